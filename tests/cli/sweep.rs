//! `patchcord sweep`.

use std::fs;

use super::{FIG_8_16, code, errors, json, out, patchcord, patchcord_with_progress, path};

const SHORT: [&str; 8] =
    ["--vary", "VcL=1e-3,2e-3", "--for", "0.3", "--measure", "peak:v_o", "--measure", "overload"];

fn run_sweep(more: &[&str]) -> std::process::Output {
    patchcord(&[&["sweep", FIG_8_16], &SHORT[..], more].concat())
}

#[test]
fn rows_are_written_to_standard_output_or_to_a_file() {
    let folder = tempfile::tempdir().unwrap();
    let csv = path(&folder, "sweep.csv");
    let shown = run_sweep(&[]);
    assert_eq!((code(&shown), errors(&shown).as_str()), (0, ""));
    let lines = out(&shown);
    assert!(lines.starts_with("# patchcord ") && lines.contains("\n# VcL: m/s\n"), "{lines}");
    assert!(lines.contains("\nVcL,peak:v_o,overload,overload_time,error,note\n0.001,0.00"), "{lines}");
    let written = run_sweep(&["--out", &csv]);
    assert_eq!(out(&written), format!("2 runs: 0 failed, 0 with a note\nwrote {csv}\n"));
    assert_eq!(fs::read_to_string(&csv).unwrap(), lines);
    let complete = out(&run_sweep(&["--out", &csv]));
    assert_eq!(
        complete,
        format!(
            "0 runs, 2 more in the file; in total 0 failed, 0 with a note\n{csv} is complete: nothing to do\n"
        )
    );
    let document = json(&run_sweep(&["--out", &path(&folder, "more.csv"), "--json"]));
    assert_eq!(document["sweep"]["threads"], std::thread::available_parallelism().unwrap().get());
    let again = json(&run_sweep(&["--out", &csv, "--json", "--threads", "1"]));
    assert_eq!(again["sweep"]["threads"], 1);
    let counts = ["runs", "kept", "written", "failed"].map(|key| again["sweep"][key].as_u64().unwrap());
    assert_eq!(counts, [2, 2, 0, 0]);
    assert_eq!(again["sweep"]["columns"][1], serde_json::json!({"name": "peak:v_o", "unit": "m/s"}));
    assert_eq!(fs::read_to_string(&csv).unwrap(), lines);
}

#[test]
fn a_long_sweep_reports_its_progress_in_plain_lines() {
    let folder = tempfile::tempdir().unwrap();
    let csv = path(&folder, "sweep.csv");
    let command = ["sweep", FIG_8_16, "--vary", "VcL=1e-3,2e-3", "--for", "2", "--measure", "peak:v_o"];
    let expected = out(&patchcord(&command));
    let ran = patchcord_with_progress("0.001", &[&command[..], &["--out", &csv]].concat());
    let lines = errors(&ran);
    assert_eq!(code(&ran), 0, "{lines}");
    assert!(lines.lines().all(|line| line.starts_with("sweep: ")), "{lines}");
    assert!(lines.lines().any(|line| line.contains(" of 2 runs")), "{lines}");
    assert_eq!(fs::read_to_string(&csv).unwrap(), expected);
}

/// F follows -S within some milliseconds. Steps of 3 ms are too long for it.
pub(super) const STIFF: &str = r#"{"patchcord": 1, "title": "stiff", "machine": "unlimited",
    "parameters": {"x0": {"value": 80, "unit": "V", "range": [1, 90]}},
    "scales": {"volt": {"per_volt": 1, "unit": "V"}},
    "elements": {"F": {"kind": "integrator", "in": {"x1000": ["F", "S"]}},
        "S": {"kind": "integrator", "in": {"x1": ["S"]}, "initial": "x0"}},
    "signals": {"f": {"at": "F", "scale": "volt"}}, "run": {"for": 1, "step": 0.003}}"#;

