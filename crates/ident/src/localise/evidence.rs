//! Regularised least squares with a Gaussian-process prior, whose kind and variance maximise the evidence.
//!
//! The model is linear: data = nuisance parameters + input coefficients + white noise. The input coefficients have a
//! smoothness prior: a random walk or its integral. [`InputNormalEquations`] accumulates the sums of products of the
//! columns. The nuisance parameters are eliminated first (Schur complement). An eigenvalue decomposition then makes the
//! evidence a cheap function of the prior variance, so that a grid search finds its maximum. The evidence is the
//! marginal likelihood of the data (D. J. C. MacKay, Bayesian interpolation, Neural Computation 4, 1992).

use nalgebra::{DMatrix, DVector};

/// The normal equations of nuisance parameters and input coefficients. All residuals are divided by the noise's
/// standard deviation.
#[derive(Debug, Clone)]
pub struct InputNormalEquations {
    /// The prior of each nuisance parameter.
    pub priors: Vec<NuisancePrior>,
    /// The number of input coefficients in each group. The smoothness prior acts within a group only.
    pub groups: Vec<usize>,
    /// The sum of squares without an input.
    pub baseline_chi2: f64,
    /// Products of columns: nuisance parameters, input coefficients, and last the data.
    sums: DMatrix<f64>,
    /// The number of data.
    rows: usize,
}

/// The Gaussian prior of a nuisance parameter, and its bounds.
#[derive(Debug, Clone, Copy)]
pub struct NuisancePrior {
    /// The expected value.
    pub mean: f64,
    /// The inverse of the prior variance, in units of the inverse noise variance.
    pub weight: f64,
    /// The least and the largest permitted value.
    pub range: [f64; 2],
}

impl NuisancePrior {
    /// Whether a value is within the bounds.
    fn permits(&self, value: f64) -> bool {
        (self.range[0]..=self.range[1]).contains(&value)
    }
}

/// The posterior of the input coefficients, with the prior of the largest evidence.
#[derive(Debug, Clone)]
pub struct InputPosterior {
    /// The posterior means of the nuisance parameters.
    pub(super) nuisance: DVector<f64>,
    /// The posterior means of the input coefficients.
    pub(super) coefficients: DVector<f64>,
    /// The posterior covariance of the input coefficients, with the nuisance parameters free.
    pub(super) covariance: DMatrix<f64>,
    /// Logarithm of the marginal likelihood, relative to that without an input.
    pub evidence: f64,
    /// The effective number of parameters: the trace of the smoothing matrix.
    pub effective_parameters: f64,
    /// The sum of squares of the residuals, without the penalty.
    pub chi2: f64,
    /// The kind of prior.
    pub prior: SmoothnessPrior,
    /// The prior variance of the coefficients, in units of the noise variance.
    prior_variance: f64,
}

/// The prior of neighbouring input coefficients.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum SmoothnessPrior {
    /// A random walk: first differences are small. The curve may jump.
    Rough,
    /// An integrated random walk: second differences are small. The curve is smooth.
    Smooth,
}

impl SmoothnessPrior {
    /// Both kinds.
    pub const ALL: [SmoothnessPrior; 2] = [SmoothnessPrior::Rough, SmoothnessPrior::Smooth];

    /// The word in reports: "rough" or "smooth".
    pub fn as_str(self) -> &'static str {
        match self {
            SmoothnessPrior::Rough => "rough",
            SmoothnessPrior::Smooth => "smooth",
        }
    }

    /// A factor F of the prior covariance F F' of one group. It is scaled so that the last coefficient has the variance
    /// 2 (rough) or about 3 (smooth) for any number of coefficients. The first columns are a constant and, if smooth, a
    /// slope.
    fn covariance_factor(self, count: usize) -> DMatrix<f64> {
        let n = count as f64;
        DMatrix::from_fn(count, count, |row, column| match (self, column) {
            (_, 0) => 1.0,
            (SmoothnessPrior::Smooth, 1) => row as f64 / n,
            (SmoothnessPrior::Rough, _) if column <= row => n.sqrt().recip(),
            (SmoothnessPrior::Smooth, _) if column <= row => {
                (row + 1 - column) as f64 * (3.0 / n.powi(3)).sqrt()
            }
            _ => 0.0,
        })
    }

    /// The factor for several groups: block diagonal.
    fn block_factor(self, groups: &[usize]) -> DMatrix<f64> {
        let total = groups.iter().sum();
        let mut factor = DMatrix::zeros(total, total);
        let mut first = 0;
        for count in groups {
            factor.view_mut((first, first), (*count, *count)).copy_from(&self.covariance_factor(*count));
            first += count;
        }
        factor
    }
}

