//! Drive: a rectangular pulse, once or repeated.

use proptest::prelude::*;

use crate::common::{built, element, random_cases, run_for, voltage, volts};
use crate::elements::bench::{ANY, bench_drive, drive_stops_at_100_volts, out, waits_in_hold};
use patchcord_core::document::Phase;
use patchcord_core::ir::Program;
use patchcord_core::solve::{self, Backend, Machine, RunSettings};

proptest! {
    #![proptest_config(random_cases(48))]

    #[test]
    fn law(
        height in ANY, begin in 0.0..0.5f64, width in 0.01..0.3f64, gap in 0.01..0.3f64, repeats: bool,
        time in 0.0..1.5f64,
    ) {
        let pulse = element("pulse").set("height", height).set("begin", begin).set("width", width);
        let period = width + gap;
        let program = bench_drive(if repeats { pulse.set("period", period) } else { pulse });
        let since = time - begin;
        let within = if repeats && since >= 0.0 { since % period } else { since };
        prop_assume!([0.0, width, period].iter().all(|edge| (within - edge).abs() > 1e-9));
        let expected = if within >= 0.0 && within < width { height } else { 0.0 };
        prop_assert_eq!(out(&run_for(&program, 0.1, time)), expected);
    }
}

#[test]
fn overload() {
    drive_stops_at_100_volts(element("pulse").set("height", -130).set("width", 0.1), -130.0);
}

#[test]
fn modes() {
    let pulse = element("pulse").set("height", 30).set("begin", 0.3).set("width", 0.2);
    waits_in_hold(pulse, |time| if (0.3..0.5).contains(&time) { 30.0 } else { 0.0 });
}

#[test]
fn it_begins_at_its_first_edge_and_ends_at_its_last() {
    let program = bench_drive(element("pulse").set("height", 30).set("begin", 0.3).set("width", 0.25));
    for (time, expected) in [(0.2, 0.0), (0.3, 30.0), (0.54, 30.0), (0.55, 0.0), (9.0, 0.0)] {
        for step in [1e-2, 0.07, 1.0] {
            assert_eq!(out(&run_for(&program, step, time)), expected, "{time} with step {step}");
        }
    }
}

/// Pulses of 40 V from b on, of width w and, if it is given, the period 0.3 s. A1 integrates them.
fn integrated(repeats: bool) -> Program {
    let pulse = element("pulse").set("height", 40).set("begin", "b").set("width", "w");
    let pulse = if repeats { pulse.set("period", "p") } else { pulse };
    built(
        volts("integrated")
            .parameter("b", 0.123, "s", [0.0, 1.0])
            .parameter("w", 1e-3, "s", [1e-6, 0.2])
            .parameter("p", 0.3, "s", [0.25, 1.0])
            .drive("u", "volt", pulse)
            .element("A1", element("integrator").cords("x10", ["u"])),
    )
}

/// The pulses are much shorter than the steps. Four of them begin within 1.1 s.
#[test]
fn pulses_shorter_than_a_step_are_exact() {
    for (program, count) in [(integrated(false), 1.0), (integrated(true), 4.0)] {
        let expected = -10.0 * 40.0 * 1e-3 * count;
        let assert_near = |found: f64, context: &str| {
            assert!((found - expected).abs() < 1e-10, "{context}: {found}, expected {expected}");
        };
        for step in [1e-2, 0.1, 0.37] {
            assert_near(voltage(&run_for(&program, step, 1.1), "A1"), &format!("step {step}"));
        }
        let mut machine = Machine::adaptive(&program, 1e-3, 0.1).unwrap();
        machine.operate(1.1).unwrap();
        assert_near(voltage(&machine, "A1"), "adaptive steps");
        for backend in Backend::ALL {
            let settings = RunSettings::from_phases([Phase::operate(1.1)], 0.05).with_signals(["A1"]);
            let trace = solve::run(&program, &settings.with_backend(backend)).unwrap();
            assert_near(*trace.tracks[0].volts.last().unwrap(), &format!("{backend}"));
        }
    }
}

/// Three pulses of 400 V/s have ended, and the fourth has begun. So A1 = -400 V/s x (3 w + t - b - 3 p).
#[test]
fn derivatives() {
    let program = integrated(true);
    let mut machine = Machine::new(&program, 0.05).unwrap();
    machine.differentiate(["b", "w", "p"]).unwrap();
    machine.operate(0.123 + 3.0 * 0.3 + 0.5e-3).unwrap();
    for (by, expected) in [("b", 400.0), ("w", -1200.0), ("p", 1200.0)] {
        let found = machine.sensitivity("A1", by).unwrap();
        assert!((found - expected).abs() < 1e-8, "by {by}: {found}, expected {expected}");
    }
}

#[test]
fn a_width_must_stay_below_the_period() {
    let program = integrated(true);
    let mut machine = run_for(&program, 0.01, 0.1);
    machine.set_parameter("w", 0.2).unwrap();
    let mut wide = program.clone();
    assert!(wide.set_parameters([("w", 0.2), ("p", 0.25)]).is_ok());
    let pulse = element("pulse").set("height", 1).set("width", "w").set("period", 0.5);
    let builder = volts("wide").parameter("w", 0.1, "s", [0.1, 1.0]).drive("u", "volt", pulse);
    let refused = built(builder).set_parameters([("w", 0.5)]).unwrap_err();
    assert!(refused.to_string().contains("not below"), "{refused}");
}
