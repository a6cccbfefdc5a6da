//! Tests whether a matrix has positive principal minors only (a "P-matrix").
//!
//! If all matrices between the bounds of the slopes of y - F(y) have this property, then y = F(y) has at most one
//! solution, with or without limits on the unknowns (D. Gale, H. Nikaido, Math. Annalen 159, 1965; for limits: R. W.
//! Cottle, J.-S. Pang, R. E. Stone, The Linear Complementarity Problem, 1992, section 3.3). Unknowns that have no
//! limit, or never reach it, can be eliminated before the test. Each test here is sufficient.

use nalgebra::{DMatrix, DVector};

use super::definite::{find_definite_scaling, has_definite_scaling};
use super::interval::Interval;
use crate::ir::number::Number as _;

/// Largest order for which principal minors are computed one by one. Their number doubles with the order.
const MAX_ORDER_OF_MINORS: usize = 8;
/// A quantity must exceed this share of the quantities that it is a difference of to count as positive.
const MARGIN: f64 = 1e-12;

/// How long a test may take.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Effort {
    /// The test is repeated often.
    Quick,
    /// The result is remembered, so the test may search.
    Thorough,
}

/// Whether all matrices between the bounds are P-matrices. `entries` has the bounds by rows. `false` if it is not
/// known.
pub(super) fn is_p_matrix(entries: &[Interval], order: usize, effort: Effort) -> bool {
    let is_bounded = entries.iter().all(|entry| entry.low.is_finite() && entry.high.is_finite());
    if !is_bounded || (0..order).any(|row| entries[row * order + row].low <= 0.0) {
        return false;
    }
    order <= 1
        || has_dominant_diagonal(entries, order)
        || has_definite_scaling(entries, order)
        || (order <= MAX_ORDER_OF_MINORS && has_positive_minors(entries, order))
        || (effort == Effort::Thorough && find_definite_scaling(entries, order))
}

/// Eliminates the unknowns that are not limited, if the bounds of their diagonal are positive. Returns the bounds of
/// the other rows and columns, and their number.
///
/// A limit multiplies a row of the slopes by some number from 0 to 1. Rows that are never limited are linear equations
/// of the differences between two solutions, so their unknowns can be replaced in the other rows.
pub(super) fn without_unlimited(entries: &[Interval], is_limited: &[bool]) -> (Vec<Interval>, usize) {
    let (mut entries, mut order) = (entries.to_vec(), is_limited.len());
    // From the last to the first, so that the indices of those still to be examined stay valid.
    for unknown in (0..is_limited.len()).rev().filter(|unknown| !is_limited[*unknown]) {
        if entries[unknown * order + unknown].low > 0.0 {
            entries = schur_complement(&entries, order, unknown);
            order -= 1;
        }
    }
    (entries, order)
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

/// Whether all principal minors are positive. They are those without the first row and column, and the first entry
/// times those of its Schur complement.
pub(super) fn has_positive_minors(entries: &[Interval], order: usize) -> bool {
    if entries[0].low <= 0.0 {
        return false;
    }
    if order == 1 {
        return true;
    }
    let complement = schur_complement(entries, order, 0);
    let indices = (1..order).flat_map(|row| (1..order).map(move |column| row * order + column));
    let without: Vec<Interval> = indices.map(|at| entries[at]).collect();
    has_positive_minors(&without, order - 1) && has_positive_minors(&complement, order - 1)
}

/// The Schur complement of an entry of the diagonal: the coefficients of the other unknowns in the other rows after
/// elimination of its unknown.
fn schur_complement(entries: &[Interval], order: usize, removed: usize) -> Vec<Interval> {
    let at = |row: usize, column: usize| entries[row * order + column];
    let (pivot, zero) = (at(removed, removed), Interval::constant(0.0));
    let others = || (0..order).filter(|index| *index != removed);
    let mut left = Vec::with_capacity((order - 1) * (order - 1));
    for row in others() {
        for column in others() {
            let (entry, factors) = (at(row, column), [at(row, removed), at(removed, column)]);
            if factors.contains(&zero) {
                left.push(entry);
                continue;
            }
            let product = factors[0].multiply(factors[1]).divide(pivot);
            let difference = entry.subtract(product);
            let bounds = [entry.low, entry.high, product.low, product.high];
            let margin = MARGIN * bounds.iter().map(|bound| bound.abs()).sum::<f64>();
            left.push(Interval::new(difference.low - margin, difference.high + margin));
        }
    }
    left
}

#[cfg(test)]
mod tests {
    use super::*;

    fn is_p(entries: &[f64]) -> bool {
        let order = entries.len().isqrt();
        let entries: Vec<Interval> = entries.iter().map(|entry| Interval::constant(*entry)).collect();
        is_p_matrix(&entries, order, Effort::Quick)
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
        assert!(!is_p_matrix(&[one, off, off, one], 2, Effort::Thorough));
        let off = Interval::new(-0.9, 0.0);
        assert!(is_p_matrix(&[one, off, off, one], 2, Effort::Quick));
    }

    #[test]
    fn the_limit_of_an_inverter_that_is_never_reached_does_not_matter() {
        // The rows are 2 x - y - n, -3 x + y - 3 n and x + n, where n is the output of an inverter of x. The minor of x
        // and y is 2 - 3. After elimination of n the rows are 3 x - y and y.
        let rows = [2.0, -1.0, -1.0, -3.0, 1.0, -3.0, 1.0, 0.0, 1.0].map(Interval::constant);
        assert!(!is_p_matrix(&rows, 3, Effort::Thorough));
        let (reduced, order) = without_unlimited(&rows, &[true, true, false]);
        assert_eq!((reduced.len(), order), (4, 2));
        assert!(is_p_matrix(&reduced, order, Effort::Quick));
        let expected = [3.0, -1.0, 0.0, 1.0];
        let is_near = |(entry, expected): (&Interval, f64)| {
            entry.low <= expected && expected <= entry.high && entry.width() < 1e-10
        };
        assert!(reduced.iter().zip(expected).all(is_near), "{reduced:?}");
    }

    #[test]
    fn an_unknown_whose_pivot_may_be_zero_is_not_eliminated() {
        let [one, half] = [1.0, 0.5].map(Interval::constant);
        let rows = [one, half, half, Interval::new(-0.1, 1.0)];
        assert_eq!(without_unlimited(&rows, &[true, false]), (rows.to_vec(), 2));
    }
}
