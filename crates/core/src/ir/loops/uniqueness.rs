//! Proves that a loop has at most one solution, from bounds of the slopes of its recomputed outputs.
//!
//! The slopes are those of the outputs before their limits, while all tears vary over their whole range. If they are not
//! enough for a proof, every other amplifier of the loop becomes an unknown as well. Then the slopes do not depend on
//! which amplifiers are at their limits.
//!
//! A proof holds for a range of inputs, so most evaluations need none. The first attempts assume nothing of the inputs
//! that vary within a step. If they fail, they are not repeated. The last attempt takes the present inputs.

use super::Problem;
use super::bounds::Bounds;
use super::interval::Interval;
use super::p_matrix::is_p_matrix;
use crate::ir::number::Number as _;
use crate::ir::op::Register;
use crate::ir::parts::Loop;
use crate::machines::REFERENCE;

/// The ranges of the inputs for which a proof is attempted if it fails for all inputs, in volts on both sides of the
/// present ones.
const MARGINS: [f64; 2] = [5.0, 0.0];
/// Largest number of unknowns of a proof with all amplifiers. Its time grows with the third power.
const MAX_UNKNOWNS: usize = 150;

/// What is known about the number of solutions of a loop.
#[derive(Debug, Clone)]
pub(super) struct Uniqueness {
    /// Bounds of the inputs for which one solution was proven, in the order of the inputs. Empty before the first
    /// proof.
    proven: Vec<Interval>,
    /// The inputs that are constant within a step, when the proofs for all values of the others failed.
    failed_for: Option<Vec<f64>>,
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
            failed_for: None,
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
        is_covered || self.is_proven_for_all(problem) || {
            let tears = tears(problem);
            MARGINS.into_iter().any(|margin| self.prove(problem, &tears, margin))
        }
    }

    /// Tries to prove that there is at most one solution whatever the inputs are that vary within a step: with the
    /// tears, then with all amplifiers. Both attempts depend on the other inputs only, so failures are remembered.
    fn is_proven_for_all(&mut self, problem: &Problem<'_>) -> bool {
        let moving = problem.program.lowered.sections.moving;
        let pairs = problem.entry.inputs.iter().zip(problem.inputs());
        let fixed = pairs.filter(|(input, _)| input.index() < moving).map(|(_, volts)| volts).collect();
        if self.failed_for.as_ref() == Some(&fixed) {
            return false;
        }
        let tears = tears(problem);
        if self.prove(problem, &tears, f64::INFINITY) {
            return true;
        }
        let all = [tears, other_amplifiers(problem)].concat();
        let is_larger = all.len() > problem.order() && all.len() <= MAX_UNKNOWNS;
        let is_proven = is_larger && self.prove(problem, &all, f64::INFINITY);
        if !is_proven {
            self.failed_for = Some(fixed);
        }
        is_proven
    }

    /// Tries to prove that there is at most one solution for inputs within a margin, in volts, of the present ones. The
    /// margin applies to inputs that vary within a step.
    fn prove(&mut self, problem: &Problem<'_>, unknowns: &[Unknown], margin: f64) -> bool {
        let moving = problem.program.lowered.sections.moving;
        let bounds = |register: usize| {
            let volts = problem.outside[register];
            let margin = if register < moving { 0.0 } else { margin };
            Interval::new(volts - margin, volts + margin)
        };
        self.proven.clear();
        let is_proven = self.is_proven_with(problem, unknowns, bounds);
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
        let range = Interval::new(-REFERENCE, REFERENCE);
        let mut assumed = vec![None; self.bounds.len()];
        unknowns.iter().for_each(|unknown| assumed[unknown.at] = Some(Bounds::fixed(range)));
        for (column, moving) in unknowns.iter().enumerate() {
            assumed[moving.at] = Some(Bounds::moving(range));
            self.evaluate(problem, &assumed, &input);
            assumed[moving.at] = Some(Bounds::fixed(range));
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

    /// Bounds of all operations, of which some are assumed. The tears are among these.
    fn evaluate(
        &mut self,
        problem: &Problem<'_>,
        assumed: &[Option<Bounds>],
        input: &impl Fn(usize) -> Interval,
    ) {
        let tears = self.bounds.iter_mut().zip(assumed).take(problem.order());
        tears.for_each(|(bounds, assumed)| *bounds = assumed.unwrap_or(*bounds));
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
