//! The experiment that distinguishes two effects: in a sentence, as a document, and as a table.

use std::fmt::Write as _;

use indexmap::IndexMap;
use serde::Serialize;

use crate::data::experiment::Output;
use crate::design::discriminating_experiment::{Separating, Shape};
use patchcord_analysis::instruments::number;

/// An experiment that distinguishes two effects, as a JSON document.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct DiscriminatingExperimentDocument {
    /// The two effects, each at its place.
    pub from: [String; 2],
    /// Whether the experiment is expected to decide between them.
    pub tells: bool,
    /// The drive.
    pub drive: String,
    /// The shape of the drive: "step", "ramps", "sine" or "reversals".
    pub shape: &'static str,
    /// How far the drive goes to either side, in its unit.
    pub amplitude: f64,
    /// The value about which it goes, in its unit.
    pub about: f64,
    /// The unit of the drive.
    pub unit: String,
    /// Whether the drive has a sign that the records never have.
    pub turns: bool,
    /// The period in seconds; of a step, the time before it.
    pub period: f64,
    /// The frequency in Hz; null for a step.
    pub frequency: Option<f64>,
    /// By how much the two predictions of every output differ, rms over the noise.
    pub apart: IndexMap<String, f64>,
    /// The expected difference in standard errors of the comparison.
    pub standard_errors: f64,
}

impl From<&Separating> for DiscriminatingExperimentDocument {
    fn from(found: &Separating) -> Self {
        DiscriminatingExperimentDocument {
            from: found.from.clone(),
            tells: found.tells(),
            drive: found.drive.clone(),
            shape: found.shape.as_str(),
            amplitude: found.amplitude,
            about: found.about,
            unit: found.unit.clone(),
            turns: found.turns,
            period: found.period,
            frequency: (found.shape != Shape::Step).then(|| 1.0 / found.period),
            apart: found.outputs.iter().cloned().zip(found.apart.iter().copied()).collect(),
            standard_errors: found.errors,
        }
    }
}

/// The experiment in a sentence.
pub fn experiment_sentence(found: &Separating) -> String {
    let most = number(found.apart.iter().copied().fold(0.0, f64::max));
    let errors = number((10.0 * found.errors).round() / 10.0);
    let differ = format!("they differ by {most} times the noise, {errors} standard errors over a record");
    match found.tells() {
        true if found.turns => {
            let drive = &found.drive;
            format!("{} would, if {drive} can change its sign: {differ}", drive_in_words(found))
        }
        true => format!("{} would: {differ}", drive_in_words(found)),
        false => format!("none of the drives tried would: at most {differ}"),
    }
}

/// "a sine of 3 N at 1.2 Hz on F".
fn drive_in_words(found: &Separating) -> String {
    let what = match found.shape {
        Shape::Step | Shape::Sine => format!("a {}", found.shape.as_str()),
        Shape::Ramps | Shape::Reversals => found.shape.as_str().to_owned(),
    };
    let about = match found.about {
        0.0 => String::new(),
        about => format!(" about {}", number(about)),
    };
    let when = match found.shape {
        Shape::Step => format!("after {} s", number(found.period)),
        _ => format!("at {} Hz", number(1.0 / found.period)),
    };
    format!("{what} of {}{about} {} {when} on {}", number(found.amplitude), found.unit, found.drive)
}

/// The experiment as a table: time, drives, and every output as either effect predicts it, in the units of the experiment's
/// outputs.
pub fn experiment_csv(found: &Separating, outputs: &[Output]) -> String {
    let what = if found.tells() { "drives that tell" } else { "drives that come nearest to telling" };
    let mut text = format!("# {what} {} from {}, and what either predicts\n", found.from[0], found.from[1]);
    let drives = found.feeds.iter().map(|feed| (feed.drive.clone(), feed.unit.text()));
    let unit =
        |name: &String| outputs.iter().find(|own| own.signal == *name).map_or("V", |own| own.unit.text());
    let predicted = found.from.iter().flat_map(|from| {
        found.outputs.iter().map(move |output| (format!("{output} with {from}"), unit(output)))
    });
    let columns: Vec<_> = [("t".to_owned(), "s")].into_iter().chain(drives).chain(predicted).collect();
    for (name, unit) in &columns {
        let _ = writeln!(text, "# {name}: {unit}");
    }
    let names: Vec<&str> = columns.iter().map(|(name, _)| name.as_str()).collect();
    let _ = writeln!(text, "{}", names.join(","));
    for sample in 0..found.record.len() {
        let tracks = found.record.drives.iter().chain(found.predictions.iter().flatten());
        let values = tracks.map(|track| track[sample]);
        let time = sample as f64 * found.record.interval;
        let cells: Vec<String> = [time].into_iter().chain(values).map(|own| own.to_string()).collect();
        let _ = writeln!(text, "{}", cells.join(","));
    }
    text
}
