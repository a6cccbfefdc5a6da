//! How far outputs move, and whether a fitted model explains that at all.

use crate::fit::estimate::over_sigma;
use crate::fit::fitted_model::Stage;
use crate::fit::problem::Problem;
use crate::statistics::descriptive::rms_about_means;

/// How far an output goes about its mean in the training records, rms over its noise.
pub(crate) fn motion_over_noise(problem: &Problem, output: usize) -> f64 {
    rms_about_means(problem.train.iter().map(|record| record.outputs[output].as_slice()))
        / problem.sigma[output]
}

/// A patch hardly explains an output, and units are in question, where of it more is left than this share of how far it moves, in rms.
pub(crate) const HARDLY: f64 = 0.5;

/// Whether a stage leaves more than half of how far an output moves.
pub(crate) fn is_hardly_explained(problem: &Problem, stage: &Stage) -> bool {
    (0..problem.outputs.len())
        .any(|output| over_sigma(&stage.train, output) > HARDLY * motion_over_noise(problem, output))
}
