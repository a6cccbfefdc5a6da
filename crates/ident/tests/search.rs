//! Searches on experiments made by benches/hidden, compared with the hidden effects in each folder's truth.json.
//!
//! The helpers that run a search on such a case are used by other test modules, too.

use std::collections::BTreeSet;
use std::fmt::Write;
use std::path::Path;

use serde_json::{Value, json};

use super::library;
use patchcord_core::circuit::Circuit;
use patchcord_ident::effects::Library;
use patchcord_ident::fit::problem::Problem;
use patchcord_ident::report::Report;
use patchcord_ident::report::doubts::doubts;
use patchcord_ident::report::fit_quality::starts_sentence;
use patchcord_ident::report::labels::candidate_label;
use patchcord_ident::report::provenance::augmented_patch;
use patchcord_ident::report::rounds::round_sentence;
use patchcord_ident::report::sentence::verdict_sentence;
use patchcord_ident::search::{Outcome, SearchSettings, Verdict};
use patchcord_ident::{Experiment, Progress, SearchPhase};

/// The experiment of a table that a motor pushes, from docs/gap.md.
const SLIDE: &str = "../../examples/05_missing_effect/slide.experiment.json";

/// Reads an experiment that must be valid.
fn read(path: &Path) -> Experiment {
    Experiment::read(path).unwrap_or_else(|error| panic!("{error}"))
}

/// The outcome of a search with the shipped library and seed 1.
pub(crate) fn outcome(experiment: &Experiment, problem: &Problem, threads: usize) -> Outcome {
    let library = Library::shipped();
    let settings = SearchSettings::new(&library).with_threads(threads);
    patchcord_ident::search::search(experiment, problem, &settings, |_| ()).unwrap().unwrap()
}

/// The search document of an outcome, as printed by `--json`.
pub(crate) fn document(experiment: &Experiment, problem: &Problem, outcome: &Outcome) -> Value {
    Report::new(experiment, problem, outcome).json()
}

/// The search of a hidden case on two threads, after `modify` has changed its experiment.
pub(crate) fn search_modified(case: &str, modify: impl FnOnce(&mut Experiment)) -> Outcome {
    let mut experiment = read(&Path::new("tests/hidden").join(case).join("experiment.json"));
    modify(&mut experiment);
    outcome(&experiment, &Problem::of(&experiment).unwrap(), 2)
}

/// The search of a case of crates/ident/tests/hidden on some threads, and the case's truth.json.
pub(crate) fn search_case(case: &str, threads: usize) -> (Experiment, Problem, Outcome, Value) {
    let folder = Path::new("tests/hidden").join(case);
    let experiment = read(&folder.join("experiment.json"));
    let problem = Problem::of(&experiment).unwrap();
    let outcome = outcome(&experiment, &problem, threads);
    let truth = std::fs::read_to_string(folder.join("truth.json")).unwrap();
    (experiment, problem, outcome, serde_json::from_str(&truth).unwrap())
}

/// The search of a case on two threads with a few shipped effects: the true ones and their closest rivals.
fn search_case_among(case: &str, effects: &[&str]) -> (Experiment, Problem, Outcome, Value) {
    let folder = Path::new("tests/hidden").join(case);
    let experiment = read(&folder.join("experiment.json"));
    let problem = Problem::of(&experiment).unwrap();
    let library = library::with_effects(effects);
    let settings = SearchSettings::new(&library).with_threads(2);
    let mut reports = Vec::new();
    let report = |progress| reports.push(progress);
    let outcome = patchcord_ident::search::search(&experiment, &problem, &settings, report).unwrap().unwrap();
    check_reports(&reports, &outcome);
    let truth = std::fs::read_to_string(folder.join("truth.json")).unwrap();
    (experiment, problem, outcome, serde_json::from_str(&truth).unwrap())
}

