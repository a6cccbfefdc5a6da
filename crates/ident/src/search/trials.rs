//! The trials of a round: every effect at every place looked at quickly, then the best gone through with.

use std::cmp::Reverse;

use crate::effects::attach::Attached;
use crate::effects::candidate::Candidate;
use crate::fit::base_fit::finish;
use crate::fit::extended_model::fit_trial;
use crate::fit::extended_model::sites_of;
use crate::fit::extended_model::{Asked, LeftOut, Untried};
use crate::fit::fitted_model::Stage;
use crate::fit::model::ModelError;
use crate::fit::peaks::Peaks;
use crate::fit::peaks::peaks_of;
use crate::fit::problem::Problem;
use crate::fit::schedule::Effort;
use crate::search::means::Means;
use crate::search::progress::{Part, Progress};
use crate::search::round::{Round, may_show};
use patchcord_analysis::pool;

/// So many of the best trials are fitted to ever more of the records, where all leave a large gap.
const GROWN: usize = 6;
/// So many trials are gone through with, those that a quick look finds best,
const TRIED_FULLY: usize = 12;
/// or so many, and what stood there, where an effect is looked at again beside others.
const TRIED_AGAIN: usize = 6;
/// What needs fewer numbers than the best is gone through with, too, where it leaves less than this times what that leaves.
const NEAR_ENOUGH: f64 = 3.0;
/// Trials that leave less than this times what the best leaves are near it: all forms of those are gone through with, and they
/// are looked after where they do not hold for the test.
const NEAR: f64 = 1.5;

/// What is tried on a stage.
pub(crate) struct Trying<'a> {
    pub problem: &'a Problem,
    pub stage: &'a Stage,
    pub peaks: &'a Peaks,
    /// Every effect at every place.
    pub all: &'a [Attached<'a>],
    /// Where one of them came to before, beside others.
    pub found: Option<&'a Found<'a>>,
    pub threads: usize,
}

/// An effect wired in, and the patch with it fitted.
type Fit = (Candidate, Stage);
/// The same; nothing where it could not be tried.
type Tried = Option<Fit>;

impl Trying<'_> {
    /// Everything tried, with what could not be; `tell` hears what is done, how much of it and how much there is.
    ///
    /// # Errors
    /// When the patch cannot be run beside the records.
    pub fn carried_out(
        &self,
        tell: &mut dyn FnMut(Part, u64, usize),
    ) -> Result<(Vec<Fit>, Vec<LeftOut>), ModelError> {
        let (mut tried, left_out) = self.looked_at(tell);
        let mut order = self.ahead(&tried, if self.found.is_some() { TRIED_AGAIN } else { TRIED_FULLY });
        self.harder(&mut tried, &order, Effort::FULL, Part::Full, tell);
        loop {
            let more = self.not_to_be_left(&tried, &order);
            if more.is_empty() {
                break;
            }
            self.harder(&mut tried, &more, Effort::FULL, Part::Full, tell);
            order.extend(more);
        }
        let is_far = order.iter().flat_map(|place| &tried[*place]).all(|(_, stage)| stage.is_far());
        if is_far && !self.problem.is_cut {
            let order = self.ahead(&tried, GROWN);
            self.harder(&mut tried, &order, Effort::GROWING, Part::Growing, tell);
        }
        Ok((self.finished(tried.into_iter().flatten().collect())?, left_out))
    }

    fn attempt(&self, place: usize, asked: Asked<'_>) -> Result<Fit, Untried> {
        fit_trial(self.problem, self.stage, &self.all[place], self.peaks, asked)
    }

    /// All of them, quickly.
    fn looked_at(&self, tell: &mut dyn FnMut(Part, u64, usize)) -> (Vec<Tried>, Vec<LeftOut>) {
        let places: Vec<usize> = (0..self.all.len()).collect();
        let wanted = self.stage.train.chi2;
        let look = |place: &usize| {
            let known = self.found.and_then(|found| found.values_of(&self.all[*place]));
            self.attempt(*place, Asked { effort: Effort::QUICK, wanted, before: None, known })
        };
        let tried = pool::each(&places, self.threads, look, |done| tell(Part::Quick, done, places.len()));
        let pairs = self.all.iter().zip(&tried);
        let left_out = pairs.filter_map(|(own, tried)| Some(LeftOut::of(own, tried.as_ref().err()?)));
        let left_out = left_out.collect();
        (tried.into_iter().map(Result::ok).collect(), left_out)
    }

    /// The places of so many of the best, and of what stood there before.
    fn ahead(&self, tried: &[Tried], most: usize) -> Vec<usize> {
        let mut order = best_of(tried, most);
        let stood = self.all.iter().position(|own| self.found.is_some_and(|found| found.is(own)));
        order.extend(stood.filter(|place| !order.contains(place) && tried[*place].is_some()));
        order
    }

    /// Those in some places, with more effort: what cannot be fitted so stays as it was with less.
    fn harder(
        &self,
        tried: &mut [Tried],
        places: &[usize],
        effort: Effort,
        part: Part,
        tell: &mut dyn FnMut(Part, u64, usize),
    ) {
        let before = self.stage.train.chi2;
        let first = best_of(tried, 1).first().copied();
        // Where there is no hope to come to what the best has come to, no more is needed.
        let best = first.and_then(|place| tried[place].as_ref());
        let reached = best.map_or(before, |(_, stage)| stage.train.chi2.min(before));
        // No thread waits for a long one at the end.
        let mut order = places.to_vec();
        order.sort_by_key(|place| Reverse(tried[*place].as_ref().map_or(0, |(_, own)| own.version.work())));
        let go_on = |place: &usize| {
            let wanted = if Some(*place) == first { before } else { reached };
            let come = tried[*place].as_ref().map(|(_, stage)| stage);
            self.attempt(*place, Asked { effort, wanted, before: come, known: None }).ok()
        };
        let again = pool::each(&order, self.threads, go_on, |done| tell(part, done, order.len()));
        for (place, again) in order.iter().zip(again) {
            let gone_through = again.is_some();
            tried[*place] = better_of(tried[*place].take(), again);
            tried[*place].iter_mut().for_each(|(_, stage)| stage.gone_through |= gone_through);
        }
    }

    /// What is not left at a quick look, beside what stands in some places: one law has many forms, and where one is near the best,
    /// the others may be ahead of it; and a law that others have in them needs fewer numbers, though many of those may stand before it.
    /// Nothing where even the best gains less than evidence asks for: there is nothing to be ahead in.
    fn not_to_be_left(&self, tried: &[Tried], places: &[usize]) -> Vec<usize> {
        let of = |place: usize| Some((&self.all[place], &tried[place].as_ref()?.1));
        let best = best_of(tried, 1).first().and_then(|best| of(*best));
        let best = best.filter(|(_, stage)| may_show(self.stage, stage, tried.len()));
        let Some((_, reached)) = best else { return Vec::new() };
        let leaves_less = |stage: &Stage, times: f64| stage.train.chi2 < times * reached.train.chi2;
        let near = places.iter().filter_map(|place| of(*place)).filter(|(_, stage)| leaves_less(stage, NEAR));
        let near: Vec<&Attached<'_>> = near.map(|(own, _)| own).collect();
        let may_lead = |place: &usize| {
            let Some((own, stage)) = of(*place).filter(|_| !places.contains(place)) else { return false };
            let is_form_of = |near: &&Attached<'_>| {
                own.effect.name == near.effect.name && own.junction() == near.junction()
            };
            let has_fewer = stage.version.fit.len() < reached.version.fit.len();
            near.iter().any(is_form_of) || has_fewer && leaves_less(stage, NEAR_ENOUGH)
        };
        (0..self.all.len()).filter(may_lead).collect()
    }

    /// Trials with steps that are fine enough where they came to, and begun in the right place where they are held back.
    fn finished(&self, tried: Vec<Fit>) -> Result<Vec<Fit>, ModelError> {
        let best = tried.iter().map(|(_, stage)| stage.train.chi2).fold(f64::INFINITY, f64::min);
        let finished = |(_, stage): &Fit| match stage.train.chi2 < NEAR * best {
            true => finish(self.problem, stage),
            false => Ok(None),
        };
        let again = pool::each(&tried, self.threads, finished, |_| ());
        let pairs = tried.into_iter().zip(again);
        pairs.map(|((candidate, stage), again)| Ok((candidate, again?.unwrap_or(stage)))).collect()
    }
}

