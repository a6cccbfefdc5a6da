//! A patch with an effect wired in: the fragment as a macro of its own, an instance or several, and the cords that join it.

use indexmap::{IndexMap, IndexSet};
use serde_json::{Map, Value, json};

use crate::data::drive_timing::{RECORD_START, is_told_the_start};
use crate::effects::attach::{Attached, Place};
use crate::effects::sites::{Junction, Reading, Total};
use crate::effects::{Attachment, Gives, Reads};
use patchcord_core::elements;
use patchcord_core::elements::Family;
use patchcord_core::machines::REFERENCE;
use patchcord_core::patch::{Edit, EditError, Patch};
use patchcord_expr::{Dimension, Formula, Scope, Unit};

/// A parameter that a graft brings into the patch.
#[derive(Debug, Clone, PartialEq)]
pub struct Brought {
    /// Its name in the patch.
    pub name: String,
    /// Its name in the effect.
    pub of: String,
    /// Its unit.
    pub unit: String,
    /// The value that it has in the patch, in that unit.
    pub value: f64,
    /// Least and largest value.
    pub range: [f64; 2],
}

/// An effect wired into a patch.
#[derive(Debug, Clone)]
pub struct Graft {
    /// The patch with it.
    pub patch: Patch,
    /// The parameters that came with it.
    pub parameters: Vec<Brought>,
    /// The parameters that are the initial voltages of its states.
    pub free: Vec<String>,
}

impl Attached<'_> {
    /// Wires the effect into a patch; `parameters` are those of the form, with values and ranges, named as in the effect.
    ///
    /// # Errors
    /// When what comes out is no document: the fragment does not fit together.
    pub fn graft(&self, patch: &Patch, parameters: &[Brought]) -> Result<Graft, EditError> {
        let mut wiring = Wiring::new(self, patch, parameters);
        match &self.place {
            Place::Junction { junction, .. } if self.form.at == Attachment::Total => wiring.through(junction),
            Place::Junction { junction, next, .. } => wiring.beside(junction, *next),
            Place::Cord(reading) => wiring.splice(reading),
        }
        wiring.graft()
    }
}

/// A graft under way.
struct Wiring<'a> {
    attached: &'a Attached<'a>,
    patch: &'a Patch,
    /// Name of the instance.
    name: String,
    parameters: Vec<Brought>,
    /// What the names in the fragment's formulas are written as.
    words: IndexMap<String, String>,
    /// New elements, and those with other cords.
    elements: IndexMap<String, Value>,
    /// New scales, for what stands in no scale of the patch.
    scales: Map<String, Value>,
    /// What is plugged into the instance.
    inputs: Map<String, Value>,
    /// Further instances, where one is not enough, and what is plugged into them.
    others: Vec<(String, Map<String, Value>)>,
}

impl<'a> Wiring<'a> {
    fn new(attached: &'a Attached<'a>, patch: &'a Patch, parameters: &[Brought]) -> Self {
        let name = free("E", |name| {
            patch.elements.contains_key(name)
                || patch.instances.contains_key(name)
                || patch.drives.contains_key(name)
        });
        let rename = |own: &Brought| {
            let taken = |name: &str| patch.parameters.contains_key(name) || patch.scales.contains_key(name);
            Brought { name: own_name(&own.of, taken), ..own.clone() }
        };
        let parameters: Vec<Brought> = parameters.iter().map(rename).collect();
        let mut words: IndexMap<String, String> =
            parameters.iter().map(|own| (own.of.clone(), own.name.clone())).collect();
        let mut scales = Map::new();
        for (role, stands_for) in attached.place.roles() {
            let mut scale = stands_for.scale().to_owned();
            if !patch.scales.contains_key(&scale) {
                let per_volt = serde_json::from_str(&scale).unwrap_or(Value::String(scale));
                scale = format!("{name}_{role}");
                scales.insert(scale.clone(), json!({"per_volt": per_volt, "unit": stands_for.unit().text()}));
            }
            words.insert(role.to_owned(), scale);
        }
        Wiring {
            attached,
            patch,
            name,
            parameters,
            words,
            scales,
            elements: IndexMap::new(),
            inputs: Map::new(),
            others: Vec::new(),
        }
    }