/// Asserts that the progress of a search names the best effect of each round, and at the end the effects of the
/// outcome.
fn check_reports(reports: &[Progress], outcome: &Outcome) {
    for report in reports.iter().filter(|report| report.total > 0) {
        assert!(report.done <= report.total, "{report:?}");
        let is_complete = report.done == report.total && report.phase == SearchPhase::Full;
        assert!(!is_complete || report.best.is_some(), "{report:?}");
    }
    if let Some(last) = reports.last().filter(|report| report.phase == SearchPhase::Localisation) {
        let effects: Vec<_> = outcome.effects.iter().map(|effect| effect.placed_effect()).collect();
        assert_eq!(last.added, effects);
    }
}

#[test]
fn one_effect_is_distinguished_from_its_rivals() {
    for (case, effects) in [
        ("saturation", ["saturation", "drive-dead-zone", "constant-bias", "time-delay"]),
        ("friction", ["coulomb-friction", "viscous-friction", "constant-bias", "cubic-stiffness"]),
    ] {
        let (experiment, problem, outcome, truth) = search_case_among(case, &effects);
        assert_eq!(outcome.verdict, Verdict::Named, "{}", verdict_sentence(&outcome));
        assert_eq!(
            effects_at_places(&document(&experiment, &problem, &outcome)["effects"]),
            effects_at_places(&truth["effects"])
        );
    }
}

#[test]
#[ignore = "takes several seconds: a search for two effects"]
fn two_effects_are_distinguished_from_their_rivals() {
    let (experiment, problem, outcome, truth) =
        search_case_among("pair", &["leak", "saturation", "constant-bias", "quadratic-drag"]);
    assert_eq!(outcome.verdict, Verdict::Named, "{}", verdict_sentence(&outcome));
    assert_eq!(
        effects_at_places(&document(&experiment, &problem, &outcome)["effects"]),
        effects_at_places(&truth["effects"])
    );
}

#[test]
fn an_unknown_effect_is_not_named_after_one_of_a_few() {
    let (_, _, outcome, _) = search_case_among("relay", &["coulomb-friction", "constant-bias", "saturation"]);
    assert_eq!(outcome.verdict, Verdict::UnknownEffect, "{}", verdict_sentence(&outcome));
}

#[test]
fn nothing_missing_is_reported_with_a_small_library() {
    let (_, _, outcome, _) =
        search_case_among("nothing", &["coulomb-friction", "cubic-stiffness", "constant-bias"]);
    assert_eq!(outcome.verdict, Verdict::NothingMissing, "{}", verdict_sentence(&outcome));
}

/// Asserts that the search of a case names its one effect at its place, with the right parameter value.
///
/// `parameter` is the library's name of the parameter, `hidden_parameter` its name in truth.json. The 95 % interval
/// must contain the true value, and may be at most `max_width` times that value wide.
fn assert_named(case: &str, parameter: &str, hidden_parameter: &str, max_width: f64) {
    let (experiment, problem, outcome, truth) = search_case(case, 2);
    assert_eq!(outcome.verdict, Verdict::Named);
    let report = Report::new(&experiment, &problem, &outcome);
    let document = report.json();
    let (effect, hidden) = (&document["effects"][0], &truth["effects"][0]);
    assert_eq!((&effect["name"], &effect["junction"]), (&hidden["name"], &hidden["junction"]));
    let truth = hidden["parameters"][hidden_parameter]["value"].as_f64().unwrap();
    let fitted = &effect["parameters"][parameter];
    let ratio = fitted["value"].as_f64().unwrap() / truth;
    assert!((ratio - 1.0).abs() < 0.02, "{fitted} {truth}");
    let [low, high] = [0, 1].map(|end| fitted["interval"][end].as_f64().unwrap());
    assert!((low..high).contains(&truth) && high - low < max_width * truth.abs(), "{fitted} {truth}");
    for data in ["train", "test"] {
        let over = |when: &str| {
            let gaps = document["gap"][when][data].as_object().unwrap().values();
            gaps.map(|gap| gap["over_sigma"].as_f64().unwrap()).fold(0.0, f64::max)
        };
        assert!(over("after") < over("before") && over("after") < 1.1, "{}", document["gap"]);
    }
    let patch = report.augmented("augmented.json").unwrap().unwrap();
    let circuit = Circuit::new(&patch).unwrap_or_else(|report| panic!("{report}"));
    assert_eq!(circuit.warnings().to_string(), "");
}

