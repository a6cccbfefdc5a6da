//! The curve of one channel against the other one, thinned to the ends of chords.

use std::f64::consts::FRAC_1_SQRT_2;
use std::mem;

use super::Sample;
use patchcord_core::chords::{Chord, CurvePoint, thin};

/// The largest number of points of a curve.
const MAX_POINTS: usize = 20_000;

/// A curve that is full keeps at most this number of points.
const POINTS_OF_FULL: usize = MAX_POINTS * 3 / 4;

/// How much larger the tolerance of a long curve is. A chord of twice the length is four times as far from the curve.
/// So half of the points remain. When the curve is full again, the oldest points are removed instead, because a larger
/// tolerance would be visible.
const COARSER: f64 = 4.0;

/// The present curve and, until a frame has it, the one before.
///
/// As with traces against time, the last frame of a generation completes its curve.
#[derive(Debug, Clone)]
pub(super) struct Curve {
    /// The present curve.
    current: Points,
    /// The curve before, if `has_finished`.
    finished: Points,
    /// Whether the next frame shows `finished`.
    has_finished: bool,
    /// The chord that is being extended; absent before the first point and after a gap.
    chord: Option<Chord>,
    /// Largest distance in volts between a short curve and the points that it is made from.
    tolerance: f64,
    /// Whether the tolerance is [`COARSER`] times as large.
    is_coarse: bool,
}

/// The points of a curve.
#[derive(Debug, Clone, Default)]
struct Points {
    /// A number that grows from curve to curve.
    generation: u32,
    /// The ends of the chords.
    points: Vec<CurvePoint>,
    /// The number of points that frames have.
    sent: usize,
}

impl Curve {
    /// An empty curve with this tolerance in volts.
    pub(super) fn new(tolerance: f64) -> Self {
        Curve {
            current: Points::default(),
            finished: Points::default(),
            has_finished: false,
            chord: None,
            tolerance,
            is_coarse: false,
        }
    }

    /// The generation of the present curve.
    pub(super) fn generation(&self) -> u32 {
        self.current.generation
    }

    /// Gives the present curve this generation, because the screen showed something else before.
    pub(super) fn set_generation(&mut self, generation: u32) {
        self.current.generation = generation;
        self.current.sent = 0;
        self.has_finished = false;
    }

    /// Sets the tolerance in volts of the points that follow.
    pub(super) fn set_tolerance(&mut self, tolerance: f64) {
        self.tolerance = tolerance;
    }

    /// The tolerances of the next points along both axes.
    fn present_tolerances(&self) -> [f64; 2] {
        let tolerance = if self.is_coarse { COARSER * self.tolerance } else { self.tolerance };
        [tolerance * FRAC_1_SQRT_2; 2]
    }

    /// Ends the present curve, because a run begins.
    pub(super) fn begin_run(&mut self) {
        self.end_chord();
        if self.current.sent < self.current.points.len() {
            let generation = self.current.generation;
            mem::swap(&mut self.current, &mut self.finished);
            self.current.generation = generation;
            self.has_finished = true;
        }
        self.clear();
    }

    /// Removes the curve.
    pub(super) fn erase(&mut self) {
        self.has_finished = false;
        self.clear();
    }

    /// Begins an empty curve of the next generation.
    fn clear(&mut self) {
        self.current.generation = self.current.generation.wrapping_add(1);
        self.current.points.clear();
        self.current.sent = 0;
        self.chord = None;
        self.is_coarse = false;
    }

    /// Adds a sample. Without a voltage at both channels there is a gap.
    pub(super) fn add(&mut self, sample: &Sample) {
        if !sample.volts.iter().all(|volts| volts.is_finite()) {
            self.end_chord();
            return;
        }
        let tolerances = self.present_tolerances();
        let point = CurvePoint { volts: sample.volts, time: sample.time, begins: self.chord.is_none() };
        match &mut self.chord {
            Some(chord) => {
                let ended = chord.extend(point, tolerances);
                ended.into_iter().flatten().for_each(|point| self.push(point));
            }
            None => {
                self.chord = Some(Chord::new(point));
                self.push(point);
            }
        }
    }

    /// Ends the present chord. The next point begins a curve.
    fn end_chord(&mut self) {
        if let Some(end) = self.chord.take().and_then(|chord| chord.open_end()) {
            self.push(end);
        }
    }

    /// Adds the end of a chord. A full curve is thinned.
    fn push(&mut self, point: CurvePoint) {
        self.current.points.push(point);
        if self.current.points.len() < MAX_POINTS {
            return;
        }
        self.current.sent = 0;
        if !mem::replace(&mut self.is_coarse, true) {
            let tolerances = self.present_tolerances();
            thin(&mut self.current.points, tolerances);
        }
        if self.current.points.len() > POINTS_OF_FULL {
            self.current.points.drain(..MAX_POINTS / 2);
            self.current.points[0].begins = true;
        }
    }

    /// Removes what is after a time, because the machine was moved back to it.
    pub(super) fn cut(&mut self, time: f64) {
        let points = &mut self.current.points;
        points.truncate(points.partition_point(|point| point.time <= time));
        self.current.sent = self.current.sent.min(points.len());
        self.chord = points.last().copied().map(Chord::new);
    }

    /// Appends the points of the next frame, if both channels are in use.
    pub(super) fn encode(&mut self, has_both_channels: bool, out: &mut Vec<u8>) {
        if !has_both_channels {
            out.extend_from_slice(&self.current.generation.to_le_bytes());
            out.extend_from_slice(&0_u32.to_le_bytes());
            return;
        }
        let has_finished = mem::take(&mut self.has_finished);
        let (curve, open_end) = if has_finished {
            (&mut self.finished, None)
        } else {
            (&mut self.current, self.chord.and_then(|chord| chord.open_end()))
        };
        let first = curve.sent;
        let count = curve.points.len() - first + usize::from(open_end.is_some());
        out.extend_from_slice(&curve.generation.to_le_bytes());
        out.extend_from_slice(&1_u32.to_le_bytes());
        out.extend_from_slice(&(first as u32).to_le_bytes());
        out.extend_from_slice(&(count as u32).to_le_bytes());
        let mut before = first.checked_sub(1).map(|index| curve.points[index]);
        for point in curve.points[first..].iter().chain(&open_end) {
            let previous = before.filter(|_| !point.begins);
            let seconds = previous.map_or(-1.0, |previous| point.time - previous.time);
            for value in [point.volts[0], point.volts[1], seconds] {
                out.extend_from_slice(&(value as f32).to_le_bytes());
            }
            before = Some(*point);
        }
        curve.sent = curve.points.len();
    }
}

#[cfg(test)]
mod tests;
