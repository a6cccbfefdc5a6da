//! Experiments on the oscillator of crates/ident/tests/systems: a force, and where it stands, with noise.

use std::fmt::Write as _;
use std::path::{Path, PathBuf};

use chacha20::ChaCha8Rng;
use chacha20::rand_core::{Rng as _, SeedableRng as _};
use serde_json::json;

use patchcord_ident::Experiment;
use patchcord_ident::fit::problem::Problem;

/// Seconds from sample to sample.
pub const INTERVAL: f64 = 0.005;
/// Standard deviation of the noise, in m.
pub const SIGMA: f64 = 1e-3;

pub fn patch() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/systems/oscillator.json")
}

/// The experiment with forces, and where the mass stood but for the noise; half of it is trained on.
pub fn measured(forces: &[f64], stood: &[f64]) -> (Experiment, Problem) {
    taken([INTERVAL, SIGMA], forces, stood, "linear")
}

/// The same with other seconds from sample to sample, other noise, and the force held otherwise between samples.
pub fn taken(
    [interval, sigma]: [f64; 2],
    forces: &[f64],
    stood: &[f64],
    hold: &str,
) -> (Experiment, Problem) {
    let folder = tempfile::tempdir().unwrap();
    let mut dice = ChaCha8Rng::seed_from_u64(2);
    // The sum of twelve has a standard deviation of 1.
    let mut noise = || (0..12).map(|_| f64::from(dice.next_u32()) / f64::from(u32::MAX)).sum::<f64>() - 6.0;
    let mut csv = "t,F,x\n".to_owned();
    for (sample, (force, stood)) in forces.iter().zip(stood).enumerate() {
        let time = interval * sample as f64;
        writeln!(csv, "{time:e},{force:e},{:e}", stood + sigma * noise()).unwrap();
    }
    std::fs::write(folder.path().join("data.csv"), csv).unwrap();
    let experiment = json!({
        "patch": patch(), "data": "data.csv", "drives": {"F": {"column": "F", "hold": hold}},
        "outputs": {"x": {"column": "x", "sigma": sigma}}, "fit": ["M", "k", "c"],
        "train": [0, (0.5 * forces.len() as f64 - 0.9) * interval],
    });
    let experiment = Experiment::parse_in(folder.path(), "experiment.json", &experiment.to_string());
    let experiment = experiment.unwrap_or_else(|error| panic!("{error}"));
    let problem = Problem::of(&experiment).unwrap();
    (experiment, problem)
}
