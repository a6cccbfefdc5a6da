//! Comparator without hysteresis.

use proptest::prelude::*;

use crate::common::{built, element, random_cases, run_for, voltage, volts};
use crate::elements::bench::{ANY, apply, assert_out, at, bench, has_no_lamp, output};
use patchcord_core::document::Phase;
use patchcord_core::ir::Program;
use patchcord_core::patch::ElementBuilder;
use patchcord_core::solve::{self, Backend, Machine, RunError, RunSettings};

/// A comparator of a with b that gives 7 V or -3 V.
fn comparator(threshold: f64) -> ElementBuilder {
    let compared = element("comparator").cord("in", "a").cord("against", "b");
    compared.set("threshold", threshold).set("high", 7).set("low", -3)
}

proptest! {
    #![proptest_config(random_cases(48))]

    #[test]
    fn law(a in ANY, b in ANY, threshold in ANY) {
        let expected = if a - b >= threshold { 7.0 } else { -3.0 };
        prop_assert_eq!(output(comparator(threshold), &[a, b]), expected);
    }
}

#[test]
fn the_default_levels_are_the_references_and_the_default_threshold_is_0() {
    let alone = || element("comparator").cord("in", "a");
    for (a, expected) in [(1e-9, 100.0), (0.0, 100.0), (-1e-9, -100.0)] {
        assert_eq!(output(alone(), &[a]), expected, "{a}");
    }
    let inverted = alone().set("high", -100).set("low", 100);
    assert_eq!(output(inverted, &[5.0]), -100.0, "the levels may be exchanged");
}

#[test]
fn overload() {
    has_no_lamp(element("comparator").cord("in", "high"), &[100.0], 100.0);
}

#[test]
fn modes() {
    let program = bench(comparator(5.0));
    let mut machine = at(&program, &[6.0, 1.0]);
    assert_out(&machine, 7.0, "in initial condition, at the threshold");
    machine.operate(2e-3).unwrap();
    apply(&mut machine, &[5.9]);
    assert_out(&machine, -3.0, "in operation");
    machine.hold();
    apply(&mut machine, &[6.0, 0.5]);
    assert_out(&machine, 7.0, "in hold");
    machine.operate(2e-3).unwrap();
    assert_out(&machine, 7.0, "after hold");
}

/// A triangle of 40 V and 0.5 Hz that is compared with 10 V. A1 integrates the output of the comparator.
fn duty() -> Program {
    let triangle = element("triangle").set("amplitude", 40).set("frequency", 0.5);
    let compared = element("comparator").cord("in", "u").set("threshold", 10).set("high", 20).set("low", -10);
    let builder = volts("duty").drive("u", "volt", triangle).element("K", compared);
    built(builder.element("A1", element("integrator").cords("x1", ["K"])))
}

/// The triangle is above 10 V from 0.125 s to 0.875 s, and switches at the same voltage in both directions.
#[test]
fn it_switches_at_the_instants_of_the_crossings() {
    let program = duty();
    let expected = 10.0 * (2.0 - 0.75) - 20.0 * 0.75;
    for step in [1e-3, 0.0373, 0.4] {
        let found = voltage(&run_for(&program, step, 2.0), "A1");
        assert!((found - expected).abs() < 1e-9, "step {step}: {found}, expected {expected}");
    }
    for tolerance in [1e-4, 1e-8] {
        let mut machine = Machine::adaptive(&program, tolerance, 1e-3).unwrap();
        machine.operate(2.0).unwrap();
        let found = voltage(&machine, "A1");
        assert!((found - expected).abs() < 1e-9, "tolerance {tolerance}: {found}, expected {expected}");
    }
    for backend in Backend::ALL {
        let settings = RunSettings::from_phases([Phase::operate(2.0)], 1e-2).with_signals(["A1"]);
        let trace = solve::run(&program, &settings.with_backend(backend)).unwrap();
        let found = *trace.tracks[0].volts.last().unwrap();
        assert!((found - expected).abs() < 1e-9, "{backend}: {found}, expected {expected}");
    }
}

