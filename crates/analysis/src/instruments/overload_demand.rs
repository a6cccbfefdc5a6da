//! What an overload demands of its amplifier, in words.

use patchcord_core::trace::{Demand, LimitDrive, Overload};
use patchcord_expr::format_significant;

/// The demanded output of an overload, such as "needs 120.0 V". If it is not known, how the integrator was driven
/// against its limit: "driven into +100 V for 1.2 s, by up to 35 V/s".
///
/// # Examples
///
/// ```
/// use patchcord_analysis::instruments::overload_demand;
/// use patchcord_core::trace::{Demand, LimitDrive, Overload};
///
/// let known = Overload { element: "A2".into(), time: 0.3, demand: Demand::Peak(120.0), caused_by: None };
/// assert_eq!(overload_demand(&known), "needs 120.0 V");
/// let driven = LimitDrive { limit: -100.0, seconds: 1.2, is_at_end: false, rate: 35.0 };
/// let unknown = Overload { demand: Demand::Driven(driven), ..known };
/// assert_eq!(overload_demand(&unknown), "driven into -100 V for 1.2 s, by up to 35 V/s");
/// ```
pub fn overload_demand(overload: &Overload) -> String {
    match overload.demand {
        Demand::Peak(volts) => format!("needs {volts:.1} V"),
        Demand::Driven(drive) => drive_text(drive),
    }
}

/// How an integrator was driven against its limit. A time that lasts to the end of the record has no number, because it
/// depends on the length of the run.
fn drive_text(driven: LimitDrive) -> String {
    let LimitDrive { limit, seconds, is_at_end, rate } = driven;
    let time = match (is_at_end, seconds > 0.0) {
        (true, _) => " to the end,".to_owned(),
        (false, true) => format!(" for {} s,", format_significant(seconds, 3)),
        (false, false) => String::new(),
    };
    format!("driven into {limit:+} V{time} by up to {} V/s", format_significant(rate, 3))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_time_has_a_number_only_if_it_ended() {
        let text = |seconds: f64, is_at_end: bool| {
            drive_text(LimitDrive { limit: 100.0, seconds, is_at_end, rate: 35.4321 })
        };
        assert_eq!(text(1.23456, false), "driven into +100 V for 1.23 s, by up to 35.4 V/s");
        assert_eq!(text(98.7, true), "driven into +100 V to the end, by up to 35.4 V/s");
        assert_eq!(text(0.0, false), "driven into +100 V by up to 35.4 V/s");
    }
}
