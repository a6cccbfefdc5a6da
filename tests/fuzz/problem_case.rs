//! Commands that scale problems.

use super::case::Case;
use super::changes::changed_document;
use super::command_lines::once_in;
use super::corpus::{Corpus, Files};
use super::document::Node;
use super::number_text::edge_number;
use super::random_problem::random_problem;
use crate::common::random::SplitMix64;

/// The name of the problem of a case.
const PROBLEM: &str = "case.problem.json";
/// The patch that is written.
pub(crate) const SCALED: &str = "scaled.json";
/// The largest number of steps of a run. Most shipped problems have more.
const MAX_STEPS: f64 = 300.0;

/// A command that scales a shipped problem with changes, or a random one.
pub(crate) fn problem_case(corpus: &Corpus, random: &mut SplitMix64) -> Case {
    let bytes = match random.below(10) {
        0..4 => random_problem(random).json().into_bytes(),
        4 | 5 => changed_document(corpus, random.pick(&corpus.bad_problems).node.clone(), random).1,
        6 => changed_document(corpus, random_problem(random), random).1,
        _ => {
            let mut node = random.pick(&corpus.problems).node.clone();
            shorten_run(&mut node);
            changed_document(corpus, node, random).1
        }
    };
    Case::of(Files::from([(PROBLEM.to_owned(), bytes)]), scale_command(random))
}

/// A command line for the problem.
fn scale_command(random: &mut SplitMix64) -> Vec<String> {
    let mut words = vec!["scale", PROBLEM];
    let options: [&[&str]; 5] = [
        &["--keep-maxima"],
        &["--steps"],
        &["--json"],
        &["--machine", "solartron-1451"],
        &["--machine", "none"],
    ];
    for option in options {
        if once_in(5, random) {
            words.extend_from_slice(option);
        }
    }
    if once_in(2, random) {
        words.extend(["--out", SCALED]);
    }
    let mut words: Vec<String> = words.into_iter().map(str::to_owned).collect();
    if once_in(5, random) {
        words.extend(["--time".to_owned(), edge_number(random)]);
    }
    words
}

/// Limits the number of steps of the run of a problem.
fn shorten_run(problem: &mut Node) {
    let Node::Object(entries) = problem else { return };
    let Some((_, Node::Object(run))) = entries.iter_mut().find(|(key, _)| key == "run") else { return };
    let step = run.iter().find(|(key, _)| key == "step").and_then(|(_, step)| step.as_number());
    let Some(step) = step else { return };
    for (key, value) in run {
        if key == "for" {
            *value = Node::number(value.as_number().unwrap_or(1.0).min(MAX_STEPS * step));
        }
    }
}
