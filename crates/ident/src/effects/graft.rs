//! A graft: a patch extended by an effect.
//!
//! The fragment of the effect becomes a macro with one instance, or several where it is inserted into several cords.
//! New potentiometers and inverters lead its outputs to the site with the right scale and sign. All new names are
//! unused in the patch. The parameters of the effect become parameters of the patch, in the units of the site.
//!
//! The order of the work is: choose unused names, connect the inputs of the fragment, lead its outputs to the site, and
//! write everything with a patch editor. Checks of patches run at the end, so that a fault in a fragment is reported
//! like a fault in any patch. The machine becomes "unlimited", because an effect may need more amplifiers than a
//! machine has.

mod fragment;

use indexmap::{IndexMap, IndexSet};
use serde_json::Value;

use crate::data::drive_timing::RECORD_START;
use crate::effects::attach::{AttachmentSite, EffectPlacement};
use crate::effects::sites::{Junction, ScaledSignal, TotalCord};
use crate::effects::unused_names::{numbered_name, unused_hyphenated_name, unused_name};
use crate::effects::{Attachment, InputRole, OutputRole};
use fragment::power_of_ten_above;
use patchcord_core::elements;
use patchcord_core::elements::Family;
use patchcord_core::machines::REFERENCE;
use patchcord_core::patch::{EditError, ElementBuilder, MacroBuilder, ParameterBuilder, Patch, PatchEditor};

/// A parameter that an effect adds to a patch.
#[derive(Debug, Clone, PartialEq)]
pub struct AddedParameter {
    /// Its name in the patch. It has a suffix such as "_1" if the patch has used the effect's name already.
    pub name: String,
    /// Its name in the effect.
    pub name_in_effect: String,
    /// Its unit: that of its reach at the site.
    pub unit: String,
    /// Its value in the patch, in that unit.
    pub value: f64,
    /// The least and the largest value of the search, in that unit.
    pub range: [f64; 2],
}

/// A patch extended by an effect.
#[derive(Debug, Clone)]
pub struct Graft {
    /// The extended patch.
    pub patch: Patch,
    /// The parameters of the effect, in the order of its form.
    pub parameters: Vec<AddedParameter>,
    /// The added parameters that are the initial voltages of the fragment's states, in the order of the form's
    /// `free_states`.
    pub initial_states: Vec<String>,
}

impl EffectPlacement<'_> {
    /// Wires the effect into a patch. `parameters` are those of the form, named as in the effect, with values and
    /// ranges in the units of the site.
    ///
    /// # Errors
    /// If the result is not a valid patch, because the fragment is inconsistent.
    pub fn graft(&self, patch: &Patch, parameters: &[AddedParameter]) -> Result<Graft, EditError> {
        let mut builder = GraftBuilder::new(self, patch, parameters);
        match &self.site {
            AttachmentSite::Junction { junction, .. } if self.form.attachment == Attachment::Total => {
                builder.insert_before_integrator(junction);
            }
            AttachmentSite::Junction { junction, next, .. } => builder.add_to_sum(junction, *next),
            AttachmentSite::Cord(signal) => builder.insert_into_cords(signal),
        }
        builder.finish()
    }
}

/// Collects the changes that wire an effect into a patch.
struct GraftBuilder<'a> {
    /// The effect, its form and the site.
    placement: &'a EffectPlacement<'a>,
    /// The patch that is extended.
    patch: &'a Patch,
    /// Name of the first instance: "E1", "E2", ...
    instance: String,
    /// The added parameters with unused names.
    parameters: Vec<AddedParameter>,
    /// The names of the fragment's formulas and the names that replace them in the patch.
    renames: IndexMap<String, String>,
    /// New elements by name.
    elements: IndexMap<String, ElementBuilder>,
    /// Changes of the cords of existing elements and instances, in the order in which they apply.
    rewirings: Vec<Rewiring>,
    /// New scales for quantities that have no named scale in the patch: name, value of a volt, unit.
    scales: Vec<(String, Value, String)>,
    /// The inputs of the first instance, by port.
    inputs: IndexMap<String, String>,
    /// Further instances with their inputs, for a fragment that is inserted into several cords.
    further_instances: Vec<(String, IndexMap<String, String>)>,
}

/// A change of the cords of an existing element or instance.
enum Rewiring {
    /// Adds a cord from an output to a jack.
    Add { element: String, jack: String, from: String },
    /// Replaces the output `from` by `to` in all cords of an element.
    Replace { element: String, from: String, to: String },
}

