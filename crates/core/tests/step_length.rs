//! Equal steps that are too long: the checks of a run find them.

use serde_json::json;

use crate::common::{built, element, voltage, volts};
use patchcord_core::ir::Program;
use patchcord_core::patch::{ElementBuilder, PatchBuilder};
use patchcord_core::solve::{Phase, RunSettings, run, run_batch, sufficient_step};
use patchcord_core::trace::{StepCause, StepWarning, Trace};

/// A trace of a program over some seconds, with checks of its steps. Every step is recorded.
fn checked(program: &Program, step: f64, seconds: f64, signals: &[&str]) -> Trace {
    let phases = [Phase::InitialCondition, Phase::operate(seconds)];
    let settings = RunSettings::from_phases(phases, step).with_signals(signals.iter().copied());
    run(program, &settings.with_step_checks()).unwrap_or_else(|stopped| panic!("{}", stopped.error))
}

/// Asserts that a run with the recommended step, and otherwise the same, gets no warning.
fn assert_recommended_step_passes(program: &Program, warning: &StepWarning, seconds: f64, signals: &[&str]) {
    let trace = checked(program, warning.recommended, seconds, signals);
    assert_eq!(trace.step_warning, None, "{warning:?}");
}

/// The cause of steps at which the method is unstable.
fn unstable(element: &str) -> StepCause {
    StepCause::Unstable(element.to_owned())
}

/// F' = -1000 (F + S) and S' = -S, from S = 80 V: F follows -S after a few milliseconds.
fn stiff() -> PatchBuilder {
    volts("stiff")
        .element("F", element("integrator").cords("x1000", ["F", "S"]))
        .element("S", element("integrator").cords("x1", ["S"]).set("initial", 80))
}

#[test]
fn an_unstable_step_is_reported_with_its_amplifier_and_a_step_that_does() {
    let program = built(stiff());
    for step in [0.0028, 0.003, 0.01] {
        let warning = checked(&program, step, 1.0, &["F", "S"]).step_warning.unwrap();
        assert_eq!((warning.signal.as_str(), &warning.cause), ("F", &unstable("F")), "{warning:?}");
        assert!(warning.error > 10.0 && warning.step == step, "{warning:?}");
        assert!(warning.recommended >= 2e-4 && warning.recommended <= 2e-3, "{warning:?}");
        assert_recommended_step_passes(&program, &warning, 1.0, &["F", "S"]);
    }
}

#[test]
fn a_short_step_gets_no_warning_and_is_found_automatically() {
    let program = built(stiff());
    assert_eq!(checked(&program, 1e-4, 1.0, &["F"]).step_warning, None);
    let settings = RunSettings::from_phases([Phase::InitialCondition, Phase::operate(1.0)], 0.01);
    let step = sufficient_step(&program, &settings.with_signals(["F"])).unwrap();
    assert!(step <= 1e-3, "{step}");
    // F = -80 (exp(-t) - exp(-1000 t)) 1000 / 999.
    let machine = crate::common::run_for(&program, step, 1.0);
    let expected = -80.0 * (-1.0f64).exp() * 1000.0 / 999.0;
    assert!((voltage(&machine, "F") - expected).abs() < 1e-3, "{}", voltage(&machine, "F"));
}

#[test]
fn several_programs_get_the_warnings_of_their_single_runs() {
    let program = built(stiff());
    let settings = RunSettings::from_phases([Phase::InitialCondition, Phase::operate(1.0)], 0.003);
    let settings = settings.with_signals(["F"]).with_step_checks();
    let expected = run(&program, &settings).unwrap().step_warning;
    assert!(expected.is_some());
    for trace in run_batch(&[program.clone(), program.clone()], &settings) {
        assert_eq!(trace.unwrap().step_warning, expected);
    }
}

#[test]
fn an_output_that_exceeds_its_limit_within_one_step_counts_as_an_overload() {
    let program = built(stiff());
    let trace = checked(&program, 0.01, 1.0, &["F"]);
    let overload = trace.overloads().find(|overload| overload.element == "F").unwrap();
    // The solver throws F to its limit, and no voltage demands more than 100 V.
    assert_eq!(overload.peak(), None);
    assert!(overload.driven().unwrap().rate > 1e3, "{overload:?}");
}

