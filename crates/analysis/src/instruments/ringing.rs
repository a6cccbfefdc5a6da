//! A damped oscillation about its final value: natural frequency and damping ratio.

use std::f64::consts::PI;

use super::is_signal;

/// What an oscillation that dies away tells of the system.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ringing {
    /// Undamped natural frequency, in rad/s: damped frequency / sqrt(1 - damping^2).
    pub natural_frequency: f64,
    /// Damping ratio; negative where the oscillation grows.
    pub damping: f64,
    /// The value that it rings about, in the unit of the signal.
    pub final_value: f64,
    /// How many peaks, upper and lower, the reading stands on.
    pub peaks: usize,
}

/// Why there is no reading.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum RingingError {
    /// Times and values do not make a signal.
    #[error("a signal has one finite value for each of its times, which rise")]
    NotASignal,
    /// It does not swing often enough.
    #[error("{0} peaks stand out: four are needed, upper and lower counted")]
    TooFewPeaks(usize),
    /// There are too few samples between two peaks to place them.
    #[error("{0:.1} samples between two peaks: at least 5 are needed")]
    TooCoarse(f64),
    /// Peaks are not evenly spaced, or do not shrink by the same ratio.
    #[error("not one damped oscillation: its {what} differ by {share:.3} from one that fits them all")]
    Irregular {
        /// What does not fit.
        what: &'static str,
        /// By how much, as a share of a half period or of a swing.
        share: f64,
    },
}

/// Fewer peaks than this leave nothing to check the oscillation against.
const FEWEST_PEAKS: usize = 4;
/// Swings smaller than this share of the largest are left to noise.
const SMALLEST_SWING: f64 = 1e-3;
/// Fewer samples between two peaks than this do not place them.
const FEWEST_SAMPLES: f64 = 5.0;
/// Peaks may be off the even grid by this share of their spacing, swings off their ratio by this share.
const TOLERANCE: f64 = 0.02;

/// Reads natural frequency, damping ratio and final value off a step response or any other ringing.
///
/// Peaks, upper and lower, are refined by the parabola through three samples. Their times lie pi / wd apart;
/// the swings from one to the next shrink by exp(-d), d the logarithmic decrement of a half period:
/// damping = d / sqrt(pi^2 + d^2), natural frequency = sqrt(pi^2 + d^2) / spacing. Both come from straight
/// lines through all peaks; swings do not ask for the final value, which then follows from them. Good for
/// damping up to about 0.7, beyond which fewer than four peaks stand out.
///
/// `time` in seconds, rising.
///
/// # Errors
/// When the signal is not one, shows fewer than four peaks or fewer than five samples between them, or is not
/// one damped oscillation: its peaks not evenly spaced, or not shrinking by the same ratio (solid friction
/// takes off the same amount, two modes beat, a limit cycle has corners).
pub fn ringing(time: &[f64], values: &[f64]) -> Result<Ringing, RingingError> {
    if !is_signal(time, values) {
        return Err(RingingError::NotASignal);
    }
    let peaks = outstanding(peaks(time, values));
    if peaks.len() < FEWEST_PEAKS {
        return Err(RingingError::TooFewPeaks(peaks.len()));
    }
    let spacing = spacing(&peaks, time)?;
    let decrement = decrement(&peaks)?;
    let turn = PI.hypot(decrement);
    Ok(Ringing {
        natural_frequency: turn / spacing,
        damping: decrement / turn,
        final_value: final_value(&peaks, decrement),
        peaks: peaks.len(),
    })
}

#[derive(Debug, Clone, Copy)]
pub(super) struct Peak {
    time: f64,
    pub value: f64,
}

/// Every place at which the signal turns; two equal samples on top are one peak.
fn peaks(time: &[f64], values: &[f64]) -> Vec<Peak> {
    let turns = (1..values.len().saturating_sub(1)).filter(|index| {
        let before = values[*index] - values[index - 1];
        let after = values[index + 1] - values[*index];
        let beyond = values.get(index + 2).map_or(0.0, |next| next - values[index + 1]);
        before * after < 0.0 || (after == 0.0 && before * beyond < 0.0)
    });
    turns.map(|index| vertex(&time[index - 1..=index + 1], &values[index - 1..=index + 1])).collect()
}

/// Top of the parabola through three samples.
pub(super) fn vertex(time: &[f64], values: &[f64]) -> Peak {
    let slope = |from: usize| (values[from + 1] - values[from]) / (time[from + 1] - time[from]);
    let bend = (slope(1) - slope(0)) / (time[2] - time[0]);
    let top = (time[0] + time[1]) / 2.0 - slope(0) / (2.0 * bend);
    Peak { time: top, value: values[0] + (top - time[0]) * (slope(0) + bend * (top - time[1])) }
}

/// The peaks up to the first swing that noise could be.
fn outstanding(mut peaks: Vec<Peak>) -> Vec<Peak> {
    let swings = swings(&peaks);
    let least = SMALLEST_SWING * swings.iter().copied().fold(0.0, f64::max);
    if let Some(small) = swings.iter().position(|swing| *swing < least) {
        peaks.truncate(small + 1);
    }
    peaks
}

/// From each peak to the next, without sign.
fn swings(peaks: &[Peak]) -> Vec<f64> {
    peaks.windows(2).map(|pair| (pair[1].value - pair[0].value).abs()).collect()
}