/// The rate of A1 has the sign of -A1, so A1 cannot leave the threshold.
#[test]
fn a_comparator_that_acts_on_its_input_chatters() {
    let program = built(
        volts("chatter")
            .element("K", element("comparator").cord("in", "A1"))
            .element("A1", element("integrator").cords("x0.1", ["K"]).set("initial", 5)),
    );
    let machines = [Machine::new(&program, 1e-3), Machine::adaptive(&program, 1e-6, 1e-3)];
    for mut machine in machines.map(Result::unwrap) {
        match machine.operate(1.0) {
            Err(RunError::Chatter { element, advice, time, .. }) => {
                let remedy = "use a \"relay\" with hysteresis, \"drop_out\" below \"pull_in\", or put a \
                              \"delay\" into the loop";
                assert_eq!((element.as_str(), advice), ("K", remedy));
                assert!((time - 0.5).abs() < 1e-2, "{time}");
            }
            outcome => panic!("{outcome:?}"),
        }
    }
}

/// The input jumps 2000 times in a step and does not depend on the output. So a relay would not help.
#[test]
fn a_comparator_of_a_fast_square_wave_needs_a_shorter_step() {
    let square = element("square").set("amplitude", 10).set("frequency", 1000);
    let builder =
        volts("fast").drive("u", "volt", square).element("K", element("comparator").cord("in", "u"));
    let program = built(builder.element("A1", element("integrator").cords("x1", ["K"])));
    match Machine::new(&program, 1.0).unwrap().operate(1.0) {
        Err(RunError::Chatter { element, advice, .. }) => {
            let remedy = "find out why its input oscillates, or choose a shorter step";
            assert_eq!((element.as_str(), advice), ("K", remedy));
        }
        outcome => panic!("{outcome:?}"),
    }
}

#[test]
fn a_phase_can_wait_for_a_position() {
    let text = r#"{"patchcord": 1, "scales": {"volt": {"per_volt": 1, "unit": "V"}},
        "elements": {"A1": {"kind": "integrator", "in": {"x1": ["-100"]}},
                     "K": {"kind": "comparator", "in": "A1", "threshold": 30}},
        "signals": {"a": {"at": "A1", "scale": "volt"}},
        "run": {"step": 1e-2, "phases": [{"operate": 1, "until": {"relay": "K", "becomes": "high"}}]}}"#;
    let patch = patchcord_core::patch::Patch::parse("until.json", text).unwrap();
    let circuit = crate::common::circuit(&patch, &[]);
    let program = crate::common::program_of(&circuit);
    let trace = solve::run(&program, &RunSettings::of(&circuit).unwrap()).unwrap();
    assert!((trace.time.last().unwrap() - 0.3).abs() < 1e-12, "{:?}", trace.time.last());
}

/// A1 rises by 20 V/s up to the crossing at p / 50 and then falls by 10 V/s. So its slope by p is 30 / 50.
#[test]
fn derivatives() {
    let compared = element("comparator").cord("in", "u").set("threshold", "p");
    let program = built(
        volts("crossing")
            .parameter("p", 15.0, "V", [1.0, 90.0])
            .drive("u", "volt", element("ramp").set("rate", 50))
            .element("K", compared.set("high", -10).set("low", 20))
            .element("S", element("inverter").cord("in", "K"))
            .element("A1", element("integrator").cords("x1", ["S"])),
    );
    let mut machine = Machine::new(&program, 1e-2).unwrap();
    machine.differentiate(["p"]).unwrap();
    machine.operate(1.0).unwrap();
    let found = machine.sensitivity("A1", "p").unwrap();
    assert!((found - 0.6).abs() < 1e-9, "{found}");
    assert_eq!(machine.sensitivity("K", "p").unwrap(), 0.0);
}
