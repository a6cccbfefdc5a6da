//! The command line as a user meets it: what it prints, what it writes, how it ends.

mod check;
mod completions;
mod draw;
mod linearise;
mod macros;
mod man;
mod new;
mod phases;
mod pictures;
mod refused;
mod sweep;

use std::fs;
use std::path::Path;
use std::process::Output;

use assert_cmd::Command;
use serde_json::Value;

const FIG_8_16: &str = "patches/thesis/fig-8-16.json";

fn patchcord(arguments: &[&str]) -> Output {
    Command::cargo_bin("patchcord").unwrap().args(arguments).output().unwrap()
}

fn code(output: &Output) -> i32 {
    output.status.code().unwrap()
}

fn out(output: &Output) -> String {
    String::from_utf8(output.stdout.clone()).unwrap()
}

fn errors(output: &Output) -> String {
    String::from_utf8(output.stderr.clone()).unwrap()
}

fn json(output: &Output) -> Value {
    serde_json::from_slice(&output.stdout).unwrap_or_else(|error| panic!("{error}: {}", out(output)))
}

fn path(folder: &tempfile::TempDir, name: &str) -> String {
    folder.path().join(name).display().to_string()
}

#[test]
fn a_run_writes_table_and_picture() {
    let folder = tempfile::tempdir().unwrap();
    let (csv, svg) = (path(&folder, "out.csv"), path(&folder, "out.svg"));
    let ran = patchcord(&["run", FIG_8_16, "--for", "0.5", "--csv", &csv, "--plot", &svg]);
    assert_eq!((code(&ran), errors(&ran).as_str()), (0, ""));
    assert!(out(&ran).contains("no overload") && out(&ran).contains(&format!("wrote {csv}")));
    let table = fs::read_to_string(&csv).unwrap();
    let lines: Vec<&str> = table.lines().filter(|line| !line.starts_with('#')).collect();
    assert_eq!(lines[0], "t,v_i,x_error,v_o,a_o,spring_force,friction_level,memory");
    assert_eq!(lines.len(), 502);
    assert!(lines[501].starts_with("0.5,"));
    assert!(table.contains("# v_o: m/s\n"));
    let picture = fs::read_to_string(&svg).unwrap();
    assert!(picture.starts_with("<?xml") && picture.contains("v_o, mm/s"));
}

#[test]
fn a_folder_takes_table_and_picture_under_the_patchs_name() {
    let folder = tempfile::tempdir().unwrap();
    let inside = path(&folder, "new/results");
    assert_eq!(code(&patchcord(&["run", FIG_8_16, "--for", "0.01", "--out", &inside])), 0);
    for file in ["fig-8-16.csv", "fig-8-16.svg"] {
        assert!(Path::new(&inside).join(file).is_file(), "{file}");
    }
}

#[test]
fn the_same_run_gives_the_same_bytes() {
    let folder = tempfile::tempdir().unwrap();
    let files = ["a.csv", "b.csv", "a.png", "b.png"].map(|name| path(&folder, name));
    for (csv, png) in [(&files[0], &files[2]), (&files[1], &files[3])] {
        assert_eq!(code(&patchcord(&["run", FIG_8_16, "--for", "0.3", "--csv", csv, "--plot", png])), 0);
    }
    let bytes = files.each_ref().map(|file| fs::read(file).unwrap());
    assert!(bytes[0] == bytes[1] && bytes[2] == bytes[3]);
}

#[test]
fn json_is_one_document_and_nothing_else() {
    let check = json(&patchcord(&["check", FIG_8_16, "--json"]));
    assert_eq!(check["ok"], true);
    let volts = |name: &str| {
        let all = check["voltages"].as_array().unwrap();
        all.iter().find(|read| read["element"] == name).unwrap()["volts"].as_f64().unwrap()
    };
    assert_eq!((volts("A1"), volts("B1"), volts("X2")), (100.0, -100.0, -50.0));
    let scaling = check["scaling"].as_array().unwrap();
    assert!(scaling.iter().any(|row| row["block"] == "K" && row["output"] == "spring_force"));
    assert!(scaling.iter().all(|row| row["difference"].as_f64().unwrap().abs() < 1e-12));
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
fn a_wrong_patch_ends_with_1_and_its_report() {
    let folder = tempfile::tempdir().unwrap();
    let file = path(&folder, "wrong.json");
    let text = fs::read_to_string(FIG_8_16).unwrap().replace("\"in\": \"B5\"", "\"in\": \"B55\"");
    fs::write(&file, text).unwrap();
    let checked = patchcord(&["check", &file]);
    assert_eq!((code(&checked), out(&checked).as_str()), (1, ""));
    assert!(errors(&checked).contains("unknown-name") && errors(&checked).contains("did you mean"));
    let told = patchcord(&["check", &file, "--json"]);
    assert_eq!(code(&told), 1);
    let first = json(&told)["diagnostics"][0].clone();
    assert_eq!((&first["code"], first["line"].is_u64()), (&"unknown-name".into(), true));
}

#[test]
fn a_wrong_command_line_ends_with_2() {
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
        &["run", FIG_8_16, "--every", "1e-8", "--repeat", "2"],
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
        let told = patchcord(&[arguments, &["--json"][..]].concat());
        assert_eq!((code(&told), &json(&told)["ok"]), (2, &false.into()), "{arguments:?}");
    }
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 0);
}

