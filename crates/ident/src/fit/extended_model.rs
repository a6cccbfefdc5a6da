//! A fitted model with one more effect wired in.

use crate::effects::attach::Attached;
use crate::effects::candidate::Candidate;
use crate::effects::sites::Sites;
use crate::fit::estimate::Point;
use crate::fit::estimation::Beginning;
use crate::fit::estimation::fit_variant;
use crate::fit::fitted_model::{Stage, Version};
use crate::fit::model::ModelError;
use crate::fit::peaks::Peaks;
use crate::fit::problem::Problem;
use crate::fit::schedule::{Effort, Starts};

/// Why an effect is not tried at a place.
#[derive(Debug, thiserror::Error)]
pub enum Untried {
    /// There is nothing to find its size by.
    #[error("there is nothing to measure it by: what it acts on stays at zero, or no frequency stands out")]
    Idle,
    /// No fit can begin.
    #[error("the patch with it can be run from none of its starts")]
    NotRun,
    /// The patch with it is none.
    #[error(transparent)]
    Model(#[from] ModelError),
}

/// What is asked of a trial.
#[derive(Debug, Clone, Copy)]
pub struct Asked<'a> {
    /// How much is done.
    pub effort: Effort,
    /// Below what the sum of squares is to come.
    pub wanted: f64,
    /// Where the same trial came to with less effort.
    pub before: Option<&'a Stage>,
    /// Values of its parameters known from elsewhere, if there are any.
    pub known: Option<&'a [f64]>,
}

/// Wires one more effect into a stage: as a candidate, and as the version of the patch that is fitted.
///
/// # Errors
/// When the effect does not fit.
pub(crate) fn attach_effect(
    stage: &Stage,
    attached: &Attached<'_>,
    peaks: &Peaks,
) -> Result<(Candidate, Version), Untried> {
    let largest = peaks.at(&attached.place);
    let candidate = Candidate::new(attached, stage.version.patch(), &largest, &peaks.spectrum);
    let candidate = candidate.map_err(ModelError::from)?.ok_or(Untried::Idle)?;
    let graft = &candidate.graft;
    let brought = graft.parameters.iter().map(|parameter| parameter.name.clone());
    let fit = stage.version.fit.iter().cloned().chain(brought).collect();
    let free = stage.version.free.iter().chain(&graft.free).cloned().collect();
    let steps = stage.version.steps.max(candidate.steps(peaks.interval));
    let version = Version::new(graft.patch.clone(), fit, free, steps);
    Ok((candidate, version))
}

/// Wires one more effect into a stage, and fits everything anew, as long as there is hope to come to what is wanted.
///
/// # Errors
/// When the effect does not fit, or the patch with it cannot be run beside the records.
pub fn fit_trial(
    problem: &Problem,
    stage: &Stage,
    attached: &Attached<'_>,
    peaks: &Peaks,
    asked: Asked<'_>,
) -> Result<(Candidate, Stage), Untried> {
    let (candidate, version) = attach_effect(stage, attached, peaks)?;
    let free = candidate.graft.free.len();
    let begun = |home: &Point, before: Option<&Point>| {
        let with = |start: &Vec<f64>| Point {
            knobs: [home.knobs.as_slice(), start].concat(),
            initial: home.initial.iter().map(|own| [own.as_slice(), &vec![0.0; free]].concat()).collect(),
            offsets: home.offsets.clone(),
        };
        let beside = before.into_iter().flat_map(|before| {
            let (others, own) = before.knobs.split_at(home.knobs.len());
            let moved = candidate.beside(own).into_iter();
            moved.map(move |own| Point { knobs: [others, &own].concat(), ..before.clone() })
        });
        let known = asked.known.map(|known| with(&candidate.within(known)));
        Starts {
            sure: candidate.without.iter().map(with).collect(),
            found: before.cloned().or(known),
            others: candidate.starts.iter().map(with).chain(beside).collect(),
        }
    };
    let from = Beginning {
        starts: begun(&stage.train.point, asked.before.map(|before| &before.train.point)),
        in_pieces: stage
            .in_pieces
            .as_ref()
            .map(|home| begun(home, asked.before.and_then(|before| before.in_pieces.as_ref()))),
        held: Some(&stage.test.point.initial),
        seen: asked.before.map(|before| before.seen.clone()).unwrap_or_default(),
        effort: asked.effort,
    };
    let stage = fit_variant(problem, version, from, asked.wanted)?.ok_or(Untried::NotRun)?;
    Ok((candidate, stage))
}

pub(crate) fn sites_of(problem: &Problem, stage: &Stage) -> Result<Sites, ModelError> {
    Ok(Sites::fed(stage.version.patch(), &problem.drives)?)
}

/// An effect that was not tried at a place.
#[derive(Debug, Clone)]
pub struct LeftOut {
    /// The effect.
    pub effect: String,
    /// The element that it would act on.
    pub junction: String,
    /// Why it was not tried.
    pub why: String,
}

impl LeftOut {
    pub(crate) fn of(attached: &Attached<'_>, why: &Untried) -> LeftOut {
        let effect = attached.effect.name.clone();
        LeftOut { effect, junction: attached.junction().to_owned(), why: why.to_string() }
    }
}
