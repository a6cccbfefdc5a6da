//! The Bode plot: magnitude in decibels and phase in degrees against frequency.

use crate::plot::{Axis, Channel, Mark, Picture};
use patchcord_analysis::instruments::Display;
use patchcord_analysis::linear::{Response, ResponsePoint, Root};

/// Two pictures of a response, one to stand below the other, with the natural frequencies of oscillating roots marked.
/// `note` is a line of small print.
pub fn bode(response: &Response, roots: &[Root], note: Option<String>) -> [Picture; 2] {
    let Response { input, output, unit, .. } = response;
    let decibels = points(response, |point| point.decibels());
    let degrees = points(response, |point| point.phase.to_degrees());
    let reference = if unit.is_empty() { "dB".to_owned() } else { format!("dB (0 dB: 1 {unit})") };
    let magnitude = Axis::snug(format!("{output} / {input}"), reference, widened(&decibels), Axis::UP);
    let phase = turns(format!("phase of {output} against {input}"), ordinates(&degrees));
    let marks = marks(response, roots);
    // Labels stand below only, where the curve is on its way down.
    let bare: Vec<Mark> = marks.iter().map(|mark| Mark { label: String::new(), ..mark.clone() }).collect();
    let title = format!("Bode plot: {}", response.title());
    [
        picture(response, title, magnitude, decibels, note, &bare),
        picture(response, String::new(), phase, degrees, None, &marks),
    ]
}

fn picture(
    response: &Response,
    title: String,
    vertical: Axis,
    points: Vec<(f64, f64)>,
    note: Option<String>,
    marks: &[Mark],
) -> Picture {
    let (low, high) = ends(response.points.iter().map(|point| point.frequency));
    let horizontal = Axis::ratios("frequency", "Hz", low, high);
    let channels = vec![Channel::line(&response.output, points)];
    Picture { channels, note, marks: marks.to_vec(), ..Picture::new(title, horizontal, vertical) }
}

fn points(response: &Response, value: impl Fn(&ResponsePoint) -> f64) -> Vec<(f64, f64)> {
    response.points.iter().map(|point| (point.frequency, value(point))).collect()
}

fn ordinates(points: &[(f64, f64)]) -> impl Iterator<Item = f64> {
    points.iter().map(|point| point.1)
}

/// The ordinates, with room around them where they are level but for rounding.
fn widened(points: &[(f64, f64)]) -> impl Iterator<Item = f64> {
    let (low, high) = ends(ordinates(points));
    let middle = 0.5 * (low + high);
    ordinates(points).chain([middle - ROOM, middle + ROOM])
}

/// Decibels to either side of a level curve.
const ROOM: f64 = 1.0;

/// The least and the largest of the finite values.
fn ends(values: impl Iterator<Item = f64>) -> (f64, f64) {
    let least_and_most = (f64::INFINITY, f64::NEG_INFINITY);
    let (low, high) = values
        .filter(|value| value.is_finite())
        .fold(least_and_most, |(low, high), value| (low.min(value), high.max(value)));
    if low <= high { (low, high) } else { (0.0, 0.0) }
}

/// An axis of degrees in divisions that are parts of a turn, or whole turns.
fn turns(label: String, degrees: impl Iterator<Item = f64>) -> Axis {
    let (low, high) = ends(degrees);
    let mut division = 45.0;
    loop {
        let (first, last) = ((low / division + SLACK).floor(), (high / division - SLACK).ceil());
        let last = last.max(first + 1.0);
        if last - first <= Axis::UP as f64 {
            let (low, high, divisions) = (first * division, last * division, (last - first) as usize);
            return Axis { label, unit: "degrees".to_owned(), low, high, divisions, logarithmic: false };
        }
        division *= 2.0;
    }
}

/// Phases this share of a division beyond a line need no further one.
const SLACK: f64 = 1e-3;

/// Natural frequencies within the response at which it can ring.
fn marks(response: &Response, roots: &[Root]) -> Vec<Mark> {
    let ringing = roots.iter().filter(|root| root.imaginary > 0.0);
    let marks = ringing.map(|root| {
        let label = format!("{} Hz", Display::new("", 1.0).number(root.hertz()));
        Mark { at: root.hertz(), label }
    });
    let (low, high) = ends(response.points.iter().map(|point| point.frequency));
    marks.filter(|mark| (low..=high).contains(&mark.at)).collect()
}
