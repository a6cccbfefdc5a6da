//! The uncertainty interval of a critical velocity: how far it depends on its criterion and on the rate of the ramp.

use super::critical_velocity::{
    Criterion, CriticalVelocity, CriticalVelocityError, critical_velocity, first_largest,
};
use super::cut::at;
use super::cycles::{Cycle, cycles};

/// The critical velocities of a run with their intervals.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CriticalRange {
    /// Where oscillation ends during the rising ramp.
    pub rising: Result<CriticalInterval, CriticalVelocityError>,
    /// Where oscillation begins during the falling ramp.
    pub falling: Result<CriticalInterval, CriticalVelocityError>,
}

/// A critical velocity and its interval, in the unit of the command.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CriticalInterval {
    /// The value for the given criterion.
    pub value: f64,
    /// The smallest of the five readings, extended by the overrun of a rising ramp.
    pub least: f64,
    /// The largest of the five readings, extended by the overrun of a falling ramp.
    pub most: f64,
    /// The largest change of the value with half or twice the threshold.
    pub by_threshold: f64,
    /// The largest change of the value with half or twice the window.
    pub by_window: f64,
    /// Absolute change of the command during the cycle next to the value; None if there is no whole cycle.
    pub overrun: Option<f64>,
    /// The number of the four other readings that failed. Their criterion is unusable with the run or finds no critical
    /// velocity. The interval omits them.
    pub unread: usize,
}

/// The factors of threshold and window for the other readings.
const FACTORS: [f64; 2] = [0.5, 2.0];

/// Reads critical velocities like [`critical_velocity`] with five criteria: the given one, and with half and twice the
/// threshold and half and twice the window.
///
/// An interval spans all readings and the overrun. An oscillation takes cycles to decay or to grow while the command
/// continues to change, so a ramp hides at least the change during one cycle. The true value is lower than the reading
/// while the command rises, and higher while it falls.
///
/// The interval does not cover two effects. A ramp that is fast compared with the decay overruns by many cycles; repeat
/// it more slowly to see this. A falling critical velocity depends on the disturbance from which the oscillation grows.
///
/// # Examples
///
/// ```
/// use patchcord_analysis::instruments::{Criterion, CriticalVelocityError, critical_range};
///
/// let time: Vec<f64> = (0..4001).map(|index| 1e-3 * f64::from(index)).collect();
/// let swing = |t: f64| if t < 3.0 { 0.5 * (100.0 * std::f64::consts::PI * t).sin() } else { 0.0 };
/// let velocity: Vec<f64> = time.iter().map(|t| t + swing(*t)).collect();
///
/// let criterion = Criterion { threshold: 0.2, window: 0.04 };
/// let interval = critical_range(&time, &time, &velocity, criterion).rising?;
/// assert!(interval.least <= interval.value && interval.value <= interval.most);
/// // The command rises by 0.02 during a cycle of 0.02 s.
/// assert!(interval.overrun.is_some_and(|overrun| (overrun - 0.02).abs() < 1e-3));
/// assert_eq!(interval.unread, 0);
/// # Ok::<(), CriticalVelocityError>(())
/// ```
pub fn critical_range(
    time: &[f64],
    command: &[f64],
    velocity: &[f64],
    criterion: Criterion,
) -> CriticalRange {
    let read = |criterion| critical_velocity(time, command, velocity, criterion);
    let given = read(criterion);
    let thresholds =
        FACTORS.map(|factor| read(Criterion { threshold: factor * criterion.threshold, ..criterion }));
    let windows = FACTORS.map(|factor| read(Criterion { window: factor * criterion.window, ..criterion }));
    let overruns = overruns(time, command, velocity, criterion);
    let interval = |of: fn(&CriticalVelocity) -> Result<f64, CriticalVelocityError>, overrun: Option<f64>| {
        let others = [thresholds, windows].map(|pair| pair.map(|read| of(&read)));
        of(&given).map(|value| CriticalInterval::new(value, others, overrun))
    };
    CriticalRange {
        rising: interval(|read| read.rising, overruns[0]),
        falling: interval(|read| read.falling, overruns[1]),
    }
}

impl CriticalInterval {
    /// Combines the value, the readings with other thresholds and with other windows, and the signed overrun.
    fn new(
        value: f64,
        [thresholds, windows]: [[Result<f64, CriticalVelocityError>; 2]; 2],
        overrun: Option<f64>,
    ) -> Self {
        let moved = |others: &[Result<f64, _>; 2]| {
            others.iter().flatten().map(|other| (other - value).abs()).fold(0.0, f64::max)
        };
        let true_value = overrun.map(|overrun| value + overrun);
        let all = || thresholds.iter().chain(&windows).flatten().copied().chain(true_value);
        CriticalInterval {
            value,
            least: all().fold(value, f64::min),
            most: all().fold(value, f64::max),
            by_threshold: moved(&thresholds),
            by_window: moved(&windows),
            overrun: overrun.map(f64::abs),
            unread: thresholds.iter().chain(&windows).filter(|other| other.is_err()).count(),
        }
    }
}

