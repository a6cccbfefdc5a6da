//! The thesis re-enacted: Figs 8.4 and 8.14 beside data that the law of Fig 8.16 made, in patches/story.

use std::path::Path;

use serde_json::json;

use super::library;
use super::search::document;
use patchcord_core::circuit::Circuit;
use patchcord_core::document::Phase;
use patchcord_core::ir::Program;
use patchcord_core::patch::{Edit, Patch};
use patchcord_core::solve::{self, RunSettings};
use patchcord_ident::Experiment;
use patchcord_ident::effects::attach::Attached;
use patchcord_ident::effects::candidate::Candidate;
use patchcord_ident::effects::reach::Extent;
use patchcord_ident::effects::sites::Sites;
use patchcord_ident::fit::fitted_model::Stage;
use patchcord_ident::fit::problem::Problem;
use patchcord_ident::report::sentence::verdict_sentence;
use patchcord_ident::search::{Means, Outcome, Verdict};

/// What patches/story/slide.py made the data with, by the names of Fig 8.16.
const TRUTH: [(&str, f64); 6] =
    [("M", 433.0), ("K", 45e6), ("f", 10.7e3), ("Fs", 771.0), ("VcL", 10.16e-3), ("Tc", 6.5e-3)];
/// The same by the names of Fig 8.4 with friction that remembers.
const RENAMED: [(&str, f64); 7] =
    [("M", 433.0), ("K", 45e6), ("f", 10.7e3), ("dF", 771.0), ("V0", 10.16e-3), ("Tc", 6.5e-3), ("Fc", 0.0)];
/// The same where friction that falls stands in the patch already.
const BESIDE_FALLING: [(&str, f64); 6] =
    [("M", 433.0), ("K", 45e6), ("f", 10.7e3), ("dF_1", 771.0), ("V0", 10.16e-3), ("Tc", 6.5e-3)];

fn experiment(figure: &str) -> Experiment {
    let file = format!("../../patches/story/from-{figure}.experiment.json");
    Experiment::read(Path::new(&file)).unwrap_or_else(|error| panic!("{error}"))
}

fn thesis(figure: &str) -> Patch {
    Patch::read(Path::new(&format!("../../patches/thesis/{figure}.json"))).unwrap()
}

fn searched(figure: &str, effects: &[&str]) -> (Problem, Outcome) {
    search(&experiment(figure), effects)
}

fn search(experiment: &Experiment, effects: &[&str]) -> (Problem, Outcome) {
    let problem = Problem::of(experiment).unwrap();
    let library = library::of(effects);
    let with = Means { library: &library, threads: 2, seed: 1 };
    let found = patchcord_ident::search::search(&problem, &experiment.patch, &experiment.fit, &with, |_| ())
        .unwrap()
        .unwrap();
    (problem, found)
}

/// That every parameter named here was found to this share of its true value.
fn found_near(outcome: &Outcome, truth: &[(&str, f64)], share: f64) {
    let stage = outcome.told();
    for (name, wanted) in truth {
        let place = stage.version.fit.iter().position(|own| own == name);
        let place = place.unwrap_or_else(|| panic!("{name} is not fitted"));
        let value = stage.train.point.knobs[place];
        assert!((value - wanted).abs() < share * wanted, "{name}: {value}, not {wanted}");
    }
}

/// A command that the data do not hold: up to 10 mm/s and back within a second.
const COMMAND: [(&str, f64); 4] = [("v_start", 0.0), ("v_rate", 20e-3), ("v_turn", 0.5), ("x_step", 0.0)];

/// Velocity and position error of a patch under that command.
fn commanded(patch: &Patch, set: &[(&str, f64)]) -> [Vec<f64>; 2] {
    let set: Vec<_> = COMMAND.iter().chain(set).map(|(name, value)| ((*name).to_owned(), *value)).collect();
    let circuit = Circuit::new(patch, &set).unwrap_or_else(|report| panic!("{report}"));
    let program = Program::new(&circuit).unwrap_or_else(|report| panic!("{report}"));
    let names = ["v_o", "x_error"].map(str::to_owned);
    let settings = RunSettings {
        phases: vec![Phase::InitialCondition, Phase::operate(1.0)],
        step: 2e-5,
        every: 1e-3,
        record: names.to_vec(),
        ..RunSettings::of(&circuit).unwrap()
    };
    let trace = solve::run(&program, &settings).unwrap();
    names.map(|name| trace.values(&name).unwrap())
}

