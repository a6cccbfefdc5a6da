//! Functions: the elements that compute them.

use std::f64::consts::LN_10;

use patchcord_expr::{Callee, EquationFunction, FormulaError, Function, Node};

use super::builder::Builder;
use super::expressions::{Reader, fault};
use crate::compare::intended::{applied, called};
use crate::graph::{FunctionKind, NodeId, ONE, Operation, Sum, Term};
use crate::symbolic::{Fraction, absolute};

impl Reader<'_, '_> {
    /// A function that formulas have, too.
    ///
    /// # Errors
    /// If no element computes the function.
    pub(super) fn call(
        &mut self,
        node: &Node,
        callee: Callee,
        arguments: &[Node],
    ) -> Result<Sum, FormulaError> {
        if let Some(value) = self.builder.constants.expression(node) {
            return Ok(Sum::constant(&value));
        }
        if let (Callee::Function(Function::Power), [base, exponent]) = (callee, arguments) {
            return self.power(node, base, exponent);
        }
        let forms = self.forms(arguments)?;
        if let Some(constants) = all_constant(&forms) {
            return Ok(Sum::constant(&called(callee, &constants)));
        }
        let builder = &mut *self.builder;
        match (callee, forms.as_slice()) {
            (Callee::Absolute, [argument]) => Ok(builder.absolute(argument)),
            (Callee::Minimum, [first, second]) => Ok(builder.minimum(first, second)),
            (Callee::Maximum, [first, second]) => Ok(builder.maximum(first, second)),
            (Callee::Function(Function::Atan2), [first, second]) => Ok(builder.atan2(first, second)),
            (Callee::Function(function), [argument]) => {
                builder.function(function, argument).ok_or_else(|| self.no_element(node, function.name()))
            }
            _ => Err(self.no_element(node, callee.name())),
        }
    }

    /// A function that only equations have, or a table.
    ///
    /// # Errors
    /// If an argument is not as the element needs it.
    pub(super) fn application(
        &mut self,
        node: &Node,
        name: &str,
        arguments: &[Node],
    ) -> Result<Sum, FormulaError> {
        if let Some(value) = self.builder.constants.expression(node) {
            return Ok(Sum::constant(&value));
        }
        let forms = self.forms(arguments)?;
        if let Some(constants) = all_constant(&forms) {
            let value = applied(name, &constants).ok_or_else(|| self.constant_table(node))?;
            return Ok(Sum::constant(&value));
        }
        match (EquationFunction::from_name(name), forms.as_slice()) {
            (Some(EquationFunction::Sign), [argument]) => Ok(Sum::node(self.builder.switch(argument, -1))),
            (Some(EquationFunction::Step), [argument]) => Ok(Sum::node(self.builder.switch(argument, 0))),
            (Some(EquationFunction::DeadZone), [argument, width]) => {
                self.check_positive(arguments, width, "half width of a dead zone")?;
                Ok(self.builder.dead_zone(argument, width))
            }
            (Some(EquationFunction::Limit), [argument, lower, upper]) => {
                self.check_limits(node, lower, upper)?;
                Ok(self.builder.limit(argument, lower, upper))
            }
            (Some(EquationFunction::Delay), [argument, time]) => self.delay(arguments, argument, time),
            (None, [argument]) => Ok(self.builder.curve(name, argument)),
            _ => Err(self.no_element(node, name)),
        }
    }

    /// The arguments of a function as sums of nodes.
    fn forms(&mut self, arguments: &[Node]) -> Result<Vec<Sum>, FormulaError> {
        arguments.iter().map(|argument| self.form(argument)).collect()
    }

    /// The fault of a table with a constant argument. A formula of a setting contains no table.
    fn constant_table(&self, node: &Node) -> FormulaError {
        let message = format!("{} does not vary", self.excerpt(node));
        fault(node.range.clone(), message, "write its value as a parameter".to_owned())
    }

    /// The delay of a sum. The initial value follows when all equations have been read.
    fn delay(&mut self, arguments: &[Node], argument: &Sum, time: &Sum) -> Result<Sum, FormulaError> {
        let Some(time_value) = time.as_constant() else {
            let range = arguments.last().map(|node| node.range.clone()).unwrap_or_default();
            let message = "the time of a delay must be constant".to_owned();
            return Err(fault(range, message, "write a parameter here".to_owned()));
        };
        self.check_positive(arguments, time, "time of a delay")?;
        let Term { coefficient, node } = self.builder.factored(argument);
        let delay = Operation::Delay { input: node, time: time_value, initial: Fraction::zero() };
        Ok(Sum::term(&coefficient, self.builder.add(delay)))
    }

