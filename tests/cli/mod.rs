//! The command line: printed text, files and exit codes.

mod bad_problems;
mod check;
mod completions;
mod draw;
mod effects;
mod equation_page;
mod equations;
mod files;
mod gap;
mod limits;
mod linearise;
mod long_tables;
mod macros;
mod man;
mod new;
#[cfg(feature = "panel")]
mod panel;
mod phases;
mod pictures;
mod profile;
mod readme;
mod replay;
mod rescale;
mod run;
mod run_errors;
mod scale_documents;
mod sensitivity;
mod slideway;
mod standard_streams;
mod static_check;
mod sweep;
mod sweep_killed;
mod sweep_page;
mod tips;
mod transcripts;
mod traps;

use std::fs;
use std::process::Output;

use assert_cmd::Command;
use serde_json::Value;

/// The patch of Fig 8.16.
const FIG_8_16: &str = "patches/thesis/fig-8-16.json";

/// Runs the command with these arguments. It prints no lines about its progress.
fn patchcord(arguments: &[&str]) -> Output {
    patchcord_with_progress("0", arguments)
}

/// Runs the command with these arguments. It prints a line about its progress each time that these seconds have passed.
fn patchcord_with_progress(seconds: &str, arguments: &[&str]) -> Output {
    let mut command = Command::cargo_bin("patchcord").unwrap();
    command.env("PATCHCORD_PROGRESS", seconds).args(arguments).output().unwrap()
}

/// A line of a run in which N replaces the seconds that the run took, because these differ from run to run.
fn without_elapsed_time(line: &str) -> String {
    let Some((begin, rest)) = line.split_once(" simulated in ") else { return line.to_owned() };
    let (elapsed, end) = rest.split_once(" s; ").unwrap();
    let number: f64 = elapsed.trim_start_matches("less than ").parse().unwrap();
    assert!(number > 0.0, "{line}");
    format!("{begin} simulated in N s; {end}")
}

/// The exit code.
fn code(output: &Output) -> i32 {
    output.status.code().unwrap()
}

/// The text on standard output.
fn out(output: &Output) -> String {
    String::from_utf8(output.stdout.clone()).unwrap()
}

/// The text on standard error.
fn errors(output: &Output) -> String {
    String::from_utf8(output.stderr.clone()).unwrap()
}

/// The JSON document on standard output.
fn json(output: &Output) -> Value {
    serde_json::from_slice(&output.stdout).unwrap_or_else(|error| panic!("{error}: {}", out(output)))
}

/// The path of a file in a folder.
fn path(folder: &tempfile::TempDir, name: &str) -> String {
    folder.path().join(name).display().to_string()
}

#[test]
fn json_output_is_a_single_document() {
    let check = json(&patchcord(&["check", FIG_8_16, "--json"]));
    assert_eq!(check["ok"], true);
    let volts = |name: &str| {
        let all = check["voltages"].as_array().unwrap();
        all.iter().find(|read| read["element"] == name).unwrap()["volts"].as_f64().unwrap()
    };
    assert_eq!((volts("A1"), volts("B1"), volts("X2")), (100.0, -100.0, -50.0));
    let scaling = check["scaling"].as_array().unwrap();
    assert!(scaling.iter().any(|row| row["block"] == "K" && row["output"] == "spring_force"));
    let mut differences = scaling.iter().filter_map(|row| row["difference"].as_f64());
    assert!(differences.all(|difference| difference.abs() < 1e-12));
    let run = json(&patchcord(&["run", FIG_8_16, "--for", "0.01", "--json"]));
    assert_eq!(run["samples"], 11);
    assert_eq!(run["readings"][0]["signal"], "v_i");
    assert_eq!(run["sweeps"][0]["overloads"].as_array().unwrap().len(), 0);
    assert!(json(&patchcord(&["elements", "--json"])).as_array().unwrap().len() >= 15);
    assert_eq!(json(&patchcord(&["elements", "pot", "--json"]))[0]["settings"][0]["name"], "setting");
    let machines = json(&patchcord(&["machines", "--json"]));
    assert_eq!(
        (&machines[0]["name"], &machines[0]["parts"]["summers"]),
        (&"solartron-1451".into(), &16.into())
    );
}

