//! What the search says of a few of the experiments that benches/hidden makes: the truth lies beside them.

use std::collections::BTreeSet;
use std::fmt::Write;
use std::path::Path;

use serde_json::{Value, json};

use super::library;
use patchcord_core::circuit::Circuit;
use patchcord_ident::Experiment;
use patchcord_ident::effects::Library;
use patchcord_ident::effects::candidate::Candidate;
use patchcord_ident::fit::problem::Problem;
use patchcord_ident::report::Report;
use patchcord_ident::report::document::SearchDocument;
use patchcord_ident::report::doubts::doubts;
use patchcord_ident::report::fit_quality::starts_sentence;
use patchcord_ident::report::provenance::augmented_patch;
use patchcord_ident::report::rounds::round_sentence;
use patchcord_ident::report::sentence::verdict_sentence;
use patchcord_ident::search::{Means, Outcome, Verdict};

fn read(path: &Path) -> Experiment {
    Experiment::read(path).unwrap_or_else(|error| panic!("{error}"))
}

pub fn outcome(experiment: &Experiment, problem: &Problem, threads: usize) -> Outcome {
    let library = Library::shipped();
    let with = Means { library: &library, threads, seed: 1 };
    patchcord_ident::search::search(problem, &experiment.patch, &experiment.fit, &with, |_| ())
        .unwrap()
        .unwrap()
}

/// What a search found, as a JSON value.
pub fn document(problem: &Problem, found: &Outcome) -> Value {
    json!(SearchDocument::of(problem, found))
}

/// The search of a case whose experiment something was done to, on two threads.
pub fn spoilt(case: &str, spoil: impl FnOnce(&mut Experiment)) -> Outcome {
    let mut experiment = read(&Path::new("tests/hidden").join(case).join("experiment.json"));
    spoil(&mut experiment);
    outcome(&experiment, &Problem::of(&experiment).unwrap(), 2)
}

/// The search of a case of crates/ident/tests/hidden, on so many threads, and its truth.
pub fn searched(case: &str, threads: usize) -> (Experiment, Problem, Outcome, Value) {
    let folder = Path::new("tests/hidden").join(case);
    let experiment = read(&folder.join("experiment.json"));
    let problem = Problem::of(&experiment).unwrap();
    let found = outcome(&experiment, &problem, threads);
    let truth = std::fs::read_to_string(folder.join("truth.json")).unwrap();
    (experiment, problem, found, serde_json::from_str(&truth).unwrap())
}

/// The search of a case with a library of a few effects: the true ones and their closest rivals.
fn searched_among(case: &str, effects: &[&str]) -> (Problem, Outcome, Value) {
    let folder = Path::new("tests/hidden").join(case);
    let experiment = read(&folder.join("experiment.json"));
    let problem = Problem::of(&experiment).unwrap();
    let with = Means { library: &library::of(effects), threads: 2, seed: 1 };
    let found = patchcord_ident::search::search(&problem, &experiment.patch, &experiment.fit, &with, |_| ())
        .unwrap()
        .unwrap();
    let truth = std::fs::read_to_string(folder.join("truth.json")).unwrap();
    (problem, found, serde_json::from_str(&truth).unwrap())
}

#[test]
fn one_effect_is_named_among_its_rivals() {
    for (case, effects) in [
        ("saturation", ["saturation", "drive-dead-zone", "constant-bias", "time-delay"]),
        ("friction", ["coulomb-friction", "viscous-friction", "constant-bias", "cubic-stiffness"]),
    ] {
        let (problem, found, truth) = searched_among(case, &effects);
        assert_eq!(found.verdict, Verdict::Named, "{}", verdict_sentence(&found));
        assert_eq!(places(&document(&problem, &found)["effects"]), places(&truth["effects"]));
    }
}

#[test]
fn two_effects_are_named_among_their_rivals() {
    let (problem, found, truth) =
        searched_among("pair", &["leak", "saturation", "constant-bias", "quadratic-drag"]);
    assert_eq!(found.verdict, Verdict::Named, "{}", verdict_sentence(&found));
    assert_eq!(places(&document(&problem, &found)["effects"]), places(&truth["effects"]));
}

