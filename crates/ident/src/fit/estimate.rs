//! Estimates of all fitted quantities, and the results of fits.
//!
//! An [`Estimate`] is a point in the space that a fit searches. A [`FitState`] is an estimate with its sum of squares.
//! A [`FitResult`] also contains the residuals and the number of data.

use crate::fit::model::{FitParameter, Model, RunValues};
use crate::statistics::descriptive::mean;

/// Values of everything that a fit can change: a start of a fit, or its result.
#[derive(Debug, Clone, PartialEq)]
pub struct Estimate {
    /// Values of the fitted parameters, in declared units, in the order of `Model::parameters`.
    pub parameters: Vec<f64>,
    /// For every record the initial voltages, in V, in the order of `Model::initial`.
    pub initial: Vec<Vec<f64>>,
    /// The constant difference of every output from the model, in the unit of the output.
    pub offsets: Vec<f64>,
}

/// The result of a fit.
#[derive(Debug, Clone)]
pub struct FitResult {
    /// The fitted values.
    pub estimate: Estimate,
    /// The sum of the squared residuals.
    pub chi2: f64,
    /// (data - model) / sigma, by record, output and sample. NaN if the datum is missing.
    pub residuals: Vec<Vec<Vec<f64>>>,
    /// The number of data.
    pub data_count: usize,
    /// The number of fitted values that affect the data.
    pub fitted_count: usize,
}

/// The state of a fit after some iterations.
#[derive(Debug, Clone)]
pub struct FitState {
    /// The best estimate until now.
    pub estimate: Estimate,
    /// The sum of the squared residuals there.
    pub chi2: f64,
    /// Whether the fit has converged or was given up, so that further iterations are useless.
    pub is_finished: bool,
}

impl FitResult {
    /// Reduced chi-squared: the sum of squared residuals per degree of freedom. It is about 1 if the model is right.
    pub fn reduced_chi2(&self) -> f64 {
        self.reduced_chi2_of(self.chi2)
    }

    /// Reduced chi-squared - 1: the mean square that noise does not explain. At least 1e-6.
    pub fn excess_reduced_chi2(&self) -> f64 {
        self.excess_reduced_chi2_of(self.chi2)
    }

    /// The excess of reduced chi-squared for another sum of squares of the same data.
    pub(crate) fn excess_reduced_chi2_of(&self, chi2: f64) -> f64 {
        (self.reduced_chi2_of(chi2) - 1.0).max(MIN_EXCESS)
    }

    /// `chi2` per degree of freedom of this fit, of which there is at least one.
    fn reduced_chi2_of(&self, chi2: f64) -> f64 {
        chi2 / self.data_count.saturating_sub(self.fitted_count).max(1) as f64
    }

    /// The rms of the residuals, in units of sigma.
    pub fn normalised_rms(&self) -> f64 {
        (self.chi2 / self.data_count as f64).sqrt()
    }

    /// The fit with the least sum of squares. `None` if there is no fit.
    pub fn best_of(results: impl IntoIterator<Item = FitResult>) -> Option<FitResult> {
        results.into_iter().min_by(|a, b| a.chi2.total_cmp(&b.chi2))
    }
}

/// The least excess of reduced chi-squared. It keeps ratios of excesses finite; the value is far below any real excess.
const MIN_EXCESS: f64 = 1e-6;

impl Estimate {
    /// The values that the patch declares, the same initial voltages for every record, and zero offsets.
    pub fn nominal(model: &Model, output_count: usize) -> Estimate {
        let values = |parameters: &[FitParameter]| {
            parameters.iter().map(|parameter| parameter.value).collect::<Vec<_>>()
        };
        Estimate {
            parameters: values(&model.parameters),
            initial: vec![values(&model.initial); model.record_count()],
            offsets: vec![0.0; output_count],
        }
    }

    /// The values that a run along one record needs.
    pub(crate) fn run_values(&self, record: usize) -> RunValues {
        RunValues { parameters: self.parameters.clone(), initial: self.initial[record].clone() }
    }
}

/// The rms of the residuals of one output over all records, in units of sigma.
pub(crate) fn normalised_output_rms(result: &FitResult, output: usize) -> f64 {
    mean(&squared_residuals(&result.residuals, output)).sqrt()
}

/// The squared residuals of one output, of all records one after the other, without missing data.
pub(crate) fn squared_residuals(residuals: &[Vec<Vec<f64>>], output: usize) -> Vec<f64> {
    let tracks = residuals.iter().flat_map(|record| record[output].iter());
    tracks.filter(|residual| !residual.is_nan()).map(|residual| residual * residual).collect()
}
