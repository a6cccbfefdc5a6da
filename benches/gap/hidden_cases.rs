//! The hidden cases: experiments made by the C program in benches/hidden, and the truth about each of them.
//!
//! The program writes an experiment of a case to one folder and its truth to another, so that a search cannot read it.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::process::Command;

use serde_json::Value;

use crate::Outcome;
use patchcord::expr::Unit;

/// A temporary folder with the cases. It is deleted when the value is dropped.
pub(crate) struct HiddenCases {
    folder: tempfile::TempDir,
}

/// The effects that are hidden in a case, and the size of their traces in the data.
pub(crate) struct Truth {
    /// "none", the name of an effect, "unknown:kind", or two names joined by "+".
    pub what: String,
    /// The hidden effects. Empty if nothing is hidden.
    pub effects: Vec<HiddenEffect>,
    /// Effect-to-noise ratio: the rms residual of the best refitted base over the standard deviation of the noise.
    pub egnr: f64,
    /// The rms residual of the true laws in the validation data, over the noise.
    pub true_validation_residual: f64,
}

/// A hidden effect with its true parameters.
pub(crate) struct HiddenEffect {
    /// Name of the effect in the library.
    pub name: String,
    /// The integrator at whose input it acts, or the drive.
    pub site: String,
    /// The shape of its law. Empty if the law has only one.
    shape: String,
    /// Its parameters by name, in SI units.
    pub parameters: BTreeMap<String, f64>,
}

/// Shapes that no law of the library has.
const SHAPES_NOT_IN_LIBRARY: [&str; 6] =
    ["Lorentzian", "speed lagged over a distance", "Dahl", "LuGre", "elastoplastic", "restitution"];

impl Truth {
    /// Whether the case hides this effect in a shape that the library's law has.
    pub(crate) fn has_library_law(&self, effect: &str) -> bool {
        let hidden = self.effects.iter().find(|hidden| hidden.name == effect);
        hidden.is_some_and(|hidden| !SHAPES_NOT_IN_LIBRARY.contains(&hidden.shape.as_str()))
    }
}

impl HiddenCases {
    /// Compiles the C program, runs its self-test, and makes the cases 1 ... `count`.
    ///
    /// # Errors
    ///
    /// If there is no C compiler, or if the program or its self-test fails.
    pub(crate) fn make(seed: u64, count: usize) -> Outcome<HiddenCases> {
        let root = Path::new(env!("CARGO_MANIFEST_DIR"));
        let folder = tempfile::tempdir()?;
        let program = folder.path().join("hidden");
        let sources = root.join("benches/hidden").read_dir()?.filter_map(|entry| Some(entry.ok()?.path()));
        let sources = sources.filter(|file| file.extension().is_some_and(|extension| extension == "c"));
        run(Command::new("cc").arg("-O2").args(sources).arg("-o").arg(&program).arg("-lm"))?;
        run(Command::new(&program).arg("--self-test"))?;
        let mut make = Command::new(&program);
        make.arg("--seed").arg(seed.to_string()).arg("--cases").arg(count.to_string());
        run(make
            .arg("--out")
            .arg(folder.path())
            .arg("--patches")
            .arg(root.join("crates/ident/tests/systems")))?;
        Ok(HiddenCases { folder })
    }

    /// The path of the experiment of a case.
    pub(crate) fn experiment(&self, number: usize) -> PathBuf {
        self.folder.path().join(format!("{number:04}/experiment.json"))
    }

    /// The truth about a case.
    ///
    /// # Errors
    ///
    /// If its file cannot be read or is incomplete.
    pub(crate) fn truth(&self, number: usize) -> Outcome<Truth> {
        let text = std::fs::read_to_string(self.folder.path().join(format!("truth/{number:04}.json")))?;
        let document: Value = serde_json::from_str(&text)?;
        let effects = document["effects"].as_array().into_iter().flatten();
        let residual = document["true_laws_leave_of_test"].as_f64();
        Ok(Truth {
            what: string(&document["truth"]),
            effects: effects.map(hidden_effect).collect(),
            egnr: document["egnr"].as_f64().unwrap_or_default(),
            true_validation_residual: residual.ok_or("a truth has no \"true_laws_leave_of_test\"")?,
        })
    }
}

/// A JSON string. Empty if the value is not a string.
fn string(value: &Value) -> String {
    value.as_str().unwrap_or_default().to_owned()
}

/// An effect of a truth file.
fn hidden_effect(effect: &Value) -> HiddenEffect {
    let parameters = effect["parameters"].as_object().into_iter().flatten();
    HiddenEffect {
        name: string(&effect["name"]),
        site: string(&effect["junction"]),
        shape: string(&effect["shape"]),
        parameters: parameters.filter_map(|(name, value)| Some((name.clone(), in_si(value)?))).collect(),
    }
}

/// The value of `{"value": ..., "unit": ...}` in SI units. `None` if either is missing or the unit is unknown.
pub(crate) fn in_si(quantity: &Value) -> Option<f64> {
    Some(Unit::parse(quantity["unit"].as_str()?).ok()?.to_si(quantity["value"].as_f64()?))
}

/// Runs a command. An error contains the command and its output.
fn run(command: &mut Command) -> Outcome<()> {
    let output = command.output()?;
    if output.status.success() {
        return Ok(());
    }
    let [stdout, stderr] = [&output.stdout, &output.stderr].map(|text| String::from_utf8_lossy(text));
    Err(format!("{command:?}: {stdout}{stderr}").into())
}