    /// Wires it to a junction: it reads what is there, and adds to what drives the integrator.
    fn beside(&mut self, junction: &Junction, next: Option<&Junction>) {
        let Place::Junction { position, load, .. } = &self.attached.place else { return };
        for reads in &self.attached.form.reads {
            let reading = match reads {
                Reads::Own => Some(&junction.own),
                Reads::Position => *position,
                Reads::Load | Reads::Force => *load,
                Reads::In => None,
            };
            if let Some(reading) = reading {
                let from = self.upright(reading);
                self.inputs.insert(reads.word().to_owned(), json!(from));
            }
        }
        for (gives, _) in &self.attached.form.gives {
            match gives {
                Gives::Add => self.push(*gives, junction, true),
                Gives::Subtract => self.push(*gives, junction, false),
                Gives::Brake => self.brake(junction),
                Gives::AddToNext => next.into_iter().for_each(|next| self.push(*gives, next, true)),
                Gives::Out => (),
            }
        }
    }

    /// Where a quantity is read upright: at its own place, or behind an inverter.
    fn upright(&mut self, reading: &Reading) -> String {
        if reading.is_upright {
            return reading.at.clone();
        }
        let name = format!("{}-{}", self.name, reading.signal);
        let note = format!("{} upright", reading.signal);
        self.elements.insert(name.clone(), json!({"kind": "inverter", "in": reading.at, "note": note}));
        name
    }

    /// A port of the instance.
    fn port(&self, gives: Gives) -> String {
        format!("{}.{}", self.name, gives.word())
    }

    /// Pushes what a junction gives upward, or downward, by the voltage at a port.
    fn push(&mut self, gives: Gives, junction: &Junction, is_upward: bool) {
        let mut from = self.port(gives);
        // An integrator inverts.
        if junction.is_upright == is_upward {
            let name = format!("{}-{}", self.name, gives.word());
            self.elements.insert(name.clone(), json!({"kind": "inverter", "in": from}));
            from = name;
        }
        let is_next = gives == Gives::AddToNext;
        let ratio = is_next.then(|| format!("{} / {}", self.words["sum"], self.words["next"]));
        self.plug(gives, junction, from, "", ratio);
    }

    fn brake(&mut self, junction: &Junction) {
        self.plug(Gives::Brake, junction, self.port(Gives::Brake), "brake_", None);
    }

    /// Leads a voltage the same way into an integrator as what is in its scale there; `ratio` is that of another scale to it.
    fn plug(
        &mut self,
        gives: Gives,
        junction: &Junction,
        mut from: String,
        prefix: &str,
        ratio: Option<String>,
    ) {
        let settings: Vec<String> = junction.sum.setting.clone().into_iter().chain(ratio).collect();
        if !settings.is_empty() {
            let name = format!("{}-P{}", self.name, gives.word());
            let setting = settings.join(" * ");
            self.elements.insert(name.clone(), json!({"kind": "pot", "in": from, "setting": setting}));
            from = name;
        }
        let jack = format!("{prefix}x{}", junction.sum.gain * self.attached.form.times);
        let element = self.element(&junction.integrator);
        if let Some(Value::Object(inputs)) = element.get_mut("in") {
            let cords = inputs.entry(jack).or_insert_with(|| json!([]));
            if let Value::String(only) = cords {
                *cords = json!([only.clone()]);
            }
            cords.as_array_mut().into_iter().for_each(|cords| cords.push(json!(from)));
        }
    }

    /// An element of the patch, to be changed.
    fn element(&mut self, name: &str) -> &mut Value {
        let entry = self.elements.entry(name.to_owned());
        entry.or_insert_with(|| self.patch.value()["elements"][name].clone())
    }

    /// Wires it between everything that drives an integrator and the integrator: into the one cord, or, where there are more,
    /// into each of them.
    fn through(&mut self, junction: &Junction) {
        if self.attached.form.reads.contains(&Reads::Own) {
            let own = self.upright(&junction.own);
            self.inputs.insert(Reads::Own.word().to_owned(), json!(own));
        }
        let driving = match &junction.sum.total {
            Some(total) => IndexSet::from([total.clone()]),
            None => self.driving(junction),
        };
        for (place, total) in driving.into_iter().enumerate() {
            let input = (Reads::In.word().to_owned(), json!(total.from));
            let instance = match place {
                0 => self.name.clone(),
                _ => format!("{}-{}", self.name, place + 1),
            };
            if place == 0 {
                self.inputs.extend([input]);
            } else {
                let inputs = self.inputs.clone().into_iter().chain([input]).collect();
                self.others.push((instance.clone(), inputs));
            }
            self.replug(&total.to, &total.from, &format!("{instance}.{}", Gives::Out.word()));
        }
    }

