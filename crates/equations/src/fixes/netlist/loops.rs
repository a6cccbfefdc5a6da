//! Solves loops without an integrator by Newton's method.

use super::Order;
use super::evaluation::Evaluation;
use crate::symbolic::linear_solution;

/// Loops with more unknown voltages are not solved.
const MAX_TEARS: usize = 6;
/// Voltages of all tears with which the method starts.
const STARTS: [f64; 2] = [50.0, -50.0];
/// Maximum number of steps from one start.
const MAX_STEPS: usize = 30;
/// A step below this share of the voltages ends the method.
const TOLERANCE: f64 = 1e-9;
/// Difference of a voltage for the slopes, as a share of it.
const DIFFERENCE: f64 = 1e-3;

/// Voltages at which all tears equal their recomputed values.
struct Solution {
    tears: Vec<f64>,
    /// Whether each recomputed value falls relative to its tear, as in a circuit that settles there.
    is_stable: bool,
}

impl Evaluation<'_> {
    /// Evaluates all outputs. `None` if a loop has too many unknown voltages, or no solution is found.
    pub(super) fn close_loops(&mut self, order: &Order) -> Option<()> {
        let tears = match order.tears.len() {
            0 => Vec::new(),
            count if count > MAX_TEARS => return None,
            _ => self.solution(order)?,
        };
        self.sweep(order, &tears);
        Some(())
    }

    /// The voltages of the tears: a stable solution if one is found.
    fn solution(&mut self, order: &Order) -> Option<Vec<f64>> {
        let mut unstable = None;
        for start in STARTS {
            match self.solution_from(order, start) {
                Some(Solution { tears, is_stable: true }) => return Some(tears),
                Some(Solution { tears, .. }) => unstable = unstable.or(Some(tears)),
                None => {}
            }
        }
        unstable
    }

    /// The solution to which the method leads from a start.
    fn solution_from(&mut self, order: &Order, start: f64) -> Option<Solution> {
        let mut tears = vec![start; order.tears.len()];
        for _ in 0..MAX_STEPS {
            let (residuals, slopes) = self.linearised(order, &tears);
            let is_stable = slopes.iter().enumerate().all(|(index, row)| row[index] < 0.0);
            let step = linear_solution(&slopes, residuals)?;
            tears.iter_mut().zip(&step).for_each(|(tear, step)| *tear -= step);
            let is_small = |(tear, step): (&f64, &f64)| step.abs() <= TOLERANCE * (1.0 + tear.abs());
            if tears.iter().zip(&step).all(is_small) {
                return Some(Solution { tears, is_stable });
            }
        }
        None
    }

    /// For each tear, its recomputed value minus its value, and the slopes of this difference by each tear.
    fn linearised(&mut self, order: &Order, tears: &[f64]) -> (Vec<f64>, Vec<Vec<f64>>) {
        let recomputed = self.sweep(order, tears);
        let residuals = recomputed.iter().zip(tears).map(|(new, old)| new - old).collect();
        let mut slopes = vec![vec![0.0; tears.len()]; tears.len()];
        for column in 0..tears.len() {
            let mut moved = tears.to_vec();
            moved[column] += DIFFERENCE * (1.0 + tears[column].abs());
            let length = moved[column] - tears[column];
            let changed = self.sweep(order, &moved);
            for (row, slopes) in slopes.iter_mut().enumerate() {
                slopes[column] = (changed[row] - recomputed[row]) / length;
            }
            slopes[column][column] -= 1.0;
        }
        (residuals, slopes)
    }
}
