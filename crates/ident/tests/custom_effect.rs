//! An effect that is not in the shipped library: a file adds it, and the search then finds it.

use std::fs;

use super::oscillator::{INTERVAL, measured};
use super::runge_kutta::integrate;
use super::search::document;
use patchcord_ident::effects::Library;
use patchcord_ident::report::sentence::verdict_sentence;
use patchcord_ident::search::SearchSettings;

/// Positions in m of a mass of 3 kg on a spring of 500 N/m and k2 x^2, with damping of 5 N s/m.
///
/// The force in N is interpolated linearly between its samples. The mass starts at rest at 0.
fn positions(k2: f64, forces: &[f64]) -> Vec<f64> {
    let force = |time: f64| {
        let index = ((time / INTERVAL) as usize).min(forces.len() - 2);
        forces[index] + (time / INTERVAL - index as f64) * (forces[index + 1] - forces[index])
    };
    let rates = |time: f64, [x, v]: [f64; 2]| [v, (force(time) - 500.0 * x - k2 * x * x - 5.0 * v) / 3.0];
    integrate([0.0; 2], (INTERVAL, forces.len()), rates).into_iter().map(|[x, _]| x).collect()
}

#[test]
#[ignore = "takes several seconds: a whole search"]
fn the_effect_of_the_format_page_is_found_after_its_file_is_added() {
    let page = fs::read_to_string("../../docs/effect-format.md").unwrap();
    let effect = page.split("```json\n").nth(1).and_then(|rest| rest.split("```").next()).unwrap();
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("square-stiffness.json"), effect).unwrap();
    let library = Library::shipped().with_folder(folder.path()).unwrap_or_else(|error| panic!("{error}"));
    let times = (0..2400).map(|sample| INTERVAL * f64::from(sample));
    let forces: Vec<f64> = times.map(|time| 20.0 * (9.0 * time).sin() + 20.0 * (5.3 * time).sin()).collect();
    let k2 = 800.0;
    let (experiment, problem) = measured(&forces, &positions(k2, &forces));
    let settings = SearchSettings::new(&library).with_threads(2);
    let outcome = patchcord_ident::search::search(&experiment, &problem, &settings, |_| ()).unwrap().unwrap();
    assert_eq!(verdict_sentence(&outcome), "square-stiffness at IV is missing");
    let parameter = &document(&experiment, &problem, &outcome)["effects"][0]["parameters"]["k2"];
    assert_eq!(parameter["unit"], "N/m2");
    assert!((parameter["value"].as_f64().unwrap() / k2 - 1.0).abs() < 0.03, "{parameter}");
}
