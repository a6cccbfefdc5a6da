//! `patchcord sweep`.

use std::fs;

use super::{FIG_8_16, code, errors, json, out, patchcord, path};

const SHORT: [&str; 8] =
    ["--vary", "VcL=1e-3,2e-3", "--for", "0.3", "--measure", "peak:v_o", "--measure", "overload"];

fn swept(more: &[&str]) -> std::process::Output {
    patchcord(&[&["sweep", FIG_8_16], &SHORT[..], more].concat())
}

#[test]
fn rows_go_to_standard_output_or_into_a_file() {
    let folder = tempfile::tempdir().unwrap();
    let csv = path(&folder, "sweep.csv");
    let shown = swept(&[]);
    assert_eq!((code(&shown), errors(&shown).as_str()), (0, ""));
    let lines = out(&shown);
    assert!(lines.starts_with("# patchcord ") && lines.contains("\n# VcL: m/s\n"), "{lines}");
    assert!(lines.contains("\nVcL,peak:v_o,overload,overload_time,error,note\n0.001,0.00"), "{lines}");
    let written = swept(&["--out", &csv]);
    assert_eq!(out(&written), format!("2 runs: 0 failed, 0 with a note\nwrote {csv}\n"));
    assert_eq!(fs::read_to_string(&csv).unwrap(), lines);
    let by_itself = json(&swept(&["--out", &path(&folder, "more.csv"), "--json"]));
    assert_eq!(by_itself["sweep"]["threads"], std::thread::available_parallelism().unwrap().get());
    let again = json(&swept(&["--out", &csv, "--json", "--threads", "1"]));
    assert_eq!(again["sweep"]["threads"], 1);
    let tally = ["runs", "kept", "written", "failed"].map(|key| again["sweep"][key].as_u64().unwrap());
    assert_eq!(tally, [2, 2, 0, 0]);
    assert_eq!(again["sweep"]["columns"][1], serde_json::json!({"name": "peak:v_o", "unit": "m/s"}));
    assert_eq!(fs::read_to_string(&csv).unwrap(), lines);
}

#[test]
fn rows_of_a_file_are_run_with_every_value_of_an_axis() {
    let folder = tempfile::tempdir().unwrap();
    let rows = path(&folder, "rows.csv");
    fs::write(&rows, "# K: N/m\nK,M\n20e6,300\n45e6,433\n").unwrap();
    let shown = out(&swept(&["--rows", &rows]));
    let begins: Vec<_> =
        shown.lines().filter(|line| line.starts_with(|c: char| c.is_ascii_digit())).collect();
    let expected =
        ["20000000,300,0.001,", "20000000,300,0.002,", "45000000,433,0.001,", "45000000,433,0.002,"];
    assert_eq!(begins.len(), 4, "{shown}");
    assert!(begins.iter().zip(expected).all(|(row, begin)| row.starts_with(begin)), "{shown}");
}

#[test]
fn a_table_of_another_sweep_is_left_as_it_is() {
    let folder = tempfile::tempdir().unwrap();
    let csv = path(&folder, "sweep.csv");
    assert_eq!(code(&swept(&["--out", &csv])), 0);
    let before = fs::read(&csv).unwrap();
    for other in [&["--set", "K=40e6"][..], &["--tol", "1e-6"], &["--measure", "stick_end"]] {
        let refused = swept(&[&["--out", &csv], other].concat());
        assert_eq!(code(&refused), 1, "{other:?}");
        assert!(errors(&refused).contains("is not the table of this sweep, and was left as it is: line "));
        assert!(fs::read(&csv).unwrap() == before);
    }
}

