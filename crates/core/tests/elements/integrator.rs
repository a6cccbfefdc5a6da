//! Integrating amplifier. crates/core/tests/limit.rs tests its limits, crates/core/tests/brake.rs its brake,
//! crates/core/tests/bouncing_ball.rs its gap, and crates/core/tests/reset.rs its reset.

use proptest::prelude::*;
use serde_json::json;

use crate::common::{built, element, random_cases, run_for, voltage, volts};
use crate::elements::bench::{ANY, apply, assert_out, at, bench, out};

proptest! {
    #![proptest_config(random_cases(48))]

    #[test]
    fn law(a in ANY, b in ANY, start in -50.0..50.0f64, length in 0.01..0.1f64) {
        let integrator = element("integrator").cords("x2", ["a"]).cords("x0.5", ["b"]).set("initial", start);
        let program = bench(integrator);
        let mut machine = at(&program, &[a, b]);
        machine.operate(length).unwrap();
        let expected = start - (2.0 * a + 0.5 * b) * length;
        prop_assert!((out(&machine) - expected).abs() < 1e-11, "{} {expected}", out(&machine));
    }

    #[test]
    fn law_of_limits(a in ANY, start in -20.0..20.0f64, upper in 20.0..60.0f64, lower in -60.0..-20.0f64,
                     drop in 0.0..2.0f64, length in 0.1..0.6f64) {
        let limit = json!({"upper": upper, "lower": lower, "drop": drop});
        let program = bench(element("integrator").cords("x2", ["a"]).set("initial", start).set("limit", limit));
        let mut machine = at(&program, &[a]);
        machine.operate(length).unwrap();
        let expected = (start - 2.0 * a * length).clamp(lower - drop, upper + drop);
        prop_assert!((out(&machine) - expected).abs() < 1e-11, "{} {expected}", out(&machine));
        prop_assert!(!machine.is_overloaded());
    }

    #[test]
    fn law_of_the_brake(a in -40.0..40.0f64, level in 0.0..40.0f64, start in -20.0..20.0f64,
                        starts_at_rest in any::<bool>(), length in 0.1..1.0f64) {
        let start = if starts_at_rest { 0.0 } else { start };
        let braked = element("integrator").cords("x1", ["a"]).cords("brake_x1", ["b"]).set("initial", start);
        let program = bench(braked);
        let mut machine = at(&program, &[a, level]);
        machine.operate(length).unwrap();
        let expected = braked_by(level, -a, start, length);
        prop_assert!((out(&machine) - expected).abs() < 1e-10, "{} {expected}", out(&machine));
    }

    /// A fall by `distance` from the speed `start`, and a return that ends at its highest point at the latest.
    #[test]
    fn law_of_a_stop(pull in 1.0..20.0f64, start in 0.0..20.0f64, distance in 1.0..10.0f64, restitution in 0.2..1.0f64,
                     fraction in 0.01..1.0f64) {
        let falling = element("integrator").cords("x1", ["u"]).cords("gap", ["A2"]).set("restitution", restitution);
        let builder = volts("stop").drive("u", "volt", element("step").set("height", -pull));
        let builder = builder.element("A1", falling.set("initial", start));
        let program = built(builder.element("A2", element("integrator").cords("x1", ["A1"]).set("initial", distance)));
        let speed = (start * start + 2.0 * pull * distance).sqrt();
        let hit = (speed - start) / pull;
        let length = fraction * (hit + restitution * speed / pull);
        let found = voltage(&run_for(&program, 1e-2, length), "A1");
        let expected = if length < hit { start + pull * length } else { pull * (length - hit) - restitution * speed };
        prop_assert!((found - expected).abs() < 1e-9, "{found} {expected}");
    }
}

/// The output after `length` seconds at a constant rate `net` with a brake. It slows down to rest, and then moves on if
/// the rate exceeds the brake's level.
fn braked_by(level: f64, net: f64, start: f64, length: f64) -> f64 {
    let slipping = net - level * start.signum();
    let rest = if start == 0.0 { 0.0 } else { -start / slipping };
    if start != 0.0 && (rest < 0.0 || rest > length) {
        return start + slipping * length;
    }
    (net.abs() - level).max(0.0).copysign(net) * (length - rest)
}

#[test]
fn overload() {
    let program = bench(element("integrator").cords("x10", ["a"]));
    let mut machine = at(&program, &[-100.0]);
    machine.operate(0.15).unwrap();
    assert_eq!(out(&machine), 100.0);
    let overloads = machine.overloads();
    // 1000 V/s: the limit after 0.1 s, and a demand 50 V higher 0.05 s later.
    assert_eq!((overloads.len(), overloads[0].element.as_str()), (1, "E"));
    assert!(
        (overloads[0].time - 0.1).abs() < 1e-9 && (overloads[0].peak().unwrap() - 150.0).abs() < 1e-6,
        "{overloads:?}"
    );
    machine.initial_condition().unwrap();
    assert!(!machine.is_overloaded());
}

#[test]
fn modes() {
    let program = bench(element("integrator").cords("x1", ["a"]).set("initial", 12));
    let mut machine = at(&program, &[40.0]);
    assert_out(&machine, 12.0, "in initial condition");
    machine.operate(0.1).unwrap();
    machine.hold();
    apply(&mut machine, &[-80.0]);
    assert_out(&machine, 8.0, "in hold");
    machine.operate(0.1).unwrap();
    assert_out(&machine, 16.0, "after hold");
}
