//! The columns of a record with their statistics, for tables that describe the data.

use crate::data::examine::{ColumnStatistics, examine};
use crate::data::experiment::Experiment;
use crate::data::record::Record;

/// A column of a record with its statistics.
#[derive(Debug, Clone, PartialEq)]
pub struct RecordColumn<'e> {
    /// What the column belongs to in the patch: "drive" or "signal".
    pub noun: &'static str,
    /// The name of the drive or signal in the patch.
    pub name: &'e str,
    /// The name of the column in the experiment.
    pub column: &'e str,
    /// The unit of the statistics.
    pub unit: &'e str,
    /// Standard deviation of the noise that the experiment specifies, in `unit`. None if it does not.
    pub sigma: Option<f64>,
    /// Time between two samples, in seconds.
    pub interval: f64,
    /// The statistics of the samples.
    pub statistics: ColumnStatistics,
}

/// Returns the columns of a record: first the drives that it feeds, then the signals, both in the order of the
/// experiment. `record` must be a record of `experiment`.
///
/// # Examples
///
/// ```
/// use patchcord_ident::{Experiment, record_columns};
///
/// let experiment = Experiment::read("../../examples/05_missing_effect/spring.experiment.json")?;
/// let columns = record_columns(&experiment, &experiment.train[0]);
/// assert_eq!((columns[0].noun, columns[0].name, columns[0].unit), ("signal", "x", "mm"));
/// assert_eq!(columns[0].statistics.missing, 0);
///
/// // The experiment does not specify the noise. It is 0.5 mm rms, and the samples show it.
/// assert_eq!(columns[0].sigma, None);
/// let noise = columns[0].statistics.noise.as_ref().ok_or("enough samples")?;
/// assert!((0.35..0.7).contains(&noise.sigma));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn record_columns<'e>(experiment: &'e Experiment, record: &Record) -> Vec<RecordColumn<'e>> {
    let interval = record.interval;
    let drives = experiment.drives.iter().zip(&record.drives).map(|(drive, samples)| RecordColumn {
        noun: "drive",
        name: &drive.drive,
        column: &drive.column,
        unit: drive.unit.text(),
        sigma: drive.sigma,
        interval,
        statistics: examine(samples, interval),
    });
    let outputs = experiment.outputs.iter().zip(&record.outputs).map(|(output, samples)| RecordColumn {
        noun: "signal",
        name: &output.signal,
        column: &output.column,
        unit: output.unit.text(),
        sigma: output.sigma,
        interval,
        statistics: examine(samples, interval),
    });
    drives.chain(outputs).collect()
}
