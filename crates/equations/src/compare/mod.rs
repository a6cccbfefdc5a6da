//! Compares the equations that a patch states with those that its wiring solves.
//!
//! Both sides of a stated equation are expressed by the states, drives and parameters of the wiring. If the difference is
//! 0 in normal form, the wiring solves the equation. Otherwise the equation is solved for the highest derivative on its
//! left, and compared with the wiring term by term for the present values of the parameters. If a quantity has no formula,
//! as the output of an open amplifier with a sine in its feedback, the sides are compared at states of the machine.

mod comparison;
mod conditions;
mod corners;
mod delays;
mod expanded;
mod expansions;
pub(crate) mod intended;
mod model;
mod numerical;
mod points;
mod rounded;
mod solution;
mod terms;
mod wording;
mod wrong_term;

use std::collections::HashSet;

use patchcord_core::circuit::Circuit;
use patchcord_core::ir::Program;
use patchcord_expr::{Equation, format_significant};

use comparison::{Comparison, Outcome};
pub(crate) use model::Obstacle;
use numerical::{Numerical, Verdict};
pub(crate) use points::{GOLDEN, other_value};

/// A stated equation, compared with the wiring.
#[derive(Debug, Clone, PartialEq)]
pub struct ComparedEquation {
    /// Its index among the equations of the patch.
    pub index: usize,
    /// Whether the wiring solves it.
    pub agreement: Agreement,
}

/// Whether the wiring solves a stated equation.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum Agreement {
    /// The wiring solves it.
    Solved,
    /// The wiring solves it while the inputs of its squaring networks and logarithms are within their range, and its
    /// integrators within their limits. Each condition is a text, such as "u >= 0".
    SolvedIf(Vec<String>),
    /// The wiring solves it at this number of states of the machine. A quantity in it has no formula, as the output of an
    /// open amplifier with a sine in its feedback, so its sides were compared numerically.
    SolvedNumerically(usize),
    /// The wiring solves it for the present values of these parameters, but not for others: a setting is a number, or
    /// lacks a parameter.
    SolvedAt(Vec<String>),
    /// The wiring solves another equation.
    Different {
        /// The differences, each as a clause, such as "the sign of (k/m) x is wrong".
        differences: Vec<String>,
        /// The equation that the wiring solves, for the same quantity.
        wired: String,
    },
    /// The comparison is not possible; the text says why.
    Undecided(String),
}

impl Agreement {
    /// Whether the wiring solves the equation for all values of the parameters.
    ///
    /// # Examples
    ///
    /// ```
    /// use patchcord_equations::Agreement;
    ///
    /// assert!(Agreement::SolvedIf(vec!["u >= 0".to_owned()]).is_solved());
    /// assert!(!Agreement::SolvedAt(vec!["k".to_owned()]).is_solved());
    /// ```
    pub fn is_solved(&self) -> bool {
        matches!(self, Agreement::Solved | Agreement::SolvedIf(_) | Agreement::SolvedNumerically(_))
    }
}

/// Compares every stated equation of a patch with its wiring, in the order of the patch.
///
/// # Examples
///
/// ```
/// use patchcord_core::circuit::Circuit;
/// use patchcord_core::ir::Program;
/// use patchcord_core::patch::Patch;
/// use patchcord_equations::{Agreement, compare_equations};
///
/// let text = r#"{"patchcord": 1, "equations": ["x' = -2 x"],
///   "scales": {"length": {"per_volt": 1, "unit": "1"}},
///   "elements": {"P1": {"kind": "pot", "in": "A1", "setting": 0.2},
///                "A1": {"kind": "integrator", "in": {"x1": ["P1"]}, "initial": 50}},
///   "signals": {"x": {"at": "A1", "scale": "length"}}}"#;
/// let circuit = Circuit::new(&Patch::parse("decay.json", text)?)?;
/// let compared = compare_equations(&circuit, &Program::new(&circuit)?);
/// let Agreement::Different { differences, wired } = &compared[0].agreement else { panic!("0.2 is not 2") };
/// assert_eq!(differences, &["the term -2 x is 10 times too small"]);
/// assert_eq!(wired, "x' = -0.2 x");
/// # Ok::<(), Box<patchcord_core::document::Report>>(())
/// ```
pub fn compare_equations(circuit: &Circuit, program: &Program) -> Vec<ComparedEquation> {
    if circuit.equations().is_empty() {
        return Vec::new();
    }
    let mut comparer = EquationComparer::new(circuit, program);
    let compared = |index| ComparedEquation { index, agreement: comparer.agreement(index) };
    (0..circuit.equations().len()).map(compared).collect()
}

