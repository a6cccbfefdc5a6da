//! Levels: values that are constant between known instants.
//!
//! The solver ends a step at each of these instants, so a level is constant within a step and needs no kinks or
//! events.

use super::Program;
use super::noise::Noise;
use super::pulses::{Pulses, pulse_value};

/// The source of a level.
#[derive(Debug, Clone)]
pub enum Level {
    /// Random numbers at equal intervals.
    Noise(Noise),
    /// A stepped table of time: each value applies until the next point. Before the first point, the first value
    /// applies.
    Points {
        /// Index of the table.
        table: usize,
    },
    /// Rectangular pulses.
    Pulses(Pulses),
}

impl Program {
    /// The noise sources among the levels.
    pub(crate) fn noises(&self) -> impl Iterator<Item = &Noise> {
        self.lowered.levels.iter().filter_map(|level| match level {
            Level::Noise(noise) => Some(noise),
            Level::Points { .. } | Level::Pulses(_) => None,
        })
    }

    /// The sources of pulses among the levels.
    pub(crate) fn pulses(&self) -> impl Iterator<Item = &Pulses> {
        self.lowered.levels.iter().filter_map(|level| match level {
            Level::Pulses(pulses) => Some(pulses),
            Level::Noise(_) | Level::Points { .. } => None,
        })
    }

    /// The values of all levels at the beginning of a run.
    pub(crate) fn initial_levels(&self, coefficients: &[f64]) -> Vec<f64> {
        let first = |level: &Level| match level {
            Level::Noise(noise) => noise.distribution.number(coefficients[noise.seed as usize], 0),
            Level::Points { table } => {
                held_value(&self.tables[*table], points_passed(&self.tables[*table], 0.0))
            }
            Level::Pulses(pulses) => pulse_value(pulses.at(coefficients).edges_until(0.0)),
        };
        self.lowered.levels.iter().map(first).collect()
    }
}

/// The number of points of a table up to a time, in problem seconds.
pub(crate) fn points_passed(points: &[[f64; 2]], time: f64) -> usize {
    points.partition_point(|point| point[0] <= time)
}

/// The value of a stepped table after its first `after` points; NaN if the table is empty.
pub(crate) fn held_value(points: &[[f64; 2]], after: usize) -> f64 {
    points.get(after.saturating_sub(1)).map_or(f64::NAN, |point| point[1])
}