#[test]
fn a_wrong_patch_gives_exit_code_1_and_a_report() {
    let folder = tempfile::tempdir().unwrap();
    let file = path(&folder, "wrong.json");
    let text = fs::read_to_string(FIG_8_16).unwrap().replace("\"in\": \"B5\"", "\"in\": \"B55\"");
    fs::write(&file, text).unwrap();
    let checked = patchcord(&["check", &file]);
    assert_eq!((code(&checked), out(&checked).as_str()), (1, ""));
    assert!(errors(&checked).contains("unknown-name") && errors(&checked).contains("did you mean"));
    let document = patchcord(&["check", &file, "--json"]);
    assert_eq!(code(&document), 1);
    let first = json(&document)["diagnostics"][0].clone();
    assert_eq!((&first["code"], first["line"].is_u64()), (&"unknown-name".into(), true));
}

#[test]
fn a_wrong_command_line_gives_exit_code_2() {
    let folder = tempfile::tempdir().unwrap();
    let plot = path(&folder, "out.gif");
    let wrong: &[&[&str]] = &[
        &["run", FIG_8_16, "--set", "VLc=1e-3"],
        &["run", FIG_8_16, "--set", "VcL"],
        &["run", FIG_8_16, "--set", "VcL=fast"],
        &["run", FIG_8_16, "--set", "VcL=NaN"],
        &["run", FIG_8_16, "--set", "VcL=1"],
        &["run", FIG_8_16, "--for", "-1"],
        &["run", FIG_8_16, "--step", "0"],
        &["run", FIG_8_16, "--every", "inf"],
        &["run", FIG_8_16, "--repeat", "0"],
        &["run", FIG_8_16, "--record", "v_p"],
        &["run", FIG_8_16, "--record", "v_o,,v_i"],
        &["run", FIG_8_16, "--record", "+100"],
        &["run", FIG_8_16, "--every", "9"],
        &["run", FIG_8_16, "--step", "9"],
        &["run", FIG_8_16, "--for", "1e-4"],
        &["run", FIG_8_16, "--step", "1e-300"],
        &["run", FIG_8_16, "--for", "1e9"],
        &["run", FIG_8_16, "--every", "1e-9", "--repeat", "2"],
        &["run", FIG_8_16, "--plot", &plot],
        &["run"],
        &["replay-all"],
        &["elements", "sumer"],
        &["new", "Cargo.toml"],
        &["new", FIG_8_16],
        &["completions", "tcsh"],
        &["man", "rum"],
    ];
    for arguments in wrong {
        let ran = patchcord(arguments);
        assert_eq!(code(&ran), 2, "{arguments:?}: {}", errors(&ran));
        assert!(!errors(&ran).is_empty(), "{arguments:?}");
        assert!(!errors(&ran).contains("000000"), "{}", errors(&ran));
        let document = patchcord(&[arguments, &["--json"][..]].concat());
        assert_eq!((code(&document), &json(&document)["ok"]), (2, &false.into()), "{arguments:?}");
    }
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 0);
}

/// A mass on a spring with a period of 1 s.
const SPRING: &str = r#"{
  "patchcord": 1,
  "title": "Mass on a spring",
  "scales": {"position": {"per_volt": 1, "unit": "mm"}},
  "elements": {
    "A1": {"kind": "integrator", "in": {"x10": ["P1"]}},
    "A2": {"kind": "integrator", "in": {"x10": ["A1"]}, "initial": -50},
    "B1": {"kind": "summer", "in": {"x1": ["A2"]}},
    "P1": {"kind": "pot", "in": "B1", "setting": 0.394784176}
  },
  "signals": {"x": {"at": "B1", "scale": "position"}},
  "run": {"for": 3.25, "step": 1e-3}
}"#;

