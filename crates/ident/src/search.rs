//! The search: every effect at every place that it fits, everything refitted, the best confirmed on what was held back; and
//! again, until what is left looks like noise or nothing more can be named.

use super::attached::Attached;
use super::beyond::Beyond;
use super::blind::Blind;
use super::candidate::Candidate;
use super::come::Come;
use super::correlation::Correlation;
use super::effect::Library;
use super::limits::Limit;
use super::model::ModelError;
use super::places::Places;
use super::problem::Problem;
use super::progress::{Part, Progress};
use super::round::Round;
use super::separate::Separating;
use super::settled::Found;
use super::site::Sites;
use super::stage::Stage;
use super::starts::Agreement;
use super::steps::Fineness;
use super::trying::Trying;
use super::way::Change;
use super::whereabouts::{Whereabouts, likeliest};
use patchcord_analysis::{pool, spare};
use patchcord_core::patch::Patch;

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
    /// Which amplifier of the patch that is told of is overloaded, in a sentence, if one is.
    pub overload: Option<String>,
    /// How it came there, change by change.
    pub way: Vec<Change>,
    /// The patch with all that was taken, fitted.
    pub last: Stage,
    /// The share of the gap that is left, in rms.
    pub left: f64,
    /// What the residuals of the patch as it was go with.
    pub correlations: Vec<Correlation>,
    /// Where and when something is missing in the patch as it was; of no junction where nothing is.
    pub whereabouts: Vec<Whereabouts>,
    /// The weakest effects that the first round would have found, where nothing was taken.
    pub limits: Vec<Limit>,
    /// Where the patch as it was comes to beyond its ranges, if it stands at their ends and leaves a gap.
    pub beyond: Option<Beyond>,
    /// Why the data cannot judge, where they cannot.
    pub blind: Option<Blind>,
    /// The experiment that would tell two effects apart, where the data cannot.
    pub separating: Option<Separating>,
    /// Where the patch as it was has room for effects; empty where none was tried.
    pub places: Places,
    /// How finely the patch that is told of was run.
    pub fineness: Fineness,
}

impl Outcome {
    /// The stage that is told of: the last one where something is named, else the patch as it was.
    pub fn told(&self) -> &Stage {
        if self.verdict.has_names() { &self.last } else { &self.base }
    }

    /// The force that closes the gap best, where something is missing that has no name.
    pub(super) fn unnamed(&self) -> Option<&Whereabouts> {
        self.whereabouts.first().filter(|_| self.verdict == Verdict::UnknownEffect)
    }

