//! The times at which tables of time have corners.
//!
//! No step may reach across a corner, because the order of the method would be lost there. Most tables have their
//! points on the grid of steps, where no additional stop is needed. So the corners that are off the grid are found
//! once and reused by all runs with the same grid.

use std::fmt;
use std::sync::{Arc, Mutex, PoisonError};

use crate::grid::Grid;

/// Problem times in seconds, in ascending order, at which tables of time have corners.
#[derive(Default)]
pub(crate) struct TableCorners {
    times: Vec<f64>,
    /// The result of the last search. Runs of the same program ask for the same grid.
    off_grid: Mutex<Option<OffGridCorners>>,
}

/// The corners that coincide with no instant of a grid.
struct OffGridCorners {
    /// Problem time at which the grid begins.
    begin: f64,
    grid: Grid,
    times: Arc<[f64]>,
}

impl TableCorners {
    /// The corners of these tables: the abscissas of their points.
    pub(crate) fn from_tables<'a>(tables: impl Iterator<Item = &'a [[f64; 2]]>) -> Self {
        let mut times: Vec<f64> = tables.flatten().map(|point| point[0]).collect();
        times.sort_by(f64::total_cmp);
        TableCorners { times, off_grid: Mutex::default() }
    }

    /// All corners, in ascending order.
    pub(crate) fn times(&self) -> &[f64] {
        &self.times
    }

    /// The corners that differ by more than `tolerance` seconds from every instant of a grid that starts at `begin`.
    pub(crate) fn off_grid(&self, begin: f64, grid: Grid, tolerance: f64) -> Arc<[f64]> {
        // A panic elsewhere cannot leave the value incomplete, so a poisoned lock is safe to use.
        let mut off_grid = self.off_grid.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(known) = off_grid.as_ref().filter(|known| known.begin == begin && known.grid == grid) {
            return Arc::clone(&known.times);
        }
        let is_off = |time: &f64| (begin + grid.time(grid.nearest(time - begin)) - time).abs() > tolerance;
        let times: Arc<[f64]> = self.times.iter().copied().filter(is_off).collect();
        *off_grid = Some(OffGridCorners { begin, grid, times: Arc::clone(&times) });
        times
    }
}

// The result of the last search follows from the times, so it is not printed.
impl fmt::Debug for TableCorners {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.times.fmt(formatter)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn corners_off_the_grid_are_found() {
        let [first, second] = [&[0.1, 0.25, 0.5 - 1e-4][..], &[0.0, 0.3 + 1e-11]]
            .map(|times| times.iter().map(|time| [*time, 1.0]).collect::<Vec<_>>());
        let corners = TableCorners::from_tables([&first[..], &second].into_iter());
        let off_grid = |begin: f64, step: f64| corners.off_grid(begin, Grid::new(step), 1e-9 * step).to_vec();
        assert_eq!(off_grid(0.0, 0.1), [0.25, 0.5 - 1e-4]);
        assert_eq!(off_grid(0.0, 0.05), [0.5 - 1e-4]);
        assert_eq!(off_grid(0.05, 0.1), [0.0, 0.1, 0.3 + 1e-11, 0.5 - 1e-4]);
        // No instant of the grid is before its start.
        assert_eq!(off_grid(0.2, 0.05), [0.0, 0.1, 0.5 - 1e-4]);
    }
}
