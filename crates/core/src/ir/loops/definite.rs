//! Tests whether positive factors of its rows give a matrix a positive definite symmetric part.
//!
//! Then all principal minors of the matrix are positive. Such factors are called a diagonal solution of Lyapunov's
//! inequality. Factors of the columns need no search of their own: D M C has a positive definite symmetric part if and
//! only if C^-1 D M has.
//!
//! Several factors are tried. Those of a mass matrix with scaled rows make it symmetric. They also make an
//! antisymmetric matrix plus a diagonal antisymmetric again. For other matrices, factors that balance rows and columns
//! are improved by steepest ascent.

use nalgebra::DMatrix;

use super::interval::Interval;

/// A quantity must exceed this share of the quantities that it is a difference of to count as positive.
const MARGIN: f64 = 1e-12;
/// Number of times that every row is balanced with its column.
const BALANCING_SWEEPS: usize = 10;
/// Maximum number of steps of the ascent.
const MAX_STEPS: usize = 60;
/// Maximum number of steps of the ascent times the third power of the order, which the time is proportional to.
const MAX_WORK: usize = 4_000_000;
/// Largest change of the logarithm of a factor's root in the first step of the ascent.
const FIRST_STEP: f64 = 0.25;
/// Length of a step of the ascent as a share of the one before.
const STEP_RATIO: f64 = 0.9;
/// Multiples of the unit matrix that make a matrix definite during the ascent: this much more than necessary, as a
/// share and at least.
const SHIFT: (f64, f64) = (0.2, 1e-3);

/// Whether simple factors make the symmetric part of all matrices between the bounds positive definite. The diagonal
/// must be positive.
pub(super) fn has_definite_scaling(entries: &[Interval], order: usize) -> bool {
    let matrix = BoundedMatrix::new(entries, order);
    let own = (0..order).map(|row| 1.0 / matrix.middle[(row, row)]).collect();
    let plain = vec![1.0; order];
    [plain, own].iter().any(|factors: &Vec<f64>| matrix.is_definite(factors)) || {
        let symmetric = symmetric_factors(&matrix.middle);
        matrix.is_definite(&symmetric) || matrix.is_definite(&balanced_factors(&matrix.middle, symmetric))
    }
}

/// Whether a search finds factors that make the symmetric part of all matrices between the bounds positive definite.
/// The diagonal must be positive.
pub(super) fn find_definite_scaling(entries: &[Interval], order: usize) -> bool {
    let matrix = BoundedMatrix::new(entries, order);
    let at = |row: usize, column: usize| matrix.middle[(row, column)];
    let is_positive =
        |row: usize, column: usize| at(row, row) * at(column, column) > at(row, column) * at(column, row);
    // No factors exist if a principal minor of order 2 is not positive.
    let may_succeed = (0..order).all(|row| (0..row).all(|column| is_positive(row, column)));
    may_succeed && {
        let start = balanced_factors(&matrix.middle, symmetric_factors(&matrix.middle));
        matrix.is_definite_after_ascent(&start)
    }
}

/// All matrices between bounds.
struct BoundedMatrix {
    /// The middle of the bounds.
    middle: DMatrix<f64>,
    /// Largest distance from the middle, with a margin for rounding.
    radius: DMatrix<f64>,
}

impl BoundedMatrix {
    /// The matrices between bounds that are given by rows.
    fn new(entries: &[Interval], order: usize) -> Self {
        let at = |row: usize, column: usize| entries[row * order + column];
        let radius = |row: usize, column: usize| {
            let entry = at(row, column);
            0.5 * entry.width() + MARGIN * entry.low.abs().max(entry.high.abs())
        };
        BoundedMatrix {
            middle: DMatrix::from_fn(order, order, |row, column| at(row, column).middle()),
            radius: DMatrix::from_fn(order, order, radius),
        }
    }

    /// Whether the symmetric part is positive definite if rows are multiplied by these factors.
    ///
    /// Rows and columns are scaled so that the middle has a diagonal of 1, which keeps the property. The radius changes
    /// eigenvalues by at most the largest sum of one of its rows. A margin covers the rounding of the factorisation.
    fn is_definite(&self, factors: &[f64]) -> bool {
        if factors.iter().any(|factor| !factor.is_finite() || *factor <= 0.0) {
            return false;
        }
        let order = factors.len();
        let scales: Vec<f64> =
            (0..order).map(|row| (factors[row] * self.middle[(row, row)]).sqrt().recip()).collect();
        let symmetric = |matrix: &DMatrix<f64>| {
            let scaled = DMatrix::from_fn(order, order, |row, column| {
                scales[row] * factors[row] * matrix[(row, column)] * scales[column]
            });
            0.5 * (&scaled + scaled.transpose())
        };
        let (mut middle, radius) = (symmetric(&self.middle), symmetric(&self.radius));
        let widest = radius.row_iter().map(|row| row.sum()).fold(0.0, f64::max);
        let margin = widest + MARGIN * order as f64;
        (0..order).for_each(|row| middle[(row, row)] -= margin);
        middle.cholesky().is_some()
    }

