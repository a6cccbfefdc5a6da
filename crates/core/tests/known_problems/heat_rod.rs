//! The rod of the lesson heat-rod: six cells between hot water and an insulated end.

use std::f64::consts::PI;

/// Number of cells of the patch.
pub(crate) const CELLS: usize = 6;
/// Temperature of the water above the rod's initial temperature, in K.
pub(crate) const HOT: f64 = 80.0;
/// Diffusivity 1.16e-4 m2/s divided by the square of a cell's length of 0.05 m, per second.
pub(crate) const RATE: f64 = 1.16e-4 / (0.05 * 0.05);

/// Temperature of a cell in K, by the eigenvectors sin(i theta) of the chain. They are 0 at the hot end and free at the
/// other. Cells are numbered from 1 at the hot end.
pub(crate) fn chain(cell: usize, time: f64) -> f64 {
    let modes = (1..=CELLS).map(|mode| {
        let theta = (2 * mode - 1) as f64 * PI / (2 * CELLS + 1) as f64;
        let shape = |cell: usize| (cell as f64 * theta).sin();
        let weight = (1..=CELLS).map(shape).sum::<f64>() / (1..=CELLS).map(|i| shape(i).powi(2)).sum::<f64>();
        weight * shape(cell) * (-4.0 * RATE * (theta / 2.0).sin().powi(2) * time).exp()
    });
    HOT * (1.0 - modes.sum::<f64>())
}
