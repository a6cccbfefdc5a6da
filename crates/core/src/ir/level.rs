//! Numbers that stay the same from one known instant to the next.

use super::Program;
use super::noise::Noise;

/// Where such numbers come from.
#[derive(Debug, Clone)]
pub(crate) enum Level {
    /// Drawn by chance.
    Noise(Noise),
    /// The points of a table, each from its time on until the next; the first before it too.
    Points { table: usize },
}

impl Program {
    /// Those that are drawn by chance.
    pub(crate) fn noises(&self) -> impl Iterator<Item = &Noise> {
        self.levels.iter().filter_map(|level| match level {
            Level::Noise(noise) => Some(noise),
            Level::Points { .. } => None,
        })
    }

    /// The numbers at the beginning of a run.
    pub(crate) fn first_levels(&self, coefficients: &[f64]) -> Vec<f64> {
        let first = |level: &Level| match level {
            Level::Noise(noise) => noise.distribution.number(coefficients[noise.seed as usize], 0),
            Level::Points { table } => held(&self.tables[*table], points_by(&self.tables[*table], 0.0)),
        };
        self.levels.iter().map(first).collect()
    }
}

/// How many points of a table have come by a time.
pub(crate) fn points_by(points: &[[f64; 2]], time: f64) -> usize {
    points.partition_point(|point| point[0] <= time)
}

/// What a table holds after so many of its points.
pub(crate) fn held(points: &[[f64; 2]], after: usize) -> f64 {
    points.get(after.saturating_sub(1)).map_or(f64::NAN, |point| point[1])
}
