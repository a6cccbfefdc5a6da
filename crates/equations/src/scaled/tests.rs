//! Scaling of whole problems.

use patchcord_core::patch::Problem;

use super::{ScaleOptions, scale_problem};

#[test]
fn an_angle_with_parameters_in_its_equation_is_scaled() {
    let problem = Problem::read("tests/systems/car-steering.json").unwrap_or_else(|error| panic!("{error}"));
    let options = ScaleOptions::default();
    let scaled = scale_problem(&problem, &options).unwrap_or_else(|error| panic!("{error}"));
    assert!(scaled.peaks.iter().all(|peak| peak.volts < 100.0), "{:?}", scaled.peaks);
    let maximum =
        |name: &str| scaled.quantities.iter().find(|quantity| quantity.name == name).unwrap().maximum;
    // By SciPy; see car-steering.reference.json.
    for (name, expected) in [("x", 46.021_727_002), ("command", 28.0)] {
        let found = maximum(name);
        assert!((found / expected - 1.0).abs() < 1e-6, "{name}: {found} instead of {expected}");
    }
}