/// The least prior variance of the grid, in units of the inverse of the largest eigenvalue. The prior then suppresses
/// every direction almost completely.
const FIRST_PRIOR_VARIANCE: f64 = 1e-2;
/// The ratio of neighbouring prior variances of the grid. The evidence has a broad maximum, so a factor of 2 is fine
/// enough.
const PRIOR_VARIANCE_RATIO: f64 = 2.0;
/// The number of prior variances of the grid. It covers 18 decades.
const PRIOR_VARIANCES: i32 = 60;

/// The prior weight of a fixed nuisance parameter, in units of the largest diagonal element of the normal equations.
/// The data then move the parameter by at most a millionth of what they would without it.
const FIXED_WEIGHT: f64 = 1e6;

impl InputNormalEquations {
    /// Normal equations without data.
    pub fn new(priors: Vec<NuisancePrior>, groups: Vec<usize>, baseline_chi2: f64) -> InputNormalEquations {
        let size = priors.len() + groups.iter().sum::<usize>() + 1;
        InputNormalEquations { priors, groups, baseline_chi2, sums: DMatrix::zeros(size, size), rows: 0 }
    }

    /// Adds data: a row for each datum, with the derivatives by all parameters and the datum in the last column.
    pub fn add(&mut self, rows: &DMatrix<f64>) {
        // Most coefficients act in few records only.
        let is_nonzero = |column: &usize| rows.column(*column).iter().any(|value| *value != 0.0);
        let nonzero: Vec<usize> = (0..rows.ncols()).filter(is_nonzero).collect();
        for (first, one) in nonzero.iter().enumerate() {
            for other in &nonzero[first..] {
                let sum = self.sums[(*one, *other)] + rows.column(*one).dot(&rows.column(*other));
                (self.sums[(*one, *other)], self.sums[(*other, *one)]) = (sum, sum);
            }
        }
        self.rows += rows.nrows();
    }

    /// The normal equations of a coarser basis. Each old coefficient is a sum of new ones, with the factors in its row
    /// of `weights`. `groups` are those of the new coefficients.
    pub fn in_basis(&self, weights: &DMatrix<f64>, groups: Vec<usize>) -> InputNormalEquations {
        let (nuisance, coefficients) = (self.priors.len(), self.coefficient_count());
        let mut transform = DMatrix::zeros(nuisance + coefficients + 1, nuisance + weights.ncols() + 1);
        (0..nuisance).for_each(|index| transform[(index, index)] = 1.0);
        transform.view_mut((nuisance, nuisance), weights.shape()).copy_from(weights);
        transform[(nuisance + coefficients, nuisance + weights.ncols())] = 1.0;
        let sums = transform.tr_mul(&(&self.sums * &transform));
        InputNormalEquations {
            priors: self.priors.clone(),
            groups,
            baseline_chi2: self.baseline_chi2,
            sums,
            rows: self.rows,
        }
    }

    /// The normal equations with all nuisance parameters fixed at their present values.
    pub fn with_fixed_nuisance(&self) -> InputNormalEquations {
        let priors = self.priors.iter().map(|prior| self.fixed_prior(prior, 0.0)).collect();
        InputNormalEquations { priors, ..self.clone() }
    }

    /// The prior that fixes a nuisance parameter at a value.
    fn fixed_prior(&self, prior: &NuisancePrior, mean: f64) -> NuisancePrior {
        NuisancePrior { mean, weight: FIXED_WEIGHT * self.sums.diagonal().max(), ..*prior }
    }

    /// The posterior with the prior of the largest evidence. Nuisance parameters that would leave their bounds are
    /// fixed at them, and the rest is solved again. `None` if the equations are singular.
    pub fn solve(&self) -> Option<InputPosterior> {
        let mut priors = self.priors.clone();
        let mut is_free = vec![true; priors.len()];
        loop {
            let posterior = self.most_likely(&priors)?;
            let outside: Vec<usize> = (0..priors.len())
                .filter(|index| is_free[*index] && !priors[*index].permits(posterior.nuisance[*index]))
                .collect();
            if outside.is_empty() {
                return Some(posterior);
            }
            for index in outside {
                let [low, high] = priors[index].range;
                priors[index] = self.fixed_prior(&priors[index], posterior.nuisance[index].clamp(low, high));
                is_free[index] = false;
            }
        }
    }

    /// The posterior of the smoothness prior with the larger evidence.
    fn most_likely(&self, priors: &[NuisancePrior]) -> Option<InputPosterior> {
        let sums = self.with_priors(priors);
        let posteriors = SmoothnessPrior::ALL.iter().filter_map(|prior| self.posterior(&sums, *prior));
        posteriors.max_by(|a, b| a.evidence.total_cmp(&b.evidence))
    }

