//! The derivatives of an unknown input by finite differences, compared with the sensitivity equations.

use serde_json::json;

use super::*;
use crate::fit::fitted_model::ModelVariant;
use crate::fit::step_size::tests::measured;
use patchcord_core::circuit::Circuit;
use patchcord_core::ir::Program;
use patchcord_core::patch::Patch;
use patchcord_core::solve::{self, RunSettings};

const SAMPLES: usize = 201;
const INTERVAL: f64 = 0.01;
const STEPS: u32 = 4;
const KNOTS: usize = 11;
/// The force at the knots. It moves the mass through its play and far beyond.
const FORCE: [f64; KNOTS] = [2.0, 30.0, -20.0, 10.0, 40.0, -50.0, 0.0, 25.0, -30.0, 5.0, 1.0];

fn knot_time(knot: usize) -> f64 {
    knot as f64 * (SAMPLES - 1) as f64 * INTERVAL / (KNOTS - 1) as f64
}

/// A mass with play in its spring and quadratic friction. A second force, of 1 V at one knot and linear to 0 at the
/// neighbouring knots, acts through a pot with the setting p.
fn mass(knot: usize) -> Patch {
    let table = |height: &dyn Fn(usize) -> f64| {
        let points: Vec<_> = (0..KNOTS).map(|index| [knot_time(index), height(index)]).collect();
        json!({"kind": "table", "scale": "volt", "points": points})
    };
    let text = json!({
        "patchcord": 1,
        "parameters": {"p": {"value": 0, "unit": "1", "range": [0, 1]}},
        "scales": {"volt": {"unit": "V", "per_volt": 1}},
        "drives": {
            "force": table(&|index| FORCE[index]),
            "further": table(&|index| f64::from(index == knot)),
        },
        "elements": {
            "P1": {"kind": "pot", "in": "further", "setting": "p"},
            "Z1": {"kind": "dead-zone", "in": "A2", "lower": -3, "upper": 5},
            "B1": {"kind": "inverter", "in": "Z1"},
            "U1": {"kind": "absolute", "in": "A1"},
            "M1": {"kind": "multiplier", "mode": "product", "a": "A1", "b": "U1"},
            "A1": {"kind": "integrator", "in": {"x10": ["force", "P1", "B1"], "x1": ["M1"]}},
            "A2": {"kind": "integrator", "in": {"x10": ["A1"]}},
        },
        "signals": {"x": {"at": "A2", "scale": "volt"}, "v": {"at": "A1", "scale": "volt"}},
        "run": {"for": 2, "step": 0.0025}
    });
    Patch::parse("mass.json", &text.to_string()).unwrap_or_else(|report| panic!("{report}"))
}

/// The derivatives of x and v by the setting of the pot, sample by sample, from the sensitivity equations.
fn exact_derivatives(patch: &Patch) -> [Vec<f64>; 2] {
    let circuit = Circuit::new(patch).unwrap();
    let settings = RunSettings::of(&circuit)
        .unwrap()
        .with_step(INTERVAL / f64::from(STEPS))
        .with_sample_interval(INTERVAL)
        .with_signals(["x", "v"])
        .with_sensitivities(["p"]);
    let trace = solve::run(&Program::new(&circuit).unwrap(), &settings).unwrap();
    ["x", "v"].map(|signal| trace.derivative(signal, "p").unwrap().values().collect())
}

/// The derivatives of both outputs by the pot and by the force at a knot, from the finite differences of the
/// estimation.
fn finite_differences(patch: &Patch, knot: usize) -> Vec<DMatrix<f64>> {
    let mut problem = measured("x", vec![0.0; SAMPLES], 1.0, STEPS);
    problem.outputs.push("v".to_owned());
    problem.sigma.push(1.0);
    problem.has_offset.push(false);
    problem.train[0].interval = INTERVAL;
    problem.train[0].outputs.push(vec![0.0; SAMPLES]);
    let fit = vec!["p".to_owned()];
    let variant = ModelVariant::new(patch.clone(), fit, Vec::new(), STEPS);
    let model = problem.model(&variant, &problem.train, &problem.outputs).unwrap();
    let fit_problem = problem.fit_problem(&model, &problem.train, true);
    let points = (0..KNOTS).map(|index| (knot_time(index), vec![(index, 1.0)])).collect();
    let basis = InputBasis { groups: vec![KNOTS], records: vec![points] };
    let reference = Estimate { parameters: vec![0.0], initial: vec![vec![0.0; 2]], offsets: vec![0.0; 2] };
    let estimation = InputEstimation {
        fit_problem,
        table: ReplacedTable::Drive("force"),
        perturbation: PERTURBATION,
        basis: &basis,
        reference: &reference,
        baseline_chi2: f64::INFINITY,
        has_feedback: false,
        nuisance_spread: 0.1,
    };
    let iterate = Iterate {
        coordinates: fit_problem.coordinates(&reference),
        coefficients: DVector::from_column_slice(&FORCE),
    };
    let columns = estimation.columns(0, &iterate, &[0]).unwrap();
    columns.iter().map(|output| output.select_columns(&[0, 1 + knot])).collect()
}

#[test]
fn finite_differences_agree_with_the_sensitivity_equations() {
    for knot in [0, 3, 7] {
        let patch = mass(knot);
        let exact = exact_derivatives(&patch);
        for (exact, columns) in exact.iter().zip(finite_differences(&patch, knot)) {
            let exact = DVector::from_column_slice(exact);
            for column in columns.column_iter() {
                let error = (column - &exact).amax() / exact.amax();
                assert!(error < 1e-4, "{knot}: {error}");
            }
        }
    }
}
