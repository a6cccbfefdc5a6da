//! Drives that go by the clock: a run begins them anew, and records need not begin where they do.

use std::cell::OnceCell;

use serde_json::Value;

use patchcord_core::circuit::Circuit;
use patchcord_core::document::Placed;
use patchcord_core::patch::{Amount, Entry, Patch};
use patchcord_expr::Formula;

/// The parameter that says when a record begins, in seconds from where its file begins: laws that go by the clock need it.
pub const RECORD_START: &str = "record_start";

/// A step that comes within so many seconds stands before the first sample: what is wired in begins with such steps.
const AT_ONCE: f64 = 1e-6;

/// Whether a drive, as patches write it, is told when its record begins.
pub(crate) fn is_told_the_start(drive: &Value) -> bool {
    has_name(drive, RECORD_START)
}

/// The formula of a setting of a drive; `None` if the patch does not have the setting, or the setting is no formula.
fn formula_of(setting: &Option<Placed<Amount>>) -> Option<&Formula> {
    match &setting.as_ref()?.value {
        Amount::Formula(formula) => Some(formula),
        _ => None,
    }
}

/// How a drive goes by the clock.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Going {
    /// It stands from the beginning.
    Constant,
    /// It moves, and every run begins it anew.
    Anew,
    /// It moves as the start of the record tells it to.
    Told,
}

/// The drives of a patch, and how each goes; a step at the beginning is a constant.
pub(crate) fn goings(patch: &Patch) -> impl Iterator<Item = (&str, Going)> {
    // Made for the first formula.
    let circuit = OnceCell::new();
    patch.drives.iter().map(move |(name, own)| {
        let mut formulas = own.settings.iter().filter_map(formula_of);
        let is_told = formulas.any(|formula| formula.names().contains(&RECORD_START));
        let going = match own.kind.name {
            _ if is_told => Going::Told,
            "step" if is_at_once(patch, own, &circuit) => Going::Constant,
            _ => Going::Anew,
        };
        (name.as_str(), going)
    })
}

/// Whether a step is at the beginning.
fn is_at_once(patch: &Patch, step: &Entry, circuit: &OnceCell<Option<Circuit>>) -> bool {
    let at = step.kind.setting("at").and_then(|index| formula_of(&step.settings[index]));
    let Some(at) = at else { return true };
    let circuit = circuit.get_or_init(|| Circuit::new(patch, &[]).ok());
    let seconds = circuit.as_ref().and_then(|circuit| at.evaluate(circuit.quantities()).ok());
    seconds.is_some_and(|at| at <= AT_ONCE)
}

/// The drives of a patch that every run begins anew, where no column feeds them.
pub(crate) fn begun_anew<'p>(
    patch: &'p Patch,
    is_fed: impl Fn(&str) -> bool + 'p,
) -> impl Iterator<Item = &'p str> {
    let own = goings(patch).filter(move |(name, going)| *going == Going::Anew && !is_fed(name));
    own.map(|(name, _)| name)
}

/// Whether anything but the note of an entry has a name among its words.
pub(crate) fn has_name(entry: &Value, name: &str) -> bool {
    let is_apart = |letter: char| !letter.is_alphanumeric() && letter != '_';
    match entry {
        Value::String(text) => text.split(is_apart).any(|word| word == name),
        Value::Array(all) => all.iter().any(|own| has_name(own, name)),
        Value::Object(all) => all.iter().any(|(key, own)| key != "note" && has_name(own, name)),
        _ => false,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn drives_begin_anew_that_move_and_are_not_told_when() {
        let text = r#"{"patchcord": 1,
            "parameters": {"record_start": {"value": 0, "unit": "s"}, "T": {"value": 40, "unit": "s"}, "f": {"value": 2, "unit": "Hz"}},
            "scales": {"s": {"per_volt": 1, "unit": "V"}},
            "drives": {
                "fed": {"kind": "sine", "scale": "s", "amplitude": 1, "frequency": "f"},
                "sine": {"kind": "sine", "scale": "s", "amplitude": 1, "frequency": "f"},
                "told": {"kind": "sine", "scale": "s", "amplitude": 1, "frequency": "f", "phase": "2 * pi * f * record_start"},
                "noted": {"kind": "sine", "scale": "s", "amplitude": 1, "frequency": "f", "note": "does not go by record_start"},
                "constant": {"kind": "step", "scale": "s", "height": 1},
                "at-once": {"kind": "step", "scale": "s", "height": 1, "at": "1e-9 * T"},
                "later": {"kind": "step", "scale": "s", "height": 1, "at": "T / 20"}
            },
            "elements": {"B1": {"kind": "summer", "in": {"x1": ["fed", "sine", "told", "noted", "constant", "at-once", "later"]}}},
            "run": {"for": 1, "step": 0.01}}"#;
        let patch = Patch::parse("drives.json", text).unwrap_or_else(|report| panic!("{report}"));
        let anew: Vec<_> = begun_anew(&patch, |name| name == "fed").collect();
        assert_eq!(anew, ["sine", "noted", "later"]);
        let of = |wanted| goings(&patch).filter(move |(_, own)| *own == wanted).map(|(name, _)| name);
        assert_eq!(of(Going::Constant).collect::<Vec<_>>(), ["constant", "at-once"]);
        assert_eq!(of(Going::Told).collect::<Vec<_>>(), ["told"]);
    }
}
