//! Tests whether a matrix has positive principal minors only (a "P-matrix").
//!
//! If all matrices between the bounds of the slopes of y - F(y) have this property, then y = F(y) has at most one
//! solution, with or without limits on the unknowns (D. Gale, H. Nikaido, Math. Annalen 159, 1965; for limits: R. W.
//! Cottle, J.-S. Pang, R. E. Stone, The Linear Complementarity Problem, 1992, section 3.3). Each test here is
//! sufficient.

use nalgebra::{DMatrix, DVector};

use super::interval::Interval;
use crate::ir::number::Number as _;

/// Largest order for which principal minors are computed one by one. Their number doubles with the order.
const MAX_ORDER_OF_MINORS: usize = 8;
/// A quantity must exceed this share of the quantities that it is a difference of to count as positive.
const MARGIN: f64 = 1e-12;

/// Whether all matrices between the bounds are P-matrices. `entries` has the bounds by rows. `false` if it is not
/// known.
pub(super) fn is_p_matrix(entries: &[Interval], order: usize) -> bool {
    let is_bounded = entries.iter().all(|entry| entry.low.is_finite() && entry.high.is_finite());
    if !is_bounded || (0..order).any(|row| entries[row * order + row].low <= 0.0) {
        return false;
    }
    order == 1
        || has_dominant_diagonal(entries, order)
        || is_positive_definite(entries, order)
        || (order <= MAX_ORDER_OF_MINORS && has_positive_minors(entries.to_vec(), order))
}

/// Whether the columns can be scaled so that the diagonal dominates in every row (an "H-matrix"). The scales solve the
/// system with the least diagonal, and with the largest other entries taken negative.
fn has_dominant_diagonal(entries: &[Interval], order: usize) -> bool {
    let comparison = DMatrix::from_fn(order, order, |row, column| {
        let own = entries[row * order + row].low;
        let entry = entries[row * order + column];
        if row == column { 1.0 } else { -entry.low.abs().max(entry.high.abs()) / own }
    });
    let Some(scales) = comparison.clone().lu().solve(&DVector::from_element(order, 1.0)) else {
        return false;
    };
    let dominance = comparison * &scales;
    scales.iter().all(|scale| *scale > 0.0) && dominance.iter().all(|excess| *excess > 0.5)
}

/// Whether the symmetric part is positive definite. Scales of the rows that make the matrix symmetric are tried too,
/// because they keep the signs of minors.
fn is_positive_definite(entries: &[Interval], order: usize) -> bool {
    let middle = DMatrix::from_fn(order, order, |row, column| entries[row * order + column].middle());
    let radius = DMatrix::from_fn(order, order, |row, column| 0.5 * entries[row * order + column].width());
    let plain = vec![1.0; order];
    let own = (0..order).map(|row| 1.0 / middle[(row, row)]).collect();
    [plain, own, symmetric_scales(&middle)].into_iter().any(|scales: Vec<f64>| {
        let scaled = |matrix: &DMatrix<f64>| {
            DMatrix::from_fn(order, order, |row, column| scales[row] * matrix[(row, column)])
        };
        let (middle, radius) = (scaled(&middle), scaled(&radius));
        let symmetric = 0.5 * (&middle + middle.transpose());
        let spread = 0.5 * (&radius + radius.transpose());
        let largest = symmetric.amax() * order as f64;
        let widest = spread.row_iter().map(|row| row.sum()).fold(0.0, f64::max);
        symmetric.symmetric_eigenvalues().min() > widest + MARGIN * largest
    })
}

/// Positive scales of the rows that make a matrix symmetric, if there are any. They follow from pairs of entries along
/// a tree of the entries that are not 0.
fn symmetric_scales(matrix: &DMatrix<f64>) -> Vec<f64> {
    let order = matrix.nrows();
    let mut scales = vec![0.0; order];
    for root in 0..order {
        if scales[root] != 0.0 {
            continue;
        }
        scales[root] = 1.0;
        let mut open = vec![root];
        while let Some(row) = open.pop() {
            for other in 0..order {
                let ratio = matrix[(row, other)] / matrix[(other, row)];
                if scales[other] == 0.0 && ratio > 0.0 && ratio.is_finite() {
                    scales[other] = scales[row] * ratio;
                    open.push(other);
                }
            }
        }
    }
    scales
}

/// Whether all principal minors are positive. They are those without the first row and column, and the first entry
/// times those of its Schur complement.
fn has_positive_minors(entries: Vec<Interval>, order: usize) -> bool {
    let pivot = entries[0];
    if pivot.low <= 0.0 {
        return false;
    }
    if order == 1 {
        return true;
    }
    let rest = order - 1;
    let at = |row: usize, column: usize| entries[row * order + column];
    let indices = || (1..order).flat_map(|row| (1..order).map(move |column| (row, column)));
    let without: Vec<Interval> = indices().map(|(row, column)| at(row, column)).collect();
    let complement = indices().map(|(row, column)| {
        let removed = at(row, 0).multiply(at(0, column)).divide(pivot);
        let left = at(row, column).subtract(removed);
        let margin = MARGIN * (at(row, column).high.abs() + removed.high.abs() + removed.low.abs());
        Interval::new(left.low - margin, left.high + margin)
    });
    let complement: Vec<Interval> = complement.collect();
    has_positive_minors(without, rest) && has_positive_minors(complement, rest)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn is_p(entries: &[f64]) -> bool {
        let order = entries.len().isqrt();
        let entries: Vec<Interval> = entries.iter().map(|entry| Interval::constant(*entry)).collect();
        is_p_matrix(&entries, order)
    }

    #[test]
    fn known_matrices_are_classified() {
        assert!(is_p(&[2.0, 1.0, 1.0, 1.0, 2.0, 1.0, 1.0, 1.0, 2.0]));
        // Neither dominant nor definite, but its minors are 1, 1 and 1 + 30.
        assert!(is_p(&[1.0, -10.0, 3.0, 1.0]));
        assert!(!is_p(&[1.0, 2.0, 1.0, 1.0]));
        assert!(!is_p(&[-1.0]));
        assert!(!is_p(&[1.0, 1.0, 1.0, 1.0]));
    }

    #[test]
    fn a_large_ladder_has_a_dominant_diagonal() {
        let order = 200;
        let ladder = |row: usize, column: usize| match row.abs_diff(column) {
            0 => 1.0,
            1 => -0.5,
            _ => 0.0,
        };
        let entries: Vec<f64> = (0..order * order).map(|at| ladder(at / order, at % order)).collect();
        assert!(is_p(&entries));
    }

    #[test]
    fn bounds_that_contain_a_singular_matrix_are_rejected() {
        let off = Interval::new(-1.1, 0.0);
        let one = Interval::constant(1.0);
        assert!(!is_p_matrix(&[one, off, off, one], 2));
        let off = Interval::new(-0.9, 0.0);
        assert!(is_p_matrix(&[one, off, off, one], 2));
    }
}
