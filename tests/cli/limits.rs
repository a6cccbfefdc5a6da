//! Inputs that are too large, or are no regular files. Every command reports them at once.

use std::fs;
use std::path::Path;

use crate::cli::{code, errors, json, out, patchcord, path, spring, spring_with};

/// A name that is much longer than a line of a message.
fn long_name() -> String {
    "a".repeat(70_000)
}

#[test]
fn a_long_name_of_a_signal_gets_a_short_report() {
    let signal = format!("\"{}\": {{\"at\": \"A1\"}}, \"x\": ", long_name());
    let (_folder, file) = spring_with("\"x\": ", &signal);
    for command in ["check", "run"] {
        let failed = patchcord(&[command, &file]);
        let report = errors(&failed);
        assert_eq!(code(&failed), 1, "{command}");
        assert!(report.contains("use at most 200 characters") && report.len() < 2000, "{command}: {report}");
    }
}

#[test]
fn a_long_name_of_a_column_gets_a_short_report() {
    let (folder, _file) = spring();
    let experiment = path(&folder, "experiment.json");
    let name = long_name();
    let outputs = format!(r#"{{"patch": "spring.json", "data": "data.csv", "outputs": {{"x": "{name}"}}}}"#);
    fs::write(&experiment, outputs).unwrap();
    fs::write(path(&folder, "data.csv"), format!("t,{name}\n0,0\n1,1\n")).unwrap();
    let failed = patchcord(&["gap", &experiment, "--check"]);
    let report = errors(&failed);
    assert_eq!(code(&failed), 1);
    assert!(report.contains("has a column name of more than 200 characters"), "{report}");
    assert!(report.len() < 5000, "{report}");
}

/// Without a limit, these files have no end.
#[cfg(unix)]
#[test]
fn devices_and_pipes_are_not_read() {
    let (folder, file) = spring();
    let pipe = path(&folder, "pipe");
    assert!(std::process::Command::new("mkfifo").arg(&pipe).status().unwrap().success());
    for (rows, noun) in [("/dev/zero", "a device"), (pipe.as_str(), "a pipe")] {
        let failed = patchcord(&["sweep", &file, "--rows", rows, "--measure", "peak:x"]);
        let expected = format!("error: cannot read {rows}: it is {noun}, not a regular file");
        assert_eq!(code(&failed), 1);
        assert!(errors(&failed).contains(&expected), "{}", errors(&failed));
    }
    let effects = tempfile::tempdir().unwrap();
    std::os::unix::fs::symlink("/dev/zero", effects.path().join("endless.json")).unwrap();
    let failed = patchcord(&["effects", "--effects", &effects.path().display().to_string()]);
    assert_eq!(code(&failed), 1);
    assert!(errors(&failed).contains("endless.json: it is a device, not a regular file"));
}

#[test]
fn a_sheet_of_too_many_pictures_is_reported_before_it_is_drawn() {
    let pictures = [r#"{"x": "t", "y": ["x"]}"#; 1000].join(", ");
    let (folder, file) =
        spring_with("\n  \"run\"", &format!("\n  \"pictures\": [{pictures}],\n  \"run\""));
    let sheet = path(&folder, "sheet.svg");
    let failed = patchcord(&["run", &file, "--plot", &sheet]);
    assert_eq!(code(&failed), 1);
    let expected = "a sheet of 1000 pictures is higher than 60000 pixels; draw fewer or smaller pictures";
    assert!(errors(&failed).contains(expected), "{}", errors(&failed));
    assert!(!Path::new(&sheet).exists());
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