#[test]
fn a_maximum_holder_above_the_maximum_is_reported() {
    // P' = 1000 (max(S, P) - P) for S = 60 sin t: P must not exceed 60 V.
    let sine = element("sine").set("amplitude", 60).set("frequency", "1 / (2 * pi)");
    let builder = volts("holder")
        .drive("S", "volt", sine)
        .element("U", element("diode-upper-of").set("in", json!(["S", "P"])).set("drop", 0))
        .element("N", element("inverter").cord("in", "U"))
        .element("P", element("integrator").cords("x1000", ["N", "P"]));
    let program = built(builder);
    let warning = checked(&program, 0.01, 5.0, &["P"]).step_warning.unwrap();
    assert_eq!(warning.cause, unstable("P"), "{warning:?}");
    assert_eq!(checked(&program, 5e-4, 5.0, &["P"]).step_warning, None);
}

#[test]
fn the_demand_of_a_held_integrator_follows_its_feedback() {
    // A' = -A + 104 without limit: 104 V at most.
    let builder = volts("feedback")
        .element("P", element("pot").cord("in", "-100").set("setting", 0.04))
        .element("H", element("pot").cord("in", "A").set("setting", 0.5))
        .element("A", element("integrator").cords("x2", ["H"]).cords("x1", ["-100", "P"]));
    let program = built(builder);
    for seconds in [5.0, 20.0, 100.0] {
        let overloads = crate::common::run_for(&program, 0.01, seconds).overloads();
        let held = seconds - 26.0f64.ln();
        let expected = 104.0 - 4.0 * (-held).exp();
        assert!(
            (overloads[0].peak().unwrap() - expected).abs() < 1e-6,
            "{seconds}: {overloads:?} {expected}"
        );
    }
}

#[test]
fn feedback_through_inverters_at_their_limits_counts() {
    // A' = -A + 120 without limits. Both inverters are exactly at ±100 V while A is held.
    for reference in ["-100", "+100"] {
        let builder = volts("inverters")
            .element("P", element("pot").cord("in", reference).set("setting", 0.2))
            .element("N", element("inverter").cord("in", "A"))
            .element("B", element("inverter").cord("in", "N"))
            .element("A", element("integrator").cords("x1", ["B", reference, "P"]));
        let program = built(builder);
        for seconds in [5.0, 100.0] {
            let overloads = crate::common::run_for(&program, 0.01, seconds).overloads();
            let lit = overloads.iter().find(|overload| overload.element == "A").unwrap();
            let expected = 120.0 - 20.0 * (-(seconds - 6.0f64.ln())).exp();
            assert!((lit.peak().unwrap() - expected).abs() < 1e-6, "{seconds}: {lit:?} {expected}");
        }
    }
}

/// A' = 100 V/s - N, where N inverts L. The input of L is a tenth of A.
fn feedback_through(kind: ElementBuilder) -> Program {
    let builder = volts("memory")
        .element("P", element("pot").cord("in", "A").set("setting", 0.1))
        .element("L", kind)
        .element("N", element("inverter").cord("in", "L"))
        .element("A", element("integrator").cords("x1", ["-100", "N"]));
    built(builder)
}

#[test]
fn feedback_with_memory_gives_a_rate_that_does_not_depend_on_the_length_of_the_run() {
    let lag = element("lag").cords("x1", ["P"]).set("time", 1);
    let integrator = element("integrator").cords("x1", ["P", "L"]);
    let delay = element("delay").cord("in", "P").set("delay", 0.5);
    for (kind, rate) in [(lag, 96.2), (integrator, 96.2), (delay, 110.0)] {
        let program = feedback_through(kind);
        let lit = |seconds: f64| crate::common::run_for(&program, 0.01, seconds).overloads()[0].clone();
        let (short, long) = (lit(20.0), lit(100.0));
        assert_eq!((short.element.as_str(), short.peak(), long.peak()), ("A", None, None));
        let [short, long] = [short, long].map(|overload| overload.driven().unwrap());
        assert_eq!((short.limit, short.is_at_end, long.is_at_end), (100.0, true, true));
        assert!((short.rate - long.rate).abs() < 1e-9, "{short:?} {long:?}");
        assert!((short.seconds - 19.0).abs() < 0.1, "{short:?}");
        assert!((long.seconds - 99.0).abs() < 0.1, "{long:?}");
        assert!((short.rate - rate).abs() < 0.5, "{short:?}");
    }
}

