//! Effects that were taken one after the other, each looked at again beside all the others: another may be better now, or none be
//! needed.

use super::attached::Attached;
use super::candidate::Candidate;
use super::come::Come;
use super::effect::Library;
use super::effort::Effort;
use super::model::ModelError;
use super::problem::Problem;
use super::progress::Progress;
use super::round::LEAST_CLOSED;
use super::search::Means;
use super::stage::{Asked, Stage, Untried};

impl Problem {
    /// Looks at every effect again, beside all the others: another may be better now, or none be needed; at the last of them only
    /// where the others, which stood when it was found, do not stand any more.
    pub(super) fn settled(
        &self,
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
            let Some((kept, without)) = self.all_but(base, &come, place, with.library)? else { break };
            let is_needed = without.leaves_structure();
            let found = Found::of(&come.effects[place], &come.stage);
            let again =
                is_needed.then(|| self.round(&without, &kept, Some(&found), with, progress)).transpose()?;
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
            come.did("the same, as it was before that");
        }
        Ok(come)
    }

    /// Drops effects of which the data do not tell that they are there; what stays has its intervals.
    pub(super) fn shed(&self, base: &Stage, mut come: Come, with: &Means<'_>) -> Result<Come, ModelError> {
        let first = base.version.fit.len();
        come.stage = self.with_intervals(come.stage, first, with.threads)?;
        while let Some((place, kept, without)) = self.needless(base, &come, with.library)? {
            come.less(place, kept, without);
            come.stage = self.with_intervals(come.stage, first, with.threads)?;
        }
        Ok(come)
    }

    /// Of several effects the place of the one that is missed least, and the others without it, among those whose strength may be
    /// none, unless only with it noise is left, or it alone closes much of what the others leave.
    fn needless(
        &self,
        base: &Stage,
        come: &Come,
        library: &Library,
    ) -> Result<Option<(usize, Vec<Candidate>, Stage)>, ModelError> {
        let mut least: Option<(usize, Vec<Candidate>, Stage)> = None;
        let places = if come.effects.len() > 1 { 0..come.effects.len() } else { 0..0 };
        for place in places.filter(|place| may_be_none(&come.effects[*place], &come.stage)) {
            let Some((kept, without)) = self.all_but(base, come, place, library)? else { continue };
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
    fn all_but(
        &self,
        base: &Stage,
        come: &Come,
        place: usize,
        library: &Library,
    ) -> Result<Option<(Vec<Candidate>, Stage)>, ModelError> {
        let others = come.effects.iter().enumerate().filter(|(other, _)| *other != place);
        let others: Vec<&Candidate> = others.map(|(_, own)| own).collect();
        self.joined(base, &others, &come.stage, library)
    }

    /// A stage with several effects wired in one after the other, which begin as they were found; nothing where one does not fit
    /// any more.
    fn joined(
        &self,
        base: &Stage,
        effects: &[&Candidate],
        found: &Stage,
        library: &Library,
    ) -> Result<Option<(Vec<Candidate>, Stage)>, ModelError> {
        let (mut kept, mut stage) = (Vec::new(), base.clone());
        stage.version.steps = stage.version.steps.max(found.version.steps);
        for effect in effects {
            let sites = self.sites(&stage)?;
            let all = library.iter().flat_map(|own| Attached::all(own, &sites));
            let Some(attached) = all.into_iter().find(|attached| effect.is(attached)) else {
                return Ok(None);
            };
            let peaks = self.peaks(&stage)?;
            let known = Found::of(effect, found).values;
            let asked =
                Asked { effort: Effort::FULL, wanted: stage.train.chi2, before: None, known: Some(&known) };
            match self.attempt(&stage, &attached, &peaks, asked) {
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
}

/// Whether an effect may have no strength at all, as far as the data tell: each of its parameters that counts as its first does, as
/// both amplitudes of a sine and a cosine.
pub(super) fn may_be_none(effect: &Candidate, stage: &Stage) -> bool {
    let parameters = &effect.graft.parameters;
    let Some((none, first)) = effect.none.zip(parameters.first()) else { return false };
    parameters.iter().filter(|own| own.unit == first.unit).all(|own| {
        let place = stage.version.fit.iter().position(|name| *name == own.name);
        let known = place.and_then(|place| stage.known.get(place));
        known.is_some_and(|known| known.interval[0] <= none && none <= known.interval[1])
    })
}

/// An effect, and the values that it came to beside others.
pub(super) struct Found<'a> {
    effect: &'a Candidate,
    values: Vec<f64>,
}

impl<'a> Found<'a> {
    fn of(effect: &'a Candidate, stage: &Stage) -> Self {
        Found { effect, values: stage.brought(effect).map(|(_, value, _)| value).collect() }
    }

    /// Whether this is it.
    pub fn is(&self, attached: &Attached<'_>) -> bool {
        self.effect.is(attached)
    }

    /// Its values where an effect is the same.
    pub fn values_of(&self, attached: &Attached<'_>) -> Option<&[f64]> {
        self.is(attached).then_some(&*self.values)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Experiment;

    #[test]
    #[ignore = "takes half a minute"]
    fn what_may_be_none_is_dropped() {
        let path = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/hidden/bias/experiment.json");
        let experiment = Experiment::read(path.as_ref()).unwrap();
        let (problem, library) = (Problem::of(&experiment).unwrap(), Library::shipped());
        let with = Means { library: &library, threads: 2, seed: 1 };
        let base = problem.base(&experiment.patch, &experiment.fit, 1).unwrap().unwrap();
        let mut come = Come::begun(base.clone());
        for _ in 0..2 {
            let round = problem.round(&come.stage, &come.effects, None, &with, &mut |_| ()).unwrap();
            let best = round.trials[0].clone();
            come.rounds.push(round);
            come.effects.push(best.candidate);
            come.stage = best.stage;
        }
        let taken = [true, false];
        assert_eq!(come.rounds.iter().map(|round| round.taken).collect::<Vec<_>>(), taken);
        let kept = problem.shed(&base, come, &with).unwrap();
        let names: Vec<&str> = kept.effects.iter().map(|own| own.effect.as_str()).collect();
        assert_eq!((names, kept.rounds.len()), (vec!["constant-bias"], 1));
        assert!(kept.way.last().unwrap().did.ends_with(" is dropped"), "{:?}", kept.way);
        assert!(kept.stage.known.iter().all(|known| known.error.is_finite()));
    }
}
