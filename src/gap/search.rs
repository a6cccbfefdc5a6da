//! The search: every effect at every place that it fits, everything refitted, the best confirmed on what was held back; and
//! again, until what is left looks like noise or nothing more can be named.

use std::mem;

use super::candidate::Candidate;
use super::effect::Library;
use super::fit::Fitted;
use super::graft::Attached;
use super::limits::{Blind, Limit};
use super::model::ModelError;
use super::progress::{Part, Progress};
use super::score::{Advantage, advantage};
use super::separate::Separating;
use super::site::Sites;
use super::stage::{Asked, Effort, Problem, Stage, Untried};
use super::starts::Agreement;
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
    /// Whether effects are named.
    pub fn has_names(self) -> bool {
        matches!(self, Verdict::Named | Verdict::Ambiguous)
    }

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
    /// How the best trial stands above it.
    pub behind: Advantage,
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

/// What was tried on one patch.
#[derive(Debug, Clone)]
pub struct Round {
    /// The patch without the effects that were tried.
    pub before: Stage,
    /// Whether that has no effect yet that was found.
    pub is_first: bool,
    /// Every trial, the best first.
    pub trials: Vec<Trial>,
    /// What could not be tried.
    pub left_out: Vec<LeftOut>,
    /// What the best does for the records that were held back.
    pub confirmed: Advantage,
    /// The score that the best must have.
    pub needed: f64,
    /// How many of the trials, the best among them, the data cannot tell apart.
    pub tied: usize,
    /// Whether the best was taken.
    pub taken: bool,
    /// Whether it was not, but may belong to what is missing beside something else.
    pub promising: bool,
    /// What a number that is fitted must gain, in squares.
    price: f64,
}

/// What came of a search.
#[derive(Debug, Clone)]
pub struct Outcome {
    /// What was found out.
    pub verdict: Verdict,
    /// The patch as it was, fitted.
    pub base: Stage,
    /// Whether fits from elsewhere come to the same.
    pub agreement: Agreement,
    /// What was tried, one effect after the other.
    pub rounds: Vec<Round>,
    /// What was taken in the first of these rounds.
    pub effects: Vec<Candidate>,
    /// The patch with all that was taken, fitted.
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
/// Trials that leave less than this times what the best leaves are looked after where they do not hold for the test.
const NEAR: f64 = 1.5;
/// How many effects are looked for at most.
const MOST_EFFECTS: usize = 3;
/// What is held back must be explained better by so many standard errors.
pub(super) const CONFIRMED: f64 = 2.0;
/// Where a trial leaves but noise, so much on what is held back at most, in squares, all that it gains there is its own doing.
const NOISE: f64 = 1.2;
/// A rival is behind if it lies so many standard errors behind,
pub(super) const APART: f64 = 2.5;
/// and by a score of so much.
const APART_BY: f64 = 6.0;
/// An effect beside others must close such a share of what they leave, in squares, or all of it that is no noise.
const LEAST_CLOSED: f64 = 0.5;
/// The score of an effect beside others must be so many times what that of a single one must be: the law of another may have a
/// slightly other shape.
const BESIDE: f64 = 2.0;
/// An effect is gone on from although it is not confirmed if it is better on what is held back by so many standard errors, and
/// more is missing: beside that it may be.
const PROMISING: f64 = 1.0;
/// What leaves structure, more than this share of the gap,
const CLEAR: f64 = 0.1;
/// and less than so many times as little as some other effect, in squares, explains in part what may be none of them:
const STANDS_OUT: f64 = 3.0;
/// it is not, if a force over what the patch does leaves less than this share of what it leaves, in squares.
const CURVE: f64 = 0.5;
/// Residuals further than this from white noise are not noise.
const COLOURED: f64 = 4.0;
/// So large a share of the gap may be left of an effect whose law has another shape than the library's; what several leave
/// adds up in squares.
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
        let mut come = Come { rounds: Vec::new(), effects: Vec::new(), stage: base.clone() };
        let (mut bettered, mut before_promise) = (0, None);
        while come.rounds.len() < MOST_EFFECTS {
            let round = self.round(&come.stage, &come.effects, with, &mut progress)?;
            // A trial may have found what the patch alone could have been fitted to.
            let better = if bettered < MOST_BETTERED { self.better(&come.stage, &round)? } else { None };
            if better.is_some_and(|better| come.is_bettered_by(better)) {
                if come.rounds.is_empty() {
                    base = come.stage.clone();
                }
                bettered += 1;
                continue;
            }
            if round.promising && before_promise.is_none() {
                before_promise = Some(come.and(&round));
            }
            if !come.goes_on_with(round) || !leaves_structure(&come.stage) {
                break;
            }
        }
        let Come { rounds, effects, stage } = match before_promise {
            None => self.settled(&base, come, true, with, &mut progress)?,
            Some(before) => self.settled(&base, come, false, with, &mut progress)?.or(before),
        };
        let left = self.gap(&stage) / self.gap(&base);
        let limits = match rounds.first() {
            Some(round) => self.limits(round, with.threads)?,
            None => Vec::new(),
        };
        let blind = self.is_blind(&base, &rounds, &limits);
        let mut verdict = self.verdict(&stage, &rounds, left, blind);
        let whereabouts = match verdict {
            Verdict::NothingMissing | Verdict::CannotJudge => Vec::new(),
            _ => {
                progress(Progress::of(Part::Where));
                self.whereabouts(&base, with.threads)?
            }
        };
        let is_doubtful = verdict.has_names() && leaves_structure(&stage) && left > CLEAR;
        if is_doubtful && !rounds[0].stands_out() && is_a_curve(&whereabouts, left) {
            verdict = Verdict::UnknownEffect;
        }
        let blind = blind.filter(|_| verdict == Verdict::CannotJudge);
        let separating = match verdict {
            Verdict::Ambiguous => self.separating(&rounds)?,
            _ => None,
        };
        Ok(Some(Outcome {
            verdict,
            agreement: self.agreement(&base, with.seed)?,
            base,
            rounds,
            effects,
            last: stage,
            left,
            whereabouts,
            limits,
            blind,
            separating,
        }))
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

