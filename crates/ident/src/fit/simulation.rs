//! Simulation: what the patch of an experiment does along its records, without any fit.
//!
//! The model is that of the fits, so drives that columns feed are tables. Initial voltages remain those of the patch.

use crate::data::experiment::Experiment;
use crate::data::record::Record;
use crate::fit::model::{FitProgram, Model, ModelError, SimulatedRecord};
use crate::fit::problem::Problem;
use patchcord_analysis::parallel;

/// The patch of an experiment, compiled once and ready to be run with many values of its parameters.
///
/// # Examples
///
/// ```
/// use patchcord_ident::{Experiment, Problem, Simulation};
///
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// let experiment = Experiment::read("../../examples/05_missing_effect/spring.experiment.json")?;
/// let simulation = Simulation::new(&experiment, &Problem::of(&experiment)?)?;
/// for stiffness in [10.0, 40.0] {
///     // The mass is 1 kg. After 0.2 s, ten samples, it is at 50 mm cos(sqrt(k / m) t).
///     let simulated = simulation.run(&[("k".to_owned(), stiffness)])?;
///     let expected = 50.0 * (stiffness.sqrt() * 0.2).cos();
///     assert!((simulated[0].outputs[0][10] - expected).abs() < 0.05);
/// }
/// # Ok(())
/// # }
/// ```
#[derive(Debug)]
pub struct Simulation {
    /// The patch with the drives of the records.
    model: Model,
}

impl Simulation {
    /// Prepares the patch of an experiment. `problem` is that of the experiment; its solver steps are used.
    ///
    /// # Errors
    /// If the patch cannot be compiled or a record cannot feed it.
    pub fn new(experiment: &Experiment, problem: &Problem) -> Result<Simulation, ModelError> {
        let Experiment { patch, drives, .. } = experiment;
        let program = FitProgram::with_own_initial(patch, drives)?;
        let records: Vec<Record> = experiment.train.iter().chain(&experiment.validation).cloned().collect();
        let model = Model::new(&program, patch, &records, &[], &[], &problem.outputs, problem.steps)?;
        Ok(Simulation { model })
    }

    /// Runs the training records and then the validation records. `parameters` has names and values in declared units;
    /// the other parameters keep their values. No initial voltage and no offset is fitted.
    ///
    /// # Errors
    /// If a parameter is unknown or outside its range, or a run cannot begin.
    pub fn run(&self, parameters: &[(String, f64)]) -> Result<Vec<SimulatedRecord>, ModelError> {
        let simulate = |record: usize| self.model.simulate(record, parameters);
        parallel::map_indices(self.model.record_count(), simulate).into_iter().collect()
    }
}

#[cfg(test)]
mod tests;
