//! Linear equations that do not have exactly one solution, together with bounds.
//!
//! The solutions of such equations are a point plus any combination of some directions. The bounds leave nothing of
//! them, a point or a range.

use nalgebra::{DMatrix, DVector};

use super::SOLUTION_SPACING;
use super::forms::value;
use super::interval::Interval;
use super::pieces::{Bound, slack};

/// Singular values below this share of the largest one count as 0.
const RANK_TOLERANCE: f64 = 1e-12;
/// Maximum number of projections onto bounds if there are several directions.
const MAX_PROJECTIONS: usize = 10_000;

/// What the bounds leave of the solutions of linear equations.
pub(super) enum Feasible {
    /// No solution.
    Nothing,
    /// One solution.
    Point(Vec<f64>),
    /// More than one.
    Range,
}

/// Solves equations, given by rows and right-hand sides, within the intervals of the unknowns and the bounds.
pub(super) fn feasible(rows: &[f64], sides: &[f64], intervals: &[Interval], bounds: &[Bound]) -> Feasible {
    let order = sides.len();
    let scale = |row: usize| {
        let entries = &rows[row * order..(row + 1) * order];
        entries.iter().fold(0.0f64, |scale, entry| scale.max(entry.abs())).max(f64::MIN_POSITIVE)
    };
    let matrix = DMatrix::from_fn(order, order, |row, column| rows[row * order + column] / scale(row));
    let scaled = DVector::from_fn(order, |row, _| sides[row] / scale(row));
    let svd = matrix.clone().svd(true, true);
    let threshold = RANK_TOLERANCE * svd.singular_values.max();
    let Ok(point) = svd.solve(&scaled, threshold) else { return Feasible::Nothing };
    let consistent = (0..order).all(|row| {
        let residual = (matrix.row(row) * &point)[0] - scaled[row];
        residual.abs() <= SOLUTION_SPACING * 1e-3
    });
    let (Some(transposed), true) = (svd.v_t.as_ref(), consistent) else { return Feasible::Nothing };
    let is_free = |index: &usize| svd.singular_values[*index] <= threshold;
    let directions: Vec<Vec<f64>> =
        (0..order).filter(is_free).map(|index| transposed.row(index).iter().copied().collect()).collect();
    let limits = limits(intervals, bounds);
    match directions.as_slice() {
        [direction] => along(point.as_slice(), direction, &limits),
        _ => among(point.as_slice(), &directions, &limits),
    }
}

/// The affine forms that must not be negative, with their margins: the ends of the intervals, and the bounds.
fn limits(intervals: &[Interval], bounds: &[Bound]) -> Vec<(Vec<f64>, f64)> {
    let order = intervals.len();
    let end = |position: usize, sign: f64, constant: f64| {
        let mut form = vec![0.0; order + 1];
        (form[position], form[order]) = (sign, constant);
        form
    };
    let ends = intervals.iter().enumerate().flat_map(|(position, interval)| {
        [end(position, 1.0, -interval.low), end(position, -1.0, interval.high)]
    });
    let bounds = bounds.iter().filter(|bound| !bound.is_equation).map(|bound| bound.form.clone());
    ends.chain(bounds).map(|form| (slack(&form), form)).map(|(slack, form)| (form, slack)).collect()
}

/// What limits leave of a line.
fn along(point: &[f64], direction: &[f64], limits: &[(Vec<f64>, f64)]) -> Feasible {
    let (mut low, mut high) = (f64::NEG_INFINITY, f64::INFINITY);
    for (form, slack) in limits {
        let (start, rate) = (value(form, point) + slack, rate(form, direction));
        if rate.abs() <= RANK_TOLERANCE * form.iter().fold(1.0, |largest, term| f64::max(largest, term.abs()))
        {
            if start < 0.0 {
                return Feasible::Nothing;
            }
        } else if rate > 0.0 {
            low = low.max(-start / rate);
        } else {
            high = high.min(-start / rate);
        }
    }
    let steepest = direction.iter().fold(0.0f64, |largest, entry| largest.max(entry.abs()));
    if low > high {
        Feasible::Nothing
    } else if (high - low) * steepest <= SOLUTION_SPACING {
        Feasible::Point(moved(point, direction, 0.5 * (low + high)))
    } else {
        Feasible::Range
    }
}

/// What limits leave of a plane or more: a range if projections onto the violated limits find a point within all.
fn among(point: &[f64], directions: &[Vec<f64>], limits: &[(Vec<f64>, f64)]) -> Feasible {
    let mut present = point.to_vec();
    for _ in 0..MAX_PROJECTIONS {
        let violation = |(form, slack): &(Vec<f64>, f64)| -(value(form, &present) + slack);
        let worst = limits.iter().map(|limit| (limit, violation(limit))).max_by(|a, b| a.1.total_cmp(&b.1));
        let Some(((form, _), excess)) = worst.filter(|(_, excess)| *excess > 0.0) else {
            return Feasible::Range;
        };
        let rates: Vec<f64> = directions.iter().map(|direction| rate(form, direction)).collect();
        let square: f64 = rates.iter().map(|rate| rate * rate).sum();
        if square <= RANK_TOLERANCE {
            return Feasible::Nothing;
        }
        for (rate, direction) in rates.iter().zip(directions) {
            present = moved(&present, direction, excess * rate / square);
        }
    }
    Feasible::Nothing
}

/// The rate of an affine form along a direction.
fn rate(form: &[f64], direction: &[f64]) -> f64 {
    form.iter().zip(direction).map(|(slope, entry)| slope * entry).sum()
}

/// A point moved along a direction.
fn moved(point: &[f64], direction: &[f64], by: f64) -> Vec<f64> {
    point.iter().zip(direction).map(|(entry, along)| entry + by * along).collect()
}
