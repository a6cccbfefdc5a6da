//! The weakest effects that data would have shown, and data that show none.

use std::path::Path;

use serde_json::{Value, json};

use super::library;
use super::oscillator::{INTERVAL, measured};
use super::search::document;
use patchcord_core::patch::Patch;
use patchcord_ident::design::detectability::{Limit, best_places};
use patchcord_ident::fit::problem::Problem;
use patchcord_ident::report::detection_limits::limit_text;
use patchcord_ident::report::doubts::doubts;
use patchcord_ident::report::places::nowhere_sentence;
use patchcord_ident::report::sentence::verdict_sentence;
use patchcord_ident::report::values::undetermined_sentence;
use patchcord_ident::search::inconclusive::Blind;
use patchcord_ident::search::{Means, Outcome, Verdict};
use patchcord_ident::{Experiment, Record};

const EFFECTS: [&str; 4] = ["constant-bias", "coulomb-friction", "hard-stop", "time-delay"];

fn searched(experiment: &Experiment, problem: &Problem) -> Outcome {
    searched_for(&EFFECTS, experiment, problem)
}

fn searched_for(effects: &[&str], experiment: &Experiment, problem: &Problem) -> Outcome {
    let library = library::of(effects);
    let with = Means { library: &library, threads: 2, seed: 1 };
    patchcord_ident::search::search(problem, &experiment.patch, &experiment.fit, &with, |_| ())
        .unwrap()
        .unwrap()
}

/// Data of an oscillator that lacks nothing, made by another program.
fn nothing() -> (Experiment, Problem) {
    let experiment = Experiment::read(Path::new("tests/hidden/nothing/experiment.json"));
    let experiment = experiment.unwrap_or_else(|error| panic!("{error}"));
    let problem = Problem::of(&experiment).unwrap();
    (experiment, problem)
}

fn limit<'o>(outcome: &'o Outcome, effect: &str) -> &'o Limit {
    outcome.limits.iter().find(|own| own.effect == effect).unwrap()
}

#[test]
#[ignore = "takes several seconds: a whole search"]
fn a_force_above_its_limit_is_found_and_one_below_it_is_not() {
    let (experiment, problem) = nothing();
    let none = searched(&experiment, &problem);
    assert_eq!(none.verdict, Verdict::NothingMissing);
    let least = limit(&none, "constant-bias").value.unwrap();
    let knobs = &none.base.train.point.knobs;
    let stiffness = knobs[experiment.fit.iter().position(|name| name == "k").unwrap()];
    // A constant force moves all that a spring holds by the same way.
    let pushed = |force: f64| {
        let mut problem = problem.clone();
        let records = problem.train.iter_mut().chain(&mut problem.test);
        records.flat_map(|record| &mut record.outputs[0]).for_each(|x| *x += force / stiffness);
        searched(&experiment, &problem)
    };
    assert_eq!(pushed(0.5 * least).verdict, Verdict::NothingMissing);
    let found = pushed(2.0 * least);
    assert_eq!(found.verdict, Verdict::Named);
    assert_eq!(found.rounds[0].trials[0].candidate.effect, "constant-bias");
}

#[test]
#[ignore = "takes several seconds: a whole search"]
fn what_would_have_shown_is_told() {
    let (experiment, problem) = nothing();
    let found = searched(&experiment, &problem);
    let document = document(&problem, &found);
    let told: Vec<&Value> = document["limits"].as_array().unwrap().iter().collect();
    let of = |parameter: &str| *told.iter().find(|own| own["parameter"] == parameter).unwrap();
    assert_eq!(of("Fc")["unit"], "N");
    assert_eq!((&of("b")["junction"], &of("b")["seen"]), (&json!("IV"), &json!(true)));
    // A stop shows where the motion comes to it, and not much before.
    let farthest = problem.train[0].outputs[0].iter().fold(0.0, |most: f64, own| most.max(own.abs()));
    let stop = of("xs")["value"].as_f64().unwrap();
    assert!((0.5 * farthest..farthest).contains(&stop), "{stop} {farthest}");
    assert_eq!(of("xs")["with"]["k"]["unit"], "N/m");
    let sentence = verdict_sentence(&found);
    assert!(
        sentence.starts_with("nothing is missing that these data would show; the weakest "),
        "{sentence}"
    );
    let told = best_places(&found.limits)[0];
    let value = format!(" that would have shown has {} = {}", told.parameter, limit_text(told).unwrap());
    assert!(sentence.ends_with(&value), "{sentence}");
}

#[test]
fn what_a_parameter_follows_shows_from_the_end_of_its_range_on() {
    let (experiment, problem) = nothing();
    let found = searched_for(&["viscous-friction"], &experiment, &problem);
    let place = experiment.fit.iter().position(|name| name == "c").unwrap();
    let (_, high) = experiment.patch.parameters["c"].range.unwrap();
    let room = high - found.base.train.point.knobs[place];
    let least = limit(&found, "viscous-friction").value.unwrap();
    assert!((room..1.2 * room).contains(&least), "{least} {room}");
}

#[test]
#[ignore = "takes several seconds: a whole search"]
fn noise_that_is_told_too_small_or_too_large_is_said() {
    let told = |times: f64| {
        let (mut experiment, mut problem) = nothing();
        problem.sigma[0] *= times;
        experiment.outputs[0].sigma = Some(problem.sigma[0]);
        let found = searched_for(&["constant-bias"], &experiment, &problem);
        (found.verdict, verdict_sentence(&found), doubts(&found, &experiment))
    };
    let (verdict, _, doubts) = told(1.0);
    assert_eq!((verdict, doubts), (Verdict::NothingMissing, Vec::new()));
    let (verdict, sentence, _) = told(0.25);
    assert_eq!(verdict, Verdict::CannotJudge);
    assert!(sentence.contains(" times its noise, although it looks like noise"), "{sentence}");
    let (verdict, _, quiet) = told(4.0);
    assert_eq!(verdict, Verdict::NothingMissing);
    assert!(quiet.len() == 1 && quiet[0].contains(" times the noise that the experiment tells"), "{quiet:?}");
}

