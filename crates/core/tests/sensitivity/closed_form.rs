//! Derivatives with a known closed form.

use std::f64::consts::PI;

use crate::common::{built, convergence_order, element, patch, program, volts};
use crate::sensitivity::comparison::Case;
use patchcord_core::ir::Program;
use patchcord_core::solve::Machine;

/// The derivatives of an element's voltage by parameters at a time, with equal steps.
fn derivatives(program: &Program, step: f64, time: f64, element: &str, by: &[&str]) -> Vec<f64> {
    let mut machine = Machine::new(program, step).unwrap();
    machine.differentiate(by).unwrap();
    machine.operate(time).unwrap();
    by.iter().map(|name| machine.sensitivity(element, name).unwrap()).collect()
}

fn assert_near(found: &[f64], expected: &[f64], allowed: f64, context: &str) {
    for (found, expected) in found.iter().zip(expected) {
        assert!((found - expected).abs() <= allowed, "{context}: {found}, expected {expected}");
    }
}

/// x = x0 e^(-a t) has the derivative -t x by the rate and e^(-a t) by the initial value.
#[test]
fn a_decay_is_differentiated_by_its_rate_and_initial_value() {
    let decay = built(
        volts("decay")
            .parameter("a", 2.0, "1/s", [0.1, 10.0])
            .parameter("start", 0.08, "kV", [0.001, 0.099])
            .element("A1", element("integrator").cords("x10", ["P1"]).set("initial", "start"))
            .element("P1", element("pot").cord("in", "A1").set("setting", "a / 10")),
    );
    for time in [0.0, 0.3, 1.7] {
        let decay_factor = (-2.0f64 * time).exp();
        let found = derivatives(&decay, 1e-3, time, "A1", &["a", "start"]);
        assert_near(&found, &[-time * 80.0 * decay_factor, 1e3 * decay_factor], 1e-9, &format!("{time}"));
    }
}

/// The derivatives of the height by restitution and gravity. After a bounce with v at a time T the height is
/// v (t - T) - g (t - T)^2 / 2, where v and T follow the geometric series.
fn ball(e: f64, g: f64, time: f64) -> [f64; 2] {
    let (h0, first) = (1.0f64, (2.0 / g).sqrt());
    let (mut speed, mut begin) = ((2.0 * g * h0).sqrt(), -first);
    let (mut speed_by_e, mut begin_by_e) = (0.0, 0.0);
    while time > begin + 2.0 * speed / g {
        begin += 2.0 * speed / g;
        begin_by_e += 2.0 * speed_by_e / g;
        speed_by_e = e * speed_by_e + speed;
        speed *= e;
    }
    let elapsed = time - begin;
    let velocity = speed - g * elapsed;
    // Times are proportional to 1 / sqrt(g), velocities to sqrt(g).
    let by_g = 0.5 * speed / g * elapsed - 0.5 * elapsed * elapsed + 0.5 * begin / g * velocity;
    [speed_by_e * elapsed - velocity * begin_by_e, by_g]
}

#[test]
fn a_ball_is_differentiated_by_restitution_and_gravity() {
    let program = program(&patch("bouncing-ball"), &[]);
    for time in [0.2, 0.7, 1.3, 2.9, 3.6] {
        let [by_e, by_g] = ball(0.8, 9.81, time);
        let found = derivatives(&program, 1e-2, time, "B1", &["e", "g"]);
        // 0.02 m per volt.
        assert_near(&found, &[by_e / 0.02, by_g / 0.02], 1e-7, &format!("{time}"));
    }
}

#[test]
fn the_derivatives_of_a_ball_at_rest_are_0() {
    let program = program(&patch("bouncing-ball"), &[]);
    let found = derivatives(&program, 1e-2, 4.9, "A1", &["e", "g", "h0", "v_rest"]);
    assert_eq!(found, [0.0; 4]);
}

