//! Fig 8.17: Fig 8.16 as blocks, which gives the same run.

use crate::known::runs::{difference, record, run};
use crate::known::slideway::{Law, Slideway};
use crate::thesis::bench::{self, document};
use crate::thesis::slideway;

const STEM: &str = "thesis/fig-8-17";
const CIRCUIT: &str = "thesis/fig-8-16";

#[test]
fn follows_the_equations() {
    assert!(slideway::agrees_at(STEM, &Slideway::thesis(Law::Remembered)));
    slideway::agrees_at_random_settings(STEM, Law::Remembered, slideway::agrees_at);
}

#[test]
fn is_set_driven_and_read_as_the_circuit_is() {
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

/// All 8.5 s of stick-slip, every signal; they come to 1.2e-11 of 100 V.
#[test]
fn its_run_is_that_of_the_circuit() {
    let [circuit, blocks] = [CIRCUIT, STEM].map(|stem| run(stem, &[], 8.466));
    assert_eq!([bench::lit(&circuit).len(), bench::lit(&blocks).len()], [0, 0]);
    for (circuit, blocks) in circuit.tracks.iter().zip(&blocks.tracks) {
        assert_eq!(circuit.name, blocks.name);
        // A signal may be another voltage in the other patch: held against each other in the volts of the circuit.
        let share = blocks.per_volt / circuit.per_volt;
        assert_eq!(circuit.volts.len(), blocks.volts.len());
        for (row, (volts, block)) in circuit.volts.iter().zip(&blocks.volts).enumerate() {
            let off = (volts - block * share) / 100.0;
            assert!(off.abs() < 1e-9, "{} is {off:e} off in row {row}", circuit.name);
        }
    }
}

#[test]
fn its_run_is_that_of_the_circuit_at_other_settings() {
    slideway::agrees_at_random_settings(STEM, Law::Remembered, |stem, setting| {
        let changes = setting.changes();
        let circuit = record(CIRCUIT, &changes, 0.2, 1e-3, &["v_o"]);
        let blocks = record(stem, &changes, 0.2, 1e-3, &["v_o"]);
        if !bench::lit(&circuit).is_empty() || !bench::lit(&blocks).is_empty() {
            return false;
        }
        let off = difference(&blocks.values("v_o").unwrap(), &circuit.values("v_o").unwrap());
        assert!(off < 1e-9, "{off:e} off at {setting:?}");
        true
    });
}
