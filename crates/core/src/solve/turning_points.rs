//! Turning points of a voltage within a step, by the cubic through four samples.
//!
//! The samples are the voltages at both ends of a step and at two of its stages. Their turning points suggest events
//! that come and go within the step (`grazing`), and peaks between its ends (`extrema`).

use crate::divided_differences::newton_coefficients;
use crate::parabola::TURN_MARGIN;

/// A voltage at four instants of a step, in order of time. The first is the beginning of the step.
#[derive(Debug, Clone, Copy)]
pub(super) struct Samples {
    /// The instants as shares of the length of the step, from 0 to 1.
    pub shares: [f64; 4],
    /// The voltage at each instant, in volts.
    pub values: [f64; 4],
}

/// A maximum or a minimum of the cubic through the samples.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct TurningPoint {
    /// The instant as a share of the length of the step.
    pub share: f64,
    /// The voltage of the cubic at that instant, in volts.
    pub value: f64,
    /// Whether it is a maximum; otherwise it is a minimum.
    pub is_peak: bool,
}

impl Samples {
    /// The turning points of the cubic through the samples (Newton's form) that are strictly inside the step: at most
    /// two. They are the roots of a quadratic, in the form without cancellation, so their order is not that of time.
    pub(super) fn turning_points(&self) -> impl Iterator<Item = TurningPoint> {
        let [_, near, far, _] = self.shares;
        let [first, second, third, fourth] = self.divided_differences();
        let cubic = fourth;
        let square = third - cubic * (near + far);
        let linear = second - near * third + cubic * near * far;
        let discriminant = square * square - 3.0 * cubic * linear;
        let sum = -(square + square.signum() * discriminant.sqrt());
        let roots = [sum / (3.0 * cubic), linear / sum];
        roots.into_iter().filter(|share| *share > 0.0 && *share < 1.0).map(move |share| TurningPoint {
            share,
            value: first + share * (linear + share * (square + share * cubic)),
            is_peak: 3.0 * cubic * share + square < 0.0,
        })
    }

    /// The value at a turning point, moved outwards by the margin of error of the cubic.
    pub(super) fn with_margin(&self, turn: &TurningPoint) -> f64 {
        let margin = TURN_MARGIN * self.swing();
        if turn.is_peak { turn.value + margin } else { turn.value - margin }
    }

    /// The difference between the largest and the least sample, in volts.
    pub(super) fn swing(&self) -> f64 {
        let largest = self.values.into_iter().fold(f64::NEG_INFINITY, f64::max);
        largest - self.values.into_iter().fold(f64::INFINITY, f64::min)
    }

    /// Divided differences of the values over the shares: the coefficients of Newton's form.
    fn divided_differences(&self) -> [f64; 4] {
        let mut table = self.values;
        newton_coefficients(&self.shares, &mut table);
        table
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Samples of a curve at 0, 0.3, 0.8 and 1.
    fn samples(curve: impl Fn(f64) -> f64) -> Samples {
        let shares = [0.0, 0.3, 0.8, 1.0];
        Samples { shares, values: shares.map(curve) }
    }

    #[test]
    fn both_turning_points_of_a_cubic_are_found() {
        let curve = |s: f64| 2.0 + (s - 0.2) * (s - 0.2) * (s - 0.8);
        let turns: Vec<TurningPoint> = samples(curve).turning_points().collect();
        assert_eq!(turns.len(), 2);
        for (turn, (share, is_peak)) in turns.iter().zip([(0.6, false), (0.2, true)]) {
            assert!((turn.share - share).abs() < 1e-12 && turn.is_peak == is_peak, "{turns:?}");
            assert!((turn.value - curve(share)).abs() < 1e-12, "{turns:?}");
        }
    }

    #[test]
    fn a_parabola_turns_once_and_a_straight_line_never() {
        let turns: Vec<TurningPoint> = samples(|s| s * (1.0 - s)).turning_points().collect();
        assert!(turns.len() == 1 && turns[0].is_peak && (turns[0].share - 0.5).abs() < 1e-12, "{turns:?}");
        let straight = samples(|s| 3.0 * s).turning_points().count();
        assert_eq!(straight + samples(|_| 3.0).turning_points().count(), 0);
    }
}
