//! Unit tests of `simulation`.

use super::*;
use crate::data::file_source::GivenFiles;
use patchcord_core::circuit::Circuit;
use patchcord_core::document::Phase;
use patchcord_core::ir::Program;
use patchcord_core::patch::Patch;
use patchcord_core::solve::{RunSettings, run};

/// The integral of a drive, times -a, from the initial voltage x0. The drive u is a ramp of 1 V/s in the data.
const INTEGRAL: &str = r#"{
  "patchcord": 1,
  "parameters": {
    "a": {"value": 2, "unit": "1", "range": [0, 10]},
    "x0": {"value": 10, "unit": "1", "range": [-50, 50]}
  },
  "scales": {"volts": {"per_volt": 1, "unit": "V"}},
  "drives": {"u": {"kind": "step", "height": 1, "scale": "volts"}},
  "elements": {
    "P1": {"kind": "pot", "in": "u", "setting": "a / 10"},
    "A1": {"kind": "integrator", "in": {"x10": ["P1"]}, "initial": "x0"}
  },
  "run": {"for": 2, "step": 0.01}
}"#;

/// The experiment on that patch: 41 samples from 0 to 2 s, of which the last quarter is for validation.
fn integral() -> Experiment {
    let patch = Patch::parse("integral.json", INTEGRAL).unwrap_or_else(|report| panic!("{report}"));
    let times = (0..41).map(|sample| 0.05 * f64::from(sample));
    let rows: Vec<String> = times.map(|time| format!("{time},{time},{}\n", 10.0 - time * time)).collect();
    let data = format!("t,u,y\n{}", rows.concat());
    let files = GivenFiles { patch: &patch, data: &[("data.csv", data.as_str())] };
    let text = r#"{"patch": "integral.json", "data": "data.csv", "drives": {"u": "u"}, "outputs": {"A1": "y"},
        "fit": ["a"]}"#;
    Experiment::parse_given(&files, "e.json", text).unwrap_or_else(|error| panic!("{error}"))
}

fn spring() -> Experiment {
    let path = "../../examples/05_missing_effect/spring.experiment.json";
    Experiment::read(path).unwrap_or_else(|error| panic!("{error}"))
}

/// The outputs of an experiment with these changes of parameters.
fn simulate(
    experiment: &Experiment,
    parameters: &[(String, f64)],
) -> Result<Vec<SimulatedRecord>, ModelError> {
    Simulation::new(experiment, &Problem::of(experiment)?)?.run(parameters)
}

/// Changes of parameters.
fn changes(values: &[(&str, f64)]) -> Vec<(String, f64)> {
    values.iter().map(|(name, value)| ((*name).to_owned(), *value)).collect()
}

/// In every record, which begins at the time b, the drive is b + t. So the output is x0 - a (b t + t^2 / 2).
#[test]
fn drives_and_parameters_determine_the_outputs() {
    let experiment = integral();
    let simulation = Simulation::new(&experiment, &Problem::of(&experiment).unwrap()).unwrap();
    for (a, x0) in [(2.0, 10.0), (0.5, -20.0), (10.0, 50.0)] {
        let simulated = simulation.run(&changes(&[("a", a), ("x0", x0)])).unwrap();
        let records = experiment.train.iter().chain(&experiment.validation);
        assert_eq!(simulated.len(), records.clone().count());
        for (simulated, record) in simulated.iter().zip(records) {
            assert_eq!(simulated.outputs[0].len(), record.len());
            for (sample, volts) in (0..).zip(&simulated.outputs[0]) {
                let time = record.interval * f64::from(sample);
                let expected = x0 - a * (record.begin * time + time * time / 2.0);
                assert!((volts - expected).abs() < 1e-9, "{a} {x0} {time}: {volts} instead of {expected}");
            }
        }
    }
    assert_eq!(simulation.run(&[]).unwrap(), simulation.run(&changes(&[("a", 2.0), ("x0", 10.0)])).unwrap());
}

/// The mass of 1 kg on a spring k, released at 50 mm, moves as 50 mm cos(sqrt(k) t). The solver error is below a tenth
/// of the noise, which is 0.5 mm.
#[test]
fn the_spring_swings_as_its_closed_solution() {
    let experiment = spring();
    for stiffness in [40.0, 10.0_f64] {
        let simulated = simulate(&experiment, &changes(&[("k", stiffness)])).unwrap();
        for (simulated, record) in simulated.iter().zip(experiment.train.iter().chain(&experiment.validation))
        {
            for (sample, position) in (0..).zip(&simulated.outputs[0]) {
                let time = record.interval * f64::from(sample);
                let expected = 50.0 * (stiffness.sqrt() * time).cos();
                assert!((position - expected).abs() < 0.05, "{time}: {position} instead of {expected}");
            }
        }
    }
}

#[test]
fn a_simulation_equals_a_run_of_the_patch() {
    let experiment = spring();
    let problem = Problem::of(&experiment).unwrap();
    let simulated = simulate(&experiment, &[]).unwrap();
    let program = Program::new(&Circuit::new(&experiment.patch).unwrap()).unwrap();
    let record = &experiment.train[0];
    let phases = vec![Phase::InitialCondition, Phase::operate(record.duration())];
    let settings = RunSettings::from_phases(phases, record.interval / f64::from(problem.steps));
    let trace = run(&program, &settings.with_sample_interval(record.interval).with_signals(["x"])).unwrap();
    assert_eq!(trace.values("x").unwrap()[..record.len()], simulated[0].outputs[0]);
}

#[test]
fn an_unknown_parameter_or_a_value_outside_its_range_is_an_error() {
    let experiment = spring();
    let message = |name, value| simulate(&experiment, &changes(&[(name, value)])).unwrap_err().to_string();
    assert_eq!(message("k", 1000.0), "k = 1000 N/m is outside its range 1 ... 100 N/m");
    assert!(message("stiffness", 40.0).contains("stiffness"));
}

/// With 0.4 kg and 0.6 N s/m the table reaches 1 m/s, which is 100 V, at 0.227 s by an independent integration.
#[test]
fn the_first_overload_has_its_amplifier_and_its_time() {
    let path = "../../examples/05_missing_effect/slide.experiment.json";
    let experiment = Experiment::read(path).unwrap_or_else(|error| panic!("{error}"));
    let simulated = simulate(&experiment, &[]).unwrap();
    let overload = simulated[0].overload.as_ref().unwrap();
    assert_eq!((overload.element.as_str(), &simulated[0].stopped), ("A1", &None));
    assert!((overload.time - 0.227).abs() < 0.005, "{overload:?}");
    assert!(simulate(&spring(), &[]).unwrap().iter().all(|record| record.overload.is_none()));
}
