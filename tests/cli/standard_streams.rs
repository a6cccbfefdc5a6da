//! The argument `-`: a patch from standard input, a table on standard output.

use std::fs;
use std::path::Path;
use std::process::Output;

use assert_cmd::Command;

use super::run::{FEEDBACK_WITH_MEMORY, HALVED_GAINS};
use super::sweep::driven;
use super::{FIG_8_16, SPRING, code, errors, json, out, patchcord, path, spring};

/// Runs the command with a text on standard input.
fn patchcord_reading(text: &str, arguments: &[&str]) -> Output {
    let mut command = Command::cargo_bin("patchcord").unwrap();
    command.args(arguments).write_stdin(text.to_owned()).output().unwrap()
}

/// Asserts that a command line is refused with this message, and that nothing is printed on standard output.
fn check_refused(arguments: &[&str], message: &str) {
    let ran = patchcord(arguments);
    assert_eq!((code(&ran), out(&ran).as_str()), (2, ""), "{arguments:?}: {}", errors(&ran));
    assert!(errors(&ran).contains(message), "{arguments:?}: {}", errors(&ran));
}

#[test]
fn a_table_on_standard_output_has_the_bytes_of_the_file() {
    let (folder, file) = spring();
    let csv = path(&folder, "table.csv");
    let commands: [&[&str]; 2] = [
        &["run", &file, "--for", "0.01"],
        &["linearise", "patches/thesis/fig-8-04.json", "--from", "v_i", "--to", "v_o", "--hz", "10:100"],
    ];
    for command in commands {
        assert_eq!(code(&patchcord(&[command, &["--csv", &csv]].concat())), 0, "{command:?}");
        let shown = patchcord(&[command, &["--csv", "-"]].concat());
        assert_eq!((code(&shown), errors(&shown).as_str()), (0, ""), "{command:?}");
        assert_eq!(out(&shown), fs::read_to_string(&csv).unwrap(), "{command:?}");
    }
    let sweep = ["sweep", FIG_8_16, "--for", "0.01", "--vary", "Tc=0.01,0.02", "--measure", "peak:v_o"];
    assert_eq!(out(&patchcord(&[&sweep[..], &["--out", "-"]].concat())), out(&patchcord(&sweep)));
    assert!(!Path::new("-").exists());
}

/// Standard error has the overloads, and standard output the table only.
#[test]
fn a_table_on_standard_output_has_its_overloads_on_standard_error() {
    let ran = patchcord(&["run", FIG_8_16, "--set", "x_step=0.127e-3", "--for", "0.1", "--csv", "-"]);
    assert_eq!(code(&ran), 0);
    assert!(errors(&ran).contains("overload: ") && errors(&ran).contains("(first)\n"), "{}", errors(&ran));
    let table = out(&ran);
    let is_row = |line: &str| line.starts_with(|sign: char| "#t".contains(sign) || sign.is_ascii_digit());
    assert!(table.lines().all(is_row) && table.contains("\nt,v_i,"), "{table}");
}

/// A command cannot read the patch from standard input a second time.
#[test]
fn the_advice_about_overloads_of_standard_input_names_no_command() {
    let shown = out(&patchcord_reading(FEEDBACK_WITH_MEMORY, &["run", "-"]));
    let advice = format!(
        "  = help: {HALVED_GAINS}; the voltage that A needs is not known, so repeat the run and the "
    );
    assert!(shown.contains(&advice), "{shown}");
    assert!(!shown.contains("--scaling"), "{shown}");
}

#[test]
fn a_table_and_a_document_on_standard_output_are_refused() {
    let response = ["linearise", FIG_8_16, "--from", "v_i", "--to", "v_o", "--csv", "-", "--json"];
    let commands: [&[&str]; 2] = [&["run", FIG_8_16, "--csv", "-", "--json"], &response];
    for command in commands {
        let ran = patchcord(command);
        let message = "with --json the table cannot go to standard output: give --csv FILE";
        assert_eq!((code(&ran), errors(&ran)), (2, format!("error: {message}\n")), "{command:?}");
        assert_eq!(json(&ran)["error"], message, "{command:?}");
    }
    let sweep = ["sweep", FIG_8_16, "--vary", "Tc=0.01,0.02", "--measure", "overload"];
    let ran = patchcord(&[&sweep[..], &["--out", "-", "--json"]].concat());
    assert_eq!((code(&ran), &json(&ran)["ok"]), (2, &false.into()));
    assert!(errors(&ran).contains("with --json the rows cannot go to standard output"), "{}", errors(&ran));
}

#[test]
fn other_outputs_cannot_be_standard_output() {
    let slideway = ["slideway", "--oil", "0.34", "--weight", "450", "--stiffness", "20", "--out", "-"];
    let commands: &[&[&str]] = &[
        &["run", FIG_8_16, "--plot", "-"],
        &["run", FIG_8_16, "--out", "-"],
        &["draw", FIG_8_16, "--plot", "-"],
        &["draw", FIG_8_16, "--out", "-"],
        &["profile", FIG_8_16, "--plot", "-"],
        &["replay", "fig-8-24", "--plot", "-"],
        &["replay", "fig-8-24", "--out", "-"],
        &["man", "--out", "-"],
        &slideway,
    ];
    for command in commands {
        check_refused(command, "which only --csv of run and linearise and --out of sweep can be");
    }
    assert!(!Path::new("-").exists());
}