/// Dry friction: half swings x = +-(c + (42 - c - 2 c n) cos(2 t - n pi)), at rest after four.
#[test]
fn half_swings_are_differentiated_by_the_friction_level() {
    let block = built(
        volts("block")
            .parameter("level", 5.0, "V", [1.0, 20.0])
            .element("PF", element("pot").cord("in", "+100").set("setting", "level / 100 / volt"))
            .element("A1", element("integrator").cords("x4", ["A2"]).cords("brake_x4", ["PF"]))
            .element("S1", element("summer").cords("x1", ["A1"]))
            .element("A2", element("integrator").cords("x1", ["S1"]).set("initial", 42)),
    );
    for time in [0.4, 1.9, 3.7, 5.5, 9.0] {
        let halves = (2.0 * time / PI).floor().min(4.0);
        let sign = if halves.rem_euclid(2.0) == 0.0 { 1.0 } else { -1.0 };
        // The turning points are 42, -32, 22, -12, 2. The block rests at the last.
        let angle = (2.0 * time).min(4.0 * PI) - halves * PI;
        let expected = sign * (1.0 - (1.0 + 2.0 * halves) * angle.cos());
        let found = derivatives(&block, 1e-3, time, "A2", &["level"]);
        assert_near(&found, &[if halves == 4.0 { -8.0 } else { expected }], 1e-8, &format!("{time}"));
    }
}

/// A triangle wave of slope s between thresholds a and b. Its n-th corner is at (a + (n - 1) (a - b)) / s.
#[test]
fn a_relay_oscillator_is_differentiated_by_its_thresholds() {
    let program = program(&patch("relay-oscillator"), &[]);
    let (slope, high, low) = (80.0f64, 20.0f64, -10.0f64);
    for time in [0.1, 0.4, 0.8, 1.1, 2.3, 4.9] {
        let corners = if time < high / slope {
            0.0
        } else {
            1.0 + ((time - high / slope) * slope / (high - low)).floor()
        };
        let expected = if corners.rem_euclid(2.0) == 1.0 {
            [-time, 1.0 + corners, 1.0 - corners]
        } else {
            [time, -corners, corners]
        };
        let found = derivatives(&program, 1e-2, time, "A1", &["slope", "a_high", "a_low"]);
        assert_near(&found, &expected, 1e-9, &format!("{time}"));
    }
}

/// x' = -x(t - T) with x = x0 before 0. The solution gains a power of t - (k - 1) T in every delay.
#[test]
fn delayed_feedback_is_differentiated_by_its_delay() {
    let program = program(&patch("delay-line"), &[]);
    for time in [0.5, 1.5, 2.5, 3.7] {
        let mut factorial = 1.0;
        let mut expected = 0.0;
        for k in 1..=time as i32 + 1 {
            let since = -(time - f64::from(k - 1));
            expected += f64::from(k * (k - 1)) * since.powi(k - 1) / (factorial * f64::from(k));
            factorial *= f64::from(k);
        }
        let found = derivatives(&program, 5e-3, time, "A1", &["T"]);
        assert_near(&found, &[50.0 * expected], 1e-6, &format!("{time}"));
    }
}

/// At the limit the output follows it. After leaving the limit it keeps that derivative.
#[test]
fn an_integrator_is_differentiated_by_its_limit() {
    let limited = built(
        volts("limited")
            .parameter("top", 20.0, "V", [1.0, 90.0])
            .parameter("swing", 40.0, "V", [1.0, 90.0])
            .drive("u", "volt", element("sine").set("amplitude", "swing").set("frequency", "1 / (2 * pi)"))
            .element(
                "A1",
                element("integrator")
                    .cords("x1", ["u"])
                    .set("limit", serde_json::json!({"lower": "-top / volt"})),
            ),
    );
    // -40 (1 - cos t) reaches -20 at 60 degrees. The limit holds until the drive changes sign at 180 degrees.
    for (time, by_top, by_swing) in
        [(0.5, 0.0, 0.5f64.cos() - 1.0), (2.0, -1.0, 0.0), (4.0, -1.0, 1.0 + 4.0f64.cos())]
    {
        let found = derivatives(&limited, 1e-2, time, "A1", &["top", "swing"]);
        assert_near(&found, &[by_top, by_swing], 1e-8, &format!("{time}"));
    }
}

