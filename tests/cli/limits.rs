//! Limits on input and on memory: kinds of files, names, numbers, pictures, rows.

use std::fs;

use serde_json::{Map, Value};

use super::{FIG_8_16, code, errors, json, out, patchcord, path, spring, spring_with};

/// Asserts that a command fails with exit code 1 and a message that contains `expected`.
fn assert_refused(arguments: &[&str], expected: &str) {
    let ran = patchcord(arguments);
    assert_eq!(code(&ran), 1, "{arguments:?}: {}", errors(&ran));
    assert!(errors(&ran).contains(expected), "{arguments:?}: {}", errors(&ran));
}

#[cfg(unix)]
#[test]
fn pipes_and_devices_are_refused_as_input_without_waiting() {
    let folder = tempfile::tempdir().unwrap();
    let [pipe, effect] = ["pipe", "zero.json"].map(|name| path(&folder, name));
    assert!(std::process::Command::new("mkfifo").arg(&pipe).status().unwrap().success());
    std::os::unix::fs::symlink("/dev/zero", &effect).unwrap();
    let expected = format!("cannot read {pipe}: it is a pipe, not a regular file");
    assert_refused(&["check", &pipe], &expected);
    assert_refused(&["gap", &pipe, "--check"], &expected);
    assert_refused(&["sweep", FIG_8_16, "--rows", &pipe, "--measure", "overload"], &expected);
    let expected = format!("cannot read {effect}: it is a device, not a regular file");
    assert_refused(&["effects", "--effects", folder.path().to_str().unwrap()], &expected);
}

#[test]
fn a_name_above_200_characters_is_refused() {
    let (_folder, file) = spring_with("\"x\"", &format!("\"{}\"", "x".repeat(65_536)));
    let ran = patchcord(&["run", &file]);
    assert_eq!(code(&ran), 1);
    assert!(errors(&ran).contains("cannot name a signal"), "{}", errors(&ran));
    assert!(errors(&ran).contains("use at most 200 characters"), "{}", errors(&ran));
    assert!(errors(&ran).len() < 2000, "the name is shortened");
}

#[test]
fn a_huge_time_scale_is_refused_before_the_analysis() {
    let (_folder, file) = spring_with("\"run\"", "\"time_scale\": 1e160,\n  \"run\"");
    assert_refused(&["linearise", &file], "\"time_scale\" must be from 1e-12 to 1e12, not 1e160");
}

#[test]
fn too_many_pictures_are_refused_before_the_run() {
    let pictures = vec![r#"{"title": "x", "y": ["x"]}"#; 108].join(", ");
    let (folder, file) = spring_with("\"run\"", &format!("\"pictures\": [{pictures}],\n  \"run\""));
    let [plot, csv] = ["x.svg", "x.csv"].map(|name| path(&folder, name));
    assert_refused(&["run", &file, "--plot", &plot, "--csv", &csv], "a sheet of 108 pictures is higher than");
    assert!(!fs::exists(&plot).unwrap() && !fs::exists(&csv).unwrap());
}

#[test]
fn a_long_name_of_a_column_gets_a_short_report() {
    let (folder, _file) = spring();
    let experiment = path(&folder, "experiment.json");
    let name = "a".repeat(70_000);
    let outputs = format!(r#"{{"patch": "spring.json", "data": "data.csv", "outputs": {{"x": "{name}"}}}}"#);
    fs::write(&experiment, outputs).unwrap();
    fs::write(path(&folder, "data.csv"), format!("t,{name}\n0,0\n1,1\n")).unwrap();
    let failed = patchcord(&["gap", &experiment, "--check"]);
    let report = errors(&failed);
    assert_eq!(code(&failed), 1);
    assert!(report.contains("has a column name of more than 200 characters"), "{report}");
    assert!(report.len() < 5000, "{report}");
}

#[test]
fn the_document_of_a_check_grows_with_the_number_of_parameters() {
    let parameters: Vec<_> =
        (0..3000).map(|index| format!(r#""p{index}": {{"value": 1, "unit": "m"}}"#)).collect();
    let section = format!("\n  \"parameters\": {{{}}},\n  \"scales\"", parameters.join(", "));
    let (_folder, file) = spring_with("\n  \"scales\"", &section);
    let checked = patchcord(&["check", &file, "--json"]);
    assert_eq!(json(&checked)["parameters"].as_array().unwrap().len(), 3000);
    assert!(out(&checked).len() < 500_000, "{}", out(&checked).len());
}

/// Work that grows with the square of the number of elements would take minutes.
#[test]
fn a_chain_of_many_elements_is_checked() {
    const ELEMENTS: usize = 30_000;
    let name = |index: usize| format!("E{index}");
    let element = |index: usize| {
        let input = index.checked_sub(1).map_or("D".to_owned(), name);
        (name(index), serde_json::json!({"kind": "inverter", "in": input}))
    };
    let elements: Map<String, Value> = (0..ELEMENTS).map(element).collect();
    let patch = serde_json::json!({
        "patchcord": 1,
        "scales": {"v": {"per_volt": 1, "unit": "V"}},
        "drives": {"D": {"kind": "sine", "scale": "v", "amplitude": 50, "frequency": 1}},
        "elements": elements,
        "signals": {"y": {"at": name(ELEMENTS - 1), "scale": "v"}},
        "run": {"for": 0.1, "step": 1e-3}
    });
    let folder = tempfile::tempdir().unwrap();
    let file = path(&folder, "chain.json");
    fs::write(&file, patch.to_string()).unwrap();
    let checked = patchcord(&["check", &file]);
    assert_eq!((code(&checked), errors(&checked).as_str()), (0, ""));
    assert!(out(&checked).contains("chain.json: nothing wrong\n"), "{}", out(&checked));
    let document = json(&patchcord(&["check", &file, "--json"]));
    assert_eq!((&document["ok"], &document["cannot_be_run"]), (&true.into(), &Value::Null));
    // The drive and the three references have voltages, too.
    assert_eq!(document["voltages"].as_array().unwrap().len(), ELEMENTS + 4);
}

/// Runs a patch with these options and at most this memory in kilobytes, and asserts that it succeeds.
#[cfg(target_os = "linux")]
pub(super) fn run_with_memory(kilobytes: u32, file: &str, options: &[&str]) -> std::process::Output {
    let limited = format!("ulimit -v {kilobytes}; exec \"$0\" \"$@\"");
    let ran = std::process::Command::new("sh")
        .args(["-c", &limited, env!("CARGO_BIN_EXE_patchcord"), "run", file])
        .args(options)
        .env("PATCHCORD_PROGRESS", "0")
        .output()
        .unwrap();
    assert_eq!((code(&ran), errors(&ran).as_str()), (0, ""));
    ran
}

/// The table has 54 MB, and the samples would take 24 MB.
#[cfg(target_os = "linux")]
#[test]
fn the_memory_of_a_run_does_not_grow_with_its_rows() {
    let (folder, file) = spring();
    let csv = path(&folder, "long.csv");
    run_with_memory(80_000, &file, &["--for", "1000", "--record", "x,A1", "--csv", &csv]);
    let lines = fs::read(&csv).unwrap().iter().filter(|byte| **byte == b'\n').count();
    assert_eq!(lines, 4 + 1_000_001);
}