#[test]
fn a_saturating_pump_is_named() {
    assert_named("saturation", "L", "L", 0.1);
}

#[test]
#[ignore = "takes several seconds: a whole search"]
fn a_stop_is_named_that_the_fitted_patch_does_not_reach() {
    // The mass touches the stop only once and for few samples, so the interval is wide.
    assert_named("stop", "xl", "xs", 0.5);
}

/// After the first rung, twelve laws that contain Coulomb friction have a better score.
#[test]
#[ignore = "takes several seconds: a whole search"]
fn coulomb_friction_is_named_instead_of_a_law_with_more_parameters() {
    assert_named("friction", "Fc", "Fc", 0.1);
}

/// With two records, the first rungs use only one of them.
#[test]
#[ignore = "takes several seconds: a whole search"]
fn a_saturating_pump_is_named_from_two_records() {
    let mut experiment = read(Path::new("tests/hidden/saturation/experiment.json"));
    experiment.train.push(experiment.train[0].clone());
    let problem = Problem::of(&experiment).unwrap();
    let outcome = outcome(&experiment, &problem, 2);
    assert_eq!(verdict_sentence(&outcome), "saturation at u is missing");
    assert!(!outcome.final_model.residuals_are_coloured());
}

/// The data are those of a mass of 2 kg. The range of the patch's parameter M ends at 1.6 kg.
#[test]
#[ignore = "takes several seconds: a whole search"]
fn a_value_beyond_a_range_is_reported_as_an_alternative_to_an_effect() {
    let experiment = read(Path::new(SLIDE));
    let problem = Problem::of(&experiment).unwrap();
    let outcome = outcome(&experiment, &problem, 2);
    let sentence = verdict_sentence(&outcome);
    let mass = sentence.strip_prefix("mass-change at A1 is missing, or M = ").unwrap();
    let mass = mass.strip_suffix(" kg, beyond its range: these data cannot distinguish them").unwrap();
    assert!((mass.parse::<f64>().unwrap() - 2.0).abs() < 0.02, "{sentence}");
    assert!(doubts(&outcome, &experiment).is_empty(), "{:?}", doubts(&outcome, &experiment));
    assert_eq!(document(&experiment, &problem, &outcome)["beyond"]["parameters"][0]["name"], "M");
}

/// The same data, with a library without the effect mass-change.
#[test]
#[ignore = "takes several seconds: a whole search"]
fn the_search_is_inconclusive_if_only_a_value_beyond_a_range_explains_the_data() {
    let experiment = read(Path::new(SLIDE));
    let problem = Problem::of(&experiment).unwrap();
    let library = library::with_effects(&["drift"]);
    let settings = SearchSettings::new(&library).with_threads(2);
    let outcome = patchcord_ident::search::search(&experiment, &problem, &settings, |_| ()).unwrap().unwrap();
    let sentence = verdict_sentence(&outcome);
    assert!(sentence.starts_with("inconclusive: the patch alone explains the data with M = "), "{sentence}");
}

