//! Documents of `patchcord scale`.

use std::fs;
use std::path::Path;

use super::{code, errors, json, out, patchcord, path};

#[test]
fn a_machine_with_too_few_parts_gives_a_warning_and_a_patch() {
    let folder = tempfile::tempdir().unwrap();
    let file = path(&folder, "patch.json");
    let problem = "crates/equations/tests/systems/projectile.json";
    let scaled = patchcord(&["scale", problem, "--machine", "solartron-1451", "--out", &file, "--json"]);
    assert_eq!(code(&scaled), 0, "{}", errors(&scaled));
    assert!(errors(&scaled).contains("the patch uses 5 multipliers"), "{}", errors(&scaled));
    let document = json(&scaled);
    let diagnostics = document["diagnostics"].as_array().unwrap();
    let missing: Vec<_> = diagnostics.iter().filter(|finding| finding["code"] == "missing-parts").collect();
    assert_eq!(missing.len(), 1, "{diagnostics:?}");
    assert_eq!(missing[0]["severity"], "warning");
    assert!(!document["quantities"].as_array().unwrap().is_empty());
    assert!(Path::new(&file).is_file());
    assert!(missing[0]["hint"].as_str().unwrap().contains("--machine unlimited"), "{diagnostics:?}");

    // A check refuses the patch. The commands in the text lead to one that it accepts.
    let checked = errors(&patchcord(&["check", &file]));
    assert!(checked.contains("write \"machine\": \"unlimited\""), "{checked}");
    let text = out(&patchcord(&["scale", problem, "--machine", "solartron-1451", "--out", &file]));
    let command = format!("patchcord scale {problem} --machine unlimited --out {file}");
    assert!(text.ends_with(&format!("\nThen:\n  {command}\n")), "{text}");
    let arguments: Vec<&str> = command.split(' ').skip(1).collect();
    let text = out(&patchcord(&arguments));
    let commands = format!("\nThen:\n  patchcord check {file}\n  patchcord run {file}\n");
    assert!(text.ends_with(&commands), "{text}");
    assert_eq!(code(&patchcord(&["check", &file])), 0);
}

#[test]
fn the_output_names_equations_that_the_patch_does_not_state() {
    let scaled =
        |system: &str| out(&patchcord(&["scale", &format!("crates/equations/tests/systems/{system}.json")]));
    let text = scaled("table-spring");
    let line = "\nthe patch does not state restoring = spring(x): equations of a patch have no tables, so \
                `patchcord check` does not compare it\n";
    assert!(text.contains(line), "{text}");
    assert!(!scaled("projectile").contains("does not state"));
}

#[test]
fn a_prescribed_scale_that_is_too_small_is_at_its_number() {
    let folder = tempfile::tempdir().unwrap();
    let file = path(&folder, "decay.json");
    let text = r#"{"patchcord": 1,
  "parameters": {"T": {"value": 2, "unit": "s"}},
  "quantities": {"x": {"unit": "mm", "initial": 50, "per_volt": 0.1}},
  "equations": ["T x' = -x"],
  "run": {"for": 10, "step": 0.01}
}"#;
    fs::write(&file, text).unwrap();
    let scaled = patchcord(&["scale", &file, "--json"]);
    assert_eq!(code(&scaled), 1, "{}", errors(&scaled));
    let finding = &json(&scaled)["diagnostics"][0];
    assert_eq!((finding["line"].as_u64(), finding["column"].as_u64()), (Some(3), Some(65)));
    assert_eq!(finding["message"], "the scale of x is prescribed as 0.1 mm per volt, but x reaches 500 V");
    assert_eq!(finding["hint"], "let 1 V represent at least 0.6 mm");
}

/// 5 V of a drive are 83.3 V of the machine with 0.06 V per volt.
#[test]
fn the_scaling_table_has_drives_and_units_of_scales() {
    let folder = tempfile::tempdir().unwrap();
    let file = path(&folder, "filter.json");
    let text = |maximum: &str| {
        format!(
            r#"{{"patchcord": 1, "parameters": {{"T": {{"value": 1, "unit": "s"}}}},
  "quantities": {{"x": {{"unit": "V", "initial": 0{maximum}}}}},
  "drives": {{"u": {{"kind": "step", "unit": "V", "height": 5, "at": 1}}}},
  "equations": ["T x' = u - x"], "run": {{"for": 10, "step": 0.01}}}}"#
        )
    };
    fs::write(&file, text("")).unwrap();
    let scaled = out(&patchcord(&["scale", &file]));
    let row = |text: &str, name: &str| {
        let line = text.lines().find(|line| line.split_whitespace().next() == Some(name));
        line.unwrap_or_else(|| panic!("{text}")).split_whitespace().map(str::to_owned).collect::<Vec<_>>()
    };
    assert_eq!(row(&scaled, "quantity").join(" "), "quantity maximum unit 1 V is peak in V", "{scaled}");
    assert_eq!(row(&scaled, "u").join(" "), "u 5 V 0.06 V 83.3", "{scaled}");
    assert!(scaled.contains("[x] is the voltage of x, and [x]' its derivative in V/s:\n"), "{scaled}");
    let drive = &json(&patchcord(&["scale", &file, "--json"]))["drives"][0];
    assert_eq!((&drive["name"], &drive["unit"]), (&"u".into(), &"V".into()));
    assert_eq!(drive["per_volt"], 0.06);
    fs::write(&file, text(", \"maximum\": 6")).unwrap();
    let stated = out(&patchcord(&["scale", &file]));
    assert_eq!(row(&stated, "quantity")[..3], ["quantity", "expected", "maximum"], "{stated}");
    assert_eq!(row(&stated, "x")[..3], ["x", "6", "4.999"], "{stated}");
}
