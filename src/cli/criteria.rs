//! Options that help if no critical velocity can be read.

use patchcord::instruments::{CriticalVelocityError, CyclesError, WindowError};

/// The options that change the criterion or the command. `slower` describes a slower command.
pub(super) fn advice_on(error: &CriticalVelocityError, slower: &str) -> Option<String> {
    match error {
        CriticalVelocityError::Window(error) => advice_on_window(*error),
        CriticalVelocityError::CommandTooFast(_) => {
            Some(format!("give a higher --threshold, or {slower} with --set"))
        }
        _ => None,
    }
}

/// The options that help if cycles cannot be read.
pub(super) fn advice_on_cycles(error: &CyclesError) -> Option<String> {
    match error {
        CyclesError::Window(error) => advice_on_window(*error),
        CyclesError::TooCoarse(_) => Some("give a shorter --every".to_owned()),
        _ => None,
    }
}

/// The options that help if the window is unsuitable.
fn advice_on_window(error: WindowError) -> Option<String> {
    match error {
        WindowError::TooCoarse(_) => Some("give a shorter --every or a longer --window".to_owned()),
        WindowError::TooLong { .. } => Some("give a shorter --window".to_owned()),
        _ => None,
    }
}