    /// Whether the symmetric part is positive definite with factors that steepest ascent finds, from these on.
    ///
    /// With the roots r of the factors, r_i m_ij / r_j has the same property as the matrix with scaled rows. The sum S
    /// of its symmetric part and a multiple of the unit matrix is positive definite. The ascent increases the
    /// determinant of S. The slope of its logarithm along the logarithm of r_i is twice entry i of the diagonal of
    /// A S^-1, with the antisymmetric part A. The multiple is nearly as small as the least eigenvalue permits.
    fn is_definite_after_ascent(&self, start: &[f64]) -> bool {
        let order = start.len();
        let mut roots: Vec<f64> = start.iter().map(|factor| factor.sqrt()).collect();
        let mut length = FIRST_STEP;
        for _ in 0..MAX_STEPS.min(MAX_WORK / order.pow(3)) {
            let Some(similar) = self.similar(&roots) else { return false };
            let symmetric = 0.5 * (&similar + similar.transpose());
            let least = symmetric.symmetric_eigenvalues().min();
            let factors: Vec<f64> = roots.iter().map(|root| root * root).collect();
            if least > 0.0 && self.is_definite(&factors) {
                return true;
            }
            let shift = SHIFT.1 + (1.0 + SHIFT.0) * (-least).max(0.0);
            let shifted = &symmetric + shift * DMatrix::<f64>::identity(order, order);
            let Some(inverse) = shifted.cholesky().map(|factors| factors.inverse()) else { return false };
            let products = (&similar - &symmetric).component_mul(&inverse);
            let slopes: Vec<f64> = products.row_iter().map(|row| row.sum()).collect();
            let steepest = slopes.iter().fold(0.0f64, |steepest, slope| steepest.max(slope.abs()));
            if steepest == 0.0 {
                return false;
            }
            let steps = slopes.iter().map(|slope| length * slope / steepest);
            roots.iter_mut().zip(steps).for_each(|(root, step)| *root *= step.exp());
            length *= STEP_RATIO;
        }
        false
    }

    /// The matrix r_i m_ij / r_j of the middle, scaled to a diagonal of 1. `None` if an entry is not finite.
    fn similar(&self, roots: &[f64]) -> Option<DMatrix<f64>> {
        let order = roots.len();
        let scales: Vec<f64> = (0..order).map(|row| self.middle[(row, row)].sqrt().recip()).collect();
        let similar = DMatrix::from_fn(order, order, |row, column| {
            self.middle[(row, column)] * (roots[row] / roots[column]) * scales[row] * scales[column]
        });
        similar.iter().all(|entry| entry.is_finite()).then_some(similar)
    }
}

/// Positive factors of the rows that make a matrix symmetric up to signs, if there are any. They follow from pairs of
/// entries along a tree of the entries that are not 0.
fn symmetric_factors(matrix: &DMatrix<f64>) -> Vec<f64> {
    let order = matrix.nrows();
    let mut factors = vec![0.0; order];
    for root in 0..order {
        if factors[root] != 0.0 {
            continue;
        }
        factors[root] = 1.0;
        let mut open = vec![root];
        while let Some(row) = open.pop() {
            for other in 0..order {
                let ratio = (matrix[(row, other)] / matrix[(other, row)]).abs();
                if factors[other] == 0.0 && ratio > 0.0 && ratio.is_finite() {
                    factors[other] = factors[row] * ratio;
                    open.push(other);
                }
            }
        }
    }
    factors
}

