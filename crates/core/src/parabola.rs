//! The parabola that a voltage follows within one equal step.
//!
//! It is given by the values at both ends and by its control point, where the tangents at both ends meet. The first two
//! stages of the classical method are both in the middle of the step, so their values determine the control point. A
//! voltage that is a linear function of states and time has its control point at the first stage.

use crate::multiply_add::multiply_add;

/// Margin for the error of a curve at a turning point, as a share of the swing of the voltage.
pub(crate) const TURN_MARGIN: f64 = 0.1;

/// Least product of the slopes at both ends of a step, as a share of the square of the rise, of a curve that surely does
/// not turn near the ends. A straight line has a quarter.
pub(crate) const LEAST_SLOPES: f64 = 0.02;

/// A voltage within a step, as a parabola.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Parabola {
    /// The voltage at the beginning of the step.
    pub begin: f64,
    /// The control point: twice the voltage in the middle, less the mean of the ends.
    pub control: f64,
    /// The voltage at the end of the step.
    pub end: f64,
}

impl Parabola {
    /// The parabola from the voltages at the first two stages and at both ends of a step. The rounding is that of the
    /// kernels.
    pub(crate) fn of_stages([first, second]: [f64; 2], [begin, end]: [f64; 2]) -> Parabola {
        Parabola { begin, control: multiply_add(begin + end, -0.5, first + second), end }
    }

    /// The share (0 ... 1) of the step at which the voltage turns, and the voltage there, moved outwards by a margin for
    /// the error of the parabola. `None` if it does not turn within the step. If the control point is not finite, the
    /// share is a half, and the voltage is the control point.
    pub(crate) fn turning_point(&self) -> Option<(f64, f64)> {
        let Parabola { begin, control, end } = *self;
        if !control.is_finite() {
            return Some((0.5, control));
        }
        if !self.turns() {
            return None;
        }
        let share = (begin - control) / (begin - 2.0 * control + end);
        let value = begin - (begin - control) * share;
        let far_end = if control < begin { begin.max(end) } else { begin.min(end) };
        Some((share, value + TURN_MARGIN * (value - far_end)))
    }

    /// The share of the step at which the voltage dips below 0, if it is not below 0 at either end: where it turns, if
    /// it is negative there with the margin. It is also below 0 where it is not a number.
    pub(crate) fn dip(&self) -> Option<f64> {
        if self.control >= 0.0 {
            return None;
        }
        let (share, least) = self.turning_point()?;
        (least < 0.0 || least.is_nan()).then_some(share)
    }

    /// Whether the voltage turns within the step, or so near an end that the error of the parabola decides. The rounding is
    /// that of the kernels.
    pub(crate) fn may_turn(&self) -> bool {
        let Parabola { begin, control, end } = *self;
        let (slopes, rise) = ((control - begin) * (end - control), end - begin);
        let excess = multiply_add(rise * rise, -LEAST_SLOPES, slopes);
        excess.is_nan() || excess < 0.0
    }

    /// Whether the voltage turns within the step: the control point is not between the ends.
    fn turns(&self) -> bool {
        let product = (self.control - self.begin) * (self.end - self.control);
        product.is_nan() || product < 0.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The parabola of height `least` at the share `at`, with curvature 1.
    fn parabola(at: f64, least: f64) -> Parabola {
        let value = |share: f64| least + (share - at) * (share - at);
        Parabola {
            begin: value(0.0),
            control: 2.0 * value(0.5) - 0.5 * (value(0.0) + value(1.0)),
            end: value(1.0),
        }
    }

    #[test]
    fn a_dip_is_found_where_it_is_deepest() {
        for at in [0.05, 0.3, 0.5, 0.9] {
            // It is below 0 for a third of the step, or for as much of it as there is on both sides.
            let half_width = f64::min(1.0 / 6.0, 0.9 * f64::min(at, 1.0 - at));
            let dip = parabola(at, -half_width * half_width).dip().unwrap();
            assert!((dip - at).abs() < 1e-12, "{dip} for {at}");
        }
        assert_eq!(parabola(0.5, 0.1).dip(), None);
        assert_eq!(parabola(-0.2, 0.0).dip(), None);
        for control in [f64::NAN, f64::NEG_INFINITY] {
            assert_eq!(Parabola { begin: 1.0, control, end: 1.0 }.dip(), Some(0.5));
        }
    }

    #[test]
    fn turns_are_those_of_the_curve() {
        // The swing is 0.49 from 2 upwards.
        let (share, least) = parabola(0.3, 2.0).turning_point().unwrap();
        assert!((share - 0.3).abs() < 1e-12 && (least - 1.951).abs() < 1e-12, "{share} {least}");
        for still in [parabola(0.0, 1.0), parabola(1.5, 0.0), Parabola { begin: 3.0, control: 3.0, end: 3.0 }]
        {
            assert_eq!(still.turning_point(), None, "{still:?}");
            // Only the first one has a slope of 0 at an end.
            assert_eq!(still.may_turn(), still.begin == 1.0, "{still:?}");
        }
    }
}