    /// Every cord that drives an integrator, its brake among them; before the potentiometer that it comes through, which sets a
    /// rate and has to stay beside the integrator, unless that drives something else, too.
    fn driving(&self, junction: &Junction) -> IndexSet<Total> {
        let elements = &self.patch.value()["elements"];
        let jacks = elements[&junction.integrator]["in"].as_object().into_iter().flatten();
        let own = jacks.filter(|(jack, _)| jack.starts_with('x') || jack.starts_with("brake_x"));
        let total = |from: &str, to: &str| Total { from: from.to_owned(), to: to.to_owned() };
        let each = own.flat_map(|(_, driven)| cords(driven)).map(|from| {
            let behind: Vec<&str> = match elements[from]["kind"].as_str() {
                Some("pot") if !self.drives_other(from, &junction.integrator) => {
                    cords(&elements[from]["in"]).collect()
                }
                _ => Vec::new(),
            };
            match behind.as_slice() {
                [behind] => total(behind, from),
                _ => total(from, &junction.integrator),
            }
        });
        each.collect()
    }

    /// Whether an element drives more than this one.
    fn drives_other(&self, from: &str, to: &str) -> bool {
        let others = self.patch.elements.iter().filter(|(name, _)| *name != to);
        let mut plugs = others.flat_map(|(_, entry)| &entry.plugs);
        let mut inlets = self.patch.instances.values().flat_map(|instance| instance.inputs.values());
        plugs.any(|plug| plug.from.value == from) || inlets.any(|inlet| inlet.driver.as_deref() == Some(from))
    }

    /// Wires it into the cords of an output, to elements and to instances of macros.
    fn splice(&mut self, reading: &Reading) {
        self.inputs.insert(Reads::In.word().to_owned(), json!(reading.at));
        let (patch, out) = (self.patch, self.port(Gives::Out));
        let is_own = |name: &str| !name.contains('.');
        for (name, entry) in patch.elements.iter().filter(|(name, _)| is_own(name)) {
            if entry.plugs.iter().any(|plug| plug.from.value == reading.at) {
                self.replug(name, &reading.at, &out);
            }
        }
        for (name, instance) in patch.instances.iter().filter(|(name, _)| is_own(name)) {
            for (port, inlet) in &instance.inputs {
                if inlet.driver.as_ref() == Some(&reading.at) {
                    put_into(&mut self.element(name)[port], &reading.at, &out);
                }
            }
        }
    }

    /// Puts other cords into the jacks of an element; a setting may have the same name as a cord.
    fn replug(&mut self, name: &str, from: &str, to: &str) {
        let kind = self.patch.elements[name].kind;
        let Some(entries) = self.element(name).as_object_mut() else { return };
        let is_jack = |key: &str| !["kind", "note", "uses"].contains(&key) && kind.setting(key).is_none();
        let jacks = entries.iter_mut().filter(|(key, _)| is_jack(key));
        jacks.for_each(|(_, jack)| put_into(jack, from, to));
    }

    fn graft(mut self) -> Result<Graft, EditError> {
        let form = self.attached.form;
        for (gain, formula) in &form.gains {
            let largest = self.largest(formula);
            self.words.insert(gain.clone(), format!("{}", ten_above(largest)));
        }
        let mut drives = Map::new();
        for (name, drive) in &form.drives {
            let own = format!("{}-{name}", self.name);
            self.words.insert(name.clone(), own.clone());
            drives.insert(own, drive.clone());
        }
        let macro_name = free_or(&self.attached.effect.name, |name| {
            self.patch.macros.contains_key(name) || elements::find(Family::Computing, name).is_some()
        });
        let mut edits = self.edits(&macro_name);
        for (name, scale) in &self.scales {
            put(&mut edits, self.patch, "scales", name, scale.clone());
        }
        for (name, drive) in drives {
            put(&mut edits, self.patch, "drives", &name, self.written(&drive));
        }
        edits.push(Edit::new("machine", "unlimited"));
        let free: Vec<String> = form.free.iter().map(|state| self.initial(state)).collect();
        for (state, name) in form.free.iter().zip(&free) {
            let limit = |end: &str, default| form.elements[state]["limit"][end].as_f64().unwrap_or(default);
            let range = [limit("lower", -REFERENCE), limit("upper", REFERENCE)];
            let value = json!({"value": 0, "unit": "1", "range": range, "description": "initial voltage"});
            put(&mut edits, self.patch, "parameters", name, value);
        }
        let patch = self.patch.edited(self.patch.file(), &edits)?;
        Ok(Graft { patch, parameters: self.parameters, free })
    }