    /// The sums with each prior of a nuisance parameter added as a datum.
    fn with_priors(&self, priors: &[NuisancePrior]) -> DMatrix<f64> {
        let (mut sums, last) = (self.sums.clone(), self.sums.ncols() - 1);
        for (index, NuisancePrior { mean, weight, .. }) in priors.iter().enumerate() {
            sums[(index, index)] += weight;
            sums[(index, last)] += weight * mean;
            sums[(last, index)] += weight * mean;
            sums[(last, last)] += weight * mean * mean;
        }
        sums
    }

    /// The number of input coefficients.
    fn coefficient_count(&self) -> usize {
        self.groups.iter().sum()
    }

    /// The posterior for one smoothness prior, at the prior variance of the largest evidence.
    fn posterior(&self, sums: &DMatrix<f64>, prior: SmoothnessPrior) -> Option<InputPosterior> {
        let (complement, problem) = self.diagonalised(sums, prior)?;
        let variance = problem.best_prior_variance();
        let (coefficients, covariance) = problem.mean_and_covariance(variance);
        Some(InputPosterior {
            nuisance: complement.nuisance(&coefficients),
            coefficients,
            covariance,
            evidence: problem.evidence(variance),
            effective_parameters: problem
                .eigenvalues
                .iter()
                .map(|value| variance * value / (1.0 + variance * value))
                .sum(),
            chi2: problem.chi2(variance),
            prior,
            prior_variance: variance,
        })
    }

    /// The covariance of the coefficients if the nuisance parameters were known exactly, with the prior of a posterior.
    pub fn conditional_covariance(&self, posterior: &InputPosterior) -> Option<DMatrix<f64>> {
        let fixed = self.with_fixed_nuisance();
        let (_, problem) = fixed.diagonalised(&fixed.with_priors(&fixed.priors), posterior.prior)?;
        Some(problem.mean_and_covariance(posterior.prior_variance).1)
    }

    /// Eliminates the nuisance parameters and decomposes the rest into independent directions.
    fn diagonalised(
        &self,
        sums: &DMatrix<f64>,
        prior: SmoothnessPrior,
    ) -> Option<(SchurComplement, DiagonalProblem)> {
        let nuisance = self.priors.len();
        let complement = SchurComplement::of(sums, nuisance)?;
        let rows = self.rows.saturating_sub(nuisance).max(1);
        let factor = prior.block_factor(&self.groups);
        let problem = DiagonalProblem::of(&complement, factor, rows, self.baseline_chi2);
        Some((complement, problem))
    }
}

/// The normal equations without the nuisance parameters.
struct SchurComplement {
    /// The nuisance parameters per input coefficient and, in the last column, for the data.
    elimination: DMatrix<f64>,
    /// The sums of products that remain: input coefficients, and last the data.
    sums: DMatrix<f64>,
}

impl SchurComplement {
    /// Eliminates the first `nuisance` parameters. `None` if their block is not positive definite.
    fn of(sums: &DMatrix<f64>, nuisance: usize) -> Option<SchurComplement> {
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
    fn nuisance(&self, coefficients: &DVector<f64>) -> DVector<f64> {
        let count = self.coefficient_count();
        self.elimination.column(count) - self.elimination.columns(0, count) * coefficients
    }
}

/// The problem in coordinates in which the data and the prior are both diagonal. The prior variance is the only unknown
/// of the evidence here.
struct DiagonalProblem {
    /// The factor of the prior covariance.
    factor: DMatrix<f64>,
    /// The information of the data about each direction.
    eigenvalues: DVector<f64>,
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
    fn of(
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
    fn chi2(&self, prior_variance: f64) -> f64 {
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
    fn evidence(&self, prior_variance: f64) -> f64 {
        let log_determinant: f64 =
            self.eigenvalues.iter().map(|value| libm::log1p(prior_variance * value)).sum();
        let ratio = self.penalised_chi2(prior_variance) / self.baseline_chi2;
        -0.5 * (self.rows * libm::log(ratio) + log_determinant)
    }

    /// The prior variance of the grid with the largest evidence.
    fn best_prior_variance(&self) -> f64 {
        let first = FIRST_PRIOR_VARIANCE / self.eigenvalues.max().max(f64::MIN_POSITIVE);
        let variances = (0..PRIOR_VARIANCES).map(|index| first * PRIOR_VARIANCE_RATIO.powi(index));
        let by_evidence = |a: &f64, b: &f64| self.evidence(*a).total_cmp(&self.evidence(*b));
        variances.max_by(by_evidence).unwrap_or(first)
    }

    /// The posterior mean and covariance of the coefficients. The noise variance is estimated from the penalised sum of
    /// squares.
    fn mean_and_covariance(&self, prior_variance: f64) -> (DVector<f64>, DMatrix<f64>) {
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
