//! Every lesson has a source, equations, units and ranges, well-used voltages, pictures, a section of the page, and a
//! test.

use std::fs;
use std::path::Path;
use std::process::Command;

use serde_json::Value;

use crate::common::shipped;
use crate::known_problems::runs::{circuit, run_circuit, settings};

/// The names of all lessons, sorted.
fn stems() -> Vec<String> {
    let files = fs::read_dir("patches/lessons").unwrap().map(|entry| entry.unwrap().path());
    let mut stems: Vec<String> =
        files.map(|file| file.file_stem().unwrap().to_str().unwrap().to_owned()).collect();
    stems.sort();
    assert!(stems.len() >= 13, "{stems:?}");
    stems
}

#[test]
fn every_lesson_has_a_title_a_source_equations_and_described_parameters() {
    for stem in stems() {
        let patch = shipped(&format!("lessons/{stem}"));
        let value = patch.value();
        for key in ["title", "source", "machine", "equations", "run", "pictures"] {
            assert!(!value[key].is_null(), "{stem} has no {key}");
        }
        for (name, parameter) in value["parameters"].as_object().unwrap() {
            let is_complete = ["unit", "range", "description"].iter().all(|key| !parameter[*key].is_null());
            assert!(is_complete, "{stem}: {name} lacks unit, range or description");
        }
        assert!(notes(value) >= 2, "{stem}: at least two elements need notes");
    }
}

/// The number of elements with a note.
fn notes(patch: &Value) -> usize {
    let elements = patch["elements"].as_object().unwrap();
    elements.values().filter(|element| element["note"].is_string()).count()
}

#[test]
fn every_lesson_runs_to_its_end_between_20_and_95_volts() {
    for stem in stems() {
        let circuit = circuit(&format!("lessons/{stem}"), &[]);
        let elements = circuit.elements();
        let integrators = elements.iter().filter(|element| element.kind.name == "integrator");
        let record = integrators.map(|element| element.name.clone());
        let trace = run_circuit(&circuit, &settings(&circuit).with_signals(record));
        assert_eq!(trace.overloads().count(), 0, "{stem}: {:?}", trace.repetitions);
        for track in &trace.tracks {
            let swings = track.extremes.iter().map(|extremes| extremes.most.volts.max(-extremes.least.volts));
            let swing = swings.fold(0.0, f64::max);
            assert!((20.0..=95.0).contains(&swing), "{stem}: the amplitude of {} is {swing} V", track.name);
        }
    }
}

#[test]
fn every_lesson_has_a_section_of_the_page_and_a_test() {
    let page = fs::read_to_string("docs/lessons.md").unwrap();
    for stem in stems() {
        assert!(page.contains(&format!("\n## {stem}\n")), "docs/lessons.md has no section {stem}");
        let test = format!("tests/lessons/{}.rs", stem.replace('-', "_"));
        assert!(Path::new(&test).exists(), "{test}");
    }
}

/// The commands that draw the pictures of a lesson, and the suffixes of their names.
const DRAWN: [(&str, &str); 2] = [("run", ""), ("draw", "-schematic")];

#[test]
fn the_pictures_of_every_lesson_are_up_to_date() {
    let folder = tempfile::tempdir().unwrap();
    let page = fs::read_to_string("docs/lessons.md").unwrap();
    for (stem, (command, ending)) in stems().iter().flat_map(|stem| DRAWN.map(|drawn| (stem, drawn))) {
        let shown = format!("pictures/lessons/{stem}{ending}.svg");
        assert!(page.contains(&format!("]({shown})")), "docs/lessons.md does not show {shown}");
        let fresh = folder.path().join(format!("{stem}{ending}.svg"));
        let patch = format!("patches/lessons/{stem}.json");
        let draw = Command::new(env!("CARGO_BIN_EXE_patchcord"))
            .args([command, &patch, "--plot"])
            .arg(&fresh)
            .output();
        assert!(draw.unwrap().status.success(), "{patch}");
        let stored = Path::new("docs").join(shown);
        if std::env::var_os("PATCHCORD_BLESS").is_some() {
            fs::copy(&fresh, &stored).unwrap();
        }
        let same = fs::read(&stored).ok() == fs::read(&fresh).ok();
        assert!(same, "{} is stale: PATCHCORD_BLESS=1 cargo test -p patchcord rewrites it", stored.display());
    }
}
