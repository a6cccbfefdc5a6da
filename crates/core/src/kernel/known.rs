//! What follows from the sides of the corners: worked out once for every set of sides that is met.

use super::Kernel;
use super::frame::Frame;
use crate::ir::Program;

/// What followed from the sides on which voltages were.
#[derive(Debug, Clone)]
pub(super) struct Known {
    /// Slope and room of every corner's watch, which tell the sides.
    corners: Vec<[f64; 2]>,
    factors: Vec<f64>,
    /// Slope and room of every other watch.
    ranges: Vec<[f64; 2]>,
    /// Between which numbers the voltage of every fence must stay.
    fences: Vec<[f64; 2]>,
    can_be_used: bool,
}

/// So many sets of sides are kept, the latest first; then the first that was met makes room.
const MOST_KNOWN: usize = 16;
/// Nothing is kept of kernels with more factors than this: it would take much memory, and as long to look up.
const MOST_FACTORS: usize = 4096;

impl Kernel {
    /// Works out what follows from the sides on which the voltages are, or takes it from when they were on the same sides
    /// before. Tells whether the factors can be used.
    pub(super) fn follow(&self, frame: &mut Frame<f64>, program: &Program, coefficients: &[f64]) -> bool {
        let mut all = std::mem::take(&mut frame.known);
        let known = all.iter().find(|known| known.is_of(frame));
        let can_be_used = match known {
            Some(known) => known.put(frame),
            None => {
                let can_be_used = self.put_factors(frame, program, coefficients);
                self.bind(frame, &program.tables, self.corners..self.watches.len());
                self.put_fences(frame);
                if self.factors.len() <= MOST_FACTORS {
                    all.truncate(MOST_KNOWN - 1);
                    all.insert(0, self.known(frame, can_be_used));
                }
                can_be_used
            }
        };
        frame.known = all;
        can_be_used
    }

    /// What now follows from the sides.
    fn known(&self, frame: &Frame<f64>, can_be_used: bool) -> Known {
        let pairs = |one: &[f64], other: &[f64]| -> Vec<[f64; 2]> {
            one.iter().zip(other).map(|(one, other)| [*one, *other]).collect()
        };
        let (slopes, rooms) = (&frame.slopes, &frame.rooms);
        Known {
            corners: pairs(&slopes[..self.corners], &rooms[..self.corners]),
            factors: frame.slots[..self.factors.len()].to_vec(),
            ranges: pairs(&slopes[self.corners..], &rooms[self.corners..]),
            fences: pairs(&frame.lows, &frame.highs),
            can_be_used,
        }
    }
}

impl Known {
    /// Whether the sides are those of now.
    fn is_of(&self, frame: &Frame<f64>) -> bool {
        let now = frame.slopes.iter().zip(&frame.rooms);
        self.corners.iter().zip(now).all(|(known, (slope, room))| *known == [*slope, *room])
    }

    /// Puts it back. Tells whether the factors can be used.
    fn put(&self, frame: &mut Frame<f64>) -> bool {
        frame.slots[..self.factors.len()].copy_from_slice(&self.factors);
        put_pairs(
            &mut frame.slopes[self.corners.len()..],
            &mut frame.rooms[self.corners.len()..],
            &self.ranges,
        );
        put_pairs(&mut frame.lows, &mut frame.highs, &self.fences);
        frame.rows.forget_fences();
        self.can_be_used
    }
}

fn put_pairs(ones: &mut [f64], others: &mut [f64], pairs: &[[f64; 2]]) {
    for ((one, other), pair) in ones.iter_mut().zip(others).zip(pairs) {
        [*one, *other] = *pair;
    }
}
