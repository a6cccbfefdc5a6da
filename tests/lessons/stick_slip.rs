//! Stick-slip: durations of sticking and slipping, and the extension of the spring.

use std::f64::consts::{PI, TAU};

use crate::common::{run_for, voltage};
use crate::known_problems::runs::{program, run, step_of};
use crate::lessons::crossings::next_rise;
use patchcord::solve::Machine;

const STEM: &str = "lessons/stick-slip";
/// Stiffness of the spring in N/m.
const K: f64 = 200.0;
/// Static friction in N.
const FS: f64 = 10.0;
/// Sliding friction in N.
const FK: f64 = 6.0;
/// Natural frequency in rad/s.
const OMEGA: f64 = 10.0;
/// Metres of extension per volt.
const STRETCH: f64 = 0.0006;

/// Durations of sticking and slipping. K1 passes a lower voltage while the block slips.
fn cycle(changes: &[(&str, f64)]) -> (f64, f64) {
    let program = program(STEM, changes);
    let mut machine = run_for(&program, step_of(STEM), 0.0);
    let slips = |machine: &Machine<'_>| 64.0 - voltage(machine, "K1");
    next_rise(&mut machine, slips);
    let sticks = next_rise(&mut machine, |machine| -slips(machine));
    let released = next_rise(&mut machine, slips);
    let second_stick = next_rise(&mut machine, |machine| -slips(machine));
    (released - sticks, second_stick - released)
}

/// The closed solution for friction that drops at once: the spring force rises from 2 Fk - Fs to Fs, then drops back.
fn closed_solution(v: f64) -> (f64, f64) {
    let stick = 2.0 * (FS - FK) / (K * v);
    (stick, 2.0 / OMEGA * (PI - ((FS - FK) * OMEGA / (K * v)).atan()))
}

/// Sum of the errors of both durations.
fn error(v: f64, v_relay: f64) -> f64 {
    let (found, expected) = (cycle(&[("v", v), ("v_relay", v_relay)]), closed_solution(v));
    (found.0 - expected.0).abs() + (found.1 - expected.1).abs()
}

#[test]
fn stick_and_slip_durations_match_the_closed_solution() {
    for v in [0.02, 0.05, 0.1] {
        // The relay switches when the slip velocity reaches v_relay, sqrt(2 v_relay m / (k v)) after the start of the
        // slip.
        let delay = (2.0 * 1e-9 * 2.0 / (K * v)).sqrt();
        assert!(error(v, 1e-9) < 3.0 * delay, "{v} m/s: {} {delay}", error(v, 1e-9));
        // A hundredth of v_relay gives a tenth of the delay.
        let ratio = error(v, 1e-5) / error(v, 1e-7);
        assert!((9.0..11.0).contains(&ratio), "{v} m/s: {ratio}");
    }
}

#[test]
fn the_extension_of_the_spring_matches_the_closed_solution() {
    let trace = run(STEM, &[("v_relay", 1e-9)], 5.0);
    let most = trace.track("x").unwrap().extremes[0].most.volts * STRETCH;
    let swing = ((FS - FK) / K).hypot(0.05 / OMEGA);
    // The relay is late by sqrt(2 v_relay m / (k v)), during which the belt moves a micrometre.
    let delay = (2.0 * 1e-9 * 2.0 / (K * 0.05)).sqrt() * 0.05;
    let expected = FK / K + swing;
    assert!((most - expected).abs() < 1.5 * delay, "{most} {expected}");
}

#[test]
fn the_block_does_not_creep_while_it_sticks() {
    let program = program(STEM, &[]);
    for time in [0.3, 0.999, 1.5, 2.1, 2.7] {
        let machine = run_for(&program, step_of(STEM), time);
        assert_eq!(voltage(&machine, "A1"), 0.0, "after {time} s");
    }
}

#[test]
fn with_equal_static_and_sliding_friction_the_block_oscillates_without_sticking() {
    // x = F / k + v / omega sin(omega t): the block reaches the velocity of the belt once per period without sticking.
    let program = program(STEM, &[("Fs", FK)]);
    let mut machine = run_for(&program, step_of(STEM), 0.7);
    let middle = |machine: &Machine<'_>| voltage(machine, "B1") * STRETCH - FK / K;
    let first = next_rise(&mut machine, middle);
    let period = next_rise(&mut machine, middle) - first;
    assert!((period - TAU / OMEGA).abs() < 1e-6, "{period}");
}
