//! The error in velocity of a model of a slide, the quality measure of docs/measured.md.
//!
//! The model runs over a whole record. The measured force drives it, and it starts with the measured position and
//! velocity. The measured velocity is the difference of the smoothed position.

use std::f64::consts::PI;

use patchcord_core::patch::Patch;
use patchcord_ident::fit::model::{FitParameter, FitProgram, Model, RunValues};
use patchcord_ident::{Experiment, Record};

/// Cutoff frequency of the filter in Hz, as in docs/measured.md.
const CUTOFF_HZ: f64 = 100.0;
/// Samples of padding at each end of a record while it is filtered. The padding is the record reflected about its end
/// point.
const PADDING: usize = 500;

/// The rms error in velocity as a share of the rms measured velocity. `None` if the patch cannot be run.
///
/// `fit` has the names of parameters of the patch, `values` their values in the units of the patch. The patch must have
/// the signal v, and the record's first output must be the position.
pub(crate) fn error(
    experiment: &Experiment,
    patch: &Patch,
    (fit, values): (&[String], &[f64]),
    record: &Record,
) -> Option<f64> {
    let outputs = ["v".to_owned()];
    let records = std::slice::from_ref(record);
    let program = FitProgram::new(patch, &experiment.drives).ok()?;
    let model = Model::new(&program, patch, records, fit, &[], &outputs, 4).ok()?;
    let position = &record.outputs[0];
    let measured = derivative(&smooth(position, record.interval), record.interval);
    let volts =
        |scale: &str, value: f64| -value / patch.value()["scales"][scale]["per_volt"].as_f64().unwrap();
    let initial_value = |state: &FitParameter| match state.name.as_str() {
        "initial_IX" => volts("position", position[0]),
        "initial_IV" => volts("velocity", measured[0]),
        _ => state.value,
    };
    let initial = model.initial.iter().map(initial_value).collect();
    let outputs = model.run(0, &[RunValues { parameters: values.to_vec(), initial }]).pop()??;
    let error: f64 = measured.iter().zip(&outputs[0]).map(|(datum, value)| (datum - value).powi(2)).sum();
    Some((error / measured.iter().map(|datum| datum * datum).sum::<f64>()).sqrt())
}

/// The derivative by central differences, one-sided at both ends.
fn derivative(samples: &[f64], interval: f64) -> Vec<f64> {
    let last = samples.len() - 1;
    let rate = |index: usize| {
        let (from, to) = (index.saturating_sub(1), (index + 1).min(last));
        (samples[to] - samples[from]) / ((to - from) as f64 * interval)
    };
    (0..samples.len()).map(rate).collect()
}

/// Filters samples with a fourth-order Butterworth low-pass, forward and backward, so that the phase does not change.
fn smooth(samples: &[f64], interval: f64) -> Vec<f64> {
    let (first, last) = (samples[0], samples[samples.len() - 1]);
    let before = samples[1..=PADDING].iter().rev().map(|sample| 2.0 * first - sample);
    let end = samples.len() - 1;
    let after = samples[end - PADDING..end].iter().rev().map(|sample| 2.0 * last - sample);
    let mut padded: Vec<f64> = before.chain(samples.iter().copied()).chain(after).collect();
    for _ in 0..2 {
        for section in sections(interval) {
            section.filter(&mut padded);
        }
        padded.reverse();
    }
    padded[PADDING..PADDING + samples.len()].to_vec()
}

/// A second-order section of the filter: y[n] = b0 (x[n] + 2 x[n-1] + x[n-2]) - a1 y[n-1] - a2 y[n-2].
struct Section {
    b0: f64,
    a1: f64,
    a2: f64,
}

/// The two sections of the filter, by the bilinear transform. Each has one pair of complex poles, at 5/8 and 7/8 of pi.
fn sections(interval: f64) -> [Section; 2] {
    let w = (PI * CUTOFF_HZ * interval).tan();
    [5.0, 7.0].map(|eighths| {
        let damping = -2.0 * (PI * eighths / 8.0).cos();
        let a0 = 1.0 + damping * w + w * w;
        Section { b0: w * w / a0, a1: 2.0 * (w * w - 1.0) / a0, a2: (1.0 - damping * w + w * w) / a0 }
    })
}

impl Section {
    /// Filters in place. The section starts in the steady state of the first sample.
    fn filter(&self, samples: &mut [f64]) {
        let first = samples.first().copied().unwrap_or_default();
        let (mut inputs, mut outputs) = ([first; 2], [first; 2]);
        for sample in samples {
            let sum = *sample + 2.0 * inputs[0] + inputs[1];
            let next = self.b0 * sum - self.a1 * outputs[0] - self.a2 * outputs[1];
            (inputs, outputs) = ([*sample, inputs[0]], [next, outputs[0]]);
            *sample = next;
        }
    }
}
