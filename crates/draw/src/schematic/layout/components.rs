//! The connected components of a graph. Each component has separate rows.
//!
//! Connections through sources do not count, because one drive may feed several independent circuits.

use super::Graph;

/// The minimum number of nodes of a component. Smaller ones are merged with the first component.
const MIN_NODES: usize = 6;

/// Returns the component of each node, numbered from 0 in the order of the graph.
///
/// A source belongs to the first component that reads it.
pub(super) fn of_nodes(graph: &Graph) -> Vec<usize> {
    let roots = roots(graph);
    let mut sizes = vec![0; roots.len()];
    roots.iter().for_each(|root| sizes[*root] += 1);
    let large: Vec<usize> = (0..roots.len()).filter(|root| sizes[*root] >= MIN_NODES).collect();
    let component = |node: usize| large.iter().position(|root| *root == roots[node]).unwrap_or(0);
    let mut components: Vec<usize> = (0..roots.len()).map(component).collect();
    for net in graph.nets.iter().filter(|net| is_source(graph, net.from)) {
        components[net.from] = net.to.iter().map(|(reader, _)| components[*reader]).min().unwrap_or(0);
    }
    components
}

/// Whether a node has no inputs.
fn is_source(graph: &Graph, node: usize) -> bool {
    graph.nodes[node].inputs.is_empty()
}

/// Returns the first node of the component of each node (union-find); nets of sources are ignored.
fn roots(graph: &Graph) -> Vec<usize> {
    let mut first: Vec<usize> = (0..graph.nodes.len()).collect();
    for net in graph.nets.iter().filter(|net| !is_source(graph, net.from)) {
        for (reader, _) in &net.to {
            let (one, other) = (root(&first, net.from), root(&first, *reader));
            first[one.max(other)] = one.min(other);
        }
    }
    (0..first.len()).map(|node| root(&first, node)).collect()
}

/// Returns the first node of the set that contains a node.
fn root(first: &[usize], mut node: usize) -> usize {
    while first[node] != node {
        node = first[node];
    }
    node
}
