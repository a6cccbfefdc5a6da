//! Prints the reasons to doubt the record of a run if standard output has the table, or if the run stops with an error.

use super::phases::phase_warnings;
use super::step_warning::step_warning_text;
use super::{eprint, eprint_coloured};
use patchcord::trace::Trace;

/// Prints to standard error which phases ended without the switching for which they waited, which steps are too long,
/// and the overloads. `overloads` is their text. Nothing is printed if there is no reason for a doubt.
pub(super) fn eprint_doubts(trace: &Trace, overloads: &str) {
    let step_warning = trace.step_warning.as_ref().map(step_warning_text).unwrap_or_default();
    let warnings = phase_warnings(trace) + &step_warning;
    if !warnings.is_empty() {
        eprint(warnings.trim_end());
    }
    if trace.overloads().next().is_some() {
        eprint_coloured(overloads.trim_end());
    }
}
