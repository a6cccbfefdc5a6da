//! Normal equations: what the derivatives of residuals by the coordinates of a fit come to, the steps they ask for, and how far
//! from where the fit ends the coordinates may be.

use nalgebra::{DMatrix, DVector};

/// What is added to the scaled normal matrix of a step at least, so that it can be solved.
const LEAST_DAMPING: f64 = 1e-12;
/// Eigenvalues of the normal matrix below this share of the largest tell of nothing: derivatives are not known better.
const LEAST_TOLD: f64 = 1e-10;
/// A coordinate that may go this share of its way, unnoticed, may be anything.
const ANYTHING: f64 = 0.05;

/// The derivatives of residuals by a coordinate, behind its place.
pub(crate) type Column = (usize, Vec<f64>);

/// What the derivatives come to: the normal matrix and the gradient, in coordinates.
pub(crate) struct Normal {
    /// The products of the derivatives by two coordinates.
    pub(crate) matrix: DMatrix<f64>,
    /// Those of the derivatives and the residuals.
    pub(crate) gradient: DVector<f64>,
}

impl Normal {
    /// That of so many coordinates before there are data.
    pub(crate) fn empty(count: usize) -> Normal {
        Normal { matrix: DMatrix::zeros(count, count), gradient: DVector::zeros(count) }
    }

    /// Adds the residuals of an output.
    pub(crate) fn add(&mut self, columns: &[Column], residual: &[f64]) {
        for (place, (index, column)) in columns.iter().enumerate() {
            self.gradient[*index] += product_there(column, residual, residual);
            for (other, beside) in &columns[..=place] {
                let sum = product_there(column, beside, residual);
                self.matrix[(*index, *other)] += sum;
                if index != other {
                    self.matrix[(*other, *index)] += sum;
                }
            }
        }
    }

    /// The matrix of some coordinates in units in which every one of them tells as much, behind these.
    fn scaled(&self, some: &[usize]) -> (Vec<f64>, DMatrix<f64>) {
        let units: Vec<f64> = some.iter().map(|index| 1.0 / self.matrix[(*index, *index)].sqrt()).collect();
        let matrix = DMatrix::from_fn(some.len(), some.len(), |row, column| {
            self.matrix[(some[row], some[column])] * units[row] * units[column]
        });
        (units, matrix)
    }

    /// The damped step of these coordinates.
    pub(crate) fn solved(&self, free: &[usize], damping: f64) -> DVector<f64> {
        let count = free.len();
        let (units, mut matrix) = self.scaled(free);
        (0..count).for_each(|place| matrix[(place, place)] += damping + LEAST_DAMPING);
        let gradient = DVector::from_fn(count, |row, _| -self.gradient[free[row]] * units[row]);
        let solved = matrix.cholesky().map(|cholesky| cholesky.solve(&gradient));
        let solved = solved.unwrap_or_else(|| gradient * (1.0 / (1.0 + damping)));
        DVector::from_fn(count, |row, _| solved[row] * units[row])
    }
}

/// How far coordinates may be from where a fit puts them.
pub(crate) struct Spread {
    /// How many coordinates there are.
    count: usize,
    /// Those that move what was measured.
    told: Vec<usize>,
    /// In whose units every coordinate tells as much.
    units: Vec<f64>,
    /// A root of the inverse of their normal matrix, in these units: the inverse is this times its transpose.
    root: DMatrix<f64>,
    /// How far they may go, in these units, in directions that the data do not tell of: until one has gone all its way,
    loose: Vec<f64>,
    /// and whether that is so far that they may be anything.
    is_anything: Vec<bool>,
}

impl Spread {
    /// That of these coordinates, each with how long its way is.
    pub(crate) fn of(normal: &Normal, free: &[(usize, f64)]) -> Spread {
        let is_told = |(index, _): &&(usize, f64)| normal.matrix[(*index, *index)] > 0.0;
        let (told, ways): (Vec<usize>, Vec<f64>) = free.iter().filter(is_told).copied().unzip();
        let (units, scaled) = normal.scaled(&told);
        let mut root = DMatrix::zeros(told.len(), told.len());
        let mut loose = vec![0.0_f64; told.len()];
        // There is no decomposition of nothing.
        if !told.is_empty() {
            let eigen = scaled.symmetric_eigen();
            let least = LEAST_TOLD * eigen.eigenvalues.max();
            let directions = eigen.eigenvectors.column_iter().zip(&eigen.eigenvalues);
            for (place, (vector, value)) in directions.enumerate() {
                if *value > least {
                    root.set_column(place, &(vector / value.sqrt()));
                } else {
                    let each = vector.iter().zip(&units).zip(&ways);
                    let length = each.map(|((part, unit), way)| way / (part * unit).abs());
                    let length = length.fold(f64::INFINITY, f64::min);
                    loose.iter_mut().zip(&vector).for_each(|(own, part)| *own = own.hypot(length * part));
                }
            }
        }
        let goes = loose.iter().zip(&units).zip(&ways);
        let is_anything = goes.map(|((own, unit), way)| own * unit > ANYTHING * way).collect();
        Spread { count: normal.gradient.len(), told, units, root, loose, is_anything }
    }

