//! Errors before and during a run, with advice and the place in the patch.

use std::fs;

use super::{FIG_8_16, code, errors, json, out, patchcord, path, spring, spring_with};

#[test]
fn negative_times_return_a_clear_error() {
    for option in ["--for", "--step", "--every"] {
        let ran = patchcord(&["run", FIG_8_16, option, "-1e-3"]);
        assert_eq!(code(&ran), 2);
        let message = errors(&ran);
        assert!(
            message.contains("must be a positive time in seconds") && !message.contains("tip:"),
            "{message}"
        );
    }
    for times in ["-1", "0", "1.5"] {
        let message = errors(&patchcord(&["run", FIG_8_16, "--repeat", times]));
        assert!(message.contains("must be an integer from 1 to 4294967295"), "{message}");
    }
    let message = errors(&patchcord(&["run", FIG_8_16, "--for", "0.1", "--repeat", "5000000"]));
    assert!(
        message.contains("; at most 1e10 are allowed") && message.contains("fewer repetitions"),
        "{message}"
    );
}

#[test]
fn wrong_units_return_the_expected_unit() {
    let cases = [
        (["--step", "1mm"], "\"1mm\" is in mm, but s is expected\n"),
        (["--for", "soon"], "\"soon\" is not a number: give the value in s\n"),
        (["--set", "M=433s"], "--set M: \"433s\" is in s, but kg is expected\n"),
        (["--tol", "1e-6V"], "\"1e-6V\" is a voltage, but the tolerance is a share of 100 V: write 1e-8\n"),
    ];
    for (options, expected) in cases {
        let ran = patchcord(&[&["run", FIG_8_16], &options[..]].concat());
        assert_eq!(code(&ran), 2);
        assert!(errors(&ran).contains(expected), "{}", errors(&ran));
    }
}

/// The range is that of the number that the user writes, for every length of the run.
#[test]
fn tolerances_have_the_same_range_in_the_patch_and_on_the_command_line() {
    for (tolerance, expected_patch, expected_option) in
        [("1e-14", 1, 2), ("1e-13", 0, 0), ("1", 0, 0), ("1.5", 1, 2), ("1e300", 1, 2)]
    {
        let run = format!("\"for\": 0.25, \"tolerance\": {tolerance}");
        let (_folder, file) = spring_with("\"for\": 3.25, \"step\": 1e-3", &run);
        let of_patch = patchcord(&["run", &file]);
        assert_eq!(code(&of_patch), expected_patch, "{tolerance}: {}", errors(&of_patch));
        if expected_patch == 1 {
            let wanted = format!("\"tolerance\" must be from 1e-13 to 1, not {tolerance}\n");
            assert!(errors(&of_patch).contains(&wanted), "{}", errors(&of_patch));
            assert!(errors(&of_patch).contains("spring.json:12:37"), "{}", errors(&of_patch));
        }
        let (_folder, file) = spring();
        let of_option = patchcord(&["run", &file, "--tol", tolerance]);
        assert_eq!(code(&of_option), expected_option, "{tolerance}: {}", errors(&of_option));
    }
}

#[test]
fn a_step_longer_than_the_run_returns_the_option_to_change() {
    let message = errors(&patchcord(&["run", FIG_8_16, "--for", "3", "--step", "50"]));
    assert!(
        message.contains("the step is 50 s, longer than the run of 3 s: give a shorter --step\n"),
        "{message}"
    );
}

#[test]
fn too_many_steps_are_reported_with_their_duration() {
    let message = errors(&patchcord(&["run", FIG_8_16, "--step", "1e-11"]));
    let steps =
        "the run would take 8.4667e11 steps, 10 days at a million steps a second; at most 1e10 are allowed";
    assert!(
        message.contains(steps)
            && message.contains("give a longer --step, a shorter --for or fewer repetitions"),
        "{message}"
    );
    let message = errors(&patchcord(&["run", FIG_8_16, "--step", "5e-10"]));
    assert!(message.contains("1.69334e10 steps, 5 hours at"), "{message}");
    // The quotient is too large for a floating-point number.
    let message = errors(&patchcord(&["run", FIG_8_16, "--for", "1e300", "--step", "1e-300"]));
    assert!(
        message.contains("the run would take more than 1e308 steps; at most 1e10 are allowed: give"),
        "{message}"
    );
}

#[test]
fn check_reports_why_a_patch_cannot_be_run() {
    let run = "{\"for\": 3.25, \"step\": 1e-3}";
    let (_folder, file) = spring_with(run, "{\"step\": 1e-3}");
    let message = out(&patchcord(&["check", &file]));
    let wanted = "cannot be run: the patch's \"run\" does not give the length of the run (\"for\": SECONDS); \
                  with `patchcord run`, give --for\n";
    assert!(message.contains(wanted), "{message}");
    let document = json(&patchcord(&["check", &file, "--json"]));
    assert_eq!((&document["ok"], &document["cannot_be_run"]["code"]), (&true.into(), &"missing-time".into()));
    let (_folder, file) = spring_with(run, "{\"for\": 3.25, \"step\": 1e-12}");
    let message = out(&patchcord(&["check", &file]));
    assert!(message.contains("cannot be run: the run would take 3.25e12 steps, 38 days"), "{message}");
    assert!(json(&patchcord(&["check", FIG_8_16, "--json"]))["cannot_be_run"].is_null());
}

