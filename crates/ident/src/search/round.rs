//! What was tried on a patch, every trial held against the best, and whether that is taken.

use std::mem;

use crate::effects::candidate::Candidate;
use crate::fit::estimate::Fitted;
use crate::fit::extended_model::LeftOut;
use crate::fit::fitted_model::Stage;
use crate::statistics::acceptance::{APART, Bar, CONFIRMED, needed};
use crate::statistics::block_comparison::{Advantage, advantage};

/// An effect wired in and fitted.
#[derive(Debug, Clone)]
pub struct Trial {
    /// The effect at its place.
    pub candidate: Candidate,
    /// The patch with it, fitted.
    pub stage: Stage,
    /// By how much it is better than the patch without it: (chi2 without - chi2 with) / (s2 m) - k ln(n / m). Here n is how many
    /// data there are and k how many parameters more are fitted (Schwarz); what the best trial leaves is s2, in squares over the
    /// noise, and remembers m samples. Initial voltages do not count: what one does dies away, and more data tell no more of it.
    pub score: f64,
    /// How the best trial stands above it.
    pub behind: Advantage,
}

/// What was tried on one patch.
#[derive(Debug, Clone)]
pub struct Round {
    /// The patch without the effects that were tried.
    pub before: Stage,
    /// The effects that stand in that, found in other rounds: none in the first, unless that was gone through again beside the others.
    pub beside: Vec<String>,
    /// Every trial, the best first.
    pub trials: Vec<Trial>,
    /// What could not be tried.
    pub left_out: Vec<LeftOut>,
    /// What the best does for the records that were held back.
    pub confirmed: Advantage,
    /// The score that the best must have: more where more was tried.
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

/// Where a trial leaves but noise, so much on what is held back at most, in squares, all that it gains there is its own doing.
const NOISE: f64 = 1.2;

/// A trial that fits more numbers than the best is a rival only if its score is lower by less than this.
const APART_BY: f64 = 6.0;
/// What stands less than so many standard errors above its alias is that.
const NO_ALIAS: f64 = 1.0;
/// An effect beside others must close such a share of what they leave, in squares, or all of it that is no noise.
pub(crate) const LEAST_CLOSED: f64 = 0.5;
/// The score of an effect beside others must be so many times what that of a single one must be: the law of another may have a
/// slightly other shape.
const BESIDE: f64 = 2.0;
/// An effect is gone on from although it is not confirmed if it is better on what is held back by so many standard errors, and
/// more is missing: beside that it may be.
const PROMISING: f64 = 1.0;
/// So many effects are gone on from where none is taken alone.
const MOST_HOPES: usize = 3;
/// An effect stands out where every other leaves so many times what it leaves, in squares.
const STANDS_OUT: f64 = 3.0;

impl Trial {
    /// How many numbers are fitted.
    fn numbers(&self) -> usize {
        self.stage.version.fit.len()
    }

    /// Whether it leaves but noise, on the data held back, too.
    fn foretells(&self) -> bool {
        !self.stage.leaves_structure() && self.stage.test.reduced() < NOISE
    }

    /// Whether it needs more numbers than an alias, above which it hardly stands, and leaves structure: there more numbers follow
    /// what neither explains.
    fn is_but(&self, other: &Trial, above: f64) -> bool {
        let is_richer = self.numbers() > other.numbers() && self.stage.leaves_structure();
        is_richer && above < NO_ALIAS && self.candidate.may_be(&other.candidate)
    }

    /// How another stands above it, on all records. What has changed by the time of the test blurs that: where the other leaves
    /// structure with no more numbers, the records that both were fitted to say it, unless the test is on this one's side.
    fn behind(&self, other: &Trial) -> Advantage {
        let train = advantage(&self.stage.train.residuals, &other.stage.train.residuals);
        let all = train.and(advantage(&self.stage.test.residuals, &other.stage.test.residuals));
        let is_fair = other.numbers() <= self.numbers() && other.stage.leaves_structure();
        if is_fair && all.sum > 0.0 && train.ratio() > all.ratio() { train } else { all }
    }
}

impl Round {
    /// Judges the trials again with a better fit of the one that was taken; what is best then, if it is to be gone on from still: what
    /// was taken is not, where it would but promise.
    pub(crate) fn refit(&mut self, taken: Stage) -> Option<Trial> {
        let mut tried: Vec<(Candidate, Stage)> =
            self.trials.iter().map(|trial| (trial.candidate.clone(), trial.stage.clone())).collect();
        tried.first_mut()?.1 = taken;
        let again = Round::of(&self.before, self.beside.clone(), tried);
        let goes_on = again.taken || (self.promising && again.promising);
        let best = goes_on.then(|| again.trials[0].clone())?;
        *self = Round { left_out: mem::take(&mut self.left_out), ..again };
        Some(best)
    }

