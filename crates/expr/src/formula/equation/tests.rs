//! Unit tests of equations, and the names that they use.

mod faults;
mod random;
mod suggestions;
mod syntax;
mod units;
mod values;

use super::{Equation, Expression, FormulaError, Node, Scope, split_primes};
use crate::formula::expression::Operator;
use crate::units::{Dimension, Unit};

/// The tables of the tests.
const TABLES: [&str; 1] = ["friction"];

/// The names of the tests with their values and units. Names with primes are derived from them.
const NAMES: [(&str, Option<f64>, &str); 9] = [
    ("x", Some(0.5), "m"),
    ("v", Some(-2.0), "m/s"),
    ("m", Some(4.0), "kg"),
    ("k", Some(10.0), "N/m"),
    ("c", Some(3.0), "N s/m"),
    ("F", Some(7.0), "N"),
    ("u", Some(0.25), "1"),
    ("T", Some(0.2), "s"),
    ("t", None, "s"),
];

/// The scope of [`NAMES`]. The table `friction` gives a force for a velocity.
struct TestScope {
    /// The dimension of a time.
    time: Dimension,
}

impl Scope for TestScope {
    fn value(&self, name: &str) -> Option<f64> {
        NAMES.iter().find(|entry| entry.0 == name)?.1
    }

    fn dimension(&self, name: &str) -> Option<Dimension> {
        let (base, order) = split_primes(name);
        let entry = NAMES.iter().find(|entry| entry.0 == base)?;
        let dimension = Unit::parse(entry.2).ok()?.dimension();
        Some(dimension.over(self.time.power(order as f64)))
    }

    fn declared_unit(&self, name: &str) -> Option<&str> {
        NAMES.iter().find(|entry| entry.0 == name).map(|entry| entry.2)
    }

    fn table(&self, name: &str) -> Option<(Dimension, Dimension)> {
        (name == "friction").then_some((Dimension::LENGTH.over(Dimension::TIME), Dimension::FORCE))
    }

    fn time(&self) -> Dimension {
        self.time
    }

    fn names(&self) -> Vec<&str> {
        NAMES.iter().map(|entry| entry.0).collect()
    }
}

const SCOPE: TestScope = TestScope { time: Dimension::TIME };

fn equation(text: &str) -> Equation {
    Equation::parse(text, &TABLES).unwrap_or_else(|error| panic!("{text}: {error}"))
}

/// The tree of a node, with parentheses around every operation.
fn shape(node: &Node) -> String {
    let list = |nodes: &[Node]| nodes.iter().map(shape).collect::<Vec<_>>().join(", ");
    match &node.expression {
        Expression::Number(value) => value.to_string(),
        Expression::Name(name) => name.clone(),
        Expression::Negate(inner) => format!("(-{})", shape(inner)),
        Expression::Binary(operator, left, right) => {
            let sign = match operator {
                Operator::Add => "+",
                Operator::Subtract => "-",
                Operator::Multiply => "*",
                Operator::Divide => "/",
                Operator::Power => "^",
            };
            format!("({} {sign} {})", shape(left), shape(right))
        }
        Expression::Call(callee, arguments) => format!("{}[{}]", callee.name(), list(arguments)),
        Expression::Apply(name, arguments) => format!("{name}<{}>", list(arguments)),
    }
}

/// The tree of the right side of `y = text`.
fn right(text: &str) -> String {
    shape(equation(&format!("y = {text}")).right())
}

/// The part of the text at fault, the message and the hint.
fn fault(result: Result<impl std::fmt::Debug, FormulaError>, text: &str) -> (String, String, String) {
    let error = result.expect_err(text);
    (text[error.range].to_owned(), error.message, error.hint.unwrap_or_default())
}

/// Asserts the part at fault, the message and the hint of texts that are not equations.
fn assert_faults(cases: &[(&str, &str, &str, &str)]) {
    for (text, part, message, hint) in cases {
        let expected = ((*part).to_owned(), (*message).to_owned(), (*hint).to_owned());
        assert_eq!(fault(Equation::parse(text, &TABLES), text), expected, "{text}");
    }
}
