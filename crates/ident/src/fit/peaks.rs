//! How far what a patch does goes, and the frequencies of which what it leaves is full: by these effects are measured.

use crate::data::examine::{Peak, peaks};
use crate::data::noise_level::ends_of;
use crate::data::record::Record;
use crate::effects::attach::{Place, Role};
use crate::effects::reach::{Extent, Largest};
use crate::fit::fitted_model::Stage;
use crate::fit::model::ModelError;
use crate::fit::problem::Problem;
use crate::fit::trajectories::all_trajectories;
use crate::statistics::descriptive::ends;

/// How far signals and drives go, in their units.
#[derive(Debug, Clone)]
pub struct Peaks {
    names: Vec<String>,
    extents: Vec<Extent>,
    /// The least time from sample to sample, in seconds.
    pub(crate) interval: f64,
    /// From where a file begins to where the longest record ends, in seconds: what is cut into pieces is as long as it was.
    length: f64,
    /// The frequencies of which what is left is full, in Hz.
    pub spectrum: Vec<f64>,
}

/// So many frequencies are tried of every output in every record,
const FREQUENCIES: usize = 3;
/// and so many of all together.
const MOST_FREQUENCIES: usize = 12;

/// The largest values of what the signals and drives of a stage come to in training.
///
/// # Errors
/// When the patch cannot be run beside the records.
pub fn peaks_of(problem: &Problem, stage: &Stage) -> Result<Peaks, ModelError> {
    let (names, courses) = all_trajectories(problem, stage)?;
    let extent = |name: usize| ends(courses.iter().filter_map(|course| course.get(name)).flatten().copied());
    let mut extents: Vec<Extent> = (0..names.len()).map(extent).map(Extent::of).collect();
    // What was measured is known without a model.
    for (output, name) in problem.outputs.iter().enumerate() {
        let Some(place) = names.iter().position(|own| own == name) else { continue };
        extents[place] = Extent::measured(ends_of(&problem.train, output), extents[place].ends);
    }
    let interval = problem.train.iter().map(|record| record.interval).fold(f64::INFINITY, f64::min);
    let end = |record: &Record| record.since + record.interval * record.len() as f64;
    let length = problem.train.iter().map(end).fold(0.0, f64::max);
    let left = problem.train.iter().zip(&stage.train.residuals);
    let all = left.flat_map(|(record, tracks)| {
        tracks.iter().flat_map(|track| peaks(track, record.interval, FREQUENCIES))
    });
    let highest = Peak::highest(all.collect(), MOST_FREQUENCIES);
    let spectrum = highest.into_iter().map(|peak| peak.frequency).collect();
    Ok(Peaks { names, extents, interval, length, spectrum })
}

impl Peaks {
    fn of(&self, name: &str) -> Option<Extent> {
        let place = self.names.iter().position(|own| own == name)?;
        Some(self.extents[place])
    }

    /// What the reaches of effects name at a place.
    pub fn at(&self, place: &Place<'_>) -> Vec<Largest> {
        let extent = |role: Role<'_>| match role {
            Role::Read(reading) => self.of(&reading.signal),
            // As fast as would cross its range in a twentieth of the record.
            Role::Rate(junction) => self.of(&junction.own.signal).map(|own| own.times(20.0 / self.length)),
        };
        place.largest(extent, self.interval, self.length)
    }
}
