//! From the patch to the circuit, finding everything that is wrong on the way.

use std::collections::{HashMap, HashSet};

use petgraph::graph::{DiGraph, NodeIndex};

use super::names::{found_or_told, outlets};
use super::scope::Quantities;
use super::{Circuit, Cord, Element, inventory, loops, macros, names, phases, settings, signals};
use crate::document::{Code, Diagnostic, Placed, Report, Span, any_error, suggestion};
use crate::elements::{Input, Jacks, Kind, REFERENCE, REFERENCES, Transfer, gain_of};
use crate::machines::{self, Machine};
use crate::patch::{Amount, Entry, Patch, Plug};
use patchcord_expr::Formula;

pub(super) type Graph = DiGraph<Element, Cord>;

pub(super) fn circuit(patch: &Patch, changes: &[(String, f64)]) -> Result<Circuit, Box<Report>> {
    let mut findings = patch.findings().to_vec();
    names::check(patch, &mut findings);
    let machine = machine(patch, &mut findings);
    let quantities = Quantities::new(patch, changes, &mut findings);
    let graph = graph(patch, machine, &mut findings);
    let cords = if any_error(&findings) { settings::Cords::Doubtful } else { settings::Cords::Known };
    settings::check(patch, &quantities, &graph, cords, &mut findings);
    let used = inventory::check(patch, machine, &mut findings);
    phases::check(patch, &quantities, &mut findings);
    let (points, record) = signals::resolve(patch, &graph, &mut findings);
    let stages = loops::stages(&graph, &mut findings);
    // An element that nothing reads is often the other end of what was just reported.
    if !any_error(&findings) {
        unused(patch, &graph, &mut findings);
    }
    let findings = macros::once(patch, findings);
    if any_error(&findings) {
        // The parts of an edited patch have no positions: its text has.
        return match patch.reread() {
            Some(read) => circuit(&read?, changes),
            None => Err(Box::new(Report::new(patch.file(), patch.text(), findings))),
        };
    }
    Ok(Circuit {
        patch: patch.clone(),
        changes: changes.to_vec(),
        machine,
        quantities,
        graph,
        stages,
        signals: points,
        record,
        used,
        warnings: findings,
    })
}

fn machine(patch: &Patch, findings: &mut Vec<Diagnostic>) -> &'static Machine {
    let Some(name) = &patch.machine else { return machines::UNNAMED };
    machines::find(&name.value).unwrap_or_else(|| {
        let known: Vec<_> = machines::ALL.iter().map(|machine| machine.name).collect();
        let message = format!("there is no machine \"{}\"", name.value);
        findings.push(
            Diagnostic::at(Code::UnknownMachine, name.span, message)
                .maybe_hint(suggestion(&name.value, &known)),
        );
        machines::UNNAMED
    })
}

/// References, drives and elements with their cords.
fn graph(patch: &Patch, machine: &Machine, findings: &mut Vec<Diagnostic>) -> Graph {
    let mut graph = Graph::new();
    let mut places = HashMap::new();
    for (name, volts) in REFERENCES {
        places.insert(*name, graph.add_node(reference(name, *volts)));
    }
    for (name, entry) in patch.drives.iter().chain(&patch.elements) {
        places.insert(name.as_str(), graph.add_node(element(patch, name, entry, findings)));
    }
    for (name, entry) in &patch.elements {
        let cords = Cords { patch, name, entry, machine, places: &places };
        cords.plug_in(&mut graph, findings);
    }
    graph
}

fn reference(name: &str, volts: f64) -> Element {
    let volts = Placed { value: Amount::Formula(Formula::constant(volts)), span: Span::default() };
    Element { name: name.to_owned(), kind: &REFERENCE, settings: vec![Some(volts)], scale: None, span: None }
}

fn element(patch: &Patch, name: &str, entry: &Entry, findings: &mut Vec<Diagnostic>) -> Element {
    let scale = entry.scale.as_ref().and_then(|scale| find_scale(patch, scale, findings));
    Element {
        name: name.to_owned(),
        kind: entry.kind,
        settings: entry.settings.clone(),
        scale,
        span: Some(entry.span),
    }
}

/// The index of a scale by its name as written.
pub(super) fn find_scale(
    patch: &Patch,
    name: &Placed<String>,
    findings: &mut Vec<Diagnostic>,
) -> Option<usize> {
    let message = || format!("there is no scale {}", name.value);
    let found = patch.scales.get_index_of(&name.value);
    found_or_told(patch, name, found, message, || patch.scales.keys().map(String::as_str).collect(), findings)
}

/// The cords of one element.
struct Cords<'a> {
    patch: &'a Patch,
    name: &'a str,
    entry: &'a Entry,
    machine: &'a Machine,
    places: &'a HashMap<&'a str, NodeIndex>,
}