/// Writes the patch SPRING with one change into a new folder.
fn spring_with(before: &str, after: &str) -> (tempfile::TempDir, String) {
    let folder = tempfile::tempdir().unwrap();
    let file = path(&folder, "spring.json");
    assert!(SPRING.contains(before), "{before}");
    fs::write(&file, SPRING.replace(before, after)).unwrap();
    (folder, file)
}

/// Writes the patch SPRING into a new folder.
fn spring() -> (tempfile::TempDir, String) {
    spring_with("", "")
}

#[test]
fn warnings_are_counted_and_do_not_change_exit_codes() {
    let (_folder, file) = spring_with("\n  \"run\"", "\n  \"record\": [\"A1\", \"x\"],\n  \"run\"");
    let checked = patchcord(&["check", &file]);
    assert_eq!(code(&checked), 0);
    assert!(out(&checked).contains("spring.json: no errors, 1 warning\n"), "{}", out(&checked));
    assert!(!errors(&checked).contains("1 warning"), "{}", errors(&checked));
    assert_eq!(code(&patchcord(&["check", &file, "--set", "k=1"])), 2);
}

/// Whether a text has no control characters except line feeds.
fn is_printable(text: &str) -> bool {
    text.chars().all(|letter| letter == '\n' || !letter.is_control())
}

#[test]
fn a_file_without_its_ending_is_recognised() {
    let (folder, file) = spring();
    let without = path(&folder, "spring");
    let ran = patchcord(&["run", &without]);
    assert_eq!(code(&ran), 1);
    let wanted = format!("cannot read {without}: No such file or directory; did you mean {file}?");
    assert!(errors(&ran).contains(&wanted), "{}", errors(&ran));
    let missing = patchcord(&["run", &path(&folder, "wheel")]);
    assert!(!errors(&missing).contains("did you mean"), "{}", errors(&missing));
}

#[test]
fn numbers_may_have_units() {
    let loaded = |arguments: &[&str]| {
        let checked = patchcord(&[&["check", FIG_8_16, "--json"], arguments].concat());
        assert_eq!(code(&checked), 0, "{}", errors(&checked));
        let parameters = json(&checked)["parameters"].as_array().unwrap().clone();
        let value = parameters.iter().find(|parameter| parameter["name"] == "VcL").unwrap()["value"].clone();
        value.as_f64().unwrap()
    };
    assert_eq!(loaded(&["--set", "VcL=5.08mm/s"]), 5.08e-3);
    assert_eq!(loaded(&["--set", "VcL=5.08e-3"]), 5.08e-3);
    let cases = [
        (["--set", "VcL=3s"], "--set VcL: \"3s\" is in s, but m/s is expected"),
        (["--set", "K=45,000,000"], "\"45,000,000\" is not a number: write 45000000"),
        (["--set", "K=45.000.000"], "\"45.000.000\" is not a number: write 45000000"),
        (["--set", "VcL=0,003"], "\"0,003\" is not a number: write 0.003"),
        (["--for", "2 kg"], "\"2 kg\" is in kg, but s is expected"),
    ];
    for (arguments, wanted) in cases {
        let failed = patchcord(&[&["run", FIG_8_16][..], &arguments[..]].concat());
        assert_eq!(code(&failed), 2, "{}", errors(&failed));
        assert!(errors(&failed).contains(wanted), "{}", errors(&failed));
    }
    assert_eq!(code(&patchcord(&["run", FIG_8_16, "--for", "10ms"])), 0);
}

