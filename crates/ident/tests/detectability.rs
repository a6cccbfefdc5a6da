//! Detection limits: the smallest detectable effects, and data in which no effect is detectable.

use std::path::Path;

use serde_json::{Value, json};

use super::library;
use super::oscillator::{INTERVAL, measured};
use super::search::document;
use patchcord_core::patch::Patch;
use patchcord_ident::design::detectability::{DetectionLimit, best_sites};
use patchcord_ident::fit::problem::Problem;
use patchcord_ident::report::detection_limits::limit_text;
use patchcord_ident::report::doubts::doubts;
use patchcord_ident::report::effect_sites::inapplicable_effects_sentence;
use patchcord_ident::report::sentence::verdict_sentence;
use patchcord_ident::report::values::undetermined_sentence;
use patchcord_ident::search::inconclusive::Inconclusive;
use patchcord_ident::search::{Outcome, SearchSettings, Verdict};
use patchcord_ident::{Experiment, Record};

/// An experiment on a spring whose patch lacks viscous friction.
const SPRING: &str = "../../examples/05_missing_effect/spring.experiment.json";

/// The library of these tests: one effect each of an offset, friction, a contact and a delay.
const EFFECTS: [&str; 4] = ["constant-bias", "coulomb-friction", "hard-stop", "time-delay"];

/// The verdict of a patch whose residual is below the declared noise.
const AGREES: &str = "the patch agrees with the data within the declared noise; no effect was searched";

/// The search with the library of EFFECTS.
fn search(experiment: &Experiment, problem: &Problem) -> Outcome {
    search_for(&EFFECTS, experiment, problem)
}

/// The search with a library of these effects, on two threads.
fn search_for(effects: &[&str], experiment: &Experiment, problem: &Problem) -> Outcome {
    let library = library::with_effects(effects);
    let settings = SearchSettings::new(&library).with_threads(2);
    patchcord_ident::search::search(experiment, problem, &settings, |_| ()).unwrap().unwrap()
}

/// Data of an oscillator without a missing effect, made by benches/hidden.
fn complete_oscillator() -> (Experiment, Problem) {
    let experiment = Experiment::read(Path::new("tests/hidden/nothing/experiment.json"));
    let experiment = experiment.unwrap_or_else(|error| panic!("{error}"));
    let problem = Problem::of(&experiment).unwrap();
    (experiment, problem)
}

/// The first detection limit of an effect.
fn limit<'o>(outcome: &'o Outcome, effect: &str) -> &'o DetectionLimit {
    outcome.detection_limits.iter().find(|limit| limit.effect == effect).unwrap()
}

#[test]
#[ignore = "takes several seconds: a whole search"]
fn a_bias_is_named_at_twice_its_detection_limit_and_not_at_half_of_it() {
    let (experiment, problem) = complete_oscillator();
    let without_effect = search(&experiment, &problem);
    assert_eq!(without_effect.verdict, Verdict::NothingMissing);
    let least = limit(&without_effect, "constant-bias").value.unwrap();
    let values = &without_effect.base.train.estimate.parameters;
    let stiffness = values[experiment.fit.iter().position(|name| name == "k").unwrap()];
    // A constant force shifts all positions by force / stiffness.
    let search_with_bias = |force: f64| {
        let mut problem = problem.clone();
        let records = problem.train.iter_mut().chain(&mut problem.validation);
        records.flat_map(|record| &mut record.outputs[0]).for_each(|x| *x += force / stiffness);
        search(&experiment, &problem)
    };
    assert_eq!(search_with_bias(0.5 * least).verdict, Verdict::NothingMissing);
    let outcome = search_with_bias(2.0 * least);
    assert_eq!(outcome.verdict, Verdict::Named);
    assert_eq!(outcome.rounds[0].trials[0].candidate.effect, "constant-bias");
}

#[test]
#[ignore = "takes several seconds: a whole search"]
fn detection_limits_are_reported_if_nothing_is_missing() {
    let (experiment, problem) = complete_oscillator();
    let outcome = search(&experiment, &problem);
    let document = document(&experiment, &problem, &outcome);
    let limits: Vec<&Value> = document["limits"].as_array().unwrap().iter().collect();
    let of = |parameter: &str| *limits.iter().find(|limit| limit["parameter"] == parameter).unwrap();
    assert_eq!(of("Fc")["unit"], "N");
    assert_eq!((&of("b")["junction"], &of("b")["seen"]), (&json!("IV"), &json!(true)));
    // A stop is detectable only if the motion reaches it.
    let farthest = problem.train[0].outputs[0].iter().fold(0.0, |most: f64, x| most.max(x.abs()));
    let stop = of("xs")["value"].as_f64().unwrap();
    assert!((0.5 * farthest..farthest).contains(&stop), "{stop} {farthest}");
    assert_eq!(of("xs")["with"]["k"]["unit"], "N/m");
    let sentence = verdict_sentence(&outcome);
    assert!(
        sentence.starts_with("no missing effect is detectable in these data; the smallest detectable "),
        "{sentence}"
    );
    let best = best_sites(&outcome.detection_limits)[0];
    let value = format!(" has {} = {}", best.parameter, limit_text(best).unwrap());
    assert!(sentence.ends_with(&value), "{sentence}");
}

