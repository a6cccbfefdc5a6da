//! How a chain is run and read.

use std::thread;

use super::document::template;
use super::error::ChainError;
use super::parameters::Parameters;
use crate::slideway::design::Design;
use patchcord_analysis::instruments::Criterion;
use patchcord_core::document::suggestion;
use patchcord_core::solve::Backend;

/// How a chain is run and read.
#[derive(Debug, Clone, PartialEq)]
pub struct Settings {
    /// Parameters of the patch that take other values than the chain's, in their declared units, in all its runs.
    pub set: Vec<(String, f64)>,
    /// Swing of the velocity, peak to peak in m/s, above which it counts as oscillating.
    pub threshold: f64,
    /// Time in s within which it swings by that; without one 0.04 s, or the period of the table on its drive if that is longer.
    pub window: Option<f64>,
    /// Step of the solver in s; without one that of the patch.
    pub step: Option<f64>,
    /// Tolerance of the solver, instead of a step.
    pub tolerance: Option<f64>,
    /// Time between samples in s; without one that of the patch.
    pub every: Option<f64>,
    /// What works the steps out.
    pub backend: Backend,
    /// The share by which every advice changes its quantity, above 0 and below 1.
    pub share: f64,
    /// How many runs are made at the same time.
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
    /// That numbers which no later step looks at are such as can be used, and that every parameter set is one of the circuit's.
    pub(super) fn check(&self) -> Result<(), ChainError> {
        if !(self.share > 0.0 && self.share < 1.0) {
            let (what, wanted) = ("the share by which advice changes a quantity", "between 0 and 1");
            return Err(ChainError::Setting { what, wanted, value: self.share });
        }
        let times = [("the threshold", Some(self.threshold)), ("the window", self.window)];
        for (what, value) in times {
            if let Some(value) = value.filter(|value| !(*value > 0.0 && value.is_finite())) {
                return Err(ChainError::Setting { what, wanted: "above 0", value });
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

    /// The parameters of a design, those set anew as they are set.
    pub(super) fn parameters(&self, design: &Design) -> Result<Parameters, ChainError> {
        let mut parameters = Parameters::of_design(design)?.rounded();
        for (name, value) in &self.set {
            parameters.set(name, *value);
        }
        Ok(parameters)
    }

    /// What a parameter is set to, the last time.
    pub(super) fn value(&self, name: &str) -> Option<f64> {
        self.set.iter().rev().find(|(set, _)| set == name).map(|(_, value)| *value)
    }

    /// When a table on its drive counts as oscillating.
    pub(super) fn criterion(&self, parameters: &Parameters) -> Result<Criterion, ChainError> {
        let period = std::f64::consts::TAU / parameters.table().natural_frequency()?;
        let window = self.window.unwrap_or(Criterion::USUAL.window.max(period));
        Ok(Criterion { threshold: self.threshold, window })
    }
}
