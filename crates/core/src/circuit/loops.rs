//! Finds the order in which voltages are computed, and the loops without an integrator.
//!
//! Only direct cords count, whose voltage acts on the output at the same instant. A strongly connected component of
//! this graph is a loop, also called an algebraic loop. It is opened at some of its members, whose outputs are unknowns
//! that the solver finds together. The others follow from them one after another.
//!
//! Each loop is examined in a graph of its members alone. The work for small loops is in proportion to their number.

use std::collections::HashSet;

use petgraph::Direction::Incoming;
use petgraph::algo::{kosaraju_scc, toposort};
use petgraph::graph::{DiGraph, EdgeIndex, NodeIndex};
use petgraph::visit::{EdgeFiltered, EdgeRef as _, NodeFiltered};

use super::resolve::Graph;
use super::{Cord, EvaluationStep};
use crate::elements::OutputStage;

/// A graph of direct cords, or the part of it between some members. The weight of a node is its node in the circuit.
/// Nodes and edges have the order of the circuit, so every search visits the members of a part in the same order as in
/// the whole graph.
type DirectGraph = DiGraph<NodeIndex, ()>;

/// Gain of an input from which on its element opens its loops. A chain of such elements would magnify the rounding of a
/// voltage, about 1e-14 V, beyond the accuracy of solutions.
const HIGH_GAIN: f64 = 50.0;

/// The steps in order of evaluation: every element comes after the elements that drive it directly.
pub(super) fn evaluation_order(graph: &Graph) -> Vec<EvaluationStep> {
    let direct = direct_graph(graph);
    let components = kosaraju_scc(&direct);
    components.into_iter().rev().map(|members| step(graph, &direct, members)).collect()
}

/// The elements with the cords through which a voltage acts at the same instant.
fn direct_graph(graph: &Graph) -> DirectGraph {
    let is_direct = |edge: EdgeIndex, cord: &Cord| {
        graph.edge_endpoints(edge).is_some_and(|(_, to)| graph[to].kind.inputs[cord.input].direct)
    };
    graph.filter_map(|node, _| Some(node), |edge, cord| is_direct(edge, cord).then_some(()))
}

/// The part of a graph between some members, given in ascending order. The work is in proportion to the cords that
/// leave them.
fn part(of: &DirectGraph, members: &[NodeIndex]) -> DirectGraph {
    let mut edges: Vec<(EdgeIndex, [NodeIndex; 2])> = Vec::new();
    for (from, member) in members.iter().enumerate() {
        for edge in of.edges(*member) {
            if let Ok(to) = members.binary_search(&edge.target()) {
                edges.push((edge.id(), [from, to].map(NodeIndex::new)));
            }
        }
    }
    // The edge added last is visited first, so edges are added in the order of the whole graph.
    edges.sort_unstable();
    let mut part = DirectGraph::with_capacity(members.len(), edges.len());
    for member in members {
        part.add_node(of[*member]);
    }
    for (_, [from, to]) in edges {
        part.add_edge(from, to, ());
    }
    part
}

/// The step for a strongly connected component of the graph of all direct cords.
fn step(graph: &Graph, direct: &DirectGraph, mut members: Vec<NodeIndex>) -> EvaluationStep {
    if let [member] = members[..]
        && direct.find_edge(member, member).is_none()
    {
        return EvaluationStep::Element(member.index());
    }
    members.sort_unstable();
    let component = part(direct, &members);
    let openers = openers(graph, &component);
    let outputs: HashSet<NodeIndex> = openers.iter().copied().collect();
    let opened = EdgeFiltered::from_fn(&component, |edge| !outputs.contains(&component[edge.source()]));
    let order = toposort(&opened, None).expect("the openers leave no loop");
    EvaluationStep::Loop {
        openers: openers.into_iter().map(NodeIndex::index).collect(),
        members: order.into_iter().map(|member| component[member].index()).collect(),
    }
}

