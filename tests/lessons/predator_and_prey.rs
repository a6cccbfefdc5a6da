//! Predator and prey: what is conserved, and how long a turn takes.

use std::f64::consts::TAU;

use crate::common::{ran, voltage};
use crate::known::runs::{program, run, step_of, values};
use crate::lessons::bench::next_rise;
use patchcord::solve::Machine;

const STEM: &str = "lessons/predator-and-prey";
const ALPHA: f64 = 0.55;
const BETA: f64 = 2.8e-5;
const GAMMA: f64 = 0.8;
const DELTA: f64 = 2.4e-5;

#[test]
fn volterras_quantity_stays_the_same() {
    let trace = run(STEM, &[], 100.0);
    let (hares, lynxes) = (values(&trace, "hares"), values(&trace, "lynxes"));
    let quantity = |x: f64, y: f64| DELTA * x - GAMMA * x.ln() + BETA * y - ALPHA * y.ln();
    let begin = quantity(34_000.0, 6_000.0);
    for (x, y) in hares.iter().zip(&lynxes) {
        // Runge-Kutta of order 4 at h = 0.01, over ten turns.
        assert!((quantity(*x, *y) - begin).abs() < 1e-9, "{}", quantity(*x, *y) - begin);
    }
}

/// The time between two rises of the hares through their balance.
fn period(changes: &[(&str, f64)]) -> f64 {
    let program = program(STEM, changes);
    let mut machine = ran(&program, step_of(STEM), 0.0);
    let above_balance = |machine: &Machine<'_>| voltage(machine, "A1") * 1e3 - GAMMA / DELTA;
    let first = next_rise(&mut machine, above_balance);
    next_rise(&mut machine, above_balance) - first
}

#[test]
fn a_turn_takes_as_long_as_an_independent_solver_says() {
    // scipy 1.17, DOP853 at 1e-13, from 34000 hares and 6000 lynxes.
    assert!((period(&[]) - 10.137_923_524_2).abs() < 1e-8, "{}", period(&[]));
}

#[test]
fn a_small_turn_takes_two_pi_by_the_root_of_alpha_gamma() {
    let expected = TAU / (ALPHA * GAMMA).sqrt();
    let longer = |share: f64| {
        let start = [("x0", GAMMA / DELTA * (1.0 + share)), ("y0", ALPHA / BETA)];
        period(&start) / expected - 1.0
    };
    let (wide, narrow) = (longer(0.04), longer(0.02));
    assert!(narrow.abs() < 1e-4, "{narrow}");
    // What a turn takes longer goes with the square of its width.
    assert!((wide / narrow - 4.0).abs() < 0.1, "{wide} {narrow}");
}

#[test]
fn in_balance_nothing_changes() {
    let program = program(STEM, &[("x0", GAMMA / DELTA), ("y0", ALPHA / BETA)]);
    let rates = ran(&program, step_of(STEM), 0.0).rates().to_vec();
    assert!(rates.iter().all(|rate| rate.abs() < 1e-12), "{rates:?}");
}
