//! Localisation of missing effects: known forces are hidden in records, and the recovered force is compared with them.

use std::fmt::Write as _;
use std::path::Path;

use serde_json::{Value, json};

use super::noise::white;
use patchcord_core::circuit::Circuit;
use patchcord_core::ir::Program;
use patchcord_core::patch::{Edit, Patch};
use patchcord_core::solve::{RunSettings, run};
use patchcord_ident::Experiment;
use patchcord_ident::effects::Library;
use patchcord_ident::fit::fitted_model::FittedModel;
use patchcord_ident::fit::problem::Problem;
use patchcord_ident::localise::Localisation;
use patchcord_ident::report::Report;
use patchcord_ident::search::{SearchSettings, Verdict};

/// A patch with a hidden change, and how its records are measured.
pub(crate) struct HiddenCase {
    /// Name of the patch in crates/ident/tests/systems.
    system: &'static str,
    /// The hidden change: paths in the patch, and the values to write there.
    edits: Vec<(&'static [&'static str], Value)>,
    /// Name of the drive, and its value over time in s.
    drive: (&'static str, fn(f64) -> f64),
    /// Measured signals, each with the standard deviation of its noise.
    outputs: &'static [(&'static str, f64)],
    /// Parameters to fit.
    fit: &'static [&'static str],
    /// Sampling interval in s.
    interval: f64,
    samples: usize,
}

impl HiddenCase {
    /// The patch without the hidden change.
    pub(crate) fn patch(&self) -> Patch {
        Patch::read(self.file()).unwrap()
    }

    /// The path of the patch.
    fn file(&self) -> std::path::PathBuf {
        Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("tests/systems/{}.json", self.system))
    }

    /// Samples of signals of the patch with the hidden change, without noise.
    fn simulate(&self, names: &[&str]) -> Vec<Vec<f64>> {
        let patch = self.patch();
        let points: Vec<[f64; 2]> = self.times().map(|time| [time, (self.drive.1)(time)]).collect();
        let scale = patch.value()["drives"][self.drive.0]["scale"].clone();
        let drive = json!({"kind": "table", "scale": scale, "points": points});
        let edit = |(path, value): (&[&str], Value)| Edit::at(path.iter().copied(), value);
        let hidden = self.edits.iter().map(|(path, value)| edit((path, value.clone())));
        let edits: Vec<Edit> = hidden.chain([edit((&["drives", self.drive.0], drive))]).collect();
        let circuit = Circuit::new(&patch.with_edits("hidden.json", &edits).unwrap()).unwrap();
        let settings = RunSettings::of(&circuit)
            .unwrap()
            .with_duration(self.interval * (self.samples - 1) as f64)
            .with_step(self.interval / 10.0)
            .with_sample_interval(self.interval)
            .with_signals(names.iter().map(|name| (*name).to_owned()));
        let trace = run(&Program::new(&circuit).unwrap(), &settings).unwrap();
        names.iter().map(|name| trace.values(name).unwrap()).collect()
    }

    /// The times of the samples in s.
    fn times(&self) -> impl Iterator<Item = f64> {
        let interval = self.interval;
        (0..self.samples).map(move |sample| sample as f64 * interval)
    }

    /// The fit problem of the measured experiment, and the patch without the hidden change fitted to it.
    fn fitted(&self) -> (Problem, FittedModel) {
        let experiment = self.measured();
        let problem = Problem::of(&experiment).unwrap();
        let model = patchcord_ident::fit::base_fit::fit_base(&problem, &experiment.patch, &experiment.fit, 1)
            .unwrap()
            .unwrap();
        (problem, model)
    }

    /// The experiment of the patch without the hidden change, on noisy samples of the patch with it.
    pub(crate) fn measured(&self) -> Experiment {
        let folder = tempfile::tempdir().unwrap();
        let names: Vec<&str> = self.outputs.iter().map(|output| output.0).collect();
        let mut noise = white(4);
        let mut csv = format!("t,{},{}\n", self.drive.0, names.join(","));
        let signals = self.simulate(&names);
        for (sample, time) in self.times().enumerate() {
            let measured =
                signals.iter().zip(self.outputs).map(|(signal, (_, sigma))| signal[sample] + sigma * noise());
            let cells = [time, (self.drive.1)(time)].into_iter().chain(measured);
            let cells: Vec<String> = cells.map(|cell| format!("{cell:e}")).collect();
            writeln!(csv, "{}", cells.join(",")).unwrap();
        }
        std::fs::write(folder.path().join("data.csv"), csv).unwrap();
        let outputs = self
            .outputs
            .iter()
            .map(|(name, sigma)| ((*name).to_owned(), json!({"column": name, "sigma": sigma})));
        let experiment = json!({
            "patch": self.file(), "data": "data.csv", "drives": {self.drive.0: self.drive.0},
            "outputs": outputs.collect::<serde_json::Map<_, _>>(), "fit": self.fit,
        });
        let experiment = Experiment::parse_in(folder.path(), "experiment.json", &experiment.to_string());
        experiment.unwrap_or_else(|error| panic!("{error}"))
    }
}

