//! A fixed part of the random inputs of `tests/fuzz`, and tests of their generator and of the rules.

use std::collections::BTreeSet;
use std::fs;
use std::panic::catch_unwind;
use std::path::Path;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Duration;

use serde_json::Value;

use crate::common::files::shipped_files;
use crate::fuzz::case::Case;
use crate::fuzz::command_lines::SWEEP;
use crate::fuzz::corpus::{Corpus, Files};
use crate::fuzz::document::Node;
use crate::fuzz::judgement::{answer_violations, content_violation, violations};
use crate::fuzz::runner::{Answer, TimeLimit};
use crate::fuzz::trials::run_cases;
use patchcord::{Circuit, Patch};

/// The seed of the fixed part.
const SEED: u64 = 1451;
/// The number of commands of the fixed part.
const COMMANDS: u64 = 600;
/// The least share of accepted cases of each command, in percent. Refused inputs test nothing after the checks.
/// `profile` is left out, since it has few cases.
const ACCEPTED_SHARES: [(&str, usize); 7] =
    [("check", 15), ("draw", 15), ("effects", 10), ("gap", 5), ("linearise", 10), ("run", 10), ("sweep", 2)];
/// The number of cases whose documents are read within the test.
const READ_CASES: u64 = 1000;

#[test]
fn random_inputs_break_no_rule() {
    let corpus = Corpus::load(false);
    let count = AtomicU64::new(0);
    let next = || Some(count.fetch_add(1, Ordering::Relaxed)).filter(|number| *number < COMMANDS);
    let kept = Path::new(env!("CARGO_TARGET_TMPDIR")).join("fuzz");
    let summary = run_cases(&corpus, SEED, &kept, &next);
    assert!(summary.violations.is_empty(), "{}", summary.violations.join("\n"));
    assert_eq!(summary.cases as u64, COMMANDS);
    // Some arguments are longer than the system permits.
    assert!(summary.skipped < 5, "{}", summary.skipped);
    for (command, share) in ACCEPTED_SHARES {
        let [accepted, all] = summary.commands[command];
        assert!(100 * accepted > share * all, "{command}: {accepted} of {all} are accepted");
    }
}

/// Reads a document as a patch and checks its circuit.
fn check(text: &str) {
    if let Ok(patch) = Patch::parse_in(Path::new("."), "case.json", text) {
        let _ = Circuit::new(&patch);
    }
}

#[test]
fn random_documents_are_read_or_refused() {
    let corpus = Corpus::load(false);
    for number in 0..READ_CASES {
        for (name, bytes) in Case::new(&corpus, SEED + 1, number).files {
            let Ok(text) = std::str::from_utf8(&bytes) else { continue };
            let is_read = !name.ends_with(".json") || catch_unwind(|| check(text)).is_ok();
            assert!(is_read, "case {number}: {name} causes a panic\n{text}");
        }
    }
}

#[test]
fn a_seed_gives_the_same_bytes_each_time() {
    let corpus = Corpus::load(true);
    let cases = |seed: u64| -> Vec<Case> { (0..50).map(|number| Case::new(&corpus, seed, number)).collect() };
    assert!(cases(7) == cases(7));
    assert!(cases(7) != cases(8));
}

#[test]
fn cases_cover_all_commands_and_kinds_of_damage() {
    let corpus = Corpus::load(true);
    let cases: Vec<Case> = (0..1000).map(|number| Case::new(&corpus, 7, number)).collect();
    let commands: BTreeSet<&str> = cases.iter().map(|case| case.arguments[0].as_str()).collect();
    let expected = ["check", "draw", "effects", "gap", "linearise", "profile", "run", "slideway", "sweep"];
    assert_eq!(commands.into_iter().collect::<Vec<_>>(), expected);
    let count = |is_counted: &dyn Fn(&Case) -> bool| cases.iter().filter(|case| is_counted(case)).count();
    assert!(count(&|case| case.damage_seed.is_some()) > 20);
    assert!(count(&|case| case.files.values().any(|bytes| std::str::from_utf8(bytes).is_err())) > 2);
}

#[test]
fn documents_are_written_as_they_were_read() {
    for file in shipped_files() {
        let value: Value = serde_json::from_str(&fs::read_to_string(file).unwrap()).unwrap();
        let mut node = Node::of(&value);
        assert_eq!(serde_json::from_str::<Value>(&node.json()).unwrap(), value);
        let last = node.size() - 1;
        assert!(node.value_mut(last).is_some() && node.value_mut(last + 1).is_none());
    }
}

