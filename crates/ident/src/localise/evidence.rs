//! Regularised least squares with a Gaussian-process prior, whose kind and variance maximise the evidence.
//!
//! The model is linear: data = nuisance parameters + input coefficients + white noise. The input coefficients have a
//! smoothness prior: a random walk or its integral. [`InputNormalEquations`] accumulates the sums of products of the
//! columns. The nuisance parameters are eliminated first (Schur complement). An eigenvalue decomposition then makes the
//! evidence a cheap function of the prior variance, so that a grid search finds its maximum. The evidence is the
//! marginal likelihood of the data (D. J. C. MacKay, Bayesian interpolation, Neural Computation 4, 1992).

use nalgebra::{DMatrix, DVector};

use crate::localise::diagonal_problem::{DiagonalProblem, SchurComplement};

/// The normal equations of nuisance parameters and input coefficients. All residuals are divided by the noise's
/// standard deviation.
#[derive(Debug, Clone)]
pub(crate) struct InputNormalEquations {
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
pub(crate) struct NuisancePrior {
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
pub(crate) struct InputPosterior {
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
#[non_exhaustive]
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

/// The prior weight of a fixed nuisance parameter, in units of the largest diagonal element of the normal equations.
/// The data then move the parameter by at most a millionth of what they would without it.
const FIXED_WEIGHT: f64 = 1e6;

impl InputNormalEquations {
    /// Normal equations without data.
    pub(crate) fn new(
        priors: Vec<NuisancePrior>,
        groups: Vec<usize>,
        baseline_chi2: f64,
    ) -> InputNormalEquations {
        let size = priors.len() + groups.iter().sum::<usize>() + 1;
        InputNormalEquations { priors, groups, baseline_chi2, sums: DMatrix::zeros(size, size), rows: 0 }
    }

    /// Adds data: a row for each datum, with the derivatives by all parameters and the datum in the last column.
    pub(crate) fn add(&mut self, rows: &DMatrix<f64>) {
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
    pub(crate) fn in_basis(&self, weights: &DMatrix<f64>, groups: Vec<usize>) -> InputNormalEquations {
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
    pub(crate) fn with_fixed_nuisance(&self) -> InputNormalEquations {
        let priors = self.priors.iter().map(|prior| self.fixed_prior(prior, 0.0)).collect();
        InputNormalEquations { priors, ..self.clone() }
    }

    /// The prior that fixes a nuisance parameter at a value.
    fn fixed_prior(&self, prior: &NuisancePrior, mean: f64) -> NuisancePrior {
        NuisancePrior { mean, weight: FIXED_WEIGHT * self.sums.diagonal().max(), ..*prior }
    }

    /// The posterior with the prior of the largest evidence. Nuisance parameters that would leave their bounds are
    /// fixed at them, and the rest is solved again. `None` if the equations are singular.
    pub(crate) fn solve(&self) -> Option<InputPosterior> {
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
    pub(crate) fn conditional_covariance(&self, posterior: &InputPosterior) -> Option<DMatrix<f64>> {
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
