//! The bounds within which a kernel is valid.
//!
//! No guard of the present modes may become due, an overloaded amplifier must stay overloaded, and all others must
//! stay in range.

use std::collections::HashMap;

use super::form::{Atom, Factor, Form};
use super::specialise::Specialiser;
use super::{AmplifierState, WITHIN_RANGE};
use crate::ir::{Guard, Lamp};
use crate::machines::REFERENCE;

/// A form that must stay between two factors.
struct Bound {
    /// The form, in volts.
    of: Form,
    /// The least value allowed, in volts; -infinity if there is no lower bound.
    low: Factor,
    /// The largest value allowed, in volts; infinity if there is no upper bound.
    high: Factor,
}

/// All bounds, at most one per atom.
#[derive(Debug, Default)]
pub(super) struct Bounds {
    /// An atom with its lower and upper bound.
    pub all: Vec<(Atom, Factor, Factor)>,
    /// Number of bounds that come from guards and overloaded amplifiers; the first ones of all. They are also tested
    /// in the middle of a step.
    pub guards: usize,
    /// The same for values that do not vary: value, lower and upper bound.
    pub fixed: Vec<[Factor; 3]>,
    /// Index of the bound of each atom.
    indices: HashMap<Atom, usize>,
}

/// The largest number below 0. A guard that 0 satisfies has it as its upper bound.
const BELOW_ZERO: f64 = -5e-324;

impl Specialiser<'_> {
    /// Collects all bounds of the kernel.
    pub(super) fn bounds(&mut self) -> Bounds {
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

    /// The bounds within which no transition of the present modes is due.
    fn guards(&self) -> Vec<Bound> {
        let modes = self.program.lowered.modes.iter().zip(self.specialisation.modes);
        let open = modes.flat_map(|(mode, value)| mode.transitions.iter().filter(|open| open.from == *value));
        open.map(|open| self.closed(open.guard)).collect()
    }

    /// The bounds within which overloaded amplifiers stay overloaded. They are treated like modes, because an overload
    /// may end for less than a step.
    fn ends(&self) -> Vec<Bound> {
        let mut ends = self.demands_in(AmplifierState::Above, [REFERENCE, f64::INFINITY]);
        ends.extend(self.demands_in(AmplifierState::Below, [f64::NEG_INFINITY, -REFERENCE]));
        ends
    }

    /// The bounds within which the other amplifiers stay in range.
    fn ranges(&self) -> Vec<Bound> {
        self.demands_in(AmplifierState::Within, [-WITHIN_RANGE, WITHIN_RANGE])
    }

    /// The bounds for the demand of all amplifiers in this state.
    fn demands_in(&self, state: AmplifierState, range: [f64; 2]) -> Vec<Bound> {
        let lamps = self.program.lowered.lamps.iter().zip(self.specialisation.amplifiers);
        let [low, high] = range.map(Factor::Number);
        let bound = |lamp: &Lamp| Bound { of: self.of(lamp.demand).clone(), low, high };
        lamps.filter(|(_, present)| **present == state).map(|(lamp, _)| bound(lamp)).collect()
    }

    /// The bound within which a guard is not due.
    fn closed(&self, guard: Guard) -> Bound {
        let high = Factor::Number(if guard.is_strict { 0.0 } else { BELOW_ZERO });
        Bound { of: self.of(guard.register).clone(), low: Factor::Number(f64::NEG_INFINITY), high }
    }

    /// Adds a bound. If there already is one for the same voltage, the narrower one applies. A bound of a voltage
    /// times a number becomes a bound of the voltage.
    fn bind(&mut self, bounds: &mut Bounds, bound: Bound) {
        let Bound { mut of, mut low, mut high } = bound;
        if let Some(factor) = of.as_fixed() {
            bounds.fixed.push([factor, low, high]);
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
        match *bounds.indices.entry(atom).or_insert(next) {
            index if index == next => bounds.all.push((atom, low, high)),
            index => {
                let known = &mut bounds.all[index];
                known.1 = self.parameter_code.upper_of(known.1, low);
                known.2 = self.parameter_code.lower_of(known.2, high);
            }
        }
    }

    /// The voltage at which constant + slope x voltage reaches a limit. `None` if it would not be exact where it must
    /// be.
    fn crossing(&mut self, limit: Factor, constant: Factor, slope: f64) -> Option<Factor> {
        match limit {
            Factor::Number(limit) if limit.is_infinite() => Some(Factor::Number(limit * slope.signum())),
            // The difference would round -5e-324 away.
            Factor::Number(BELOW_ZERO) => None,
            _ => {
                let negative = self.parameter_code.multiply(constant, Factor::Number(-1.0));
                let distance = self.parameter_code.add(limit, negative);
                Some(self.parameter_code.multiply(distance, Factor::Number(1.0 / slope)))
            }
        }
    }
}
