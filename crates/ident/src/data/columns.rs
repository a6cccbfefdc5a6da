//! The columns of a record that an experiment reads, and what each is like.

use crate::data::examine::{Examined, examine};
use crate::data::experiment::Experiment;
use crate::data::record::Record;

/// A column of a record, and what it is like.
#[derive(Debug, Clone, PartialEq)]
pub struct Column<'e> {
    /// What the patch has there: "drive" or "signal".
    pub noun: &'static str,
    /// What the patch calls it.
    pub name: &'e str,
    /// What the file calls it.
    pub column: &'e str,
    /// The unit in which it is looked at.
    pub unit: &'e str,
    /// The noise that the experiment tells.
    pub sigma: Option<f64>,
    /// Time between two samples, in seconds.
    pub interval: f64,
    /// What it is like.
    pub is: Examined,
}

/// The drives that a record feeds, then the signals that it holds.
pub fn columns<'e>(experiment: &'e Experiment, record: &Record) -> Vec<Column<'e>> {
    let interval = record.interval;
    let drives = experiment.drives.iter().zip(&record.drives).map(|(feed, samples)| Column {
        noun: "drive",
        name: &feed.drive,
        column: &feed.column,
        unit: feed.unit.text(),
        sigma: feed.sigma,
        interval,
        is: examine(samples, interval),
    });
    let outputs = experiment.outputs.iter().zip(&record.outputs).map(|(output, samples)| Column {
        noun: "signal",
        name: &output.signal,
        column: &output.column,
        unit: output.unit.text(),
        sigma: output.sigma,
        interval,
        is: examine(samples, interval),
    });
    drives.chain(outputs).collect()
}