impl Rewiring {
    /// Applies the change. No cord is added to an integrator whose document lists no jacks.
    fn apply(&self, editor: &mut PatchEditor) -> Result<(), EditError> {
        match self {
            Rewiring::Add { element, jack, from } => match has_jacks(editor.patch(), element) {
                true => editor.add_cord(element, jack, from),
                false => Ok(()),
            },
            Rewiring::Replace { element, from, to } => editor.replug(element, from, to),
        }
    }
}

/// Whether the document of a patch lists jacks for an integrator, with or without cords.
fn has_jacks(patch: &Patch, integrator: &str) -> bool {
    let mut cords = patch.written_cords(integrator);
    cords.next().is_some() || patch.value()["elements"][integrator]["in"].is_object()
}

impl<'a> GraftBuilder<'a> {
    /// Chooses the names of the instance, the parameters and the scales.
    fn new(placement: &'a EffectPlacement<'a>, patch: &'a Patch, parameters: &[AddedParameter]) -> Self {
        let instance = numbered_name("E", |name| {
            patch.elements.contains_key(name)
                || patch.instances.contains_key(name)
                || patch.drives.contains_key(name)
        });
        let with_unused_name = |parameter: &AddedParameter| {
            let is_taken =
                |name: &str| patch.parameters.contains_key(name) || patch.scales.contains_key(name);
            AddedParameter { name: unused_name(&parameter.name_in_effect, is_taken), ..parameter.clone() }
        };
        let parameters: Vec<AddedParameter> = parameters.iter().map(with_unused_name).collect();
        let mut renames: IndexMap<String, String> = parameters
            .iter()
            .map(|parameter| (parameter.name_in_effect.clone(), parameter.name.clone()))
            .collect();
        let mut scales = Vec::new();
        for (role, quantity) in placement.site.quantities() {
            let mut scale = quantity.scale().to_owned();
            if !patch.scales.contains_key(&scale) {
                let per_volt = serde_json::from_str(&scale).unwrap_or(Value::String(scale));
                scale = format!("{instance}_{role}");
                scales.push((scale.clone(), per_volt, quantity.unit().text().to_owned()));
            }
            renames.insert(role.to_owned(), scale);
        }
        GraftBuilder {
            placement,
            patch,
            instance,
            parameters,
            renames,
            scales,
            elements: IndexMap::new(),
            rewirings: Vec::new(),
            inputs: IndexMap::new(),
            further_instances: Vec::new(),
        }
    }

    /// Wires the fragment to a junction: connects its inputs and adds its outputs to the sum of the integrator.
    fn add_to_sum(&mut self, junction: &Junction, next: Option<&Junction>) {
        let AttachmentSite::Junction { position, load, .. } = &self.placement.site else { return };
        for role in &self.placement.form.reads {
            let signal = match role {
                InputRole::Own => Some(&junction.output),
                InputRole::Position => *position,
                InputRole::Load | InputRole::Force => *load,
                InputRole::In => None,
            };
            if let Some(signal) = signal {
                let from = self.noninverted_output(signal);
                self.inputs.insert(role.word().to_owned(), from);
            }
        }
        for (role, _) in &self.placement.form.gives {
            match role {
                OutputRole::Add => self.push(*role, junction, true),
                OutputRole::Subtract => self.push(*role, junction, false),
                OutputRole::Brake => self.brake(junction),
                OutputRole::AddToNext => next.into_iter().for_each(|next| self.push(*role, next, true)),
                OutputRole::Out => (),
            }
        }
    }

    /// An output that carries a quantity with its sign: that of the signal, or of a new inverter behind it.
    ///
    /// The inverter is named after the instance and the signal, such as "E1-x".
    fn noninverted_output(&mut self, signal: &ScaledSignal) -> String {
        if signal.is_noninverted {
            return signal.element.clone();
        }
        let name = format!("{}-{}", self.instance, signal.signal);
        let note = format!("{} with its sign", signal.signal);
        let inverter = ElementBuilder::new("inverter").cord("in", &signal.element).set("note", note);
        self.elements.insert(name.clone(), inverter);
        name
    }

    /// An output port of the first instance.
    fn port(&self, role: OutputRole) -> String {
        format!("{}.{}", self.instance, role.word())
    }

