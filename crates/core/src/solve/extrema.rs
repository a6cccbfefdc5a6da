//! Extrema of voltages within the step accepted last, by the curve of the states.
//!
//! The samples at the stages show where a voltage turns. A search for the extremum then evaluates the voltage on the
//! curve of the states. This is done for adaptive steps only. With equal steps, only the ends of steps count.

use super::minimum_search::MinimumSearch;
use super::state::Solver;
use super::turning_points::TurningPoint;
use crate::ir::Register;

/// Least swing of the samples of a voltage that is searched for extrema, in volts.
const MIN_SWING: f64 = 1e-9;

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
    let mut search = MinimumSearch::around(turn.share, evaluate(turn.share));
    while let Some(share) = search.next() {
        search.add(share, evaluate(share));
    }
    (begin + search.best.0 * length, sign * search.best.1)
}