/// The range of the effect ends slightly below the hidden bias.
#[test]
#[ignore = "takes several seconds: a whole search"]
fn a_parameter_at_the_end_of_its_range_is_reported_as_a_doubt() {
    let bias = std::fs::read_to_string("../../patches/effects/constant-bias.json").unwrap();
    let folder = tempfile::tempdir().unwrap();
    let small = bias.replace(r#""range": [-1, 1]"#, r#""range": [-0.064, 0.064]"#);
    assert_ne!(small, bias);
    std::fs::write(folder.path().join("constant-bias.json"), small).unwrap();
    let library = Library::default().with_folder(folder.path()).unwrap();
    let experiment = read(Path::new("tests/hidden/bias/experiment.json"));
    let problem = Problem::of(&experiment).unwrap();
    let settings = SearchSettings::new(&library).with_threads(2);
    let outcome = patchcord_ident::search::search(&experiment, &problem, &settings, |_| ()).unwrap().unwrap();
    let doubt = "The b of constant-bias is at the end of its range: the data may require a value beyond it.";
    assert_eq!(verdict_sentence(&outcome), "constant-bias at I2 is missing");
    assert!(doubts(&outcome, &experiment).contains(&doubt.to_owned()), "{:?}", doubts(&outcome, &experiment));
}

/// The law has kinks. The interval must not depend on how the steps of the solver meet them.
#[test]
#[ignore = "takes several seconds: a whole search"]
fn a_soft_dead_zone_is_named_and_its_interval_contains_the_true_width() {
    assert_named("dead-zone", "b", "b", 0.1);
}

#[test]
#[ignore = "takes several seconds: a whole search"]
fn a_hole_in_a_tank_is_named_as_a_leak_proportional_to_the_root_of_the_level() {
    assert_named("hole", "c", "c", 0.1);
}

/// In the patch's initial state the table sticks, and the fit has no gradient there. In the record it moves from the
/// beginning.
#[test]
#[ignore = "takes several seconds: a whole search"]
fn a_record_is_fitted_that_begins_far_from_the_initial_state_of_the_patch() {
    let experiment = Experiment::read(Path::new("tests/hidden/far/experiment.json"));
    let experiment = experiment.unwrap_or_else(|error| panic!("{error}"));
    let problem = Problem::of(&experiment).unwrap();
    let base = patchcord_ident::fit::base_fit::fit_base(&problem, &experiment.patch, &experiment.fit, 1)
        .unwrap()
        .unwrap();
    assert!(base.validation.normalised_rms() < 1.1, "{}", base.validation.normalised_rms());
}

#[test]
#[ignore = "takes several seconds: a whole search"]
fn a_constant_inflow_is_named_at_its_tank() {
    assert_named("bias", "b", "b", 0.1);
}

#[test]
#[ignore = "takes several seconds: a whole search"]
fn a_periodic_disturbance_is_named_with_its_frequency() {
    assert_named("periodic", "f", "f", 0.1);
}

/// Names and junctions of the effects of a search document or a truth.json.
fn effects_at_places(effects: &Value) -> BTreeSet<String> {
    let effects = effects.as_array().unwrap().iter();
    effects.map(|effect| format!("{} {}", effect["name"], effect["junction"])).collect()
}

#[test]
#[ignore = "takes several seconds: a whole search"]
fn two_effects_are_named_at_their_places() {
    let (experiment, problem, mut outcome, truth) = search_case("pair", 2);
    assert_eq!(outcome.verdict, Verdict::Named);
    let document = document(&experiment, &problem, &outcome);
    assert_eq!(effects_at_places(&document["effects"]), effects_at_places(&truth["effects"]));
    let rounds = document["rounds"].as_array().unwrap();
    assert_eq!(rounds.iter().filter(|round| round["taken"] == true).count(), 2);
    // After the second round, each effect was tried again together with the other.
    let named: Vec<String> = outcome.effects.iter().map(candidate_label).collect();
    assert_eq!([&rounds[0]["beside"][0], &rounds[1]["beside"][0]], [&named[1][..], &named[0][..]]);
    assert_eq!(document["effects"][1]["step"], 2);
    let leak =
        document["effects"].as_array().unwrap().iter().find(|effect| effect["name"] == "leak").unwrap();
    let hidden = truth["effects"][0]["parameters"]["g"]["value"].as_f64().unwrap();
    assert!((leak["parameters"]["g"]["value"].as_f64().unwrap() / hidden - 1.0).abs() < 0.05, "{leak}");
    assert!(!outcome.final_model.residuals_are_coloured());
    // With another verdict, the sentence of the round adds why the effect is not named.
    let is_unnamed = |outcome: &Outcome| {
        round_sentence(outcome, &outcome.rounds[0]).contains("It is taken. It is not named, because ")
    };
    assert!(!is_unnamed(&outcome));
    outcome.verdict = Verdict::UnknownEffect;
    assert!(is_unnamed(&outcome));
}

#[test]
#[ignore = "takes several seconds: a whole search"]
fn two_effects_are_named_of_which_one_masks_the_other() {
    let (experiment, problem, outcome, truth) = search_case("masked", 2);
    assert_eq!(outcome.verdict, Verdict::Named);
    assert_eq!(
        effects_at_places(&document(&experiment, &problem, &outcome)["effects"]),
        effects_at_places(&truth["effects"])
    );
}

/// A table of t in s, F in N and x in m of a mass of 20 kg that becomes 29 kg at 2.5 s, with viscous friction of 40 N
/// s/m.
///
/// It has 1600 samples at 250 Hz, integrated by the midpoint method with ten steps per sample. Positions are rounded to
/// 0.1 mm.
fn loaded_mass_csv() -> String {
    let force = |t: f64| 40.0 * (8.2 * t).sin() + 20.0 * (4.4 * t).sin();
    let step = 4e-4;
    let mut rows = "t,F,x\n".to_owned();
    let (mut x, mut v) = (0.0, 0.0);
    for count in 0..16_000_u32 {
        let t = f64::from(count) * step;
        if count % 10 == 0 {
            writeln!(rows, "{t:.3},{:.9},{x:.4}", force(t)).unwrap();
        }
        let mass = if t < 2.5 { 20.0 } else { 29.0 };
        let acceleration = |v: f64, t: f64| (force(t) - 40.0 * v) / mass;
        let middle = v + step / 2.0 * acceleration(v, t);
        x += step * middle;
        v += step * acceleration(middle, t + step / 2.0);
    }
    rows
}

#[test]
#[ignore = "takes several seconds: a whole search"]
fn a_mass_that_changes_in_training_keeps_its_value_in_the_test() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("loaded.csv"), loaded_mass_csv()).unwrap();
    let patch = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/systems/axis.json");
    let experiment = json!({
        "patch": patch, "data": "loaded.csv", "drives": {"F": "F"}, "outputs": {"x": "x"},
        "train": [0, 4.8], "test": [4.8, 6.396],
    });
    let path = folder.path().join("experiment.json");
    std::fs::write(&path, experiment.to_string()).unwrap();
    let experiment = read(&path);
    let problem = Problem::of(&experiment).unwrap();
    let outcome = outcome(&experiment, &problem, 2);
    assert_eq!(outcome.verdict, Verdict::Named);
    let document = document(&experiment, &problem, &outcome);
    let effect = &document["effects"][0];
    assert_eq!(effect["name"], "mass-change");
    let value = |name: &str| effect["parameters"][name]["value"].as_f64().unwrap();
    assert!((value("r") - 0.45).abs() < 0.01 && (value("t1") - 2.5).abs() < 0.02, "{effect}");
    assert!(
        outcome.final_model.validation.normalised_rms() < 1.2,
        "{}",
        outcome.final_model.validation.normalised_rms()
    );
}

#[test]
#[ignore = "takes several seconds: a whole search"]
fn a_relay_in_the_drive_is_reported_as_an_unknown_effect() {
    let (experiment, _, outcome, _) = search_case("relay", 2);
    assert_eq!(outcome.verdict, Verdict::UnknownEffect);
    assert!(augmented_patch(&outcome, &experiment, "augmented.json").unwrap().is_none());
    assert_eq!(outcome.localisations[0].junction, "IT");
}

#[test]
#[ignore = "takes several seconds: a whole search"]
fn nothing_missing_is_reported_with_any_thread_count() {
    let [(experiment, problem, one_thread, _), (_, _, two_threads, _)] =
        [1, 2].map(|threads| search_case("nothing", threads));
    assert_eq!(one_thread.verdict, Verdict::NothingMissing);
    assert!(augmented_patch(&one_thread, &experiment, "augmented.json").unwrap().is_none());
    assert_eq!(document(&experiment, &problem, &one_thread), document(&experiment, &problem, &two_threads));
    assert!(one_thread.agreement.is_reproduced, "{}", starts_sentence(&one_thread.agreement));
}
