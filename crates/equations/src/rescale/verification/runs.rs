//! Compares the runs of both patches.
//!
//! A motion that amplifies deviations also amplifies the rounding of the numbers in the document, so only the beginning
//! of such a run agrees. A later difference is accepted only if the old patch itself reacts as strongly to initial voltages
//! that are changed a little.

use std::collections::BTreeMap;

use patchcord_core::machines::REFERENCE;
use patchcord_core::patch::{Edit, Patch};
use patchcord_core::trace::Trace;
use patchcord_expr::format_significant;
use serde_json::{Value, json};

use super::{CANCELLED, Pair, TOLERANCE, name};
use crate::rescale::error::RescaleError;
use crate::rescale::measured::Measured;
use crate::rescale::wiring::Wiring;

/// The share of the run that must agree even if a motion amplifies deviations.
const LEAST_SHARE: f64 = 0.1;
/// Largest difference of a voltage that is not amplified rounding, as a share of the peak.
const AMPLIFIED: f64 = 1e-6;
/// Share by which initial voltages change to find out whether the motion amplifies deviations. It is far above the
/// rounding of numbers in the document, and far below [`AMPLIFIED`].
const CHANGE: f64 = 1e-9;
/// Volts by which initial voltages change in addition, because some are 0.
const ADDED_VOLTS: f64 = 1e-8;
/// Digits of a time in a message.
const DIGITS: usize = 4;

/// How far two runs agree.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct RunAgreement {
    /// The problem time up to which they agree.
    pub until: f64,
    /// Whether they agree to their end.
    pub is_whole: bool,
}

/// The first sample at which two runs differ.
struct Difference {
    sample: usize,
    /// The output that differs, or another quantity.
    quantity: String,
}

/// Compares the records of both runs.
///
/// # Errors
/// The message that names an output, if it differs by more than amplified rounding.
pub(super) fn compare_runs(pair: &Pair<'_>) -> Result<RunAgreement, String> {
    let (time, factors) = (&pair.old.trace.time, &pair.factors);
    if let Some(Difference { sample, quantity }) = first_difference(pair, pair.new, factors, AMPLIFIED)? {
        let is_early = (sample as f64) < LEAST_SHARE * time.len() as f64;
        if is_early || !amplifies_deviations(pair, sample) {
            let at = time.get(sample).or(time.last()).copied().unwrap_or(0.0);
            return Err(format!("{quantity} differs from t = {} s on", format_significant(at, DIGITS)));
        }
    }
    let first = first_difference(pair, pair.new, factors, TOLERANCE)?;
    let agreeing = first.as_ref().map_or(time.len(), |difference| difference.sample);
    Ok(RunAgreement { until: last_time(time, agreeing), is_whole: first.is_none() })
}

/// The time of the last of the first samples. The clock restarts in every repetition: 0 if the next sample is the first
/// one of a repetition, or if there is none.
fn last_time(time: &[f64], count: usize) -> f64 {
    let Some(last) = count.checked_sub(1).and_then(|last| time.get(last)).copied() else { return 0.0 };
    let restarts = time.get(count).is_some_and(|next| *next < last);
    if restarts { 0.0 } else { last }
}

/// Whether a run of the old patch with slightly changed initial voltages differs as much as the new patch, at the same
/// sample or earlier.
fn amplifies_deviations(pair: &Pair<'_>, sample: usize) -> bool {
    let Some(patch) = with_changed_initial_voltages(pair.old) else { return false };
    let Ok(changed) = Measured::new(&patch, RescaleError::Patch) else { return false };
    let ones = vec![1.0; pair.factors.len()];
    let first = first_difference(pair, &changed, &ones, AMPLIFIED);
    first.is_ok_and(|first| first.is_some_and(|difference| difference.sample <= sample))
}

/// The patch with initial voltages that are changed a little. `None` if its text cannot be edited.
fn with_changed_initial_voltages(measured: &Measured) -> Option<Patch> {
    let wiring = Wiring::new(&measured.circuit);
    let initial = (0..wiring.len()).filter(|element| wiring.kind(*element).setting("initial").is_some());
    let edits = initial.filter_map(|element| {
        Some((wiring.path(element, "initial")?, changed_voltage(wiring.written(element, "initial"))))
    });
    // The instances of a macro share their settings.
    let edits: BTreeMap<Vec<String>, Value> = edits.collect();
    let edits: Vec<Edit> = edits.into_iter().map(|(path, value)| Edit::at(path, value)).collect();
    let patch = measured.circuit.patch();
    patch.with_edits(patch.file(), &edits).ok()
}

/// An initial voltage of the document that is changed a little, and not beyond 100 V.
fn changed_voltage(written: Option<&Value>) -> Value {
    let factor = 1.0 - CHANGE;
    match written {
        Some(Value::String(formula)) => json!(format!("({formula}) * {factor} + {ADDED_VOLTS}")),
        Some(number) => json!(number.as_f64().unwrap_or(0.0) * factor + ADDED_VOLTS),
        None => json!(ADDED_VOLTS),
    }
}

/// The first sample at which a voltage of another run is not its factor times that of the old run. `share` is the
/// permitted difference as a share of the peak.
///
/// # Errors
/// The message if the other run has no record of an output.
fn first_difference(
    pair: &Pair<'_>,
    other: &Measured,
    factors: &[f64],
    share: f64,
) -> Result<Option<Difference>, String> {
    let old = &pair.old.trace;
    let count = old.len().min(other.trace.len());
    let tolerance = pair.old.circuit.run_plan().tolerance.as_ref().map_or(0.0, |placed| placed.value);
    let mut first = clock_difference(old, &other.trace, share + tolerance);
    for (element, factor) in factors.iter().enumerate() {
        let output = name(pair, element);
        let Some(own) = old.track(output) else { continue };
        let track = other.trace.track(output).ok_or_else(|| format!("{output} has no record"))?;
        let peak = own.volts.iter().fold(0.0, |peak: f64, volts| peak.max(volts.abs()));
        // The errors of steps that adapt are within the tolerance of the run, in units of 100 V.
        let permitted = share * peak.max(CANCELLED) + REFERENCE * tolerance * factor.recip().max(1.0);
        let differs = |sample: usize| {
            let [one, other] = [own.volts[sample], track.volts[sample] / factor];
            let is_near = (other - one).abs() <= permitted;
            !(is_near || (one.is_nan() && other.is_nan()))
        };
        // A jump can be just before a sample in one run and just after it in the other.
        let lasts = |sample: &usize| differs(*sample) && (sample + 1 >= count || differs(sample + 1));
        let end = first.as_ref().map_or(count, |difference| difference.sample);
        if let Some(sample) = (0..end).find(lasts) {
            first = Some(Difference { sample, quantity: output.to_owned() });
        }
    }
    Ok(first)
}

/// The first sample that only one of two runs has, or that they have at different times. `share` is the permitted
/// difference as a share of the largest time.
fn clock_difference(one: &Trace, other: &Trace, share: f64) -> Option<Difference> {
    let permitted = share * one.time.iter().copied().fold(0.0, f64::max);
    let mut pairs = one.time.iter().zip(&other.time);
    let sample = pairs.position(|(one, other)| (one - other).abs() > permitted);
    if let Some(sample) = sample {
        return Some(Difference { sample, quantity: "the clock".to_owned() });
    }
    let count = one.len().min(other.len());
    let is_longer = one.len().max(other.len()) > count;
    is_longer.then(|| Difference { sample: count, quantity: "the length of the run".to_owned() })
}
