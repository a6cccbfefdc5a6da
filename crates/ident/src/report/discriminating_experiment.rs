//! The experiment that distinguishes two effects: as a sentence, as a JSON document, and as a CSV table.
//!
//! The sentence follows the verdict if two effects are tied. The table has the proposed drive, so that it can be fed
//! to the real system, and the prediction of each effect. Plotting a new measurement over the predictions shows which
//! effect is missing.

use std::fmt::Write as _;

use indexmap::IndexMap;
use serde::Serialize;

use crate::data::experiment::MeasuredOutput;
use crate::design::discriminating_experiment::{DiscriminatingExperiment, Shape};
use crate::report::labels::effect_label;
use crate::report::values::format_pure_number;

/// An experiment that distinguishes two effects, as a JSON document.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct DiscriminatingExperimentDocument {
    /// The two effects, each at its site.
    pub from: [String; 2],
    /// Whether the experiment is expected to decide between them.
    pub tells: bool,
    /// The drive.
    pub drive: String,
    /// The shape of the drive: "step", "ramps", "sine" or "reversals".
    pub shape: &'static str,
    /// Amplitude to either side of `about`, in the unit of the drive.
    pub amplitude: f64,
    /// Value at rest, in the unit of the drive.
    pub about: f64,
    /// The unit of the drive.
    pub unit: String,
    /// Whether the drive has a sign that the records never have.
    pub turns: bool,
    /// The period in seconds; of a step, the time before it.
    pub period: f64,
    /// The frequency in Hz; null for a step.
    pub frequency: Option<f64>,
    /// Difference of the two predictions by output, rms over the noise.
    pub apart: IndexMap<String, f64>,
    /// The expected difference in standard errors of the comparison.
    pub standard_errors: f64,
}

impl From<&DiscriminatingExperiment> for DiscriminatingExperimentDocument {
    /// The frequency is 1 / period; a step has none.
    fn from(experiment: &DiscriminatingExperiment) -> Self {
        DiscriminatingExperimentDocument {
            from: experiment.effects.each_ref().map(effect_label),
            tells: experiment.is_decisive(),
            drive: experiment.drive.clone(),
            shape: experiment.shape.as_str(),
            amplitude: experiment.amplitude,
            about: experiment.rest,
            unit: experiment.unit.clone(),
            turns: experiment.reverses_sign,
            period: experiment.period,
            frequency: (experiment.shape != Shape::Step).then(|| 1.0 / experiment.period),
            apart: experiment
                .outputs
                .iter()
                .cloned()
                .zip(experiment.difference_rms.iter().copied())
                .collect(),
            standard_errors: experiment.standard_errors,
        }
    }
}

/// The experiment as a sentence without a full stop: the drive, and the expected difference of the predictions.
///
/// The difference is the rms of the output that differs most, in multiples of its noise. The standard errors are
/// rounded to one decimal.
pub fn experiment_sentence(experiment: &DiscriminatingExperiment) -> String {
    let most = format_pure_number(experiment.difference_rms.iter().copied().fold(0.0, f64::max));
    let errors = format_pure_number((10.0 * experiment.standard_errors).round() / 10.0);
    let difference = format!("{most} times the noise, or {errors} standard errors over a record");
    match experiment.is_decisive() {
        true if experiment.reverses_sign => format!(
            "{} would distinguish them if {} can change its sign: the predictions differ by {difference}",
            drive_text(experiment),
            experiment.drive
        ),
        true => format!(
            "{} would distinguish them: the predictions differ by {difference}",
            drive_text(experiment)
        ),
        false => {
            format!(
                "none of the drives tried would distinguish them: the predictions differ by at most {difference}"
            )
        }
    }
}

/// The drive as text, for example "a sine of 3 N at 1.2 Hz on F".
fn drive_text(experiment: &DiscriminatingExperiment) -> String {
    let shape = match experiment.shape {
        Shape::Step | Shape::Sine => format!("a {}", experiment.shape.as_str()),
        Shape::Ramps | Shape::Reversals => experiment.shape.as_str().to_owned(),
    };
    let rest = match experiment.rest {
        0.0 => String::new(),
        rest => format!(" about {}", format_pure_number(rest)),
    };
    let time = match experiment.shape {
        Shape::Step => format!("after {} s", format_pure_number(experiment.period)),
        _ => format!("at {} Hz", format_pure_number(1.0 / experiment.period)),
    };
    let (amplitude, unit) = (format_pure_number(experiment.amplitude), &experiment.unit);
    format!("{shape} of {amplitude}{rest} {unit} {time} on {}", experiment.drive)
}

/// The experiment as a CSV table: time, drives, and both predictions of every output, in the units of the
/// experiment's outputs. Comment lines in front have the units.
///
/// The beginning of a table with one drive F and one output x:
///
/// ```text
/// # drives that distinguish leak at I2 from drift at I2, and both predictions
/// # t: s
/// # F: N
/// # x with leak at I2: mm
/// # x with drift at I2: mm
/// t,F,x with leak at I2,x with drift at I2
/// ```
///
/// Names that contain a comma are not quoted. Rows are evenly spaced in time, from 0.
pub fn experiment_csv(experiment: &DiscriminatingExperiment, outputs: &[MeasuredOutput]) -> String {
    let purpose =
        if experiment.is_decisive() { "drives that distinguish" } else { "drives that best distinguish" };
    let effects = experiment.effects.each_ref().map(effect_label);
    let [one, other] = &effects;
    let mut text = format!("# {purpose} {one} from {other}, and both predictions\n");
    let drives = experiment.drives.iter().map(|drive| (drive.drive.clone(), drive.unit.text()));
    let unit = |name: &String| {
        outputs.iter().find(|output| output.signal == *name).map_or("V", |output| output.unit.text())
    };
    let predicted = effects.iter().flat_map(|effect| {
        experiment.outputs.iter().map(move |output| (format!("{output} with {effect}"), unit(output)))
    });
    let columns: Vec<_> = [("t".to_owned(), "s")].into_iter().chain(drives).chain(predicted).collect();
    for (name, unit) in &columns {
        let _ = writeln!(text, "# {name}: {unit}");
    }
    let names: Vec<&str> = columns.iter().map(|(name, _)| name.as_str()).collect();
    let _ = writeln!(text, "{}", names.join(","));
    for sample in 0..experiment.record.len() {
        let tracks = experiment.record.drives.iter().chain(experiment.predictions.iter().flatten());
        let values = tracks.map(|track| track[sample]);
        let time = sample as f64 * experiment.record.interval;
        let cells: Vec<String> = [time].into_iter().chain(values).map(|value| value.to_string()).collect();
        let _ = writeln!(text, "{}", cells.join(","));
    }
    text
}
