//! Finds the solution of a loop that has only one, by Newton's method from the last solution.
//!
//! The unknowns y solve y = clip(a(y)), where a is the output demanded of the amplifiers. The iteration first decides
//! for every tear whether its amplifier is at a limit: the step of its own equation alone would leave the range. Then
//! it solves the linear system with y = ±100 V for these, and y = a(y) for the others.
//!
//! The first step uses the factors of the last evaluation, so that a loop that changes little needs two evaluations of
//! its operations.

use super::matrix::Factors;
use super::{Problem, SOLUTION_SPACING, clamped};
use crate::ir::Register;
use crate::ir::tangent::SourceSlopes;
use crate::machines::REFERENCE;

/// Maximum number of steps. Newton's method doubles the number of digits in each, so most loops need two or three.
const MAX_STEPS: usize = 60;
/// Maximum number of times that a step is halved.
const MAX_HALVINGS: usize = 8;
/// A step of the first factors is kept if it reduces the residual to at most this share.
const KEPT_SHARE: f64 = 0.1;
/// The residual at which the iteration ends, as a share of the largest voltage or 1 V: some units of rounding.
const SETTLED: f64 = 2e-15;
/// If rounding prevents a smaller residual, one below this is accepted, in volts.
const STAGNANT: f64 = 1e-10;

/// Where an amplifier is, as the iteration assumes.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Side {
    /// Its output is what its inputs demand.
    Within,
    /// Its output is at this limit, in volts.
    At(f64),
}

/// The iteration, with its buffers.
#[derive(Debug, Clone)]
pub(super) struct Newton {
    /// Slopes of y - a(y) where the factors were computed, by rows.
    rows: Vec<f64>,
    /// The side of every tear in the factors.
    sides: Vec<Side>,
    /// The linear system: these slopes, or 1 on the diagonal for a tear at a limit.
    system: Vec<f64>,
    /// Factors of the linear system. `None` before the first step.
    factors: Option<Factors>,
    /// Whether the first step uses the factors of the last evaluation. In a straight loop it does not if the slopes
    /// have changed: then it needs new ones anyway.
    reuses_factors: bool,
    /// The side of every tear at the present point.
    present: Vec<Side>,
    /// The residuals at the present point.
    residuals: Vec<f64>,
    /// The present step.
    step: Vec<f64>,
    /// The tears before the present step.
    before: Vec<f64>,
    /// Slopes of the tears and operations.
    slopes: Vec<f64>,
}

impl Newton {
    /// The iteration for a loop with this number of tears, and of tears and operations.
    pub(super) fn new(order: usize, span: usize) -> Self {
        Newton {
            rows: vec![0.0; order * order],
            system: vec![0.0; order * order],
            sides: vec![Side::Within; order],
            factors: None,
            reuses_factors: true,
            present: vec![Side::Within; order],
            residuals: vec![0.0; order],
            step: vec![0.0; order],
            before: vec![0.0; order],
            slopes: vec![0.0; span],
        }
    }

    /// Forgets the factors.
    pub(super) fn forget(&mut self) {
        (self.factors, self.reuses_factors) = (None, true);
    }

    /// Moves the tears to the solution and evaluates the loop there. `false` if the iteration does not settle.
    pub(super) fn follow(&mut self, problem: &Problem<'_>, tears: &mut [f64], inside: &mut [f64]) -> bool {
        problem.evaluate_at(tears, inside);
        if self.factors.is_some() && self.reuses_factors {
            let residual = self.measure(problem, inside);
            if settles(tears, residual) {
                return true;
            }
            if self.present == self.sides {
                self.prepare_step(tears);
                let next = self.advance(problem, tears, inside, 1.0);
                if settles(tears, next) {
                    return true;
                }
                self.reuses_factors = !problem.entry.is_straight;
                if next.is_nan() || next > KEPT_SHARE * residual {
                    tears.copy_from_slice(&self.before);
                    problem.evaluate_at(tears, inside);
                }
            }
        }
        let mut last = f64::INFINITY;
        for _ in 0..MAX_STEPS {
            let Some(residual) = self.linearise(problem, inside) else { return false };
            if settles(tears, residual) || (residual < STAGNANT && residual > 0.5 * last) {
                return true;
            }
            last = residual;
            let Some(next) = self.descend(problem, tears, inside, residual) else { return false };
            if settles(tears, next) {
                return true;
            }
        }
        false
    }

    /// Improves a solution that a search has found, and evaluates the loop there. The tears stay as they are if the
    /// iteration leaves it.
    pub(super) fn refine(&mut self, problem: &Problem<'_>, tears: &mut [f64], inside: &mut [f64]) {
        let found = tears.to_vec();
        self.factors = None;
        let is_settled = self.follow(problem, tears, inside);
        let is_near = |(found, tear): (&f64, &f64)| (found - tear).abs() <= SOLUTION_SPACING;
        if !is_settled || !found.iter().zip(tears.iter()).all(is_near) {
            self.factors = None;
            tears.copy_from_slice(&found);
            problem.evaluate_at(tears, inside);
        }
    }