    /// Looks at every effect again, beside all the others: another may be better now, or none be needed; at the last of them only
    /// where the others, which stood when it was found, do not stand any more.
    fn settled(
        &self,
        base: &Stage,
        mut come: Come,
        mut others_stand: bool,
        with: &Means<'_>,
        progress: &mut impl FnMut(Progress),
    ) -> Result<Come, ModelError> {
        let (mut place, have_stood) = (0, others_stand);
        while come.effects.len() > 1 && place < come.effects.len() {
            if others_stand && place + 1 == come.effects.len() {
                break;
            }
            let others = come.effects.iter().enumerate().filter(|(other, _)| *other != place);
            let others: Vec<&Candidate> = others.map(|(_, own)| own).collect();
            let Some((kept, without)) = self.joined(base, &others, with.library)? else { break };
            let is_needed = leaves_structure(&without);
            let again = is_needed.then(|| self.round(&without, &kept, with, progress)).transpose()?;
            match again {
                Some(again) if again.taken => {
                    others_stand &= again.trials[0].candidate.is_same(&come.effects[place]);
                    come.replace(place, kept, again);
                    place += 1;
                }
                // Others that leave far more without it do not make needless what stood when it was found.
                Some(again) if have_stood && again.closed() > LEAST_CLOSED => place += 1,
                _ => {
                    come.rounds.remove(place);
                    (come.effects, come.stage) = (kept, without);
                    others_stand = false;
                }
            }
        }
        Ok(come)
    }