#[test]
fn the_time_at_the_limit_ends_when_the_drive_turns() {
    // The input turns after 3 s. A reaches its limit after about 1 s.
    let builder = volts("turn")
        .drive("u", "volt", element("step").set("height", -80).set("at", 3))
        .element("P", element("pot").cord("in", "A").set("setting", 0.1))
        .element("L", element("lag").cords("x1", ["P"]).set("time", 1))
        .element("A", element("integrator").cords("x1", ["+100", "L"]).cords("x2", ["u"]));
    let program = built(builder);
    for seconds in [4.0, 4.5] {
        let overloads = crate::common::run_for(&program, 0.01, seconds).overloads();
        let driven = overloads[0].driven().unwrap();
        assert_eq!((overloads[0].element.as_str(), driven.limit, driven.is_at_end), ("A", -100.0, false));
        assert!((driven.seconds - 2.0).abs() < 0.1, "{driven:?}");
    }
}

/// An oscillating reaction (the Oregonator): three reactants in volts, of which one jumps within milliseconds.
fn oregonator() -> PatchBuilder {
    let product = |a: &str, b: &str| element("multiplier").set("mode", "product").cord("a", a).cord("b", b);
    let inverters = ["X", "Y", "Z"].map(|of| (format!("N{of}"), of));
    let pots = [
        ("P1", "NY", 0.26940935994722465),
        ("P2", "XY", 0.3367616999340309),
        ("P3", "NX", 0.25),
        ("P4", "XX", 0.25),
        ("P5", "Y", 0.2),
        ("P6", "XY", 0.25),
        ("P7", "NZ", 0.18559117623008584),
    ];
    let x = element("integrator").cords("x10", ["P1"]).cords("x10000", ["P2"]).cords("x100", ["P3", "P4"]);
    let y = element("integrator").cords("x10", ["P5"]).cords("x10000", ["P6"]).cords("x100", ["P7"]);
    let builder = volts("oscillating reaction")
        .element("XY", product("X", "Y"))
        .element("XX", product("X", "X"))
        .element("X", x.set("initial", 10))
        .element("Y", y.set("initial", 0.07423647049203434))
        .element("Z", element("integrator").cords("x1", ["NX", "Z"]).set("initial", 10));
    let builder = inverters
        .iter()
        .fold(builder, |builder, (name, of)| builder.element(name, element("inverter").cord("in", of)));
    pots.iter().fold(builder, |builder, (name, from, setting)| {
        builder.element(name, element("pot").cord("in", from).set("setting", *setting))
    })
}

#[test]
fn an_oscillating_reaction_is_wrong_with_a_warning_or_right_without_one() {
    let program = built(oregonator());
    let warning = checked(&program, 1e-3, 8.0, &["X", "Y", "Z"]).step_warning.unwrap();
    assert!(warning.error > 10.0 && matches!(warning.cause, StepCause::Unstable(_)), "{warning:?}");
    assert!((5e-5..=5e-4).contains(&warning.recommended), "{warning:?}");
    assert_eq!(checked(&program, 1e-4, 8.0, &["X", "Y", "Z"]).step_warning, None);
    // An independent computation by the classical Runge-Kutta method with steps of 5e-5 s.
    let machine = crate::common::run_for(&program, 1e-4, 8.0);
    for (element, expected) in [("X", 0.08524685250), ("Y", 12.01951713), ("Z", 2.02736322547)] {
        assert!((voltage(&machine, element) - expected).abs() < 1e-6, "{element}");
    }
}

/// A drive whose period divides the step is the same at both ends of every step.
#[test]
fn a_drive_that_the_steps_do_not_show_is_reported() {
    for (frequency, step) in [(50.0, 0.02), (1000.0, 1e-3), (10.0, 0.2), (740.0, 0.05), (12.0, 0.03)] {
        let sine = element("sine").set("amplitude", 80).set("frequency", frequency);
        let patch = volts("aliased").drive("u", "volt", sine);
        let program = built(patch.element("A", element("integrator").cords("x10", ["u"])));
        let warning = checked(&program, step, 1.0, &["u", "A"]).step_warning.unwrap();
        assert_eq!(warning.cause, StepCause::Fast("u".to_owned()), "{warning:?}");
        let period = 1.0 / frequency;
        assert!(warning.error > 0.1 && warning.recommended <= 0.02 * period, "{warning:?}");
        assert!(warning.recommended >= 0.005 * period, "{warning:?}");
    }
    let slow = element("sine").set("amplitude", 80).set("frequency", 1);
    let patch = volts("slow").drive("u", "volt", slow);
    let program = built(patch.element("A", element("integrator").cords("x1", ["u"])));
    assert_eq!(checked(&program, 0.02, 1.0, &["A"]).step_warning, None);
}

