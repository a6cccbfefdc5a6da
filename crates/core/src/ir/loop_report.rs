//! What is wrong with a loop without an integrator, in words.

use super::Loop;
use super::loops::Solutions;
use crate::document::{Code, told};

/// What is wrong with a loop, and what to do about it.
pub(crate) fn remedy(entry: &Loop, solutions: Solutions) -> (Code, &'static str) {
    match solutions {
        Solutions::Counted { count: 0, .. } => (
            Code::LoopWithoutSolution,
            "put an integrator or a lag into the loop, or a relay with hysteresis",
        ),
        Solutions::NotANumber => {
            (Code::LoopWithoutSolution, "look for what goes beyond all numbers in it: a gain, a function")
        }
        Solutions::TooManyPieces => (Code::LoopTooTangled, "put an integrator or a lag into the loop"),
        Solutions::Range => {
            (Code::LoopWithSolutions, "its gain is exactly 1: change it, or put an integrator into the loop")
        }
        _ if entry.is_open => (
            Code::LoopWithSolutions,
            "what is fed back has to rise with the output all the way from -100 V to 100 V: square one sign only, \
             divide by what is above 0",
        ),
        _ => (Code::LoopWithSolutions, "the loop latches up: bring its gain under 1, or invert it once more"),
    }
}

/// A voltage to the microvolt.
fn told_volts(volts: f64) -> String {
    told((volts * 1e6).round() / 1e6)
}

/// The solutions in words.
pub(crate) fn tell(entry: &Loop, solutions: Solutions) -> String {
    let opened = entry.opened();
    match solutions {
        Solutions::Counted { count: 0, .. } => "no set of voltages satisfies it".to_owned(),
        Solutions::Counted { count, first } => {
            let told: Vec<_> =
                first.iter().take(count).map(|volts| format!("{} V", told_volts(*volts))).collect();
            let more = if count > told.len() { ", ..." } else { "" };
            format!("{count} solutions: {opened} at {}{more}", told.join(", "))
        }
        Solutions::Range => format!("a whole range of solutions: {opened} follows itself"),
        Solutions::NotANumber => "a voltage in it that is not a number".to_owned(),
        Solutions::TooManyPieces => "is made of more pieces than can be looked at".to_owned(),
    }
}
