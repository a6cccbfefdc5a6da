//! Schematics: every element and every cord is drawn, and nothing overlaps.

use std::collections::BTreeMap;

use proptest::prelude::*;
use serde_json::{Value, json};

use crate::common::element;
use crate::schematic_checks::{check, schematic};
use patchcord_core::patch::{ElementBuilder, Patch, PatchBuilder};
use patchcord_draw::plot::{Format, Primitive, Theme, render_drawing};

#[test]
fn patches_of_the_tests_are_drawn_correctly() {
    for file in crate::common::files::test_patch_files() {
        let patch = crate::common::patch_of(&file);
        check(&crate::common::circuit(&patch, &[]), patch.file());
    }
}

#[test]
fn the_final_circuit_is_drawn_correctly() {
    let circuit = crate::common::circuit(&crate::common::slideway(), &[]);
    let drawn = schematic(&circuit);
    check(&circuit, "fig-8-16");
    let dead_zone = drawn.main.symbols.iter().find(|placed| placed.symbol.name == "DZ").unwrap();
    let texts: Vec<_> = dead_zone.labels().map(|label| label.text.as_str()).collect();
    assert!(["DZ", "0.2537", "PB1 PB2 D1D2"].iter().all(|text| texts.contains(text)), "{texts:?}");
    let v_o = drawn.main.symbols.iter().find(|placed| placed.symbol.name == "B3").unwrap();
    assert_eq!(v_o.symbol.outputs[0].signals, ["v_o"]);
    let live = drawn.to_live_json().to_string();
    assert!(live.len() < 60_000, "{} bytes are too many for every change of the patch", live.len());
}

#[test]
fn circuits_with_common_drives_have_separate_rows() {
    let patch = crate::common::shipped("thesis/fig-8-16-both");
    let drawn = schematic(&crate::common::circuit(&patch, &[]));
    let of = |prefix: &'static str| {
        drawn.main.symbols.iter().filter(move |placed| placed.symbol.name.starts_with(prefix))
    };
    let lowest = of("D.").map(|placed| placed.area.bottom).fold(0.0, f64::max);
    assert!(of("B.").count() > 10 && of("B.").all(|placed| placed.area.top > lowest));
}

#[test]
fn long_texts_stay_on_the_sheet() {
    let name = |index: usize| format!("a_pot_with_a_name_that_is_far_too_long_to_be_read_{index}");
    let pot = |index: usize| {
        let setting = vec!["0.001"; 5 + 20 * (index % 3)].join(" + ");
        element("pot")
            .cord("in", "+100")
            .set("setting", setting)
            .set("note", "the purpose of this pot ".repeat(index))
    };
    let builder = PatchBuilder::new("long").machine("unlimited").run(1.0, 1e-3);
    let patch = (0..9).fold(builder, |builder, index| builder.element(&name(index), pot(index))).build();
    check(&crate::common::circuit(&patch.unwrap(), &[]), "long");
}

#[test]
fn columns_of_lists_are_balanced() {
    let builder = PatchBuilder::new("notes").machine("unlimited").run(1.0, 1e-3);
    let pot = || element("pot").cord("in", "+100").set("setting", 0.5).set("note", "half");
    let patch = (0..15).fold(builder, |builder, index| builder.element(&format!("P{index}"), pot())).build();
    let drawing = schematic(&crate::common::circuit(&patch.unwrap(), &[])).drawing();
    let labels = drawing.primitives.iter().filter_map(Primitive::label);
    let mut columns: BTreeMap<i64, usize> = BTreeMap::new();
    labels.filter(|label| label.text == "half").for_each(|label| {
        *columns.entry(label.at.0 as i64).or_default() += 1;
    });
    let (min, max) = (columns.values().min().unwrap(), columns.values().max().unwrap());
    assert!(columns.len() > 1 && max - min <= 1, "{columns:?}");
}

#[test]
fn flags_do_not_overlap_texts_at_jacks() {
    let integrator = element("integrator")
        .cords("x1", ["+100", "-100"])
        .cords("gap", ["+100", "ground"])
        .cords("brake_x10", ["-100"])
        .cords("reset", ["ground"])
        .set("restitution", 0.5);
    let patch = PatchBuilder::new("flags").run(1.0, 1e-3).element("A", integrator).build();
    check(&crate::common::circuit(&patch.unwrap_or_else(|report| panic!("{report}")), &[]), "flags");
}

