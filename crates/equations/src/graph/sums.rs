//! Sums of nodes with constant factors.

use num_traits::Signed as _;

use super::{NodeId, Sum, Term};
use crate::symbolic::{Fraction, Rational};

/// The node of the number 1: the first node of every plan.
pub(crate) const ONE: NodeId = NodeId(0);

impl Sum {
    /// A node times a constant. The number 0 has no term.
    pub(crate) fn term(coefficient: &Fraction, node: NodeId) -> Sum {
        let mut sum = Sum::default();
        sum.add(coefficient, node);
        sum
    }

    /// A constant.
    pub(crate) fn constant(value: &Fraction) -> Sum {
        Sum::term(value, ONE)
    }

    /// A node.
    pub(crate) fn node(node: NodeId) -> Sum {
        Sum::term(&Fraction::whole(1), node)
    }

    /// Adds a node times a constant.
    pub(crate) fn add(&mut self, coefficient: &Fraction, node: NodeId) {
        let sum = match self.terms.remove(&node) {
            Some(own) => own.plus(coefficient),
            None => coefficient.clone(),
        };
        if !sum.is_zero() {
            self.terms.insert(node, sum);
        }
    }

    /// The sum of two sums.
    pub(crate) fn plus(mut self, other: &Sum) -> Sum {
        for (node, coefficient) in &other.terms {
            self.add(coefficient, *node);
        }
        self
    }

    /// The difference of two sums.
    pub(crate) fn minus(self, other: &Sum) -> Sum {
        self.plus(&other.negated())
    }

    /// The sum with the opposite sign.
    pub(crate) fn negated(&self) -> Sum {
        let negated = |(node, coefficient): (&NodeId, &Fraction)| (*node, coefficient.negated());
        Sum { terms: self.terms.iter().map(negated).collect() }
    }

    /// The sum times a constant.
    pub(crate) fn scaled(&self, factor: &Fraction) -> Sum {
        let mut sum = Sum::default();
        for (node, coefficient) in &self.terms {
            sum.add(&coefficient.times(factor), *node);
        }
        sum
    }

    /// The same sum with each node replaced. Like terms are added.
    pub(crate) fn with_nodes(&self, node: &dyn Fn(NodeId) -> NodeId) -> Sum {
        let mut sum = Sum::default();
        for (own, coefficient) in &self.terms {
            sum.add(coefficient, node(*own));
        }
        sum
    }

    /// The constant, if the sum contains no other node than [`ONE`].
    pub(crate) fn as_constant(&self) -> Option<Fraction> {
        match self.as_term() {
            Some(term) => (term.node == ONE).then_some(term.coefficient),
            None => self.terms.is_empty().then(Fraction::zero),
        }
    }

    /// The only term, if there is exactly one.
    pub(crate) fn as_term(&self) -> Option<Term> {
        let (node, coefficient) = self.terms.first_key_value().filter(|_| self.terms.len() == 1)?;
        Some(Term { coefficient: coefficient.clone(), node: *node })
    }

    /// The node, if the sum is one node with the factor 1. The number 1 is a constant, not a node.
    pub(crate) fn as_node(&self) -> Option<NodeId> {
        let term = self.as_term()?;
        (term.node != ONE && term.coefficient == Fraction::whole(1)).then_some(term.node)
    }

    /// The first number in the first coefficient. Sums that are multiples of each other become equal if each is divided
    /// by this number. `None` for the empty sum.
    pub(crate) fn leading_number(&self) -> Option<Rational> {
        let (_, coefficient) = self.terms.first_key_value()?;
        leading_number(coefficient).cloned()
    }

    /// Whether each coefficient begins with a negative number.
    pub(crate) fn is_negative(&self) -> bool {
        self.terms.values().all(|coefficient| leading_number(coefficient).is_some_and(Rational::is_negative))
    }
}

/// The first number in a coefficient. `None` for the number 0.
fn leading_number(coefficient: &Fraction) -> Option<&Rational> {
    coefficient.numerator().terms().next().map(|(_, number)| number)
}
