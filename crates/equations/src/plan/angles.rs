//! Functions of angles, and functions that are made of others.

use super::builder::Builder;
use crate::graph::{FunctionKind, Operation, Sum, Term};
use crate::notation::Notation;
use crate::symbolic::Fraction;

impl Builder<'_> {
    /// The sine of a varying angle. The sine of the opposite angle is shared.
    pub(super) fn sine(&mut self, angle: &Sum) -> Sum {
        match self.of_opposite(FunctionKind::Sin, angle) {
            Some(sine) => sine.negated(),
            None => self.generated(FunctionKind::Sin, angle),
        }
    }

    /// The cosine of a varying angle. The cosine of the opposite angle is shared.
    pub(super) fn cosine(&mut self, angle: &Sum) -> Sum {
        match self.of_opposite(FunctionKind::Cos, angle) {
            Some(cosine) => cosine,
            None => self.generated(FunctionKind::Cos, angle),
        }
    }

    /// The function of the opposite angle, if it has a node.
    fn of_opposite(&mut self, kind: FunctionKind, angle: &Sum) -> Option<Sum> {
        let Term { coefficient, node } = self.factored(angle);
        let argument = Term { coefficient: coefficient.negated(), node };
        self.find(&Operation::Function { kind, argument }).map(Sum::node)
    }

    /// The angle whose tangent is a varying sum.
    pub(super) fn atan(&mut self, tangent: &Sum) -> Sum {
        let name = self.named_call("atan", &[tangent]);
        self.angle(tangent, &Sum::constant(&Fraction::whole(1)), name)
    }

    /// The angle of the point (second, first), at least one of which varies.
    pub(super) fn atan2(&mut self, first: &Sum, second: &Sum) -> Sum {
        let name = self.named_call("atan2", &[first, second]);
        self.angle(first, second, name)
    }

    /// The angle y of the point (b, a): b sin(y) - a cos(y) = 0. The left side rises with y at the right solution, and
    /// falls at the opposite angle.
    fn angle(&mut self, a: &Sum, b: &Sum, name: Notation) -> Sum {
        let key = [a.clone(), b.clone()];
        if let Some(node) = self.angles.get(&key) {
            return Sum::node(*node);
        }
        let node = self.reserve_number(name);
        let angle = Sum::node(node);
        let (sine, cosine) = (self.sine(&angle), self.cosine(&angle));
        let zero = self.times(b, &sine).minus(&self.times(a, &cosine));
        self.define(node, Operation::Zero(zero));
        self.angles.insert(key, node);
        angle
    }

    /// The hyperbolic tangent: sign(z) (1 - e)/(1 + e) with e = exp(-2 |z|), which is never above 1.
    pub(super) fn tanh(&mut self, argument: &Sum) -> Sum {
        let size = self.absolute(argument);
        let exponential = self.generated(FunctionKind::Exp, &size.scaled(&Fraction::whole(-2)));
        let one = Sum::constant(&Fraction::whole(1));
        let of_size = self.ratio(&[one.clone().minus(&exponential)], &[one.plus(&exponential)]);
        let Term { coefficient, node } = self.factored(&of_size);
        let sign = self.switch(argument, -1);
        let name = self.named_call("tanh", &[argument]);
        Sum::term(&coefficient, self.add_as(Operation::product(sign, node), |_, _| name))
    }

    /// The name of a function with its arguments.
    fn named_call(&self, function: &str, arguments: &[&Sum]) -> Notation {
        let arguments = arguments.iter().map(|argument| self.sum_notation(argument));
        Notation::Call(function.to_owned(), arguments.collect())
    }
}
