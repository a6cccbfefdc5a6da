//! The example of docs/story.md: the data in patches/story follow the law of Fig 8.16 of the thesis. The searches begin
//! with the simpler patches of Figs 8.4 and 8.14, and must find the law that these lack.

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
use patchcord_ident::effects::attach::EffectPlacement;
use patchcord_ident::effects::candidate::Candidate;
use patchcord_ident::effects::reach::Extent;
use patchcord_ident::effects::sites::Sites;
use patchcord_ident::fit::fitted_model::FittedModel;
use patchcord_ident::fit::problem::Problem;
use patchcord_ident::report::sentence::verdict_sentence;
use patchcord_ident::search::{Outcome, SearchSettings, Verdict};

/// The parameters with which patches/story/slide.py made the data, in SI units, by their names in Fig 8.16.
const TRUTH: [(&str, f64); 6] =
    [("M", 433.0), ("K", 45e6), ("f", 10.7e3), ("Fs", 771.0), ("VcL", 10.16e-3), ("Tc", 6.5e-3)];
/// The same parameters by their names in Fig 8.4 with the effect friction-memory.
const TRUTH_WITH_MEMORY: [(&str, f64); 7] =
    [("M", 433.0), ("K", 45e6), ("f", 10.7e3), ("dF", 771.0), ("V0", 10.16e-3), ("Tc", 6.5e-3), ("Fc", 0.0)];
/// The same parameters if the patch already contains stribeck-friction, whose dF takes the name.
const TRUTH_AFTER_STRIBECK: [(&str, f64); 6] =
    [("M", 433.0), ("K", 45e6), ("f", 10.7e3), ("dF_1", 771.0), ("V0", 10.16e-3), ("Tc", 6.5e-3)];

/// The experiment that begins with the patch of a figure, such as "fig-8-14".
fn experiment(figure: &str) -> Experiment {
    let file = format!("../../patches/story/from-{figure}.experiment.json");
    Experiment::read(Path::new(&file)).unwrap_or_else(|error| panic!("{error}"))
}

/// The shipped patch of a figure of the thesis.
fn thesis_patch(figure: &str) -> Patch {
    Patch::read(Path::new(&format!("../../patches/thesis/{figure}.json"))).unwrap()
}

/// The search from the patch of a figure, with a library of a few effects.
fn search_figure(figure: &str, effects: &[&str]) -> (Problem, Outcome) {
    search(&experiment(figure), effects)
}

/// The search of an experiment with a library of a few effects, on two threads.
fn search(experiment: &Experiment, effects: &[&str]) -> (Problem, Outcome) {
    let problem = Problem::of(experiment).unwrap();
    let library = library::with_effects(effects);
    let settings = SearchSettings::new(&library).with_threads(2);
    let outcome = patchcord_ident::search::search(experiment, &problem, &settings, |_| ()).unwrap().unwrap();
    (problem, outcome)
}

/// Asserts that the fitted value of each parameter is within `tolerance`, a share of the true value, of the true value.
fn assert_fitted(outcome: &Outcome, truth: &[(&str, f64)], tolerance: f64) {
    let model = outcome.reported_model();
    for (name, expected) in truth {
        let index = model.variant.fit.iter().position(|fitted| fitted == name);
        let index = index.unwrap_or_else(|| panic!("{name} is not fitted"));
        let value = model.train.estimate.parameters[index];
        assert!((value - expected).abs() < tolerance * expected, "{name}: {value}, not {expected}");
    }
}

/// A velocity command that is not in the data: up to 10 mm/s in 0.5 s and back to 0 in another 0.5 s. In SI units.
const COMMAND: [(&str, f64); 4] = [("v_start", 0.0), ("v_rate", 20e-3), ("v_turn", 0.5), ("x_step", 0.0)];

/// Velocity and position error of a patch under that command, every 1 ms over 1 s.
fn run_with_command(patch: &Patch, set: &[(&str, f64)]) -> [Vec<f64>; 2] {
    let set: Vec<_> = COMMAND.iter().chain(set).map(|(name, value)| ((*name).to_owned(), *value)).collect();
    let circuit = Circuit::with_parameters(patch, set).unwrap_or_else(|report| panic!("{report}"));
    let program = Program::new(&circuit).unwrap_or_else(|report| panic!("{report}"));
    let names = ["v_o", "x_error"].map(str::to_owned);
    let settings = RunSettings::of(&circuit)
        .unwrap()
        .with_step(2e-5)
        .with_phases([Phase::InitialCondition, Phase::operate(1.0)])
        .with_sample_interval(1e-3)
        .with_signals(names.to_vec());
    let trace = solve::run(&program, &settings).unwrap();
    names.map(|name| trace.values(&name).unwrap())
}

