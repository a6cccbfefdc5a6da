//! Reads the expressions of stated equations as exact expressions.

use std::f64::consts::PI;

use patchcord_expr::{Callee, EquationFunction, Expression, Node, Operator};

use super::model::Obstacle;
use crate::symbolic::{Fraction, absolute, call, delay, step};

/// The exact expression of a node. `resolve` gives the expression of a name.
pub(crate) fn fraction(
    node: &Node,
    resolve: &mut dyn FnMut(&str) -> Result<Fraction, Obstacle>,
) -> Result<Fraction, Obstacle> {
    Ok(match &node.expression {
        // The wiring keeps the name of pi too.
        Expression::Number(PI) => resolve("pi")?,
        Expression::Number(value) => Fraction::number(*value),
        Expression::Name(name) => resolve(name)?,
        Expression::Negate(inner) => fraction(inner, resolve)?.negated(),
        Expression::Binary(operator, left, right) => {
            let (left, right) = (fraction(left, resolve)?, fraction(right, resolve)?);
            match operator {
                Operator::Add => left.plus(&right),
                Operator::Subtract => left.minus(&right),
                Operator::Multiply => left.times(&right),
                Operator::Divide => left.over(&right),
                Operator::Power => call(patchcord_expr::Function::Power, &left, &right),
            }
        }
        Expression::Call(callee, arguments) => called(*callee, &all(arguments, resolve)?),
        Expression::Apply(name, arguments) => {
            let arguments = all(arguments, resolve)?;
            applied(name, &arguments).ok_or_else(|| Obstacle::Unknown(name.clone()))?
        }
    })
}

/// The exact expressions of several nodes.
fn all(
    nodes: &[Node],
    resolve: &mut dyn FnMut(&str) -> Result<Fraction, Obstacle>,
) -> Result<Vec<Fraction>, Obstacle> {
    nodes.iter().map(|node| fraction(node, resolve)).collect()
}

/// A function that formulas have, too.
pub(crate) fn called(callee: Callee, arguments: &[Fraction]) -> Fraction {
    match (callee, arguments) {
        (Callee::Absolute, [argument]) => absolute(argument),
        (Callee::Minimum, [first, second]) => first.minimum(second),
        (Callee::Maximum, [first, second]) => first.maximum(second),
        (Callee::Function(function), [argument]) => call(function, argument, argument),
        (Callee::Function(function), [first, second]) => call(function, first, second),
        _ => Fraction::zero(),
    }
}

/// A function that only equations have. `None` for a table.
pub(crate) fn applied(name: &str, arguments: &[Fraction]) -> Option<Fraction> {
    Some(match (EquationFunction::from_name(name)?, arguments) {
        (EquationFunction::Sign, [x]) => step(x).minus(&step(&x.negated())),
        (EquationFunction::Step, [x]) => step(x),
        (EquationFunction::DeadZone, [x, width]) => {
            let above = x.minus(width).maximum(&Fraction::zero());
            above.plus(&x.plus(width).minimum(&Fraction::zero()))
        }
        (EquationFunction::Limit, [x, low, high]) => x.maximum(low).minimum(high),
        (EquationFunction::Delay, [x, time]) => delay(x, time),
        _ => return None,
    })
}