    /// Standard errors where the noise is white.
    pub(crate) fn errors(&self) -> Vec<f64> {
        self.each(|row| self.root.row(row).norm())
    }

    /// Standard errors by how far every block would move the coordinates of which so many bend it, whatever the noise is like.
    pub(crate) fn errors_by(&self, pulls: &[DVector<f64>], bent: usize) -> Vec<f64> {
        let moves: Vec<DVector<f64>> = pulls.iter().map(|pull| self.moved(pull)).collect();
        let blocks = pulls.len() as f64;
        let few = (blocks / (blocks - bent as f64).max(1.0)).sqrt();
        self.each(|row| few * moves.iter().map(|own| own[row] * own[row]).sum::<f64>().sqrt())
    }

    /// Where all coordinates go, so that the squares rise least, where one of them goes by 1.
    pub(crate) fn along(&self, index: usize) -> DVector<f64> {
        let mut along = DVector::zeros(self.count);
        if let Some(row) = self.told.iter().position(|told| *told == index) {
            let moved = &self.root * self.root.row(row).transpose();
            for (place, (told, unit)) in self.told.iter().zip(&self.units).enumerate() {
                along[*told] = moved[place] * unit / (moved[row] * self.units[row]);
            }
        }
        along
    }

    /// Where a gradient would move what is told of, in its units.
    fn moved(&self, gradient: &DVector<f64>) -> DVector<f64> {
        let own = self.told.iter().zip(&self.units).map(|(index, unit)| gradient[*index] * unit);
        let own = DVector::from_iterator(self.told.len(), own);
        &self.root * (self.root.transpose() * own)
    }

    /// Something of every coordinate; infinite where the data do not tell.
    fn each(&self, of: impl Fn(usize) -> f64) -> Vec<f64> {
        let mut all = vec![f64::INFINITY; self.count];
        for (row, (index, unit)) in self.told.iter().zip(&self.units).enumerate() {
            if !self.is_anything[row] {
                all[*index] = of(row).hypot(self.loose[row]) * unit;
            }
        }
        all
    }
}

/// The sum of products where there are data.
pub(crate) fn product_there(left: &[f64], right: &[f64], data: &[f64]) -> f64 {
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

    use super::{Normal, Spread};

    /// The spread of a mean, and of a coordinate that nothing tells of, by residuals.
    fn spread(residuals: &[f64]) -> Spread {
        let mut normal = Normal::empty(2);
        let column = |value: f64| vec![value; residuals.len()];
        normal.add(&[(0, column(-1.0)), (1, column(0.0))], residuals);
        Spread::of(&normal, &[(0, 1.0), (1, 1.0)])
    }

    #[test]
    fn mean_is_as_good_as_the_root_of_the_count() {
        let errors = spread(&[1.0; 100]).errors();
        assert!((errors[0] - 0.1).abs() < 1e-12 && errors[1].is_infinite(), "{errors:?}");
    }

    #[test]
    fn what_others_follow_is_not_told_and_the_rest_is() {
        let mut normal = Normal::empty(3);
        let wave = |rate: f64| (0..100).map(|k| (rate * f64::from(k)).sin()).collect::<Vec<_>>();
        normal.add(&[(0, wave(0.1)), (1, wave(0.1)), (2, wave(1.3))], &wave(0.7));
        let errors = Spread::of(&normal, &[(0, 1.0), (1, 1.0), (2, 1.0)]).errors();
        assert!(errors[0].is_infinite() && errors[1].is_infinite(), "{errors:?}");
        assert!((errors[2] - 50.0_f64.sqrt().recip()).abs() < 2e-3, "{errors:?}");
    }

    #[test]
    fn where_one_goes_another_makes_up_for_it() {
        let mut normal = Normal::empty(2);
        let (one, other) = (vec![1.0, 1.0, 0.0], vec![0.0, 2.0, 2.0]);
        normal.add(&[(0, one), (1, other)], &[0.0; 3]);
        let along = Spread::of(&normal, &[(0, 1.0), (1, 1.0)]).along(0);
        // The second takes away of the first what is along it: - (1 * 2) / (2 * 2 + 2 * 2).
        assert!((along - DVector::from_vec(vec![1.0, -0.25])).norm() < 1e-12);
    }

    #[test]
    fn where_nothing_moves_nothing_is_told() {
        let errors = Spread::of(&Normal::empty(2), &[(0, 1.0), (1, 1.0)]).errors();
        assert_eq!(errors, [f64::INFINITY; 2]);
    }

    #[test]
    fn blocks_that_disagree_widen_a_mean_by_their_own_spread() {
        let means = [1.0, -1.0, 3.0, -3.0];
        let residuals = means.map(|mean| [mean; 25]).concat();
        let pulls = means.map(|mean| DVector::from_vec(vec![-25.0 * mean, 0.0]));
        // The standard error of the mean of four means.
        let wanted = (20.0_f64 / 3.0 / 4.0).sqrt();
        let errors = spread(&residuals).errors_by(&pulls, 1);
        assert!((errors[0] - wanted).abs() < 1e-12, "{errors:?}, not {wanted}");
    }
}
