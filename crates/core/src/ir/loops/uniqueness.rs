//! Proves that a loop has at most one solution, from bounds of the slopes of its recomputed outputs.
//!
//! The slopes are those of the outputs before their limits, while all tears vary over their whole range. If they are not
//! enough for a proof, every other amplifier of the loop that can reach its limit becomes an unknown as well. Then the
//! slopes do not depend on which amplifiers are at their limits. An inverter of an amplifier never reaches its limit
//! before that amplifier.
//!
//! A proof holds for a range of inputs, so most evaluations need none. The first attempts assume nothing of the inputs
//! that vary within a step. If they fail, they are not repeated. The last attempt takes the present inputs.

use super::Problem;
use super::bounds::Bounds;
use super::interval::Interval;
use super::p_matrix::{Effort, is_p_matrix, without_unlimited};
use crate::ir::number::Number as _;
use crate::ir::op::Register;
use crate::ir::parts::{Lamp, Loop, Tear};
use crate::machines::REFERENCE;

/// The ranges of the inputs for which a proof is attempted if it fails for all inputs, in volts on both sides of the
/// present ones.
const MARGINS: [f64; 2] = [5.0, 0.0];
/// Largest number of unknowns of a proof with all amplifiers. Its time grows with the third power.
const MAX_UNKNOWNS: usize = 150;
/// The range of an unknown.
const RANGE: Interval = Interval { low: -REFERENCE, high: REFERENCE };

/// What is known about the number of solutions of a loop.
#[derive(Debug, Clone)]
pub(super) struct Uniqueness {
    /// Bounds of the inputs for which one solution was proven, in the order of the inputs. Empty before the first
    /// proof.
    proven: Vec<Interval>,
    /// The inputs that are constant within a step, when the proofs for all values of the others failed.
    failed_for: Option<Vec<f64>>,
    /// Bounds of the tears and operations while all unknowns are fixed, at any voltage within ±100 V.
    fixed: Vec<Bounds>,
    /// The same while one unknown moves.
    moving: Vec<Bounds>,
    /// The tears and operations that depend on the moving unknown.
    dependents: Vec<usize>,
}

/// A voltage of a loop that the proof treats as unknown.
#[derive(Debug, Clone, Copy)]
struct Unknown {
    /// Index of its register, counted from the first tear.
    at: usize,
    /// The register of the output that its element demands.
    demand: Register,
    /// Whether the output is limited to ±100 V.
    is_limited: bool,
}

impl Uniqueness {
    /// Nothing is known.
    pub(super) fn new(entry: &Loop) -> Self {
        let zeros = vec![Bounds::constant(0.0); entry.tears.len() + entry.operations.len()];
        Uniqueness {
            proven: Vec::with_capacity(entry.inputs.len()),
            failed_for: None,
            fixed: zeros.clone(),
            moving: zeros,
            dependents: Vec::new(),
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
            MARGINS.into_iter().any(|margin| self.prove(problem, &tears, margin, Effort::Quick))
        }
    }

    /// Tries to prove that there is at most one solution whatever the inputs are that vary within a step: with the
    /// tears, then with all amplifiers that can reach their limits. Both attempts depend on the other inputs only, so
    /// failures are remembered.
    fn is_proven_for_all(&mut self, problem: &Problem<'_>) -> bool {
        let moving = problem.program.lowered.sections.moving;
        let pairs = problem.entry.inputs.iter().zip(problem.inputs());
        let fixed = pairs.filter(|(input, _)| input.index() < moving).map(|(_, volts)| volts).collect();
        if self.failed_for.as_ref() == Some(&fixed) {
            return false;
        }
        let tears = tears(problem);
        if self.prove(problem, &tears, f64::INFINITY, Effort::Thorough) {
            return true;
        }
        let all = self.with_limited_amplifiers(problem, tears);
        let is_larger = all.len() > problem.order() && all.len() <= MAX_UNKNOWNS;
        let is_proven = is_larger && self.prove(problem, &all, f64::INFINITY, Effort::Thorough);
        if !is_proven {
            self.failed_for = Some(fixed);
        }
        is_proven
    }

    /// The tears, and the other amplifiers of the loop that can reach their limits.
    fn with_limited_amplifiers(&mut self, problem: &Problem<'_>, tears: Vec<Unknown>) -> Vec<Unknown> {
        let mut all = [tears, other_amplifiers(problem)].concat();
        self.evaluate_fixed(problem, &all, |register| input_bounds(problem, register, f64::INFINITY));
        all.retain(|unknown| unknown.at < problem.order() || self.can_reach_limit(problem, unknown));
        all
    }

    /// Whether an unknown can be at a limit while all unknowns are within ±100 V.
    fn can_reach_limit(&self, problem: &Problem<'_>, unknown: &Unknown) -> bool {
        let is_within =
            |at: usize| self.fixed[at].value.low >= RANGE.low && self.fixed[at].value.high <= RANGE.high;
        unknown.is_limited && !inner(problem, unknown.demand).is_some_and(is_within)
    }

