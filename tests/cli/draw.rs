//! `patchcord draw`.

use std::fs;
use std::path::Path;

use super::{FIG_8_16, code, errors, json, out, patchcord, patchcord_with_progress, path};

#[test]
fn a_schematic_is_drawn() {
    let folder = tempfile::tempdir().unwrap();
    let svg = path(&folder, "a.svg");
    let drawn = patchcord(&["draw", FIG_8_16, "--plot", &svg]);
    assert_eq!((code(&drawn), errors(&drawn), out(&drawn)), (0, String::new(), format!("wrote {svg}\n")));
    let picture = fs::read_to_string(&svg).unwrap();
    assert!(["DZ", "0.2520", "IC 100 V", "friction_level"].iter().all(|text| picture.contains(text)));
    assert!(!picture.contains("voltages at"));
}

#[test]
fn a_patch_panel_reports_its_progress_in_plain_lines() {
    let folder = tempfile::tempdir().unwrap();
    let svg = path(&folder, "a.svg");
    let drawn = patchcord_with_progress("0.001", &["draw", FIG_8_16, "--board", "--plot", &svg]);
    let lines = errors(&drawn);
    assert_eq!((code(&drawn), out(&drawn)), (0, format!("wrote {svg}\n")), "{lines}");
    assert!(lines.lines().all(|line| line.starts_with("draw: ")), "{lines}");
    assert!(lines.lines().any(|line| line.contains(" of ") && line.contains(" cords")), "{lines}");
}

#[test]
fn voltages_are_those_at_the_requested_time() {
    let folder = tempfile::tempdir().unwrap();
    let png = path(&folder, "a.png");
    let arguments =
        ["draw", FIG_8_16, "--dark", "--values", "0.5", "--plot", &png, "--out", &path(&folder, "")];
    assert_eq!(code(&patchcord(&arguments)), 0);
    assert!(fs::read(&png).unwrap().starts_with(b"\x89PNG"));
    let text = fs::read_to_string(path(&folder, "fig-8-16.schematic.svg")).unwrap();
    assert!(text.contains("voltages at t = 0.5 s"));
    let data = json(&patchcord(&["draw", FIG_8_16, "--values", "--json"]));
    let symbols = data["schematic"]["symbols"].as_array().unwrap();
    assert_eq!(symbols.len(), 27);
    let memory = symbols.iter().find(|symbol| symbol["name"] == "A1").unwrap();
    assert_eq!(memory["outputs"][0]["volts"], 100.0);
}

#[test]
fn a_schematic_needs_an_output_file() {
    let folder = tempfile::tempdir().unwrap();
    let (copy, other) = (path(&folder, "patch.svg"), path(&folder, "other.svg"));
    fs::copy(FIG_8_16, &copy).unwrap();
    for (arguments, text) in [
        (vec!["draw", FIG_8_16], "no output file"),
        (vec!["draw", FIG_8_16, "--plot", "a.pdf"], ".svg or .png"),
        (vec!["draw", &copy, "--plot", &copy], "the patch itself"),
        (vec!["draw", FIG_8_16, "--values", "-1", "--plot", &other], "--values"),
        (vec!["draw", FIG_8_16, "--values", "soon", "--plot", &other], "not a number"),
    ] {
        let failed = patchcord(&arguments);
        assert_eq!(code(&failed), 2, "{arguments:?}");
        assert!(errors(&failed).contains(text), "{}", errors(&failed));
    }
    assert!(fs::read_to_string(&copy).unwrap().starts_with('{') && !Path::new(&other).exists());
}

#[test]
fn voltages_at_a_later_time_need_a_valid_run() {
    let folder = tempfile::tempdir().unwrap();
    let stepless = path(&folder, "stepless.json");
    let mut patch: serde_json::Value = serde_json::from_str(&fs::read_to_string(FIG_8_16).unwrap()).unwrap();
    patch["run"].as_object_mut().unwrap().remove("step");
    fs::write(&stepless, patch.to_string()).unwrap();
    let phased = path(&folder, "phased.json");
    patch["run"] = serde_json::json!({"step": 1e-4, "phases": [{"operate": 1.0}, {"hold": 1.0}]});
    fs::write(&phased, patch.to_string()).unwrap();
    for (patch, seconds, text) in [
        (FIG_8_16, "1e15", "give an earlier time with --values"),
        (FIG_8_16, "1e-9", "give a later time with --values"),
        (&stepless, "0.5", "write {\"step\": SECONDS} there"),
        (&phased, "2.5", "the run ends after 2 s: give an earlier time with --values"),
    ] {
        let failed = patchcord(&["draw", patch, "--values", seconds, "--json"]);
        assert_eq!(code(&failed), 2, "{seconds} of {patch}");
        assert!(
            errors(&failed).contains(text) || out(&failed).contains(&text.replace('"', "\\\"")),
            "{}{}",
            errors(&failed),
            out(&failed)
        );
    }
    for patch in [&stepless, &phased] {
        assert_eq!(code(&patchcord(&["draw", patch, "--values", "--json"])), 0, "{patch}");
    }
}

