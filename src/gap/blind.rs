//! Data that cannot judge a patch: what leaves nothing but noise is then no proof that nothing is missing.

use super::beyond::Beyond;
use super::fit::Fitted;
use super::limits::Limit;
use super::round::Round;
use super::stage::{Problem, Stage};
use super::turned::Turned;
use crate::instruments::number;

/// Why data cannot judge a patch.
#[derive(Debug, Clone, PartialEq)]
pub enum Blind {
    /// They are no more than the numbers that are fitted.
    Few,
    /// A constant explains them as well as the patch does.
    Still,
    /// What explains the training data does not explain those held back: so many times the noise is left of them.
    Changed(f64),
    /// No effect could be tried.
    Nowhere,
    /// No effect that was tried would show, however strong.
    Effects,
    /// The patch explains them with values beyond their ranges, as this tells.
    Beyond(String),
    /// The patch explains their opposite.
    Turned(Turned),
}

impl Blind {
    pub(super) fn beyond(beyond: &Beyond) -> Blind {
        Blind::Beyond(beyond.told())
    }

    /// The same in words.
    pub fn sentence(&self) -> String {
        match self {
            Blind::Few => "they are no more than the numbers that are fitted".to_owned(),
            Blind::Still => "nothing moves in them beyond the noise".to_owned(),
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
            Blind::Turned(turned) => turned.sentence(),
        }
    }
}

/// By chance data held back leave less than so many times what training leaves, or than the noise.
const CHANGED: f64 = 2.0;

/// It lies less than so many standard deviations above that of training by chance.
const BY_CHANCE: f64 = 5.0;

/// Whether what explains an output in training does not explain it in what was held back.
pub(super) fn has_changed(stage: &Stage, output: usize) -> bool {
    let [train, test] = [&stage.train, &stage.test].map(|fitted| over_sigma(fitted, output));
    test > CHANGED * train.max(1.0) || is_beyond_chance(stage, output)
}

/// What is left of an output, rms over its noise.
pub(super) fn over_sigma(fitted: &Fitted, output: usize) -> f64 {
    mean(&squares(fitted, output)).sqrt()
}

fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len().max(1) as f64
}

/// What is left of an output in squares over the noise, sample by sample.
fn squares(fitted: &Fitted, output: usize) -> Vec<f64> {
    let tracks = fitted.residuals.iter().flat_map(|record| record[output].iter());
    tracks.filter(|own| !own.is_nan()).map(|own| own * own).collect()
}

/// Whether what was held back leaves more of an output than training does by so much that it is no chance.
fn is_beyond_chance(stage: &Stage, output: usize) -> bool {
    let parts = [&stage.train, &stage.test].map(|fitted| squares(fitted, output));
    let [was, is] = parts.each_ref().map(|own| mean(own));
    // The mean of the squares of m normal numbers is off by sqrt(2 / m) of itself.
    let [learnt, held] = parts.map(|own| 2.0 * stage.memory / own.len().max(1) as f64);
    let was = was.max(1.0);
    is - was > BY_CHANCE * (learnt * was * was + held * is * is).sqrt()
}

impl Problem {
    /// The same of any output.
    pub(super) fn has_changed(&self, stage: &Stage) -> bool {
        (0..self.outputs.len()).any(|output| has_changed(stage, output))
    }

    /// Why the data cannot judge a patch that leaves nothing but noise; nothing where they can.
    pub(super) fn is_blind(&self, base: &Stage, rounds: &[Round], limits: &[Limit]) -> Option<Blind> {
        if base.train.count <= base.train.free {
            return Some(Blind::Few);
        }
        let needed = rounds.first().map_or(0.0, |round| round.needed);
        if self.motion(base) < needed * base.memory {
            return Some(Blind::Still);
        }
        if self.has_changed(base) {
            return Some(Blind::Changed(base.test.over_noise()));
        }
        if rounds.iter().all(|round| round.trials.is_empty()) {
            return Some(Blind::Nowhere);
        }
        (!limits.iter().any(Limit::is_seen)).then_some(Blind::Effects)
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
            let mean = track.iter().sum::<f64>() / track.len().max(1) as f64;
            track.iter().map(|own| (own - mean).powi(2)).sum::<f64>()
        };
        tracks.map(moved).sum()
    }
}