    /// The places of the trials that close most, one of an effect, that may belong to what is missing beside something else; not
    /// that of one which was gone on from.
    pub(crate) fn hopes(&self) -> Vec<usize> {
        let names: Vec<&str> = self.trials.iter().map(|trial| trial.candidate.effect.as_str()).collect();
        let is_hope = |place: &usize| {
            let trial = &self.trials[*place];
            let closes = trial.score > self.needed && trial.stage.closed(&self.before) > LEAST_CLOSED;
            closes && trial.stage.leaves_structure() && !names[..*place].contains(&names[*place])
        };
        (usize::from(self.promising)..names.len()).filter(is_hope).take(MOST_HOPES).collect()
    }

    /// Whether the search goes on with the best.
    pub(crate) fn is_gone_on_from(&self) -> bool {
        self.taken || self.promising
    }

    /// The share of the gap, in squares, that the best closes.
    pub fn closed(&self) -> f64 {
        self.trials.first().map_or(0.0, |best| best.stage.closed(&self.before))
    }

    /// Whether the best does enough to stand beside what was taken before it: most of what is left, or all that does not look
    /// like noise. An effect whose law has another shape than the library's leaves something, too.
    pub fn closes_enough(&self) -> bool {
        let leaves_noise = self.trials.first().is_some_and(|best| !best.stage.leaves_structure());
        self.beside.is_empty() || leaves_noise || self.closed() > LEAST_CLOSED
    }

    /// The trials that the data cannot tell from the best of all.
    pub fn rivals(&self) -> impl Iterator<Item = &Trial> {
        self.trials.iter().skip(1).filter(|trial| self.is_tied(trial))
    }

    /// The best of them.
    pub fn rival(&self) -> Option<&Trial> {
        self.rival_place().map(|place| &self.trials[place])
    }

    pub(crate) fn rival_place(&self) -> Option<usize> {
        (1..self.trials.len()).find(|place| self.is_tied(&self.trials[*place]))
    }

