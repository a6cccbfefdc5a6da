//! The limits that decide whether an effect is accepted, so that chance alone is not sufficient.
//!
//! An effect must decrease the Bayesian information criterion by [`required_delta_bic`]. In addition, the validation
//! data must confirm it. The limits are chosen, not derived.

/// The criterion by which the effects of one round are accepted.
#[derive(Debug, Clone, Copy)]
pub(crate) struct AcceptanceCriterion {
    /// The variance that counts as noise, relative to the noise of the data. 1 if the residual is only that noise.
    pub(crate) noise_variance: f64,
    /// The integrated autocorrelation time of the residual, in samples. 1 for white noise.
    pub(crate) autocorrelation_time: f64,
    /// The `delta_bic` that an effect needs.
    pub(crate) required_delta_bic: f64,
}

impl AcceptanceCriterion {
    /// Returns the criterion for this number of trials if the residual is white noise of the expected size.
    pub(crate) fn white_noise(trials: usize) -> AcceptanceCriterion {
        AcceptanceCriterion {
            noise_variance: 1.0,
            autocorrelation_time: 1.0,
            required_delta_bic: required_delta_bic(trials),
        }
    }

    /// Returns the noise variance per independent sample. Correlated noise of n samples with the autocorrelation time m
    /// has the information of n / m independent samples.
    pub(crate) fn effective_variance(&self) -> f64 {
        self.noise_variance * self.autocorrelation_time
    }
}

/// The `delta_bic` that a single trial needs. A chosen limit.
const BASE_DELTA_BIC: f64 = 4.0;
/// The increase of the required `delta_bic` with the natural logarithm of the number of trials. The best of n trials
/// without effect decreases chi2 by about 2 ln(n) by chance.
const DELTA_BIC_PER_LOG_TRIAL: f64 = 2.0;
/// The standard errors by which the validation data must be fitted better with an effect. A chosen limit: chance
/// exceeds it in about 2 % of the cases.
pub(crate) const CONFIRMATION_Z: f64 = 2.0;

/// The standard errors from which the data distinguish a rival from the best trial. A chosen limit: chance exceeds it
/// in less than 1 % of the cases.
pub(crate) const RIVAL_Z: f64 = 2.5;

/// Returns the `delta_bic` that the best of this number of trials needs: 4 + 2 ln(trials).
pub(crate) fn required_delta_bic(trials: usize) -> f64 {
    BASE_DELTA_BIC + DELTA_BIC_PER_LOG_TRIAL * libm::log(trials.max(1) as f64)
}