/// The places of so many trials, those that left least first.
fn best_of(tried: &[Tried], most: usize) -> Vec<usize> {
    let chi2 = |place: &usize| tried[*place].as_ref().map_or(f64::INFINITY, |(_, stage)| stage.train.chi2);
    let mut order: Vec<usize> = (0..tried.len()).filter(|place| tried[*place].is_some()).collect();
    order.sort_by(|a, b| chi2(a).total_cmp(&chi2(b)));
    order.truncate(most);
    order
}

/// The one of two trials that left less.
fn better_of(one: Tried, other: Tried) -> Tried {
    one.into_iter().chain(other).min_by(|(_, a), (_, b)| a.train.chi2.total_cmp(&b.train.chi2))
}

/// Tries every effect on a stage that has some already; of one it may be known where it came to beside others.
pub(crate) fn run_round(
    problem: &Problem,
    stage: &Stage,
    effects: &[Candidate],
    found: Option<&Found<'_>>,
    with: &Means<'_>,
    progress: &mut impl FnMut(Progress),
) -> Result<Round, ModelError> {
    let sites = sites_of(problem, stage)?;
    let peaks = peaks_of(problem, stage)?;
    let is_new = |own: &Attached<'_>| own.effect.recurs() || effects.iter().all(|effect| !effect.is(own));
    let all = with.library.iter().flat_map(|effect| Attached::all(effect, &sites));
    let all: Vec<Attached<'_>> = all.filter(is_new).collect();
    let number = effects.len() + 1;
    let mut tell = |part, done, all: usize| {
        progress(Progress { round: number, part, done, all: all as u64 });
    };
    let trying = Trying { problem, stage, peaks: &peaks, all: &all, found, threads: with.threads };
    let (tried, left_out) = trying.carried_out(&mut tell)?;
    let mut round = Round::of(stage, effects.iter().map(Candidate::named).collect(), tried);
    round.left_out = left_out;
    Ok(round)
}

/// An effect, and the values that it came to beside others.
pub(crate) struct Found<'a> {
    effect: &'a Candidate,
    pub(crate) values: Vec<f64>,
}

impl<'a> Found<'a> {
    pub(crate) fn of(effect: &'a Candidate, stage: &Stage) -> Self {
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
