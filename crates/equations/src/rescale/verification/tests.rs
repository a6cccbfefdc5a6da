use patchcord_core::patch::Patch;

use super::super::decision::Decision;
use super::super::error::RescaleError;
use super::super::values::Values;
use super::super::wiring::Wiring;
use super::*;

/// A patch with these sections, and its run.
fn measured(sections: &str) -> Measured {
    let text = format!(r#"{{"patchcord": 1, {sections}}}"#);
    let patch = Patch::parse("p.json", &text).unwrap_or_else(|report| panic!("{report}"));
    Measured::new(&patch, RescaleError::Patch).unwrap_or_else(|error| panic!("{error}"))
}

/// Compares two patches, in the second of which all voltages should be `factor` times as large.
fn compared(old: &str, new: &str, factor: f64) -> Result<Verified, String> {
    let [old, new] = [old, new].map(measured);
    let (wiring, values) = (Wiring::new(&old.circuit), Values::of(&old.circuit));
    let mut decision = Decision::none(&wiring);
    for element in (0..wiring.len()).filter(|element| !wiring.is_reference(*element)) {
        decision.factors[element] = factor;
    }
    verify(&old, &new, &Decided { wiring: &wiring, old: &values, decision: &decision })
}

/// Checks that the second patch is accepted with all random states and the whole run, and that it is refused with this
/// message after each edit of its text.
fn check(old: &str, new: &str, factor: f64, end: f64, wrong: &[([&str; 2], &str)]) {
    assert_eq!(compared(old, new, factor), Ok(Verified { states: 24, agrees_until: Some(end) }));
    for ([right, edited], expected) in wrong {
        assert_eq!(new.matches(right).count(), 1, "{right}");
        let message = compared(old, &new.replace(right, edited), factor).expect_err(edited);
        assert!(message.starts_with(expected), "{edited}: {message}");
    }
}

/// A decay with this initial voltage and this value of one volt.
fn decay(initial: f64, per_volt: f64) -> String {
    format!(
        r#""scales": {{"length": {{"per_volt": {per_volt}, "unit": "mm"}}}},
        "elements": {{"P1": {{"kind": "pot", "in": "A1", "setting": 0.5}},
            "A1": {{"kind": "integrator", "in": {{"x1": ["P1"]}}, "initial": {initial}}}}},
        "signals": {{"x": {{"at": "A1", "scale": "length"}}}},
        "equations": ["x' = -0.5 x"], "run": {{"for": 2, "step": 0.01}}"#
    )
}

#[test]
fn a_wrong_pot_a_wrong_gain_and_a_wrong_initial_voltage_are_refused() {
    let wrong = [
        ([r#""setting": 0.5"#, r#""setting": 0.4"#], "P1 is "),
        ([r#""x1": ["P1"]"#, r#""x10": ["P1"]"#], "the derivative of A1 is "),
        ([r#""initial": 80"#, r#""initial": 20"#], "A1 begins at 20 V in place of 80 V"),
        ([r#""initial": 80"#, r#""initial": 80.00001"#], "A1 begins at 80.00001 V in place of 80 V"),
    ];
    check(&decay(20.0, 1.0), &decay(80.0, 0.25), 4.0, 2.0, &wrong);
    let other = decay(80.0, 0.25).replace("x' = -0.5 x", "x' = -0.4 x");
    let old = decay(20.0, 1.0);
    // The texts of the equations are those of the old patch.
    assert_eq!(compared(&old, &other, 4.0), Err("its wiring does not solve x' = -0.5 x".to_owned()));
}

/// A decay that drives a comparator, whose voltages are multiplied by a factor.
fn switched(factor: f64) -> String {
    let [threshold, high, low, initial] = [0.5, 5.0, -5.0, 8.0].map(|volts| volts * factor);
    format!(
        r#""elements": {{
            "K1": {{"kind": "comparator", "in": "A1", "threshold": {threshold}, "high": {high}, "low": {low}}},
            "A1": {{"kind": "integrator", "in": {{"x1": ["A1", "K1"]}}, "initial": {initial}}}}},
        "run": {{"for": 0.5, "step": 0.01}}"#
    )
}

/// In the run, the comparator is high all the time, so only the states show these edits.
#[test]
fn a_threshold_and_an_output_that_no_run_reaches_are_compared() {
    let wrong = [
        ([r#""threshold": 5,"#, r#""threshold": 0.5,"#], "K1 would switch at another voltage"),
        ([r#""threshold": 5,"#, r#""threshold": 5.0001,"#], "K1 would switch at another voltage"),
        ([r#""low": -50"#, r#""low": -5"#], "K1 is "),
    ];
    check(&switched(1.0), &switched(10.0), 10.0, 0.5, &wrong);
}

/// A decay with a step in the last quarter of its run, whose voltages are multiplied by a factor.
fn stepped(factor: f64) -> String {
    format!(
        r#""scales": {{"length": {{"per_volt": {}, "unit": "mm"}}}},
        "drives": {{"F": {{"kind": "step", "scale": "length", "height": 8, "at": 1.5}}}},
        "elements": {{"A1": {{"kind": "integrator", "in": {{"x1": ["A1", "F"]}}, "initial": {}}}}},
        "run": {{"for": 2, "step": 0.01}}"#,
        1.0 / factor,
        20.0 * factor
    )
}

/// The motion does not amplify deviations, so a late difference is no rounding.
#[test]
fn a_difference_late_in_the_run_is_refused() {
    let wrong = [
        ([r#""at": 1.5"#, r#""at": 1.9"#], "F differs from t = 1.5"),
        ([r#""height": 8"#, r#""height": 8.001"#], "F differs from t = 1.5"),
        ([r#""for": 2"#, r#""for": 1.8"#], "the length of the run differs from t = "),
    ];
    check(&stepped(1.0), &stepped(4.0), 4.0, 2.0, &wrong);
}

/// A delay line that gives out its first voltage after the end of the run.
fn delayed(factor: f64) -> String {
    let initial = 8.0 * factor;
    format!(
        r#""elements": {{"H1": {{"kind": "delay", "in": "A1", "delay": 3}},
            "A1": {{"kind": "integrator", "in": {{"x1": ["H1"]}}, "initial": {initial}}}}},
        "run": {{"for": 2, "step": 0.01}}"#
    )
}

#[test]
fn a_delay_beyond_the_run_is_compared() {
    let wrong = [([r#""delay": 3"#, r#""delay": 4"#], "the delay of H1 is 4 s in place of 3 s")];
    check(&delayed(1.0), &delayed(10.0), 10.0, 2.0, &wrong);
    let renamed = compared(&delayed(1.0), &delayed(10.0).replace("H1", "H2"), 10.0);
    assert_eq!(renamed, Err("H1 is not the element that it was".to_owned()));
}

/// A growth that overloads if the initial voltage is 8 V.
fn growing(initial: f64) -> String {
    format!(
        r#""elements": {{"B1": {{"kind": "inverter", "in": "A1"}},
            "A1": {{"kind": "integrator", "in": {{"x10": ["B1"]}}, "initial": {initial}}}}},
        "run": {{"for": 1, "step": 0.001}}"#
    )
}

#[test]
fn initial_voltages_are_compared_if_the_run_overloads() {
    let (old, factor) = (growing(8.0), 5e-4);
    assert_eq!(compared(&old, &growing(0.004), factor), Ok(Verified { states: 24, agrees_until: None }));
    let message = compared(&old, &growing(0.002), factor).unwrap_err();
    assert_eq!(message, "A1 begins at 0.002 V in place of 0.004 V");
    // The old patch does not overload, so the new one must not.
    let message = compared(&growing(0.004), &growing(8.0), 2000.0).unwrap_err();
    assert!(message.ends_with(" overloads"), "{message}");
}

#[test]
fn an_equation_that_was_solved_must_stay_solved() {
    use Standing::{Different, Solved, SolvedAt, Undecided};
    for (old, worse) in
        [(Solved, &[SolvedAt, Undecided, Different][..]), (SolvedAt, &[Undecided, Different][..])]
    {
        assert!(worse.iter().all(|new| is_lost(old, *new)), "{old:?}");
    }
    for (old, kept) in
        [(Solved, &[Solved][..]), (SolvedAt, &[Solved, SolvedAt][..]), (Different, &[Different][..])]
    {
        assert!(!kept.iter().any(|new| is_lost(old, *new)), "{old:?}");
    }
}

#[test]
fn values_that_are_no_numbers_differ_from_numbers() {
    let infinite = f64::INFINITY;
    for (wanted, found) in [(infinite, 5.0), (5.0, infinite), (f64::NAN, 5.0), (infinite, -infinite)] {
        assert!(is_different(wanted, found, 1e-8), "{wanted} and {found}");
    }
    assert!(!is_different(f64::NAN, f64::NAN, 1e-8) && !is_different(infinite, infinite, 1e-8));
    assert!(is_different(1.0, 1.0 + 1e-7, 1e-8) && !is_different(1.0, 1.0 + 1e-10, 1e-8));
}
