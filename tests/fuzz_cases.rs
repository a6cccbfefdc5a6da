//! A fixed part of the random inputs of `tests/fuzz`, and tests of their generator and of the rules.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::panic::catch_unwind;
use std::path::Path;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Duration;

use serde_json::Value;

use crate::common::files::shipped_files;
use crate::fuzz::case::Case;
use crate::fuzz::command_lines::{PATCH, SWEEP, TABLE};
use crate::fuzz::corpus::{Corpus, Files};
use crate::fuzz::document::Node;
use crate::fuzz::judgement::{answer_violations, content_violation, violations};
use crate::fuzz::large_patch::{SHAPES, Shape, case_of, large_patch};
use crate::fuzz::other_commands::COMMAND_NAMES;
use crate::fuzz::runner::{Answer, TimeLimit};
use crate::fuzz::special_files::{Special, Specials};
use crate::fuzz::streams::{StandardInput, StandardOutput};
use crate::fuzz::trials::{Summary, run_cases};
use patchcord::{Circuit, Patch, Program};

/// The seed of the fixed part.
const SEED: u64 = 1451;
/// The number of commands of the fixed part.
const COMMANDS: u64 = 650;
/// The least share of accepted cases of each command, in percent. Refused inputs test nothing after the checks.
/// `profile` is left out, since it has few cases.
const ACCEPTED_SHARES: [(&str, usize); 9] = [
    ("check", 15),
    ("draw", 15),
    ("effects", 10),
    ("equations", 15),
    ("gap", 5),
    ("linearise", 10),
    ("run", 10),
    ("scale", 15),
    ("sweep", 2),
];
/// The number of cases whose documents are read within the test.
const READ_CASES: u64 = 1000;
/// The number of commands with a special input or output.
const SPECIAL_COMMANDS: u64 = 60;
/// The number of parts of the large patches.
const LARGE_COUNT: usize = 2000;
/// The commands on large patches.
const LARGE_COMMANDS: [(Shape, &[&str]); 13] = [
    (Shape::Chain, &["check", PATCH, "--voltages", "--scaling"]),
    (Shape::Loops, &["check", PATCH, "--json"]),
    (Shape::Parameters, &["check", PATCH, "--json"]),
    (Shape::Backlashes, &["run", PATCH]),
    (Shape::Relays, &["run", PATCH, "--csv", TABLE]),
    (Shape::Delays, &["run", PATCH]),
    (Shape::Signals, &["run", PATCH, "--json"]),
    (Shape::Chain, &["linearise", PATCH]),
    (Shape::Chain, &["equations", PATCH]),
    (Shape::Delays, &["equations", PATCH, "--json"]),
    (Shape::Parameters, &["equations", PATCH, "--latex"]),
    (Shape::Chain, &["check", PATCH, "--test", "random"]),
    (Shape::Instances, &["draw", PATCH, "--plot", "d.svg"]),
];

/// Runs the first cases of a series, which break no rule.
fn run_first(series: &str, count: u64, make: &(dyn Fn(u64) -> Case + Sync)) -> Summary {
    let numbers = AtomicU64::new(0);
    let next = || Some(numbers.fetch_add(1, Ordering::Relaxed)).filter(|number| *number < count);
    let kept = Path::new(env!("CARGO_TARGET_TMPDIR")).join("fuzz");
    let summary = run_cases(series, make, &kept, &next);
    assert!(summary.violations.is_empty(), "{}", summary.violations.join("\n"));
    assert_eq!(summary.cases as u64, count);
    summary
}

#[test]
fn random_inputs_break_no_rule() {
    let corpus = Corpus::load(false);
    let summary = run_first(&SEED.to_string(), COMMANDS, &|number| Case::new(&corpus, SEED, number));
    // Some arguments are longer than the system permits.
    assert!(summary.skipped < 5, "{}", summary.skipped);
    for (command, share) in ACCEPTED_SHARES {
        let [accepted, all] = summary.commands[command];
        assert!(100 * accepted > share * all, "{command}: {accepted} of {all} are accepted");
    }
}

/// Pipes, devices, folders, files of the system, protected and missing files.
#[cfg(target_os = "linux")]
#[test]
fn special_inputs_and_outputs_break_no_rule() {
    use crate::common::random::SplitMix64;
    use crate::fuzz::special_case::special_case;
    let corpus = Corpus::load(false);
    let make = |number| special_case(&corpus, &mut SplitMix64(number));
    let summary = run_first("special", SPECIAL_COMMANDS, &make);
    assert_eq!(summary.skipped, 0);
}

#[test]
fn large_patches_break_no_rule() {
    let make = |number: u64| {
        let (shape, words) = LARGE_COMMANDS[number as usize];
        case_of(shape, LARGE_COUNT, words.iter().map(|word| (*word).to_owned()).collect())
    };
    let summary = run_first("large", LARGE_COMMANDS.len() as u64, &make);
    assert_eq!(summary.skipped, 0);
    // A schematic has at most 1000 symbols, and a linear model at most 500 states.
    let expected =
        [("check", [4, 4]), ("draw", [0, 1]), ("equations", [3, 3]), ("linearise", [0, 1]), ("run", [4, 4])];
    let expected = expected.map(|(command, counts)| (command.to_owned(), counts));
    assert_eq!(summary.commands, BTreeMap::from(expected));
}