    /// Tries to prove that there is at most one solution for inputs within a margin, in volts, of the present ones. The
    /// margin applies to inputs that vary within a step.
    fn prove(&mut self, problem: &Problem<'_>, unknowns: &[Unknown], margin: f64, effort: Effort) -> bool {
        let bounds = |register: usize| input_bounds(problem, register, margin);
        self.proven.clear();
        let is_proven = self.is_proven_with(problem, unknowns, bounds, effort);
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
        effort: Effort,
    ) -> bool {
        let order = unknowns.len();
        let zero = Interval::constant(0.0);
        let mut entries = vec![zero; order * order];
        self.evaluate_fixed(problem, unknowns, &input);
        let mut is_unknown = vec![false; self.fixed.len()];
        unknowns.iter().for_each(|unknown| is_unknown[unknown.at] = true);
        for (column, moving) in unknowns.iter().enumerate() {
            self.evaluate_moving(problem, &is_unknown, moving.at, &input);
            for (row, unknown) in unknowns.iter().enumerate() {
                let slope = inner(problem, unknown.demand).map_or(zero, |at| self.moving[at].slope);
                let own = Interval::constant(if row == column { 1.0 } else { 0.0 });
                entries[row * order + column] = own.subtract(slope);
            }
        }
        let is_limited: Vec<bool> =
            unknowns.iter().map(|unknown| self.can_reach_limit(problem, unknown)).collect();
        let (reduced, left) = without_unlimited(&entries, &is_limited);
        is_p_matrix(&reduced, left, effort) || (left < order && is_p_matrix(&entries, order, Effort::Quick))
    }

    /// Bounds of all operations while all unknowns are fixed.
    fn evaluate_fixed(
        &mut self,
        problem: &Problem<'_>,
        unknowns: &[Unknown],
        input: impl Fn(usize) -> Interval,
    ) {
        let range = Bounds::fixed(RANGE);
        let mut assumed = vec![None; self.fixed.len()];
        unknowns.iter().for_each(|unknown| assumed[unknown.at] = Some(range));
        self.fixed[..problem.order()].fill(range);
        problem.evaluate_with(&mut self.fixed, |register| Bounds::fixed(input(register)), |at| assumed[at]);
        self.moving.copy_from_slice(&self.fixed);
        self.dependents.clear();
    }

    /// Bounds of all operations while one unknown moves. Only those that depend on it differ from the bounds while all
    /// unknowns are fixed.
    fn evaluate_moving(
        &mut self,
        problem: &Problem<'_>,
        is_unknown: &[bool],
        moving: usize,
        input: impl Fn(usize) -> Interval,
    ) {
        for at in self.dependents.drain(..) {
            self.moving[at] = self.fixed[at];
        }
        self.moving[moving] = Bounds::moving(RANGE);
        self.dependents.push(moving);
        for at in (problem.order()..is_unknown.len()).filter(|at| !is_unknown[*at]) {
            let op = problem.program.lowered.body[problem.outside.len() + at];
            let depends = |operand| inner(problem, operand).is_some_and(|at| !self.moving[at].is_level());
            if op.operands().any(depends) {
                self.moving[at] = problem.apply(op, |register| match inner(problem, register) {
                    Some(at) => self.moving[at],
                    None => Bounds::fixed(input(register.index())),
                });
                self.dependents.push(at);
            }
        }
    }
}

/// Index of a register counted from the first tear; `None` if it is before the loop.
fn inner(problem: &Problem<'_>, register: Register) -> Option<usize> {
    register.index().checked_sub(problem.outside.len())
}

/// Bounds of a register before the loop: a margin in volts on both sides if it varies within a step, otherwise its
/// voltage.
fn input_bounds(problem: &Problem<'_>, register: usize, margin: f64) -> Interval {
    let volts = problem.outside[register];
    let margin = if register < problem.program.lowered.sections.moving { 0.0 } else { margin };
    Interval::new(volts - margin, volts + margin)
}

/// The tears of the loop.
fn tears(problem: &Problem<'_>) -> Vec<Unknown> {
    let tears = problem.entry.tears.iter().enumerate();
    let unknown = |(at, tear): (usize, &Tear)| Unknown {
        at,
        demand: tear.demanded(),
        is_limited: tear.demand.is_some(),
    };
    tears.map(unknown).collect()
}

/// The amplifiers of the loop whose outputs follow from the tears.
fn other_amplifiers(problem: &Problem<'_>) -> Vec<Unknown> {
    let lamps = &problem.program.lowered.lamps[problem.entry.lamps.clone()];
    let is_tear = |output: Register| problem.entry.tears.iter().any(|tear| tear.result == output);
    let others = lamps.iter().filter(|lamp| !is_tear(lamp.output));
    let unknown = |lamp: &Lamp| {
        Some(Unknown { at: inner(problem, lamp.output)?, demand: lamp.demand, is_limited: true })
    };
    others.filter_map(unknown).collect()
}
