//! `patchcord run`: readings, overloads, and why a run stops or cannot start.

use std::fs;

use super::sweep::STIFF;
use super::{
    FIG_8_16, code, errors, json, out, patchcord, patchcord_with_progress, path, spring, spring_with,
    without_elapsed_time,
};

#[test]
fn a_repeated_run_numbers_its_runs() {
    let folder = tempfile::tempdir().unwrap();
    let csv = path(&folder, "out.csv");
    assert_eq!(code(&patchcord(&["run", FIG_8_16, "--for", "0.002", "--repeat", "2", "--csv", &csv])), 0);
    let table = fs::read_to_string(&csv).unwrap();
    let rows: Vec<&str> = table.lines().filter(|line| !line.starts_with('#')).collect();
    assert!(rows[0].ends_with(",run"));
    assert_eq!(rows.len(), 7);
    let without_run = |row: &str| row.rsplit_once(',').unwrap().0.to_owned();
    assert_eq!(without_run(rows[3]), without_run(rows[6]));
    assert!(rows[1].ends_with(",1") && rows[6].ends_with(",2"));
}

#[test]
fn overloads_are_printed_with_their_causes() {
    let ran = patchcord(&["run", FIG_8_16, "--set", "x_step=0.127e-3", "--for", "0.1"]);
    assert_eq!(code(&ran), 0);
    let text = out(&ran);
    let lines: Vec<&str> = text.lines().filter(|line| line.starts_with("overload: ")).collect();
    assert!(lines.len() > 1 && lines[0].ends_with("(first)"), "{text}");
    assert!(lines[1].contains("caused by"), "{text}");
    let held =
        patchcord(&["run", FIG_8_16, "--set", "x_step=0.127e-3", "--for", "0.1", "--hold-on-overload"]);
    assert!(out(&held).contains("held at t = "), "{}", out(&held));
}

/// An integrator whose feedback leads through a lag. The lag changes its rate at the limit from 96 V/s to 90 V/s.
pub(super) const FEEDBACK_WITH_MEMORY: &str = r#"{"patchcord": 1, "title": "memory", "machine": "unlimited",
    "elements": {
    "P": {"kind": "pot", "in": "A", "setting": 0.1},
    "L": {"kind": "lag", "in": {"x1": ["P"]}, "time": 1},
    "N": {"kind": "inverter", "in": "L"},
    "A": {"kind": "integrator", "in": {"x1": ["-100", "N"]}}
}, "record": ["A"], "run": {"for": 20, "step": 0.01}}"#;

#[test]
fn an_overload_with_an_unknown_demand_does_not_depend_on_the_length_of_the_run() {
    let folder = tempfile::tempdir().unwrap();
    let file = path(&folder, "memory.json");
    fs::write(&file, FEEDBACK_WITH_MEMORY).unwrap();
    let line = "\noverload: A at t = 1.013656 s, driven into +100 V to the end, by up to 96.3 V/s (first)\n";
    for seconds in ["20", "100"] {
        let text = out(&patchcord(&["run", &file, "--for", seconds]));
        assert!(text.contains(line), "{text}");
    }
    let document = json(&patchcord(&["run", &file, "--json"]));
    let overload = &document["sweeps"][0]["overloads"][0];
    assert!(overload["peak"].is_null(), "{overload}");
    assert_eq!((&overload["driven"]["limit"], &overload["driven"]["to_end"]), (&100.0.into(), &true.into()));
}

/// The advice for an overload of A in this patch.
pub(super) const HALVED_GAINS: &str = "make A 2 times smaller: put a pot of 0.5 between -100 and A, put a pot of 0.5 \
                                       between N and A; then multiply by 2 where other amplifiers use it";

