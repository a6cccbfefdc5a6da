//! Runs with phases: printed text, records and pictures.

use std::fs;

use serde_json::Value;

use super::{code, errors, json, out, patchcord, path, spring_with};

/// The spring with a relay that drops out when the position passes 0, and these phases.
fn spring_with_phases(phases: &str) -> (tempfile::TempDir, String) {
    let relay = r#""K1": {"kind": "relay", "in": "B1", "on": "+100", "off": "-100", "pull_in": 0.01, "drop_out": 0},
    "B1": {"kind""#;
    let (folder, file) = spring_with("\"B1\": {\"kind\"", relay);
    let text = fs::read_to_string(&file).unwrap();
    let parameter =
        r#""parameters": {"w": {"value": 0.394784176, "unit": "1", "range": [0.1, 0.9]}}, "scales""#;
    let text =
        text.replace("\"scales\"", parameter).replace("\"setting\": 0.394784176", "\"setting\": \"w\"");
    let run = format!("{{\"step\": 1e-3, \"every\": 0.1, \"phases\": [{phases}]}}");
    fs::write(&file, text.replace("{\"for\": 3.25, \"step\": 1e-3}", &run)).unwrap();
    (folder, file)
}

/// A quarter of a period of 1 s, a hold, and a run with a softer spring.
const QUARTER: &str = r#"{"operate": 5, "until": {"relay": "K1", "becomes": "released"}}, {"hold": 0.5},
    {"initial_condition": true}, {"set": {"w": 0.2}}, {"operate": 0.15, "until": "K1"}"#;

#[test]
fn phases_are_printed_recorded_and_drawn() {
    let (folder, file) = spring_with_phases(QUARTER);
    let [csv, svg] = ["out.csv", "out.svg"].map(|name| path(&folder, name));
    let ran = patchcord(&["run", &file, "--csv", &csv, "--plot", &svg]);
    assert_eq!((code(&ran), errors(&ran).as_str()), (0, ""));
    let text = out(&ran);
    let lines: Vec<String> =
        text.lines().map(|line| line.split_whitespace().collect::<Vec<_>>().join(" ")).collect();
    for line in [
        "1 1 0.000000 0.000000 initial condition",
        "2 1 0.000000 0.250000 operate until K1 becomes released K1 released",
        "3 1 0.250000 0.750000 hold time",
        "5 2 0.000000 0.000000 w = 0.2",
        "warning: phase 6: K1 did not switch within 0.15 s",
    ] {
        assert!(lines.iter().any(|found| found == line), "{line}\n{text}");
    }
    let table = fs::read_to_string(&csv).unwrap();
    let rows: Vec<Vec<&str>> =
        table.lines().filter(|line| !line.starts_with('#')).map(|line| line.split(',').collect()).collect();
    assert_eq!(rows[0], ["t", "x", "run", "phase"]);
    let phases: Vec<_> = rows[1..].iter().map(|row| (row[2], row[3])).collect();
    assert_eq!(phases, [[("1", "2"); 4].as_slice(), &[("1", "3"); 7], &[("2", "6"); 3]].concat());
    let ends = [11, 14].map(|row| rows[row][0].parse::<f64>().unwrap());
    assert!((ends[0] - 0.75).abs() < 1e-6 && ends[1] == 0.15, "{table}");
    assert!(rows[4..12].iter().all(|row| row[1] == rows[4][1]), "{table}");
    assert!(fs::read_to_string(&svg).unwrap().contains(">\nhold\n</text>"));
}

#[test]
fn json_lists_the_phases_with_their_ends() {
    let (_folder, file) = spring_with_phases(QUARTER);
    let text = json(&patchcord(&["run", &file, "--json"]));
    let phases = text["phases"].as_array().unwrap();
    let what: Vec<_> =
        phases.iter().map(|phase| (phase["what"].as_str().unwrap(), &phase["ended_by"])).collect();
    let (none, time, relay) = (&Value::Null, &"time".into(), &"relay".into());
    assert_eq!(
        what,
        [
            ("initial_condition", none),
            ("operate", relay),
            ("hold", time),
            ("initial_condition", none),
            ("set", none),
            ("operate", time)
        ]
    );
    assert!((phases[1]["end"].as_f64().unwrap() - 0.25).abs() < 1e-6, "{text}");
    assert_eq!((&phases[1]["until"]["became"], &phases[5]["until"]["became"]), (&"released".into(), none));
    assert_eq!((&phases[4]["set"][0]["name"], &phases[4]["set"][0]["value"]), (&"w".into(), &0.2.into()));
    assert_eq!((&text["run"]["repeat"], &phases[3]["run"]), (&2.into(), &2.into()));
    let plain = json(&patchcord(&["run", &file, "--for", "0.2", "--json"]));
    assert_eq!((plain["phases"].as_array().unwrap().len(), &plain["run"]["for"]), (2, &0.2.into()));
}

#[test]
fn every_run_has_its_own_readings() {
    let (_folder, file) = spring_with_phases(QUARTER);
    let text = json(&patchcord(&["run", &file, "--json"]));
    let ends: Vec<f64> =
        text["readings"].as_array().unwrap().iter().map(|reading| reading["end"].as_f64().unwrap()).collect();
    // A quarter of a period of 1 s, and 0.15 s with half the stiffness: 50 mm cos(0.15 sqrt(0.2) x 10).
    assert!(ends[0].abs() < 1e-6 && (ends[1] - 50.0 * (1.5 * 0.2f64.sqrt()).cos()).abs() < 1e-6, "{ends:?}");
    assert_eq!((ends.len(), &text["readings"][1]["run"]), (2, &2.into()));
    let shown = out(&patchcord(&["run", &file]));
    let lines: Vec<Vec<&str>> = shown.lines().map(|line| line.split_whitespace().collect()).collect();
    assert!(
        lines.contains(&"run signal unit start end least at s most at s".split(' ').collect()),
        "{shown}"
    );
    assert!(lines.contains(&"2 x mm 50 39.17 39.17 0.15 50 0".split(' ').collect()), "{shown}");
    let plain = out(&patchcord(&["run", &file, "--for", "0.25"]));
    assert!(plain.contains("\nsignal  unit  start"), "{plain}");
    let many = out(&patchcord(&[
        "run", &file, "--for", "0.01", "--step", "0.01", "--every", "0.01", "--repeat", "50",
    ]));
    assert!(many.contains("\nand 10 more runs: see --json\n"), "{many}");
}

#[test]
fn options_that_conflict_with_phases_return_errors() {
    let (_folder, file) = spring_with_phases(QUARTER);
    let ran = patchcord(&["run", &file, "--repeat", "2"]);
    assert_eq!((code(&ran), out(&ran).as_str()), (2, ""));
    assert!(errors(&ran).contains("or give --for as well"), "{}", errors(&ran));
    let ran = patchcord(&["run", &file, "--repeat", "2", "--for", "0.1"]);
    assert_eq!(code(&ran), 0, "{}", errors(&ran));
    assert!(!out(&ran).contains("phase") && !out(&ran).contains("hold"), "{}", out(&ran));
    for options in [["--every", "9"], ["--step", "9"], ["--every", "1e-9"]] {
        assert_eq!(code(&patchcord(&[&["run", &file][..], &options].concat())), 2, "{options:?}");
    }
}

#[test]
fn a_phase_that_cannot_be_run_is_reported() {
    let (folder, file) = spring_with_phases(
        r#"{"operate": 0.25}, {"set": {"w": "w * x / x"}}, {"operate": 0.25},
        {"set": {"w": "w * (1 + x * x / x / x)"}}, {"operate": 1}"#,
    );
    let text = fs::read_to_string(&file).unwrap().replace("\"initial\": -50", "\"initial\": 0");
    fs::write(&file, text).unwrap();
    let csv = path(&folder, "out.csv");
    let ran = patchcord(&["run", &file, "--csv", &csv]);
    assert_eq!((code(&ran), out(&ran).as_str()), (1, ""));
    assert!(errors(&ran).contains("\nerror: phase 3 (set): w cannot be set to"), "{}", errors(&ran));
    assert!(errors(&ran).contains("the denominator x is 0"), "{}", errors(&ran));
    assert!(errors(&ran).contains("the files contain the run up to t = 0.25 s"), "{}", errors(&ran));
    assert!(fs::read_to_string(&csv).unwrap().lines().last().unwrap().starts_with("0.25,"));
}
