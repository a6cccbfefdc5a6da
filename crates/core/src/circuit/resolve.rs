//! Makes the circuit from the patch: builds the graph, runs all checks and collects their diagnostics.
//!
//! All checks run, also after errors. A check stays silent about a fault that follows from an earlier one, such as a
//! missing cord next to a cord with a wrong name.
//!
//! The nodes of the graph are the references, the drives and the elements, in this order. Other modules rely on it: the
//! index of a node is the index of the element in the circuit.

use std::collections::{HashMap, HashSet};

use petgraph::graph::{DiGraph, NodeIndex};

use super::names::{found_or_report, output_names};
use super::scope::Quantities;
use super::{Circuit, Cord, Element, equations, inventory, loops, macros, names, phases, settings, signals};
use crate::document::{Code, Diagnostic, Placed, Report, Span, any_error, factor_violation, suggestion};
use crate::elements::{Input, Jacks, REFERENCE, REFERENCES, misplaced_key_hint};
use crate::machines::{self, MachineModel};
use crate::patch::{
    Amount, ElementEntry, OpenInput, Patch, Plug, cord_hint, cord_notation, fixed_voltage_hint, no_cord,
    open_inputs, outputs_tied,
};
use patchcord_expr::{Formula, nearest};

/// The elements with the cords between them. An edge goes from the driver to the driven element.
pub(super) type Graph = DiGraph<Element, Cord>;

/// Makes a circuit from a patch, with parameters changed by `changes`.
///
/// # Errors
/// If any check finds an error. For an edited patch the checks run again on its text, so the report has positions.
///
/// The order of the checks follows their needs. Units can be checked only if the quantities are known, and pots in
/// front of integrators only if the cords are in the graph.
pub(super) fn resolve(patch: &Patch, changes: &[(String, f64)]) -> Result<Circuit, Box<Report>> {
    let mut findings = patch.findings().to_vec();
    names::check(patch, &mut findings);
    let machine = machine(patch, &mut findings);
    let quantities = Quantities::new(patch, changes, &mut findings);
    let graph = graph(patch, machine, &mut findings);
    let cords = if any_error(&findings) { settings::Cords::Incomplete } else { settings::Cords::Complete };
    settings::check(patch, &quantities, &graph, cords, &mut findings);
    let parts = inventory::check(patch, machine, &mut findings);
    phases::check(patch, &quantities, &mut findings);
    let (points, record) = signals::resolve(patch, &graph, &mut findings);
    let auxiliaries = equations::check(patch, &mut findings);
    let evaluation_order = loops::evaluation_order(&graph);
    // With errors, an unused element is often one whose cord has a wrong name, so it gets no warning.
    if !any_error(&findings) {
        warn_of_unused(patch, &graph, &mut findings);
    }
    let findings = macros::merge_instances(patch, findings);
    if any_error(&findings) {
        // Edited values have no positions, so the report is made from the text.
        return match patch.reread() {
            Some(read) => resolve(&read?, changes),
            None => Err(Box::new(Report::new(patch.file(), patch.text(), findings))),
        };
    }
    Ok(Circuit {
        patch: patch.clone(),
        changes: changes.to_vec(),
        machine,
        quantities,
        graph,
        evaluation_order,
        signals: points,
        record,
        auxiliaries,
        parts,
        warnings: findings,
    })
}

/// The machine of the patch. Reports an unknown name and continues with the default machine.
fn machine(patch: &Patch, findings: &mut Vec<Diagnostic>) -> &'static MachineModel {
    let Some(name) = &patch.machine else { return machines::DEFAULT_MACHINE };
    machines::find(&name.value).unwrap_or_else(|| {
        let known: Vec<_> = machines::ALL.iter().map(|machine| machine.name).collect();
        let message = format!("there is no machine \"{}\"", name.value);
        findings.push(
            Diagnostic::at(Code::UNKNOWN_MACHINE, name.span, message)
                .maybe_hint(suggestion(&name.value, &known)),
        );
        machines::DEFAULT_MACHINE
    })
}

/// Builds the graph: references, drives and elements, then their cords. Reports faults of the cords.
///
/// Drives have no inputs, so only elements have cords.
fn graph(patch: &Patch, machine: &MachineModel, findings: &mut Vec<Diagnostic>) -> Graph {
    let mut graph = Graph::new();
    let mut nodes = HashMap::new();
    for (name, volts) in REFERENCES {
        nodes.insert(*name, graph.add_node(reference(name, *volts)));
    }
    for (name, entry) in patch.drives.iter().chain(&patch.elements) {
        nodes.insert(name.as_str(), graph.add_node(element(patch, name, entry, findings)));
    }
    for (name, entry) in &patch.elements {
        let plugger = CordPlugger { patch, name, entry, machine, nodes: &nodes };
        plugger.plug_in(&mut graph, findings);
    }
    graph
}

