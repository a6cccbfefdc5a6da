//! Data that cannot judge a patch: what leaves nothing but noise is then no proof that nothing is missing.

use crate::data::record::Record;
use crate::design::detectability::detection_limit::Limit;
use crate::fit::coloured_residual::NotWhite;
use crate::fit::estimate::{Point, over_sigma, squares};
use crate::fit::fitted_model::{COLOURED, Stage};
use crate::fit::model::ModelError;
use crate::fit::problem::Problem;
use crate::fit::validation::any_has_changed;
use crate::fit::validation::is_more;
use crate::residuals::divergence::Runaway;
use crate::residuals::misspecification::Mistold;
use crate::residuals::residual_analysis::SlowNoise;
use crate::search::round::Round;
use crate::statistics::descriptive::{about_mean, mean};
use crate::statistics::whiteness::colour;

/// Why data cannot judge a patch.
#[derive(Debug, Clone, PartialEq)]
pub enum Blind {
    /// They are no more than the numbers that are fitted.
    Few,
    /// A constant explains them as well as the patch does, or they look like noise about one.
    Still,
    /// What is left looks like noise, but of this output it is so many times its noise.
    Loud(String, f64),
    /// What is left is no more than noise, but not white.
    NotWhite(NotWhite),
    /// What is left goes like slow noise of a sensor.
    Slow(SlowNoise),
    /// What explains the training data does not explain those held back: so many times the noise is left of them.
    Changed(f64),
    /// No effect could be tried.
    Nowhere,
    /// No effect that was tried would show, however strong.
    Effects,
    /// The patch explains them with values beyond their ranges.
    Beyond,
    /// The patch explains them once something is told otherwise.
    Mistold(Mistold),
    /// The patch runs away from them.
    Runaway(Runaway),
}

/// From so many samples on what looks like noise is some.
const ENOUGH: usize = 100;
/// What looks like noise is no more than so many times as much.
pub(crate) const LOUD: f64 = 2.0;

/// Why the data cannot judge a patch that leaves nothing but noise; nothing where they can.
///
/// # Errors
/// When the patch cannot be run beside the records.
pub(crate) fn why_inconclusive(
    problem: &Problem,
    base: &Stage,
    rounds: &[Round],
    limits: &[Limit],
) -> Result<Option<Blind>, ModelError> {
    if base.train.count <= base.train.free {
        return Ok(Some(Blind::Few));
    }
    let needed = rounds.first().map_or(0.0, |round| round.needed);
    if motion_of(problem, base) < needed * base.memory {
        return Ok(Some(Blind::Still));
    }
    let left = problem.outputs.iter().enumerate().map(|(place, name)| (name, over_sigma(&base.train, place)));
    if let Some((output, left)) = left.max_by(|a, b| a.1.total_cmp(&b.1)).filter(|own| own.1 > LOUD) {
        return Ok(Some(Blind::Loud(output.clone(), left)));
    }
    if any_has_changed(problem, base) && !holds_for_all(problem, base)? {
        return Ok(Some(Blind::Changed(base.test.over_noise())));
    }
    if rounds.iter().all(|round| round.trials.is_empty()) {
        return Ok(Some(Blind::Nowhere));
    }
    Ok((!limits.iter().any(Limit::is_seen)).then_some(Blind::Effects))
}

/// Whether the training data look like noise about a constant; few look like that that are none.
pub(crate) fn is_noise_alone(problem: &Problem) -> bool {
    let over_noise = |(track, sigma): (&Vec<f64>, &f64)| {
        about_mean(track).into_iter().map(|own| own / sigma).collect::<Vec<f64>>()
    };
    let of = |record: &Record| record.outputs.iter().zip(&problem.sigma).map(over_noise).collect();
    let all: Vec<Vec<Vec<f64>>> = problem.train.iter().map(of).collect();
    let is_enough = all.iter().flatten().all(|track| track.len() >= ENOUGH);
    let is_quiet = |output: usize| mean(&squares(&all, output)) < LOUD * LOUD;
    is_enough && (0..problem.outputs.len()).all(is_quiet) && colour(&all) < COLOURED
}

/// Whether the patch explains all data when it is fitted to all: what training left open may have led it astray in what was
/// held back, as where motion sticks.
fn holds_for_all(problem: &Problem, base: &Stage) -> Result<bool, ModelError> {
    let records = [problem.train.as_slice(), &problem.test].concat();
    let initial = [base.train.point.initial.as_slice(), &base.test.point.initial].concat();
    let model = problem.model(&base.version, &records, &problem.outputs)?;
    let start = Point { initial, ..base.train.point.clone() };
    let Some(fitted) = problem.task(&model, &records, true).fit(&start) else { return Ok(false) };
    let (train, test) = fitted.residuals.split_at(problem.train.len());
    let is_explained = |output: usize| {
        let was = squares(&base.train.residuals, output);
        let parts = [train, test].map(|part| squares(part, output));
        parts.iter().all(|is| !is_more(&was, is, base.memory))
    };
    Ok((0..problem.outputs.len()).all(is_explained))
}

/// What the patch explains of the training data beside a constant, in squares over the noise.
fn motion_of(problem: &Problem, base: &Stage) -> f64 {
    let tracks = problem.train.iter().zip(&base.train.residuals).flat_map(|(record, left)| {
        record.outputs.iter().zip(left).zip(&problem.sigma).map(|((data, left), sigma)| {
            let made = data.iter().zip(left).map(|(datum, left)| datum / sigma - left);
            made.filter(|own| !own.is_nan()).collect::<Vec<f64>>()
        })
    });
    let moved = |track: Vec<f64>| {
        let mean = mean(&track);
        track.iter().map(|own| (own - mean).powi(2)).sum::<f64>()
    };
    tracks.map(moved).sum()
}