    /// Adds the voltage of a port to the sum of a junction, so that it increases or decreases the output.
    fn push(&mut self, role: OutputRole, junction: &Junction, is_increasing: bool) {
        let mut from = self.port(role);
        // An integrator inverts.
        if junction.is_noninverted == is_increasing {
            let name = format!("{}-{}", self.instance, role.word());
            self.elements.insert(name.clone(), ElementBuilder::new("inverter").cord("in", &from));
            from = name;
        }
        let is_next = role == OutputRole::AddToNext;
        let ratio = is_next.then(|| format!("{} / {}", self.renames["sum"], self.renames["next"]));
        self.plug(role, junction, from, "", ratio);
    }

    /// Leads the voltage of the brake port to the brake of an integrator.
    fn brake(&mut self, junction: &Junction) {
        self.plug(OutputRole::Brake, junction, self.port(OutputRole::Brake), "brake_", None);
    }

    /// Leads a voltage to an integrator with the same setting and gain as the sum. `ratio` is a further factor, for a
    /// voltage of another scale. `prefix` is "brake_" for the brake and empty for the sum.
    fn plug(
        &mut self,
        role: OutputRole,
        junction: &Junction,
        mut from: String,
        prefix: &str,
        ratio: Option<String>,
    ) {
        let settings: Vec<String> = junction.sum.setting.clone().into_iter().chain(ratio).collect();
        if !settings.is_empty() {
            let name = format!("{}-P{}", self.instance, role.word());
            let setting = settings.join(" * ");
            let pot = ElementBuilder::new("pot").cord("in", &from).set("setting", setting);
            self.elements.insert(name.clone(), pot);
            from = name;
        }
        let jack = format!("{prefix}x{}", junction.sum.gain * self.placement.form.output_gain);
        self.rewirings.push(Rewiring::Add { element: junction.integrator.clone(), jack, from });
    }

    /// Inserts the fragment between an integrator and everything that drives it. If several cords drive it, there is an
    /// instance in each of them.
    fn insert_before_integrator(&mut self, junction: &Junction) {
        if self.placement.form.reads.contains(&InputRole::Own) {
            let output = self.noninverted_output(&junction.output);
            self.inputs.insert(InputRole::Own.word().to_owned(), output);
        }
        let cords = match &junction.sum.total_cord {
            Some(total_cord) => IndexSet::from([total_cord.clone()]),
            None => self.driving_cords(junction),
        };
        for (index, cord) in cords.into_iter().enumerate() {
            let input = (InputRole::In.word().to_owned(), cord.from.clone());
            let instance = match index {
                0 => self.instance.clone(),
                _ => format!("{}-{}", self.instance, index + 1),
            };
            if index == 0 {
                self.inputs.extend([input]);
            } else {
                let inputs = self.inputs.clone().into_iter().chain([input]).collect();
                self.further_instances.push((instance.clone(), inputs));
            }
            self.replug(&cord.to, &cord.from, &format!("{instance}.{}", OutputRole::Out.word()));
        }
    }

    /// Every cord that drives an integrator, including its brake. If a potentiometer drives only this integrator, the
    /// cord into the potentiometer counts: its setting is a rate of the integrator and must remain next to it.
    ///
    /// A cord occurs once, even if it drives several jacks.
    fn driving_cords(&self, junction: &Junction) -> IndexSet<TotalCord> {
        let cords = self.patch.written_cords(&junction.integrator);
        let driving = cords.filter(|(jack, _)| jack.starts_with('x') || jack.starts_with("brake_x"));
        let cord = |from: &str, to: &str| TotalCord { from: from.to_owned(), to: to.to_owned() };
        let cords = driving.map(|(_, from)| {
            let is_pot = self.patch.elements.get(from).is_some_and(|entry| entry.kind.name == "pot");
            let pot_inputs: Vec<&str> = match is_pot && !self.drives_other(from, &junction.integrator) {
                true => self.patch.written_cords(from).map(|(_, pot_input)| pot_input).collect(),
                false => Vec::new(),
            };
            match pot_inputs.as_slice() {
                [pot_input] => cord(pot_input, from),
                _ => cord(from, &junction.integrator),
            }
        });
        cords.collect()
    }

    /// Whether the output `from` drives an element or an instance other than `to`.
    fn drives_other(&self, from: &str, to: &str) -> bool {
        let others = self.patch.elements.iter().filter(|(name, _)| *name != to);
        let mut plugs = others.flat_map(|(_, entry)| &entry.plugs);
        let mut instance_inputs = self.patch.instances.values().flat_map(|instance| instance.inputs.values());
        plugs.any(|plug| plug.from.value == from)
            || instance_inputs.any(|input| input.driver.as_deref() == Some(from))
    }

