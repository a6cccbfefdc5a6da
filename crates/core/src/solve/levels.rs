//! Levels in a run: values that stay constant between known instants, at which they jump to the next value.
//!
//! A level is a noise voltage, which draws a number at every instant of its grid, or a table whose values are held
//! until the next point. The instants are known in advance, so every step ends at the next of them.

use super::discontinuities::INSTANT_TOLERANCE;
use super::error::RunError;
use super::settings_check::MAX_STEPS;
use super::state::{Setup, SolverState};
use crate::grid::Grid;
use crate::ir::{Distribution, Level, Noise, Program, Tables, held_value, points_passed};

/// The position of a level in its sequence of values.
#[derive(Debug, Clone)]
pub(super) enum LevelSource {
    /// A noise voltage.
    Noise(NoiseSource),
    /// A table whose values are held.
    Points {
        /// Index of the table.
        table: usize,
        /// Number of points whose time has passed. The value is that of the last of them, or of the first point before
        /// any.
        passed: usize,
    },
}

/// The position of a noise voltage in its sequence of numbers.
#[derive(Debug, Clone)]
pub(super) struct NoiseSource {
    /// Seed of the sequence, a whole number.
    seed: f64,
    /// Problem seconds between two numbers.
    every: f64,
    /// The distribution of the numbers.
    distribution: Distribution,
    /// The instants at which numbers are drawn.
    grid: Grid,
    /// Index of the present number, from 0.
    index: u64,
}

impl NoiseSource {
    /// The source of a noise voltage at its first number.
    fn new(noise: &Noise, coefficients: &[f64]) -> Self {
        let (seed, every) = (coefficients[noise.seed as usize], coefficients[noise.every as usize]);
        NoiseSource { seed, every, distribution: noise.distribution, grid: Grid::new(every), index: 0 }
    }

    /// Moves to the number of a problem time.
    fn seek(&mut self, time: f64) {
        self.index = self.grid.steps_in(time);
    }

    /// The present number.
    fn number(&self) -> f64 {
        self.distribution.number(self.seed, self.index)
    }

    /// The problem time of the next number.
    fn next(&self) -> f64 {
        self.grid.time(self.index + 1)
    }

    /// Numbers per problem second.
    fn rate(&self) -> f64 {
        1.0 / self.every
    }
}

impl LevelSource {
    /// The sources of all levels of a program, each at its first value, in the order of `Program::levels`.
    pub(super) fn all(program: &Program, coefficients: &[f64]) -> Vec<Self> {
        let source = |level: &Level| match level {
            Level::Noise(noise) => LevelSource::Noise(NoiseSource::new(noise, coefficients)),
            Level::Points { table } => LevelSource::Points { table: *table, passed: 0 },
        };
        program.lowered.levels.iter().map(source).collect()
    }

    /// The source of a noise voltage; `None` for a table.
    fn as_noise(&self) -> Option<&NoiseSource> {
        match self {
            LevelSource::Noise(source) => Some(source),
            LevelSource::Points { .. } => None,
        }
    }

    /// Moves to the value of a problem time. Points of a table up to `tolerance` seconds later count as passed.
    fn seek(&mut self, tables: &Tables, time: f64, tolerance: f64) {
        match self {
            LevelSource::Noise(source) => source.seek(time),
            LevelSource::Points { table, passed } => {
                *passed = points_passed(&tables[*table], time + tolerance);
            }
        }
    }

    /// Moves forward to the value of a problem time, and returns whether the level jumped.
    fn advance_to(&mut self, tables: &Tables, time: f64) -> bool {
        let is_due = self.next(tables) <= time;
        match self {
            LevelSource::Noise(source) if is_due => {
                source.index = source.grid.steps_in(time).max(source.index + 1);
            }
            LevelSource::Points { table, passed } if is_due => *passed = points_passed(&tables[*table], time),
            _ => {}
        }
        is_due
    }

    /// The present value.
    fn value(&self, tables: &Tables) -> f64 {
        match self {
            LevelSource::Noise(source) => source.number(),
            LevelSource::Points { table, passed } => held_value(&tables[*table], *passed),
        }
    }

    /// The problem time of the next jump; infinity after the last point of a table.
    pub(super) fn next(&self, tables: &Tables) -> f64 {
        match self {
            LevelSource::Noise(source) => source.next(),
            LevelSource::Points { table, passed } => {
                tables[*table].get(*passed).map_or(f64::INFINITY, |point| point[0])
            }
        }
    }
}

/// The number of jumps of all levels per problem second. For a table it is the average over its length. Delay lines
/// allocate memory by it.
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
    /// Makes the sources from the present coefficients, and moves all levels to the present time.
    pub(super) fn begin_levels(&mut self, setup: &Setup<'_>) {
        self.level_sources = LevelSource::all(setup.program, &self.coefficients);
        let (tables, tolerance) = (&setup.program.tables, INSTANT_TOLERANCE * setup.step);
        for (source, level) in self.level_sources.iter_mut().zip(&mut self.levels) {
            source.seek(tables, self.time, tolerance);
            *level = source.value(tables);
        }
    }

    /// Moves all levels forward to a problem time, and returns whether any of them jumped.
    pub(super) fn change_levels(&mut self, tables: &Tables, time: f64) -> bool {
        let mut has_jumped = false;
        for (source, level) in self.level_sources.iter_mut().zip(&mut self.levels) {
            if source.advance_to(tables, time) {
                *level = source.value(tables);
                has_jumped = true;
            }
        }
        has_jumped
    }
}

/// Checks that a run of this length in problem seconds draws an acceptable number of noise values.
///
/// # Errors
/// If a noise voltage draws more than [`MAX_STEPS`] numbers: every number ends a step.
pub(super) fn check_noise(program: &Program, sources: &[LevelSource], length: f64) -> Result<(), RunError> {
    let noises = sources.iter().filter_map(LevelSource::as_noise);
    for (source, noise) in noises.zip(program.noises()) {
        let numbers = length * source.rate();
        if numbers > MAX_STEPS {
            let element = program.name(noise.element).to_owned();
            return Err(RunError::NoiseTooFine { element, numbers, max: MAX_STEPS });
        }
    }
    Ok(())
}