    /// Whether more is left than a law of another shape mostly leaves, and that is no noise.
    pub fn leaves_much(&self) -> bool {
        leaves_much(&self.last, self.left)
    }
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
/// How many effects are looked for at most.
const MOST_EFFECTS: usize = 3;
/// What leaves structure, one effect more than this share of the gap, explains in part what may be no effect of the library, unless it
/// is one alone that stands out:
const CLEAR: f64 = 0.1;
/// it is none, if a force over what the patch does leaves less than this share of what it leaves, in squares.
const CURVE: f64 = 0.5;
/// So large a share of the gap may be left of an effect whose law has another shape than the library's; what several leave
/// adds up in squares. By docs/measured.md friction leaves 32 % on a slide; by docs/hidden-effects.md ten of 130 unknown effects get
/// a name so, where 30 % gave one to eight.
const MOST_LEFT: f64 = 0.35;

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
        spare::with_threads(with.threads, || self.searched(patch, fit, with, &mut progress))
    }

    /// What comes of it, on the threads that it has.
    fn searched(
        &self,
        patch: &Patch,
        fit: &[String],
        with: &Means<'_>,
        progress: &mut impl FnMut(Progress),
    ) -> Result<Option<Outcome>, ModelError> {
        progress(Progress::of(Part::Base));
        let Some(base) = self.base(patch, fit, with.seed)? else { return Ok(None) };
        if self.is_noise_alone() {
            return self.unjudged(base, Blind::Still, with.seed).map(Some);
        }
        if let Some(runaway) = self.runaway(&base)? {
            return self.unjudged(base, Blind::Runaway(runaway), with.seed).map(Some);
        }
        if let Some(mistold) = self.mistold(&base, patch, fit, with.seed)? {
            return self.unjudged(base, Blind::Mistold(mistold), with.seed).map(Some);
        }
        let (base, come, before_promise) = self.gone_through(base, with, progress)?;
        let come = match before_promise {
            None => self.settled(&base, come, true, with, progress)?,
            Some(before) => self.settled(&base, come, false, with, progress)?.or(before),
        };
        let come = self.together(&base, come, with, progress)?;
        self.judged(base, come, with, progress).map(Some)
    }

    /// Round after round, as long as something is taken: the patch as it was, which a trial may have shown to fit better, where that
    /// leads, and where it had led before something was gone on from that is not confirmed.
    fn gone_through(
        &self,
        mut base: Stage,
        with: &Means<'_>,
        progress: &mut impl FnMut(Progress),
    ) -> Result<(Stage, Come, Option<Come>), ModelError> {
        let mut come = Come::begun(base.clone());
        let (mut bettered, mut before_promise) = (0, None);
        while come.rounds.len() < MOST_EFFECTS {
            if self.leaves_noise_of_drives(&come.stage, with.threads)? {
                break;
            }
            let round = self.round(&come.stage, &come.effects, None, with, progress)?;
            // A trial may have found what the patch alone could have been fitted to.
            let better = match bettered < MOST_BETTERED {
                true => self.better(&come.stage, &round, with.threads)?,
                false => None,
            };
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
            if !come.goes_on_with(round) || !come.stage.leaves_structure() {
                break;
            }
        }
        Ok((base, come, before_promise))
    }

    /// Whether what a stage leaves is what noise of the drives brings: nothing that an effect might be named after.
    fn leaves_noise_of_drives(&self, stage: &Stage, threads: usize) -> Result<bool, ModelError> {
        Ok(self.not_white(stage, threads)?.is_some_and(|own| own.is_of_drives()))
    }

    /// Where no effect is taken alone, each of those that close most is gone on from as if it had been: of two the one may hide the
    /// other. The first that holds together with what is found beside it, and leaves but noise, is it.
    fn together(
        &self,
        base: &Stage,
        mut come: Come,
        with: &Means<'_>,
        progress: &mut impl FnMut(Progress),
    ) -> Result<Come, ModelError> {
        for place in come.hopes() {
            let pair = self.hoped(base, come.hoping(place), with, progress)?;
            if pair.effects.len() > 1 && pair.all_hold() && !pair.stage.leaves_structure() {
                return Ok(pair);
            }
            come = come.after(&pair, "back, as no two hold together and leave but noise");
        }
        Ok(come)
    }

    /// What is found beside an effect that is gone on from; that alone where nothing is, or where it leaves noise of the drives.
    fn hoped(
        &self,
        base: &Stage,
        mut hope: Come,
        with: &Means<'_>,
        progress: &mut impl FnMut(Progress),
    ) -> Result<Come, ModelError> {
        if self.leaves_noise_of_drives(&hope.stage, with.threads)? {
            return Ok(hope);
        }
        let round = self.round(&hope.stage, &hope.effects, None, with, progress)?;
        match hope.goes_on_with(round) {
            true => self.settled(base, hope, false, with, progress),
            false => Ok(hope),
        }
    }

    /// What was found out by all that was tried.
    fn judged(
        &self,
        base: Stage,
        come: Come,
        with: &Means<'_>,
        progress: &mut impl FnMut(Progress),
    ) -> Result<Outcome, ModelError> {
        let Come { mut rounds, effects, stage: last, way } = self.shed(&base, come, with)?;
        let left = last.gap() / base.gap();
        // What could be there unseen is asked where nothing was found.
        let nothing_in = rounds.first().filter(|_| effects.is_empty());
        let limits =
            nothing_in.map(|round| self.limits(round, with.threads)).transpose()?.unwrap_or_default();
        let (mut verdict, blind, whereabouts) =
            self.concluded(&base, &last, &rounds, &limits, with, progress)?;
        let beyond = self.beyond(&base, &last)?;
        let blind =
            beyond.as_ref().filter(|own| own.leaves_noise()).map(|own| Blind::Beyond(own.told())).or(blind);
        if let Some(own) = &beyond {
            verdict = own.weighed(verdict);
        }
        let is_ambiguous = verdict == Verdict::Ambiguous;
        let separating = if is_ambiguous { self.separating(&rounds)? } else { None };
        for round in &mut rounds {
            if let Some(rival) = round.rival_place() {
                round.trials[rival].stage = self.with_errors(round.trials[rival].stage.clone())?;
            }
        }
        let told = if verdict.has_names() { &last } else { &base };
        Ok(Outcome {
            verdict,
            fineness: self.fineness(told)?,
            overload: self.overload(told)?,
            agreement: self.agreement(&base, with.seed)?,
            correlations: self.correlations(&base)?,
            places: Places::of(&base.version.patch, &self.drives, with.library)?,
            base: self.with_errors(base)?,
            rounds,
            effects,
            way,
            last,
            left,
            whereabouts,
            limits,
            beyond,
            blind: blind.filter(|_| verdict == Verdict::CannotJudge),
            separating,
        })
    }

    /// What rounds come to, why the data cannot judge where they cannot, and where something is missing where it is.
    fn concluded(
        &self,
        base: &Stage,
        last: &Stage,
        rounds: &[Round],
        limits: &[Limit],
        with: &Means<'_>,
        progress: &mut impl FnMut(Progress),
    ) -> Result<(Verdict, Option<Blind>, Vec<Whereabouts>), ModelError> {
        let left = last.gap() / base.gap();
        let not_white = self.not_white(last, with.threads)?;
        let leaves_noise = !last.leaves_structure() || not_white.is_some();
        let taken = taken(rounds).count();
        let blind = match not_white {
            Some(own) => Some(Blind::NotWhite(own)),
            None if taken == 0 && leaves_noise => self.is_blind(base, rounds, limits)?,
            None => None,
        };
        let verdict = verdict(rounds, left, leaves_noise, blind.is_some());
        if matches!(verdict, Verdict::NothingMissing | Verdict::CannotJudge) {
            return Ok((verdict, blind, Vec::new()));
        }
        progress(Progress::of(Part::Where));
        let whereabouts = self.whereabouts(base, with.threads)?;
        let slow = match verdict == Verdict::UnknownEffect && taken == 0 {
            true => self.slow_noise(base, likeliest(&whereabouts)),
            false => None,
        };
        if let Some(slow) = slow {
            return Ok((Verdict::CannotJudge, Some(Blind::Slow(slow)), Vec::new()));
        }
        let is_doubtful = verdict.has_names() && !leaves_noise && (taken > 1 || leaves_much(last, left));
        let is_other = is_doubtful && !is_sure(base, last, rounds) && is_a_curve(&whereabouts, left);
        Ok((if is_other { Verdict::UnknownEffect } else { verdict }, blind, whereabouts))
    }

    /// What comes of data that no effect is sought in.
    fn unjudged(&self, base: Stage, why: Blind, seed: u64) -> Result<Outcome, ModelError> {
        let base = self.with_errors(base)?;
        Ok(Outcome {
            verdict: Verdict::CannotJudge,
            fineness: self.fineness(&base)?,
            overload: self.overload(&base)?,
            agreement: self.agreement(&base, seed)?,
            correlations: self.correlations(&base)?,
            last: base.clone(),
            base,
            rounds: Vec::new(),
            effects: Vec::new(),
            way: Vec::new(),
            left: 1.0,
            whereabouts: Vec::new(),
            limits: Vec::new(),
            beyond: None,
            blind: Some(why),
            separating: None,
            places: Places::default(),
        })
    }

    /// The patch of a stage fitted better, from where the best trials came to.
    fn better(&self, stage: &Stage, round: &Round, threads: usize) -> Result<Option<Stage>, ModelError> {
        let looked_at = &round.trials[..round.trials.len().min(LOOKED_AT)];
        let again = pool::each(looked_at, threads, |trial| self.once_more(stage, &trial.stage), |_| ());
        again.into_iter().find_map(Result::transpose).transpose()
    }

    pub(super) fn sites(&self, stage: &Stage) -> Result<Sites, ModelError> {
        Ok(Sites::fed(&stage.version.patch, &self.drives)?)
    }

    /// Tries every effect on a stage that has some already; of one it may be known where it came to beside others.
    pub(super) fn round(
        &self,
        stage: &Stage,
        effects: &[Candidate],
        found: Option<&Found<'_>>,
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
        let trying = Trying { problem: self, stage, peaks: &peaks, all: &all, found, threads: with.threads };
        let (tried, left_out) = trying.carried_out(&mut tell)?;
        let mut round = Round::of(stage, effects.iter().map(Candidate::named).collect(), tried);
        round.left_out = left_out;
        Ok(round)
    }
}

