//! A patch that runs away from the data, as where a sign in one of its loops is wrong: what it lacks cannot be told from there.

use std::iter::successors;

use crate::fit::fitted_model::Stage;
use crate::fit::levenberg_marquardt::Task;
use crate::fit::model::ModelError;
use crate::fit::normal_equations::Column;
use crate::fit::problem::Problem;
use crate::residuals::output_motion::HARDLY;
use crate::residuals::output_motion::motion_over_noise;
use crate::statistics::descriptive::rms_about_means;

/// What little is changed at the beginning of a record grows by more than this factor where a patch runs away,
const GROWTH: f64 = 1e3;
/// from the first part of a record to so many times that.
const LONGER: usize = 16;
/// Integrators in a row that hold each at its initial voltage let a change grow by a power of that number, too, or of less than this, as
/// samples are counted from 0, and do not run away.
const IN_A_ROW: f64 = 2.0 * LONGER as f64;
/// The first part has so many samples at least; of a record too short for that nothing is said.
const LEAST_SAMPLES: usize = 4;

/// That a patch runs away from the data.
#[derive(Debug, Clone, PartialEq)]
pub struct Runaway {
    /// The output from which it goes farthest.
    pub output: String,
    /// What is left of that, rms about the mean over its noise,
    pub left: f64,
    /// and how far it moves.
    pub moves: f64,
    /// By more than this factor a change of an initial voltage grows in it.
    pub growth: f64,
}

/// That a stage far from the data runs away from an output that it hardly explains.
///
/// # Errors
/// When the patch cannot be run beside the records.
pub(crate) fn divergence_of(problem: &Problem, stage: &Stage) -> Result<Option<Runaway>, ModelError> {
    if !stage.is_far() {
        return Ok(None);
    }
    let against = |output: usize| {
        let left = rms_about_means(stage.train.residuals.iter().map(|record| record[output].as_slice()));
        (output, left, motion_over_noise(problem, output))
    };
    let mut lost: Vec<(usize, f64, f64)> = (0..problem.outputs.len()).map(against).collect();
    lost.retain(|(_, left, moves)| *left > HARDLY * moves);
    if lost.is_empty() {
        return Ok(None);
    }
    lost.sort_by(|a, b| b.1.total_cmp(&a.1));
    let model = problem.model(&stage.version, &problem.train, &problem.outputs)?;
    let responses = responses(&problem.task(&model, &problem.train, false), stage);
    let growth = GROWTH.max(IN_A_ROW.powi(model.initial.len() as i32 - 1));
    let is_away = |(output, ..): &(usize, f64, f64)| {
        responses.iter().any(|record| record[*output].iter().any(|own| grows(&own.1, growth)))
    };
    let away = lost.into_iter().find(is_away);
    Ok(away.map(|(output, left, moves)| Runaway {
        output: problem.outputs[output].clone(),
        left,
        moves,
        growth,
    }))
}

/// What initial voltages do to the outputs of every record; nothing where the patch cannot be run.
fn responses(task: &Task<'_>, stage: &Stage) -> Vec<Vec<Vec<Column>>> {
    let at = task.shares(&stage.train.point);
    let courses = task.courses(std::slice::from_ref(&at)).pop().flatten().unwrap_or_default();
    courses.iter().enumerate().map(|(record, course)| task.responses(&at, record, course)).collect()
}

/// Whether a response grows by more than a factor from some first part of its record to a longer one: by its end it may have come to where
/// amplifiers stop. One that is nothing at first, as behind a delay, only begins later.
fn grows(response: &[f64], factor: f64) -> bool {
    let largest = |count: usize| response[..count].iter().fold(0.0, |most: f64, own| most.max(own.abs()));
    let firsts = successors(Some(LEAST_SAMPLES), |first| Some(2 * first));
    let mut firsts = firsts.take_while(|first| LONGER * first <= response.len());
    firsts.any(|first| largest(first) > 0.0 && largest(LONGER * first) > factor * largest(first))
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
    fn a_mass_that_nothing_holds_back_goes_far_and_does_not_run_away() {
        let path = Path::new("tests/hidden/nothing/experiment.json");
        let mut experiment = Experiment::read(path).unwrap_or_else(|error| panic!("{error}"));
        let free = Edit::new("elements/SF/in", json!({"x1": ["BF"]}));
        experiment.patch = experiment.patch.edited("free.json", &[free]).unwrap();
        experiment.train[0].outputs[0].iter_mut().for_each(|value| *value *= 0.1);
        let problem = Problem::of(&experiment).unwrap();
        let base = fit_base(&problem, &experiment.patch, &[], 1).unwrap().unwrap();
        let left = rms_about_means(base.train.residuals.iter().map(|record| record[0].as_slice()));
        assert!(
            base.is_far() && left > motion_over_noise(&problem, 0),
            "{left} {}",
            motion_over_noise(&problem, 0)
        );
        assert_eq!(divergence_of(&problem, &base).unwrap(), None);
    }

    #[test]
    fn what_grows_by_more_than_integrators_in_a_row_runs_away() {
        let times = || (0..160).map(f64::from);
        let exponential: Vec<f64> = times().map(|time| (0.1 * time).exp()).collect();
        let stopped: Vec<f64> =
            times().map(|time| if time < 70.0 { (0.2 * time).exp() } else { 0.0 }).collect();
        assert!(grows(&exponential, GROWTH) && grows(&stopped, GROWTH));
        let cubic: Vec<f64> = times().map(|time| time.powi(3)).collect();
        assert!(grows(&cubic, GROWTH) && !grows(&cubic, IN_A_ROW.powi(3)));
        // What only begins later, and what is too short to tell.
        let late: Vec<f64> = times().map(|time| f64::from(time > 20.0)).collect();
        assert!(!grows(&late, GROWTH) && !grows(&[0.0, 1e-9, 1.0, 1e9], GROWTH));
    }
}
