//! The samples of a run that its pictures need.
//!
//! A picture against time looks the same with the envelope of the run. A picture against a signal needs no sample if the
//! run follows its curves, and every sample otherwise.

use crate::envelope::TraceEnvelope;
use crate::plot::Size;
use patchcord_core::document::format_distinct;
use patchcord_core::patch::PictureSpec;
use patchcord_core::solve::{BLOCK_SAMPLES, RunSettings};

/// Largest number of numbers of 8 bytes for the samples of a run and for its pictures. They take 400 MB.
const MAX_NUMBERS: f64 = 5e7;
/// Numbers for every sample while one picture is drawn: its axes, its positions, and its wrong and its correct parts.
const NUMBERS_FOR_DRAWING: usize = 16;
/// Numbers for the time of every sample.
const NUMBERS_FOR_TIME: usize = 1;
/// Numbers for every sample of a curve.
const NUMBERS_PER_POINT: usize = 2;
/// Number of samples of a group of the envelope.
const SAMPLES_PER_GROUP: f64 = 2.0;
/// The largest number of groups, divided by the least number that remains when they are merged.
const MERGED_GROUPS: f64 = 2.0;
/// Least number of groups of the envelope for each pixel of the width, if the memory permits it. An extreme moves by at
/// most a twenty-fifth of a pixel.
const GROUPS_PER_PIXEL: f64 = 25.0;
/// Least number of groups of the envelope for each pixel of the width in any case. An extreme moves by at most half a
/// pixel.
const MIN_GROUPS_PER_PIXEL: f64 = 2.0;

/// The samples of a run that its pictures need.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum PictureSamples {
    /// None, because there are no pictures.
    None,
    /// The envelope.
    Envelope {
        /// The largest number of its groups, apart from one for every run.
        groups: usize,
    },
    /// All samples.
    All,
}

impl PictureSamples {
    /// Returns the number of samples of the blocks in which the run passes its samples on. `None` if the trace keeps
    /// all samples.
    pub fn block_samples(self) -> Option<usize> {
        (self != PictureSamples::All).then_some(BLOCK_SAMPLES)
    }

    /// Returns the envelope of a run that has not begun. `None` if the pictures do not need one.
    pub fn envelope(self) -> Option<TraceEnvelope> {
        match self {
            PictureSamples::Envelope { groups } => Some(TraceEnvelope::new(groups)),
            PictureSamples::None | PictureSamples::All => None,
        }
    }
}

/// A run with more samples than its pictures permit.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[error(
    "the run would record {samples} samples; at most {max} are allowed with pictures that need every sample, because \
     {reason}",
    samples = format_distinct(*samples, *max), max = format_distinct(*max, *samples), reason = reason.text()
)]
pub struct TooManySamplesError {
    /// Number of samples of the run.
    pub samples: f64,
    /// The largest number of samples.
    pub max: f64,
    /// Why the pictures need every sample.
    pub reason: SampleDemand,
}

/// Why pictures need every sample of a run.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum SampleDemand {
    /// A picture is against a signal, and the run does not follow its curves.
    AgainstSignal,
    /// The envelope has too few groups for each of the runs.
    ManyRuns,
    /// The envelope of a single run would be too large, because of the width or the number of curves.
    LargePictures,
}

impl SampleDemand {
    /// Returns the reason for messages.
    fn text(self) -> &'static str {
        match self {
            SampleDemand::AgainstSignal => "one is against a signal",
            SampleDemand::ManyRuns => "there are very many repetitions or phases",
            SampleDemand::LargePictures => "they have very many curves or pixels",
        }
    }
}

