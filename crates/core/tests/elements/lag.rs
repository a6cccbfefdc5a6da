//! First-order lag.

use proptest::prelude::*;

use crate::common::{built, check_derivatives, element, random_cases, run_for, voltage, volts};
use crate::elements::bench::{ANY, apply, assert_out, at, bench, out};
use patchcord_core::patch::ElementBuilder;
use patchcord_core::solve::{Machine, RunError};

fn lag(time: f64) -> ElementBuilder {
    element("lag").cords("x1", ["a"]).set("time", time)
}

proptest! {
    #![proptest_config(random_cases(48))]

    #[test]
    fn law(a in ANY, b in -20.0..20.0f64, start in ANY, time in 0.02..1.0f64, length in 0.0..1.0f64) {
        let lag = element("lag").cords("x0.5", ["a"]).cords("x2", ["b"]).set("time", time).set("initial", start);
        let program = bench(lag);
        let mut machine = at(&program, &[a, b]);
        machine.operate(length).unwrap();
        let target = -(0.5 * a + 2.0 * b);
        let expected = target + (start - target) * (-length / time).exp();
        // RK4 with steps of 1/20 of the time constant: under (h / T)^4 / 120 of 200 V.
        prop_assert!((out(&machine) - expected).abs() < 1.1e-5, "{} {expected}", out(&machine));
    }
}

#[test]
fn overload() {
    let program = bench(element("lag").cords("x2", ["a"]).set("time", 0.1));
    let mut machine = at(&program, &[-75.0]);
    // The lag approaches 150 V and reaches the limit of 100 V after T ln 3.
    let limit_time = 0.1 * 3f64.ln();
    machine.operate(limit_time - 1e-6).unwrap();
    assert!(out(&machine) < 100.0 && !machine.is_overloaded());
    machine.operate(2.0).unwrap();
    assert_eq!(out(&machine), 100.0);
    let overloads = machine.overloads();
    assert_eq!((overloads.len(), overloads[0].element.as_str()), (1, "E"));
    assert!((overloads[0].time - limit_time).abs() < 1e-3 + 1e-9, "{overloads:?}");
    assert!((overloads[0].peak().unwrap() - 150.0).abs() < 1e-3, "{overloads:?}");
    // It leaves the limit immediately when its input changes.
    apply(&mut machine, &[-25.0]);
    machine.operate(0.1).unwrap();
    assert!((out(&machine) - (50.0 + 50.0 * (-1f64).exp())).abs() < 1e-6, "{}", out(&machine));
    assert!(machine.is_overloaded(), "the lamp stays lit");
    machine.initial_condition().unwrap();
    assert!(!machine.is_overloaded());
}

#[test]
fn modes() {
    let program = bench(lag(0.1).set("initial", 12));
    let mut machine = at(&program, &[40.0]);
    assert_out(&machine, 12.0, "in initial condition");
    machine.operate(0.1).unwrap();
    machine.hold();
    let held = out(&machine);
    apply(&mut machine, &[-80.0]);
    assert_eq!(out(&machine), held, "in hold");
    machine.operate(0.1).unwrap();
    let expected = 80.0 + (held - 80.0) * (-1f64).exp();
    assert!((out(&machine) - expected).abs() < 1e-6, "after hold");
}

#[test]
fn a_lag_equals_a_patched_lag_of_a_summer_an_integrator_and_a_pot() {
    // Fig 8.15: an integrator of the difference between the input and the inverted output.
    let sine = element("sine").set("amplitude", 30).set("frequency", 3);
    let builder = volts("two lags")
        .drive("u", "volt", sine)
        .element("E", element("lag").cords("x1", ["u"]).set("time", 0.05).set("initial", -20))
        .element("P", element("pot").cord("in", "S").set("setting", 0.2))
        .element("S", element("summer").cords("x1", ["u", "A"]))
        .element("A", element("integrator").cords("x100", ["B"]).set("initial", -20))
        .element("B", element("inverter").cord("in", "P"));
    let program = built(builder);
    let machine = run_for(&program, 1e-3, 0.7);
    assert!((voltage(&machine, "E") - voltage(&machine, "A")).abs() < 1e-11);
}

#[test]
fn the_time_constant_is_in_machine_seconds() {
    let slow =
        volts("slow").time_scale(10.0).element("E", element("lag").cords("x1", ["ground"]).set("time", 2));
    let program = built(slow.element("F", element("lag").cords("x1", ["-100"]).set("time", 2)));
    let expected = 100.0 * (1.0 - (-0.5f64 / 0.2).exp());
    assert!((voltage(&run_for(&program, 1e-3, 0.5), "F") - expected).abs() < 1e-6);
}

#[test]
fn a_step_longer_than_the_time_constant_is_refused() {
    let program = bench(lag(1e-3));
    assert!(Machine::new(&program, 1e-3).is_ok());
    match Machine::new(&program, 1.1e-3) {
        Err(RunError::LagTooShort { element, time, step }) => {
            assert_eq!((element.as_str(), time, step), ("E", 1e-3, 1.1e-3));
        }
        other => panic!("{:?}", other.map(|machine| machine.time())),
    }
}

#[test]
fn derivatives() {
    let builder = volts("lag").parameter("T", 0.2, "s", [0.05, 1.0]).parameter("u", 30.0, "1", [1.0, 90.0]);
    let builder = builder.element("P", element("pot").cord("in", "-100").set("setting", "u / 100"));
    let lag = element("lag").cords("x1", ["P"]).cords("x0.5", ["A"]).set("time", "T").set("initial", 5);
    let program = built(builder.element("E", lag).element("A", element("integrator").cords("x1", ["E"])));
    check_derivatives(&program, 1e-3, &[0.0, 0.3]);
}
