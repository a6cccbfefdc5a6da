//! The instants at which tables of time have corners.

use std::fmt;
use std::sync::{Arc, Mutex, PoisonError};

use crate::grid::Grid;

/// Problem times, rising, at which tables have corners.
#[derive(Default)]
pub(crate) struct Corners {
    times: Vec<f64>,
    /// Those that were asked for last: runs of the same program ask for the same.
    strays: Mutex<Option<Strays>>,
}

/// The corners that lie on no instant of a grid.
struct Strays {
    begin: f64,
    grid: Grid,
    times: Arc<[f64]>,
}

impl Corners {
    /// Those of tables.
    pub fn of<'a>(tables: impl Iterator<Item = &'a [[f64; 2]]>) -> Self {
        let mut times: Vec<f64> = tables.flatten().map(|point| point[0]).collect();
        times.sort_by(f64::total_cmp);
        Corners { times, strays: Mutex::default() }
    }

    /// All of them.
    pub fn times(&self) -> &[f64] {
        &self.times
    }

    /// Those farther than some room from every instant of a grid that begins at a time.
    pub fn off(&self, begin: f64, grid: Grid, room: f64) -> Arc<[f64]> {
        // Whoever broke off left it as whole as it was.
        let mut strays = self.strays.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(known) = strays.as_ref().filter(|known| known.begin == begin && known.grid == grid) {
            return Arc::clone(&known.times);
        }
        let is_off = |time: &f64| (begin + grid.time(grid.nearest(time - begin)) - time).abs() > room;
        let times: Arc<[f64]> = self.times.iter().copied().filter(is_off).collect();
        *strays = Some(Strays { begin, grid, times: Arc::clone(&times) });
        times
    }
}

// What was asked for follows from the times.
impl fmt::Debug for Corners {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.times.fmt(formatter)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn corners_beside_a_grid_are_told() {
        let [first, second] = [&[0.1, 0.25, 0.5 - 1e-4][..], &[0.0, 0.3 + 1e-11]]
            .map(|times| times.iter().map(|time| [*time, 1.0]).collect::<Vec<_>>());
        let corners = Corners::of([&first[..], &second].into_iter());
        let off = |begin: f64, step: f64| corners.off(begin, Grid::new(step), 1e-9 * step).to_vec();
        assert_eq!(off(0.0, 0.1), [0.25, 0.5 - 1e-4]);
        assert_eq!(off(0.0, 0.05), [0.5 - 1e-4]);
        assert_eq!(off(0.05, 0.1), [0.0, 0.1, 0.3 + 1e-11, 0.5 - 1e-4]);
        // Before the grid begins nothing lies on it.
        assert_eq!(off(0.2, 0.05), [0.0, 0.1, 0.5 - 1e-4]);
    }
}
