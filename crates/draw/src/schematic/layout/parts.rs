//! Parts of a circuit that only sources join: each has rows of its own.

use super::Graph;

/// A part with fewer nodes stands among those of the first one.
const FEWEST: usize = 6;

/// For every node its part, counted from 0 in the order of the graph. A source stands with the first that reads it.
pub(super) fn of(graph: &Graph) -> Vec<usize> {
    let joined = joined(graph);
    let mut sizes = vec![0; joined.len()];
    joined.iter().for_each(|root| sizes[*root] += 1);
    let large: Vec<usize> = (0..joined.len()).filter(|root| sizes[*root] >= FEWEST).collect();
    let part = |node: usize| large.iter().position(|root| *root == joined[node]).unwrap_or(0);
    let mut parts: Vec<usize> = (0..joined.len()).map(part).collect();
    for net in graph.nets.iter().filter(|net| is_source(graph, net.from)) {
        parts[net.from] = net.to.iter().map(|(reader, _)| parts[*reader]).min().unwrap_or(0);
    }
    parts
}

/// Whether nothing can be plugged into a node.
fn is_source(graph: &Graph, node: usize) -> bool {
    graph.nodes[node].inputs.is_empty()
}

/// For every node the first of those that nets join to it, sources left out.
fn joined(graph: &Graph) -> Vec<usize> {
    let mut first: Vec<usize> = (0..graph.nodes.len()).collect();
    for net in graph.nets.iter().filter(|net| !is_source(graph, net.from)) {
        for (reader, _) in &net.to {
            let (one, other) = (root(&first, net.from), root(&first, *reader));
            first[one.max(other)] = one.min(other);
        }
    }
    (0..first.len()).map(|node| root(&first, node)).collect()
}

fn root(first: &[usize], mut node: usize) -> usize {
    while first[node] != node {
        node = first[node];
    }
    node
}