    /// Checks that the last argument of a function is positive at present, if it is constant.
    fn check_positive(&self, arguments: &[Node], value: &Sum, noun: &str) -> Result<(), FormulaError> {
        let present = value.as_constant().map(|value| self.builder.constants.value(&value));
        match (present, arguments.last()) {
            (Some(present), Some(node)) if !(present > 0.0 && present.is_finite()) => {
                let message = format!("the {noun} must be positive, and {} is not", self.excerpt(node));
                Err(fault(node.range.clone(), message, "choose a positive value".to_owned()))
            }
            _ => Ok(()),
        }
    }

    /// Checks that constant limits are in ascending order at present.
    fn check_limits(&self, node: &Node, lower: &Sum, upper: &Sum) -> Result<(), FormulaError> {
        let present = |bound: &Sum| bound.as_constant().map(|value| self.builder.constants.value(&value));
        match (present(lower), present(upper)) {
            (Some(low), Some(high)) if low > high => {
                let message = format!("the lower limit in {} exceeds the upper one", self.excerpt(node));
                Err(fault(node.range.clone(), message, "exchange the limits".to_owned()))
            }
            _ => Ok(()),
        }
    }

    /// The fault of a function that no element computes.
    fn no_element(&self, node: &Node, function: &str) -> FormulaError {
        let message = format!("no element computes {function}");
        let hint = format!("use another function, or a table, in place of {function}");
        fault(node.range.clone(), message, hint)
    }
}

/// The values of sums that are all constant, as those of `x - x` and `0 x` are. `None` if one of them varies.
fn all_constant(forms: &[Sum]) -> Option<Vec<Fraction>> {
    forms.iter().map(Sum::as_constant).collect()
}

