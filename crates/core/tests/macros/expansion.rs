//! An independent expansion of macros that works on the JSON document only.

use std::collections::HashMap;

use serde_json::{Map, Value};

use patchcord_expr::Unit;

/// The context in which a section is expanded: the name prefix, the drivers of ports, and the formulas of settings.
struct Context<'d> {
    macros: &'d Map<String, Value>,
    prefix: String,
    cords: HashMap<String, String>,
    settings: HashMap<String, String>,
}

/// The document with all macros expanded.
pub(super) fn expanded(document: &Value) -> Value {
    let mut document = document.clone();
    let macros = document["macros"].as_object().unwrap().clone();
    let top_level =
        Context { macros: &macros, prefix: String::new(), cords: HashMap::new(), settings: HashMap::new() };
    let elements = document["elements"].as_object().unwrap().clone();
    document["elements"] = top_level.elements(&elements).into_iter().collect();
    let driver_of = top_level.drivers(&elements);
    for signal in document["signals"].as_object_mut().unwrap().values_mut() {
        signal["at"] = driver_of(signal["at"].as_str().unwrap()).into();
    }
    for name in document.get_mut("record").and_then(Value::as_array_mut).into_iter().flatten() {
        *name = driver_of(name.as_str().unwrap()).into();
    }
    document.as_object_mut().unwrap().shift_remove("macros");
    document
}

impl Context<'_> {
    /// The expanded elements of a section.
    fn elements(&self, section: &Map<String, Value>) -> Vec<(String, Value)> {
        let mut elements = Vec::new();
        for (name, entry) in section {
            match self.macros.get(entry["kind"].as_str().unwrap()) {
                None => elements.push((format!("{}{name}", self.prefix), self.element(section, entry))),
                Some(definition) => elements.extend(
                    self.of_instance(section, name, entry, definition).elements(section_of(definition)),
                ),
            }
        }
        elements
    }

    /// An element with its cords and formulas resolved.
    fn element(&self, section: &Map<String, Value>, entry: &Value) -> Value {
        let driver_of = self.drivers(section);
        let mut entry = entry.clone();
        if let Some(jacks) = entry["in"].as_object_mut() {
            jacks.values_mut().for_each(|cords| {
                cords.as_array_mut().unwrap().iter_mut().for_each(|cord| {
                    *cord = driver_of(cord.as_str().unwrap()).into();
                })
            });
        } else {
            entry["in"] = driver_of(entry["in"].as_str().unwrap()).into();
        }
        for key in ["setting", "initial"] {
            if let Some(formula) = entry.get(key).and_then(Value::as_str) {
                entry[key] = self.formula(formula).into();
            }
        }
        entry
    }

    /// The context of an instance.
    fn of_instance(
        &self,
        section: &Map<String, Value>,
        name: &str,
        entry: &Value,
        definition: &Value,
    ) -> Context<'_> {
        let driver_of = self.drivers(section);
        let ports = definition["inputs"].as_object().unwrap().keys();
        let cords = ports.map(|port| (port.clone(), driver_of(entry[port].as_str().unwrap())));
        let settings = definition["settings"].as_object().into_iter().flatten().map(|(setting, row)| {
            let value = entry.get(setting).unwrap_or(&row["default"]);
            let unit = Unit::parse(row["unit"].as_str().unwrap()).unwrap();
            let text = value
                .as_str()
                .map_or_else(|| format!("{value} * {}", unit.factor()), |formula| self.formula(formula));
            (setting.clone(), format!("({text})"))
        });
        Context {
            macros: self.macros,
            prefix: format!("{}{name}.", self.prefix),
            cords: cords.collect(),
            settings: settings.collect(),
        }
    }

    /// A function from a cord in a section to the name of the element that drives it.
    fn drivers(&self, section: &Map<String, Value>) -> impl Fn(&str) -> String {
        move |cord| {
            if let Some(driver) = self.cords.get(cord) {
                return driver.clone();
            }
            let (name, port) = cord.split_once('.').unwrap_or((cord, ""));
            match section.get(name).and_then(|entry| self.macros.get(entry["kind"].as_str().unwrap())) {
                Some(definition) => {
                    let outputs = definition["outputs"].as_object().unwrap();
                    let Some(output) =
                        outputs.get(port).or(outputs.values().next().filter(|_| port.is_empty()))
                    else {
                        return cord.to_owned();
                    };
                    let prefix = format!("{}{name}.", self.prefix);
                    let context = Context {
                        macros: self.macros,
                        prefix,
                        cords: HashMap::new(),
                        settings: HashMap::new(),
                    };
                    context.drivers(section_of(definition))(output.as_str().unwrap())
                }
                None if section.contains_key(cord) => format!("{}{cord}", self.prefix),
                None => cord.to_owned(),
            }
        }
    }

    /// A formula with the names of settings replaced by their formulas.
    fn formula(&self, formula: &str) -> String {
        let is_operator = |letter: char| !(letter.is_alphanumeric() || letter == '_' || letter == '.');
        let words = formula.split_inclusive(is_operator).map(|token| {
            let word = token.trim_end_matches(is_operator);
            token.replacen(word, self.settings.get(word).map_or(word, String::as_str), 1)
        });
        words.collect()
    }
}

/// The elements of a macro definition.
fn section_of(definition: &Value) -> &Map<String, Value> {
    definition["elements"].as_object().unwrap()
}