#[test]
fn a_run_with_overloads_says_once_what_to_do() {
    let folder = tempfile::tempdir().unwrap();
    let [scaled, bare] = ["scaled.json", "bare.json"].map(|name| path(&folder, name));
    let signal = r#""scales": {"position": {"per_volt": 1, "unit": "mm"}},
    "signals": {"x": {"at": "A", "scale": "position"}}"#;
    fs::write(&scaled, FEEDBACK_WITH_MEMORY.replace("\"record\": [\"A\"]", signal)).unwrap();
    fs::write(&bare, FEEDBACK_WITH_MEMORY).unwrap();
    let advice = |file: &str, remedy: &str| {
        let guess =
            "the voltage that A needs is not known, so repeat the run and the change until no lamp lights";
        format!("  = help: {remedy}; {guess}; `patchcord check {file} --scaling` compares scales and gains\n")
    };
    let of_scale = "let 1 V of x at A represent 2 times as much (\"per_volt\": 2 in place of 1 in the scale \"position\"), \
                    and adapt the gains";
    for (file, remedy) in [(&scaled, of_scale), (&bare, HALVED_GAINS)] {
        let text = out(&patchcord(&["run", file, "--repeat", "2"]));
        assert!(text.contains("run 2: overload: A"), "{text}");
        assert_eq!(text.matches(&advice(file, remedy)).count(), 1, "{text}");
    }
    let table = patchcord(&["run", &scaled, "--csv", "-"]);
    let once = |text: &str| text.matches(&advice(&scaled, of_scale)).count();
    assert_eq!([once(&errors(&table)), once(&out(&table))], [1, 0], "{}", errors(&table));
    let document = patchcord(&["run", &scaled, "--json"]);
    assert_eq!((&json(&document)["ok"], once(&out(&document))), (&true.into(), 0));
    let (_folder, file) = spring();
    assert!(!out(&patchcord(&["run", &file])).contains("--scaling"));
}

/// An oscillator that states its equations. The pot of the spring is at the inverse of x, so it pushes x away.
const WRONG_SIGN: &str = r#"{"patchcord": 1, "title": "wrong sign",
    "scales": {"position": {"per_volt": 1, "unit": "1"}},
    "elements": {
    "A1": {"kind": "integrator", "in": {"x1": ["B1"]}, "initial": 40},
    "P1": {"kind": "pot", "in": "B2", "setting": 0.4},
    "A2": {"kind": "integrator", "in": {"x10": ["P1"]}},
    "B1": {"kind": "inverter", "in": "A2"},
    "B2": {"kind": "inverter", "in": "A1"}
}, "signals": {"x": {"at": "A1", "scale": "position"}, "v": {"at": "A2", "scale": "position"}},
"equations": ["x' = v", "v' = -4 x"], "run": {"for": 3, "step": 0.001}}"#;

#[test]
fn the_advice_for_an_overload_names_an_equation_that_the_wiring_does_not_solve() {
    let folder = tempfile::tempdir().unwrap();
    let [wrong, right] = ["wrong.json", "right.json"].map(|name| path(&folder, name));
    fs::write(&wrong, WRONG_SIGN).unwrap();
    let text = out(&patchcord(&["run", &wrong]));
    let advice = format!(
        "  = help: the wiring does not solve the stated equation v' = -4 x: correct this before the scales, because \
         a wrong sign can cause the overload; `patchcord check {wrong}` says what differs\n"
    );
    assert!(text.contains(&advice), "{text}");
    // With the right sign, the velocity is too large: 2 * 80 V.
    let corrected = WRONG_SIGN.replace(r#""in": "B2""#, r#""in": "A1""#).replace("40}", "80}");
    fs::write(&right, corrected).unwrap();
    let text = out(&patchcord(&["run", &right]));
    assert!(text.contains("; `patchcord check ") && text.contains(" --scaling` compares"), "{text}");
    assert!(!text.contains("stated equation"), "{text}");
}

#[test]
fn readings_are_in_the_unit_of_the_patch() {
    let folder = tempfile::tempdir().unwrap();
    let file = path(&folder, "current.json");
    let patch = r#"{"patchcord": 1, "scales": {"current": {"per_volt": 0.005, "unit": "A"}},
        "elements": {"A1": {"kind": "integrator", "in": {"x1": ["A1"]}, "initial": 80}},
        "signals": {"i": {"at": "A1", "scale": "current"}}, "run": {"for": 1, "step": 0.001}}"#;
    fs::write(&file, patch).unwrap();
    let text = out(&patchcord(&["run", &file]));
    let rows = text.lines().filter(|line| line.starts_with("i "));
    let row: Vec<&str> = rows.flat_map(str::split_whitespace).collect();
    // 0.4 A / e
    assert_eq!(row, ["i", "A", "0.4", "0.1472", "0.1472", "1", "0.4", "0"], "{text}");
}

