//! Experiments on the oscillator of crates/ident/tests/systems: a measured force F and a measured position x with
//! noise.

use std::fmt::Write as _;
use std::path::{Path, PathBuf};

use chacha20::ChaCha8Rng;
use chacha20::rand_core::{Rng as _, SeedableRng as _};
use serde_json::json;

use patchcord_ident::Experiment;
use patchcord_ident::fit::problem::Problem;

/// Sampling interval in s.
pub(crate) const INTERVAL: f64 = 0.005;
/// Standard deviation of the position noise in m.
pub(crate) const SIGMA: f64 = 1e-3;

/// The path of the oscillator's patch.
pub(crate) fn patch() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/systems/oscillator.json")
}

/// The experiment with these forces in N and true positions in m, and its fit problem. The first half is training data.
pub(crate) fn measured(forces: &[f64], positions: &[f64]) -> (Experiment, Problem) {
    measured_with([INTERVAL, SIGMA], forces, positions, "linear")
}

/// The same experiment with another sampling interval in s, noise in m, and interpolation of the force.
///
/// `hold` is the value of the drive's key "hold": "linear", "smooth" or "previous".
pub(crate) fn measured_with(
    [interval, sigma]: [f64; 2],
    forces: &[f64],
    positions: &[f64],
    hold: &str,
) -> (Experiment, Problem) {
    let folder = tempfile::tempdir().unwrap();
    let mut rng = ChaCha8Rng::seed_from_u64(2);
    // The sum of twelve uniform numbers has a standard deviation of 1.
    let mut noise = || (0..12).map(|_| f64::from(rng.next_u32()) / f64::from(u32::MAX)).sum::<f64>() - 6.0;
    let mut csv = "t,F,x\n".to_owned();
    for (sample, (force, position)) in forces.iter().zip(positions).enumerate() {
        let time = interval * sample as f64;
        writeln!(csv, "{time:e},{force:e},{:e}", position + sigma * noise()).unwrap();
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