/// A bell curve at x, with a height, a centre and a standard deviation.
fn bell(height: f64, centre: f64, width: f64, x: f64) -> f64 {
    height * (-((x - centre) / width).powi(2) / 2.0).exp()
}

/// Two tanks with a hidden inflow into the lower one, mainly between 900 and 1100 s.
fn tanks(fit: &'static [&'static str]) -> HiddenCase {
    let points: Vec<[f64; 2]> =
        (0..=240).map(|index| [10.0 * f64::from(index), inflow(10.0 * f64::from(index))]).collect();
    HiddenCase {
        system: "tanks",
        edits: vec![
            (&["drives", "W"], json!({"kind": "table", "scale": "flow", "points": points})),
            (&["elements", "BW"], json!({"kind": "inverter", "in": "W"})),
            (&["elements", "S2", "in", "x1"], json!(["BW"])),
        ],
        drive: ("u", |time| 5.0 + 3.0 * (time / 90.0).sin() + 1.5 * (time / 37.0).sin()),
        outputs: &[("h1", 5e-4), ("h2", 5e-4)],
        fit,
        interval: 1.0,
        samples: 2400,
    }
}

/// The hidden inflow in m3/s.
fn inflow(time: f64) -> f64 {
    bell(2e-5, 1000.0, 50.0, time)
}

/// An oscillator with a hidden force that is a bell curve of its position, centred at 0.05 m.
pub(crate) fn oscillator() -> HiddenCase {
    let drive =
        |time: f64| 14.0 * (8.0 * time).sin() + 16.0 * (11.3 * time).sin() + 10.0 * (3.1 * time).sin();
    oscillator_with_force(bell_force, drive)
}

/// An oscillator with a hidden force in N as a function of its position in m, under a drive in N over time in s.
fn oscillator_with_force(force: fn(f64) -> f64, drive: fn(f64) -> f64) -> HiddenCase {
    let points: Vec<[f64; 2]> =
        (-50..=50).map(|volts| [f64::from(volts), force(0.004 * f64::from(volts)) / 2.0]).collect();
    HiddenCase {
        system: "oscillator",
        edits: vec![
            (&["elements", "G1"], json!({"kind": "function-generator", "in": "IX", "points": points})),
            (&["elements", "BG"], json!({"kind": "inverter", "in": "G1"})),
            (&["elements", "SF", "in", "x1"], json!(["BF", "BG"])),
        ],
        drive: ("F", drive),
        outputs: &[("x", 3e-4)],
        fit: &["M", "k", "c"],
        interval: 0.005,
        samples: 2400,
    }
}

/// The hidden force in N at a position in m.
fn bell_force(x: f64) -> f64 {
    bell(6.0, 0.05, 0.02, x)
}