/// Whether the equations of a patch name the time.
pub(crate) fn names_time(circuit: &Circuit) -> bool {
    circuit.equations().iter().any(|placed| placed.value.names().contains(&"t"))
}

/// Compares single equations of a circuit with its wiring. The equations of the wiring are derived once.
pub(crate) struct EquationComparer<'a> {
    circuit: &'a Circuit,
    program: &'a Program,
    /// The comparison with the wiring as it is.
    exact: Comparison<'a>,
    /// The comparison with the wiring while its squaring networks and logarithms are within their range. It is made
    /// when it is first needed.
    in_range: Option<Comparison<'a>>,
    /// The wiring at states of the machine. It is made when it is first needed.
    numerical: Option<Numerical<'a>>,
}

/// How the wiring and an equation compare, without a text.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Standing {
    /// The wiring solves the equation, perhaps only within the range of a network or the limits of an integrator, or as
    /// far as states of the machine were compared.
    Solved,
    /// The wiring solves the equation for the present values of some parameters only.
    SolvedAt,
    /// The wiring solves another equation.
    Different,
    /// The comparison is not possible.
    Undecided,
}

impl<'a> EquationComparer<'a> {
    /// A comparer for the equations of a circuit.
    pub(crate) fn new(circuit: &'a Circuit, program: &'a Program) -> Self {
        let exact = Comparison::new(circuit, program, false);
        EquationComparer { circuit, program, exact, in_range: None, numerical: None }
    }

    /// The outcome for the equation with this index, and whether the wiring solves it only within the range of its
    /// networks.
    fn outcome(&mut self, index: usize) -> Result<(Outcome, bool), Obstacle> {
        let equation = &self.circuit.equations()[index].value;
        let found = self.symbolic_outcome(equation);
        let is_final = match &found {
            Err(Obstacle::Implicit(_)) => false,
            Err(_) | Ok((_, true)) => true,
            Ok((Outcome::Solved, false)) => true,
            Ok((_, false)) => self.exact.implicit_in(equation).is_none(),
        };
        match found {
            found if is_final => found,
            // A factor that is 0 at present hides a quantity without a formula.
            Ok((Outcome::SolvedAt(names), _)) => {
                let present = || (Outcome::SolvedAt(names.clone()), false);
                match self.numerical_outcome(equation, Ok(present())) {
                    Ok((Outcome::SolvedNumerically(states), _)) => {
                        Ok((Outcome::SolvedNumerically(states), false))
                    }
                    _ => Ok(present()),
                }
            }
            found => self.numerical_outcome(equation, found),
        }
    }

    /// The outcome for an equation by symbolic expressions, and whether the wiring solves it only within the range of its
    /// networks.
    fn symbolic_outcome(&mut self, equation: &Equation) -> Result<(Outcome, bool), Obstacle> {
        let found = self.exact.outcome(equation)?;
        // Out of range, a function can agree for the present parameters by chance: x^a for a = 0.
        let is_certain = !found.is_different() && !matches!(found, Outcome::SolvedAt(_));
        if is_certain || self.exact.model.system.margins.is_empty() {
            return Ok((found, false));
        }
        let (circuit, program) = (self.circuit, self.program);
        let in_range = self.in_range.get_or_insert_with(|| Comparison::new(circuit, program, true));
        Ok(match in_range.outcome(equation)? {
            Outcome::Solved => (found, true),
            present @ Outcome::SolvedAt(_) => (present, false),
            _ => (found, false),
        })
    }

