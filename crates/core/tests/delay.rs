//! Delay lines: delayed sines and jumps, and delayed feedback compared with the method of steps.

use std::f64::consts::TAU;

use crate::common::{
    built, check_derivatives, convergence_order, element, patch, program, run_for, voltage, volts,
};

/// Voltage before t = 0.
const X0: f64 = 50.0;

/// x' = -x(t - T) with x = X0 before 0. The solution gains one power of t in every delay (Bellman and Cooke 1963).
fn method_of_steps(delay: f64, time: f64) -> f64 {
    let mut factorial = 1.0;
    let mut total = 0.0;
    for k in 0..=(time / delay).floor() as i32 + 1 {
        factorial *= f64::from(k.max(1));
        total += (-(time - f64::from(k - 1) * delay)).powi(k) / factorial;
    }
    X0 * total
}

#[test]
fn a_delayed_sine_keeps_its_shape() {
    let program = program(&patch("delay-line"), &[("tone", 0.4)]);
    let mut machine = run_for(&program, 1e-2, 0.0);
    for _ in 0..500 {
        machine.operate(0.0137).unwrap();
        let delayed_time = machine.time() - 1.0;
        let expected = if delayed_time < 0.0 { 0.0 } else { 80.0 * (TAU * 0.4 * delayed_time).sin() };
        // A cubic through samples 1e-2 s apart: 3/128 (omega h)^4 of 80 V, 8e-7 V.
        assert!((voltage(&machine, "D1") - expected).abs() < 1e-6, "{}", voltage(&machine, "D1") - expected);
    }
}

/// The largest error of the delayed feedback in V.
fn largest_error(delay: f64, step: f64) -> f64 {
    let program = program(&patch("delay-line"), &[("T", delay)]);
    let mut machine = run_for(&program, step, 0.0);
    let mut largest = 0.0f64;
    while machine.time() < 6.0 {
        machine.operate(20.0 * step).unwrap();
        largest = largest.max((voltage(&machine, "A1") - method_of_steps(delay, machine.time())).abs());
    }
    largest
}

#[test]
fn delayed_feedback_follows_the_method_of_steps() {
    let steps = [4e-2, 2e-2, 1e-2, 5e-3];
    // A delay of whole steps and one of a fraction. With the second, delayed corners are within steps.
    for (delay, bound) in [(1.0, 1e-8), (0.777, 1e-8)] {
        let errors = steps.map(|step| largest_error(delay, step));
        assert!(errors[2] < bound, "{delay} {errors:?}");
        // Within steps the positions of delayed corners differ between step sizes, so the observed order varies.
        let observed = convergence_order(&steps, &errors);
        assert!((3.8..4.3).contains(&observed), "{delay} {observed} {errors:?}");
    }
}

#[test]
fn a_delayed_jump_stays_a_jump_at_every_step_size() {
    // The integral of a delayed step of 10 V is exact at every step size of the solver.
    let builder =
        volts("delayed step").drive("u", "volt", element("step").set("height", 10).set("at", 0.123));
    let builder = builder.element("D1", element("delay").cord("in", "u").set("delay", 0.777));
    let delayed = built(builder.element("A1", element("integrator").cords("x1", ["D1"])));
    for step in [1e-3, 0.04, 0.7] {
        let machine = run_for(&delayed, step, 2.0);
        assert!((voltage(&machine, "A1") + 11.0).abs() < 1e-11, "{step} {}", voltage(&machine, "A1") + 11.0);
    }
}

#[test]
fn derivatives_agree_before_and_after_the_first_delay() {
    check_derivatives(&program(&patch("delay-line"), &[]), 1e-2, &[0.555, 1.555, 3.333]);
}

#[test]
fn a_delay_can_be_decreased_and_increased_during_a_run() {
    // A separate oscillator of two integrators is unaffected: 50 cos(10 t).
    let builder = volts("changed").parameter("T", 1.0, "s", [0.1, 2.0]);
    let builder = builder.element("D1", element("delay").cord("in", "A1").set("delay", "T"));
    let builder = builder.element("A1", element("integrator").cords("x1", ["D1"]).set("initial", 1));
    let builder = builder.element("A2", element("integrator").cords("x10", ["B1"]).set("initial", 50));
    let builder = builder.element("A3", element("integrator").cords("x10", ["A2"]));
    let program = built(builder.element("B1", element("summer").cords("x1", ["A3"])));
    let mut machine = run_for(&program, 1e-3, 0.5);
    for delay in [0.3, 1.5, 0.2] {
        machine.set_parameter("T", delay).unwrap();
        machine.operate(0.4).unwrap();
    }
    let expected = 50.0 * (10.0 * machine.time()).cos();
    assert!((machine.time() - 1.7).abs() < 1e-12);
    assert!((voltage(&machine, "A2") - expected).abs() < 1e-6, "{} {expected}", voltage(&machine, "A2"));
}

#[test]
fn delayed_copies_of_a_smooth_signal_do_not_limit_steps() {
    let builder =
        volts("comb").drive("u", "volt", element("sine").set("amplitude", 10).set("frequency", 0.3));
    let delays = [("D1", "u", 0.37), ("D2", "D1", 0.51), ("D3", "D2", 0.29), ("D4", "D3", 0.83)];
    let builder = delays.iter().fold(builder, |builder, (name, from, delay)| {
        builder.element(name, element("delay").cord("in", from).set("delay", *delay))
    });
    let program = built(builder.element("A1", element("integrator").cords("x1", ["D1", "D2", "D3", "D4"])));
    let steps = run_for(&program, 1e-2, 40.0).work().steps;
    // The corner at t = 0 reaches the outputs a few times. After that no discontinuity limits the steps.
    assert!(steps < 4_100, "{steps}");
}
