//! The order of convergence: 4 on smooth patches, and 4 if located events join smooth stretches.
//! crates/core/tests/problems.rs tests the order on the problems with known solutions.

use std::f64::consts::TAU;

use crate::common::{
    built, convergence_order, dead_zone_oscillator, element, program, root, run_for, slideway, source,
    voltage, volts,
};
use patchcord_core::ir::Program;
use patchcord_core::solve::Machine;

/// Steps in seconds, each half as long as the one before.
const STEPS: [f64; 5] = [0.05, 0.025, 0.0125, 0.00625, 0.003125];
/// Instants of comparison in seconds. None is a multiple of a step, so each run ends with a partial step.
const INSTANTS: [f64; 5] = [1.01, 1.93, 2.81, 3.47, 4.39];

/// The largest error of an element's voltage over the instants, for each step.
fn errors(program: &Program, name: &str, expected: impl Fn(f64) -> f64) -> [f64; 5] {
    let error = |step: f64, time: f64| (voltage(&run_for(program, step, time), name) - expected(time)).abs();
    STEPS.map(|step| INSTANTS.iter().map(|time| error(step, *time)).fold(0.0, f64::max))
}

/// Asserts that the error of an element's voltage is of order 4.
fn assert_order_4(program: &Program, name: &str, expected: impl Fn(f64) -> f64) {
    let found = errors(program, name, expected);
    let observed = convergence_order(&STEPS, &found);
    assert!((3.9..=4.1).contains(&observed), "order {observed} of {name} from {found:?}");
}

/// x'' = -4 x - 0.4 x', released from 50 V.
#[test]
fn a_damped_oscillator_has_order_4() {
    let builder = volts("damped oscillator")
        .element("A1", element("integrator").cords("x4", ["A2"]).cords("x0.4", ["A1"]))
        .element("S1", element("summer").cords("x1", ["A1"]))
        .element("A2", element("integrator").cords("x1", ["S1"]).set("initial", 50));
    let omega = (4.0f64 - 0.04).sqrt();
    assert_order_4(&built(builder), "A2", |time| {
        let (sine, cosine) = (omega * time).sin_cos();
        50.0 * (-0.2 * time).exp() * (cosine + 0.2 / omega * sine)
    });
}

/// Four equal lags in series, the first at 50 V. The last is 50 t^3 / 3! e^-t, inverted three times.
#[test]
fn a_chain_of_lags_has_order_4() {
    let lag = |input: &str, output: &str| element("integrator").cords("x1", [input, output]);
    let builder = volts("chain")
        .element("A1", element("integrator").cords("x1", ["A1"]).set("initial", 50))
        .element("A2", lag("A1", "A2"))
        .element("A3", lag("A2", "A3"))
        .element("A4", lag("A3", "A4"));
    assert_order_4(&built(builder), "A4", |time| -50.0 * time.powi(3) / 6.0 * (-time).exp());
}

/// x' = -x - 40 sin(2 pi t / 3).
#[test]
fn a_lag_driven_by_a_sine_has_order_4() {
    let sine = element("sine").set("amplitude", 40).set("frequency", "1 / 3");
    let builder = volts("driven lag")
        .drive("u", "volt", sine)
        .element("A1", element("integrator").cords("x1", ["A1", "u"]));
    let omega = TAU / 3.0;
    assert_order_4(&built(builder), "A1", |time| {
        let (sine, cosine) = (omega * time).sin_cos();
        -40.0 / (1.0 + omega * omega) * (sine - omega * cosine + omega * (-time).exp())
    });
}

/// x' = -x - u, where u is a table whose corners are not at ends of steps.
#[test]
fn a_lag_driven_by_a_table_has_order_4() {
    let points = serde_json::json!([[0.313, 0], [1.271, 30], [1.277, -30]]);
    let builder = volts("driven lag")
        .drive("u", "volt", element("table").set("points", points))
        .element("A1", element("integrator").cords("x1", ["A1", "u"]).set("initial", 50));
    assert_order_4(&built(builder), "A1", |time| {
        // The response to a ramp of slope 1 from t = 0 is t - 1 + exp(-t).
        let ramp = |elapsed: f64| if elapsed > 0.0 { elapsed - 1.0 + (-elapsed).exp() } else { 0.0 };
        let (up, down) = (30.0 / (1.271 - 0.313), -60.0 / (1.277 - 1.271));
        let response = up * ramp(time - 0.313) + (down - up) * ramp(time - 1.271) - down * ramp(time - 1.277);
        50.0 * (-time).exp() - response
    });
}

/// A ball that falls with viscous drag, v' = -g - c v and h' = v, and bounces with a restitution.
struct DraggedBall {
    gravity: f64,
    drag: f64,
    restitution: f64,
}