#[test]
fn an_unknown_effect_gets_no_name_of_a_few() {
    let (_, found, _) = searched_among("relay", &["coulomb-friction", "constant-bias", "saturation"]);
    assert_eq!(found.verdict, Verdict::UnknownEffect, "{}", verdict_sentence(&found));
}

#[test]
fn no_effect_of_a_few_is_named_if_nothing_is_missing() {
    let (_, found, _) = searched_among("nothing", &["coulomb-friction", "cubic-stiffness", "constant-bias"]);
    assert_eq!(found.verdict, Verdict::NothingMissing, "{}", verdict_sentence(&found));
}

/// Holds a search that has to name one effect against the truth; the interval of its parameter may be so wide, by the value hidden.
fn named(case: &str, parameter: &str, true_one: &str, wide: f64) {
    let (experiment, problem, found, truth) = searched(case, 2);
    assert_eq!(found.verdict, Verdict::Named);
    let report = Report::new(&experiment, &problem, &found);
    let document = report.json();
    let (effect, hidden) = (&document["effects"][0], &truth["effects"][0]);
    assert_eq!((&effect["name"], &effect["junction"]), (&hidden["name"], &hidden["junction"]));
    let wanted = hidden["parameters"][true_one]["value"].as_f64().unwrap();
    let told = &effect["parameters"][parameter];
    let near = told["value"].as_f64().unwrap() / wanted;
    assert!((near - 1.0).abs() < 0.02, "{told} {wanted}");
    let [low, high] = [0, 1].map(|end| told["interval"][end].as_f64().unwrap());
    assert!((low..high).contains(&wanted) && high - low < wide * wanted.abs(), "{told} {wanted}");
    for part in ["train", "test"] {
        let over = |when: &str| {
            let gaps = document["gap"][when][part].as_object().unwrap().values();
            gaps.map(|gap| gap["over_sigma"].as_f64().unwrap()).fold(0.0, f64::max)
        };
        assert!(over("after") < over("before") && over("after") < 1.1, "{}", document["gap"]);
    }
    let patch = report.augmented("augmented.json").unwrap().unwrap();
    let circuit = Circuit::new(&patch, &[]).unwrap_or_else(|report| panic!("{report}"));
    assert_eq!(circuit.warnings().to_string(), "");
}

#[test]
fn a_pump_at_its_limit_is_named() {
    named("saturation", "L", "L", 0.1);
}

#[test]
#[ignore = "takes several seconds: a whole search"]
fn a_stop_that_the_patch_without_it_does_not_come_to_is_named() {
    // Few samples of one push tell little of how far in it was met.
    named("stop", "xl", "xs", 0.5);
}

/// Twelve laws that have it in them stand before it at a quick look.
#[test]
#[ignore = "takes several seconds: a whole search"]
fn coulomb_friction_is_named_and_no_law_that_needs_more() {
    named("friction", "Fc", "Fc", 0.1);
}

/// So many samples that looks begin with one of the records.
#[test]
#[ignore = "takes several seconds: a whole search"]
fn a_pump_at_its_limit_is_named_from_two_records() {
    let mut experiment = read(Path::new("tests/hidden/saturation/experiment.json"));
    experiment.train.push(experiment.train[0].clone());
    let problem = Problem::of(&experiment).unwrap();
    let found = outcome(&experiment, &problem, 2);
    assert_eq!(verdict_sentence(&found), "saturation at u is missing");
    assert!(!found.last.leaves_structure());
}

/// A mass of 2 kg, of a patch that looks for it up to 1.6 kg.
#[test]
#[ignore = "takes several seconds: a whole search"]
fn what_may_be_a_value_beyond_a_range_is_said() {
    let experiment = read(Path::new("tests/slide.json"));
    let problem = Problem::of(&experiment).unwrap();
    let found = outcome(&experiment, &problem, 2);
    let said = verdict_sentence(&found);
    let mass = said.strip_prefix("mass-change at A1 is missing, or M = ").unwrap();
    let mass = mass.strip_suffix(" kg, beyond its range: these data cannot tell").unwrap();
    assert!((mass.parse::<f64>().unwrap() - 2.0).abs() < 0.02, "{said}");
    assert!(doubts(&found, &experiment).is_empty(), "{:?}", doubts(&found, &experiment));
    assert_eq!(document(&problem, &found)["beyond"]["parameters"][0]["name"], "M");
}

