//! The search: every effect at every place that it fits, everything refitted, the best confirmed on what was held back; and
//! again, until what is left looks like noise or nothing more can be named.

use super::candidate::Candidate;
use super::effect::Library;
use super::graft::Attached;
use super::limits::{Blind, Limit};
use super::model::ModelError;
use super::progress::{Part, Progress};
use super::score::{Advantage, advantage};
use super::separate::Separating;
use super::site::Sites;
use super::stage::{Effort, Problem, Stage};
use super::whereabouts::Whereabouts;
use crate::circuit::Circuit;
use crate::patch::Patch;
use crate::pool;

/// What was found out.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Verdict {
    /// These effects are missing.
    Named,
    /// One of several is missing, and the data cannot tell which.
    Ambiguous,
    /// The patch explains the data.
    NothingMissing,
    /// Something is missing that the library does not have.
    UnknownEffect,
    /// The data do not bear a judgement.
    CannotJudge,
}

impl Verdict {
    /// The word for it in reports.
    pub fn as_str(self) -> &'static str {
        match self {
            Verdict::Named => "named",
            Verdict::Ambiguous => "ambiguous",
            Verdict::NothingMissing => "nothing-missing",
            Verdict::UnknownEffect => "unknown-effect",
            Verdict::CannotJudge => "cannot-judge",
        }
    }
}

/// An effect wired in and fitted.
#[derive(Debug, Clone)]
pub struct Trial {
    /// The effect at its place.
    pub candidate: Candidate,
    /// The patch with it, fitted.
    pub stage: Stage,
    /// By how much it is better than the patch without it: see [`Round::score`].
    pub score: f64,
    /// How the best trial stands above it, on all records.
    pub behind: Advantage,
}

/// What was tried on one patch.
#[derive(Debug, Clone)]
pub struct Round {
    /// The patch without the effects that were tried.
    pub before: Stage,
    /// Every trial, the best first.
    pub trials: Vec<Trial>,
    /// What the best does for the records that were held back.
    pub confirmed: Advantage,
    /// The score that the best must have.
    pub needed: f64,
    /// How many of the trials, the best among them, the data cannot tell apart.
    pub tied: usize,
    /// Whether the best was taken.
    pub taken: bool,
}

/// What came of a search.
#[derive(Debug, Clone)]
pub struct Outcome {
    /// What was found out.
    pub verdict: Verdict,
    /// The patch as it was, fitted.
    pub base: Stage,
    /// What was tried, one effect after the other.
    pub rounds: Vec<Round>,
    /// The patch with every effect that was taken and is still needed, fitted.
    pub last: Stage,
    /// The share of the gap that is left, in rms.
    pub left: f64,
    /// Where and when something is missing in the patch as it was; of no junction where nothing is.
    pub whereabouts: Vec<Whereabouts>,
    /// The smallest effects that the first round would have found.
    pub limits: Vec<Limit>,
    /// Why the data cannot judge, where they cannot.
    pub blind: Option<Blind>,
    /// The experiment that would tell two effects apart, where the data cannot.
    pub separating: Option<Separating>,
}

/// What a search is made with.
#[derive(Debug, Clone, Copy)]
pub struct Means<'a> {
    /// The effects that may be missing.
    pub library: &'a Library,
    /// How many threads try them; what is found does not depend on it.
    pub threads: usize,
    /// What the points are drawn by from which the patch is fitted.
    pub seed: u64,
}

/// From where so many of the best trials came to the patch is fitted again.
const LOOKED_AT: usize = 3;
/// So often a round is made again because the patch before it could be fitted better.
const MOST_BETTERED: usize = 3;
/// So many of the best trials are fitted to ever more of the records, where all leave a large gap.
const GROWN: usize = 6;
/// So many trials are gone through with, those that a quick look finds best.
const TRIED_FULLY: usize = 12;
/// How many effects are looked for at most.
const MOST_EFFECTS: usize = 3;
/// What is held back must be explained better by so many standard errors.
pub(super) const CONFIRMED: f64 = 2.0;
/// A rival is behind if it lies so many standard errors behind,
pub(super) const APART: f64 = 2.5;
/// and by a score of so much.
const APART_BY: f64 = 6.0;
/// Residuals further than this from white noise are not noise.
const COLOURED: f64 = 4.0;
/// So large a share of the gap may be left of an effect whose law has another shape than the library's.
const MOST_LEFT: f64 = 0.3;

