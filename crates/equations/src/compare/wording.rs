//! The outcomes of comparisons as texts.

use patchcord_expr::{Dimension, round_significant, split_primes};

use super::Agreement;
use super::comparison::{Comparison, Outcome};
use super::expanded::MAX_DEPTH;
use super::model::Obstacle;
use super::numerical::Difference;
use super::terms::{DifferenceKind, TermDifference, is_negative};
use crate::derive::LawKind;
use crate::notation::{Notation, text};
use crate::symbolic::{Fraction, Symbol};
use crate::writing::Writer;

impl Obstacle {
    /// The obstacle as a clause.
    pub(super) fn text(&self) -> String {
        match self {
            Obstacle::Unknown(name) => format!("{name} is not known"),
            Obstacle::Implicit(name) => {
                format!(
                    "{name} is the solution of a loop without a formula, and its value is known at few states"
                )
            }
            Obstacle::Deviation(share) => {
                format!("its sides differ by at most {share} of their terms, as by the rounding of a setting")
            }
            Obstacle::TooDeep(name) => {
                format!("the formula of {name} has more than {MAX_DEPTH} functions inside each other")
            }
            Obstacle::Unsettled(name) => {
                format!("the value at t = 0 depends on {name}, which is no parameter")
            }
        }
    }
}

impl Comparison<'_> {
    /// An outcome as texts.
    pub(super) fn agreement(&self, outcome: Outcome) -> Agreement {
        match outcome {
            Outcome::Solved => Agreement::Solved,
            Outcome::SolvedAt(names) => Agreement::SolvedAt(names),
            Outcome::SolvedNumerically(states) => Agreement::SolvedNumerically(states),
            Outcome::Terms { name, terms, wired } => self.different_terms(&name, &terms, &wired),
            Outcome::InitialValue { name, stated, wired } => {
                self.different_initial_value(&name, [&stated, &wired])
            }
            Outcome::Sides(left, right) => self.different_sides([&left, &right]),
            Outcome::Values { difference, implicit } => self.different_values(&difference, implicit),
            Outcome::NoValue => Agreement::Undecided("it has no value at most voltages".to_owned()),
        }
    }

    /// The agreement for a quantity whose terms differ.
    fn different_terms(&self, name: &str, found: &[TermDifference], wired: &Fraction) -> Agreement {
        let dimension = self.circuit.equation_dimension(name);
        let writer = Writer::new(self.circuit, &self.model.system);
        let write = |value: &Fraction| text(&writer.expression(value, dimension));
        let time_scale = self.circuit.time_scale();
        let clauses = found.iter().take(MAX_CLAUSES);
        let mut differences: Vec<String> =
            clauses.map(|difference| clause(difference, time_scale, &write)).collect();
        if let Some(more @ 1..) = found.len().checked_sub(MAX_CLAUSES) {
            differences.push(format!("{more} more terms differ"));
        }
        let (base, primes) = split_primes(name);
        let left = Notation::Name { name: base.to_owned(), primes: u8::try_from(primes).unwrap_or(u8::MAX) };
        let wired = if wired.size() > MAX_WIRED_TERMS {
            OTHER_EQUATION.to_owned()
        } else {
            format!("{} = {}", text(&left), write(wired))
        };
        Agreement::Different { differences, wired }
    }

    /// The agreement for a quantity with another initial value: the stated one and that of the wiring.
    fn different_initial_value(&self, name: &str, values: [&Fraction; 2]) -> Agreement {
        let dimension = self.circuit.equation_dimension(name);
        let writer = Writer::new(self.circuit, &self.model.system);
        let [stated, wired] = values.map(|value| text(&writer.expression(value, dimension)));
        let differences = vec![format!("{name} is {wired} at t = 0, and should be {stated}")];
        Agreement::Different { differences, wired: format!("{name}(0) = {wired}") }
    }

    /// The agreement of an equation that is not solved for a quantity and has unequal sides.
    fn different_sides(&self, sides: [&Fraction; 2]) -> Agreement {
        let writer = Writer::new(self.circuit, &self.model.system);
        let [left, right] = sides.map(|side| text(&writer.expression(side, writer.dimension(side))));
        let differences =
            vec![format!("in the wiring, the left side is {left} and the right side is {right}")];
        Agreement::Different { differences, wired: format!("{left} = {right} at some instants only") }
    }

    /// The agreement of an equation whose sides have different values at a state. `implicit` is a quantity behind it
    /// that has no formula: the wiring solves its loop.
    fn different_values(&self, difference: &Difference, implicit: Option<Symbol>) -> Agreement {
        let writer = Writer::new(self.circuit, &self.model.system);
        let write = |value: f64, dimension: Option<Dimension>| {
            let rounded = Fraction::number(round_significant(value, VALUE_DIGITS));
            text(&writer.expression(&rounded, dimension))
        };
        let quantity = |(name, value): &(String, f64)| {
            format!("{name} = {}", write(*value, self.circuit.equation_dimension(name)))
        };
        let quantities: Vec<String> = difference.quantities.iter().map(quantity).collect();
        let [left, right] = difference.sides.map(|(value, dimension)| write(value, dimension));
        let state = if quantities.is_empty() { "a state".to_owned() } else { quantities.join(", ") };
        let clause = format!("at {state}, the left side is {left} and the right side is {right}");
        let law = implicit.and_then(|symbol| match self.model.system.law(symbol)? {
            LawKind::Implicit(residual) => Some(writer.implicit(symbol, residual)),
            _ => None,
        });
        let wired = match law {
            Some(law) => format!("{} = {}", text(&law.left), text(&law.right)),
            None => OTHER_EQUATION.to_owned(),
        };
        Agreement::Different { differences: vec![clause], wired }
    }
}

