//! The order in which the nodes of a network are computed, and its loops.
//!
//! A loop is a strongly connected component of the graph of laws. It is opened at some of its nodes, the *tears*, whose
//! values are unknowns. The other members then follow one after another.

use petgraph::Direction::{self, Incoming, Outgoing};
use petgraph::algo::{kosaraju_scc, toposort};
use petgraph::graph::{DiGraph, NodeIndex};
use petgraph::visit::NodeFiltered;

use super::law::Law;

/// A node or a loop. It follows from earlier ones.
#[derive(Debug)]
pub(super) enum Block {
    /// A node that does not depend on itself.
    Node(usize),
    /// Nodes that depend on each other, or a node that is given by an equation.
    Loop(Loop),
}

/// A loop. The values of the tears are unknown.
#[derive(Debug)]
pub(super) struct Loop {
    /// The tears.
    pub tears: Vec<usize>,
    /// All members in order of evaluation, each with its index among the tears if it is one.
    pub members: Vec<(usize, Option<usize>)>,
}

/// A graph with an edge from every input of a law to the node of the law.
type LawGraph = DiGraph<(), ()>;

/// The blocks of laws in order of evaluation.
pub(super) fn blocks(laws: &[Law]) -> Vec<Block> {
    let graph = graph(laws);
    // The components come in reverse order of evaluation.
    kosaraju_scc(&graph).into_iter().rev().map(|members| block(laws, &graph, members)).collect()
}

/// The graph of laws.
fn graph(laws: &[Law]) -> LawGraph {
    let mut graph = LawGraph::with_capacity(laws.len(), 2 * laws.len());
    for _ in laws {
        graph.add_node(());
    }
    for (node, law) in laws.iter().enumerate() {
        for input in law.inputs() {
            graph.add_edge(NodeIndex::new(input), NodeIndex::new(node), ());
        }
    }
    graph
}

/// Whether a component of a graph depends on itself.
fn is_cyclic(graph: &LawGraph, component: &[NodeIndex]) -> bool {
    component.len() > 1 || component.iter().any(|node| graph.find_edge(*node, *node).is_some())
}

/// Whether a node is given by an equation.
fn is_zero(laws: &[Law], node: NodeIndex) -> bool {
    matches!(laws[node.index()], Law::Zero(_))
}

/// The block of a strongly connected component.
fn block(laws: &[Law], graph: &LawGraph, mut members: Vec<NodeIndex>) -> Block {
    if !is_cyclic(graph, &members) && !is_zero(laws, members[0]) {
        return Block::Node(members[0].index());
    }
    members.sort_unstable();
    let tears: Vec<usize> = tears(laws, graph, &members).into_iter().map(NodeIndex::index).collect();
    let position = |node: usize| tears.iter().position(|tear| *tear == node);
    let order = opened_order(graph, &members, &tears);
    let members = order.into_iter().map(|node| (node, position(node))).collect();
    Block::Loop(Loop { tears, members })
}

/// The members at which a loop is opened: those that equations give, and then one member of each loop that remains.
fn tears(laws: &[Law], graph: &LawGraph, members: &[NodeIndex]) -> Vec<NodeIndex> {
    let mut tears: Vec<NodeIndex> = members.iter().copied().filter(|node| is_zero(laws, *node)).collect();
    let mut is_closed = vec![false; graph.node_count()];
    members.iter().for_each(|node| is_closed[node.index()] = true);
    tears.iter().for_each(|node| is_closed[node.index()] = false);
    loop {
        let rest = NodeFiltered::from_fn(graph, |node: NodeIndex| is_closed[node.index()]);
        let components = kosaraju_scc(&rest);
        let Some(component) = components.iter().find(|component| is_cyclic(graph, component)) else {
            return tears;
        };
        let tear = busiest(graph, component);
        tears.push(tear);
        is_closed[tear.index()] = false;
    }
}

/// The member of a component with the largest product of inputs and outputs within the component; of several, the one
/// with the smallest index.
fn busiest(graph: &LawGraph, component: &[NodeIndex]) -> NodeIndex {
    let count = |direction: Direction, node: NodeIndex| {
        graph.neighbors_directed(node, direction).filter(|other| component.contains(other)).count()
    };
    let ways = |node: NodeIndex| count(Incoming, node) * count(Outgoing, node);
    let mut nodes = component.to_vec();
    nodes.sort_unstable_by_key(|node| (std::cmp::Reverse(ways(*node)), *node));
    nodes[0]
}

/// The members of a loop in order of evaluation for known tears.
fn opened_order(graph: &LawGraph, members: &[NodeIndex], tears: &[usize]) -> Vec<usize> {
    let mut opened = DiGraph::<usize, ()>::with_capacity(members.len(), 2 * members.len());
    let nodes: Vec<NodeIndex> = members.iter().map(|member| opened.add_node(member.index())).collect();
    for (member, node) in members.iter().zip(&nodes) {
        if tears.contains(&member.index()) {
            continue;
        }
        for reader in graph.neighbors(*member) {
            if let Ok(position) = members.binary_search(&reader) {
                opened.add_edge(*node, nodes[position], ());
            }
        }
    }
    // The search for tears ends only when the other members have no loop.
    let order = toposort(&opened, None).expect("the tears leave no loop");
    order.into_iter().map(|node| opened[node]).collect()
}
