//! Extents of signals and dominant frequencies of residuals. The ranges and starts of an effect's parameters are
//! computed from them.

use crate::data::examine::{SpectralPeak, spectral_peaks};
use crate::data::noise_level::output_extremes;
use crate::data::record::Record;
use crate::effects::attach::{AttachmentSite, FormulaQuantity};
use crate::effects::reach::{Extent, QuantitySize};
use crate::fit::fitted_model::FittedModel;
use crate::fit::model::ModelError;
use crate::fit::problem::Problem;
use crate::fit::trajectories::all_trajectories;
use crate::statistics::descriptive::extremes;

/// The least and largest values of all signals and drives of a fitted model, and the frequencies of its residuals.
#[derive(Debug, Clone)]
pub struct SignalExtents {
    /// Names of the signals and drives.
    names: Vec<String>,
    /// The extent of each, in its unit and in the same order.
    extents: Vec<Extent>,
    /// The least sampling interval of the training records, in seconds.
    pub(crate) interval: f64,
    /// The time from the start of a file to the end of its last record, in seconds; of several files the longest. It
    /// does not change if records are cut into pieces.
    length: f64,
    /// The dominant frequencies of the training residuals, in Hz, the strongest first.
    pub residual_frequencies: Vec<f64>,
}

/// The largest number of frequencies from one output of one record.
const FREQUENCIES_PER_TRACK: usize = 3;
/// The largest number of frequencies altogether. Each is a start of a fit.
const MAX_FREQUENCIES: usize = 12;
/// The number of crossings of its range per record that a quantity makes at the assumed largest rate. It applies if no
/// signal measures the rate.
const CROSSINGS_PER_RECORD: f64 = 20.0;

/// The extents of the signals and drives of a fitted model in the training records. Outputs have their measured
/// extents.
///
/// # Errors
/// If the patch cannot be run along the records.
///
/// # Examples
///
/// ```
/// use patchcord_ident::fit::signal_extents::signal_extents;
/// use patchcord_ident::{Experiment, Problem, fit_base};
///
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// let experiment = Experiment::read("../../examples/05_missing_effect/spring.experiment.json")?;
/// let problem = Problem::of(&experiment)?;
/// let fitted = fit_base(&problem, &experiment.patch, &experiment.fit, 1)?.ok_or("the patch cannot be run")?;
/// let extents = signal_extents(&problem, &fitted)?;
///
/// // The residual of the spring without damping oscillates.
/// assert!(!extents.residual_frequencies.is_empty());
/// # Ok(())
/// # }
/// ```
pub fn signal_extents(problem: &Problem, fitted: &FittedModel) -> Result<SignalExtents, ModelError> {
    let (names, trajectories) = all_trajectories(problem, fitted)?;
    let ends_of_signal = |signal: usize| {
        extremes(trajectories.iter().filter_map(|trajectory| trajectory.get(signal)).flatten().copied())
    };
    let mut extents: Vec<Extent> = (0..names.len()).map(ends_of_signal).map(Extent::of).collect();
    for (output, name) in problem.outputs.iter().enumerate() {
        let Some(index) = names.iter().position(|signal| signal == name) else { continue };
        extents[index] =
            Extent::with_simulated(output_extremes(&problem.train, output), extents[index].range);
    }
    let interval = problem.train.iter().map(|record| record.interval).fold(f64::INFINITY, f64::min);
    let end = |record: &Record| record.start_in_file + record.interval * record.len() as f64;
    let length = problem.train.iter().map(end).fold(0.0, f64::max);
    let residuals = problem.train.iter().zip(&fitted.train.residuals);
    let all_peaks = residuals.flat_map(|(record, tracks)| {
        tracks.iter().flat_map(|track| spectral_peaks(track, record.interval, FREQUENCIES_PER_TRACK))
    });
    let highest = SpectralPeak::highest(all_peaks.collect(), MAX_FREQUENCIES);
    let residual_frequencies = highest.into_iter().map(|peak| peak.frequency).collect();
    Ok(SignalExtents { names, extents, interval, length, residual_frequencies })
}

impl SignalExtents {
    /// The extent of the signal or drive with this name.
    fn extent(&self, name: &str) -> Option<Extent> {
        let index = self.names.iter().position(|signal| signal == name)?;
        Some(self.extents[index])
    }

    /// The largest values of the quantities that the formulas of an effect can name at a site.
    pub fn largest_at(&self, site: &AttachmentSite<'_>) -> Vec<QuantitySize> {
        let extent = |quantity: FormulaQuantity<'_>| match quantity {
            FormulaQuantity::Signal(scaled) => self.extent(&scaled.signal),
            FormulaQuantity::Rate(junction) => self
                .extent(&junction.output.signal)
                .map(|extent| extent.times(CROSSINGS_PER_RECORD / self.length)),
        };
        site.quantity_sizes(extent, self.interval, self.length)
    }
}
