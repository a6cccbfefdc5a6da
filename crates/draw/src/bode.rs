//! Bode plots: magnitude in decibels and phase in degrees against frequency.

use crate::plot::{Axis, Channel, Marker, Picture};
use patchcord_analysis::format::QuantityFormat;
use patchcord_analysis::linear::{FrequencyResponse, ResponsePoint, Root};

/// Returns the magnitude and the phase of a response as two pictures, to be stacked in this order.
///
/// The natural frequencies of oscillating roots within the range are marked. `note` is printed below
/// the title.
///
/// # Examples
///
/// ```
/// use patchcord_analysis::linear::{FrequencyBand, TransferFunction, roots};
/// use patchcord_core::circuit::Circuit;
/// use patchcord_core::ir::Program;
/// use patchcord_core::patch::Patch;
/// use patchcord_core::solve::Machine;
/// use patchcord_draw::bode;
///
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// let patch = Patch::read("../../patches/lessons/driven-oscillator.json")?;
/// let program = Program::new(&Circuit::new(&patch)?)?;
/// let model = Machine::new(&program, 1e-3)?.state_space();
/// let band = FrequencyBand { low: 0.1, high: 100.0 };
/// let response = TransferFunction::new(&model, "push", "x")?.response(band)?;
///
/// let [magnitude, phase] = bode(&response, &roots(&model)?, None);
/// assert_eq!(magnitude.vertical.unit, "dB (0 dB: 1 mm per N)");
/// assert_eq!(phase.markers[0].label, "1.007 Hz");
/// assert!(magnitude.horizontal.logarithmic);
/// # Ok(())
/// # }
/// ```
pub fn bode(response: &FrequencyResponse, roots: &[Root], note: Option<&str>) -> [Picture; 2] {
    let FrequencyResponse { input, output, unit, .. } = response;
    let decibels = points(response, |point| point.decibels());
    let degrees = points(response, |point| point.phase.to_degrees());
    let reference = if unit.is_empty() { "dB".to_owned() } else { format!("dB (0 dB: 1 {unit})") };
    let magnitude = Axis::fit_tight(
        format!("{output} / {input}"),
        reference,
        widened(&decibels),
        Axis::VERTICAL_DIVISIONS,
    );
    let phase = phase_axis(format!("phase of {output} against {input}"), ordinates(&degrees));
    let markers = markers(response, roots);
    // The labels are in the phase plot only; there the curve falls and leaves space for them.
    let bare: Vec<Marker> =
        markers.iter().map(|marker| Marker { label: String::new(), ..marker.clone() }).collect();
    let title = format!("Bode plot: {}", response.title());
    [
        picture(response, title, magnitude, decibels, note, &bare),
        picture(response, String::new(), phase, degrees, None, &markers),
    ]
}

/// Returns one of the two pictures.
///
/// The horizontal axis covers the frequencies of the response. `points` are frequencies in Hz and values in the unit of
/// `vertical`.
fn picture(
    response: &FrequencyResponse,
    title: String,
    vertical: Axis,
    points: Vec<(f64, f64)>,
    note: Option<&str>,
    markers: &[Marker],
) -> Picture {
    let (low, high) = ends(response.points.iter().map(|point| point.frequency));
    let horizontal = Axis::logarithmic("frequency", "Hz", low, high);
    let channels = vec![Channel::line(&response.output, points)];
    Picture {
        channels,
        note: note.map(str::to_owned),
        markers: markers.to_vec(),
        ..Picture::new(title, horizontal, vertical)
    }
}

/// Returns the frequency and a value of each point of a response.
fn points(response: &FrequencyResponse, value: impl Fn(&ResponsePoint) -> f64) -> Vec<(f64, f64)> {
    response.points.iter().map(|point| (point.frequency, value(point))).collect()
}

/// Returns the second coordinate of each point.
fn ordinates(points: &[(f64, f64)]) -> impl Iterator<Item = f64> {
    points.iter().map(|point| point.1)
}

/// Returns the ordinates, with a margin so that a constant curve does not show its rounding errors.
fn widened(points: &[(f64, f64)]) -> impl Iterator<Item = f64> {
    let (low, high) = ends(ordinates(points));
    let middle = 0.5 * (low + high);
    ordinates(points).chain([middle - MARGIN, middle + MARGIN])
}

/// The margin around the middle of the magnitude, in decibels.
const MARGIN: f64 = 1.0;

/// Returns the lowest and highest finite values; zeros if there are none.
fn ends(values: impl Iterator<Item = f64>) -> (f64, f64) {
    let empty = (f64::INFINITY, f64::NEG_INFINITY);
    let (low, high) = values
        .filter(|value| value.is_finite())
        .fold(empty, |(low, high), value| (low.min(value), high.max(value)));
    if low <= high { (low, high) } else { (0.0, 0.0) }
}

/// Returns an axis in degrees with divisions of 45 degrees times a power of two.
fn phase_axis(label: String, degrees: impl Iterator<Item = f64>) -> Axis {
    let (low, high) = ends(degrees);
    let mut division = 45.0;
    loop {
        let (first, last) = ((low / division + OVERSHOOT).floor(), (high / division - OVERSHOOT).ceil());
        let last = last.max(first + 1.0);
        if last - first <= Axis::VERTICAL_DIVISIONS as f64 {
            let (low, high, divisions) = (first * division, last * division, (last - first) as usize);
            return Axis { label, unit: "degrees".to_owned(), low, high, divisions, logarithmic: false };
        }
        division *= 2.0;
    }
}

/// The part of a division by which phases may exceed the axis; it covers rounding.
const OVERSHOOT: f64 = 1e-3;

/// Returns markers at the natural frequencies of oscillating roots within the frequency range.
fn markers(response: &FrequencyResponse, roots: &[Root]) -> Vec<Marker> {
    let oscillating = roots.iter().filter(|root| root.imaginary > 0.0);
    let markers = oscillating.map(|root| {
        let label = format!("{} Hz", QuantityFormat::new("", 1.0).number(root.hertz()));
        Marker { at: root.hertz(), label }
    });
    let (low, high) = ends(response.points.iter().map(|point| point.frequency));
    markers.filter(|marker| (low..=high).contains(&marker.at)).collect()
}
