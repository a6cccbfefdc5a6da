//! Makes the identification problem of an experiment: estimates missing noise levels, cuts the records and chooses the
//! solver steps.

use crate::data::drive_timing::restarting_drives;
use crate::data::experiment::Experiment;
use crate::data::noise_level::{drive_noise, max_over_records, min_noise, output_noise};
use crate::data::record::Record;
use crate::fit::cancellation::Cancellation;
use crate::fit::model::ModelError;
use crate::fit::problem::{Problem, cut_records};
use crate::fit::step_size::steps_per_sample;

/// The number of pieces of a record, if the record is long enough. Over a sixteenth of a record even a poor model stays
/// near the data.
const PIECES_PER_RECORD: usize = 16;

impl Problem {
    /// The problem of an experiment. Noise levels that the experiment does not specify are estimated without a model.
    ///
    /// Records are not cut if a drive of the patch depends on time since the start of a run: each piece would restart
    /// the drive.
    ///
    /// # Errors
    /// If the patch cannot be run along the records.
    pub fn of(experiment: &Experiment) -> Result<Problem, ModelError> {
        let cut = |records: &[Record]| match experiment.piece_duration {
            Some(seconds) => records.iter().flat_map(|record| record.split_by_duration(seconds)).collect(),
            None => records.to_vec(),
        };
        let records = &experiment.train;
        let sigma = experiment.outputs.iter().enumerate();
        let sigma = sigma.map(|(index, output)| {
            output.sigma.unwrap_or_else(|| {
                max_over_records(output_noise, records, index).max(min_noise(records, index))
            })
        });
        let drive_sigma = experiment.drives.iter().enumerate();
        let drive_sigma = drive_sigma.map(|(index, drive)| {
            drive.sigma.unwrap_or_else(|| max_over_records(drive_noise, records, index))
        });
        let mut restarting_drives = restarting_drives(&experiment.patch, |name| {
            experiment.drives.iter().any(|measured| measured.drive == name)
        });
        let pieces_per_record = if restarting_drives.next().is_some() { 1 } else { PIECES_PER_RECORD };
        let mut problem = Problem {
            drives: experiment.drives.clone(),
            drive_sigma: drive_sigma.collect(),
            outputs: experiment.outputs.iter().map(|output| output.signal.clone()).collect(),
            sigma: sigma.collect(),
            has_offset: experiment.outputs.iter().map(|output| output.has_offset).collect(),
            train: cut(&experiment.train),
            pieces: cut_records(&experiment.train, pieces_per_record),
            pieces_per_record,
            validation: cut(&experiment.validation),
            is_cut: experiment.piece_duration.is_some(),
            steps: 1,
            cancellation: Cancellation::default(),
        };
        problem.steps = steps_per_sample(&problem, &experiment.patch, &experiment.fit)?;
        Ok(problem)
    }
}
