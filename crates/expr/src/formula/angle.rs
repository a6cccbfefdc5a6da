//! Distinguishes angular frequencies from numbers of cycles per second.
//!
//! An angle is a pure number, so rad/s and Hz have the same dimension. The declared units of the names
//! show the difference. The power of the angle is derived from the leaves to the root. The units rad,
//! deg and rpm count as an angle, and so does the number pi, because a cycle is 2 pi rad. So
//! `w / (2 * pi)` is a number of cycles if w is in rad/s.

use std::f64::consts::{FRAC_1_PI, PI, TAU};

use super::callee::Callee;
use super::equation::EquationFunction;
use super::error::FormulaError;
use super::evaluate;
use super::expression::{Expression, Node, Operator};
use super::scope::{NoNames, Scope};
use super::unit_check::is_literal_zero;
use super::wording::excerpt;
use crate::function::Function;
use crate::number_text::format_shortest;
use crate::units::Unit;

/// Two powers that differ by less than this are equal. It covers the rounding of roots.
const POWER_TOLERANCE: f64 = 1e-9;

/// The numbers that convert angles, and the power of the angle for which each counts.
const CONVERSIONS: [(f64, f64); 8] = [
    (PI, 1.0),
    (TAU, 1.0),
    (PI / 180.0, 1.0),
    (PI / 30.0, 1.0),
    (FRAC_1_PI, -1.0),
    (0.5 * FRAC_1_PI, -1.0),
    (180.0 / PI, -1.0),
    (30.0 / PI, -1.0),
];

/// The relative difference up to which a number counts as one of [`CONVERSIONS`], so 3.14 counts as pi.
const CONVERSION_TOLERANCE: f64 = 1e-3;

/// The power of the angle at a node, or the error of the first sum whose terms differ in it.
type PowerResult = Result<f64, FormulaError>;

/// Returns whether the unit of a formula has one angle, as rad/s does.
///
/// The result is false if no name of the formula is declared in such a unit.
pub(super) fn is_angular(text: &str, root: &Node, scope: &dyn Scope) -> Result<bool, FormulaError> {
    if !root.names().into_iter().any(|name| declared_power(scope, name) > 0.0) {
        return Ok(false);
    }
    let power = AngleChecker { text, scope }.power(root)?;
    let is_angular = is_near(power, 1.0);
    if is_angular || power < POWER_TOLERANCE {
        return Ok(is_angular);
    }
    let (whole, power) = (excerpt(text, root), format_shortest(power));
    let message = format!("the unit of {whole} has rad to the power {power}");
    Err(FormulaError::new(root.range.clone(), message)
        .with_hint("an angular frequency is in rad/s, and divided by 2 * pi it is in Hz"))
}

/// Derives the powers of the angle at the nodes of one formula.
struct AngleChecker<'a> {
    /// The text of the formula, for excerpts in error messages.
    text: &'a str,
    /// The units in which the names were declared.
    scope: &'a dyn Scope,
}