#[test]
fn an_overload_of_an_unstable_solver_gets_no_advice_about_scales() {
    let folder = tempfile::tempdir().unwrap();
    let file = path(&folder, "stiff.json");
    fs::write(&file, STIFF).unwrap();
    let printed = out(&patchcord(&["run", &file]));
    let with_table = errors(&patchcord(&["run", &file, "--csv", "-"]));
    for text in [printed, with_table] {
        assert!(text.contains("overload: F") && text.contains("the solver is unstable at F"), "{text}");
        assert!(!text.contains("per_volt") && !text.contains("--scaling"), "{text}");
    }
}

#[test]
fn readings_use_every_step_of_the_run() {
    let (_folder, file) = spring();
    let coarse = json(&patchcord(&["run", &file, "--every", "1", "--json"]));
    let fine = json(&patchcord(&["run", &file, "--json"]));
    assert_eq!((&coarse["samples"], &fine["samples"]), (&5.into(), &3251.into()));
    assert_eq!(coarse["readings"], fine["readings"]);
    let [x, t] = ["value", "t"].map(|key| coarse["readings"][0]["least"][key].as_f64().unwrap());
    assert!((x + 50.0).abs() < 1e-6 && ((t % 1.0) - 0.5).abs() < 2e-3, "{coarse}");
    assert!(coarse["readings"][0]["end"].as_f64().unwrap().abs() < 1e-6, "{coarse}");
}

#[test]
fn the_last_line_of_a_table_is_the_end_of_the_run() {
    let (folder, file) = spring();
    let csv = path(&folder, "out.csv");
    let times = |options: &[&str]| -> Vec<String> {
        assert_eq!(code(&patchcord(&[&["run", &file, "--csv", &csv], options].concat())), 0, "{options:?}");
        let table = fs::read_to_string(&csv).unwrap();
        let rows = table.lines().filter(|line| line.starts_with(|sign: char| sign.is_ascii_digit()));
        rows.map(|row| row.split(',').next().unwrap().to_owned()).collect()
    };
    assert_eq!(times(&["--every", "1"]), ["0", "1", "2", "3", "3.25"]);
    assert_eq!(times(&["--every", "1.25", "--tol", "1e-6"]), ["0", "1.25", "2.5", "3.25"]);
    assert_eq!(times(&["--for", "0.3", "--every", "0.1"]), ["0", "0.1", "0.2", "0.3"]);
    // 3 x 0.3 is 0.8999999999999999.
    assert_eq!(times(&["--for", "1.2", "--every", "0.3"]), ["0", "0.3", "0.6", "0.9", "1.2"]);
    let run = ["0", "0.1", "0.2", "0.25"];
    assert_eq!(times(&["--for", "0.25", "--every", "0.1", "--repeat", "2"]), [run, run].concat());
}

#[test]
fn a_run_that_stops_writes_its_record() {
    let folder = tempfile::tempdir().unwrap();
    let csv = path(&folder, "ball.csv");
    // A ball that never comes to rest bounces infinitely often.
    let endless = [
        "run",
        "crates/core/tests/patches/bouncing-ball.json",
        "--set",
        "v_rest=0",
        "--set",
        "e=0.5",
        "--csv",
        &csv,
    ];
    let ran = patchcord(&endless);
    assert_eq!((code(&ran), out(&ran).as_str()), (1, ""));
    assert!(errors(&ran).contains("it chatters; give it a larger \"rest\""), "{}", errors(&ran));
    let table = fs::read_to_string(&csv).unwrap();
    let last = table.lines().last().unwrap().split(',').next().unwrap();
    assert!(last.parse::<f64>().unwrap() > 1.0, "{last}");
    assert!(
        errors(&ran).contains(&format!("the files contain the run up to t = {last} s")),
        "{}",
        errors(&ran)
    );
    let text = json(&patchcord(&[&endless[..], &["--json"]].concat()));
    assert_eq!(
        (&text["ok"], &text["code"], &text["files"][0]),
        (&false.into(), &"chatter".into(), &csv.into())
    );
    assert_eq!(text["recorded_until"].to_string(), last);
}

