//! A patch compiled for fitting: its drives become tables, and its initial voltages become parameters.

use super::{FitParameter, ModelError};
use crate::data::experiment::{MeasuredDrive, replace_with_tables};
use crate::effects::unused_names::unused_name;
use patchcord_core::circuit::Circuit;
use patchcord_core::ir::Program;
use patchcord_core::patch::{ParameterBuilder, Patch};
use patchcord_core::solve::{MIN_TOLERANCE, Machine};

/// A patch compiled for fitting: drives that records feed are tables, and every initial voltage is a parameter.
///
/// All models of one patch are made from one such program, so that they share the code of its kernels.
#[derive(Debug)]
pub struct FitProgram {
    /// The compiled patch, without the data of any record.
    pub(super) program: Program,
    /// The initial voltages of the integrators and lags of the patch, as parameters of the program.
    pub(super) initial: Vec<FitParameter>,
    /// The drives that records feed.
    pub(super) drives: Vec<MeasuredDrive>,
}

impl FitProgram {
    /// Compiles a patch. `drives` specifies the drives that records feed.
    ///
    /// # Errors
    /// If the patch is invalid or has no such drive.
    pub fn new(patch: &Patch, drives: &[MeasuredDrive]) -> Result<FitProgram, ModelError> {
        let (prepared, initial) = prepare_patch(patch, drives)?;
        FitProgram::compile(&prepared, initial, drives)
    }

    /// Compiles a patch whose initial voltages are not parameters, but remain as the patch specifies them.
    ///
    /// # Errors
    /// As for [`new`](Self::new).
    pub(crate) fn with_own_initial(
        patch: &Patch,
        drives: &[MeasuredDrive],
    ) -> Result<FitProgram, ModelError> {
        let mut editor = patch.edit();
        replace_with_tables(&mut editor, drives)?;
        FitProgram::compile(&editor.finish(patch.file())?, Vec::new(), drives)
    }

    /// Compiles a patch that is prepared for fitting.
    ///
    /// # Errors
    /// If the patch is invalid.
    fn compile(
        prepared: &Patch,
        initial: Vec<FitParameter>,
        drives: &[MeasuredDrive],
    ) -> Result<FitProgram, ModelError> {
        let program = Program::new(&Circuit::new(prepared)?)?;
        Ok(FitProgram { program, initial, drives: drives.to_vec() })
    }

    /// Whether the program was compiled for the same drives with the same interpolation.
    pub(crate) fn has_drives(&self, drives: &[MeasuredDrive]) -> bool {
        let mut pairs = self.drives.iter().zip(drives);
        self.drives.len() == drives.len()
            && pairs.all(|(drive, other)| drive.drive == other.drive && drive.hold == other.hold)
    }
}

/// The integrators and lags of a patch, except those in macros, with their initial voltages in V.
fn initial_voltages(patch: &Patch) -> Result<Vec<(String, f64)>, ModelError> {
    let program = Program::new(&Circuit::new(patch)?)?;
    // The machine is never run. The adaptive one has no step that could be too long for a lag.
    let machine = Machine::adaptive(&program, MIN_TOLERANCE, 1.0)?;
    let states = program.states().into_iter().zip(machine.states());
    let outside_macros = states.filter(|(element, _)| !element.contains('.'));
    Ok(outside_macros.map(|(element, volts)| (element.to_owned(), *volts)).collect())
}

/// The patch with a parameter for every initial voltage and a table for every drive that records feed, and these
/// parameters. Each is named "initial_" and the element and ranges from -100 to 100 V.
fn prepare_patch(patch: &Patch, drives: &[MeasuredDrive]) -> Result<(Patch, Vec<FitParameter>), ModelError> {
    let mut editor = patch.edit();
    let mut initial = Vec::new();
    for (element, value) in initial_voltages(patch)? {
        let word: String =
            element.chars().map(|letter| if letter.is_ascii_alphanumeric() { letter } else { '_' }).collect();
        let is_taken = |name: &str| {
            editor.patch().parameters.contains_key(name) || editor.patch().scales.contains_key(name)
        };
        let name = unused_name(&format!("initial_{word}"), is_taken);
        editor.put_parameter(&name, ParameterBuilder::new(value, "1").range([-100, 100]));
        editor.set_initial(&element, name.as_str())?;
        initial.push(FitParameter { name, value, range: [-100.0, 100.0] });
    }
    replace_with_tables(&mut editor, drives)?;
    Ok((editor.finish(patch.file())?, initial))
}

/// The patch with fitted initial voltages, in V. `initial` contains first those of its integrators and lags, then those
/// of the parameters `initial_states`.
///
/// # Errors
/// If the patch is invalid or a value is not finite.
pub(crate) fn with_initial_voltages(
    patch: &Patch,
    initial_states: &[String],
    initial: &[f64],
) -> Result<Patch, ModelError> {
    let states = initial_voltages(patch)?;
    let mut editor = patch.edit();
    for ((element, _), volts) in states.iter().zip(initial) {
        editor.set_initial(element, *volts)?;
    }
    for (name, volts) in initial_states.iter().zip(initial.iter().skip(states.len())) {
        editor.set_parameter(name, *volts)?;
    }
    Ok(editor.finish(patch.file())?)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn initial_voltages_of_a_lag_do_not_depend_on_its_time_constant() {
        let text = r#"{"patchcord": 1,
            "elements": {"L1": {"kind": "lag", "in": {"x1": ["L1"]}, "time": 1e-6, "initial": 5}},
            "run": {"for": 1e-5, "step": 1e-7}}"#;
        let patch = Patch::parse("quick.json", text).unwrap();
        assert_eq!(initial_voltages(&patch).unwrap(), [("L1".to_owned(), 5.0)]);
    }
}
