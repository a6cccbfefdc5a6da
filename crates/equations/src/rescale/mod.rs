//! Rescales a patch: other scales, or another time scale, with the same names and the same solution.
//!
//! 1. `measured` runs the patch and reads the peak of every output.
//! 2. `model` has the relations between the factors of the outputs, from the laws of the elements (`laws`, `relations`)
//!    and the cords (`wiring`). `choice` looks for round factors with which the `goals` and those of `digits` are
//!    reached. `time` decides what another time scale changes. Both give a `decision`, with gains from `gains`.
//! 3. `edits` changes the document: `scales`, settings (`formulas`, with the `values` of all names), `cords`, and the
//!    gain rule in numbers (`rules`).
//! 4. `verification` compares the new patch with the old one, and refuses it if they differ; see also `exact`. If the old
//!    patch overloads, its peaks are not known, so what overloads becomes smaller until a run has no overload.
//! 5. `report` makes the tables.

mod choice;
mod cords;
mod decision;
mod digits;
mod edits;
mod error;
mod exact;
mod formulas;
mod gains;
mod goals;
mod laws;
mod measured;
mod model;
mod relations;
mod report;
mod rules;
mod scales;
mod time;
mod values;
mod verification;
mod wiring;

use std::cmp::Reverse;

use patchcord_core::circuit::Circuit;
use patchcord_core::elements::OutputStage;
use patchcord_core::patch::Patch;

use choice::{Choice, choose};
use decision::{Decided, Decision};
pub use edits::ChangedSetting;
use edits::{Edited, edited};
pub use error::RescaleError;
use measured::Measured;
use model::{Approach, Evidence, Gains, Model};
pub use report::{RescaledOutput, RescaledScale};
use report::{new_peak, output_rows, scale_rows};
use time::time_decision;
use values::Values;
use verification::{Verified, verify};
use wiring::Wiring;

/// Runs of changed patches at most.
const MAX_RUNS: usize = 16;
/// The factor by which the peak of an amplifier that overloads is taken to be larger.
const BEHIND_OVERLOAD: f64 = 2.0;
/// Two peaks are equal if they differ by at most this share.
const ROUNDING: f64 = 1e-6;

/// What a rescaling changes.
///
/// # Examples
///
/// ```
/// use patchcord_equations::RescaleOptions;
///
/// let options = RescaleOptions { time: Some(10.0) };
/// assert_eq!(RescaleOptions::default().time, None);
/// # let _ = options;
/// ```
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct RescaleOptions {
    /// New machine seconds per present machine second. Only the time scale then changes. `None` if the scales of the
    /// amplitudes change.
    pub time: Option<f64>,
}

/// A rescaled patch, with the tables that explain it.
#[derive(Debug, Clone)]
#[non_exhaustive]
pub struct RescaledPatch {
    /// The patch.
    pub patch: Patch,
    /// The scales of signals and drives before and after, in the order of the patch.
    pub scales: Vec<RescaledScale>,
    /// The peaks of all amplifiers and drives before and after.
    pub outputs: Vec<RescaledOutput>,
    /// What changed in the document. Empty if the patch needs no other scales.
    pub changes: Vec<ChangedSetting>,
    /// Machine seconds per problem second after the change.
    pub time_scale: f64,
    /// The number of runs of changed patches.
    pub runs: usize,
    /// The number of random states at which all voltages and derivatives of both patches were compared. It is 0 if a loop
    /// without an integrator has no single solution at any of them. Then the runs agree to their end.
    pub compared_states: usize,
    /// The problem time up to which all voltages of both runs agree within 1e-9 of their peaks. It is below the length of
    /// the run if the motion amplifies rounding. `None` if the patch overloads, so that its run is wrong.
    pub agrees_until: Option<f64>,
}

/// Changes the scales of a patch so that its amplifiers peak from 50 to 95 V, or its time scale.
///
/// Names, order, notes and layout of the document stay. The scales, the settings, the initial values and the gains change
/// so that the patch computes the same, for all values of the parameters. The result is compared with the patch before it
/// is returned.
///
/// # Errors
/// If the patch has a fault or cannot be run, if the machine has no gain that is necessary, if a setting cannot change,
/// or if the result does not compute the same.
///
/// # Examples
///
/// ```
/// use patchcord_core::patch::Patch;
/// use patchcord_equations::{RescaleOptions, rescale_patch};
///
/// // A decay from 2 V.
/// let text = r#"{"patchcord": 1, "scales": {"length": {"per_volt": 1, "unit": "mm"}},
///   "elements": {"A1": {"kind": "integrator", "in": {"x1": ["A1"]}, "initial": "2 * length0 / length"}},
///   "parameters": {"length0": {"value": 1, "unit": "mm"}},
///   "signals": {"x": {"at": "A1", "scale": "length"}}, "run": {"for": 2, "step": 0.01}}"#;
/// let rescaled = rescale_patch(&Patch::parse("decay.json", text)?, &RescaleOptions::default())?;
/// let [output] = &rescaled.outputs[..] else { panic!("there is one amplifier") };
/// assert!(output.is_good() && rescaled.patch.text().contains(r#""initial": "2 * length0 / length""#));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn rescale_patch(patch: &Patch, options: &RescaleOptions) -> Result<RescaledPatch, RescaleError> {
    let original = Measured::new(patch, RescaleError::Patch)?;
    match options.time {
        Some(time) if time > 0.0 && time.is_finite() => with_time_scale(&original, time),
        Some(time) => {
            Err(RescaleError::Impossible(format!("the factor of the time must be positive, got {time}")))
        }
        None => with_amplitudes(&original),
    }
}