/// The largest difference between two runs, as a share of the largest value of the second run. The larger of both
/// signals.
fn relative_difference(run: &[Vec<f64>; 2], reference: &[Vec<f64>; 2]) -> f64 {
    let peak =
        |values: &mut dyn Iterator<Item = f64>| values.fold(0.0, |peak: f64, value| peak.max(value.abs()));
    let share = |(signal, reference): (&Vec<f64>, &Vec<f64>)| {
        let pairs = signal.iter().zip(reference);
        peak(&mut pairs.map(|(a, b)| a - b)) / peak(&mut reference.iter().copied())
    };
    peak(&mut run.iter().zip(reference).map(share))
}

#[test]
fn with_the_true_parameters_fig_8_16_leaves_only_the_noise() {
    let mut experiment = experiment("fig-8-14");
    let edits = TRUTH.map(|(name, value)| Edit::at(["parameters", name, "value"], value));
    experiment.patch = thesis_patch("fig-8-16").with_edits("fig-8-16.json", &edits).unwrap();
    experiment.fit.clear();
    let problem = Problem::of(&experiment).unwrap();
    let model = patchcord_ident::fit::base_fit::fit_base(&problem, &experiment.patch, &experiment.fit, 1)
        .unwrap()
        .unwrap();
    for fitted in [&model.train, &model.validation] {
        let residual = fitted.normalised_rms();
        assert!((residual - 1.0).abs() < 0.05, "{residual}");
    }
}

/// The patch of Fig 8.4 with an effect whose friction level is the half width of a dead zone of the spring force.
fn fig_8_4_with(effect: &str) -> Patch {
    let patch = thesis_patch("fig-8-04");
    let circuit = Circuit::new(&patch).unwrap();
    let sites = Sites::of(&circuit, &["v_i"]);
    let library = library::with_effects(&[effect]);
    let attachments = EffectPlacement::all(library.get(effect).unwrap(), &sites);
    let placement = attachments.iter().find(|placement| placement.read_names() == ["spring_force"]).unwrap();
    let largest =
        placement.site.quantity_sizes(|role| Some(Extent::of([0.0, 10.0 * role.per_volt()])), 1e-3, 1.0);
    Candidate::new(placement, &patch, &largest, &[]).unwrap().unwrap().graft.patch
}

#[test]
fn fig_8_4_with_stribeck_friction_equals_fig_8_14_and_with_friction_memory_fig_8_16() {
    let without_memory = [&TRUTH_WITH_MEMORY[..5], &TRUTH_WITH_MEMORY[6..]].concat();
    let run = run_with_command(&fig_8_4_with("stribeck-friction"), &without_memory);
    let fig_8_14 = run_with_command(&thesis_patch("fig-8-14"), &TRUTH[..5]);
    let difference = relative_difference(&run, &fig_8_14);
    assert!(difference < 1e-6, "{difference}");
    let fig_8_16 = run_with_command(&thesis_patch("fig-8-16"), &TRUTH);
    let run = run_with_command(&fig_8_4_with("friction-memory"), &TRUTH_WITH_MEMORY);
    let difference = relative_difference(&run, &fig_8_16);
    assert!(difference < 1e-6, "{difference}");
    // The augmented patch that a search wrote, with its fitted values.
    let fitted = Patch::read(Path::new("tests/story/found.json")).unwrap();
    let difference = relative_difference(&run_with_command(&fitted, &[]), &fig_8_16);
    assert!(difference < 0.03, "{difference}");
    // Without memory the runs differ clearly.
    assert!(relative_difference(&fig_8_14, &fig_8_16) > 0.1);
}

/// The friction effects of the searches.
const FRICTION: [&str; 4] = ["coulomb-friction", "friction-memory", "stribeck-friction", "viscous-friction"];

