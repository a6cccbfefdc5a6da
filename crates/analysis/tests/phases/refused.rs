//! Phases that cannot be gone through: told before the run where that can be, else where it stops.

use super::{INITIAL, decay, hold, made, repeat, tried};
use crate::common::element;
use patchcord_core::ir::SettingError;
use patchcord_core::patch::PatchBuilder;
use patchcord_core::solve::{Change, Phase, RunError};
use patchcord_core::trace::Ending;
use patchcord_expr::Formula;

#[test]
fn what_cannot_be_set_stops_the_run_and_leaves_its_record() {
    let phases = [Phase::operate(0.5), Phase::set_by("start", "level / 50").unwrap(), Phase::operate(0.5)];
    let stopped = tried(&decay(), &phases, 0.25, &["level"]).unwrap_err();
    assert!(
        matches!(
            &stopped.error,
            RunError::Setting(SettingError::OutsideRange(violation)) if violation.name == "start"
        ),
        "{stopped}"
    );
    assert_eq!((stopped.trace.time.as_slice(), stopped.trace.marks.len()), (&[0.0, 0.25, 0.5][..], 3));
    assert_eq!(stopped.trace.marks[2].ended, Ending::Stopped);
    let pole = Phase::set_by("start", "level * level / (level - level)").unwrap();
    let stopped = tried(&decay(), &[Phase::operate(0.5), pole], 0.25, &["level"]).unwrap_err();
    assert!(stopped.error.to_string().contains("denominator"), "{stopped}");
    assert_eq!(stopped.trace.len(), 3);
}

#[test]
fn settings_that_make_no_run_are_refused_before_it() {
    let refused = |phases: &[Phase]| tried(&decay(), phases, 0.1, &["level"]).unwrap_err();
    let told = |phases: &[Phase]| refused(phases).error.code();
    assert_eq!(told(&[]), "no-time");
    assert_eq!(told(&[INITIAL, Phase::set("a", 2.0)]), "no-time");
    assert_eq!(told(&[repeat(0, &[Phase::operate(1.0)])]), "empty-repeat");
    assert_eq!(told(&[repeat(2, &[]), Phase::operate(1.0)]), "empty-repeat");
    assert_eq!(told(&[Phase::operate(-1.0)]), "not-a-time");
    assert_eq!(told(&[Phase::operate(1.0), hold(f64::NAN)]), "not-a-time");
    assert_eq!(told(&[repeat(2, &[INITIAL, Phase::operate(0.05)])]), "longer-than-run");
    let operate = Phase::operate(1.0);
    let wait = |relay: &str, becomes| [Phase::operate_until(1.0, relay, becomes)];
    assert_eq!(told(&wait("K2", None)), "unknown-element");
    assert_eq!(told(&wait("A1", None)), "not-a-relay");
    assert_eq!(told(&wait("K1", Some("shut"))), "unknown-position");
    assert_eq!(told(&[operate.clone(), Phase::set("b", 1.0)]), "unknown-parameter");
    for formula in ["level", "b", "a + 1"] {
        assert_eq!(
            told(&[operate.clone(), Phase::set_by("a", formula).unwrap()]),
            "bad-formula",
            "{formula}"
        );
    }
    assert!(refused(&wait("K2", None)).trace.is_empty());
}

#[test]
fn plans_beyond_reason_are_refused_at_once() {
    let billions = |phases: &[Phase]| repeat(1_000_000_000, &[repeat(1_000_000_000, phases)]);
    let told = |phases: &[Phase]| tried(&decay(), phases, 0.1, &["level"]).unwrap_err().error.code();
    assert_eq!(told(&[billions(&[Phase::operate(0.1)])]), "too-many-steps");
    assert_eq!(told(&[Phase::operate(1.0), billions(&[Phase::set("a", 2.0)])]), "too-many-numbers");
    assert_eq!(told(&[billions(&[INITIAL]), Phase::operate(1.0)]), "too-many-numbers");
    assert_eq!(told(&[Phase::operate(1.0), hold(1e12)]), "too-many-numbers");
    assert_eq!(told(&[repeat(u64::MAX, &[hold(f64::MAX)])]), "too-many-numbers");
    // Every parameter that is set is told of in the trace.
    let changes = vec![Change::new("a", Formula::parse("1").unwrap()); 1000];
    let sets = repeat(100_000, &[Phase::Set { changes }]);
    assert_eq!(told(&[sets, Phase::operate(1.0)]), "too-many-numbers");
}

#[test]
fn a_scale_cannot_change_within_a_record() {
    let builder = PatchBuilder::new("rescaled")
        .parameter("full", 100.0, "mm", [1.0, 1000.0])
        .scale("position", "full / 100", "mm")
        .element("A1", element("integrator").cords("x1", ["+100"]))
        .signal("x", "A1", "position", 1.0)
        .run(1.0, 1e-3);
    let phases = [Phase::operate(0.5), Phase::set("full", 200.0), Phase::operate(0.1)];
    let stopped = tried(&made(builder), &phases, 0.1, &["x"]).unwrap_err();
    assert_eq!(stopped.error, RunError::Rescaled { signal: "x".to_owned() });
}
