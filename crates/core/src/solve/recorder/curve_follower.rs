//! Follows curves of one signal against another one: decides where they need points, and thins the points as they come.
//!
//! A straight curve needs points only every [`MAX_SPACING`] steps, a bent one at every step, or within steps. The time
//! to the next point follows from the bend at the last ones. After each event it is short again, because a rate may
//! have jumped. Corners of tables of time are no events if they are at the end of a step, but they are points.

use std::sync::Arc;

use super::{Watch, find_signal, per_volt};
use crate::chords::{Chord, CurvePoint, thin};
use crate::ir::{Program, SignalInfo, TableCorners};
use crate::solve::discontinuities::next_corner;
use crate::solve::error::RunError;
use crate::solve::settings::RunSettings;
use crate::solve::state::Solver;
use crate::trace::{CurveAxis, SignalCurve};

/// Number of points at which a curve is thinned. A curve of very many repetitions has two for each of them.
const MAX_POINTS: usize = 20_000;
/// Largest distance in volts, along each axis, between the points of a curve and the straight lines that replace them.
const MAX_TOLERANCE: f64 = 0.02;
/// The same as a share of the range of the signal so far, for signals that use a small part of the machine's range. It
/// is a fraction of a pixel in a picture.
const TOLERANCE_SHARE: f64 = 1.0 / 4000.0;
/// Least distance in volts, so that rounding alone needs no points.
const MIN_TOLERANCE: f64 = 1e-6;
/// Largest factor of the tolerance of long curves. With it, all voltages of the machine are within the tolerance.
const MAX_COARSENESS: f64 = 32_768.0;

/// Time to the next point after an event, in steps.
const FIRST_SPACING: f64 = 0.25;
/// Least time between points, in steps.
const MIN_SPACING: f64 = 1.0 / 64.0;
/// Largest time between points of equal steps, in steps.
const MAX_SPACING: f64 = 16.0;
/// Largest factor by which the time between points grows from one point to the next.
const MAX_GROWTH: f64 = 2.0;

/// A signal of a curve.
#[derive(Debug)]
pub(super) struct FollowedSignal {
    /// The signal.
    pub signal: SignalInfo,
    /// Value of one volt in the unit of the signal, at the beginning of the run.
    pub per_volt: f64,
}

/// The curves of the settings: their signals without repetitions, and the watch that follows them. The watch is `None`
/// if there are no curves.
///
/// # Errors
/// If a signal is unknown.
pub(super) fn follow(
    program: &Program,
    solver: &Solver<'_>,
    settings: &RunSettings,
) -> Result<(Vec<FollowedSignal>, Option<Watch>), RunError> {
    let mut signals: Vec<FollowedSignal> = Vec::new();
    let mut curves = Vec::new();
    for (x, y) in &settings.curves {
        let mut registers = [0; 2];
        for (register, name) in registers.iter_mut().zip([x, y]) {
            let signal = find_signal(program, name)?;
            let known = signals.iter().position(|followed| followed.signal.name == signal.name);
            *register = known.unwrap_or(signals.len());
            if known.is_none() {
                signals.push(FollowedSignal { per_volt: per_volt(&signal, solver), signal });
            }
        }
        curves.push(FollowedCurve::new(registers, registers.map(|register| axis(&signals[register]))));
    }
    if curves.is_empty() {
        return Ok((signals, None));
    }
    let registers = signals.iter().map(|followed| followed.signal.register).collect();
    let follower = CurveFollower::new(curves, Arc::clone(&program.corners), settings);
    Ok((signals, Some(Watch::following(registers, follower))))
}

/// The axis of a curve along which a signal is.
fn axis(followed: &FollowedSignal) -> CurveAxis {
    let FollowedSignal { signal, per_volt } = followed;
    CurveAxis { name: signal.name.clone(), unit: signal.unit.clone(), per_volt: *per_volt }
}

/// The curves of a run, and where they need the next point.
#[derive(Debug, Clone)]
pub(super) struct CurveFollower {
    /// The curves.
    curves: Vec<FollowedCurve>,
    /// Lowest and highest voltage of each watched register so far.
    ranges: Vec<[f64; 2]>,
    /// Length of equal steps, or of the first step tried, in problem seconds.
    step: f64,
    /// Time from the last point to the next one, in steps. It is a whole number if it is 1 or more.
    spacing: f64,
    /// The largest time between points, in steps.
    max_spacing: f64,
    /// The problem times at which tables of time have corners.
    corners: Arc<TableCorners>,
    /// The point before the last one, and the last one.
    recent: [RecentPoint; 2],
}

/// A point of all curves.
#[derive(Debug, Clone)]
struct RecentPoint {
    /// Its time by the recorder's clock; NaN if there is no point yet.
    time: f64,
    /// The voltages of the watched registers.
    volts: Vec<f64>,
}

impl CurveFollower {
    /// Curves without points, of a run with these corners of tables and these settings.
    fn new(curves: Vec<FollowedCurve>, corners: Arc<TableCorners>, settings: &RunSettings) -> Self {
        let none = || RecentPoint { time: f64::NAN, volts: Vec::new() };
        CurveFollower {
            curves,
            ranges: Vec::new(),
            step: settings.step,
            spacing: FIRST_SPACING,
            corners,
            max_spacing: if settings.tolerance.is_some() { f64::INFINITY } else { MAX_SPACING },
            recent: [none(), none()],
        }
    }

    /// Whether the next point is within the next step.
    pub(super) fn is_within_step(&self) -> bool {
        self.spacing < 1.0
    }

    /// Time from the last point to the next one, in problem seconds.
    pub(super) fn seconds(&self) -> f64 {
        self.spacing * self.step
    }