/// The share of points whose value is within two standard errors of the truth.
///
/// The first three numbers of a point are the abscissa, the value and its standard error.
fn share_within_two_errors<const N: usize>(points: &[[f64; N]], truth: impl Fn(f64) -> f64) -> f64 {
    let within = points.iter().filter(|point| (point[1] - truth(point[0])).abs() < 2.0 * point[2]).count();
    within as f64 / points.len() as f64
}

#[test]
#[ignore = "takes several seconds: a whole search"]
fn an_inflow_is_localised_at_its_tank_and_in_its_time_window() {
    let (problem, base) = tanks(&["ku", "R1", "R2"]).fitted();
    let localisations = patchcord_ident::localise::localise(&problem, &base).unwrap();
    let junctions: Vec<&str> =
        localisations.iter().map(|localisation| localisation.junction.as_str()).collect();
    assert_eq!(junctions, ["I2", "I1"]);
    let [lower, upper] = [&localisations[0], &localisations[1]];
    assert!(lower.evidence > upper.evidence + 10.0, "{} {}", lower.evidence, upper.evidence);
    assert!(lower.explained_fraction > 0.99, "{}", lower.explained_fraction);
    assert_eq!((lower.unit.as_str(), lower.best_regressor()), ("m3/s", "time"));
    let force = &lower.inputs[0];
    // About 95 % are expected. The points are not independent, so the limit is lower.
    let covered = share_within_two_errors(&force.points, inflow);
    assert!(covered > 0.85, "{covered}");
    let highest = force.points.iter().max_by(|a, b| a[1].total_cmp(&b[1])).unwrap();
    assert!((highest[1] / 2e-5 - 1.0).abs() < 0.1 && highest[2] < 4e-6, "{highest:?}");
    let [from, to] = force.windows[0];
    assert!(
        force.windows.len() == 1 && (850.0..950.0).contains(&from) && (1050.0..1150.0).contains(&to),
        "{from} {to}"
    );
}

#[test]
#[ignore = "takes several seconds: a whole search"]
fn standard_errors_agree_with_the_errors_of_the_recovered_force() {
    let (problem, base) = tanks(&[]).fitted();
    let localisations = patchcord_ident::localise::localise(&problem, &base).unwrap();
    let points = &localisations[0].inputs[0].points;
    assert_eq!(localisations[0].junction, "I2");
    // The mean square error in units of the standard error is about 1. It is less where the inflow is 0, because the
    // force is smoother there.
    let sum = points.iter().map(|point| ((point[1] - inflow(point[0])) / point[2]).powi(2)).sum::<f64>();
    let mean_square = sum / points.len() as f64;
    assert!((0.2..1.5).contains(&mean_square), "{mean_square}");
    assert!(share_within_two_errors(points, inflow) > 0.9);
}

#[test]
#[ignore = "takes several seconds: a whole search"]
fn a_force_over_position_is_recovered_as_a_function_generator() {
    let (problem, base) = oscillator().fitted();
    let localisations = patchcord_ident::localise::localise(&problem, &base).unwrap();
    let best: &Localisation = &localisations[0];
    assert_eq!((best.junction.as_str(), best.best_regressor()), ("IV", "x"));
    let curve = &best.curves[best.best_curve.unwrap()];
    let around: Vec<[f64; 3]> =
        curve.points.iter().copied().filter(|point| (-0.05..0.1).contains(&point[0])).collect();
    assert!(share_within_two_errors(&around, bell_force) > 0.8, "{around:?}");
    assert_eq!(best.recovered.elements["E1.G1"].kind.name, "function-generator");
    let with_force =
        patchcord_ident::fit::base_fit::fit_base(&problem, &best.recovered, &base.variant.fit, 1)
            .unwrap()
            .unwrap();
    let gaps = [&base, &with_force].map(|model| [model.excess_rms(), model.validation.normalised_rms()]);
    assert!(gaps[1][0] < 0.3 * gaps[0][0] && gaps[1][1] < 0.3 * gaps[0][1], "{gaps:?}");
    assert!(curve.validation_fraction.unwrap() > 0.9, "{:?}", curve.validation_fraction);
}

