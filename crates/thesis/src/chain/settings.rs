//! Settings of the runs of a chain and of the reading of the critical velocity.

use std::thread;

use super::document::template;
use super::error::ChainError;
use super::parameters::Parameters;
use crate::slideway::design::Design;
use patchcord_analysis::instruments::Criterion;
use patchcord_core::document::suggestion;
use patchcord_core::solve::Backend;

/// Settings of the runs of a chain and of the reading of the critical velocity.
///
/// # Examples
///
/// ```
/// use patchcord_thesis::chain::Settings;
///
/// let settings = Settings { threads: 1, ..Settings::default() };
/// assert_eq!((settings.share, settings.window), (0.1, None));
/// assert!((settings.threshold - 0.25e-3).abs() < 1e-12);
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Settings {
    /// Parameters of the patch that replace those of the chain in all runs: name and value in the declared unit. The
    /// last entry of a name counts.
    pub set: Vec<(String, f64)>,
    /// Peak-to-peak swing of velocity in m/s, above which it counts as oscillation. The default is 0.25 mm/s.
    pub threshold: f64,
    /// Time in s within which the swing is measured. `None` means 0.04 s, or the natural period of the table on its
    /// drive if that is longer.
    pub window: Option<f64>,
    /// Step of the solver in s. `None` means the step of the patch.
    pub step: Option<f64>,
    /// Tolerance of the solver, in place of a fixed step. `None` means a fixed step.
    pub tolerance: Option<f64>,
    /// Time between samples in s. `None` means that of the patch.
    pub every: Option<f64>,
    /// The backend that calculates the steps.
    pub backend: Backend,
    /// Relative change of the quantity of every rule of section 9.5, above 0 and below 1. The default is 0.1.
    pub share: f64,
    /// Number of runs at the same time.
    pub threads: usize,
}

impl Default for Settings {
    fn default() -> Self {
        Settings {
            set: Vec::new(),
            threshold: Criterion::USUAL.threshold,
            window: None,
            step: None,
            tolerance: None,
            every: None,
            backend: Backend::default(),
            share: 0.1,
            threads: thread::available_parallelism().map_or(1, usize::from),
        }
    }
}

impl Settings {
    /// Checks the settings that no later step checks.
    ///
    /// # Errors
    /// If the share, the threshold or the window is out of its range, or the circuit lacks a parameter that is set.
    pub(super) fn check(&self) -> Result<(), ChainError> {
        if !(self.share > 0.0 && self.share < 1.0) {
            let (what, wanted) = ("the relative change of a quantity", "between 0 and 1");
            return Err(ChainError::Setting { what, wanted, value: self.share });
        }
        let positive = [("the threshold", Some(self.threshold)), ("the window", self.window)];
        for (what, value) in positive {
            if let Some(value) = value.filter(|value| !(*value > 0.0 && value.is_finite())) {
                return Err(ChainError::Setting { what, wanted: "positive and finite", value });
            }
        }
        let template = template();
        let known: Vec<_> = template.parameters.keys().map(String::as_str).collect();
        match self.set.iter().find(|(name, _)| !known.contains(&name.as_str())) {
            None => Ok(()),
            Some((name, _)) => {
                let hint = suggestion(name, &known).unwrap_or_default();
                Err(ChainError::NoParameter { name: name.clone(), hint })
            }
        }
    }

    /// The parameters of a design, replaced by those that are set.
    pub(super) fn parameters(&self, design: &Design) -> Result<Parameters, ChainError> {
        let mut parameters = Parameters::of_design(design)?.rounded();
        for (name, value) in &self.set {
            parameters.set(name, *value);
        }
        Ok(parameters)
    }

    /// The value that a parameter is set to. `None` if it is not set.
    pub(super) fn value(&self, name: &str) -> Option<f64> {
        self.set.iter().rev().find(|(set, _)| set == name).map(|(_, value)| *value)
    }

    /// The criterion of oscillation for a table on its drive.
    pub(super) fn criterion(&self, parameters: &Parameters) -> Result<Criterion, ChainError> {
        let period = std::f64::consts::TAU / parameters.table().natural_frequency()?;
        let window = self.window.unwrap_or(Criterion::USUAL.window.max(period));
        Ok(Criterion { threshold: self.threshold, window })
    }
}
