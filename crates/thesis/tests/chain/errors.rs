//! Tests that errors of the design chain name quantity, value and range.

use super::{inputs, try_chain};
use patchcord_thesis::chain::{Chain, Inputs, Settings};
use patchcord_thesis::slideway::ridge::Ridge;
use patchcord_thesis::slideway::units::{CM2, KGF, UM};

/// Asserts that the chain for these inputs and set parameters fails with a message that begins in this way.
fn assert_chain_error(inputs: &Inputs, set: &[(&str, f64)], expected: &str) {
    let got = try_chain(inputs, set).unwrap_err().to_string();
    assert!(got.starts_with(expected), "got {got}, expected {expected}");
}

#[test]
fn errors_of_inputs_name_quantity_value_and_range() {
    let base = inputs(20.0);
    let flat_ridge = Ridge { width: 50.0 * UM, height: 0.0 };
    let cases = [
        (Inputs { viscosity: 0.0, ..base }, "viscosity must be within 0.001 ... 1000, got 0 P"),
        (Inputs { viscosity: f64::NAN, ..base }, "viscosity must be within 0.001 ... 1000, got NaN P"),
        (Inputs { weight: -KGF, ..base }, "weight must be positive, got -1 kgf"),
        (Inputs { area: CM2, ..base }, "weight / area must be within 0.0001 ... 8, got 450 kgf/cm2"),
        (inputs(0.0), "stiffness must be positive, got 0 kN/mm"),
        (inputs(1.0), "K = 1 MN/m is below the range of the circuit of Fig 8.16, 5 ... 178 MN/m"),
        (
            Inputs { weight: 20.0 * KGF, ..base },
            "M = 20 kg is below the range of the circuit of Fig 8.16, 180 ... 4000 kg",
        ),
        (Inputs { ridge: flat_ridge, ..base }, "height of a ridge must be within 0.001 ... 100000, got 0 um"),
    ];
    for (inputs, expected) in cases {
        assert_chain_error(&inputs, &[], expected);
    }
}

/// Set parameters, and the beginnings of the messages of the errors.
const WRONG_PARAMETERS: &[(&[(&str, f64)], &str)] = &[
    (&[("k", 1.0)], "the circuit of Fig 8.16 has no parameter k; did you mean \"K\"?"),
    (&[("v_turn", 4000.0)], "v_turn = 4000 s is above the range of the circuit of Fig 8.16, 0 ... 3600 s"),
    (
        &[("v_rate", -1e-3)],
        "the velocity command must rise from rest or forward motion (v_start at least 0, v_rate and v_turn \
         positive), got v_start = 0 m/s, v_rate = -0.001 m/s2 and v_turn = ",
    ),
    (
        &[("v_rate", 0.1)],
        "the critical velocity cannot be read: the command alone changes by 3.9 mm/s within a window",
    ),
    (&[("Tc", 1e-4)], "Tc = 0.1 ms is below the range of the circuit of Fig 8.16, "),
    // The printed range extends from the minimum with the smallest scales to the maximum with the largest scales.
    (
        &[("VcL", 15.0)],
        "VcL = 15000 mm/s is above the range of the circuit of Fig 8.16, 0.254 ... 10000 mm/s",
    ),
    (
        &[("VcL", 0.3e-3), ("v_turn", 40.0)],
        "VcL = 0.3 mm/s is below the range of the circuit of Fig 8.16 with scales 5 times as large, \
         1.27 ... 250 mm/s: the command or its overshoot needs these scales",
    ),
];

#[test]
fn errors_of_parameters_name_quantity_value_and_range() {
    for (set, expected) in WRONG_PARAMETERS {
        assert_chain_error(&inputs(20.0), set, expected);
    }
}

#[test]
fn errors_of_settings_name_quantity_value_and_range() {
    let wrong = |settings: Settings| Chain::new(&inputs(20.0), &settings).unwrap_err().to_string();
    let settings = Settings::default;
    assert!(wrong(Settings { share: 1.0, ..settings() }).ends_with("must be between 0 and 1, got 1"));
    assert!(
        wrong(Settings { threshold: f64::NAN, ..settings() })
            .ends_with("must be positive and finite, got NaN")
    );
    assert!(
        wrong(Settings { window: Some(0.0), ..settings() }).ends_with("must be positive and finite, got 0")
    );
    let overloaded = wrong(Settings { step: Some(0.05), ..settings() });
    // With so long a step the first overloaded amplifier depends on rounding.
    assert!(overloaded.contains(" is overloaded even at 25.4 mm/s a volt: the motion"), "{overloaded}");
    assert!(wrong(Settings { every: Some(0.02), ..settings() }).contains("a window has 2 samples"));
}
