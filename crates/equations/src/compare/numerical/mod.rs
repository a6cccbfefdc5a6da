//! Compares an equation with the wiring at states of the machine, because a quantity in it has no formula.
//!
//! An open amplifier with a function in its feedback solves an equation, such as b sin(y) - a cos(y) = 0. Its output y is
//! a quantity without a formula. At a state, y is the value at which the inputs of the amplifier cancel, near the output
//! that the program computes. So the finite amplification does not matter. All other quantities are expressions of
//! states, drives and such outputs, also their derivatives.

mod corners;
mod outputs;
mod places;
mod question;

use std::collections::{BTreeMap, HashSet};

use patchcord_core::circuit::Circuit;
use patchcord_core::ir::{Program, ProgramPoint};
use patchcord_expr::{Dimension, Equation, split_primes};

use super::expansions::TimeLaws;
use super::model::Model;
use super::points::ParameterValues;
use super::terms::TOLERANCE;
use crate::symbolic::{Fraction, term_size, value};
use crate::writing::Writer;
use outputs::{Known, Outputs};
use places::{MIN_PLACES, Place, motion, places};
use question::{Question, has_jump};

/// Difference of two equal sides, as a share of the sum of the sizes of their terms.
const EQUAL: f64 = 1e-5;

/// The wiring of a circuit at states of the machine.
pub(super) struct Numerical<'a> {
    circuit: &'a Circuit,
    program: &'a Program,
    model: Model<'a>,
    outputs: Outputs,
    /// The points of a short motion from the initial condition.
    motion: Vec<ProgramPoint>,
    /// Whether each state is a ramp.
    ramps: Vec<bool>,
    /// The states of the machine by what follows its law of time at them. Each list is made when it is first needed.
    places: BTreeMap<TimeLaws, Vec<Place>>,
}

/// How the sides of an equation compare.
pub(super) enum Verdict {
    /// They are equal at this number of states.
    Equal(usize),
    /// They are equal for the present values of these parameters only.
    EqualAt(Vec<String>),
    /// They differ by at most this share of their terms. It can be the rounding of a setting.
    Near(f64),
    /// They differ.
    Different(Difference),
    /// They have values at few states.
    NoValues,
}

/// A state at which the sides of an equation differ.
pub(super) struct Difference {
    /// The quantities that the equation names, with their values in SI.
    pub quantities: Vec<(String, f64)>,
    /// The values of the sides in SI, with their dimensions. `None` if any dimension is right.
    pub sides: [(f64, Option<Dimension>); 2],
}

/// The sides of an equation at a state.
struct Sample {
    /// Their difference as a share of the sum of the sizes of their terms.
    difference: f64,
    /// The angles of points in them.
    angles: Vec<f64>,
}

/// The sides of an equation at all states.
#[derive(Default)]
struct Summary {
    /// The number of states at which both sides have values.
    count: usize,
    /// The largest difference, as a share.
    largest: f64,
    /// The first state at which the sides differ: its index.
    first: Option<usize>,
    /// Whether the sides are equal for other values of the parameters. `None` if they have no values there.
    is_general: Option<bool>,
}

impl<'a> Numerical<'a> {
    /// The wiring of a circuit at states near a short motion from its initial condition.
    pub(super) fn new(circuit: &'a Circuit, program: &'a Program) -> Self {
        let (model, outputs) = Model::evaluated(circuit, program, Outputs::new);
        let motion = motion(circuit, program);
        let ramps = outputs.states.iter().map(|state| model.is_ramp(*state)).collect();
        Numerical { circuit, program, model, outputs, motion, ramps, places: BTreeMap::new() }
    }

    /// Compares the sides of an equation. It may name drives or write out their laws of time. `is_timed` is whether it
    /// contains the time. Then ramps follow their laws of time.
    pub(super) fn verdict(&mut self, equation: &Equation, is_timed: bool) -> Verdict {
        let found = self.verdict_with(TimeLaws { drives: false, ramps: is_timed }, equation);
        if self.circuit.patch().drives.is_empty() || matches!(found, Verdict::Equal(_)) {
            return found;
        }
        let timed = self.verdict_with(TimeLaws { drives: true, ramps: is_timed }, equation);
        match (&found, &timed) {
            (_, Verdict::Equal(_)) | (Verdict::NoValues, _) => timed,
            _ => found,
        }
    }

