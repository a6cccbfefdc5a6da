//! Swings of the final circuit at a steady command, and the VcL that makes them as frequent as stated.

use super::recipe::{Problem, Recipe, Record};
use crate::slideway::units::MM_PER_S;

/// The final circuit at a steady command in m/s, four seconds long.
pub(super) fn at_command(command: f64) -> Recipe {
    Recipe::of("fig-8-16").steady(command).lasting(4.0).every(2e-4)
}

/// How the velocity swings in its last second.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Swing {
    /// Cycles a second; none where it slides, or swings by less than a twentieth of its velocity.
    pub frequency: Option<f64>,
    /// The least and the largest velocity, in m/s.
    pub least: f64,
    pub most: f64,
}

/// What swings by a smaller share of its velocity slides.
const LEAST_SHARE: f64 = 0.05;

/// How the velocity of a run swings.
pub(super) fn swing(run: &Record) -> Result<Swing, Problem> {
    let velocity = run.values("v_o")?;
    let settled = velocity[3 * velocity.len() / 4..].iter();
    let (least, most) = settled.fold((f64::INFINITY, f64::NEG_INFINITY), |(least, most), value| {
        (f64::min(least, *value), f64::max(most, *value))
    });
    let oscillates = most - least > LEAST_SHARE * 0.5 * (most + least).abs();
    let frequency = oscillates.then(|| run.measure("frequency:v_o,last=1")).transpose()?;
    Ok(Swing { frequency, least, most })
}

/// Swings at a command in m/s, by VcL in m/s.
pub(super) fn by_limit(command: f64) -> Result<Vec<(f64, Swing)>, Problem> {
    let limits: Vec<_> = (3..=54).map(|half| f64::from(half) * 0.5 * MM_PER_S).collect();
    at_command(command).recording(&["v_o"]).along("VcL", &limits, swing)
}

/// The values of VcL in m/s at which a frequency comes out, by straight lines between those of `swings`; each with the swing there.
pub(super) fn limits_at(
    command: f64,
    swings: &[(f64, Swing)],
    hertz: f64,
) -> Result<Vec<(f64, Swing)>, Problem> {
    let limits: Vec<_> = swings.windows(2).filter_map(|pair| crossing([pair[0], pair[1]], hertz)).collect();
    at_command(command).recording(&["v_o"]).along("VcL", &limits, swing)
}

/// The VcL at which a frequency is passed between two of them.
fn crossing([one, next]: [(f64, Swing); 2], hertz: f64) -> Option<f64> {
    let (before, after) = (one.1.frequency? - hertz, next.1.frequency? - hertz);
    (before * after <= 0.0 && before != after).then(|| one.0 + (next.0 - one.0) * before / (before - after))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_frequency_is_found_between_two_others() {
        let swing = |frequency| Swing { frequency, least: 0.0, most: 1.0 };
        let between = |one, next| crossing([(1.0, swing(one)), (2.0, swing(next))], 33.0);
        assert_eq!(between(Some(32.0), Some(36.0)), Some(1.25));
        assert_eq!(between(Some(34.0), Some(32.0)), Some(1.5));
        assert_eq!(between(Some(34.0), Some(36.0)), None);
        assert_eq!(between(Some(34.0), None), None);
    }
}
