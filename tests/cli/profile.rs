//! `patchcord profile`.

use std::fs;

use serde_json::Value;

use super::sweep::STIFF;
use super::{FIG_8_16, code, errors, json, out, patchcord, path};

const PAGE: &str = "docs/profile.md";
/// Solid friction that decreases slowly with velocity: oscillation without standstill.
const SLOW_FALL: [&str; 8] =
    ["profile", FIG_8_16, "--set", "VcL=12.7e-3", "--set", "Tc=0.009", "--set", "v_rate=2.4e-3"];
/// A rising and a falling ramp.
const FALLING: [&str; 9] =
    ["profile", FIG_8_16, "--set", "VcL=5.08e-3", "--set", "v_turn=7", "--for", "14", "--falling"];

/// The tables of points and sections that a command prints.
fn printed(arguments: &[&str]) -> String {
    let text = out(&patchcord(arguments));
    text.split_once("\n\n").unwrap().1.to_owned()
}

#[test]
fn the_page_shows_what_the_command_prints() {
    let page = fs::read_to_string(PAGE).unwrap();
    let mut fresh = page.clone();
    for (index, command) in [&["profile", FIG_8_16][..], &SLOW_FALL, &FALLING].into_iter().enumerate() {
        assert!(page.contains(&format!("    patchcord {}", command.join(" "))), "{command:?}");
        let block = fresh.split("```text\n").nth(index + 1).and_then(|rest| rest.split("```").next());
        let block = format!("```text\n{}```", block.unwrap());
        fresh = fresh.replacen(&block, &format!("```text\n{}```", printed(command)), 1);
    }
    if std::env::var_os("PATCHCORD_BLESS").is_some() {
        fs::write(PAGE, &fresh).unwrap();
    }
    let page = fs::read_to_string(PAGE).unwrap();
    assert!(page == fresh, "{PAGE} is stale: PATCHCORD_BLESS=1 cargo test -p patchcord rewrites it");
}

#[test]
fn points_and_sections_are_drawn_and_printed() {
    let folder = tempfile::tempdir().unwrap();
    let (svg, png) = (path(&folder, "profile.svg"), path(&folder, "profile.png"));
    let done = patchcord(&["profile", FIG_8_16, "--plot", &svg]);
    assert_eq!((code(&done), errors(&done).as_str()), (0, ""));
    assert!(out(&done).ends_with(&format!("\nwrote {svg}\n")), "{}", out(&done));
    let picture = fs::read_to_string(&svg).unwrap();
    for part in [
        "velocity profile",
        "1, 2, 3",
        "C stick-slip",
        "D oscillation dies away",
        "v_o, mm/s",
        "VcL 2.54 mm/s",
    ] {
        assert!(picture.contains(part), "{part}");
    }
    assert_eq!(code(&patchcord(&["profile", FIG_8_16, "--plot", &png])), 0);
    assert!(fs::read(&png).unwrap().starts_with(b"\x89PNG"));
}

fn point(document: &Value, number: usize) -> &Value {
    &document["profile"]["points"][number - 1]
}

#[test]
fn the_document_has_points_and_reasons_for_missing_points() {
    let document = json(&patchcord(&["profile", FIG_8_16, "--json"]));
    let profile = &document["profile"];
    assert_eq!((&profile["unit"], &profile["standstill"]), (&"m/s".into(), &0.125e-3.into()));
    assert_eq!(point(&document, 3)["coincides"], 2);
    let upper = point(&document, 5)["command"].as_f64().unwrap();
    assert!((upper - 4.54e-3).abs() < 0.02e-3, "{upper}");
    let range = &profile["critical_velocity"];
    assert_eq!(range["value"].as_f64(), Some(upper));
    assert!(range["least"].as_f64().unwrap() < upper && upper < range["most"].as_f64().unwrap());
    assert_eq!(profile["sections"][0]["why"], "points 1 and 2 coincide");
    let frequency = profile["sections"][3]["frequency"][1].as_f64().unwrap();
    assert!((frequency - 51.3).abs() < 0.5, "{frequency}");

    let document = json(&patchcord(&[&SLOW_FALL[..], &["--json"]].concat()));
    let why = "no three cycles in a row reach standstill";
    assert_eq!((&point(&document, 3)["there"], &point(&document, 3)["why"]), (&false.into(), &why.into()));
    assert_eq!(document["profile"]["sections"][1]["there"], true);

    let document = json(&patchcord(&["profile", FIG_8_16, "--for", "2", "--json"]));
    assert_eq!(point(&document, 5)["why"], "the oscillation continues to the end of the ramp");
    assert!(document["profile"]["critical_velocity"].is_null());
}

