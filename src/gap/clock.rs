//! Drives that go by the clock: a run begins them anew, and records need not begin where they do.

use serde_json::Value;

use crate::circuit::Circuit;
use crate::patch::{Formula, Patch};

/// The parameter that says when a record begins, in seconds from where its file begins: laws that go by the clock need it.
pub const RECORD_START: &str = "record_start";

/// A step that comes within so many seconds stands before the first sample: what is wired in begins with such steps.
const AT_ONCE: f64 = 1e-6;

/// Whether a drive, as patches write it, is told when its record begins.
pub(super) fn is_told_the_start(drive: &Value) -> bool {
    let mut settings = drive.as_object().into_iter().flat_map(|settings| settings.values());
    settings.any(|setting| setting.as_str().is_some_and(|formula| formula.contains(RECORD_START)))
}

/// The drives of a patch that every run begins anew, where no column feeds them; a step at the beginning is a constant.
pub(super) fn begun_anew<'p>(
    patch: &'p Patch,
    is_fed: impl Fn(&str) -> bool + 'p,
) -> impl Iterator<Item = &'p str> {
    let seconds = |at: &Value| match at.as_str() {
        Some(text) => Formula::parse(text).ok()?.evaluate(Circuit::new(patch, &[]).ok()?.quantities()).ok(),
        None => at.as_f64(),
    };
    let moves = move |name: &str, kind: &str| {
        let drive = &patch.value()["drives"][name];
        let is_at_once = |at: &Value| seconds(at).is_some_and(|at| at <= AT_ONCE);
        let is_constant = kind == "step" && drive.get("at").is_none_or(is_at_once);
        !is_constant && !is_told_the_start(drive)
    };
    let drives = patch.drives.iter().map(|(name, drive)| (name.as_str(), drive.kind.name));
    drives.filter(move |(name, kind)| !is_fed(name) && moves(name, kind)).map(|(name, _)| name)
}

/// The drives of a patch that are constant from the beginning.
pub(super) fn constants(patch: &Patch) -> impl Iterator<Item = &str> {
    let drives = patch.drives.iter().filter(|(name, drive)| {
        drive.kind.name == "step" && patch.value()["drives"][name.as_str()].get("at").is_none()
    });
    drives.map(|(name, _)| name.as_str())
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
                "constant": {"kind": "step", "scale": "s", "height": 1},
                "at-once": {"kind": "step", "scale": "s", "height": 1, "at": "1e-9 * T"},
                "later": {"kind": "step", "scale": "s", "height": 1, "at": "T / 20"}
            },
            "elements": {"B1": {"kind": "summer", "in": {"x1": ["fed", "sine", "told", "constant", "at-once", "later"]}}},
            "run": {"for": 1, "step": 0.01}}"#;
        let patch = Patch::parse("drives.json", text).unwrap_or_else(|report| panic!("{report}"));
        assert_eq!(begun_anew(&patch, |name| name == "fed").collect::<Vec<_>>(), ["sine", "later"]);
    }
}
