//! Compares Fig 8.16 with SciPy's solution of the physical equations (table by
//! crates/core/tests/reference/fig_8_16.py).

use std::fs;

use crate::known_problems::runs::{difference, run, values};

/// The settings of the cases in crates/core/tests/reference/fig_8_16.py.
const CASES: &[&[(&str, f64)]] = &[
    &[("VcL", 2.54e-3), ("Tc", 0.0065), ("v_rate", 1.2e-3)],
    &[("VcL", 1.27e-3), ("Tc", 0.006), ("v_rate", 1.2e-3), ("v_start", 1e-3)],
    &[("VcL", 5.08e-3), ("Tc", 0.0095), ("v_rate", 2.4e-3), ("v_start", 2e-3)],
    &[("VcL", 25.4e-3), ("Tc", 0.025), ("v_rate", 1.2e-3), ("v_start", 3e-3), ("K", 17.86e6), ("M", 454.0)],
    &[("VcL", 10.16e-3), ("Tc", 0.002), ("v_rate", 0.0), ("v_start", 1e-3), ("f", 2e3), ("Fs", 300.0)],
    &[("VcL", 2.54e-3), ("Tc", 0.5), ("v_rate", 1.2e-3), ("v_start", -1e-3), ("K", 80e6), ("M", 1000.0)],
];

/// Permitted difference from SciPy relative to the peak, with the default step of 20 us. The largest observed is
/// 8.3e-10.
const MAX_DIFFERENCE: f64 = 1e-8;

/// The rows of a case: t, v_o, spring_force, memory.
fn reference(case: usize) -> Vec<Vec<f64>> {
    let table = fs::read_to_string("tests/reference/fig_8_16.csv").unwrap();
    let rows = table.lines().skip(1).map(|line| line.split(',').map(|cell| cell.parse().unwrap()).collect());
    rows.filter(|row: &Vec<f64>| row[0] == case as f64).map(|row| row[1..].to_vec()).collect()
}

#[test]
fn fig_8_16_agrees_with_scipy() {
    for (case, changes) in CASES.iter().enumerate() {
        let (trace, reference) = (run("thesis/fig-8-16", changes, 0.2), reference(case));
        assert_eq!(trace.overloads().count(), 0, "case {case}");
        assert_eq!(trace.len(), reference.len(), "case {case}");
        for (column, signal) in ["v_o", "spring_force", "memory"].iter().enumerate() {
            let expected: Vec<f64> = reference.iter().map(|row| row[column + 1]).collect();
            let relative_difference = difference(&values(&trace, signal), &expected);
            println!("case {case} {signal}: {relative_difference:.1e} of the peak");
            assert!(
                relative_difference <= MAX_DIFFERENCE,
                "case {case}, {signal}: {relative_difference} of the peak"
            );
        }
    }
}