impl DraggedBall {
    /// Velocity and height after a time in free fall.
    fn free_fall(&self, velocity: f64, height: f64, time: f64) -> (f64, f64) {
        let (terminal, decay) = (-self.gravity / self.drag, (-self.drag * time).exp());
        let speed = terminal + (velocity - terminal) * decay;
        (speed, height + terminal * time + (velocity - terminal) * (1.0 - decay) / self.drag)
    }

    /// Velocity and height at `time` after a release from `height` at rest.
    fn at(&self, height: f64, time: f64) -> (f64, f64) {
        let (mut velocity, mut height, mut remaining) = (0.0, height, time);
        loop {
            let apex = (1.0 + velocity * self.drag / self.gravity).ln() / self.drag;
            let (_, top) = self.free_fall(velocity, height, apex);
            let longest = apex + (2.0 * top / self.gravity).sqrt() * 2.0;
            let contact = root(|time| self.free_fall(velocity, height, time).1, apex, longest);
            if contact >= remaining {
                return self.free_fall(velocity, height, remaining);
            }
            velocity = -self.restitution * self.free_fall(velocity, height, contact).0;
            (height, remaining) = (0.0, remaining - contact);
        }
    }
}

#[test]
fn a_bouncing_ball_with_drag_has_order_4() {
    let builder = volts("dragged ball")
        .element("PG", element("pot").cord("in", "+100").set("setting", 0.5))
        .element(
            "A1",
            element("integrator").cords("x1", ["PG", "A1"]).cords("gap", ["B1"]).set("restitution", 0.9),
        )
        .element("A2", element("integrator").cords("x1", ["A1"]).set("initial", -30))
        .element("B1", element("summer").cords("x1", ["A2"]));
    let ball = DraggedBall { gravity: 50.0, drag: 1.0, restitution: 0.9 };
    assert_order_4(&built(builder), "B1", |time| ball.at(30.0, time).1);
}

/// x'' = -4 dz(x) with a dead zone dz of ±10 V: straight lines of 30 V/s between half swings of 15 V.
#[test]
fn an_oscillator_with_a_dead_zone_has_order_4() {
    let (line, swing) = (20.0 / 30.0, TAU / 4.0);
    assert_order_4(&dead_zone_oscillator(), "A2", |time| {
        let elapsed = time + line / 2.0;
        let halves = (elapsed / (line + swing)).floor();
        let sign = if halves.rem_euclid(2.0) == 0.0 { 1.0 } else { -1.0 };
        let in_half = elapsed - halves * (line + swing);
        sign * if in_half < line {
            -10.0 + 30.0 * in_half
        } else {
            10.0 + 15.0 * (2.0 * (in_half - line)).sin()
        }
    });
}

/// x' = -x + min(160 t, 100) / 2: a summer that is overloaded from 0.625 s on.
#[test]
fn a_lag_after_an_overloaded_amplifier_has_order_4() {
    let builder = volts("clipped")
        .drive("u", "volt", element("ramp").set("rate", 40))
        .element("S1", element("summer").cords("x4", ["u"]))
        .element("A1", element("integrator").cords("x1", ["A1"]).cords("x0.5", ["S1"]));
    // The response to a ramp of slope 1 from t = 0 is t - 1 + exp(-t).
    let ramp = |elapsed: f64| if elapsed > 0.0 { elapsed - 1.0 + (-elapsed).exp() } else { 0.0 };
    assert_order_4(&built(builder), "A1", |time| 80.0 * (ramp(time) - ramp(time - 0.625)));
}

/// x' = -x + u / 2, u = 160 t up to 1 s and then back, limited to 100 V from 0.625 s to 1.375 s.
#[test]
fn a_lag_after_a_temporarily_overloaded_amplifier_has_order_4() {
    let builder = volts("clipped for a while")
        .drive("u", "volt", element("ramp").set("rate", 40).set("turn", 1))
        .element("S1", element("summer").cords("x4", ["u"]))
        .element("A1", element("integrator").cords("x1", ["A1"]).cords("x0.5", ["S1"]));
    let ramp = |elapsed: f64| if elapsed > 0.0 { elapsed - 1.0 + (-elapsed).exp() } else { 0.0 };
    assert_order_4(&built(builder), "A1", |time| {
        80.0 * (ramp(time) - ramp(time - 0.625) - ramp(time - 1.375) + ramp(time - 2.625))
    });
}