#[test]
fn the_same_circuit_gives_the_same_bytes() {
    let circuit = crate::common::circuit(&crate::common::slideway(), &[]);
    let bytes = |format| render_drawing(&schematic(&circuit).drawing(), format, Theme::Light).unwrap();
    for format in [Format::Svg, Format::Png] {
        assert!(bytes(format) == bytes(format));
    }
    let text = String::from_utf8(bytes(Format::Svg)).unwrap();
    roxmltree::Document::parse(&text).unwrap();
}

/// Returns the patch of a document.
fn parsed(document: &Value) -> Patch {
    Patch::parse("macros.json", &document.to_string()).unwrap_or_else(|report| panic!("{report}"))
}

#[test]
fn macros_are_drawn_as_boxes_with_ports_settings_and_inner_signals() {
    let text = std::fs::read_to_string("../core/tests/patches/lags-in-macros.json").unwrap();
    let mut document: Value = serde_json::from_str(&text).unwrap();
    document["signals"]["middle"] = json!({"at": "W.sum", "scale": "volt"});
    let drawn = schematic(&crate::common::circuit(&parsed(&document), &[]));
    let names: Vec<_> = drawn.main.symbols.iter().map(|placed| placed.symbol.name.as_str()).collect();
    assert_eq!(names, ["D", "P", "W", "L"]);
    let opened: Vec<_> =
        drawn.macros.iter().map(|opened| (opened.of.as_str(), opened.instance.as_str())).collect();
    assert_eq!(opened, [("two-lags", "W"), ("lag-8-15", "W.first")]);
    let w = &drawn.main.symbols[2];
    let texts: Vec<_> = w.labels().map(|label| label.text.as_str()).collect();
    for expected in ["W", "two-lags", "in", "level", "out", "between", "T 20 ms", "inside: middle"] {
        assert!(texts.contains(&expected), "{expected}: {texts:?}");
    }
    let ports: Vec<_> = w.symbol.outputs.iter().map(|output| output.port.as_str()).collect();
    assert_eq!(ports, ["out", "between"]);
    assert_eq!(w.symbol.outputs[1].signals, ["between"]);
    assert!(w.outputs[0].1 < w.outputs[1].1);
    let inside: Vec<_> =
        drawn.macros[0].diagram.symbols.iter().map(|placed| placed.symbol.name.as_str()).collect();
    assert_eq!(inside, ["in", "level", "first", "sum", "second", "out", "between"]);
    let live = drawn.to_live_json();
    let outputs: Vec<_> =
        live["symbols"][2]["outputs"].as_array().unwrap().iter().map(|output| &output["name"]).collect();
    assert_eq!(outputs, ["W.out", "W.between"]);
}

/// Special ports: driven by the same output, by a reference or by the instance itself; connected only to
/// an inner instance; outputs without readers.
#[test]
fn special_ports_are_drawn_correctly() {
    let circuit = crate::common::circuit(
        &parsed(&json!({
            "patchcord": 1,
            "scales": {"volt": {"per_volt": 1, "unit": "V"}},
            "drives": {"D": {"kind": "step", "scale": "volt", "height": 50}},
            "macros": {
                "sum": {
                    "inputs": {"a": "", "b": "", "c": ""},
                    "outputs": {"minus": "B"},
                    "elements": {"B": {"kind": "summer", "in": {"x1": ["a", "b", "B2"], "x10": ["c"]}},
                                 "B2": {"kind": "pot", "in": "a", "setting": 0.1}}
                },
                "pair": {
                    "inputs": {"one": "", "two": ""},
                    "outputs": {"first": "S", "second": "A", "again": "A", "unread": "P"},
                    "elements": {
                        "S": {"kind": "sum", "a": "one", "b": "two", "c": "A"},
                        "T": {"kind": "sum", "a": "two", "b": "ground", "c": "one"},
                        "A": {"kind": "integrator", "in": {"x1": ["S", "T", "two", "one", "A"]}},
                        "P": {"kind": "pot", "in": "A", "setting": 0.5}
                    }
                }
            },
            "elements": {
                "M": {"kind": "pair", "one": "D", "two": "D"},
                "N": {"kind": "pair", "one": "+100", "two": "N.second"},
                "O": {"kind": "pair", "one": "M.second", "two": "M.first"}
            },
            "signals": {"x": {"at": "O", "scale": "volt"}, "y": {"at": "N.again", "scale": "volt"}},
            "run": {"for": 1, "step": 1e-3},
            "record": ["x", "y"]
        })),
        &[],
    );
    check(&circuit, "ports");
}

