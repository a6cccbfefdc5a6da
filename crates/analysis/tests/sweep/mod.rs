//! Sweeps give the same rows for changed and new programs, for any number of threads, and after an interruption.

mod lanes;
mod measures;

#[cfg(unix)]
use std::{fs, path::Path};

use crate::common::slideway;
use patchcord_analysis::instruments::Measure;
use patchcord_analysis::sweep::{Axis, Plan, Sweep, SweepSummary};
use patchcord_core::circuit::Circuit;
use patchcord_core::ir::Program;
use patchcord_core::patch::{ElementBuilder, Patch, PatchBuilder};
use patchcord_core::solve::{self, RunSettings};
use patchcord_core::trace::StepCause;

/// The circuit and the program of a patch, or None if the patch is refused with these parameter values.
fn program(patch: &Patch, changes: &[(String, f64)]) -> Option<(Circuit, Program)> {
    let circuit = Circuit::with_parameters(patch, changes.iter().cloned()).ok()?;
    let program = Program::new(&circuit).ok()?;
    Some((circuit, program))
}

fn sweep(
    patch: &Patch,
    axes: &[&str],
    measures: &[&str],
    settings: impl FnOnce(RunSettings) -> RunSettings,
) -> Sweep {
    let (circuit, program) = program(patch, &[]).unwrap();
    let plan = Plan::new(axes.iter().map(|text| text.parse::<Axis>().unwrap()), &program).unwrap();
    let measures: Vec<_> =
        measures.iter().map(|text| Measure::parse(text, program.signals()).unwrap()).collect();
    let settings = settings(RunSettings::of(&circuit).unwrap());
    Sweep::new(patch, program, settings, plan, measures).unwrap()
}

/// All rows, without the head.
fn rows(sweep: &Sweep, threads: usize) -> Vec<String> {
    let mut bytes = Vec::new();
    sweep.write(&mut bytes, threads, &mut |_| ()).unwrap();
    let text = String::from_utf8(bytes).unwrap();
    let rows = text.strip_prefix(&sweep.head()).unwrap().lines();
    rows.map(str::to_owned).collect()
}

/// Changes of all parameters with a range, each towards one end of its range by a different fraction.
fn towards_range_ends(patch: &Patch, fraction: f64) -> Vec<(String, f64)> {
    let ranged = patch
        .parameters
        .iter()
        .filter_map(|(name, parameter)| Some((name, parameter.value, parameter.range?)));
    let moved = ranged.enumerate().map(|(index, (name, value, (low, high)))| {
        let end = if index % 2 == 0 { high } else { low };
        (name.clone(), value + fraction * (end - value) / (1.0 + index as f64))
    });
    moved.collect()
}

#[test]
fn a_program_with_changed_parameters_equals_a_new_one() {
    let mut compared = 0;
    for file in crate::common::files::shipped_files() {
        let patch = crate::common::patch_of(&file);
        let (circuit, mut changed) = program(&patch, &[]).unwrap();
        let settings = RunSettings::of(&circuit).unwrap();
        let seconds = 0.02 * settings.duration();
        let every = settings.step;
        let settings = settings.with_sample_interval(every).with_duration(seconds);
        for fraction in [0.05, 0.3, 0.0] {
            let changes = towards_range_ends(&patch, fraction);
            let named: Vec<_> = changes.iter().map(|(name, value)| (name.as_str(), *value)).collect();
            let set = changed.set_parameters(named);
            let Some((_, fresh)) = program(&patch, &changes) else {
                assert!(set.is_err() || solve::run(&changed, &settings).is_err(), "{file:?} {changes:?}");
                continue;
            };
            set.unwrap();
            assert_eq!(
                solve::run(&changed, &settings),
                solve::run(&fresh, &settings),
                "{file:?} {changes:?}"
            );
            compared += 1;
        }
    }
    assert!(compared > 60, "{compared}");
}

#[test]
fn rows_do_not_depend_on_the_number_of_threads() {
    let sweep = sweep(
        &slideway(),
        &["VcL=1.27e-3:25.4e-3:5:log", "Tc=0.006:0.025:4"],
        &["peak:v_o", "stick_end", "frequency:v_o,last=0.1"],
        |settings| settings.with_duration(0.25),
    );
    let one = rows(&sweep, 1);
    assert_eq!(one.len(), 20);
    assert!(one[0].starts_with("0.00127,0.006,") && one[1].starts_with("0.00127,0.012"), "{one:?}");
    for threads in [2, 5] {
        assert_eq!(rows(&sweep, threads), one, "{threads} threads");
    }
}