#[test]
fn a_step_and_a_ramp_are_differentiated_by_their_times() {
    let driven = built(
        volts("driven")
            .parameter("at", 0.3, "s", [0.0, 1.0])
            .parameter("turn", 0.7, "s", [0.0, 1.0])
            .drive("jump", "volt", element("step").set("height", 10).set("at", "at"))
            .drive("slope", "volt", element("ramp").set("rate", 20).set("turn", "turn"))
            .element("A1", element("integrator").cords("x1", ["jump"]))
            .element("A2", element("integrator").cords("x1", ["slope"])),
    );
    for step in [1e-2, 0.25] {
        assert_near(&derivatives(&driven, step, 1.5, "A1", &["at", "turn"]), &[10.0, 0.0], 1e-10, "A1");
        let expected = -20.0 * 2.0 * (1.5 - 0.7);
        assert_near(&derivatives(&driven, step, 1.5, "A2", &["at", "turn"]), &[0.0, expected], 1e-10, "A2");
    }
}

/// Derivatives have the order of the method, 4, also with a dead zone, a brake and a relay.
#[test]
fn derivatives_converge_with_order_4() {
    let dead_zone = built(
        volts("dead zone")
            .parameter("start", 30.0, "V", [1.0, 90.0])
            .element("DZ", element("dead-zone").cord("in", "A2").set("lower", -10).set("upper", 10))
            .element("A1", element("integrator").cords("x4", ["DZ"]).set("initial", "start / volt"))
            .element("S1", element("summer").cords("x1", ["A1"]))
            .element("A2", element("integrator").cords("x1", ["S1"])),
    );
    let brake = program(&patch("stick-slip-brake"), &[]);
    let steps = [4e-2, 2e-2, 1e-2, 5e-3];
    let cases = [(&dead_zone, "start", 1.0), (&brake, "Fk", 0.2), (&brake, "m", 0.2)];
    for (program, by, scale) in cases {
        let samples = |step: f64| {
            [1.21, 1.43, 2.57, 3.33, 4.39].map(|time| derivatives(program, step, time, "A2", &[by])[0])
        };
        let exact = samples(1e-3 * scale);
        let errors = steps.map(|step| {
            samples(step * scale)
                .iter()
                .zip(&exact)
                .map(|(found, exact)| (found - exact).abs())
                .fold(0.0, f64::max)
        });
        let observed = convergence_order(&steps, &errors);
        assert!((3.8..4.2).contains(&observed), "{by}: order {observed} from {errors:?}");
    }
}

/// With a tolerance the error of derivatives is about that of the run.
#[test]
fn adaptive_derivatives_keep_ten_times_the_tolerance() {
    let case = Case::new(patch("bouncing-ball"), &[], 3.4);
    let exact = case.trace(&["e", "g"]);
    for tolerance in [1e-6, 1e-9] {
        let case = Case::new(patch("bouncing-ball"), &[], 3.4);
        let trace = case.with(|settings| settings.with_tolerance(tolerance)).trace(&["e", "g"]);
        for name in ["e", "g"] {
            let [found, expected] = [&trace, &exact].map(|trace| trace.derivative("height", name).unwrap());
            let largest = expected.values().fold(0.0f64, |maximum, slope| maximum.max(slope.abs()));
            let pairs = found.values().zip(expected.values());
            let largest_difference =
                pairs.map(|(found, expected)| (found - expected).abs()).fold(0.0, f64::max);
            assert!(
                largest_difference < 10.0 * tolerance * largest,
                "{tolerance} {name} {largest_difference}"
            );
        }
    }
}

#[test]
fn the_derivative_at_a_kink_is_that_towards_higher_values() {
    let rectified = |value: f64| {
        let builder = volts("rectified")
            .parameter("p", value, "V", [-9.0, 9.0])
            .drive("u", "volt", element("step").set("height", "-p"))
            .element("AB", element("absolute").cord("in", "u"));
        built(builder)
    };
    for (value, expected) in [(2.0, 1.0), (-2.0, -1.0), (0.0, 1.0)] {
        assert_eq!(derivatives(&rectified(value), 1e-2, 0.1, "AB", &["p"]), [expected], "{value}");
    }
}