/// Differences that are listed at most.
const MAX_CLAUSES: usize = 8;
/// Terms of an equation of the wiring that is written, at most.
const MAX_WIRED_TERMS: usize = 100;
/// What the wiring solves, if its equation is not written.
const OTHER_EQUATION: &str = "another equation";
/// Significant digits of a value in a message.
const VALUE_DIGITS: usize = 4;

/// A difference as a clause.
fn clause(difference: &TermDifference, time_scale: f64, write: &dyn Fn(&Fraction) -> String) -> String {
    let size = |value: &Fraction| write(&if is_negative(value) { value.negated() } else { value.clone() });
    match difference.kind {
        DifferenceKind::Sign => format!("the sign of {} is wrong", size(&difference.stated)),
        DifferenceKind::Missing => format!("the term {} is missing", write(&difference.stated)),
        DifferenceKind::Extra => format!("the term {} is not in the equation", write(&difference.wired)),
        DifferenceKind::Factor(factor) => {
            let sign = if factor < 0.0 { "has the wrong sign and " } else { "" };
            let (times, word) =
                if factor.abs() < 1.0 { (1.0 / factor.abs(), "small") } else { (factor.abs(), "large") };
            let times = patchcord_expr::format_significant(times, FACTOR_DIGITS);
            let reason = if is_power_of(factor.abs(), time_scale) { ", by the time scale" } else { "" };
            let is = if sign.is_empty() { "is" } else { "and is" };
            let sign = sign.trim_end_matches("and ");
            format!("the term {} {sign}{is} {times} times too {word}{reason}", write(&difference.stated))
        }
    }
}

/// Significant digits of a factor in a message.
const FACTOR_DIGITS: usize = 4;

/// Whether a factor is the time scale, its square, or the reciprocal of either.
fn is_power_of(factor: f64, time_scale: f64) -> bool {
    let is_near = |power: i32| (factor / time_scale.powi(power) - 1.0).abs() < 1e-9;
    time_scale != 1.0 && [-2, -1, 1, 2].into_iter().any(is_near)
}
