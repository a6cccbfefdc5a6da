//! Solves the loops of nodes at the start by Newton's method, for one assumed value in each loop.

use std::collections::BTreeMap;

use super::NodeId;
use super::start::{Order, Start, StartValues};

/// Steps at most.
const MOST_STEPS: usize = 100;
/// Halvings of a step at most.
const MOST_HALVINGS: usize = 30;
/// The solution is found if no value changes by more than this share of its size.
const TOLERANCE: f64 = 1e-12;
/// The difference of two values for a numerical derivative, as a share of their size.
const DIFFERENCE: f64 = 1e-6;

/// The loops of a plan at the start.
pub(super) struct Loops<'s, 'a> {
    /// The nodes and what determines them.
    start: &'s Start<'a>,
    /// The order of evaluation.
    order: Order,
    /// The nodes whose values are assumed.
    assumed: Vec<NodeId>,
}

impl<'s, 'a> Loops<'s, 'a> {
    /// The loops of nodes that are evaluated in this order.
    pub(super) fn new(start: &'s Start<'a>, order: Order) -> Self {
        let assumed = order.assumed.iter().copied().collect();
        Loops { start, order, assumed }
    }

    /// The values of all nodes.
    ///
    /// # Errors
    /// If no solution is found: the first implicit node, or the first assumed one.
    pub(super) fn solution(&self) -> Result<StartValues, NodeId> {
        let implicit = self.assumed.iter().find(|node| self.start.is_implicit(**node));
        let Some(first) = implicit.or(self.assumed.first()) else { return Ok(self.values_at(&[])) };
        let mut point: Vec<f64> = self.assumed.iter().map(|node| self.start.guess(*node)[0]).collect();
        for _ in 0..MOST_STEPS {
            let slopes = self.slopes(&point);
            let step = solved(slopes.clone(), self.residuals(&point)).ok_or(*first)?;
            let size = self.size(&point, &step);
            point = self.next(&point, &step, &slopes);
            if size <= TOLERANCE {
                return Ok(self.values_at(&point));
            }
        }
        Err(*first)
    }

    /// The values of all nodes at a solution, with the slopes of the implicit ones.
    fn values_at(&self, point: &[f64]) -> StartValues {
        let slopes = self.slopes(point);
        let own = self.assumed.iter().enumerate().map(|(index, node)| (*node, slopes[index][index]));
        let own = own.filter(|(node, _)| self.start.is_implicit(*node)).collect();
        StartValues { values: self.evaluated(point), slopes: own }
    }

    /// The point after a step. The step is halved until the next step, with the same slopes, is not longer.
    fn next(&self, point: &[f64], step: &[f64], slopes: &[Vec<f64>]) -> Vec<f64> {
        let size = self.size(point, step);
        let after = |share: f64| -> Vec<f64> {
            point.iter().zip(step).map(|(value, change)| value - share * change).collect()
        };
        let is_nearer = |next: &Vec<f64>| {
            let further = solved(slopes.to_vec(), self.residuals(next));
            further.is_some_and(|further| self.size(point, &further) <= size)
        };
        let shares = (0..MOST_HALVINGS as i32).map(|halvings| 0.5_f64.powi(halvings));
        shares.map(after).find(is_nearer).unwrap_or_else(|| after(1.0))
    }

    /// The largest change of a step, as a share of the sizes of the values.
    fn size(&self, point: &[f64], step: &[f64]) -> f64 {
        let changes = step.iter().enumerate().map(|(index, change)| change.abs() / self.scale(point, index));
        let larger = |largest: f64, change: f64| {
            if change > largest || change.is_nan() { change } else { largest }
        };
        changes.fold(0.0, larger)
    }

    /// The size of an assumed value.
    fn scale(&self, point: &[f64], index: usize) -> f64 {
        point[index].abs().max(self.start.guess(self.assumed[index])[1])
    }

    /// By how much each assumed value is wrong.
    fn residuals(&self, point: &[f64]) -> Vec<f64> {
        let values = self.evaluated(point);
        self.assumed.iter().map(|node| self.start.residual(*node, &values)).collect()
    }

    /// The derivative of each residual, as a row, with respect to each assumed value.
    fn slopes(&self, point: &[f64]) -> Vec<Vec<f64>> {
        let mut slopes = vec![vec![0.0; point.len()]; point.len()];
        for column in 0..point.len() {
            let difference = DIFFERENCE * self.scale(point, column);
            let [below, above] = [-difference, difference].map(|difference| {
                let mut point = point.to_vec();
                point[column] += difference;
                self.residuals(&point)
            });
            for (row, slopes) in slopes.iter_mut().enumerate() {
                slopes[column] = (above[row] - below[row]) / (2.0 * difference);
            }
        }
        slopes
    }

    /// The values of all nodes for these values of the assumed ones.
    fn evaluated(&self, point: &[f64]) -> Vec<f64> {
        let assumed: BTreeMap<NodeId, f64> =
            self.assumed.iter().copied().zip(point.iter().copied()).collect();
        self.start.evaluated(&self.order, &assumed)
    }
}

/// The solution of linear equations by elimination with pivots. `None` if the matrix is singular.
fn solved(mut matrix: Vec<Vec<f64>>, mut right: Vec<f64>) -> Option<Vec<f64>> {
    let count = right.len();
    for column in 0..count {
        let largest = |a: &usize, b: &usize| matrix[*a][column].abs().total_cmp(&matrix[*b][column].abs());
        let pivot = (column..count).max_by(largest)?;
        matrix.swap(column, pivot);
        right.swap(column, pivot);
        let divisor = matrix[column][column];
        if !(divisor != 0.0 && divisor.is_finite()) {
            return None;
        }
        let own = matrix[column].clone();
        for row in (0..count).filter(|row| *row != column) {
            let factor = matrix[row][column] / divisor;
            let entries = matrix[row].iter_mut().zip(&own);
            entries.for_each(|(entry, own)| *entry -= factor * own);
            right[row] -= factor * right[column];
        }
    }
    Some(right.iter().enumerate().map(|(index, value)| value / matrix[index][index]).collect())
}
