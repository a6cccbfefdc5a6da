//! Derivatives through the phases of a run.

use crate::common::{element, volts};
use crate::sensitivity::comparison::Case;
use patchcord_core::patch::Patch;
use patchcord_core::solve::{ParameterChange, Phase};
use patchcord_core::trace::Trace;
use patchcord_expr::Formula;

/// A decay from 80 V with the rate `a`. The relay K1 releases at 20 V.
fn decay() -> Patch {
    let relay = element("relay").set("drop_out", "mark / volt").set("pull_in", 30);
    let builder = volts("decay")
        .parameter("a", 1.0, "1/s", [0.1, 10.0])
        .parameter("b", 3.0, "1/s", [0.1, 10.0])
        .parameter("mark", 20.0, "V", [1.0, 29.0])
        .element("A1", element("integrator").cords("x10", ["P1"]).set("initial", 80))
        .element("P1", element("pot").cord("in", "A1").set("setting", "a / 10"))
        .element("K1", relay.cord("in", "A1").cord("on", "+100").cord("off", "-100"))
        .signal("level", "A1", "volt", 1.0);
    builder.build().unwrap_or_else(|report| panic!("{report}"))
}

fn set(parameter: &str, to: &str) -> Phase {
    Phase::Set { changes: vec![ParameterChange::new(parameter, Formula::parse(to).unwrap())] }
}

fn case(phases: &[Phase]) -> Case {
    Case::new(decay(), &[], 1.0).with(|settings| {
        settings.with_phases(phases.to_vec()).with_sample_interval(0.0317).with_signals(["level"])
    })
}

/// The last sample before a time: its time and its derivative.
fn at(trace: &Trace, by: &str, time: f64) -> (f64, f64) {
    let sample = trace.time.partition_point(|sample| *sample < time) - 1;
    (trace.time[sample], trace.derivative("level", by).unwrap().volts[sample])
}

#[test]
fn the_phase_after_a_relay_switches_begins_at_a_moving_instant() {
    // 80 e^-at until 20 V at T = ln 4 / a, then a hold of half a second, then 20 e^-2(t - T).
    let phases = [
        Phase::operate_until(10.0, "K1", None),
        Phase::Hold { time: 0.5 },
        set("a", "2"),
        Phase::operate(1.0),
    ];
    let trace = case(&phases).trace(&["a", "mark"]);
    let (end, time_derivative) = (4.0f64.ln(), [-(4.0f64.ln()), -1.0 / 20.0]);
    for (name, time_derivative) in ["a", "mark"].into_iter().zip(time_derivative) {
        let (time, found) = at(&trace, name, end - 0.1);
        let expected = if name == "a" { -time * 80.0 * (-time).exp() } else { 0.0 };
        assert!((found - expected).abs() < 1e-9, "{name} at {time}: {found}, expected {expected}");
        let held = at(&trace, name, end + 0.4).1;
        let expected = if name == "mark" { 1.0 } else { 0.0 };
        assert!((held - expected).abs() < 1e-9, "{name} held: {held}");
        let (time, found) = at(&trace, name, end + 1.3);
        let decay = (-2.0 * (time - end - 0.5)).exp();
        let expected = 20.0 * decay * 2.0 * time_derivative + if name == "mark" { decay } else { 0.0 };
        assert!((found - expected).abs() < 1e-9, "{name} at {time}: {found}, expected {expected}");
    }
}

#[test]
fn derivatives_through_phases_agree_with_differences() {
    let shots = [
        Phase::InitialCondition,
        Phase::operate(0.4),
        set("a", "a * (1.5 + level / volt / 100) + b / 10"),
        Phase::Hold { time: 0.2 },
        Phase::operate_until(5.0, "K1", None),
        Phase::operate(0.3),
        set("a", "b"),
        Phase::operate(0.4),
    ];
    let twice = [Phase::Repeat { times: 2, phases: shots.to_vec() }];
    // In the second repetition the formulas use the values that the first one ended with.
    for phases in [shots.as_slice(), &shots[..5], &twice[..]] {
        let case = Case { relative_step: 1e-4, ..case(phases) };
        case.check(&["a", "b"], 1e-5, 0.9);
    }
}
