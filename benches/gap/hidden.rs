//! The cases, and the truth about them, which lies apart.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::process::Command;

use serde_json::Value;

use crate::Outcome;
use patchcord::expr::Unit;

/// Cases made by the program in benches/hidden.
pub struct Hidden {
    folder: tempfile::TempDir,
}

/// What is hidden in a case.
pub struct Truth {
    /// "none", a name, "unknown:kind" or two names joined by "+".
    pub what: String,
    /// The effects.
    pub effects: Vec<Effect>,
    /// The rms that the best base leaves, over sigma.
    pub egnr: f64,
    /// The rms that the true laws leave of the data held back, over sigma.
    pub held_out: f64,
}

/// An effect that is hidden.
pub struct Effect {
    pub name: String,
    pub junction: String,
    /// The shape of its law, where it may have several.
    shape: String,
    /// Its parameters, in SI units.
    pub parameters: BTreeMap<String, f64>,
}

/// Shapes that the library's laws do not have.
const SHAPES_OF_OTHERS: [&str; 6] =
    ["Lorentzian", "speed lagged over a distance", "Dahl", "LuGre", "elastoplastic", "restitution"];

impl Truth {
    /// Whether a hidden effect has the law that the library's has.
    pub fn has_own_law(&self, effect: &str) -> bool {
        let shape = self.effects.iter().find(|own| own.name == effect).map(|own| own.shape.as_str());
        shape.is_some_and(|shape| !SHAPES_OF_OTHERS.contains(&shape))
    }
}

impl Hidden {
    /// Builds the program, holds it against closed solutions, and lets it make so many cases.
    pub fn made(seed: u64, cases: usize) -> Outcome<Hidden> {
        let root = Path::new(env!("CARGO_MANIFEST_DIR"));
        let folder = tempfile::tempdir()?;
        let program = folder.path().join("hidden");
        let sources = root.join("benches/hidden").read_dir()?.filter_map(|entry| Some(entry.ok()?.path()));
        let sources = sources.filter(|file| file.extension().is_some_and(|ending| ending == "c"));
        succeed(Command::new("cc").arg("-O2").args(sources).arg("-o").arg(&program).arg("-lm"))?;
        succeed(Command::new(&program).arg("--self-test"))?;
        let mut make = Command::new(&program);
        make.arg("--seed").arg(seed.to_string()).arg("--cases").arg(cases.to_string());
        succeed(
            make.arg("--out")
                .arg(folder.path())
                .arg("--patches")
                .arg(root.join("crates/ident/tests/systems")),
        )?;
        Ok(Hidden { folder })
    }

    /// The experiment of a case.
    pub fn experiment(&self, number: usize) -> PathBuf {
        self.folder.path().join(format!("{number:04}/experiment.json"))
    }

    /// What is hidden in it.
    pub fn truth(&self, number: usize) -> Outcome<Truth> {
        let text = std::fs::read_to_string(self.folder.path().join(format!("truth/{number:04}.json")))?;
        let told: Value = serde_json::from_str(&text)?;
        let effects = told["effects"].as_array().into_iter().flatten();
        Ok(Truth {
            what: word(&told["truth"]),
            effects: effects.map(effect).collect(),
            egnr: told["egnr"].as_f64().unwrap_or_default(),
            held_out: told["true_laws_leave_of_test"].as_f64().ok_or("a truth tells no noise")?,
        })
    }
}

fn word(value: &Value) -> String {
    value.as_str().unwrap_or_default().to_owned()
}

fn effect(told: &Value) -> Effect {
    let parameters = told["parameters"].as_object().into_iter().flatten();
    Effect {
        name: word(&told["name"]),
        junction: word(&told["junction"]),
        shape: word(&told["shape"]),
        parameters: parameters.filter_map(|(name, own)| Some((name.clone(), in_si(own)?))).collect(),
    }
}

/// A value with its unit, in SI.
pub fn in_si(told: &Value) -> Option<f64> {
    Some(Unit::parse(told["unit"].as_str()?).ok()?.to_si(told["value"].as_f64()?))
}

fn succeed(command: &mut Command) -> Outcome<()> {
    let output = command.output()?;
    if output.status.success() {
        return Ok(());
    }
    let told = [&output.stdout, &output.stderr].map(|text| String::from_utf8_lossy(text));
    Err(format!("{command:?}: {}{}", told[0], told[1]).into())
}
