//! The order of reading, which decides which connections go forward and which are feedback.

use super::Graph;

/// Returns the rank of each node. A connection to a node of higher rank goes forward; any other is
/// feedback.
///
/// The nodes are visited depth first from the starts, and the ranks are in reverse order of completion.
/// So only a connection back into the current path is feedback.
pub(super) fn ranks(graph: &Graph) -> Vec<usize> {
    let readers = readers(graph);
    let mut visit = Visit { readers: &readers, seen: vec![false; graph.nodes.len()], finished: Vec::new() };
    for start in graph.starts.iter().copied().chain(0..graph.nodes.len()) {
        visit.visit_from(start);
    }
    let mut rank = vec![0; graph.nodes.len()];
    for (position, node) in visit.finished.iter().rev().enumerate() {
        rank[*node] = position;
    }
    move_feedback_pots(graph, &readers, rank)
}

/// Returns the readers of each node in the order of the graph.
pub(super) fn readers(graph: &Graph) -> Vec<Vec<usize>> {
    let mut readers = vec![Vec::new(); graph.nodes.len()];
    for net in &graph.nets {
        readers[net.from].extend(net.to.iter().map(|(node, _)| *node));
    }
    readers
}

/// A depth-first visit of all nodes.
struct Visit<'a> {
    /// The readers of each node, in the order in which they are visited.
    readers: &'a [Vec<usize>],
    /// For each node, whether it was visited.
    seen: Vec<bool>,
    /// The nodes in the order of completion.
    finished: Vec<usize>,
}

impl Visit<'_> {
    /// Visits all nodes that can be reached from a start.
    ///
    /// The stack is explicit because a path may be too long for recursion.
    fn visit_from(&mut self, start: usize) {
        if std::mem::replace(&mut self.seen[start], true) {
            return;
        }
        let mut path = vec![(start, 0)];
        while let Some((node, next)) = path.last_mut() {
            let Some(reader) = self.readers[*node].get(*next).copied() else {
                self.finished.push(*node);
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

/// Moves each pot whose output is feedback only to just before its first reader.
fn move_feedback_pots(graph: &Graph, readers: &[Vec<usize>], rank: Vec<usize>) -> Vec<usize> {
    let mut keys: Vec<(f64, usize)> = rank.iter().map(|rank| (*rank as f64, 0)).collect();
    let mut by_rank: Vec<usize> = (0..rank.len()).collect();
    by_rank.sort_by_key(|node| std::cmp::Reverse(rank[*node]));
    for (turn, node) in by_rank.into_iter().enumerate() {
        let first = readers[node]
            .iter()
            .map(|reader| keys[*reader])
            .min_by(|a, b| a.partial_cmp(b).unwrap_or(std::cmp::Ordering::Equal));
        let is_feedback = readers[node].iter().all(|reader| rank[*reader] <= rank[node]);
        if let Some((key, _)) = first.filter(|_| is_feedback && graph.nodes[node].prefers_right) {
            keys[node] = (key - 0.5, turn);
        }
    }
    let mut order: Vec<usize> = (0..rank.len()).collect();
    order.sort_by(|a, b| keys[*a].partial_cmp(&keys[*b]).unwrap_or(std::cmp::Ordering::Equal));
    let mut rank = vec![0; order.len()];
    for (position, node) in order.into_iter().enumerate() {
        rank[node] = position;
    }
    rank
}