    /// A stage with several effects wired in one after the other; nothing where one does not fit any more.
    fn joined(
        &self,
        base: &Stage,
        effects: &[&Candidate],
        library: &Library,
    ) -> Result<Option<(Vec<Candidate>, Stage)>, ModelError> {
        let (mut kept, mut stage) = (Vec::new(), base.clone());
        for effect in effects {
            let sites = self.sites(&stage)?;
            let all = library.iter().flat_map(|own| Attached::all(own, &sites));
            let Some(attached) = all.into_iter().find(|attached| effect.is(attached)) else {
                return Ok(None);
            };
            let peaks = self.peaks(&stage)?;
            let asked = Asked { effort: Effort::FULL, wanted: stage.train.chi2, before: None };
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

    pub(super) fn sites(&self, stage: &Stage) -> Result<Sites, ModelError> {
        let circuit = Circuit::new(&stage.version.patch, &[])?;
        let fed: Vec<&str> = self.drives.iter().map(|feed| feed.drive.as_str()).collect();
        Ok(Sites::of(&circuit, &fed))
    }

    /// What no noise explains, in sigmas rms.
    pub fn gap(&self, stage: &Stage) -> f64 {
        stage.train.unexplained().sqrt()
    }

    fn verdict(&self, stage: &Stage, rounds: &[Round], left: f64, blind: Option<Blind>) -> Verdict {
        let taken = rounds.iter().filter(|round| round.taken);
        let most_left = MOST_LEFT * (taken.clone().count() as f64).sqrt();
        match (taken.clone().count(), leaves_structure(stage)) {
            (0, false) if blind.is_some() => Verdict::CannotJudge,
            (0, false) => Verdict::NothingMissing,
            (0, true) => Verdict::UnknownEffect,
            (_, true) if left > most_left => Verdict::UnknownEffect,
            _ if taken.clone().any(|round| round.tied > 1) => Verdict::Ambiguous,
            _ => Verdict::Named,
        }
    }

    /// Tries every effect on a stage that has some already.
    fn round(
        &self,
        stage: &Stage,
        effects: &[Candidate],
        with: &Means<'_>,
        progress: &mut impl FnMut(Progress),
    ) -> Result<Round, ModelError> {
        let sites = self.sites(stage)?;
        let peaks = self.peaks(stage)?;
        let is_new = |own: &Attached<'_>| own.effect.recurs() || effects.iter().all(|effect| !effect.is(own));
        let all = with.library.iter().flat_map(|effect| Attached::all(effect, &sites));
        let all: Vec<Attached<'_>> = all.filter(is_new).collect();
        let number = effects.len() + 1;
        let mut tell = |part, done, all: usize| {
            progress(Progress { round: number, part, done, all: all as u64 });
        };
        let attempt =
            |attached: &Attached<'_>, asked: Asked<'_>| self.attempt(stage, attached, &peaks, asked);
        let before = stage.train.chi2;
        let tried = pool::each(
            &all,
            with.threads,
            |own| attempt(own, Asked { effort: Effort::QUICK, wanted: before, before: None }),
            |done| tell(Part::Quick, done, all.len()),
        );
        let left_out: Vec<LeftOut> = all
            .iter()
            .zip(&tried)
            .filter_map(|(own, tried)| Some(LeftOut::of(own, tried.as_ref().err()?)))
            .collect();
        let mut tried: Vec<Option<(Candidate, Stage)>> = tried.into_iter().map(Result::ok).collect();
        let mut harder = |most: usize, effort: Effort, part: Part| {
            let order = best_of(&tried, most);
            // Where there is no hope to come to what the best has come to, no more is needed.
            let best = order.first().and_then(|place| tried[*place].as_ref());
            let reached = best.map_or(before, |(_, stage)| stage.train.chi2.min(before));
            let again = pool::each(
                &order,
                with.threads,
                |place| {
                    let wanted = if *place == order[0] { before } else { reached };
                    let come = tried[*place].as_ref().map(|(_, stage)| stage);
                    attempt(&all[*place], Asked { effort, wanted, before: come }).ok()
                },
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
        let tried: Vec<(Candidate, Stage)> = tried.into_iter().flatten().collect();
        let best = tried.iter().map(|(_, stage)| stage.train.chi2).fold(f64::INFINITY, f64::min);
        let found_again = |(_, stage): &(Candidate, Stage)| {
            let is_near = stage.train.chi2 < NEAR * best;
            is_near.then(|| self.found_again(stage).ok().flatten()).flatten()
        };
        let again = pool::each(&tried, with.threads, found_again, |_| ());
        let tried = tried.into_iter().zip(again);
        let tried = tried.map(|((candidate, stage), again)| (candidate, again.unwrap_or(stage)));
        Ok(Round { left_out, ..Round::of(stage, effects.is_empty(), tried.collect()) })
    }
}

/// Whether a force over what the patch does explains far more than effects that leave such a share of the gap.
fn is_a_curve(whereabouts: &[Whereabouts], left: f64) -> bool {
    let best = whereabouts.first().and_then(|best| best.best.map(|place| &best.curves[place]));
    best.is_some_and(|curve| 1.0 - curve.explains < CURVE * left * left)
}

/// Whether what is left is more than noise.
fn leaves_structure(stage: &Stage) -> bool {
    stage.colour > COLOURED
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

/// How far a search has come.
#[derive(Clone)]
struct Come {
    /// What was tried, one effect after the other.
    rounds: Vec<Round>,
    /// What was taken in the first of these rounds,
    effects: Vec<Candidate>,
    /// and the patch with it.
    stage: Stage,
}

impl Come {
    /// The same with a round that took nothing.
    fn and(&self, round: &Round) -> Come {
        let mut come = self.clone();
        come.rounds.push(round.clone());
        come
    }

    /// What came of a promise: what was there before, unless two effects or more hold together that one alone did not.
    fn or(self, before: Come) -> Come {
        if self.effects.len() > before.effects.len() + 1 { self } else { before }
    }

    /// Whether to go on with a round: it is one more, and its best is taken, or may be beside what is still missing.
    fn goes_on_with(&mut self, round: Round) -> bool {
        let best = round.is_gone_on_from().then(|| round.trials[0].clone());
        self.rounds.push(round);
        let is_taken = best.is_some();
        if let Some(best) = best {
            self.effects.push(best.candidate);
            self.stage = best.stage;
        }
        is_taken
    }

    /// Whether to go on from here with a better fit of the patch: not where its last effect would not have been taken then.
    fn is_bettered_by(&mut self, better: Stage) -> bool {
        let Some(last) = self.rounds.last_mut() else {
            self.stage = better;
            return true;
        };
        let Some(best) = last.refit(better) else { return false };
        self.effects.pop();
        self.effects.push(best.candidate);
        self.stage = best.stage;
        true
    }

    /// Another round in a place, found beside the others.
    fn replace(&mut self, place: usize, others: Vec<Candidate>, round: Round) {
        let best = round.trials[0].clone();
        self.effects = others;
        self.effects.insert(place, best.candidate);
        self.stage = best.stage;
        self.rounds[place] = round;
    }
}

impl LeftOut {
    fn of(attached: &Attached<'_>, why: &Untried) -> LeftOut {
        let effect = attached.effect.name.clone();
        LeftOut { effect, junction: attached.junction().to_owned(), why: why.to_string() }
    }

    /// What was not tried, and why, in a line.
    pub fn sentence(&self) -> String {
        let why = self.why.lines().next().unwrap_or_default();
        format!("{} at {} was not tried: {why}", self.effect, self.junction)
    }
}

impl Trial {
    /// How many numbers are fitted.
    fn numbers(&self) -> usize {
        self.stage.version.fit.len()
    }

    /// How another stands above it, on all records. What has changed by the time of the test blurs that: where the other leaves
    /// structure with no more numbers, the records that both were fitted to say it, unless the test is on this one's side.
    fn behind(&self, other: &Trial) -> Advantage {
        let train = advantage(&self.stage.train, &other.stage.train);
        let all = train.and(advantage(&self.stage.test, &other.stage.test));
        let is_fair = other.numbers() <= self.numbers() && leaves_structure(&other.stage);
        if is_fair && all.sum > 0.0 && train.ratio() > all.ratio() { train } else { all }
    }
}

impl Round {
    /// Judges the trials again with a better fit of the one that was taken; what is best then, if it still is to be taken.
    fn refit(&mut self, taken: Stage) -> Option<Trial> {
        let mut tried: Vec<(Candidate, Stage)> =
            self.trials.iter().map(|trial| (trial.candidate.clone(), trial.stage.clone())).collect();
        tried.first_mut()?.1 = taken;
        let again = Round::of(&self.before, self.is_first, tried);
        let best = again.is_gone_on_from().then(|| again.trials[0].clone())?;
        *self = Round { left_out: mem::take(&mut self.left_out), ..again };
        Some(best)
    }

    /// Whether the search goes on with the best.
    fn is_gone_on_from(&self) -> bool {
        self.taken || self.promising
    }

    /// The share of the gap, in squares, that the best closes.
    pub fn closed(&self) -> f64 {
        let before = self.before.train.unexplained();
        self.trials.first().map_or(0.0, |best| 1.0 - best.stage.train.unexplained() / before)
    }

    /// Whether the best does enough to stand beside what was taken before it: most of what is left, or all that does not look
    /// like noise. An effect whose law has another shape than the library's leaves something, too.
    pub fn closes_enough(&self) -> bool {
        let leaves_noise = self.trials.first().is_some_and(|best| !leaves_structure(&best.stage));
        self.is_first || leaves_noise || self.closed() > LEAST_CLOSED
    }

    fn of(before: &Stage, is_first: bool, tried: Vec<(Candidate, Stage)>) -> Round {
        let unit = unit(tried.iter().map(|(_, stage)| stage));
        let each = (before.train.count as f64 / unit.1).ln();
        let score = |stage: &Stage| {
            let numbers = (stage.version.fit.len() - before.version.fit.len()) as f64;
            (before.train.chi2 - stage.train.chi2) / (unit.0 * unit.1) - numbers * each
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
        let needed = if is_first { needed } else { BESIDE * needed };
        let mut round = Round {
            before: before.clone(),
            is_first,
            trials,
            left_out: Vec::new(),
            confirmed: nothing,
            needed,
            tied: 0,
            taken: false,
            promising: false,
            price: unit.0 * unit.1 * each,
        };
        round.judge();
        round
    }

    /// Holds the trials against the best, and judges it.
    fn judge(&mut self) {
        self.compare();
        // What explains all the data better, those held back with those it was fitted to, is better than its score.
        let ahead = (1..self.trials.len()).filter(|place| self.is_ahead(&self.trials[*place]));
        let ratio = |place: &usize| self.trials[*place].behind.ratio();
        self.put_first(ahead.min_by(|a, b| ratio(a).total_cmp(&ratio(b))));
        // What needs fewer numbers and explains all the data no worse is to be preferred.
        let simpler = (1..self.trials.len()).find(|place| self.is_simpler(&self.trials[*place]));
        self.put_first(simpler);
        let Some(best) = self.trials.first() else { return };
        self.confirmed = advantage(&self.before.test, &best.stage.test);
        let shows = best.score > self.needed && self.closes_enough();
        let leaves_noise = !leaves_structure(&best.stage) && best.stage.test.reduced() < NOISE;
        let gains = leaves_noise && self.confirmed.sum > self.needed * best.stage.memory;
        self.taken = shows && (self.confirmed.ratio() > CONFIRMED || gains);
        let may_be = self.confirmed.ratio() > PROMISING && self.closed() > LEAST_CLOSED;
        self.promising = shows && !self.taken && may_be && leaves_structure(&best.stage);
        self.tied = 1 + self.trials.iter().skip(1).filter(|trial| self.is_tied(trial)).count();
    }

    /// Puts a trial before those that stand before it.
    fn put_first(&mut self, place: Option<usize>) {
        if let Some(place) = place {
            self.trials[..=place].rotate_right(1);
            self.compare();
        }
    }

    fn compare(&mut self) {
        let behind: Vec<Advantage> = self.trials.iter().map(|trial| trial.behind(&self.trials[0])).collect();
        self.trials.iter_mut().zip(behind).for_each(|(trial, behind)| trial.behind = behind);
    }

    fn is_ahead(&self, trial: &Trial) -> bool {
        let price = self.price * (trial.numbers() as f64 - self.trials[0].numbers() as f64);
        trial.score > self.needed && trial.behind.ratio() < -APART && -trial.behind.sum > price
    }

    /// Whether a trial does with fewer numbers as well as the best, where that leaves structure: there more numbers follow what
    /// neither explains.
    fn is_simpler(&self, trial: &Trial) -> bool {
        let best = &self.trials[0];
        let has_fewer = trial.numbers() < best.numbers() && leaves_structure(&best.stage);
        has_fewer && trial.score > self.needed && trial.behind.sum <= 0.0
    }

    /// Whether all other effects leave far more than the best.
    fn stands_out(&self) -> bool {
        let Some(best) = self.trials.first() else { return false };
        let others = self.trials.iter().filter(|trial| trial.candidate.effect != best.candidate.effect);
        let least = others.map(|trial| trial.stage.train.unexplained()).fold(f64::INFINITY, f64::min);
        least > STANDS_OUT * best.stage.train.unexplained()
    }

    /// Whether the data cannot tell a trial from the best, which is of another effect.
    pub(super) fn is_tied(&self, trial: &Trial) -> bool {
        let best = &self.trials[0];
        // One that needs more numbers has to be worth them.
        let is_simple = trial.numbers() <= best.numbers();
        let is_worth_them = trial.behind.sum < 0.0 || !leaves_structure(&best.stage);
        let is_near = best.score - trial.score < APART_BY && is_worth_them || is_simple;
        let is_near = is_near && trial.behind.ratio() < APART;
        // What leaves structure where another leaves noise, or far less structure, is no rival.
        let leaves_far_more = |of: fn(&Stage) -> &Fitted| {
            of(&trial.stage).unexplained() > STANDS_OUT * of(&best.stage).unexplained()
        };
        let is_far = leaves_far_more(|stage| &stage.train) && leaves_far_more(|stage| &stage.test);
        let is_as_good = !leaves_structure(&trial.stage) || leaves_structure(&best.stage) && !is_far;
        trial.candidate.effect != best.candidate.effect && trial.score > self.needed && is_near && is_as_good
    }
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::*;
    use crate::gap::Experiment;

    /// A pump at its limit, wired where it is missing and looked at quickly: what a trial is made of.
    fn any() -> (Candidate, Stage) {
        let path = Path::new("tests/gap/hidden/saturation/experiment.json");
        let experiment = Experiment::read(path).unwrap_or_else(|error| panic!("{error}"));
        let problem = Problem::of(&experiment).unwrap();
        let base = problem.base(&experiment.patch, &experiment.fit, 1).unwrap().unwrap();
        let (sites, peaks) = (problem.sites(&base).unwrap(), problem.peaks(&base).unwrap());
        let library = Library::shipped();
        let mut all = library.iter().flat_map(|effect| Attached::all(effect, &sites));
        let limit = all.find(|own| own.effect.name == "saturation").unwrap();
        let asked = Asked { effort: Effort::QUICK, wanted: f64::INFINITY, before: None };
        problem.attempt(&base, &limit, &peaks, asked).unwrap()
    }

    /// A trial of so many numbers that leaves slow waves, of one height in training, of two in turn in the test.
    fn trial(
        like: &(Candidate, Stage),
        name: &str,
        numbers: usize,
        train: f64,
        test: [f64; 2],
    ) -> (Candidate, Stage) {
        let (mut candidate, mut stage) = like.clone();
        name.clone_into(&mut candidate.effect);
        stage.version.fit = (0..numbers).map(|number| format!("p{number}")).collect();
        for (fitted, heights) in [(&mut stage.train, [train; 2]), (&mut stage.test, test)] {
            let wave = (0..2000_u32).map(|k| heights[(k / 100 % 2) as usize] * (0.2 * f64::from(k)).sin());
            fitted.residuals = vec![vec![wave.collect()]];
            fitted.chi2 = fitted.residuals[0][0].iter().map(|own| own * own).sum();
            fitted.count = 2000;
        }
        (stage.colour, stage.memory) = (100.0, 20.0);
        (candidate, stage)
    }

    /// The best of a round, and how many the data cannot tell apart.
    fn judged(like: &(Candidate, Stage), tried: Vec<(Candidate, Stage)>) -> (String, usize) {
        let (_, before) = trial(like, "", 2, 100.0, [100.0; 2]);
        let round = Round::of(&before, true, tried);
        (round.trials[0].candidate.effect.clone(), round.tied)
    }

    #[test]
    fn where_structure_is_left_the_simpler_goes_before_what_is_no_better() {
        let like = any();
        let of = |test: [f64; 2], colour: f64| {
            let mut rich = trial(&like, "rich", 4, 9.0, test);
            rich.1.colour = colour;
            judged(&like, vec![trial(&like, "simple", 3, 10.0, [20.0; 2]), rich])
        };
        assert_eq!(of([28.6, 5.0], 100.0), ("simple".to_owned(), 1));
        // What is better, though not beyond doubt, or leaves but noise, is not put behind.
        assert_eq!(of([28.0, 5.0], 100.0), ("rich".to_owned(), 2));
        assert_eq!(of([28.6, 5.0], 0.0), ("rich".to_owned(), 1));
    }

    #[test]
    fn where_structure_is_left_training_tells_apart_what_the_test_blurs() {
        let like = any();
        let of = |rival: [f64; 2], colour: f64| {
            let mut best = trial(&like, "best", 3, 10.0, [30.0, 10.0]);
            let mut rival = trial(&like, "rival", 3, 12.0, rival);
            (best.1.colour, rival.1.colour) = (colour, colour);
            judged(&like, vec![best, rival])
        };
        assert_eq!(of([10.0, 30.0], 100.0), ("best".to_owned(), 1));
        // The test is on the rival's side, or nothing but noise is left.
        assert_eq!(of([10.0, 28.0], 100.0), ("best".to_owned(), 2));
        assert_eq!(of([10.0, 30.0], 0.0), ("best".to_owned(), 2));
    }
}
