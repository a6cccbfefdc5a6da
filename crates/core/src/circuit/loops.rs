//! Finds the order in which voltages are computed, and the loops without an integrator.
//!
//! Only direct cords count, whose voltage acts on the output at the same instant. A strongly connected component of
//! this graph is a loop, also called an algebraic loop. It is opened at some of its members, whose outputs are unknowns
//! that the solver finds together. The others follow from them one after another.

use std::collections::HashSet;

use petgraph::Direction::Incoming;
use petgraph::algo::{kosaraju_scc, toposort};
use petgraph::graph::{DiGraph, NodeIndex};
use petgraph::visit::{EdgeFiltered, EdgeRef as _, NodeFiltered};

use super::EvaluationStep;
use super::resolve::Graph;
use crate::elements::OutputStage;

/// A graph of direct cords. A node has the index of its element in the circuit.
type DirectGraph = DiGraph<(), ()>;

/// Gain of an input from which on its element opens its loops. A chain of such elements would magnify the rounding of a
/// voltage, about 1e-14 V, beyond the accuracy of solutions.
const HIGH_GAIN: f64 = 50.0;

/// The steps in order of evaluation: every element comes after the elements that drive it directly.
pub(super) fn evaluation_order(graph: &Graph) -> Vec<EvaluationStep> {
    let direct = direct_graph(graph);
    let components = kosaraju_scc(&direct);
    components.iter().rev().map(|members| step(graph, &direct, members)).collect()
}

/// The elements with the cords through which a voltage acts at the same instant.
fn direct_graph(graph: &Graph) -> DirectGraph {
    let is_direct = |edge: &petgraph::graph::EdgeReference<'_, super::Cord>| {
        graph[edge.target()].kind.inputs[edge.weight().input].direct
    };
    let mut direct = graph.map(|_, _| (), |_, _| ());
    let direct_edges: Vec<bool> = graph.edge_references().map(|edge| is_direct(&edge)).collect();
    direct.retain_edges(|_, edge| direct_edges[edge.index()]);
    direct
}

/// The step for a strongly connected component.
fn step(graph: &Graph, direct: &DirectGraph, members: &[NodeIndex]) -> EvaluationStep {
    if let [member] = members
        && direct.find_edge(*member, *member).is_none()
    {
        return EvaluationStep::Element(member.index());
    }
    let openers = openers(graph, direct, members);
    let inside: HashSet<NodeIndex> = members.iter().copied().collect();
    let opened = EdgeFiltered::from_fn(direct, |edge| !openers.contains(&edge.source()));
    let opened = NodeFiltered::from_fn(&opened, |node| inside.contains(&node));
    let order = toposort(&opened, None).expect("the openers leave no loop");
    EvaluationStep::Loop {
        openers: openers.into_iter().map(NodeIndex::index).collect(),
        members: order.into_iter().map(NodeIndex::index).collect(),
    }
}

/// The members at which a loop is opened.
///
/// All open amplifiers and inputs of high gain are among them: they would magnify the errors of voltages that are
/// computed from other unknowns. The loops that remain among the other members are opened one member at a time.
fn openers(graph: &Graph, direct: &DirectGraph, members: &[NodeIndex]) -> Vec<NodeIndex> {
    let has_high_gain = |member: &&NodeIndex| {
        graph[**member].kind.output == OutputStage::OpenAmplifier
            || graph.edges_directed(**member, Incoming).any(|cord| cord.weight().gain.abs() >= HIGH_GAIN)
    };
    let mut openers: Vec<NodeIndex> = members.iter().filter(has_high_gain).copied().collect();
    openers.sort_unstable();
    let mut closed: Vec<Vec<NodeIndex>> = vec![members.to_vec()];
    while let Some(component) = closed.pop() {
        let rest: HashSet<NodeIndex> =
            component.into_iter().filter(|member| !openers.contains(member)).collect();
        let remaining = NodeFiltered::from_fn(direct, |node| rest.contains(&node));
        for component in kosaraju_scc(&remaining) {
            if component.len() > 1 || direct.find_edge(component[0], component[0]).is_some() {
                openers.push(opener(graph, direct, &component));
                closed.push(component);
            }
        }
    }
    openers
}

/// The member that opens a strongly connected component.
///
/// A member that leaves no loop among the others is preferred, then one that drives itself, then the one in most loops
/// of two members. Among equals, amplifiers come before passive elements, and then the order of the document decides.
fn opener(graph: &Graph, direct: &DirectGraph, component: &[NodeIndex]) -> NodeIndex {
    let inside: HashSet<NodeIndex> = component.iter().copied().collect();
    let mut candidates = component.to_vec();
    candidates.sort_unstable_by_key(|node| (graph[*node].kind.output == OutputStage::Passive, *node));
    // Only members of every loop qualify, so those of any one loop are enough.
    let cycle = cycle(direct, &inside, candidates[0]);
    let opens_all = |node: &&NodeIndex| {
        cycle.contains(*node)
            && toposort(
                &NodeFiltered::from_fn(direct, |other| other != **node && inside.contains(&other)),
                None,
            )
            .is_ok()
    };
    let drives_itself = |node: &&NodeIndex| direct.find_edge(**node, **node).is_some();
    let pairs = |node: NodeIndex| {
        let back = |other: &NodeIndex| inside.contains(other) && direct.find_edge(*other, node).is_some();
        direct.neighbors(node).filter(back).count()
    };
    let found = candidates.iter().find(opens_all).or_else(|| candidates.iter().find(drives_itself));
    let best = || candidates.iter().rev().max_by_key(|node| pairs(**node));
    *found.or_else(best).expect("a component has members")
}

/// The members of a loop that is reached from a member of a strongly connected component.
fn cycle(direct: &DirectGraph, inside: &HashSet<NodeIndex>, from: NodeIndex) -> HashSet<NodeIndex> {
    let mut path = vec![from];
    let mut seen: HashSet<NodeIndex> = HashSet::from([from]);
    loop {
        let last = path[path.len() - 1];
        let next = direct.neighbors(last).filter(|node| inside.contains(node)).min();
        let next = next.expect("every member of a component drives another");
        if !seen.insert(next) {
            let start = path.iter().position(|node| *node == next).unwrap_or(0);
            return path[start..].iter().copied().collect();
        }
        path.push(next);
    }
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
            step.members().iter().map(|member| circuit.element(*member).name.clone()).collect::<Vec<_>>()
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

    #[test]
    fn every_open_amplifier_opens_its_loop() {
        let open = || ElementBuilder::new("open-amplifier");
        let patch = PatchBuilder::new("two stages")
            .element("N", ElementBuilder::new("summer").cords("x1", ["B"]))
            .element("A", open().cords("x1", ["A", "N", "+100"]))
            .element("B", open().cords("x1", ["A", "B"]))
            .build()
            .unwrap();
        let circuit = Circuit::new(&patch).unwrap_or_else(|report| panic!("{report}"));
        let loops = circuit.evaluation_order().iter().filter_map(|step| match step {
            EvaluationStep::Loop { openers, .. } => Some(openers.as_slice()),
            EvaluationStep::Element(_) => None,
        });
        let names: Vec<_> = loops.flatten().map(|opener| circuit.element(*opener).name.as_str()).collect();
        assert_eq!(names, ["A", "B"]);
    }
}
