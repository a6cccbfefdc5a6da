//! Finds the order in which voltages are computed, and the loops without an integrator.
//!
//! Only direct cords count, whose voltage acts on the output at the same instant. A strongly connected component of
//! this graph is a loop, also called an algebraic loop. One of its members opens the loop: its output is an unknown
//! that the solver finds. If loops remain among the other members, they are opened in the same way, up to three deep.

use std::collections::HashSet;

use petgraph::algo::{kosaraju_scc, toposort};
use petgraph::graph::{DiGraph, NodeIndex};
use petgraph::visit::EdgeRef as _;

use super::EvaluationStep;
use super::resolve::Graph;
use crate::document::{Code, Diagnostic};
use crate::elements::OutputStage;

/// A graph of direct cords. The weight of a node is the index of its element in the circuit.
type DirectGraph = DiGraph<usize, ()>;

/// Number of loops that can be nested in each other. Each level multiplies the work of a step, because the inner loop
/// is solved again for every trial value of the outer one.
const MAX_LOOP_DEPTH: usize = 3;

/// The steps in order of evaluation: every element comes after the elements that drive it directly.
pub(super) fn evaluation_order(graph: &Graph, findings: &mut Vec<Diagnostic>) -> Vec<EvaluationStep> {
    LoopOpener { graph, findings }.ordered(&direct_graph(graph), 0)
}

/// The elements with the cords through which a voltage acts at the same instant.
fn direct_graph(graph: &Graph) -> DirectGraph {
    let is_direct = |edge: &petgraph::graph::EdgeReference<'_, super::Cord>| {
        graph[edge.target()].kind.inputs[edge.weight().input].direct
    };
    let mut direct = graph.map(|index, _| index.index(), |_, _| ());
    let direct_edges: Vec<bool> = graph.edge_references().map(|edge| is_direct(&edge)).collect();
    direct.retain_edges(|_, edge| direct_edges[edge.index()]);
    direct
}

/// Orders the elements and opens loops.
struct LoopOpener<'a> {
    /// The circuit, for the kinds and names of the elements.
    graph: &'a Graph,
    /// The diagnostics so far.
    findings: &'a mut Vec<Diagnostic>,
}

impl LoopOpener<'_> {
    /// The elements of a subgraph in order of evaluation. `depth` is the number of loops around the subgraph.
    fn ordered(&mut self, subgraph: &DirectGraph, depth: usize) -> Vec<EvaluationStep> {
        let components = kosaraju_scc(subgraph);
        components.iter().rev().map(|members| self.step(subgraph, members, depth)).collect()
    }

    /// The step for a strongly connected component. Reports a loop that is nested too deeply.
    fn step(&mut self, subgraph: &DirectGraph, members: &[NodeIndex], depth: usize) -> EvaluationStep {
        if members.len() == 1 && subgraph.find_edge(members[0], members[0]).is_none() {
            return EvaluationStep::Element(subgraph[members[0]]);
        }
        if depth == MAX_LOOP_DEPTH {
            self.findings.push(nested_too_deeply(self.graph, members.iter().map(|index| subgraph[*index])));
            return EvaluationStep::Element(subgraph[members[0]]);
        }
        let opener = self.opener(subgraph, members);
        let inner = without(subgraph, members, opener);
        EvaluationStep::Loop { opener: subgraph[opener], inner: self.ordered(&inner, depth + 1) }
    }

    /// The member that opens a loop.
    ///
    /// Members that leave no loop among the others are preferred. Among these, open amplifiers are preferred to other
    /// amplifiers, and amplifiers to passive elements: the gain of an open amplifier magnifies the errors of its
    /// inputs. Then the order of the document decides.
    fn opener(&self, subgraph: &DirectGraph, members: &[NodeIndex]) -> NodeIndex {
        let element = |index: &NodeIndex| &self.graph[NodeIndex::new(subgraph[*index])];
        let mut candidates = members.to_vec();
        let rank = |index: &NodeIndex| match element(index).kind.output {
            OutputStage::OpenAmplifier => 0,
            OutputStage::Amplifier | OutputStage::Integrator => 1,
            OutputStage::Passive => 2,
        };
        candidates.sort_by_key(|index| (rank(index), subgraph[*index]));
        let opens_all = |index: &NodeIndex| toposort(&without(subgraph, members, *index), None).is_ok();
        candidates.iter().copied().find(opens_all).unwrap_or(candidates[0])
    }
}

/// The members of a loop without the one that opens it, and the cords between them.
fn without(subgraph: &DirectGraph, members: &[NodeIndex], opener: NodeIndex) -> DirectGraph {
    let inner_members: HashSet<NodeIndex> =
        members.iter().copied().filter(|index| *index != opener).collect();
    subgraph.filter_map(|index, element| inner_members.contains(&index).then_some(*element), |_, ()| Some(()))
}

/// The diagnostic for loops that are nested more than [`MAX_LOOP_DEPTH`] deep.
fn nested_too_deeply(graph: &Graph, members: impl Iterator<Item = usize>) -> Diagnostic {
    let mut members: Vec<usize> = members.collect();
    members.sort_unstable();
    let element = |member: &usize| &graph[NodeIndex::new(*member)];
    let names: Vec<_> = members.iter().map(|member| element(member).name.as_str()).collect();
    let message = format!(
        "the loops through {} have no integrator, and a loop remains if {MAX_LOOP_DEPTH} elements are removed",
        names.join(", ")
    );
    let span = members.iter().find_map(|member| element(member).span);
    let hint = Some("put an integrator or a lag into some of them".to_owned());
    Diagnostic { code: Code::LOOP_TOO_TANGLED, span, message, hint }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::circuit::Circuit;
    use crate::patch::{ElementBuilder, PatchBuilder};

    /// Names of the members of each loop in a patch of summers. Each entry is a summer and the outputs that drive it.
    fn loops_of(wiring: &[(&str, &[&str])]) -> Vec<Vec<String>> {
        let builder = wiring.iter().fold(PatchBuilder::new("loops"), |builder, (name, from)| {
            builder.element(name, ElementBuilder::new("summer").cords("x1", *from))
        });
        let circuit = Circuit::new(&builder.build().unwrap()).unwrap_or_else(|report| panic!("{report}"));
        let names = |step: &EvaluationStep| {
            step.members().into_iter().map(|member| circuit.element(member).name.clone()).collect::<Vec<_>>()
        };
        circuit.evaluation_order().iter().map(names).filter(|names| names.len() > 1).collect()
    }

    #[test]
    fn a_chain_of_summers_has_no_loop() {
        assert!(loops_of(&[("A", &["B"]), ("B", &["C"]), ("C", &["+100"])]).is_empty());
    }

    #[test]
    fn the_first_amplifier_opens_a_loop() {
        let loops = loops_of(&[("A", &["C"]), ("B", &["A"]), ("C", &["B", "+100"])]);
        assert_eq!(loops, [["B", "C", "A"]]);
    }

    #[test]
    fn a_summer_in_two_loops_opens_both() {
        let loops = loops_of(&[("B", &["A"]), ("A", &["B", "C"]), ("C", &["A"])]);
        assert_eq!(loops[0].last().unwrap(), "A");
    }
}
