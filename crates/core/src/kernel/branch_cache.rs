//! Caches everything that depends on the branch, so that it is computed once for each branch.
//!
//! A voltage that oscillates about a corner returns to the same two branches again and again. Their factors, bounds and
//! safe intervals are kept, so a return only copies them. The cache is cleared when the coefficients change.

use super::Kernel;
use super::frame::Frame;
use crate::ir::Program;

/// The data of one branch.
#[derive(Debug, Clone)]
pub(super) struct CachedBranch {
    /// Slope and offset of every corner's watch, which identify the branch.
    corners: Vec<[f64; 2]>,
    /// Values of the factors.
    factors: Vec<f64>,
    /// Slope and offset of every other watch.
    ranges: Vec<[f64; 2]>,
    /// The safe intervals.
    safe_intervals: Vec<[f64; 2]>,
    /// Whether the factors are valid on this branch.
    is_valid: bool,
}

/// Maximum number of cached branches. The oldest one is dropped.
const MAX_CACHED_BRANCHES: usize = 16;
/// Kernels with more factors than this are not cached: a look-up would take as long as the computation.
const MAX_CACHED_FACTORS: usize = 4096;

impl Kernel {
    /// Computes everything that depends on the branch, or takes it from the cache. Returns whether the factors are
    /// valid.
    pub(super) fn update_branch(
        &self,
        frame: &mut Frame<f64>,
        program: &Program,
        coefficients: &[f64],
    ) -> bool {
        let mut all = std::mem::take(&mut frame.branch_cache);
        let known = all.iter().find(|known| known.is_of(frame));
        let is_valid = match known {
            Some(known) => known.put(frame),
            None => {
                let is_valid = self.compute_factors(frame, program, coefficients);
                self.bind(frame, &program.tables, self.corners..self.watches.len());
                self.update_safe_intervals(frame);
                if self.factors.len() <= MAX_CACHED_FACTORS {
                    all.truncate(MAX_CACHED_BRANCHES - 1);
                    all.insert(0, self.snapshot(frame, is_valid));
                }
                is_valid
            }
        };
        frame.branch_cache = all;
        is_valid
    }

    /// The present branch with everything that depends on it.
    fn snapshot(&self, frame: &Frame<f64>, is_valid: bool) -> CachedBranch {
        let pairs = |one: &[f64], other: &[f64]| -> Vec<[f64; 2]> {
            one.iter().zip(other).map(|(one, other)| [*one, *other]).collect()
        };
        let (slopes, offsets) = (&frame.slopes, &frame.offsets);
        CachedBranch {
            corners: pairs(&slopes[..self.corners], &offsets[..self.corners]),
            factors: frame.slots[..self.factors.len()].to_vec(),
            ranges: pairs(&slopes[self.corners..], &offsets[self.corners..]),
            safe_intervals: pairs(&frame.lows, &frame.highs),
            is_valid,
        }
    }
}

impl CachedBranch {
    /// Whether this is the branch of the frame.
    fn is_of(&self, frame: &Frame<f64>) -> bool {
        let now = frame.slopes.iter().zip(&frame.offsets);
        self.corners.iter().zip(now).all(|(known, (slope, offset))| *known == [*slope, *offset])
    }

    /// Copies the data into the frame. Returns whether the factors are valid.
    fn put(&self, frame: &mut Frame<f64>) -> bool {
        frame.slots[..self.factors.len()].copy_from_slice(&self.factors);
        put_pairs(
            &mut frame.slopes[self.corners.len()..],
            &mut frame.offsets[self.corners.len()..],
            &self.ranges,
        );
        put_pairs(&mut frame.lows, &mut frame.highs, &self.safe_intervals);
        frame.rows.invalidate_safe_intervals();
        self.is_valid
    }
}

/// Writes the first and the second numbers of some pairs into two lists.
fn put_pairs(ones: &mut [f64], others: &mut [f64], pairs: &[[f64; 2]]) {
    for ((one, other), pair) in ones.iter_mut().zip(others).zip(pairs) {
        [*one, *other] = *pair;
    }
}