#[test]
fn a_step_that_is_too_long_is_reported_with_a_row() {
    let folder = tempfile::tempdir().unwrap();
    let [patch, csv, other] = ["stiff.json", "out.csv", "other.csv"].map(|name| path(&folder, name));
    fs::write(&patch, STIFF).unwrap();
    let stiff = |options: &[&str]| {
        let command = ["sweep", &patch, "--vary", "x0=10,50", "--measure", "peak:f"];
        patchcord(&[&command[..], options].concat())
    };
    for options in [&[][..], &["--out", &csv]] {
        let message = errors(&stiff(options));
        let begin =
            "warning: at x0 = 50 V the step of 0.003 s is too long: the solver is unstable at F. With";
        assert!(message.starts_with(begin), "{message}");
        let end = "  = help: try --step 0.0002 or --tol 1e-6; other rows may need a shorter step\n";
        assert!(message.ends_with(end), "{message}");
    }
    let document = json(&stiff(&["--out", &other, "--json"]));
    let warning = &document["step_warning"];
    assert_eq!((&warning["at"]["x0"], &warning["unstable"]), (&50.0.into(), &"F".into()));
    // Rows of the file, shorter steps and adaptive steps need no check.
    for options in [&["--out", &csv][..], &["--step", "1e-4"], &["--tol", "1e-6"]] {
        assert_eq!(errors(&stiff(options)), "", "{options:?}");
    }
    assert!(json(&stiff(&["--out", &csv, "--json"]))["step_warning"].is_null());
}

#[test]
fn rows_of_a_file_are_combined_with_every_value_of_an_axis() {
    let folder = tempfile::tempdir().unwrap();
    let rows = path(&folder, "rows.csv");
    fs::write(&rows, "# K: N/m\nK,M\n20e6,300\n45e6,433\n").unwrap();
    let shown = out(&run_sweep(&["--rows", &rows]));
    let begins: Vec<_> =
        shown.lines().filter(|line| line.starts_with(|c: char| c.is_ascii_digit())).collect();
    let expected =
        ["20000000,300,0.001,", "20000000,300,0.002,", "45000000,433,0.001,", "45000000,433,0.002,"];
    assert_eq!(begins.len(), 4, "{shown}");
    assert!(begins.iter().zip(expected).all(|(row, begin)| row.starts_with(begin)), "{shown}");
}

#[test]
fn values_of_a_range_are_short_decimal_numbers() {
    let values = |vary: &str| -> Vec<String> {
        let sweep = ["sweep", FIG_8_16, "--for", "0.002", "--measure", "overload", "--vary", vary];
        let table = out(&patchcord(&sweep));
        let rows = table.lines().filter(|line| line.starts_with(|sign: char| sign.is_ascii_digit()));
        rows.map(|row| row.split(',').next().unwrap().to_owned()).collect()
    };
    let expected = ["0.003", "0.0031", "0.0032", "0.0033", "0.0034", "0.0035"];
    assert_eq!(values("VcL=3e-3:3.5e-3:6"), expected);
    assert_eq!(values("VcL=3mm/s:3.5mm/s:6"), expected);
    assert_eq!(values("Tc=0.1:1:10"), ["0.1", "0.2", "0.3", "0.4", "0.5", "0.6", "0.7", "0.8", "0.9", "1"]);
    assert_eq!(values("Tc=1e-3:1:4:log"), ["0.001", "0.01", "0.1", "1"]);
}

#[test]
fn the_file_of_another_sweep_is_left_unchanged() {
    let folder = tempfile::tempdir().unwrap();
    let csv = path(&folder, "sweep.csv");
    assert_eq!(code(&run_sweep(&["--out", &csv])), 0);
    let before = fs::read(&csv).unwrap();
    for other in [&["--set", "K=40e6"][..], &["--tol", "1e-6"], &["--measure", "stick_end"]] {
        let failed = run_sweep(&[&["--out", &csv], other].concat());
        assert_eq!(code(&failed), 1, "{other:?}");
        assert!(errors(&failed).contains("does not belong to this sweep: line "));
        assert!(fs::read(&csv).unwrap() == before);
    }
}