/// A ramp that is held, set to a lower rate, ended by a relay, held, and restarted.
#[test]
fn voltages_follow_the_phases_of_the_run() {
    let folder = tempfile::tempdir().unwrap();
    let patch = path(&folder, "fall.json");
    let fall = serde_json::json!({
        "patchcord": 1,
        "parameters": {"share": {"value": 0.5, "unit": "1", "range": [0, 1]}},
        "elements": {
            "P": {"kind": "pot", "in": "+100", "setting": "share"},
            "A": {"kind": "integrator", "in": {"x1": ["P"]}},
            "K": {"kind": "relay", "in": "A", "on": "+100", "off": "-100", "pull_in": -20, "drop_out": -30}
        },
        "run": {"step": 1e-2, "phases": [
            {"operate": 0.5}, {"hold": 1}, {"set": {"share": 0.1}}, {"operate": 9, "until": "K"}, {"hold": 1},
            {"repeat": 1000000, "phases": [{"initial_condition": true}, {"operate": 1}]}
        ]}
    });
    fs::write(&patch, fall.to_string()).unwrap();
    for (seconds, a, position) in [
        ("0.2", -10.0, "pulled-in"),
        ("0.5", -25.0, "pulled-in"),
        ("1.2", -25.0, "pulled-in"),
        ("1.75", -27.5, "pulled-in"),
        ("2.5", -30.0, "released"),
        ("3.5", -5.0, "pulled-in"),
        ("4.25", -2.5, "pulled-in"),
    ] {
        let text = json(&patchcord(&["draw", &patch, "--values", seconds, "--json"]));
        let symbols = text["schematic"]["symbols"].as_array().unwrap();
        let found = symbols[1]["outputs"][0]["volts"].as_f64().unwrap();
        assert!((found - a).abs() < 1e-9, "{found} V after {seconds} s");
        assert_eq!(symbols[2]["position"], position, "after {seconds} s");
    }
}

/// The layout of a sheet without voltages and positions.
fn layout(mut schematic: serde_json::Value) -> serde_json::Value {
    let symbols = schematic["symbols"].as_array_mut().unwrap().iter_mut();
    for symbol in symbols {
        symbol["texts"].take();
        symbol["position"].take();
        symbol["outputs"].as_array_mut().unwrap().iter_mut().for_each(|output| drop(output["volts"].take()));
    }
    schematic["macros"].take();
    schematic
}

/// The layout does not depend on voltages, so sheets of one patch can be compared.
#[test]
fn voltages_do_not_change_the_layout_of_shipped_patches() {
    for file in crate::common::files::shipped_files() {
        let patch = file.to_str().unwrap();
        let drawn = |options: &[&str]| {
            let drawn = patchcord(&[&["draw", patch, "--json"], options].concat());
            assert_eq!(code(&drawn), 0, "{patch}: {}", errors(&drawn));
            json(&drawn)["schematic"].clone()
        };
        let (bare, read) = (drawn(&[]), drawn(&["--values", "1"]));
        let volts = |symbol: &serde_json::Value| symbol["outputs"][0]["volts"].is_number();
        assert!(read["symbols"].as_array().unwrap().iter().all(volts), "{patch}");
        assert!(layout(bare) == layout(read), "{patch} has another layout with voltages");
    }
}

#[test]
fn a_board_shows_no_voltages() {
    let failed = patchcord(&["draw", FIG_8_16, "--board", "--values", "--json"]);
    assert_eq!(code(&failed), 2);
    let board = &json(&patchcord(&["draw", FIG_8_16, "--board", "--json"]))["board"];
    assert!(
        board["cords"].as_array().unwrap().iter().any(|cord| cord["from"] == "+100" && cord["to"] == "KS1")
    );
}

