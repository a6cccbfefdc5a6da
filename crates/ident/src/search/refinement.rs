//! Effects that were taken one after the other, each looked at again beside all the others: another may be better now, or none be
//! needed.

use crate::effects::Library;
use crate::effects::attach::Attached;
use crate::effects::candidate::Candidate;
use crate::fit::extended_model::fit_trial;
use crate::fit::extended_model::sites_of;
use crate::fit::extended_model::{Asked, Untried};
use crate::fit::fitted_model::Stage;
use crate::fit::intervals::with_intervals;
use crate::fit::model::ModelError;
use crate::fit::peaks::peaks_of;
use crate::fit::problem::Problem;
use crate::fit::schedule::Effort;
use crate::search::means::Means;
use crate::search::progress::Progress;
use crate::search::round::LEAST_CLOSED;
use crate::search::search_log::Action;
use crate::search::state::Come;
use crate::search::trials::Found;
use crate::search::trials::run_round;

/// Looks at every effect again, beside all the others: another may be better now, or none be needed; at the last of them only
/// where the others, which stood when it was found, do not stand any more.
pub(crate) fn refine(
    problem: &Problem,
    base: &Stage,
    mut come: Come,
    mut others_stand: bool,
    with: &Means<'_>,
    progress: &mut impl FnMut(Progress),
) -> Result<Come, ModelError> {
    let (begun, mut place, have_stood) = (come.clone(), 0, others_stand);
    while come.effects.len() > 1 && place < come.effects.len() {
        if others_stand && place + 1 == come.effects.len() {
            break;
        }
        let Some((kept, without)) = without_effect(problem, base, &come, place, with.library)? else { break };
        let is_needed = without.leaves_structure();
        let found = Found::of(&come.effects[place], &come.stage);
        let again = is_needed
            .then(|| run_round(problem, &without, &kept, Some(&found), with, progress))
            .transpose()?;
        match again {
            Some(again) if again.taken => {
                others_stand &= again.trials[0].candidate.is_same(&come.effects[place]);
                come.replace(place, kept, again);
                place += 1;
            }
            // Others that leave far more without it do not make needless what stood when it was found.
            Some(_) if have_stood && come.stage.closed(&without) > LEAST_CLOSED => place += 1,
            _ => {
                come.less(place, kept, without);
                others_stand = false;
            }
        }
    }
    // The same effects may have come to less before they were looked at one by one.
    if come.has_the_effects_of(&begun) && begun.stage.train.chi2 < come.stage.train.chi2 {
        (come.effects, come.stage) = (begun.effects, begun.stage);
        come.did(Action::RestoreFit);
    }
    Ok(come)
}

/// Drops effects of which the data do not tell that they are there; what stays has its intervals.
pub(crate) fn backward_eliminate(
    problem: &Problem,
    base: &Stage,
    mut come: Come,
    with: &Means<'_>,
) -> Result<Come, ModelError> {
    let first = base.version.fit.len();
    come.stage = with_intervals(problem, come.stage, first, with.threads)?;
    while let Some((place, kept, without)) = least_significant(problem, base, &come, with.library)? {
        come.less(place, kept, without);
        come.stage = with_intervals(problem, come.stage, first, with.threads)?;
    }
    Ok(come)
}

/// Of several effects the place of the one that is missed least, and the others without it, among those whose strength may be
/// none, unless only with it noise is left, or it alone closes much of what the others leave.
fn least_significant(
    problem: &Problem,
    base: &Stage,
    come: &Come,
    library: &Library,
) -> Result<Option<(usize, Vec<Candidate>, Stage)>, ModelError> {
    let mut least: Option<(usize, Vec<Candidate>, Stage)> = None;
    let places = if come.effects.len() > 1 { 0..come.effects.len() } else { 0..0 };
    for place in places.filter(|place| may_be_none(&come.effects[*place], &come.stage)) {
        let Some((kept, without)) = without_effect(problem, base, come, place, library)? else { continue };
        let leaves_noise = !come.stage.leaves_structure() && without.leaves_structure();
        let closes_much = come.stage.closed(&without) > LEAST_CLOSED && come.rounds[place].tied == 1;
        let is_vouched_for = leaves_noise || closes_much;
        let is_less = least.as_ref().is_none_or(|own| without.train.chi2 < own.2.train.chi2);
        if is_less && !is_vouched_for {
            least = Some((place, kept, without));
        }
    }
    Ok(least)
}

