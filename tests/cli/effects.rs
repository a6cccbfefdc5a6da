//! `patchcord effects`

use super::{code, errors, json, out, patchcord};

#[test]
fn effects_are_listed_and_described() {
    let all = out(&patchcord(&["effects"]));
    for name in ["coulomb-friction", "friction-memory", "overflow", "time-delay"] {
        assert!(all.lines().any(|line| line.starts_with(name)), "{all}");
    }
    let one = out(&patchcord(&["effects", "viscous-friction"]));
    assert!(one.contains("F = c v") && one.contains("sum / own"), "{one}");
    let output = json(&patchcord(&["effects", "--json"]));
    assert_eq!(output.as_array().unwrap().len(), 22);
    let wrong = patchcord(&["effects", "viscous-fiction"]);
    assert_eq!(code(&wrong), 2);
    assert!(errors(&wrong).contains("viscous-friction"), "{}", errors(&wrong));
}

#[test]
fn effects_of_a_folder_are_added_and_wrong_ones_are_reported() {
    let folder = tempfile::tempdir().unwrap();
    let empty = patchcord(&["effects", "--effects", folder.path().to_str().unwrap()]);
    assert!(code(&empty) == 1 && errors(&empty).contains("there is no effect in "), "{}", errors(&empty));
    let effect = std::fs::read_to_string("patches/effects/drift.json").unwrap();
    std::fs::write(folder.path().join("creep.json"), effect).unwrap();
    let arguments = ["effects", "creep", "--effects", folder.path().to_str().unwrap()];
    assert!(out(&patchcord(&arguments)).starts_with("creep: "));
    std::fs::write(folder.path().join("wrong.json"), "{\"effect\": 1}").unwrap();
    std::fs::write(folder.path().join("worse.json"), "{").unwrap();
    let output = patchcord(&arguments);
    assert_eq!(code(&output), 1);
    for expected in ["an effect needs \"title\"", "wrong.json: ", "worse.json: 1 error"] {
        assert!(errors(&output).contains(expected), "{}", errors(&output));
    }
}

/// Parts of the effect cubic-stiffness, their replacements, and the messages of the errors.
const WRONG_CHANGES: &[(&str, &str, &str)] = &[
    (
        "\"kind\": \"inverter\"",
        "\"kind\": \"inverted\"",
        "this form cannot be wired: there is no kind \"inverted\"",
    ),
    ("0.5 + 5000 * k3 * position^3 / sum / G", "0.5 + k4 + k3", "this form cannot be wired"),
    (
        "0.5 + 5000 * k3 * position^3 / sum / G",
        "0.5",
        "no formula of this form's elements and drives contains k3",
    ),
    ("10000 * abs(k3)", "10000 * abs(k4)", "depends on k4, which the form does not have"),
    (
        "\"at\": \"motion\",",
        "\"at\": \"motion\", \"parameters\": [\"k3\", \"k3\"],",
        "this form has the parameter k3 twice",
    ),
    ("\"k3\": {", "\"own\": {", "the parameter own has the name of a quantity of every form"),
    ("\"k3\": {", "\"G\": {", "the parameter G has the name of a gain or drive of this form"),
    ("\"none\": 0", "\"none\": 20", "\"none\" has the value 20, outside the range -10 ... 10"),
    ("[-1, -0.05, 0.3]", "\"hihgest\"", "\"hihgest\" is not one of spectrum, highest, lowest"),
    ("[-1, -0.05, 0.3]", "\"spectrum\"", "gives frequencies, but the reach is sum / position^3"),
    ("\"at\": \"motion\",", "\"at\": \"motion\", \"times\": 0,", "must be within 1 ... 1000000, got 0"),
    ("\"at\": \"motion\",", "\"at\": \"motoin\",", "motion"),
    ("[-1, -0.05, 0.3]", "\"highest\"", "a single name, but the reach is sum / position^3"),
    ("{\"add\": \"B2\"}", "{\"out\": \"B2\"}", "\"out\" is not one of add, subtract, brake, add_to_next"),
    ("[\"position\"]", "[\"in\"]", "\"in\" is not one of own, position, load, force"),
    ("{\"kind\": \"inverter\", \"in\": \"M2\"}", "\"inverter\"", "an object with \"kind\""),
    ("sum / position^3", "sum / positio^3", "contains positio, which a form at \"motion\""),
    ("sum / position^3", "sum + position", "not a product of powers"),
    ("[-1, -0.05, 0.3]", "[-1, 30]", "\"start\" has the value 30, outside the range -10 ... 10"),
    ("[-1, -0.05, 0.3]", "[]", "\"start\" lists no value"),
    ("\"at\": \"motion\",", "\"at\": \"motion\", \"parameters\": [],", "a form needs at least one parameter"),
    ("[-10, 10]", "[-1e300, 10]", "its ends must be within -1000000 ... 1000000"),
    ("[-10, 10]", "[-10, 1e300]", "its ends must be within -1000000 ... 1000000"),
    ("sum / position^3", "sum / position^3e9", "it must be within 1e-12 ... 1e12"),
    (
        "\"title\": \"Cubic stiffness\"",
        "\"title\": \" \"",
        "\"title\" is empty: it needs the common name of the effect",
    ),
];

