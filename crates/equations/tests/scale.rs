//! All problems of `tests/systems` and `problems` become patches without overloads whose runs agree with SciPy.

use std::path::Path;

use patchcord_core::circuit::Circuit;
use patchcord_core::ir::Program;
use patchcord_core::patch::Problem;
use patchcord_core::solve::{RunSettings, run};
use patchcord_core::trace::Trace;
use patchcord_equations::{ScaleOptions, ScaledProblem, compare_equations, scale_problem};
use patchcord_expr::Unit;
use serde_json::Value;

use crate::problem_files::{problem_file, problem_files, reference};
use crate::rod::rod;

/// Largest difference from SciPy, as a share of the peak.
const TOLERANCE: f64 = 1e-6;

/// The scaled patch of a problem.
pub(crate) fn scaled(path: &Path) -> ScaledProblem {
    let problem = Problem::read(path).unwrap_or_else(|error| panic!("{error}"));
    scale_problem(&problem, &ScaleOptions::default())
        .unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}

/// The record of a run of the patch.
fn trace(scaled: &ScaledProblem) -> Trace {
    let circuit = Circuit::new(&scaled.patch).unwrap_or_else(|report| panic!("{report}"));
    let program = Program::new(&circuit).unwrap();
    run(&program, &RunSettings::of(&circuit).unwrap()).unwrap()
}

/// The name of the signal of a quantity: x_dot for x'.
fn signal_name(quantity: &str) -> String {
    let base = quantity.trim_end_matches('\'');
    let ending = ["", "_dot", "_ddot", "_dddot"][quantity.len() - base.len()];
    format!("{base}{ending}")
}

/// The largest difference of a quantity from its reference, as a share of its peak.
fn difference(trace: &Trace, times: &[f64], quantity: &str, reference: &Value) -> f64 {
    let track = trace.track(&signal_name(quantity)).unwrap_or_else(|| panic!("{quantity} is recorded"));
    let [own, wanted] = [track.unit.as_str(), reference["unit"].as_str().unwrap()].map(Unit::parse);
    let (own, wanted) = (own.unwrap(), wanted.unwrap());
    let values: Vec<f64> = track.values().collect();
    let end = times.last().unwrap();
    let at = |time: &f64| {
        let is_near = |sample: &f64| (sample - time).abs() <= 1e-9 * end;
        trace.time.iter().position(is_near).unwrap_or_else(|| panic!("a sample at {time}"))
    };
    let pairs = times.iter().zip(reference["values"].as_array().unwrap());
    let differences = pairs.map(|(time, expected)| {
        let found = wanted.out_of_si(own.to_si(values[at(time)]));
        (found - expected.as_f64().unwrap()).abs()
    });
    differences.fold(0.0, f64::max) / reference["peak"].as_f64().unwrap()
}

#[test]
fn every_problem_becomes_a_patch_that_agrees_with_scipy() {
    let mut faults = Vec::new();
    for path in problem_files() {
        let name = path.file_stem().unwrap().to_string_lossy().into_owned();
        let scaled = scaled(&path);
        let trace = trace(&scaled);
        let overloads: Vec<&str> = trace.overloads().map(|overload| overload.element.as_str()).collect();
        if !overloads.is_empty() {
            faults.push(format!("{name}: {overloads:?} overload"));
        }
        let low = scaled.peaks.iter().filter(|peak| {
            let is_explained = peak.reason.is_some_and(|reason| !reason.starts_with("no run"));
            !(50.0..=95.0).contains(&peak.volts) && (!is_explained || peak.volts > 95.0)
        });
        faults.extend(low.map(|peak| format!("{name}: {} peaks at {:.1} V", peak.output, peak.volts)));
        let reference = reference(&path);
        let times: Vec<f64> =
            reference["times"].as_array().unwrap().iter().map(|time| time.as_f64().unwrap()).collect();
        for (quantity, entry) in reference["quantities"].as_object().unwrap() {
            let difference = difference(&trace, &times, quantity, entry);
            if difference > TOLERANCE {
                faults.push(format!("{name}: {quantity} differs by {difference:.1e} of its peak"));
            }
        }
    }
    assert!(faults.is_empty(), "{faults:#?}");
}

/// The exponentials are about 1e-11 and 1e-7, so the factors of their products in the equations are large. The rates of
/// the states are below 0.01/s.
#[test]
fn the_time_scale_of_arrhenius_terms_follows_from_the_states() {
    for name in ["heated-sample", "ignition"] {
        let scaled = scaled(&problem_file(name));
        assert!(scaled.time_scale <= 1e-3, "{name}: {}", scaled.time_scale);
        let exponentials = scaled.patch.elements.iter().filter(|(_, element)| element.kind.name == "exp");
        let outputs: Vec<&str> = exponentials.map(|(output, _)| output.as_str()).collect();
        let of_exponential = scaled.peaks.iter().filter(|peak| outputs.contains(&peak.output.as_str()));
        let peaks: Vec<f64> = of_exponential.map(|peak| peak.volts).collect();
        assert_eq!(peaks.len(), 1, "{name}");
        assert!((50.0..=95.0).contains(&peaks[0]), "{name}: {peaks:?}");
        let problem = Problem::read(problem_file(name)).unwrap_or_else(|error| panic!("{error}"));
        let options = ScaleOptions { time_scale: Some(0.2), ..ScaleOptions::default() };
        assert!(scale_problem(&problem, &options).is_ok_and(|scaled| scaled.time_scale == 0.2), "{name}");
    }
}

