use std::fs;

use tempfile::TempDir;

use super::*;
use crate::circuit::Circuit;
use crate::patch::{ElementBuilder, Patch};

/// A table of two points.
const TABLE: &str = "t,u\n0,0\n1,50\n";

/// A folder with the tables "secret.csv" and "start/pump.csv". The tests permit "start".
fn folders() -> (TempDir, PathBuf) {
    let all = tempfile::tempdir().unwrap();
    let start = all.path().join("start");
    fs::create_dir_all(start.join("sub")).unwrap();
    fs::write(all.path().join("secret.csv"), TABLE).unwrap();
    fs::write(start.join("pump.csv"), TABLE).unwrap();
    (all, start)
}

/// The text of a patch with a drive whose table is in a file.
fn text(file: &str) -> String {
    let file = file.replace('\\', "\\\\");
    format!(
        r#"{{"patchcord": 1, "scales": {{"volt": {{"per_volt": 1, "unit": "V"}}}},
            "drives": {{"u": {{"kind": "table", "scale": "volt", "points": {{"csv": "{file}"}}}}}},
            "elements": {{"A1": {{"kind": "summer", "in": {{"x1": ["u"]}}}}}}, "run": {{"for": 1, "step": 0.01}},
            "record": ["A1"]}}"#
    )
}

/// What the checker reports about a patch; empty if it has no errors.
fn faults(patch: &Patch) -> String {
    let findings = Circuit::new(patch).err().map(|report| report.findings).unwrap_or_default();
    findings.iter().map(|finding| format!("{}: {}\n", finding.message, finding.advice())).collect()
}

/// What the checker reports about a table that is read below a folder.
fn faults_below(folder: &Path, file: &str) -> String {
    faults(&Patch::parse_with(TableAccess::Below(folder.to_owned()), "p.json", &text(file)).unwrap())
}

#[test]
fn tables_below_the_folder_are_read() {
    let (_all, start) = folders();
    for file in ["pump.csv", "./pump.csv", "sub/../pump.csv", "../start/pump.csv"] {
        assert_eq!(faults_below(&start, file), "", "{file}");
    }
    assert_eq!(faults_below(&start, start.join("pump.csv").to_str().unwrap()), "");
}

#[test]
fn tables_elsewhere_are_refused_whether_they_exist_or_not() {
    let (all, start) = folders();
    let absolute = all.path().join("secret.csv");
    let names = ["../secret.csv", "sub/../../secret.csv", "../missing.csv", "/missing.csv"];
    for file in names.into_iter().chain([absolute.to_str().unwrap()]) {
        let report = faults_below(&start, file);
        assert!(report.contains("is not below the folder from which tables may be read"), "{file}: {report}");
    }
    // A folder whose name only begins like the permitted one.
    fs::create_dir(all.path().join("start2")).unwrap();
    fs::write(all.path().join("start2/pump.csv"), TABLE).unwrap();
    assert!(faults_below(&start, "../start2/pump.csv").contains("is not below the folder"));
    assert!(faults_below(&all.path().join("none"), "pump.csv").contains("is not below the folder"));
}

#[test]
fn a_missing_table_and_a_folder_are_reported_as_such() {
    let (_all, start) = folders();
    assert!(faults_below(&start, "missing.csv").contains("there is no file"));
    assert!(faults_below(&start, "sub").contains("it is a folder"));
}

#[cfg(unix)]
#[test]
fn links_are_resolved_and_pipes_are_refused_without_waiting() {
    use std::os::unix::fs::symlink;
    let (all, start) = folders();
    symlink(all.path().join("secret.csv"), start.join("link.csv")).unwrap();
    symlink(all.path(), start.join("up")).unwrap();
    symlink("pump.csv", start.join("inside.csv")).unwrap();
    for file in ["link.csv", "up/secret.csv"] {
        assert!(faults_below(&start, file).contains("is not below the folder"), "{file}");
    }
    assert_eq!(faults_below(&start, "inside.csv"), "");
    assert!(std::process::Command::new("mkfifo").arg(start.join("pipe.csv")).status().unwrap().success());
    assert!(faults_below(&start, "pipe.csv").contains("it is a pipe, not a regular file"));
}

#[test]
fn without_access_the_points_belong_into_the_patch() {
    let (_all, start) = folders();
    for file in ["pump.csv", start.join("pump.csv").to_str().unwrap()] {
        let patch = Patch::parse_with(TableAccess::None, "p.json", &text(file)).unwrap();
        let report = faults(&patch);
        assert!(report.contains("tables in files cannot be read here"), "{report}");
        assert!(report.contains("write the points into the patch"), "{report}");
        assert!(patch.table_files().is_empty());
    }
}

/// The name of a patch can lead anywhere, but the folder of its tables stays.
#[test]
fn edited_patches_keep_their_access() {
    let (all, start) = folders();
    let name = all.path().join("p.json").display().to_string();
    let access = TableAccess::Below(start);
    let patch = Patch::parse_with(access.clone(), &name, &text("secret.csv")).unwrap();
    assert!(faults(&patch).contains("there is no file"));
    let mut typed = patch.edit();
    typed.put_element("P1", ElementBuilder::new("pot").cord("in", "A1").set("setting", 0.5));
    let mut removed = patch.edit();
    removed.remove_cord("A1", "x1", "u").unwrap();
    let mut put = patch.edit();
    put.put(["run", "for"], 2);
    let edited = [typed, removed, put].map(|editor| editor.finish(&name).unwrap());
    let with_edits = patch.with_edits(&name, &[crate::patch::Edit::new("run/for", 2)]).unwrap();
    let open = Patch::parse_with(access.clone(), &name, &text("secret.csv").replace("\"u\"]", "]")).unwrap();
    for patch in edited.into_iter().chain([with_edits]).chain([open.with_grounded_inputs().unwrap()]) {
        assert_eq!(patch.table_access(), &access);
        assert!(faults(&patch).contains("there is no file"));
    }
}

#[test]
fn a_patch_of_a_file_takes_the_folder_of_its_new_name() {
    let (all, start) = folders();
    let patch = Patch::parse_in(&start, "p.json", &text("pump.csv")).unwrap();
    assert_eq!(faults(&patch), "");
    let mut editor = patch.edit();
    editor.put(["run", "for"], 2);
    assert_eq!(faults(&editor.finish("q.json").unwrap()), "");
    let elsewhere = all.path().join("q.json").display().to_string();
    assert!(faults(&patch.edit().finish(&elsewhere).unwrap()).contains("there is no file"));
}