impl Problem {
    /// Searches for what a patch lacks. `progress` is told how far it has come.
    ///
    /// # Errors
    /// When the patch cannot be run beside the records.
    pub fn search(
        &self,
        patch: &Patch,
        fit: &[String],
        with: &Means<'_>,
        mut progress: impl FnMut(Progress),
    ) -> Result<Option<Outcome>, ModelError> {
        progress(Progress::of(Part::Base));
        let Some(mut base) = self.base(patch, fit, with.seed)? else { return Ok(None) };
        let mut rounds: Vec<Round> = Vec::new();
        let (mut stage, mut bettered) = (base.clone(), 0);
        while rounds.len() < MOST_EFFECTS {
            let round = self.round(&stage, rounds.len() + 1, with, &mut progress)?;
            // A trial may have found what the patch alone could have been fitted to.
            let better = if bettered < MOST_BETTERED { self.better(&stage, &round)? } else { None };
            let again = match (rounds.last_mut(), better) {
                (None, Some(better)) => {
                    base = better.clone();
                    Some(better)
                }
                (Some(last), Some(better)) => last.refit(better),
                (_, None) => None,
            };
            if let Some(again) = again {
                bettered += 1;
                stage = again;
                continue;
            }
            let taken = round.taken.then(|| round.trials[0].stage.clone());
            rounds.push(round);
            let Some(next) = taken else { break };
            stage = next;
            if !self.is_structured(&stage) {
                break;
            }
        }
        let (rounds, stage) = self.settled(&base, rounds, stage, with, &mut progress)?;
        let left = self.gap(&stage) / self.gap(&base);
        let limits = match rounds.first() {
            Some(round) => self.limits(round, with.threads)?,
            None => Vec::new(),
        };
        let verdict = self.verdict(&base, &stage, &rounds, left, &limits);
        let whereabouts = match verdict {
            Verdict::NothingMissing | Verdict::CannotJudge => Vec::new(),
            _ => {
                progress(Progress::of(Part::Where));
                self.whereabouts(&base, with.threads)?
            }
        };
        let blind = self.is_blind(&base, &rounds, &limits).filter(|_| verdict == Verdict::CannotJudge);
        let separating = match verdict {
            Verdict::Ambiguous => self.separating(&rounds)?,
            _ => None,
        };
        Ok(Some(Outcome { verdict, base, rounds, last: stage, left, whereabouts, limits, blind, separating }))
    }

    /// The patch of a stage fitted better, from where the best trials came to.
    fn better(&self, stage: &Stage, round: &Round) -> Result<Option<Stage>, ModelError> {
        for trial in round.trials.iter().take(LOOKED_AT) {
            if let Some(better) = self.once_more(stage, &trial.stage)? {
                return Ok(Some(better));
            }
        }
        Ok(None)
    }

    /// Looks at every effect again, with all that came after it: another may be better now, or none be needed.
    fn settled(
        &self,
        base: &Stage,
        mut rounds: Vec<Round>,
        mut stage: Stage,
        with: &Means<'_>,
        progress: &mut impl FnMut(Progress),
    ) -> Result<(Vec<Round>, Stage), ModelError> {
        let mut place = 0;
        while rounds.iter().filter(|round| round.taken).count() > 1 && place + 1 < rounds.len() {
            let others = rounds.iter().enumerate().filter(|(other, round)| *other != place && round.taken);
            let others: Vec<&Candidate> = others.map(|(_, round)| &round.trials[0].candidate).collect();
            if !rounds[place].taken {
                break;
            }
            let Some(without) = self.joined(base, &others, with.library)? else { break };
            let again = self.round(&without, place + 1, with, progress)?;
            if again.taken {
                stage = again.trials[0].stage.clone();
                rounds[place] = again;
                place += 1;
            } else {
                stage = without;
                rounds.remove(place);
            }
        }
        Ok((rounds, stage))
    }

