//! Numbers and outputs quoted in the README and in examples are correct.

use std::fs;
use std::path::Path;
use std::process::Command;

use serde_json::Value;

use super::transcripts::{folder_with_problems, printed, refreshed};
use super::{FIG_8_16, code, errors, out, patchcord, path, without_elapsed_time};
use crate::common::files::assert_up_to_date;

/// The lines of the indented block after this text in the README.
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
fn the_command_of_the_readme_prints_the_quoted_lines() {
    let folder = tempfile::tempdir().unwrap();
    let command = readme_block("This runs the final circuit of the thesis:\n")[0].clone();
    let arguments: Vec<_> = command.strip_prefix("cargo run -- ").unwrap().split(' ').collect();
    let patch = fs::canonicalize(arguments[1]).unwrap();
    let arguments =
        arguments.iter().map(|word| if *word == FIG_8_16 { patch.to_str().unwrap() } else { word });
    let mut process = Command::new(env!("CARGO_BIN_EXE_patchcord"));
    let process = process.env("PATCHCORD_PROGRESS", "0").args(arguments).current_dir(&folder);
    let ran = process.output().unwrap();
    assert_eq!((code(&ran), errors(&ran).as_str()), (0, ""));
    let quoted: Vec<String> =
        readme_block("and ends with\n").into_iter().filter(|line| !line.is_empty()).collect();
    let quoted: Vec<String> = quoted.iter().map(|line| without_elapsed_time(line)).collect();
    let printed: Vec<String> =
        out(&ran).lines().filter(|line| !line.is_empty()).map(without_elapsed_time).collect();
    assert_eq!(printed[printed.len() - quoted.len()..], quoted);
    assert!(folder.path().join("fig-8-16.csv").is_file() && folder.path().join("fig-8-16.svg").is_file());
}

/// The heading of the section with a problem and its patch.
const SCALING: &str = "## From an equation to a patch\n";

#[test]
fn the_section_about_scaling_has_the_outputs_of_its_commands() {
    let page = fs::read_to_string("README.md").unwrap();
    let (before, rest) = page.split_once(SCALING).unwrap();
    let (section, after) = rest.split_once("\n## ").unwrap();
    assert!(before.lines().count() < 80, "the section is on the first screens");
    let folder = folder_with_problems();
    let fresh = refreshed(section, folder.path());
    let equations = printed("equations mass.json", folder.path());
    let text = section.replace('\n', " ");
    for equation in equations.lines().filter(|line| line.contains("' = ")) {
        assert!(text.contains(&format!("`{equation}`")), "{equation} is not quoted");
    }
    assert_up_to_date("README.md", format!("{before}{SCALING}{fresh}\n## {after}").as_bytes(), "patchcord");
}

/// The time between the first two falls of the position through 0, with this mass in kg.
fn period(file: &str, mass: &str) -> f64 {
    let csv = format!("{file}.csv");
    let set = format!("m={mass}");
    assert_eq!(code(&patchcord(&["run", file, "--set", &set, "--set", "c=0", "--csv", &csv])), 0);
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
fn four_times_the_mass_has_twice_the_period() {
    let folder = tempfile::tempdir().unwrap();
    let file = path(&folder, "spring.json");
    assert_eq!(code(&patchcord(&["new", &file])), 0);
    let [light, heavy] = ["1", "4"].map(|mass| period(&file, mass));
    assert!((heavy / light - 2.0).abs() < 1e-3, "{light} {heavy}");
}

/// The mistake of the README: `A2` plugged into `P1` instead of `B1`.
#[test]
fn the_report_of_a_wrong_sign_is_the_quoted_one() {
    let folder = tempfile::tempdir().unwrap();
    let file = path(&folder, "spring.json");
    assert_eq!(code(&patchcord(&["new", &file])), 0);
    let text = fs::read_to_string(&file).unwrap();
    let (right, wrong) = (r#""P1": {"kind": "pot", "in": "B1""#, r#""P1": {"kind": "pot", "in": "A2""#);
    assert!(text.contains(right), "{text}");
    fs::write(&file, text.replace(right, wrong)).unwrap();
    let mut process = Command::new(env!("CARGO_BIN_EXE_patchcord"));
    let checked = process.args(["check", "spring.json"]).current_dir(&folder).output().unwrap();
    assert_eq!(code(&checked), 1);
    let quoted = readme_block("instead of `B1`, and check again.\n");
    let printed: Vec<String> = errors(&checked).lines().map(|line| line.trim().to_owned()).collect();
    assert_eq!(quoted[..quoted.len() - 1], printed[..quoted.len() - 1], "{}", errors(&checked));
}

/// The pictures at the top of the README are those of the patch that `patchcord new` writes.
#[test]
fn the_first_pictures_of_the_readme_are_up_to_date() {
    let folder = tempfile::tempdir().unwrap();
    let [file, plot, schematic] =
        ["spring.json", "spring.svg", "schematic.svg"].map(|name| path(&folder, name));
    assert_eq!(code(&patchcord(&["new", &file])), 0);
    assert_eq!(code(&patchcord(&["run", &file, "--plot", &plot])), 0);
    assert_eq!(code(&patchcord(&["draw", &file, "--plot", &schematic])), 0);
    assert_up_to_date("docs/pictures/spring.svg", &fs::read(plot).unwrap(), "patchcord");
    assert_up_to_date("docs/pictures/spring.schematic.svg", &fs::read(schematic).unwrap(), "patchcord");
}

#[test]
#[ignore = "takes several seconds: a whole search"]
fn the_search_of_the_readme_finds_the_quoted_damping() {
    let folder = tempfile::tempdir().unwrap();
    let into = path(&folder, "found");
    let block = readme_block("To name the effect, run\n");
    let words = block[0].split(' ').skip(1).map(|word| if word == "found" { &into } else { word });
    let ran = patchcord(&words.collect::<Vec<_>>());
    assert_eq!((code(&ran), errors(&ran).as_str()), (0, ""));
    let quoted = block.iter().rfind(|line| !line.is_empty()).unwrap();
    assert_eq!(out(&ran).lines().next(), Some(quoted.as_str()));
    let report = fs::read_to_string(Path::new(&into).join("report.json")).unwrap();
    let report: Value = serde_json::from_str(&report).unwrap();
    let c = &report["parameters"]["c"];
    let [low, high] = [0, 1].map(|end| c["interval"][end].as_f64().unwrap());
    let quoted =
        format!("a damping of {:.3} ± {:.3} per second", c["value"].as_f64().unwrap(), (high - low) / 2.0);
    assert!(fs::read_to_string("README.md").unwrap().replace('\n', " ").contains(&quoted), "{quoted}");
}

#[test]
fn the_shots_of_the_hybrid_run_have_the_quoted_errors() {
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
    let quoted = format!("the eighth {:.1} mm short", -1e3 * misses[7]);
    assert!(page.replace('\n', " ").contains(&quoted), "{quoted}");
}