    /// Inserts the fragment into all cords of an output, to elements and to instances of macros.
    fn insert_into_cords(&mut self, signal: &ScaledSignal) {
        self.inputs.insert(InputRole::In.word().to_owned(), signal.element.clone());
        let (patch, out) = (self.patch, self.port(OutputRole::Out));
        let is_outside_macros = |name: &str| !name.contains('.');
        for (name, entry) in patch.elements.iter().filter(|(name, _)| is_outside_macros(name)) {
            if entry.plugs.iter().any(|plug| plug.from.value == signal.element) {
                self.replug(name, &signal.element, &out);
            }
        }
        for (name, instance) in patch.instances.iter().filter(|(name, _)| is_outside_macros(name)) {
            if instance.inputs.values().any(|input| input.driver.as_ref() == Some(&signal.element)) {
                self.replug(name, &signal.element, &out);
            }
        }
    }

    /// Replaces the output `from` by `to` in the cords of an element or instance.
    fn replug(&mut self, element: &str, from: &str, to: &str) {
        let [element, from, to] = [element, from, to].map(str::to_owned);
        self.rewirings.push(Rewiring::Replace { element, from, to });
    }

    /// Edits the patch. The order of the edits determines the order of states, parameters and sums.
    fn finish(mut self) -> Result<Graft, EditError> {
        let form = self.placement.form;
        for (gain, formula) in &form.gains {
            let largest = self.largest(formula);
            self.renames.insert(gain.clone(), format!("{}", power_of_ten_above(largest)));
        }
        let mut drives = Vec::new();
        for (name, drive) in &form.drives {
            let name_in_patch = format!("{}-{name}", self.instance);
            self.renames.insert(name.clone(), name_in_patch.clone());
            drives.push((name_in_patch, drive));
        }
        let macro_name = unused_hyphenated_name(&self.placement.effect.name, |name| {
            self.patch.macros.contains_key(name) || elements::find(Family::Computing, name).is_some()
        });
        let mut editor = self.patch.edit();
        if !self.patch.equations.is_empty() {
            // With the effect, the wiring solves other equations.
            editor.set_equations([] as [&str; 0]);
        }
        self.put_elements(&macro_name, &mut editor)?;
        for (name, per_volt, unit) in &self.scales {
            editor.put_scale(name, per_volt.clone(), unit);
        }
        for (name, drive) in drives {
            match self.renamed_value(drive) {
                Value::Object(entry) => editor.put_drive(&name, ElementBuilder::from_entry(entry)),
                // Reading the text reports the wrong type.
                other => editor.put(["drives", name.as_str()], other),
            }
        }
        editor.set_machine("unlimited");
        let initial_states: Vec<String> =
            form.free_states.iter().map(|state| self.initial_parameter(state)).collect();
        for (state, name) in form.free_states.iter().zip(&initial_states) {
            let limit = |end: &str, default| form.elements[state]["limit"][end].as_f64().unwrap_or(default);
            let range = [limit("lower", -REFERENCE), limit("upper", REFERENCE)];
            let initial = ParameterBuilder::new(0, "1").range(range).description("initial voltage");
            editor.put_parameter(name, initial);
        }
        let patch = editor.finish(self.patch.file())?;
        Ok(Graft { patch, parameters: self.parameters, initial_states })
    }

    /// Adds the parameters, the macro, its instances and the new elements, and changes cords.
    fn put_elements(&self, macro_name: &str, editor: &mut PatchEditor) -> Result<(), EditError> {
        let effect = self.placement.effect;
        for added in &self.parameters {
            let parameter = ParameterBuilder::new(added.value, &added.unit).range(added.range);
            let description = &effect.parameters[&added.name_in_effect].description;
            editor.put_parameter(&added.name, parameter.description(description));
        }
        if self.needs_record_start() {
            let start = ParameterBuilder::new(0, "s").description("start of the record in its file");
            editor.put_parameter(RECORD_START, start);
        }
        editor.put_macro(macro_name, MacroBuilder::from_entry(self.macro_definition()));
        let further = self.further_instances.iter().map(|(name, inputs)| (name, inputs));
        for (name, inputs) in [(&self.instance, &self.inputs)].into_iter().chain(further) {
            let instance = ElementBuilder::new(macro_name);
            let instance = inputs.iter().fold(instance, |instance, (port, from)| instance.cord(port, from));
            editor.put_element(name, instance.set("note", effect.title.as_str()));
        }
        for (name, element) in &self.elements {
            editor.put_element(name, element.clone());
        }
        self.rewirings.iter().try_for_each(|rewiring| rewiring.apply(editor))
    }
}