    /// A stage with several effects wired in one after the other; nothing where one does not fit any more.
    fn joined(
        &self,
        base: &Stage,
        effects: &[&Candidate],
        library: &Library,
    ) -> Result<Option<Stage>, ModelError> {
        let mut stage = base.clone();
        for effect in effects {
            let sites = self.sites(&stage)?;
            let all = library.iter().flat_map(|own| Attached::all(own, &sites));
            let Some(attached) = all.into_iter().find(|attached| effect.is(attached)) else {
                return Ok(None);
            };
            let peaks = self.peaks(&stage)?;
            let Some((_, next)) = self.attempt(&stage, &attached, &peaks, Effort::FULL)? else {
                return Ok(None);
            };
            stage = next;
        }
        Ok(Some(stage))
    }

    pub(super) fn sites(&self, stage: &Stage) -> Result<Sites, ModelError> {
        let circuit = Circuit::new(&stage.version.patch, &[])?;
        let fed: Vec<&str> = self.drives.iter().map(|feed| feed.drive.as_str()).collect();
        Ok(Sites::of(&circuit, &fed))
    }

    /// What no noise explains, in sigmas rms.
    pub fn gap(&self, stage: &Stage) -> f64 {
        (stage.train.reduced() - 1.0).max(1e-6).sqrt()
    }

    /// Whether what is left is more than noise.
    fn is_structured(&self, stage: &Stage) -> bool {
        stage.colour > COLOURED
    }

    fn verdict(&self, base: &Stage, stage: &Stage, rounds: &[Round], left: f64, limits: &[Limit]) -> Verdict {
        let taken = rounds.iter().filter(|round| round.taken);
        match (taken.clone().count(), self.is_structured(stage)) {
            (0, false) if self.is_blind(base, rounds, limits).is_some() => Verdict::CannotJudge,
            (0, false) => Verdict::NothingMissing,
            (0, true) => Verdict::UnknownEffect,
            (_, true) if left > MOST_LEFT => Verdict::UnknownEffect,
            _ if taken.clone().any(|round| round.tied > 1) => Verdict::Ambiguous,
            _ => Verdict::Named,
        }
    }

    /// Tries every effect on a stage, as the round of this number.
    fn round(
        &self,
        stage: &Stage,
        number: usize,
        with: &Means<'_>,
        progress: &mut impl FnMut(Progress),
    ) -> Result<Round, ModelError> {
        let sites = self.sites(stage)?;
        let peaks = self.peaks(stage)?;
        let all: Vec<Attached<'_>> =
            with.library.iter().flat_map(|effect| Attached::all(effect, &sites)).collect();
        let mut tell = |part: Part, done: u64, of: usize| {
            progress(Progress { round: number, part, done, all: of as u64 });
        };
        let attempt =
            |attached: &Attached<'_>, effort| self.attempt(stage, attached, &peaks, effort).ok().flatten();
        let mut tried = pool::each(
            &all,
            with.threads,
            |own| attempt(own, Effort::QUICK),
            |done| tell(Part::Quick, done, all.len()),
        );
        let mut harder = |most: usize, effort: Effort, part: Part| {
            let order = best_of(&tried, most);
            let again = pool::each(
                &order,
                with.threads,
                |place| attempt(&all[*place], effort),
                |done| tell(part, done, order.len()),
            );
            for (place, again) in order.iter().zip(again) {
                tried[*place] = better_of(tried[*place].take(), again);
            }
            order.iter().flat_map(|place| &tried[*place]).all(|(_, stage)| stage.is_far())
        };
        let is_far = harder(TRIED_FULLY, Effort::FULL, Part::Full);
        if is_far && !self.is_cut {
            harder(GROWN, Effort::GROWING, Part::Growing);
        }
        Ok(Round::of(stage, tried.into_iter().flatten().collect()))
    }
}