#[test]
fn a_rod_of_100_cells_reaches_its_straight_profile() {
    let scaled =
        scale_problem(&rod(100, r#"{"for": 20000, "step": 0.2, "every": 10000}"#), &ScaleOptions::default())
            .unwrap_or_else(|error| panic!("{error}"));
    assert!(scaled.peaks.iter().all(|peak| (50.0..=95.0).contains(&peak.volts)));
    let trace = trace(&scaled);
    for cell in 1..=100_u32 {
        let last = trace.values(&format!("T{cell}")).unwrap().last().copied().unwrap();
        // The slowest mode has the rate 4 a sin^2(pi / 202), so it has died out.
        let expected = 80.0 * (1.0 - f64::from(cell) / 101.0);
        assert!((last - expected).abs() < 1e-6, "T{cell} = {last}, expected {expected}");
    }
}

/// The scaled patch of a problem of pure numbers with these quantities and equations, and the last value of a signal
/// in its run.
fn last_value(quantities: &str, equations: &str, signal: &str) -> (ScaledProblem, f64) {
    let text = format!(
        r#"{{"patchcord": 1, "quantities": {{{quantities}}}, "equations": [{equations}],
            "run": {{"for": 2, "step": 0.001}}}}"#
    );
    let problem = Problem::parse("p.json", &text).unwrap_or_else(|report| panic!("{report}"));
    let scaled = scale_problem(&problem, &ScaleOptions::default()).unwrap_or_else(|error| panic!("{error}"));
    let last = trace(&scaled).values(signal).unwrap().last().copied().unwrap();
    (scaled, last)
}

#[test]
fn a_three_point_controller_stops_at_the_edge_of_its_dead_zone() {
    for start in [1.0, -1.0] {
        let quantities = format!(r#""y": {{"unit": "1", "initial": {start}}}"#);
        let (scaled, last) = last_value(&quantities, r#""y' = -sign(dead_zone(y, 0.1))""#, "y");
        assert!((last - 0.1 * start).abs() < 1e-9, "{last}");
        let circuit = Circuit::new(&scaled.patch).unwrap_or_else(|report| panic!("{report}"));
        let compared = compare_equations(&circuit, &Program::new(&circuit).unwrap());
        assert!(compared.iter().all(|compared| compared.agreement.is_solved()), "{compared:?}");
    }
}

#[test]
fn the_sign_of_a_limiter_at_0_is_0() {
    // x rises from -1 to 1, so its positive part is 0 in the first half.
    let quantities = r#""x": {"unit": "1", "initial": -1}, "y": {"unit": "1", "initial": 0}"#;
    let (_, last) = last_value(quantities, r#""x' = 1", "y' = sign(max(x, 0))""#, "y");
    assert!((last - 1.0).abs() < 1e-9, "{last}");
}

#[test]
fn the_sign_of_a_sum_that_stays_at_0_is_0() {
    // x rises from -1 to 1. The sums are 0 below 0, above 0, and above -0.3.
    let quantities = r#""x": {"unit": "1", "initial": -1}, "y": {"unit": "1", "initial": 0}"#;
    let cases = [("x + abs(x)", 1.0), ("x - max(x, 0)", -1.0), ("x - limit(x, -0.3, 1)", -0.7)];
    for (argument, expected) in cases {
        let equations = format!(r#""x' = 1", "y' = sign({argument})""#);
        let (_, last) = last_value(quantities, &equations, "y");
        assert!((last - expected).abs() < 1e-9, "{argument}: {last}");
    }
}

/// The cube of x is a product of x and its square, and a multiplier divides by 100 V. So x must peak above 79 V.
#[test]
fn the_factors_of_a_product_are_large_enough_for_it() {
    let duffing = scaled(&problem_file("duffing"));
    let low: Vec<_> = duffing.peaks.iter().filter(|peak| !peak.is_good()).collect();
    assert!(low.is_empty() && duffing.peaks.len() >= 5, "{low:?}");
}

#[test]
fn the_far_end_of_a_long_rod_is_0_in_a_short_run() {
    let problem = rod(400, r#"{"for": 20, "step": 0.2}"#);
    let scaled = scale_problem(&problem, &ScaleOptions::default()).unwrap_or_else(|error| panic!("{error}"));
    let far = scaled.quantities.iter().find(|quantity| quantity.name == "T400").unwrap();
    assert!(far.per_volt > 1e-70 && far.peak < 1e-9, "{far:?}");
    assert!(scaled.peaks.iter().all(|peak| peak.volts <= 95.0));
}

#[test]
fn the_patch_is_the_same_in_every_run() {
    let path = problem_file("slideway");
    assert_eq!(scaled(&path).patch.text(), scaled(&path).patch.text());
}