    /// The problem time of the next point, if that of the last one is `last`: a corner, if there is one before.
    pub(super) fn next_point(&self, last: f64) -> f64 {
        let next = last + self.seconds();
        next_corner(self.corners.times(), last, self.step).map_or(next, |corner| next.min(corner))
    }

    /// Begins a repetition: the next point begins a curve.
    pub(super) fn begin_repetition(&mut self) {
        self.curves.iter_mut().for_each(FollowedCurve::end_chord);
    }

    /// Notes that rates may jump at the last point.
    pub(super) fn restart(&mut self) {
        self.spacing = FIRST_SPACING;
        // The bend at the last point then does not count.
        self.recent[0].time = self.recent[1].time;
    }

    /// Adds a point at a time of the recorder's clock.
    pub(super) fn add(&mut self, time: f64, volts: &[f64]) {
        self.ranges.resize(volts.len(), [f64::INFINITY, f64::NEG_INFINITY]);
        for ([low, high], volts) in self.ranges.iter_mut().zip(volts) {
            (*low, *high) = (low.min(*volts), high.max(*volts));
        }
        self.adapt_spacing(time, volts);
        self.recent.swap(0, 1);
        let [_, last] = &mut self.recent;
        last.time = time;
        last.volts.clear();
        last.volts.extend_from_slice(volts);
        self.curves.iter_mut().for_each(|curve| curve.add(time, volts, &self.ranges));
    }

    /// Adapts the time to the next point to the bend of the voltages at the last point, before this point is added. The
    /// distance of a curve from its chord grows with the square of the time between the ends of the chord.
    fn adapt_spacing(&mut self, time: f64, volts: &[f64]) {
        let [before, last] = &self.recent;
        let (first, second) = (last.time - before.time, time - last.time);
        if second <= 0.0 {
            self.spacing = FIRST_SPACING;
        } else if first > 0.0 {
            let share = first / (first + second);
            let coarseness = self.curves.iter().map(|curve| curve.coarseness).fold(MAX_COARSENESS, f64::min);
            let mut bend: f64 = 0.0;
            for (index, volts) in volts.iter().enumerate() {
                let chord = before.volts[index] + (volts - before.volts[index]) * share;
                let distance = (last.volts[index] - chord).abs();
                bend = bend.max(distance / (coarseness * tolerance(self.ranges[index])));
            }
            let steps = (4.0 * first * second / bend).sqrt() / self.step;
            let steps = steps.clamp(MIN_SPACING, (MAX_GROWTH * self.spacing).min(self.max_spacing));
            self.spacing = if steps < 1.0 { steps } else { steps.floor() };
        }
    }

    /// The curves.
    pub(super) fn into_curves(self) -> Vec<SignalCurve> {
        let finished = self.curves.into_iter().map(|mut curve| {
            curve.end_chord();
            curve.curve
        });
        finished.collect()
    }
}

/// The tolerance of a signal with this range, in volts.
fn tolerance([low, high]: [f64; 2]) -> f64 {
    (TOLERANCE_SHARE * (high - low)).clamp(MIN_TOLERANCE, MAX_TOLERANCE)
}

/// A curve while it is followed.
#[derive(Debug, Clone)]
struct FollowedCurve {
    /// The indices of its signals among the watched registers.
    registers: [usize; 2],
    /// The ends of the chords so far.
    curve: SignalCurve,
    /// The chord that is being extended; `None` before the first point of a repetition.
    chord: Option<Chord>,
    /// The factor of the tolerances. It doubles whenever the curve has too many points.
    coarseness: f64,
    /// The number of points at which the curve is thinned.
    max_points: usize,
}

impl FollowedCurve {
    /// A curve without points.
    fn new(registers: [usize; 2], axes: [CurveAxis; 2]) -> Self {
        let curve = SignalCurve { axes, points: Vec::new() };
        FollowedCurve { registers, curve, chord: None, coarseness: 1.0, max_points: MAX_POINTS }
    }

    /// The present tolerances along the axes, for signals with these ranges.
    fn tolerances(&self, ranges: &[[f64; 2]]) -> [f64; 2] {
        self.registers.map(|register| self.coarseness * tolerance(ranges[register]))
    }

    /// Adds a point.
    fn add(&mut self, time: f64, volts: &[f64], ranges: &[[f64; 2]]) {
        let tolerances = self.tolerances(ranges);
        let begins = self.chord.is_none();
        let point = CurvePoint { time, volts: self.registers.map(|register| volts[register]), begins };
        match &mut self.chord {
            Some(chord) => self.curve.points.extend(chord.extend(point, tolerances).into_iter().flatten()),
            None => {
                self.chord = Some(Chord::new(point));
                self.curve.points.push(point);
            }
        }
        if self.curve.points.len() >= self.max_points {
            self.thin(ranges);
        }
    }

    /// Ends the present chord. The next point begins a curve.
    fn end_chord(&mut self) {
        self.curve.points.extend(self.chord.take().and_then(|chord| chord.open_end()));
    }

    /// Thins the curve until it has at most three quarters of the points, or only those at which repetitions begin and
    /// end.
    fn thin(&mut self, ranges: &[[f64; 2]]) {
        while self.curve.points.len() > MAX_POINTS / 4 * 3 && self.coarseness < MAX_COARSENESS {
            self.coarseness *= 2.0;
            let tolerances = self.tolerances(ranges);
            thin(&mut self.curve.points, tolerances);
        }
        self.max_points = MAX_POINTS.max(2 * self.curve.points.len());
    }
}

#[cfg(test)]
mod tests;