/// x' = -x - min(20 t, 25).
#[test]
fn a_lag_after_a_diode_lower_of_has_order_4() {
    let builder = source(volts("lower of two"), "level", 25.0)
        .drive("u", "volt", element("ramp").set("rate", 20))
        .element("L", element("diode-lower-of").set("in", serde_json::json!(["u", "level"])))
        .element("A1", element("integrator").cords("x1", ["A1", "L"]));
    let ramp = |elapsed: f64| if elapsed > 0.0 { elapsed - 1.0 + (-elapsed).exp() } else { 0.0 };
    assert_order_4(&built(builder), "A1", |time| -20.0 * (ramp(time) - ramp(time - 1.25)));
}

/// x' = -x - k. k is 30 V from the time at which 20 t exceeds 40 sin(2 pi t / 4) by 5 V until it is 5 V below.
#[test]
fn a_lag_after_a_comparator_has_order_4() {
    let (rising, wave) = (element("ramp").set("rate", 20), element("sine").set("amplitude", 40));
    let relay =
        element("relay").cord("in", "u").cord("against", "w").cord("on", "level").cord("off", "ground");
    let builder = source(volts("comparator"), "level", 30.0)
        .drive("u", "volt", rising)
        .drive("w", "volt", wave.set("frequency", "1 / 4"))
        .element("K", relay.set("pull_in", 5).set("drop_out", -5))
        .element("A1", element("integrator").cords("x1", ["A1", "K"]));
    let above = |time: f64| 20.0 * time - 40.0 * (TAU * time / 4.0).sin();
    let pulled_in = root(|time| above(time) - 5.0, 1.0, 3.0);
    assert_order_4(&built(builder), "A1", |time| {
        if time > pulled_in { -30.0 * (1.0 - (pulled_in - time).exp()) } else { 0.0 }
    });
}

/// x' = -x - |40 sin(2 t)|: in every half period the response to a sine that begins at 0.
#[test]
fn a_lag_after_a_rectifier_has_order_4() {
    let builder = volts("rectifier")
        .drive("u", "volt", element("sine").set("amplitude", 40).set("frequency", "1 / pi"))
        .element("AB", element("absolute").cord("in", "u"))
        .element("A1", element("integrator").cords("x1", ["A1", "AB"]));
    let response = |start: f64, elapsed: f64| {
        let ((sine, cosine), decay) = ((2.0 * elapsed).sin_cos(), (-elapsed).exp());
        start * decay - 40.0 / 5.0 * (sine - 2.0 * cosine + 2.0 * decay)
    };
    assert_order_4(&built(builder), "A1", |time| {
        let half = TAU / 4.0;
        let halves = (time / half).floor();
        let start = (0..halves as usize).fold(0.0, |start, _| response(start, half));
        response(start, time - halves * half)
    });
}

/// x' = -x - f(u) with three straight segments f and a ramp u of 20 V/s that reaches their corners at 1 s and 2 s.
#[test]
fn a_lag_after_a_function_generator_has_order_4() {
    let points = serde_json::json!([[0, 0], [20, 10], [40, -20], [60, 0]]);
    let builder = volts("generator")
        .drive("u", "volt", element("ramp").set("rate", 20))
        .element("FG", element("function-generator").cord("in", "u").set("points", points))
        .element("A1", element("integrator").cords("x1", ["A1", "FG"]));
    let ramp = |elapsed: f64| if elapsed > 0.0 { elapsed - 1.0 + (-elapsed).exp() } else { 0.0 };
    assert_order_4(&built(builder), "A1", |time| {
        -10.0 * ramp(time) + 40.0 * ramp(time - 1.0) - 50.0 * ramp(time - 2.0)
    });
}

/// Stick-slip of Fig 8.16 over its first 2 s has 484 kinks, most of them in the dead zone of its friction.
#[test]
fn stick_slip_of_fig_8_16_has_order_4() {
    let program = program(&slideway(), &[]);
    let instants: Vec<f64> = (1..=200).map(|hundredth| f64::from(hundredth) / 100.0).collect();
    let samples = |mut machine: Machine<'_>| -> Vec<f64> {
        let sample = |instant: &f64| {
            machine.operate(instant - machine.time()).unwrap();
            voltage(&machine, "B3")
        };
        instants.iter().map(sample).collect()
    };
    let exact = samples(Machine::adaptive(&program, 1e-11, 2e-5).unwrap());
    let steps = [2e-4, 1e-4, 5e-5, 2.5e-5];
    let errors = steps.map(|step| {
        let found = samples(Machine::new(&program, step).unwrap());
        found.iter().zip(&exact).map(|(found, exact)| (found - exact).abs()).fold(0.0, f64::max)
    });
    let observed = convergence_order(&steps, &errors);
    assert!((3.9..=4.1).contains(&observed), "order {observed} from {errors:?}");
}
