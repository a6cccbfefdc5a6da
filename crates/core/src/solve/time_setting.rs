//! The times in the settings of a run, as error messages name them.

use std::fmt;

/// The times in the settings of a run. An error names one of them in words and by its key in the patch.
///
/// # Examples
///
/// ```
/// use patchcord_core::solve::TimeSetting;
///
/// assert_eq!(TimeSetting::Every.key(), "every");
/// assert_eq!(TimeSetting::Every.to_string(), "the time between samples");
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum TimeSetting {
    /// Length of the run, or of a phase in which the machine operates.
    Duration,
    /// Length of a hold.
    Hold,
    /// Length of the solver's equal steps, or of the first step tried if steps adapt.
    Step,
    /// Time between recorded samples.
    Every,
}

impl TimeSetting {
    /// The key of the time in the `run` of a patch, or in a phase.
    pub fn key(self) -> &'static str {
        match self {
            TimeSetting::Duration => "for",
            TimeSetting::Hold => "hold",
            TimeSetting::Step => "step",
            TimeSetting::Every => "every",
        }
    }
}

impl fmt::Display for TimeSetting {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str(match self {
            TimeSetting::Duration => "the length of the run",
            TimeSetting::Hold => "the length of a hold",
            TimeSetting::Step => "the step",
            TimeSetting::Every => "the time between samples",
        })
    }
}
