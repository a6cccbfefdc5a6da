//! Assigns nodes to layers so that every forward edge leads to a later layer.

use super::Graph;

/// An edge from one node to another.
pub(super) type Edge = (usize, usize);

/// Returns the forward edges in ascending order, each pair of nodes once.
pub(super) fn forward_edges(graph: &Graph, rank: &[usize]) -> Vec<Edge> {
    let all = graph.nets.iter().flat_map(|net| net.to.iter().map(|(node, _)| (net.from, *node)));
    let mut edges: Vec<_> = all.filter(|(from, to)| rank[*from] < rank[*to]).collect();
    edges.sort_unstable();
    edges.dedup();
    edges
}

/// Returns the layer of each node, numbered from 0.
///
/// Each node is first as far left as its edges permit. Then nodes move right if that shortens the nets.
pub(super) fn assign(graph: &Graph, rank: &[usize], edges: &[Edge]) -> Vec<usize> {
    let mut into = vec![Vec::new(); rank.len()];
    let mut out = vec![Vec::new(); rank.len()];
    for (from, to) in edges {
        into[*to].push(*from);
        out[*from].push(*to);
    }
    let mut nodes: Vec<usize> = (0..rank.len()).collect();
    nodes.sort_by_key(|node| rank[*node]);
    let mut layers = vec![0; rank.len()];
    for node in &nodes {
        layers[*node] = into[*node].iter().map(|from| layers[*from] + 1).max().unwrap_or(0);
    }
    for _ in 0..ROUNDS {
        for node in nodes.iter().rev() {
            let last = out[*node].iter().map(|to| layers[*to] - 1).min();
            let first = into[*node].iter().map(|from| layers[*from] + 1).max().unwrap_or(0);
            layers[*node] = match last {
                Some(last) if should_move_right(graph, *node, &layers, &into, &out) => last,
                _ => first,
            };
        }
    }
    layers
}

/// The number of rounds in which nodes move right.
const ROUNDS: usize = 6;

/// Whether the nets get shorter, or do not get longer, if the node moves to the right.
///
/// The length of a net is the distance to its last reader.
fn should_move_right(
    graph: &Graph,
    node: usize,
    layers: &[usize],
    into: &[Vec<usize>],
    out: &[Vec<usize>],
) -> bool {
    let is_last = |from: &&usize| out[**from].iter().all(|to| layers[*to] <= layers[node]);
    let lengthened = into[node].iter().filter(is_last).count();
    lengthened < 1 || (lengthened == 1 && graph.nodes[node].prefers_right)
}
