//! The pictures of a run: the options for their size, and what they show.

use clap::Args;

use super::failure::Failure;
use patchcord::circuit::Circuit;
use patchcord::draw::plot::{Format, Picture, Size, check_sheet};
use patchcord::draw::{self, SampleDemand};
use patchcord::instruments::{parameter_line, signal_faults};
use patchcord::trace::Trace;

#[derive(Args)]
pub(super) struct PictureArguments {
    /// Width of each picture in pixels, 240 to 4000; 900 if absent
    #[arg(long, value_name = "PIXELS", allow_negative_numbers = true, value_parser = side)]
    width: Option<u32>,
    /// Height of each picture in pixels, 240 to 4000; 560 if absent
    #[arg(long, value_name = "PIXELS", allow_negative_numbers = true, value_parser = side)]
    height: Option<u32>,
    /// Resolution of PNG files: 2 gives twice as many pixels along each side. From 0.25 to 10; 1 if absent
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
}

/// What to do about pictures that need too many samples, for messages.
pub(super) fn advice_on_samples(demand: SampleDemand) -> &'static str {
    match demand {
        SampleDemand::AgainstSignal | SampleDemand::ManyRuns => {
            "give a longer --every, a shorter --for or fewer repetitions, or write a table without pictures"
        }
        SampleDemand::LargePictures => "draw fewer pictures, or give a smaller --width or --scale",
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
