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
use patchcord_core::patch::{EditError, ElementBuilder, MacroBuilder, ParameterBuilder, Patch, PatchEditor};
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
    /// New elements by name.
    elements: IndexMap<String, ElementBuilder>,
    /// Changes of the cords of elements and instances that the patch has, in their order.
    rewirings: Vec<Rewiring>,
    /// New scales, for quantities that have no scale in the patch: name, value of a volt, unit.
    scales: Vec<(String, Value, String)>,
    /// What is plugged into the instance, by port.
    inputs: IndexMap<String, String>,
    /// Further instances, where one is not enough, and what is plugged into them.
    others: Vec<(String, IndexMap<String, String>)>,
}

/// A change of the cords of an element or an instance that the patch has.
enum Rewiring {
    /// One more cord.
    Cord { element: String, jack: String, from: String },
    /// Another name in place of one that is plugged in.
    Replug { element: String, from: String, to: String },
}

impl Rewiring {
    fn apply(&self, editor: &mut PatchEditor) -> Result<(), EditError> {
        match self {
            Rewiring::Cord { element, jack, from } => match has_jacks(editor.patch(), element) {
                true => editor.add_cord(element, jack, from),
                false => Ok(()),
            },
            Rewiring::Replug { element, from, to } => editor.replug(element, from, to),
        }
    }
}

