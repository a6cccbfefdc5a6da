//! Frequency responses compared with closed solutions, runs of the machine, and SciPy.

use std::f64::consts::{PI, TAU};
use std::fs;

use crate::common::{built, circuit, element, volts};
use crate::linear::{model, near, response, shipped};
use patchcord_analysis::instruments::harmonic;
use patchcord_analysis::linear::{
    FrequencyBand, FrequencyResponse, LinearError, ResponsePoint, TransferFunction, roots,
};
use patchcord_core::ir::Program;
use patchcord_core::patch::PatchBuilder;
use patchcord_core::solve::{self, RunSettings};

/// A lag L with the time constant in s and the drive u.
fn lag(time: f64) -> PatchBuilder {
    let lag = element("lag").cords("x1", ["u"]).set("time", time);
    volts("lag").drive("u", "volt", element("step").set("height", 1)).element("L", lag)
}

#[test]
fn a_lag_at_its_corner_gives_7_07_of_10_volts_45_degrees_late() {
    for time in [0.0065, 0.5] {
        let corner = 1.0 / (TAU * time);
        let found = response(&built(lag(time)), "u", "L", [corner, 1e3 * corner]);
        let first = found.points[0];
        assert!(near(10.0 * first.ratio, 50f64.sqrt(), 1e-12), "{first:?}");
        // The lag inverts: half a turn of lead minus 45 degrees.
        assert!(near(first.phase, 0.75 * PI, 1e-12), "{first:?}");
        assert!(near(first.decibels(), -10.0 * 2f64.log10(), 1e-12), "{first:?}");
        let last = found.points[found.points.len() - 1];
        assert!(near(last.ratio, 1e-3, 1e-6) && near(last.phase, PI / 2.0 + 1e-3, 1e-6), "{last:?}");
        assert_eq!(found.unit, "");
    }
}

#[test]
fn a_circuit_without_memory_has_a_constant_response() {
    let summer = element("summer").cords("x1", ["u"]);
    let drive = element("step").set("height", 1);
    let patch = volts("summer").drive("u", "volt", drive).element("B", summer);
    let found = response(&built(patch), "u", "B", [0.01, 100.0]);
    assert!(found.points.len() > 200, "{}", found.points.len());
    for point in &found.points {
        assert_eq!((point.ratio, point.phase.abs()), (1.0, PI), "{point:?}");
    }
}

#[test]
fn a_driven_oscillator_follows_its_formula() {
    let (m, k, d) = (1.0, 40.0, 2.0);
    let found = response(&shipped("lessons/driven-oscillator", &[]), "push", "x", [0.01, 100.0]);
    assert_eq!(found.unit, "mm per N");
    for point in &found.points {
        let omega = TAU * point.frequency;
        let (real, imaginary): (f64, f64) = (k - m * omega * omega, d * omega);
        assert!(near(point.ratio, 1e3 / real.hypot(imaginary), 1e-10), "{point:?}");
        assert!(near(point.phase, -imaginary.atan2(real), 1e-10), "{point:?}");
    }
    let steps = found.points.windows(2).map(|pair| (pair[1].phase - pair[0].phase).abs());
    assert!(steps.fold(0.0, f64::max) < 0.15, "points are close enough for a curve");
}

/// The amplitude ratio and the phase lead of x relative to the push, measured in a run.
fn measured(frequency: f64, changes: &[(&str, f64)]) -> (f64, f64) {
    let changes: Vec<_> = [&[("f", frequency), ("F", 0.5)], changes].concat();
    let patch = crate::common::shipped("lessons/driven-oscillator");
    let circuit = circuit(&patch, &changes);
    let program = Program::new(&circuit).unwrap();
    let settings = RunSettings::of(&circuit).unwrap().with_duration(20.0 + 10.0 / frequency);
    let trace = solve::run(&program, &settings).unwrap();
    let from = trace.time.partition_point(|time| *time < 20.0 - 1e-9);
    let read =
        |name: &str| harmonic(&trace.time[from..], &trace.values(name).unwrap()[from..], frequency).unwrap();
    let (push, x) = (read("push"), read("x"));
    (x.amplitude / push.amplitude, x.phase - push.phase)
}