#[test]
fn an_effect_that_a_parameter_imitates_is_detectable_beyond_the_range_of_that_parameter() {
    let (experiment, problem) = complete_oscillator();
    let outcome = search_for(&["viscous-friction"], &experiment, &problem);
    let index = experiment.fit.iter().position(|name| name == "c").unwrap();
    let (_, high) = experiment.patch.parameters["c"].range.unwrap();
    let margin = high - outcome.base.train.estimate.parameters[index];
    let least = limit(&outcome, "viscous-friction").value.unwrap();
    assert!((margin..1.2 * margin).contains(&least), "{least} {margin}");
}

#[test]
#[ignore = "takes several seconds: a whole search"]
fn noise_specified_too_small_or_too_large_is_reported() {
    let search_with_sigma = |factor: f64| {
        let (mut experiment, mut problem) = complete_oscillator();
        problem.sigma[0] *= factor;
        experiment.outputs[0].sigma = Some(problem.sigma[0]);
        let outcome = search_for(&["constant-bias"], &experiment, &problem);
        (outcome.verdict, verdict_sentence(&outcome), doubts(&outcome, &experiment))
    };
    let (verdict, _, doubts) = search_with_sigma(1.0);
    assert_eq!((verdict, doubts), (Verdict::NothingMissing, Vec::new()));
    let (verdict, sentence, _) = search_with_sigma(0.25);
    assert_eq!(verdict, Verdict::CannotJudge);
    assert!(sentence.contains(" times its noise, although it looks like noise"), "{sentence}");
    let (verdict, sentence, doubts) = search_with_sigma(4.0);
    assert_eq!((verdict, sentence.as_str()), (Verdict::NothingMissing, AGREES));
    assert!(
        doubts.len() == 1 && doubts[0].contains(" times the noise that the experiment specifies"),
        "{doubts:?}"
    );
}

/// The patch lacks the damping of a spring. It leaves 9 mm rms of a motion of 17 mm rms.
#[test]
fn no_effect_is_named_if_the_residual_is_below_the_declared_noise() {
    let search_with_sigma = |sigma: f64| {
        let mut experiment = Experiment::read(SPRING).unwrap_or_else(|error| panic!("{error}"));
        experiment.outputs[0].sigma = Some(sigma);
        let outcome = search_for(&["viscous-friction"], &experiment, &Problem::of(&experiment).unwrap());
        assert!(outcome.effects.is_empty() || outcome.verdict == Verdict::Named);
        (outcome.verdict, outcome.inconclusive.clone(), verdict_sentence(&outcome))
    };
    assert_eq!(search_with_sigma(15.0), (Verdict::NothingMissing, None, AGREES.to_owned()));
    let (verdict, reason, sentence) = search_with_sigma(40.0);
    assert_eq!((verdict, reason), (Verdict::CannotJudge, Some(Inconclusive::NoiseAboveMotion)));
    assert!(sentence.starts_with("inconclusive: the patch agrees with the data within the declared noise, "));
    assert_eq!(search_with_sigma(0.5).0, Verdict::Named);
}

/// Milliseconds that are read as seconds: the solver cannot follow the spring from sample to sample.
#[test]
#[ignore = "takes several seconds: fits with many steps"]
fn a_solver_error_above_the_noise_makes_the_search_inconclusive() {
    let mut experiment = Experiment::read(SPRING).unwrap_or_else(|error| panic!("{error}"));
    for record in experiment.train.iter_mut().chain(&mut experiment.validation) {
        // 100 samples keep the test short.
        record.outputs.iter_mut().for_each(|column| column.truncate(100));
        record.interval *= 1e3;
    }
    let problem = Problem::of(&experiment).unwrap();
    let outcome = search_for(&["viscous-friction"], &experiment, &problem);
    assert_eq!((outcome.verdict, outcome.rounds.len()), (Verdict::CannotJudge, 0));
    assert!(outcome.step_refinement.exceeds_noise(), "{:?}", outcome.step_refinement);
    let sentence = verdict_sentence(&outcome);
    assert!(sentence.contains("check the unit of \"time\""), "{sentence}");
}

#[test]
#[ignore = "takes several seconds: a whole search"]
fn a_change_between_training_and_test_makes_the_search_inconclusive_or_doubtful() {
    // All data are shifted by `offset`. In the test, alternating samples are also shifted up and down. Both are in
    // sigmas.
    let search_disturbed = |alternation: f64, offset: f64| {
        let (experiment, mut problem) = complete_oscillator();
        let [alternation, offset] = [alternation, offset].map(|sigmas| sigmas * problem.sigma[0]);
        let disturb = |records: &mut Vec<Record>, alternation: f64| {
            let shift = |(index, x): (usize, &mut f64)| {
                *x += offset + if index % 2 == 0 { alternation } else { -alternation };
            };
            records.iter_mut().flat_map(|record| record.outputs[0].iter_mut().enumerate()).for_each(shift);
        };
        disturb(&mut problem.train, 0.0);
        disturb(&mut problem.validation, alternation);
        let outcome = search_for(&["constant-bias"], &experiment, &problem);
        (outcome.verdict, verdict_sentence(&outcome), doubts(&outcome, &experiment))
    };
    for sigmas in [0.7, 3.0] {
        let (verdict, sentence, doubts) = search_disturbed(sigmas, 0.0);
        assert_eq!((verdict, doubts), (Verdict::CannotJudge, Vec::new()));
        assert!(sentence.ends_with("the system has changed, or an effect acts only there"), "{sentence}");
    }
    let (verdict, sentence, doubts) = search_disturbed(0.7, 5.0);
    assert_eq!((verdict, sentence.as_str()), (Verdict::Named, "constant-bias at IV is missing"));
    assert!(doubts.len() == 1 && doubts[0].contains("an effect acts only there"), "{doubts:?}");
}

