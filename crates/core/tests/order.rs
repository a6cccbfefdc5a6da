//! The order of convergence: 4 on smooth patches, and 4 where smooth stretches are joined by located changes; that of the
//! problems with known solutions is looked at in crates/core/tests/known.rs.

use std::f64::consts::TAU;

use crate::common::{built, element, order, play, program, ran, root, slideway, source, voltage, volts};
use patchcord_core::ir::Program;
use patchcord_core::solve::Machine;

const STEPS: [f64; 5] = [0.05, 0.025, 0.0125, 0.00625, 0.003125];
/// Not multiples of any step: the run up to each ends with a part of one.
const INSTANTS: [f64; 5] = [1.01, 1.93, 2.81, 3.47, 4.39];

/// The largest errors of an element's voltage over the instants, down the ladder of steps.
fn errors(program: &Program, name: &str, expected: impl Fn(f64) -> f64) -> [f64; 5] {
    let error = |step: f64, time: f64| (voltage(&ran(program, step, time), name) - expected(time)).abs();
    STEPS.map(|step| INSTANTS.iter().map(|time| error(step, *time)).fold(0.0, f64::max))
}

fn assert_order_4(program: &Program, name: &str, expected: impl Fn(f64) -> f64) {
    let found = errors(program, name, expected);
    let reached = order(&STEPS, &found);
    assert!((3.9..=4.1).contains(&reached), "order {reached} of {name} from {found:?}");
}

