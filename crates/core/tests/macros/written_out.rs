//! Patches without macros, written out on the text alone.

use std::collections::HashMap;

use serde_json::{Map, Value};

use patchcord_expr::Unit;

/// What a section is written out with: names of ports and settings, and what they stand for.
struct Around<'d> {
    macros: &'d Map<String, Value>,
    prefix: String,
    cords: HashMap<String, String>,
    settings: HashMap<String, String>,
}

/// The document without macros, written out on the text alone.
pub fn written_out(document: &Value) -> Value {
    let mut document = document.clone();
    let macros = document["macros"].as_object().unwrap().clone();
    let outside =
        Around { macros: &macros, prefix: String::new(), cords: HashMap::new(), settings: HashMap::new() };
    let elements = document["elements"].as_object().unwrap().clone();
    document["elements"] = outside.elements(&elements).into_iter().collect();
    let reads = outside.reads(&elements);
    for signal in document["signals"].as_object_mut().unwrap().values_mut() {
        signal["at"] = reads(signal["at"].as_str().unwrap()).into();
    }
    for name in document.get_mut("record").and_then(Value::as_array_mut).into_iter().flatten() {
        *name = reads(name.as_str().unwrap()).into();
    }
    document.as_object_mut().unwrap().shift_remove("macros");
    document
}

impl Around<'_> {
    fn elements(&self, section: &Map<String, Value>) -> Vec<(String, Value)> {
        let mut written = Vec::new();
        for (name, entry) in section {
            match self.macros.get(entry["kind"].as_str().unwrap()) {
                None => written.push((format!("{}{name}", self.prefix), self.element(section, entry))),
                Some(of) => written.extend(self.inside(section, name, entry, of).elements(inside(of))),
            }
        }
        written
    }

    fn element(&self, section: &Map<String, Value>, entry: &Value) -> Value {
        let reads = self.reads(section);
        let mut entry = entry.clone();
        if let Some(jacks) = entry["in"].as_object_mut() {
            jacks.values_mut().for_each(|cords| {
                cords.as_array_mut().unwrap().iter_mut().for_each(|cord| {
                    *cord = reads(cord.as_str().unwrap()).into();
                })
            });
        } else {
            entry["in"] = reads(entry["in"].as_str().unwrap()).into();
        }
        for key in ["setting", "initial"] {
            if let Some(formula) = entry.get(key).and_then(Value::as_str) {
                entry[key] = self.formula(formula).into();
            }
        }
        entry
    }

    fn inside(&self, section: &Map<String, Value>, name: &str, entry: &Value, of: &Value) -> Around<'_> {
        let reads = self.reads(section);
        let ports = of["inputs"].as_object().unwrap().keys();
        let cords = ports.map(|port| (port.clone(), reads(entry[port].as_str().unwrap())));
        let settings = of["settings"].as_object().into_iter().flatten().map(|(setting, row)| {
            let value = entry.get(setting).unwrap_or(&row["default"]);
            let unit = Unit::parse(row["unit"].as_str().unwrap()).unwrap();
            let text =
                value.as_str().map_or_else(|| format!("{value} * {}", unit.factor()), |it| self.formula(it));
            (setting.clone(), format!("({text})"))
        });
        Around {
            macros: self.macros,
            prefix: format!("{}{name}.", self.prefix),
            cords: cords.collect(),
            settings: settings.collect(),
        }
    }

    /// What a cord in a section comes from.
    fn reads(&self, section: &Map<String, Value>) -> impl Fn(&str) -> String {
        move |cord| {
            if let Some(driver) = self.cords.get(cord) {
                return driver.clone();
            }
            let (name, port) = cord.split_once('.').unwrap_or((cord, ""));
            match section.get(name).and_then(|entry| self.macros.get(entry["kind"].as_str().unwrap())) {
                Some(of) => {
                    let outputs = of["outputs"].as_object().unwrap();
                    let Some(at) = outputs.get(port).or(outputs.values().next().filter(|_| port.is_empty()))
                    else {
                        return cord.to_owned();
                    };
                    let prefix = format!("{}{name}.", self.prefix);
                    let around = Around {
                        macros: self.macros,
                        prefix,
                        cords: HashMap::new(),
                        settings: HashMap::new(),
                    };
                    around.reads(inside(of))(at.as_str().unwrap())
                }
                None if section.contains_key(cord) => format!("{}{cord}", self.prefix),
                None => cord.to_owned(),
            }
        }
    }

    fn formula(&self, formula: &str) -> String {
        let is_sign = |letter: char| !(letter.is_alphanumeric() || letter == '_' || letter == '.');
        let words = formula.split_inclusive(is_sign).map(|piece| {
            let word = piece.trim_end_matches(is_sign);
            piece.replacen(word, self.settings.get(word).map_or(word, String::as_str), 1)
        });
        words.collect()
    }
}

fn inside(of: &Value) -> &Map<String, Value> {
    of["elements"].as_object().unwrap()
}
