//! The faceplates follow the format that docs/panel.md describes, and so does the example on that page.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};

use patchcord_core::elements::{Family, find};
use patchcord_core::machines::Part;
use serde::Deserialize;
use serde_json::Value;

/// The outputs of the machine itself.
const REFERENCES: [&str; 3] = ["+100", "-100", "ground"];
/// Least distance of two jacks of a module: `PITCH` of page/js/faceplate.js. For fingers, the page enlarges it to
/// 44 px.
const LEAST_DISTANCE: f64 = 28.0;

/// A file of the folder.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Faceplate {
    title: String,
    note: String,
    class: String,
    width: f64,
    references: BTreeMap<String, String>,
    modules: BTreeMap<String, Module>,
    sections: Vec<Section>,
}

/// A form of modules.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Module {
    size: [f64; 2],
    #[serde(default)]
    jacks: BTreeMap<String, [f64; 2]>,
    out: [f64; 2],
    knob: Option<[f64; 2]>,
}

/// A group of modules.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Section {
    title: String,
    class: String,
    module: String,
    columns: usize,
    min: usize,
    #[serde(default)]
    references: bool,
    family: Option<String>,
    #[serde(default)]
    kinds: Vec<String>,
    part: Option<String>,
    add: Option<String>,
}

/// The text of a file of this crate or of the repository.
fn text(path: &str) -> String {
    fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join(path)).unwrap()
}

/// The names of the faceplates, without the list of them.
fn names() -> BTreeSet<String> {
    let folder = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("page/faceplates");
    let entries = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().file_name());
    let names = entries.map(|name| name.to_str().unwrap().strip_suffix(".json").unwrap().to_owned());
    names.filter(|name| name != "index").collect()
}

/// The texts of all faceplates, and of the example on the page, with their names.
fn faceplates() -> Vec<(String, String)> {
    let page = text("../../docs/panel.md");
    let (_, section) = page.split_once("\n### Faceplates\n").unwrap();
    let (_, example) = section.split_once("```text\n").unwrap();
    let example = ("docs/panel.md".to_owned(), example.split_once("```").unwrap().0.to_owned());
    let files = names().into_iter().map(|name| {
        let text = text(&format!("page/faceplates/{name}.json"));
        (name, text)
    });
    files.chain([example]).collect()
}

/// Whether the name is that of a kind of element that has cords.
fn is_kind(name: &str) -> bool {
    find(Family::Computing, name).is_some()
}

/// Checks the places in a form of modules.
fn check_module(context: &str, Module { size, jacks, out, knob }: &Module) {
    let is_inside = |place: &[f64; 2]| (0..2).all(|axis| 0.0 < place[axis] && place[axis] < size[axis]);
    let all: Vec<&[f64; 2]> = jacks.values().chain([out]).collect();
    assert!(all.iter().copied().chain(knob).all(is_inside), "{context}: outside of the module");
    for (index, one) in all.iter().enumerate() {
        for other in &all[..index] {
            let distance = (one[0] - other[0]).hypot(one[1] - other[1]);
            assert!(distance >= LEAST_DISTANCE, "{context}: {one:?} and {other:?}");
        }
    }
}

/// Checks what a section names.
fn check_section(context: &str, section: &Section) {
    assert!(!section.title.is_empty() && !section.class.is_empty() && section.columns > 0, "{context}");
    assert!(section.family.as_deref().is_none_or(|family| family == "drive"), "{context}");
    assert!(section.kinds.iter().chain(&section.add).all(|kind| is_kind(kind)), "{context}");
    let is_part = |key: &String| Part::ALL.iter().any(|part| part.key() == key);
    assert!(section.part.as_ref().is_none_or(is_part), "{context}");
}

#[test]
fn every_faceplate_follows_the_format() {
    for (name, text) in faceplates() {
        let plate: Faceplate = serde_json::from_str(&text).unwrap_or_else(|error| panic!("{name}: {error}"));
        assert!(!plate.title.is_empty() && !plate.note.is_empty() && !plate.class.is_empty(), "{name}");
        assert!(plate.references.keys().all(|key| REFERENCES.contains(&key.as_str())), "{name}");
        for (form, module) in &plate.modules {
            check_module(&format!("{name}, {form}"), module);
            assert!(module.size[0] <= plate.width, "{name}, {form}");
        }
        for section in &plate.sections {
            check_section(&format!("{name}, {}", section.title), section);
        }
        let used: BTreeSet<&String> = plate.sections.iter().map(|section| &section.module).collect();
        assert!(used.into_iter().eq(plate.modules.keys()), "{name}: forms of modules");
        assert_eq!(plate.sections.iter().filter(|section| section.references).count(), 1, "{name}");
        // What has no other place is in the last section.
        let last = plate.sections.last().unwrap();
        assert!(last.kinds.is_empty() && last.part.is_none() && last.family.is_none(), "{name}");
    }
}

#[test]
fn the_list_of_faceplates_has_all_files() {
    let list: BTreeMap<String, String> = serde_json::from_str(&text("page/faceplates/index.json")).unwrap();
    assert!(list.keys().eq(&names()));
    assert!(list.values().all(|title| !title.is_empty()));
}

#[test]
fn the_analog_thing_has_its_modules() {
    let plate: Faceplate = serde_json::from_str(&text("page/faceplates/the-analog-thing.json")).unwrap();
    let count = |title: &str| plate.sections.iter().find(|section| section.title == title).unwrap().min;
    let titles = ["Integrators", "Summers", "Inverters", "Multipliers", "Comparators", "Coefficients"];
    assert_eq!(titles.map(count), [5, 4, 4, 2, 2, 8]);
}

/// The keys of an object, and of all objects in a list or in an object.
fn keys<'v>(values: impl IntoIterator<Item = &'v Value>) -> BTreeSet<String> {
    values.into_iter().flat_map(|value| value.as_object().unwrap().keys().cloned()).collect()
}

#[test]
fn the_page_lists_the_fields_of_the_files() {
    let page = text("../../docs/panel.md");
    let (_, section) = page.split_once("\n### Faceplates\n").unwrap();
    let section = section.split("\n## ").next().unwrap();
    let files: Vec<Value> =
        faceplates().iter().map(|(_, text)| serde_json::from_str(text).unwrap()).collect();
    let sections = files.iter().flat_map(|file| file["sections"].as_array().unwrap());
    let modules = files.iter().flat_map(|file| file["modules"].as_object().unwrap().values());
    for (heading, expected) in
        [("| file |", keys(&files)), ("| module |", keys(modules)), ("| section |", keys(sections))]
    {
        let (_, table) = section.split_once(heading).unwrap();
        let rows = table.lines().skip(2).take_while(|line| line.starts_with("| `"));
        let listed: BTreeSet<String> = rows.map(|row| row.split('`').nth(1).unwrap().to_owned()).collect();
        assert_eq!(listed, expected, "{heading}");
    }
}
