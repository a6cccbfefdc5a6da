//! The comparison of a stated equation with one model of the wiring.

use std::collections::HashSet;

use patchcord_core::circuit::Circuit;
use patchcord_core::ir::Program;
use patchcord_expr::{Equation, split_primes};

use super::corners::equal_between_corners;
use super::delays::{with_delay_times, with_delay_variables};
use super::expansions::TimeLaws;
use super::intended::fraction;
use super::model::{Model, Obstacle};
use super::numerical::Difference;
use super::points::{ParameterValues, Point, ROUNDING, equal_at_points};
use super::rounded::without_rounded;
use super::solution::Solved;
use super::terms::{DifferenceKind, TermDifference, differences};
use crate::derive::LawKind;
use crate::symbolic::{Fraction, Symbol, value};

/// A comparison in progress.
pub(super) struct Comparison<'a> {
    pub circuit: &'a Circuit,
    program: &'a Program,
    /// Values of the coefficients of the program.
    coefficients: Vec<f64>,
    /// Length of the run in seconds.
    duration: f64,
    pub model: Model<'a>,
}

/// Length of a run that the patch does not state, in seconds.
const DURATION: f64 = 10.0;

/// The outcome of a comparison.
pub(super) enum Outcome {
    /// The wiring solves the equation.
    Solved,
    /// The wiring solves the equation for the present values of these parameters only.
    SolvedAt(Vec<String>),
    /// The wiring solves the equation at this number of states.
    SolvedNumerically(usize),
    /// Terms of a quantity differ.
    Terms {
        /// The quantity, with its primes.
        name: String,
        /// The terms that differ.
        terms: Vec<TermDifference>,
        /// The expression that the wiring has for the quantity.
        wired: Fraction,
    },
    /// A quantity has another initial value.
    InitialValue {
        /// The quantity, with its primes.
        name: String,
        /// The stated value.
        stated: Fraction,
        /// The value that the wiring gives.
        wired: Fraction,
    },
    /// The two sides of the equation differ, which is solved for no quantity.
    Sides(Fraction, Fraction),
    /// The two sides have different values at a state.
    Values {
        /// The state.
        difference: Difference,
        /// A quantity behind the equation that has no formula. `None` if it is not known.
        implicit: Option<Symbol>,
    },
    /// The sides have no value at most voltages.
    NoValue,
}

impl Outcome {
    /// Whether the wiring solves another equation.
    pub(super) fn is_different(&self) -> bool {
        !self.is_solved() && !matches!(self, Outcome::NoValue)
    }

    /// Whether the wiring solves the equation, at least for the present values of the parameters.
    pub(super) fn is_solved(&self) -> bool {
        matches!(self, Outcome::Solved | Outcome::SolvedAt(_) | Outcome::SolvedNumerically(_))
    }
}

impl<'a> Comparison<'a> {
    /// A comparison with the wiring of a circuit. `stays_in_range` is whether squaring networks and logarithms count as
    /// within their range.
    pub(super) fn new(circuit: &'a Circuit, program: &'a Program, stays_in_range: bool) -> Self {
        let model = Model::new(circuit, program, stays_in_range);
        let duration = circuit.run_plan().duration.as_ref().map_or(DURATION, |duration| duration.value);
        Comparison { circuit, program, coefficients: program.coefficient_values(), duration, model }
    }

    /// Whether the wiring solves an equation. It may name drives and ramps, or write out their laws of time.
    pub(super) fn outcome(&mut self, equation: &Equation) -> Result<Outcome, Obstacle> {
        self.model.limited.clear();
        // A ramp of the wiring can stand for the time of the equation.
        let ramps = self.model.has_ramps() && self.model.is_explicit_in_time(equation);
        let found = self.outcome_with(TimeLaws { drives: false, ramps }, equation);
        if matches!(found, Ok(Outcome::Solved | Outcome::SolvedAt(_)))
            || self.circuit.patch().drives.is_empty()
        {
            return found;
        }
        let expanded = self.outcome_with(TimeLaws { drives: true, ramps }, equation);
        // A drive that is 0 at present would hide a cord that is missing, so equality for the present parameters is not
        // enough here.
        match (&found, &expanded) {
            (_, Ok(Outcome::Solved)) | (Ok(Outcome::NoValue) | Err(_), Ok(_)) => expanded,
            (Ok(named), Ok(by_laws))
                if equation.names().contains(&"t") && shows_more_clearly(by_laws, named) =>
            {
                expanded
            }
            _ => found,
        }
    }

    /// Whether the wiring solves an equation in which these quantities are expanded into their laws of time.
    fn outcome_with(&mut self, time_laws: TimeLaws, equation: &Equation) -> Result<Outcome, Obstacle> {
        self.model.set_time_laws(time_laws);
        let found = self.outcome_in_model(equation);
        self.model.set_time_laws(TimeLaws::default());
        found
    }

