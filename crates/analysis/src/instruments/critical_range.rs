//! How far a critical velocity depends on its criterion: an interval beside the value.

use super::critical_velocity::{
    Criterion, CriticalVelocity, NoCriticalVelocity, critical_velocity, first_largest,
};
use super::cut::at;
use super::cycles::{Cycle, cycles};

/// The critical velocities of a profile with their intervals.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CriticalRange {
    /// Where oscillation ends while the command rises.
    pub rising: Result<CriticalInterval, NoCriticalVelocity>,
    /// Where it begins while the command falls.
    pub falling: Result<CriticalInterval, NoCriticalVelocity>,
}

/// A critical velocity and how far it moves, in the unit of the command.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CriticalInterval {
    /// What is read with the criterion as given.
    pub value: f64,
    /// The least of all readings, less the overrun while the command rises.
    pub least: f64,
    /// The largest of all readings, with the overrun while the command falls.
    pub most: f64,
    /// How far it moves, either way, with half and double of the threshold.
    pub by_threshold: f64,
    /// How far it moves, either way, with half and double of the window.
    pub by_window: f64,
    /// By how much the command changes in the cycle next to it, without sign; nothing where there is no whole cycle to see.
    pub overrun: Option<f64>,
    /// How many of the four other readings cannot be had: a criterion that the run is too coarse or too fast for, or
    /// that finds no critical velocity. The interval leaves them out.
    pub unread: usize,
}

/// Half and double.
const FACTORS: [f64; 2] = [0.5, 2.0];

/// Reads critical velocities like [`critical_velocity`], and again with half and double of the threshold and half and double of the window, one
/// at a time. An interval spans all readings. It goes further by the overrun, to the side on which the
/// true velocity lies: an oscillation that has begun to die takes cycles to do so and a new one to grow, while the command goes on;
/// one cycle's worth is the least that a ramp hides. While the command rises the true one lies lower, while it falls higher.
///
/// What an interval does not hold: a ramp that is quick against the decay overruns by many cycles (run it slower to see), and a
/// falling critical velocity depends on the disturbance that there is to grow from.
pub fn critical_range(
    time: &[f64],
    command: &[f64],
    velocity: &[f64],
    criterion: Criterion,
) -> CriticalRange {
    let read = |criterion| critical_velocity(time, command, velocity, criterion);
    let usual = read(criterion);
    let thresholds =
        FACTORS.map(|factor| read(Criterion { threshold: factor * criterion.threshold, ..criterion }));
    let windows = FACTORS.map(|factor| read(Criterion { window: factor * criterion.window, ..criterion }));
    let next = overruns(time, command, velocity, criterion);
    let interval = |of: fn(&CriticalVelocity) -> Result<f64, NoCriticalVelocity>, overrun: Option<f64>| {
        let others = [thresholds, windows].map(|pair| pair.map(|read| of(&read)));
        of(&usual).map(|value| CriticalInterval::new(value, others, overrun))
    };
    CriticalRange {
        rising: interval(|read| read.rising, next[0]),
        falling: interval(|read| read.falling, next[1]),
    }
}