/// Time from one peak to the next.
fn spacing(peaks: &[Peak], time: &[f64]) -> Result<f64, RingingError> {
    let times: Vec<f64> = peaks.iter().map(|peak| peak.time).collect();
    let (spacing, off) = line(&times);
    let within = time.iter().filter(|instant| times[0] < **instant && **instant <= times[times.len() - 1]);
    let samples = within.count() as f64 / (times.len() - 1) as f64;
    if samples < FEWEST_SAMPLES {
        return Err(RingingError::TooCoarse(samples));
    }
    regular("peak times", off / spacing).map(|()| spacing)
}

/// Logarithmic decrement of a half period.
fn decrement(peaks: &[Peak]) -> Result<f64, RingingError> {
    let logarithms: Vec<f64> = swings(peaks).iter().map(|swing| swing.ln()).collect();
    let (slope, off) = line(&logarithms);
    regular("swings", off.exp_m1()).map(|()| -slope)
}

fn regular(what: &'static str, share: f64) -> Result<(), RingingError> {
    if share <= TOLERANCE { Ok(()) } else { Err(RingingError::Irregular { what, share }) }
}

/// Slope of the straight line through values at 0, 1, 2, ..., and how far the worst of them is off it.
fn line(values: &[f64]) -> (f64, f64) {
    let count = values.len() as f64;
    let (middle, mean) = ((count - 1.0) / 2.0, values.iter().sum::<f64>() / count);
    let place = |index: usize| index as f64 - middle;
    let moment: f64 = values.iter().enumerate().map(|(index, value)| place(index) * value).sum();
    let slope = moment / (count * (count * count - 1.0) / 12.0);
    let off = |(index, value): (usize, &f64)| (value - mean - slope * place(index)).abs();
    (slope, values.iter().enumerate().map(off).fold(0.0, f64::max))
}

/// The mean of what each pair of peaks says: it divides their swing as 1 to exp(-decrement).
fn final_value(peaks: &[Peak], decrement: f64) -> f64 {
    let share = 1.0 / (1.0 + (-decrement).exp());
    let told = peaks.windows(2).map(|pair| pair[0].value + share * (pair[1].value - pair[0].value));
    told.sum::<f64>() / (peaks.len() - 1) as f64
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::instruments::sampled;

    /// Step response of wn^2 / (s^2 + 2 zeta wn s + wn^2), height 2.
    fn response(wn: f64, zeta: f64) -> impl Fn(f64) -> f64 {
        let wd = wn * (1.0 - zeta * zeta).sqrt();
        move |t| 2.0 - 2.0 * (-zeta * wn * t).exp() * ((wd * t).cos() + zeta * wn / wd * (wd * t).sin())
    }

    #[test]
    fn a_step_response_gives_back_what_made_it() {
        for (wn, zeta) in [(198.3, 0.0992), (322.4, 0.0383), (50.0, 0.0), (50.0, 0.4), (50.0, 0.7)] {
            let (time, values) = sampled(4000, 1e-4, response(wn, zeta));
            let read = ringing(&time, &values).unwrap();
            assert!((read.natural_frequency / wn - 1.0).abs() < 1e-5, "{wn} {zeta} {read:?}");
            assert!((read.damping - zeta).abs() < 1e-5, "{wn} {zeta} {read:?}");
            assert!((read.final_value - 2.0).abs() < 1e-4, "{wn} {zeta} {read:?}");
        }
    }

    #[test]
    fn a_growing_oscillation_has_negative_damping() {
        let (time, values) = sampled(1000, 1e-3, response(50.0, -0.05));
        assert!((ringing(&time, &values).unwrap().damping + 0.05).abs() < 1e-4);
    }

    #[test]
    fn solid_friction_beats_and_noise_are_not_one_damped_oscillation() {
        let constant_loss = |t: f64| {
            let half = (t / PI).floor();
            let side = if half % 2.0 == 0.0 { 0.06 } else { -0.06 };
            (1.0 - 0.06 * (2.0 * half + 1.0)) * t.cos() + side
        };
        let beat = |t: f64| t.sin() + (1.17 * t).sin();
        let noise = |t: f64| (1e4 * t * t).sin();
        for (name, signal) in
            [("loss", &constant_loss as &dyn Fn(f64) -> f64), ("beat", &beat), ("noise", &noise)]
        {
            let (time, values) = sampled(2000, 0.01, signal);
            let read = ringing(&time, &values);
            assert!(
                matches!(read, Err(RingingError::Irregular { .. } | RingingError::TooCoarse(_))),
                "{name}: {read:?}"
            );
        }
    }

    #[test]
    fn what_cannot_be_read_is_refused() {
        let (time, values) = sampled(1000, 1e-3, response(50.0, 0.9));
        assert!(matches!(ringing(&time, &values), Err(RingingError::TooFewPeaks(_))));
        assert_eq!(ringing(&time, &vec![1.0; 1000]), Err(RingingError::TooFewPeaks(0)));
        assert_eq!(ringing(&[], &[]), Err(RingingError::TooFewPeaks(0)));
        assert_eq!(ringing(&time, &values[1..]), Err(RingingError::NotASignal));
        let (time, values) = sampled(100, 1e-2, response(200.0, 0.01));
        assert!(matches!(ringing(&time, &values), Err(RingingError::TooCoarse(_))));
        let (time, values) = sampled(100, 1e-2, |t| 1.0 / (t - 0.5));
        assert_eq!(ringing(&time, &values), Err(RingingError::NotASignal));
    }
}
