//! A rod of six cells: its closed solution, and the continuous rod that it approximates.

use std::f64::consts::PI;

use crate::common::{run_for, voltage};
use crate::known_problems::heat_rod::{CELLS, HOT, RATE, chain};
use crate::known_problems::runs::{program, step_of};

const STEM: &str = "lessons/heat-rod";

/// Temperature of a continuous rod, 6.5 cells long because its free end is half a cell beyond the last one. Source:
/// Carslaw and Jaeger, chapter 3.
fn rod(cell: usize, time: f64) -> f64 {
    let length = CELLS as f64 + 0.5;
    let modes = (1..200).map(|mode| {
        let wave = (2 * mode - 1) as f64 * PI / (2.0 * length);
        2.0 / (wave * length) * (wave * cell as f64).sin() * (-RATE * wave * wave * time).exp()
    });
    HOT * (1.0 - modes.sum::<f64>())
}

/// The temperatures of the cells. Every second one is patched with a negative sign.
fn temperatures(time: f64) -> [f64; CELLS] {
    let program = program(STEM, &[]);
    let machine = run_for(&program, step_of(STEM), time);
    std::array::from_fn(|index| {
        let volts = voltage(&machine, &format!("C{}.A", index + 1));
        if index % 2 == 0 { -volts } else { volts }
    })
}

#[test]
fn temperatures_follow_the_closed_solution_of_the_chain() {
    for time in [10.0, 100.0, 400.0, 1500.0] {
        for (index, found) in temperatures(time).into_iter().enumerate() {
            let expected = chain(index + 1, time);
            // Runge-Kutta with steps of a tenth of the fastest decay, 4 RATE.
            assert!((found - expected).abs() < 1e-5, "cell {} after {time} s: {found} {expected}", index + 1);
        }
    }
}

#[test]
fn the_slowest_decay_is_the_first_eigenvalue() {
    let missing = |time: f64| HOT - temperatures(time)[CELLS - 1];
    let found = (missing(1500.0) / missing(2500.0)).ln() / 1000.0;
    let first = 4.0 * RATE * (PI / 26.0).sin().powi(2);
    assert!((found / first - 1.0).abs() < 1e-6, "{found} {first}");
    // The eigenvalue of the continuous rod, RATE (pi / 13)^2, is larger by x^2 / 3, x = pi / 26.
    let whole = RATE * (PI / 13.0).powi(2);
    assert!((whole / found - 1.0 - (PI / 26.0f64).powi(2) / 3.0).abs() < 1e-4, "{whole} {found}");
}

#[test]
fn six_cells_approximate_the_continuous_rod() {
    for time in [100.0, 200.0, 500.0, 1000.0] {
        for (index, found) in temperatures(time).into_iter().enumerate() {
            let expected = rod(index + 1, time);
            assert!((found - expected).abs() < 0.5, "cell {} after {time} s: {found} {expected}", index + 1);
        }
    }
}