/// A reference with its voltage.
fn reference(name: &str, volts: f64) -> Element {
    let volts = Placed { value: Amount::Formula(Formula::constant(volts)), span: Span::default() };
    Element { name: name.to_owned(), kind: &REFERENCE, settings: vec![Some(volts)], scale: None, span: None }
}

/// An element or drive. Reports an unknown scale.
fn element(patch: &Patch, name: &str, entry: &ElementEntry, findings: &mut Vec<Diagnostic>) -> Element {
    let scale = entry.scale.as_ref().and_then(|scale| find_scale(patch, scale, findings));
    Element {
        name: name.to_owned(),
        kind: entry.kind,
        settings: entry.settings.clone(),
        scale,
        span: Some(entry.span),
    }
}

/// The index of the scale with this name. Reports an unknown name.
pub(super) fn find_scale(
    patch: &Patch,
    name: &Placed<String>,
    findings: &mut Vec<Diagnostic>,
) -> Option<usize> {
    let message = || format!("there is no scale {}", name.value);
    let found = patch.scales.get_index_of(&name.value);
    found_or_report(
        patch,
        name,
        found,
        message,
        || patch.scales.keys().map(String::as_str).collect(),
        findings,
    )
}

/// Plugs in the cords of one element.
struct CordPlugger<'a> {
    /// The patch, for the names that cords may use.
    patch: &'a Patch,
    /// Name of the element.
    name: &'a str,
    /// The element in the patch, with its kind and cords.
    entry: &'a ElementEntry,
    /// The machine, for its input gains.
    machine: &'a MachineModel,
    /// The nodes of all references, drives and elements by name.
    nodes: &'a HashMap<&'a str, NodeIndex>,
}

