//! The log book: what was done in each phase of a run, in few words.

use super::Display;
use patchcord_core::document::told;
use patchcord_core::trace::{Deed, Ending, Mark, NewValue};

/// What the machine did: "operate until K1 is pulled-in", "k = 20 N/m".
pub fn deed(mark: &Mark) -> String {
    match &mark.phase {
        Deed::InitialCondition => "initial condition".to_owned(),
        Deed::Operate { until: None } => "operate".to_owned(),
        Deed::Operate { until: Some((relay, None)) } => format!("operate until {relay} switches"),
        Deed::Operate { until: Some((relay, Some(position))) } => {
            format!("operate until {relay} becomes {position}")
        }
        Deed::Hold => "hold".to_owned(),
        Deed::Set(values) if values.is_empty() => "set".to_owned(),
        Deed::Set(values) => values.iter().map(new_value).collect::<Vec<_>>().join(", "),
    }
}

fn new_value(new: &NewValue) -> String {
    format!("{} = {}", new.parameter, Display::new(&new.unit, new.value).text(new.value))
}

/// What ended a phase that takes time: "time", "K1 pulled-in", "overload"; nothing for one that takes none.
pub fn ending(mark: &Mark) -> String {
    match (&mark.phase, &mark.ended) {
        (_, Ending::Stopped) => "error".to_owned(),
        (_, Ending::Overload) => "overload".to_owned(),
        (Deed::Operate { until: Some((relay, _)) }, Ending::Switched(position)) => {
            format!("{relay} {position}")
        }
        (Deed::Operate { .. } | Deed::Hold, _) => "time".to_owned(),
        _ => String::new(),
    }
}

/// What a phase waited for in vain: "K1 did not switch within 10 s".
pub fn missed(mark: &Mark) -> Option<String> {
    let Deed::Operate { until: Some((relay, position)) } = &mark.phase else { return None };
    let what = match position {
        Some(position) => format!("become {position}"),
        None => "switch".to_owned(),
    };
    mark.waited_in_vain().then(|| format!("{relay} did not {what} within {} s", told(mark.end - mark.begin)))
}