/// F follows -50 V with a rate of 1000/s while a pulse of 50 ms lasts, and keeps its voltage otherwise.
#[test]
fn a_short_stiff_episode_of_a_long_run_is_reported() {
    let pulse = element("pulse").set("height", -100).set("begin", 200).set("width", 0.05);
    let builder = volts("episode")
        .drive("gate", "volt", pulse)
        .element("S", element("summer").cords("x1", ["F"]).cords("x0.5", ["+100"]))
        .element("M", element("multiplier").cord("a", "S").cord("b", "gate").set("mode", "product"))
        .element("F", element("integrator").cords("x1000", ["M"]).set("initial", -49));
    let program = built(builder);
    let warning = checked(&program, 0.0029, 400.0, &["F"]).step_warning.unwrap();
    assert_eq!(warning.cause, unstable("F"), "{warning:?}");
    assert!(warning.error > 1.0 && warning.recommended <= 2e-3, "{warning:?}");
    assert!((warning.time - 200.0).abs() < 0.1, "{warning:?}");
    assert_eq!(checked(&program, 1e-3, 400.0, &["F"]).step_warning, None);
}

/// A comparator is high for 14.4 ms of every period of 0.2 s.
#[test]
fn pulses_of_half_a_step_have_the_right_length_or_a_warning() {
    let half_width = 0.0072;
    let threshold = 80.0 * (2.0 * std::f64::consts::PI * 5.0 * half_width).cos();
    let comparator = element("comparator").cord("in", "u").set("threshold", threshold).set("low", 0);
    let builder = volts("pulses")
        .drive("u", "volt", element("sine").set("amplitude", 80).set("frequency", 5))
        .element("C", comparator)
        .element("A", element("integrator").cords("x1", ["C"]));
    let program = built(builder);
    let expected = -100.0 * 5.0 * 2.0 * half_width;
    for step in [0.03, 0.017, 0.01, 0.005, 0.002] {
        let trace = checked(&program, step, 1.0, &["A"]);
        let error = (trace.values("A").unwrap().last().unwrap() - expected).abs();
        assert!(error < 2e-3 * expected.abs() || trace.step_warning.is_some(), "step {step}: {error} V");
        assert!(step > 0.01 || trace.step_warning.is_none(), "step {step}: {:?}", trace.step_warning);
    }
}

/// A comparator of an oscillator of 99 V and 1 Hz is high above 98.9 V. The method damps the oscillator a little, and this
/// shortens the pulses by much more.
#[test]
fn pulses_of_an_oscillator_have_the_right_length_or_a_warning() {
    let rate = 2.0 * std::f64::consts::PI / 10.0;
    let pot = |from: &str| element("pot").cord("in", from).set("setting", rate);
    let builder = volts("pulses of an oscillator")
        .element("C", element("integrator").cords("x10", ["PS"]).set("initial", 99))
        .element("PS", pot("S"))
        .element("S", element("integrator").cords("x10", ["PC"]))
        .element("PC", pot("M"))
        .element("M", element("inverter").cord("in", "C"))
        .element("K", element("comparator").cord("in", "S").set("threshold", 98.9).set("low", 0))
        .element("A", element("integrator").cords("x1", ["K"]));
    let program = built(builder);
    let expected = -100.0 * 10.0 * 2.0 * (98.9f64 / 99.0).acos() / (2.0 * std::f64::consts::PI);
    for step in [0.035, 0.03, 0.028, 0.025, 0.022, 0.02, 0.01, 0.005] {
        let trace = checked(&program, step, 10.0, &["A"]);
        let error = (trace.values("A").unwrap().last().unwrap() - expected).abs();
        assert!(error < 2e-3 * expected.abs() || trace.step_warning.is_some(), "step {step}: {error} V");
        assert!(step > 0.01 || trace.step_warning.is_none(), "step {step}: {:?}", trace.step_warning);
    }
}

