//! The parts of the machine: a scaled patch can need more of them than the machine has.
//!
//! The patch is computed all the same, with as many parts as it needs, so that a reader sees its scales.

use patchcord_core::circuit::Circuit;
use patchcord_core::document::Diagnostic;
use patchcord_core::machines::{MachineModel, Part};
use patchcord_core::patch::Patch;

use super::built_patch::BuiltPatch;
use super::error::ScaleError;
use crate::findings::codes;

/// The circuit of a patch on a machine that has as many parts as it needs.
///
/// # Errors
/// If the patch cannot be wired.
pub(super) fn unlimited_circuit(patch: &Patch) -> Result<Circuit, ScaleError> {
    let mut unlimited = patch.clone();
    unlimited.machine = None;
    Circuit::new(&unlimited).map_err(ScaleError::Circuit)
}

/// The warnings about a patch, and about the parts that the machine lacks for it, at positions in the problem.
///
/// # Errors
/// If the patch cannot be wired.
pub(super) fn warnings(built: &BuiltPatch<'_>) -> Result<Vec<Diagnostic>, ScaleError> {
    let machine = built.basis.options.machine;
    let circuit = unlimited_circuit(built.patch).map_err(|error| built.fault_of_problem(error))?;
    let parts = circuit.parts().iter();
    let missing = parts.filter_map(|(part, used)| missing_parts(machine, *part, *used));
    let warnings = circuit.warnings();
    let about_patch = warnings.findings.iter().map(|finding| built.in_problem(finding));
    Ok(about_patch.chain(missing).collect())
}

/// The warning about a part of which a machine has too few. `None` if it has enough.
fn missing_parts(machine: &MachineModel, part: Part, used: usize) -> Option<Diagnostic> {
    let owned = machine.count(part).filter(|owned| *owned < used)?;
    let owned = if owned == 0 { "none".to_owned() } else { owned.to_string() };
    let message = format!("the patch uses {}, and the {} has {owned}", part.counted(used), machine.name);
    Some(Diagnostic::without_span(codes::MISSING_PARTS, message))
}
