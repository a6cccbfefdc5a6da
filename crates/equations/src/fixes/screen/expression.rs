//! The value of an expression of an equation, and the size of its terms.

use patchcord_expr::{Callee, EquationFunction, Expression, Function, Node, Operator};

/// A value with the sum of the sizes of the terms that it consists of, for the tolerance of a comparison.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Measured {
    pub value: f64,
    pub size: f64,
}

impl Measured {
    /// A value of one term.
    fn term(value: f64) -> Self {
        Measured { value, size: value.abs() }
    }
}

/// The value of a node. `resolve` gives the value of a name. NaN if a value is not known, as that of a delay.
pub(super) fn measured(node: &Node, resolve: &dyn Fn(&str) -> f64) -> Measured {
    match &node.expression {
        Expression::Number(value) => Measured::term(*value),
        Expression::Name(name) => Measured::term(resolve(name)),
        Expression::Negate(inner) => {
            let inner = measured(inner, resolve);
            Measured { value: -inner.value, ..inner }
        }
        Expression::Binary(operator, left, right) => {
            operation(*operator, measured(left, resolve), measured(right, resolve))
        }
        Expression::Call(callee, arguments) => {
            all(arguments, resolve).map_or(UNKNOWN, |arguments| call(*callee, &arguments))
        }
        Expression::Apply(name, arguments) => {
            all(arguments, resolve).map_or(UNKNOWN, |arguments| application(name, &arguments))
        }
    }
}

/// A value that is not known.
const UNKNOWN: Measured = Measured { value: f64::NAN, size: f64::NAN };

/// The values of several nodes. `None` if one is not known: a step or a maximum of NaN would be a number.
fn all(nodes: &[Node], resolve: &dyn Fn(&str) -> f64) -> Option<Vec<Measured>> {
    let values = nodes.iter().map(|node| Some(measured(node, resolve)).filter(|found| !found.value.is_nan()));
    values.collect()
}

/// The value of an operation.
fn operation(operator: Operator, left: Measured, right: Measured) -> Measured {
    match operator {
        Operator::Add => Measured { value: left.value + right.value, size: left.size + right.size },
        Operator::Subtract => Measured { value: left.value - right.value, size: left.size + right.size },
        Operator::Multiply => Measured { value: left.value * right.value, size: left.size * right.size },
        Operator::Divide => Measured { value: left.value / right.value, size: left.size / right.value.abs() },
        Operator::Power => Measured::term(Function::Power.apply(left.value, right.value)),
    }
}

/// The value of a function of formulas.
fn call(callee: Callee, arguments: &[Measured]) -> Measured {
    let argument = |index: usize| arguments.get(index).map_or(0.0, |argument| argument.value);
    let value = callee.apply(argument(0), argument(1));
    match callee {
        Callee::Function(_) => Measured::term(value),
        Callee::Minimum | Callee::Maximum | Callee::Absolute => Measured { value, size: largest(arguments) },
    }
}

/// The value of a function of equations.
fn application(name: &str, arguments: &[Measured]) -> Measured {
    let values: Vec<f64> = arguments.iter().map(|argument| argument.value).collect();
    let function = EquationFunction::from_name(name);
    let value = function.and_then(|function| function.value(&values)).unwrap_or(f64::NAN);
    match function {
        Some(EquationFunction::DeadZone | EquationFunction::Limit) => {
            Measured { value, size: largest(arguments) }
        }
        _ => Measured::term(value),
    }
}

/// The largest size of several arguments.
fn largest(arguments: &[Measured]) -> f64 {
    arguments.iter().fold(0.0, |largest, argument| largest.max(argument.size))
}

#[cfg(test)]
mod tests {
    use patchcord_expr::Equation;

    use super::*;

    /// The right side of an equation with x = 3 and w = 5.
    fn right(text: &str) -> Measured {
        let equation = Equation::parse(text, &["friction"]).unwrap();
        measured(equation.right(), &|name: &str| match name {
            "x" => 3.0,
            "w" => 5.0,
            _ => f64::NAN,
        })
    }

    #[test]
    fn sums_have_the_size_of_their_terms() {
        assert_eq!(right("y = x - w"), Measured { value: -2.0, size: 8.0 });
        assert_eq!(right("y = -2 (x - w)"), Measured { value: 4.0, size: 16.0 });
        assert_eq!(right("y = (x + w)/(x - w)"), Measured { value: -4.0, size: 4.0 });
        assert_eq!(right("y = (x - w)^2"), Measured { value: 4.0, size: 4.0 });
    }

    #[test]
    fn functions_that_can_be_0_have_the_size_of_their_arguments() {
        assert_eq!(right("y = dead_zone(x, w)"), Measured { value: 0.0, size: 5.0 });
        assert_eq!(right("y = max(x - w, 0)"), Measured { value: 0.0, size: 8.0 });
        assert_eq!(right("y = limit(x, -1, 1)"), Measured { value: 1.0, size: 3.0 });
        assert_eq!(right("y = sign(x)"), Measured { value: 1.0, size: 1.0 });
    }

    #[test]
    fn unknown_values_are_no_numbers() {
        let terms = ["y = z", "y = delay(x, w)", "y = friction(x)", "y = 2 x + z"];
        let functions = [
            "y = step(z)",
            "y = sign(delay(x, w))",
            "y = max(z, 0)",
            "y = min(1, z)",
            "y = x + dead_zone(z, 1)",
            "y = limit(friction(x), 0, 1)",
        ];
        for text in terms.into_iter().chain(functions) {
            assert!(right(text).value.is_nan(), "{text}");
        }
    }
}