/// Asserts that the effect cubic-stiffness with a change gives an error with this message and the name of the file.
fn assert_change_is_reported(from: &str, to: &str, message: &str) {
    let effect = std::fs::read_to_string("patches/effects/cubic-stiffness.json").unwrap();
    assert!(effect.contains(from), "{from}");
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("changed.json"), effect.replacen(from, to, 1)).unwrap();
    let output = patchcord(&["effects", "changed", "--effects", folder.path().to_str().unwrap()]);
    assert_eq!(code(&output), 1);
    let output = errors(&output);
    assert!(output.contains(message) && output.contains("changed.json:"), "{output}");
}

#[test]
fn errors_in_an_effect_name_its_file() {
    for (from, to, message) in WRONG_CHANGES {
        assert_change_is_reported(from, to, message);
    }
    let many = format!("[{}]", vec!["1"; 51].join(", "));
    let message = "\"start\" lists 51 values; at most 50 are allowed";
    assert_change_is_reported("[-1, -0.05, 0.3]", &many, message);
}

#[test]
fn wiring_errors_have_their_place() {
    let effect = std::fs::read_to_string("patches/effects/viscous-friction.json").unwrap();
    for (from, to, expected) in [
        ("\"kind\": \"pot\"", "\"kind\": \"pott\"", "changed.json:22:24\n"),
        (
            "c * own / sum / G",
            "c * own / summ / G",
            "may contain its parameters, its gains, \"sum\" and the words",
        ),
        ("c * own / sum / G", "c * own / summ / G", "changed.json:22:55\n"),
        ("\"xG\"", "\"xH\"", "changed.json:23:47\n"),
    ] {
        let folder = tempfile::tempdir().unwrap();
        std::fs::write(folder.path().join("changed.json"), effect.replacen(from, to, 1)).unwrap();
        let output =
            errors(&patchcord(&["effects", "changed", "--effects", folder.path().to_str().unwrap()]));
        assert!(output.contains(expected) && !output.contains("probe_"), "{output}");
    }
}

#[test]
fn unusable_folders_of_effects_return_errors() {
    let output = |path: &str| {
        let output = patchcord(&["effects", "--effects", path]);
        assert_eq!(code(&output), 1);
        errors(&output)
    };
    let file = output("patches/effects/drift.json");
    assert!(file.contains("patches/effects/drift.json is a file: name the folder that it is in"), "{file}");
    let folder = tempfile::tempdir().unwrap();
    std::fs::copy("crates/ident/tests/base.json", folder.path().join("base.json")).unwrap();
    let experiment = "examples/05_missing_effect/slide.experiment.json";
    std::fs::copy(experiment, folder.path().join("slide.json")).unwrap();
    let both = output(folder.path().to_str().unwrap());
    for expected in
        ["this is a patch, where an effect is needed", "this is an experiment, where an effect is needed"]
    {
        assert!(both.contains(expected), "{both}");
    }
}

#[test]
fn an_unknown_alias_gives_a_note() {
    let folder = tempfile::tempdir().unwrap();
    let effect = std::fs::read_to_string("patches/effects/drift.json").unwrap();
    let effect = effect.replacen("\"aliases\": {", "\"aliases\": {\"no-such\": \"ever\", ", 1);
    std::fs::write(folder.path().join("creep.json"), effect).unwrap();
    let output = patchcord(&["effects", "--effects", folder.path().to_str().unwrap()]);
    assert_eq!(errors(&output), "note: creep has the alias no-such, which is not an effect\n");
    assert_eq!(code(&output), 0);
}

#[test]
fn an_effect_that_replaces_another_gives_a_note() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::copy("patches/effects/drift.json", folder.path().join("leak.json")).unwrap();
    let output = patchcord(&["effects", "--effects", folder.path().to_str().unwrap()]);
    assert!(
        errors(&output).contains("leak.json replaces the shipped effect of that name"),
        "{}",
        errors(&output)
    );
    assert_eq!(code(&output), 0);
}
