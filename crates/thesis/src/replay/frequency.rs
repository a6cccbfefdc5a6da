//! Oscillation of the final circuit at a constant command, and the VcL at which it has a stated frequency.
//!
//! The caption of Fig 8.34 prints a frequency, a command and a VcL that do not agree. This module computes the
//! frequency for a range of VcL. It then finds each VcL at which the stated frequency occurs.

use super::recipe::{BoxError, Recipe};
use super::run_record::RunRecord;
use super::series::min_max;
use crate::slideway::units::MM_PER_S;

/// The final circuit at a constant command in m/s. A run takes 4 s, which is long enough for the oscillation to
/// become periodic. Samples are 0.2 ms apart.
pub(super) fn steady_recipe(command: f64) -> Recipe {
    Recipe::new("fig-8-16").steady_command(command).run_time(4.0).sample_interval(2e-4)
}

/// The oscillation of the velocity during the last quarter of a run, which is its last second.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct VelocitySwing {
    /// Frequency in Hz. `None` if the table slides, that is if the peak-to-peak swing is below 5 % of the mean
    /// velocity.
    pub frequency: Option<f64>,
    /// The smallest velocity, in m/s.
    pub min: f64,
    /// The largest velocity, in m/s.
    pub max: f64,
}

/// A table slides if its peak-to-peak swing is below this share of the mean of smallest and largest velocity.
const MIN_SWING_SHARE: f64 = 0.05;

/// Reads the oscillation of `v_o` from the end of a run.
///
/// # Errors
/// If `v_o` is not recorded, if an amplifier was overloaded, or if no frequency can be read.
pub(super) fn read_swing(run: &RunRecord) -> Result<VelocitySwing, BoxError> {
    let velocity = run.values("v_o")?;
    let (min, max) = min_max(velocity[3 * velocity.len() / 4..].iter().copied());
    let oscillates = max - min > MIN_SWING_SHARE * 0.5 * (max + min).abs();
    let frequency = oscillates.then(|| run.measure("frequency:v_o,last=1")).transpose()?;
    Ok(VelocitySwing { frequency, min, max })
}

/// Runs the final circuit at a command in m/s with VcL from 1.5 to 27 mm/s in steps of 0.5 mm/s. Returns each VcL in
/// m/s with the oscillation.
pub(super) fn swings_by_limit(command: f64) -> Result<Vec<(f64, VelocitySwing)>, BoxError> {
    let limits: Vec<_> = (3..=54).map(|half| f64::from(half) * 0.5 * MM_PER_S).collect();
    steady_recipe(command).record(&["v_o"]).run_values("VcL", &limits, read_swing)
}

/// Returns the values of VcL in m/s at which the oscillation has the frequency `hertz`, each with the oscillation
/// there. VcL is interpolated linearly between neighbours in `swings`.
pub(super) fn limits_at_frequency(
    command: f64,
    swings: &[(f64, VelocitySwing)],
    hertz: f64,
) -> Result<Vec<(f64, VelocitySwing)>, BoxError> {
    let limits: Vec<_> = swings.windows(2).filter_map(|pair| crossing([pair[0], pair[1]], hertz)).collect();
    steady_recipe(command).record(&["v_o"]).run_values("VcL", &limits, read_swing)
}

/// Interpolates the VcL at which the frequency `hertz` is passed between two neighbours. `None` if it is not passed,
/// or if one of them slides.
fn crossing([one, next]: [(f64, VelocitySwing); 2], hertz: f64) -> Option<f64> {
    let (before, after) = (one.1.frequency? - hertz, next.1.frequency? - hertz);
    (before * after <= 0.0 && before != after).then(|| one.0 + (next.0 - one.0) * before / (before - after))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_frequency_is_found_between_two_others() {
        let swing = |frequency| VelocitySwing { frequency, min: 0.0, max: 1.0 };
        let between = |one, next| crossing([(1.0, swing(one)), (2.0, swing(next))], 33.0);
        assert_eq!(between(Some(32.0), Some(36.0)), Some(1.25));
        assert_eq!(between(Some(34.0), Some(32.0)), Some(1.5));
        assert_eq!(between(Some(34.0), Some(36.0)), None);
        assert_eq!(between(Some(34.0), None), None);
    }
}
