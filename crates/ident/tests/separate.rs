//! The experiment that tells two effects apart: where data cannot, data that it makes do.

use serde_json::{Value, json};

use super::integrated::integrated;
use super::oscillator::{INTERVAL, measured, patch};
use super::search::document;
use super::{library, noise};
use patchcord_core::circuit::Circuit;
use patchcord_core::ir::Program;
use patchcord_core::patch::{Edit, Patch};
use patchcord_core::solve::{RunSettings, run};
use patchcord_ident::Experiment;
use patchcord_ident::fit::problem::Problem;
use patchcord_ident::report::discriminating_experiment::{experiment_csv, experiment_sentence};
use patchcord_ident::report::sentence::verdict_sentence;
use patchcord_ident::search::{Means, Outcome, Verdict};

/// Where the oscillator stands whose drive comes 50 ms late.
fn late(forces: &[f64]) -> Vec<f64> {
    let points = forces.iter().enumerate().map(|(sample, force)| [INTERVAL * sample as f64, *force]);
    let drive = json!({"kind": "table", "scale": "force", "points": points.collect::<Vec<_>>()});
    let edit = |path: &[&str], value: Value| Edit {
        path: path.iter().map(|part| (*part).to_owned()).collect(),
        value,
    };
    let edits = [
        edit(&["drives", "F"], drive),
        edit(&["elements", "DL"], json!({"kind": "delay", "in": "F", "delay": 0.05})),
        edit(&["elements", "BF", "in"], json!("DL")),
    ];
    let patch = Patch::read(&patch()).unwrap().edited("late.json", &edits).unwrap();
    let circuit = Circuit::new(&patch, &[]).unwrap_or_else(|report| panic!("{report}"));
    let settings = RunSettings {
        step: INTERVAL / 10.0,
        every: INTERVAL,
        record: vec!["x".to_owned()],
        ..RunSettings::of(&circuit).unwrap().lasting(INTERVAL * (forces.len() - 1) as f64)
    };
    run(&Program::new(&circuit).unwrap(), &settings).unwrap().values("x").unwrap()
}

/// What the search makes of a drive that comes late.
fn searched(forces: &[f64]) -> (Experiment, Problem, Outcome) {
    let (experiment, problem) = measured(forces, &late(forces));
    let library = library::of(&["actuator-lag", "time-delay", "constant-bias"]);
    let with = Means { library: &library, threads: 2, seed: 1 };
    let found = patchcord_ident::search::search(&problem, &experiment.patch, &experiment.fit, &with, |_| ())
        .unwrap()
        .unwrap();
    (experiment, problem, found)
}

#[test]
#[ignore = "takes several seconds: a whole search"]
fn what_slow_drives_cannot_tell_the_experiment_does() {
    let slow: Vec<f64> = (0..2400)
        .map(|sample| INTERVAL * f64::from(sample))
        .map(|time| 20.0 * (2.0 * time).sin() + 10.0 * (3.3 * time).sin())
        .collect();
    let (experiment, problem, found) = searched(&slow);
    assert_eq!(found.verdict, Verdict::Ambiguous, "{}", verdict_sentence(&found));
    let separating = found.separating.as_ref().unwrap();
    assert!(separating.tells(), "{}", experiment_sentence(separating));
    let mut both = separating.from.clone();
    both.sort();
    assert_eq!(both, ["actuator-lag at F", "time-delay at F"]);
    assert!(verdict_sentence(&found).contains("these data cannot tell; "), "{}", verdict_sentence(&found));
    let document = document(&problem, &found);
    let rivals = document["rivals"].as_array().unwrap().iter();
    let tied = rivals.filter(|rival| rival["tied"] == true && rival["step"] == 1).map(|rival| &rival["name"]);
    let named = document["effects"].as_array().unwrap().iter().skip(1).map(|effect| &effect["name"]);
    assert_eq!(tied.collect::<Vec<_>>(), named.collect::<Vec<_>>(), "the other of the two");
    // A line of what it is, the units, a line of names, and one for every sample: time, drive, what either predicts.
    let csv = experiment_csv(separating, &experiment.outputs);
    let units: Vec<&str> =
        csv.lines().skip(1).take(4).map(|line| line.rsplit(": ").next().unwrap()).collect();
    assert_eq!(units, ["s", "N", "m", "m"], "{csv}");
    let rows: Vec<Vec<f64>> =
        csv.lines().skip(6).map(|line| line.split(',').map(|cell| cell.parse().unwrap()).collect()).collect();
    assert!(rows.len() == 1200 && rows.iter().all(|row| row.len() == 4));
    // The drive made twice: once to train, once to test.
    let once = rows.iter().map(|row| row[1]);
    let forces: Vec<f64> = once.clone().chain(once).collect();
    let (_, _, told) = searched(&forces);
    assert_eq!(told.verdict, Verdict::Named, "{}", verdict_sentence(&told));
    assert_eq!(told.rounds[0].trials[0].candidate.effect, "time-delay");
    assert!(told.separating.is_none());
}

/// A table of 1 kg with viscous friction of 1 N s/m and dry friction of 0.1 N, pushed forward all the time.
fn pushed() -> (Experiment, Problem) {
    let push = |time: f64| 0.4 + 0.1 * (2.0 * time).sin() + 0.05 * (5.3 * time).sin();
    let stood = integrated([0.0, 0.3], (0.01, 801), |time, [_, v]| [v, push(time) - v - 0.1]);
    assert!(stood.iter().all(|[_, v]| *v > 0.05));
    let mut csv = "t,F,x\n".to_owned();
    let mut noise = noise::white(5);
    for (sample, [x, _]) in stood.iter().enumerate() {
        let time = 0.01 * sample as f64;
        csv += &format!("{time:e},{:e},{:e}\n", push(time), x + 2e-4 * noise());
    }
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("data.csv"), csv).unwrap();
    let patch = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/base.json");
    let experiment = json!({
        "patch": patch, "data": "data.csv", "drives": {"F": {"column": "F", "sigma": 0}},
        "outputs": {"x": {"column": "x", "sigma": 2e-4}}, "fit": ["M"],
    });
    let experiment = Experiment::parse_in(folder.path(), "experiment.json", &experiment.to_string());
    let experiment = experiment.unwrap_or_else(|error| panic!("{error}"));
    let problem = Problem::of(&experiment).unwrap();
    (experiment, problem)
}

#[test]
#[ignore = "takes several seconds: a whole search"]
fn what_motion_one_way_cannot_tell_a_drive_that_turns_does() {
    let (experiment, problem) = pushed();
    let patch = experiment.patch.edited("base.json", &[Edit::new("parameters/f/value", 1)]).unwrap();
    let library = library::of(&["constant-bias", "coulomb-friction"]);
    let with = Means { library: &library, threads: 2, seed: 1 };
    let found =
        patchcord_ident::search::search(&problem, &patch, &experiment.fit, &with, |_| ()).unwrap().unwrap();
    assert_eq!(found.verdict, Verdict::Ambiguous, "{}", verdict_sentence(&found));
    let separating = found.separating.as_ref().unwrap();
    assert!(separating.tells() && separating.turns, "{}", experiment_sentence(separating));
    assert!(
        verdict_sentence(&found).contains(" would, if F can change its sign: they differ"),
        "{}",
        verdict_sentence(&found)
    );
}
