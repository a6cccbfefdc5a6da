//! The nodes that an operation reads, and the same operation of other nodes.

use super::{NodeId, Operation, Term};

impl Operation {
    /// The nodes that the operation reads, in the order of its parts. A node can occur twice.
    pub(crate) fn inputs(&self) -> Vec<NodeId> {
        match self {
            Operation::One | Operation::Drive(_) => Vec::new(),
            Operation::Integral { rate: sum, .. }
            | Operation::Sum(sum)
            | Operation::Limited { sum, .. }
            | Operation::Root(sum)
            | Operation::Zero(sum) => sum.terms.keys().copied().collect(),
            Operation::Product(nodes) => nodes.to_vec(),
            Operation::Quotient { dividend, divisor } => {
                dividend.terms.keys().copied().chain([*divisor]).collect()
            }
            Operation::Absolute(node)
            | Operation::Switch { input: node, .. }
            | Operation::Delay { input: node, .. } => vec![*node],
            Operation::Lower(terms) | Operation::Higher(terms) => {
                terms.iter().map(|term| term.node).collect()
            }
            Operation::DeadZone { input, width } => vec![*input, width.node],
            Operation::Function { argument: term, .. } | Operation::Curve { input: term, .. } => {
                vec![term.node]
            }
        }
    }

    /// The same operation with each node replaced by `node(..)`. Like terms of a sum are added.
    pub(crate) fn with_nodes(self, node: &dyn Fn(NodeId) -> NodeId) -> Operation {
        let term = |term: Term| Term { node: node(term.node), ..term };
        match self {
            Operation::One | Operation::Drive(_) => self,
            Operation::Integral { initial, rate } => {
                Operation::Integral { initial, rate: rate.with_nodes(node) }
            }
            Operation::Sum(sum) => Operation::Sum(sum.with_nodes(node)),
            Operation::Limited { sum, lower, upper } => {
                Operation::Limited { sum: sum.with_nodes(node), lower, upper }
            }
            Operation::Product([left, right]) => Operation::product(node(left), node(right)),
            Operation::Quotient { dividend, divisor } => {
                Operation::Quotient { dividend: dividend.with_nodes(node), divisor: node(divisor) }
            }
            Operation::Root(sum) => Operation::Root(sum.with_nodes(node)),
            Operation::Zero(sum) => Operation::Zero(sum.with_nodes(node)),
            Operation::Absolute(input) => Operation::Absolute(node(input)),
            Operation::Lower(terms) => Operation::Lower(terms.map(term)),
            Operation::Higher(terms) => Operation::Higher(terms.map(term)),
            Operation::Switch { input, at_least_0, below_0 } => {
                Operation::Switch { input: node(input), at_least_0, below_0 }
            }
            Operation::DeadZone { input, width } => {
                Operation::DeadZone { input: node(input), width: term(width) }
            }
            Operation::Function { kind, argument } => Operation::Function { kind, argument: term(argument) },
            Operation::Curve { table, input } => Operation::Curve { table, input: term(input) },
            Operation::Delay { input, time, initial } => {
                Operation::Delay { input: node(input), time, initial }
            }
        }
    }

    /// The product of two nodes. The order of the nodes does not matter.
    pub(crate) fn product(left: NodeId, right: NodeId) -> Operation {
        Operation::Product([left.min(right), left.max(right)])
    }

    /// Whether two nodes with this operation are the same quantity, and can be one node. Integrals remain separate: the
    /// reader expects one integrator for each state. The value of a [`Operation::Zero`] depends on its own node.
    pub(crate) fn is_shareable(&self) -> bool {
        !matches!(self, Operation::Integral { .. } | Operation::Zero(_))
    }

    /// The node of which this operation is just another name: the only node of a sum, with the factor 1.
    pub(crate) fn alias(&self) -> Option<NodeId> {
        match self {
            Operation::Sum(sum) => sum.as_node(),
            _ => None,
        }
    }
}
