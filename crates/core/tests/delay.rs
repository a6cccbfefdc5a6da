//! Delay lines: what went in comes out later; a delayed feedback by the method of steps.

use std::f64::consts::TAU;

use crate::common::{built, check_derivatives, element, order, patch, program, ran, voltage, volts};

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

#[test]
fn a_delay_may_be_turned_down_and_up_while_the_machine_runs() {
    // An oscillator beside the line must not notice: 50 cos(10 t) from two integrators.
    let builder = volts("turned").parameter("T", 1.0, "s", [0.1, 2.0]);
    let builder = builder.element("D1", element("delay").cord("in", "A1").set("delay", "T"));
    let builder = builder.element("A1", element("integrator").cords("x1", ["D1"]).set("initial", 1));
    let builder = builder.element("A2", element("integrator").cords("x10", ["B1"]).set("initial", 50));
    let builder = builder.element("A3", element("integrator").cords("x10", ["A2"]));
    let program = built(builder.element("B1", element("summer").cords("x1", ["A3"])));
    let mut machine = ran(&program, 1e-3, 0.5);
    for delay in [0.3, 1.5, 0.2] {
        machine.set("T", delay).unwrap();
        machine.operate(0.4).unwrap();
    }
    let wanted = 50.0 * (10.0 * machine.time()).cos();
    assert!((machine.time() - 1.7).abs() < 1e-12);
    assert!((voltage(&machine, "A2") - wanted).abs() < 1e-6, "{} {wanted}", voltage(&machine, "A2"));
}

#[test]
fn a_smooth_signal_has_no_echoes() {
    let builder =
        volts("comb").drive("u", "volt", element("sine").set("amplitude", 10).set("frequency", 0.3));
    let delays = [("D1", "u", 0.37), ("D2", "D1", 0.51), ("D3", "D2", 0.29), ("D4", "D3", 0.83)];
    let builder = delays.iter().fold(builder, |builder, (name, from, delay)| {
        builder.element(name, element("delay").cord("in", from).set("delay", *delay))
    });
    let program = built(builder.element("A1", element("integrator").cords("x1", ["D1", "D2", "D3", "D4"])));
    let steps = ran(&program, 1e-2, 40.0).work().steps;
    // The corner at t = 0 comes out of every line a few times; after that nothing is left to stop for.
    assert!(steps < 4_100, "{steps}");
}
