//! The pictures of a run: the options for their size, what they show, and the samples that they need.

use clap::Args;

use super::failure::Failure;
use patchcord::circuit::Circuit;
use patchcord::draw::plot::{Format, Picture, Size, check_sheet};
use patchcord::draw::{self, TraceEnvelope};
use patchcord::instruments::{parameter_line, signal_faults};
use patchcord::patch::PictureSpec;
use patchcord::solve::{BLOCK_SAMPLES, RunSettings};
use patchcord::trace::Trace;

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

#[derive(Args)]
pub(super) struct PictureArguments {
    /// Width of each picture in pixels, 240 to 4000; 900 if absent
    #[arg(long, value_name = "PIXELS", allow_negative_numbers = true, value_parser = side)]
    width: Option<u32>,
    /// Height of each picture in pixels, 240 to 4000; 560 if absent
    #[arg(long, value_name = "PIXELS", allow_negative_numbers = true, value_parser = side)]
    height: Option<u32>,
    /// Resolution of PNG files: pixels per pixel of width and height, 0.25 to 10; 1 if absent
    #[arg(long, value_name = "FACTOR", allow_negative_numbers = true, value_parser = scale)]
    scale: Option<f64>,
}

/// Parses the length of a side of a picture in pixels.
fn side(text: &str) -> Result<u32, String> {
    let permitted = Size::MIN_SIDE..=Size::MAX_SIDE;
    let pixels: Option<u32> = text.trim().parse().ok().filter(|pixels| permitted.contains(pixels));
    pixels.ok_or_else(|| format!("must be an integer from {} to {}", Size::MIN_SIDE, Size::MAX_SIDE))
}

/// Parses the scale of a PNG file.
fn scale(text: &str) -> Result<f64, String> {
    let permitted = Size::MIN_SCALE..=Size::MAX_SCALE;
    let factor: Option<f64> = text.trim().parse().ok().filter(|factor| permitted.contains(factor));
    factor.ok_or_else(|| format!("must be a factor from {} to {}", Size::MIN_SCALE, Size::MAX_SCALE))
}

impl PictureArguments {
    /// The size and the scale of the pictures.
    ///
    /// # Errors
    /// A usage error if an option has no effect on files of these formats.
    pub(super) fn resolution(&self, formats: &[Format]) -> Result<Resolution, Failure> {
        let is_given = self.width.is_some() || self.height.is_some() || self.scale.is_some();
        if is_given && formats.is_empty() {
            let advice = "also give --plot FILE or --out DIR";
            return Err(Failure::usage(format!("--width, --height and --scale are for pictures: {advice}")));
        }
        if self.scale.is_some() && !formats.contains(&Format::Png) {
            let advice = "also give --plot FILE.png, or use --width and --height";
            return Err(Failure::usage(format!("--scale is for PNG files: {advice}")));
        }
        let usual = Size::default();
        Ok(Resolution {
            size: Size {
                width: self.width.unwrap_or(usual.width),
                height: self.height.unwrap_or(usual.height),
            },
            scale: self.scale.unwrap_or(1.0),
            is_given,
        })
    }
}

/// The resolution of pictures.
#[derive(Debug, Clone, Copy)]
pub(super) struct Resolution {
    /// The size of each picture.
    pub(super) size: Size,
    /// The pixels of a PNG file per pixel of this size.
    pub(super) scale: f64,
    /// Whether an option gives the size or the scale.
    is_given: bool,
}

impl Resolution {
    /// Checks whether a sheet with this number of pictures can be drawn.
    ///
    /// # Errors
    /// A usage error if an option gives the resolution, else an error of the patch.
    pub(super) fn check(&self, pictures: usize, format: Format) -> Result<(), Failure> {
        let checked = check_sheet(pictures, format, self.size, self.scale);
        checked.map_err(|error| match self.is_given {
            true => Failure::usage(error.to_string()),
            false => Failure::data(error.to_string()),
        })
    }

    /// The samples of a run that these pictures need. Pictures against time need the envelope only, if there are too
    /// many samples for the memory.
    ///
    /// # Errors
    /// If they need more samples than the memory permits: a picture is against a signal, the samples belong to many
    /// runs, or the envelope is too large because of the width or the number of curves.
    pub(super) fn samples(
        &self,
        pictures: &[PictureSpec],
        settings: &RunSettings,
    ) -> Result<PictureSamples, TooManySamples> {
        let signals = settings.record.len();
        let derivatives = signals * settings.sensitivities.len();
        let curves = pictures.iter().map(|picture| picture.y.len()).sum::<usize>() + derivatives;
        let numbers =
            NUMBERS_FOR_DRAWING + NUMBERS_FOR_TIME + signals + derivatives + NUMBERS_PER_POINT * curves;
        let (samples, max) = (settings.max_samples(), MAX_NUMBERS / numbers as f64);
        if samples <= max {
            return Ok(PictureSamples::All);
        }
        let refused = |reason| Err(TooManySamples { samples, max, reason });
        if pictures.iter().any(|picture| picture.x.value != "t") {
            return refused(SampleDemand::AgainstSignal);
        }
        let permitted_groups = max / SAMPLES_PER_GROUP;
        // Every phase may begin a run, which has one group more.
        let max_groups = permitted_groups - settings.phase_count();
        let pixels = f64::from(self.size.width) * self.scale.max(1.0);
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
}

/// The number of runs of the greatest length that take as long as all runs together. It is 1 for runs without duration.
fn run_count(settings: &RunSettings) -> f64 {
    let duration = settings.duration();
    if duration > 0.0 { settings.total_duration() / duration } else { 1.0 }
}

/// The samples of a run that its pictures need.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum PictureSamples {
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

/// A run with more samples than its pictures permit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct TooManySamples {
    /// Number of samples of the run.
    pub(super) samples: f64,
    /// The largest number of samples.
    pub(super) max: f64,
    /// Why the pictures need every sample.
    pub(super) reason: SampleDemand,
}

