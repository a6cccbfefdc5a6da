//! The order of working out voltages, and the loops that have no integrator in them.

use petgraph::algo::{kosaraju_scc, toposort};
use petgraph::graph::{DiGraph, NodeIndex};
use petgraph::visit::EdgeRef as _;

use super::Stage;
use super::resolve::Graph;
use crate::elements::Output;
use crate::patch::{Code, Diagnostic};

type Plain = DiGraph<usize, ()>;

/// Drivers before what they drive; members of a loop together, the one that opens it last.
pub(super) fn stages(graph: &Graph, findings: &mut Vec<Diagnostic>) -> Vec<Stage> {
    let direct = direct_cords(graph);
    let components = kosaraju_scc(&direct);
    let stages = components.iter().rev().filter_map(|members| stage(graph, &direct, members, findings));
    stages.collect()
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

fn stage(
    graph: &Graph,
    direct: &Plain,
    members: &[NodeIndex],
    findings: &mut Vec<Diagnostic>,
) -> Option<Stage> {
    let alone = members.len() == 1 && direct.find_edge(members[0], members[0]).is_none();
    if alone {
        return Some(Stage::Element(members[0].index()));
    }
    let opened = opened(graph, direct, members);
    if opened.is_none() {
        findings.push(tangled(graph, members));
    }
    opened.map(Stage::Loop)
}

/// The members in an order that one of them, the last, opens. Amplifiers are tried first.
fn opened(graph: &Graph, direct: &Plain, members: &[NodeIndex]) -> Option<Vec<usize>> {
    let mut candidates = members.to_vec();
    candidates.sort_by_key(|index| (graph[*index].kind.output == Output::Passive, index.index()));
    candidates.into_iter().find_map(|tear| order_without(direct, members, tear))
}

/// The members in order when the cords out of `tear` are pulled, if no loop is left then.
fn order_without(direct: &Plain, members: &[NodeIndex], tear: NodeIndex) -> Option<Vec<usize>> {
    let part =
        direct.filter_map(|index, element| members.contains(&index).then_some(*element), |_, _| Some(()));
    let mut part = part;
    part.retain_edges(|part, edge| {
        part.edge_endpoints(edge).is_some_and(|(from, _)| part[from] != tear.index())
    });
    let order = toposort(&part, None).ok()?;
    let others = order.into_iter().map(|index| part[index]).filter(|element| *element != tear.index());
    Some(others.chain([tear.index()]).collect())
}

fn tangled(graph: &Graph, members: &[NodeIndex]) -> Diagnostic {
    let mut members = members.to_vec();
    members.sort();
    let names: Vec<_> = members.iter().map(|index| graph[*index].name.as_str()).collect();
    let message = format!(
        "the loops through {} have no integrator, and no single element opens them all",
        names.join(", ")
    );
    let span = members.iter().find_map(|index| graph[*index].span);
    let hint = Some("put an integrator or a lag into one of them".to_owned());
    Diagnostic { code: Code::LoopTooTangled, span, message, hint }
}