    fn edits(&self, macro_name: &str) -> Vec<Edit> {
        let mut edits = Vec::new();
        for own in &self.parameters {
            let told = &self.attached.effect.parameters[&own.of];
            let value = json!({
                "value": own.value, "unit": own.unit, "range": own.range, "description": told.description,
            });
            put(&mut edits, self.patch, "parameters", &own.name, value);
        }
        if self.goes_by_the_clock() {
            let value = json!({"value": 0, "unit": "s", "description": "when the record begins"});
            put(&mut edits, self.patch, "parameters", RECORD_START, value);
        }
        put(&mut edits, self.patch, "macros", macro_name, self.fragment());
        let others = self.others.iter().map(|(name, inputs)| (name, inputs));
        for (name, inputs) in [(&self.name, &self.inputs)].into_iter().chain(others) {
            let mut instance = Map::new();
            instance.insert("kind".to_owned(), json!(macro_name));
            instance.extend(inputs.clone());
            instance.insert("note".to_owned(), json!(self.attached.effect.title));
            put(&mut edits, self.patch, "elements", name, Value::Object(instance));
        }
        for (name, element) in &self.elements {
            put(&mut edits, self.patch, "elements", name, element.clone());
        }
        edits
    }

    fn goes_by_the_clock(&self) -> bool {
        self.attached.form.drives.values().any(is_told_the_start)
    }

    /// The fragment as a macro.
    fn fragment(&self) -> Value {
        let effect = self.attached.effect;
        let inputs = self.inputs.keys().map(|role| {
            let meaning =
                Reads::ALL.iter().find(|reads| reads.word() == role).map_or("", |reads| reads.meaning());
            (role.clone(), json!(meaning))
        });
        let outputs = self.attached.form.gives.iter().map(|(gives, at)| (gives.word().to_owned(), json!(at)));
        let form = self.attached.form;
        let elements = form.elements.iter().map(|(name, element)| {
            let mut element = self.written(element);
            if form.free.contains(name) {
                element["initial"] = json!(self.initial(name));
            }
            (name.clone(), element)
        });
        json!({
            "note": format!("{} {}. Source: {}", effect.physics, effect.law, effect.source),
            "inputs": inputs.collect::<Map<_, _>>(),
            "outputs": outputs.collect::<Map<_, _>>(),
            "elements": elements.collect::<Map<_, _>>(),
        })
    }

    /// Name of the parameter that is the initial voltage of a state inside.
    fn initial(&self, state: &str) -> String {
        let taken =
            |name: &str| self.patch.parameters.contains_key(name) || self.patch.scales.contains_key(name);
        own_name(&format!("{}_{state}_initial", self.name), taken)
    }

    /// An element or drive of the fragment with the names that it has in the patch.
    fn written(&self, value: &Value) -> Value {
        match value {
            Value::Object(entries) => {
                let mut written = Map::new();
                for (key, value) in entries {
                    let is_plain = key == "note" || key == "kind";
                    let value = if is_plain { value.clone() } else { self.written(value) };
                    // A gain may come to that of a jack that has cords already.
                    match (written.get_mut(&self.jack(key)), value) {
                        (Some(Value::Array(cords)), Value::Array(more)) => cords.extend(more),
                        (_, value) => {
                            written.insert(self.jack(key), value);
                        }
                    }
                }
                Value::Object(written)
            }
            Value::Array(items) => Value::Array(items.iter().map(|item| self.written(item)).collect()),
            // An input port has the name of its role.
            Value::String(text) if self.inputs.contains_key(text) => value.clone(),
            Value::String(text) if self.attached.form.elements.contains_key(text) => value.clone(),
            Value::String(text) => Value::String(renamed(text, &self.words)),
            _ => value.clone(),
        }
    }

    /// "xG" with its power of ten.
    fn jack(&self, key: &str) -> String {
        let gain = key.strip_prefix('x').filter(|gain| self.attached.form.gains.contains_key(*gain));
        gain.map_or_else(|| key.to_owned(), |gain| format!("x{}", self.words[gain]))
    }