/// The patch with another time scale.
///
/// # Errors
/// Those of [`rescale_patch`].
fn with_time_scale(original: &Measured, time: f64) -> Result<RescaledPatch, RescaleError> {
    let wiring = Wiring::new(&original.circuit);
    let old = Values::of(&original.circuit);
    let decision = time_decision(&wiring, &old, time).map_err(RescaleError::Impossible)?;
    let edited = edited(&wiring, &old, &decision).map_err(RescaleError::Impossible)?;
    let decided = Decided { wiring: &wiring, old: &old, decision: &decision };
    let measured = Measured::new(&edited.patch, RescaleError::Faults)?;
    finished(original, &decided, edited, &measured, None, 1)
}

/// A patch with other scales that has no overload.
struct Rescaling {
    /// What changes from the original patch.
    decision: Decision,
    edited: Edited,
    measured: Measured,
    /// The number of runs of changed patches.
    runs: usize,
}

/// The patch with other scales of amplitudes. It is rescaled again until nothing changes.
///
/// # Errors
/// Those of [`rescale_patch`].
fn with_amplitudes(original: &Measured) -> Result<RescaledPatch, RescaleError> {
    let wiring = Wiring::new(&original.circuit);
    let old = Values::of(&original.circuit);
    if !has_voltage(&wiring, &original.peaks) {
        let message = "there is nothing to scale: all amplifiers have 0 V in the whole run. Give an integrator an \
                       initial value, or add a drive";
        return Err(RescaleError::Impossible(message.to_owned()));
    }
    let mut rescaling = without_overload(original, &wiring, &old)?;
    while let Some(next) = rescaled_again(&wiring, &old, &rescaling) {
        rescaling = next;
    }
    let Rescaling { decision, edited, measured, runs } = rescaling;
    let (new_wiring, new) = (Wiring::new(&measured.circuit), Values::of(&measured.circuit));
    let settled = best(Evidence { wiring: &new_wiring, old: &new, peaks: &measured.peaks }).ok();
    let model = settled.as_ref().map(|(model, ..)| model);
    let decided = Decided { wiring: &wiring, old: &old, decision: &decision };
    finished(original, &decided, edited, &measured, model, runs)
}

/// The first scales with which a run has no overload.
///
/// # Errors
/// Those of [`rescale_patch`].
fn without_overload(
    original: &Measured,
    wiring: &Wiring<'_>,
    old: &Values<'_>,
) -> Result<Rescaling, RescaleError> {
    let mut peaks = behind_overloads(wiring, original, &original.peaks);
    let mut is_exact = original.overloads.is_empty();
    let mut overloads = Vec::new();
    for runs in 1..=MAX_RUNS {
        let (_, decision, edited) = best(Evidence { wiring, old, peaks: &peaks })?;
        let decided = Decided { wiring, old, decision: &decision };
        let measured = Measured::new(&edited.patch, RescaleError::Faults)?;
        let found = |element: usize| {
            let factor = decided.factor(element, 0).unwrap_or(1.0);
            new_peak(wiring, &measured, element) / factor
        };
        let found: Vec<f64> = (0..wiring.len()).map(found).collect();
        if measured.overloads.is_empty() {
            let are_equal = |(one, other): (&f64, &f64)| (one - other).abs() <= ROUNDING * one.max(*other);
            if is_exact || found.iter().zip(&peaks).all(are_equal) {
                return Ok(Rescaling { decision, edited, measured, runs });
            }
            (peaks, is_exact) = (found, true);
        } else {
            overloads = measured.overloads.iter().cloned().collect();
            is_exact = false;
            let larger: Vec<f64> = peaks.iter().zip(&found).map(|(known, found)| known.max(*found)).collect();
            peaks = behind_overloads(wiring, &measured, &larger);
        }
    }
    let message = format!(
        "{} would overload in all scales that were tried: shorten the run, or put a pot in front of it",
        overloads.join(" and ")
    );
    Err(RescaleError::Impossible(message))
}

