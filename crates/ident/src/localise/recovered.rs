//! A recovered input as part of a patch: a table over time, or a function generator over a signal of the patch.
//!
//! The input is wired in like an effect of the library, as a graft. Its effect is made here, with one element or drive.

use indexmap::IndexMap;
use serde::Serialize;
use serde_json::{Map, Value};

use crate::effects::attach::{AttachmentSite, EffectPlacement};
use crate::effects::graft::Graft;
use crate::effects::sites::{Junction, ScaledSignal};
use crate::effects::{Attachment, Effect, Form, InputRole, OutputRole};
use crate::localise::input_basis::InputBasis;
use patchcord_core::document::json_value;
use patchcord_core::machines::REFERENCE;
use patchcord_core::patch::{EditError, Patch};

/// The patch with a table drive at a junction, for an input over time, and the name of the drive. `points` are pairs of
/// time in seconds and input in the unit of the junction's sum.
///
/// # Errors
/// If the drive cannot be wired to the junction.
pub(crate) fn with_table(
    patch: &Patch,
    junction: &Junction,
    points: &[[f64; 2]],
) -> Result<(Patch, String), EditError> {
    let law = "F = F(t), a table";
    let note = "recovered force over time";
    let drives = entry("D1", &TableDrive { kind: "table", scale: "sum", points, note });
    let elements = entry("B1", &Inverter { kind: "inverter", input: "D1", note: "- recovered force" });
    let form = form(Vec::new(), (OutputRole::Subtract, "B1"), drives, elements);
    let graft = graft(patch, law, form, junction, None)?;
    let drive = graft.patch.drives.keys().find(|name| !patch.drives.contains_key(*name)).cloned();
    Ok((graft.patch, drive.unwrap_or_default()))
}

/// The patch with a function generator at a junction, for an input over a signal, and the name of the generator.
/// `points` are pairs of input and output voltage; voltages beyond full scale are clamped.
///
/// # Errors
/// If the function generator cannot be wired to the junction.
pub(crate) fn with_function(
    patch: &Patch,
    junction: &Junction,
    signal: &ScaledSignal,
    points: &[[f64; 2]],
) -> Result<(Patch, String), EditError> {
    let law = format!("F = F({}), a curve", signal.signal);
    let points: Vec<[f64; 2]> =
        points.iter().map(|point| point.map(|volts| volts.clamp(-REFERENCE, REFERENCE))).collect();
    let note = format!("recovered force over {}", signal.signal);
    let generator =
        FunctionGenerator { kind: "function-generator", input: "position", points: &points, note: &note };
    let (reads, gives) = (vec![InputRole::Position], (OutputRole::Add, "G1"));
    let form = form(reads, gives, Map::new(), entry("G1", &generator));
    let graft = graft(patch, &law, form, junction, Some(signal))?;
    let instance = graft.patch.instances.keys().find(|name| !patch.instances.contains_key(*name));
    let name = format!("{}.G1", instance.cloned().unwrap_or_default());
    Ok((graft.patch, name))
}

/// The basis of a curve as points of a function generator, in volts. The coefficients are the input at `knots`, in
/// units. Beyond the outermost knots the curve is constant up to full scale. The points are the same for all records.
pub(crate) fn function_basis(
    knots: &[f64],
    junction: &Junction,
    signal: &ScaledSignal,
    record_count: usize,
) -> InputBasis {
    let volts_per_unit = 1.0 / junction.sum.per_volt;
    let point = |(index, knot): (usize, &f64)| {
        ((knot / signal.per_volt).clamp(-REFERENCE, REFERENCE), vec![(index, volts_per_unit)])
    };
    let mut points: Vec<_> = knots.iter().enumerate().map(point).collect();
    let last = knots.len() - 1;
    if points[0].0 > -REFERENCE {
        points.insert(0, (-REFERENCE, vec![(0, volts_per_unit)]));
    }
    if points[points.len() - 1].0 < REFERENCE {
        points.push((REFERENCE, vec![(last, volts_per_unit)]));
    }
    InputBasis { groups: vec![knots.len()], records: vec![points; record_count] }
}

/// A table drive in the document of a fragment.
#[derive(Serialize)]
struct TableDrive<'a> {
    kind: &'static str,
    scale: &'static str,
    points: &'a [[f64; 2]],
    note: &'static str,
}

/// An inverter in the document of a fragment.
#[derive(Serialize)]
struct Inverter {
    kind: &'static str,
    #[serde(rename = "in")]
    input: &'static str,
    note: &'static str,
}

/// A function generator in the document of a fragment.
#[derive(Serialize)]
struct FunctionGenerator<'a> {
    kind: &'static str,
    #[serde(rename = "in")]
    input: &'static str,
    points: &'a [[f64; 2]],
    note: &'a str,
}

/// A JSON object with one entry.
fn entry(name: &str, value: &impl Serialize) -> Map<String, Value> {
    Map::from_iter([(name.to_owned(), json_value(value))])
}

/// A form without parameters that adds to the sum of an integrator.
fn form(
    reads: Vec<InputRole>,
    gives: (OutputRole, &str),
    drives: Map<String, Value>,
    elements: Map<String, Value>,
) -> Form {
    Form {
        note: String::new(),
        attachment: Attachment::Sum,
        signal: None,
        reads,
        gives: vec![(gives.0, gives.1.to_owned())],
        gains: IndexMap::new(),
        drives,
        elements,
        output_gain: 1.0,
        free_states: Vec::new(),
        parameters: Vec::new(),
    }
}

/// Wires a form to a junction. The form may read any signal in the role of a position, whatever its dimension.
fn graft(
    patch: &Patch,
    law: &str,
    form: Form,
    junction: &Junction,
    position: Option<&ScaledSignal>,
) -> Result<Graft, EditError> {
    let effect = Effect {
        name: "recovered-force".to_owned(),
        title: "Recovered force".to_owned(),
        law: law.to_owned(),
        physics: "The input that explains the residuals; its cause is unknown.".to_owned(),
        source: "patchcord gap".to_owned(),
        excitation: String::new(),
        aliases: IndexMap::new(),
        parameters: IndexMap::new(),
        forms: vec![form],
    };
    let site = AttachmentSite::Junction { junction, position, load: None, next: None };
    EffectPlacement { effect: &effect, form: &effect.forms[0], site }.graft(patch, &[])
}