    /// Computes slopes and factors at the present point. Returns the residual there; `None` if the system is singular.
    fn linearise(&mut self, problem: &Problem<'_>, inside: &[f64]) -> Option<f64> {
        let order = problem.order();
        let mut are_same = true;
        for column in 0..order {
            self.slopes[..order].fill(0.0);
            self.slopes[column] = 1.0;
            differentiate(problem, inside, &mut self.slopes);
            for (row, tear) in problem.entry.tears.iter().enumerate() {
                let own = if row == column { 1.0 } else { 0.0 };
                let slope = own - slope_of(problem, &self.slopes, tear.demanded());
                let entry = &mut self.rows[row * order + column];
                are_same &= *entry == slope;
                *entry = slope;
            }
        }
        self.reuses_factors |= are_same;
        let residual = self.measure(problem, inside);
        self.sides.copy_from_slice(&self.present);
        self.system.copy_from_slice(&self.rows);
        for (row, _) in self.sides.iter().enumerate().filter(|(_, side)| **side != Side::Within) {
            self.system[row * order..(row + 1) * order].fill(0.0);
            self.system[row * order + row] = 1.0;
        }
        self.factors = Factors::new(&self.system, order);
        self.factors.is_some().then_some(residual)
    }

    /// Finds the side of every tear, and computes its residual. Returns the largest residual in volts of its
    /// tear.
    fn measure(&mut self, problem: &Problem<'_>, inside: &[f64]) -> f64 {
        let order = problem.order();
        let mut largest = 0.0;
        for (position, tear) in problem.entry.tears.iter().enumerate() {
            let output = inside[position];
            let gap = output - problem.get(inside, tear.demanded());
            let row = &self.rows[position * order..(position + 1) * order];
            let aim = output - gap / row[position].abs();
            let (side, residual) = match aim {
                aim if tear.demand.is_some() && aim.abs() >= REFERENCE => {
                    let limit = REFERENCE.copysign(aim);
                    (Side::At(limit), output - limit)
                }
                _ => (Side::Within, gap),
            };
            let scale = match side {
                Side::Within => row.iter().fold(0.0f64, |scale, slope| scale.max(slope.abs())),
                Side::At(_) => 1.0,
            };
            (self.present[position], self.residuals[position]) = (side, residual);
            largest = if residual.is_nan() { f64::NAN } else { f64::max(largest, residual.abs() / scale) };
            if largest.is_nan() {
                return f64::NAN;
            }
        }
        largest
    }

    /// Computes the step from the residuals, and keeps the tears from which it starts.
    fn prepare_step(&mut self, tears: &[f64]) {
        self.step.copy_from_slice(&self.residuals);
        if let Some(factors) = &self.factors {
            factors.solve(&mut self.step);
        }
        self.before.copy_from_slice(tears);
    }

    /// Moves the tears by a share of the step and evaluates the loop. Returns the residual there.
    fn advance(&mut self, problem: &Problem<'_>, tears: &mut [f64], inside: &mut [f64], share: f64) -> f64 {
        for (position, tear) in problem.entry.tears.iter().enumerate() {
            let moved = self.before[position] - share * self.step[position];
            tears[position] = match self.sides[position] {
                Side::At(limit) if share == 1.0 => limit,
                _ if tear.demand.is_some() => clamped(moved),
                _ => moved,
            };
        }
        problem.evaluate_at(tears, inside);
        self.measure(problem, inside)
    }

    /// Makes a step and returns the residual after it. In a curved loop the step is halved until the residual
    /// decreases; `None` if it never does.
    fn descend(
        &mut self,
        problem: &Problem<'_>,
        tears: &mut [f64],
        inside: &mut [f64],
        residual: f64,
    ) -> Option<f64> {
        self.prepare_step(tears);
        let mut share = 1.0;
        for _ in 0..MAX_HALVINGS {
            let next = self.advance(problem, tears, inside, share);
            if next < residual || problem.entry.is_straight || residual < STAGNANT {
                return (!next.is_nan()).then_some(next);
            }
            share *= 0.5;
        }
        None
    }
}

/// Whether a residual is as small as rounding permits.
fn settles(tears: &[f64], residual: f64) -> bool {
    residual <= SETTLED * tears.iter().fold(1.0, |largest, tear| f64::max(largest, tear.abs()))
}

/// The slope of a register. Registers before the loop do not vary.
fn slope_of(problem: &Problem<'_>, slopes: &[f64], register: Register) -> f64 {
    register.index().checked_sub(problem.outside.len()).map_or(0.0, |inner| slopes[inner])
}

/// Computes the slopes of the operations from those of the tears.
fn differentiate(problem: &Problem<'_>, inside: &[f64], slopes: &mut [f64]) {
    let value = |register: Register| problem.get(inside, register);
    for at in problem.entry.operations.clone() {
        let op = problem.program.lowered.body[at];
        let slope = |register| slope_of(problem, slopes, register);
        let found = problem.program.slope(op, value, value, &SourceSlopes::none(), slope);
        slopes[at - problem.outside.len()] = found;
    }
}