/// A patch whose drive stands in a table beside it, in a folder with a file of rows.
fn driven() -> tempfile::TempDir {
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

/// What is told of the table of the driven patch when words in a file have become others, or options are given.
fn gone_on(file: &str, from: &str, to: &str, options: &str) -> String {
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
    let told = errors(&patchcord(&[&command, &options[..]].concat()));
    assert!(fs::read(&csv).unwrap() == before);
    told
}

#[test]
fn what_changed_since_a_table_was_begun_is_told() {
    let cases = [
        ("driven.json", "inverter", "absolute", "", "left as it is: the patch changed since; line "),
        ("u.csv", "1,50", "1,60", "", "left as it is: the patch's tables changed since; line "),
        ("k.csv", "0.2", "0.3", "", "left as it is: the file of rows changed since; line "),
        ("k.csv", "", "", "--backend reference", "and this sweep has \"# backend: reference\" there"),
        ("k.csv", "", "", "--backend reference --tol 1e-6", "tolerance 1e-6, recorded every 0.01 s\" there"),
    ];
    for (file, from, to, options, wanted) in cases {
        let told = gone_on(file, from, to, options);
        assert!(told.contains(wanted), "{told}");
    }
    assert_eq!(gone_on("k.csv", "", "", "--backend interpreter"), "");
}

#[test]
fn a_table_that_another_sweep_is_writing_is_left_to_it() {
    let folder = tempfile::tempdir().unwrap();
    let csv = path(&folder, "sweep.csv");
    let other = fs::File::create(&csv).unwrap();
    other.lock().unwrap();
    let refused = swept(&["--out", &csv]);
    let told =
        format!("error: another sweep is writing {csv}: wait until it is done, or give another file\n");
    assert_eq!((code(&refused), errors(&refused)), (1, told));
    assert_eq!(fs::read(&csv).unwrap(), b"");
    drop(other);
    assert_eq!(code(&swept(&["--out", &csv])), 0);
}

#[test]
fn a_wrong_command_line_ends_with_2_before_any_run() {
    let folder = tempfile::tempdir().unwrap();
    let (csv, rows) = (path(&folder, "sweep.csv"), path(&folder, "rows.csv"));
    fs::write(&rows, "K\n20e6\n").unwrap();
    let cases: &[(&[&str], &str)] = &[
        (&["--vary", "VcL=1e-3:2e-3:3"], "VcL is varied twice"),
        (&["--vary", "Tc=5"], "Tc = 5 s is outside its range 0.001 ... 1 s"),
        (&["--vary", "Tcc=0.5"], "did you mean \"Tc\"?"),
        (&["--vary", "Tc=1:2"], "\"Tc=1:2\" gives no values"),
        (&["--set", "VcL=1e-3"], "VcL is set and varied"),
        (&["--measure", "peek:v_o"], "did you mean \"peak\"?"),
        (&["--measure", "peak:v_o"], "two columns would be called peak:v_o"),
        (&["--threads", "0"], "--threads"),
        (&["--threads", "-1"], "a whole number from 1 to 1024 is wanted"),
        (&["--tol", "1e-20"], "the rounding of numbers is no smaller"),
        (&["--tol", "-1e-6"], "a number from 1e-13 to 1 is wanted"),
        (&["--step", "1"], "longer than the run"),
        (&["--json"], "give --out FILE"),
        (&["--rows", &rows, "--out", &rows], "holds the settings to run"),
    ];
    for (more, told) in cases {
        let needs_none = more.contains(&"--json") || more.contains(&"--out");
        let into = if needs_none { &[][..] } else { &["--out", &csv] };
        let refused = swept(&[more, into].concat());
        assert_eq!((code(&refused), fs::exists(&csv).unwrap()), (2, false), "{more:?}: {}", errors(&refused));
        assert!(errors(&refused).contains(told), "{more:?}: {}", errors(&refused));
    }
    let thrown = "patches/lessons/projectile.json";
    let phases =
        patchcord(&["sweep", thrown, "--vary", "v0=10,30", "--measure", "amplitude:y", "--out", &csv]);
    let told = "amplitude:y cannot be read of a run within which a phase waits for a relay or sets a parameter: measure";
    assert_eq!((code(&phases), fs::exists(&csv).unwrap()), (2, false));
    assert!(errors(&phases).contains(told), "{}", errors(&phases));
    let nothing = patchcord(&["sweep", FIG_8_16, "--measure", "overload"]);
    assert!(code(&nothing) == 2 && errors(&nothing).contains("nothing is varied"));
    let unmeasured = patchcord(&["sweep", FIG_8_16, "--vary", "VcL=1e-3,2e-3"]);
    assert!(code(&unmeasured) == 2 && errors(&unmeasured).contains("critical_velocity:[v_i,v_o]"));
    fs::write(&rows, "K\nfast\n").unwrap();
    let unreadable = swept(&["--rows", &rows]);
    assert!(code(&unreadable) == 1 && errors(&unreadable).contains("line 2 has \"fast\""));
    let missing = swept(&["--rows", "nofile.csv"]);
    let told = "error: cannot read nofile.csv: No such file or directory\n";
    assert_eq!((code(&missing), errors(&missing).as_str()), (1, told));
}