#[test]
fn incomplete_files_and_infinite_numbers_are_recognised() {
    let svg = |x: &str| format!("<svg xmlns=\"http://www.w3.org/2000/svg\"><text x=\"{x}\">inf</text></svg>");
    let (good_svg, bad_svg) = (svg("1.5"), svg("translate(NaN, 3)"));
    let good: [(&str, &[u8]); 5] = [
        ("a.csv", b"# x: inf\nt,x\n0,1e308\n"),
        ("a.csv", b"t,note\n0,\"infinite inf.\"\n"),
        ("a.svg", good_svg.as_bytes()),
        ("a.json", b"{\"x\": 1}"),
        ("folder/a.png", b"\x89PNG...IEND\xaeB`\x82"),
    ];
    let bad: [(&str, &[u8]); 8] = [
        ("a.csv", b"t,x\n0,1"),
        ("a.csv", b"t,x\n0,NaN\n"),
        ("a.csv", b"t,x\n-inf,0\n"),
        ("a.csv", b""),
        ("a.svg", bad_svg.as_bytes()),
        ("a.svg", &good_svg.as_bytes()[..60]),
        ("a.json", b"{\"x\": NaN}"),
        ("a.png", b"\x89PNG"),
    ];
    for (name, bytes) in good {
        assert_eq!(content_violation(name, bytes), None, "{}", String::from_utf8_lossy(bytes));
    }
    for (name, bytes) in bad {
        assert!(content_violation(name, bytes).is_some(), "{}", String::from_utf8_lossy(bytes));
    }
}

/// An answer that no limit of time has ended.
fn answer(code: Option<i32>, output: &str, errors: &str) -> Answer {
    let (output, errors) = (output.into(), errors.into());
    Answer { code, broken_limit: None, output, errors, time: Duration::ZERO }
}

#[test]
fn each_limit_of_time_has_a_text_of_its_own() {
    let folder = tempfile::tempdir().unwrap();
    let case = Case { files: Files::new(), arguments: vec!["check".to_owned()], damage_seed: None };
    let found = |broken_limit| {
        violations(&case, folder.path(), &Answer { broken_limit, ..answer(None, "", "x") }).join(", ")
    };
    assert_eq!(found(Some(TimeLimit::Processor)), "needs more than 20 s of processor time");
    assert_eq!(found(Some(TimeLimit::Waiting)), "waits longer than 120 s");
    assert_eq!(found(None), "is ended by a signal");
}

#[test]
fn a_sweep_without_its_table_is_recognised() {
    let folder = tempfile::tempdir().unwrap();
    let arguments = ["sweep", "case.json", "--out", SWEEP].map(str::to_owned).to_vec();
    let case = Case { files: Files::new(), arguments, damage_seed: None };
    let count = |code| violations(&case, folder.path(), &answer(Some(code), "", "x")).len();
    assert_eq!([count(0), count(1)], [1, 0]);
    fs::write(folder.path().join(SWEEP), "p\n1\n").unwrap();
    assert_eq!(count(0), 0);
}

#[test]
fn wrong_answers_are_recognised() {
    let arguments = ["check", "--json"].map(str::to_owned);
    let count = |answer: &Answer| answer_violations(&arguments, answer).len();
    assert_eq!(count(&answer(Some(0), "{\"ok\": true}", "")), 0);
    assert_eq!(count(&answer(Some(1), "{\"ok\": false}", "error: no")), 0);
    assert_eq!(answer_violations(&arguments[..1], &answer(Some(0), "text", "")), Vec::<String>::new());
    let wrong = [
        answer(Some(0), "{\"ok\": tr", ""),
        answer(Some(0), "{} {}", ""),
        answer(Some(2), "{}", " \n"),
        answer(None, "{}", "error"),
        answer(Some(9), "{}", "error"),
        answer(Some(101), "{}", "thread main panicked at src/main.rs:1:1"),
        answer(Some(1), "{}", "memory allocation of 9 bytes failed"),
    ];
    for answer in &wrong {
        assert_eq!(count(answer), 1, "{:?} {}", answer.code, String::from_utf8_lossy(&answer.errors));
    }
}
