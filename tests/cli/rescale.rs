//! `patchcord scale` of a patch.

use std::fs;

use serde_json::{Value, json as value};

use super::{code, errors, json, out, patchcord, path};

/// A file with the lesson on a driven oscillator in which one volt represents five times as much.
fn misscaled(folder: &tempfile::TempDir) -> String {
    let text = fs::read_to_string("patches/lessons/driven-oscillator.json").unwrap();
    let scales = [
        (r#""per_volt": 1,  "#, r#""per_volt": 5,  "#),
        (r#""per_volt": 10, "#, r#""per_volt": 50, "#),
        (r#""per_volt": 0.02,"#, r#""per_volt": 0.1,"#),
    ];
    let text = scales.iter().fold(text, |text, (old, new)| {
        assert_eq!(text.matches(old).count(), 1, "{old}");
        text.replace(old, new)
    });
    let file = path(folder, "old.json");
    fs::write(&file, text).unwrap();
    file
}

/// The elements of a patch.
fn elements(file: &str) -> Value {
    let document: Value = serde_json::from_str(&fs::read_to_string(file).unwrap()).unwrap();
    document["elements"].clone()
}

#[test]
fn a_patch_is_rescaled_and_keeps_its_names() {
    let folder = tempfile::tempdir().unwrap();
    let (old, new) = (misscaled(&folder), path(&folder, "new.json"));
    let ran = patchcord(&["scale", &old, "--out", &new]);
    assert_eq!((code(&ran), errors(&ran).as_str()), (0, ""), "{}", out(&ran));
    let text = out(&ran);
    assert!(text.contains("scale     unit  1 V was  1 V is\n"), "{text}");
    assert!(text.contains("4 of 4 outputs peak between 50 and 95 V\n"), "{text}");
    assert!(
        text.contains("both patches agree within 1e-9 at 24 random states, and their runs up to t = 8 s\n")
    );
    assert!(text.contains(&format!("\nThen:\n  patchcord check {new}\n")), "{text}");
    let checked = patchcord(&["check", &new]);
    assert_eq!((code(&checked), errors(&checked).as_str()), (0, ""));
    assert!(out(&checked).contains("nothing wrong\n"), "{}", out(&checked));
    assert_eq!(elements(&old), elements(&new));
}

#[test]
fn the_document_has_the_tables_and_the_patch() {
    let document =
        json(&patchcord(&["scale", "patches/lessons/mass-and-spring.json", "--time", "10", "--json"]));
    assert_eq!((&document["ok"], document["time_scale"].as_f64()), (&value!(true), Some(10.0)));
    assert_eq!(document["rescaled"]["elements"]["A2"]["in"], value!({"x1": ["A1"]}));
    assert_eq!(document["scales"][0]["name"], "position");
    assert_eq!(document["scales"][0]["before"], document["scales"][0]["after"]);
    let changes = document["changes"].as_array().unwrap();
    let gain = changes.iter().find(|change| change["setting"] == "gain of A1").unwrap();
    assert_eq!((&gain["before"], &gain["after"]), (&value!("x10"), &value!("x1")));
    assert_eq!(gain["rule"], "gain * pot = 10 / 10 = 1");
    assert_eq!(document["files"], value!([]));
}

#[test]
fn options_of_problems_are_refused_for_a_patch() {
    let lesson = "patches/lessons/mass-and-spring.json";
    let ran = patchcord(&["scale", lesson, "--machine", "unlimited", "--keep-maxima"]);
    assert_eq!(code(&ran), 2);
    assert_eq!(
        errors(&ran),
        "error: --machine and --keep-maxima: not for a patch, which has its own machine and scales\n"
    );
    assert_eq!(code(&patchcord(&["scale", lesson, "--time", "0"])), 2);
}

#[test]
fn a_patch_that_cannot_be_rescaled_writes_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let new = path(&folder, "new.json");
    let ran = patchcord(&["scale", "patches/thesis/fig-8-04.json", "--time", "0.1", "--out", &new]);
    assert_eq!(code(&ran), 1);
    assert_eq!(
        errors(&ran),
        "error: A3 (line 50) would need an input with a gain of 10000, which solartron-1451 does not have: state another \
         \"machine\", or change the scales less\n"
    );
    assert!(fs::metadata(&new).is_err());
    let old = misscaled(&folder);
    let same = patchcord(&["scale", &old, "--out", &old]);
    assert_eq!(code(&same), 2);
    assert!(errors(&same).contains("is the patch itself"), "{}", errors(&same));
}