/// The largest difference between two runs, as a share of the largest value.
fn apart(one: &[Vec<f64>; 2], other: &[Vec<f64>; 2]) -> f64 {
    let most = |values: &mut dyn Iterator<Item = f64>| values.fold(0.0, |most: f64, own| most.max(own.abs()));
    let share = |(one, other): (&Vec<f64>, &Vec<f64>)| {
        let pairs = one.iter().zip(other);
        most(&mut pairs.map(|(a, b)| a - b)) / most(&mut other.iter().copied())
    };
    most(&mut one.iter().zip(other).map(share))
}

#[test]
fn the_data_are_those_of_fig_8_16_and_noise() {
    let mut experiment = experiment("fig-8-14");
    let edits = TRUTH.map(|(name, value)| Edit {
        path: ["parameters", name, "value"].map(str::to_owned).to_vec(),
        value: json!(value),
    });
    experiment.patch = thesis("fig-8-16").edited("fig-8-16.json", &edits).unwrap();
    experiment.fit.clear();
    let problem = Problem::of(&experiment).unwrap();
    let stage = patchcord_ident::fit::base_fit::fit_base(&problem, &experiment.patch, &experiment.fit, 1)
        .unwrap()
        .unwrap();
    for fitted in [&stage.train, &stage.test] {
        let over = fitted.over_noise();
        assert!((over - 1.0).abs() < 0.05, "{over}");
    }
}

/// Fig 8.4 with an effect as the width of a dead zone of the spring force.
fn augmented(effect: &str) -> Patch {
    let patch = thesis("fig-8-04");
    let circuit = Circuit::new(&patch, &[]).unwrap();
    let sites = Sites::of(&circuit, &["v_i"]);
    let library = library::of(&[effect]);
    let all = Attached::all(library.get(effect).unwrap(), &sites);
    let attached = all.iter().find(|attached| attached.reads() == ["spring_force"]).unwrap();
    let largest = attached.place.largest(|role| Some(Extent::of([0.0, 10.0 * role.per_volt()])), 1e-3, 1.0);
    Candidate::new(attached, &patch, &largest, &[]).unwrap().unwrap().graft.patch
}

#[test]
fn fig_8_4_with_falling_friction_wired_in_is_fig_8_14_and_with_memory_fig_8_16() {
    let falling = [&RENAMED[..5], &RENAMED[6..]].concat();
    let found = commanded(&augmented("stribeck-friction"), &falling);
    let apart_falling = apart(&found, &commanded(&thesis("fig-8-14"), &TRUTH[..5]));
    assert!(apart_falling < 1e-6, "{apart_falling}");
    let wanted = commanded(&thesis("fig-8-16"), &TRUTH);
    let found = commanded(&augmented("friction-memory"), &RENAMED);
    assert!(apart(&found, &wanted) < 1e-6, "{}", apart(&found, &wanted));
    let told = Patch::read(Path::new("tests/story/found.json")).unwrap();
    let near = apart(&commanded(&told, &[]), &wanted);
    assert!(near < 0.03, "{near}");
    // Without memory it is another thing.
    let without = commanded(&thesis("fig-8-14"), &TRUTH[..5]);
    assert!(apart(&without, &wanted) > 0.1);
}

const FRICTION: [&str; 4] = ["coulomb-friction", "friction-memory", "stribeck-friction", "viscous-friction"];