impl CriticalInterval {
    /// The interval of a value, of what is read with other thresholds and with other windows, and of how far the true one lies
    /// from it.
    fn new(
        value: f64,
        [thresholds, windows]: [[Result<f64, NoCriticalVelocity>; 2]; 2],
        overrun: Option<f64>,
    ) -> Self {
        let moved = |others: &[Result<f64, _>; 2]| {
            others.iter().flatten().map(|other| (other - value).abs()).fold(0.0, f64::max)
        };
        let beyond = overrun.map(|overrun| value + overrun);
        let all = || thresholds.iter().chain(&windows).flatten().copied().chain(beyond);
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

/// How far before the last cycle on the way to the turn and before the first one on the way back the command stood: it is back there
/// that the true velocity lies.
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

    /// Rises by 0.1 a second for 8 s and comes back, swinging at 50 Hz: by 1 at first, from 0.3 on less by e every half second,
    /// from 0.3 on down more again as quickly.
    fn profile(way: f64) -> CriticalRange {
        let ramp = |t: f64| 0.1 * t.min(16.0 - t);
        let (time, command) = sampled(32_001, 5e-4, |t| way * ramp(t));
        let height = |t: f64| 0.5 * ((0.3 - ramp(t)) / 0.1 / DIES_IN).exp().min(1.0);
        let wave = |t: f64| height(t) * (100.0 * std::f64::consts::PI * t).sin();
        let (_, velocity) = sampled(32_001, 5e-4, |t| way * (ramp(t) + wave(t)));
        critical_range(&time, &command, &velocity, CRITERION)
    }

    const DIES_IN: f64 = 0.5;

    fn near(got: f64, wanted: f64, within: f64) {
        assert!((got - wanted).abs() < within, "{got} {wanted}");
    }

    #[test]
    fn an_interval_tells_what_the_criterion_does() {
        let found = profile(1.0);
        let (rising, falling) = (found.rising.unwrap(), found.falling.unwrap());
        // Half the threshold is passed so much later, double of it so much sooner.
        let step = 0.1 * DIES_IN * 2.0_f64.ln();
        for interval in [rising, falling] {
            near(interval.by_threshold, step, 0.003);
            near(interval.overrun.unwrap(), 0.002, 1e-5);
            assert_eq!(interval.unread, 0, "{interval:?}");
            assert!(interval.by_window <= 0.004, "{interval:?}");
        }
        near(rising.value, 0.3 + 0.1 * DIES_IN * 5.0_f64.ln(), 0.003);
        for (end, way) in [(rising.most, 1.0), (rising.least, -1.0)] {
            near(end, rising.value + way * step, 0.003);
        }
        for (end, way) in [(falling.most, 1.0), (falling.least, -1.0)] {
            near(end, falling.value + way * step, 0.003);
        }
    }

    #[test]
    fn where_the_criterion_does_nothing_the_overrun_is_left() {
        let ends = |value: f64, overrun: Option<f64>| {
            let interval = CriticalInterval::new(value, [[Ok(value); 2]; 2], overrun);
            [interval.least, interval.most]
        };
        assert_eq!(ends(3.0, Some(-0.25)), [2.75, 3.0]);
        assert_eq!(ends(3.0, Some(0.25)), [3.0, 3.25]);
        assert_eq!(ends(3.0, None), [3.0, 3.0]);
    }

    #[test]
    fn backward_the_interval_lies_on_the_other_side() {
        let [forward, backward] = [1.0, -1.0].map(|way| profile(way).rising.unwrap());
        assert_eq!(
            (forward.value, forward.least, forward.most),
            (-backward.value, -backward.most, -backward.least)
        );
    }

    #[test]
    fn what_cannot_be_read_is_counted_and_left_out() {
        // The command rises by 0.04 in a window of 0.04: half of this threshold is passed by it alone.
        let (time, command) = sampled(4001, 1e-3, |t| t);
        let swing = |t: f64| if t < 3.0 { 0.5 * (100.0 * std::f64::consts::PI * t).sin() } else { 0.0 };
        let (_, velocity) = sampled(4001, 1e-3, |t| t + swing(t));
        let criterion = Criterion { threshold: 0.07, window: 0.04 };
        let found = critical_range(&time, &command, &velocity, criterion);
        assert_eq!(found.rising.unwrap().unread, 2, "half the threshold, double of the window");
        assert_eq!(found.falling, Err(NoCriticalVelocity::NeverBack));
        let found = critical_range(&time, &command, &command, criterion);
        assert_eq!(found.rising, Err(NoCriticalVelocity::Quiet));
        assert_eq!(critical_range(&[], &[], &[], criterion).rising, Err(NoCriticalVelocity::NotASignal));
    }
}