#[test]
fn a_patch_is_read_from_standard_input() {
    let (_folder, file) = spring();
    let checked = patchcord_reading(SPRING, &["check", "-"]);
    assert_eq!((code(&checked), errors(&checked).as_str()), (0, ""));
    assert!(out(&checked).starts_with("<stdin>: "), "{}", out(&checked));
    let commands: [&[&str]; 4] =
        [&["run", "--csv", "-"], &["linearise"], &["check", "--voltages", "--json"], &["draw", "--json"]];
    for command in commands {
        let read = patchcord_reading(SPRING, &[command, &["-"]].concat());
        let named = out(&patchcord(&[command, &[file.as_str()]].concat()));
        assert_eq!((code(&read), errors(&read).as_str()), (0, ""), "{command:?}");
        let quoted = |text: &str| serde_json::to_string(text).unwrap();
        assert_eq!(out(&read), named.replace(&quoted(&file), "\"<stdin>\""), "{command:?}");
    }
    // The last line of a run has the time that it took.
    let read = out(&patchcord_reading(SPRING, &["run", "--for", "0.1", "-"]));
    let named = out(&patchcord(&["run", "--for", "0.1", &file]));
    assert!(table(&read).len() > 3 && read.contains(" simulated in "), "{read}");
    assert_eq!(table(&read), table(&named));
}

/// The lines of the table that a run prints.
fn table(text: &str) -> Vec<&str> {
    text.lines().take_while(|line| !line.starts_with("no picture")).collect()
}

#[test]
fn faults_of_a_patch_from_standard_input_have_their_lines() {
    let wrong = SPRING.replace("\"in\": \"B1\"", "\"in\": \"B2\"");
    let failed = patchcord_reading(&wrong, &["run", "-"]);
    assert_eq!((code(&failed), out(&failed).as_str()), (1, ""));
    assert!(errors(&failed).contains("--> <stdin>:9:"), "{}", errors(&failed));
    assert!(errors(&failed).contains("\n<stdin>: 1 error"), "{}", errors(&failed));
    let empty = patchcord_reading("", &["check", "-", "--json"]);
    assert_eq!((code(&empty), &json(&empty)["patch"]), (1, &"<stdin>".into()));
}

#[test]
fn files_of_a_patch_from_standard_input_are_named_stdin() {
    let folder = tempfile::tempdir().unwrap();
    let inside = path(&folder, "results");
    assert_eq!(code(&patchcord_reading(SPRING, &["run", "-", "--for", "0.01", "--out", &inside])), 0);
    assert_eq!(code(&patchcord_reading(SPRING, &["draw", "-", "--out", &inside])), 0);
    for name in ["stdin.csv", "stdin.svg", "stdin.picture-1.svg", "stdin.schematic.svg"] {
        assert!(Path::new(&inside).join(name).is_file(), "{name}");
    }
}

/// The paths of tables are relative to the working directory, because standard input has no folder.
#[test]
fn tables_of_a_patch_from_standard_input_are_read_and_kept() {
    let folder = driven();
    let text = fs::read_to_string(folder.path().join("driven.json")).unwrap();
    let run = |csv: &str| {
        let mut command = Command::cargo_bin("patchcord").unwrap();
        let command = command.current_dir(&folder).args(["run", "-", "--csv", csv]);
        command.write_stdin(text.clone()).output().unwrap()
    };
    let ran = run("-");
    assert_eq!((code(&ran), errors(&ran).as_str()), (0, ""));
    assert!(out(&ran).ends_with("\n1,-25\n"), "{}", out(&ran));
    let refused = run("u.csv");
    assert_eq!(code(&refused), 2);
    assert!(errors(&refused).contains("u.csv is a table of the patch itself"), "{}", errors(&refused));
}

/// A file that the shell opens as standard input is not overwritten.
#[cfg(target_os = "linux")]
#[test]
fn a_file_on_standard_input_is_kept() {
    let (_folder, file) = spring();
    let binary = env!("CARGO_BIN_EXE_patchcord");
    let mut command = std::process::Command::new(binary);
    let command = command.args(["run", "-", "--csv", &file]).stdin(fs::File::open(&file).unwrap());
    let ran = command.output().unwrap();
    assert_eq!(code(&ran), 2);
    assert!(errors(&ran).contains("spring.json is the patch itself"), "{}", errors(&ran));
    assert_eq!(fs::read_to_string(&file).unwrap(), SPRING);
}

#[test]
fn only_a_patch_can_be_standard_input() {
    let message = "\"-\" is standard input, which only a patch can be: give the name of a file";
    check_refused(&["gap", "-"], message);
    check_refused(&["sweep", FIG_8_16, "--rows", "-", "--measure", "overload"], message);
    check_refused(&["sweep", "-", "--rows", "-", "--measure", "overload"], message);
}