#[test]
fn the_falling_ramp_has_the_falling_critical_velocity() {
    let document = json(&patchcord(&[&FALLING[..], &["--json"]].concat()));
    let profile = &document["profile"];
    assert_eq!(
        (&profile["way"], &point(&document, 5)["what"]),
        (&"falling".into(), &"oscillation begins".into())
    );
    let coincide: Vec<_> = (1..=3).map(|number| point(&document, number)["coincides"].clone()).collect();
    assert_eq!(coincide, [Value::Null, 1.into(), 2.into()]);
    let (upper, rest) = (point(&document, 5), point(&document, 1));
    assert!(upper["t"].as_f64() < rest["t"].as_f64() && rest["command"].as_f64() < upper["command"].as_f64());
    let measures = ["critical_velocity", "first_oscillation", "profile_falling", "profile"];
    let options: Vec<_> = measures.iter().flat_map(|measure| ["--measure", measure]).collect();
    let run = ["sweep", FIG_8_16, "--vary", "VcL=5.08e-3", "--set", "v_turn=7", "--for", "14"];
    let rows = out(&patchcord(&[&run[..], &options].concat()));
    let cells: Vec<f64> =
        rows.lines().last().unwrap().split(',').filter_map(|cell| cell.parse().ok()).collect();
    let [_, rising, falling, first, begins] = cells[..5] else { panic!("{rows}") };
    let (back, forth) = (&cells[5..10], &cells[10..15]);
    assert_eq!((upper["command"].as_f64(), begins, back[4]), (Some(falling), falling, falling));
    assert_eq!((forth[1], forth[4]), (first, rising));
    assert!(profile["critical_velocity"]["value"].as_f64() == Some(falling) && falling < rising);
    let text = printed(&FALLING[..FALLING.len() - 1]);
    let page = fs::read_to_string(PAGE).unwrap();
    for number in ["9.92", "5.207"] {
        assert!(text.contains(number) && page.contains(number), "{text}");
    }
}

#[test]
fn an_incomplete_falling_ramp_has_a_note_with_its_length() {
    let cut = ["profile", FIG_8_16, "--set", "v_turn=7", "--falling"];
    let text = printed(&cut);
    let note = "note: the run ends at 6.64 mm/s, before the command is back at 0: give --for 14\n";
    assert!(text.ends_with(note), "{text}");
    assert_eq!(printed(&FALLING).matches("note: ").count(), 0);
    let document = json(&patchcord(&[&cut[..], &["--json"]].concat()));
    assert!(document["profile"]["note"].as_str().unwrap().ends_with("give --for 14"));
    // The run ends three windows after the oscillation starts.
    let text = printed(&[&FALLING[..4], &["--set", "v_turn=7", "--for", "11.82", "--falling"]].concat());
    assert!(text.contains("the ramp or the run ends before there are enough cycles to decide"), "{text}");
}

#[test]
fn the_picture_of_a_falling_ramp_is_labelled() {
    let folder = tempfile::tempdir().unwrap();
    let svg = path(&folder, "back.svg");
    assert_eq!(code(&patchcord(&[&FALLING[..], &["--plot", &svg]].concat())), 0);
    assert!(fs::read_to_string(&svg).unwrap().contains("friction memory: command falling"));
}

#[test]
fn ports_of_instances_are_signals() {
    let lags = "crates/core/tests/patches/lags-in-macros.json";
    let ports = ["--signals", "W.between,L.minus", "--threshold", "100", "--every", "1e-3"];
    let done = patchcord(&[&["profile", lags], &ports[..], &["--json"]].concat());
    let profile = &json(&done)["profile"];
    assert_eq!((&profile["command"], &profile["velocity"]), (&"W.first.A1".into(), &"L.B1".into()));
    assert_eq!(profile["points"][4]["why"], "the velocity does not oscillate");
}

#[test]
fn an_interval_reports_failed_criteria() {
    // The command turns too early for two criteria: half the threshold, and twice the window.
    let text = out(&patchcord(&["profile", FIG_8_16, "--set", "v_turn=4", "--for", "8"]));
    assert!(text.contains(" mm/s, 2 of 4 other criteria failed\n"), "{text}");
}

#[test]
fn other_criteria_find_other_points() {
    let at = |number: usize, more: &[&str]| {
        let document = json(&patchcord(&[&["profile", FIG_8_16, "--json"], more].concat()));
        point(&document, number)["command"].as_f64().unwrap()
    };
    assert!(at(5, &["--threshold", "1e-3"]) < at(5, &[]));
    assert!(at(4, &["--standstill", "1e-3"]) > at(4, &[]));
}