#[test]
#[ignore = "takes several seconds: a whole search"]
fn what_holds_in_training_only_cannot_be_judged_or_is_doubted() {
    let shaken = |sigmas: f64, off: f64| {
        let (experiment, mut problem) = nothing();
        let [by, off] = [sigmas, off].map(|own| own * problem.sigma[0]);
        let each = |records: &mut Vec<Record>, by: f64| {
            let wild = |(place, x): (usize, &mut f64)| *x += off + if place % 2 == 0 { by } else { -by };
            records.iter_mut().flat_map(|record| record.outputs[0].iter_mut().enumerate()).for_each(wild);
        };
        each(&mut problem.train, 0.0);
        each(&mut problem.test, by);
        let found = searched_for(&["constant-bias"], &experiment, &problem);
        (found.verdict, verdict_sentence(&found), doubts(&found, &experiment))
    };
    for sigmas in [0.7, 3.0] {
        let (verdict, sentence, doubts) = shaken(sigmas, 0.0);
        assert_eq!((verdict, doubts), (Verdict::CannotJudge, Vec::new()));
        assert!(sentence.ends_with("something has changed by then, or shows there alone"), "{sentence}");
    }
    let (verdict, sentence, doubts) = shaken(0.7, 5.0);
    assert_eq!((verdict, sentence.as_str()), (Verdict::Named, "constant-bias at IV is missing"));
    assert!(doubts.len() == 1 && doubts[0].contains("or shows there alone"), "{doubts:?}");
}

#[test]
fn an_integrator_that_gives_no_signal_is_told() {
    let (mut experiment, problem) = nothing();
    let mut document = experiment.patch.value().clone();
    document["signals"].as_object_mut().unwrap().retain(|name, _| name == "x");
    experiment.patch = Patch::parse("nameless.json", &document.to_string()).unwrap();
    let found = searched_for(&["constant-bias"], &experiment, &problem);
    let doubts = doubts(&found, &experiment);
    let is_told =
        |own: &String| own.starts_with("IV gives no signal with a scale, so that nothing is tried there");
    assert!(doubts.iter().any(is_told), "{doubts:?}");
}

#[test]
fn where_no_effect_has_a_place_nothing_can_be_judged() {
    let (experiment, problem) = nothing();
    let found = searched_for(&["overflow"], &experiment, &problem);
    assert_eq!((found.verdict, &found.blind), (Verdict::CannotJudge, &Some(Blind::Nowhere)));
    assert_eq!(nowhere_sentence(&found.places).unwrap(), "The patch has no place for overflow.");
    assert_eq!(document(&problem, &found)["nowhere"], json!(["overflow"]));
}

/// So many samples of an oscillator that swings so far while a force so large is told.
fn swinging(samples: usize, force: f64, way: f64) -> (Experiment, Problem) {
    let swing = |size: f64| -> Vec<f64> {
        (0..samples).map(|sample| size * (8.0 * INTERVAL * sample as f64).sin()).collect()
    };
    measured(&swing(force), &swing(way))
}

#[test]
fn what_stands_still_cannot_be_judged() {
    let (experiment, problem) = swinging(600, 1e-6, 0.0);
    let found = searched(&experiment, &problem);
    assert_eq!((found.verdict, &found.blind), (Verdict::CannotJudge, &Some(Blind::Still)));
    assert_eq!(verdict_sentence(&found), "these data cannot judge: nothing moves in them beyond the noise");
}

#[test]
fn a_few_samples_cannot_be_judged() {
    let (experiment, problem) = swinging(20, 1.0, 1e-2);
    let found = searched(&experiment, &problem);
    assert_eq!(
        (found.verdict, &found.blind),
        (Verdict::CannotJudge, &Some(Blind::Effects)),
        "{:?}",
        found.limits
    );
    assert!(document(&problem, &found)["limits"].as_array().unwrap().iter().all(|own| own["seen"] == false));
}

/// A free swing tells of the shares of stiffness and damping in the mass, and a force of the mass.
#[test]
fn what_can_be_changed_together_is_told() {
    let swing = |sample: usize| {
        let time = INTERVAL * sample as f64;
        0.02 * (-0.5 * time).exp() * (12.0 * time).cos()
    };
    let stood: Vec<f64> = (0..800).map(swing).collect();
    let untold = |force: f64| {
        let forces: Vec<f64> = (0..800).map(|sample| force * f64::from(sample % 100)).collect();
        let (experiment, problem) = measured(&forces, &stood);
        let base = patchcord_ident::fit::base_fit::fit_base(&problem, &experiment.patch, &experiment.fit, 1)
            .unwrap()
            .unwrap();
        undetermined_sentence(&patchcord_ident::fit::intervals::with_errors(&problem, base).unwrap())
    };
    let told = untold(1e-9).unwrap();
    assert!(told.starts_with("These data do not tell M, k, c: their values"), "{told}");
    assert_eq!(untold(0.1), None);
}

/// Of a sensor that is not connected, or a thing that is held fast: a friction that nothing overcomes would explain it.
#[test]
fn noise_alone_is_explained_by_nothing() {
    let (experiment, problem) = swinging(600, 10.0, 0.0);
    let found = searched_for(&["coulomb-friction"], &experiment, &problem);
    assert_eq!((found.verdict, &found.blind), (Verdict::CannotJudge, &Some(Blind::Still)));
}
