//! Fig 8.9: the straight-line friction level alone.

use crate::known::runs::run;
use crate::thesis::bench;

/// Velocities in volts of A3, and the other signals in volts, while the velocity rises from -30 to 30 V.
fn swept(changes: &[(&str, f64)]) -> [Vec<f64>; 4] {
    let trace = run("thesis/fig-8-09", changes, 12.0);
    assert!(bench::lit(&trace).is_empty());
    let [velocity, plus, minus, limited] =
        ["v_o", "VB", "minus_VB", "limited"].map(|name| trace.values(name).unwrap());
    [velocity.iter().map(|velocity| velocity / 0.254e-3).collect(), plus, minus, limited]
}

/// A signal where A3 stands at so many volts.
fn at(velocity: &[f64], signal: &[f64], volts: f64) -> f64 {
    signal[velocity.iter().position(|velocity| (velocity - volts).abs() < 1e-9).unwrap()]
}

#[test]
fn voltages_are_those_of_the_setting_up() {
    let [velocity, plus, minus, limited] = swept(&[]);
    for sign in [-1.0, 1.0] {
        assert!(at(&velocity, &plus, 10.0 * sign).abs() < 1e-9);
        assert!((at(&velocity, &plus, 30.0 * sign) + 0.5).abs() < 1e-9);
        // +10 V when A3 stands at 15 V: what the slope leaves is less than a voltmeter of three digits shows.
        assert!((at(&velocity, &limited, 15.0 * sign) - 10.0).abs() < 0.05);
    }
    assert!((at(&velocity, &plus, 0.0) - 50.0).abs() < 1e-9);
    assert!(plus.iter().zip(&minus).all(|(plus, minus)| *plus == -*minus));
}

#[test]
fn the_level_falls_straight_to_vcl_whatever_that_is() {
    for vcl in [1.27e-3, 2.54e-3, 5.08e-3] {
        let [velocity, plus, ..] = swept(&[("VcL", vcl), ("slope", 0.0)]);
        for (velocity, plus) in velocity.iter().zip(plus) {
            let expected = 50.0 * (1.0 - velocity.abs() * 0.254e-3 / vcl).max(0.0);
            assert!((plus - expected).abs() < 1e-9, "{plus} V at {velocity} V");
        }
    }
}