impl AngleChecker<'_> {
    /// Returns the power of the angle at a node. A sign does not change it.
    fn power(&self, node: &Node) -> PowerResult {
        match &node.expression {
            Expression::Number(value) => Ok(conversion_power(*value)),
            Expression::Name(name) => Ok(declared_power(self.scope, name)),
            Expression::Negate(inner) => self.power(inner),
            Expression::Binary(operator, left, right) => self.binary(node, *operator, left, right),
            Expression::Call(callee, arguments) => self.call(node, *callee, arguments),
            Expression::Apply(name, arguments) => self.application(name, arguments),
        }
    }

    /// Returns the power of the angle of an operation.
    fn binary(&self, node: &Node, operator: Operator, left: &Node, right: &Node) -> PowerResult {
        match operator {
            Operator::Add | Operator::Subtract => self.agreeing(node, left, right),
            Operator::Multiply => Ok(self.power(left)? + self.power(right)?),
            Operator::Divide => Ok(self.power(left)? - self.power(right)?),
            Operator::Power => self.raised(left, right),
        }
    }

    /// Returns the power of the angle of a call. Functions that take pure numbers give pure numbers.
    fn call(&self, node: &Node, callee: Callee, arguments: &[Node]) -> PowerResult {
        match (callee, arguments) {
            (Callee::Absolute, [only]) => self.power(only),
            (Callee::Minimum | Callee::Maximum, [a, b]) => self.agreeing(node, a, b),
            (Callee::Function(Function::Sqrt), [only]) => Ok(0.5 * self.power(only)?),
            (Callee::Function(Function::Power), [base, exponent]) => self.raised(base, exponent),
            _ => Ok(0.0),
        }
    }

    /// Returns the power of the angle of a function of equations or a table. The functions whose value has the
    /// dimension of their first argument keep its power.
    fn application(&self, name: &str, arguments: &[Node]) -> PowerResult {
        use EquationFunction::{DeadZone, Delay, Limit};
        match (EquationFunction::from_name(name), arguments) {
            (Some(DeadZone | Delay | Limit), [first, ..]) => self.power(first),
            _ => Ok(0.0),
        }
    }

    /// Returns the common power of two terms. A literal 0 adapts to the other term.
    ///
    /// A sum of literal numbers is a pure number. Terms without an angle in the numerator need not agree:
    /// the unit of a torsional spring may be N m/rad or N m.
    fn agreeing(&self, node: &Node, left: &Node, right: &Node) -> PowerResult {
        let (a, b) = (self.power(left)?, self.power(right)?);
        if is_near(a, b) || is_literal_zero(right) {
            return Ok(a);
        }
        match (is_literal_zero(left), node.names().is_empty()) {
            (true, _) => Ok(b),
            (_, true) => Ok(0.0),
            _ if a <= 0.0 && b <= 0.0 => Ok(a.max(b)),
            _ => Err(self.disagreement(node, (left, a), (right, b))),
        }
    }

    /// Returns the error for terms that differ in the power of the angle.
    fn disagreement(&self, node: &Node, (left, a): (&Node, f64), (right, b): (&Node, f64)) -> FormulaError {
        let [left, right] = [left, right].map(|term| excerpt(self.text, term));
        let [a, b] = [a, b].map(format_shortest);
        let message =
            format!("the unit of {left} has rad to the power {a}, that of {right} to the power {b}");
        FormulaError::new(node.range.clone(), message)
            .with_hint("declare both in rad/s, or divide an angular frequency by 2 * pi first")
    }

    /// Returns the power of the angle of a base with an exponent. If the base has an angle, the exponent must
    /// consist of literal numbers.
    fn raised(&self, base: &Node, exponent: &Node) -> PowerResult {
        let power = self.power(base)?;
        if power == 0.0 {
            return Ok(0.0);
        }
        evaluate::value(self.text, exponent, &NoNames).map(|number| power * number).map_err(|_| {
            let base = excerpt(self.text, base);
            let message = format!("{base} is an angle, so its exponent must be a number");
            FormulaError::new(exponent.range.clone(), message)
        })
    }
}

/// Whether two powers are equal up to rounding.
fn is_near(a: f64, b: f64) -> bool {
    (a - b).abs() < POWER_TOLERANCE
}

/// Returns the power of the angle in the unit in which a name was declared; 0 without a declared unit.
fn declared_power(scope: &dyn Scope, name: &str) -> f64 {
    let unit = scope.declared_unit(name).and_then(|text| Unit::parse(text).ok());
    unit.map_or(0.0, |unit| unit.angle_power())
}

/// Returns the power of the angle for which a number counts; 0 if it does not convert angles.
fn conversion_power(value: f64) -> f64 {
    let is_same = |number: f64| (value / number - 1.0).abs() < CONVERSION_TOLERANCE;
    CONVERSIONS.iter().find(|(number, _)| is_same(*number)).map_or(0.0, |(_, power)| *power)
}

