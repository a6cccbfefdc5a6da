//! The experiments of patches/measured: their patches follow their equations, and their files name existing columns.
//!
//! The measured data are not part of the repository; docs/measured.md says where to get them. Without them, the tests
//! that need them print a note and pass.

#[path = "../../../benches/measured/velocity.rs"]
mod velocity;

use std::fmt::Write as _;
use std::fs;
use std::io::{self, Write as _};
use std::path::{Path, PathBuf};

use crate::common::shipped;
use crate::equations::Equations;
use patchcord_core::patch::Patch;
use patchcord_core::solve::{self, RunSettings};
use patchcord_ident::Experiment;
use patchcord_ident::fit::problem::Problem;
use patchcord_ident::report::sentence::verdict_sentence;
use patchcord_ident::search::{Outcome, SearchSettings, Verdict};

/// Folder of the patches and experiments, relative to the package. The data belong in its subfolder `data`.
const FOLDER: &str = "../../patches/measured";

/// Linear interpolation in a table of points; constant before the first and after the last point.
fn interpolate(points: &[[f64; 2]], time: f64) -> f64 {
    let next = points.partition_point(|[x, _]| *x <= time);
    let (Some([from, first]), Some([to, last])) = (points.get(next.wrapping_sub(1)), points.get(next)) else {
        return points[next.saturating_sub(1)][1];
    };
    first + (last - first) * (time - from) / (to - from)
}

/// The points of a drive's table in the patch. They replace the measured data.
fn points_of(patch: &Patch, drive: &str) -> Vec<[f64; 2]> {
    serde_json::from_value(patch.value()["drives"][drive]["points"].clone()).unwrap()
}

/// A slide in motion: M v' = F - offset - (Fp or Fm) v - Fc sign(v), x' = v. All in SI units.
struct Slide {
    /// Force over time.
    force: Vec<[f64; 2]>,
    mass: f64,
    offset: f64,
    /// Viscous friction Fp at positive velocity.
    forward: f64,
    /// Viscous friction Fm at negative velocity.
    backward: f64,
    /// Coulomb friction Fc.
    dry: f64,
}

impl Equations<2, 1> for Slide {
    fn rates(&self, [_, v]: [f64; 2], time: f64, [side]: [f64; 1]) -> [f64; 2] {
        let viscous = if side > 0.0 { self.forward } else { self.backward };
        let friction = viscous * v + self.dry * if side > 0.0 { 1.0 } else { -1.0 };
        [v, (interpolate(&self.force, time) - self.offset - friction) / self.mass]
    }

    fn kinks(&self, [_, v]: [f64; 2]) -> [f64; 1] {
        [v]
    }
}

/// Two tanks in cascade: h1' = k u - q1 (h1 / 5 V)^n1 and h2' = q1 (h1 / 5 V)^n1 - q2 (h2 / 5 V)^n2.
///
/// Levels are in V of their sensors, time in s.
struct Tanks {
    /// Pump voltage u over time.
    pump: Vec<[f64; 2]>,
    /// k, the rise of the upper level per volt of the pump.
    gain: f64,
    /// q1 and q2, the outflows at 5 V.
    outflows: [f64; 2],
    /// n1 and n2.
    powers: [f64; 2],
}

impl Equations<2, 0> for Tanks {
    fn rates(&self, levels: [f64; 2], time: f64, _: [f64; 0]) -> [f64; 2] {
        let flow = |tank: usize| self.outflows[tank] * (levels[tank] / 5.0).powf(self.powers[tank]);
        [self.gain * interpolate(&self.pump, time) - flow(0), flow(0) - flow(1)]
    }

    fn kinks(&self, _: [f64; 2]) -> [f64; 0] {
        []
    }
}

/// Samples of a signal, one every `every` seconds, of a patch with some parameters changed.
fn run(patch: &Patch, changes: &[(&str, f64)], duration: f64, every: f64, signal: &str) -> Vec<f64> {
    let circuit = crate::common::circuit(patch, changes);
    let settings = RunSettings::of(&circuit).unwrap().with_duration(duration).with_sample_interval(every);
    let trace = solve::run(&crate::common::program_of(&circuit), &settings).unwrap();
    trace.values(signal).unwrap()
}

/// Asserts that two sequences have the same length and differ by less than `tolerance` everywhere.
fn assert_close(name: &str, found: &[f64], expected: impl Iterator<Item = f64>, tolerance: f64) {
    let expected: Vec<f64> = expected.collect();
    assert_eq!(found.len(), expected.len(), "{name}");
    for (sample, (found, expected)) in found.iter().zip(expected).enumerate() {
        assert!((found - expected).abs() < tolerance, "{name}, sample {sample}: {found} and not {expected}");
    }
}