/// The same, with a library that has no other mass.
#[test]
#[ignore = "takes several seconds: a whole search"]
fn what_a_value_beyond_a_range_explains_is_not_called_unknown() {
    let experiment = read(Path::new("tests/slide.json"));
    let problem = Problem::of(&experiment).unwrap();
    let library = library::of(&["drift"]);
    let with = Means { library: &library, threads: 2, seed: 1 };
    let found = patchcord_ident::search::search(&problem, &experiment.patch, &experiment.fit, &with, |_| ())
        .unwrap()
        .unwrap();
    let said = verdict_sentence(&found);
    assert!(said.starts_with("these data cannot judge: the patch alone explains them with M = "), "{said}");
}

/// A bias that may be nearly as large as what is missing.
#[test]
#[ignore = "takes several seconds: a whole search"]
fn an_effect_at_the_end_of_its_range_is_doubted() {
    let bias = std::fs::read_to_string("../../patches/effects/constant-bias.json").unwrap();
    let folder = tempfile::tempdir().unwrap();
    let small = bias.replace(r#""range": [-1, 1]"#, r#""range": [-0.064, 0.064]"#);
    assert_ne!(small, bias);
    std::fs::write(folder.path().join("constant-bias.json"), small).unwrap();
    let library = Library::default().and_folder(folder.path()).unwrap();
    let experiment = read(Path::new("tests/hidden/bias/experiment.json"));
    let problem = Problem::of(&experiment).unwrap();
    let with = Means { library: &library, threads: 2, seed: 1 };
    let found = patchcord_ident::search::search(&problem, &experiment.patch, &experiment.fit, &with, |_| ())
        .unwrap()
        .unwrap();
    let doubt =
        "The b of constant-bias is found at the end of its range: these data may ask for a value beyond it.";
    assert_eq!(verdict_sentence(&found), "constant-bias at I2 is missing");
    assert!(doubts(&found, &experiment).contains(&doubt.to_owned()), "{:?}", doubts(&found, &experiment));
}

/// Laws with kinks: how steps of the solver fall on these is no part of how far a value may be off.
#[test]
#[ignore = "takes several seconds: a whole search"]
fn a_soft_dead_zone_is_named_and_its_width_lies_in_its_interval() {
    named("dead-zone", "b", "b", 0.1);
}

#[test]
#[ignore = "takes several seconds: a whole search"]
fn a_hole_in_a_tank_is_a_leak_by_the_root_of_its_level() {
    named("hole", "c", "c", 0.1);
}

/// A table that sticks where the patch begins, and moves where the record does: nothing tells a fit which way to go.
#[test]
#[ignore = "takes several seconds: a whole search"]
fn a_record_that_begins_far_from_the_patch_is_found() {
    let experiment = Experiment::read(Path::new("tests/hidden/far/experiment.json"));
    let experiment = experiment.unwrap_or_else(|error| panic!("{error}"));
    let problem = Problem::of(&experiment).unwrap();
    let base = patchcord_ident::fit::base_fit::fit_base(&problem, &experiment.patch, &experiment.fit, 1)
        .unwrap()
        .unwrap();
    assert!(base.test.over_noise() < 1.1, "{}", base.test.over_noise());
}

#[test]
#[ignore = "takes several seconds: a whole search"]
fn a_constant_inflow_is_named_at_its_tank() {
    named("bias", "b", "b", 0.1);
}

#[test]
#[ignore = "takes several seconds: a whole search"]
fn a_disturbance_with_a_frequency_of_its_own_is_named() {
    named("periodic", "f", "f", 0.1);
}

/// The names of effects, and where they are.
fn places(effects: &Value) -> BTreeSet<String> {
    let all = effects.as_array().unwrap().iter();
    all.map(|own| format!("{} {}", own["name"], own["junction"])).collect()
}

#[test]
#[ignore = "takes several seconds: a whole search"]
fn two_effects_are_named_at_their_places() {
    let (_, problem, found, truth) = searched("pair", 2);
    assert_eq!(found.verdict, Verdict::Named);
    let document = document(&problem, &found);
    assert_eq!(places(&document["effects"]), places(&truth["effects"]));
    let rounds = document["rounds"].as_array().unwrap();
    assert_eq!(rounds.iter().filter(|round| round["taken"] == true).count(), 2);
    // Each was looked at again beside the other.
    let named: Vec<String> = found.effects.iter().map(Candidate::named).collect();
    assert_eq!([&rounds[0]["beside"][0], &rounds[1]["beside"][0]], [&named[1][..], &named[0][..]]);
    assert_eq!(document["effects"][1]["step"], 2);
    let leak = document["effects"].as_array().unwrap().iter().find(|own| own["name"] == "leak").unwrap();
    let wanted = truth["effects"][0]["parameters"]["g"]["value"].as_f64().unwrap();
    assert!((leak["parameters"]["g"]["value"].as_f64().unwrap() / wanted - 1.0).abs() < 0.05, "{leak}");
    assert!(!found.last.leaves_structure());
    // The same effects, were too much left for a name.
    let is_nameless =
        |of: &Outcome| round_sentence(of, &of.rounds[0]).contains("It is taken. It is not named: ");
    assert!(!is_nameless(&found) && is_nameless(&Outcome { verdict: Verdict::UnknownEffect, ..found }));
}

#[test]
#[ignore = "takes several seconds: a whole search"]
fn two_effects_are_named_of_which_one_hides_the_other() {
    let (_, problem, found, truth) = searched("masked", 2);
    assert_eq!(found.verdict, Verdict::Named);
    assert_eq!(places(&document(&problem, &found)["effects"]), places(&truth["effects"]));
}

/// A mass on which a force acts, of which nearly half is added after 2.5 s: positions at 250 Hz over 6.4 s, worked out in steps a
/// tenth as long, to a tenth of a millimetre.
fn loaded() -> String {
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
        let pull = |v: f64, t: f64| (force(t) - 40.0 * v) / mass;
        let middle = v + step / 2.0 * pull(v, t);
        x += step * middle;
        v += step * pull(middle, t + step / 2.0);
    }
    rows
}

