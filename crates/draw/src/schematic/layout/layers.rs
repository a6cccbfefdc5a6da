//! Layers: every cord that goes forward leads to a later one.

use super::Graph;

/// A cord from node to node.
pub(super) type Edge = (usize, usize);

/// The cords that go forward, each pair of nodes once.
pub(super) fn forward_edges(graph: &Graph, rank: &[usize]) -> Vec<Edge> {
    let all = graph.nets.iter().flat_map(|net| net.to.iter().map(|(node, _)| (net.from, *node)));
    let mut edges: Vec<_> = all.filter(|(from, to)| rank[*from] < rank[*to]).collect();
    edges.sort_unstable();
    edges.dedup();
    edges
}

/// The layer of every node, counted from 0: as far left as its cords allow, then drawn together so that cords
/// become short.
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
                Some(last) if pulls_right(graph, *node, &layers, &into, &out) => last,
                _ => first,
            };
        }
    }
    layers
}

/// So often are layers drawn together.
const ROUNDS: usize = 6;

/// Whether cords get shorter, or no longer, when the node moves to the right: a net is as long as its way to
/// the last of its readers.
fn pulls_right(
    graph: &Graph,
    node: usize,
    layers: &[usize],
    into: &[Vec<usize>],
    out: &[Vec<usize>],
) -> bool {
    let is_last = |from: &&usize| out[**from].iter().all(|to| layers[*to] <= layers[node]);
    let longer = into[node].iter().filter(is_last).count();
    longer < 1 || (longer == 1 && graph.nodes[node].leans_right)
}