impl CordPlugger<'_> {
    /// Adds all cords of the element to the graph. Reports wrong jacks, unknown drivers, and inputs with too many or
    /// too few cords. Cords of one jack have the same span, so they are grouped by it.
    fn plug_in(&self, graph: &mut Graph, findings: &mut Vec<Diagnostic>) {
        let mut plugged = vec![Vec::new(); self.entry.kind.inputs.len()];
        for plugs in self.entry.plugs.chunk_by(|one, next| one.jack.span == next.jack.span) {
            if let Some((input, gain)) = self.jack(&plugs[0].jack, Some(&plugs[0].from.value), findings) {
                self.connect(plugs, Cord { input, gain }, graph, findings);
                plugged[input].extend(plugs);
            }
        }
        for jack in &self.entry.empty_jacks {
            self.jack(jack, None, findings);
        }
        let open_inputs = open_inputs(self.entry);
        for (input, plugs) in plugged.iter().enumerate() {
            self.check_max_cords(input, plugs, findings);
            let open_input = open_inputs.iter().find(|open_input| open_input.input == input);
            findings.extend(open_input.map(|open_input| self.too_few_cords(open_input)));
        }
    }

    /// Adds the cords of one jack to the graph.
    ///
    /// A cord from an unknown element is reported and left out.
    fn connect(&self, plugs: &[Plug], cord: Cord, graph: &mut Graph, findings: &mut Vec<Diagnostic>) {
        for plug in plugs {
            if let Some(from) = self.driver(plug, findings) {
                graph.add_edge(from, self.nodes[self.name], cord);
            }
        }
    }

    /// The index of the input and the gain of a jack. Reports a jack or a gain that does not exist.
    ///
    /// The name of a jack with a gain consists of the input and the gain, such as "x10". Its gain is 10. `source` is
    /// what is plugged into the jack.
    fn jack(
        &self,
        jack: &Placed<String>,
        source: Option<&str>,
        findings: &mut Vec<Diagnostic>,
    ) -> Option<(usize, f64)> {
        let kind = self.entry.kind;
        let found = kind.input(&jack.value);
        match found {
            None => findings.push(self.unknown_jack(jack, source)),
            Some((_, gain)) => self.check_gain(jack, gain, findings),
        }
        found
    }

    /// The diagnostic for a jack that the kind does not have.
    ///
    /// The hint names a jack that was probably meant, or lists the jacks of the kind.
    fn unknown_jack(&self, jack: &Placed<String>, source: Option<&str>) -> Diagnostic {
        let (kind, written) = (self.entry.kind, jack.value.as_str());
        let message = format!("{} (kind {}) has no input \"{written}\"", self.name, kind.name);
        let similar = kind.similar_jack(written).map(|similar| format!("did you mean \"{similar}\"?"));
        let jacks: Vec<_> = kind.inputs.iter().map(jack_names).collect();
        let hint = match similar.or_else(|| self.jack_with_gain_hint(written, source)) {
            Some(hint) => hint,
            None if jacks.is_empty() => "it has no inputs".to_owned(),
            None => format!("it has {}", jacks.join(", ")),
        };
        Diagnostic::at(Code::UNKNOWN_INPUT, jack.span, message).hint(hint)
    }

    /// The hint for a key in "in" of an element whose inputs have gains: a source that is exchanged with its jack, an
    /// output without a jack, a key that belongs next to "in", or a misspelled jack without a gain. `None` for other
    /// names.
    fn jack_with_gain_hint(&self, written: &str, source: Option<&str>) -> Option<String> {
        let kind = self.entry.kind;
        if !kind.has_gains() {
            return None;
        }
        let as_jack = |source: &str| match kind.input(source) {
            Some(_) => Some(source.to_owned()),
            None => kind.similar_jack(source),
        };
        if let Some(jack) = source.filter(|source| !self.is_output(source)).and_then(as_jack) {
            return Some(format!("write \"{jack}\": [\"{written}\"]"));
        }
        if self.is_output(written) {
            return Some(format!("the gain is in the name of an input: write \"x1\": [\"{written}\"]"));
        }
        let similar = || {
            let without_gain = kind.inputs.iter().filter(|input| input.jacks != Jacks::Gains);
            nearest(written, without_gain.map(|input| input.name))
        };
        misplaced_key_hint(kind, written)
            .or_else(|| similar().map(|similar| format!("did you mean \"{similar}\"?")))
    }

    /// Whether the patch has an output with this name.
    fn is_output(&self, name: &str) -> bool {
        self.nodes.contains_key(name) || self.patch.instance_outputs.contains_key(name)
    }

    /// Reports a gain outside the limits of all gains, or one that the machine does not have for this kind.
    ///
    /// The machine without limits permits every other gain, so its lists of gains are empty.
    fn check_gain(&self, jack: &Placed<String>, gain: f64, findings: &mut Vec<Diagnostic>) {
        let what = format!("an input gain of {}", self.name);
        if let Some(finding) = factor_violation(&what, Placed { value: gain, span: jack.span }) {
            return findings.push(finding);
        }
        let gains = self.entry.kind.available_gains(self.machine);
        if gains.is_empty() || gains.contains(&gain) {
            return;
        }
        let known: Vec<_> = gains.iter().map(|gain| format!("x{gain}")).collect();
        let (name, kind, machine) = (&self.name, self.entry.kind.name, self.machine.name);
        let message =
            format!("{name} has an input gain x{gain}, but no {kind} of the {machine} has this gain");
        let hint = format!("the gains are {}: use one of them with a pot in front", known.join(", "));
        findings.push(Diagnostic::at(Code::MISSING_GAIN, jack.span, message).hint(hint));
    }

    /// The node that drives a cord. Reports an unknown name.
    ///
    /// The hint is chosen among the names of all outputs, including those of macros' instances.
    fn driver(&self, plug: &Plug, findings: &mut Vec<Diagnostic>) -> Option<NodeIndex> {
        let message = || format!("{} is driven by {}, which is not in the patch", self.name, plug.from.value);
        let found = self.nodes.get(plug.from.value.as_str()).copied();
        if found.is_none()
            && let Some(hint) = self.source_hint(&plug.from.value)
        {
            findings.push(Diagnostic::at(Code::UNKNOWN_NAME, plug.from.span, message()).hint(hint));
            return None;
        }
        let known = || output_names(self.patch, self.nodes);
        found_or_report(self.patch, &plug.from, found, message, known, findings)
    }

    /// The hint for a cord from a negative output, or from a fixed voltage under another name. `None` for other names.
    fn source_hint(&self, name: &str) -> Option<String> {
        let outputs =
            self.nodes.keys().copied().chain(self.patch.instance_outputs.keys().map(String::as_str));
        // A name can also mean an output that could not be read.
        let is_unread = || self.patch.unread_names().can_include(name);
        let fixed_voltage = || fixed_voltage_hint(name, outputs).filter(|_| !is_unread());
        self.inversion_hint(name).or_else(fixed_voltage)
    }

    /// The hint for a cord from a negative output, such as "-A1". `None` if the name does not mean this.
    fn inversion_hint(&self, name: &str) -> Option<String> {
        let output = name.strip_prefix('-')?.trim_start();
        self.is_output(output).then(|| {
            format!("a cord does not invert: plug in an \"inverter\" that has the cord \"in\": \"{output}\"")
        })
    }

    /// Reports an input with more cords than it can take.
    ///
    /// The report is at the first cord that is too many.
    fn check_max_cords(&self, input: usize, plugs: &[&Plug], findings: &mut Vec<Diagnostic>) {
        let allowed = match self.entry.kind.inputs[input].jacks {
            Jacks::One => 1,
            Jacks::Exactly(count) => count,
            Jacks::Any | Jacks::Gains => usize::MAX,
        };
        if let Some(extra) = plugs.get(allowed) {
            findings.push(self.too_many_cords(input, plugs, extra));
        }
    }

    /// The diagnostic for an input with fewer cords than it needs.
    fn too_few_cords(&self, open_input: &OpenInput<'_>) -> Diagnostic {
        let OpenInput { input, count, least, first_cord, empty_jack } = open_input;
        let row = &self.entry.kind.inputs[*input];
        let span = first_cord.or(*empty_jack).map_or(self.entry.span, |placed| placed.span);
        let jacks = jack_names(row);
        let hint = cord_hint(&cord_notation(self.entry.kind, row), row.description);
        if *count == 0 {
            return no_cord(self.name, &jacks, hint, span);
        }
        let message = format!("{jacks} of {} needs {least} cords and has {count}", self.name);
        Diagnostic::at(Code::NO_DRIVER, span, message).hint(hint)
    }

    /// The diagnostic for more cords than an input can take. `extra` is the first of the surplus cords.
    fn too_many_cords(&self, input: usize, plugs: &[&Plug], extra: &Plug) -> Diagnostic {
        let row = &self.entry.kind.inputs[input];
        if let Jacks::Exactly(count) = row.jacks {
            let message = format!("{} takes {count} cords and has {}", self.name, plugs.len());
            return Diagnostic::at(Code::TOO_MANY_INPUTS, extra.from.span, message)
                .hint("use a second element for the others");
        }
        outputs_tied(self.name, row.name, &plugs[0].from, &extra.from)
    }
}

