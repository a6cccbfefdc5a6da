//! Why data cannot judge a patch, in words.

use crate::fit::coloured_residual::{Cause, NotWhite};
use crate::report::ranges::extension_text;
use crate::residuals::divergence::Runaway;
use crate::residuals::misspecification::{Mistold, Otherwise};
use crate::residuals::residual_analysis::{BROUGHT, SlowNoise};
use crate::search::inconclusive::Blind;
use crate::search::range_extension::Beyond;
use patchcord_analysis::instruments::number;

/// What to do about a patch that diverges.
const ADVICE: &str = "look at the signs in its loops, or write \"pieces\" where it is to run away";

/// Why the data are inconclusive; `beyond` is the patch with wider ranges, if there is one.
pub fn inconclusive_sentence(reason: &Blind, beyond: Option<&Beyond>) -> String {
    match reason {
        Blind::Few => "they are no more than the numbers that are fitted".to_owned(),
        Blind::Still => "nothing moves in them beyond the noise".to_owned(),
        Blind::Loud(output, left) => format!(
            "what is left of {output} is {} times its noise, although it looks like noise: there are wild samples in these data, more noise than that, or something too fast for them",
            number(*left)
        ),
        Blind::NotWhite(own) => coloured_sentence(own),
        Blind::Slow(own) => slow_noise_sentence(own),
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
            beyond.map(extension_text).unwrap_or_default()
        ),
        Blind::Mistold(own) => misspecification_sentence(own),
        Blind::Runaway(own) => divergence_sentence(own),
    }
}

/// Why a residual is coloured although nothing is missing.
pub fn coloured_sentence(residual: &NotWhite) -> String {
    let (output, left) = (&residual.output, number(residual.left));
    match &residual.cause {
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

/// Why a residual is slow noise of a sensor.
pub fn slow_noise_sentence(noise: &SlowNoise) -> String {
    format!(
        "what is left of {} goes like slow noise of its sensor, which that remembers for about {} s, rather than like a force at any junction",
        noise.output,
        number(noise.seconds)
    )
}

/// What is specified wrongly, what the patch leaves with it and without it, and where to look.
pub fn misspecification_sentence(wrong: &Mistold) -> String {
    let ([before, after], told) = (wrong.leaves.map(number), respecification_text(&wrong.otherwise));
    let advice = respecification_advice(&wrong.otherwise);
    format!("with {told} the patch leaves {after} times the noise, and {before} as it is: {advice}")
}

fn respecification_text(otherwise: &Otherwise) -> String {
    match otherwise {
        Otherwise::Turned(names) => format!("{} turned round", names.join(", ")),
        Otherwise::Thousandth(names) => format!("a thousandth of {}", names.join(", ")),
        Otherwise::Thousandfold(names) => format!("a thousand times {}", names.join(", ")),
        Otherwise::ThousandthOfTimes => "a thousandth of all times".to_owned(),
        Otherwise::ThousandfoldTimes => "a thousand times all times".to_owned(),
    }
}

/// Where to look.
fn respecification_advice(otherwise: &Otherwise) -> &'static str {
    match otherwise {
        Otherwise::Turned(_) => "look at the signs of signal, column and drives",
        Otherwise::Thousandth(_) | Otherwise::Thousandfold(_) => {
            "look at the units of columns and drives, which are those of the signals where no \"unit\" is told, and of parameters"
        }
        Otherwise::ThousandthOfTimes | Otherwise::ThousandfoldTimes => {
            "look at the unit of \"time\", which is s where none is told, and at what makes the patch quick or slow: jacks of integrators, units of parameters"
        }
    }
}

/// How far a patch diverges from the data, and what to do about it.
pub fn divergence_sentence(divergence: &Runaway) -> String {
    let Runaway { output, left, moves, growth } = divergence;
    let [left, moves, growth] = [left, moves, growth].map(|own| number(*own));
    format!(
        "the patch runs away: it leaves {left} times the noise of {output}, which moves by {moves}, and what is changed of its initial voltages grows more than {growth} times: {ADVICE}"
    )
}