/// x'' = -100 x from 10 V. A relay that switches in most steps has no influence on x.
#[test]
fn switchings_do_not_hide_the_error_of_a_step() {
    let relay = element("relay").cord("in", "T").cord("on", "+100").cord("off", "-100");
    let builder = volts("oscillator and relay")
        .element("A1", element("integrator").cords("x100", ["B"]))
        .element("A2", element("integrator").cords("x1", ["A1"]).set("initial", -10))
        .element("B", element("inverter").cord("in", "A2"))
        .element("T", element("integrator").cords("x10", ["R"]))
        .element("R", relay.set("pull_in", 50).set("drop_out", -50));
    let program = built(builder);
    let warning = checked(&program, 0.1, 10.0, &["B"]).step_warning.unwrap();
    assert!(warning.error > 0.3 && warning.recommended < 0.05, "{warning:?}");
    let settings = RunSettings::from_phases([Phase::InitialCondition, Phase::operate(10.0)], 0.1);
    let step = sufficient_step(&program, &settings.with_signals(["B"])).unwrap();
    let machine = crate::common::run_for(&program, step, 10.0);
    let expected = 10.0 * 100.0f64.cos();
    assert!((voltage(&machine, "B") - expected).abs() < 0.02, "step {step}: {}", voltage(&machine, "B"));
}

/// The reaction of Robertson. With too long a step all outputs go to their limits and stay there, also with half of the
/// step.
#[test]
fn outputs_that_an_unstable_step_throws_to_their_limits_are_reported() {
    let product = |a: &str, b: &str| element("multiplier").cord("a", a).cord("b", b).set("mode", "product");
    let inverse = |of: &str| element("inverter").cord("in", of);
    let builder = volts("reaction")
        .element("mA", element("integrator").cords("x0.04", ["mA"]).cords("x1", ["BC"]).set("initial", -100))
        .element("A", inverse("mA"))
        .element(
            "mB",
            element("integrator").cords("x400", ["A"]).cords("x10000", ["nBC"]).cords("x3000", ["nBB"]),
        )
        .element("B", inverse("mB"))
        .element("mC", element("integrator").cords("x0.3", ["BB"]))
        .element("C", inverse("mC"))
        .element("BC", product("B", "C"))
        .element("BB", product("B", "B"))
        .element("nBC", inverse("BC"))
        .element("nBB", inverse("BB"));
    let program = built(builder);
    for step in [0.1, 0.04, 0.02, 0.01, 0.005] {
        let trace = checked(&program, step, 40.0, &["A", "B", "C"]);
        let warning = trace.step_warning.unwrap_or_else(|| panic!("step {step}: {:?}", trace.repetitions));
        assert!(matches!(warning.cause, StepCause::Unstable(_)), "{warning:?}");
        assert!(warning.error > 10.0 && warning.recommended < 0.3 * step, "{warning:?}");
        assert_recommended_step_passes(&program, &warning, 40.0, &["A", "B", "C"]);
    }
    // The values of a at 40 s in the literature: 0.7158.
    let machine = crate::common::run_for(&program, 2e-4, 40.0);
    assert!((voltage(&machine, "A") - 71.58270687).abs() < 1e-5, "{}", voltage(&machine, "A"));
}

/// The overload is an error of the solver, but the output at the limit is not recorded.
#[test]
fn a_false_overload_of_an_output_that_is_not_recorded_is_reported() {
    let program = built(stiff());
    let warning = checked(&program, 0.01, 1.0, &["S"]).step_warning.unwrap();
    assert_recommended_step_passes(&program, &warning, 1.0, &["S"]);
    assert_eq!((warning.signal.as_str(), warning.unit.as_str(), &warning.cause), ("F", "V", &unstable("F")));
    assert!((10.0..=30.0).contains(&warning.error), "{warning:?}");
    assert!(warning.recommended >= 5e-4 && warning.recommended <= 2e-3, "{warning:?}");
}

/// x'' = -w^2 x with gains of 1 and w^2, so that the states differ by a factor of 100 or more.
#[test]
fn an_oscillator_with_unequal_gains_gets_a_step_that_passes() {
    for (gain, step) in [(1e4, 5e-3), (1e4, 2e-2), (1e4, 3e-2), (25.0, 5.0), (25.0, 0.5)] {
        let builder = volts("oscillator")
            .element("A1", element("integrator").cords(&format!("x{gain}"), ["B"]).set("initial", 0))
            .element("A2", element("integrator").cords("x1", ["A1"]).set("initial", -0.5))
            .element("B", element("inverter").cord("in", "A2"));
        let program = built(builder);
        let Some(warning) = checked(&program, step, 10.0, &["B"]).step_warning else {
            panic!("{gain} {step}");
        };
        // The method is unstable if the step is more than 2.83 divided by the angular frequency.
        let is_unstable = matches!(warning.cause, StepCause::Unstable(_));
        assert_eq!(is_unstable, step * f64::sqrt(gain) > 2.7, "{gain} {step}: {warning:?}");
        assert_recommended_step_passes(&program, &warning, 10.0, &["B"]);
    }
}
