//! Proves that a loop has at most one solution, from bounds of the slopes of its recomputed outputs.
//!
//! The slopes are those of the outputs before their limits, while all tears vary over their whole range. If they are not
//! enough for a proof, every other amplifier of the loop becomes an unknown as well. Then the slopes do not depend on
//! which amplifiers are at their limits.
//!
//! A proof holds for a range of inputs, so most evaluations need none. The first attempt assumes nothing of the inputs
//! that vary within a step, and the last one takes the present inputs.

use super::Problem;
use super::bounds::Bounds;
use super::interval::Interval;
use super::p_matrix::is_p_matrix;
use crate::ir::number::Number as _;
use crate::ir::op::Register;
use crate::ir::parts::Loop;
use crate::machines::REFERENCE;

/// The ranges of the inputs for which a proof is attempted, in volts on both sides of the present ones.
const MARGINS: [f64; 3] = [f64::INFINITY, 5.0, 0.0];

/// What is known about the number of solutions of a loop.
#[derive(Debug, Clone)]
pub(super) struct Uniqueness {
    /// Bounds of the inputs for which one solution was proven, in the order of the inputs. Empty before the first
    /// proof.
    proven: Vec<Interval>,
    /// Bounds of the tears and operations.
    bounds: Vec<Bounds>,
}

/// A voltage of a loop that the proof treats as unknown.
#[derive(Debug, Clone, Copy)]
struct Unknown {
    /// Index of its register, counted from the first tear.
    at: usize,
    /// The register of the output that its element demands.
    demand: Register,
}

impl Uniqueness {
    /// Nothing is known.
    pub(super) fn new(entry: &Loop) -> Self {
        Uniqueness {
            proven: Vec::with_capacity(entry.inputs.len()),
            bounds: vec![Bounds::constant(0.0); entry.tears.len() + entry.operations.len()],
        }
    }

    /// Whether the loop has at most one solution. `false` if it is not known.
    pub(super) fn is_proven(&mut self, problem: &Problem<'_>) -> bool {
        let is_covered = self.proven.len() == problem.entry.inputs.len()
            && problem
                .inputs()
                .zip(&self.proven)
                .all(|(volts, proven)| proven.low <= volts && volts <= proven.high);
        is_covered || MARGINS.into_iter().any(|margin| self.prove(problem, margin))
    }

    /// Tries to prove that there is at most one solution for inputs within a margin, in volts, of the present ones. The
    /// margin applies to inputs that vary within a step.
    fn prove(&mut self, problem: &Problem<'_>, margin: f64) -> bool {
        let moving = problem.program.lowered.sections.moving;
        let bounds = |register: usize| {
            let volts = problem.outside[register];
            let margin = if register < moving { 0.0 } else { margin };
            Interval::new(volts - margin, volts + margin)
        };
        self.proven.clear();
        let tears = tears(problem);
        let others = other_amplifiers(problem);
        let is_proven = self.is_proven_with(problem, &tears, bounds)
            || (!others.is_empty() && self.is_proven_with(problem, &[tears, others].concat(), bounds));
        if is_proven {
            self.proven.extend(problem.entry.inputs.iter().map(|input| bounds(input.index())));
        }
        is_proven
    }

    /// Whether the loop has at most one solution for inputs within these bounds.
    fn is_proven_with(
        &mut self,
        problem: &Problem<'_>,
        unknowns: &[Unknown],
        input: impl Fn(usize) -> Interval,
    ) -> bool {
        let order = unknowns.len();
        let mut entries = vec![Interval::constant(0.0); order * order];
        for column in 0..order {
            self.evaluate(problem, unknowns, column, &input);
            for (row, unknown) in unknowns.iter().enumerate() {
                let slope = match unknown.demand.index().checked_sub(problem.outside.len()) {
                    Some(at) => self.bounds[at].slope,
                    None => Interval::constant(0.0),
                };
                let own = Interval::constant(if row == column { 1.0 } else { 0.0 });
                entries[row * order + column] = own.subtract(slope);
            }
        }
        is_p_matrix(&entries, order)
    }

    /// Bounds of all operations while one unknown moves and the others are anywhere.
    fn evaluate(
        &mut self,
        problem: &Problem<'_>,
        unknowns: &[Unknown],
        moving: usize,
        input: &impl Fn(usize) -> Interval,
    ) {
        let range = Interval::new(-REFERENCE, REFERENCE);
        let mut assumed = vec![None; self.bounds.len()];
        unknowns.iter().for_each(|unknown| assumed[unknown.at] = Some(Bounds::fixed(range)));
        assumed[unknowns[moving].at] = Some(Bounds::moving(range));
        for (bounds, assumed) in self.bounds.iter_mut().zip(&assumed).take(problem.order()) {
            *bounds = assumed.unwrap_or(*bounds);
        }
        problem.evaluate_with(&mut self.bounds, |register| Bounds::fixed(input(register)), |at| assumed[at]);
    }
}

/// The tears of the loop.
fn tears(problem: &Problem<'_>) -> Vec<Unknown> {
    let tears = problem.entry.tears.iter().enumerate();
    tears.map(|(at, tear)| Unknown { at, demand: tear.demanded() }).collect()
}

/// The amplifiers of the loop whose outputs follow from the tears.
fn other_amplifiers(problem: &Problem<'_>) -> Vec<Unknown> {
    let lamps = &problem.program.lowered.lamps[problem.entry.lamps.clone()];
    let is_tear = |output: Register| problem.entry.tears.iter().any(|tear| tear.result == output);
    let others = lamps.iter().filter(|lamp| !is_tear(lamp.output));
    let unknown = |output: Register, demand: Register| {
        let at = output.index().checked_sub(problem.outside.len())?;
        Some(Unknown { at, demand })
    };
    others.filter_map(|lamp| unknown(lamp.output, lamp.demand)).collect()
}
