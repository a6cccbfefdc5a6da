//! Levels in a run: values that stay constant between known instants, at which they jump to the next value.
//!
//! A level is a noise voltage, which draws a number at every instant of its grid, a table whose values are held until
//! the next point, or rectangular pulses. The instants are known in advance, so every step ends at the next of them.

use super::discontinuities::INSTANT_TOLERANCE;
use super::error::RunError;
use super::state::{Setup, SolverState};
use crate::grid::Grid;
use crate::ir::{
    Distribution, Level, Noise, Program, PulseTrain, Pulses, Tables, held_value, points_passed, pulse_value,
};

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
    /// Rectangular pulses.
    Pulses(PulseSource),
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

/// The position of rectangular pulses in the sequence of their edges.
#[derive(Debug, Clone)]
pub(super) struct PulseSource {
    /// The pulses, with their present settings.
    train: PulseTrain<f64>,
    /// Number of edges that have passed, which is the index of the next edge.
    edges: u64,
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
        self.grid.time(self.index.saturating_add(1))
    }
}

impl LevelSource {
    /// The sources of all levels of a program, each at its first value, in the order of `Program::levels`.
    pub(super) fn all(program: &Program, coefficients: &[f64]) -> Vec<Self> {
        let source = |level: &Level| match level {
            Level::Noise(noise) => LevelSource::Noise(NoiseSource::new(noise, coefficients)),
            Level::Points { table } => LevelSource::Points { table: *table, passed: 0 },
            Level::Pulses(pulses) => {
                LevelSource::Pulses(PulseSource { train: pulses.at(coefficients), edges: 0 })
            }
        };
        program.lowered.levels.iter().map(source).collect()
    }

    /// Moves to the value of a problem time. Points of a table and edges of pulses up to `tolerance` seconds later
    /// count as passed.
    fn seek(&mut self, tables: &Tables, time: f64, tolerance: f64) {
        match self {
            LevelSource::Noise(source) => source.seek(time),
            LevelSource::Points { table, passed } => {
                *passed = points_passed(&tables[*table], time + tolerance);
            }
            LevelSource::Pulses(source) => source.edges = source.train.edges_until(time + tolerance),
        }
    }

    /// Moves forward to the value of a problem time, and returns whether the level jumped.
    fn advance_to(&mut self, tables: &Tables, time: f64) -> bool {
        let is_due = self.next(tables) <= time;
        match self {
            LevelSource::Noise(source) if is_due => {
                source.index = source.grid.steps_in(time).max(source.index.saturating_add(1));
            }
            LevelSource::Points { table, passed } if is_due => *passed = points_passed(&tables[*table], time),
            LevelSource::Pulses(source) if is_due => {
                source.edges = source.train.edges_until(time).max(source.edges.saturating_add(1));
            }
            _ => {}
        }
        is_due
    }

    /// The present value.
    fn value(&self, tables: &Tables) -> f64 {
        match self {
            LevelSource::Noise(source) => source.number(),
            LevelSource::Points { table, passed } => held_value(&tables[*table], *passed),
            LevelSource::Pulses(source) => pulse_value(source.edges),
        }
    }

    /// The problem time of the next jump; infinity after the last point of a table and after a single pulse.
    pub(super) fn next(&self, tables: &Tables) -> f64 {
        match self {
            LevelSource::Noise(source) => source.next(),
            LevelSource::Points { table, passed } => {
                tables[*table].get(*passed).map_or(f64::INFINITY, |point| point[0])
            }
            LevelSource::Pulses(source) => source.train.time(source.edges),
        }
    }

    /// The number of jumps per problem second. For a table it is the average over its length.
    fn rate(&self, tables: &Tables) -> f64 {
        match self {
            LevelSource::Noise(source) => 1.0 / source.every,
            LevelSource::Points { table, .. } => match &tables[*table][..] {
                [first, .., last] => tables[*table].len() as f64 / (last[0] - first[0]),
                _ => 0.0,
            },
            LevelSource::Pulses(source) => source.train.rate(),
        }
    }
}

/// The number of jumps of all levels per problem second. Delay lines allocate memory by it.
pub(super) fn jump_rate(program: &Program, sources: &[LevelSource]) -> f64 {
    sources.iter().map(|source| source.rate(&program.tables)).sum()
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

/// The pulses with an edge at the present instant, each with the index of this edge.
pub(super) fn due_edges<'a>(
    setup: &'a Setup<'_>,
    state: &'a SolverState,
) -> impl Iterator<Item = (&'a Pulses, u64)> {
    let due_time = state.time + INSTANT_TOLERANCE * setup.step;
    let levels = setup.program.lowered.levels.iter().zip(&state.level_sources);
    levels.filter_map(move |pair| {
        let (Level::Pulses(pulses), LevelSource::Pulses(source)) = pair else { return None };
        (source.train.time(source.edges) <= due_time).then_some((pulses, source.edges))
    })
}

/// Checks that a run of this length in problem seconds does not take too many steps. A step ends at every jump of a
/// level, in addition to `equal_steps`. Points of tables are not counted, because files limit their number.
///
/// # Errors
/// If there are more than `max`. The error names the drive with the most jumps, unless these are fewer than the
/// equal steps.
pub(super) fn check_step_count(
    program: &Program,
    sources: &[LevelSource],
    length: f64,
    equal_steps: f64,
    max: f64,
) -> Result<(), RunError> {
    let jumps = |source: &LevelSource| match source {
        LevelSource::Points { .. } => 0.0,
        _ => length * source.rate(&program.tables),
    };
    let steps = equal_steps + sources.iter().map(jumps).sum::<f64>();
    let drives =
        sources.iter().zip(&program.lowered.levels).map(|(source, level)| (jumps(source), source, level));
    let most = drives.max_by(|one, other| one.0.total_cmp(&other.0));
    let name = |element: usize| program.name(element).to_owned();
    let error = match most.filter(|(jumps, ..)| *jumps >= equal_steps) {
        Some((numbers, LevelSource::Noise(source), Level::Noise(noise))) => {
            RunError::NoiseTooFine { element: name(noise.element), every: source.every, numbers, steps, max }
        }
        Some((edges, _, Level::Pulses(pulses))) => {
            RunError::PulsesTooFast { element: name(pulses.element), edges, steps, max }
        }
        _ => RunError::TooManySteps { steps, max },
    };
    if steps > max { Err(error) } else { Ok(()) }
}
