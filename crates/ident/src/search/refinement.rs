//! Refinement of several effects that were added one after the other.
//!
//! Each effect was found while later ones were still missing. So [`refine`] repeats the search for each effect with
//! all the others in the patch: it is kept, replaced or dropped. [`backward_eliminate`] then drops effects that may
//! have zero strength.

use crate::effects::Library;
use crate::effects::attach::EffectPlacement;
use crate::effects::candidate::Candidate;
use crate::fit::extended_model::find_sites;
use crate::fit::extended_model::fit_trial;
use crate::fit::extended_model::{SkipReason, TrialRequest};
use crate::fit::fitted_model::FittedModel;
use crate::fit::intervals::with_profile_intervals;
use crate::fit::model::ModelError;
use crate::fit::problem::Problem;
use crate::fit::schedule::Effort;
use crate::fit::signal_extents::signal_extents;
use crate::search::progress::Progress;
use crate::search::round::MIN_EXPLAINED_FRACTION;
use crate::search::search_log::Action;
use crate::search::settings::SearchSettings;
use crate::search::state::SearchState;
use crate::search::trials::PreviousFit;
use crate::search::trials::run_round;

/// Repeats the search for every effect with all others in the patch. Each one is kept, replaced by a better one, or
/// dropped.
///
/// `is_confirmed` says that every effect was taken with all earlier ones in the patch. The last effect is then
/// repeated only if another one has changed.
///
/// # Errors
/// If the patch cannot be simulated with the drives of the records.
pub(crate) fn refine(
    problem: &Problem,
    base: &FittedModel,
    mut state: SearchState,
    is_confirmed: bool,
    settings: &SearchSettings<'_>,
    progress: &mut (impl FnMut(Progress) + Send),
) -> Result<SearchState, ModelError> {
    let (original, mut index, mut are_others_unchanged) = (state.clone(), 0, is_confirmed);
    while state.effects.len() > 1 && index < state.effects.len() {
        if are_others_unchanged && index + 1 == state.effects.len() {
            break;
        }
        let Some((others, without)) = without_effect(problem, base, &state, index, settings.library)? else {
            break;
        };
        let is_needed = without.residuals_are_coloured();
        let previous = PreviousFit::new(&state.effects[index], &state.model);
        let repeated = is_needed
            .then(|| run_round(problem, &without, &others, Some(&previous), settings, progress))
            .transpose()?;
        match repeated {
            Some(round) if round.taken => {
                are_others_unchanged &= round.trials[0].candidate.is_same(&state.effects[index]);
                state.replace_effect(index, others, round);
                index += 1;
            }
            // An effect that was confirmed once stays if the others leave far more without it.
            Some(_) if is_confirmed && state.model.explained_fraction(&without) > MIN_EXPLAINED_FRACTION => {
                index += 1
            }
            _ => {
                state = state.without(index, others, without);
                are_others_unchanged = false;
            }
        }
    }
    // The original fit of the same effects may be better than the repeated one.
    if state.has_same_effects(&original) && original.model.train.chi2 < state.model.train.chi2 {
        (state.effects, state.model) = (original.effects, original.model);
        state.log(Action::RestoreFit);
    }
    Ok(state)
}

/// Drops effects that may have zero strength, the least significant first. The effects that remain have 95 %
/// intervals.
///
/// # Errors
/// If the patch cannot be simulated with the drives of the records.
pub(crate) fn backward_eliminate(
    problem: &Problem,
    base: &FittedModel,
    mut state: SearchState,
    settings: &SearchSettings<'_>,
) -> Result<SearchState, ModelError> {
    let first = base.variant.fit.len();
    state.model = with_profile_intervals(problem, state.model, first)?;
    while let Some((index, others, without)) = least_significant(problem, base, &state, settings.library)? {
        state = state.without(index, others, without);
        state.model = with_profile_intervals(problem, state.model, first)?;
    }
    Ok(state)
}

/// The effect whose removal increases chi2 least, among those whose interval includes zero strength. Returns its
/// index, the other effects, and the patch with these.
///
/// An effect does not count if the residual is white only with it. Nor does it count if it has no rival and explains
/// more than half of the excess that the others leave. Returns None if no effect can be dropped, or if there is only
/// one.
fn least_significant(
    problem: &Problem,
    base: &FittedModel,
    state: &SearchState,
    library: &Library,
) -> Result<Option<(usize, Vec<Candidate>, FittedModel)>, ModelError> {
    let mut least: Option<(usize, Vec<Candidate>, FittedModel)> = None;
    let indices = if state.effects.len() > 1 { 0..state.effects.len() } else { 0..0 };
    for index in indices.filter(|index| can_be_zero(&state.effects[*index], &state.model)) {
        let Some((others, without)) = without_effect(problem, base, state, index, library)? else { continue };
        let is_white_only_with = !state.model.residuals_are_coloured() && without.residuals_are_coloured();
        let explains_much = state.model.explained_fraction(&without) > MIN_EXPLAINED_FRACTION
            && state.rounds[index].tied == 1;
        let is_essential = is_white_only_with || explains_much;
        let is_less = least.as_ref().is_none_or(|least| without.train.chi2 < least.2.train.chi2);
        if is_less && !is_essential {
            least = Some((index, others, without));
        }
    }
    Ok(least)
}