/// The patch with all effects but the one in a place, and these; nothing where one of them does not fit any more.
fn without_effect(
    problem: &Problem,
    base: &Stage,
    come: &Come,
    place: usize,
    library: &Library,
) -> Result<Option<(Vec<Candidate>, Stage)>, ModelError> {
    let others = come.effects.iter().enumerate().filter(|(other, _)| *other != place);
    let others: Vec<&Candidate> = others.map(|(_, own)| own).collect();
    fit_effects(problem, base, &others, &come.stage, library)
}

/// A stage with several effects wired in one after the other, which begin as they were found; nothing where one does not fit
/// any more.
fn fit_effects(
    problem: &Problem,
    base: &Stage,
    effects: &[&Candidate],
    found: &Stage,
    library: &Library,
) -> Result<Option<(Vec<Candidate>, Stage)>, ModelError> {
    let (mut kept, mut stage) = (Vec::new(), base.clone());
    stage.version.steps = stage.version.steps.max(found.version.steps);
    for effect in effects {
        let sites = sites_of(problem, &stage)?;
        let all = library.iter().flat_map(|own| Attached::all(own, &sites));
        let Some(attached) = all.into_iter().find(|attached| effect.is(attached)) else {
            return Ok(None);
        };
        let peaks = peaks_of(problem, &stage)?;
        let known = Found::of(effect, found).values;
        let asked =
            Asked { effort: Effort::FULL, wanted: stage.train.chi2, before: None, known: Some(&known) };
        match fit_trial(problem, &stage, &attached, &peaks, asked) {
            Ok((candidate, next)) => {
                kept.push(candidate);
                stage = next;
            }
            Err(Untried::Model(error)) => return Err(error),
            Err(Untried::Idle | Untried::NotRun) => return Ok(None),
        }
    }
    Ok(Some((kept, stage)))
}

/// Whether an effect may have no strength at all, as far as the data tell: each of its parameters that counts as its first does, as
/// both amplitudes of a sine and a cosine.
pub(crate) fn may_be_none(effect: &Candidate, stage: &Stage) -> bool {
    let parameters = &effect.graft.parameters;
    let Some((none, first)) = effect.none.zip(parameters.first()) else { return false };
    parameters.iter().filter(|own| own.unit == first.unit).all(|own| {
        let place = stage.version.fit.iter().position(|name| *name == own.name);
        let known = place.and_then(|place| stage.known.get(place));
        known.is_some_and(|known| known.interval[0] <= none && none <= known.interval[1])
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Experiment;
    use crate::fit::base_fit::fit_base;

    #[test]
    #[ignore = "takes half a minute"]
    fn what_may_be_none_is_dropped() {
        let path = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/hidden/bias/experiment.json");
        let experiment = Experiment::read(path.as_ref()).unwrap();
        let (problem, library) = (Problem::of(&experiment).unwrap(), Library::shipped());
        let with = Means { library: &library, threads: 2, seed: 1 };
        let base = fit_base(&problem, &experiment.patch, &experiment.fit, 1).unwrap().unwrap();
        let mut come = Come::begun(base.clone());
        for _ in 0..2 {
            let round = run_round(&problem, &come.stage, &come.effects, None, &with, &mut |_| ()).unwrap();
            let best = round.trials[0].clone();
            come.rounds.push(round);
            come.effects.push(best.candidate);
            come.stage = best.stage;
        }
        let taken = [true, false];
        assert_eq!(come.rounds.iter().map(|round| round.taken).collect::<Vec<_>>(), taken);
        let kept = backward_eliminate(&problem, &base, come, &with).unwrap();
        let names: Vec<&str> = kept.effects.iter().map(|own| own.effect.as_str()).collect();
        assert_eq!((names, kept.rounds.len()), (vec!["constant-bias"], 1));
        assert!(matches!(kept.way.last().unwrap().did, Action::Drop(_)), "{:?}", kept.way);
        assert!(kept.stage.known.iter().all(|known| known.error.is_finite()));
    }
}
