//! What a run is refused for, or stopped by: told with what helps, and where.

use std::fs;

use super::{FIG_8_16, code, errors, json, out, patchcord, path, spring_with};

#[test]
fn times_below_0_are_refused_for_what_they_are() {
    for option in ["--for", "--step", "--every"] {
        let ran = patchcord(&["run", FIG_8_16, option, "-1e-3"]);
        assert_eq!(code(&ran), 2);
        let told = errors(&ran);
        assert!(told.contains("a time above 0 s is wanted") && !told.contains("tip:"), "{told}");
    }
    for times in ["-1", "0", "1.5"] {
        let told = errors(&patchcord(&["run", FIG_8_16, "--repeat", times]));
        assert!(told.contains("a whole number from 1 to 4294967295 is wanted"), "{told}");
    }
    let told = errors(&patchcord(&["run", FIG_8_16, "--for", "0.1", "--repeat", "1000000"]));
    assert!(told.contains("; at most 2e8 are allowed") && told.contains("or repeat it less"), "{told}");
}

#[test]
fn more_steps_than_anybody_waits_for_are_told_with_their_time() {
    let told = errors(&patchcord(&["run", FIG_8_16, "--step", "1e-11"]));
    let steps =
        "the run would take 8.4667e11 steps, 10 days at a million steps a second; at most 1e10 are allowed";
    assert!(told.contains(steps) && told.contains("give a longer --step or a shorter --for"), "{told}");
    let told = errors(&patchcord(&["run", FIG_8_16, "--step", "5e-10"]));
    assert!(told.contains("1.69334e10 steps, 5 hours at"), "{told}");
}

#[test]
fn check_tells_what_keeps_a_patch_from_being_run() {
    let run = "{\"for\": 3.25, \"step\": 1e-3}";
    let (_folder, file) = spring_with(run, "{\"step\": 1e-3}");
    let told = out(&patchcord(&["check", &file]));
    let wanted = "cannot be run as it stands: the patch's \"run\" does not give the length of the run (\"for\"); \
                  to `patchcord run` give --for\n";
    assert!(told.contains(wanted), "{told}");
    let document = json(&patchcord(&["check", &file, "--json"]));
    assert_eq!((&document["ok"], &document["cannot_be_run"]["code"]), (&true.into(), &"missing-time".into()));
    let (_folder, file) = spring_with(run, "{\"for\": 3.25, \"step\": 1e-12}");
    let told = out(&patchcord(&["check", &file]));
    assert!(told.contains("cannot be run as it stands: the run would take 3.25e12 steps, 38 days"), "{told}");
    assert!(json(&patchcord(&["check", FIG_8_16, "--json"]))["cannot_be_run"].is_null());
}

/// Numbers drawn every nanosecond, for 100 s.
const TOO_FINE: &str = r#"{"patchcord": 1, "title": "fine noise", "scales": {"volt": {"per_volt": 1, "unit": "V"}},
    "drives": {"u": {"kind": "noise", "scale": "volt", "rms": 1, "every": 1e-9, "seed": 1}},
    "elements": {"L": {"kind": "inverter", "in": "u"}}, "run": {"for": 100, "step": 0.01}}"#;

#[test]
fn check_tells_what_only_a_ready_machine_shows() {
    let folder = tempfile::tempdir().unwrap();
    let file = path(&folder, "noise.json");
    fs::write(&file, TOO_FINE).unwrap();
    let document = json(&patchcord(&["check", &file, "--json"]));
    assert_eq!(document["cannot_be_run"]["code"], "noise-too-fine");
}

/// -1000 V by a voltage that falls from 50 V through 0 within the run.
const DIVISION: &str = r#"{"patchcord": 1, "title": "division", "machine": "unlimited", "elements": {
    "D": {"kind": "integrator", "in": {"x1": ["+100"]}, "initial": 50},
    "M": {"kind": "multiplier", "mode": "product", "a": "A5", "b": "D"},
  "A5": {"kind": "open-amplifier", "in": {"x0.1": ["+100"], "x1": ["M"]}}
}, "record": ["A5"], "run": {"for": 1, "step": 0.01}}"#;

#[test]
fn a_loop_that_cannot_be_solved_within_a_run_is_told_with_its_place_and_advice() {
    let folder = tempfile::tempdir().unwrap();
    let file = path(&folder, "division.json");
    fs::write(&file, DIVISION).unwrap();
    let told = errors(&patchcord(&["run", &file]));
    assert!(told.contains("the loop M, A5 has no integrator and 3 solutions"), "{told}");
    assert!(told.contains("; what is fed back has to rise with the output"), "{told}");
    assert!(told.contains("division.json:4:3: A5\n"), "{told}");
}
