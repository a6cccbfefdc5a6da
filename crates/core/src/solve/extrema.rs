//! Extrema of voltages within the step accepted last, by the curve of the states.
//!
//! Samples at the stages show where a voltage turns; a search for the extremum then evaluates the curve of the states.
//! Only adaptive steps have enough stages for it. Equal steps show their ends alone.

use super::state::Solver;
use super::turning_points::TurningPoint;
use crate::ir::Register;

/// The position of an extremum is searched to this share of the step. The voltage is flat there.
const POSITION_TOLERANCE: f64 = 1e-4;
/// An extremum is at most this share of the step away from where the samples show it.
const SEARCH_RADIUS: f64 = 0.3;
/// Voltages whose samples swing by less than this, in volts, have no extrema.
const LEAST_SWING: f64 = 1e-9;
/// The share of the longer part that the golden section tries next.
const GOLDEN: f64 = 0.381_966_011_250_105;
/// A search evaluates at most this many positions.
const MAX_EVALUATIONS: usize = 40;

impl Solver<'_> {
    /// The maximum of a voltage above `high` and its minimum below `low` within the last step, each as problem time and
    /// volts; `None` for an extremum inside this range. The order is that of the turning points of the samples.
    pub fn extrema_beyond(&mut self, at: Register, [low, high]: [f64; 2]) -> [Option<(f64, f64)>; 2] {
        let mut found = [None; 2];
        let (state, buffers) = (&self.state, &self.buffers);
        let ends = [&buffers.last.voltages, &state.voltages].map(Vec::as_slice);
        let samples = buffers.samples(self.setup.method, ends, |voltages| voltages[at.index()]);
        let has_length = buffers.last.time < state.time;
        let Some(samples) = samples.filter(|samples| samples.swing() > LEAST_SWING && has_length) else {
            return found;
        };
        for (place, turn) in found.iter_mut().zip(samples.turning_points()) {
            let value = samples.with_margin(&turn);
            if if turn.is_peak { value > high } else { value < low } {
                *place = Some(refine(self, at, turn));
            }
        }
        found
    }
}

/// Refines an extremum on the curve of the states, near the turning point of the samples: problem time and volts.
fn refine(solver: &mut Solver<'_>, at: Register, turn: TurningPoint) -> (f64, f64) {
    let (begin, length) = (solver.buffers.last.time, solver.state.time - solver.buffers.last.time);
    let sign = if turn.is_peak { -1.0 } else { 1.0 };
    let mut evaluate = |share: f64| {
        solver.interpolate(begin + share * length);
        sign * solver.buffers.voltages[at.index()]
    };
    let ends = [(turn.share - SEARCH_RADIUS).max(0.0), (turn.share + SEARCH_RADIUS).min(1.0)];
    let mut search = Search::new(ends, turn.share, evaluate(turn.share));
    for _ in 0..MAX_EVALUATIONS {
        let Some(share) = search.next() else { break };
        search.add(share, evaluate(share));
    }
    (begin + search.best.0 * length, sign * search.best.1)
}

/// The search for the least value of a function (Brent 1973): by parabolas through the three best positions, with the
/// golden section as a safeguard.
struct Search {
    /// The positions between which the least value is.
    ends: [f64; 2],
    /// The best position and its value, then the second and the third.
    best: (f64, f64),
    second: (f64, f64),
    third: (f64, f64),
    /// The last two moves, the latest last.
    moves: [f64; 2],
}

impl Search {
    /// A search between two ends that begins at a position with a known value. Positions are shares of the step.
    fn new(ends: [f64; 2], position: f64, value: f64) -> Self {
        let first = (position, value);
        Search { ends, best: first, second: first, third: first, moves: [0.0; 2] }
    }

    /// The position to evaluate next; `None` if the position of the least value is known well enough.
    fn next(&mut self) -> Option<f64> {
        let ([low, high], (position, _)) = (self.ends, self.best);
        let middle = 0.5 * (low + high);
        if (position - middle).abs() + 0.5 * (high - low) <= 2.0 * POSITION_TOLERANCE {
            return None;
        }
        let vertex = self.vertex().filter(|by| {
            by.abs() < 0.5 * self.moves[0].abs()
                && low + POSITION_TOLERANCE < position + by
                && position + by < high - POSITION_TOLERANCE
        });
        self.moves = match vertex {
            Some(by) => [self.moves[1], by],
            None => {
                let longer = if position < middle { high - position } else { low - position };
                [longer, GOLDEN * longer]
            }
        };
        let by = self.moves[1];
        Some(position + if by.abs() < POSITION_TOLERANCE { POSITION_TOLERANCE.copysign(by) } else { by })
    }

    /// The distance from the best position to the vertex of the parabola through the three best positions.
    fn vertex(&self) -> Option<f64> {
        let [(x, at), (near, by_near), (far, by_far)] = [self.best, self.second, self.third];
        let (one, other) = ((x - near) * (at - by_far), (x - far) * (at - by_near));
        let by = -0.5 * ((x - far) * other - (x - near) * one) / (other - one);
        by.is_finite().then_some(by)
    }

    /// Adds the value at a position, and moves one end of the search to the worse of it and the best.
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

    /// The position at which a search finds the least value of a function, and the number of evaluations.
    fn found(function: impl Fn(f64) -> f64, from: f64) -> (f64, usize) {
        let mut search = Search::new([0.0, 1.0], from, function(from));
        let mut evaluations = 1;
        while let Some(position) = search.next() {
            search.add(position, function(position));
            evaluations += 1;
        }
        (search.best.0, evaluations)
    }

    #[test]
    fn the_least_value_is_found_in_a_valley_at_a_corner_and_at_an_end() {
        for least in [0.0, 0.123, 0.5, 0.9] {
            let (position, evaluations) = found(|x| (x - least).powi(2) * (3.0 + x), 0.45);
            assert!(
                (position - least).abs() < 3.0 * POSITION_TOLERANCE && evaluations < 25,
                "{position} of {least} after {evaluations}"
            );
            let (position, evaluations) = found(|x| (x - least).abs() * (3.0 + x), 0.45);
            assert!(
                (position - least).abs() < 3.0 * POSITION_TOLERANCE && evaluations < MAX_EVALUATIONS,
                "{position} of {least} after {evaluations}"
            );
        }
    }
}
