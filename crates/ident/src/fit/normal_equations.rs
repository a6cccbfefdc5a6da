//! Normal equations of a least-squares fit: damped steps, and the covariance of the fitted coordinates.
//!
//! [`NormalEquations`] collects J'J and J'r from the columns of the Jacobian J and the residuals r, one output at a
//! time. [`Covariance`] is made from them by an eigenvalue decomposition. Directions with a very small eigenvalue are
//! undetermined: the data do not constrain them, and they are excluded from the inverse.

use nalgebra::{DMatrix, DVector};

/// The least damping of the scaled normal matrix, whose diagonal is 1. It keeps the matrix positive definite.
const MIN_DAMPING: f64 = 1e-12;
/// Directions with an eigenvalue below this fraction of the largest are undetermined. Finite differences do not give
/// the derivatives more accurately.
const MIN_EIGENVALUE_RATIO: f64 = 1e-10;
/// A coordinate is undetermined if undetermined directions can change it by more than this fraction of its range.
const UNDETERMINED_FRACTION: f64 = 0.05;

/// A column of the Jacobian: the index of the coordinate, and the derivative of every residual of one output.
pub(crate) type JacobianColumn = (usize, Vec<f64>);

/// The normal matrix and the gradient of a least-squares problem, in coordinates.
pub(crate) struct NormalEquations {
    /// J'J: for every pair of coordinates the sum of the products of their derivatives.
    pub(crate) matrix: DMatrix<f64>,
    /// J'r: for every coordinate the sum of the products of derivative and residual.
    pub(crate) gradient: DVector<f64>,
}

impl NormalEquations {
    /// The equations for `count` coordinates without data.
    pub(crate) fn zeros(count: usize) -> NormalEquations {
        NormalEquations { matrix: DMatrix::zeros(count, count), gradient: DVector::zeros(count) }
    }

    /// Adds the residuals of one output. Coordinates without a column do not affect it.
    pub(crate) fn add(&mut self, columns: &[JacobianColumn], residuals: &[f64]) {
        for (row, (index, column)) in columns.iter().enumerate() {
            self.gradient[*index] += product_of_present(column, residuals, residuals);
            for (other_index, other_column) in &columns[..=row] {
                let sum = product_of_present(column, other_column, residuals);
                self.matrix[(*index, *other_index)] += sum;
                if index != other_index {
                    self.matrix[(*other_index, *index)] += sum;
                }
            }
        }
    }

    /// The normal matrix of some coordinates, scaled so that its diagonal is 1. The first value of the result is the
    /// scale: how much of each coordinate is one unit of the scaled matrix.
    fn scaled(&self, indices: &[usize]) -> (Vec<f64>, DMatrix<f64>) {
        let units: Vec<f64> =
            indices.iter().map(|index| 1.0 / self.matrix[(*index, *index)].sqrt()).collect();
        let matrix = DMatrix::from_fn(indices.len(), indices.len(), |row, column| {
            self.matrix[(indices[row], indices[column])] * units[row] * units[column]
        });
        (units, matrix)
    }

    /// The damped step of the coordinates `free`, in their order. If the matrix is not positive definite, the step is a
    /// damped step along the gradient.
    pub(crate) fn damped_step(&self, free: &[usize], damping: f64) -> DVector<f64> {
        let count = free.len();
        let (units, mut matrix) = self.scaled(free);
        (0..count).for_each(|row| matrix[(row, row)] += damping + MIN_DAMPING);
        let gradient = DVector::from_fn(count, |row, _| -self.gradient[free[row]] * units[row]);
        let step = matrix.cholesky().map(|cholesky| cholesky.solve(&gradient));
        let step = step.unwrap_or_else(|| gradient * (1.0 / (1.0 + damping)));
        DVector::from_fn(count, |row, _| step[row] * units[row])
    }
}

/// The covariance of the fitted coordinates for residuals of variance 1.
pub(crate) struct Covariance {
    /// The number of all coordinates.
    count: usize,
    /// Indices of the fitted coordinates that affect the data.
    sensitive: Vec<usize>,
    /// The scale of each sensitive coordinate: with it, the diagonal of the normal matrix is 1.
    units: Vec<f64>,
    /// A root of the scaled covariance: root * root' is the inverse of the scaled normal matrix.
    root: DMatrix<f64>,
    /// How far undetermined directions can change each sensitive coordinate, in its unit. Each direction is limited by
    /// the first coordinate that passes its whole range.
    undetermined_shift: Vec<f64>,
    /// Whether this shift is so large that the coordinate itself is undetermined.
    is_undetermined: Vec<bool>,
}

