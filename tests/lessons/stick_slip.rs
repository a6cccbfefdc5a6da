//! Stick-slip: how long the block sticks and slips, and how far the spring is stretched.

use std::f64::consts::{PI, TAU};

use crate::common::{ran, voltage};
use crate::known::runs::{program, run, step_of};
use crate::lessons::bench::next_rise;
use patchcord::solve::Machine;

const STEM: &str = "lessons/stick-slip";
const K: f64 = 200.0;
const FS: f64 = 10.0;
const FK: f64 = 6.0;
const OMEGA: f64 = 10.0;
const STRETCH: f64 = 0.0006;

/// How long it sticks, and how long it slips: K1 passes on a lower voltage while it slips.
fn cycle(changes: &[(&str, f64)]) -> (f64, f64) {
    let program = program(STEM, changes);
    let mut machine = ran(&program, step_of(STEM), 0.0);
    let slips = |machine: &Machine<'_>| 64.0 - voltage(machine, "K1");
    next_rise(&mut machine, slips);
    let sticks = next_rise(&mut machine, |machine| -slips(machine));
    let released = next_rise(&mut machine, slips);
    let again = next_rise(&mut machine, |machine| -slips(machine));
    (released - sticks, again - released)
}

/// The same for friction that falls at once: the spring is drawn from 2 Fk - Fs to Fs, and leaps back.
fn closed(v: f64) -> (f64, f64) {
    let stick = 2.0 * (FS - FK) / (K * v);
    (stick, 2.0 / OMEGA * (PI - ((FS - FK) * OMEGA / (K * v)).atan()))
}

/// What the two times are off the closed ones, together.
fn error(v: f64, v_relay: f64) -> f64 {
    let (found, expected) = (cycle(&[("v", v), ("v_relay", v_relay)]), closed(v));
    (found.0 - expected.0).abs() + (found.1 - expected.1).abs()
}

#[test]
fn stick_and_slip_last_as_long_as_the_closed_solution_says() {
    for v in [0.02, 0.05, 0.1] {
        // The relay feels the slip when it has reached v_relay, sqrt(2 v_relay m / (k v)) after it began.
        let late = (2.0 * 1e-9 * 2.0 / (K * v)).sqrt();
        assert!(error(v, 1e-9) < 3.0 * late, "{v} m/s: {} {late}", error(v, 1e-9));
        // A hundredth of the speed, a tenth of the delay.
        let ratio = error(v, 1e-5) / error(v, 1e-7);
        assert!((9.0..11.0).contains(&ratio), "{v} m/s: {ratio}");
    }
}

#[test]
fn the_spring_is_stretched_as_far_as_the_closed_solution_says() {
    let trace = run(STEM, &[("v_relay", 1e-9)], 5.0);
    let most = trace.track("x").unwrap().courses[0].most.volts * STRETCH;
    let swing = ((FS - FK) / K).hypot(0.05 / OMEGA);
    // The relay is late by sqrt(2 v_relay m / (k v)), in which the belt goes a micrometre.
    let late = (2.0 * 1e-9 * 2.0 / (K * 0.05)).sqrt() * 0.05;
    let expected = FK / K + swing;
    assert!((most - expected).abs() < 1.5 * late, "{most} {expected}");
}

#[test]
fn while_it_sticks_it_does_not_creep() {
    let program = program(STEM, &[]);
    for time in [0.3, 0.999, 1.5, 2.1, 2.7] {
        let machine = ran(&program, step_of(STEM), time);
        assert_eq!(voltage(&machine, "A1"), 0.0, "after {time} s");
    }
}

#[test]
fn with_one_friction_for_both_it_swings_evenly() {
    // x = F / k + v / omega sin(omega t): it touches the belt's velocity once a turn, and is not caught.
    let program = program(STEM, &[("Fs", FK)]);
    let mut machine = ran(&program, step_of(STEM), 0.7);
    let middle = |machine: &Machine<'_>| voltage(machine, "B1") * STRETCH - FK / K;
    let first = next_rise(&mut machine, middle);
    let turn = next_rise(&mut machine, middle) - first;
    assert!((turn - TAU / OMEGA).abs() < 1e-6, "{turn}");
}
