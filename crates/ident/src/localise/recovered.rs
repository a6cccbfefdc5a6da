//! A recovered force as a part of the patch: a table over time, or a function generator over what the patch itself does.

use indexmap::IndexMap;
use serde_json::{Map, Value, json};

use crate::effects::attach::{Attached, Place};
use crate::effects::graft::Graft;
use crate::effects::sites::{Junction, Reading};
use crate::effects::{Attachment, Effect, Form, Gives, Reads};
use crate::localise::unknown_input::Shape;
use patchcord_core::patch::{EditError, Patch};

/// Full scale, in volts: beyond the outermost knots a function generator is level up to here.
const FULL: f64 = 100.0;

/// A patch with a table drive at a junction, for a force over time, and the name of the drive.
pub fn with_table(
    patch: &Patch,
    junction: &Junction,
    points: &[[f64; 2]],
) -> Result<(Patch, String), EditError> {
    let law = "F = F(t), a table";
    let drives = json!({"D1": {"kind": "table", "scale": "sum", "points": points, "note": "recovered force over time"}});
    let elements = json!({"B1": {"kind": "inverter", "in": "D1", "note": "- recovered force"}});
    let form = form(Vec::new(), (Gives::Subtract, "B1"), drives, elements);
    let graft = wired(patch, law, form, junction, None)?;
    let drive = graft.patch.drives.keys().find(|name| !patch.drives.contains_key(*name)).cloned();
    Ok((graft.patch, drive.unwrap_or_default()))
}

/// A patch with a function generator at a junction, for a force over a quantity, and its name; `points` are in volts.
pub fn with_function(
    patch: &Patch,
    junction: &Junction,
    reading: &Reading,
    points: &[[f64; 2]],
) -> Result<(Patch, String), EditError> {
    let law = format!("F = F({}), a curve", reading.signal);
    let points: Vec<[f64; 2]> =
        points.iter().map(|point| point.map(|volts| volts.clamp(-FULL, FULL))).collect();
    let note = format!("recovered force over {}", reading.signal);
    let elements =
        json!({"G1": {"kind": "function-generator", "in": "position", "points": points, "note": note}});
    let form = form(vec![Reads::Position], (Gives::Add, "G1"), json!({}), elements);
    let graft = wired(patch, &law, form, junction, Some(reading))?;
    let instance = graft.patch.instances.keys().find(|name| !patch.instances.contains_key(*name));
    let name = format!("{}.G1", instance.cloned().unwrap_or_default());
    Ok((graft.patch, name))
}

/// The points of a function generator by the numbers of a curve over these knots: level beyond the outermost ones, up to full scale.
pub fn setting(knots: &[f64], junction: &Junction, reading: &Reading, records: usize) -> Shape {
    let volt = 1.0 / junction.sum.per_volt;
    let place =
        |(place, knot): (usize, &f64)| ((knot / reading.per_volt).clamp(-FULL, FULL), vec![(place, volt)]);
    let mut points: Vec<_> = knots.iter().enumerate().map(place).collect();
    let last = knots.len() - 1;
    if points[0].0 > -FULL {
        points.insert(0, (-FULL, vec![(0, volt)]));
    }
    if points[points.len() - 1].0 < FULL {
        points.push((FULL, vec![(last, volt)]));
    }
    Shape { groups: vec![knots.len()], records: vec![points; records] }
}

fn form(reads: Vec<Reads>, gives: (Gives, &str), drives: Value, elements: Value) -> Form {
    Form {
        note: String::new(),
        at: Attachment::Sum,
        signal: None,
        reads,
        gives: vec![(gives.0, gives.1.to_owned())],
        gains: IndexMap::new(),
        drives: object(drives),
        elements: object(elements),
        times: 1.0,
        free: Vec::new(),
        parameters: Vec::new(),
    }
}

fn object(value: Value) -> Map<String, Value> {
    match value {
        Value::Object(entries) => entries,
        _ => Map::new(),
    }
}

fn wired(
    patch: &Patch,
    law: &str,
    form: Form,
    junction: &Junction,
    position: Option<&Reading>,
) -> Result<Graft, EditError> {
    let effect = Effect {
        name: "recovered-force".to_owned(),
        title: "Recovered force".to_owned(),
        law: law.to_owned(),
        physics: "What the data ask for beside what the patch has; what it comes from is not known."
            .to_owned(),
        source: "patchcord gap".to_owned(),
        excitation: String::new(),
        aliases: IndexMap::new(),
        parameters: IndexMap::new(),
        forms: vec![form],
    };
    let place = Place::Junction { junction, position, load: None, next: None };
    Attached { effect: &effect, form: &effect.forms[0], place }.graft(patch, &[])
}
