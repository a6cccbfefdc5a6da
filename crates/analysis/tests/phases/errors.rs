//! Phases that cannot be run. The error comes before the run if possible, otherwise when the run stops.

use super::{INITIAL, built, decay, hold, repeat, try_run};
use crate::common::element;
use patchcord_core::ir::SettingError;
use patchcord_core::patch::PatchBuilder;
use patchcord_core::solve::{ParameterChange, Phase, RunError};
use patchcord_core::trace::PhaseEnd;
use patchcord_expr::Formula;

#[test]
fn a_value_that_cannot_be_set_stops_the_run_and_keeps_its_record() {
    let phases = [Phase::operate(0.5), Phase::set_by("start", "level / 50").unwrap(), Phase::operate(0.5)];
    let stopped = try_run(&decay(), &phases, 0.25, &["level"]).unwrap_err();
    assert!(
        matches!(
            &stopped.error,
            RunError::Setting(SettingError::OutsideRange(violation)) if violation.name == "start"
        ),
        "{stopped}"
    );
    assert_eq!(
        (stopped.trace.time.as_slice(), stopped.trace.phase_records.len()),
        (&[0.0, 0.25, 0.5][..], 3)
    );
    assert_eq!(stopped.trace.phase_records[2].ended, PhaseEnd::Stopped);
    let pole = Phase::set_by("start", "level * level / (level - level)").unwrap();
    let stopped = try_run(&decay(), &[Phase::operate(0.5), pole], 0.25, &["level"]).unwrap_err();
    assert!(stopped.error.to_string().contains("denominator"), "{stopped}");
    assert_eq!(stopped.trace.len(), 3);
}

#[test]
fn invalid_settings_return_an_error_before_the_run() {
    let stopped = |phases: &[Phase]| try_run(&decay(), phases, 0.1, &["level"]).unwrap_err();
    let code = |phases: &[Phase]| stopped(phases).error.code();
    assert_eq!(code(&[]), "no-time");
    assert_eq!(code(&[INITIAL, Phase::set("a", 2.0)]), "no-time");
    assert_eq!(code(&[repeat(0, &[Phase::operate(1.0)])]), "empty-repeat");
    assert_eq!(code(&[repeat(2, &[]), Phase::operate(1.0)]), "empty-repeat");
    assert_eq!(code(&[Phase::operate(-1.0)]), "not-a-time");
    assert_eq!(code(&[Phase::operate(1.0), hold(f64::NAN)]), "not-a-time");
    assert_eq!(code(&[repeat(2, &[INITIAL, Phase::operate(0.05)])]), "longer-than-run");
    let operate = Phase::operate(1.0);
    let operate_until = |relay: &str, becomes| [Phase::operate_until(1.0, relay, becomes)];
    assert_eq!(code(&operate_until("K2", None)), "unknown-element");
    assert_eq!(code(&operate_until("A1", None)), "not-a-relay");
    assert_eq!(code(&operate_until("K1", Some("shut"))), "unknown-position");
    assert_eq!(code(&[operate.clone(), Phase::set("b", 1.0)]), "unknown-parameter");
    for formula in ["level", "b", "a + 1"] {
        assert_eq!(
            code(&[operate.clone(), Phase::set_by("a", formula).unwrap()]),
            "bad-formula",
            "{formula}"
        );
    }
    assert!(stopped(&operate_until("K2", None)).trace.is_empty());
}

#[test]
fn excessive_run_lengths_are_refused_immediately() {
    let billions = |phases: &[Phase]| repeat(1_000_000_000, &[repeat(1_000_000_000, phases)]);
    let code = |phases: &[Phase]| try_run(&decay(), phases, 0.1, &["level"]).unwrap_err().error.code();
    assert_eq!(code(&[billions(&[Phase::operate(0.1)])]), "too-many-steps");
    assert_eq!(code(&[Phase::operate(1.0), billions(&[Phase::set("a", 2.0)])]), "too-many-numbers");
    assert_eq!(code(&[billions(&[INITIAL]), Phase::operate(1.0)]), "too-many-numbers");
    assert_eq!(code(&[Phase::operate(1.0), hold(1e12)]), "too-many-numbers");
    assert_eq!(code(&[repeat(u64::MAX, &[hold(f64::MAX)])]), "too-many-numbers");
    // The trace records every parameter that is set.
    let changes = vec![ParameterChange::new("a", Formula::parse("1").unwrap()); 1000];
    let sets = repeat(100_000, &[Phase::Set { changes }]);
    assert_eq!(code(&[sets, Phase::operate(1.0)]), "too-many-numbers");
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
    let stopped = try_run(&built(builder), &phases, 0.1, &["x"]).unwrap_err();
    assert_eq!(stopped.error, RunError::Rescaled { signal: "x".to_owned() });
}