#[test]
fn a_step_that_is_too_long_is_reported_without_a_profile() {
    let folder = tempfile::tempdir().unwrap();
    let patch = path(&folder, "stiff.json");
    fs::write(&patch, STIFF).unwrap();
    let command = ["profile", &patch, "--signals", "S,F", "--threshold", "1"];
    for options in [&[][..], &["--json"]] {
        let failed = patchcord(&[&command[..], options].concat());
        let message = errors(&failed);
        assert_eq!(code(&failed), 1, "{message}");
        assert!(message.starts_with("warning: the step of 0.003 s is too long"), "{message}");
        assert!(message.contains("\nerror: no velocity profile: "), "{message}");
    }
}

/// The error of a run in which the command is constant.
const NO_CHANGE: &str = "no velocity profile: the command does not change\n";

/// Arguments of unusable runs, exit codes, and parts of the messages.
const UNUSABLE_RUNS: &[(&[&str], i32, &str)] = &[
    (&["patches/lessons/stick-slip.json"], 2, "the patch has no signal v_i: give --signals COMMAND,VELOCITY"),
    (&[FIG_8_16, "--signals", "v_i"], 2, "must be two names"),
    (&[FIG_8_16, "--signals", "v_i,v_p"], 2, "no signal v_p: give --signals COMMAND,VELOCITY; did you mean"),
    (&[FIG_8_16, "--signals", "v_i,x_error"], 2, "v_i in m/s and x_error in m do not have the same unit"),
    (&[FIG_8_16, "--signals", "x_error,x_error"], 2, "x_error in m is not a velocity: give --threshold"),
    (&[FIG_8_16, "--set", "v_rate=0"], 1, NO_CHANGE),
    (&[FIG_8_16, "--set", "v_rate=0", "--falling"], 1, NO_CHANGE),
    (
        &[FIG_8_16, "--set", "v_start=9e-3", "--set", "v_rate=-1e-3"],
        1,
        "does not rise steadily: use --falling for a command that falls\n",
    ),
    (
        &[FIG_8_16, "--falling"],
        1,
        "the command never falls in this run: make it turn with --set v_turn=SECONDS, and run twice as \
         long with --for\n",
    ),
    (
        &[FIG_8_16, "--set", "v_rate=0.02"],
        1,
        "no velocity profile: the command alone changes by 780 µm/s within a window: it must stay below \
         the threshold: give a higher --threshold, or a slower command with --set\n",
    ),
    (
        &[FIG_8_16, "--window", "1e-9"],
        1,
        "at least 8 are needed: give a shorter --every or a longer --window\n",
    ),
    (&[FIG_8_16, "--window", "9"], 1, "window of 9 s exceeds the run of 8.4667 s: give a shorter --window\n"),
    (&[FIG_8_16, "--every", "0.01"], 1, "a window has 4 samples, at least 8 are needed"),
    (
        &[FIG_8_16, "--every", "0.005", "--window", "0.04"],
        1,
        "samples, at least 8 are needed: give a shorter --every\n",
    ),
    (&[FIG_8_16, "--plot", "profile.txt"], 2, "profile.txt"),
    (&[FIG_8_16, "--plot", FIG_8_16], 2, ""),
    (&["patches/none.json"], 1, "none.json"),
];

/// Asserts that `patchcord profile` with these arguments gives only an error with this exit code and message.
fn assert_error(arguments: &[&str], exit: i32, message: &str) {
    let done = patchcord(&[&["profile"], arguments].concat());
    assert!(errors(&done).contains(message), "{arguments:?}: {}", errors(&done));
    assert_eq!((code(&done), out(&done).as_str()), (exit, ""), "{arguments:?}");
}

#[test]
fn unusable_runs_return_errors_with_advice() {
    for (arguments, exit, message) in UNUSABLE_RUNS {
        assert_error(arguments, *exit, message);
    }
    let document = json(&patchcord(&["profile", FIG_8_16, "--set", "v_rate=0", "--json"]));
    assert_eq!(document["ok"], false);
}

#[test]
fn wrong_criteria_return_errors_with_advice() {
    for option in ["--threshold", "--window", "--standstill"] {
        for value in ["0", "-1"] {
            assert_error(&[FIG_8_16, option, value], 2, "must be a positive number");
        }
        for value in ["nan", "inf"] {
            assert_error(&[FIG_8_16, option, value], 2, "is not a finite number");
        }
        let reason =
            if option == "--window" { "\"1mm\" is in mm, but s is expected" } else { "without the unit mm" };
        assert_error(&[FIG_8_16, option, "1mm"], 2, reason);
    }
    let still = "no velocity profile: the run reaches only 10.16 mm/s, and velocities up to";
    for (option, example) in [("--threshold", "0.00025"), ("--standstill", "0.000125")] {
        let advice = format!("give a lower value, in m/s, such as {option} {example}\n");
        assert_error(&[FIG_8_16, option, "0.25"], 1, &advice);
        assert_error(&[FIG_8_16, option, "0.25"], 1, still);
    }
}