/// Returns the samples of a run that these pictures need. A PNG has `scale` pixels per pixel of the size.
///
/// If there are too many samples for the memory, pictures against time need the envelope only.
///
/// # Errors
///
/// If they need more samples than the memory permits: a picture is against a signal and the settings do not have its
/// curves, the samples belong to many runs, or the envelope is too large because of the width or the number of curves.
///
/// # Examples
///
/// ```
/// use patchcord_core::circuit::Circuit;
/// use patchcord_core::patch::{ElementBuilder, PatchBuilder};
/// use patchcord_core::solve::RunSettings;
/// use patchcord_draw::plot::Size;
/// use patchcord_draw::{PictureSamples, picture_samples};
///
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// // dx/dt = -x, from x = 50 V
/// let decay = ElementBuilder::new("integrator").cords("x1", ["A1"]).set("initial", 50);
/// let patch = PatchBuilder::new("Decay").element("A1", decay).run(2.0, 1e-3).record(["A1"]).build()?;
/// let circuit = Circuit::new(&patch)?;
/// let (short, pictures) = (RunSettings::of(&circuit)?, circuit.picture_specs(["A1"]));
/// assert_eq!(picture_samples(&pictures, &short, Size::default(), 1.0)?, PictureSamples::All);
/// // From 25 to 50 groups for each of 900 pixels.
/// let few = PictureSamples::Envelope { groups: 45_000 };
/// assert_eq!(picture_samples(&pictures, &short.with_duration(1e6), Size::default(), 1.0)?, few);
/// # Ok(())
/// # }
/// ```
pub fn picture_samples(
    pictures: &[PictureSpec],
    settings: &RunSettings,
    size: Size,
    scale: f64,
) -> Result<PictureSamples, TooManySamplesError> {
    if pictures.is_empty() {
        return Ok(PictureSamples::None);
    }
    let signals = settings.record.len();
    let derivatives = signals * settings.sensitivities.len();
    let curves = pictures.iter().map(|picture| picture.y.len()).sum::<usize>() + derivatives;
    let numbers = NUMBERS_FOR_DRAWING + NUMBERS_FOR_TIME + signals + derivatives + NUMBERS_PER_POINT * curves;
    let (samples, max) = (settings.max_samples(), MAX_NUMBERS / numbers as f64);
    if samples <= max {
        return Ok(PictureSamples::All);
    }
    let refused = |reason| Err(TooManySamplesError { samples, max, reason });
    if !pictures.iter().all(|picture| picture.x.value == "t" || is_followed(picture, settings)) {
        return refused(SampleDemand::AgainstSignal);
    }
    let permitted_groups = max / SAMPLES_PER_GROUP;
    // Every phase may begin a run, which has one group more.
    let max_groups = permitted_groups - settings.phase_count();
    let pixels = f64::from(size.width) * scale.max(1.0);
    // The groups are shared by all runs, and each run may take the whole width.
    let runs = run_count(settings);
    let wanted_groups = MERGED_GROUPS * GROUPS_PER_PIXEL * pixels * runs;
    let least_groups = |runs: f64| MERGED_GROUPS * MIN_GROUPS_PER_PIXEL * pixels * runs;
    let groups = max_groups.min(wanted_groups);
    if groups >= least_groups(runs) {
        Ok(PictureSamples::Envelope { groups: groups as usize })
    } else if permitted_groups < least_groups(1.0) {
        refused(SampleDemand::LargePictures)
    } else {
        refused(SampleDemand::ManyRuns)
    }
}

/// Whether the run follows all curves of a picture against a signal.
fn is_followed(picture: &PictureSpec, settings: &RunSettings) -> bool {
    let is_curve_of = |y: &str, (along, up): &(String, String)| *along == picture.x.value && up == y;
    picture.y.iter().all(|y| settings.curves.iter().any(|curve| is_curve_of(&y.value, curve)))
}

/// The number of runs of the greatest length that take as long as all runs together. It is 1 for runs without duration.
fn run_count(settings: &RunSettings) -> f64 {
    let duration = settings.duration();
    if duration > 0.0 { settings.total_duration() / duration } else { 1.0 }
}

#[cfg(test)]
mod tests {
    use super::*;
    use patchcord_core::document::{Placed, Span};

    /// Pictures of one signal each against `x`.
    fn specs(x: &str, count: usize) -> Vec<PictureSpec> {
        let placed = |name: &str| Placed { value: name.to_owned(), span: Span::default() };
        let spec =
            PictureSpec { title: String::new(), x: placed(x), y: vec![placed("y")], equal_scales: true };
        vec![spec; count]
    }

