//! Joins nodes with equal values, and removes nodes that no quantity needs.

use std::collections::BTreeMap;

use super::builder::{Entry, NameKind};
use crate::graph::{Node, NodeId, ONE, Operation};
use crate::notation::text;

/// The nodes of a plan, and where the nodes of its builder are in it.
pub(super) struct Simplified {
    /// The nodes.
    pub nodes: Vec<Node>,
    /// For each node of the builder, the node with its value. `None` if no quantity needs it.
    pub places: Vec<Option<NodeId>>,
}

impl Simplified {
    /// The node with the value of a node of the builder. `None` if no quantity needs it.
    pub(super) fn place(&self, node: NodeId) -> Option<NodeId> {
        self.places[node.0 as usize]
    }
}

/// Joins equal nodes, and keeps those on which the quantities depend.
///
/// # Errors
/// The node of a quantity that the equations only set equal to itself, as `a = b` and `b = a` do.
pub(super) fn simplified(mut entries: Vec<Entry>, quantities: &[NodeId]) -> Result<Simplified, NodeId> {
    let mut operations = take_operations(&mut entries)?;
    let joined = join(&mut entries, &mut operations)?;
    let joined_with = |node: NodeId| target(&joined, node);
    let is_needed = needed(&operations, [ONE].iter().chain(quantities).map(|node| joined_with(*node)));
    let mut places: Vec<Option<NodeId>> = Vec::with_capacity(entries.len());
    let mut count = 0;
    for needed in &is_needed {
        places.push(needed.then_some(NodeId(count)));
        count += u32::from(*needed);
    }
    let place = |node: NodeId| places[node.0 as usize].unwrap_or(node);
    let kept = entries.into_iter().zip(operations).zip(&is_needed).filter(|(_, needed)| **needed);
    let nodes = kept.map(|((entry, operation), _)| Node {
        name: text(&entry.notation),
        dimension: entry.dimension,
        operation: operation.with_nodes(&place),
    });
    let nodes = nodes.collect();
    let all = (0..is_needed.len() as u32).map(NodeId);
    let places = all.map(|node| places[joined_with(node).0 as usize]).collect();
    Ok(Simplified { nodes, places })
}

/// The operations of all nodes.
///
/// # Errors
/// A node without an operation.
fn take_operations(entries: &mut [Entry]) -> Result<Vec<Operation>, NodeId> {
    let operations = entries.iter_mut().zip(0..);
    operations.map(|(entry, index)| entry.operation.take().ok_or(NodeId(index))).collect()
}

/// Joins nodes with equal operations, and nodes that are other names of a node, until there are none. Returns the node
/// with which each was joined. The operations then refer to the remaining nodes only.
///
/// # Errors
/// The node of a quantity that is just another name of itself.
fn join(entries: &mut [Entry], operations: &mut [Operation]) -> Result<Vec<Option<NodeId>>, NodeId> {
    let mut joined: Vec<Option<NodeId>> = vec![None; entries.len()];
    let mut changes = true;
    while changes {
        changes = false;
        let mut known: BTreeMap<Operation, NodeId> = BTreeMap::new();
        for node in (0..entries.len() as u32).map(NodeId) {
            let index = node.0 as usize;
            if joined[index].is_some() {
                continue;
            }
            let operation = operations[index].clone().with_nodes(&|node| target(&joined, node));
            operations[index] = operation.clone();
            let same = match operation.alias() {
                Some(same) if same == node => return Err(node),
                Some(same) => Some(same),
                None if operation.is_shareable() => known.get(&operation).copied(),
                None => None,
            };
            match same {
                Some(same) => {
                    unite(entries, operations, &mut joined, [node, same]);
                    changes = true;
                }
                None => {
                    known.insert(operation, node);
                }
            }
        }
    }
    Ok(joined)
}

/// Joins two nodes. A quantity keeps its place, and the name of the greater kind remains.
fn unite(
    entries: &mut [Entry],
    operations: &mut [Operation],
    joined: &mut [Option<NodeId>],
    [node, same]: [NodeId; 2],
) {
    let [index, other] = [node, same].map(|node| node.0 as usize);
    let [kind, other_kind] = [index, other].map(|index| entries[index].kind);
    if kind > NameKind::Expression && other_kind == NameKind::Expression {
        operations[index] = operations[other].clone();
        joined[other] = Some(node);
        return;
    }
    if kind > other_kind {
        entries[other].notation = entries[index].notation.clone();
        entries[other].kind = kind;
    }
    joined[index] = Some(same);
}

/// The node that remains of a node.
fn target(joined: &[Option<NodeId>], node: NodeId) -> NodeId {
    let mut node = node;
    while let Some(next) = joined[node.0 as usize] {
        node = next;
    }
    node
}

/// For each node, whether one of the roots is it or depends on it.
fn needed(operations: &[Operation], roots: impl Iterator<Item = NodeId>) -> Vec<bool> {
    let mut is_needed = vec![false; operations.len()];
    let mut open: Vec<NodeId> = roots.collect();
    while let Some(node) = open.pop() {
        let index = node.0 as usize;
        if !is_needed[index] {
            is_needed[index] = true;
            open.extend(operations[index].inputs());
        }
    }
    is_needed
}
