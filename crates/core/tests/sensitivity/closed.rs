//! Derivatives that are known in closed form.

use std::f64::consts::PI;

use crate::common::{built, element, order, patch, program, volts};
use crate::sensitivity::bench::Case;
use patchcord_core::ir::Program;
use patchcord_core::solve::{Machine, RunSettings};

/// The derivatives of an element's voltage by parameters, after so long, in fixed steps.
fn derivatives(program: &Program, step: f64, time: f64, element: &str, by: &[&str]) -> Vec<f64> {
    let mut machine = Machine::new(program, step).unwrap();
    machine.differentiate(by).unwrap();
    machine.operate(time).unwrap();
    by.iter().map(|name| machine.sensitivity(element, name).unwrap()).collect()
}

fn assert_near(found: &[f64], wanted: &[f64], allowed: f64, what: &str) {
    for (found, wanted) in found.iter().zip(wanted) {
        assert!((found - wanted).abs() <= allowed, "{what}: {found} and not {wanted}");
    }
}

/// x = x0 e^(-a t): by the rate -t x, by the start e^(-a t).
#[test]
fn decay_by_its_rate_and_its_start() {
    let decay = built(
        volts("decay")
            .parameter("a", 2.0, "1/s", [0.1, 10.0])
            .parameter("start", 0.08, "kV", [0.001, 0.099])
            .element("A1", element("integrator").cords("x10", ["P1"]).set("initial", "start"))
            .element("P1", element("pot").cord("in", "A1").set("setting", "a / 10")),
    );
    for time in [0.0, 0.3, 1.7] {
        let gone = (-2.0f64 * time).exp();
        let found = derivatives(&decay, 1e-3, time, "A1", &["a", "start"]);
        assert_near(&found, &[-time * 80.0 * gone, 1e3 * gone], 1e-9, &format!("{time}"));
    }
}

/// The derivatives of the height by restitution and gravity: thrown from the floor at v at a time T, it is
/// v (t - T) - g (t - T)^2 / 2; v and T follow the geometric series.
fn ball(e: f64, g: f64, time: f64) -> [f64; 2] {
    let (h0, first) = (1.0f64, (2.0 / g).sqrt());
    let (mut thrown, mut begin) = ((2.0 * g * h0).sqrt(), -first);
    let (mut thrown_by_e, mut begin_by_e) = (0.0, 0.0);
    while time > begin + 2.0 * thrown / g {
        begin += 2.0 * thrown / g;
        begin_by_e += 2.0 * thrown_by_e / g;
        thrown_by_e = e * thrown_by_e + thrown;
        thrown *= e;
    }
    let flown = time - begin;
    let fast = thrown - g * flown;
    // Times go with 1 / sqrt(g), velocities with sqrt(g).
    let by_g = 0.5 * thrown / g * flown - 0.5 * flown * flown + 0.5 * begin / g * fast;
    [thrown_by_e * flown - fast * begin_by_e, by_g]
}

#[test]
fn a_ball_by_restitution_and_gravity() {
    let program = program(&patch("bouncing-ball"), &[]);
    for time in [0.2, 0.7, 1.3, 2.9, 3.6] {
        let [by_e, by_g] = ball(0.8, 9.81, time);
        let found = derivatives(&program, 1e-2, time, "B1", &["e", "g"]);
        // 0.02 m per volt.
        assert_near(&found, &[by_e / 0.02, by_g / 0.02], 1e-7, &format!("{time}"));
    }
}

#[test]
fn a_ball_that_has_come_to_rest_follows_nothing() {
    let program = program(&patch("bouncing-ball"), &[]);
    let found = derivatives(&program, 1e-2, 4.9, "A1", &["e", "g", "h0", "v_rest"]);
    assert_eq!(found, [0.0; 4]);
}

/// Dry friction: half swings about +-c, x = +-(c + (42 - c - 2 c n) cos(2 t - n pi)), at rest after four.
#[test]
fn half_swings_by_the_level_of_friction() {
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
        // Turning points 42, -32, 22, -12, 2; there it rests.
        let turned = (2.0 * time).min(4.0 * PI) - halves * PI;
        let wanted = sign * (1.0 - (1.0 + 2.0 * halves) * turned.cos());
        let found = derivatives(&block, 1e-3, time, "A2", &["level"]);
        assert_near(&found, &[if halves == 4.0 { -8.0 } else { wanted }], 1e-8, &format!("{time}"));
    }
}

