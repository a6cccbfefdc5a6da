//! Compares the equations that a patch states with those that its wiring solves.
//!
//! Both sides of a stated equation are expressed by the states, drives and parameters of the wiring. If the difference is
//! 0 in normal form, the wiring solves the equation. Otherwise the equation is solved for the highest derivative on its
//! left, and compared with the wiring term by term for the present values of the parameters.

mod comparison;
mod conditions;
mod expansions;
pub(crate) mod intended;
mod model;
mod points;
mod terms;
mod wording;

use std::collections::HashSet;

use patchcord_core::circuit::Circuit;
use patchcord_core::ir::Program;

use comparison::{Comparison, Outcome};
pub(crate) use model::Obstacle;
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

/// Compares single equations of a circuit with its wiring. The equations of the wiring are derived once.
pub(crate) struct EquationComparer<'a> {
    circuit: &'a Circuit,
    program: &'a Program,
    /// The comparison with the wiring as it is.
    exact: Comparison<'a>,
    /// The comparison with the wiring while its squaring networks and logarithms are within their range. It is made
    /// when it is first needed.
    in_range: Option<Comparison<'a>>,
}

/// How the wiring and an equation compare, without a text.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Standing {
    /// The wiring solves the equation, perhaps only within the range of a network or the limits of an integrator.
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
        EquationComparer { circuit, program, exact: Comparison::new(circuit, program, false), in_range: None }
    }

    /// The outcome for the equation with this index, and whether the wiring solves it only within the range of its
    /// networks.
    fn outcome(&mut self, index: usize) -> Result<(Outcome, bool), Obstacle> {
        let equation = &self.circuit.equations()[index].value;
        let found = self.exact.outcome(equation)?;
        if !found.is_different() || self.exact.model.system.margins.is_empty() {
            return Ok((found, false));
        }
        let (circuit, program) = (self.circuit, self.program);
        let in_range = self.in_range.get_or_insert_with(|| Comparison::new(circuit, program, true));
        let is_solved = matches!(in_range.outcome(equation)?, Outcome::Solved);
        Ok((found, is_solved))
    }

    /// How the equation with this index and the wiring compare. No text is written, which can take long.
    pub(crate) fn standing(&mut self, index: usize) -> Standing {
        match self.outcome(index) {
            Ok((Outcome::Solved, _) | (_, true)) => Standing::Solved,
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

#[cfg(test)]
mod tests;
