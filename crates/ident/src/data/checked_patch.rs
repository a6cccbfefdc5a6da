//! The patch of an experiment, free of errors, and the units and scales of its drives and signals.

use crate::data::codes;
use crate::data::experiment_document::ColumnBinding;
use crate::data::file_source::FileSource;
use patchcord_core::circuit::Circuit;
use patchcord_core::document::fields::Findings;
use patchcord_core::document::{Code, Diagnostic, DocumentError, Placed, Report, suggestion};
use patchcord_core::ir::Program;
use patchcord_core::patch::Patch;
use patchcord_expr::Unit;

/// A patch that compiles without errors.
pub(crate) struct CheckedPatch {
    /// The circuit, with the default values of all parameters.
    pub circuit: Circuit,
}

/// The drive or signal of the patch to which a column belongs.
#[derive(Debug, Clone)]
pub(crate) struct BindingTarget {
    /// The name under which the patch records it.
    pub name: String,
    /// The unit of its scale; volts if it has no scale.
    pub unit: Unit,
    /// The value of 1 V in `unit`. Negative if the signal is inverted.
    pub per_volt: f64,
}

impl CheckedPatch {
    /// Reads the patch that `named` names and compiles it. A fault is added to the findings.
    ///
    /// # Errors
    /// If the patch cannot be read or has errors. The error is the report of the patch, or None if there is no report
    /// because the file cannot be read.
    pub(crate) fn read(
        source: FileSource<'_>,
        named: &Placed<String>,
        findings: &mut Findings,
    ) -> Result<CheckedPatch, Option<Box<Report>>> {
        let path = source.path(&named.value);
        let bad_patch = |message: String| Diagnostic::at(codes::BAD_PATCH, named.span, message);
        source.patch(&named.value).and_then(|patch| Ok(compiled(&patch)?)).map_err(|error| match error {
            DocumentError::Text(report) => {
                findings.push(bad_patch(format!("the patch {} has errors", path.display())));
                Some(report)
            }
            error => {
                let hint = "write the path of the patch relative to the folder of the experiment";
                findings.push(bad_patch(error.to_string()).hint(hint));
                None
            }
        })
    }

    /// The patch as written.
    pub(crate) fn patch(&self) -> &Patch {
        self.circuit.patch()
    }

    /// Returns the drive that a column feeds. None, with a finding, if the patch does not have it.
    pub(crate) fn drive(&self, binding: &ColumnBinding, findings: &mut Findings) -> Option<BindingTarget> {
        let patch = self.patch();
        let Some(drive) = patch.drives.get(&binding.name.value) else {
            let known: Vec<_> = patch.drives.keys().map(String::as_str).collect();
            findings.push(self.unknown_name(&binding.name, "drive", &known));
            return None;
        };
        let scale = drive.scale.as_ref().map(|scale| scale.value.as_str());
        self.target(&binding.name.value, scale, 1.0)
    }

    /// Returns the signal that a column measures. None, with a finding, if the patch does not have it.
    pub(crate) fn signal(&self, binding: &ColumnBinding, findings: &mut Findings) -> Option<BindingTarget> {
        let name = self.circuit.recorded_name(&binding.name.value);
        let signal = name.and_then(|name| self.circuit.signals().iter().find(|signal| signal.name == name));
        let Some(signal) = signal else {
            let named: Vec<_> = self.patch().signals.keys().map(String::as_str).collect();
            let all = || self.circuit.signals().iter().map(|signal| signal.name.as_str()).collect();
            let known = if named.is_empty() { all() } else { named };
            findings.push(self.unknown_name(&binding.name, "signal", &known));
            return None;
        };
        let scale = signal.scale.map(|scale| self.circuit.derived(scale).0);
        self.target(&signal.name, scale, signal.factor)
    }

    /// Returns a target with its unit. `factor` multiplies the value of 1 V of the scale; it is negative for an
    /// inverted signal. Without a scale, the unit is the volt. None if the scale has no value.
    fn target(&self, name: &str, scale: Option<&str>, factor: f64) -> Option<BindingTarget> {
        let (unit, per_volt) = match scale {
            Some(scale) => {
                let index = self.circuit.derived_index(scale)?;
                (self.circuit.derived_unit(index).clone(), self.circuit.per_volt(index)?)
            }
            None => (Unit::parse("V").ok()?, 1.0),
        };
        Some(BindingTarget { name: name.to_owned(), unit, per_volt: factor * per_volt })
    }

    /// Reports a name that the patch does not have. `noun` is "drive" or "signal".
    fn unknown_name(&self, name: &Placed<String>, noun: &str, known: &[&str]) -> Diagnostic {
        let message = format!("the patch {} has no {noun} {}", self.patch().file(), name.value);
        let no_candidates = format!("the patch has no {noun}s");
        Diagnostic::at(Code::UNKNOWN_NAME, name.span, message)
            .hint(suggestion(&name.value, known).unwrap_or(no_candidates))
    }
}

/// Compiles a patch to find its errors.
fn compiled(patch: &Patch) -> Result<CheckedPatch, Box<Report>> {
    let circuit = Circuit::new(patch)?;
    Program::new(&circuit)?;
    Ok(CheckedPatch { circuit })
}
