//! Delay lines: what went in comes out later; a delayed feedback by the method of steps.

mod common;

use std::f64::consts::TAU;

use common::{built, check_derivatives, element, order, patch, program, ran, voltage, volts};

const X0: f64 = 50.0;

/// x' = -x(t - T), x = X0 before 0: one more power of t in every delay (Bellman and Cooke 1963).
fn by_steps(delay: f64, time: f64) -> f64 {
    let mut factorial = 1.0;
    let mut total = 0.0;
    for k in 0..=(time / delay).floor() as i32 + 1 {
        factorial *= f64::from(k.max(1));
        total += (-(time - f64::from(k - 1) * delay)).powi(k) / factorial;
    }
    X0 * total
}

#[test]
fn a_sine_comes_out_as_it_went_in() {
    let program = program(&patch("delay-line"), &[("tone", 0.4)]);
    let mut machine = ran(&program, 1e-2, 0.0);
    for _ in 0..500 {
        machine.operate(0.0137).unwrap();
        let late = machine.time() - 1.0;
        let expected = if late < 0.0 { 0.0 } else { 80.0 * (TAU * 0.4 * late).sin() };
        // A cubic through samples 1e-2 s apart: 3/128 (omega h)^4 of 80 V, 8e-7 V.
        assert!((voltage(&machine, "D1") - expected).abs() < 1e-6, "{}", voltage(&machine, "D1") - expected);
    }
}

fn worst(delay: f64, step: f64) -> f64 {
    let program = program(&patch("delay-line"), &[("T", delay)]);
    let mut machine = ran(&program, step, 0.0);
    let mut worst = 0.0f64;
    while machine.time() < 6.0 {
        machine.operate(20.0 * step).unwrap();
        worst = worst.max((voltage(&machine, "A1") - by_steps(delay, machine.time())).abs());
    }
    worst
}

#[test]
fn delayed_feedback_follows_the_method_of_steps() {
    let steps = [4e-2, 2e-2, 1e-2, 5e-3];
    // A delay of whole steps, and one that is not: echoes fall between the steps there.
    for (delay, bound) in [(1.0, 1e-8), (0.777, 1e-8)] {
        let errors = steps.map(|step| worst(delay, step));
        assert!(errors[2] < bound, "{delay} {errors:?}");
        // Off the grid the stops at echoes fall differently with every step, which scatters the slope.
        let reached = order(&steps, &errors);
        assert!((3.8..4.3).contains(&reached), "{delay} {reached} {errors:?}");
    }
}

#[test]
fn a_jump_comes_out_as_a_jump_wherever_it_falls() {
    // The ramp that an integrator makes of a late step of 10 V is exact, whatever the step of the solver.
    let builder = volts("late step").drive("u", "volt", element("step").set("height", 10).set("at", 0.123));
    let builder = builder.element("D1", element("delay").cord("in", "u").set("delay", 0.777));
    let late = built(builder.element("A1", element("integrator").cords("x1", ["D1"])));
    for step in [1e-3, 0.04, 0.7] {
        let machine = ran(&late, step, 2.0);
        assert!((voltage(&machine, "A1") + 11.0).abs() < 1e-11, "{step} {}", voltage(&machine, "A1") + 11.0);
    }
}

#[test]
fn derivatives_agree_before_and_after_the_first_echo() {
    check_derivatives(&program(&patch("delay-line"), &[]), 1e-2, &[0.555, 1.555, 3.333]);
}