impl Builder<'_> {
    /// A function of one varying pure number. `None` if no element computes it.
    fn function(&mut self, function: Function, argument: &Sum) -> Option<Sum> {
        let ln_10 = Fraction::number(LN_10);
        Some(match function {
            Function::Sqrt => Sum::node(self.add(Operation::Root(argument.clone()))),
            Function::Sin => self.sine(argument),
            Function::Cos => self.cosine(argument),
            Function::Tan => {
                let (sine, cosine) = (self.sine(argument), self.cosine(argument));
                self.ratio(&[sine], &[cosine])
            }
            Function::Atan => self.atan(argument),
            Function::Exp => self.generated(FunctionKind::Exp, argument),
            Function::Exp10 => self.generated(FunctionKind::Exp, &argument.scaled(&ln_10)),
            Function::Ln => self.generated(FunctionKind::Ln, argument),
            Function::Log10 => {
                self.generated(FunctionKind::Ln, argument).scaled(&Fraction::whole(1).over(&ln_10))
            }
            Function::Tanh => self.tanh(argument),
            Function::Atan2 | Function::Power | Function::Floor => return None,
        })
    }

    /// A function that a function generator computes.
    pub(super) fn generated(&mut self, kind: FunctionKind, argument: &Sum) -> Sum {
        let argument = match kind {
            FunctionKind::Sin | FunctionKind::Cos => self.factored(argument),
            FunctionKind::Exp | FunctionKind::Ln => self.nonzero_term(argument),
        };
        Sum::node(self.add(Operation::Function { kind, argument }))
    }

    /// A varying sum as a constant times a node. A constant that is 0 at present stays in the node. A pot can follow it, and
    /// the settings of an exponential cannot, because they contain its reciprocal.
    pub(super) fn nonzero_term(&mut self, sum: &Sum) -> Term {
        let term = self.factored(sum);
        if self.constants.value(&term.coefficient) != 0.0 {
            return term;
        }
        Term { coefficient: Fraction::whole(1), node: self.node_of(sum) }
    }

    /// The absolute value of a varying sum. The size of a constant factor is taken out.
    pub(super) fn absolute(&mut self, argument: &Sum) -> Sum {
        let Term { coefficient, node } = self.factored(argument);
        Sum::term(&absolute(&coefficient), self.add(Operation::Absolute(node)))
    }

    /// 1 if a varying sum is 0 or more, otherwise another number.
    pub(super) fn switch(&mut self, argument: &Sum, below_0: i64) -> NodeId {
        let input = self.with_same_sign(argument);
        let (at_least_0, below_0) = (Fraction::whole(1), Fraction::whole(below_0));
        self.add(Operation::Switch { input, at_least_0, below_0 })
    }

    /// A node with the sign of a varying sum: without its constant factor, if that is positive.
    fn with_same_sign(&mut self, argument: &Sum) -> NodeId {
        let Term { coefficient, node } = self.factored(argument);
        if self.constants.is_positive(&coefficient) { node } else { self.node_of(argument) }
    }

    /// The larger of two sums, at least one of which varies.
    fn maximum(&mut self, first: &Sum, second: &Sum) -> Sum {
        match [first.as_constant(), second.as_constant()] {
            [Some(bound), _] => self.limited(second, Some(bound), None),
            [_, Some(bound)] => self.limited(first, Some(bound), None),
            [None, None] => {
                let pair = self.positive_pair(first, second);
                Sum::node(self.add(Operation::Higher(pair)))
            }
        }
    }

    /// The smaller of two sums, at least one of which varies.
    fn minimum(&mut self, first: &Sum, second: &Sum) -> Sum {
        match [first.as_constant(), second.as_constant()] {
            [Some(bound), _] => self.limited(second, None, Some(bound)),
            [_, Some(bound)] => self.limited(first, None, Some(bound)),
            [None, None] => {
                let pair = self.positive_pair(first, second);
                Sum::node(self.add(Operation::Lower(pair)))
            }
        }
    }

    /// A sum between two bounds. At least one of the three varies.
    fn limit(&mut self, argument: &Sum, lower: &Sum, upper: &Sum) -> Sum {
        match [argument, lower, upper].map(Sum::as_constant) {
            [None, Some(lower), Some(upper)] if self.is_below(&lower, &upper) => {
                self.limited(argument, Some(lower), Some(upper))
            }
            [Some(value), Some(low), None] => self.minimum(&Sum::constant(&value.maximum(&low)), upper),
            _ => {
                let raised = self.maximum(argument, lower);
                self.minimum(&raised, upper)
            }
        }
    }

    /// A varying sum with constant bounds. The upper bound of a node with a lower bound belongs to the same node, if it is
    /// the larger one. A limiter has no other bounds.
    fn limited(&mut self, sum: &Sum, lower: Option<Fraction>, upper: Option<Fraction>) -> Sum {
        let bounded = sum.as_node().and_then(|node| self.entry(node).operation.clone());
        let operation = match (bounded, lower, upper) {
            (Some(Operation::Limited { sum, lower: Some(inner), upper: None }), None, Some(upper))
                if self.is_below(&inner, &upper) =>
            {
                Operation::Limited { sum, lower: Some(inner), upper: Some(upper) }
            }
            (_, lower, upper) => Operation::Limited { sum: sum.clone(), lower, upper },
        };
        Sum::node(self.add(operation))
    }

    /// Whether a constant is below another one at present.
    fn is_below(&self, lower: &Fraction, upper: &Fraction) -> bool {
        self.constants.value(lower) < self.constants.value(upper)
    }

    /// Two varying sums with positive constant factors, in ascending order.
    fn positive_pair(&mut self, first: &Sum, second: &Sum) -> [Term; 2] {
        let mut pair = [self.positive_term(first), self.positive_term(second)];
        pair.sort_unstable();
        pair
    }

    /// A varying sum as a positive constant times a node.
    fn positive_term(&mut self, sum: &Sum) -> Term {
        let term = self.factored(sum);
        if self.constants.is_positive(&term.coefficient) {
            return term;
        }
        Term { coefficient: Fraction::whole(1), node: self.node_of(sum) }
    }

    /// The dead zone of a sum. A number in front of a node is taken out.
    fn dead_zone(&mut self, argument: &Sum, width: &Sum) -> Sum {
        if let Some(argument) = argument.as_constant() {
            // The excess of a constant over a width that varies.
            let above = Sum::constant(&argument).minus(width);
            let below = Sum::constant(&argument).plus(width);
            let zero = Sum::default();
            return self.maximum(&above, &zero).plus(&self.minimum(&below, &zero));
        }
        let width = match width.as_constant() {
            Some(coefficient) => Term { coefficient, node: ONE },
            None => self.positive_term(width),
        };
        let Term { coefficient, node } = self.factored(argument);
        if coefficient.as_rational().is_none() {
            let input = self.node_of(argument);
            return Sum::node(self.add(Operation::DeadZone { input, width }));
        }
        let narrower = width.coefficient.over(&absolute(&coefficient));
        let width = Term { coefficient: narrower, node: width.node };
        Sum::term(&coefficient, self.add(Operation::DeadZone { input: node, width }))
    }

    /// A table of the problem. The points of a function generator are numbers, so parameters of the argument are in front
    /// of it.
    fn curve(&mut self, table: &str, argument: &Sum) -> Sum {
        let mut input = self.factored(argument);
        if self.constants.has_parameters(&input.coefficient) {
            input = Term { coefficient: Fraction::whole(1), node: self.node_of(argument) };
        }
        Sum::node(self.add(Operation::Curve { table: table.to_owned(), input }))
    }
}
