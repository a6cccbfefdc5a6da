//! Why data cannot judge a patch, in words.

use crate::fit::coloured_residual::{Cause, NotWhite};
use crate::residuals::divergence::ADVICE;
use crate::residuals::residual_analysis::BROUGHT;
use crate::search::inconclusive::Blind;
use crate::search::range_extension::Beyond;
use patchcord_analysis::instruments::number;

impl NotWhite {
    /// The same in words.
    pub fn sentence(&self) -> String {
        let (output, left) = (&self.output, number(self.left));
        match &self.cause {
            Cause::Drives(drives, brought) => format!(
                "what is left of {output}, {left} times its noise, is no more than noise of {} may bring, {} times: measure that better, or tell its \"sigma\", which is 0 of what is set and not measured",
                drives.join(", "),
                number((1.0 + BROUGHT * brought * brought).sqrt())
            ),
            Cause::Runaway(drives) => format!(
                "the patch runs away: what is left of {output}, {left} times its noise, is more than that moves, and noise of {} would grow as far: {ADVICE}",
                drives.join(", ")
            ),
            Cause::Between(drives, smooth) => format!(
                "what is left of {output}, {left} times its noise, is what straight lines between the samples of {} bring: going on smoothly it leaves {} times; write \"hold\": \"smooth\" if that is how it went, or take samples closer together",
                drives.join(", "),
                number(*smooth)
            ),
            Cause::Own => format!(
                "what is left of {output} is no more than its noise, {left} times, but not white: that noise is slow, or less than that, which its \"sigma\" would tell"
            ),
        }
    }
}

impl Blind {
    /// The same in words; `beyond` is what the patch comes to beyond its ranges.
    pub fn sentence(&self, beyond: Option<&Beyond>) -> String {
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
            Blind::Beyond => format!(
                "the patch alone explains them with {}: widen that if the value may be true; something is missing if it may not",
                beyond.map(Beyond::told).unwrap_or_default()
            ),
            Blind::Mistold(own) => own.sentence(),
            Blind::Runaway(own) => own.sentence(),
        }
    }
}