/// Samples stay in memory only for pictures of derivatives against a signal, which have no curves.
#[test]
fn only_a_run_with_derivatives_against_a_signal_is_refused_for_the_memory_of_its_samples() {
    let run = "{\"for\": 3.25, \"step\": 1e-3}";
    // 3.25e8 samples, and 9.75e10 numbers.
    let with_interval = |every: &str| {
        let more = r#""parameters": {"w": {"value": 0.394784176, "unit": "1", "range": [0.1, 0.9]}},
  "pictures": [{"x": "x", "y": ["d x / d w"]}]"#;
        let run_and_more = format!("{{\"for\": 3.25, \"step\": 1e-3, \"every\": {every}}},\n  {more}");
        let (folder, file) = spring_with(run, &run_and_more);
        let text = fs::read_to_string(&file).unwrap();
        fs::write(&file, text.replace("\"setting\": 0.394784176", "\"setting\": \"w\"")).unwrap();
        (folder, file)
    };
    let (folder, file) = with_interval("1e-8");
    assert!(json(&patchcord(&["check", &file, "--json"]))["cannot_be_run"].is_null());
    let plot = path(&folder, "x.svg");
    let refused = patchcord(&["run", &file, "--plot", &plot, "--json"]);
    assert_eq!((code(&refused), &json(&refused)["code"]), (1, &"too-many-numbers".into()));
    let wanted = "would record 3.25e8 samples; at most 2173910 are allowed with pictures that need every sample, \
                  because one is against a signal: give a longer --every";
    assert!(errors(&refused).contains(wanted), "{}", errors(&refused));
    // An option causes the same error.
    assert_eq!(code(&patchcord(&["run", &file, "--every", "1e-7", "--plot", &plot])), 2);
    assert!(!fs::exists(&plot).unwrap());
    let (_folder, file) = with_interval("1e-10");
    let message = out(&patchcord(&["check", &file]));
    assert!(message.contains("9.75e10 numbers; at most 1e10 are allowed"), "{message}");
}

/// A new random number every nanosecond for 100 s.
const TOO_FINE: &str = r#"{"patchcord": 1, "title": "fine noise", "scales": {"volt": {"per_volt": 1, "unit": "V"}},
    "drives": {"u": {"kind": "noise", "scale": "volt", "rms": 1, "every": 1e-9, "seed": 1}},
    "elements": {"L": {"kind": "inverter", "in": "u"}}, "run": {"for": 100, "step": 0.01}}"#;

#[test]
fn check_reports_errors_that_only_the_machine_detects() {
    let folder = tempfile::tempdir().unwrap();
    let file = path(&folder, "noise.json");
    fs::write(&file, TOO_FINE).unwrap();
    let document = json(&patchcord(&["check", &file, "--json"]));
    assert_eq!(document["cannot_be_run"]["code"], "noise-too-fine");
    let message = errors(&patchcord(&["run", &file]));
    let wanted = "u draws a number every 1e-9 s, 1e11 in the run, and each ends a step";
    assert!(message.contains(wanted), "{message}");
}

/// -1000 V by a voltage that falls from 50 V through 0 within the run.
pub(super) const DIVISION: &str = r#"{"patchcord": 1, "title": "division", "machine": "unlimited", "elements": {
    "D": {"kind": "integrator", "in": {"x1": ["+100"]}, "initial": 50},
    "M": {"kind": "multiplier", "mode": "product", "a": "A5", "b": "D"},
  "A5": {"kind": "open-amplifier", "in": {"x0.1": ["+100"], "x1": ["M"]}}
}, "record": ["A5"], "run": {"for": 1, "step": 0.01}}"#;

#[test]
fn an_unsolvable_loop_during_a_run_is_reported_with_place_and_advice() {
    let folder = tempfile::tempdir().unwrap();
    let file = path(&folder, "division.json");
    fs::write(&file, DIVISION).unwrap();
    let message = errors(&patchcord(&["run", &file]));
    assert!(message.contains("the loop M, A5 has no integrator and 3 solutions"), "{message}");
    assert!(message.contains("; the feedback must rise with the output"), "{message}");
    assert!(message.contains("division.json:4:3: A5\n"), "{message}");
}

/// A5 needs more than 100 V from t = 0.4 s on, and the loop has several solutions from t = 0.5 s on.
#[test]
fn overloads_before_an_error_are_printed() {
    let folder = tempfile::tempdir().unwrap();
    let (file, csv, svg) = (path(&folder, "division.json"), path(&folder, "x.csv"), path(&folder, "x.svg"));
    fs::write(&file, DIVISION).unwrap();
    let options: [&[&str]; 3] = [&[], &["--csv", &csv], &["--plot", &svg]];
    for options in options {
        let ran = patchcord(&[&["run", &file], options].concat());
        let message = errors(&ran);
        assert_eq!((code(&ran), out(&ran).as_str()), (1, ""), "{message}");
        let (overloads, error) = message.split_once("error: ").unwrap();
        assert!(overloads.contains("overload: A5 at t = 0.400"), "{message}");
        assert!(overloads.ends_with(" V (first)\n") && error.contains(" 3 solutions"), "{message}");
        let document = json(&patchcord(&[&["run", &file, "--json"], options].concat()));
        let overloads = document["sweeps"][0]["overloads"].as_array().unwrap();
        assert_eq!((overloads.len(), &overloads[0]["element"]), (1, &"A5".into()), "{document}");
        assert!((overloads[0]["t"].as_f64().unwrap() - 0.4).abs() < 1e-3, "{document}");
        assert!(!document["error"].as_str().unwrap().contains("overload"), "{document}");
    }
}
