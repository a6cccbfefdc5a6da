//! Every problem with a known solution, with equal steps and with a tolerance; and the page that tells them.

mod common;
#[path = "problems/mod.rs"]
mod library;

use std::fs;
use std::process::Command;

use common::order;
use library::{PROBLEMS, Problem};
use patchcord::solve::{self, RunSettings};

const TOLERANCES: [f64; 4] = [1e-5, 1e-6, 1e-7, 1e-8];

#[test]
fn equal_steps_are_right() {
    for problem in &PROBLEMS {
        let (program, settings) = problem.program();
        let error = problem.error(&program, &settings);
        assert!(error < problem.within, "{}: {error:e}", problem.name);
    }
}

#[test]
fn the_error_goes_with_the_fourth_power_of_the_step() {
    for problem in PROBLEMS.iter().filter(|problem| problem.fourth_order) {
        let (program, settings) = problem.program();
        let steps = [8.0, 4.0, 2.0, 1.0].map(|times| times * problem.step);
        let errors = steps.map(|step| problem.error(&program, &RunSettings { step, ..settings.clone() }));
        let reached = order(&steps, &errors);
        assert!((3.9..=4.1).contains(&reached), "{}: order {reached} from {errors:?}", problem.name);
    }
}

#[test]
fn runs_are_right_to_the_tolerance() {
    for problem in &PROBLEMS {
        let (program, settings) = problem.program();
        for tolerance in TOLERANCES {
            let settings = RunSettings { tolerance: Some(tolerance), ..settings.clone() };
            let error = problem.error(&program, &settings);
            assert!(error < tolerance, "{}: {error:e} at {tolerance:e}", problem.name);
        }
    }
}

#[test]
fn the_page_tells_every_problem() {
    let page = fs::read_to_string("docs/problems.md").unwrap();
    let told: Vec<_> = page.lines().filter_map(|line| line.strip_prefix("## ")).collect();
    assert_eq!(told, PROBLEMS.map(|problem| problem.name));
    for (problem, section) in PROBLEMS.iter().zip(page.split("\n## ").skip(1)) {
        let named = [format!("`{}`", problem.patch), format!("signal `{}`", problem.signal)];
        for words in named {
            assert!(section.contains(&words), "{} does not say {words}", problem.name);
        }
    }
}

/// The largest error of the samples that a command of the page writes, in machine units.
fn error_of(problem: &Problem, command: &str) -> f64 {
    let folder = tempfile::tempdir().unwrap();
    let csv = folder.path().join("samples.csv");
    let mut patchcord = Command::new(env!("CARGO_BIN_EXE_patchcord"));
    let ran = patchcord.args(command.split_whitespace()).arg("--csv").arg(&csv).output().unwrap();
    assert!(ran.status.success(), "{command}: {}", String::from_utf8_lossy(&ran.stderr));
    let (program, settings) = problem.program();
    let per_volt = solve::run(&program, &settings).unwrap().tracks[0].per_volt;
    let text = fs::read_to_string(csv).unwrap();
    let mut lines = text.lines().skip_while(|line| line.starts_with('#'));
    let column = lines.next().unwrap().split(',').position(|name| name == problem.signal).unwrap();
    let off = |line: &str| {
        let sample: Vec<f64> = line.split(',').map(|number| number.parse().unwrap()).collect();
        (sample[column] / per_volt - (problem.exact)(sample[0])).abs() / 100.0
    };
    lines.map(off).fold(0.0, f64::max)
}

#[test]
fn the_commands_of_the_page_are_as_right_as_it_says() {
    let page = fs::read_to_string("docs/problems.md").unwrap();
    for (problem, section) in PROBLEMS.iter().zip(page.split("\n## ").skip(1)) {
        let commands = section.lines().filter_map(|line| line.strip_prefix("    patchcord "));
        let told = section.split("\nLess than ").nth(1).unwrap().split(" off.").next().unwrap();
        let bounds: Vec<f64> = told.split(" and ").map(|bound| bound.parse().unwrap()).collect();
        assert_eq!((commands.clone().count(), bounds.len()), (2, 2), "{}", problem.name);
        for (command, bound) in commands.zip(bounds) {
            let error = error_of(problem, command);
            assert!(error < bound, "{command}: {error:e}");
        }
    }
}
