//! An effect that the program does not have: adding it is adding a file, and then it is found.

use std::fs;

use patchcord::gap::effect::Library;
use patchcord::gap::search::Means;

use super::oscillator::{INTERVAL, measured};

/// Steps from sample to sample.
const STEPS: u32 = 10;

/// Where a mass of 3 kg stands on a spring of 500 N/m, with damping of 5 N s/m and a pull of k2 x^2: Runge and Kutta.
fn askew(k2: f64, forces: &[f64]) -> Vec<f64> {
    let rates = |[x, v]: [f64; 2], force: f64| [v, (force - 500.0 * x - k2 * x * x - 5.0 * v) / 3.0];
    let on = |[x, v]: [f64; 2], [dx, dv]: [f64; 2], by: f64| [x + by * dx, v + by * dv];
    let (mut state, h) = ([0.0, 0.0], INTERVAL / f64::from(STEPS));
    let mut stood = vec![0.0];
    for pair in forces.windows(2) {
        for step in 0..STEPS {
            let force = |part: f64| {
                let share = (f64::from(step) + part) / f64::from(STEPS);
                pair[0] + share * (pair[1] - pair[0])
            };
            let first = rates(state, force(0.0));
            let second = rates(on(state, first, h / 2.0), force(0.5));
            let third = rates(on(state, second, h / 2.0), force(0.5));
            let fourth = rates(on(state, third, h), force(1.0));
            for (place, own) in state.iter_mut().enumerate() {
                *own += h / 6.0 * (first[place] + 2.0 * second[place] + 2.0 * third[place] + fourth[place]);
            }
        }
        stood.push(state[0]);
    }
    stood
}

#[test]
fn the_effect_of_the_page_is_added_as_a_file_and_found() {
    let page = fs::read_to_string("docs/effect-format.md").unwrap();
    let effect = page.split("```json\n").nth(1).and_then(|rest| rest.split("```").next()).unwrap();
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("square-stiffness.json"), effect).unwrap();
    let library = Library::shipped().and_folder(folder.path()).unwrap_or_else(|error| panic!("{error}"));
    let times = (0..2400).map(|sample| INTERVAL * f64::from(sample));
    let forces: Vec<f64> = times.map(|time| 20.0 * (9.0 * time).sin() + 20.0 * (5.3 * time).sin()).collect();
    let k2 = 800.0;
    let (experiment, problem) = measured(&forces, &askew(k2, &forces));
    let with = Means { library: &library, threads: 2, seed: 1 };
    let found = problem.search(&experiment.patch, &experiment.fit, &with, |_| ()).unwrap().unwrap();
    assert_eq!(found.sentence(), "square-stiffness at IV is missing");
    let told = &found.document(&problem)["effects"][0]["parameters"]["k2"];
    assert_eq!(told["unit"], "N/m2");
    assert!((told["value"].as_f64().unwrap() / k2 - 1.0).abs() < 0.03, "{told}");
}