#[test]
fn a_run_has_the_amplitude_and_phase_of_the_response() {
    for frequency in [0.3, 1.0, 1.5, 4.0] {
        let changes = [("d", 3.0), ("k", 55.0)];
        let program = shipped("lessons/driven-oscillator", &changes);
        let predicted = response(&program, "push", "x", [frequency, 10.0 * frequency]).points[0];
        let (ratio, lead) = measured(frequency, &changes);
        // Errors by steps of 2 ms and by the transient: 1e-7 in the test of the lesson.
        assert!(near(ratio, predicted.ratio, 1e-6), "{frequency} Hz: {ratio} {predicted:?}");
        let phase_error = (lead - predicted.phase + PI).rem_euclid(TAU) - PI;
        assert!(phase_error.abs() < 1e-6, "{frequency} Hz: {lead} {predicted:?}");
    }
}

#[test]
fn the_linear_slideway_agrees_with_scipy() {
    let table = fs::read_to_string("../core/tests/reference/fig_8_04_bode.csv").unwrap();
    let rows: Vec<Vec<f64>> = table
        .lines()
        .skip(1)
        .map(|line| line.split(',').map(|cell| cell.parse().unwrap()).collect())
        .collect();
    assert!(rows.len() > 20);
    let program = shipped("thesis/fig-8-04", &[]);
    let model = model(&program);
    for (column, (from, to)) in
        [("v_i", "v_o"), ("v_i", "spring_force"), ("x_i", "x_o")].into_iter().enumerate()
    {
        let transfer = TransferFunction::new(&model, from, to).unwrap();
        let frequencies = rows.iter().map(|row| row[0]);
        for (row, frequency) in rows.iter().zip(frequencies) {
            let band = FrequencyBand { low: frequency, high: 1.01 * frequency };
            let point = transfer.response(band).unwrap().points[0];
            let (ratio, phase) = (row[1 + 2 * column], row[2 + 2 * column]);
            assert!(near(point.ratio, ratio, 1e-9), "{to} {frequency} Hz: {point:?} {ratio}");
            let phase_error = (point.phase - phase + PI).rem_euclid(TAU) - PI;
            assert!(phase_error.abs() < 1e-9, "{to} {frequency} Hz: {point:?} {phase}");
        }
    }
}

#[test]
fn an_undamped_resonance_turns_the_phase_down_by_half_a_turn() {
    let found = response(&shipped("lessons/driven-oscillator", &[("d", 0.0)]), "push", "x", [0.1, 10.0]);
    let (first, last) = (found.points[0], found.points[found.points.len() - 1]);
    assert!(first.phase.abs() < 1e-9 && (last.phase + PI).abs() < 1e-9, "{first:?} {last:?}");
    let peak = found.points.iter().map(|point| point.ratio).fold(0.0, f64::max);
    assert!(peak > 1e4 * first.ratio, "{peak}");
}

#[test]
fn the_response_between_two_signals_depends_only_on_the_path_between_them() {
    // M v' = spring force - f v for either drive, so the spring has no influence.
    let (m, f) = (454.0, 17.86e3);
    let program = shipped("thesis/fig-8-04", &[]);
    let model = model(&program);
    for drive in ["v_i", "x_i"] {
        let transfer = TransferFunction::between(&model, drive, "spring_force", "v_o").unwrap();
        let found = transfer.response(FrequencyBand { low: 0.1, high: 1000.0 }).unwrap();
        assert_eq!(found.unit, "m/s per N");
        assert_eq!(found.title(), format!("v_o from spring_force, moved by {drive}"));
        for point in &found.points {
            let reactance = m * TAU * point.frequency;
            assert!(near(point.ratio, 1.0 / reactance.hypot(f), 1e-10), "{point:?}");
            assert!(near(point.phase, -reactance.atan2(f), 1e-10), "{point:?}");
        }
    }
    let unaffected = TransferFunction::between(&model, "v_i", "x_i", "v_o")
        .unwrap()
        .response(FrequencyBand { low: 1.0, high: 10.0 });
    assert_eq!(unaffected.unwrap_err().to_string(), "x_i does not depend on v_i at this operating point");
    let unknown = TransferFunction::between(&model, "v_i", "spring_forse", "v_o").unwrap_err().to_string();
    assert_eq!(unknown, "the patch has no signal spring_forse; did you mean \"spring_force\"?");
}