/// A triangle between thresholds a and b of slope s: the n-th corner comes at (a + (n - 1) (a - b)) / s.
#[test]
fn a_relay_oscillator_by_its_thresholds() {
    let program = program(&patch("relay-oscillator"), &[]);
    let (slope, high, low) = (80.0f64, 20.0f64, -10.0f64);
    for time in [0.1, 0.4, 0.8, 1.1, 2.3, 4.9] {
        let corners = if time < high / slope {
            0.0
        } else {
            1.0 + ((time - high / slope) * slope / (high - low)).floor()
        };
        let wanted = if corners.rem_euclid(2.0) == 1.0 {
            [-time, 1.0 + corners, 1.0 - corners]
        } else {
            [time, -corners, corners]
        };
        let found = derivatives(&program, 1e-2, time, "A1", &["slope", "a_high", "a_low"]);
        assert_near(&found, &wanted, 1e-9, &format!("{time}"));
    }
}

/// x' = -x(t - T), x = x0 before 0: a power of t - (k - 1) T in every delay.
#[test]
fn delayed_feedback_by_its_delay() {
    let program = program(&patch("delay-line"), &[]);
    for time in [0.5, 1.5, 2.5, 3.7] {
        let mut factorial = 1.0;
        let mut wanted = 0.0;
        for k in 1..=time as i32 + 1 {
            let since = -(time - f64::from(k - 1));
            wanted += f64::from(k * (k - 1)) * since.powi(k - 1) / (factorial * f64::from(k));
            factorial *= f64::from(k);
        }
        let found = derivatives(&program, 5e-3, time, "A1", &["T"]);
        assert_near(&found, &[50.0 * wanted], 1e-6, &format!("{time}"));
    }
}

/// A limit that holds is followed; what leaves it goes on from there.
#[test]
fn an_integrator_by_its_limit() {
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
    // -40 (1 - cos t) meets -20 at 60 degrees, is held until the drive turns at 180, and comes back from there.
    for (time, by_top, by_swing) in
        [(0.5, 0.0, 0.5f64.cos() - 1.0), (2.0, -1.0, 0.0), (4.0, -1.0, 1.0 + 4.0f64.cos())]
    {
        let found = derivatives(&limited, 1e-2, time, "A1", &["top", "swing"]);
        assert_near(&found, &[by_top, by_swing], 1e-8, &format!("{time}"));
    }
}

#[test]
fn a_step_and_a_ramp_by_their_times() {
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
        let wanted = -20.0 * 2.0 * (1.5 - 0.7);
        assert_near(&derivatives(&driven, step, 1.5, "A2", &["at", "turn"]), &[0.0, wanted], 1e-10, "A2");
    }
}

/// Derivatives are of the order of the method: 4, with dead zone, brake and relay as well.
#[test]
fn derivatives_converge_with_order_4() {
    let dead_zone = built(
        volts("play")
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
        let at = |step: f64| {
            [1.21, 1.43, 2.57, 3.33, 4.39].map(|time| derivatives(program, step, time, "A2", &[by])[0])
        };
        let exact = at(1e-3 * scale);
        let errors = steps.map(|step| {
            at(step * scale)
                .iter()
                .zip(&exact)
                .map(|(found, exact)| (found - exact).abs())
                .fold(0.0, f64::max)
        });
        let reached = order(&steps, &errors);
        assert!((3.8..4.2).contains(&reached), "{by}: order {reached} from {errors:?}");
    }
}

/// With a tolerance the derivatives are about as right as the run.
#[test]
fn a_tolerance_serves_derivatives_too() {
    let case = Case::new(patch("bouncing-ball"), &[], 3.4);
    let exact = case.trace(&["e", "g"]);
    for tolerance in [1e-6, 1e-9] {
        let case = Case::new(patch("bouncing-ball"), &[], 3.4);
        let trace = case.with(|own| RunSettings { tolerance: Some(tolerance), ..own }).trace(&["e", "g"]);
        for name in ["e", "g"] {
            let [found, wanted] = [&trace, &exact].map(|trace| trace.derivative("height", name).unwrap());
            let largest = wanted.values().fold(0.0f64, |most, slope| most.max(slope.abs()));
            let pairs = found.values().zip(wanted.values());
            let worst = pairs.map(|(found, wanted)| (found - wanted).abs()).fold(0.0, f64::max);
            assert!(worst < 10.0 * tolerance * largest, "{tolerance} {name} {worst}");
        }
    }
}

#[test]
fn on_a_kink_the_derivative_is_that_towards_higher_values() {
    let rectified = |value: f64| {
        let builder = volts("rectified")
            .parameter("p", value, "V", [-9.0, 9.0])
            .drive("u", "volt", element("step").set("height", "-p"))
            .element("AB", element("absolute").cord("in", "u"));
        built(builder)
    };
    for (value, wanted) in [(2.0, 1.0), (-2.0, -1.0), (0.0, 1.0)] {
        assert_eq!(derivatives(&rectified(value), 1e-2, 0.1, "AB", &["p"]), [wanted], "{value}");
    }
}
