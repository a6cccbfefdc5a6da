//! Data that cannot judge a patch: what leaves nothing but noise is then no proof that nothing is missing.

use super::fit::{Fitted, Point};
use super::limits::Limit;
use super::mistold::Mistold;
use super::model::ModelError;
use super::problem::Problem;
use super::record::Record;
use super::round::Round;
use super::runaway::Runaway;
use super::score::{about_mean, colour};
use super::stage::{COLOURED, Stage};
use super::statistics::mean;
use super::unrest::{NotWhite, SlowNoise};
use patchcord_analysis::instruments::number;

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
    /// The patch explains them with values beyond their ranges, as this tells.
    Beyond(String),
    /// The patch explains them once something is told otherwise.
    Mistold(Mistold),
    /// The patch runs away from them.
    Runaway(Runaway),
}

impl Blind {
    /// The same in words.
    pub fn sentence(&self) -> String {
        match self {
            Blind::Few => "they are no more than the numbers that are fitted".to_owned(),
            Blind::Still => "nothing moves in them beyond the noise".to_owned(),
            Blind::Loud(output, left) => format!(
                "what is left of {output} is {} times its noise, although it looks like noise: there are wild samples in these data, more noise than that, or something too fast for them",
                number(*left)
            ),
            Blind::NotWhite(own) => own.sentence(),
            Blind::Slow(own) => own.sentence(),
            Blind::Changed(left) => format!(
                "what holds in training does not hold in the data held back, of which {} times the noise is left: something has changed by then, or shows there alone",
                number(*left)
            ),
            Blind::Nowhere => {
                "no effect found a place in the patch, whose integrators have to give signals with scales"
                    .to_owned()
            }
            Blind::Effects => "they would show none of the effects that were tried".to_owned(),
            Blind::Beyond(told) => format!(
                "the patch alone explains them with {told}: widen that if the value may be true; something is missing if it may not"
            ),
            Blind::Mistold(own) => own.sentence(),
            Blind::Runaway(own) => own.sentence(),
        }
    }
}

/// By chance data held back leave less than so many times what training leaves, or than the noise.
const CHANGED: f64 = 2.0;
/// What is left of them lies less than so many standard deviations above that of training by chance.
const BY_CHANCE: f64 = 5.0;
/// From so many samples on what looks like noise is some.
const ENOUGH: usize = 100;
/// What looks like noise is no more than so many times as much.
pub(super) const LOUD: f64 = 2.0;

/// Whether what explains an output in training does not explain it in what was held back.
pub(super) fn has_changed(stage: &Stage, output: usize) -> bool {
    let [was, is] = [&stage.train, &stage.test].map(|fitted| squares(&fitted.residuals, output));
    is_more(&was, &is, stage.memory)
}

/// What is left of an output, rms over its noise.
pub(super) fn over_sigma(fitted: &Fitted, output: usize) -> f64 {
    mean(&squares(&fitted.residuals, output)).sqrt()
}

/// What is left of an output in squares over the noise, sample by sample.
fn squares(residuals: &[Vec<Vec<f64>>], output: usize) -> Vec<f64> {
    let tracks = residuals.iter().flat_map(|record| record[output].iter());
    tracks.filter(|own| !own.is_nan()).map(|own| own * own).collect()
}

/// Whether squares that remember for so many samples are more than others, or than the noise, by so much that it is no chance.
fn is_more(before: &[f64], after: &[f64], memory: f64) -> bool {
    let (was, is) = (mean(before).max(1.0), mean(after));
    // The mean of the squares of m normal numbers is off by sqrt(2 / m) of itself.
    let [learnt, held] = [before, after].map(|own| 2.0 * memory / own.len().max(1) as f64);
    let by_chance = BY_CHANCE * (learnt * was * was + held * is * is).sqrt();
    is > CHANGED * CHANGED * was || is - was > by_chance
}

impl Problem {
    /// Whether what explains training does not explain what was held back, of any output.
    pub(super) fn has_changed(&self, stage: &Stage) -> bool {
        (0..self.outputs.len()).any(|output| has_changed(stage, output))
    }

    /// Why the data cannot judge a patch that leaves nothing but noise; nothing where they can.
    ///
    /// # Errors
    /// When the patch cannot be run beside the records.
    pub(super) fn is_blind(
        &self,
        base: &Stage,
        rounds: &[Round],
        limits: &[Limit],
    ) -> Result<Option<Blind>, ModelError> {
        if base.train.count <= base.train.free {
            return Ok(Some(Blind::Few));
        }
        let needed = rounds.first().map_or(0.0, |round| round.needed);
        if self.motion(base) < needed * base.memory {
            return Ok(Some(Blind::Still));
        }
        let left =
            self.outputs.iter().enumerate().map(|(place, name)| (name, over_sigma(&base.train, place)));
        if let Some((output, left)) = left.max_by(|a, b| a.1.total_cmp(&b.1)).filter(|own| own.1 > LOUD) {
            return Ok(Some(Blind::Loud(output.clone(), left)));
        }
        if self.has_changed(base) && !self.holds_for_all(base)? {
            return Ok(Some(Blind::Changed(base.test.over_noise())));
        }
        if rounds.iter().all(|round| round.trials.is_empty()) {
            return Ok(Some(Blind::Nowhere));
        }
        Ok((!limits.iter().any(Limit::is_seen)).then_some(Blind::Effects))
    }

    /// Whether the training data look like noise about a constant; few look like that that are none.
    pub(super) fn is_noise_alone(&self) -> bool {
        let over_noise = |(track, sigma): (&Vec<f64>, &f64)| {
            about_mean(track).into_iter().map(|own| own / sigma).collect::<Vec<f64>>()
        };
        let of = |record: &Record| record.outputs.iter().zip(&self.sigma).map(over_noise).collect();
        let all: Vec<Vec<Vec<f64>>> = self.train.iter().map(of).collect();
        let is_enough = all.iter().flatten().all(|track| track.len() >= ENOUGH);
        let is_quiet = |output: usize| mean(&squares(&all, output)) < LOUD * LOUD;
        is_enough && (0..self.outputs.len()).all(is_quiet) && colour(&all) < COLOURED
    }

    /// Whether the patch explains all data when it is fitted to all: what training left open may have led it astray in what was
    /// held back, as where motion sticks.
    fn holds_for_all(&self, base: &Stage) -> Result<bool, ModelError> {
        let records = [self.train.as_slice(), &self.test].concat();
        let initial = [base.train.point.initial.as_slice(), &base.test.point.initial].concat();
        let model = self.model(&base.version, &records, &self.outputs)?;
        let start = Point { initial, ..base.train.point.clone() };
        let Some(fitted) = self.task(&model, &records, true).fit(&start) else { return Ok(false) };
        let (train, test) = fitted.residuals.split_at(self.train.len());
        let is_explained = |output: usize| {
            let was = squares(&base.train.residuals, output);
            let parts = [train, test].map(|part| squares(part, output));
            parts.iter().all(|is| !is_more(&was, is, base.memory))
        };
        Ok((0..self.outputs.len()).all(is_explained))
    }

    /// What the patch explains of the training data beside a constant, in squares over the noise.
    fn motion(&self, base: &Stage) -> f64 {
        let tracks = self.train.iter().zip(&base.train.residuals).flat_map(|(record, left)| {
            record.outputs.iter().zip(left).zip(&self.sigma).map(|((data, left), sigma)| {
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
}
