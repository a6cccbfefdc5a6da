//! Integrating amplifier. Its limit: tests/limit.rs; its brake: tests/brake.rs; its stops: tests/bouncing_ball.rs.

use proptest::prelude::*;

use crate::bench::{ANY, apply, assert_out, at, bench, out};
use crate::common::{element, random_cases};

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
}

#[test]
fn overload() {
    let program = bench(element("integrator").cords("x10", ["a"]));
    let mut machine = at(&program, &[-100.0]);
    machine.operate(0.15).unwrap();
    assert_eq!(out(&machine), 100.0);
    let told = machine.overloads();
    // 1000 V/s: at the limit after 0.1 s, and 50 V beyond it 0.05 s later.
    assert_eq!((told.len(), told[0].element.as_str()), (1, "E"));
    assert!((told[0].time - 0.1).abs() < 1e-9 && (told[0].peak - 150.0).abs() < 1e-6, "{told:?}");
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
