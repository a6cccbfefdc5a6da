//! The size limits of expanded macros, and table files inside macros.

use std::fs;

use serde_json::{Value, json};

use crate::common::{element, program, run_for, voltage, volts};
use patchcord_core::circuit::Circuit;
use patchcord_core::document::{Code, Report};
use patchcord_core::patch::{ElementBuilder, MacroBuilder, Patch, PatchBuilder};

/// A chain of instances of a macro that contains one element.
fn chain(element_of_macro: ElementBuilder, instances: usize) -> PatchBuilder {
    let definition = MacroBuilder::new()
        .input("in", "")
        .output("out", "F")
        .element("F", element_of_macro.cord("in", "in"));
    let first =
        volts("a chain").define("half", definition).signal("end", &format!("B{instances}"), "volt", 1.0);
    (1..=instances).fold(first, |chain, index| {
        let before = if index == 1 { "+100".to_owned() } else { format!("B{}", index - 1) };
        chain.element(&format!("B{index}"), element("half").cord("in", &before))
    })
}

/// A function generator with these points.
fn generator(points: Value) -> ElementBuilder {
    element("function-generator").set("points", points)
}

/// `count` points of a straight line with the slope 1/2.
fn points(count: usize) -> Vec<[f64; 2]> {
    (0..count).map(|index| index as f64 / count as f64).map(|volts| [100.0 * volts, 50.0 * volts]).collect()
}

/// The report of a patch that is refused.
fn refusal(patch: &Patch) -> Report {
    *Circuit::new(patch).unwrap_err()
}

/// Whether a chain of instances is refused because its expansion is too large.
fn is_too_large(element_of_macro: ElementBuilder, instances: usize) -> bool {
    let Err(report) = Circuit::new(&chain(element_of_macro, instances).build().unwrap()) else {
        return false;
    };
    report.findings.iter().any(|finding| finding.code == Code::MACRO_TOO_LARGE)
}

#[test]
fn points_notes_and_parts_count_towards_the_size_of_an_expansion() {
    assert!(!is_too_large(generator(json!(points(1000))), 300));
    assert!(is_too_large(generator(json!(points(1000))), 600));
    let noted = |note: usize| generator(json!([[0, 0], [1, 1]])).set("note", "n".repeat(note));
    assert!(!is_too_large(noted(10_000), 300));
    assert!(is_too_large(noted(10_000), 2_000));
    let parts = json!({"function_generators": vec![""; 1000]});
    let listed = generator(json!([[0, 0], [1, 1]])).set("uses", parts);
    assert!(!is_too_large(listed.clone(), 1));
    assert!(is_too_large(listed, 400));
}

#[test]
fn a_short_text_that_expands_without_bound_is_refused_at_the_instance_that_exceeds_the_limit() {
    let macro_with_ports = || MacroBuilder::new().input("in", "");
    let inverter = macro_with_ports().output("out", "F").element("F", element("inverter").cord("in", "in"));
    // Every macro contains two instances of the one before, so the last one has 2^18 elements.
    let nested = (1..=18).fold(volts("doubled").define("m0", inverter), |patch, depth| {
        let inner = format!("m{}", depth - 1);
        let doubled = macro_with_ports()
            .output("out", "Y")
            .element("X", element(&inner).cord("in", "in"))
            .element("Y", element(&inner).cord("in", "X"));
        patch.define(&format!("m{depth}"), doubled)
    });
    let small = nested.element("A", element("m1").cord("in", "+100"));
    let large = small.element("B", element("m18").cord("in", "A")).build().unwrap();
    let report = refusal(&large);
    let [finding] = &report.findings[..] else { panic!("{report}") };
    assert_eq!(finding.code, Code::MACRO_TOO_LARGE);
    let span = finding.span.unwrap();
    assert_eq!(&report.text[span.start..span.end], "\"B\"");
}

/// A patch that is read from a folder with the table file tables/half.csv of `count` points.
fn with_table_file(patch: PatchBuilder, count: usize) -> Patch {
    let folder = tempfile::tempdir().unwrap();
    let rows: String = points(count).iter().map(|[x, y]| format!("{x},{y}\n")).collect();
    fs::create_dir(folder.path().join("tables")).unwrap();
    fs::write(folder.path().join("tables/half.csv"), format!("u,y\n{rows}")).unwrap();
    let path = folder.path().join("patch.json");
    patch.build().unwrap().write(&path).unwrap();
    Patch::read(&path).unwrap()
}

#[test]
fn a_table_path_inside_a_macro_is_relative_to_the_patch_file() {
    let patch = with_table_file(chain(generator(json!({"csv": "tables/half.csv"})), 3), 10);
    let program = program(&patch, &[]);
    assert!((voltage(&run_for(&program, 1e-2, 0.1), "B3.F") - 12.5).abs() < 1e-12);
}

#[test]
fn too_many_uses_of_a_table_give_one_finding() {
    let patch = with_table_file(chain(generator(json!({"csv": "tables/half.csv"})), 1002), 10_000);
    let [finding] = &refusal(&patch).findings[..] else { panic!("{}", refusal(&patch)) };
    assert_eq!(finding.code, Code::BAD_TABLE);
    assert!(finding.message.contains("more than 10000000 points"), "{}", finding.message);
}
