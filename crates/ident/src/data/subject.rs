//! The patch that an experiment is about, and what its names stand for.

use std::path::Path;

use crate::data::document::Wire;
use patchcord_core::circuit::Circuit;
use patchcord_core::document::fields::Findings;
use patchcord_core::document::{Code, Diagnostic, DocumentError, Placed, Report, suggestion};
use patchcord_core::ir::Program;
use patchcord_core::patch::Patch;
use patchcord_expr::Unit;

/// The patch, found right.
pub(crate) struct Subject {
    pub circuit: Circuit,
}

/// What the column of a drive or a signal is measured in.
#[derive(Debug, Clone)]
pub(crate) struct Target {
    /// The name under which it is recorded.
    pub name: String,
    pub unit: Unit,
    /// What a volt of it stands for, in this unit; with its sign.
    pub per_volt: f64,
}

impl Subject {
    /// Reads the patch; of a wrong one the report comes back.
    pub fn read(
        folder: &Path,
        named: &Placed<String>,
        findings: &mut Findings,
    ) -> Result<Subject, Option<Box<Report>>> {
        let path = folder.join(&named.value);
        let wrong = |message: String| Diagnostic::at(Code::BadPatch, named.span, message);
        Patch::read(&path).and_then(|patch| Ok(checked(&patch)?)).map_err(|error| match error {
            DocumentError::Text(report) => {
                findings.push(wrong(format!("the patch {} is wrong", path.display())));
                Some(report)
            }
            error => {
                let hint = "a patch is looked for from the folder of the experiment";
                findings.push(wrong(error.to_string()).hint(hint));
                None
            }
        })
    }

    pub fn patch(&self) -> &Patch {
        self.circuit.patch()
    }

    /// The drive that a column feeds.
    pub fn drive(&self, wire: &Wire, findings: &mut Findings) -> Option<Target> {
        let patch = self.patch();
        let Some(drive) = patch.drives.get(&wire.name.value) else {
            let known: Vec<_> = patch.drives.keys().map(String::as_str).collect();
            findings.push(self.unknown(&wire.name, "drive", &known));
            return None;
        };
        let scale = drive.scale.as_ref().map(|scale| scale.value.as_str());
        self.target(&wire.name.value, scale, 1.0)
    }

    /// The signal that a column measures.
    pub fn signal(&self, wire: &Wire, findings: &mut Findings) -> Option<Target> {
        let name = self.circuit.recordable(&wire.name.value);
        let point = name.and_then(|name| self.circuit.signals().iter().find(|point| point.name == name));
        let Some(point) = point else {
            let named: Vec<_> = self.patch().signals.keys().map(String::as_str).collect();
            let all = || self.circuit.signals().iter().map(|point| point.name.as_str()).collect();
            let known = if named.is_empty() { all() } else { named };
            findings.push(self.unknown(&wire.name, "signal", &known));
            return None;
        };
        let scale = point.scale.map(|scale| self.circuit.derived(scale).0);
        self.target(&point.name, scale, point.factor)
    }

    fn target(&self, name: &str, scale: Option<&str>, factor: f64) -> Option<Target> {
        let (unit, per_volt) = match scale {
            Some(scale) => {
                let index = self.circuit.derived_index(scale)?;
                (self.circuit.derived_unit(index).clone(), self.circuit.per_volt(index)?)
            }
            None => (Unit::parse("V").ok()?, 1.0),
        };
        Some(Target { name: name.to_owned(), unit, per_volt: factor * per_volt })
    }

    fn unknown(&self, name: &Placed<String>, noun: &str, known: &[&str]) -> Diagnostic {
        let message = format!("the patch {} has no {noun} {}", self.patch().file(), name.value);
        let none = format!("the patch has no {noun}s");
        Diagnostic::at(Code::UnknownName, name.span, message)
            .hint(suggestion(&name.value, known).unwrap_or(none))
    }
}

fn checked(patch: &Patch) -> Result<Subject, Box<Report>> {
    let circuit = Circuit::new(patch, &[])?;
    Program::new(&circuit)?;
    Ok(Subject { circuit })
}