/// The other effects and the patch with them, without the effect at an index. None if one of them cannot be attached
/// any more.
fn without_effect(
    problem: &Problem,
    base: &FittedModel,
    state: &SearchState,
    index: usize,
    library: &Library,
) -> Result<Option<(Vec<Candidate>, FittedModel)>, ModelError> {
    let others = state.effects.iter().enumerate().filter(|(other, _)| *other != index);
    let others: Vec<&Candidate> = others.map(|(_, effect)| effect).collect();
    fit_effects(problem, base, &others, &state.model, library)
}

/// Attaches effects to a patch and fits it after each. The fits start at the values of the effects in `previous`.
/// Returns None if an effect cannot be attached any more.
fn fit_effects(
    problem: &Problem,
    base: &FittedModel,
    effects: &[&Candidate],
    previous: &FittedModel,
    library: &Library,
) -> Result<Option<(Vec<Candidate>, FittedModel)>, ModelError> {
    let (mut candidates, mut model) = (Vec::new(), base.clone());
    model.variant.steps = model.variant.steps.max(previous.variant.steps);
    for effect in effects {
        let sites = find_sites(problem, &model)?;
        let all = library.iter().flat_map(|effect| EffectPlacement::all(effect, &sites));
        let Some(placement) = all.into_iter().find(|placement| effect.is_placed_as(placement)) else {
            return Ok(None);
        };
        let peaks = signal_extents(problem, &model)?;
        let known = PreviousFit::new(effect, previous).values;
        let request = TrialRequest {
            effort: Effort::FULL,
            target_chi2: model.train.chi2,
            previous: None,
            effect_values: Some(&known),
        };
        match fit_trial(problem, &model, &placement, &peaks, request) {
            Ok((candidate, next)) => {
                candidates.push(candidate);
                model = next;
            }
            Err(SkipReason::Model(error)) => return Err(error),
            Err(SkipReason::NoScale | SkipReason::NotRunnable) => return Ok(None),
        }
    }
    Ok(Some((candidates, model)))
}

/// Whether the intervals of an effect include zero strength. All parameters with the unit of the first one are
/// strengths, for example the amplitudes of a sine and a cosine. False if the effect has no value of zero strength,
/// or no intervals.
pub(crate) fn can_be_zero(effect: &Candidate, model: &FittedModel) -> bool {
    let parameters = &effect.graft.parameters;
    let Some((zero, first)) = effect.null_value.zip(parameters.first()) else { return false };
    parameters.iter().filter(|parameter| parameter.unit == first.unit).all(|parameter| {
        let index = model.variant.fit.iter().position(|name| *name == parameter.name);
        let uncertainty = index.and_then(|index| model.uncertainties.get(index));
        uncertainty.is_some_and(|known| known.interval[0] <= zero && zero <= known.interval[1])
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Experiment;
    use crate::fit::base_fit::fit_base;

    #[test]
    #[ignore = "takes half a minute"]
    fn an_effect_that_may_have_zero_strength_is_dropped() {
        let path = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/hidden/bias/experiment.json");
        let experiment = Experiment::read(path).unwrap();
        let (problem, library) = (Problem::of(&experiment).unwrap(), Library::shipped());
        let settings = SearchSettings::new(&library).with_threads(2);
        let base = fit_base(&problem, &experiment.patch, &experiment.fit, 1).unwrap().unwrap();
        let mut state = SearchState::new(base.clone());
        for _ in 0..2 {
            let round =
                run_round(&problem, &state.model, &state.effects, None, &settings, &mut |_| ()).unwrap();
            let best = round.trials[0].clone();
            state.rounds.push(round);
            state.effects.push(best.candidate);
            state.model = best.model;
        }
        let taken = [true, false];
        assert_eq!(state.rounds.iter().map(|round| round.taken).collect::<Vec<_>>(), taken);
        let state = backward_eliminate(&problem, &base, state, &settings).unwrap();
        let names: Vec<&str> = state.effects.iter().map(|candidate| candidate.effect.as_str()).collect();
        assert_eq!((names, state.rounds.len()), (vec!["constant-bias"], 1));
        let last = &state.search_log.last().unwrap().action;
        assert!(matches!(last, Action::Drop(_)), "{:?}", state.search_log);
        assert!(state.model.uncertainties.iter().all(|known| known.error.is_finite()));
    }
}