/// The places of so many trials, those that left least first.
fn best_of(tried: &[Option<(Candidate, Stage)>], most: usize) -> Vec<usize> {
    let chi2 = |place: &usize| tried[*place].as_ref().map_or(f64::INFINITY, |(_, stage)| stage.train.chi2);
    let mut order: Vec<usize> = (0..tried.len()).filter(|place| tried[*place].is_some()).collect();
    order.sort_by(|a, b| chi2(a).total_cmp(&chi2(b)));
    order.truncate(most);
    order
}

/// The one of two trials that left less.
fn better_of(
    one: Option<(Candidate, Stage)>,
    other: Option<(Candidate, Stage)>,
) -> Option<(Candidate, Stage)> {
    one.into_iter().chain(other).min_by(|(_, a), (_, b)| a.train.chi2.total_cmp(&b.train.chi2))
}

/// What the best of some trials leaves, in squares over the noise, and for how many samples that remembers: the unit of scores.
pub(super) fn unit<'s>(tried: impl Iterator<Item = &'s Stage>) -> (f64, f64) {
    let best = tried.min_by(|a, b| a.train.chi2.total_cmp(&b.train.chi2));
    best.map_or((1.0, 1.0), |best| (best.train.reduced().max(f64::MIN_POSITIVE), best.memory))
}

impl Round {
    /// Judges the trials again with a better fit of the one that was taken; what is best then, if it still is to be taken.
    fn refit(&mut self, taken: Stage) -> Option<Stage> {
        let mut tried: Vec<(Candidate, Stage)> =
            self.trials.iter().map(|trial| (trial.candidate.clone(), trial.stage.clone())).collect();
        tried.first_mut()?.1 = taken;
        let again = Round::of(&self.before, tried);
        let stage = again.taken.then(|| again.trials[0].stage.clone())?;
        *self = again;
        Some(stage)
    }

    fn of(before: &Stage, tried: Vec<(Candidate, Stage)>) -> Round {
        let unit = unit(tried.iter().map(|(_, stage)| stage));
        let score = |stage: &Stage| {
            let numbers = (stage.version.fit.len() - before.version.fit.len()) as f64;
            let samples = before.train.count as f64 / unit.1;
            (before.train.chi2 - stage.train.chi2) / (unit.0 * unit.1) - numbers * samples.ln()
        };
        let nothing = Advantage { sum: 0.0, error: 0.0 };
        let trial = |(candidate, stage): (Candidate, Stage)| Trial {
            score: score(&stage),
            candidate,
            stage,
            behind: nothing,
        };
        let mut trials: Vec<Trial> = tried.into_iter().map(trial).collect();
        trials.sort_by(|a, b| b.score.total_cmp(&a.score));
        let needed = 2.0 * (trials.len().max(1) as f64).ln() + 4.0;
        let Some(best) = trials.first().cloned() else {
            return Round {
                before: before.clone(),
                trials,
                confirmed: nothing,
                needed,
                tied: 0,
                taken: false,
            };
        };
        let confirmed = advantage(&before.test, &best.stage.test);
        for trial in &mut trials {
            trial.behind = advantage(&trial.stage.train, &best.stage.train)
                .and(advantage(&trial.stage.test, &best.stage.test));
        }
        let taken = best.score > needed && confirmed.ratio() > CONFIRMED;
        let mut round = Round { before: before.clone(), trials, confirmed, needed, tied: 1, taken };
        round.tied += round.trials.iter().skip(1).filter(|trial| round.is_tied(trial)).count();
        round
    }

    /// Whether the data cannot tell a trial from the best, which is of another effect.
    pub(super) fn is_tied(&self, trial: &Trial) -> bool {
        let best = &self.trials[0];
        // One that needs more numbers has to be worth them.
        let is_simple = trial.stage.version.fit.len() <= best.stage.version.fit.len();
        let is_near = best.score - trial.score < APART_BY || (is_simple && trial.behind.ratio() < APART);
        // What leaves structure where another leaves noise is no rival.
        let is_noise = |trial: &Trial| trial.stage.colour < COLOURED;
        let is_as_good = is_noise(trial) || !is_noise(best);
        trial.candidate.effect != best.candidate.effect && trial.score > self.needed && is_near && is_as_good
    }
}
