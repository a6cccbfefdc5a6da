//! Where a search in measured data begins: the patches follow their equations, and the experiments name what data have.
//!
//! The data are not ours to pass on: docs/measured.md tells where they are found.

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
use patchcord_ident::search::{Means, Outcome, Verdict};

const FOLDER: &str = "../../patches/measured";

/// The value between the points of a table, level before and after.
fn between(points: &[[f64; 2]], time: f64) -> f64 {
    let next = points.partition_point(|[at, _]| *at <= time);
    let (Some([from, low]), Some([to, high])) = (points.get(next.wrapping_sub(1)), points.get(next)) else {
        return points[next.saturating_sub(1)][1];
    };
    low + (high - low) * (time - from) / (to - from)
}

/// The points that stand in a patch for the data of a drive.
fn points_of(patch: &Patch, drive: &str) -> Vec<[f64; 2]> {
    serde_json::from_value(patch.value()["drives"][drive]["points"].clone()).unwrap()
}

/// M v' = F - offset - (Fp or Fm) v - Fc sign(v), x' = v, while it does not stand.
struct Slide {
    force: Vec<[f64; 2]>,
    mass: f64,
    offset: f64,
    forward: f64,
    backward: f64,
    dry: f64,
}

impl Equations<2, 1> for Slide {
    fn rates(&self, [_, v]: [f64; 2], time: f64, [side]: [f64; 1]) -> [f64; 2] {
        let viscous = if side > 0.0 { self.forward } else { self.backward };
        let friction = viscous * v + self.dry * if side > 0.0 { 1.0 } else { -1.0 };
        [v, (between(&self.force, time) - self.offset - friction) / self.mass]
    }

    fn kinks(&self, [_, v]: [f64; 2]) -> [f64; 1] {
        [v]
    }
}

/// h1' = k u - q1 (h1 / 5 V)^n1 and h2' = q1 (h1 / 5 V)^n1 - q2 (h2 / 5 V)^n2.
struct Tanks {
    pump: Vec<[f64; 2]>,
    gain: f64,
    outflows: [f64; 2],
    powers: [f64; 2],
}

impl Equations<2, 0> for Tanks {
    fn rates(&self, levels: [f64; 2], time: f64, _: [f64; 0]) -> [f64; 2] {
        let flow = |tank: usize| self.outflows[tank] * (levels[tank] / 5.0).powf(self.powers[tank]);
        [self.gain * between(&self.pump, time) - flow(0), flow(0) - flow(1)]
    }

    fn kinks(&self, _: [f64; 2]) -> [f64; 0] {
        []
    }
}

/// Samples of a signal of a patch with some parameters changed.
fn run(patch: &Patch, changes: &[(&str, f64)], duration: f64, every: f64, signal: &str) -> Vec<f64> {
    let circuit = crate::common::circuit(patch, changes);
    let settings = RunSettings { every, ..RunSettings::of(&circuit).unwrap().lasting(duration) };
    let trace = solve::run(&crate::common::program_of(&circuit), &settings).unwrap();
    trace.values(signal).unwrap()
}

fn assert_alike(name: &str, found: &[f64], expected: impl Iterator<Item = f64>, within: f64) {
    let expected: Vec<f64> = expected.collect();
    assert_eq!(found.len(), expected.len(), "{name}");
    for (sample, (found, expected)) in found.iter().zip(expected).enumerate() {
        let off = (found - expected).abs();
        assert!(off < within, "{name}, sample {sample}: {found} and not {expected}");
    }
}

