//! Derivatives through the phases of a run.

use crate::common::{element, volts};
use crate::sensitivity::bench::Case;
use patchcord_core::patch::Patch;
use patchcord_core::solve::{Change, Phase, RunSettings};
use patchcord_core::trace::Trace;
use patchcord_expr::Formula;

/// 80 V that decay with the rate `a`; K1 releases at 20 V.
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
    Phase::Set { changes: vec![Change::new(parameter, Formula::parse(to).unwrap())] }
}

fn case(phases: &[Phase]) -> Case {
    let record = vec!["level".to_owned()];
    Case::new(decay(), &[], 1.0).with(|own| RunSettings {
        phases: phases.to_vec(),
        every: 0.0317,
        record,
        ..own
    })
}

/// The derivative at the sample before a time of the record.
fn at(trace: &Trace, by: &str, time: f64) -> (f64, f64) {
    let sample = trace.time.partition_point(|sample| *sample < time) - 1;
    (trace.time[sample], trace.derivative("level", by).unwrap().volts[sample])
}

#[test]
fn what_follows_a_relay_begins_at_a_moving_instant() {
    // 80 e^-at until 20 V at T = ln 4 / a, held for half a second, then 20 e^-2(t - T).
    let phases = [
        Phase::operate_until(10.0, "K1", None),
        Phase::Hold { time: 0.5 },
        set("a", "2"),
        Phase::operate(1.0),
    ];
    let trace = case(&phases).trace(&["a", "mark"]);
    let (end, moves) = (4.0f64.ln(), [-(4.0f64.ln()), -1.0 / 20.0]);
    for (name, moves) in ["a", "mark"].into_iter().zip(moves) {
        let (time, found) = at(&trace, name, end - 0.1);
        let wanted = if name == "a" { -time * 80.0 * (-time).exp() } else { 0.0 };
        assert!((found - wanted).abs() < 1e-9, "{name} at {time}: {found} and not {wanted}");
        let held = at(&trace, name, end + 0.4).1;
        let wanted = if name == "mark" { 1.0 } else { 0.0 };
        assert!((held - wanted).abs() < 1e-9, "{name} held: {held}");
        let (time, found) = at(&trace, name, end + 1.3);
        let gone = (-2.0 * (time - end - 0.5)).exp();
        let wanted = 20.0 * gone * 2.0 * moves + if name == "mark" { gone } else { 0.0 };
        assert!((found - wanted).abs() < 1e-9, "{name} at {time}: {found} and not {wanted}");
    }
}

#[test]
fn differences_agree_through_phases() {
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
    // A repeated run sets anew from what the first one left.
    for phases in [shots.as_slice(), &shots[..5], &twice[..]] {
        let case = Case { share: 1e-4, ..case(phases) };
        case.check(&["a", "b"], 1e-5, 0.9);
    }
}
