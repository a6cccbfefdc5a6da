//! How the drives of a patch depend on time, and which of them restart with every record.
//!
//! A run begins at time 0, but a record may begin later in its file. A drive that moves as the patch defines it would
//! then be wrong, because every run restarts it. A column can feed such a drive instead. Otherwise its formulas can
//! contain the parameter [`RECORD_START`], which every run sets to the start of its record.

use std::cell::OnceCell;

use serde_json::Value;

use patchcord_core::circuit::Circuit;
use patchcord_core::document::Placed;
use patchcord_core::patch::{Amount, ElementEntry, Patch};
use patchcord_expr::Formula;

/// The parameter that every run sets to the start of its record, in seconds from the first sample of the file. Drives
/// with formulas of this parameter are in phase with the record.
pub(crate) const RECORD_START: &str = "record_start";

/// A step at most this many seconds after the start counts as a constant drive. Grafted effects contain such steps.
const STEP_AT_START: f64 = 1e-6;

/// Whether a drive, as JSON of a patch, contains the start of its record in a formula.
pub(crate) fn uses_record_start(drive: &Value) -> bool {
    mentions_name(drive, RECORD_START)
}

/// Returns the formula of a setting of a drive. None if the patch does not specify the setting, or if it is not a
/// formula.
fn formula_of(setting: &Option<Placed<Amount>>) -> Option<&Formula> {
    match &setting.as_ref()?.value {
        Amount::Formula(formula) => Some(formula),
        _ => None,
    }
}

/// How a drive depends on time.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum DriveTiming {
    /// It is constant from the start of the run.
    Constant,
    /// It moves, and every run restarts it.
    Restarts,
    /// It moves, and its formulas contain the start of the record.
    FollowsRecord,
}

/// Returns the name and the timing of every drive of a patch, in the order of the patch. Whether a column feeds the
/// drive is not considered.
pub(crate) fn drive_timings(patch: &Patch) -> impl Iterator<Item = (&str, DriveTiming)> {
    // The circuit is only needed to evaluate formulas, so it is built for the first one.
    let circuit = OnceCell::new();
    patch.drives.iter().map(move |(name, drive)| {
        let mut formulas = drive.settings.iter().filter_map(formula_of);
        let follows_record = formulas.any(|formula| formula.names().contains(&RECORD_START));
        let timing = match drive.kind.name {
            _ if follows_record => DriveTiming::FollowsRecord,
            "step" if is_at_start(patch, drive, &circuit) => DriveTiming::Constant,
            _ => DriveTiming::Restarts,
        };
        (name.as_str(), timing)
    })
}

/// Whether a step occurs at the start of the run. False if its time cannot be evaluated.
fn is_at_start(patch: &Patch, step: &ElementEntry, circuit: &OnceCell<Option<Circuit>>) -> bool {
    let step_time = step.kind.setting("at").and_then(|index| formula_of(&step.settings[index]));
    let Some(step_time) = step_time else { return true };
    let circuit = circuit.get_or_init(|| Circuit::new(patch).ok());
    let seconds = circuit.as_ref().and_then(|circuit| step_time.evaluate(circuit.quantities()).ok());
    seconds.is_some_and(|seconds| seconds <= STEP_AT_START)
}

/// Returns the drives of a patch that every run restarts and that no column feeds.
pub(crate) fn restarting_drives<'p>(
    patch: &'p Patch,
    is_fed: impl Fn(&str) -> bool + 'p,
) -> impl Iterator<Item = &'p str> {
    let restarting =
        drive_timings(patch).filter(move |(name, timing)| *timing == DriveTiming::Restarts && !is_fed(name));
    restarting.map(|(name, _)| name)
}

/// Whether a text in the JSON of an entry contains a name as a whole word. Notes and keys are ignored.
pub(crate) fn mentions_name(entry: &Value, name: &str) -> bool {
    let is_separator = |letter: char| !letter.is_alphanumeric() && letter != '_';
    match entry {
        Value::String(text) => text.split(is_separator).any(|word| word == name),
        Value::Array(items) => items.iter().any(|item| mentions_name(item, name)),
        Value::Object(items) => items.iter().any(|(key, item)| key != "note" && mentions_name(item, name)),
        _ => false,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn drives_that_move_restart_unless_their_formulas_contain_the_start_of_the_record() {
        let text = r#"{"patchcord": 1,
            "parameters": {"record_start": {"value": 0, "unit": "s"}, "T": {"value": 40, "unit": "s"}, "f": {"value": 2, "unit": "Hz"}},
            "scales": {"s": {"per_volt": 1, "unit": "V"}},
            "drives": {
                "fed": {"kind": "sine", "scale": "s", "amplitude": 1, "frequency": "f"},
                "sine": {"kind": "sine", "scale": "s", "amplitude": 1, "frequency": "f"},
                "in-phase": {"kind": "sine", "scale": "s", "amplitude": 1, "frequency": "f", "phase": "2 * pi * f * record_start"},
                "noted": {"kind": "sine", "scale": "s", "amplitude": 1, "frequency": "f", "note": "does not contain record_start"},
                "constant": {"kind": "step", "scale": "s", "height": 1},
                "at-once": {"kind": "step", "scale": "s", "height": 1, "at": "1e-9 * T"},
                "later": {"kind": "step", "scale": "s", "height": 1, "at": "T / 20"}
            },
            "elements": {"B1": {"kind": "summer", "in": {"x1": ["fed", "sine", "in-phase", "noted", "constant", "at-once", "later"]}}},
            "run": {"for": 1, "step": 0.01}}"#;
        let patch = Patch::parse("drives.json", text).unwrap_or_else(|report| panic!("{report}"));
        let restarting: Vec<_> = restarting_drives(&patch, |name| name == "fed").collect();
        assert_eq!(restarting, ["sine", "noted", "later"]);
        let drives_with =
            |wanted| drive_timings(&patch).filter(move |(_, timing)| *timing == wanted).map(|(name, _)| name);
        assert_eq!(drives_with(DriveTiming::Constant).collect::<Vec<_>>(), ["constant", "at-once"]);
        assert_eq!(drives_with(DriveTiming::FollowsRecord).collect::<Vec<_>>(), ["in-phase"]);
    }
}
