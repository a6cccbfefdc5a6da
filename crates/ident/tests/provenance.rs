//! The patches that a search leaves: they begin as the data do, and tell where they come from.

use std::fs;
use std::sync::LazyLock;

use serde_json::{Value, json};

use crate::page::HILL;
use crate::search::searched;
use patchcord_core::circuit::Circuit;
use patchcord_core::document::Phase;
use patchcord_core::ir::Program;
use patchcord_core::patch::{Edit, Patch};
use patchcord_core::solve::{self, RunSettings};
use patchcord_ident::Experiment;
use patchcord_ident::fit::problem::Problem;
use patchcord_ident::report::Report;
use patchcord_ident::report::provenance::fitted_patch;
use patchcord_ident::search::Outcome;

/// What a patch leaves of the first training record when it is run as it stands, fed with the data: rms over the noise.
fn left(patch: Patch, experiment: &Experiment, sigma: &[f64]) -> f64 {
    let experiment = Experiment { patch, ..experiment.clone() };
    let circuit = Circuit::new(&experiment.patch_to_feed().unwrap(), &[]).unwrap();
    let mut program = Program::new(&circuit).unwrap();
    let record = &experiment.train[0];
    for (feed, values) in experiment.drives.iter().zip(&record.drives) {
        let points =
            values.iter().enumerate().map(|(sample, value)| [sample as f64 * record.interval, *value]);
        solve::set_drive_table(&mut program, &feed.drive, points.collect()).unwrap();
    }
    let outputs: Vec<String> = experiment.outputs.iter().map(|output| output.signal.clone()).collect();
    let settings = RunSettings {
        phases: vec![Phase::InitialCondition, Phase::operate(record.duration())],
        step: record.interval / 4.0,
        every: record.interval,
        record: outputs.clone(),
        ..RunSettings::of(&circuit).unwrap()
    };
    let trace = solve::run(&program, &settings).unwrap();
    let mut squares = Vec::new();
    for ((name, data), sigma) in outputs.iter().zip(&record.outputs).zip(sigma) {
        let pairs = trace.values(name).unwrap().into_iter().zip(data);
        squares.extend(pairs.map(|(model, datum)| ((datum - model) / sigma).powi(2)));
    }
    (squares.iter().sum::<f64>() / squares.len() as f64).sqrt()
}

/// A constant inflow into a tank that its patch lacks.
static BIAS: LazyLock<(Experiment, Problem, Outcome, Value)> = LazyLock::new(|| searched("bias", 2));

fn note(patch: &Patch) -> &str {
    patch.value()["note"].as_str().unwrap()
}

#[test]
#[ignore = "takes several seconds: a whole search"]
fn an_augmented_patch_runs_as_the_data_do_and_says_why() {
    let (experiment, problem, found, _) = &*BIAS;
    let report = Report::new(experiment, problem, found);
    let fitted = report.fitted("fitted.json").unwrap();
    let augmented = report.augmented("augmented.json").unwrap().unwrap();
    let [before, after] = [&fitted, &augmented].map(|own| left(own.clone(), experiment, &problem.sigma));
    let [wanted_before, wanted_after] = [&found.base, found.told()].map(|stage| stage.train.over_noise());
    assert!((before / wanted_before - 1.0).abs() < 0.01, "{before} {wanted_before}");
    assert!((after / wanted_after - 1.0).abs() < 0.01, "{after} {wanted_after}");
    let (told, own) = (note(&augmented), note(&experiment.patch));
    for part in [experiment.patch.file(), "train.csv", &found.rounds[0].trials[0].named(), "(95 %: ", own] {
        assert!(told.contains(part), "{part}: {told}");
    }
    assert!(note(&fitted).contains("train.csv") && !note(&fitted).contains("95 %"));
    assert!(report.recovered("recovered.json").unwrap().is_none());
}

#[test]
#[ignore = "takes several seconds: a whole search"]
fn a_recovered_patch_runs_as_the_data_do_and_nothing_is_augmented() {
    let (experiment, problem, found) = &*HILL;
    let report = Report::new(experiment, problem, found);
    assert!(report.augmented("augmented.json").unwrap().is_none());
    let recovered = report.recovered("recovered.json").unwrap().unwrap();
    let after = left(recovered.clone(), experiment, &problem.sigma);
    assert!(after < 0.3 * found.base.train.over_noise(), "{after}");
    assert!(note(&recovered).contains("a function of x"), "{}", note(&recovered));
}

#[test]
#[ignore = "takes several seconds: a whole search"]
fn tables_in_files_are_found_from_where_the_patch_goes() {
    let (mut experiment, _, mut found, _) = BIAS.clone();
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name).display().to_string();
    fs::create_dir(at("found")).unwrap();
    fs::write(at("pump.csv"), "t,u\n0,1\n60,2\n").unwrap();
    let drive = &experiment.drives[0].drive;
    let scale = experiment.patch.value()["drives"][drive]["scale"].clone();
    let table = json!({"kind": "table", "scale": scale, "points": {"csv": "pump.csv", "x": "t", "y": "u"}});
    let edit = Edit { path: ["drives", drive].map(str::to_owned).to_vec(), value: table };
    experiment.patch = experiment.patch.edited(&at("base.json"), &[edit]).unwrap();
    found.base.version = found.base.version.with_patch(experiment.patch.clone());
    let file = at("found/fitted.json");
    let fitted = fitted_patch(&found, &experiment, &file).unwrap();
    assert_eq!(fitted.value()["drives"][drive]["points"]["csv"], "../pump.csv");
    Circuit::new(&fitted, &[]).unwrap_or_else(|report| panic!("{report}"));
}