/// A drive whose frequency n is in rpm and whose amplitude w is in 1/s.
const TURNING: &str = r#"{"patchcord": 1,
    "parameters": {"n": {"value": 120, "unit": "rpm", "range": [1, 1000]},
        "w": {"value": 9, "unit": "1/s", "range": [1, 90]}},
    "scales": {"speed": {"per_volt": 1, "unit": "1/s"}},
    "drives": {"shake": {"kind": "sine", "scale": "speed", "amplitude": "w", "frequency": "n"}},
    "elements": {"S": {"kind": "summer", "in": {"x1": ["shake"]}}},
    "signals": {"s": {"at": "S", "scale": "speed"}},
    "run": {"for": 1, "step": 0.01}}"#;

#[test]
fn revolutions_are_not_taken_for_radians() {
    let folder = tempfile::tempdir().unwrap();
    let patch = path(&folder, "turning.json");
    fs::write(&patch, TURNING).unwrap();
    let loaded = |setting: &str| {
        let checked = patchcord(&["check", &patch, "--json", "--set", setting]);
        assert_eq!(code(&checked), 0, "{}", errors(&checked));
        let name = setting.split_once('=').unwrap().0;
        let parameters = json(&checked)["parameters"].as_array().unwrap().clone();
        let parameter = parameters.iter().find(|parameter| parameter["name"] == name).unwrap();
        parameter["value"].as_f64().unwrap()
    };
    let cases = [("n=150 1/min", 150.0), ("n=2.5 1/s", 150.0), ("w=150 rpm", 2.5), ("w=3 rad/s", 3.0)];
    for (setting, value) in cases {
        assert!((loaded(setting) / value - 1.0).abs() < 1e-12, "{setting}: {}", loaded(setting));
    }
    let failed = patchcord(&["check", &patch, "--set", "w=90 deg/s"]);
    let wanted = "--set w: \"90 deg/s\": deg/s cannot be converted to 1/s, because 1/s may count radians, degrees or \
                  revolutions: write the value in 1/s, or declare 1/s with its angle, as in \"rad/s\", \"deg/s\" or \
                  \"rpm\"";
    assert_eq!(code(&failed), 2);
    assert!(errors(&failed).contains(wanted), "{}", errors(&failed));
}

#[test]
fn control_characters_do_not_reach_the_terminal() {
    let (_folder, file) = spring_with("Mass on a spring", "Mass\\u001b[2J\\u0007\\u009b1m on a spring");
    for arguments in [["check", &file], ["run", &file]] {
        let shown = out(&patchcord(&arguments));
        assert!(shown.contains("Mass\\u001b[2J\\u0007\\u009b1m on a spring\n"), "{shown:?}");
        assert!(is_printable(&shown), "{shown:?}");
    }
    let document = patchcord(&["check", &file, "--json"]);
    assert_eq!(json(&document)["title"], "Mass\u{1b}[2J\u{7}\u{9b}1m on a spring");
    assert!(is_printable(&out(&document)));
}

/// The name is the same in messages about a missing file, a wrong patch, a written file and a wrong command line.
#[cfg(unix)]
#[test]
fn control_characters_of_names_are_shown_as_escape_sequences() {
    let (folder, right) = spring();
    let name = "a\u{1b}[31m\u{7}\n.json";
    let (missing, wrong) = (path(&folder, "no\u{1b}[31m\n.json"), path(&folder, name));
    fs::write(&wrong, SPRING.replace("\"title\"", "\"titel\"")).unwrap();
    let csv = path(&folder, "b\u{1b}[31m.csv");
    let parameter = "k\u{1b}[31m=1";
    let cases: &[(&[&str], i32)] = &[
        (&["check", &missing], 1),
        (&["check", &wrong], 1),
        (&["run", &right, "--csv", &csv], 0),
        (&["run", &right, "--set", parameter], 2),
        (&["run", &right, "--tol", parameter], 2),
        (&[parameter], 2),
    ];
    for (arguments, expected) in cases {
        let ran = patchcord(arguments);
        let shown = out(&ran) + &errors(&ran);
        assert_eq!(code(&ran), *expected, "{arguments:?}: {shown}");
        assert!(shown.contains("\\u001b[31m") && is_printable(&shown), "{arguments:?}: {shown:?}");
    }
    // The rows of a sweep go to standard output, with the name of the patch above them.
    let named = path(&folder, "c\u{1b}[31m.json");
    fs::copy(FIG_8_16, &named).unwrap();
    let vary = ["--for", "0.01", "--vary", "VcL=1e-3,2e-3", "--measure", "peak:v_o"];
    let table = out(&patchcord(&[&["sweep", &named], &vary[..]].concat()));
    assert!(table.contains("# patch: c\\u001b[31m.json\n") && is_printable(&table), "{table:?}");
    assert!(errors(&patchcord(&["check", &missing])).contains("no\\u001b[31m\\u000a.json: No such file"));
}

