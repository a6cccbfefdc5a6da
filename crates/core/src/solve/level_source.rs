//! Levels while the machine runs: one number after the other, those of noise on a time grid of its own.

use super::breaks::SAME;
use super::error::RunError;
use super::machine::Machine;
use super::run::MOST_STEPS;
use crate::grid::Grid;
use crate::ir::{Distribution, Level, Noise, Program, Tables, held, points_by};

/// Where a level is in its row of numbers.
#[derive(Debug, Clone)]
pub(super) enum LevelSource {
    Noise(NoiseSource),
    /// After so many points of a table.
    Points {
        table: usize,
        after: usize,
    },
}

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
    fn new(noise: &Noise, coefficients: &[f64]) -> Self {
        let (seed, every) = (coefficients[noise.seed as usize], coefficients[noise.every as usize]);
        NoiseSource { seed, every, distribution: noise.distribution, grid: Grid::new(every), place: 0 }
    }

    /// Goes to the number that holds at a time.
    fn go_to(&mut self, time: f64) {
        self.place = self.grid.steps_in(time);
    }

    /// The number that holds now.
    fn number(&self) -> f64 {
        self.distribution.number(self.seed, self.place)
    }

    /// When the next number takes over.
    fn next(&self) -> f64 {
        self.grid.time(self.place + 1)
    }

    /// Numbers in a second.
    fn rate(&self) -> f64 {
        1.0 / self.every
    }
}

impl LevelSource {
    /// The source of each level, at the beginning of its row.
    pub fn all(program: &Program, coefficients: &[f64]) -> Vec<Self> {
        let source = |level: &Level| match level {
            Level::Noise(noise) => LevelSource::Noise(NoiseSource::new(noise, coefficients)),
            Level::Points { table } => LevelSource::Points { table: *table, after: 0 },
        };
        program.levels.iter().map(source).collect()
    }

    fn as_noise(&self) -> Option<&NoiseSource> {
        match self {
            LevelSource::Noise(source) => Some(source),
            LevelSource::Points { .. } => None,
        }
    }

    /// Goes to the number that holds at a time; rounding within some room is forgiven.
    fn go_to(&mut self, tables: &Tables, time: f64, room: f64) {
        match self {
            LevelSource::Noise(source) => source.go_to(time),
            LevelSource::Points { table, after } => *after = points_by(&tables[*table], time + room),
        }
    }

    /// Goes to the number that takes over by a time; tells whether there is any.
    fn jump_by(&mut self, tables: &Tables, time: f64) -> bool {
        let is_due = self.next(tables) <= time;
        match self {
            LevelSource::Noise(source) if is_due => {
                source.place = source.grid.steps_in(time).max(source.place + 1);
            }
            LevelSource::Points { table, after } if is_due => *after = points_by(&tables[*table], time),
            _ => {}
        }
        is_due
    }

    /// The number that holds now.
    fn number(&self, tables: &Tables) -> f64 {
        match self {
            LevelSource::Noise(source) => source.number(),
            LevelSource::Points { table, after } => held(&tables[*table], *after),
        }
    }

    /// When the next number takes over.
    pub fn next(&self, tables: &Tables) -> f64 {
        match self {
            LevelSource::Noise(source) => source.next(),
            LevelSource::Points { table, after } => {
                tables[*table].get(*after).map_or(f64::INFINITY, |point| point[0])
            }
        }
    }
}

/// How many numbers all sources give in a second, of points on average.
pub(super) fn most_jumps(program: &Program, sources: &[LevelSource]) -> f64 {
    let rate = |source: &LevelSource| match source {
        LevelSource::Noise(source) => source.rate(),
        LevelSource::Points { table, .. } => match &program.tables[*table][..] {
            [first, .., last] => program.tables[*table].len() as f64 / (last[0] - first[0]),
            _ => 0.0,
        },
    };
    sources.iter().map(rate).sum()
}

impl Machine<'_> {
    /// Goes to the levels that hold now, as the settings are now.
    pub(super) fn begin_levels(&mut self) {
        self.level_sources = LevelSource::all(self.program, &self.coefficients);
        let (tables, room) = (&self.program.tables, SAME * self.step);
        for (source, level) in self.level_sources.iter_mut().zip(&mut self.levels) {
            source.go_to(tables, self.time, room);
            *level = source.number(tables);
        }
    }

    /// Goes to the levels that take over by a time; tells whether there were any.
    pub(super) fn jump_by(&mut self, time: f64) -> bool {
        let tables = &self.program.tables;
        let mut any = false;
        for (source, level) in self.level_sources.iter_mut().zip(&mut self.levels) {
            if source.jump_by(tables, time) {
                *level = source.number(tables);
                any = true;
            }
        }
        any
    }

    /// Refuses noise so fine that a run of this length would never end.
    pub(super) fn check_noise(&self, length: f64) -> Result<(), RunError> {
        let noises = self.level_sources.iter().filter_map(LevelSource::as_noise);
        for (source, noise) in noises.zip(self.program.noises()) {
            let numbers = length * source.rate();
            if numbers > MOST_STEPS {
                let element = self.program.name(noise.element).to_owned();
                return Err(RunError::NoiseTooFine { element, numbers, most: MOST_STEPS });
            }
        }
        Ok(())
    }
}
