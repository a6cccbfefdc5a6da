//! The first patch that `patchcord new` writes.

use std::fs;

use assert_cmd::Command;

use super::{code, errors, json, out, patchcord, path};

/// Runs the command with the folder as working directory.
fn patchcord_in(folder: &tempfile::TempDir, arguments: &[&str]) -> std::process::Output {
    Command::cargo_bin("patchcord").unwrap().args(arguments).current_dir(folder).output().unwrap()
}

#[test]
fn the_first_patch_checks_runs_and_draws() {
    let folder = tempfile::tempdir().unwrap();
    let made = patchcord_in(&folder, &["new", "my-spring.json"]);
    assert_eq!((code(&made), errors(&made).as_str()), (0, ""));
    for (number, line) in out(&made).lines().filter(|line| line.starts_with("  patchcord ")).enumerate() {
        let words: Vec<_> = line.split_whitespace().skip(1).collect();
        assert_eq!(words[0], ["check", "draw", "run"][number]);
        let ran = patchcord_in(&folder, &words);
        assert_eq!((code(&ran), errors(&ran).as_str()), (0, ""), "{line}");
        let expected =
            ["nothing wrong\nMy spring\n", "wrote my-spring.schematic.svg\n", "no overload"][number];
        assert!(out(&ran).contains(expected), "{}", out(&ran));
    }
    let picture = fs::read_to_string(folder.path().join("my-spring.svg")).unwrap();
    assert!(picture.contains("Position and velocity") && picture.contains("polyline"));
    assert_eq!(fs::read_dir(&folder).unwrap().count(), 3);
}

#[test]
fn the_first_patch_agrees_with_a_damped_mass() {
    let folder = tempfile::tempdir().unwrap();
    let file = path(&folder, "spring.json");
    assert_eq!(json(&patchcord(&["new", &file, "--json"]))["files"][0], file.as_str());
    let least = |changes: &[&str]| {
        let ran = json(&patchcord(&[&["run", &file, "--json"], changes].concat()));
        ["value", "t"].map(|key| ran["readings"][0]["least"][key].as_f64().unwrap())
    };
    // Half a period after release: x0 exp(-zeta w t) with zeta = c / (2 sqrt(k m)), read at steps of 1 ms.
    let damped = 4.0 * (1.0 - 0.01f64).sqrt();
    let half = std::f64::consts::PI / damped;
    let [value, time] = least(&[]);
    assert!((value + 50.0 * (-0.1 * 4.0 * half).exp()).abs() < 1e-3, "{value}");
    assert!((time - half).abs() <= 1e-3, "{time}");
    // As the notes say: twice the period at four times the mass, and no oscillation at c = 8.
    assert!(
        (least(&["--set", "m=4", "--set", "c=0"])[1] % std::f64::consts::PI - std::f64::consts::FRAC_PI_2)
            .abs()
            < 1e-3
    );
    assert!(least(&["--set", "c=8"])[0] > -1e-9);
}

#[test]
fn an_existing_file_is_not_overwritten() {
    let folder = tempfile::tempdir().unwrap();
    let file = path(&folder, "kept.json");
    fs::write(&file, "mine").unwrap();
    let failed = patchcord(&["new", &file]);
    assert_eq!((code(&failed), out(&failed).as_str()), (2, ""));
    assert!(errors(&failed).ends_with("already exists: choose another name, or remove it first\n"));
    assert_eq!(fs::read_to_string(&file).unwrap(), "mine");
    let nowhere = patchcord(&["new", &path(&folder, "no/such.json")]);
    assert_eq!(code(&nowhere), 1);
    assert!(errors(&nowhere).starts_with("error: cannot write"), "{}", errors(&nowhere));
    let unnamed = patchcord(&["new", &path(&folder, "spring")]);
    assert!(errors(&unnamed).trim_end().ends_with("spring.json"), "{}", errors(&unnamed));
    assert_eq!(fs::read_dir(&folder).unwrap().count(), 1);
}

#[test]
fn every_file_name_gives_a_valid_title() {
    let folder = tempfile::tempdir().unwrap();
    let file = path(&folder, "say \"hello\" \\ öl.json");
    assert_eq!(code(&patchcord(&["new", &file])), 0);
    assert_eq!(json(&patchcord(&["check", &file, "--json"]))["title"], "Say \"hello\" \\ öl");
}