#[test]
fn files_that_cannot_be_read_or_written_end_with_1() {
    let wrong: &[&[&str]] = &[
        &["check", "no-such-file.json"],
        &["run", FIG_8_16, "--for", "0.001", "--csv", "no/such/folder/out.csv"],
        &["run", FIG_8_16, "--for", "0.001", "--csv", "patches"],
    ];
    for arguments in wrong {
        let ran = patchcord(arguments);
        assert_eq!(code(&ran), 1, "{arguments:?}");
        assert!(errors(&ran).starts_with("error: cannot"), "{}", errors(&ran));
    }
}

#[test]
fn no_file_is_written_twice_or_over_the_patch() {
    let folder = tempfile::tempdir().unwrap();
    let [patch, table, out] = ["a.json", "a.csv", "new"].map(|name| path(&folder, name));
    fs::copy(FIG_8_16, &patch).unwrap();
    let [picture, twice] = [path(&folder, "a.svg"), path(&folder, "new/a.csv")];
    let roundabout = path(&folder, "../") + folder.path().file_name().unwrap().to_str().unwrap() + "/a.svg";
    let wrong: &[(&[&str], &str)] = &[
        (&["--csv", &patch], "is the patch itself"),
        (&["--csv", &picture, "--plot", &roundabout], "would be written twice"),
        (&["--csv", &twice, "--out", &out], "would be written twice"),
        (&["--csv", ""], "a value is required"),
    ];
    for (options, message) in wrong {
        let ran = patchcord(&[&["run", &patch, "--for", "0.001"], *options].concat());
        assert_eq!(code(&ran), 2, "{options:?}: {}", errors(&ran));
        assert!(errors(&ran).contains(message), "{}", errors(&ran));
    }
    assert_eq!(fs::read_to_string(&patch).unwrap(), fs::read_to_string(FIG_8_16).unwrap());
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1);
    assert_eq!(code(&patchcord(&["run", &patch, "--for", "0.001", "--csv", &table])), 0);
}

#[test]
fn a_folder_is_made_for_right_patches_and_keeps_the_dots_of_their_names() {
    let folder = tempfile::tempdir().unwrap();
    let [patch, wrong, out] = ["a.b.json", "wrong.json", "new"].map(|name| path(&folder, name));
    fs::copy(FIG_8_16, &patch).unwrap();
    fs::write(&wrong, "{\"patchcord\": 1, \"elements\": 3}").unwrap();
    assert_eq!(code(&patchcord(&["run", &wrong, "--out", &out])), 1);
    assert!(!Path::new(&out).exists());
    assert_eq!(code(&patchcord(&["run", &patch, "--for", "0.001", "--out", &out])), 0);
    assert!(Path::new(&out).join("a.b.csv").is_file() && Path::new(&out).join("a.b.svg").is_file());
}

#[test]
fn a_repeated_run_tells_its_runs_apart() {
    let folder = tempfile::tempdir().unwrap();
    let csv = path(&folder, "out.csv");
    assert_eq!(code(&patchcord(&["run", FIG_8_16, "--for", "0.002", "--repeat", "2", "--csv", &csv])), 0);
    let table = fs::read_to_string(&csv).unwrap();
    let rows: Vec<&str> = table.lines().filter(|line| !line.starts_with('#')).collect();
    assert!(rows[0].ends_with(",run"));
    assert_eq!(rows.len(), 7);
    let without_run = |row: &str| row.rsplit_once(',').unwrap().0.to_owned();
    assert_eq!(without_run(rows[3]), without_run(rows[6]));
    assert!(rows[1].ends_with(",1") && rows[6].ends_with(",2"));
}