    /// What a formula comes to at most, over the ranges of the parameters.
    fn largest(&self, formula: &Formula) -> f64 {
        let mut values = Values { values: Vec::new() };
        for (role, stands_for) in self.attached.place.roles() {
            values.values.push((role, stands_for.unit().to_si(stands_for.per_volt())));
        }
        values.values.push(("time_scale", self.patch.time_scale));
        let given = values.values.len();
        // Every corner of the ranges: a binary digit of its number chooses the end of each.
        let corner = |number: usize| {
            let mut values = Values { values: values.values[..given].to_vec() };
            for (place, own) in self.parameters.iter().enumerate() {
                let unit = Unit::parse(&own.unit).map_or(1.0, |unit| unit.factor());
                values.values.push((&own.of, unit * own.range[number >> place & 1]));
            }
            formula.evaluate(&values).ok().map(f64::abs)
        };
        (0..1 << self.parameters.len()).filter_map(corner).fold(1.0, f64::max)
    }
}

/// What names in formulas stand for, in SI.
struct Values<'a> {
    values: Vec<(&'a str, f64)>,
}

impl Scope for Values<'_> {
    fn value(&self, name: &str) -> Option<f64> {
        self.values.iter().find(|(own, _)| *own == name).map(|(_, value)| *value)
    }

    fn dimension(&self, _: &str) -> Option<Dimension> {
        None
    }

    fn names(&self) -> Vec<&str> {
        self.values.iter().map(|(name, _)| *name).collect()
    }
}

/// Puts a named thing into a section, which may not be there yet.
fn put(edits: &mut Vec<Edit>, patch: &Patch, section: &str, name: &str, value: Value) {
    if patch.value().get(section).is_some() {
        edits.push(Edit { path: vec![section.to_owned(), name.to_owned()], value });
        return;
    }
    let found = edits.iter_mut().find(|edit| edit.path == [section]);
    match found.map(|edit| &mut edit.value) {
        Some(Value::Object(entries)) => {
            entries.insert(name.to_owned(), value);
        }
        _ => edits.push(Edit { path: vec![section.to_owned()], value: json!({name: value}) }),
    }
}

/// What drives a jack: one cord, or a list of them.
fn cords(jack: &Value) -> impl Iterator<Item = &str> {
    jack.as_array().map_or(std::slice::from_ref(jack), Vec::as_slice).iter().filter_map(Value::as_str)
}

/// Puts other cords into jacks.
fn put_into(jacks: &mut Value, from: &str, to: &str) {
    match jacks {
        Value::String(text) if text == from => *text = to.to_owned(),
        Value::Array(items) => items.iter_mut().for_each(|item| put_into(item, from, to)),
        Value::Object(entries) => entries.values_mut().for_each(|item| put_into(item, from, to)),
        _ => (),
    }
}

/// The first of name1, name2, ... that is not taken.
fn free(stem: &str, is_taken: impl Fn(&str) -> bool) -> String {
    let names = (1..).map(|number| format!("{stem}{number}"));
    names.into_iter().find(|name| !is_taken(name)).unwrap_or_default()
}

/// The name, or the first of name_1, name_2, ... that is not taken: one that formulas can read.
pub(crate) fn own_name(name: &str, is_taken: impl Fn(&str) -> bool) -> String {
    if is_taken(name) { free(&format!("{name}_"), is_taken) } else { name.to_owned() }
}

/// The name, or the first of name-2, name-3, ... that is not taken.
fn free_or(name: &str, is_taken: impl Fn(&str) -> bool) -> String {
    if !is_taken(name) {
        return name.to_owned();
    }
    (2..).map(|number| format!("{name}-{number}")).find(|name| !is_taken(name)).unwrap_or_default()
}

/// The least power of ten, 1 or more, that is not below a value.
fn ten_above(value: f64) -> f64 {
    let mut ten = 1.0;
    while ten < value && ten < 1e12 {
        ten *= 10.0;
    }
    ten
}

/// A formula with other words for its names.
fn renamed(text: &str, words: &IndexMap<String, String>) -> String {
    let mut out = String::new();
    let mut rest = text;
    let is_inside = |letter: char| letter.is_ascii_alphanumeric() || letter == '_';
    while let Some(first) = rest.chars().next() {
        let length = rest.find(|letter| !is_inside(letter)).unwrap_or(rest.len()).max(first.len_utf8());
        let (word, after) = rest.split_at(length);
        let follows = after.trim_start().starts_with('(');
        match words.get(word).filter(|_| !follows) {
            Some(other) => out.push_str(other),
            None => out.push_str(word),
        }
        rest = after;
    }
    out
}