/// The friction force jumps where the velocity changes its sign. These times depend on the recovered curve itself.
#[test]
#[ignore = "takes several seconds: a whole search"]
fn coulomb_friction_is_recovered_as_a_force_over_velocity() {
    // 120 N on 400 kg are 0.3 V at a gain of 1000.
    let brake = json!({"kind": "pot", "in": "+100", "setting": 0.003});
    let hidden = HiddenCase {
        system: "slide",
        edits: vec![(&["elements", "PB"], brake), (&["elements", "IV", "in", "brake_x1000"], json!(["PB"]))],
        drive: ("v_i", |time| 0.012 * (9.0 * time).sin() + 0.012 * (23.0 * time + 1.0).sin()),
        outputs: &[("x_error", 2e-8)],
        fit: &["M", "f"],
        interval: 0.001,
        samples: 2400,
    };
    let (problem, base) = hidden.fitted();
    let localisations = patchcord_ident::localise::localise(&problem, &base).unwrap();
    assert_eq!((localisations[0].junction.as_str(), localisations[0].best_regressor()), ("IV", "v"));
    let curve = &localisations[0].curves[localisations[0].best_curve.unwrap()];
    assert!(
        curve.explained_fraction > 0.994 && curve.validation_fraction.unwrap() > 0.96,
        "{} {:?}",
        curve.explained_fraction,
        curve.validation_fraction
    );
}

/// The hidden force makes the spring so soft on one side that the patch without it loses the phase of the data.
/// The curve is then found by fits to increasing parts of the record.
#[test]
#[ignore = "takes several seconds: a whole search"]
fn a_strong_nonlinear_spring_is_recovered_as_a_force_over_position() {
    let spring = |x: f64| -3000.0 * x * x;
    let tones = |time: f64| {
        let tones = [(4.0, 2.5), (3.0, 5.7), (3.0, 10.7), (3.0, 14.5), (2.0, 19.5)];
        tones.iter().map(|(amplitude, omega)| amplitude * (omega * time).sin()).sum()
    };
    let (problem, base) = oscillator_with_force(spring, tones).fitted();
    assert!(base.excess_rms() > 10.0, "{}", base.excess_rms());
    let localisations = patchcord_ident::localise::localise(&problem, &base).unwrap();
    assert_eq!((localisations[0].junction.as_str(), localisations[0].best_regressor()), ("IV", "x"));
    let curve = &localisations[0].curves[localisations[0].best_curve.unwrap()];
    assert!(
        curve.explained_fraction > 0.999 && curve.validation_fraction.unwrap() > 0.9,
        "{} {:?}",
        curve.explained_fraction,
        curve.validation_fraction
    );
}

#[test]
#[ignore = "takes several seconds: a whole search"]
fn an_unknown_effect_is_reported_with_its_force_and_the_thread_count_does_not_matter() {
    let hidden = tanks(&["ku"]);
    let experiment = hidden.measured();
    let problem = Problem::of(&experiment).unwrap();
    let library = Library::default();
    let [one_thread, two_threads] = [1, 2].map(|threads| {
        let settings = SearchSettings::new(&library).with_threads(threads);
        patchcord_ident::search::search(&experiment, &problem, &settings, |_| ()).unwrap().unwrap()
    });
    assert_eq!(one_thread.verdict, Verdict::UnknownEffect);
    let [report, other_report] =
        [&one_thread, &two_threads].map(|outcome| Report::new(&experiment, &problem, outcome));
    let document = report.json();
    assert_eq!(document, other_report.json());
    let localisation = &document["where"][0];
    assert_eq!((&localisation["junction"], &localisation["best_against"]), (&"I2".into(), &"time".into()));
    let recovered = report.recovered("recovered.json").unwrap().unwrap();
    assert_eq!(recovered.drives["E1-D1"].kind.name, "table");
    Circuit::new(&recovered).unwrap_or_else(|report| panic!("{report}"));
}