/// Whether an integrator has jacks, with or without cords.
fn has_jacks(patch: &Patch, integrator: &str) -> bool {
    let mut cords = patch.written_cords(integrator);
    cords.next().is_some() || patch.value()["elements"][integrator]["in"].is_object()
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
        let mut scales = Vec::new();
        for (role, stands_for) in attached.place.roles() {
            let mut scale = stands_for.scale().to_owned();
            if !patch.scales.contains_key(&scale) {
                let per_volt = serde_json::from_str(&scale).unwrap_or(Value::String(scale));
                scale = format!("{name}_{role}");
                scales.push((scale.clone(), per_volt, stands_for.unit().text().to_owned()));
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
            rewirings: Vec::new(),
            inputs: IndexMap::new(),
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
                self.inputs.insert(reads.word().to_owned(), from);
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
        let inverter = ElementBuilder::new("inverter").cord("in", &reading.at).set("note", note);
        self.elements.insert(name.clone(), inverter);
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
            self.elements.insert(name.clone(), ElementBuilder::new("inverter").cord("in", &from));
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
            let pot = ElementBuilder::new("pot").cord("in", &from).set("setting", setting);
            self.elements.insert(name.clone(), pot);
            from = name;
        }
        let jack = format!("{prefix}x{}", junction.sum.gain * self.attached.form.times);
        self.rewirings.push(Rewiring::Cord { element: junction.integrator.clone(), jack, from });
    }

    /// Wires it between everything that drives an integrator and the integrator: into the one cord, or, where there are more,
    /// into each of them.
    fn through(&mut self, junction: &Junction) {
        if self.attached.form.reads.contains(&Reads::Own) {
            let own = self.upright(&junction.own);
            self.inputs.insert(Reads::Own.word().to_owned(), own);
        }
        let driving = match &junction.sum.total {
            Some(total) => IndexSet::from([total.clone()]),
            None => self.driving(junction),
        };
        for (place, total) in driving.into_iter().enumerate() {
            let input = (Reads::In.word().to_owned(), total.from.clone());
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
        let cords = self.patch.written_cords(&junction.integrator);
        let own = cords.filter(|(jack, _)| jack.starts_with('x') || jack.starts_with("brake_x"));
        let total = |from: &str, to: &str| Total { from: from.to_owned(), to: to.to_owned() };
        let each = own.map(|(_, from)| {
            let is_pot = self.patch.elements.get(from).is_some_and(|entry| entry.kind.name == "pot");
            let behind: Vec<&str> = match is_pot && !self.drives_other(from, &junction.integrator) {
                true => self.patch.written_cords(from).map(|(_, behind)| behind).collect(),
                false => Vec::new(),
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
        self.inputs.insert(Reads::In.word().to_owned(), reading.at.clone());
        let (patch, out) = (self.patch, self.port(Gives::Out));
        let is_own = |name: &str| !name.contains('.');
        for (name, entry) in patch.elements.iter().filter(|(name, _)| is_own(name)) {
            if entry.plugs.iter().any(|plug| plug.from.value == reading.at) {
                self.replug(name, &reading.at, &out);
            }
        }
        for (name, instance) in patch.instances.iter().filter(|(name, _)| is_own(name)) {
            if instance.inputs.values().any(|inlet| inlet.driver.as_ref() == Some(&reading.at)) {
                self.replug(name, &reading.at, &out);
            }
        }
    }

    /// Puts another name in place of one that is plugged into an element or an instance.
    fn replug(&mut self, name: &str, from: &str, to: &str) {
        let [element, from, to] = [name, from, to].map(str::to_owned);
        self.rewirings.push(Rewiring::Replug { element, from, to });
    }

    fn graft(mut self) -> Result<Graft, EditError> {
        let form = self.attached.form;
        for (gain, formula) in &form.gains {
            let largest = self.largest(formula);
            self.words.insert(gain.clone(), format!("{}", ten_above(largest)));
        }
        let mut drives = Vec::new();
        for (name, drive) in &form.drives {
            let own = format!("{}-{name}", self.name);
            self.words.insert(name.clone(), own.clone());
            drives.push((own, drive));
        }
        let macro_name = free_or(&self.attached.effect.name, |name| {
            self.patch.macros.contains_key(name) || elements::find(Family::Computing, name).is_some()
        });
        let mut editor = self.patch.edit();
        self.put_elements(&macro_name, &mut editor)?;
        for (name, per_volt, unit) in &self.scales {
            editor.put_scale(name, per_volt.clone(), unit);
        }
        for (name, drive) in drives {
            match self.written(drive) {
                Value::Object(entry) => editor.put_drive(&name, ElementBuilder::of(entry)),
                // What it is instead is reported when the text is read.
                other => editor.put(&["drives", name.as_str()], other),
            }
        }
        editor.set_machine("unlimited");
        let free: Vec<String> = form.free.iter().map(|state| self.initial(state)).collect();
        for (state, name) in form.free.iter().zip(&free) {
            let limit = |end: &str, default| form.elements[state]["limit"][end].as_f64().unwrap_or(default);
            let range = [limit("lower", -REFERENCE), limit("upper", REFERENCE)];
            let initial = ParameterBuilder::new(0, "1").range(range).description("initial voltage");
            editor.put_parameter(name, initial);
        }
        let patch = editor.finish(self.patch.file())?;
        Ok(Graft { patch, parameters: self.parameters, free })
    }

    /// Puts the parameters, the macro, its instances and the new elements, and changes cords. The order is that of states and
    /// sums.
    fn put_elements(&self, macro_name: &str, editor: &mut PatchEditor) -> Result<(), EditError> {
        let effect = self.attached.effect;
        for own in &self.parameters {
            let parameter = ParameterBuilder::new(own.value, &own.unit).range(own.range);
            editor.put_parameter(&own.name, parameter.description(&effect.parameters[&own.of].description));
        }
        if self.goes_by_the_clock() {
            let start = ParameterBuilder::new(0, "s").description("when the record begins");
            editor.put_parameter(RECORD_START, start);
        }
        editor.put_macro(macro_name, MacroBuilder::of(self.fragment()));
        let others = self.others.iter().map(|(name, inputs)| (name, inputs));
        for (name, inputs) in [(&self.name, &self.inputs)].into_iter().chain(others) {
            let instance = ElementBuilder::new(macro_name);
            let instance = inputs.iter().fold(instance, |instance, (port, from)| instance.cord(port, from));
            editor.put_element(name, instance.set("note", effect.title.as_str()));
        }
        for (name, element) in &self.elements {
            editor.put_element(name, element.clone());
        }
        self.rewirings.iter().try_for_each(|rewiring| rewiring.apply(editor))
    }

    fn goes_by_the_clock(&self) -> bool {
        self.attached.form.drives.values().any(is_told_the_start)
    }

    /// The fragment as a macro.
    fn fragment(&self) -> Map<String, Value> {
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
        let note = format!("{} {}. Source: {}", effect.physics, effect.law, effect.source);
        let keys = [
            ("note", Value::String(note)),
            ("inputs", Value::Object(inputs.collect())),
            ("outputs", Value::Object(outputs.collect())),
            ("elements", Value::Object(elements.collect())),
        ];
        keys.into_iter().map(|(key, value)| (key.to_owned(), value)).collect()
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
