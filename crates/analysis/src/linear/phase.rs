//! Phases that are continuous over frequency, without jumps by a whole turn.

use std::f64::consts::{PI, TAU};

use nalgebra::Complex;

/// Makes phases continuous over frequency.
#[derive(Default)]
pub(super) struct PhaseUnwrapper {
    /// The previous phase in radians; None before the first finite ratio.
    last: Option<f64>,
}

/// Tolerance in radians. A step of half a turn counts as downward, so that rounding does not decide its direction.
const HALF_TURN_TOLERANCE: f64 = 1e-6;

impl PhaseUnwrapper {
    /// The phase of the next ratio; NaN if the ratio is 0 or not finite.
    pub(super) fn next(&mut self, ratio: Complex<f64>) -> f64 {
        if ratio.norm() == 0.0 || !ratio.is_finite() {
            return f64::NAN;
        }
        let phase = match self.last {
            None => first_phase(ratio.arg()),
            Some(last) => last + wrapped(ratio.arg() - last),
        };
        self.last = Some(phase);
        phase
    }
}

/// The phase of the first point. Half a turn counts as lead.
fn first_phase(phase: f64) -> f64 {
    if phase + PI < HALF_TURN_TOLERANCE { phase + TAU } else { phase }
}

/// The angle plus a multiple of 2 pi, within -pi ... pi.
fn wrapped(angle: f64) -> f64 {
    angle - TAU * ((angle + PI + HALF_TURN_TOLERANCE) / TAU).floor()
}
