//! An effect that the program does not have: adding it is adding a file, and then it is found.

use std::fs;

use super::integrated::integrated;
use super::oscillator::{INTERVAL, measured};
use super::search::document;
use patchcord_ident::effects::Library;
use patchcord_ident::report::sentence::verdict_sentence;
use patchcord_ident::search::Means;

/// Where a mass of 3 kg stands on a spring of 500 N/m, with damping of 5 N s/m and a pull of k2 x^2, under a force that goes
/// straight from sample to sample.
fn askew(k2: f64, forces: &[f64]) -> Vec<f64> {
    let force = |time: f64| {
        let before = ((time / INTERVAL) as usize).min(forces.len() - 2);
        forces[before] + (time / INTERVAL - before as f64) * (forces[before + 1] - forces[before])
    };
    let rates = |time: f64, [x, v]: [f64; 2]| [v, (force(time) - 500.0 * x - k2 * x * x - 5.0 * v) / 3.0];
    integrated([0.0; 2], (INTERVAL, forces.len()), rates).into_iter().map(|[x, _]| x).collect()
}

#[test]
#[ignore = "takes several seconds: a whole search"]
fn the_effect_of_the_page_is_added_as_a_file_and_found() {
    let page = fs::read_to_string("../../docs/effect-format.md").unwrap();
    let effect = page.split("```json\n").nth(1).and_then(|rest| rest.split("```").next()).unwrap();
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("square-stiffness.json"), effect).unwrap();
    let library = Library::shipped().and_folder(folder.path()).unwrap_or_else(|error| panic!("{error}"));
    let times = (0..2400).map(|sample| INTERVAL * f64::from(sample));
    let forces: Vec<f64> = times.map(|time| 20.0 * (9.0 * time).sin() + 20.0 * (5.3 * time).sin()).collect();
    let k2 = 800.0;
    let (experiment, problem) = measured(&forces, &askew(k2, &forces));
    let with = Means { library: &library, threads: 2, seed: 1 };
    let found = patchcord_ident::search::search(&problem, &experiment.patch, &experiment.fit, &with, |_| ())
        .unwrap()
        .unwrap();
    assert_eq!(verdict_sentence(&found), "square-stiffness at IV is missing");
    let told = &document(&problem, &found)["effects"][0]["parameters"]["k2"];
    assert_eq!(told["unit"], "N/m2");
    assert!((told["value"].as_f64().unwrap() / k2 - 1.0).abs() < 0.03, "{told}");
}