    /// Whether the wiring solves an equation, with drives and ramps as the model takes them.
    fn outcome_in_model(&mut self, equation: &Equation) -> Result<Outcome, Obstacle> {
        if let Some(initial) = equation.initial_quantity() {
            return self.initial_outcome(equation, initial);
        }
        let none = HashSet::new();
        let [left, right] = [equation.left(), equation.right()]
            .map(|side| fraction(side, &mut |name| self.model.named(name, &none)));
        let sides = [left?, right?];
        if sides[0] == sides[1] {
            return Ok(Outcome::Solved);
        }
        let are_equal = equal_at_points(self.point(ParameterValues::Present), sides.each_ref());
        // Different values are found faster than a difference in normal form. They do not decide if the wiring has a loop
        // that makes both sides equal.
        if are_equal != Some(false) || self.has_implicit_laws() {
            let residual = sides[0].minus(&sides[1]);
            if residual.is_zero() || self.is_implicit_law(&residual) {
                return Ok(Outcome::Solved);
            }
        }
        match self.solved(equation)? {
            Some(solved) => self.solved_outcome(equation, &solved, are_equal),
            None => self.unsolved_outcome(sides, are_equal),
        }
    }

    /// The outcome for an equation that is solved for a quantity. `are_equal` is whether its sides are equal at points.
    fn solved_outcome(
        &mut self,
        equation: &Equation,
        solved: &Solved,
        are_equal: Option<bool>,
    ) -> Result<Outcome, Obstacle> {
        let kept = self.kept(equation, &solved.name);
        let wired = self.model.named(&solved.name, &kept)?;
        let Solved { name, value: stated, .. } = solved;
        // Kept signals can differ although the sides are equal: the wiring may compute such a signal twice.
        if are_equal == Some(false)
            && let Some(term) = self.wrong_term(equation, solved, &wired, &kept)
        {
            return Ok(Outcome::Terms { name: name.clone(), terms: vec![term], wired });
        }
        let terms = self.differences(ParameterValues::Present, [stated, &wired]);
        if terms.is_empty() {
            return Ok(self.solved_generally([stated, &wired]));
        }
        // Signals in the equation are wired correctly or not; a difference that remains without them is in this one.
        if self.are_equal(ParameterValues::Present, [stated, &wired]) == Some(true) {
            return Ok(self.solved_generally([stated, &wired]));
        }
        if !kept.is_empty() {
            let none = HashSet::new();
            let full = [self.model.expanded_fraction(stated, &none), self.model.named(name, &none)?];
            let sides = full.each_ref();
            if self.differences(ParameterValues::Present, sides).is_empty()
                || self.are_equal(ParameterValues::Present, sides) == Some(true)
            {
                return Ok(self.solved_generally(sides));
            }
        }
        Ok(Outcome::Terms { name: name.clone(), terms, wired })
    }

    /// The outcome for an equation that is solved for no quantity. `are_equal` is whether its sides are equal at points.
    fn unsolved_outcome(
        &self,
        [left, right]: [Fraction; 2],
        are_equal: Option<bool>,
    ) -> Result<Outcome, Obstacle> {
        let residual = left.minus(&right);
        if let Some(symbol) = self.implicit_symbol(&residual) {
            return Err(Obstacle::Implicit(self.model.system.symbols.entry(symbol).name.clone()));
        }
        Ok(match are_equal {
            Some(true) if self.are_equal(ParameterValues::Present, [&left, &right]) == Some(true) => {
                self.solved_generally([&left, &right])
            }
            Some(_) if residual.is_zero() => Outcome::Solved,
            Some(_) => Outcome::Sides(left, right),
            None => Outcome::NoValue,
        })
    }

    /// Whether the wiring has loops without a formula.
    fn has_implicit_laws(&self) -> bool {
        self.model.system.laws.iter().any(|law| matches!(law.kind, LawKind::Implicit(_)))
    }

    /// Whether an expression is 0 because a loop of the wiring makes it 0: it is a constant times the residual of the
    /// loop.
    fn is_implicit_law(&mut self, residual: &Fraction) -> bool {
        let implicit = self.model.system.laws.iter().filter_map(|law| match &law.kind {
            LawKind::Implicit(value) => Some(value.clone()),
            _ => None,
        });
        let implicit: Vec<Fraction> = implicit.collect();
        let none = HashSet::new();
        implicit.iter().any(|law| {
            let law = self.model.expanded_fraction(law, &none);
            !law.is_zero() && residual.over(&law).is_constant()
        })
    }

    /// The first quantity in an expression that a loop without a formula determines.
    fn implicit_symbol(&self, value: &Fraction) -> Option<Symbol> {
        let mut found = None;
        value.contains(&mut |symbol| {
            let is_implicit = matches!(self.model.system.law(symbol), Some(LawKind::Implicit(_)));
            if is_implicit {
                found = Some(symbol);
            }
            is_implicit
        });
        found
    }

