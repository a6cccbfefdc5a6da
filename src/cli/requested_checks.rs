//! The checks that options of `patchcord check` request: the audit of amplitude scaling and the static check.

use serde::Serialize;

use super::failure::Failure;
use super::scaling_report::{ScalingDocument, scaling_text};
use super::static_check::{StaticDocument, StaticReport};
use patchcord::circuit::Circuit;
use patchcord::document::plural;
use patchcord::equations::AuditedGain;

/// The results of the checks that options request.
pub(super) struct RequestedChecks {
    /// The audit of amplitude scaling; empty if no option requests it.
    pub gains: Vec<AuditedGain>,
    /// The static check; `None` if no option requests it.
    pub test: Option<StaticReport>,
}

/// The results as keys of a document.
#[derive(Serialize)]
pub(super) struct RequestedDocument<'a> {
    scaling: Vec<ScalingDocument<'a>>,
    static_check: Option<StaticDocument<'a>>,
}

impl RequestedChecks {
    /// The tables, each after an empty line. `with_scaling` is whether that of the scaling is printed.
    pub(super) fn text(&self, with_scaling: bool, circuit: &Circuit) -> String {
        let scaling = with_scaling.then(|| scaling_text(circuit, &self.gains));
        let test = self.test.as_ref().map(StaticReport::text);
        [scaling, test].into_iter().flatten().map(|table| format!("\n{table}")).collect()
    }

    /// The results as keys of a document.
    pub(super) fn document<'a>(&'a self, circuit: &'a Circuit) -> RequestedDocument<'a> {
        RequestedDocument {
            scaling: ScalingDocument::all(circuit, &self.gains),
            static_check: self.test.as_ref().map(StaticReport::document),
        }
    }

    /// The failure if the static check has a difference.
    pub(super) fn failure(&self) -> Option<Failure> {
        self.test.as_ref().and_then(StaticReport::failure)
    }

    /// The verdict on a patch without errors, which has this number of warnings.
    pub(super) fn verdict(&self, warnings: usize) -> String {
        let wrong_gains = self.gains.iter().filter(|gain| gain.is_wrong()).count();
        let differences = self.test.as_ref().map_or(0, StaticReport::difference_count);
        let counts = [(warnings, "warning"), (wrong_gains, "wrong gain"), (differences, "difference")];
        let found = counts.into_iter().filter(|(count, _)| *count > 0);
        let found: Vec<String> = found.map(|(count, noun)| plural(count as u64, noun)).collect();
        if found.is_empty() { "nothing wrong".to_owned() } else { format!("no errors, {}", found.join(", ")) }
    }
}