#[test]
fn a_row_has_the_readings_of_a_single_run() {
    let measures = ["voltmeter:x_error", "least:v_o", "most:v_o", "peak:A3"];
    let sweep =
        sweep(&slideway(), &["K=20e6,45e6", "M=433,800"], &measures, |settings| settings.with_duration(0.3));
    let changes = [("K".to_owned(), 20e6), ("M".to_owned(), 800.0)];
    let (_, fresh) = program(&slideway(), &changes).unwrap();
    let trace = solve::run(&fresh, sweep.settings()).unwrap();
    let readings = patchcord_analysis::instruments::readings(&trace);
    let read = |name: &str| readings.iter().find(|reading| reading.signal == name).unwrap();
    let expected =
        [read("x_error").end, read("v_o").least.value, read("v_o").most.value, read("A3").largest()];
    let row = &rows(&sweep, 2)[1];
    let cells: Vec<f64> = row.split(',').take(6).map(|cell| cell.parse().unwrap()).collect();
    assert_eq!((cells[0], cells[1], &cells[2..]), (20e6, 800.0, expected.as_slice()));
}

/// A pot at twice the parameter k, between the reference and a summer.
fn pot() -> Patch {
    let pot = ElementBuilder::new("pot").cord("in", "+100").set("setting", "2 * k");
    let builder = PatchBuilder::new("pot").parameter("k", 0.1, "1", [0.0, 1.0]).scale("volt", 1, "V");
    let builder =
        builder.element("P", pot).element("S", ElementBuilder::new("summer").cords("x1", ["P", "P"]));
    builder.signal("s", "S", "volt", 1.0).run(1.0, 0.1).build().unwrap()
}

#[test]
fn failed_runs_and_overloads_are_reported_with_their_reason() {
    let sweep = sweep(&pot(), &["k=0.1,0.75,0.4,0.2"], &["voltmeter:s", "frequency:s"], |settings| settings);
    let none = "frequency:s: no oscillation: apart from rounding, the signal is constant";
    let expected = [
        format!("0.1,-40,,,\"{none}\""),
        "0.75,,,outside-range,\"P setting is 1.5, outside 0 ... 1\"".to_owned(),
        format!("0.4,-100,,,\"{none}; overload of S at t = 0.000000 s\""),
        format!("0.2,-80,,,\"{none}\""),
    ];
    assert_eq!(rows(&sweep, 2), expected);
}

#[test]
fn a_continued_sweep_counts_the_existing_rows() {
    let sweep = sweep(&pot(), &["k=0.1,0.75,0.4,0.2"], &["frequency:s"], |settings| settings);
    let file = tempfile::NamedTempFile::new().unwrap();
    let summary = || sweep.append_to(file.path(), 1, &mut |_| ()).unwrap();
    let counts =
        |kept, written| SweepSummary { kept, written, failed: 1, noted: 3, ..SweepSummary::default() };
    assert_eq!(summary(), counts(0, 4));
    assert_eq!(summary(), counts(4, 0));
    let table = std::fs::read_to_string(file.path()).unwrap();
    let cut = table.rfind("0.4,").unwrap();
    std::fs::write(file.path(), &table[..cut]).unwrap();
    assert_eq!(summary(), counts(2, 2));
    assert_eq!(std::fs::read_to_string(file.path()).unwrap(), table);
}

/// F' = -1000 (F + S) and S' = -k S, from S = 80 V. Steps of 3 ms are too long for F.
fn stiff() -> Patch {
    let slow = ElementBuilder::new("integrator").cords("x1", ["P"]).set("initial", 80);
    let builder = PatchBuilder::new("stiff").parameter("k", 0.5, "1", [0.0, 1.0]).scale("volt", 1, "V");
    let builder = builder
        .element("F", ElementBuilder::new("integrator").cords("x1000", ["F", "S"]))
        .element("P", ElementBuilder::new("pot").cord("in", "S").set("setting", "k"))
        .element("S", slow);
    builder.signal("f", "F", "volt", 1.0).run(0.3, 3e-3).build().unwrap()
}

#[test]
fn steps_that_are_too_long_for_a_row_are_reported_with_its_values() {
    let summary = |measure: &str, threads, settings: fn(RunSettings) -> RunSettings| {
        let sweep = sweep(&stiff(), &["k=0.01:0.7:70"], &[measure], settings);
        sweep.write(&mut std::io::sink(), threads, &mut |_| ()).unwrap()
    };
    let one = summary("peak:f", 1, |settings| settings);
    let warning = one.step_warning.clone().unwrap();
    // Row 43 of 70 is checked.
    assert_eq!((warning.values, warning.warning.signal.as_str()), (vec![0.44], "f"));
    assert_eq!(warning.warning.cause, StepCause::Unstable("F".to_owned()));
    assert_eq!(warning.warning.step, 3e-3);
    assert_eq!(summary("peak:f", 3, |settings| settings), one);
    let overload = summary("overload", 1, |settings| settings);
    assert_eq!(overload.step_warning.unwrap().warning.signal, "F");
    assert_eq!(summary("peak:f", 1, |settings| settings.with_step(1e-4)).step_warning, None);
    assert_eq!(summary("peak:f", 1, |settings| settings.with_tolerance(1e-6)).step_warning, None);
}

