//! The order of reading: which cords go forward.

use super::Graph;

/// For every node its rank: a cord to a node of higher rank goes forward, any other is feedback.
///
/// Nodes are visited depth first from the starts; what is reached last in this way ranks lowest, so only cords
/// back into the path being followed are feedback.
pub(super) fn ranks(graph: &Graph) -> Vec<usize> {
    let readers = readers(graph);
    let mut visit = Visit { readers: &readers, seen: vec![false; graph.nodes.len()], left: Vec::new() };
    for start in graph.starts.iter().copied().chain(0..graph.nodes.len()) {
        visit.from(start);
    }
    let mut rank = vec![0; graph.nodes.len()];
    for (place, node) in visit.left.iter().rev().enumerate() {
        rank[*node] = place;
    }
    cut_before(graph, &readers, rank)
}

/// For every node, those that read it, in the order of the graph.
pub(super) fn readers(graph: &Graph) -> Vec<Vec<usize>> {
    let mut readers = vec![Vec::new(); graph.nodes.len()];
    for net in &graph.nets {
        readers[net.from].extend(net.to.iter().map(|(node, _)| *node));
    }
    readers
}

struct Visit<'a> {
    readers: &'a [Vec<usize>],
    seen: Vec<bool>,
    /// Nodes in the order in which everything behind them was seen.
    left: Vec<usize>,
}

impl Visit<'_> {
    /// A stack of its own: circuits may be longer than the program's.
    fn from(&mut self, start: usize) {
        if std::mem::replace(&mut self.seen[start], true) {
            return;
        }
        let mut path = vec![(start, 0)];
        while let Some((node, next)) = path.last_mut() {
            let Some(reader) = self.readers[*node].get(*next).copied() else {
                self.left.push(*node);
                path.pop();
                continue;
            };
            *next += 1;
            if !std::mem::replace(&mut self.seen[reader], true) {
                path.push((reader, 0));
            }
        }
    }
}

/// A pot from which only feedback leaves stands before what it feeds: the cut goes before it.
fn cut_before(graph: &Graph, readers: &[Vec<usize>], rank: Vec<usize>) -> Vec<usize> {
    let mut keys: Vec<(f64, usize)> = rank.iter().map(|rank| (*rank as f64, 0)).collect();
    let mut by_rank: Vec<usize> = (0..rank.len()).collect();
    by_rank.sort_by_key(|node| std::cmp::Reverse(rank[*node]));
    for (turn, node) in by_rank.into_iter().enumerate() {
        let first = readers[node]
            .iter()
            .map(|reader| keys[*reader])
            .min_by(|a, b| a.partial_cmp(b).unwrap_or(std::cmp::Ordering::Equal));
        let goes_back = readers[node].iter().all(|reader| rank[*reader] <= rank[node]);
        if let Some((key, _)) = first.filter(|_| goes_back && graph.nodes[node].leans_right) {
            keys[node] = (key - 0.5, turn);
        }
    }
    let mut order: Vec<usize> = (0..rank.len()).collect();
    order.sort_by(|a, b| keys[*a].partial_cmp(&keys[*b]).unwrap_or(std::cmp::Ordering::Equal));
    let mut rank = vec![0; order.len()];
    for (place, node) in order.into_iter().enumerate() {
        rank[node] = place;
    }
    rank
}
