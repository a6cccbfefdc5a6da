//! What has to be watched so that a kernel tells the same as its program: guards, ranges, corners.

use std::collections::HashMap;

use super::fold::Folder;
use super::form::{Atom, Factor, Form};
use super::{Asked, WITHIN_RANGE};
use crate::ir::{Guard, Lamp};
use crate::machines::REFERENCE;

/// What has to stay between two factors.
struct Bound {
    of: Form,
    low: Factor,
    high: Factor,
}

/// What has to stay between which factors.
#[derive(Debug, Default)]
pub(super) struct Bounds {
    pub all: Vec<(Atom, Factor, Factor)>,
    /// So many of them, the first, are those of guards and ends.
    pub guards: usize,
    /// The same of numbers that do not move.
    pub still: Vec<[Factor; 3]>,
    places: HashMap<Atom, usize>,
}

/// The largest number below 0.
const BELOW_ZERO: f64 = -5e-324;

impl Folder<'_> {
    /// All that has to be bound.
    pub fn bounds(&mut self) -> Bounds {
        let mut bounds = Bounds::default();
        for bound in self.guards().into_iter().chain(self.ends()) {
            self.bind(&mut bounds, bound);
        }
        bounds.guards = bounds.all.len();
        for range in self.ranges() {
            self.bind(&mut bounds, range);
        }
        bounds
    }

    /// No guard lets anything happen.
    fn guards(&self) -> Vec<Bound> {
        let modes = self.program.modes.iter().zip(self.stance.modes);
        let open = modes.flat_map(|(mode, value)| mode.transitions.iter().filter(|open| open.from == *value));
        open.map(|open| self.closed(open.guard)).collect()
    }

    /// Amplifiers that are overloaded stay so: like modes, as they may come back for less than a step.
    fn ends(&self) -> Vec<Bound> {
        let mut ends = self.asked(Asked::TooHigh, [REFERENCE, f64::INFINITY]);
        ends.extend(self.asked(Asked::TooLow, [f64::NEG_INFINITY, -REFERENCE]));
        ends
    }

    /// The others stay within their range.
    fn ranges(&self) -> Vec<Bound> {
        self.asked(Asked::Within, [-WITHIN_RANGE, WITHIN_RANGE])
    }

    /// Of amplifiers that are asked for something, the range in which that stays.
    fn asked(&self, asked: Asked, range: [f64; 2]) -> Vec<Bound> {
        let lamps = self.program.lamps.iter().zip(self.stance.asked);
        let [low, high] = range.map(Factor::Number);
        let bound = |lamp: &Lamp| Bound { of: self.of(lamp.demand).clone(), low, high };
        lamps.filter(|(_, own)| **own == asked).map(|(lamp, _)| bound(lamp)).collect()
    }

    fn closed(&self, guard: Guard) -> Bound {
        let high = Factor::Number(if guard.strict { 0.0 } else { BELOW_ZERO });
        Bound { of: self.of(guard.register).clone(), low: Factor::Number(f64::NEG_INFINITY), high }
    }

    /// Adds a bound; of what is bound already, the narrower one. A voltage times a number is bound itself.
    fn bind(&mut self, bounds: &mut Bounds, bound: Bound) {
        let Bound { mut of, mut low, mut high } = bound;
        if let Some(factor) = of.as_still() {
            bounds.still.push([factor, low, high]);
            return;
        }
        if let [(atom, Factor::Number(slope))] = of.terms[..]
            && let (Some(lower), Some(upper)) =
                (self.crossing(low, of.constant, slope), self.crossing(high, of.constant, slope))
        {
            (low, high) = if slope > 0.0 { (lower, upper) } else { (upper, lower) };
            of = Form::atom(atom);
        }
        let atom = self.atom(&of);
        let next = bounds.all.len();
        match *bounds.places.entry(atom).or_insert(next) {
            place if place == next => bounds.all.push((atom, low, high)),
            place => {
                let known = &mut bounds.all[place];
                known.1 = self.early.upper_of(known.1, low);
                known.2 = self.early.lower_of(known.2, high);
            }
        }
    }

    /// Where constant + slope x voltage comes to a limit: nothing where that has to be told to the last bit, and
    /// cannot be.
    fn crossing(&mut self, limit: Factor, constant: Factor, slope: f64) -> Option<Factor> {
        match limit {
            Factor::Number(limit) if limit.is_infinite() => Some(Factor::Number(limit * slope.signum())),
            // Just below 0 is not told by a difference.
            Factor::Number(BELOW_ZERO) => None,
            _ => {
                let way = self.early.multiply(constant, Factor::Number(-1.0));
                let way = self.early.add(limit, way);
                Some(self.early.multiply(way, Factor::Number(1.0 / slope)))
            }
        }
    }
}
