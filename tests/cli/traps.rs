//! Common traps of beginners: each patch in `tests/traps` gets the reports that are stored next to it.
//!
//! `PATCHCORD_BLESS=1 cargo test -p patchcord` rewrites the reports.

use std::fs;

use assert_cmd::Command;

use super::{FIG_8_16, errors, json, out, patchcord, path, without_elapsed_time};
use crate::common::files::{assert_up_to_date, json_files_in, repository_path};

/// The folder of the patches and their reports.
const FOLDER: &str = "tests/traps";

/// What a command prints about a patch of the folder: standard error first.
fn printed(command: &str, file: &str) -> String {
    let mut process = Command::cargo_bin("patchcord").unwrap();
    let process = process.env("PATCHCORD_PROGRESS", "0").current_dir(repository_path(FOLDER));
    let output = process.args([command, file]).output().unwrap();
    let text: String = out(&output).lines().map(|line| without_elapsed_time(line) + "\n").collect();
    format!("$ patchcord {command} {file}\n{}{text}\n", errors(&output))
}

#[test]
fn every_trap_has_its_reports() {
    let files = json_files_in(&repository_path(FOLDER));
    assert!(files.len() >= 6, "{files:?}");
    for patch in files {
        let stem = patch.file_stem().unwrap().to_str().unwrap();
        let file = format!("{stem}.json");
        let text = printed("check", &file) + &printed("run", &file);
        assert_up_to_date(&format!("{FOLDER}/{stem}.txt"), text.as_bytes(), "patchcord");
    }
}

#[test]
fn every_code_of_the_linear_analysis_has_a_trap() {
    for code in patchcord::linear::codes::ALL {
        let report = fs::read_to_string(repository_path(&format!("{FOLDER}/{}.txt", code.as_str()))).unwrap();
        assert!(report.contains(&format!("\nwarning[{}]: ", code.as_str())), "{report}");
    }
}

/// The traps of the comparison with equations.
const STATED: &str = "crates/equations/tests/patches/traps";

/// The drive has 5 rad/s or 47.7465 rpm, and the mass on its spring has 5 rad/s. So the amplitude rises to
/// F / (c w) = 400 mm. With 5 Hz it would stay below 12 mm.
#[test]
fn a_frequency_in_rad_per_s_or_rpm_is_not_taken_for_hertz() {
    for trap in ["a2", "a4"] {
        let document = json(&patchcord(&["run", &format!("{STATED}/{trap}.json"), "--json"]));
        let reading = &document["readings"][0];
        assert_eq!((&reading["signal"], &reading["unit"]), (&"x".into(), &"mm".into()));
        let most = reading["most"]["value"].as_f64().unwrap();
        assert!((most - 400.0).abs() < 1.0, "{trap}: {most}");
    }
}

/// The wiring is right, so the equations agree. The scales are wrong.
#[test]
fn a_patch_that_solves_its_equations_and_clips_gets_a_warning_and_lamps() {
    let file = format!("{STATED}/lv3.json");
    let checked = patchcord(&["check", &file]);
    assert!(out(&checked).contains("the wiring solves its 2 equations\n"), "{}", out(&checked));
    assert!(
        errors(&checked).starts_with("warning[initial-at-limit]: A2 begins at 100 V"),
        "{}",
        errors(&checked)
    );
    let text = out(&patchcord(&["run", &file]));
    assert!(text.contains("\noverload: A2") && text.contains("\noverload: A1"), "{text}");
    assert!(text.contains("let 1 V of pred at A2 represent 2 times as much"), "{text}");
}