impl Covariance {
    /// The covariance of the coordinates `free`, each given as its index and the width of its range.
    pub(crate) fn new(normal: &NormalEquations, free: &[(usize, f64)]) -> Covariance {
        let is_sensitive = |(index, _): &&(usize, f64)| normal.matrix[(*index, *index)] > 0.0;
        let (sensitive, widths): (Vec<usize>, Vec<f64>) = free.iter().filter(is_sensitive).copied().unzip();
        let (units, scaled) = normal.scaled(&sensitive);
        let mut root = DMatrix::zeros(sensitive.len(), sensitive.len());
        let mut undetermined_shift = vec![0.0_f64; sensitive.len()];
        // The decomposition of an empty matrix is not defined.
        if !sensitive.is_empty() {
            let eigen = scaled.symmetric_eigen();
            let min_eigenvalue = MIN_EIGENVALUE_RATIO * eigen.eigenvalues.max();
            let directions = eigen.eigenvectors.column_iter().zip(&eigen.eigenvalues);
            for (column, (vector, value)) in directions.enumerate() {
                if *value > min_eigenvalue {
                    root.set_column(column, &(vector / value.sqrt()));
                } else {
                    let components = vector.iter().zip(&units).zip(&widths);
                    let length =
                        components.map(|((component, unit), width)| width / (component * unit).abs());
                    let length = length.fold(f64::INFINITY, f64::min);
                    undetermined_shift
                        .iter_mut()
                        .zip(&vector)
                        .for_each(|(shift, component)| *shift = shift.hypot(length * component));
                }
            }
        }
        let shifts = undetermined_shift.iter().zip(&units).zip(&widths);
        let is_undetermined =
            shifts.map(|((shift, unit), width)| shift * unit > UNDETERMINED_FRACTION * width).collect();
        Covariance {
            count: normal.gradient.len(),
            sensitive,
            units,
            root,
            undetermined_shift,
            is_undetermined,
        }
    }

    /// Standard errors of all coordinates for white residuals of variance 1. Infinite if undetermined.
    pub(crate) fn standard_errors(&self) -> Vec<f64> {
        self.expand(|row| self.root.row(row).norm())
    }

    /// Standard errors of all coordinates from the gradients of blocks of residuals. They are valid for correlated
    /// residuals, too.
    ///
    /// Each gradient would shift the coordinates by covariance * gradient. The result is the root of the sum of squared
    /// shifts, corrected for the `fitted` coordinates by which a fit reduces these shifts.
    pub(crate) fn block_standard_errors(&self, gradients: &[DVector<f64>], fitted: usize) -> Vec<f64> {
        let shifts: Vec<DVector<f64>> = gradients.iter().map(|gradient| self.shift(gradient)).collect();
        let blocks = gradients.len() as f64;
        let correction = (blocks / (blocks - fitted as f64).max(1.0)).sqrt();
        self.expand(|row| correction * shifts.iter().map(|shift| shift[row] * shift[row]).sum::<f64>().sqrt())
    }

    /// The direction of least increase of the sum of squares in which the coordinate `index` changes by 1. Zero if the
    /// coordinate does not affect the data.
    pub(crate) fn profile_direction(&self, index: usize) -> DVector<f64> {
        let mut direction = DVector::zeros(self.count);
        if let Some(row) = self.sensitive.iter().position(|sensitive| *sensitive == index) {
            let shift = &self.root * self.root.row(row).transpose();
            for (other_row, (sensitive, unit)) in self.sensitive.iter().zip(&self.units).enumerate() {
                direction[*sensitive] = shift[other_row] * unit / (shift[row] * self.units[row]);
            }
        }
        direction
    }

    /// The shift of the sensitive coordinates by a gradient, in their units.
    fn shift(&self, gradient: &DVector<f64>) -> DVector<f64> {
        let scaled = self.sensitive.iter().zip(&self.units).map(|(index, unit)| gradient[*index] * unit);
        let scaled = DVector::from_iterator(self.sensitive.len(), scaled);
        &self.root * (self.root.transpose() * scaled)
    }