/// x'' = -4 x - 0.4 x', released from 50 V.
#[test]
fn damped_oscillator() {
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

/// Four equal lags in a row, the first at 50 V: 50 t^3 / 3! e^-t at the last, inverted three times.
#[test]
fn chain_of_lags() {
    let lag = |from: [&str; 1], own: &str| element("integrator").cords("x1", [from[0], own]);
    let builder = volts("chain")
        .element("A1", element("integrator").cords("x1", ["A1"]).set("initial", 50))
        .element("A2", lag(["A1"], "A2"))
        .element("A3", lag(["A2"], "A3"))
        .element("A4", lag(["A3"], "A4"));
    assert_order_4(&built(builder), "A4", |time| -50.0 * time.powi(3) / 6.0 * (-time).exp());
}

/// x' = -x - 40 sin(2 pi t / 3).
#[test]
fn lag_driven_by_a_sine() {
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

/// x' = -x - u, u the straight lines of a table whose corners fall on no step.
#[test]
fn lag_driven_by_a_table() {
    let points = serde_json::json!([[0.313, 0], [1.271, 30], [1.277, -30]]);
    let builder = volts("driven lag")
        .drive("u", "volt", element("table").set("points", points))
        .element("A1", element("integrator").cords("x1", ["A1", "u"]).set("initial", 50));
    assert_order_4(&built(builder), "A1", |time| {
        // The answer to a ramp of slope 1 that begins at t = 0 is t - 1 + exp(-t).
        let ramp = |since: f64| if since > 0.0 { since - 1.0 + (-since).exp() } else { 0.0 };
        let (up, down) = (30.0 / (1.271 - 0.313), -60.0 / (1.277 - 1.271));
        let answer = up * ramp(time - 0.313) + (down - up) * ramp(time - 1.271) - down * ramp(time - 1.277);
        50.0 * (-time).exp() - answer
    });
}

/// A ball falling through drag that follows its velocity: v' = -g - c v, h' = v, bounces e.
struct DraggedBall {
    gravity: f64,
    drag: f64,
    restitution: f64,
}

impl DraggedBall {
    fn flight(&self, velocity: f64, height: f64, time: f64) -> (f64, f64) {
        let (last, gone) = (-self.gravity / self.drag, (-self.drag * time).exp());
        let speed = last + (velocity - last) * gone;
        (speed, height + last * time + (velocity - last) * (1.0 - gone) / self.drag)
    }

    fn at(&self, height: f64, until: f64) -> (f64, f64) {
        let (mut velocity, mut height, mut left) = (0.0, height, until);
        loop {
            let apex = (1.0 + velocity * self.drag / self.gravity).ln() / self.drag;
            let (_, top) = self.flight(velocity, height, apex);
            let longest = apex + (2.0 * top / self.gravity).sqrt() * 2.0;
            let contact = root(|time| self.flight(velocity, height, time).1, apex, longest);
            if contact >= left {
                return self.flight(velocity, height, left);
            }
            velocity = -self.restitution * self.flight(velocity, height, contact).0;
            (height, left) = (0.0, left - contact);
        }
    }
}

#[test]
fn bounces_joined_by_flight_with_drag() {
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

/// x'' = -4 dz(x), dz a dead zone of ±10 V: level flight at 30 V/s between half swings of 15 V.
#[test]
fn half_swings_joined_by_a_dead_zone() {
    let (flight, swing) = (20.0 / 30.0, TAU / 4.0);
    assert_order_4(&play(), "A2", |time| {
        let since = time + flight / 2.0;
        let halves = (since / (flight + swing)).floor();
        let sign = if halves.rem_euclid(2.0) == 0.0 { 1.0 } else { -1.0 };
        let gone = since - halves * (flight + swing);
        sign * if gone < flight { -10.0 + 30.0 * gone } else { 10.0 + 15.0 * (2.0 * (gone - flight)).sin() }
    });
}

/// x' = -x + min(160 t, 100) / 2: a summer that is asked for more than 100 V from 0.625 s on.
#[test]
fn lag_behind_an_amplifier_that_is_clipped() {
    let builder = volts("clipped")
        .drive("u", "volt", element("ramp").set("rate", 40))
        .element("S1", element("summer").cords("x4", ["u"]))
        .element("A1", element("integrator").cords("x1", ["A1"]).cords("x0.5", ["S1"]));
    // The answer to a ramp of slope 1 that begins at t = 0 is t - 1 + exp(-t).
    let ramp = |since: f64| if since > 0.0 { since - 1.0 + (-since).exp() } else { 0.0 };
    assert_order_4(&built(builder), "A1", |time| 80.0 * (ramp(time) - ramp(time - 0.625)));
}

/// x' = -x + u / 2, u = 160 t up to 1 s and then back, between -100 V and 100 V: it leaves 100 V at 1.375 s.
#[test]
fn lag_behind_an_amplifier_that_is_clipped_for_a_while() {
    let builder = volts("clipped for a while")
        .drive("u", "volt", element("ramp").set("rate", 40).set("turn", 1))
        .element("S1", element("summer").cords("x4", ["u"]))
        .element("A1", element("integrator").cords("x1", ["A1"]).cords("x0.5", ["S1"]));
    let ramp = |since: f64| if since > 0.0 { since - 1.0 + (-since).exp() } else { 0.0 };
    assert_order_4(&built(builder), "A1", |time| {
        80.0 * (ramp(time) - ramp(time - 0.625) - ramp(time - 1.375) + ramp(time - 2.625))
    });
}

/// x' = -x - min(20 t, 25).
#[test]
fn lag_behind_the_lower_of_two() {
    let builder = source(volts("lower of two"), "level", 25.0)
        .drive("u", "volt", element("ramp").set("rate", 20))
        .element("L", element("diode-lower-of").set("in", serde_json::json!(["u", "level"])))
        .element("A1", element("integrator").cords("x1", ["A1", "L"]));
    let ramp = |since: f64| if since > 0.0 { since - 1.0 + (-since).exp() } else { 0.0 };
    assert_order_4(&built(builder), "A1", |time| -20.0 * (ramp(time) - ramp(time - 1.25)));
}

/// x' = -x - k, k = 30 V while 20 t lies above 40 sin(2 pi t / 4) by 5 V or more, until it lies below by 5 V.
#[test]
fn lag_behind_a_comparator() {
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

/// x' = -x - |40 sin(2 t)|: in every half period an answer to a sine that begins at 0.
#[test]
fn lag_behind_a_rectifier() {
    let builder = volts("rectifier")
        .drive("u", "volt", element("sine").set("amplitude", 40).set("frequency", "1 / pi"))
        .element("AB", element("absolute").cord("in", "u"))
        .element("A1", element("integrator").cords("x1", ["A1", "AB"]));
    let answer = |from: f64, since: f64| {
        let ((sine, cosine), gone) = ((2.0 * since).sin_cos(), (-since).exp());
        from * gone - 40.0 / 5.0 * (sine - 2.0 * cosine + 2.0 * gone)
    };
    assert_order_4(&built(builder), "A1", |time| {
        let half = TAU / 4.0;
        let halves = (time / half).floor();
        let from = (0..halves as usize).fold(0.0, |from, _| answer(from, half));
        answer(from, time - halves * half)
    });
}

/// x' = -x - f(u), f three straight segments, u a ramp of 20 V/s that meets their corners at 1 s and 2 s.
#[test]
fn lag_behind_a_function_generator() {
    let points = serde_json::json!([[0, 0], [20, 10], [40, -20], [60, 0]]);
    let builder = volts("generator")
        .drive("u", "volt", element("ramp").set("rate", 20))
        .element("FG", element("function-generator").cord("in", "u").set("points", points))
        .element("A1", element("integrator").cords("x1", ["A1", "FG"]));
    let ramp = |since: f64| if since > 0.0 { since - 1.0 + (-since).exp() } else { 0.0 };
    assert_order_4(&built(builder), "A1", |time| {
        -10.0 * ramp(time) + 40.0 * ramp(time - 1.0) - 50.0 * ramp(time - 2.0)
    });
}

/// Stick-slip of Fig 8.16 over its first 2 s: 484 kinks, most of them of the dead zone that is its friction.
#[test]
fn stick_slip_of_fig_8_16() {
    let program = program(&slideway(), &[]);
    let instants: Vec<f64> = (1..=200).map(|hundredth| f64::from(hundredth) / 100.0).collect();
    let course = |mut machine: Machine<'_>| -> Vec<f64> {
        let at = |instant: &f64| {
            machine.operate(instant - machine.time()).unwrap();
            voltage(&machine, "B3")
        };
        instants.iter().map(at).collect()
    };
    let exact = course(Machine::adaptive(&program, 1e-11, 2e-5).unwrap());
    let steps = [2e-4, 1e-4, 5e-5, 2.5e-5];
    let errors = steps.map(|step| {
        let found = course(Machine::new(&program, step).unwrap());
        found.iter().zip(&exact).map(|(found, exact)| (found - exact).abs()).fold(0.0, f64::max)
    });
    let reached = order(&steps, &errors);
    assert!((3.9..=4.1).contains(&reached), "order {reached} from {errors:?}");
}
