//! What a force may depend on: what the patch itself does, and how long it has been at rest.

use nalgebra::DMatrix;

use crate::effects::sites::Reading;
use crate::localise::unknown_input::{Instant, Shape};
use crate::statistics::descriptive::ends;

/// A quantity, and its course beside every record.
#[derive(Debug, Clone)]
pub struct Variable {
    /// What it is called.
    pub name: String,
    /// Its unit.
    pub unit: String,
    /// Where it is read in the patch, if it is anywhere.
    pub reading: Option<Reading>,
    /// Of every record, its values at the samples.
    pub tracks: Vec<Vec<f64>>,
    /// Whether a force over it may jump where it changes sign.
    pub may_jump: bool,
}

/// On either side of 0 a jump takes this share of the range.
const JUMP: f64 = 2e-3;
/// What is slower than this share of the fastest is at rest,
const AT_REST: f64 = 0.01;
/// and a rest that is shorter than so many samples is none.
const LEAST_REST: usize = 5;

impl Variable {
    /// The time for which another has been at rest; nothing where it never is.
    pub fn rest_of(own: &Variable, intervals: &[f64]) -> Option<Variable> {
        let fastest = own.tracks.iter().flatten().fold(0.0, |most: f64, value| most.max(value.abs()));
        let rests = |(track, interval): (&Vec<f64>, &f64)| {
            let mut rested = 0;
            let values = track.iter().map(|value| {
                rested = if value.abs() < AT_REST * fastest { rested + 1 } else { 0 };
                rested.max(LEAST_REST) - LEAST_REST
            });
            values.map(|samples| samples as f64 * interval).collect::<Vec<f64>>()
        };
        let tracks: Vec<Vec<f64>> = own.tracks.iter().zip(intervals).map(rests).collect();
        let rests = tracks.iter().flatten().any(|time| *time > 0.0);
        let (name, unit) = ("time at rest".to_owned(), "s".to_owned());
        rests.then_some(Variable { name, unit, reading: None, tracks, may_jump: false })
    }

    /// So many knots over its range, with two about 0 where a force may jump there; nothing where it stands still.
    pub fn knots(&self, count: usize) -> Option<Vec<f64>> {
        let [low, high] = ends(self.tracks.iter().flatten().copied());
        let range = high - low;
        if range.is_nan() || range <= 1e-9 * low.abs().max(high.abs()) {
            return None;
        }
        let mut knots: Vec<f64> =
            (0..count).map(|place| low + range * place as f64 / (count - 1) as f64).collect();
        let jump = JUMP * range;
        if self.may_jump && low < -jump && high > jump {
            knots.retain(|knot| knot.abs() > 2.0 * jump);
            let place = knots.partition_point(|knot| *knot < 0.0);
            knots.splice(place..place, [-jump, jump]);
        }
        Some(knots)
    }

    /// A force over time, `time`, as a curve over these knots, or as two where it `turns`, for rising and for falling: of each
    /// number of the force the shares of those of the curve, in the mean over the samples beside it.
    pub fn shares(&self, time: &Shape, knots: &[f64], turns: bool, intervals: &[f64]) -> DMatrix<f64> {
        let branches = 1 + usize::from(turns);
        let mut shares = DMatrix::zeros(time.count(), branches * knots.len());
        for ((track, interval), points) in self.tracks.iter().zip(intervals).zip(&time.records) {
            let times: Vec<f64> = points.iter().map(|point| point.0).collect();
            for ((sample, value), falls) in track.iter().enumerate().zip(falling(track)) {
                let first = if turns && falls { knots.len() } else { 0 };
                for (row, near) in beside(points, &times, sample as f64 * interval) {
                    for (place, share) in parts(knots, *value) {
                        shares[(row, first + place)] += near * share;
                    }
                }
            }
        }
        for mut row in shares.row_iter_mut() {
            let sum = row.sum();
            row /= if sum > 0.0 { sum } else { 1.0 };
        }
        shares
    }

    /// Its value at a time of a record.
    pub fn at(&self, record: usize, time: f64, interval: f64) -> f64 {
        let track = &self.tracks[record];
        track[((time / interval).round() as usize).min(track.len() - 1)]
    }
}

/// Between which knots a value lies, and how near it is to each.
fn parts(knots: &[f64], value: f64) -> [(usize, f64); 2] {
    let place = knots.partition_point(|knot| *knot < value).clamp(1, knots.len() - 1);
    let share = ((value - knots[place - 1]) / (knots[place] - knots[place - 1])).clamp(0.0, 1.0);
    [(place - 1, 1.0 - share), (place, share)]
}

/// Of the numbers of a force over time those on either side of an instant, and how near it is to each.
fn beside(points: &[Instant], times: &[f64], time: f64) -> Vec<(usize, f64)> {
    let near = parts(times, time).into_iter();
    near.flat_map(|(place, near)| points[place].1.iter().map(move |(number, share)| (*number, near * share)))
        .collect()
}

/// Where a track falls; where it stands, as before.
fn falling(track: &[f64]) -> Vec<bool> {
    let mut falls = false;
    let mut before = track.first().copied().unwrap_or_default();
    let each = track.iter().map(|value| {
        if *value != before {
            falls = *value < before;
        }
        before = *value;
        falls
    });
    each.collect()
}