/// Why pictures need every sample of a run.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum SampleDemand {
    /// A picture is against a signal.
    AgainstSignal,
    /// The envelope has too few groups for each of the runs.
    ManyRuns,
    /// The envelope of a single run would be too large, because of the width or the number of curves.
    LargePictures,
}

/// What helps if a run is too long for its pictures.
const SHORTER_RUN: &str =
    "give a longer --every, a shorter --for or fewer repetitions, or write a table without pictures";

impl SampleDemand {
    /// The reason for messages.
    pub(super) fn text(self) -> &'static str {
        match self {
            SampleDemand::AgainstSignal => "one is against a signal",
            SampleDemand::ManyRuns => "there are very many repetitions or phases",
            SampleDemand::LargePictures => "they have very many curves or pixels",
        }
    }

    /// What to do about it, for messages.
    pub(super) fn advice(self) -> &'static str {
        match self {
            SampleDemand::AgainstSignal | SampleDemand::ManyRuns => SHORTER_RUN,
            SampleDemand::LargePictures => "draw fewer pictures, or give a smaller --width or --scale",
        }
    }
}

impl PictureSamples {
    /// Number of samples of the blocks in which the run passes its samples on. `None` if the trace keeps all samples.
    pub(super) fn block_samples(self) -> Option<usize> {
        (self != PictureSamples::All).then_some(BLOCK_SAMPLES)
    }

    /// The envelope of a run that has not begun. `None` if the pictures do not need one.
    pub(super) fn envelope(self) -> Option<TraceEnvelope> {
        match self {
            PictureSamples::Envelope { groups } => Some(TraceEnvelope::new(groups)),
            PictureSamples::None | PictureSamples::All => None,
        }
    }
}

/// The pictures of the patch, or every recorded signal against time if it has none. Pictures of derivatives follow.
///
/// The note of each picture has the parameters. Curves are marked from the first overload that makes them wrong.
pub(super) fn pictures(circuit: &Circuit, trace: &Trace) -> Result<Vec<Picture>, Failure> {
    let signals = trace.tracks.iter().filter(|track| track.derivative.is_none());
    let specs = circuit.picture_specs(signals.map(|track| track.name.as_str()));
    let (note, faults) = (parameter_line(circuit), signal_faults(circuit, trace));
    let drawn = specs.iter().map(|spec| draw::picture(trace, spec, Some(&note), &faults));
    let drawn = drawn.collect::<Result<Vec<_>, _>>().and_then(|mut pictures| {
        pictures.extend(draw::sensitivity_pictures(trace, Some(&note), &faults)?);
        Ok(pictures)
    });
    drawn.map_err(|error| Failure::data(error.to_string()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use patchcord::document::{Placed, Span};

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
    ) -> Result<PictureSamples, TooManySamples> {
        let resolution = Resolution { size: Size::default(), scale: 1.0, is_given: false };
        let settings = RunSettings::from_phases([], 1.0).with_duration(samples).repeated(repetitions);
        resolution.samples(specs, &settings.with_signals(["x", "y"]))
    }

    #[test]
    fn pictures_against_time_need_few_samples_of_a_long_run() {
        assert_eq!(samples(&specs("t", 1), 2e6, 1), Ok(PictureSamples::All));
        // From 25 to 50 groups for each of 900 pixels.
        let few: Result<_, TooManySamples> = Ok(PictureSamples::Envelope { groups: 45_000 });
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
    fn sides_and_scales_have_limits() {
        assert_eq!((side("240"), side(" 4000 ")), (Ok(240), Ok(4000)));
        for wrong in ["239", "4001", "900.5", "-900", "wide"] {
            assert_eq!(side(wrong), Err("must be an integer from 240 to 4000".to_owned()), "{wrong}");
        }
        assert_eq!((scale("2"), scale("0.25")), (Ok(2.0), Ok(0.25)));
        for wrong in ["0", "-1", "11", "NaN", "inf", "2x"] {
            assert_eq!(scale(wrong), Err("must be a factor from 0.25 to 10".to_owned()), "{wrong}");
        }
    }
}