#[test]
fn an_overload_is_told_with_what_it_caused() {
    let ran = patchcord(&["run", FIG_8_16, "--set", "x_step=0.127e-3", "--for", "0.1"]);
    assert_eq!(code(&ran), 0);
    let told = out(&ran);
    let lines: Vec<&str> = told.lines().filter(|line| line.starts_with("overload: ")).collect();
    assert!(lines.len() > 1 && lines[0].ends_with("(first)"), "{told}");
    assert!(lines[1].contains("caused by"), "{told}");
    let held =
        patchcord(&["run", FIG_8_16, "--set", "x_step=0.127e-3", "--for", "0.1", "--hold-on-overload"]);
    assert!(out(&held).contains("held at t = "), "{}", out(&held));
}

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

/// A small patch in a folder of its own, one thing in it changed.
fn spring_with(before: &str, after: &str) -> (tempfile::TempDir, String) {
    let folder = tempfile::tempdir().unwrap();
    let file = path(&folder, "spring.json");
    assert!(SPRING.contains(before), "{before}");
    fs::write(&file, SPRING.replace(before, after)).unwrap();
    (folder, file)
}

fn spring() -> (tempfile::TempDir, String) {
    spring_with("", "")
}

#[test]
fn readings_come_from_every_step_and_end_with_the_run() {
    let (_folder, file) = spring();
    let coarse = json(&patchcord(&["run", &file, "--every", "1", "--json"]));
    let fine = json(&patchcord(&["run", &file, "--json"]));
    assert_eq!((&coarse["samples"], &fine["samples"]), (&4.into(), &3251.into()));
    assert_eq!(coarse["readings"], fine["readings"]);
    let [x, t] = ["value", "t"].map(|key| coarse["readings"][0]["least"][key].as_f64().unwrap());
    assert!((x + 50.0).abs() < 1e-6 && ((t % 1.0) - 0.5).abs() < 2e-3, "{coarse}");
    assert!(coarse["readings"][0]["end"].as_f64().unwrap().abs() < 1e-6, "{coarse}");
}

#[test]
fn a_run_that_stops_writes_what_it_recorded() {
    let folder = tempfile::tempdir().unwrap();
    let csv = path(&folder, "ball.csv");
    // A ball that never comes to rest bounces without end.
    let endless =
        ["run", "tests/patches/bouncing-ball.json", "--set", "v_rest=0", "--set", "e=0.5", "--csv", &csv];
    let ran = patchcord(&endless);
    assert_eq!((code(&ran), out(&ran).as_str()), (1, ""));
    assert!(errors(&ran).contains("it chatters"), "{}", errors(&ran));
    let table = fs::read_to_string(&csv).unwrap();
    let last = table.lines().last().unwrap().split(',').next().unwrap();
    assert!(last.parse::<f64>().unwrap() > 1.0, "{last}");
    assert!(errors(&ran).contains(&format!("the files hold the run up to t = {last} s")), "{}", errors(&ran));
    let told = json(&patchcord(&[&endless[..], &["--json"]].concat()));
    assert_eq!(
        (&told["ok"], &told["code"], &told["files"][0]),
        (&false.into(), &"chatter".into(), &csv.into())
    );
    assert_eq!(told["recorded_until"].to_string(), last);
}

#[test]
fn a_missing_run_is_told_at_once_and_checks_nevertheless() {
    let delay = r#""B1": {"kind": "summer", "in": {"x1": ["D1"]}}, "D1": {"kind": "delay", "in": "A2", "delay": 1e-6}"#;
    let lag = r#""B1": {"kind": "lag", "in": {"x1": ["A2"]}, "time": 1e-6}"#;
    [delay, lag].into_iter().for_each(missing_run_is_told);
}