#[cfg(test)]
mod tests {
    use super::super::{Equation, Formula};
    use super::*;
    use crate::units::Dimension;

    /// Names with their declared units.
    const UNITS: [(&str, &str); 8] = [
        ("w", "rad/s"),
        ("n", "rpm"),
        ("f", "Hz"),
        ("d", "1/s"),
        ("phi", "deg"),
        ("T", "s"),
        ("k", "N m/rad"),
        ("J", "kg m2"),
    ];

    /// The scope of [`UNITS`].
    struct Units;

    impl Scope for Units {
        fn value(&self, _name: &str) -> Option<f64> {
            None
        }

        fn dimension(&self, name: &str) -> Option<Dimension> {
            Some(Unit::parse(self.declared_unit(name)?).ok()?.dimension())
        }

        fn declared_unit(&self, name: &str) -> Option<&str> {
            UNITS.iter().find(|(known, _)| *known == name).map(|(_, unit)| *unit)
        }

        fn names(&self) -> Vec<&str> {
            UNITS.iter().map(|(name, _)| *name).collect()
        }
    }

    fn is_angular(text: &str) -> Result<bool, FormulaError> {
        Formula::parse(text).unwrap().is_angular(&Units)
    }

    #[test]
    fn angular_frequencies_have_one_angle() {
        for text in [
            "w",
            "-n / 3",
            "phi / T",
            "w + n",
            "w + 2 * pi * f",
            "w * (1 + pi / 4)",
            "max(0, w)",
            "sqrt(w^2 - n * w)",
            "power(w^3, 1 / 3)",
            "w * phi / pi",
            "abs(w) * cos(phi)",
            "0 + w",
        ] {
            assert_eq!(is_angular(text), Ok(true), "{text}");
        }
    }

    #[test]
    fn cycles_and_formulas_without_a_unit_of_angle_are_not_angular() {
        for text in [
            "2",
            "f",
            "d",
            "2 * pi * f",
            "sqrt(k / J) / (2 * pi)",
            "sqrt(k / J - d^2)",
            "w / (2 * pi)",
            "n / 6.28",
            "0.159155 * w",
            "f + w / 2 / pi",
            "w * 57.3 / 360",
            "30 / pi * n / 60",
            "sin(phi) / T",
        ] {
            assert_eq!(is_angular(text), Ok(false), "{text}");
        }
    }

    #[test]
    fn functions_of_equations_keep_the_angle_of_their_first_argument() {
        let power = |text: &str| {
            let equation = Equation::parse(&format!("y = {text}"), &["curve"]).unwrap();
            super::is_angular(equation.text(), equation.right(), &Units)
        };
        for text in ["delay(w, T)", "limit(w, 0, n)", "dead_zone(w, n)"] {
            assert_eq!(power(text), Ok(true), "{text}");
        }
        for text in ["sign(w)", "step(w)", "curve(w)"] {
            assert_eq!(power(text), Ok(false), "{text}");
        }
    }

    #[test]
    fn other_powers_of_the_angle_are_errors() {
        let cases = [
            ("w + f", "w + f", "the unit of w has rad to the power 1, that of f to the power 0"),
            (
                "sqrt(w^2 - d^2)",
                "w^2 - d^2",
                "the unit of w^2 has rad to the power 2, that of d^2 to the power 0",
            ),
            ("w * phi", "w * phi", "the unit of w * phi has rad to the power 2"),
            ("w * pi / 180", "w * pi / 180", "the unit of w * pi / 180 has rad to the power 2"),
            ("w * phi^J", "J", "phi is an angle, so its exponent must be a number"),
        ];
        for (text, part, message) in cases {
            let error = is_angular(text).expect_err(text);
            assert_eq!((&text[error.range], error.message.as_str()), (part, message));
        }
    }
}
