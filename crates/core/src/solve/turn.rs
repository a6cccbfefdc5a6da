//! Where a voltage turns within a stretch.

use crate::divided::divide;

/// A voltage at four places of a stretch, the first of which is its beginning: shares of its length, and values.
#[derive(Debug, Clone, Copy)]
pub(super) struct Samples {
    pub shares: [f64; 4],
    pub values: [f64; 4],
}

/// By this share of the swing the samples of a voltage may be wrong about where it turns.
const MARGIN: f64 = 0.1;

/// Where a voltage has a peak or a dip.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Turn {
    /// The share of the stretch gone.
    pub share: f64,
    /// The voltage there.
    pub value: f64,
    /// Whether it is a peak.
    pub is_peak: bool,
}

impl Samples {
    /// The peak and the dip of the cubic through the samples (Newton), where they lie inside.
    pub fn turns(&self) -> impl Iterator<Item = Turn> {
        let [_, near, far, _] = self.shares;
        let [first, second, third, fourth] = self.divided();
        let cubic = fourth;
        let square = third - cubic * (near + far);
        let linear = second - near * third + cubic * near * far;
        let under = square * square - 3.0 * cubic * linear;
        let sum = -(square + square.signum() * under.sqrt());
        let places = [sum / (3.0 * cubic), linear / sum];
        places.into_iter().filter(|share| *share > 0.0 && *share < 1.0).map(move |share| Turn {
            share,
            value: first + share * (linear + share * (square + share * cubic)),
            is_peak: 3.0 * cubic * share + square < 0.0,
        })
    }

    /// What a turn may come to in truth: a little more than by the samples.
    pub fn beyond(&self, turn: &Turn) -> f64 {
        let margin = MARGIN * self.swing();
        if turn.is_peak { turn.value + margin } else { turn.value - margin }
    }

    /// How far apart the values lie.
    pub fn swing(&self) -> f64 {
        let most = self.values.into_iter().fold(f64::NEG_INFINITY, f64::max);
        most - self.values.into_iter().fold(f64::INFINITY, f64::min)
    }

    /// Differences of the values, each divided by what its places lie apart.
    fn divided(&self) -> [f64; 4] {
        let mut table = self.values;
        divide(&self.shares, &mut table);
        table
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn samples(curve: impl Fn(f64) -> f64) -> Samples {
        let shares = [0.0, 0.3, 0.8, 1.0];
        Samples { shares, values: shares.map(curve) }
    }

    #[test]
    fn both_turns_of_a_cubic_are_found() {
        let curve = |s: f64| 2.0 + (s - 0.2) * (s - 0.2) * (s - 0.8);
        let turns: Vec<Turn> = samples(curve).turns().collect();
        assert_eq!(turns.len(), 2);
        for (turn, (share, is_peak)) in turns.iter().zip([(0.6, false), (0.2, true)]) {
            assert!((turn.share - share).abs() < 1e-12 && turn.is_peak == is_peak, "{turns:?}");
            assert!((turn.value - curve(share)).abs() < 1e-12, "{turns:?}");
        }
    }

    #[test]
    fn a_parabola_turns_once_and_a_straight_line_nowhere() {
        let turns: Vec<Turn> = samples(|s| s * (1.0 - s)).turns().collect();
        assert!(turns.len() == 1 && turns[0].is_peak && (turns[0].share - 0.5).abs() < 1e-12, "{turns:?}");
        assert_eq!(samples(|s| 3.0 * s).turns().count() + samples(|_| 3.0).turns().count(), 0);
    }
}