#[test]
#[ignore = "takes a minute or more: searches on the data of the thesis"]
fn from_fig_8_14_friction_memory_is_named_at_its_place_in_the_thesis() {
    let (problem, outcome) = search_figure("fig-8-14", &FRICTION);
    assert_eq!(outcome.verdict, Verdict::Named);
    let document = document(&experiment("fig-8-14"), &problem, &outcome);
    let effects = document["effects"].as_array().unwrap();
    assert_eq!(effects.len(), 1);
    assert_eq!((&effects[0]["name"], &effects[0]["junction"]), (&json!("friction-memory"), &json!("X1")));
    assert_fitted(&outcome, &TRUTH[2..], 0.01);
    assert!(outcome.base.excess_rms() > 20.0 && outcome.reported_model().excess_rms() < 0.5);
    // After the multiplier that squares the share of friction, the memory is another law and fits worse.
    let after_square = outcome.rounds[0].trials.iter().find(|trial| trial.candidate.site == "M1").unwrap();
    assert!(after_square.model.excess_rms() > 4.0);
}

#[test]
#[ignore = "takes a minute or more: searches on the data of the thesis"]
fn from_fig_8_4_a_second_search_finds_the_memory_after_stribeck_friction() {
    // In a library without memory, stribeck-friction is the best effect, but its residual is too large for a name.
    let (_, first) = search_figure("fig-8-04", &["coulomb-friction", "stribeck-friction"]);
    assert_eq!(first.verdict, Verdict::UnknownEffect);
    let page = std::fs::read_to_string("../../docs/story.md").unwrap();
    assert!(page.contains(&verdict_sentence(&first)), "{}", verdict_sentence(&first));
    // The second search begins with the model that the first one fitted.
    let mut experiment = experiment("fig-8-04");
    let variant = &first.final_model.variant;
    experiment.patch =
        variant.patch_with_values("stribeck.json", &first.final_model.train.estimate.parameters).unwrap();
    experiment.fit = variant.fit.clone();
    let second = search(&experiment, &["coulomb-friction", "friction-memory", "stribeck-friction"]).1;
    assert_eq!(verdict_sentence(&second), "friction-memory at A3 is missing");
    assert_fitted(&second, &TRUTH_AFTER_STRIBECK, 0.01);
    let gaps = [&first.base, &first.final_model, second.reported_model()].map(FittedModel::excess_rms);
    assert!(gaps[1] < 0.5 * gaps[0] && gaps[2] < 0.01 * gaps[1], "{gaps:?}");
    // The friction that the first search added is now unnecessary: its fitted values are almost 0.
    let FittedModel { variant, train, .. } = second.reported_model();
    let mut values: Vec<_> =
        variant.fit.iter().map(String::as_str).zip(train.estimate.parameters.clone()).collect();
    for unnecessary in ["dF", "Fc"] {
        let (_, value) = values.iter_mut().find(|(name, _)| *name == unnecessary).unwrap();
        assert!(*value < 0.02 * 771.0, "{unnecessary}: {value}");
        *value = 0.0;
    }
    let run = run_with_command(variant.patch(), &values);
    let difference = relative_difference(&run, &run_with_command(&thesis_patch("fig-8-16"), &TRUTH));
    assert!(difference < 0.06, "{difference}");
}

#[test]
#[ignore = "takes a minute or more: searches on the data of the thesis"]
fn from_fig_8_4_friction_memory_is_named_and_the_model_runs_like_fig_8_16() {
    let (_, outcome) = search_figure("fig-8-04", &FRICTION);
    assert_eq!(verdict_sentence(&outcome), "friction-memory at A3 is missing");
    assert_fitted(&outcome, &TRUTH_WITH_MEMORY[..6], 0.01);
    // Each refinement of the friction law in the thesis reduces the residual.
    let least_gap = |effect: &str, reads: &[&str]| {
        let trials = outcome.rounds[0].trials.iter().filter(|trial| trial.candidate.effect == effect);
        let gaps =
            trials.filter(|trial| trial.candidate.reads == reads).map(|trial| trial.model.excess_rms());
        gaps.fold(f64::INFINITY, f64::min)
    };
    let gaps = [
        outcome.base.excess_rms(),
        least_gap("coulomb-friction", &[]),
        least_gap("stribeck-friction", &[]),
        least_gap("friction-memory", &[]),
        least_gap("friction-memory", &["spring_force"]),
    ];
    assert!(gaps.windows(2).all(|pair| pair[1] < pair[0]) && gaps[4].is_finite(), "{gaps:?}");
    let FittedModel { variant, train, .. } = outcome.reported_model();
    let values = variant.fit.iter().map(String::as_str).zip(train.estimate.parameters.iter().copied());
    let run = run_with_command(variant.patch(), &values.collect::<Vec<_>>());
    let difference = relative_difference(&run, &run_with_command(&thesis_patch("fig-8-16"), &TRUTH));
    assert!(difference < 0.03, "{difference}");
}