#[test]
fn large_patches_are_valid() {
    for shape in SHAPES {
        let text = large_patch(shape, 13).json();
        let patch = Patch::parse_in(Path::new("."), PATCH, &text);
        let patch = patch.unwrap_or_else(|report| panic!("{shape:?}: {report}"));
        let circuit = Circuit::new(&patch).unwrap_or_else(|report| panic!("{shape:?}: {report}"));
        assert!(Program::new(&circuit).is_ok(), "{shape:?}");
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
    let missing: Vec<&&str> = COMMAND_NAMES.iter().filter(|name| !commands.contains(**name)).collect();
    assert!(missing.is_empty(), "{missing:?}");
    let count = |is_counted: &dyn Fn(&Case) -> bool| cases.iter().filter(|case| is_counted(case)).count();
    assert!(count(&|case| case.damage_seed.is_some()) > 15);
    assert!(count(&|case| !case.specials.is_empty()) > 2);
    assert!(count(&|case| case.input != StandardInput::Empty) > 20);
    assert!(count(&|case| case.output != StandardOutput::Kept) > 5);
    let size = |case: &Case| case.files.get(PATCH).map_or(0, Vec::len);
    assert!(count(&|case| size(case) > 50_000) > 2);
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

/// A command without files.
fn command(words: &[&str]) -> Case {
    Case::of(Files::new(), words.iter().map(|word| (*word).to_owned()).collect())
}

#[test]
fn each_limit_of_time_has_a_text_of_its_own() {
    let folder = tempfile::tempdir().unwrap();
    let case = command(&["check"]);
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
    let case = command(&["sweep", "case.json", "--out", SWEEP]);
    let count = |code| violations(&case, folder.path(), &answer(Some(code), "", "x")).len();
    assert_eq!([count(0), count(1)], [1, 0]);
    fs::write(folder.path().join(SWEEP), "p\n1\n").unwrap();
    assert_eq!(count(0), 0);
}

#[test]
fn wrong_answers_are_recognised() {
    let case = command(&["check", "--json"]);
    let count = |answer: &Answer| answer_violations(&case, answer).len();
    assert_eq!(count(&answer(Some(0), "{\"ok\": true}", "")), 0);
    assert_eq!(count(&answer(Some(1), "{\"ok\": false}", "error: no")), 0);
    let text = |text: &str| answer_violations(&command(&["check", "inf"]), &answer(Some(0), text, "")).len();
    assert_eq!([text("text"), text("-inf V"), text("NaN V"), text("NaN1")], [0, 0, 1, 0]);
    // "information" contains "inf", but not as a word.
    assert_eq!(
        answer_violations(&command(&["check", "information"]), &answer(Some(0), "-inf V", "")).len(),
        1
    );
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

#[test]
fn a_table_on_standard_output_is_examined() {
    let count = |case: &Case, code, output: &str| {
        answer_violations(case, &answer(Some(code), output, "message")).len()
    };
    for words in [&["run", "-", "--csv", "-"][..], &["sweep", PATCH], &["sweep", PATCH, "--out", "-"]] {
        let case = command(words);
        assert_eq!([count(&case, 0, "t,x\n0,1\n"), count(&case, 1, "")], [0, 0], "{words:?}");
        let wrong = [(0, ""), (0, "t,x\n0,NaN\n"), (0, "t,x\n0,1"), (1, "t,x\n0")];
        for (code, output) in wrong {
            assert_eq!(count(&case, code, output), 1, "{words:?} {output:?}");
        }
    }
    assert_eq!(count(&command(&["sweep", PATCH, "--out", SWEEP]), 0, "3 runs"), 0);
}

/// A device without space and a closed pipe are outputs, a file and a pipe are inputs.
#[cfg(target_os = "linux")]
#[test]
fn a_command_gets_its_streams() {
    use crate::fuzz::runner::run;
    let folder = tempfile::tempdir().unwrap();
    let case = case_of(Shape::Chain, 8, ["check", "-"].map(str::to_owned).to_vec());
    case.write(folder.path()).unwrap();
    let code = |input, output| run(folder.path(), &Case { input, output, ..case.clone() }).unwrap().code;
    let [file, pipe] = [StandardInput::File, StandardInput::Pipe].map(|of| of(PATCH.to_owned()));
    assert_eq!(code(StandardInput::Empty, StandardOutput::Kept), Some(1));
    assert_eq!(code(file.clone(), StandardOutput::Kept), Some(0));
    assert_eq!(code(pipe, StandardOutput::Kept), Some(0));
    assert_eq!(code(file.clone(), StandardOutput::Full), Some(1));
    assert_eq!(code(file, StandardOutput::Closed), Some(0));
}

#[cfg(unix)]
#[test]
fn special_files_that_are_replaced_are_recognised() {
    let folder = tempfile::tempdir().unwrap();
    let specials = [
        ("pipe", Special::Pipe),
        ("inside/folder", Special::Folder),
        ("link", Special::Link("/dev/zero".to_owned())),
        ("file", Special::Protected),
    ];
    let specials: Specials = specials.into_iter().map(|(name, special)| (name.to_owned(), special)).collect();
    let files = Files::from([("file".to_owned(), b"x".to_vec())]);
    let case = Case { files, specials, ..command(&["check"]) };
    case.write(folder.path()).unwrap();
    let count = || violations(&case, folder.path(), &answer(Some(0), "", "")).len();
    assert_eq!(count(), 0);
    for (number, name) in ["pipe", "link"].into_iter().enumerate() {
        let path = folder.path().join(name);
        fs::remove_file(&path).unwrap();
        fs::write(&path, "x").unwrap();
        assert_eq!(count(), number + 1, "{name}");
    }
    fs::remove_dir(folder.path().join("inside/folder")).unwrap();
    assert_eq!(count(), 3);
}
