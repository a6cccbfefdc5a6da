//! The log book: describes each phase of a run, and how it ended, in a few words.

use crate::format::QuantityFormat;
use patchcord_core::document::format_number;
use patchcord_core::trace::{NewValue, PhaseEnd, PhaseKind, PhaseRecord};

/// What the machine did in a phase: "operate until K1 is pulled-in", "k = 20 N/m".
///
/// # Examples
///
/// ```
/// use patchcord_analysis::instruments::{phase_description, phase_end_description, unmet_condition};
/// use patchcord_core::trace::{PhaseEnd, PhaseKind, PhaseRecord};
///
/// let (repetition, begin, end, problem_time, sample) = (0, 0.0, 2.0, 0.0, 0);
/// let (phase, ended) = (PhaseKind::Hold, PhaseEnd::Time);
/// let record = PhaseRecord { phase, repetition, begin, end, problem_time, sample, ended };
/// assert_eq!((phase_description(&record).as_str(), phase_end_description(&record).as_str()), ("hold", "time"));
/// assert_eq!(unmet_condition(&record), None);
/// ```
pub fn phase_description(record: &PhaseRecord) -> String {
    match &record.phase {
        PhaseKind::InitialCondition => "initial condition".to_owned(),
        PhaseKind::Operate { until: None } => "operate".to_owned(),
        PhaseKind::Operate { until: Some((relay, None)) } => format!("operate until {relay} switches"),
        PhaseKind::Operate { until: Some((relay, Some(position))) } => {
            format!("operate until {relay} becomes {position}")
        }
        PhaseKind::Hold => "hold".to_owned(),
        PhaseKind::Set(values) if values.is_empty() => "set".to_owned(),
        PhaseKind::Set(values) => values.iter().map(new_value).collect::<Vec<_>>().join(", "),
        _ => "phase".to_owned(),
    }
}

/// "k = 20 N/m": a parameter that was set between two phases.
fn new_value(new: &NewValue) -> String {
    format!("{} = {}", new.parameter, QuantityFormat::new(&new.unit, new.value).text(new.value))
}

/// How a phase with a duration ended: "time", "K1 pulled-in", "overload". Empty for a phase without a duration.
pub fn phase_end_description(record: &PhaseRecord) -> String {
    match (&record.phase, &record.ended) {
        (_, PhaseEnd::Stopped) => "error".to_owned(),
        (_, PhaseEnd::Overload) => "overload".to_owned(),
        (PhaseKind::Operate { until: Some((relay, _)) }, PhaseEnd::Switched(position)) => {
            format!("{relay} {position}")
        }
        (PhaseKind::Operate { .. } | PhaseKind::Hold, _) => "time".to_owned(),
        _ => String::new(),
    }
}

/// The switching that a phase waited for in vain: "K1 did not switch within 10 s". None if the phase ended as intended.
pub fn unmet_condition(record: &PhaseRecord) -> Option<String> {
    let PhaseKind::Operate { until: Some((relay, position)) } = &record.phase else { return None };
    let what = match position {
        Some(position) => format!("become {position}"),
        None => "switch".to_owned(),
    };
    record
        .has_timed_out()
        .then(|| format!("{relay} did not {what} within {} s", format_number(record.end - record.begin)))
}
