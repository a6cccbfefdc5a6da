//! What a model of a slide is worth: how far off its velocity is in a run over a whole record, driven by the measured force and
//! begun as was measured (docs/measured.md).

use std::f64::consts::PI;

use patchcord_core::patch::Patch;
use patchcord_ident::fit::model::{Choice, FitProgram, Knob, Model};
use patchcord_ident::{Experiment, Record};

/// The filter lets through what is slower than this, in Hz.
const CUTOFF: f64 = 100.0;
/// So many samples lie before and behind a record while it is filtered, turned about its ends.
const MARGIN: usize = 500;

/// The error in velocity as a share of the measured velocity, both rms; nothing where the patch cannot be run so.
///
/// `fit` names parameters of the patch, `knobs` holds their values.
pub fn error(
    experiment: &Experiment,
    patch: &Patch,
    (fit, knobs): (&[String], &[f64]),
    record: &Record,
) -> Option<f64> {
    let outputs = ["v".to_owned()];
    let records = std::slice::from_ref(record);
    let lowered = FitProgram::new(patch, &experiment.drives).ok()?;
    let model = Model::new(&lowered, patch, records, fit, &[], &outputs, 4).ok()?;
    let position = &record.outputs[0];
    let measured = rates(&smoothed(position, record.interval), record.interval);
    let volts =
        |scale: &str, value: f64| -value / patch.value()["scales"][scale]["per_volt"].as_f64().unwrap();
    let begun = |own: &Knob| match own.name.as_str() {
        "initial_IX" => volts("position", position[0]),
        "initial_IV" => volts("velocity", measured[0]),
        _ => own.value,
    };
    let initial = model.initial.iter().map(begun).collect();
    let course = model.run(0, &[Choice { knobs: knobs.to_vec(), initial }]).pop()??;
    let off: f64 = measured.iter().zip(&course[0]).map(|(datum, own)| (datum - own).powi(2)).sum();
    Some((off / measured.iter().map(|datum| datum * datum).sum::<f64>()).sqrt())
}

/// Differences of neighbours, over two intervals but at the ends.
fn rates(track: &[f64], interval: f64) -> Vec<f64> {
    let last = track.len() - 1;
    let rate = |place: usize| {
        let (from, to) = (place.saturating_sub(1), (place + 1).min(last));
        (track[to] - track[from]) / ((to - from) as f64 * interval)
    };
    (0..track.len()).map(rate).collect()
}

/// A track through Butterworth's filter of fourth order, forth and back, which shifts nothing.
fn smoothed(track: &[f64], interval: f64) -> Vec<f64> {
    let (first, last) = (track[0], track[track.len() - 1]);
    let before = track[1..=MARGIN].iter().rev().map(|own| 2.0 * first - own);
    let behind = track[track.len() - 1 - MARGIN..track.len() - 1].iter().rev().map(|own| 2.0 * last - own);
    let mut all: Vec<f64> = before.chain(track.iter().copied()).chain(behind).collect();
    for _ in 0..2 {
        for section in sections(interval) {
            section.filter(&mut all);
        }
        all.reverse();
    }
    all[MARGIN..MARGIN + track.len()].to_vec()
}

/// A part of the filter with two poles: y = b0 (x + 2 x' + x'') - a1 y' - a2 y''.
struct Section {
    b0: f64,
    a1: f64,
    a2: f64,
}

/// Both pairs of poles, brought over by the bilinear transform.
fn sections(interval: f64) -> [Section; 2] {
    let w = (PI * CUTOFF * interval).tan();
    [5.0, 7.0].map(|place| {
        let damping = -2.0 * (PI * place / 8.0).cos();
        let a0 = 1.0 + damping * w + w * w;
        Section { b0: w * w / a0, a1: 2.0 * (w * w - 1.0) / a0, a2: (1.0 - damping * w + w * w) / a0 }
    })
}

impl Section {
    /// In place, begun as if the track had always stood where it begins.
    fn filter(&self, track: &mut [f64]) {
        let first = track.first().copied().unwrap_or_default();
        let (mut given, mut made) = ([first; 2], [first; 2]);
        for own in track {
            let sum = *own + 2.0 * given[0] + given[1];
            let next = self.b0 * sum - self.a1 * made[0] - self.a2 * made[1];
            (given, made) = ([*own, given[0]], [next, made[0]]);
            *own = next;
        }
    }
}
