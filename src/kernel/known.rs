//! What follows from the sides of the corners: worked out once for every set of sides that was met lately.

use super::Kernel;
use super::frame::Frame;
use super::lane::Lane;
use crate::program::Program;

/// What followed from the sides on which the voltages of a lane were.
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

/// So many sets of sides are kept.
const MOST_KNOWN: usize = 16;

impl Kernel {
    /// Works out what follows from the sides on which a lane's voltages are, or takes it from when they were on the same
    /// sides before. Tells whether the factors can be used.
    pub(super) fn follow<V: Lane>(
        &self,
        frame: &mut Frame<V>,
        program: &Program,
        coefficients: &[f64],
        lane: usize,
    ) -> bool {
        let mut all = std::mem::take(&mut frame.known[lane]);
        let known = all.iter().find(|known| known.is_of(frame, lane));
        let can_be_used = match known {
            Some(known) => known.put(frame, lane),
            None => {
                let can_be_used = self.put_factors(frame, program, coefficients, lane);
                self.bind(frame, &program.tables, lane, self.corners..self.watches.len());
                self.put_fences(frame, lane);
                if all.len() == MOST_KNOWN {
                    all.remove(0);
                }
                all.push(self.known(frame, lane, can_be_used));
                can_be_used
            }
        };
        frame.known[lane] = all;
        can_be_used
    }

    /// What now follows from the sides of a lane.
    fn known<V: Lane>(&self, frame: &Frame<V>, lane: usize, can_be_used: bool) -> Known {
        let pairs = |one: &[V], other: &[V]| {
            one.iter().zip(other).map(|(one, other)| [one.get(lane), other.get(lane)]).collect::<Vec<_>>()
        };
        let (slopes, rooms) = (&frame.slopes, &frame.rooms);
        Known {
            corners: pairs(&slopes[..self.corners], &rooms[..self.corners]),
            factors: frame.slots[..self.factors.len()].iter().map(|slot| slot.get(lane)).collect(),
            ranges: pairs(&slopes[self.corners..], &rooms[self.corners..]),
            fences: pairs(&frame.lows, &frame.highs),
            can_be_used,
        }
    }
}

impl Known {
    /// Whether the sides are those of now.
    fn is_of<V: Lane>(&self, frame: &Frame<V>, lane: usize) -> bool {
        let now = frame.slopes.iter().zip(&frame.rooms);
        self.corners.iter().zip(now).all(|(known, (slope, room))| *known == [slope.get(lane), room.get(lane)])
    }

    /// Puts it back. Tells whether the factors can be used.
    fn put<V: Lane>(&self, frame: &mut Frame<V>, lane: usize) -> bool {
        for (slot, factor) in frame.slots.iter_mut().zip(&self.factors) {
            slot.set(lane, *factor);
        }
        put_pairs(
            &mut frame.slopes[self.corners.len()..],
            &mut frame.rooms[self.corners.len()..],
            &self.ranges,
            lane,
        );
        put_pairs(&mut frame.lows, &mut frame.highs, &self.fences, lane);
        self.can_be_used
    }
}

fn put_pairs<V: Lane>(ones: &mut [V], others: &mut [V], pairs: &[[f64; 2]], lane: usize) {
    for ((one, other), pair) in ones.iter_mut().zip(others).zip(pairs) {
        one.set(lane, pair[0]);
        other.set(lane, pair[1]);
    }
}