/// The same of a spring whose inverter is made of something that wants a short step.
fn missing_run_is_told(inverter: &str) {
    let (_folder, file) = spring_with(r#""B1": {"kind": "summer", "in": {"x1": ["A2"]}}"#, inverter);
    let text = fs::read_to_string(&file).unwrap();
    fs::write(&file, text.replace(",\n  \"run\": {\"for\": 3.25, \"step\": 1e-3}", "")).unwrap();
    let ran = patchcord(&["run", &file]);
    assert_eq!(code(&ran), 2);
    assert!(errors(&ran).contains("give --for and --step or --tol"), "{}", errors(&ran));
    let checked = patchcord(&["check", &file]);
    assert_eq!((code(&checked), errors(&checked).as_str()), (0, ""));
    let ran = patchcord(&["run", &file, "--for", "1", "--step", "1e-3"]);
    assert_eq!(code(&ran), 2);
    assert!(
        errors(&ran).contains("give one with --step, or a tolerance with --tol\n  --> "),
        "{}",
        errors(&ran)
    );
}

#[test]
fn warnings_are_counted_and_leave_an_unknown_parameter_a_wrong_command_line() {
    let (_folder, file) = spring_with("\n  \"run\"", "\n  \"record\": [\"A1\", \"x\"],\n  \"run\"");
    let checked = patchcord(&["check", &file]);
    assert_eq!(code(&checked), 0);
    assert!(out(&checked).contains("spring.json: no errors, 1 warning\n"), "{}", out(&checked));
    assert_eq!(code(&patchcord(&["check", &file, "--set", "k=1"])), 2);
}

#[test]
fn control_characters_do_not_reach_the_terminal() {
    let (_folder, file) = spring_with("Mass on a spring", "Mass\\u001b[2J\\u0007\\u009b1m on a spring");
    for arguments in [["check", &file], ["run", &file]] {
        let shown = out(&patchcord(&arguments));
        assert!(shown.contains("Mass[2J1m on a spring\n"), "{shown:?}");
        assert!(shown.chars().all(|letter| letter == '\n' || !letter.is_control()), "{shown:?}");
    }
    let told = patchcord(&["check", &file, "--json"]);
    assert_eq!(json(&told)["title"], "Mass\u{1b}[2J\u{7}\u{9b}1m on a spring");
    assert!(out(&told).chars().all(|letter| letter == '\n' || !letter.is_control()));
}

#[test]
fn names_to_record_may_stand_apart() {
    let (_folder, file) = spring();
    let ran = json(&patchcord(&["run", &file, "--record", "x, A1", "--json"]));
    let names: Vec<_> =
        ran["readings"].as_array().unwrap().iter().map(|reading| &reading["signal"]).collect();
    assert_eq!(names, ["x", "A1"]);
    assert_eq!(ran["sweeps"][0]["switchings"], 0);
}

#[test]
fn a_ball_at_rest_reads_0() {
    let ran = patchcord(&["run", "tests/patches/bouncing-ball.json", "--set", "e=0.5"]);
    let told = out(&ran);
    let height = told.lines().find(|line| line.starts_with("height")).unwrap();
    assert_eq!(height.split_whitespace().nth(3), Some("0"), "{told}");
}

#[test]
fn the_page_of_elements_is_printed_too() {
    assert_eq!(out(&patchcord(&["elements", "--markdown"])), patchcord::elements::reference_page());
    let told = out(&patchcord(&["elements", "integrator"]));
    assert!(
        told.contains("law       d out / dt = ") && told.contains("\nsetting      unit  default"),
        "{told}"
    );
}

#[test]
fn help_and_version_end_well() {
    for arguments in [["--help"], ["--version"]] {
        assert_eq!(code(&patchcord(&arguments)), 0);
    }
    assert!(out(&patchcord(&["run", "--json", "--help"])).contains("Usage"));
}

#[cfg(unix)]
#[test]
fn a_table_on_standard_output_stands_before_the_readings() {
    let (folder, file) = spring();
    let shown = folder.path().join("shown");
    let mut command = std::process::Command::new(assert_cmd::cargo::cargo_bin("patchcord"));
    let ran = command
        .args(["run", &file, "--for", "0.002", "--csv", "/dev/stdout"])
        .stdout(fs::File::create(&shown).unwrap())
        .status()
        .unwrap();
    assert!(ran.success());
    let shown = fs::read_to_string(shown).unwrap();
    assert!(shown.starts_with("# t: s\n") && shown.ends_with("wrote /dev/stdout\n"), "{shown}");
}

#[cfg(unix)]
#[test]
fn a_read_only_file_is_refused_before_the_run() {
    use std::os::unix::fs::PermissionsExt as _;
    let (folder, file) = spring();
    let kept = path(&folder, "kept.csv");
    fs::write(&kept, "old").unwrap();
    fs::set_permissions(&kept, fs::Permissions::from_mode(0o444)).unwrap();
    let ran = patchcord(&["run", &file, "--csv", &kept]);
    assert_eq!((code(&ran), out(&ran).as_str()), (1, ""));
    assert_eq!(errors(&ran), format!("error: cannot write {kept}: it is read-only\n"));
    assert_eq!(fs::read_to_string(&kept).unwrap(), "old");
}

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
    let ran = Command::cargo_bin("patchcord").unwrap().args(arguments).current_dir(&folder).output().unwrap();
    assert_eq!((code(&ran), errors(&ran).as_str()), (0, ""));
    let promised: Vec<String> =
        readme_block("It ends with\n").into_iter().filter(|line| !line.is_empty()).collect();
    let printed: Vec<String> = out(&ran).lines().map(str::to_owned).filter(|line| !line.is_empty()).collect();
    assert_eq!(printed[printed.len() - promised.len()..], promised);
    assert!(folder.path().join("fig-8-16.csv").is_file() && folder.path().join("fig-8-16.svg").is_file());
}