/// A folder with a patch, the table of its drive, and a file of rows.
pub(super) fn driven() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    let patch = r#"{"patchcord": 1, "title": "driven", "machine": "unlimited",
        "parameters": {"k": {"value": 0.5, "unit": "1", "range": [0, 1]}},
        "scales": {"volt": {"per_volt": 1, "unit": "V"}},
        "drives": {"u": {"kind": "table", "scale": "volt", "points": {"csv": "u.csv"}}},
        "elements": {"P": {"kind": "pot", "in": "u", "setting": "k"}, "S": {"kind": "inverter", "in": "P"}},
        "signals": {"s": {"at": "S", "scale": "volt"}}, "run": {"for": 1, "step": 0.01}}"#;
    fs::write(folder.path().join("driven.json"), patch).unwrap();
    fs::write(folder.path().join("u.csv"), "t,u\n0,0\n1,50\n").unwrap();
    fs::write(folder.path().join("k.csv"), "k\n0.1\n0.2\n").unwrap();
    folder
}

/// Runs a sweep twice, the second time with a change in a file or with options. Returns the error of the second run.
fn error_after_change(file: &str, from: &str, to: &str, options: &str) -> String {
    let folder = driven();
    let [patch, rows, csv] = ["driven.json", "k.csv", "out.csv"].map(|name| path(&folder, name));
    let command = ["sweep", &patch, "--rows", &rows, "--measure", "voltmeter:s", "--out", &csv];
    assert_eq!(code(&patchcord(&command)), 0);
    let before = fs::read(&csv).unwrap();
    let file = folder.path().join(file);
    let text = fs::read_to_string(&file).unwrap();
    assert!(text.contains(from));
    fs::write(file, text.replace(from, to)).unwrap();
    let options: Vec<_> = options.split_whitespace().collect();
    let error = errors(&patchcord(&[&command, &options[..]].concat()));
    assert!(fs::read(&csv).unwrap() == before);
    error
}

#[test]
fn changed_inputs_of_an_existing_file_are_reported() {
    let cases = [
        (
            "driven.json",
            "inverter",
            "absolute",
            "",
            "does not belong to this sweep: the patch changed after the file was started; line ",
        ),
        (
            "u.csv",
            "1,50",
            "1,60",
            "",
            "does not belong to this sweep: the patch's tables changed after the file was started; line ",
        ),
        (
            "k.csv",
            "0.2",
            "0.3",
            "",
            "does not belong to this sweep: the file of rows changed after the file was started; line ",
        ),
        ("k.csv", "", "", "--backend reference", "expected \"# backend: reference\""),
        (
            "k.csv",
            "",
            "",
            "--backend reference --tol 1e-6",
            "tolerance 1e-6, recorded every 0.01 s\"; the file",
        ),
    ];
    for (file, from, to, options, wanted) in cases {
        let error = error_after_change(file, from, to, options);
        assert!(error.contains(wanted), "{error}");
    }
    assert_eq!(error_after_change("k.csv", "", "", "--backend interpreter"), "");
}

#[test]
fn a_changed_row_of_an_existing_file_is_reported_with_line_and_column() {
    let folder = tempfile::tempdir().unwrap();
    let csv = path(&folder, "sweep.csv");
    assert_eq!(code(&run_sweep(&["--out", &csv])), 0);
    let table = fs::read_to_string(&csv).unwrap();
    let row = table.lines().find(|line| line.starts_with("0.001,")).unwrap();
    let number = table.lines().position(|line| line == row).unwrap() + 1;
    let peak = row.split(',').nth(1).unwrap();
    for (changed, reason) in [
        ("0.001,".to_owned(), "it has 2 fields, expected 6"),
        (row.to_owned() + ",7", "it has 7 fields, expected 6"),
        (row.replace(peak, "fast"), "in the column peak:v_o, \"fast\" is not a finite number"),
        (row.replace(peak, "NaN"), "in the column peak:v_o, \"NaN\" is not a finite number"),
        (row.replace("none", "Z9"), "in the column overload, \"Z9\" is no element"),
    ] {
        let text = table.replacen(row, &changed, 1);
        fs::write(&csv, &text).unwrap();
        let failed = run_sweep(&["--out", &csv]);
        let expected = format!("error: line {number} of {csv} is no row of this sweep: {reason}");
        assert_eq!(code(&failed), 1, "{changed}");
        assert!(errors(&failed).starts_with(&expected), "{}", errors(&failed));
        assert_eq!(fs::read_to_string(&csv).unwrap(), text);
    }
    // Without the changed row and the rows after it, the sweep is continued to the same bytes.
    fs::write(&csv, &table[..table.find(row).unwrap()]).unwrap();
    assert_eq!(code(&run_sweep(&["--out", &csv])), 0);
    assert_eq!(fs::read_to_string(&csv).unwrap(), table);
}

