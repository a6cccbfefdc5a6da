//! `patchcord check` on patches with macros.

use super::{code, errors, json, out, patchcord};

const LAGS: &str = "crates/core/tests/patches/lags-in-macros.json";

#[test]
fn check_lists_macros_with_their_instances() {
    let checked = patchcord(&["check", LAGS]);
    assert_eq!(code(&checked), 0);
    assert!(errors(&checked).contains("L.B1 has no scale and is recorded in volts"), "{}", errors(&checked));
    let report = out(&checked);
    assert!(report.contains("7 summers, 3 integrators, 4 fixed pots"), "{report}");
    assert!(report.contains("macro lag-8-15: W.first, W.second, L\nmacro two-lags: W\n"), "{report}");
}

#[test]
fn json_lists_ports_and_elements_of_instances() {
    let report = json(&patchcord(&["check", LAGS, "--json"]));
    let outer = &report["macros"][1]["instances"][0];
    assert_eq!((&report["macros"][1]["macro"], &outer["name"]), (&"two-lags".into(), &"W".into()));
    assert_eq!(outer["inputs"]["in"], "P");
    assert_eq!(outer["outputs"]["between"], "W.first.A1");
    assert_eq!(outer["elements"].as_array().unwrap().len(), 9);
}

#[test]
fn parameters_reach_into_macros() {
    let settings = |changes: &[&str]| {
        let report = json(&patchcord(&[&["check", LAGS, "--json"], changes].concat()));
        let volts = report["voltages"].as_array().unwrap().clone();
        volts.iter().find(|read| read["element"] == "W.first.PA1").unwrap()["volts"].as_f64().unwrap()
    };
    // The input of PA1 is -25 V, its setting 0.001 s / T1.
    assert_eq!((settings(&[]), settings(&["--set", "T1=100"])), (-1.25, -0.25));
}

#[test]
fn a_port_is_recorded_as_its_element() {
    let ran = json(&patchcord(&[
        "run",
        "patches/lessons/heat-rod.json",
        "--for",
        "5",
        "--record",
        "C1.u,C2",
        "--json",
    ]));
    let names: Vec<_> = ran["readings"].as_array().unwrap().iter().map(|read| &read["signal"]).collect();
    assert_eq!(names, ["C1.A", "C2.P"]);
}
