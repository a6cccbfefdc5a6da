//! Drives that go by the clock: a run begins them anew, and records need not begin where they do.

use serde_json::Value;

use crate::patch::Patch;

/// The parameter that says when a record begins, in seconds from where its file begins: laws that go by the clock need it.
pub const RECORD_START: &str = "record_start";

/// Whether a drive, as patches write it, is told when its record begins.
pub(super) fn is_told_the_start(drive: &Value) -> bool {
    let mut settings = drive.as_object().into_iter().flat_map(|settings| settings.values());
    settings.any(|setting| setting.as_str().is_some_and(|formula| formula.contains(RECORD_START)))
}

/// The drives of a patch that every run begins anew, where no column feeds them; a step at the very beginning is a constant.
pub(super) fn begun_anew<'p>(
    patch: &'p Patch,
    is_fed: impl Fn(&str) -> bool + 'p,
) -> impl Iterator<Item = &'p str> {
    let moves = |name: &str, kind: &str| {
        let drive = &patch.value()["drives"][name];
        let is_constant = kind == "step" && drive.get("at").is_none_or(|at| at.as_f64() == Some(0.0));
        !is_constant && !is_told_the_start(drive)
    };
    let drives = patch.drives.iter().map(|(name, drive)| (name.as_str(), drive.kind.name));
    drives.filter(move |(name, kind)| !is_fed(name) && moves(name, kind)).map(|(name, _)| name)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn drives_begin_anew_that_move_and_are_not_told_when() {
        let text = r#"{"patchcord": 1,
            "parameters": {"record_start": {"value": 0, "unit": "s"}},
            "drives": {
                "fed": {"kind": "sine", "amplitude": 1, "frequency": 2},
                "sine": {"kind": "sine", "amplitude": 1, "frequency": 2},
                "told": {"kind": "sine", "amplitude": 1, "frequency": 2, "phase": "4 * pi * record_start"},
                "constant": {"kind": "step", "height": 1},
                "later": {"kind": "step", "height": 1, "at": 2}
            },
            "elements": {"B1": {"kind": "summer", "in": {"x1": ["fed", "sine", "told", "constant", "later"]}}},
            "run": {"for": 1, "step": 0.01}}"#;
        let patch = Patch::parse("drives.json", text).unwrap_or_else(|report| panic!("{report}"));
        assert_eq!(begun_anew(&patch, |name| name == "fed").collect::<Vec<_>>(), ["sine", "later"]);
    }
}