    /// Compares the sides of an equation in which these quantities follow their laws of time.
    fn verdict_with(&mut self, time_laws: TimeLaws, equation: &Equation) -> Verdict {
        self.model.set_time_laws(time_laws);
        let Ok(question) = Question::new(&mut self.model, equation) else { return Verdict::NoValues };
        let (program, motion, ramps) = (self.program, &self.motion, &self.ramps);
        self.places.entry(time_laws).or_insert_with(|| places(program, motion, ramps, time_laws));
        let places = &self.places[&time_laws];
        let Summary { count, largest, first, is_general } = self.summary(&question, places);
        let different = match first {
            Some(index) => places.get(index).cloned(),
            None if count < MIN_PLACES => None,
            None => self.different_between_corners(&question, time_laws, places),
        };
        match (different, is_general) {
            (Some(place), _) => self.difference(equation, &question, &place),
            _ if count < MIN_PLACES => Verdict::NoValues,
            _ if largest > EQUAL => Verdict::Near(largest),
            // A drive that is 0 at present would hide a cord that is missing.
            (None, Some(false)) => Verdict::EqualAt(question.parameters(&self.model)),
            (None, None) if time_laws.drives => Verdict::NoValues,
            _ => Verdict::Equal(count),
        }
    }

    /// The sides of an equation at all states.
    fn summary(&self, question: &Question, places: &[Place]) -> Summary {
        let mut found = Summary::default();
        let mut instants: Vec<(Option<usize>, Vec<f64>)> = Vec::new();
        for (index, place) in places.iter().enumerate() {
            let Some(sample) = self.sample(question, place, ParameterValues::Present) else { continue };
            let same = instants.iter().find(|(instant, _)| instant.is_some() && *instant == place.instant);
            let before = same.or(instants.first()).map(|(_, angles)| angles);
            if before.is_some_and(|before| has_jump(before, &sample.angles)) {
                continue;
            }
            found.count += 1;
            found.largest = found.largest.max(sample.difference);
            if sample.difference > TOLERANCE {
                found.first = Some(index);
                return found;
            }
            if let Some(other) = self.sample(question, place, ParameterValues::Near)
                && !has_jump(&sample.angles, &other.angles)
            {
                found.is_general = Some(found.is_general != Some(false) && other.difference <= EQUAL);
            }
            instants.push((place.instant, sample.angles));
        }
        found
    }

    /// The sides of an equation at a place. `None` if one has no value there, or jumps there.
    fn sample(&self, question: &Question, place: &Place, parameters: ParameterValues) -> Option<Sample> {
        let known = self.known(question, place, parameters)?;
        if question.is_at_switch(&known) {
            return None;
        }
        let sides = question.sides.each_ref().map(|side| value(side, &known));
        let size: f64 = question.sides.iter().map(|side| term_size(side, &known)).sum();
        let difference = (sides[0] - sides[1]).abs();
        let difference = if difference == 0.0 { 0.0 } else { difference / size };
        let angles = question.angles(&known);
        difference.is_finite().then_some(Sample { difference, angles })
    }

    /// The values of all quantities of an equation at a place. `None` if a loop has no solution near that of the program.
    fn known(&self, question: &Question, place: &Place, parameters: ParameterValues) -> Option<Known<'_>> {
        let mut known = Known::new((&self.model.system, self.program), &self.outputs, place, parameters);
        known.solve(&question.loops)?;
        Some(known)
    }

    /// The values of both sides and of the quantities of an equation at a place where they differ.
    fn difference(&mut self, equation: &Equation, question: &Question, place: &Place) -> Verdict {
        let quantities = self.quantities(equation);
        let Some(known) = self.known(question, place, ParameterValues::Present) else {
            return Verdict::NoValues;
        };
        let quantities = quantities.into_iter().map(|(name, quantity)| (name, value(&quantity, &known)));
        let quantities = quantities.filter(|(_, value)| value.is_finite()).collect();
        let writer = Writer::new(self.circuit, &self.model.system);
        let sides = question.sides.each_ref().map(|side| (value(side, &known), writer.dimension(side)));
        Verdict::Different(Difference { quantities, sides })
    }

    /// The signals and drives that an equation names, as expressions.
    fn quantities(&mut self, equation: &Equation) -> Vec<(String, Fraction)> {
        let (patch, none) = (self.circuit.patch(), HashSet::new());
        let is_quantity = |name: &&str| {
            split_primes(name).1 == 0
                && (patch.signals.contains_key(*name) || patch.drives.contains_key(*name))
        };
        let names = equation.names().into_iter().filter(is_quantity);
        let named = names.filter_map(|name| Some((name.to_owned(), self.model.named(name, &none).ok()?)));
        named.collect()
    }
}

#[cfg(test)]
mod tests;
