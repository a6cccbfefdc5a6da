//! Systems of linear equations for the tears of a loop.

use nalgebra::{DMatrix, DVectorViewMut, Dyn, LU};

/// A system is singular if a pivot is smaller than this share of the largest entry of its row.
const SINGULAR: f64 = 1e-12;

/// A factorised matrix. One equation needs no memory on the heap.
#[derive(Debug, Clone)]
pub(super) enum Factors {
    /// The only entry.
    One(f64),
    /// The factors of the matrix with rows divided by their scales, and these scales.
    Many { factors: Box<LU<f64, Dyn, Dyn>>, scales: Vec<f64> },
}

impl Factors {
    /// Factorises a matrix that is given by rows. `None` if it is singular or has entries that are not finite.
    pub(super) fn new(rows: &[f64], order: usize) -> Option<Self> {
        if rows.iter().any(|entry| !entry.is_finite()) {
            return None;
        }
        if let [entry] = rows {
            return (entry.abs() > SINGULAR).then_some(Factors::One(*entry));
        }
        let scales: Vec<f64> = rows
            .chunks(order)
            .map(|row| row.iter().fold(0.0f64, |largest, entry| largest.max(entry.abs())))
            .collect();
        if scales.contains(&0.0) {
            return None;
        }
        let scaled = DMatrix::from_fn(order, order, |row, column| rows[row * order + column] / scales[row]);
        let factors = LU::new(scaled);
        let diagonal = factors.u().diagonal();
        let is_regular = diagonal.iter().all(|pivot| pivot.abs() > SINGULAR);
        is_regular.then(|| Factors::Many { factors: Box::new(factors), scales })
    }

    /// Replaces the right-hand side of a system by its solution.
    pub(super) fn solve(&self, sides: &mut [f64]) {
        match self {
            Factors::One(entry) => sides[0] /= entry,
            Factors::Many { factors, scales } => {
                sides.iter_mut().zip(scales).for_each(|(side, scale)| *side /= scale);
                let length = sides.len();
                let mut view = DVectorViewMut::from_slice(sides, length);
                factors.solve_mut(&mut view);
            }
        }
    }
}

/// The slopes of tears that equal their recomputed outputs: y = F(y, x) gives (1 - dF/dy) dy = dF at constant y.
///
/// `close` gets slopes of the tears, and writes the slopes of F in their place. It is linear in them. After the last
/// call the slopes are those of the solution; they are NaN if the system is singular.
pub(crate) fn close_slopes(order: usize, mut close: impl FnMut(&mut [f64])) {
    if order == 1 {
        let (mut by_the_rest, mut by_both) = ([0.0], [1.0]);
        close(&mut by_the_rest);
        close(&mut by_both);
        let steepness = 1.0 - (by_both[0] - by_the_rest[0]);
        close(&mut [by_the_rest[0] / steepness]);
        return;
    }
    let mut by_the_rest = vec![0.0; order];
    close(&mut by_the_rest);
    let mut rows = vec![0.0; order * order];
    for column in 0..order {
        let mut by_both = vec![0.0; order];
        by_both[column] = 1.0;
        close(&mut by_both);
        for row in 0..order {
            let own = if row == column { 1.0 } else { 0.0 };
            rows[row * order + column] = own - (by_both[row] - by_the_rest[row]);
        }
    }
    match Factors::new(&rows, order) {
        Some(factors) => factors.solve(&mut by_the_rest),
        None => by_the_rest.fill(f64::NAN),
    }
    close(&mut by_the_rest);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_of_different_size_are_solved() {
        // 1e9 x + 2e9 y = 5e9 and 3 x - y = 1, so x = 1 and y = 2.
        let factors = Factors::new(&[1e9, 2e9, 3.0, -1.0], 2).unwrap();
        let mut sides = [5e9, 1.0];
        factors.solve(&mut sides);
        assert!((sides[0] - 1.0).abs() < 1e-15 && (sides[1] - 2.0).abs() < 1e-15, "{sides:?}");
    }

    #[test]
    fn a_singular_matrix_has_no_factors() {
        assert!(Factors::new(&[1.0, 2.0, 2.0, 4.0], 2).is_none());
        assert!(Factors::new(&[0.0], 1).is_none());
        assert!(Factors::new(&[f64::NAN], 1).is_none());
    }

    #[test]
    fn slopes_close_over_two_tears() {
        // y = 0.5 z + x and z = -y + 2 x with dx = 1: dy = 4/3 and dz = 2/3.
        let mut last = Vec::new();
        close_slopes(2, |tears| {
            last = tears.to_vec();
            tears.copy_from_slice(&[0.5 * last[1] + 1.0, -last[0] + 2.0]);
        });
        assert!((last[0] - 4.0 / 3.0).abs() < 1e-15 && (last[1] - 2.0 / 3.0).abs() < 1e-15, "{last:?}");
    }
}