#[test]
fn an_integrator_without_a_signal_is_reported() {
    let (mut experiment, problem) = complete_oscillator();
    let mut document = experiment.patch.value().clone();
    document["signals"].as_object_mut().unwrap().retain(|name, _| name == "x");
    experiment.patch = Patch::parse("nameless.json", &document.to_string()).unwrap();
    let outcome = search_for(&["constant-bias"], &experiment, &problem);
    let doubts = doubts(&outcome, &experiment);
    let is_reported = |doubt: &String| {
        doubt.starts_with("No effect is tried at IV, because its output is not a signal with a scale")
    };
    assert!(doubts.iter().any(is_reported), "{doubts:?}");
}

#[test]
fn the_search_is_inconclusive_if_no_effect_fits_the_patch() {
    let (experiment, problem) = complete_oscillator();
    let outcome = search_for(&["overflow"], &experiment, &problem);
    assert_eq!(
        (outcome.verdict, &outcome.inconclusive),
        (Verdict::CannotJudge, &Some(Inconclusive::NoSites))
    );
    let sentence = inapplicable_effects_sentence(&outcome.effect_sites).unwrap();
    assert_eq!(sentence, "The patch has no place for overflow.");
    assert_eq!(document(&experiment, &problem, &outcome)["nowhere"], json!(["overflow"]));
}

/// Samples of an oscillator: force and position are in-phase sines with amplitudes in N and in m.
fn sine_data(samples: usize, force: f64, position: f64) -> (Experiment, Problem) {
    let sine = |amplitude: f64| -> Vec<f64> {
        (0..samples).map(|sample| amplitude * (8.0 * INTERVAL * sample as f64).sin()).collect()
    };
    measured(&sine(force), &sine(position))
}

#[test]
fn data_without_motion_are_inconclusive() {
    let (experiment, problem) = sine_data(600, 1e-6, 0.0);
    let outcome = search(&experiment, &problem);
    assert_eq!(
        (outcome.verdict, &outcome.inconclusive),
        (Verdict::CannotJudge, &Some(Inconclusive::NoMotion))
    );
    assert_eq!(verdict_sentence(&outcome), "inconclusive: the outputs do not move beyond the noise");
}

#[test]
fn data_with_few_samples_are_inconclusive() {
    let (experiment, problem) = sine_data(20, 1.0, 1e-2);
    let outcome = search(&experiment, &problem);
    assert_eq!(
        (outcome.verdict, &outcome.inconclusive),
        (Verdict::CannotJudge, &Some(Inconclusive::NothingDetectable)),
        "{:?}",
        outcome.detection_limits
    );
    assert!(
        document(&experiment, &problem, &outcome)["limits"]
            .as_array()
            .unwrap()
            .iter()
            .all(|limit| limit["seen"] == false)
    );
}

/// A free oscillation determines only k/M and c/M. A force determines M, too.
#[test]
fn parameters_of_which_only_ratios_are_determined_are_reported() {
    let position = |sample: usize| {
        let time = INTERVAL * sample as f64;
        0.02 * (-0.5 * time).exp() * (12.0 * time).cos()
    };
    let positions: Vec<f64> = (0..800).map(position).collect();
    let undetermined = |force: f64| {
        let forces: Vec<f64> = (0..800).map(|sample| force * f64::from(sample % 100)).collect();
        let (experiment, problem) = measured(&forces, &positions);
        let base = patchcord_ident::fit::base_fit::fit_base(&problem, &experiment.patch, &experiment.fit, 1)
            .unwrap()
            .unwrap();
        undetermined_sentence(&patchcord_ident::fit::intervals::with_standard_errors(&problem, base).unwrap())
    };
    let sentence = undetermined(1e-9).unwrap();
    assert!(sentence.starts_with("These data do not determine M, k, c: their values"), "{sentence}");
    assert_eq!(undetermined(0.1), None);
}

/// Such data come from a disconnected sensor or a blocked mass. A very large friction would explain them.
#[test]
fn data_that_are_only_noise_are_inconclusive() {
    let (experiment, problem) = sine_data(600, 10.0, 0.0);
    let outcome = search_for(&["coulomb-friction"], &experiment, &problem);
    assert_eq!(
        (outcome.verdict, &outcome.inconclusive),
        (Verdict::CannotJudge, &Some(Inconclusive::NoMotion))
    );
}
