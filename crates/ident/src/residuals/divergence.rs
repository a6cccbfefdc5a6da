//! Fits that diverge from the data, usually because the sign in a loop is wrong. Such a model is unstable, and a
//! missing effect cannot be identified from its residuals.

use std::iter::successors;

use crate::fit::fitted_model::FittedModel;
use crate::fit::levenberg_marquardt::FitProblem;
use crate::fit::model::ModelError;
use crate::fit::normal_equations::JacobianColumn;
use crate::fit::problem::Problem;
use crate::residuals::output_motion::{UNEXPLAINED_RATIO, normalised_motion};
use crate::statistics::descriptive::rms_about_means;

/// Least growth of the response to an initial voltage in a diverging fit. It is measured from a first part of the
/// record to a part that is [`LENGTH_RATIO`] times as long.
const MIN_GROWTH: f64 = 1e3;
/// The ratio of the lengths of the two parts of a record that are compared.
const LENGTH_RATIO: usize = 16;
/// Growth per integrator that is not divergence. The response of n integrators in series grows as the power n - 1 of
/// the time. Over the two parts it grows by up to 2 * [`LENGTH_RATIO`] per power, because samples are counted from 0.
const INTEGRATOR_GROWTH: f64 = 2.0 * LENGTH_RATIO as f64;
/// The least number of samples of the first part. Shorter records are not tested.
const MIN_FIRST_SAMPLES: usize = 4;

/// A fit that diverges from the data.
#[derive(Debug, Clone, PartialEq)]
pub struct Divergence {
    /// The diverging output with the largest residuals.
    pub output: String,
    /// The rms of its residuals about their mean, in units of sigma.
    pub normalised_rms: f64,
    /// The rms motion of the output about its mean, in units of sigma.
    pub normalised_motion: f64,
    /// The response of the output to an initial voltage grows by more than this factor.
    pub growth: f64,
}

/// Detects a fit that diverges. `None` if the fit is not poor or does not diverge.
///
/// A fit diverges if three conditions are true:
///
/// * Its rms residual is at least 5 sigma.
/// * The residuals of an output exceed half of the output's motion.
/// * The response of that output to an initial voltage grows more than a thousandfold.
///
/// The response of more than two integrators in series may grow more without divergence, so that the limit is then
/// higher.
///
/// # Errors
/// If the patch cannot be run along the records.
pub(crate) fn find_divergence(
    problem: &Problem,
    fitted: &FittedModel,
) -> Result<Option<Divergence>, ModelError> {
    if !fitted.is_poor() {
        return Ok(None);
    }
    let with_rms = |output: usize| {
        let residual_rms =
            rms_about_means(fitted.train.residuals.iter().map(|record| record[output].as_slice()));
        (output, residual_rms, normalised_motion(problem, output))
    };
    let mut unexplained: Vec<(usize, f64, f64)> = (0..problem.outputs.len()).map(with_rms).collect();
    unexplained.retain(|(_, residual_rms, motion)| *residual_rms > UNEXPLAINED_RATIO * motion);
    if unexplained.is_empty() {
        return Ok(None);
    }
    unexplained.sort_by(|a, b| b.1.total_cmp(&a.1));
    let model = problem.model(&fitted.variant, &problem.train, &problem.outputs)?;
    let responses = initial_state_responses(&problem.fit_problem(&model, &problem.train, false), fitted);
    let growth = MIN_GROWTH.max(INTEGRATOR_GROWTH.powi(model.initial.len() as i32 - 1));
    let is_diverging = |(output, ..): &(usize, f64, f64)| {
        responses.iter().any(|record| record[*output].iter().any(|column| has_growth(&column.1, growth)))
    };
    let diverging = unexplained.into_iter().find(is_diverging);
    Ok(diverging.map(|(output, normalised_rms, normalised_motion)| Divergence {
        output: problem.outputs[output].clone(),
        normalised_rms,
        normalised_motion,
        growth,
    }))
}

/// For every record and output the derivatives with respect to the initial voltages. Empty if the model cannot be run.
fn initial_state_responses(
    fit_problem: &FitProblem<'_>,
    fitted: &FittedModel,
) -> Vec<Vec<Vec<JacobianColumn>>> {
    let coordinates = fit_problem.coordinates(&fitted.train.estimate);
    let trajectories =
        fit_problem.trajectories(std::slice::from_ref(&coordinates)).pop().flatten().unwrap_or_default();
    trajectories
        .iter()
        .enumerate()
        .map(|(record, trajectory)| fit_problem.jacobian(&coordinates, record, trajectory))
        .collect()
}

/// Whether the maximum of a response grows by more than a factor from some first part of the record to a longer one.
///
/// Several first parts are tested, because an overload may stop the growth before the end. A first part in which the
/// response is zero, as behind a delay, does not count.
fn has_growth(response: &[f64], factor: f64) -> bool {
    let largest =
        |count: usize| response[..count].iter().fold(0.0, |largest: f64, value| largest.max(value.abs()));
    let first_counts = successors(Some(MIN_FIRST_SAMPLES), |count| Some(2 * count));
    let mut first_counts = first_counts.take_while(|count| LENGTH_RATIO * count <= response.len());
    first_counts.any(|count| largest(count) > 0.0 && largest(LENGTH_RATIO * count) > factor * largest(count))
}

#[cfg(test)]
mod tests {
    use crate::fit::base_fit::fit_base;
    use std::path::Path;

    use serde_json::json;

    use super::*;
    use crate::Experiment;
    use patchcord_core::patch::Edit;

    #[test]
    fn a_free_mass_moves_far_but_does_not_diverge() {
        let path = Path::new("tests/hidden/nothing/experiment.json");
        let mut experiment = Experiment::read(path).unwrap_or_else(|error| panic!("{error}"));
        let free = Edit::new("elements/SF/in", json!({"x1": ["BF"]}));
        experiment.patch = experiment.patch.with_edits("free.json", &[free]).unwrap();
        experiment.train[0].outputs[0].iter_mut().for_each(|value| *value *= 0.1);
        let problem = Problem::of(&experiment).unwrap();
        let base = fit_base(&problem, &experiment.patch, &[], 1).unwrap().unwrap();
        let residual_rms = rms_about_means(base.train.residuals.iter().map(|record| record[0].as_slice()));
        assert!(
            base.is_poor() && residual_rms > normalised_motion(&problem, 0),
            "{residual_rms} {}",
            normalised_motion(&problem, 0)
        );
        assert_eq!(find_divergence(&problem, &base).unwrap(), None);
    }

    #[test]
    fn only_growth_faster_than_that_of_integrators_in_series_is_divergence() {
        let times = || (0..160).map(f64::from);
        let exponential: Vec<f64> = times().map(|time| (0.1 * time).exp()).collect();
        let stopped: Vec<f64> =
            times().map(|time| if time < 70.0 { (0.2 * time).exp() } else { 0.0 }).collect();
        assert!(has_growth(&exponential, MIN_GROWTH) && has_growth(&stopped, MIN_GROWTH));
        let cubic: Vec<f64> = times().map(|time| time.powi(3)).collect();
        assert!(has_growth(&cubic, MIN_GROWTH) && !has_growth(&cubic, INTEGRATOR_GROWTH.powi(3)));
        // A delayed response, and a record that is too short to be tested.
        let late: Vec<f64> = times().map(|time| f64::from(time > 20.0)).collect();
        assert!(!has_growth(&late, MIN_GROWTH) && !has_growth(&[0.0, 1e-9, 1.0, 1e9], MIN_GROWTH));
    }
}
