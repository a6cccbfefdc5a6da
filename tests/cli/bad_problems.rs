//! Messages of `patchcord scale` about problems, and of other commands that get a problem.

use std::fs;

use super::{code, errors, json, out, patchcord, path};

/// A problem without a title, in a file `decay.json` of a new folder, with one replacement. Returns the folder and the
/// file.
fn decay(before: &str, after: &str) -> (tempfile::TempDir, String) {
    let text = r#"{
  "patchcord": 1,
  "parameters": {"T": {"value": 2, "unit": "s"}},
  "quantities": {"x": {"unit": "mm", "initial": 50}},
  "equations": ["T x' = -x"],
  "run": {"for": 10, "step": 0.01}
}
"#;
    assert!(text.contains(before), "{before}");
    let folder = tempfile::tempdir().unwrap();
    let file = path(&folder, "decay.json");
    fs::write(&file, text.replace(before, after)).unwrap();
    (folder, file)
}

#[test]
fn a_fault_of_a_problem_has_exit_code_1_and_a_position() {
    let faults = [
        (", \"step\": 0.01", "", "missing-key", 6, 10),
        (", \"initial\": 50", "", "missing-key", 4, 18),
        ("T x'", "h x'", "unknown-name", 5, 18),
        ("= -x", "= 100 * x", "unbounded", 4, 18),
    ];
    for (before, after, expected, line, column) in faults {
        let (_folder, file) = decay(before, after);
        let scaled = patchcord(&["scale", &file, "--json"]);
        assert_eq!(code(&scaled), 1, "{}", errors(&scaled));
        let document = json(&scaled);
        let first = &document["diagnostics"][0];
        let found = (first["code"].as_str(), first["line"].as_u64(), first["column"].as_u64());
        assert_eq!(found, (Some(expected), Some(line), Some(column)), "{}", errors(&scaled));
        assert_eq!((&document["ok"], &document["problem"]), (&false.into(), &file.as_str().into()));
    }
}

#[test]
fn a_fault_of_the_built_patch_is_at_the_quantity_of_the_problem() {
    let (_folder, file) = decay("= -x", "= 10 - 20 * step(x)");
    let text = fs::read_to_string(&file).unwrap().replace("\"mm\", \"initial\": 50", "\"1\", \"initial\": 5");
    fs::write(&file, text).unwrap();
    let scaled = patchcord(&["scale", &file]);
    assert_eq!(code(&scaled), 1);
    let text = errors(&scaled);
    assert!(text.contains("step(x) switches without end") && text.contains("decay.json:4:18"), "{text}");
    assert!(!text.contains("(built)") && !text.contains("relay"), "{text}");
}

#[test]
fn a_patch_has_the_name_of_the_problem_as_its_title_and_ends_with_a_line_feed() {
    let (folder, file) = decay("", "");
    let patch = path(&folder, "patch.json");
    assert_eq!(code(&patchcord(&["scale", &file, "--out", &patch])), 0);
    let text = fs::read_to_string(&patch).unwrap();
    assert!(text.contains("\n  \"title\": \"decay\",\n") && text.ends_with("}\n"), "{text}");
}

#[test]
fn other_commands_say_that_a_problem_must_be_scaled() {
    let (folder, file) = decay("", "");
    let picture = path(&folder, "picture.svg");
    let commands: [&[&str]; 4] =
        [&["check", &file], &["run", &file], &["equations", &file], &["draw", &file, "--plot", &picture]];
    for command in commands {
        let output = patchcord(command);
        let text = errors(&output);
        assert_eq!((code(&output), out(&output).as_str()), (1, ""), "{text}");
        assert!(text.contains("this is a problem, where a patch is needed"), "{text}");
        assert!(text.contains("`patchcord scale PROBLEM.json --out PATCH.json` makes a patch"), "{text}");
    }
}
