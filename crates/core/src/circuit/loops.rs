//! The order of working out voltages, and the loops that have no integrator in them.

use std::collections::HashSet;

use petgraph::algo::{kosaraju_scc, toposort};
use petgraph::graph::{DiGraph, NodeIndex};
use petgraph::visit::EdgeRef as _;

use super::Stage;
use super::resolve::Graph;
use crate::document::{Code, Diagnostic};
use crate::elements::Output;

type Plain = DiGraph<usize, ()>;

/// Loops inside loops that are opened one after the other; each one more multiplies the work of a step.
const DEEPEST: usize = 3;

/// Drivers before what they drive, members of a loop together.
pub(super) fn stages(graph: &Graph, findings: &mut Vec<Diagnostic>) -> Vec<Stage> {
    Opener { graph, findings }.ordered(&direct_cords(graph), 0)
}

/// The graph of cords through which a voltage acts within the same instant.
fn direct_cords(graph: &Graph) -> Plain {
    let is_direct = |edge: &petgraph::graph::EdgeReference<'_, super::Cord>| {
        graph[edge.target()].kind.inputs[edge.weight().input].direct
    };
    let mut direct = graph.map(|index, _| index.index(), |_, _| ());
    let keep: Vec<bool> = graph.edge_references().map(|edge| is_direct(&edge)).collect();
    direct.retain_edges(|_, edge| keep[edge.index()]);
    direct
}

struct Opener<'a> {
    graph: &'a Graph,
    findings: &'a mut Vec<Diagnostic>,
}

impl Opener<'_> {
    /// The elements of a part of the circuit in order, `depth` loops having been opened around it.
    fn ordered(&mut self, part: &Plain, depth: usize) -> Vec<Stage> {
        let components = kosaraju_scc(part);
        components.iter().rev().map(|members| self.stage(part, members, depth)).collect()
    }

    fn stage(&mut self, part: &Plain, members: &[NodeIndex], depth: usize) -> Stage {
        if members.len() == 1 && part.find_edge(members[0], members[0]).is_none() {
            return Stage::Element(part[members[0]]);
        }
        if depth == DEEPEST {
            self.findings.push(tangled(self.graph, members.iter().map(|index| part[*index])));
            return Stage::Element(part[members[0]]);
        }
        let opened = self.opened(part, members);
        let inside = without(part, members, opened);
        Stage::Loop { opened: part[opened], inside: self.ordered(&inside, depth + 1) }
    }

    /// The member that opens a loop: one that leaves no loop inside if there is one; open amplifiers, whose gain
    /// magnifies what is wrong with their inputs, before other amplifiers, and these before the rest.
    fn opened(&self, part: &Plain, members: &[NodeIndex]) -> NodeIndex {
        let element = |index: &NodeIndex| &self.graph[NodeIndex::new(part[*index])];
        let mut order = members.to_vec();
        let rank = |index: &NodeIndex| match element(index).kind.output {
            Output::OpenAmplifier => 0,
            Output::Amplifier | Output::Integrator => 1,
            Output::Passive => 2,
        };
        order.sort_by_key(|index| (rank(index), part[*index]));
        let opens_all = |index: &NodeIndex| toposort(&without(part, members, *index), None).is_ok();
        order.iter().copied().find(opens_all).unwrap_or(order[0])
    }
}

/// The members of a loop but one, and the cords between them.
fn without(part: &Plain, members: &[NodeIndex], opened: NodeIndex) -> Plain {
    let kept: HashSet<NodeIndex> = members.iter().copied().filter(|index| *index != opened).collect();
    part.filter_map(|index, element| kept.contains(&index).then_some(*element), |_, ()| Some(()))
}

fn tangled(graph: &Graph, members: impl Iterator<Item = usize>) -> Diagnostic {
    let mut members: Vec<usize> = members.collect();
    members.sort_unstable();
    let element = |member: &usize| &graph[NodeIndex::new(*member)];
    let names: Vec<_> = members.iter().map(|member| element(member).name.as_str()).collect();
    let message = format!(
        "the loops through {} have no integrator, and stay closed when {DEEPEST} elements are taken out",
        names.join(", ")
    );
    let span = members.iter().find_map(|member| element(member).span);
    let hint = Some("put an integrator or a lag into some of them".to_owned());
    Diagnostic { code: Code::LoopTooTangled, span, message, hint }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::circuit::Circuit;
    use crate::patch::{ElementBuilder, PatchBuilder};

    /// Summers that each read some of the others.
    fn stages_of(wiring: &[(&str, &[&str])]) -> Vec<Vec<String>> {
        let builder = wiring.iter().fold(PatchBuilder::new("loops"), |builder, (name, from)| {
            builder.element(name, ElementBuilder::new("summer").set("in", serde_json::json!({ "x1": from })))
        });
        let circuit =
            Circuit::new(&builder.build().unwrap(), &[]).unwrap_or_else(|report| panic!("{report}"));
        let named = |stage: &Stage| {
            stage.members().into_iter().map(|member| circuit.element(member).name.clone()).collect::<Vec<_>>()
        };
        circuit.stages().iter().map(named).filter(|names| names.len() > 1).collect()
    }

    #[test]
    fn drivers_come_before_what_they_drive() {
        assert!(stages_of(&[("A", &["B"]), ("B", &["C"]), ("C", &["+100"])]).is_empty());
    }

    #[test]
    fn a_ring_is_opened_at_its_first_amplifier() {
        let stages = stages_of(&[("A", &["C"]), ("B", &["A"]), ("C", &["B", "+100"])]);
        assert_eq!(stages, [["B", "C", "A"]]);
    }

    #[test]
    fn a_summer_in_two_rings_opens_both() {
        let stages = stages_of(&[("B", &["A"]), ("A", &["B", "C"]), ("C", &["A"])]);
        assert_eq!(stages[0].last().unwrap(), "A");
    }
}