#[test]
fn checks_and_blocks_of_the_settings_are_ignored() {
    let rows_with = |settings: fn(RunSettings) -> RunSettings| {
        rows(&sweep(&stiff(), &["k=0.1,0.2"], &["voltmeter:f"], settings), 1)
    };
    let plain = rows_with(|settings| settings);
    assert_eq!(rows_with(|settings| settings.with_step_checks().with_blocks(10)), plain);
}

/// The error of a sweep of four runs if `change` is made to its file after `done` rows. On Windows,
/// others cannot change a locked file.
#[cfg(unix)]
fn error_after_change(done: u64, change: impl Fn(&Path)) -> String {
    let sweep = sweep(&pot(), &["k=0.1,0.2,0.3,0.4"], &["voltmeter:s"], |settings| settings);
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("rows.csv");
    let mut is_changed = false;
    let mut progress = |rows: u64| {
        if rows == done && !std::mem::replace(&mut is_changed, true) {
            change(&file);
        }
    };
    let error = sweep.append_to(&file, 1, &mut progress).unwrap_err().to_string();
    error.replace(&file.display().to_string(), "FILE")
}

#[cfg(unix)]
#[test]
fn a_file_that_others_change_during_the_sweep_is_detected() {
    // After the last row the change must be detected too.
    for done in [2, 4] {
        let error = error_after_change(done, |file| fs::remove_file(file).unwrap());
        assert!(error.starts_with("FILE was deleted or renamed during the sweep"), "{error}");
        let error = error_after_change(done, |file| fs::write(file, "").unwrap());
        assert!(error.starts_with("another program changed FILE during the sweep"), "{error}");
        assert!(error.contains("it has 0 bytes instead of "), "{error}");
        let add_row = |file: &Path| {
            let text = fs::read_to_string(file).unwrap();
            fs::write(file, text + "5,\n").unwrap();
        };
        let error = error_after_change(done, add_row);
        assert!(error.starts_with("another program changed FILE"), "{error}");
    }
}

#[cfg(unix)]
#[test]
fn a_file_that_others_replace_during_the_sweep_is_left_unchanged() {
    let replace = |file: &Path| {
        fs::remove_file(file).unwrap();
        fs::write(file, "mine").unwrap();
    };
    // While the old file is open, the system cannot give its number to the new one.
    let error = error_after_change(2, replace);
    assert!(error.starts_with("FILE was replaced by another file during the sweep"), "{error}");
}

#[test]
fn an_oscillation_cannot_be_read_over_more_than_the_run() {
    let row = |last: &str| {
        let measure = format!("amplitude:s,last={last}");
        rows(&sweep(&pot(), &["k=0.1,0.2"], &[measure.as_str()], |settings| settings), 1).remove(0)
    };
    assert!(row("1.5").contains("last=1.5 s exceeds the run of 1 s"), "{}", row("1.5"));
    assert!(row("1").contains("no oscillation"), "{}", row("1"));
}

#[test]
fn invalid_sweeps_return_errors() {
    let (circuit, program) = program(&pot(), &[]).unwrap();
    let plan = |text: &str| Plan::new([Axis::parse(text).unwrap()], &program).unwrap();
    let new_sweep = |measures: &[&str], step: f64| {
        let measures: Vec<_> =
            measures.iter().map(|text| Measure::parse(text, program.signals()).unwrap()).collect();
        let settings = RunSettings::of(&circuit).unwrap().with_step(step);
        Sweep::new(&pot(), program.clone(), settings, plan("k=0,1"), measures)
            .map_err(|error| error.to_string())
    };
    assert_eq!(new_sweep(&[], 0.1).unwrap_err(), "no measure is specified");
    assert!(new_sweep(&["peak:s", "peak:s"], 0.1).unwrap_err().starts_with("two columns are named peak:s"));
    assert!(new_sweep(&["peak:s"], 2.0).unwrap_err().contains("longer than the run"));
    assert!(new_sweep(&["peak:s", "peak:P"], 0.1).is_ok());
}

#[test]
fn heads_of_different_sweeps_differ() {
    let head = |axis: &str, measure: &str, seconds: f64| {
        sweep(&pot(), &[axis], &[measure], |settings| settings.with_duration(seconds)).head()
    };
    let first = head("k=0:0.5:3", "peak:s", 1.0);
    assert_eq!(first, head("k=0:0.5:3", "peak:s", 1.0));
    for (other, line) in [
        (head("k=0:0.5:4", "peak:s", 1.0), "# vary: k=0:0.5:4"),
        (head("k=0:0.5:3", "most:s", 1.0), "# measure: most:s"),
        (head("k=0:0.5:3", "peak:s", 2.0), "# run: for 2 s, step 0.1 s, recorded every 0.1 s"),
    ] {
        let differing = first.lines().zip(other.lines()).find(|(one, other)| one != other);
        assert_eq!(differing.unwrap().1, line);
    }
    let phases = sweep(&pot(), &["k=0:0.5:3"], &["peak:s"], |settings| settings.repeated(3)).head();
    let line = "# run: phases, 3 s at most, step 0.1 s, recorded every 0.1 s\n";
    assert!(phases.contains(line), "{phases}");
}