#[test]
fn slides_follow_their_equations() {
    let frictionless =
        |force| Slide { force, mass: 87.0, offset: 2.5, forward: 0.0, backward: 0.0, dry: 0.0 };
    let own = [("M", 87.0), ("offset", 2.5), ("x_start", 0.03), ("v_start", 0.05)];
    let with = |more: &[(&'static str, f64)]| [&own[..], more].concat();
    let cases = [
        ("emps", with(&[]), [0.0; 3]),
        ("emps-friction", with(&[("Fv", 180.0), ("Fc", 15.0)]), [180.0, 180.0, 15.0]),
        ("emps-asymmetric", with(&[("Fp", 150.0), ("Fm", 260.0), ("Fc", 15.0)]), [150.0, 260.0, 15.0]),
    ];
    for (stem, changes, [forward, backward, dry]) in cases {
        let patch = shipped(&format!("measured/{stem}"));
        let slide = Slide { forward, backward, dry, ..frictionless(points_of(&patch, "F")) };
        let course = slide.course([0.03, 0.05], 3.0, 0.05, 1e-4);
        for (state, signal) in ["x", "v"].into_iter().enumerate() {
            let found = run(&patch, &changes, 3.0, 0.05, signal);
            assert_alike(stem, &found, course.iter().map(|course| course[state]), 1e-9);
        }
        let least = course.iter().fold(0.0f64, |least, [_, v]| least.min(*v));
        assert!(dry == 0.0 || least < -0.05, "{stem} turns round, and shows both sides of its friction");
    }
}

#[test]
fn what_stands_on_a_slide_is_held() {
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
    let course = tanks.course([7.0, 5.2], 3000.0, 20.0, 1.0);
    for (state, signal) in ["h1", "h2"].into_iter().enumerate() {
        let found = run(&patch, &changes, 3000.0, 20.0, signal);
        assert_alike(signal, &found, course.iter().map(|course| course[state]), 1e-7);
    }
}

/// Rows of numbers that move, under these names.
fn made(names: &str, rows: usize, interval: f64) -> String {
    let mut text = format!("{names}\n");
    for row in 0..rows {
        let values = (1..names.split(',').count())
            .map(|column| (1e-2 * (row * column) as f64).sin().to_string())
            .collect::<Vec<_>>();
        writeln!(text, "{},{}", row as f64 * interval, values.join(",")).unwrap();
    }
    text
}

fn experiments() -> Vec<PathBuf> {
    let entries = fs::read_dir(FOLDER).unwrap().map(|entry| entry.unwrap().path());
    let mut found: Vec<_> =
        entries.filter(|path| path.to_str().unwrap().ends_with(".experiment.json")).collect();
    found.sort();
    assert!(found.len() >= 4, "{found:?}");
    found
}

/// The experiments find what they name in tables that are made as the measured ones are.
#[test]
fn experiments_read_tables_made_like_the_data() {
    let folder = tempfile::tempdir().unwrap();
    fs::create_dir(folder.path().join("data")).unwrap();
    for entry in fs::read_dir(FOLDER).unwrap().map(|entry| entry.unwrap().path()) {
        if entry.is_file() {
            fs::copy(&entry, folder.path().join(entry.file_name().unwrap())).unwrap();
        }
    }
    let put = |name: &str, text: &str| fs::write(folder.path().join("data").join(name), text).unwrap();
    let slide = made("t_s,position_m,reference_m,motor_signal_V,force_N", 2485, 0.01);
    put("emps_train.csv", &slide);
    put("emps_test.csv", &slide);
    // The tanks' table has no times, names in quotes, and nothing behind its last comma.
    let tanks = made("none,\"uEst\",\"uVal\",\"yEst\",\"yVal\",\"Ts\",", 1024, 4.0);
    let without_times = |line: &str| line.split_once(',').unwrap().1.to_owned();
    put("dataBenchmark.csv", &tanks.lines().map(without_times).collect::<Vec<_>>().join("\n"));
    for path in experiments() {
        let moved = folder.path().join(path.file_name().unwrap());
        let made = Experiment::read(&moved).unwrap_or_else(|error| panic!("{error}"));
        assert_eq!(made.warnings.to_string(), "", "{}", path.display());
        assert!(!made.test.is_empty() && !made.fit.is_empty());
    }
}

/// An experiment, where its data are; where not, that is told.
fn whose_data_are_there(path: &Path) -> Option<Experiment> {
    let text = fs::read_to_string(path).unwrap();
    let named = text.split('"').filter(|word| word.ends_with(".csv"));
    if let Some(missing) = named.map(|file| Path::new(FOLDER).join(file)).find(|file| !file.exists()) {
        // Past what cargo holds back of tests that pass.
        let mut aloud = io::stderr();
        writeln!(aloud, "{} is not read: there is no {}", path.display(), missing.display()).unwrap();
        return None;
    }
    Some(Experiment::read(path).unwrap_or_else(|error| panic!("{error}")))
}

/// Where the data themselves are, the experiments read them whole.
#[test]
fn experiments_read_the_data_where_they_are() {
    for path in experiments() {
        let Some(read) = whose_data_are_there(&path) else { continue };
        assert_eq!(read.warnings.to_string(), "", "{}", path.display());
        let samples: usize = read.train.iter().chain(&read.test).map(|record| record.len()).sum();
        assert!([24_841, 2 * 24_841, 2 * 1024].contains(&samples), "{}: {samples}", path.display());
    }
}

/// What a search among a few effects says, where the data are.
fn searched(name: &str, effects: &[&str]) -> Option<(Experiment, Problem, Outcome)> {
    let experiment = whose_data_are_there(&Path::new(FOLDER).join(format!("{name}.experiment.json")))?;
    let problem = Problem::of(&experiment).unwrap();
    let with = Means { library: &crate::library::of(effects), threads: 2, seed: 1 };
    let found = patchcord_ident::search::search(&problem, &experiment.patch, &experiment.fit, &with, |_| ())
        .unwrap()
        .unwrap();
    Some((experiment, problem, found))
}

#[test]
fn friction_of_the_slide_differs_by_direction_and_does_not_fall() {
    let effects = ["asymmetric-viscous-friction", "stribeck-friction", "saturation"];
    let Some((experiment, _, found)) = searched("emps-friction", &effects) else { return };
    let sentence = verdict_sentence(&found);
    assert!(sentence.starts_with("asymmetric-viscous-friction at IV is missing"), "{sentence}");
    let stage = found.told();
    let knobs = (stage.version.fit.as_slice(), stage.train.point.knobs.as_slice());
    for (record, most) in [(&experiment.train[0], 0.015), (&experiment.test[0], 0.052)] {
        let error = velocity::error(&experiment, stage.version.patch(), knobs, record).unwrap();
        assert!(error < most, "{}: {error}", record.name);
    }
}

#[test]
#[ignore = "takes ten minutes: cargo test -p patchcord-ident -- --ignored"]
fn the_tanks_overflow_and_nothing_saturates() {
    let Some((_, problem, found)) = searched("cascaded-tanks", &["overflow", "saturation"]) else { return };
    assert_eq!(found.verdict, Verdict::Named);
    assert!(found.effects.iter().all(|effect| effect.effect == "overflow"), "{}", verdict_sentence(&found));
    let error = found.told().test.over_noise() * problem.sigma[0];
    assert!(error < 0.28, "{error} V");
}

/// Where the data are, the numbers that were fitted apart from the program come as near to the measured velocity as docs/measured.md tells.
#[test]
fn velocities_come_as_near_as_is_told() {
    let file = Path::new(FOLDER).join("emps-friction.experiment.json");
    let Some(experiment) = whose_data_are_there(&file) else { return };
    let viscous = [("M", 94.29), ("offset", -3.55), ("Fv", 192.7), ("Fc", 21.61)];
    let by_direction = [("M", 93.25), ("offset", -0.19), ("Fp", 157.3), ("Fm", 233.1), ("Fc", 21.31)];
    let cases =
        [("emps-friction", &viscous[..], [0.046, 0.066]), ("emps-asymmetric", &by_direction, [0.014, 0.050])];
    for (stem, values, told) in cases {
        let (fit, knobs): (Vec<String>, Vec<f64>) =
            values.iter().map(|(name, value)| ((*name).to_owned(), *value)).unzip();
        let patch = shipped(&format!("measured/{stem}"));
        for (record, told) in [&experiment.train[0], &experiment.test[0]].into_iter().zip(told) {
            let error = velocity::error(&experiment, &patch, (&fit, &knobs), record).unwrap();
            assert!((error - told).abs() < 0.001, "{stem}, {}: {error} and not {told}", record.name);
        }
    }
}