    /// A value for every coordinate from a value per sensitive coordinate. The undetermined shift is added in
    /// quadrature. Infinite for undetermined and for insensitive coordinates.
    fn expand(&self, value_of: impl Fn(usize) -> f64) -> Vec<f64> {
        let mut all = vec![f64::INFINITY; self.count];
        for (row, (index, unit)) in self.sensitive.iter().zip(&self.units).enumerate() {
            if !self.is_undetermined[row] {
                all[*index] = value_of(row).hypot(self.undetermined_shift[row]) * unit;
            }
        }
        all
    }
}

/// The sum of the products of two columns over the samples where `data` is not NaN.
pub(crate) fn product_of_present(left: &[f64], right: &[f64], data: &[f64]) -> f64 {
    let mut sum = 0.0;
    for ((left, right), datum) in left.iter().zip(right).zip(data) {
        if !datum.is_nan() {
            sum += left * right;
        }
    }
    sum
}

#[cfg(test)]
mod tests {
    use nalgebra::DVector;

    use super::{Covariance, NormalEquations};

    /// The covariance of two coordinates: the mean of the residuals, and one that does not affect them.
    fn covariance_of_mean(residuals: &[f64]) -> Covariance {
        let mut normal = NormalEquations::zeros(2);
        let column = |value: f64| vec![value; residuals.len()];
        normal.add(&[(0, column(-1.0)), (1, column(0.0))], residuals);
        Covariance::new(&normal, &[(0, 1.0), (1, 1.0)])
    }

    #[test]
    fn standard_error_of_a_mean_is_the_inverse_root_of_the_count() {
        let errors = covariance_of_mean(&[1.0; 100]).standard_errors();
        assert!((errors[0] - 0.1).abs() < 1e-12 && errors[1].is_infinite(), "{errors:?}");
    }

    #[test]
    fn collinear_coordinates_are_undetermined_and_the_others_are_not() {
        let mut normal = NormalEquations::zeros(3);
        let wave = |rate: f64| (0..100).map(|k| (rate * f64::from(k)).sin()).collect::<Vec<_>>();
        normal.add(&[(0, wave(0.1)), (1, wave(0.1)), (2, wave(1.3))], &wave(0.7));
        let errors = Covariance::new(&normal, &[(0, 1.0), (1, 1.0), (2, 1.0)]).standard_errors();
        assert!(errors[0].is_infinite() && errors[1].is_infinite(), "{errors:?}");
        assert!((errors[2] - 50.0_f64.sqrt().recip()).abs() < 2e-3, "{errors:?}");
    }

    #[test]
    fn profile_direction_includes_the_compensation_by_other_coordinates() {
        let mut normal = NormalEquations::zeros(2);
        let (first, second) = (vec![1.0, 1.0, 0.0], vec![0.0, 2.0, 2.0]);
        normal.add(&[(0, first), (1, second)], &[0.0; 3]);
        let direction = Covariance::new(&normal, &[(0, 1.0), (1, 1.0)]).profile_direction(0);
        // The second coordinate cancels the projection of the first column on its own: -(1 * 2) / (2 * 2 + 2 * 2).
        assert!((direction - DVector::from_vec(vec![1.0, -0.25])).norm() < 1e-12);
    }

    #[test]
    fn coordinates_without_data_are_undetermined() {
        let errors = Covariance::new(&NormalEquations::zeros(2), &[(0, 1.0), (1, 1.0)]).standard_errors();
        assert_eq!(errors, [f64::INFINITY; 2]);
    }

    #[test]
    fn block_standard_error_of_a_mean_is_that_of_the_block_means() {
        let means = [1.0, -1.0, 3.0, -3.0];
        let residuals = means.map(|mean| [mean; 25]).concat();
        let gradients = means.map(|mean| DVector::from_vec(vec![-25.0 * mean, 0.0]));
        // The standard error of the mean of four means.
        let expected = (20.0_f64 / 3.0 / 4.0).sqrt();
        let errors = covariance_of_mean(&residuals).block_standard_errors(&gradients, 1);
        assert!((errors[0] - expected).abs() < 1e-12, "{errors:?}, not {expected}");
    }
}