impl Cords<'_> {
    fn plug_in(&self, graph: &mut Graph, findings: &mut Vec<Diagnostic>) {
        let inputs = self.entry.kind.inputs.len();
        let (mut plugged, mut empty) = (vec![Vec::new(); inputs], vec![None; inputs]);
        // A cord that could not be understood may be the one that an input lacks.
        let mut doubtful = self.entry.doubtful;
        for plugs in self.entry.plugs.chunk_by(|one, next| one.jack.span == next.jack.span) {
            match self.jack(&plugs[0].jack, findings) {
                Some((input, gain)) => {
                    self.connect(plugs, Cord { input, gain }, graph, findings);
                    plugged[input].extend(plugs);
                }
                None => doubtful = true,
            }
        }
        for jack in &self.entry.empty_jacks {
            match self.jack(jack, findings) {
                Some((input, _)) => empty[input] = Some(jack.span),
                None => doubtful = true,
            }
        }
        for (input, plugs) in plugged.iter().enumerate() {
            self.not_too_many(input, plugs, findings);
            if !doubtful {
                self.enough(input, plugs, empty[input], findings);
            }
        }
    }

    /// Plugs in the cords of one jack.
    fn connect(&self, plugs: &[Plug], cord: Cord, graph: &mut Graph, findings: &mut Vec<Diagnostic>) {
        for plug in plugs {
            if let Some(from) = self.driver(plug, findings) {
                graph.add_edge(from, self.places[self.name], cord);
            }
        }
    }

    /// The input and gain of a jack by its name.
    fn jack(&self, jack: &Placed<String>, findings: &mut Vec<Diagnostic>) -> Option<(usize, f64)> {
        let kind = self.entry.kind;
        let found = kind.input(&jack.value);
        match found {
            None => findings.push(self.unknown_jack(jack)),
            Some((_, gain)) => self.gain(jack, gain, findings),
        }
        found
    }

    fn unknown_jack(&self, jack: &Placed<String>) -> Diagnostic {
        let message =
            format!("{} (kind {}) has no input \"{}\"", self.name, self.entry.kind.name, jack.value);
        let meant = self.entry.kind.inputs.iter().find_map(|input| meant_jack(input, &jack.value));
        let jacks: Vec<_> =
            self.entry.kind.inputs.iter().map(|input| jack_names(input.name, input.jacks)).collect();
        let hint = match meant {
            Some(meant) => format!("did you mean \"{meant}\"?"),
            None if jacks.is_empty() => "it has none".to_owned(),
            None => format!("it has {}", jacks.join(", ")),
        };
        Diagnostic::at(Code::UnknownInput, jack.span, message).hint(hint)
    }

    fn gain(&self, jack: &Placed<String>, gain: f64, findings: &mut Vec<Diagnostic>) {
        let gains = gains(self.machine, self.entry.kind);
        if gains.is_empty() || gains.contains(&gain) {
            return;
        }
        let known: Vec<_> = gains.iter().map(|gain| format!("x{gain}")).collect();
        let (name, kind, machine) = (&self.name, self.entry.kind.name, self.machine.name);
        let message = format!("{name} has an input gain x{gain}, as no {kind} of the {machine} has");
        let hint = format!("it has {}: put a pot in front of one of these", known.join(", "));
        findings.push(Diagnostic::at(Code::MissingGain, jack.span, message).hint(hint));
    }

    fn driver(&self, plug: &Plug, findings: &mut Vec<Diagnostic>) -> Option<NodeIndex> {
        let message = || format!("{} is driven by {}, which is not in the patch", self.name, plug.from.value);
        let found = self.places.get(plug.from.value.as_str()).copied();
        let known = || outlets(self.patch, self.places);
        found_or_told(self.patch, &plug.from, found, message, known, findings)
    }

    /// Reports cords for which an input has no jacks.
    fn not_too_many(&self, input: usize, plugs: &[&Plug], findings: &mut Vec<Diagnostic>) {
        let allowed = match self.entry.kind.inputs[input].jacks {
            Jacks::One => 1,
            Jacks::Exactly(count) => count,
            Jacks::Any | Jacks::Gains => usize::MAX,
        };
        if let Some(extra) = plugs.get(allowed) {
            findings.push(self.too_many(input, plugs, extra));
        }
    }

    /// Reports an input that lacks cords.
    fn enough(&self, input: usize, plugs: &[&Plug], empty: Option<Span>, findings: &mut Vec<Diagnostic>) {
        let row = &self.entry.kind.inputs[input];
        let least = if let Jacks::Exactly(count) = row.jacks { count } else { 1 };
        if (row.required || empty.is_some()) && plugs.len() < least {
            let span = plugs.first().map(|plug| plug.from.span).or(empty).unwrap_or(self.entry.span);
            let what = jack_names(row.name, row.jacks);
            let message = match plugs.len() {
                0 => format!("nothing drives {} of {}", what, self.name),
                some => format!("{} of {} needs {least} cords and has {some}", what, self.name),
            };
            let hint = format!("{}; use \"ground\" for 0 V", row.description);
            findings.push(Diagnostic::at(Code::NoDriver, span, message).hint(hint));
        }
    }

    fn too_many(&self, input: usize, plugs: &[&Plug], extra: &Plug) -> Diagnostic {
        let row = &self.entry.kind.inputs[input];
        if let Jacks::Exactly(count) = row.jacks {
            let message = format!("{} takes {count} cords and is given {}", self.name, plugs.len());
            return Diagnostic::at(Code::TooManyInputs, extra.from.span, message)
                .hint("use a second element for the others");
        }
        let (first, second) = (&plugs[0].from.value, &extra.from.value);
        let message =
            format!("the outputs of {first} and {second} are tied together at {} of {}", row.name, self.name);
        Diagnostic::at(Code::OutputsTied, extra.from.span, message)
            .hint("add them in a summer, and plug in its output")
    }
}