#[test]
fn slides_follow_their_equations() {
    let frictionless =
        |force| Slide { force, mass: 87.0, offset: 2.5, forward: 0.0, backward: 0.0, dry: 0.0 };
    let common = [("M", 87.0), ("offset", 2.5), ("x_start", 0.03), ("v_start", 0.05)];
    let with = |friction: &[(&'static str, f64)]| [&common[..], friction].concat();
    let cases = [
        ("emps", with(&[]), [0.0; 3]),
        ("emps-friction", with(&[("Fv", 180.0), ("Fc", 15.0)]), [180.0, 180.0, 15.0]),
        ("emps-asymmetric", with(&[("Fp", 150.0), ("Fm", 260.0), ("Fc", 15.0)]), [150.0, 260.0, 15.0]),
    ];
    for (stem, changes, [forward, backward, dry]) in cases {
        let patch = shipped(&format!("measured/{stem}"));
        let slide = Slide { forward, backward, dry, ..frictionless(points_of(&patch, "F")) };
        let trajectory = slide.integrate([0.03, 0.05], 3.0, 0.05, 1e-4);
        for (state, signal) in ["x", "v"].into_iter().enumerate() {
            let found = run(&patch, &changes, 3.0, 0.05, signal);
            assert_close(stem, &found, trajectory.iter().map(|values| values[state]), 1e-9);
        }
        let least = trajectory.iter().fold(0.0f64, |least, [_, v]| least.min(*v));
        assert!(
            dry == 0.0 || least < -0.05,
            "{stem} must reverse its motion, so that the friction of both directions acts"
        );
    }
}

#[test]
fn a_slide_at_rest_is_held_by_coulomb_friction() {
    let patch = shipped("measured/emps-friction");
    let held = run(&patch, &[("Fc", 100.0), ("Fv", 0.0), ("offset", 19.0)], 0.01, 0.001, "v");
    assert!(held.iter().all(|velocity| *velocity == 0.0), "{held:?}");
}

#[test]
fn tanks_follow_their_equations() {
    let patch = shipped("measured/cascaded-tanks");
    let pump = points_of(&patch, "u");
    let changes = [("k", 0.05), ("q1", 0.11), ("q2", 0.1), ("n1", 0.6), ("n2", 0.4)];
    let (outflows, powers) = ([0.11, 0.1], [0.6, 0.4]);
    let tanks = Tanks { pump, gain: 0.05, outflows, powers };
    let trajectory = tanks.integrate([7.0, 5.2], 3000.0, 20.0, 1.0);
    for (state, signal) in ["h1", "h2"].into_iter().enumerate() {
        let found = run(&patch, &changes, 3000.0, 20.0, signal);
        assert_close(signal, &found, trajectory.iter().map(|values| values[state]), 1e-7);
    }
}

/// A table with these column names. The first column is the time, the others are different sines.
fn synthetic_table(names: &str, rows: usize, interval: f64) -> String {
    let mut text = format!("{names}\n");
    for row in 0..rows {
        let values = (1..names.split(',').count())
            .map(|column| (1e-2 * (row * column) as f64).sin().to_string())
            .collect::<Vec<_>>();
        writeln!(text, "{},{}", row as f64 * interval, values.join(",")).unwrap();
    }
    text
}

/// The paths of all experiments in the folder.
fn experiments() -> Vec<PathBuf> {
    let entries = fs::read_dir(FOLDER).unwrap().map(|entry| entry.unwrap().path());
    let mut experiments: Vec<_> =
        entries.filter(|path| path.to_str().unwrap().ends_with(".experiment.json")).collect();
    experiments.sort();
    assert!(experiments.len() >= 4, "{experiments:?}");
    experiments
}

/// The columns that the experiments name exist in tables with the format of the measured data.
#[test]
fn experiments_read_tables_with_the_format_of_the_data() {
    let folder = tempfile::tempdir().unwrap();
    fs::create_dir(folder.path().join("data")).unwrap();
    for entry in fs::read_dir(FOLDER).unwrap().map(|entry| entry.unwrap().path()) {
        if entry.is_file() {
            fs::copy(&entry, folder.path().join(entry.file_name().unwrap())).unwrap();
        }
    }
    let write_data = |name: &str, text: &str| fs::write(folder.path().join("data").join(name), text).unwrap();
    let slide = synthetic_table("t_s,position_m,reference_m,motor_signal_V,force_N", 2485, 0.01);
    write_data("emps_train.csv", &slide);
    write_data("emps_test.csv", &slide);
    // The table of the tanks has no time column, quoted names, and a comma at the end of each row.
    let tanks = synthetic_table("none,\"uEst\",\"uVal\",\"yEst\",\"yVal\",\"Ts\",", 1024, 4.0);
    let without_times = |line: &str| line.split_once(',').unwrap().1.to_owned();
    write_data("dataBenchmark.csv", &tanks.lines().map(without_times).collect::<Vec<_>>().join("\n"));
    for path in experiments() {
        let copy = folder.path().join(path.file_name().unwrap());
        let experiment = Experiment::read(&copy).unwrap_or_else(|error| panic!("{error}"));
        assert_eq!(experiment.warnings.to_string(), "", "{}", path.display());
        assert!(!experiment.validation.is_empty() && !experiment.fit.is_empty());
    }
}

/// Reads an experiment. `None` with a note on standard error if its data are missing.
fn read_if_present(path: &Path) -> Option<Experiment> {
    let text = fs::read_to_string(path).unwrap();
    let files = text.split('"').filter(|word| word.ends_with(".csv"));
    if let Some(missing) = files.map(|file| Path::new(FOLDER).join(file)).find(|file| !file.exists()) {
        // cargo captures eprintln! of tests that pass, but not a direct write.
        let mut stderr = io::stderr();
        writeln!(stderr, "{} is not read: {} is missing", path.display(), missing.display()).unwrap();
        return None;
    }
    Some(Experiment::read(path).unwrap_or_else(|error| panic!("{error}")))
}

/// If the measured data are present, the experiments read all their samples.
#[test]
fn experiments_read_the_measured_data_if_present() {
    for path in experiments() {
        let Some(experiment) = read_if_present(&path) else { continue };
        assert_eq!(experiment.warnings.to_string(), "", "{}", path.display());
        let samples: usize =
            experiment.train.iter().chain(&experiment.validation).map(|record| record.len()).sum();
        assert!([24_841, 2 * 24_841, 2 * 1024].contains(&samples), "{}: {samples}", path.display());
    }
}

/// The search with a library of a few effects. `None` if the data are missing.
fn search_if_present(name: &str, effects: &[&str]) -> Option<(Experiment, Problem, Outcome)> {
    let experiment = read_if_present(&Path::new(FOLDER).join(format!("{name}.experiment.json")))?;
    let problem = Problem::of(&experiment).unwrap();
    let library = crate::library::with_effects(effects);
    let settings = SearchSettings::new(&library).with_threads(2);
    let outcome = patchcord_ident::search::search(&experiment, &problem, &settings, |_| ()).unwrap().unwrap();
    Some((experiment, problem, outcome))
}

#[test]
fn the_friction_of_the_measured_slide_depends_on_direction() {
    let effects = ["asymmetric-viscous-friction", "stribeck-friction", "saturation"];
    let Some((experiment, _, outcome)) = search_if_present("emps-friction", &effects) else { return };
    let sentence = verdict_sentence(&outcome);
    assert!(sentence.starts_with("asymmetric-viscous-friction at IV is missing"), "{sentence}");
    let model = outcome.reported_model();
    let values = (model.variant.fit.as_slice(), model.train.estimate.parameters.as_slice());
    for (record, limit) in [(&experiment.train[0], 0.015), (&experiment.validation[0], 0.052)] {
        let error = velocity::error(&experiment, model.variant.patch(), values, record).unwrap();
        assert!(error < limit, "{}: {error}", record.name);
    }
}

#[test]
#[ignore = "takes ten minutes: cargo test -p patchcord-ident -- --ignored"]
fn the_measured_tanks_overflow_and_their_sensors_do_not_saturate() {
    let Some((_, problem, outcome)) = search_if_present("cascaded-tanks", &["overflow", "saturation"]) else {
        return;
    };
    assert_eq!(outcome.verdict, Verdict::Named);
    assert!(
        outcome.effects.iter().all(|effect| effect.effect == "overflow"),
        "{}",
        verdict_sentence(&outcome)
    );
    let error = outcome.reported_model().validation.normalised_rms() * problem.sigma[0];
    assert!(error < 0.28, "{error} V");
}

/// With parameters that another program fitted, the velocity errors are those of docs/measured.md. Needs the measured
/// data.
#[test]
fn velocity_errors_of_published_fits_agree_with_the_page() {
    let file = Path::new(FOLDER).join("emps-friction.experiment.json");
    let Some(experiment) = read_if_present(&file) else { return };
    let viscous = [("M", 94.29), ("offset", -3.55), ("Fv", 192.7), ("Fc", 21.61)];
    let by_direction = [("M", 93.25), ("offset", -0.19), ("Fp", 157.3), ("Fm", 233.1), ("Fc", 21.31)];
    let cases =
        [("emps-friction", &viscous[..], [0.046, 0.066]), ("emps-asymmetric", &by_direction, [0.014, 0.050])];
    for (stem, parameters, expected_errors) in cases {
        let (fit, values): (Vec<String>, Vec<f64>) =
            parameters.iter().map(|(name, value)| ((*name).to_owned(), *value)).unzip();
        let patch = shipped(&format!("measured/{stem}"));
        for (record, expected) in
            [&experiment.train[0], &experiment.validation[0]].into_iter().zip(expected_errors)
        {
            let error = velocity::error(&experiment, &patch, (&fit, &values), record).unwrap();
            assert!(
                (error - expected).abs() < 0.001,
                "{stem}, {}: {error}, expected {expected}",
                record.name
            );
        }
    }
}
