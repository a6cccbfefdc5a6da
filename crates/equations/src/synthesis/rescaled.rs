//! Nodes whose scales follow from others, and sums that give some of them a scale of their own.
//!
//! A multiplier, a diode network and a delay line have no gains. So the scale of a product follows from those of its
//! factors, for example. If a user prescribes the scale of such a node or keeps its maximum, or if its scale depends on
//! itself through a feedback, a sum with this node as its only term is added. The same is done if the scale depends on
//! parameters and the node is the input of an element with settings that are numbers.

use std::collections::{BTreeMap, BTreeSet};

use crate::graph::{Node, NodeId, Operation, Plan, Sum};
use crate::symbolic::Fraction;

/// A plan in which all scales can be computed.
#[derive(Debug)]
pub(super) struct Rescaled {
    /// The plan. Added nodes are at its end.
    pub plan: Plan,
    /// For each added node, the node that it was. That node is a sum now.
    pub origins: Vec<NodeId>,
    /// The nodes whose scales follow from others, each after those from which it follows.
    pub order: Vec<NodeId>,
}

/// Whether the scale of a node follows from the scales of its inputs.
pub(super) fn is_forced(operation: &Operation) -> bool {
    !scale_sources(operation).is_empty()
}

/// The nodes whose scales determine that of a node with this operation.
fn scale_sources(operation: &Operation) -> Vec<NodeId> {
    match operation {
        Operation::Product(factors) => factors.to_vec(),
        Operation::Absolute(input) | Operation::Delay { input, .. } => vec![*input],
        Operation::Lower(terms) | Operation::Higher(terms) => terms.iter().map(|term| term.node).collect(),
        Operation::DeadZone { input, width } => vec![*input, width.node],
        Operation::One
        | Operation::Drive(_)
        | Operation::Integral { .. }
        | Operation::Sum(_)
        | Operation::Limited { .. }
        | Operation::Quotient { .. }
        | Operation::Root(_)
        | Operation::Zero(_)
        | Operation::Switch { .. }
        | Operation::Function { .. }
        | Operation::Curve { .. } => Vec::new(),
    }
}

/// The nodes whose scales follow from others by coefficients that contain parameters, although an element that reads them
/// has settings that are numbers: the points of a table, and the initial voltage of a delay line.
pub(super) fn unsettled_scales(plan: &Plan, has_parameters: &dyn Fn(&Fraction) -> bool) -> BTreeSet<NodeId> {
    let with_numbers = plan.nodes.iter().filter_map(|node| match &node.operation {
        Operation::Curve { input, .. } => Some(input.node),
        Operation::Delay { input, initial, .. } if !initial.is_zero() => Some(*input),
        _ => None,
    });
    with_numbers.filter(|id| depends_on_parameters(plan, *id, has_parameters)).collect()
}

/// Whether the scale of a node follows from others by a coefficient that contains parameters.
fn depends_on_parameters(plan: &Plan, id: NodeId, has_parameters: &dyn Fn(&Fraction) -> bool) -> bool {
    let (mut open, mut seen) = (vec![id], BTreeSet::new());
    while let Some(id) = open.pop() {
        if !seen.insert(id) {
            continue;
        }
        let operation = &plan.node(id).operation;
        let is_parametric = match operation {
            Operation::Lower(terms) | Operation::Higher(terms) => {
                terms.iter().any(|term| has_parameters(&term.coefficient))
            }
            Operation::DeadZone { width, .. } => has_parameters(&width.coefficient),
            _ => false,
        };
        if is_parametric {
            return true;
        }
        open.extend(scale_sources(operation));
    }
    false
}

/// Adds a sum after each node for which `needs_own_scale` is true, and where a scale would depend on itself.
pub(super) fn rescaled(plan: &Plan, needs_own_scale: &dyn Fn(NodeId) -> bool) -> Rescaled {
    let closing = Search::of(plan).closing;
    let is_split =
        |id: &NodeId| is_forced(&plan.node(*id).operation) && (needs_own_scale(*id) || closing.contains(id));
    let origins: Vec<NodeId> = plan.ids().filter(is_split).collect();
    let mut plan = plan.clone();
    origins.iter().for_each(|id| split(&mut plan, *id));
    let order = Search::of(&plan).order;
    Rescaled { plan, origins, order }
}

/// Moves the operation of a node to a new node at the end. The node becomes a sum with the new node as its only term.
fn split(plan: &mut Plan, id: NodeId) {
    let added = NodeId(plan.nodes.len() as u32);
    let sum = Operation::Sum(Sum { terms: BTreeMap::from([(added, Fraction::whole(1))]) });
    let node = &mut plan.nodes[id.0 as usize];
    let operation = std::mem::replace(&mut node.operation, sum);
    let moved = Node { name: node.name.clone(), dimension: node.dimension, operation };
    plan.nodes.push(moved);
}

/// A depth-first search along the nodes whose scales follow from others.
struct Search<'p> {
    /// The plan.
    plan: &'p Plan,
    /// The nodes on the way from the first node to the present one.
    open: BTreeSet<NodeId>,
    /// The nodes that are complete.
    done: BTreeSet<NodeId>,
    /// The complete nodes, each after those from which its scale follows.
    order: Vec<NodeId>,
    /// The nodes whose scales depend on themselves.
    closing: BTreeSet<NodeId>,
}

impl<'p> Search<'p> {
    /// The search in a whole plan.
    fn of(plan: &'p Plan) -> Self {
        let [open, done, closing] = [BTreeSet::new(), BTreeSet::new(), BTreeSet::new()];
        let mut search = Search { plan, open, done, order: Vec::new(), closing };
        plan.ids().for_each(|id| search.visit(id));
        search
    }

    /// Visits a node after the nodes from which its scale follows.
    fn visit(&mut self, id: NodeId) {
        if self.open.contains(&id) {
            self.closing.insert(id);
            return;
        }
        let sources = scale_sources(&self.plan.node(id).operation);
        if sources.is_empty() || !self.done.insert(id) {
            return;
        }
        self.open.insert(id);
        sources.into_iter().for_each(|source| self.visit(source));
        self.open.remove(&id);
        self.order.push(id);
    }
}