/// The jack with a gain that is written in capitals, or by its gain alone.
fn meant_jack(input: &Input, written: &str) -> Option<String> {
    let small = written.to_lowercase();
    let tried = [small.clone(), format!("{}{small}", input.name)];
    tried.into_iter().find(|jack| input.jacks == Jacks::Gains && gain_of(input.name, jack).is_some())
}

fn jack_names(name: &str, jacks: Jacks) -> String {
    if jacks == Jacks::Gains { format!("{name}1, {name}10, ...") } else { format!("\"{name}\"") }
}

fn gains(machine: &Machine, kind: &Kind) -> &'static [f64] {
    if kind.transfer == Transfer::Integrating { machine.integrator_gains } else { machine.summer_gains }
}

/// Warns of elements whose output nothing reads, records or draws. Outputs of macros may be left open, as long as
/// one of the instance is read.
fn unused(patch: &Patch, graph: &Graph, findings: &mut Vec<Diagnostic>) {
    let read_at = patch.signals.values().map(|signal| &signal.at);
    let drawn = patch.pictures.iter().flat_map(|picture| picture.y.iter().chain([&picture.x]));
    let named = read_at.chain(&patch.record).chain(drawn).map(|name| name.value.as_str());
    let named: HashSet<&str> = named.chain(phases::relays(patch)).collect();
    let outputs = macros::outputs(patch);
    for index in graph.node_indices() {
        let element = &graph[index];
        let Some(span) = element.span else { continue };
        let name = element.name.as_str();
        let is_read = graph.neighbors(index).next().is_some() || named.contains(name);
        if !is_read && !outputs.contains(name) {
            findings.push(unread(name, span));
        }
    }
    for (name, span) in macros::unread(patch, graph, &named) {
        findings.push(unread(name, span));
    }
}

fn unread(name: &str, span: Span) -> Diagnostic {
    Diagnostic::at(Code::UnusedElement, span, format!("nothing reads {name}"))
        .hint("name a signal at it, plug it in somewhere, or leave it out")
}

#[cfg(test)]
mod tests {
    use crate::circuit::Circuit;
    use crate::document::Code;
    use crate::patch::Patch;

    /// The codes of what is said of a summer and a drive that no cord leaves.
    fn told_of(asked: &str) -> Vec<Code> {
        let text = format!(
            r#"{{"patchcord": 1, "scales": {{"volt": {{"per_volt": 1, "unit": "V"}}}},
                "drives": {{"D": {{"kind": "step", "height": 1, "scale": "volt"}},
                           "E": {{"kind": "step", "height": 1, "scale": "volt"}}}},
                "elements": {{"S": {{"kind": "summer", "in": {{"x1": ["E"]}}}}}}, {asked}}}"#
        );
        let circuit = Circuit::new(&Patch::parse("p.json", &text).unwrap(), &[]);
        circuit
            .unwrap_or_else(|report| panic!("{report}"))
            .warnings()
            .findings
            .iter()
            .map(|f| f.code)
            .collect()
    }

    #[test]
    fn what_is_recorded_or_drawn_is_read() {
        let drawn = r#""pictures": [{"x": "S", "y": ["D"]}]"#;
        assert_eq!(told_of(drawn), []);
        assert_eq!(told_of(r#""record": ["D", "S"]"#), [Code::UnscaledSignal]);
        assert_eq!(told_of(r#""record": ["D"]"#), [Code::UnusedElement]);
        assert_eq!(told_of(r#""record": []"#), [Code::UnusedElement; 2]);
    }
}