#[test]
fn macros_are_drawn_as_boxes_or_opened() {
    let rod = "patches/lessons/heat-rod.json";
    let drawn = |options: &[&str]| {
        json(&patchcord(&[&["draw", rod, "--json"], options].concat()))["schematic"].clone()
    };
    let names = |symbols: &serde_json::Value| -> Vec<String> {
        symbols.as_array().unwrap().iter().map(|symbol| symbol["name"].as_str().unwrap().to_owned()).collect()
    };
    let closed = drawn(&["--values", "100"]);
    assert_eq!(names(&closed["symbols"]), ["hot", "P0", "C1", "C2", "C3", "C4", "C5", "C6", "B7"]);
    assert_eq!(closed["macros"][0]["name"], "cell");
    assert_eq!(names(&closed["macros"][0]["symbols"]), ["left", "right", "A", "P", "flow", "u"]);
    let u = &closed["symbols"][2]["outputs"][1];
    assert_eq!((&u["port"], &u["signals"]), (&"u".into(), &serde_json::json!(["T1"])));
    assert!(u["volts"].as_f64().unwrap() < -10.0);
    let open = drawn(&["--open"]);
    assert_eq!(names(&open["symbols"]).len(), 15);
    assert_eq!(open["macros"], serde_json::json!([]));
}

/// A chain of `pots` pots and a summer with `inputs` inputs.
fn wide_and_tall(pots: usize, inputs: usize) -> String {
    let pot = |index: usize| {
        let from = if index == 0 { "+100".to_owned() } else { format!("P{}", index - 1) };
        (format!("P{index}"), serde_json::json!({"kind": "pot", "in": from, "setting": 0.5}))
    };
    let mut elements: serde_json::Map<_, _> = (0..pots).map(pot).collect();
    let mut cords = vec!["+100".to_owned(); inputs];
    cords.push(format!("P{}", pots - 1));
    elements.insert("B".to_owned(), serde_json::json!({"kind": "summer", "in": {"x1": cords}}));
    serde_json::json!({"patchcord": 1, "machine": "unlimited", "elements": elements}).to_string()
}

#[test]
fn a_drawing_that_is_too_large_returns_an_error_with_advice() {
    let folder = tempfile::tempdir().unwrap();
    let patch = path(&folder, "large.json");
    for (pots, inputs, ending, text) in [
        (1000, 1, "svg", "1001 symbols are too many for one sheet; the maximum is 1000; put parts"),
        (1, 4000, "svg", "a side has at most 60000 pixels; put parts of the patch into macros"),
        (40, 3500, "png", "a PNG has at most 100 million pixels; an SVG has no such limit"),
    ] {
        fs::write(&patch, wide_and_tall(pots, inputs)).unwrap();
        let drawing = path(&folder, &format!("large.{ending}"));
        let failed = patchcord(&["draw", &patch, "--plot", &drawing]);
        assert_eq!(code(&failed), 1);
        assert!(errors(&failed).contains(text), "{}", errors(&failed));
        assert!(!Path::new(&drawing).exists());
    }
}

#[test]
fn too_many_cords_return_an_error() {
    let folder = tempfile::tempdir().unwrap();
    let patch = path(&folder, "cords.json");
    fs::write(&patch, wide_and_tall(1, 999)).unwrap();
    let failed = patchcord(&["draw", &patch, "--board", "--plot", &path(&folder, "cords.svg")]);
    let text =
        "1001 cords are too many for one panel; the maximum is 1000; the schematic, without --board, may fit";
    assert!(code(&failed) == 1 && errors(&failed).contains(text), "{}", errors(&failed));
}

/// The height of the symbols is estimated before the slow layout.
#[test]
fn a_drawing_that_is_too_high_is_reported_quickly() {
    let folder = tempfile::tempdir().unwrap();
    let patch = path(&folder, "high.json");
    let pot = serde_json::json!({"kind": "pot", "in": "+100", "setting": 0.001});
    let names: Vec<String> = (0..999).map(|index| format!("P{index}")).collect();
    let mut elements: serde_json::Map<_, _> = names.iter().map(|name| (name.clone(), pot.clone())).collect();
    elements.insert("B".to_owned(), serde_json::json!({"kind": "summer", "in": {"x1": names}}));
    let document = serde_json::json!({"patchcord": 1, "machine": "unlimited", "elements": elements});
    fs::write(&patch, document.to_string()).unwrap();
    let failed = patchcord(&["draw", &patch, "--json"]);
    assert_eq!(code(&failed), 1);
    let text = out(&failed);
    assert!(
        text.contains("the drawing would be at least") && text.contains("put parts of the patch into macros"),
        "{text}"
    );
}
