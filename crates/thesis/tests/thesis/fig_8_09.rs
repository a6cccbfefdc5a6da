//! Fig 8.9: the straight-line friction level alone.

use crate::known_problems::runs::run;
use crate::thesis::circuit_readings;

/// Velocities in volts of A3, and the other signals in volts, while the velocity rises from -30 to 30 V.
fn sweep(changes: &[(&str, f64)]) -> [Vec<f64>; 4] {
    let trace = run("thesis/fig-8-09", changes, 12.0);
    assert!(circuit_readings::overloaded_elements(&trace).is_empty());
    let [velocity, plus, minus, limited] =
        ["v_o", "VB", "minus_VB", "limited"].map(|name| trace.values(name).unwrap());
    [velocity.iter().map(|velocity| velocity / 0.254e-3).collect(), plus, minus, limited]
}

/// A signal at a voltage of A3.
fn at(velocity: &[f64], signal: &[f64], volts: f64) -> f64 {
    signal[velocity.iter().position(|velocity| (velocity - volts).abs() < 1e-9).unwrap()]
}

#[test]
fn voltages_agree_with_the_procedure_of_the_text() {
    let [velocity, plus, minus, limited] = sweep(&[]);
    for sign in [-1.0, 1.0] {
        assert!(at(&velocity, &plus, 10.0 * sign).abs() < 1e-9);
        assert!((at(&velocity, &plus, 30.0 * sign) + 0.5).abs() < 1e-9);
        // +10 V when A3 is at 15 V. A voltmeter of three digits does not show the error of the slope.
        assert!((at(&velocity, &limited, 15.0 * sign) - 10.0).abs() < 0.05);
    }
    assert!((at(&velocity, &plus, 0.0) - 50.0).abs() < 1e-9);
    assert!(plus.iter().zip(&minus).all(|(plus, minus)| *plus == -*minus));
}

#[test]
fn level_falls_linearly_to_every_vcl() {
    for vcl in [1.27e-3, 2.54e-3, 5.08e-3] {
        let [velocity, plus, ..] = sweep(&[("VcL", vcl), ("slope", 0.0)]);
        for (velocity, plus) in velocity.iter().zip(plus) {
            let expected = 50.0 * (1.0 - velocity.abs() * 0.254e-3 / vcl).max(0.0);
            assert!((plus - expected).abs() < 1e-9, "{plus} V at {velocity} V");
        }
    }
}
