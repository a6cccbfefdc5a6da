//! The problem that an experiment asks for.

use crate::data::drive_timing::begun_anew;
use crate::data::experiment::Experiment;
use crate::data::noise_level::{drive_noise, largest, least_noise, noise};
use crate::data::record::Record;
use crate::fit::model::ModelError;
use crate::fit::problem::{Problem, in_pieces};
use crate::fit::step_size::steps_per_sample;

/// A record is cut into this many pieces, if they are long enough.
const PIECES: usize = 16;

impl Problem {
    /// What an experiment asks for; noise that it does not tell is estimated without a model.
    ///
    /// # Errors
    /// When the patch cannot be run beside the records.
    pub fn of(experiment: &Experiment) -> Result<Problem, ModelError> {
        let cut = |records: &[Record]| match experiment.pieces {
            Some(seconds) => records.iter().flat_map(|record| record.pieces_of(seconds)).collect(),
            None => records.to_vec(),
        };
        let records = &experiment.train;
        let sigma = experiment.outputs.iter().enumerate();
        let sigma = sigma.map(|(place, output)| {
            output.sigma.unwrap_or_else(|| largest(noise, records, place).max(least_noise(records, place)))
        });
        let drive_sigma = experiment.drives.iter().enumerate();
        let drive_sigma = drive_sigma
            .map(|(place, feed)| feed.sigma.unwrap_or_else(|| largest(drive_noise, records, place)));
        // A drive of the patch would begin anew with every piece.
        let mut own =
            begun_anew(&experiment.patch, |name| experiment.drives.iter().any(|feed| feed.drive == name));
        let cuts = if own.next().is_some() { 1 } else { PIECES };
        let mut problem = Problem {
            drives: experiment.drives.clone(),
            drive_sigma: drive_sigma.collect(),
            outputs: experiment.outputs.iter().map(|output| output.signal.clone()).collect(),
            sigma: sigma.collect(),
            offset: experiment.outputs.iter().map(|output| output.offset).collect(),
            train: cut(&experiment.train),
            pieces: in_pieces(&experiment.train, cuts),
            cuts,
            test: cut(&experiment.test),
            is_cut: experiment.pieces.is_some(),
            steps: 1,
        };
        problem.steps = steps_per_sample(&problem, &experiment.patch, &experiment.fit)?;
        Ok(problem)
    }
}
