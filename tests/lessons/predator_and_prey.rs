//! Predator and prey: the conserved quantity and the period.

use std::f64::consts::TAU;

use crate::common::{run_for, voltage};
use crate::known_problems::runs::{program, run, step_of, values};
use crate::lessons::crossings::next_rise;
use patchcord::solve::Machine;

const STEM: &str = "lessons/predator-and-prey";
const ALPHA: f64 = 0.55;
const BETA: f64 = 2.8e-5;
const GAMMA: f64 = 0.8;
const DELTA: f64 = 2.4e-5;

#[test]
fn the_quantity_of_volterra_is_conserved() {
    let trace = run(STEM, &[], 100.0);
    let (hares, lynxes) = (values(&trace, "hares"), values(&trace, "lynxes"));
    let quantity = |x: f64, y: f64| DELTA * x - GAMMA * x.ln() + BETA * y - ALPHA * y.ln();
    let begin = quantity(34_000.0, 6_000.0);
    for (x, y) in hares.iter().zip(&lynxes) {
        // Runge-Kutta of order 4 at h = 0.01 over ten periods.
        assert!((quantity(*x, *y) - begin).abs() < 1e-9, "{}", quantity(*x, *y) - begin);
    }
}

/// The time between two rises of the hares through equilibrium.
fn period(changes: &[(&str, f64)]) -> f64 {
    let program = program(STEM, changes);
    let mut machine = run_for(&program, step_of(STEM), 0.0);
    let above_balance = |machine: &Machine<'_>| voltage(machine, "A1") * 1e3 - GAMMA / DELTA;
    let first = next_rise(&mut machine, above_balance);
    next_rise(&mut machine, above_balance) - first
}

#[test]
fn the_period_matches_an_independent_solver() {
    // scipy 1.17, DOP853 at 1e-13, from 34000 hares and 6000 lynxes.
    assert!((period(&[]) - 10.137_923_524_2).abs() < 1e-8, "{}", period(&[]));
}

#[test]
fn the_period_of_small_oscillations_is_two_pi_by_sqrt_alpha_gamma() {
    let expected = TAU / (ALPHA * GAMMA).sqrt();
    let longer = |fraction: f64| {
        let start = [("x0", GAMMA / DELTA * (1.0 + fraction)), ("y0", ALPHA / BETA)];
        period(&start) / expected - 1.0
    };
    let (wide, narrow) = (longer(0.04), longer(0.02));
    assert!(narrow.abs() < 1e-4, "{narrow}");
    // The increase of the period is proportional to the square of the amplitude.
    assert!((wide / narrow - 4.0).abs() < 0.1, "{wide} {narrow}");
}

#[test]
fn all_rates_are_0_at_equilibrium() {
    let program = program(STEM, &[("x0", GAMMA / DELTA), ("y0", ALPHA / BETA)]);
    let rates = run_for(&program, step_of(STEM), 0.0).rates().to_vec();
    assert!(rates.iter().all(|rate| rate.abs() < 1e-12), "{rates:?}");
}
