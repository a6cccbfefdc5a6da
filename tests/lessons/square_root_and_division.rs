//! A tank that empties: a square root, a quotient, an arcsine, and the closed solution of Torricelli's law.

use std::f64::consts::PI;

use crate::common::{program_of, run_for, voltage};
use crate::known_problems::lessons::torricelli;
use crate::known_problems::runs::{circuit, program, settings, step_of};
use patchcord::solve;

const STEM: &str = "lessons/square-root-and-division";

/// The error of roots and quotients by the open-loop gain of 1e6: 1e-6 at full voltage, and more if the square that is
/// fed back is small: 1e-6 x out / (out^2 / 100 V).
fn near(volts: f64) -> f64 {
    1e-6 * 100.0 / volts
}

#[test]
fn the_height_is_a_parabola_and_jet_and_remaining_time_fall_linearly() {
    for (a, h0) in [(1e-4, 1.0), (1.5e-4, 0.6), (0.8e-4, 1.1)] {
        let program = program(STEM, &[("a", a), ("h0", h0)]);
        let falls = a / 0.05 * (2.0 * 9.81f64).sqrt();
        let empty = 2.0 * h0.sqrt() / falls;
        for share in [0.0, 0.2, 0.5, 0.8] {
            let time = share * empty;
            let machine = run_for(&program, step_of(STEM), time);
            let height = voltage(&machine, "A1") * 0.0125;
            let (jet, left) = (voltage(&machine, "A2") * 0.06, voltage(&machine, "A3") * 1.5);
            let expected = torricelli(a, h0, time);
            let allowed = 2.0 * near(voltage(&machine, "A2"));
            assert!((height / expected - 1.0).abs() < allowed, "{height} m after {time} s, not {expected}");
            assert!((jet / (2.0 * 9.81 * expected).sqrt() - 1.0).abs() < allowed, "{jet} m/s after {time} s");
            // At the present rate the water would last half the actual time, because the jet weakens.
            assert!((left / (0.5 * (empty - time)) - 1.0).abs() < allowed, "{left} s left after {time} s");
        }
    }
}

/// The error is a millionth of the output at the sum, divided by the slope of the sine.
#[test]
fn the_arm_of_the_float_has_the_arcsine_of_the_height() {
    for (length, h0) in [(1.25, 1.2), (1.5, 1.0), (2.0, 0.05)] {
        let program = program(STEM, &[("L", length), ("h0", h0)]);
        let machine = run_for(&program, step_of(STEM), 0.0);
        let expected = (h0 / length).asin();
        let found = voltage(&machine, "A4");
        let slope = 50.0 * PI * expected.cos() / 100.0;
        let error = (found - expected.to_degrees() / 0.9).abs();
        assert!(error < 1.01e-6 * found / slope, "{found} V at {h0} m, {error} V wrong");
    }
}

#[test]
fn an_empty_tank_makes_the_division_impossible() {
    let circuit = circuit(STEM, &[]);
    let stopped = solve::run(&program_of(&circuit), &settings(&circuit).with_duration(240.0)).unwrap_err();
    // The tank is empty after 225.77 s; the last step is before that.
    assert!(stopped.error.to_string().contains("at t = 225.5 s the loop M2, A3"), "{}", stopped.error);
    assert_eq!(stopped.trace.time.last(), Some(&225.0));
}
