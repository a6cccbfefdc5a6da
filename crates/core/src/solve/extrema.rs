//! Extrema of voltages within the step accepted last, by the curve of the states.
//!
//! The samples at the stages show where a voltage turns. A search for the extremum then evaluates the voltage on the
//! curve of the states. This is done for adaptive steps only. With equal steps, only the ends of steps count.

use super::state::Solver;
use super::turning_points::TurningPoint;
use crate::ir::Register;

/// Tolerance of the position of an extremum, as a share of the step. The voltage is flat there, so its error is of the
/// order of the square.
const POSITION_TOLERANCE: f64 = 1e-4;
/// Largest distance of an extremum from the turning point of the samples, as a share of the step.
const SEARCH_RADIUS: f64 = 0.3;
/// Least swing of the samples of a voltage that is searched for extrema, in volts.
const MIN_SWING: f64 = 1e-9;
/// The share of the longer part that the golden section tries next: (3 - sqrt 5) / 2.
const GOLDEN_SHARE: f64 = 0.381_966_011_250_105;
/// Largest number of positions that a search evaluates after the first.
const MAX_EVALUATIONS: usize = 40;

impl Solver<'_> {
    /// The maximum of a voltage above `high` and its minimum below `low` within the last step, each as problem time and
    /// volts; `None` for an extremum inside this range. The order is that of the turning points of the samples. The
    /// buffers are overwritten by interpolation.
    pub(super) fn extrema_outside(
        &mut self,
        register: Register,
        [low, high]: [f64; 2],
    ) -> [Option<(f64, f64)>; 2] {
        let mut extrema = [None; 2];
        if !self.setup.is_adaptive {
            return extrema;
        }
        let (state, buffers) = (&self.state, &self.buffers);
        let ends = [&buffers.last.voltages, &state.voltages].map(Vec::as_slice);
        let samples = buffers.samples(self.setup.method, ends, |voltages| voltages[register.index()]);
        let has_length = buffers.last.time < state.time;
        if !has_length || samples.swing() <= MIN_SWING {
            return extrema;
        }
        for (extremum, turn) in extrema.iter_mut().zip(samples.turning_points()) {
            let value = samples.with_margin(&turn);
            if if turn.is_peak { value > high } else { value < low } {
                *extremum = Some(refine(self, register, turn));
            }
        }
        extrema
    }
}

/// Refines an extremum on the curve of the states, near the turning point of the samples: problem time and volts.
fn refine(solver: &mut Solver<'_>, register: Register, turn: TurningPoint) -> (f64, f64) {
    let (begin, length) = (solver.buffers.last.time, solver.state.time - solver.buffers.last.time);
    // The search looks for a minimum.
    let sign = if turn.is_peak { -1.0 } else { 1.0 };
    let mut evaluate = |share: f64| {
        solver.interpolate(begin + share * length);
        sign * solver.buffers.voltages[register.index()]
    };
    let ends = [(turn.share - SEARCH_RADIUS).max(0.0), (turn.share + SEARCH_RADIUS).min(1.0)];
    let mut search = MinimumSearch::new(ends, turn.share, evaluate(turn.share));
    for _ in 0..MAX_EVALUATIONS {
        let Some(share) = search.next() else { break };
        search.add(share, evaluate(share));
    }
    (begin + search.best.0 * length, sign * search.best.1)
}

/// The search for the minimum of a function (Brent 1973): by parabolas through the three best positions, with the
/// golden section as a safeguard. Positions are shares of the step.
struct MinimumSearch {
    /// The positions between which the minimum is.
    ends: [f64; 2],
    /// The position with the least value, and the value.
    best: (f64, f64),
    /// The position with the second least value, and the value.
    second: (f64, f64),
    /// The position with the third least value, and the value.
    third: (f64, f64),
    /// The last two moves, the latest last.
    moves: [f64; 2],
}

