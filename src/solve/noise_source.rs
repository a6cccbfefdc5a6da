//! A noise voltage while the machine runs: one number after the other, on a time grid of its own.

use super::error::RunError;
use super::machine::Machine;
use super::run::MOST_STEPS;
use crate::grid::Grid;
use crate::program::{Distribution, Noise, Program};

/// Where a noise voltage is in its row of numbers.
#[derive(Debug, Clone)]
pub(super) struct NoiseSource {
    seed: f64,
    every: f64,
    distribution: Distribution,
    grid: Grid,
    place: u64,
}

impl NoiseSource {
    /// The source of each noise voltage, at the beginning of its row.
    pub fn all(program: &Program, coefficients: &[f64]) -> Vec<Self> {
        program.noises.iter().map(|noise| NoiseSource::new(noise, coefficients)).collect()
    }

    fn new(noise: &Noise, coefficients: &[f64]) -> Self {
        let (seed, every) = (coefficients[noise.seed as usize], coefficients[noise.every as usize]);
        NoiseSource { seed, every, distribution: noise.distribution, grid: Grid::new(every), place: 0 }
    }

    /// Goes to the number that holds at a time.
    pub fn go_to(&mut self, time: f64) {
        self.place = self.grid.steps_in(time);
    }

    /// The number that holds now.
    pub fn number(&self) -> f64 {
        self.distribution.number(self.seed, self.place)
    }

    /// When the next number takes over.
    pub fn next(&self) -> f64 {
        self.grid.time(self.place + 1)
    }

    /// Numbers in a second.
    pub fn rate(&self) -> f64 {
        1.0 / self.every
    }
}

impl Machine<'_> {
    /// Draws the numbers that hold now, as the settings are now.
    pub(super) fn draw_anew(&mut self) {
        self.noises = NoiseSource::all(self.program, &self.coefficients);
        for (source, drawn) in self.noises.iter_mut().zip(&mut self.drawn) {
            source.go_to(self.time);
            *drawn = source.number();
        }
    }

    /// Draws the numbers that take over by a time; tells whether there were any.
    pub(super) fn draw_by(&mut self, time: f64) -> bool {
        let mut any = false;
        for (source, drawn) in self.noises.iter_mut().zip(&mut self.drawn) {
            if source.next() <= time {
                source.place = source.grid.steps_in(time).max(source.place + 1);
                *drawn = source.number();
                any = true;
            }
        }
        any
    }

    /// Refuses noise so fine that a run of this length would never end.
    pub(super) fn check_noise(&self, length: f64) -> Result<(), RunError> {
        for (source, noise) in self.noises.iter().zip(&self.program.noises) {
            let numbers = length * source.rate();
            if numbers > MOST_STEPS {
                let element = self.program.name(noise.element).to_owned();
                return Err(RunError::NoiseTooFine { element, numbers, most: MOST_STEPS });
            }
        }
        Ok(())
    }
}
