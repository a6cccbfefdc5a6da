//! `patchcord run --sensitivity`.

use std::fs;

use super::{FIG_8_16, code, errors, json, out, patchcord, path};

pub(super) const BALL: &str = "patches/lessons/bouncing-ball.json";

#[test]
fn the_page_shows_what_the_command_prints() {
    let page = fs::read_to_string("docs/sensitivity.md").unwrap();
    let command = page.lines().find_map(|line| line.strip_prefix("    patchcord ")).unwrap();
    let shown = page.split("```text\n").nth(1).and_then(|rest| rest.split("```").next()).unwrap();
    let words: Vec<&str> = command.split(' ').take_while(|word| *word != "--plot").collect();
    let printed = out(&patchcord(&words));
    assert!(printed.contains(shown), "{command}\n{printed}");
    assert!(shown.contains("16.61") && page.contains("by 16.61 percent"));
}

#[test]
fn derivatives_are_columns_readings_and_pictures() {
    let folder = tempfile::tempdir().unwrap();
    let (svg, csv) = (path(&folder, "ball.svg"), path(&folder, "ball.csv"));
    let arguments = [
        "run",
        "crates/core/tests/patches/bouncing-ball.json",
        "--record",
        "height",
        "--sensitivity",
        "e, g,e",
    ];
    let text = json(&patchcord(&[&arguments[..], &["--json", "--csv", &csv, "--plot", &svg]].concat()));
    let names: Vec<_> =
        text["readings"].as_array().unwrap().iter().map(|reading| &reading["signal"]).collect();
    assert_eq!(names, ["height", "d height / d e", "d height / d g"]);
    let first = &text["sensitivities"][0];
    assert_eq!(
        (&first["signal"], &first["parameter"], &first["unit"]),
        (&"height".into(), &"e".into(), &"m".into())
    );
    let size = first["most"]["value"].as_f64().unwrap().abs();
    assert!((first["relative"].as_f64().unwrap() - 0.8 * size).abs() < 1e-9, "{first}");
    let table = fs::read_to_string(&csv).unwrap();
    assert!(
        table.contains("# d height / d g: m/(m/s2)\n")
            && table.contains("\nt,height,d height / d e,d height / d g\n")
    );
    let picture = fs::read_to_string(&svg).unwrap();
    for part in ["What height owes to its parameters", "p d height / d p, m", "e d height / d e"] {
        assert!(picture.contains(part), "{part}");
    }
    let twice = out(&patchcord(&[&arguments[..], &["--repeat", "2"]].concat()));
    assert!(twice.contains("\n  2  d height / d g"), "{twice}");
}

#[test]
fn missing_derivatives_return_errors() {
    let noise = "crates/core/tests/patches/memory.json";
    for (patch, options, text, wanted) in [
        (FIG_8_16, "--sensitivity m", "the patch has no parameter m; did you mean \"M\"?", 2),
        (
            "patches/problems/bouncing-ball.json",
            "--sensitivity e",
            "the patch has no parameter e; it has none",
            2,
        ),
        (FIG_8_16, "--sensitivity M,", "a name is missing", 2),
        (noise, "--sensitivity top --every 1e-9 --step 1e-9", "the run would", 2),
    ] {
        let failed = patchcord(&[&["run", patch], &options.split(' ').collect::<Vec<_>>()[..]].concat());
        assert_eq!(code(&failed), wanted, "{options}: {}", errors(&failed));
        assert!(errors(&failed).contains(text), "{}", errors(&failed));
    }
}

#[test]
fn a_derivative_that_ceases_to_exist_stops_the_run() {
    let folder = tempfile::tempdir().unwrap();
    let (patch, csv) = (path(&folder, "late.json"), path(&folder, "late.csv"));
    let text = serde_json::json!({
        "patchcord": 1,
        "machine": "unlimited",
        "parameters": {"mark": {"value": 50, "unit": "V", "range": [1, 90]}},
        "scales": {"volt": {"per_volt": 1, "unit": "V"}},
        "drives": {"u": {"kind": "ramp", "scale": "volt", "rate": 50}},
        "elements": {
            "K1": {"kind": "relay", "in": "u", "on": "+100", "off": "-100", "pull_in": "mark / volt", "drop_out": -90},
            "K2": {"kind": "relay", "in": "u", "on": "+100", "off": "-100", "pull_in": 50, "drop_out": -90}
        },
        "run": {"for": 2, "step": 0.01}
    });
    fs::write(&patch, text.to_string()).unwrap();
    let stopped = patchcord(&["run", &patch, "--sensitivity", "mark", "--csv", &csv]);
    assert_eq!(code(&stopped), 1);
    let text = errors(&stopped);
    assert!(
        text.contains("K2 and K1 switch at the same instant") && text.contains(&format!("{patch}:")),
        "{text}"
    );
    assert!(text.contains("the files contain the run up to t = "), "{text}");
    assert!(fs::read_to_string(&csv).unwrap().lines().count() > 90);
}

/// The derivative is -1 N/N. In units of the largest offset it is too large for a number.
#[test]
fn a_derivative_that_is_not_finite_leaves_no_table() {
    let folder = tempfile::tempdir().unwrap();
    let (patch, csv) = (path(&folder, "huge.json"), path(&folder, "huge.csv"));
    let text = serde_json::json!({
        "patchcord": 1,
        "machine": "unlimited",
        "parameters": {"offset": {"value": 0, "unit": "N", "range": [-20, 1.7976931348623157e308]}},
        "scales": {"force": {"per_volt": 5, "unit": "N"}},
        "elements": {
            "PO": {"kind": "free-pot", "in": "+100", "end": "-100", "setting": "0.5 + offset / force / 200"},
            "SF": {"kind": "summer", "in": {"x1": ["PO"]}}
        },
        "signals": {"net_force": {"at": "SF", "scale": "force"}},
        "run": {"for": 1, "step": 0.1}
    });
    fs::write(&patch, text.to_string()).unwrap();
    let stopped = patchcord(&["run", &patch, "--sensitivity", "offset", "--csv", &csv]);
    let text = errors(&stopped);
    assert_eq!(code(&stopped), 1, "{text}");
    assert!(text.contains("no derivative by offset: at t = 0 s it is not a finite number"), "{text}");
    assert!(!fs::exists(&csv).unwrap());
}

#[test]
fn a_patch_may_plot_derivatives() {
    let folder = tempfile::tempdir().unwrap();
    let (patch, csv, svg) =
        (path(&folder, "ball.json"), path(&folder, "ball.csv"), path(&folder, "ball.svg"));
    let text = fs::read_to_string("crates/core/tests/patches/bouncing-ball.json").unwrap();
    fs::write(&patch, text.replace(r#""y": ["height"]"#, r#""y": ["height", "d velocity / d e"]"#)).unwrap();
    assert_eq!(code(&patchcord(&["check", &patch])), 0);
    let ran = patchcord(&["run", &patch, "--csv", &csv, "--plot", &svg]);
    assert_eq!((code(&ran), errors(&ran).as_str()), (0, ""));
    let columns = "\nt,height,velocity,d height / d e,d velocity / d e\n";
    assert!(fs::read_to_string(&csv).unwrap().contains(columns));
    assert!(fs::read_to_string(&svg).unwrap().contains("d velocity / d e (right)"));
    let without = json(&patchcord(&["run", &patch, "--record", "height", "--json"]));
    assert_eq!(without["sensitivities"], serde_json::json!([]));
}