/// The jacks of an input for messages: "x1, x10, ..." or the quoted name.
fn jack_names(input: &Input) -> String {
    if input.jacks == Jacks::Gains { input.jack_text() } else { format!("\"{}\"", input.name) }
}

/// Warns of elements whose output is not used, recorded or drawn.
///
/// Outputs of a macro's instance may remain unused if at least one output of the instance is used.
fn warn_of_unused(patch: &Patch, graph: &Graph, findings: &mut Vec<Diagnostic>) {
    let named = read_by_name(patch);
    let outputs = macros::outputs(patch);
    for index in graph.node_indices() {
        let element = &graph[index];
        let Some(span) = element.span else { continue };
        let name = element.name.as_str();
        let is_read = graph.neighbors(index).next().is_some() || named.contains(name);
        if !is_read && !outputs.contains(name) {
            findings.push(unused_output(name, span));
        }
    }
    for (name, span) in macros::unused_instances(patch, graph, &named) {
        findings.push(unused_output(name, span));
    }
}

/// The names of the outputs that signals, the record, pictures and phases read.
pub(super) fn read_by_name(patch: &Patch) -> HashSet<&str> {
    let read_by_signals = patch.signals.values().map(|signal| &signal.element);
    let drawn = patch.pictures.iter().flat_map(|picture| picture.y.iter().chain([&picture.x]));
    let named = read_by_signals.chain(&patch.record).chain(drawn).map(|name| name.value.as_str());
    named.chain(phases::relays(patch)).collect()
}

/// The warning about an element or an instance that is not used.
fn unused_output(name: &str, span: Span) -> Diagnostic {
    Diagnostic::at(Code::UNUSED_ELEMENT, span, format!("nothing uses the output of {name}"))
        .hint("define a signal at it, plug it in, or remove it")
}

#[cfg(test)]
mod tests {
    use crate::circuit::Circuit;
    use crate::document::Code;
    use crate::patch::Patch;

    /// The codes of the warnings about a patch in which no cord leaves the summer S and the drive D.
    fn warnings_with(section: &str) -> Vec<Code> {
        let text = format!(
            r#"{{"patchcord": 1, "scales": {{"volt": {{"per_volt": 1, "unit": "V"}}}},
                "drives": {{"D": {{"kind": "step", "height": 1, "scale": "volt"}},
                           "E": {{"kind": "step", "height": 1, "scale": "volt"}}}},
                "elements": {{"S": {{"kind": "summer", "in": {{"x1": ["E"]}}}}}}, {section}}}"#
        );
        let circuit = Circuit::new(&Patch::parse("p.json", &text).unwrap());
        circuit
            .unwrap_or_else(|report| panic!("{report}"))
            .warnings()
            .findings
            .iter()
            .map(|finding| finding.code)
            .collect()
    }

    #[test]
    fn a_recorded_or_drawn_element_counts_as_used() {
        let drawn = r#""pictures": [{"x": "S", "y": ["D"]}]"#;
        assert_eq!(warnings_with(drawn), []);
        assert_eq!(warnings_with(r#""record": ["D", "S"]"#), [Code::UNSCALED_SIGNAL]);
        assert_eq!(warnings_with(r#""record": ["D"]"#), [Code::UNUSED_ELEMENT]);
        assert_eq!(warnings_with(r#""record": []"#), [Code::UNUSED_ELEMENT; 2]);
    }
}
