//! What macros may come to when they are written out, and the files that their tables stand in.

use std::fs;

use serde_json::{Value, json};

use crate::common::{element, program, ran, voltage, volts};
use patchcord_core::circuit::Circuit;
use patchcord_core::document::{Code, Report};
use patchcord_core::patch::{ElementBuilder, MacroBuilder, Patch, PatchBuilder};

/// A chain of so many instances of a macro that holds this element.
fn chain(of: ElementBuilder, instances: usize) -> PatchBuilder {
    let bend = MacroBuilder::new().input("in", "").output("out", "F").element("F", of.cord("in", "in"));
    let first = volts("a chain").define("bend", bend).signal("end", &format!("B{instances}"), "volt", 1.0);
    (1..=instances).fold(first, |chain, at| {
        let before = if at == 1 { "+100".to_owned() } else { format!("B{}", at - 1) };
        chain.element(&format!("B{at}"), element("bend").cord("in", &before))
    })
}

fn bend(points: Value) -> ElementBuilder {
    element("function-generator").set("points", points)
}

/// A curve of so many points: half of what comes in.
fn points(count: usize) -> Vec<[f64; 2]> {
    (0..count).map(|at| at as f64 / count as f64).map(|volts| [100.0 * volts, 50.0 * volts]).collect()
}

/// What is said of a patch that cannot be read.
fn told(patch: &Patch) -> Report {
    *Circuit::new(patch, &[]).unwrap_err()
}

fn is_too_large(of: ElementBuilder, instances: usize) -> bool {
    let Err(report) = Circuit::new(&chain(of, instances).build().unwrap(), &[]) else { return false };
    report.findings.iter().any(|finding| finding.code == Code::MacroTooLarge)
}

#[test]
fn points_notes_and_parts_count_when_macros_are_written_out() {
    assert!(!is_too_large(bend(json!(points(1000))), 300));
    assert!(is_too_large(bend(json!(points(1000))), 600));
    let noted = |note: usize| bend(json!([[0, 0], [1, 1]])).set("note", "n".repeat(note));
    assert!(!is_too_large(noted(10_000), 300));
    assert!(is_too_large(noted(10_000), 2_000));
    let parts = json!({"function_generators": vec![""; 1000]});
    let listed = bend(json!([[0, 0], [1, 1]])).set("uses", parts);
    assert!(!is_too_large(listed.clone(), 1));
    assert!(is_too_large(listed, 400));
}

/// A patch file beside a table of so many points, read from elsewhere.
fn beside_a_table(patch: PatchBuilder, count: usize) -> Patch {
    let folder = tempfile::tempdir().unwrap();
    let rows: String = points(count).iter().map(|[x, y]| format!("{x},{y}\n")).collect();
    fs::create_dir(folder.path().join("tables")).unwrap();
    fs::write(folder.path().join("tables/half.csv"), format!("u,y\n{rows}")).unwrap();
    let path = folder.path().join("patch.json");
    patch.build().unwrap().write(&path).unwrap();
    Patch::read(&path).unwrap()
}

#[test]
fn a_table_inside_a_macro_is_looked_for_from_the_folder_of_the_patch() {
    let patch = beside_a_table(chain(bend(json!({"csv": "tables/half.csv"})), 3), 10);
    let program = program(&patch, &[]);
    assert!((voltage(&ran(&program, 1e-2, 0.1), "B3.F") - 12.5).abs() < 1e-12);
}

#[test]
fn a_table_that_is_used_too_often_is_told_once() {
    let patch = beside_a_table(chain(bend(json!({"csv": "tables/half.csv"})), 1002), 10_000);
    let [finding] = &told(&patch).findings[..] else { panic!("{}", told(&patch)) };
    assert_eq!(finding.code, Code::BadTable);
    assert!(finding.message.contains("more than 10000000 points"), "{}", finding.message);
}
