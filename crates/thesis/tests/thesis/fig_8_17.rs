//! Fig 8.17: the block form of Fig 8.16, which gives the same run.

use crate::known_problems::runs::{difference, record, run};
use crate::known_problems::slideway::{FrictionLaw, Slideway};
use crate::thesis::circuit_readings::{self, document};
use crate::thesis::equations;

/// The patch of the block form.
const STEM: &str = "thesis/fig-8-17";
/// The patch of the circuit.
const CIRCUIT: &str = "thesis/fig-8-16";

#[test]
fn follows_the_equations() {
    assert!(equations::agrees_at(STEM, &Slideway::thesis(FrictionLaw::LagBeforeSquare)));
    equations::agrees_at_random_settings(STEM, FrictionLaw::LagBeforeSquare, equations::agrees_at);
}

#[test]
fn settings_drives_and_signals_equal_the_circuit() {
    let (circuit, blocks) = (document(CIRCUIT), document(STEM));
    for section in ["scales", "drives", "run", "record"] {
        assert_eq!(circuit[section], blocks[section], "{section}");
    }
    for (name, parameter) in circuit["parameters"].as_object().unwrap() {
        for key in ["value", "unit", "range"] {
            assert_eq!(parameter[key], blocks["parameters"][name][key], "{key} of {name}");
        }
    }
    for (name, signal) in circuit["signals"].as_object().unwrap() {
        assert_eq!(signal["scale"], blocks["signals"][name]["scale"], "{name}");
    }
}

/// All signals over 8.5 s of stick-slip. The largest difference is 1.2e-11 of 100 V.
#[test]
fn run_equals_the_circuit() {
    let [circuit, blocks] = [CIRCUIT, STEM].map(|stem| run(stem, &[], 8.466));
    assert_eq!(
        [
            circuit_readings::overloaded_elements(&circuit).len(),
            circuit_readings::overloaded_elements(&blocks).len()
        ],
        [0, 0]
    );
    for (circuit, blocks) in circuit.tracks.iter().zip(&blocks.tracks) {
        assert_eq!(circuit.name, blocks.name);
        // A signal may have another scale in the other patch. Both are compared in the volts of the circuit.
        let scale = blocks.per_volt / circuit.per_volt;
        assert_eq!(circuit.volts.len(), blocks.volts.len());
        for (row, (volts, block)) in circuit.volts.iter().zip(&blocks.volts).enumerate() {
            let error = (volts - block * scale) / 100.0;
            assert!(error.abs() < 1e-9, "{} deviates by {error:e} in row {row}", circuit.name);
        }
    }
}

#[test]
fn run_equals_the_circuit_at_random_settings() {
    equations::agrees_at_random_settings(STEM, FrictionLaw::LagBeforeSquare, |stem, setting| {
        let changes = setting.changes();
        let circuit = record(CIRCUIT, &changes, 0.2, 1e-3, &["v_o"]);
        let blocks = record(stem, &changes, 0.2, 1e-3, &["v_o"]);
        if !circuit_readings::overloaded_elements(&circuit).is_empty()
            || !circuit_readings::overloaded_elements(&blocks).is_empty()
        {
            return false;
        }
        let error = difference(&blocks.values("v_o").unwrap(), &circuit.values("v_o").unwrap());
        assert!(error < 1e-9, "deviation {error:e} at {setting:?}");
        true
    });
}
