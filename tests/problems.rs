//! The commands of docs/problems.md have at most the errors that the page states.

use std::fs;
use std::process::Command;

use crate::known_problems::{Problem, closed_form, runs};

/// The largest error of the samples that a command writes, in machine units.
fn error_of(problem: &Problem, command: &str) -> f64 {
    let folder = tempfile::tempdir().unwrap();
    let csv = folder.path().join("samples.csv");
    let mut patchcord = Command::new(env!("CARGO_BIN_EXE_patchcord"));
    let ran = patchcord.args(command.split_whitespace()).arg("--csv").arg(&csv).output().unwrap();
    assert!(ran.status.success(), "{command}: {}", String::from_utf8_lossy(&ran.stderr));
    let prepared = problem.prepare();
    let per_volt = runs::run_program(&prepared.program, &prepared.settings).tracks[0].per_volt;
    let text = fs::read_to_string(csv).unwrap();
    let mut lines = text.lines().skip_while(|line| line.starts_with('#'));
    let column = lines.next().unwrap().split(',').position(|name| name == problem.signal).unwrap();
    let error = |line: &str| {
        let sample: Vec<f64> = line.split(',').map(|number| number.parse().unwrap()).collect();
        (sample[column] - problem.closed_form()(sample[0])) / per_volt / 100.0
    };
    runs::peak(&lines.map(error).collect::<Vec<_>>())
}

#[test]
fn commands_have_at_most_the_stated_errors() {
    let page = fs::read_to_string("docs/problems.md").unwrap();
    for (problem, section) in closed_form::PROBLEMS.iter().zip(page.split("\n## ").skip(1)) {
        let commands = section.lines().filter_map(|line| line.strip_prefix("    patchcord "));
        let stated = section.split("\nLess than ").nth(1).unwrap().split(" off.").next().unwrap();
        let bounds: Vec<f64> = stated.split(" and ").map(|bound| bound.parse().unwrap()).collect();
        assert_eq!((commands.clone().count(), bounds.len()), (2, 2), "{}", problem.name);
        for (command, bound) in commands.zip(bounds) {
            let error = error_of(problem, command);
            assert!(error < bound, "{command}: {error:e}");
        }
    }
}
