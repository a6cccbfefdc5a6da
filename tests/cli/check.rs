//! `patchcord check`, compared with a run of the same patch.

use std::fs;

use crate::cli::{code, json, out, patchcord, path};

/// P has 30 V, and the summer S would need -300 V. P is read with factors and without a scale.
fn overdriven(folder: &tempfile::TempDir) -> String {
    let file = path(folder, "overdriven.json");
    let patch = r#"{
      "patchcord": 1,
      "parameters": {"share": {"value": 0.3, "unit": "1", "range": [0, 1]}, "spare": {"value": 0, "unit": "1"}},
      "elements": {
        "P": {"kind": "pot", "in": "+100", "setting": "share"},
        "S": {"kind": "summer", "in": {"x10": ["P"]}}
      },
      "signals": {"turned": {"at": "P", "factor": -1}, "twice": {"at": "P", "factor": 2}, "s": {"at": "S"}},
      "run": {"for": 1, "step": 0.1}
    }"#;
    fs::write(&file, patch).unwrap();
    file
}

#[test]
fn the_problem_check_reports_overloads() {
    let folder = tempfile::tempdir().unwrap();
    let file = overdriven(&folder);
    let report = patchcord(&["check", &file]);
    assert_eq!(code(&report), 0);
    assert!(
        out(&report).contains("overload: S at t = 0.000000 s, needs 300.0 V (first)"),
        "{}",
        out(&report)
    );
    let document = json(&patchcord(&["check", &file, "--json"]));
    assert_eq!(document["overloads"][0]["element"], "S");
    let quiet = patchcord(&["check", &file, "--set", "share=0.1"]);
    assert!(!out(&quiet).contains("overload"), "{}", out(&quiet));
}

#[test]
fn the_problem_check_reports_positions() {
    let thermostat = "patches/lessons/relay-thermostat.json";
    let report = out(&patchcord(&["check", thermostat, "--voltages"]));
    assert!(report.contains("volts  position") && report.contains("pulled-in"), "{report}");
    let document = json(&patchcord(&["check", thermostat, "--json"]));
    let relay = document["voltages"].as_array().unwrap().iter().find(|read| read["kind"] == "relay");
    assert_eq!(relay.unwrap()["position"], "pulled-in");
    let without = out(&patchcord(&["check", "patches/lessons/lorenz.json", "--voltages"]));
    assert!(!without.contains("position"), "{without}");
}

#[test]
fn a_factor_applies_without_a_scale() {
    let folder = tempfile::tempdir().unwrap();
    let file = overdriven(&folder);
    let document = json(&patchcord(&["run", &file, "--json"]));
    let ends: Vec<_> =
        document["readings"].as_array().unwrap().iter().map(|reading| &reading["end"]).collect();
    assert_eq!(ends, [-30.0, 60.0, -100.0]);
}

#[test]
fn a_parameter_set_to_0_is_printed() {
    let folder = tempfile::tempdir().unwrap();
    let file = overdriven(&folder);
    let ran = patchcord(&["run", &file, "--set", "share=0"]);
    assert!(out(&ran).contains("share 0\n"), "{}", out(&ran));
    assert!(!out(&ran).contains("spare"), "{}", out(&ran));
}

#[test]
fn a_pure_number_has_no_unit() {
    let folder = tempfile::tempdir().unwrap();
    let failed = patchcord(&["check", &overdriven(&folder), "--set", "share=2"]);
    let report = crate::cli::errors(&failed);
    assert!(report.contains("share = 2 is outside its range 0 ... 1\n"), "{report}");
}

/// The patch of the bad patches whose table has Unix times.
const UNREACHED: &str = "crates/core/tests/patches/bad/unreached-table.json";

#[test]
fn check_and_run_warn_of_a_table_that_is_not_reached() {
    let warning = "warning[unreached-table]: the table of D begins at 1.42e9 s, but the run ends at 3600 s";
    for command in ["check", "run"] {
        let warned = patchcord(&[command, UNREACHED]);
        assert_eq!(code(&warned), 0);
        assert!(crate::cli::errors(&warned).contains(warning), "{command}: {}", crate::cli::errors(&warned));
        let document = json(&patchcord(&[command, UNREACHED, "--json"]));
        assert_eq!(document["diagnostics"][0]["code"], "unreached-table", "{command}");
    }
}

#[test]
fn a_table_is_compared_with_the_run_that_is_made() {
    let folder = tempfile::tempdir().unwrap();
    let file = path(&folder, "late.json");
    let text = r#"{"patchcord": 1, "scales": {"volt": {"per_volt": 1, "unit": "V"}},
        "drives": {"D": {"kind": "table", "scale": "volt", "points": [[4, 0], [5, 1]]}},
        "signals": {"d": {"at": "D", "scale": "volt"}}, "run": {"step": 0.01}}"#;
    fs::write(&file, text).unwrap();
    assert!(!crate::cli::errors(&patchcord(&["check", &file])).contains("unreached-table"));
    for (seconds, count) in [("3", 1), ("6", 0)] {
        let document = json(&patchcord(&["run", &file, "--for", seconds, "--json"]));
        assert_eq!(document["diagnostics"].as_array().unwrap().len(), count, "{document}");
    }
    let warned = crate::cli::errors(&patchcord(&["run", UNREACHED, "--for", "500"]));
    assert!(warned.contains("but the run ends at 500 s\n") && !warned.contains("3600 s"), "{warned}");
}
