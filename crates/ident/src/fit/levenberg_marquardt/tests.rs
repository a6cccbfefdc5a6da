//! Unit tests of `levenberg_marquardt`.

use super::*;
use crate::fit::model::FitProgram;
use patchcord_core::patch::Patch;

/// An integrator without input. Its output B1 = -begin is constant; begin is from -50 to 0 V.
const CONSTANT: &str = r#"{
  "patchcord": 1,
  "parameters": {"begin": {"value": -30, "unit": "1", "range": [-50, 0]}},
  "elements": {"L1": {"kind": "held"}, "B1": {"kind": "inverter", "in": "L1.out"}},
  "macros": {"held": {"outputs": {"out": "A1"}, "elements": {
    "A1": {"kind": "integrator", "in": {"x1": ["ground"]}, "initial": "begin"}
  }}}
}"#;

/// The fitted initial voltage, from a start, if B1 was measured as a constant. All in V.
fn fitted_voltage(start: f64, measured: f64) -> f64 {
    let patch = Patch::parse("standing.json", CONSTANT).unwrap_or_else(|report| panic!("{report}"));
    let records = [Record {
        name: String::new(),
        begin: 0.0,
        start_in_file: 0.0,
        interval: 0.1,
        jitter: 0.0,
        drives: Vec::new(),
        outputs: vec![vec![measured; 12]],
    }];
    let [initial_states, outputs] = ["begin", "B1"].map(|name| [name.to_owned()]);
    let program = FitProgram::new(&patch, &[]).unwrap();
    let model = Model::new(&program, &patch, &records, &[], &initial_states, &outputs, 1).unwrap();
    let fit_problem = FitProblem {
        model: &model,
        records: &records,
        sigma: &[1.0],
        has_offset: &[false],
        fits_parameters: true,
        fixed_parameter: None,
        target_chi2: f64::INFINITY,
        max_iterations: MAX_ITERATIONS,
        convergence_ratio: CONVERGENCE_RATIO,
        damping_schedule: DampingSchedule::SEQUENTIAL,
    };
    let start = Estimate { parameters: Vec::new(), initial: vec![vec![start]], offsets: vec![0.0] };
    fit_problem.fit(&start).unwrap().estimate.initial[0][0]
}

#[test]
fn initial_voltages_are_fitted_within_their_ranges() {
    for start in [-50.0, -30.0, 0.0] {
        for (measured, expected) in [(20.0, -20.0), (-10.0, 0.0), (70.0, -50.0)] {
            let fitted = fitted_voltage(start, measured);
            assert!((fitted - expected).abs() < 1e-6, "{fitted} from {start}, expected {expected}");
        }
    }
}