    /// Trials on a stage, judged.
    pub(crate) fn of(before: &Stage, beside: Vec<String>, tried: Vec<(Candidate, Stage)>) -> Round {
        let unit = unit(tried.iter().map(|(_, stage)| stage));
        let each = libm::log(before.train.count as f64 / unit.1);
        let score = |stage: &Stage| {
            let numbers = (stage.version.fit.len() - before.version.fit.len()) as f64;
            (before.train.chi2 - stage.train.chi2) / (unit.0 * unit.1) - numbers * each
        };
        let nothing = Advantage { sum: 0.0, error: 0.0, freedom: 0 };
        let trial = |(candidate, stage): (Candidate, Stage)| Trial {
            score: score(&stage),
            candidate,
            stage,
            behind: nothing,
        };
        let mut trials: Vec<Trial> = tried.into_iter().map(trial).collect();
        trials.sort_by(|a, b| b.score.total_cmp(&a.score));
        let needed = needed(trials.len());
        let needed = if beside.is_empty() { needed } else { BESIDE * needed };
        let mut round = Round {
            before: before.clone(),
            beside,
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

    /// What the trials were measured by.
    pub(crate) fn bar(&self) -> Bar {
        let (noise, memory) = unit(self.trials.iter().map(|trial| &trial.stage));
        Bar { noise, memory, needed: self.needed }
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
        // Of what the scores cannot tell apart, what foretells the data held back goes first.
        let foretelling = (1..self.trials.len()).find(|place| self.foretells_more(&self.trials[*place]));
        self.put_first(foretelling);
        let Some(best) = self.trials.first() else { return };
        self.confirmed = advantage(&self.before.test.residuals, &best.stage.test.residuals);
        let shows = best.score > self.needed && self.closes_enough();
        let gains = best.foretells() && self.confirmed.sum > self.needed * best.stage.memory;
        self.taken = shows && (self.confirmed.ratio() > CONFIRMED || gains);
        let may_be = self.confirmed.ratio() > PROMISING && self.closed() > LEAST_CLOSED;
        self.promising = shows && !self.taken && may_be && best.stage.leaves_structure();
        self.tied = 1 + self.rivals().count();
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

    /// Whether a trial does with fewer numbers as well as the best, where that leaves structure.
    fn is_simpler(&self, trial: &Trial) -> bool {
        let best = &self.trials[0];
        let has_fewer = trial.numbers() < best.numbers() && best.stage.leaves_structure();
        let is_no_worse = trial.behind.sum <= 0.0 || best.is_but(trial, trial.behind.ratio());
        has_fewer && trial.score > self.needed && is_no_worse
    }

    /// Whether a trial with the best's score leaves but noise on the data held back, and the best does not.
    fn foretells_more(&self, trial: &Trial) -> bool {
        let best = &self.trials[0];
        let is_near = trial.score > self.needed && best.score - trial.score < APART_BY;
        is_near && trial.foretells() && !best.foretells()
    }

    /// Whether all other effects leave far more than the best.
    pub(crate) fn stands_out(&self) -> bool {
        let Some(best) = self.trials.first() else { return false };
        let others = self.trials.iter().filter(|trial| trial.candidate.effect != best.candidate.effect);
        let least = others.map(|trial| trial.stage.train.unexplained()).fold(f64::INFINITY, f64::min);
        least > STANDS_OUT * best.stage.train.unexplained()
    }

    /// By how much a trial's score is lower than the best's, where that alone tells them apart: the data held back do not.
    pub fn lower_in_score(&self, trial: &Trial) -> Option<f64> {
        let lower = self.trials[0].score - trial.score;
        (trial.behind.ratio() < APART && lower > 0.0).then_some(lower)
    }

    /// Whether the data cannot tell a trial from the best, which is of another effect.
    pub(crate) fn is_tied(&self, trial: &Trial) -> bool {
        let best = &self.trials[0];
        // One that needs more numbers has to be worth them.
        let is_simple = trial.numbers() <= best.numbers();
        let is_worth_them = trial.behind.sum < 0.0 || !best.stage.leaves_structure();
        let is_near = best.score - trial.score < APART_BY && is_worth_them || is_simple;
        let is_near = is_near && trial.behind.ratio() < APART;
        // What leaves structure where another leaves noise, or far less structure, is no rival.
        let leaves_far_more = |of: fn(&Stage) -> &Fitted| {
            of(&trial.stage).unexplained() > STANDS_OUT * of(&best.stage).unexplained()
        };
        let is_far = leaves_far_more(|stage| &stage.train) && leaves_far_more(|stage| &stage.test);
        let is_as_good = !trial.stage.leaves_structure() || best.stage.leaves_structure() && !is_far;
        let is_as_good = is_as_good && !trial.is_but(best, -trial.behind.ratio());
        trial.candidate.effect != best.candidate.effect && trial.score > self.needed && is_near && is_as_good
    }
}

/// Whether the best of so many trials gains what its score must be, the numbers that it needs left out, were what it leaves white.
pub(crate) fn may_show(before: &Stage, best: &Stage, trials: usize) -> bool {
    before.train.chi2 - best.train.chi2 > needed(trials) * best.train.reduced()
}

/// What the best of some trials leaves, in squares over the noise, and for how many samples that remembers: the unit of scores.
fn unit<'s>(tried: impl Iterator<Item = &'s Stage>) -> (f64, f64) {
    let best = tried.min_by(|a, b| a.train.chi2.total_cmp(&b.train.chi2));
    best.map_or((1.0, 1.0), |best| (best.train.reduced().max(f64::MIN_POSITIVE), best.memory))
}

impl Trial {
    /// The effect and where it acts.
    pub fn named(&self) -> String {
        self.candidate.named()
    }
}

#[cfg(test)]
mod tests {
    use crate::effects::attach::Attached;
    use crate::fit::base_fit::fit_base;
    use crate::fit::extended_model::fit_trial;
    use crate::fit::extended_model::sites_of;
    use crate::fit::peaks::peaks_of;
    use std::path::Path;

    use super::*;
    use crate::Experiment;
    use crate::effects::Library;
    use crate::fit::extended_model::Asked;
    use crate::fit::problem::Problem;
    use crate::fit::schedule::Effort;

    /// A pump at its limit, wired where it is missing and looked at quickly: what a trial is made of.
    fn any() -> (Candidate, Stage) {
        let path = Path::new("tests/hidden/saturation/experiment.json");
        let experiment = Experiment::read(path).unwrap_or_else(|error| panic!("{error}"));
        let problem = Problem::of(&experiment).unwrap();
        let base = fit_base(&problem, &experiment.patch, &experiment.fit, 1).unwrap().unwrap();
        let (sites, peaks) = (sites_of(&problem, &base).unwrap(), peaks_of(&problem, &base).unwrap());
        let library = Library::shipped();
        let mut all = library.iter().flat_map(|effect| Attached::all(effect, &sites));
        let limit = all.find(|own| own.effect.name == "saturation").unwrap();
        let asked = Asked { effort: Effort::QUICK, wanted: f64::INFINITY, before: None, known: None };
        fit_trial(&problem, &base, &limit, &peaks, asked).unwrap()
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
        let round = Round::of(&before, Vec::new(), tried);
        (round.trials[0].candidate.effect.clone(), round.tied)
    }

    #[test]
    fn where_structure_is_left_the_simpler_goes_before_what_is_no_better() {
        let like = any();
        let beside = |simple: &str, test: [f64; 2], colour: f64| {
            let mut rich = trial(&like, "rich", 4, 9.0, test);
            rich.1.colour = colour;
            judged(&like, vec![trial(&like, simple, 3, 10.0, [20.0; 2]), rich])
        };
        let of = |test: [f64; 2], colour: f64| beside("simple", test, colour);
        assert_eq!(of([28.6, 5.0], 100.0), ("simple".to_owned(), 1));
        // What is better, though not beyond doubt, or leaves but noise, is not put behind.
        assert_eq!(of([28.0, 5.0], 100.0), ("rich".to_owned(), 2));
        assert_eq!(of([28.6, 5.0], 0.0), ("rich".to_owned(), 1));
        // It is but its alias, if it is not clearly better.
        let of = |test: [f64; 2]| beside(&like.0.aliases[0], test, 100.0);
        assert_eq!(of([28.0, 5.0]), ("overflow".to_owned(), 1));
        assert_eq!(of([24.0, 5.0]), ("rich".to_owned(), 2));
    }

    #[test]
    fn what_was_taken_is_not_gone_on_from_where_a_better_fit_only_promises() {
        let like = any();
        let (_, before) = trial(&like, "", 2, 100.0, [100.0; 2]);
        let refit = |test: [f64; 2], better: [f64; 2]| {
            let of = |train, test| trial(&like, "a", 3, train, test);
            let mut round = Round::of(&before, Vec::new(), vec![of(9.0, test)]);
            let was = (round.taken, round.promising);
            (was, round.refit(of(8.9, better).1).map(|_| (round.taken, round.promising)))
        };
        let (taken, promising) = ((true, false), (false, true));
        assert_eq!(refit([0.0, 110.0], [0.0, 109.0]), (taken, Some(taken)));
        assert_eq!(refit([0.0, 110.0], [0.0, 122.0]), (taken, None));
        assert_eq!(refit([0.0, 122.0], [0.0, 121.0]), (promising, Some(promising)));
        assert_eq!(refit([0.0, 122.0], [0.0, 110.0]), (promising, Some(taken)));
    }

    #[test]
    fn what_gains_less_than_any_score_asks_for_does_not_show() {
        let like = any();
        let of = |height: f64| trial(&like, "", 3, height, [1.0; 2]).1;
        // Noise of 2000 samples, of which 40 trials ask for 11 squares.
        let shows = |height: f64| may_show(&of(1.414), &of(height), 40);
        assert!(shows(1.409) && !shows(1.411));
    }

    #[test]
    fn of_equal_scores_what_foretells_the_test_goes_before_what_does_not() {
        let like = any();
        let of = |train: f64, test: [f64; 2]| {
            let mut best = trial(&like, "best", 3, 1.4, [0.2, 3.0]);
            let mut rival = trial(&like, "rival", 3, train, test);
            (best.1.colour, rival.1.colour) = (0.0, 0.0);
            judged(&like, vec![best, rival]).0
        };
        assert_eq!(of(1.402, [1.5, 1.5]), "rival");
        // Its score is behind, or the test is no noise to it, either.
        assert_eq!(of(1.8, [1.5, 1.5]), "best");
        assert_eq!(of(1.402, [1.6, 1.6]), "best");
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