#[test]
fn a_file_that_another_sweep_is_writing_is_left_unchanged() {
    let folder = tempfile::tempdir().unwrap();
    let csv = path(&folder, "sweep.csv");
    let other = fs::File::create(&csv).unwrap();
    other.lock().unwrap();
    let failed = run_sweep(&["--out", &csv]);
    let error =
        format!("error: another sweep is writing {csv}: wait until it ends, or specify another file\n");
    assert_eq!((code(&failed), errors(&failed)), (1, error));
    assert_eq!(fs::read(&csv).unwrap(), b"");
    drop(other);
    assert_eq!(code(&run_sweep(&["--out", &csv])), 0);
}

#[test]
fn a_wrong_command_line_gives_exit_code_2_before_any_run() {
    let folder = tempfile::tempdir().unwrap();
    let (csv, rows) = (path(&folder, "sweep.csv"), path(&folder, "rows.csv"));
    fs::write(&rows, "K\n20e6\n").unwrap();
    let cases: &[(&[&str], &str)] = &[
        (&["--vary", "VcL=1e-3:2e-3:3"], "VcL is varied twice"),
        (&["--vary", "Tc=5"], "Tc = 5 s is outside its range 0.001 ... 1 s"),
        (&["--vary", "Tcc=0.5"], "did you mean \"Tc\"?"),
        (&["--vary", "Tc=1kg:3kg:5"], "Tc: \"1kg\" is in kg, but s is expected"),
        (&["--vary", "Tc=1:2"], "\"Tc=1:2\" gives no values"),
        (&["--set", "VcL=1e-3"], "VcL is set and varied"),
        (&["--measure", "peek:v_o"], "did you mean \"peak\"?"),
        (&["--measure", "peak:v_o"], "two columns are named peak:v_o"),
        (&["--threads", "0"], "--threads"),
        (&["--threads", "-1"], "must be an integer from 1 to 1024"),
        (&["--tol", "1e-20"], "rounding errors are not smaller"),
        (&["--tol", "-1e-6"], "must be from 1e-13 to 1"),
        (&["--step", "1"], "longer than the run"),
        (&["--json"], "give --out FILE"),
        (&["--rows", &rows, "--out", &rows], "is the file of --rows itself"),
    ];
    for (more, wanted) in cases {
        let needs_none = more.contains(&"--json") || more.contains(&"--out");
        let into = if needs_none { &[][..] } else { &["--out", &csv] };
        let failed = run_sweep(&[more, into].concat());
        assert_eq!((code(&failed), fs::exists(&csv).unwrap()), (2, false), "{more:?}: {}", errors(&failed));
        assert!(errors(&failed).contains(wanted), "{more:?}: {}", errors(&failed));
    }
    let thrown = "patches/lessons/projectile.json";
    let phases =
        patchcord(&["sweep", thrown, "--vary", "v0=10,30", "--measure", "amplitude:y", "--out", &csv]);
    let wanted =
        "amplitude:y cannot be read if a phase within a run waits for a relay or sets a parameter: use";
    assert_eq!((code(&phases), fs::exists(&csv).unwrap()), (2, false));
    assert!(errors(&phases).contains(wanted), "{}", errors(&phases));
    let nothing = patchcord(&["sweep", FIG_8_16, "--measure", "overload"]);
    assert!(code(&nothing) == 2 && errors(&nothing).contains("no parameter is varied"));
    let unmeasured = patchcord(&["sweep", FIG_8_16, "--vary", "VcL=1e-3,2e-3"]);
    assert!(code(&unmeasured) == 2 && errors(&unmeasured).contains("critical_velocity:[v_i,v_o]"));
    fs::write(&rows, "K\nfast\n").unwrap();
    let unreadable = run_sweep(&["--rows", &rows]);
    assert!(
        code(&unreadable) == 1
            && errors(&unreadable).contains("has \"fast\" instead of a number, in the column K")
    );
    let missing = run_sweep(&["--rows", "nofile.csv"]);
    let error = "error: cannot read nofile.csv: No such file or directory\n";
    assert_eq!((code(&missing), errors(&missing).as_str()), (1, error));
}
