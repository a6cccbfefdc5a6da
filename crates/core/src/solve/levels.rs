//! Levels in a run: voltages that stay constant between known instants, at which they jump to the next number.
//!
//! A level is a noise voltage, whose numbers follow each other on a separate grid, or a table whose values are held.

use super::discontinuities::INSTANT_TOLERANCE;
use super::error::RunError;
use super::run::MAX_STEPS;
use super::state::{Setup, SolverState};
use crate::grid::Grid;
use crate::ir::{Distribution, Level, Noise, Program, Tables, held, points_by};

/// The position of a level in its sequence of numbers.
#[derive(Debug, Clone)]
pub(super) enum LevelSource {
    /// A noise voltage.
    Noise(NoiseSource),
    /// A table whose values are held.
    Points {
        /// Index of the table.
        table: usize,
        /// Number of points whose time has come.
        after: usize,
    },
}

/// The position of a noise voltage in its sequence of numbers.
#[derive(Debug, Clone)]
pub(super) struct NoiseSource {
    /// Seed of the sequence.
    seed: f64,
    /// Problem seconds between two numbers.
    every: f64,
    distribution: Distribution,
    grid: Grid,
    /// Index of the present number.
    index: u64,
}

impl NoiseSource {
    /// The source of a noise voltage at its first number.
    fn new(noise: &Noise, coefficients: &[f64]) -> Self {
        let (seed, every) = (coefficients[noise.seed as usize], coefficients[noise.every as usize]);
        NoiseSource { seed, every, distribution: noise.distribution, grid: Grid::new(every), index: 0 }
    }

    /// Moves to the number at a time.
    fn seek(&mut self, time: f64) {
        self.index = self.grid.steps_in(time);
    }

    /// The present number.
    fn number(&self) -> f64 {
        self.distribution.number(self.seed, self.index)
    }

    /// The time of the next number.
    fn next(&self) -> f64 {
        self.grid.time(self.index + 1)
    }

    /// Numbers per problem second.
    fn rate(&self) -> f64 {
        1.0 / self.every
    }
}

impl LevelSource {
    /// The sources of all levels of a program, each at its first number.
    pub fn all(program: &Program, coefficients: &[f64]) -> Vec<Self> {
        let source = |level: &Level| match level {
            Level::Noise(noise) => LevelSource::Noise(NoiseSource::new(noise, coefficients)),
            Level::Points { table } => LevelSource::Points { table: *table, after: 0 },
        };
        program.levels.iter().map(source).collect()
    }

    /// The source of a noise voltage; `None` for a table.
    fn as_noise(&self) -> Option<&NoiseSource> {
        match self {
            LevelSource::Noise(source) => Some(source),
            LevelSource::Points { .. } => None,
        }
    }

    /// Moves to the number at a time. Points of a table up to `tolerance` seconds later count as reached.
    fn seek(&mut self, tables: &Tables, time: f64, tolerance: f64) {
        match self {
            LevelSource::Noise(source) => source.seek(time),
            LevelSource::Points { table, after } => *after = points_by(&tables[*table], time + tolerance),
        }
    }

    /// Moves to the number at a time, and returns whether it is another one than before.
    fn advance_to(&mut self, tables: &Tables, time: f64) -> bool {
        let is_due = self.next(tables) <= time;
        match self {
            LevelSource::Noise(source) if is_due => {
                source.index = source.grid.steps_in(time).max(source.index + 1);
            }
            LevelSource::Points { table, after } if is_due => *after = points_by(&tables[*table], time),
            _ => {}
        }
        is_due
    }

    /// The present number.
    fn number(&self, tables: &Tables) -> f64 {
        match self {
            LevelSource::Noise(source) => source.number(),
            LevelSource::Points { table, after } => held(&tables[*table], *after),
        }
    }

    /// The problem time of the next jump; infinity after the last point of a table.
    pub fn next(&self, tables: &Tables) -> f64 {
        match self {
            LevelSource::Noise(source) => source.next(),
            LevelSource::Points { table, after } => {
                tables[*table].get(*after).map_or(f64::INFINITY, |point| point[0])
            }
        }
    }
}

/// The number of jumps of all levels per problem second. For a table it is the average over its length.
pub(super) fn jump_rate(program: &Program, sources: &[LevelSource]) -> f64 {
    let rate = |source: &LevelSource| match source {
        LevelSource::Noise(source) => source.rate(),
        LevelSource::Points { table, .. } => match &program.tables[*table][..] {
            [first, .., last] => program.tables[*table].len() as f64 / (last[0] - first[0]),
            _ => 0.0,
        },
    };
    sources.iter().map(rate).sum()
}

impl SolverState {
    /// Makes the sources again from the present coefficients, and moves all levels to the present time.
    pub fn begin_levels(&mut self, setup: &Setup<'_>) {
        self.level_sources = LevelSource::all(setup.program, &self.coefficients);
        let (tables, tolerance) = (&setup.program.tables, INSTANT_TOLERANCE * setup.step);
        for (source, level) in self.level_sources.iter_mut().zip(&mut self.levels) {
            source.seek(tables, self.time, tolerance);
            *level = source.number(tables);
        }
    }

    /// Moves all levels to a time, and returns whether any of them jumped.
    pub fn change_levels(&mut self, tables: &Tables, time: f64) -> bool {
        let mut any = false;
        for (source, level) in self.level_sources.iter_mut().zip(&mut self.levels) {
            if source.advance_to(tables, time) {
                *level = source.number(tables);
                any = true;
            }
        }
        any
    }
}

/// Checks that noise does not draw so many numbers that a run of this length in seconds would never end.
///
/// # Errors
/// If a noise voltage draws more than [`MAX_STEPS`] numbers.
pub(super) fn check_noise(program: &Program, sources: &[LevelSource], length: f64) -> Result<(), RunError> {
    let noises = sources.iter().filter_map(LevelSource::as_noise);
    for (source, noise) in noises.zip(program.noises()) {
        let numbers = length * source.rate();
        if numbers > MAX_STEPS {
            let element = program.name(noise.element).to_owned();
            return Err(RunError::NoiseTooFine { element, numbers, most: MAX_STEPS });
        }
    }
    Ok(())
}
