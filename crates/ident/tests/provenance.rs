//! The patches that a search writes: they start in the fitted initial state, and their note names their source.

use std::fs;
use std::sync::LazyLock;

use serde_json::{Value, json};

use crate::report_page::BELL_FORCE_SEARCH;
use crate::search::search_case;
use patchcord_core::circuit::Circuit;
use patchcord_core::document::Phase;
use patchcord_core::ir::Program;
use patchcord_core::patch::{Edit, Patch};
use patchcord_core::solve::{self, RunSettings};
use patchcord_ident::Experiment;
use patchcord_ident::fit::problem::Problem;
use patchcord_ident::report::Report;
use patchcord_ident::report::labels::candidate_label;
use patchcord_ident::report::provenance::fitted_patch;
use patchcord_ident::search::Outcome;

/// The residual of an unchanged patch in the first training record: rms over the noise.
///
/// The drives are tables of the measured data, connected by straight lines.
fn residual_over_noise(patch: &Patch, experiment: &Experiment, sigma: &[f64]) -> f64 {
    let mut editor = patch.edit();
    experiment.drives.iter().for_each(|measured| editor.put_table_drive(&measured.drive, "linear").unwrap());
    let circuit = Circuit::new(&editor.finish(patch.file()).unwrap()).unwrap();
    let mut program = Program::new(&circuit).unwrap();
    let record = &experiment.train[0];
    for (measured, values) in experiment.drives.iter().zip(&record.drives) {
        let points =
            values.iter().enumerate().map(|(sample, value)| [sample as f64 * record.interval, *value]);
        solve::set_drive_table(&mut program, &measured.drive, points.collect()).unwrap();
    }
    let outputs: Vec<String> = experiment.outputs.iter().map(|output| output.signal.clone()).collect();
    let settings = RunSettings::of(&circuit)
        .unwrap()
        .with_step(record.interval / 4.0)
        .with_phases([Phase::InitialCondition, Phase::operate(record.duration())])
        .with_sample_interval(record.interval)
        .with_signals(outputs.clone());
    let trace = solve::run(&program, &settings).unwrap();
    let mut squares = Vec::new();
    for ((name, data), sigma) in outputs.iter().zip(&record.outputs).zip(sigma) {
        let pairs = trace.values(name).unwrap().into_iter().zip(data);
        squares.extend(pairs.map(|(model, datum)| ((datum - model) / sigma).powi(2)));
    }
    (squares.iter().sum::<f64>() / squares.len() as f64).sqrt()
}

/// The search for a constant inflow into a tank. Several tests use its outcome.
static BIAS_SEARCH: LazyLock<(Experiment, Problem, Outcome, Value)> =
    LazyLock::new(|| search_case("bias", 2));

/// The note of a patch.
fn note(patch: &Patch) -> &str {
    patch.value()["note"].as_str().unwrap()
}

#[test]
#[ignore = "takes several seconds: a whole search"]
fn an_augmented_patch_reproduces_the_fit_and_its_note_names_its_source() {
    let (experiment, problem, outcome, _) = &*BIAS_SEARCH;
    let report = Report::new(experiment, problem, outcome);
    let fitted = report.fitted("fitted.json").unwrap();
    let augmented = report.augmented("augmented.json").unwrap().unwrap();
    let [before, after] =
        [&fitted, &augmented].map(|patch| residual_over_noise(patch, experiment, &problem.sigma));
    let [expected_before, expected_after] =
        [&outcome.base, outcome.reported_model()].map(|model| model.train.normalised_rms());
    assert!((before / expected_before - 1.0).abs() < 0.01, "{before} {expected_before}");
    assert!((after / expected_after - 1.0).abs() < 0.01, "{after} {expected_after}");
    let (augmented_note, original_note) = (note(&augmented), note(&experiment.patch));
    let label = candidate_label(&outcome.rounds[0].trials[0].candidate);
    for part in [experiment.patch_name.as_str(), "train.csv", &label, "(95 %: ", original_note] {
        assert!(augmented_note.contains(part), "{part}: {augmented_note}");
    }
    assert!(note(&fitted).contains("train.csv") && !note(&fitted).contains("95 %"));
    assert!(report.recovered("recovered.json").unwrap().is_none());
}

#[test]
#[ignore = "takes several seconds: a whole search"]
fn without_a_named_effect_a_recovered_patch_is_written_instead_of_an_augmented_one() {
    let (experiment, problem, outcome) = &*BELL_FORCE_SEARCH;
    let report = Report::new(experiment, problem, outcome);
    assert!(report.augmented("augmented.json").unwrap().is_none());
    let recovered = report.recovered("recovered.json").unwrap().unwrap();
    let after = residual_over_noise(&recovered, experiment, &problem.sigma);
    assert!(after < 0.3 * outcome.base.train.normalised_rms(), "{after}");
    assert!(note(&recovered).contains("a function of x"), "{}", note(&recovered));
}

#[test]
#[ignore = "takes several seconds: a whole search"]
fn paths_of_table_files_are_adapted_to_the_folder_of_the_written_patch() {
    let (mut experiment, _, mut outcome, _) = BIAS_SEARCH.clone();
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name).display().to_string();
    fs::create_dir(path("found")).unwrap();
    fs::write(path("pump.csv"), "t,u\n0,1\n60,2\n").unwrap();
    let drive = &experiment.drives[0].drive;
    let scale = experiment.patch.value()["drives"][drive]["scale"].clone();
    let table = json!({"kind": "table", "scale": scale, "points": {"csv": "pump.csv", "x": "t", "y": "u"}});
    let edit = Edit::at(["drives", drive], table);
    experiment.patch = experiment.patch.with_edits(&path("base.json"), &[edit]).unwrap();
    outcome.base.variant = outcome.base.variant.with_patch(experiment.patch.clone());
    let file = path("found/fitted.json");
    let fitted = fitted_patch(&outcome, &experiment, &file).unwrap();
    assert_eq!(fitted.value()["drives"][drive]["points"]["csv"], "../pump.csv");
    Circuit::new(&fitted).unwrap_or_else(|report| panic!("{report}"));
}
