//! The discriminating experiment: if the data cannot distinguish two effects, the search proposes a drive that can.
//!
//! The tests make data with the proposed drive, and search again.

use serde_json::{Value, json};

use super::oscillator::{INTERVAL, measured, patch};
use super::runge_kutta::integrate;
use super::search::document;
use super::{library, noise};
use patchcord_core::circuit::Circuit;
use patchcord_core::ir::Program;
use patchcord_core::patch::{Edit, Patch};
use patchcord_core::solve::{RunSettings, run};
use patchcord_ident::Experiment;
use patchcord_ident::fit::problem::Problem;
use patchcord_ident::report::discriminating_experiment::{experiment_csv, experiment_sentence};
use patchcord_ident::report::labels::effect_label;
use patchcord_ident::report::sentence::verdict_sentence;
use patchcord_ident::search::{Outcome, SearchSettings, Verdict};

/// Positions in m of the oscillator if its drive is delayed by 50 ms.
fn delayed_positions(forces: &[f64]) -> Vec<f64> {
    let points = forces.iter().enumerate().map(|(sample, force)| [INTERVAL * sample as f64, *force]);
    let drive = json!({"kind": "table", "scale": "force", "points": points.collect::<Vec<_>>()});
    let edit = |path: &[&str], value: Value| Edit::at(path.iter().copied(), value);
    let edits = [
        edit(&["drives", "F"], drive),
        edit(&["elements", "DL"], json!({"kind": "delay", "in": "F", "delay": 0.05})),
        edit(&["elements", "BF", "in"], json!("DL")),
    ];
    let patch = Patch::read(patch()).unwrap().with_edits("delayed.json", &edits).unwrap();
    let circuit = Circuit::new(&patch).unwrap_or_else(|report| panic!("{report}"));
    let settings = RunSettings::of(&circuit)
        .unwrap()
        .with_duration(INTERVAL * (forces.len() - 1) as f64)
        .with_step(INTERVAL / 10.0)
        .with_sample_interval(INTERVAL)
        .with_signals(["x"]);
    run(&Program::new(&circuit).unwrap(), &settings).unwrap().values("x").unwrap()
}

/// The search on data of the oscillator with a delayed drive.
fn search_delayed(forces: &[f64]) -> (Experiment, Problem, Outcome) {
    let (experiment, problem) = measured(forces, &delayed_positions(forces));
    let library = library::with_effects(&["actuator-lag", "time-delay", "constant-bias"]);
    let settings = SearchSettings::new(&library).with_threads(2);
    let outcome = patchcord_ident::search::search(&experiment, &problem, &settings, |_| ()).unwrap().unwrap();
    (experiment, problem, outcome)
}

#[test]
#[ignore = "takes several seconds: a whole search"]
fn the_proposed_experiment_distinguishes_a_delay_from_a_lag() {
    let slow_forces: Vec<f64> = (0..2400)
        .map(|sample| INTERVAL * f64::from(sample))
        .map(|time| 20.0 * (2.0 * time).sin() + 10.0 * (3.3 * time).sin())
        .collect();
    let (experiment, problem, outcome) = search_delayed(&slow_forces);
    assert_eq!(outcome.verdict, Verdict::Ambiguous, "{}", verdict_sentence(&outcome));
    let proposal = outcome.discriminating_experiment.as_ref().unwrap();
    assert!(proposal.is_decisive(), "{}", experiment_sentence(proposal));
    let mut effects = proposal.effects.each_ref().map(effect_label);
    effects.sort();
    assert_eq!(effects, ["actuator-lag at F", "time-delay at F"]);
    assert!(
        verdict_sentence(&outcome).contains("these data cannot distinguish them; "),
        "{}",
        verdict_sentence(&outcome)
    );
    let document = document(&experiment, &problem, &outcome);
    let rivals = document["rivals"].as_array().unwrap().iter();
    let tied = rivals.filter(|rival| rival["tied"] == true && rival["step"] == 1).map(|rival| &rival["name"]);
    let named = document["effects"].as_array().unwrap().iter().skip(1).map(|effect| &effect["name"]);
    assert_eq!(
        tied.collect::<Vec<_>>(),
        named.collect::<Vec<_>>(),
        "the tied rival is the second effect of the step"
    );
    // The table has a comment, four units, the names, and a row per sample: time, drive, and the predictions of both
    // effects.
    let csv = experiment_csv(proposal, &experiment.outputs);
    let units: Vec<&str> =
        csv.lines().skip(1).take(4).map(|line| line.rsplit(": ").next().unwrap()).collect();
    assert_eq!(units, ["s", "N", "m", "m"], "{csv}");
    let rows: Vec<Vec<f64>> =
        csv.lines().skip(6).map(|line| line.split(',').map(|cell| cell.parse().unwrap()).collect()).collect();
    assert!(rows.len() == 1200 && rows.iter().all(|row| row.len() == 4));
    // The proposed drive is applied twice: once for training, once for the test.
    let drive = rows.iter().map(|row| row[1]);
    let forces: Vec<f64> = drive.clone().chain(drive).collect();
    let (_, _, repeated) = search_delayed(&forces);
    assert_eq!(repeated.verdict, Verdict::Named, "{}", verdict_sentence(&repeated));
    assert_eq!(repeated.rounds[0].trials[0].candidate.effect, "time-delay");
    assert!(repeated.discriminating_experiment.is_none());
}

/// Data of a table of 1 kg with viscous friction of 1 N s/m and dry friction of 0.1 N. It always moves forward.
fn moved_forward() -> (Experiment, Problem) {
    let force = |time: f64| 0.4 + 0.1 * (2.0 * time).sin() + 0.05 * (5.3 * time).sin();
    let states = integrate([0.0, 0.3], (0.01, 801), |time, [_, v]| [v, force(time) - v - 0.1]);
    assert!(states.iter().all(|[_, v]| *v > 0.05));
    let mut csv = "t,F,x\n".to_owned();
    let mut noise = noise::white(5);
    for (sample, [x, _]) in states.iter().enumerate() {
        let time = 0.01 * sample as f64;
        csv += &format!("{time:e},{:e},{:e}\n", force(time), x + 2e-4 * noise());
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
fn a_drive_that_changes_its_sign_is_proposed_if_the_data_move_in_one_direction() {
    let (mut experiment, problem) = moved_forward();
    experiment.patch =
        experiment.patch.with_edits("base.json", &[Edit::new("parameters/f/value", 1)]).unwrap();
    let library = library::with_effects(&["constant-bias", "coulomb-friction"]);
    let settings = SearchSettings::new(&library).with_threads(2);
    let outcome = patchcord_ident::search::search(&experiment, &problem, &settings, |_| ()).unwrap().unwrap();
    assert_eq!(outcome.verdict, Verdict::Ambiguous, "{}", verdict_sentence(&outcome));
    let proposal = outcome.discriminating_experiment.as_ref().unwrap();
    assert!(proposal.is_decisive() && proposal.reverses_sign, "{}", experiment_sentence(proposal));
    assert!(
        verdict_sentence(&outcome)
            .contains(" would distinguish them if F can change its sign: the predictions differ"),
        "{}",
        verdict_sentence(&outcome)
    );
}