#[test]
#[ignore = "takes a minute or more: searches on the data of the thesis"]
fn from_fig_8_14_the_memory_is_named_where_the_thesis_has_it() {
    let (problem, found) = searched("fig-8-14", &FRICTION);
    assert_eq!(found.verdict, Verdict::Named);
    let document = document(&problem, &found);
    let effects = document["effects"].as_array().unwrap();
    assert_eq!(effects.len(), 1);
    assert_eq!((&effects[0]["name"], &effects[0]["junction"]), (&json!("friction-memory"), &json!("X1")));
    found_near(&found, &TRUTH[2..], 0.01);
    assert!(found.base.gap() > 20.0 && found.told().gap() < 0.5);
    // Behind the square it would be another law.
    let behind = found.rounds[0].trials.iter().find(|trial| trial.candidate.junction == "M1").unwrap();
    assert!(behind.stage.gap() > 4.0);
}

#[test]
#[ignore = "takes a minute or more: searches on the data of the thesis"]
fn from_fig_8_4_in_two_steps_friction_that_falls_comes_first_and_memory_then() {
    // A library without memory has nothing better than friction that falls, and does not believe it.
    let (_, first) = searched("fig-8-04", &["coulomb-friction", "stribeck-friction"]);
    assert_eq!(first.verdict, Verdict::UnknownEffect);
    let told = std::fs::read_to_string("../../docs/story.md").unwrap();
    assert!(told.contains(&verdict_sentence(&first)), "{}", verdict_sentence(&first));
    // What is fitted so far is where the next search begins.
    let mut experiment = experiment("fig-8-04");
    let version = &first.last.version;
    experiment.patch = version.at("falling.json", &first.last.train.point.knobs).unwrap();
    experiment.fit = version.fit.clone();
    let second = search(&experiment, &["coulomb-friction", "friction-memory", "stribeck-friction"]).1;
    assert_eq!(verdict_sentence(&second), "friction-memory at A3 is missing");
    found_near(&second, &BESIDE_FALLING, 0.01);
    let gaps = [&first.base, &first.last, second.told()].map(Stage::gap);
    assert!(gaps[1] < 0.5 * gaps[0] && gaps[2] < 0.01 * gaps[1], "{gaps:?}");
    // The friction of the first step is needless now.
    let Stage { version, train, .. } = second.told();
    let mut values: Vec<_> = version.fit.iter().map(String::as_str).zip(train.point.knobs.clone()).collect();
    for needless in ["dF", "Fc"] {
        let (_, value) = values.iter_mut().find(|(name, _)| *name == needless).unwrap();
        assert!(*value < 0.02 * 771.0, "{needless}: {value}");
        *value = 0.0;
    }
    let found = commanded(version.patch(), &values);
    let near = apart(&found, &commanded(&thesis("fig-8-16"), &TRUTH));
    assert!(near < 0.06, "{near}");
}

#[test]
#[ignore = "takes a minute or more: searches on the data of the thesis"]
fn from_fig_8_4_friction_that_falls_and_remembers_is_found_and_runs_like_fig_8_16() {
    let (_, found) = searched("fig-8-04", &FRICTION);
    assert_eq!(verdict_sentence(&found), "friction-memory at A3 is missing");
    found_near(&found, &RENAMED[..6], 0.01);
    // Each of the thesis's steps adds to the one before and leaves less.
    let best = |effect: &str, reads: &[&str]| {
        let own = found.rounds[0].trials.iter().filter(|trial| trial.candidate.effect == effect);
        let own = own.filter(|trial| trial.candidate.reads == reads).map(|trial| trial.stage.gap());
        own.fold(f64::INFINITY, f64::min)
    };
    let steps = [
        found.base.gap(),
        best("coulomb-friction", &[]),
        best("stribeck-friction", &[]),
        best("friction-memory", &[]),
        best("friction-memory", &["spring_force"]),
    ];
    assert!(steps.windows(2).all(|pair| pair[1] < pair[0]) && steps[4].is_finite(), "{steps:?}");
    let Stage { version, train, .. } = found.told();
    let values = version.fit.iter().map(String::as_str).zip(train.point.knobs.iter().copied());
    let run = commanded(version.patch(), &values.collect::<Vec<_>>());
    let near = apart(&run, &commanded(&thesis("fig-8-16"), &TRUTH));
    assert!(near < 0.03, "{near}");
}