#[test]
fn the_reference_page_of_elements_is_printed() {
    assert_eq!(out(&patchcord(&["elements", "--markdown"])), patchcord::elements::reference_page());
    let page = out(&patchcord(&["elements", "integrator"]));
    assert!(
        page.contains("law       d out / dt = ") && page.contains("\nsetting      unit  default"),
        "{page}"
    );
}

#[test]
fn an_element_is_found_by_its_name_in_other_programs() {
    let failed = patchcord(&["elements", "schmitt-trigger"]);
    assert_eq!(code(&failed), 2);
    assert!(
        errors(&failed)
            .contains("there is no element or drive \"schmitt-trigger\"; use a \"relay\": it compares")
    );
}

#[test]
fn help_and_version_give_exit_code_0() {
    for arguments in [["--help"], ["--version"]] {
        assert_eq!(code(&patchcord(&arguments)), 0);
    }
    assert!(out(&patchcord(&["run", "--json", "--help"])).contains("Usage"));
}

/// /dev/full refuses every write.
#[cfg(target_os = "linux")]
#[test]
fn output_that_cannot_be_written_gives_exit_code_1() {
    let binary = env!("CARGO_BIN_EXE_patchcord");
    let cases: &[&[&str]] = &[
        &["--help"],
        &["--version"],
        &["help", "run"],
        &["run", "--help"],
        &["run", "--json", "--help"],
        &["elements"],
        &["man"],
        &["completions", "bash"],
        &["check", FIG_8_16],
        &["check", FIG_8_16, "--json"],
        &["run", FIG_8_16, "--for", "0.01", "--csv", "-"],
        &["sweep", FIG_8_16, "--for", "0.01", "--vary", "VcL=1e-3,2e-3", "--measure", "peak:v_o"],
    ];
    for arguments in cases {
        let full = fs::File::options().write(true).open("/dev/full").unwrap();
        let ran = std::process::Command::new(binary).args(*arguments).stdout(full).output().unwrap();
        let message = "error: cannot write to standard output: No space left on device\n";
        assert_eq!((code(&ran), errors(&ran).as_str()), (1, message), "{arguments:?}");
    }
}

/// The reader closes the pipe before the command writes, as with `head`.
#[test]
fn a_closed_pipe_is_no_error() {
    let binary = env!("CARGO_BIN_EXE_patchcord");
    let commands: [&[&str]; 4] = [
        &["--help"],
        &["check", FIG_8_16],
        &["run", FIG_8_16, "--csv", "/dev/stdout"],
        &["run", FIG_8_16, "--csv", "-"],
    ];
    for arguments in commands {
        let (reader, writer) = std::io::pipe().unwrap();
        drop(reader);
        let mut command = std::process::Command::new(binary);
        let command = command.env("PATCHCORD_PROGRESS", "0").args(arguments).stdout(writer);
        let ran = command.output().unwrap();
        assert_eq!((code(&ran), errors(&ran).as_str()), (0, ""), "{arguments:?}");
    }
}