/// Returns elements of several kinds, each with its settings given.
fn elements_with_settings() -> Vec<ElementBuilder> {
    vec![
        element("integrator")
            .cords("x1", ["+100"])
            .cords("gap", ["E7"])
            .cords("reset", ["E9"])
            .set("restitution", 0.75)
            .set("rest", 0.125)
            .set("threshold", 3)
            .set("limit", json!({"upper": 40, "drop": 0.625})),
        element("function-generator")
            .cord("in", "+100")
            .set("symmetry", "odd")
            .set("points", json!([[0, 0], [12, 34], [56, 78]])),
        element("delay").cord("in", "+100").set("delay", 0.25).set("initial", 17),
        element("relay")
            .cord("in", "+100")
            .cord("on", "+100")
            .cord("off", "-100")
            .set("pull_in", 2)
            .set("drop_out", 1)
            .set("closed", true),
        element("key-switch").cord("in", "+100").set("closed", false),
        element("track-hold").cord("in", "+100").cord("track", "+100").set("initial", 5).set("threshold", 3),
        element("multiplier").cord("a", "+100").cord("b", "+100").set("mode", "product"),
        element("dead-zone").cord("in", "+100").set("lower", -7).set("upper", 9),
        element("backlash").cord("in", "+100").set("width", 6),
        element("comparator").cord("in", "E8").cord("against", "E7").set("threshold", 4).set("high", 60),
    ]
}

#[test]
fn settings_that_the_symbol_omits_are_listed() {
    let elements = elements_with_settings().into_iter().enumerate();
    let builder = PatchBuilder::new("settings").machine("unlimited").run(1.0, 1e-3);
    let patch =
        elements.fold(builder, |builder, (index, element)| builder.element(&format!("E{index}"), element));
    let patch = patch.build();
    let circuit = crate::common::circuit(&patch.unwrap_or_else(|report| panic!("{report}")), &[]);
    check(&circuit, "settings");
    let drawn = schematic(&circuit);
    let rows = drawn.lists.iter().flat_map(|list| &list.rows);
    let rows: Vec<_> = rows.map(|row| (row.name.as_str(), row.value.as_str(), row.text.as_str())).collect();
    for row in [
        ("E0 restitution", "0.75", ""),
        ("E0 rest", "0.125 V", ""),
        ("E0 threshold", "3 V", ""),
        ("E0 limit.drop", "0.625 V", ""),
        ("E1 symmetry", "odd", ""),
        ("E1 points", "", "(0, 0) (12, 34) (56, 78)"),
        ("E2 initial", "17 V", ""),
        ("E3", "closed", ""),
        ("E9 high", "60 V", ""),
    ] {
        assert!(rows.contains(&row), "{row:?} among {rows:?}");
    }
}

/// Returns a patch of integrators, summers, pots and multipliers; feedback leads into integrators only.
fn random_patch(kinds: &[u8], cords: &[(u16, u16)]) -> Patch {
    let count = kinds.len();
    let name = |index: usize| format!("E{index}");
    let mut builder = PatchBuilder::new("random").run(1.0, 1e-3);
    for (index, kind) in kinds.iter().enumerate() {
        let (first, second) = cords[index];
        let earlier = |pick: u16| match usize::from(pick) % (index + 1) {
            0 => "+100".to_owned(),
            other => name(other - 1),
        };
        let any = |pick: u16| name(usize::from(pick) % count);
        let new_element = match kind % 4 {
            0 => element("integrator").cords("x1", [&any(first)]).cords("x10", [&any(second)]),
            1 => element("summer").cords("x1", [&earlier(first), &earlier(second)]).cords("x10", ["-100"]),
            2 => element("pot").cord("in", &earlier(first)).set("setting", 0.5),
            _ => element("multiplier")
                .set("mode", "sum-of-squares")
                .cord("a", &earlier(first))
                .cord("b", &earlier(second)),
        };
        builder = builder.element(&name(index), new_element);
    }
    builder.build().unwrap_or_else(|report| panic!("{report}"))
}

proptest! {
    #![proptest_config(crate::common::random_cases(40))]

    #[test]
    fn random_circuits_are_drawn_correctly(
        kinds in prop::collection::vec(any::<u8>(), 1..40),
        cords in prop::collection::vec(any::<(u16, u16)>(), 40),
    ) {
        let circuit = crate::common::circuit(&random_patch(&kinds, &cords), &[]);
        check(&circuit, "random");
    }
}

#[test]
#[ignore = "takes 15 s"]
fn a_large_circuit_is_drawn() {
    let kinds: Vec<u8> = (0..300_u32).map(|index| (index * 7 % 11) as u8).collect();
    let cords: Vec<(u16, u16)> = (0..300_u16).map(|index| (index * 31 + 7, index * 57 + 3)).collect();
    let circuit = crate::common::circuit(&random_patch(&kinds, &cords), &[]);
    check(&circuit, "large");
}
