//! What every lesson must have: a source, units and ranges, well-used voltages, a picture, a page, a test.

use std::fs;
use std::path::Path;
use std::process::Command;

use patchcord::circuit::Circuit;
use patchcord::patch::Patch;
use patchcord::program::Program;
use patchcord::solve::{self, RunSettings};
use serde_json::Value;

use crate::bench::trace;
use crate::common::circuit;

fn stems() -> Vec<String> {
    let files = fs::read_dir("patches/lessons").unwrap().map(|entry| entry.unwrap().path());
    let mut stems: Vec<String> =
        files.map(|file| file.file_stem().unwrap().to_str().unwrap().to_owned()).collect();
    stems.sort();
    assert!(stems.len() >= 13, "{stems:?}");
    stems
}

#[test]
fn every_lesson_says_what_it_is_and_where_it_comes_from() {
    for stem in stems() {
        let patch = crate::bench::lesson(&stem);
        let value = patch.value();
        for key in ["title", "source", "machine", "run", "pictures"] {
            assert!(!value[key].is_null(), "{stem} has no {key}");
        }
        for (name, parameter) in value["parameters"].as_object().unwrap() {
            let told = ["unit", "range", "description"].iter().all(|key| !parameter[*key].is_null());
            assert!(told, "{stem}: {name} lacks unit, range or description");
        }
        assert!(notes(value) >= 2, "{stem}: notes say what stands at an element");
    }
}

fn notes(patch: &Value) -> usize {
    let elements = patch["elements"].as_object().unwrap();
    elements.values().filter(|element| element["note"].is_string()).count()
}

#[test]
fn every_lesson_runs_to_its_end_between_20_and_95_volts() {
    for stem in stems() {
        let circuit = circuit(&crate::bench::lesson(&stem), &[]);
        let elements = circuit.elements();
        let integrators = elements.iter().filter(|element| element.kind.name == "integrator");
        let record = integrators.map(|element| element.name.clone()).collect();
        let program = Program::new(&circuit).unwrap_or_else(|report| panic!("{report}"));
        let settings = RunSettings { record, ..RunSettings::of(&circuit).unwrap() };
        let trace = solve::run(&program, &settings).unwrap_or_else(|error| panic!("{stem}: {error}"));
        assert_eq!(trace.overloads().count(), 0, "{stem}: {:?}", trace.sweeps);
        for track in &trace.tracks {
            let course = track.course.unwrap();
            let swing = course.most.volts.max(-course.least.volts);
            assert!((20.0..=95.0).contains(&swing), "{stem}: {} swings to {swing} V", track.name);
        }
    }
}

#[test]
fn every_lesson_has_a_picture_a_page_and_a_test() {
    let page = fs::read_to_string("docs/lessons.md").unwrap();
    for stem in stems() {
        assert!(page.contains(&format!("\n## {stem}\n")), "docs/lessons.md has no section {stem}");
        let picture = format!("pictures/lessons/{stem}.png");
        assert!(page.contains(&format!("]({picture})")), "docs/lessons.md does not show {picture}");
        assert!(Path::new("docs").join(&picture).exists(), "{picture}");
        let test = format!("tests/lessons/{}.rs", stem.replace('-', "_"));
        assert!(Path::new(&test).exists(), "{test}");
    }
}

/// The commands of the page: file, and what they set.
fn commands(page: &str) -> impl Iterator<Item = (&str, Vec<(String, f64)>)> {
    page.lines().filter_map(|line| line.strip_prefix("    patchcord run ")).map(|line| {
        let mut words = line.split_whitespace();
        let file = words.next().unwrap();
        let settings = words.filter_map(|word| word.split_once('='));
        (file, settings.map(|(name, value)| (name.to_owned(), value.parse().unwrap())).collect())
    })
}

#[test]
fn what_the_page_proposes_can_be_set() {
    let page = fs::read_to_string("docs/lessons.md").unwrap();
    let mut proposed = 0;
    for (file, changes) in commands(&page) {
        let patch = Patch::read(Path::new(file)).unwrap_or_else(|report| panic!("{report}"));
        let circuit = Circuit::new(&patch, &changes).unwrap_or_else(|report| panic!("{file}: {report}"));
        Program::new(&circuit).unwrap_or_else(|report| panic!("{file}: {report}"));
        proposed += 1;
    }
    assert!(proposed >= 2 * stems().len(), "{proposed}");
}

/// A lesson, what is changed in it, how long it runs, and when a lamp then lights.
type Lit<'a> = (&'a str, &'a [(&'a str, f64)], f64, f64);

#[test]
fn lamps_light_when_the_page_says() {
    let page = fs::read_to_string("docs/lessons.md").unwrap();
    let told: [Lit<'_>; 3] = [
        ("driven-oscillator", &[("d", 0.5)], 20.0, 1.9),
        ("two-phase-oscillator", &[("damp", 0.0)], 15.0, 10.2),
        ("mathieu", &[("a", 1.0)], 60.0, 12.6),
    ];
    for (stem, changes, duration, time) in told {
        let trace = trace(stem, changes, duration);
        let first = trace.overloads().next().unwrap();
        assert_eq!(
            (first.element.as_str(), format!("{:.1}", first.time)),
            ("A2", time.to_string()),
            "{stem}"
        );
        assert!(page.contains(&format!("after {time} s")), "{stem}: {time}");
    }
}

#[test]
fn every_lesson_shows_its_schematic_as_it_is_drawn() {
    let folder = std::env::temp_dir().join(format!("patchcord-lessons-{}", std::process::id()));
    fs::create_dir_all(&folder).unwrap();
    let page = fs::read_to_string("docs/lessons.md").unwrap();
    for stem in stems() {
        let (shown, fresh) =
            (format!("pictures/lessons/{stem}-schematic.svg"), folder.join(format!("{stem}.svg")));
        assert!(page.contains(&format!("]({shown})")), "docs/lessons.md does not show {shown}");
        let stored = Path::new("docs").join(shown);
        let patch = format!("patches/lessons/{stem}.json");
        let draw = Command::new(env!("CARGO_BIN_EXE_patchcord"))
            .args(["draw", &patch, "--plot"])
            .arg(&fresh)
            .output();
        assert!(draw.unwrap().status.success(), "{patch}");
        if std::env::var_os("PATCHCORD_BLESS").is_some() {
            fs::copy(&fresh, &stored).unwrap();
        }
        let same = fs::read(&stored).ok() == fs::read(&fresh).ok();
        assert!(
            same,
            "{} is stale: PATCHCORD_BLESS=1 cargo test --test lessons rewrites it",
            stored.display()
        );
    }
    fs::remove_dir_all(&folder).unwrap();
}
