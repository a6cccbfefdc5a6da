//! Every problem with a known solution, with equal steps and with a tolerance; and the page that tells them.

mod common;
#[path = "problems/mod.rs"]
mod library;

use std::fs;

use common::order;
use library::PROBLEMS;
use patchcord::solve::RunSettings;

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
