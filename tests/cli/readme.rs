//! The README and the examples' prose say what the programs do.

use std::fs;
use std::path::Path;
use std::process::Command;

use serde_json::Value;

use super::{FIG_8_16, code, errors, json, out, patchcord, path};

/// The lines of the README's block after these words.
fn readme_block(after: &str) -> Vec<String> {
    let text = fs::read_to_string("README.md").unwrap();
    let block = text.split(after).nth(1).unwrap().trim_start_matches('\n');
    block
        .lines()
        .take_while(|line| line.is_empty() || line.starts_with("    "))
        .map(|line| line.trim().to_owned())
        .collect()
}

#[test]
fn the_readmes_command_ends_as_the_readme_says() {
    let folder = tempfile::tempdir().unwrap();
    let command = readme_block("With a Rust toolchain and nothing else:\n")[0].clone();
    let arguments: Vec<_> = command.strip_prefix("cargo run --release -- ").unwrap().split(' ').collect();
    let patch = fs::canonicalize(arguments[1]).unwrap();
    let arguments =
        arguments.iter().map(|word| if *word == FIG_8_16 { patch.to_str().unwrap() } else { word });
    let ran =
        Command::new(env!("CARGO_BIN_EXE_patchcord")).args(arguments).current_dir(&folder).output().unwrap();
    assert_eq!((code(&ran), errors(&ran).as_str()), (0, ""));
    let promised: Vec<String> =
        readme_block("It ends with\n").into_iter().filter(|line| !line.is_empty()).collect();
    let printed: Vec<String> = out(&ran).lines().map(str::to_owned).filter(|line| !line.is_empty()).collect();
    assert_eq!(printed[printed.len() - promised.len()..], promised);
    assert!(folder.path().join("fig-8-16.csv").is_file() && folder.path().join("fig-8-16.svg").is_file());
}

/// What the README has its reader save: the document at a place among those that it shows.
fn readme_document(place: usize) -> String {
    let text = fs::read_to_string("README.md").unwrap();
    text.split("```json\n").nth(1 + place).unwrap().split("```").next().unwrap().to_owned()
}

/// The period of the README's spring with a mass in kg: between its falls through 0 mm.
fn period(file: &str, mass: &str) -> f64 {
    let csv = format!("{file}.csv");
    let set = format!("m={mass}");
    assert_eq!(code(&patchcord(&["run", file, "--set", &set, "--csv", &csv])), 0);
    let table = fs::read_to_string(csv).unwrap();
    let rows = table.lines().skip_while(|line| !line.starts_with("t,")).skip(1);
    let points: Vec<Vec<f64>> =
        rows.map(|row| row.split(',').map(|number| number.parse().unwrap()).collect()).collect();
    let falls = points.windows(2).filter(|pair| pair[0][1] > 0.0 && pair[1][1] <= 0.0);
    let times: Vec<f64> = falls
        .map(|pair| pair[0][0] + (pair[1][0] - pair[0][0]) * pair[0][1] / (pair[0][1] - pair[1][1]))
        .collect();
    times[1] - times[0]
}

#[test]
fn the_readmes_first_patch_swings_as_the_readme_says() {
    let folder = tempfile::tempdir().unwrap();
    let file = path(&folder, "spring.json");
    fs::write(&file, readme_document(0)).unwrap();
    let told = json(&patchcord(&["run", &file, "--json"]));
    let [least, most] = ["least", "most"].map(|end| told["readings"][0][end]["value"].as_f64().unwrap());
    let [light, heavy] = ["1", "4"].map(|mass| period(&file, mass));
    let promised = format!(
        "The mass swings between {least:.0} and {most:.0} mm, with a period of {light:.2} s at 1 kg and {heavy:.2} s at 4 kg."
    );
    assert!(fs::read_to_string("README.md").unwrap().contains(&promised), "{promised}");
}

#[test]
#[ignore = "takes several seconds: a whole search"]
fn the_readmes_spring_lacks_the_damping_that_the_readme_says() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("spring.json"), readme_document(0)).unwrap();
    fs::write(folder.path().join("spring.experiment.json"), readme_document(1)).unwrap();
    let measured = readme_block("of which `spring.json` above knows nothing.\n");
    let searched = readme_block("spring.experiment.json --check\n");
    let commands = measured.into_iter().chain(searched).filter(|line| line.starts_with("patchcord "));
    let mut printed = String::new();
    for command in commands {
        let words = command.split_whitespace().skip(1);
        let ran = Command::new(env!("CARGO_BIN_EXE_patchcord")).args(words).current_dir(&folder).output();
        let ran = ran.unwrap();
        assert_eq!((code(&ran), errors(&ran).as_str()), (0, ""), "{command}");
        printed = out(&ran);
    }
    let promised = readme_block("tries every effect of 22 that finds a place, and says\n");
    assert_eq!(printed.lines().next(), promised.iter().map(String::as_str).find(|line| !line.is_empty()));
    let report = fs::read_to_string(folder.path().join("found/report.json")).unwrap();
    let report: Value = serde_json::from_str(&report).unwrap();
    let [k, c] = ["k", "c"].map(|name| report["parameters"][name]["value"].as_f64().unwrap());
    let promised = format!("with k = {k:.0} N/m and damping of {c:.1} per second");
    assert!(fs::read_to_string("README.md").unwrap().contains(&promised), "{promised}");
}

#[test]
fn the_shots_of_the_hybrid_run_land_as_its_page_says() {
    let folder = tempfile::tempdir().unwrap();
    let test = std::env::current_exe().unwrap();
    let built = test.parent().and_then(Path::parent).unwrap().join("examples/04_hybrid_run");
    let ran =
        Command::new(built).env("TMPDIR", folder.path()).output().expect("cargo test builds the examples");
    let shots = out(&ran);
    let landed = shots.lines().filter_map(|line| line.split_once(" m: ")?.0.split(' ').next_back());
    let misses: Vec<f64> = landed.map(|metres| metres.parse::<f64>().unwrap() - 60.0).collect();
    let nearer = misses.windows(2).map(|pair| pair[0] / pair[1]);
    assert!(nearer.clone().all(|times| (4.5..5.0).contains(&times)), "{misses:?}");
    let page = fs::read_to_string("examples/04_hybrid_run/README.md").unwrap();
    let promised = format!("the eighth {:.1} mm short", -1e3 * misses[7]);
    assert!(page.replace('\n', " ").contains(&promised), "{promised}");
}
