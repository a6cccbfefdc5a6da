//! The rod of the lesson heat-rod: six cells between hot water and the end that is wrapped up.

use std::f64::consts::PI;

pub const CELLS: usize = 6;
pub const HOT: f64 = 80.0;
/// Diffusivity by the square of a cell's length, per second.
pub const RATE: f64 = 1.16e-4 / (0.05 * 0.05);

/// Temperature of a cell by the eigenvectors sin(i theta) of the chain: held at the hot end, free at the other.
pub fn chain(cell: usize, time: f64) -> f64 {
    let modes = (1..=CELLS).map(|mode| {
        let theta = (2 * mode - 1) as f64 * PI / (2 * CELLS + 1) as f64;
        let shape = |cell: usize| (cell as f64 * theta).sin();
        let share = (1..=CELLS).map(shape).sum::<f64>() / (1..=CELLS).map(|i| shape(i).powi(2)).sum::<f64>();
        share * shape(cell) * (-4.0 * RATE * (theta / 2.0).sin().powi(2) * time).exp()
    });
    HOT * (1.0 - modes.sum::<f64>())
}