/// The rounds that took something.
pub(super) fn taken(rounds: &[Round]) -> impl Iterator<Item = &Round> + Clone {
    rounds.iter().filter(|round| round.taken)
}

/// What rounds come to that leave such a share of the gap.
fn verdict(rounds: &[Round], left: f64, leaves_noise: bool, is_blind: bool) -> Verdict {
    let taken = taken(rounds);
    let most_left = MOST_LEFT * (taken.clone().count() as f64).sqrt();
    match (taken.clone().count(), leaves_noise) {
        (0, true) if is_blind => Verdict::CannotJudge,
        (0, true) => Verdict::NothingMissing,
        (0, false) => Verdict::UnknownEffect,
        (_, false) if left > most_left => Verdict::UnknownEffect,
        _ if taken.clone().any(|round| round.tied > 1) => Verdict::Ambiguous,
        _ => Verdict::Named,
    }
}

/// Whether a stage leaves structure, and such a share of the gap that this is no small matter.
fn leaves_much(stage: &Stage, left: f64) -> bool {
    stage.leaves_structure() && left > CLEAR
}

/// Whether what leaves structure is to be believed all the same: one effect alone, that stands out, that is no stronger than it may
/// be, and beside which the patch does not ask for values beyond their ranges.
fn is_sure(base: &Stage, last: &Stage, rounds: &[Round]) -> bool {
    let is_alone = taken(rounds).count() == 1;
    let is_within = |round: &Round| !last.is_strongest(&round.trials[0].candidate);
    is_alone && rounds[0].stands_out() && is_within(&rounds[0]) && last.newly_at_end(base).next().is_none()
}

/// Whether a force over what the patch does explains far more than effects that leave such a share of the gap.
fn is_a_curve(whereabouts: &[Whereabouts], left: f64) -> bool {
    let best = whereabouts.first().and_then(|best| best.best.map(|place| &best.curves[place]));
    best.is_some_and(|curve| 1.0 - curve.explains < CURVE * left * left)
}