/// The members at which a loop is opened, as nodes of the circuit. `component` is the graph of the loop.
///
/// All open amplifiers and inputs of high gain are among them: they would magnify the errors of voltages that are
/// computed from other unknowns. The loops that remain among the other members are opened one member at a time.
fn openers(graph: &Graph, component: &DirectGraph) -> Vec<NodeIndex> {
    let has_high_gain = |member: &NodeIndex| {
        let element = component[*member];
        graph[element].kind.output == OutputStage::OpenAmplifier
            || graph.edges_directed(element, Incoming).any(|cord| cord.weight().gain.abs() >= HIGH_GAIN)
    };
    let (high, rest): (Vec<_>, Vec<_>) = component.node_indices().partition(has_high_gain);
    let mut openers: Vec<NodeIndex> = high.into_iter().map(|member| component[member]).collect();
    let mut closed = vec![part(component, &rest)];
    while let Some(remaining) = closed.pop() {
        for mut members in kosaraju_scc(&remaining) {
            if members.len() > 1 || remaining.find_edge(members[0], members[0]).is_some() {
                members.sort_unstable();
                let smaller = part(&remaining, &members);
                let opener = opener(graph, &smaller);
                openers.push(smaller[opener]);
                let others: Vec<_> = smaller.node_indices().filter(|member| *member != opener).collect();
                closed.push(part(&smaller, &others));
            }
        }
    }
    openers
}

/// The member that opens a strongly connected component, of which this is the graph.
///
/// A member that leaves no loop among the others is preferred, then one that drives itself, then the one in most loops
/// of two members, then the one with the largest product of incoming and outgoing cords. So an inverter comes after a
/// summer: chains of summers between the openers magnify rounding. Among equals, amplifiers come before passive elements,
/// and then the order of the document decides.
fn opener(graph: &Graph, component: &DirectGraph) -> NodeIndex {
    let mut candidates: Vec<NodeIndex> = component.node_indices().collect();
    // The sort is stable, so the order of the document remains.
    candidates.sort_by_key(|member| graph[component[*member]].kind.output == OutputStage::Passive);
    // Only members of every loop qualify, so those of any one loop are enough.
    let cycle = cycle(component, candidates[0]);
    let opens_all = |member: &&NodeIndex| {
        cycle.contains(*member)
            && toposort(&NodeFiltered::from_fn(component, |other| other != **member), None).is_ok()
    };
    let drives_itself = |member: &&NodeIndex| component.find_edge(**member, **member).is_some();
    let pairs = |member: NodeIndex| {
        let back = |other: &NodeIndex| component.find_edge(*other, member).is_some();
        component.neighbors(member).filter(back).count()
    };
    let found = candidates.iter().find(opens_all).or_else(|| candidates.iter().find(drives_itself));
    let ways = |member: NodeIndex| {
        component.edges(member).count() * component.edges_directed(member, Incoming).count()
    };
    let best = || candidates.iter().rev().max_by_key(|member| (pairs(**member), ways(**member)));
    *found.or_else(best).expect("a component has members")
}

/// The members of a loop that is reached from a member of a strongly connected component, of which this is the graph.
fn cycle(component: &DirectGraph, from: NodeIndex) -> HashSet<NodeIndex> {
    let mut path = vec![from];
    let mut seen: HashSet<NodeIndex> = HashSet::from([from]);
    loop {
        let last = path[path.len() - 1];
        let next = component.neighbors(last).min().expect("every member of a component drives another");
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

    /// The loops in a patch of summers with one cord each, sorted. Each entry is a summer and the output that drives
    /// it.
    fn sorted_loops_of(cords: &[[String; 2]]) -> Vec<Vec<String>> {
        let drivers: Vec<[&str; 1]> = cords.iter().map(|[_, from]| [from.as_str()]).collect();
        let wiring: Vec<(&str, &[&str])> =
            cords.iter().zip(&drivers).map(|([to, _], from)| (to.as_str(), from.as_slice())).collect();
        let mut loops = loops_of(&wiring);
        loops.sort_unstable();
        loops
    }

    #[test]
    fn each_of_many_loops_is_opened_as_if_it_were_alone() {
        let cord = |to: &str, from: &str, pair: usize| [format!("{to}{pair}"), format!("{from}{pair}")];
        let count = 300;
        let cords: Vec<[String; 2]> = (0..count)
            .map(|pair| cord("A", "B", pair))
            .chain((0..count).rev().map(|pair| cord("B", "A", pair)))
            .collect();
        let mut alone: Vec<Vec<String>> = (0..count)
            .flat_map(|pair| sorted_loops_of(&[cord("A", "B", pair), cord("B", "A", pair)]))
            .collect();
        alone.sort_unstable();
        assert_eq!(alone.len(), count);
        assert_eq!(sorted_loops_of(&cords), alone);
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
