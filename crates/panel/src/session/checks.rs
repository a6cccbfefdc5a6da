//! The numbers that commands and snapshots permit.

use patchcord_core::document::format_distinct;
use patchcord_core::patch::Patch;

use crate::document::Refusal;
use crate::limits::check_range;

/// Checks the length of a sweep.
///
/// # Errors
/// If it is out of range, or shorter than the step of the patch.
pub(super) fn check_sweep(seconds: Option<f64>, patch: &Patch) -> Result<(), Refusal> {
    within("the length of a sweep", seconds, [1e-9, 1e9])?;
    let step = patch.run.step.as_ref().map(|step| step.value);
    match (seconds, step) {
        (Some(seconds), Some(step)) if seconds < step => {
            let [seconds, step] = [format_distinct(seconds, step), format_distinct(step, seconds)];
            Err(Refusal::new(format!("a sweep of {seconds} s is shorter than the step of {step} s")))
        }
        _ => Ok(()),
    }
}

/// Checks the speed factor.
///
/// # Errors
/// If it is out of range.
pub(super) fn check_speed(factor: Option<f64>) -> Result<(), Refusal> {
    within("the speed factor", factor, [1e-6, 1e6])
}

/// Checks the rate of repetitive operation.
///
/// # Errors
/// If it is out of range.
pub(super) fn check_rate(hertz: Option<f64>) -> Result<(), Refusal> {
    within("the rate", hertz, [0.01, 50.0])
}

/// Checks the reference divider of the null meter.
///
/// # Errors
/// If it is out of range.
pub(super) fn check_divider(divider: f64) -> Result<(), Refusal> {
    within("the reference divider", Some(divider), [-1.0, 1.0])
}

/// Checks that a number is in a range, if there is one.
///
/// # Errors
/// If it is not.
pub(super) fn within(what: &str, number: Option<f64>, range: [f64; 2]) -> Result<(), Refusal> {
    number.map_or(Ok(()), |number| check_range(what, number, range)).map_err(Refusal::new)
}
