//! Describes the faults of loops without an integrator in words.

use super::{Loop, Solutions};
use crate::document::{Code, format_number};
use patchcord_expr::format_significant;

/// The diagnostic code of a fault, and a hint what to do.
pub(crate) fn remedy(entry: &Loop, solutions: Solutions) -> (Code, &'static str) {
    match solutions {
        Solutions::Counted { count: 0, .. } => (
            Code::LOOP_WITHOUT_SOLUTION,
            "put an integrator or a lag into the loop, or a relay with hysteresis",
        ),
        Solutions::NotANumber => {
            (Code::LOOP_WITHOUT_SOLUTION, "look for a gain or a function in it that overflows")
        }
        Solutions::TooManyPieces | Solutions::Inexact { .. } => {
            (Code::LOOP_TOO_TANGLED, "put an integrator or a lag into the loop")
        }
        Solutions::Range => (
            Code::LOOP_WITH_SOLUTIONS,
            "its gain is exactly 1: change it, or put an integrator into the loop",
        ),
        _ if entry.tears.iter().any(|tear| tear.amplification.is_some()) => (
            Code::LOOP_WITH_SOLUTIONS,
            "the feedback must rise with the output from -100 V to 100 V: square one sign only, divide by a positive \
             voltage",
        ),
        _ => {
            (Code::LOOP_WITH_SOLUTIONS, "the loop latches up: bring its gain under 1, or invert it once more")
        }
    }
}

/// A voltage rounded to the microvolt.
fn format_volts(volts: f64) -> String {
    format_number((volts * 1e6).round() / 1e6)
}

/// The solutions in words that continue "the loop ... has no integrator and".
pub(crate) fn describe_solutions(entry: &Loop, solutions: Solutions) -> String {
    match solutions {
        Solutions::Counted { count: 0, .. } => "no set of voltages satisfies it".to_owned(),
        Solutions::Counted { count, tear, first } => {
            let listed: Vec<_> =
                first.iter().take(count).map(|volts| format!("{} V", format_volts(*volts))).collect();
            let more = if count > listed.len() { ", ..." } else { "" };
            format!("{count} solutions: {} at {}{more}", entry.tears[tear].name, listed.join(", "))
        }
        Solutions::Range => {
            let opened: Vec<_> = entry.openers().collect();
            format!("a continuous range of solutions for {}", opened.join(", "))
        }
        Solutions::NotANumber => "a voltage in it that is not a number".to_owned(),
        Solutions::TooManyPieces => "is made of more pieces than the search examines".to_owned(),
        Solutions::Inexact { tear, volts } => format!(
            "amplifies rounding: {} differs from what its inputs give by {} V",
            entry.tears[tear].name,
            format_significant(volts, 2)
        ),
    }
}
