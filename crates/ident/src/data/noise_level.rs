//! The noise of outputs and drives, estimated without a model.

use crate::data::examine::{NoiseKind, examine, noise_of};
use crate::data::experiment::Experiment;
use crate::data::record::Record;
use crate::statistics::descriptive::ends;

/// Where a column shows no noise, this share of its range counts as such: what the digits of a recorder leave.
const LEAST_NOISE: f64 = 1e-6;
/// A drive moves by so many times the noise of its column at least, rms.
const LEAST_MOTION: f64 = 5.0;

/// The ends between which an output lies.
pub(crate) fn ends_of(records: &[Record], output: usize) -> [f64; 2] {
    ends(records.iter().flat_map(|record| &record.outputs[output]).copied())
}

/// The white noise of a drive in a record; what comes to as much as it moves by is no noise of its column but what it drives with.
pub(crate) fn drive_noise(record: &Record, drive: usize) -> f64 {
    let is = examine(&record.drives[drive], record.interval);
    let noise =
        is.noise.filter(|noise| noise.kind == NoiseKind::White && is.rms > LEAST_MOTION * noise.sigma);
    noise.map_or(0.0, |noise| noise.sigma)
}

/// The noise of an output in a record; 0 where that is too short to tell.
pub(crate) fn noise(record: &Record, output: usize) -> f64 {
    noise_of(&record.outputs[output]).map_or(0.0, |noise| noise.sigma)
}

/// The largest of what is estimated of a column in each of several records.
pub(crate) fn largest(estimate: fn(&Record, usize) -> f64, records: &[Record], place: usize) -> f64 {
    records.iter().map(|record| estimate(record, place)).fold(0.0, f64::max)
}

impl Experiment {
    /// Whether an output shows noise in training, or the experiment tells some; where not, a millionth of its range counts as such.
    pub fn shows_noise(&self, output: usize) -> bool {
        let records = &self.train;
        self.outputs[output].sigma.is_some() || largest(noise, records, output) > least_noise(records, output)
    }
}

/// What counts as noise of an output at least, in its unit.
pub(crate) fn least_noise(records: &[Record], output: usize) -> f64 {
    let [least, most] = ends_of(records, output);
    LEAST_NOISE * (most - least)
}