#[test]
fn growth_that_is_declared_or_stated_is_no_trap() {
    let folder = tempfile::tempdir().unwrap();
    let run = r#""run": {"for": 3"#;
    let with = |key: &str| {
        let file = changed(&folder, "growing-loop", &[(run, &format!("{key}, {run}"))]);
        errors(&patchcord(&["check", &file]))
    };
    assert_eq!(with(r#""positive_feedback": true"#), "");
    assert_eq!(with(r#""equations": "m x'' = k x""#), "");
    assert!(with(r#""positive_feedback": false"#).starts_with("warning[growing-loop]: "));
}

/// A trap with these replacements, in a new file.
fn changed(folder: &tempfile::TempDir, stem: &str, replacements: &[(&str, &str)]) -> String {
    let text = fs::read_to_string(repository_path(&format!("{FOLDER}/{stem}.json"))).unwrap();
    let changed = replacements.iter().fold(text, |text, (old, new)| {
        assert_eq!(text.matches(old).count(), 1, "{old}: {text}");
        text.replace(old, new)
    });
    let file = path(folder, "changed.json");
    fs::write(&file, changed).unwrap();
    file
}

#[test]
fn the_gains_of_the_advice_remove_the_overload() {
    let folder = tempfile::tempdir().unwrap();
    let file = changed(
        &folder,
        "overload-of-a-gain",
        &[
            (r#""in": {"x10": ["A2"]}, "note": "10"#, r#""in": {"x10": ["P2"]}, "note": "1.25"#),
            (r#""P1": "#, r#""P2": {"kind": "pot", "in": "A2", "setting": 0.125}, "P1": "#),
            ("velocity / 100", "velocity / 100 * 8"),
        ],
    );
    let text = out(&patchcord(&["run", &file]));
    assert!(text.ends_with("; no overload\n") && !text.contains("peaks below"), "{text}");
    assert!(text.contains("x       mm       50   49.62"), "{text}");
}

#[test]
fn the_scale_of_the_advice_removes_the_trap_at_the_start() {
    let folder = tempfile::tempdir().unwrap();
    let file = changed(
        &folder,
        "initial-at-limit",
        &[(r#""pred": {"per_volt": 0.1"#, r#""pred": {"per_volt": 0.2"#)],
    );
    let ran = patchcord(&["run", &file]);
    assert_eq!(errors(&ran), "");
    // The prey needs a larger scale too: its largest number is 29, and full scale is 20.
    let text = out(&ran);
    assert!(text.contains("overload: A1") && !text.contains("overload: A2"), "{text}");
    assert!(text.contains("let 1 V of prey at A1 represent 2 times as much (\"per_volt\": 0.4"), "{text}");
}

#[test]
fn low_peaks_are_in_the_document_and_not_among_the_warnings() {
    let file = format!("{FOLDER}/low-peak.json");
    let document = json(&patchcord(&["run", &file, "--json"]));
    let low = document["low_peaks"].as_array().unwrap();
    let names: Vec<_> = low.iter().map(|peak| peak["element"].as_str().unwrap()).collect();
    assert_eq!(names, ["A2", "B1", "A1"]);
    // The amplitude is 50 mm, and the largest velocity is sqrt(k / m) times as large.
    let [position, velocity] = [0, 2].map(|index| low[index]["peak"].as_f64().unwrap());
    assert!((position - 2.0).abs() < 1e-9 && (velocity - 40f64.sqrt() * 0.5).abs() < 1e-4, "{low:?}");
    assert_eq!(document["diagnostics"].as_array().unwrap().len(), 0);
    // The position error of the slideway is amplified behind A6.
    let slideway = json(&patchcord(&["run", FIG_8_16, "--json"]));
    assert_eq!(slideway["low_peaks"].as_array().unwrap().len(), 1);
    assert_eq!(slideway["low_peaks"][0]["element"], "A6");
}

#[test]
fn the_lessons_fall_into_no_trap() {
    for file in json_files_in(&repository_path("patches/lessons")) {
        let file = file.to_str().unwrap();
        for command in ["check", "run"] {
            let ran = patchcord(&[command, file]);
            assert_eq!(errors(&ran), "", "{file}");
            assert!(!out(&ran).contains("peaks below"), "{file}: {}", out(&ran));
        }
    }
}