/// A rescaled patch with the further changes that a rescaling of it would make. `None` if there are none.
fn rescaled_again(wiring: &Wiring<'_>, old: &Values<'_>, before: &Rescaling) -> Option<Rescaling> {
    if before.runs >= MAX_RUNS {
        return None;
    }
    let between = (Wiring::new(&before.measured.circuit), Values::of(&before.measured.circuit));
    let evidence = Evidence { wiring: &between.0, old: &between.1, peaks: &before.measured.peaks };
    let (_, next, next_edited) = best(evidence).ok()?;
    if next_edited.changes.is_empty() {
        return None;
    }
    let decision = before.decision.followed_by(&next, [wiring, &between.0])?;
    let edited = edited(wiring, old, &decision).ok()?;
    let measured = Measured::new(&edited.patch, RescaleError::Faults).ok()?;
    let is_valid = measured.overloads.is_empty();
    is_valid.then(|| Rescaling { decision, edited, measured, runs: before.runs + 1 })
}

/// The peaks, with larger ones for the amplifiers that overload in a run. Without its limit, an integrator would be beyond
/// it by an unknown voltage.
fn behind_overloads(wiring: &Wiring<'_>, measured: &Measured, peaks: &[f64]) -> Vec<f64> {
    let factor =
        |element| if measured.overloads.contains(wiring.name(element)) { BEHIND_OVERLOAD } else { 1.0 };
    peaks.iter().enumerate().map(|(element, peak)| peak * factor(element)).collect()
}

/// Whether an amplifier or a drive is not always 0 V.
fn has_voltage(wiring: &Wiring<'_>, peaks: &[f64]) -> bool {
    let is_amplifier = |element: &usize| wiring.kind(*element).output != OutputStage::Passive;
    (0..wiring.len()).filter(is_amplifier).any(|element| peaks[element] > 0.0)
}

/// The decision with which the most outputs peak from 50 to 95 V, with its edits. It uses as few freedoms as possible.
///
/// # Errors
/// If no decision can be edited.
fn best<'e>(evidence: Evidence<'e>) -> Result<(Model<'e>, Decision, Edited), RescaleError> {
    let mut found: Vec<(Model<'e>, Choice)> = Vec::new();
    let mut failure = None;
    let approaches = [Gains::Decades, Gains::Free, Gains::Kept]
        .into_iter()
        .flat_map(|gains| [true, false].map(|adapts| Approach { adapts, gains }));
    for approach in approaches {
        let model = Model::new(evidence, approach);
        match choose(&model) {
            Ok(choice) => found.push((model, choice)),
            Err(message) => failure = failure.or(Some(RescaleError::Impossible(message))),
        }
    }
    found.sort_by_key(|(_, choice)| (choice.outside, Reverse(choice.good)));
    let mut fault = None;
    for (model, Choice { decision, .. }) in found {
        let edited = edited(evidence.wiring, evidence.old, &decision).map_err(RescaleError::Impossible);
        match edited.and_then(without_faults) {
            Ok(edited) => return Ok((model, decision, edited)),
            Err(error) => fault = fault.or(Some(error)),
        }
    }
    // The reason against the best decision says more than that against another approach.
    Err(fault.or(failure).unwrap_or_else(|| RescaleError::Impossible("no scales were found".to_owned())))
}

/// A changed patch if it has no faults.
///
/// # Errors
/// If it has.
fn without_faults(edited: Edited) -> Result<Edited, RescaleError> {
    Circuit::new(&edited.patch).map_err(RescaleError::Faults)?;
    Ok(edited)
}

/// The verified result.
///
/// # Errors
/// If the new patch does not compute the same.
fn finished(
    original: &Measured,
    decided: &Decided<'_>,
    edited: Edited,
    measured: &Measured,
    model: Option<&Model<'_>>,
    runs: usize,
) -> Result<RescaledPatch, RescaleError> {
    let exact = |patch: &Patch| Measured::new(patch, RescaleError::Faults);
    let [old, new] = edited.exact.each_ref().map(|patch| patch.as_ref().map(exact).transpose());
    let (exact_old, exact_new) = (old?, new?);
    let pair = [exact_old.as_ref().unwrap_or(original), exact_new.as_ref().unwrap_or(measured)];
    let verified = verify(pair[0], pair[1], decided).map_err(RescaleError::Differs)?;
    let Verified { states, agrees_until } = verified;
    Ok(RescaledPatch {
        scales: scale_rows(decided.wiring, measured),
        outputs: output_rows(decided, original, measured, model),
        changes: edited.changes,
        time_scale: measured.circuit.time_scale(),
        patch: edited.patch,
        runs,
        compared_states: states,
        agrees_until,
    })
}