#[test]
#[ignore = "takes several seconds: a whole search"]
fn a_load_taken_up_in_training_is_still_there_in_the_test() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("loaded.csv"), loaded()).unwrap();
    let patch = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/systems/axis.json");
    let told = json!({
        "patch": patch, "data": "loaded.csv", "drives": {"F": "F"}, "outputs": {"x": "x"},
        "train": [0, 4.8], "test": [4.8, 6.396],
    });
    let path = folder.path().join("experiment.json");
    std::fs::write(&path, told.to_string()).unwrap();
    let experiment = read(&path);
    let problem = Problem::of(&experiment).unwrap();
    let found = outcome(&experiment, &problem, 2);
    assert_eq!(found.verdict, Verdict::Named);
    let document = document(&problem, &found);
    let effect = &document["effects"][0];
    assert_eq!(effect["name"], "mass-change");
    let value = |name: &str| effect["parameters"][name]["value"].as_f64().unwrap();
    assert!((value("r") - 0.45).abs() < 0.01 && (value("t1") - 2.5).abs() < 0.02, "{effect}");
    assert!(found.last.test.over_noise() < 1.2, "{}", found.last.test.over_noise());
}

#[test]
#[ignore = "takes several seconds: a whole search"]
fn a_relay_in_the_drive_is_none_of_the_effects() {
    let (experiment, _, found, _) = searched("relay", 2);
    assert_eq!(found.verdict, Verdict::UnknownEffect);
    assert!(augmented_patch(&found, &experiment, "augmented.json").unwrap().is_none());
    assert_eq!(found.whereabouts[0].junction, "IT");
}

#[test]
#[ignore = "takes several seconds: a whole search"]
fn nothing_is_named_where_nothing_is_missing_whatever_the_threads() {
    let [(experiment, problem, one, _), (_, _, other, _)] =
        [1, 2].map(|threads| searched("nothing", threads));
    assert_eq!(one.verdict, Verdict::NothingMissing);
    assert!(augmented_patch(&one, &experiment, "augmented.json").unwrap().is_none());
    assert_eq!(document(&problem, &one), document(&problem, &other));
    assert!(one.agreement.is_same, "{}", starts_sentence(&one.agreement));
}
