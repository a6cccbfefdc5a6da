//! Which polarities the circuit of each node needs from the outputs of others.

use super::design::{Block, Branch, Design};
use super::elements::functions::argument_gain;
use super::polarity::{Need, PolarityNode};
use crate::graph::{FunctionKind, NodeId, Operation};

/// The node whose output is that of another one, and the sign between them. It differs from `id` if this is an alias.
pub(super) fn resolved(blocks: &[Block], id: NodeId) -> (NodeId, i8) {
    let mut found = (id, 1);
    // An alias of itself would have no end.
    for _ in 0..blocks.len() {
        let Block::Alias { node, sign } = blocks[found.0.0 as usize] else { break };
        found = (node, found.1 * sign);
    }
    found
}

/// The sign that makes the voltage of a divisor positive.
pub(super) fn divisor_sign(design: &Design<'_>, divisor: NodeId) -> i8 {
    let [low, _] = design.input.ranges[divisor.0 as usize];
    if low > 0.0 { 1 } else { -1 }
}

/// The sign by which an additional summer changes the voltage of an input.
pub(super) fn summer_sign(branch: &Branch) -> i8 {
    if branch.route.summers.is_multiple_of(2) { 1 } else { -1 }
}

/// The nodes of the search for polarities.
pub(super) fn polarity_nodes(design: &Design<'_>, blocks: &[Block]) -> Vec<PolarityNode> {
    let is_fixed = |operation: &Operation| match operation {
        Operation::One | Operation::Drive(_) | Operation::Root(_) => true,
        Operation::Function { kind, .. } => matches!(kind, FunctionKind::Exp | FunctionKind::Ln),
        _ => false,
    };
    let node = |id: NodeId| {
        let block = &blocks[id.0 as usize];
        let has_both = matches!(block, Block::Reference | Block::Ground);
        PolarityNode {
            needs: Finder { design, blocks }.needs(id, block),
            is_free: !has_both && !is_fixed(design.input.operation(id)),
            has_both,
            is_named: !design.input.labels(id).is_empty(),
        }
    };
    design.input.plan.ids().map(node).collect()
}

/// Finds the needs of nodes.
struct Finder<'f> {
    /// The design.
    design: &'f Design<'f>,
    /// The circuits of the nodes.
    blocks: &'f [Block],
}

impl Finder<'_> {
    /// What a node needs.
    fn needs(&self, id: NodeId, block: &Block) -> Vec<Need> {
        match block {
            Block::Reference | Block::Ground | Block::Drive | Block::Alias { .. } => Vec::new(),
            Block::Share(branch) => vec![self.own(branch.node, branch.sign)],
            Block::Amplifier { branches, .. } => self.of_amplifier(id, branches),
            Block::Element => self.of_element(id),
        }
    }

    /// What an amplifier needs.
    fn of_amplifier(&self, id: NodeId, branches: &[Branch]) -> Vec<Need> {
        let branches = branches.iter();
        match self.design.input.operation(id) {
            Operation::Zero(_) => branches.map(|branch| self.own(branch.node, branch.sign)).collect(),
            Operation::Root(_) => branches.map(|branch| self.fixed(branch.node, -branch.sign)).collect(),
            Operation::Quotient { divisor, .. } => {
                let sign = divisor_sign(self.design, *divisor);
                let dividend = branches.map(|branch| self.own(branch.node, -branch.sign * sign));
                dividend.chain([self.fixed(*divisor, sign)]).collect()
            }
            _ => branches.map(|branch| self.own(branch.node, -branch.sign * summer_sign(branch))).collect(),
        }
    }

    /// What an element without gains needs. Functions and comparators take any polarity of their inputs.
    fn of_element(&self, id: NodeId) -> Vec<Need> {
        match self.design.input.operation(id) {
            Operation::Product([first, second]) => {
                let [first, second] = [first, second].map(|node| resolved(self.blocks, *node));
                let sources = [first.0.0 as usize, second.0.0 as usize];
                vec![Need::Factors { sources, signs: [first.1, second.1] }]
            }
            Operation::Absolute(input) => vec![self.both(*input)],
            Operation::Lower(terms) | Operation::Higher(terms) => {
                terms.iter().map(|term| self.own(term.node, 1)).collect()
            }
            Operation::DeadZone { input, width } => vec![self.own(*input, 1), self.both(width.node)],
            Operation::Delay { input, .. } => vec![self.own(*input, 1)],
            Operation::Function { kind: FunctionKind::Exp | FunctionKind::Ln, argument } => {
                let sign = self.design.table.expressions.sign(&argument.coefficient);
                // A summer in front of the function inverts.
                let is_amplified = argument_gain(self.design, id).is_ok_and(|gain| gain > 1.0);
                vec![self.fixed(argument.node, if is_amplified { -sign } else { sign })]
            }
            _ => Vec::new(),
        }
    }

    /// The need for the polarity of the node times a sign.
    fn own(&self, node: NodeId, sign: i8) -> Need {
        let (source, alias) = resolved(self.blocks, node);
        Need::Own { source: source.0 as usize, sign: sign * alias }
    }

    /// The need for a polarity.
    fn fixed(&self, node: NodeId, sign: i8) -> Need {
        let (source, alias) = resolved(self.blocks, node);
        Need::Fixed { source: source.0 as usize, sign: sign * alias }
    }

    /// The need for both polarities.
    fn both(&self, node: NodeId) -> Need {
        Need::Both { source: resolved(self.blocks, node).0.0 as usize }
    }
}
