//! Regressors: quantities on which an unknown input may depend, with their trajectories, and curves over them.
//!
//! An input over time is first estimated without an assumption about its cause. Then each regressor is tested: the
//! input becomes a piecewise linear curve over the regressor. This only needs a matrix that maps the values at the
//! curve's knots to the coefficients over time.

use nalgebra::DMatrix;

use crate::effects::sites::ScaledSignal;
use crate::localise::input_basis::{BasisPoint, InputBasis};
use crate::statistics::descriptive::extremes;

/// A quantity on which an input may depend, with its values in every record.
#[derive(Debug, Clone)]
pub(crate) struct Regressor {
    /// The name of the signal or drive, or "time at rest".
    pub name: String,
    /// The unit of the values.
    pub unit: String,
    /// The signal in the patch. `None` if no voltage of the patch carries the quantity.
    pub signal: Option<ScaledSignal>,
    /// The values at the samples, for every record.
    pub trajectories: Vec<Vec<f64>>,
    /// Whether a curve may jump where the quantity changes sign, as friction does with velocity.
    pub may_jump: bool,
}

/// Half the width of a jump at zero, as a share of the regressor's range. A function generator needs a finite width.
const JUMP_HALF_WIDTH: f64 = 2e-3;
/// Speed below which a body counts as at rest, as a share of its largest speed in the records.
const REST_SPEED: f64 = 0.01;
/// Least duration of a rest, in samples. A reversal of the motion is shorter.
const MIN_REST_SAMPLES: usize = 5;
/// Least range of a regressor, as a share of its largest magnitude. A smaller range is rounding.
const MIN_RELATIVE_RANGE: f64 = 1e-9;

impl Regressor {
    /// The time, in seconds, for which a velocity has been at rest; 0 in motion. `intervals` are the sampling intervals
    /// of the records. `None` if there is no rest in any record.
    pub(crate) fn time_at_rest(velocity: &Regressor, intervals: &[f64]) -> Option<Regressor> {
        let fastest =
            velocity.trajectories.iter().flatten().fold(0.0, |most: f64, value| most.max(value.abs()));
        let rest_times = |(trajectory, interval): (&Vec<f64>, &f64)| {
            let mut rest_samples = 0;
            let counts = trajectory.iter().map(|value| {
                rest_samples = if value.abs() < REST_SPEED * fastest { rest_samples + 1 } else { 0 };
                rest_samples.max(MIN_REST_SAMPLES) - MIN_REST_SAMPLES
            });
            counts.map(|samples| samples as f64 * interval).collect::<Vec<f64>>()
        };
        let trajectories: Vec<Vec<f64>> =
            velocity.trajectories.iter().zip(intervals).map(rest_times).collect();
        let has_rest = trajectories.iter().flatten().any(|time| *time > 0.0);
        let (name, unit) = ("time at rest".to_owned(), "s".to_owned());
        has_rest.then_some(Regressor { name, unit, signal: None, trajectories, may_jump: false })
    }

    /// `count` evenly spaced knots over the regressor's range. If a curve may jump, two knots close to zero replace
    /// those next to zero. `None` if the regressor is constant.
    pub(crate) fn knots(&self, count: usize) -> Option<Vec<f64>> {
        let [low, high] = extremes(self.trajectories.iter().flatten().copied());
        let range = high - low;
        if range.is_nan() || range <= MIN_RELATIVE_RANGE * low.abs().max(high.abs()) {
            return None;
        }
        let mut knots: Vec<f64> =
            (0..count).map(|index| low + range * index as f64 / (count - 1) as f64).collect();
        let jump = JUMP_HALF_WIDTH * range;
        if self.may_jump && low < -jump && high > jump {
            knots.retain(|knot| knot.abs() > 2.0 * jump);
            let zero = knots.partition_point(|knot| *knot < 0.0);
            knots.splice(zero..zero, [-jump, jump]);
        }
        Some(knots)
    }

    /// The matrix that maps the values of a curve at its knots to the coefficients of an input over time. Each row is
    /// the weighted mean over the samples near the coefficient's time. If `by_direction`, there are two curves, first
    /// for rising and then for falling values of the regressor, with a column per knot of each.
    pub(crate) fn curve_weights(
        &self,
        basis: &InputBasis,
        knots: &[f64],
        by_direction: bool,
        intervals: &[f64],
    ) -> DMatrix<f64> {
        let branches = 1 + usize::from(by_direction);
        let mut weights = DMatrix::zeros(basis.coefficient_count(), branches * knots.len());
        for ((trajectory, interval), points) in self.trajectories.iter().zip(intervals).zip(&basis.records) {
            let times: Vec<f64> = points.iter().map(|point| point.0).collect();
            let samples = trajectory.iter().enumerate().zip(falling_samples(trajectory));
            for ((sample, value), is_falling) in samples {
                let first = if by_direction && is_falling { knots.len() } else { 0 };
                for (row, share) in coefficient_shares(points, &times, sample as f64 * interval) {
                    for (knot, weight) in interpolation_shares(knots, *value) {
                        weights[(row, first + knot)] += share * weight;
                    }
                }
            }
        }
        for mut row in weights.row_iter_mut() {
            let sum = row.sum();
            row /= if sum > 0.0 { sum } else { 1.0 };
        }
        weights
    }

    /// The value at a time of a record, in seconds from its start: that of the nearest sample.
    pub(crate) fn value_at(&self, record: usize, time: f64, interval: f64) -> f64 {
        let trajectory = &self.trajectories[record];
        trajectory[((time / interval).round() as usize).min(trajectory.len() - 1)]
    }
}

/// The weights of linear interpolation: the indices of the two neighbouring knots, and the share of each. Values
/// outside the knots get the nearest end.
fn interpolation_shares(knots: &[f64], value: f64) -> [(usize, f64); 2] {
    let next = knots.partition_point(|knot| *knot < value).clamp(1, knots.len() - 1);
    let share = ((value - knots[next - 1]) / (knots[next] - knots[next - 1])).clamp(0.0, 1.0);
    [(next - 1, 1.0 - share), (next, share)]
}

/// The coefficients on which the input at a time depends, and the share of each. `times` are those of `points`.
fn coefficient_shares(points: &[BasisPoint], times: &[f64], time: f64) -> Vec<(usize, f64)> {
    let neighbours = interpolation_shares(times, time).into_iter();
    neighbours
        .flat_map(|(point, share)| {
            points[point].1.iter().map(move |(coefficient, weight)| (*coefficient, share * weight))
        })
        .collect()
}

/// Whether a trajectory falls, for every sample. At a sample equal to the one before, the last direction continues.
fn falling_samples(trajectory: &[f64]) -> Vec<bool> {
    let mut is_falling = false;
    let mut previous = trajectory.first().copied().unwrap_or_default();
    let samples = trajectory.iter().map(|value| {
        if *value != previous {
            is_falling = *value < previous;
        }
        previous = *value;
        is_falling
    });
    samples.collect()
}
