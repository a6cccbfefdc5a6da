//! The noise of drives and outputs in records, estimated without a model.

use crate::data::examine::{NoiseKind, estimate_noise, examine};
use crate::data::experiment::Experiment;
use crate::data::record::Record;
use crate::statistics::descriptive::extremes;

/// The noise assumed for an output without visible noise, as a fraction of its range. About the resolution of a
/// recorder with six digits.
const ASSUMED_NOISE_FRACTION: f64 = 1e-6;
/// The least ratio of a drive's rms motion to its noise. Below it, the noise is taken for the excitation itself.
const MIN_MOTION_TO_NOISE: f64 = 5.0;

/// Returns the minimum and maximum of an output over all records, in its unit. Missing samples are ignored.
pub(crate) fn output_extremes(records: &[Record], output: usize) -> [f64; 2] {
    extremes(records.iter().flat_map(|record| &record.outputs[output]).copied())
}

/// Returns the standard deviation of the white noise of a drive in a record, in its unit. Zero if no white noise is
/// visible, or if the noise is more than a fifth of the drive's rms: then the drive itself is a random excitation.
pub(crate) fn drive_noise(record: &Record, drive: usize) -> f64 {
    let statistics = examine(&record.drives[drive], record.interval);
    let noise = statistics
        .noise
        .filter(|noise| noise.kind == NoiseKind::White && statistics.rms > MIN_MOTION_TO_NOISE * noise.sigma);
    noise.map_or(0.0, |noise| noise.sigma)
}

/// Returns the standard deviation of the noise of an output in a record, in its unit. Zero if the record has too few
/// consecutive samples for an estimate.
pub(crate) fn output_noise(record: &Record, output: usize) -> f64 {
    estimate_noise(&record.outputs[output]).map_or(0.0, |noise| noise.sigma)
}

/// Returns the largest of the values that `estimate` gives for one column in several records. At least 0.
pub(crate) fn max_over_records(
    estimate: fn(&Record, usize) -> f64,
    records: &[Record],
    column: usize,
) -> f64 {
    records.iter().map(|record| estimate(record, column)).fold(0.0, f64::max)
}

impl Experiment {
    /// Whether the noise of an output is known: the experiment specifies it, or the training data show it. Otherwise a
    /// millionth of the output's range is assumed. `output` is an index into `outputs`.
    pub fn has_known_noise(&self, output: usize) -> bool {
        let records = &self.train;
        let estimated = || max_over_records(output_noise, records, output);
        self.outputs[output].sigma.is_some() || estimated() > min_noise(records, output)
    }
}

/// Returns the least standard deviation that is assumed for the noise of an output, in its unit.
pub(crate) fn min_noise(records: &[Record], output: usize) -> f64 {
    let [minimum, maximum] = output_extremes(records, output);
    ASSUMED_NOISE_FRACTION * (maximum - minimum)
}
