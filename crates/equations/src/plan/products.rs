//! Products and quotients of sums.

use super::builder::Builder;
use super::constants::is_readable;
use super::names::times;
use crate::graph::{NodeId, Operation, Sum, Term};
use crate::symbolic::Fraction;

/// In a product of more factors, no pair is preferred that has a node already. The search would take too long.
const MOST_PAIRED: usize = 8;

impl Builder<'_> {
    /// A product of sums over a product of sums. No divisor must be the number 0.
    ///
    /// Constants are taken out. A constant is distributed over the sum that it multiplies, if that is the only varying
    /// factor. Otherwise each varying factor is one node, so that as few multipliers as possible are necessary.
    pub(super) fn ratio(&mut self, tops: &[Sum], bottoms: &[Sum]) -> Sum {
        let (mut constant, varying) = self.without_constants(tops);
        let (divisor, bottoms) = self.without_constants(bottoms);
        constant = constant.over(&divisor);
        if constant.is_zero() {
            return Sum::default();
        }
        let divisor = self.factor_product(&bottoms);
        if let Some(divisor) = &divisor {
            constant = constant.over(&divisor.coefficient);
        }
        let top = match varying.as_slice() {
            [only] => only.scaled(&constant),
            several => match self.factor_product(several) {
                Some(term) => Sum::term(&constant.times(&term.coefficient), term.node),
                None => Sum::constant(&constant),
            },
        };
        match divisor {
            Some(divisor) => self.quotient(top, divisor.node),
            None => top,
        }
    }

    /// The product of two sums.
    pub(super) fn times(&mut self, left: &Sum, right: &Sum) -> Sum {
        self.ratio(&[left.clone(), right.clone()], &[])
    }

    /// The product of two nodes.
    pub(super) fn product(&mut self, left: NodeId, right: NodeId) -> NodeId {
        self.add_as(Operation::product(left, right), |builder, _| {
            times(builder.entry(left).notation.clone(), builder.entry(right).notation.clone())
        })
    }

    /// A sum over a node.
    fn quotient(&mut self, dividend: Sum, divisor: NodeId) -> Sum {
        let term = self.multiple(Operation::Quotient { dividend, divisor });
        Sum::term(&term.coefficient, term.node)
    }

    /// The product of varying sums, each of which becomes a constant times a node. `None` if there are no sums.
    fn factor_product(&mut self, sums: &[Sum]) -> Option<Term> {
        let mut constant = Fraction::whole(1);
        let mut nodes = Vec::with_capacity(sums.len());
        for sum in sums {
            let term = self.factored(sum);
            constant = constant.times(&term.coefficient);
            nodes.push(term.node);
        }
        let node = self.node_product(nodes)?;
        Some(Term { coefficient: constant, node })
    }

    /// The product of nodes, from left to right. Pairs that have a node already come first. `None` if there are no
    /// nodes.
    fn node_product(&mut self, mut nodes: Vec<NodeId>) -> Option<NodeId> {
        while nodes.len() > 1 {
            let (first, second) = self.known_pair(&nodes).unwrap_or((0, 1));
            let right = nodes.remove(second);
            nodes[first] = self.product(nodes[first], right);
        }
        nodes.pop()
    }

    /// The places of two nodes whose product has a node already.
    fn known_pair(&self, nodes: &[NodeId]) -> Option<(usize, usize)> {
        if nodes.len() > MOST_PAIRED {
            return None;
        }
        let count = nodes.len();
        let mut pairs = (0..count).flat_map(|first| (first + 1..count).map(move |second| (first, second)));
        pairs.find(|(first, second)| self.find(&Operation::product(nodes[*first], nodes[*second])).is_some())
    }

    /// The product of the constants among sums, and the other sums. A constant with which the product would be too long is
    /// a node.
    fn without_constants(&mut self, sums: &[Sum]) -> (Fraction, Vec<Sum>) {
        let mut constant = Fraction::whole(1);
        let mut varying = Vec::new();
        for sum in sums {
            let Some(value) = sum.as_constant() else {
                varying.push(sum.clone());
                continue;
            };
            let product = constant.times(&value);
            if is_readable(&product) || product.size() <= constant.size().max(value.size()) {
                constant = product;
            } else {
                varying.push(Sum::node(self.node_of(sum)));
            }
        }
        (constant, varying)
    }
}
