//! Where and when something is missing: forces that are known, hidden in records, and what is recovered of them.

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
use patchcord_ident::fit::fitted_model::Stage;
use patchcord_ident::fit::problem::Problem;
use patchcord_ident::localise::Whereabouts;
use patchcord_ident::report::Report;
use patchcord_ident::search::{Means, Verdict};

/// Something that is hidden in a patch, and the records that it makes.
pub struct Hidden {
    /// Name of the patch in crates/ident/tests/systems.
    system: &'static str,
    /// What is put into it.
    edits: Vec<(&'static [&'static str], Value)>,
    drive: (&'static str, fn(f64) -> f64),
    /// Signals that are measured, each with its noise.
    outputs: &'static [(&'static str, f64)],
    fit: &'static [&'static str],
    interval: f64,
    samples: usize,
}

impl Hidden {
    pub fn patch(&self) -> Patch {
        Patch::read(&self.file()).unwrap()
    }

    fn file(&self) -> std::path::PathBuf {
        Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("tests/systems/{}.json", self.system))
    }

    /// Samples of signals of the patch with what is hidden.
    fn run(&self, names: &[&str]) -> Vec<Vec<f64>> {
        let patch = self.patch();
        let points: Vec<[f64; 2]> = self.times().map(|time| [time, (self.drive.1)(time)]).collect();
        let scale = patch.value()["drives"][self.drive.0]["scale"].clone();
        let drive = json!({"kind": "table", "scale": scale, "points": points});
        let edit = |(path, value): (&[&str], Value)| Edit {
            path: path.iter().map(|part| (*part).to_owned()).collect(),
            value,
        };
        let hidden = self.edits.iter().map(|(path, value)| edit((path, value.clone())));
        let edits: Vec<Edit> = hidden.chain([edit((&["drives", self.drive.0], drive))]).collect();
        let circuit = Circuit::new(&patch.edited("hidden.json", &edits).unwrap(), &[]).unwrap();
        let settings = RunSettings {
            step: self.interval / 10.0,
            every: self.interval,
            record: names.iter().map(|name| (*name).to_owned()).collect(),
            ..RunSettings::of(&circuit).unwrap().lasting(self.interval * (self.samples - 1) as f64)
        };
        let trace = run(&Program::new(&circuit).unwrap(), &settings).unwrap();
        names.iter().map(|name| trace.values(name).unwrap()).collect()
    }

    fn times(&self) -> impl Iterator<Item = f64> {
        let interval = self.interval;
        (0..self.samples).map(move |sample| sample as f64 * interval)
    }

    /// Measures it, with noise, and fits the patch as it is.
    fn fitted(&self) -> (Problem, Stage) {
        let experiment = self.measured();
        let problem = Problem::of(&experiment).unwrap();
        let stage = patchcord_ident::fit::base_fit::fit_base(&problem, &experiment.patch, &experiment.fit, 1)
            .unwrap()
            .unwrap();
        (problem, stage)
    }

    /// Measures it, with noise.
    pub fn measured(&self) -> Experiment {
        let folder = tempfile::tempdir().unwrap();
        let names: Vec<&str> = self.outputs.iter().map(|output| output.0).collect();
        let mut noise = white(4);
        let mut csv = format!("t,{},{}\n", self.drive.0, names.join(","));
        let tracks = self.run(&names);
        for (sample, time) in self.times().enumerate() {
            let measured =
                tracks.iter().zip(self.outputs).map(|(track, (_, sigma))| track[sample] + sigma * noise());
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

/// The value at the middle of a bell of this height and width.
fn bell(height: f64, middle: f64, width: f64, at: f64) -> f64 {
    height * (-((at - middle) / width).powi(2) / 2.0).exp()
}

/// Between 900 and 1100 s something flows into the lower tank that the patch does not have.
fn tanks(fit: &'static [&'static str]) -> Hidden {
    let points: Vec<[f64; 2]> =
        (0..=240).map(|place| [10.0 * f64::from(place), inflow(10.0 * f64::from(place))]).collect();
    Hidden {
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

fn inflow(time: f64) -> f64 {
    bell(2e-5, 1000.0, 50.0, time)
}

/// A hill of force at 0.05 m pushes an oscillator away.
pub fn oscillator() -> Hidden {
    let drive =
        |time: f64| 14.0 * (8.0 * time).sin() + 16.0 * (11.3 * time).sin() + 10.0 * (3.1 * time).sin();
    pushed(hill, drive)
}

/// An oscillator that is pushed by a force over its position, and by a drive.
fn pushed(force: fn(f64) -> f64, drive: fn(f64) -> f64) -> Hidden {
    let points: Vec<[f64; 2]> =
        (-50..=50).map(|volts| [f64::from(volts), force(0.004 * f64::from(volts)) / 2.0]).collect();
    Hidden {
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

fn hill(x: f64) -> f64 {
    bell(6.0, 0.05, 0.02, x)
}

/// The share of points of a curve that lie within two standard errors of what is true.
fn within_two_errors<const N: usize>(points: &[[f64; N]], truth: impl Fn(f64) -> f64) -> f64 {
    let within = points.iter().filter(|point| (point[1] - truth(point[0])).abs() < 2.0 * point[2]).count();
    within as f64 / points.len() as f64
}

#[test]
#[ignore = "takes several seconds: a whole search"]
fn a_flow_into_the_lower_tank_is_found_there_and_then() {
    let (problem, stage) = tanks(&["ku", "R1", "R2"]).fitted();
    let found = patchcord_ident::localise::localise(&problem, &stage, 2).unwrap();
    let junctions: Vec<&str> = found.iter().map(|own| own.junction.as_str()).collect();
    assert_eq!(junctions, ["I2", "I1"]);
    let [lower, upper] = [&found[0], &found[1]];
    assert!(lower.evidence > upper.evidence + 10.0, "{} {}", lower.evidence, upper.evidence);
    assert!(lower.explains > 0.99, "{}", lower.explains);
    assert_eq!((lower.unit.as_str(), lower.best_against()), ("m3/s", "time"));
    let force = &lower.forces[0];
    // 95 of 100 by chance, of points that are not independent.
    let covered = within_two_errors(&force.points, inflow);
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
fn errors_are_as_large_as_what_is_recovered_is_off() {
    let (problem, stage) = tanks(&[]).fitted();
    let found = patchcord_ident::localise::localise(&problem, &stage, 2).unwrap();
    let points = &found[0].forces[0].points;
    assert_eq!(found[0].junction, "I2");
    // In units of the standard errors, squared: 1 by chance, less where nothing flows and the force is smoother than elsewhere.
    let off = points.iter().map(|point| ((point[1] - inflow(point[0])) / point[2]).powi(2)).sum::<f64>();
    let off = off / points.len() as f64;
    assert!((0.2..1.5).contains(&off), "{off}");
    assert!(within_two_errors(points, inflow) > 0.9);
}

#[test]
#[ignore = "takes several seconds: a whole search"]
fn a_hill_of_force_goes_with_position_and_becomes_a_function_generator() {
    let (problem, stage) = oscillator().fitted();
    let found = patchcord_ident::localise::localise(&problem, &stage, 1).unwrap();
    let found: &Whereabouts = &found[0];
    assert_eq!((found.junction.as_str(), found.best_against()), ("IV", "x"));
    let curve = &found.curves[found.best.unwrap()];
    let around: Vec<[f64; 3]> =
        curve.points.iter().copied().filter(|point| (-0.05..0.1).contains(&point[0])).collect();
    assert!(within_two_errors(&around, hill) > 0.8, "{around:?}");
    assert_eq!(found.recovered.elements["E1.G1"].kind.name, "function-generator");
    let with = patchcord_ident::fit::base_fit::fit_base(&problem, &found.recovered, &stage.version.fit, 1)
        .unwrap()
        .unwrap();
    let gaps = [&stage, &with].map(|stage| [stage.gap(), stage.test.over_noise()]);
    assert!(gaps[1][0] < 0.3 * gaps[0][0] && gaps[1][1] < 0.3 * gaps[0][1], "{gaps:?}");
    assert!(curve.held_out.unwrap() > 0.9, "{:?}", curve.held_out);
}

/// The force of Coulomb friction jumps where the table turns, and that at places which the curve itself moves.
#[test]
#[ignore = "takes several seconds: a whole search"]
fn coulomb_friction_goes_with_velocity() {
    // 120 N of 400 kg, as 0.3 V at a gain of 1000.
    let brake = json!({"kind": "pot", "in": "+100", "setting": 0.003});
    let hidden = Hidden {
        system: "slide",
        edits: vec![(&["elements", "PB"], brake), (&["elements", "IV", "in", "brake_x1000"], json!(["PB"]))],
        drive: ("v_i", |time| 0.012 * (9.0 * time).sin() + 0.012 * (23.0 * time + 1.0).sin()),
        outputs: &[("x_error", 2e-8)],
        fit: &["M", "f"],
        interval: 0.001,
        samples: 2400,
    };
    let (problem, stage) = hidden.fitted();
    let found = patchcord_ident::localise::localise(&problem, &stage, 2).unwrap();
    assert_eq!((found[0].junction.as_str(), found[0].best_against()), ("IV", "v"));
    let curve = &found[0].curves[found[0].best.unwrap()];
    assert!(
        curve.explains > 0.994 && curve.held_out.unwrap() > 0.96,
        "{} {:?}",
        curve.explains,
        curve.held_out
    );
}

/// The spring grows so much softer to one side that the patch without that falls out of step.
#[test]
#[ignore = "takes several seconds: a whole search"]
fn a_curve_that_leads_astray_is_found_through_ever_more_of_the_record() {
    let spring = |x: f64| -3000.0 * x * x;
    let tones = |time: f64| {
        let tones = [(4.0, 2.5), (3.0, 5.7), (3.0, 10.7), (3.0, 14.5), (2.0, 19.5)];
        tones.iter().map(|(amplitude, speed)| amplitude * (speed * time).sin()).sum()
    };
    let (problem, stage) = pushed(spring, tones).fitted();
    assert!(stage.gap() > 10.0, "{}", stage.gap());
    let found = patchcord_ident::localise::localise(&problem, &stage, 2).unwrap();
    assert_eq!((found[0].junction.as_str(), found[0].best_against()), ("IV", "x"));
    let curve = &found[0].curves[found[0].best.unwrap()];
    assert!(
        curve.explains > 0.999 && curve.held_out.unwrap() > 0.9,
        "{} {:?}",
        curve.explains,
        curve.held_out
    );
}

#[test]
#[ignore = "takes several seconds: a whole search"]
fn what_has_no_name_comes_with_its_force_whatever_the_threads() {
    let hidden = tanks(&["ku"]);
    let (problem, stage) = hidden.fitted();
    let library = Library::default();
    let [one, two] = [1, 2].map(|threads| {
        let with = Means { library: &library, threads, seed: 1 };
        patchcord_ident::search::search(&problem, &hidden.patch(), &stage.version.fit, &with, |_| ())
            .unwrap()
            .unwrap()
    });
    assert_eq!(one.verdict, Verdict::UnknownEffect);
    let experiment = hidden.measured();
    let [report, other] = [&one, &two].map(|outcome| Report::new(&experiment, &problem, outcome));
    let document = report.json();
    assert_eq!(document, other.json());
    let told = &document["where"][0];
    assert_eq!((&told["junction"], &told["best_against"]), (&"I2".into(), &"time".into()));
    let recovered = report.recovered("recovered.json").unwrap().unwrap();
    assert_eq!(recovered.drives["E1-D1"].kind.name, "table");
    Circuit::new(&recovered, &[]).unwrap_or_else(|report| panic!("{report}"));
}