#[test]
fn a_patch_without_a_run_checks_but_does_not_run() {
    let delay = r#""B1": {"kind": "summer", "in": {"x1": ["D1"]}}, "D1": {"kind": "delay", "in": "A2", "delay": 1e-6}"#;
    let lag = r#""B1": {"kind": "lag", "in": {"x1": ["A2"]}, "time": 1e-6}"#;
    [delay, lag].into_iter().for_each(check_missing_run);
}

/// The test for a spring whose inverter is replaced by elements that need a short step.
fn check_missing_run(inverter: &str) {
    let (_folder, file) = spring_with(r#""B1": {"kind": "summer", "in": {"x1": ["A2"]}}"#, inverter);
    let text = fs::read_to_string(&file).unwrap();
    fs::write(&file, text.replace(",\n  \"run\": {\"for\": 3.25, \"step\": 1e-3}", "")).unwrap();
    let ran = patchcord(&["run", &file]);
    assert_eq!(code(&ran), 2);
    assert!(errors(&ran).contains("give --for and --step or --tol"), "{}", errors(&ran));
    let checked = patchcord(&["check", &file]);
    assert_eq!((code(&checked), errors(&checked).as_str()), (0, ""));
    let ran = patchcord(&["run", &file, "--for", "1", "--step", "1e-3"]);
    assert_eq!(code(&ran), 2);
    assert!(
        errors(&ran).contains("give a step with --step, or a tolerance with --tol\n  --> "),
        "{}",
        errors(&ran)
    );
}

#[test]
fn names_to_record_may_be_separated_by_blanks() {
    let (_folder, file) = spring();
    let ran = json(&patchcord(&["run", &file, "--record", "x, A1", "--json"]));
    let names: Vec<_> =
        ran["readings"].as_array().unwrap().iter().map(|reading| &reading["signal"]).collect();
    assert_eq!(names, ["x", "A1"]);
    assert_eq!(ran["sweeps"][0]["switchings"], 0);
}

#[test]
fn a_ball_at_rest_has_the_reading_0() {
    let ran = patchcord(&["run", "crates/core/tests/patches/bouncing-ball.json", "--set", "e=0.5"]);
    let text = out(&ran);
    let height = text.lines().find(|line| line.starts_with("height")).unwrap();
    assert_eq!(height.split_whitespace().nth(3), Some("0"), "{text}");
}

#[test]
fn an_overload_fails_on_request_after_everything_is_written() {
    let folder = tempfile::tempdir().unwrap();
    let csv = path(&folder, "out.csv");
    let overloaded =
        ["run", FIG_8_16, "--set", "x_step=0.127e-3", "--for", "0.1", "--fail-on-overload", "--csv", &csv];
    let ran = patchcord(&overloaded);
    assert_eq!(code(&ran), 3);
    let (text, message) = (out(&ran), errors(&ran));
    assert!(text.contains("\noverload: ") && text.contains(&format!("\nwrote {csv}\n")), "{text}");
    assert!(message.starts_with("error: overload of ") && message.contains(" more: "), "{message}");
    assert!(fs::read_to_string(&csv).unwrap().contains("# v_o: m/s\n"));
    let document = patchcord(&[&overloaded[..], &["--json"]].concat());
    assert_eq!((code(&document), &json(&document)["ok"]), (3, &false.into()));
    assert!(!json(&document)["sweeps"][0]["overloads"].as_array().unwrap().is_empty());
    assert!(json(&document)["error"].as_str().unwrap().starts_with("overload of "));
    let (_folder, file) = spring();
    assert_eq!(code(&patchcord(&["run", &file, "--fail-on-overload"])), 0);
    assert!(out(&patchcord(&["--help"])).contains("--fail-on-overload"));
}

#[test]
fn a_run_without_a_picture_says_how_to_get_one() {
    let (folder, file) = spring();
    let text = out(&patchcord(&["run", &file]));
    let hint = "no picture: add --plot FILE.svg or --plot FILE.png to draw the curves\n";
    assert!(text.contains(hint), "{text}");
    let svg = path(&folder, "spring.svg");
    let drawn = out(&patchcord(&["run", &file, "--plot", &svg]));
    assert!(!drawn.contains("no picture") && !drawn.contains("\n\n\n"), "{drawn}");
    assert!(!out(&patchcord(&["run", &file, "--json"])).contains("no picture"));
}

#[test]
fn a_patch_without_a_title_is_named_by_its_file() {
    let (_folder, file) = spring_with("  \"title\": \"Mass on a spring\",\n", "");
    for command in ["run", "linearise"] {
        let text = out(&patchcord(&[command, &file]));
        assert!(text.starts_with(&format!("{file}\n\n")) && !text.contains("\n\n\n"), "{command}: {text}");
    }
}

#[test]
fn output_that_is_no_terminal_has_no_colours() {
    let ran = patchcord(&["run", FIG_8_16, "--set", "x_step=0.127e-3", "--for", "0.1"]);
    assert!(!out(&ran).contains('\u{1b}'), "{}", out(&ran));
}

#[test]
fn the_last_line_has_the_simulated_time_and_the_number_of_overloads() {
    let (folder, file) = spring();
    let csv = path(&folder, "out.csv");
    let last = |arguments: &[&str]| {
        let text = out(&patchcord(&[&["run"], arguments].concat()));
        without_elapsed_time(text.lines().last().unwrap())
    };
    assert_eq!(last(&[&file]), "3.25 s simulated in N s; no overload");
    assert_eq!(last(&[&file, "--csv", &csv]), "3.25 s simulated in N s; no overload");
    let repeated = last(&[&file, "--for", "0.01", "--repeat", "3"]);
    assert_eq!(repeated, "0.03 s in 3 runs, simulated in N s; no overload");
    let overloaded = [FIG_8_16, "--set", "x_step=0.127e-3", "--for", "0.1"];
    let document = json(&patchcord(&[&["run", "--json"], &overloaded[..]].concat()));
    let count = document["sweeps"][0]["overloads"].as_array().unwrap().len();
    assert_eq!(last(&overloaded), format!("0.1 s simulated in N s; {count} overloads"));
    // The time that a run took is in no file and in no document.
    assert!(!fs::read_to_string(csv).unwrap().contains("simulated"));
    assert!(!document.to_string().contains("simulated"));
}

#[test]
fn the_work_of_the_solver_is_printed_on_request() {
    let (_folder, file) = spring();
    assert!(!out(&patchcord(&["run", &file])).contains("evaluations"));
    let work = json(&patchcord(&["run", &file, "--json"]))["sweeps"][0].clone();
    let [steps, switchings, kinks, evaluations] =
        ["steps", "switchings", "kinks", "evaluations"].map(|key| work[key].as_u64().unwrap());
    let line =
        format!("\n{steps} steps, {switchings} switchings, {kinks} kinks, {evaluations} evaluations\n");
    let text = out(&patchcord(&["run", &file, "--verbose"]));
    assert!(text.contains(&line), "{line}{text}");
}

#[test]
fn a_long_run_reports_its_progress_in_plain_lines() {
    let ran = patchcord_with_progress("0.001", &["run", FIG_8_16]);
    let lines = errors(&ran);
    assert_eq!(code(&ran), 0, "{lines}");
    let is_progress = |line: &str| line.starts_with("run: ") && line.contains(" s simulated");
    assert!(!lines.is_empty() && lines.lines().all(is_progress), "{lines}");
    assert_eq!(errors(&patchcord(&["run", FIG_8_16])), "");
}

#[test]
fn a_wrong_interval_of_the_progress_is_refused() {
    for text in ["often", "1e-9", "-1"] {
        let refused = patchcord_with_progress(text, &["run", FIG_8_16, "--json"]);
        let message = errors(&refused);
        assert_eq!((code(&refused), message.lines().count()), (2, 1), "{message}");
        assert!(message.starts_with("error: the environment variable PATCHCORD_PROGRESS must"), "{message}");
        assert!(json(&refused)["error"].as_str().unwrap().ends_with(&format!("not \"{text}\"")));
    }
}

#[test]
fn a_run_with_an_automatic_step_says_which_step_it_found() {
    let (_folder, file) = spring();
    let text = out(&patchcord(&["run", &file, "--step", "auto"]));
    let step =
        text.lines().find_map(|line| line.strip_suffix(" s, found by --step auto")?.strip_prefix("step "));
    assert!(step.is_some_and(|step| step.parse::<f64>().is_ok_and(|step| step > 0.0)), "{text}");
    assert!(!out(&patchcord(&["run", &file])).contains("found by"));
}