    /// The first quantity behind an equation that a loop without a formula determines. `None` if all have formulas.
    pub(super) fn implicit_in(&mut self, equation: &Equation) -> Option<Symbol> {
        let none = HashSet::new();
        for side in [equation.left(), equation.right()] {
            let value = fraction(side, &mut |name| self.model.named(name, &none));
            let found = match value {
                Ok(value) => self.implicit_symbol(&value),
                Err(Obstacle::Implicit(name)) => self.model.system.symbols.find_variable(&name, 0),
                Err(_) => None,
            };
            if found.is_some() {
                return found;
            }
        }
        None
    }

    /// The obstacle to the comparison of an equation with a quantity that has neither a formula nor values.
    pub(super) fn implicit_obstacle(&mut self, equation: &Equation) -> Obstacle {
        let symbol = self.implicit_in(equation);
        let name = symbol.map(|symbol| self.model.system.symbols.entry(symbol).name.clone());
        Obstacle::Implicit(name.unwrap_or_default())
    }

    /// Whether different terms have a meaning for the reader of an equation: it names every quantity in them that has no
    /// formula.
    pub(super) fn has_readable_terms(&self, equation: &Equation, outcome: &Outcome) -> bool {
        let Outcome::Terms { name: solved, wired, .. } = outcome else { return false };
        let (names, solved) = (equation.names(), split_primes(solved).0);
        !wired.contains(&mut |symbol| {
            let name = self.model.system.symbols.entry(symbol).name.as_str();
            let is_implicit = matches!(self.model.system.law(symbol), Some(LawKind::Implicit(_)));
            is_implicit && (name == solved || !names.contains(&name))
        })
    }

    /// Whether a quantity has its stated initial value.
    fn initial_outcome(&mut self, equation: &Equation, name: &str) -> Result<Outcome, Obstacle> {
        let (base, primes) = split_primes(name);
        let none = HashSet::new();
        let stated = fraction(equation.right(), &mut |name| self.model.named(name, &none))?;
        let wired = self.model.initial(base, primes)?;
        if self.differences(ParameterValues::Present, [&stated, &wired]).is_empty() {
            return Ok(self.solved_generally([&stated, &wired]));
        }
        Ok(Outcome::InitialValue { name: name.to_owned(), stated, wired })
    }

    /// The factors by which terms are wrong: wired / stated, for the present values of the parameters.
    pub(super) fn factors(&self, outcome: &Outcome) -> Vec<f64> {
        match outcome {
            Outcome::Terms { terms, .. } => {
                let factor = |term: &TermDifference| match term.kind {
                    DifferenceKind::Factor(factor) => Some(factor),
                    _ => None,
                };
                terms.iter().filter_map(factor).collect()
            }
            Outcome::InitialValue { stated, wired, .. } => {
                let point = self.point(ParameterValues::Present);
                let [stated, wired] = [stated, wired].map(|side| value(side, &point));
                vec![wired / stated]
            }
            _ => Vec::new(),
        }
    }

    /// The terms in which a stated and a wired expression differ.
    fn differences(
        &self,
        parameters: ParameterValues,
        [stated, wired]: [&Fraction; 2],
    ) -> Vec<TermDifference> {
        let point = self.point(parameters);
        let found = differences(stated, wired, &point);
        if !found.is_empty()
            && let Some([stated, wired]) = with_delay_times([stated, wired], &point)
            && differences(&stated, &wired, &point).is_empty()
        {
            return Vec::new();
        }
        without_rounded(found, point)
    }

    /// Whether two expressions are equal at points, see [`equal_at_points`], and within short intervals. Delays can have any
    /// values there.
    fn are_equal(&self, parameters: ParameterValues, sides: [&Fraction; 2]) -> Option<bool> {
        let point = self.point(parameters);
        let with_variables = with_delay_variables(sides, &point, &self.model.delayed);
        let sides = with_variables.as_ref().map_or(sides, |sides| sides.each_ref());
        let are_equal = equal_at_points(point, sides)?;
        Some(are_equal && equal_between_corners(point, sides, ROUNDING))
    }

    /// A point with these values of the parameters.
    pub(super) fn point(&self, parameters: ParameterValues) -> Point<'_> {
        let (system, program, coefficients) = (&self.model.system, self.program, &self.coefficients);
        Point { system, program, coefficients, parameters, duration: self.duration, index: 0 }
    }

    /// The outcome for two sides that are equal for the present values of the parameters: also for others, or not.
    fn solved_generally(&self, sides: [&Fraction; 2]) -> Outcome {
        if self.differences(ParameterValues::Other, sides).is_empty()
            || self.are_equal(ParameterValues::Other, sides) == Some(true)
        {
            return Outcome::Solved;
        }
        Outcome::SolvedAt(self.model.parameters_in(sides))
    }
}

/// Whether an outcome with the laws of drives shows a difference more clearly than one with their names. The equation
/// writes out laws of time, so the name of a drive is an extra term, and a law is a missing one.
fn shows_more_clearly(by_laws: &Outcome, named: &Outcome) -> bool {
    match (by_laws, named) {
        (Outcome::Terms { terms: fewer, .. }, Outcome::Terms { terms, .. }) => fewer.len() < terms.len(),
        (Outcome::Sides(..), Outcome::Sides(..)) => true,
        _ => false,
    }
}