    /// The samples for pictures of the usual size. The run has this many samples in each repetition.
    fn samples(
        specs: &[PictureSpec],
        samples: f64,
        repetitions: u64,
    ) -> Result<PictureSamples, TooManySamplesError> {
        let settings = RunSettings::from_phases([], 1.0).with_duration(samples).repeated(repetitions);
        picture_samples(specs, &settings.with_signals(["x", "y"]), Size::default(), 1.0)
    }

    #[test]
    fn pictures_against_time_need_few_samples_of_a_long_run() {
        assert_eq!(samples(&specs("t", 1), 2e6, 1), Ok(PictureSamples::All));
        // From 25 to 50 groups for each of 900 pixels.
        let few: Result<_, TooManySamplesError> = Ok(PictureSamples::Envelope { groups: 45_000 });
        assert_eq!([samples(&specs("t", 1), 3e6, 1), samples(&specs("t", 1), 3e9, 1)], [few, few]);
        let limited = Ok(PictureSamples::Envelope { groups: 1_190_276 });
        assert_eq!(samples(&specs("t", 1), 3e6, 100), limited);
    }

    #[test]
    fn the_envelope_is_limited() {
        for (count, length, repetitions) in [(1, 3e6, 1), (1, 3e6, 100), (250, 1e6, 1), (60, 3e5, 7)] {
            let kept = samples(&specs("t", count), length, repetitions);
            let Ok(PictureSamples::Envelope { groups }) = kept else { panic!("{kept:?}") };
            let numbers = 2.0 * (groups as f64 + 2.0 * repetitions as f64) * (19 + 2 * count) as f64;
            assert!(numbers <= MAX_NUMBERS, "{count}: {groups}");
            assert!(0.5 * groups as f64 >= 2.0 * 900.0 * repetitions as f64, "{count}: {groups}");
        }
    }

    #[test]
    fn pictures_against_a_signal_need_few_samples_if_the_run_follows_their_curves() {
        let settings = RunSettings::from_phases([], 1.0).with_duration(3e6).with_signals(["x", "y"]);
        let mixed = [specs("t", 1), specs("x", 1)].concat();
        let samples = |settings: RunSettings| picture_samples(&mixed, &settings, Size::default(), 1.0);
        let few = Ok(PictureSamples::Envelope { groups: 45_000 });
        assert_eq!(samples(settings.clone().with_curves([("x", "y")])), few);
        assert!(samples(settings.with_curves([("y", "x")])).is_err());
    }

    #[test]
    fn pictures_against_a_signal_and_of_many_runs_need_every_sample() {
        assert_eq!(samples(&specs("x", 1), 2e6, 1), Ok(PictureSamples::All));
        let mixed = [specs("t", 1), specs("x", 1)].concat();
        let refused = samples(&mixed, 3e6, 1).unwrap_err();
        assert!(refused.samples >= 3e6 && refused.max == MAX_NUMBERS / 23.0, "{refused:?}");
        assert_eq!(refused.reason, SampleDemand::AgainstSignal);
        assert_eq!(samples(&specs("t", 1), 5e3, 400), Ok(PictureSamples::All));
        for (length, repetitions) in [(5e3, 1000), (5.0, 10_000_000)] {
            let refused = samples(&specs("t", 1), length, repetitions).unwrap_err();
            assert_eq!(refused.reason, SampleDemand::ManyRuns, "{repetitions}");
        }
    }

    #[test]
    fn an_envelope_of_very_many_curves_is_too_large() {
        let refused = samples(&specs("t", 4000), 1e6, 1).unwrap_err();
        assert_eq!(refused.reason, SampleDemand::LargePictures);
        // Without duration, every phase still has two samples.
        let refused = samples(&specs("t", 1), 0.0, 10_000_000).unwrap_err();
        assert_eq!(refused.reason, SampleDemand::ManyRuns);
    }

    #[test]
    fn no_pictures_need_no_samples() {
        assert_eq!(samples(&[], 3e9, 1), Ok(PictureSamples::None));
        assert_eq!(PictureSamples::None.block_samples(), Some(BLOCK_SAMPLES));
        assert_eq!(PictureSamples::All.block_samples(), None);
    }
}