impl MinimumSearch {
    /// A search between two ends that begins at a position with a known value.
    fn new(ends: [f64; 2], position: f64, value: f64) -> Self {
        let first = (position, value);
        MinimumSearch { ends, best: first, second: first, third: first, moves: [0.0; 2] }
    }

    /// The position to evaluate next; `None` if the position of the minimum is known to [`POSITION_TOLERANCE`].
    fn next(&mut self) -> Option<f64> {
        let ([low, high], (position, _)) = (self.ends, self.best);
        let middle = 0.5 * (low + high);
        if (position - middle).abs() + 0.5 * (high - low) <= 2.0 * POSITION_TOLERANCE {
            return None;
        }
        // A parabola is used only if its move is less than half of the move before the last, and stays inside.
        let vertex = self.vertex().filter(|step| {
            step.abs() < 0.5 * self.moves[0].abs()
                && low + POSITION_TOLERANCE < position + step
                && position + step < high - POSITION_TOLERANCE
        });
        self.moves = match vertex {
            Some(step) => [self.moves[1], step],
            None => {
                let longer = if position < middle { high - position } else { low - position };
                [longer, GOLDEN_SHARE * longer]
            }
        };
        let step = self.moves[1];
        Some(
            position + if step.abs() < POSITION_TOLERANCE { POSITION_TOLERANCE.copysign(step) } else { step },
        )
    }

    /// The distance from the best position to the vertex of the parabola through the three best positions; `None` if
    /// two of them coincide or all are on a straight line.
    fn vertex(&self) -> Option<f64> {
        let [(x, value), (second_x, second_value), (third_x, third_value)] =
            [self.best, self.second, self.third];
        let to_third = (x - second_x) * (value - third_value);
        let to_second = (x - third_x) * (value - second_value);
        let step = -0.5 * ((x - third_x) * to_second - (x - second_x) * to_third) / (to_second - to_third);
        step.is_finite().then_some(step)
    }

    /// Adds the value at a position. One end of the search moves to the worse of this position and the best one.
    fn add(&mut self, position: f64, value: f64) {
        let (worse, is_better) = if value <= self.best.1 { (self.best.0, true) } else { (position, false) };
        // The worse of the two bounds the search on its side of the better one.
        let better = if is_better { position } else { self.best.0 };
        self.ends[usize::from(worse > better)] = worse;
        if is_better {
            (self.third, self.second, self.best) = (self.second, self.best, (position, value));
        } else if value <= self.second.1 || self.second.0 == self.best.0 {
            (self.third, self.second) = (self.second, (position, value));
        } else if value <= self.third.1 || self.third.0 == self.best.0 || self.third.0 == self.second.0 {
            self.third = (position, value);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The position at which a search finds the minimum of a function, and the number of evaluations.
    fn minimise(function: impl Fn(f64) -> f64, start: f64) -> (f64, usize) {
        let mut search = MinimumSearch::new([0.0, 1.0], start, function(start));
        let mut evaluations = 1;
        while let Some(position) = search.next() {
            search.add(position, function(position));
            evaluations += 1;
        }
        (search.best.0, evaluations)
    }

    #[test]
    fn the_minimum_is_found_in_a_valley_at_a_corner_and_at_an_end() {
        for minimum in [0.0, 0.123, 0.5, 0.9] {
            let (position, evaluations) = minimise(|x| (x - minimum).powi(2) * (3.0 + x), 0.45);
            assert!(
                (position - minimum).abs() < 3.0 * POSITION_TOLERANCE && evaluations < 25,
                "{position} for {minimum} after {evaluations}"
            );
            let (position, evaluations) = minimise(|x| (x - minimum).abs() * (3.0 + x), 0.45);
            assert!(
                (position - minimum).abs() < 3.0 * POSITION_TOLERANCE && evaluations < MAX_EVALUATIONS,
                "{position} for {minimum} after {evaluations}"
            );
        }
    }
}
