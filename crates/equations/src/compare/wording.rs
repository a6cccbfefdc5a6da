//! The differences and the obstacles of a comparison in words.

use super::model::Obstacle;
use super::terms::{DifferenceKind, TermDifference, is_negative};
use crate::symbolic::Fraction;

impl Obstacle {
    /// The obstacle as a clause.
    pub(super) fn text(&self) -> String {
        match self {
            Obstacle::Unknown(name) => format!("{name} is not known"),
            Obstacle::Implicit(name) => {
                format!("{name} is the solution of a loop without a formula")
            }
            Obstacle::Unsettled(name) => {
                format!("the value at t = 0 depends on {name}, which is no parameter")
            }
        }
    }
}

/// A difference as a clause.
pub(super) fn clause(
    difference: &TermDifference,
    time_scale: f64,
    write: &dyn Fn(&Fraction) -> String,
) -> String {
    let size = |value: &Fraction| write(&if is_negative(value) { value.negated() } else { value.clone() });
    match difference.kind {
        DifferenceKind::Sign => format!("the sign of {} is wrong", size(&difference.stated)),
        DifferenceKind::Missing => format!("the term {} is missing", write(&difference.stated)),
        DifferenceKind::Extra => format!("the term {} is not in the equation", write(&difference.wired)),
        DifferenceKind::Factor(factor) => {
            let sign = if factor < 0.0 { "has the wrong sign and " } else { "" };
            let (times, word) =
                if factor.abs() < 1.0 { (1.0 / factor.abs(), "small") } else { (factor.abs(), "large") };
            let times = patchcord_expr::format_significant(times, FACTOR_DIGITS);
            let reason = if is_power_of(factor.abs(), time_scale) { ", by the time scale" } else { "" };
            let is = if sign.is_empty() { "is" } else { "and is" };
            let sign = sign.trim_end_matches("and ");
            format!("the term {} {sign}{is} {times} times too {word}{reason}", write(&difference.stated))
        }
    }
}

/// Significant digits of a factor in a message.
const FACTOR_DIGITS: usize = 4;

/// Whether a factor is the time scale, its square, or the reciprocal of either.
fn is_power_of(factor: f64, time_scale: f64) -> bool {
    let is_near = |power: i32| (factor / time_scale.powi(power) - 1.0).abs() < 1e-9;
    time_scale != 1.0 && [-2, -1, 1, 2].into_iter().any(is_near)
}
