//! The motion of outputs, and whether a fitted model explains it.

use crate::fit::estimate::normalised_output_rms;
use crate::fit::fitted_model::FittedModel;
use crate::fit::problem::Problem;
use crate::statistics::descriptive::rms_about_means;

/// The rms motion of an output about its mean in the training records, in units of sigma. Each record has its own mean.
pub(crate) fn normalised_motion(problem: &Problem, output: usize) -> f64 {
    rms_about_means(problem.train.iter().map(|record| record.outputs[output].as_slice()))
        / problem.sigma[output]
}

/// Ratio of the rms residual of an output to its rms motion above which the model does not explain the output. Units
/// may then be wrong.
pub(crate) const UNEXPLAINED_RATIO: f64 = 0.5;

/// Whether the model does not explain at least one output: the residuals exceed half of its motion.
pub(crate) fn has_unexplained_output(problem: &Problem, fitted: &FittedModel) -> bool {
    (0..problem.outputs.len()).any(|output| {
        normalised_output_rms(&fitted.train, output) > UNEXPLAINED_RATIO * normalised_motion(problem, output)
    })
}