#[test]
fn the_response_of_a_drive_to_itself_is_1() {
    let found = response(&built(lag(0.1)), "u", "u", [1.0, 10.0]);
    assert!(found.points.iter().all(|point| (point.ratio, point.phase) == (1.0, 0.0)));
}

#[test]
fn invalid_requests_return_errors() {
    let program = shipped("thesis/fig-8-04", &[]);
    let model = model(&program);
    let error = |from: &str, to: &str| TransferFunction::new(&model, from, to).unwrap_err().to_string();
    assert_eq!(error("v_j", "v_o"), "v_j is not a drive; did you mean \"v_i\"?");
    assert_eq!(error("v_o", "v_i"), "v_o is not a drive; did you mean \"v_i\"?");
    assert!(error("+100", "v_i").starts_with("+100 is not a drive; known here: v_i, x_i"));
    assert_eq!(error("v_i", "v_p"), "the patch has no signal v_p; did you mean \"v_o\"?");
    let uninfluenced = TransferFunction::new(&model, "v_i", "x_i").unwrap();
    let band = FrequencyBand { low: 1.0, high: 10.0 };
    let uninfluenced = uninfluenced.response(band);
    assert!(matches!(uninfluenced, Err(LinearError::NoInfluence { .. })), "{uninfluenced:?}");
    let transfer = TransferFunction::new(&model, "v_i", "v_o").unwrap();
    let infinite = f64::INFINITY;
    let reversed = [(0.0, 1.0), (-1.0, 1.0), (2.0, 2.0), (2.0, 1.0)];
    for (low, high) in
        reversed.into_iter().chain([(1.0, infinite), (f64::NAN, 1.0), (1e-300, 1e300), (1.0, 1e101)])
    {
        assert!(
            matches!(transfer.response(FrequencyBand { low, high }), Err(LinearError::BadBand { .. })),
            "{low} {high}"
        );
    }
    let widest = transfer.response(FrequencyBand { low: 1e-100, high: 1e100 }).unwrap().points;
    assert!(widest.len() > 12_000 && widest.iter().all(|point| point.ratio.is_finite()));
}

#[test]
fn the_default_band_contains_the_roots() {
    let program = shipped("thesis/fig-8-04", &[]);
    let model = model(&program);
    // 31.57 Hz
    let band = FrequencyBand::around(&roots(&model).unwrap(), &model);
    assert_eq!(band, FrequencyBand { low: 1.0, high: 1000.0 });
    let program = built(volts("none").drive("u", "volt", element("step").set("height", 1)));
    assert_eq!(
        FrequencyBand::around(&[], &crate::linear::model(&program)),
        FrequencyBand { low: 0.01, high: 100.0 }
    );
}

#[test]
fn a_csv_table_has_exact_numbers() {
    let found = response(&built(lag(0.1)), "u", "L", [1.0, 2.0]);
    let mut table = Vec::new();
    found.write_csv(&mut table).unwrap();
    let text = String::from_utf8(table).unwrap();
    let lines: Vec<&str> = text.lines().filter(|line| !line.starts_with('#')).collect();
    assert_eq!((lines[0], lines.len()), ("frequency,ratio,decibels,phase", found.points.len() + 1));
    let row: Vec<f64> = lines[3].split(',').map(|cell| cell.parse().unwrap()).collect();
    let point = found.points[2];
    assert_eq!(row, [point.frequency, point.ratio, point.decibels(), point.phase.to_degrees()]);
}

#[test]
fn a_csv_table_has_no_row_for_an_infinite_or_absent_response() {
    let point = |frequency: f64, ratio: f64, phase: f64| ResponsePoint { frequency, ratio, phase };
    let points = vec![
        point(1.0, f64::INFINITY, f64::NAN),
        point(2.0, 0.0, f64::NAN),
        point(3.0, 1.0, 0.0),
        point(4.0, f64::NAN, f64::NAN),
    ];
    let (input, output, unit) = ("u".to_owned(), "x".to_owned(), String::new());
    let mut table = Vec::new();
    FrequencyResponse { input, by: None, output, unit, points }.write_csv(&mut table).unwrap();
    let text = String::from_utf8(table).unwrap();
    let rows: Vec<&str> = text.lines().filter(|line| !line.starts_with('#')).skip(1).collect();
    assert_eq!(rows, ["3.0,1.0,0.0,0.0"]);
}
