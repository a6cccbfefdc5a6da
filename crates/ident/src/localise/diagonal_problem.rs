//! The linear algebra of the evidence: elimination of nuisance parameters, and independent directions.
//!
//! [`SchurComplement`] eliminates the nuisance parameters from the normal equations. [`DiagonalProblem`] decomposes the
//! rest into directions in which the data and the prior are both diagonal. The evidence, the posterior and the sum of
//! squares are then cheap functions of the prior variance.

use nalgebra::{DMatrix, DVector};

/// The least prior variance of the grid, in units of the inverse of the largest eigenvalue. The prior then suppresses
/// every direction almost completely.
const FIRST_PRIOR_VARIANCE: f64 = 1e-2;
/// The ratio of neighbouring prior variances of the grid. The evidence has a broad maximum, so a factor of 2 is fine
/// enough.
const PRIOR_VARIANCE_RATIO: f64 = 2.0;
/// The number of prior variances of the grid. It covers 18 decades.
const PRIOR_VARIANCES: i32 = 60;

/// The normal equations without the nuisance parameters.
pub(super) struct SchurComplement {
    /// The nuisance parameters per input coefficient and, in the last column, for the data.
    elimination: DMatrix<f64>,
    /// The sums of products that remain: input coefficients, and last the data.
    sums: DMatrix<f64>,
}

impl SchurComplement {
    /// Eliminates the first `nuisance` parameters. `None` if their block is not positive definite.
    pub(super) fn of(sums: &DMatrix<f64>, nuisance: usize) -> Option<SchurComplement> {
        let rest = sums.ncols() - nuisance;
        let block = sums.view((0, 0), (nuisance, nuisance)).clone_owned().cholesky()?;
        let cross = sums.view((0, nuisance), (nuisance, rest));
        let elimination = block.solve(&cross);
        let sums = sums.view((nuisance, nuisance), (rest, rest)) - cross.tr_mul(&elimination);
        Some(SchurComplement { elimination, sums })
    }

    /// The number of input coefficients.
    fn coefficient_count(&self) -> usize {
        self.sums.ncols() - 1
    }

    /// The matrix and the right-hand side of the normal equations in the prior's independent coordinates.
    fn whitened(&self, factor: &DMatrix<f64>) -> (DMatrix<f64>, DVector<f64>) {
        let count = self.coefficient_count();
        let matrix = factor.tr_mul(&(self.sums.view((0, 0), (count, count)) * factor));
        let right_side = factor.tr_mul(&self.sums.view((0, count), (count, 1)).column(0));
        ((&matrix + matrix.transpose()) / 2.0, right_side)
    }

    /// The most likely nuisance parameters for given input coefficients.
    pub(super) fn nuisance(&self, coefficients: &DVector<f64>) -> DVector<f64> {
        let count = self.coefficient_count();
        self.elimination.column(count) - self.elimination.columns(0, count) * coefficients
    }
}

/// The problem in coordinates in which the data and the prior are both diagonal. The prior variance is the only unknown
/// of the evidence here.
pub(super) struct DiagonalProblem {
    /// The factor of the prior covariance.
    factor: DMatrix<f64>,
    /// The information of the data about each direction.
    pub eigenvalues: DVector<f64>,
    /// The directions as columns.
    eigenvectors: DMatrix<f64>,
    /// The right-hand side of the normal equations in each direction.
    projections: DVector<f64>,
    /// The sum of squares with all coefficients at 0 and the nuisance parameters free.
    total_chi2: f64,
    /// The sum of squares without an input.
    baseline_chi2: f64,
    /// The number of data minus that of nuisance parameters, at least 1.
    rows: f64,
}

impl DiagonalProblem {
    /// Decomposes the whitened normal equations. Negative eigenvalues are rounding and become 0.
    pub(super) fn of(
        complement: &SchurComplement,
        factor: DMatrix<f64>,
        rows: usize,
        baseline_chi2: f64,
    ) -> DiagonalProblem {
        let (matrix, right_side) = complement.whitened(&factor);
        let eigen = matrix.symmetric_eigen();
        let projections = eigen.eigenvectors.tr_mul(&right_side);
        let eigenvalues = eigen.eigenvalues.map(|value| value.max(0.0));
        let last = complement.coefficient_count();
        DiagonalProblem {
            factor,
            eigenvalues,
            eigenvectors: eigen.eigenvectors,
            projections,
            total_chi2: complement.sums[(last, last)],
            baseline_chi2,
            rows: rows as f64,
        }
    }

    /// The posterior variance of each direction, in units of the noise variance: w / (1 + w lambda).
    fn posterior_variances(&self, prior_variance: f64) -> DVector<f64> {
        self.eigenvalues.map(|value| prior_variance / (1.0 + prior_variance * value))
    }

    /// The minimum of the sum of squares plus the penalty of the prior.
    fn penalised_chi2(&self, prior_variance: f64) -> f64 {
        let variances = self.posterior_variances(prior_variance);
        let explained: f64 = self
            .projections
            .iter()
            .zip(&variances)
            .map(|(projection, variance)| projection * projection * variance)
            .sum();
        (self.total_chi2 - explained).max(f64::MIN_POSITIVE)
    }

    /// The sum of squares at the posterior mean, without the penalty.
    pub(super) fn chi2(&self, prior_variance: f64) -> f64 {
        let variances = self.posterior_variances(prior_variance);
        let terms = self.projections.iter().zip(&self.eigenvalues).zip(&variances);
        let explained: f64 = terms
            .map(|((projection, value), variance)| {
                projection * projection * variance * (2.0 - value * variance)
            })
            .sum();
        (self.total_chi2 - explained).max(f64::MIN_POSITIVE)
    }

    /// Logarithm of the marginal likelihood relative to that without an input. The noise variance is integrated out, so
    /// that only the ratio of the sums of squares matters.
    pub(super) fn evidence(&self, prior_variance: f64) -> f64 {
        let log_determinant: f64 =
            self.eigenvalues.iter().map(|value| libm::log1p(prior_variance * value)).sum();
        let ratio = self.penalised_chi2(prior_variance) / self.baseline_chi2;
        -0.5 * (self.rows * libm::log(ratio) + log_determinant)
    }

    /// The prior variance of the grid with the largest evidence.
    pub(super) fn best_prior_variance(&self) -> f64 {
        let first = FIRST_PRIOR_VARIANCE / self.eigenvalues.max().max(f64::MIN_POSITIVE);
        let variances = (0..PRIOR_VARIANCES).map(|index| first * PRIOR_VARIANCE_RATIO.powi(index));
        let by_evidence = |a: &f64, b: &f64| self.evidence(*a).total_cmp(&self.evidence(*b));
        variances.max_by(by_evidence).unwrap_or(first)
    }

    /// The posterior mean and covariance of the coefficients. The noise variance is estimated from the penalised sum of
    /// squares.
    pub(super) fn mean_and_covariance(&self, prior_variance: f64) -> (DVector<f64>, DMatrix<f64>) {
        let variances = self.posterior_variances(prior_variance);
        let directions = &self.factor * &self.eigenvectors;
        let mean = &directions * variances.component_mul(&self.projections);
        let noise_variance = self.penalised_chi2(prior_variance) / self.rows;
        let mut scaled = directions.clone();
        for (mut column, variance) in scaled.column_iter_mut().zip(&variances) {
            column *= variance * noise_variance;
        }
        (mean, scaled * directions.transpose())
    }
}