/// Improves factors of rows: with the roots r of the factors, the rows of r_i m_ij / r_j and its columns then have
/// nearly equal sums of squares (E. E. Osborne, Journal of the ACM 7, 1960).
fn balanced_factors(matrix: &DMatrix<f64>, mut factors: Vec<f64>) -> Vec<f64> {
    let order = matrix.nrows();
    for _ in 0..BALANCING_SWEEPS {
        for own in 0..order {
            let (mut row, mut column) = (0.0, 0.0);
            for other in (0..order).filter(|other| *other != own) {
                row += matrix[(own, other)].powi(2) / factors[other];
                column += matrix[(other, own)].powi(2) * factors[other];
            }
            let factor = (column / row).sqrt();
            if factor > 0.0 && factor.is_finite() {
                factors[own] = factor;
            }
        }
    }
    factors
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::super::p_matrix::has_positive_minors;
    use super::*;
    use crate::ir::number::Number;
    use crate::low_discrepancy::golden_place;

    /// Bounds of a matrix whose entry is a function of its row and column.
    fn matrix(order: usize, entry: impl Fn(usize, usize) -> f64) -> Vec<Interval> {
        (0..order * order).map(|at| Interval::constant(entry(at / order, at % order))).collect()
    }

    /// Irregular numbers between -1 and 1.
    fn irregular(index: usize) -> f64 {
        2.0 * golden_place((index * index + index + 1) as u64) - 1.0
    }

    /// Entry of F F^T + `own`, a symmetric positive definite matrix.
    fn mass(order: usize, own: f64, row: usize, column: usize) -> f64 {
        let product = |inner| irregular(row * order + inner) * irregular(column * order + inner);
        (0..order).map(product).sum::<f64>() + if row == column { own } else { 0.0 }
    }

    /// Entry of an antisymmetric matrix.
    fn twist(row: usize, column: usize) -> f64 {
        match row.cmp(&column) {
            std::cmp::Ordering::Less => 10.0 * irregular(100 * row + column),
            std::cmp::Ordering::Equal => 0.0,
            std::cmp::Ordering::Greater => -10.0 * irregular(100 * column + row),
        }
    }

    /// A factor between 1e-2 and 1e2.
    fn factor(index: usize) -> f64 {
        10f64.powf(2.0 * irregular(3 * index + 7))
    }

    #[test]
    fn mass_matrices_with_scaled_rows_and_columns_have_a_definite_scaling() {
        for order in [5, 16, 30] {
            let entry = |row, column| factor(row) * mass(order, 0.1, row, column) * factor(column + 50);
            assert!(has_definite_scaling(&matrix(order, entry), order), "{order}");
        }
    }

    #[test]
    fn antisymmetric_matrices_plus_a_diagonal_have_a_definite_scaling() {
        for order in [5, 16, 30] {
            let plus_one = |row, column| twist(row, column) + if row == column { 1.0 } else { 0.0 };
            let entry = |row, column| factor(row) * plus_one(row, column) * factor(column + 50);
            assert!(has_definite_scaling(&matrix(order, entry), order), "{order}");
        }
    }

    #[test]
    fn the_search_finds_factors_of_a_definite_matrix_with_an_antisymmetric_part() {
        let order = 12;
        let entry = |row, column| {
            factor(row) * (mass(order, 0.05, row, column) + 0.1 * twist(row, column)) * factor(column + 50)
        };
        assert!(find_definite_scaling(&matrix(order, entry), order));
    }

    #[test]
    fn matrices_with_a_negative_eigenvalue_have_no_definite_scaling() {
        for order in [5, 16] {
            // The symmetric matrix 1 - 1.5 u u^T with a unit vector u has an eigenvalue of -0.5.
            let length: f64 = (0..order).map(|index| irregular(index).powi(2)).sum();
            let symmetric = |row: usize, column: usize| {
                let own = if row == column { 1.0 } else { 0.0 };
                own - 1.5 * irregular(row) * irregular(column) / length
            };
            let entry = |row, column| factor(row) * symmetric(row, column) * factor(column + 50);
            let bounds = matrix(order, entry);
            let has_positive_diagonal = (0..order).all(|row| bounds[row * order + row].low > 0.0);
            assert!(has_positive_diagonal && !has_definite_scaling(&bounds, order), "{order}");
            assert!(!find_definite_scaling(&bounds, order), "{order}");
        }
    }

    #[test]
    fn bounds_that_contain_a_singular_matrix_are_not_definite() {
        let [one, off] = [Interval::constant(1.0), Interval::new(-1.0, 1.0)];
        assert!(!has_definite_scaling(&[one, off, off, one], 2));
        assert!(!find_definite_scaling(&[one, off, off, one], 2));
        let off = Interval::new(-0.9, 0.9);
        assert!(has_definite_scaling(&[one, off, off, one], 2));
    }

    proptest! {
        #[test]
        fn a_definite_scaling_implies_positive_minors(
            entries in proptest::collection::vec(-1.0..1.0f64, 25), own in 0.3..2.0f64, width in 0.0..0.1f64,
        ) {
            let order = 5;
            let bounds: Vec<Interval> = entries
                .iter()
                .enumerate()
                .map(|(at, entry)| {
                    let middle = if at % (order + 1) == 0 { own } else { *entry };
                    Interval::new(middle - width, middle + width)
                })
                .collect();
            let is_definite = has_definite_scaling(&bounds, order) || find_definite_scaling(&bounds, order);
            // Each corner of the bounds is a matrix; the minors of some of them are computed.
            let corner = |seed: usize| {
                let pick = |(at, entry): (usize, &Interval)| {
                    Interval::constant(if irregular(25 * seed + at) < 0.0 { entry.low } else { entry.high })
                };
                bounds.iter().enumerate().map(pick).collect::<Vec<_>>()
            };
            prop_assert!(!is_definite || (0..20).all(|seed| has_positive_minors(&corner(seed), order)));
        }
    }
}