/// The change from the end to the start of a cycle: the last cycle before the turn and the first one after it. Added to
/// the reading, it gives the command that caused the change.
fn overruns(time: &[f64], command: &[f64], velocity: &[f64], criterion: Criterion) -> [Option<f64>; 2] {
    let Ok(found) = cycles(time, command, velocity, criterion) else { return [None; 2] };
    let turn = time[first_largest(command)];
    let back = |cycle: &Cycle| at(time, command, cycle.begin) - at(time, command, cycle.end);
    let last = found.iter().rfind(|cycle| cycle.end <= turn);
    [last, found.iter().find(|cycle| cycle.begin >= turn)].map(|cycle| cycle.map(back))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::instruments::sampled;

    const CRITERION: Criterion = Criterion { threshold: 0.2, window: 0.04 };

    /// The command rises by 0.1 per second for 8 s and falls back. The velocity swings by 1 at 50 Hz. Above the
    /// command 0.3 the swing decays by e every half second, and it grows at the same rate on the way back. `sign`
    /// mirrors it all.
    fn profile(sign: f64) -> CriticalRange {
        let ramp = |t: f64| 0.1 * t.min(16.0 - t);
        let (time, command) = sampled(32_001, 5e-4, |t| sign * ramp(t));
        let height = |t: f64| 0.5 * ((0.3 - ramp(t)) / 0.1 / DECAY_TIME).exp().min(1.0);
        let wave = |t: f64| height(t) * (100.0 * std::f64::consts::PI * t).sin();
        let (_, velocity) = sampled(32_001, 5e-4, |t| sign * (ramp(t) + wave(t)));
        critical_range(&time, &command, &velocity, CRITERION)
    }

    /// The time in which the swing decays by a factor of e, in seconds.
    const DECAY_TIME: f64 = 0.5;

    fn near(got: f64, wanted: f64, within: f64) {
        assert!((got - wanted).abs() < within, "{got} {wanted}");
    }

    #[test]
    fn an_interval_covers_the_influence_of_the_criterion() {
        let found = profile(1.0);
        let (rising, falling) = (found.rising.unwrap(), found.falling.unwrap());
        // Half the threshold is passed later by ln 2 x the decay time, twice the threshold earlier by the same.
        let step = 0.1 * DECAY_TIME * 2.0_f64.ln();
        for interval in [rising, falling] {
            near(interval.by_threshold, step, 0.003);
            near(interval.overrun.unwrap(), 0.002, 1e-5);
            assert_eq!(interval.unread, 0, "{interval:?}");
            assert!(interval.by_window <= 0.004, "{interval:?}");
        }
        near(rising.value, 0.3 + 0.1 * DECAY_TIME * 5.0_f64.ln(), 0.003);
        for (end, sign) in [(rising.most, 1.0), (rising.least, -1.0)] {
            near(end, rising.value + sign * step, 0.003);
        }
        for (end, sign) in [(falling.most, 1.0), (falling.least, -1.0)] {
            near(end, falling.value + sign * step, 0.003);
        }
    }

    #[test]
    fn if_all_readings_agree_only_the_overrun_counts() {
        let ends = |value: f64, overrun: Option<f64>| {
            let interval = CriticalInterval::new(value, [[Ok(value); 2]; 2], overrun);
            [interval.least, interval.most]
        };
        assert_eq!(ends(3.0, Some(-0.25)), [2.75, 3.0]);
        assert_eq!(ends(3.0, Some(0.25)), [3.0, 3.25]);
        assert_eq!(ends(3.0, None), [3.0, 3.0]);
    }

    #[test]
    fn a_mirrored_run_gives_the_mirrored_interval() {
        let [forward, backward] = [1.0, -1.0].map(|sign| profile(sign).rising.unwrap());
        assert_eq!(
            (forward.value, forward.least, forward.most),
            (-backward.value, -backward.most, -backward.least)
        );
    }

    #[test]
    fn failed_readings_are_counted_and_omitted() {
        // The command rises by 0.04 in a window of 0.04 s, which exceeds half the threshold.
        let (time, command) = sampled(4001, 1e-3, |t| t);
        let swing = |t: f64| if t < 3.0 { 0.5 * (100.0 * std::f64::consts::PI * t).sin() } else { 0.0 };
        let (_, velocity) = sampled(4001, 1e-3, |t| t + swing(t));
        let criterion = Criterion { threshold: 0.07, window: 0.04 };
        let found = critical_range(&time, &command, &velocity, criterion);
        assert_eq!(found.rising.unwrap().unread, 2, "half the threshold, twice the window");
        assert_eq!(found.falling, Err(CriticalVelocityError::NeverBack));
        let found = critical_range(&time, &command, &command, criterion);
        assert_eq!(found.rising, Err(CriticalVelocityError::NoOscillation));
        assert_eq!(critical_range(&[], &[], &[], criterion).rising, Err(CriticalVelocityError::NotASignal));
    }
}