    /// The outcome for an equation in which a quantity has no formula, by values at states. `found` is the outcome by
    /// symbolic expressions, for which this quantity is unknown.
    fn numerical_outcome(
        &mut self,
        equation: &Equation,
        found: Result<(Outcome, bool), Obstacle>,
    ) -> Result<(Outcome, bool), Obstacle> {
        let (circuit, program) = (self.circuit, self.program);
        let numerical = self.numerical.get_or_insert_with(|| Numerical::new(circuit, program));
        let is_readable =
            found.as_ref().is_ok_and(|(outcome, _)| self.exact.has_readable_terms(equation, outcome));
        let is_timed = self.exact.model.is_explicit_in_time(equation);
        let outcome = match numerical.verdict(equation, is_timed) {
            Verdict::Equal(states) => Outcome::SolvedNumerically(states),
            Verdict::EqualAt(names) => Outcome::SolvedAt(names),
            Verdict::Near(share) => {
                let percents = format_significant(100.0 * share, DEVIATION_DIGITS);
                return Err(Obstacle::Deviation(format!("{percents} %")));
            }
            Verdict::Different(_) | Verdict::NoValues if is_readable => return found,
            Verdict::Different(difference) => {
                Outcome::Values { difference, implicit: self.exact.implicit_in(equation) }
            }
            Verdict::NoValues => {
                return Err(found.err().unwrap_or_else(|| self.exact.implicit_obstacle(equation)));
            }
        };
        Ok((outcome, false))
    }

    /// How the equation with this index and the wiring compare. No text is written, which can take long.
    pub(crate) fn standing(&mut self, index: usize) -> Standing {
        match self.outcome(index) {
            Ok((Outcome::Solved | Outcome::SolvedNumerically(_), _) | (_, true)) => Standing::Solved,
            Ok((Outcome::SolvedAt(_), _)) => Standing::SolvedAt,
            Ok((Outcome::NoValue, _)) | Err(_) => Standing::Undecided,
            Ok(_) => Standing::Different,
        }
    }

    /// How the equation with this index and the wiring compare, with texts.
    fn agreement(&mut self, index: usize) -> Agreement {
        let outcome = self.outcome(index);
        let limits = self.exact.limit_conditions();
        match outcome {
            Ok((_, true)) => {
                let equation = &self.circuit.equations()[index].value;
                Agreement::SolvedIf([self.exact.range_conditions(equation), limits].concat())
            }
            Ok((Outcome::Solved, false)) if !limits.is_empty() => Agreement::SolvedIf(limits),
            Ok((outcome, false)) => self.exact.agreement(outcome),
            Err(obstacle) => Agreement::Undecided(obstacle.text()),
        }
    }

    /// The factors by which terms of the equation with this index are wrong, for the present values of the parameters:
    /// wired / stated. Empty if no term has a wrong factor.
    pub(crate) fn factors(&mut self, index: usize) -> Vec<f64> {
        match self.outcome(index) {
            Ok((outcome, false)) => self.exact.factors(&outcome),
            _ => Vec::new(),
        }
    }

    /// For each signal of the patch, whether it varies: whether it depends on a state, a drive or time.
    pub(crate) fn varying_signals(&mut self) -> Vec<bool> {
        let none = HashSet::new();
        let model = &mut self.exact.model;
        let varies = |name: &String| {
            let value = model.quantity(name, 0, &none);
            value.is_ok_and(|value| !value.is_constant())
        };
        self.circuit.patch().signals.keys().map(varies).collect()
    }
}

/// Significant digits of a deviation in percents.
const DEVIATION_DIGITS: usize = 2;

#[cfg(test)]
mod tests;
