//! Makes derived equations readable: no modes that follow from a comparison, no names that the reader does not know.
//!
//! The steps keep the meaning. A comparator's mode becomes a step of its inputs. Delays and pulses without a name are
//! written where they are used. A state without a signal gets the name of a signal that differs from it by a constant
//! factor and by drives, or of the derivative of such a signal.

use std::collections::{HashMap, HashSet};

use super::nested_delays::{DelayLine, nested};
use super::system::{Law, LawKind, ModeLaw, Source, System, TransitionLaw};
use super::wiring::Wiring;
use crate::symbolic::{Fraction, Symbol, derivative, partial_derivative, step};

/// The largest number of primes of a state. Its rate has one more, which is the largest number in an equation.
const MOST_PRIMES: u8 = 8;

/// The readable equations of a wiring. `is_known` is whether the patch names a quantity of this name.
pub(crate) fn simplified(wiring: Wiring, is_known: &dyn Fn(&str) -> bool) -> System {
    let Wiring { system, time, .. } = wiring;
    let mut simplification = Simplification { system, time, is_known };
    simplification.replace_modes();
    simplification.replace_sources();
    simplification.replace_delays();
    while simplification.name_a_state() || simplification.name_a_derivative() {}
    simplification.system
}

/// A simplification in progress.
struct Simplification<'a> {
    system: System,
    time: Symbol,
    is_known: &'a dyn Fn(&str) -> bool,
}

impl Simplification<'_> {
    /// Whether the patch has a name for a quantity.
    fn is_known(&self, symbol: Symbol) -> bool {
        (self.is_known)(&self.system.symbols.entry(symbol).name)
    }

    /// Replaces modes that depend on their inputs only, such as those of comparators.
    fn replace_modes(&mut self) {
        let mut index = 0;
        while index < self.system.modes.len() {
            let mode = &self.system.modes[index];
            match comparison(mode) {
                Some(value) if !value.contains(&mut |symbol| symbol == mode.symbol) => {
                    let symbol = mode.symbol;
                    self.system.modes.remove(index);
                    self.system.replace(symbol, &value);
                }
                _ => index += 1,
            }
        }
        // The mode of an amplifier at its limits is part of the law of its state.
        self.system.modes.retain(|mode| mode.noun != "limit");
    }

    /// Replaces pulses by laws of time.
    fn replace_sources(&mut self) {
        let pulses = |law: &Law| match &law.kind {
            LawKind::Source(Source::Pulses(value)) => Some((law.of, value.clone())),
            _ => None,
        };
        let found: HashMap<Symbol, Fraction> = self.system.laws.iter().filter_map(pulses).collect();
        self.system.laws.retain(|law| !found.contains_key(&law.of));
        self.system.replace_all(&found);
    }

    /// Replaces the outputs of delay lines without a name, unless they depend on themselves or are deep inside each
    /// other.
    fn replace_delays(&mut self) {
        let unnamed = self.system.laws.iter().filter(|law| !self.is_known(law.of));
        let lines = unnamed.filter_map(|law| match &law.kind {
            LawKind::Delay { input, time, .. } => Some(DelayLine { output: law.of, input, time }),
            _ => None,
        });
        let values = nested(&lines.collect::<Vec<_>>());
        self.system.laws.retain(|law| !values.contains_key(&law.of));
        self.system.replace_all(&values);
    }

    /// Gives a state without a name that of a signal. Returns whether it found one.
    fn name_a_state(&mut self) -> bool {
        let is_drive = |law: &&Law| matches!(law.kind, LawKind::Drive(_));
        let drives: HashSet<Symbol> = self.system.laws.iter().filter(is_drive).map(|law| law.of).collect();
        let varies = |symbol: Symbol| !symbol.is_constant && !drives.contains(&symbol);
        // A signal that names a state contains nothing else that varies, except drives.
        let mut signals: HashMap<Symbol, Vec<(Symbol, &Fraction)>> = HashMap::new();
        for law in &self.system.laws {
            if let LawKind::Definition(value) = &law.kind
                && self.is_known(law.of)
                && let Some(only) = only_symbol(value, varies)
            {
                signals.entry(only).or_default().push((law.of, value));
            }
        }
        let relation = self
            .unnamed_states()
            .into_iter()
            .find_map(|state| self.best_relation(state, signals.get(&state)?.as_slice()));
        let Some(relation) = relation else { return false };
        self.rename(&relation);
        true
    }

    /// The states that the patch does not name.
    fn unnamed_states(&self) -> Vec<Symbol> {
        let is_state = |law: &&Law| matches!(law.kind, LawKind::State { .. }) && !self.is_known(law.of);
        self.system.laws.iter().filter(is_state).map(|law| law.of).collect()
    }

    /// The relation of a state to the signal that names it best: one that is proportional, otherwise one that differs
    /// by drives. `signals` are those that contain it, with their values.
    fn best_relation(&self, state: Symbol, signals: &[(Symbol, &Fraction)]) -> Option<Relation> {
        let relations = signals.iter().filter_map(|(signal, value)| self.relation(*signal, value, state));
        let relations: Vec<Relation> = relations.collect();
        let proportional = relations.iter().find(|relation| relation.rest.is_zero());
        proportional.or(relations.first()).cloned()
    }

    /// The relation signal = factor x state + rest, with a constant factor and a rest of drives and time.
    fn relation(&self, signal: Symbol, value: &Fraction, state: Symbol) -> Option<Relation> {
        let factor = partial_derivative(value, state);
        if factor.is_zero() || !factor.is_constant() {
            return None;
        }
        // Limits would be exchanged by a negative factor.
        let has_limits = matches!(self.system.law(state), Some(LawKind::State { limits, .. }) if limits.iter().any(Option::is_some));
        if has_limits && !factor.is_nonnegative() && !factor.negated().is_nonnegative() {
            return None;
        }
        let rest = value.minus(&factor.times(&Fraction::symbol(state)));
        let is_other = &mut |symbol: Symbol| {
            !symbol.is_constant && !matches!(self.system.law(symbol), Some(LawKind::Drive(_)))
        };
        (!rest.contains(is_other)).then_some(Relation { signal, state, factor, rest })
    }

    /// Replaces a state by the signal that names it.
    fn rename(&mut self, relation: &Relation) {
        let Relation { signal, state, factor, rest } = relation;
        let value = Fraction::symbol(*signal).minus(rest).over(factor);
        let change = self.time_derivative(rest);
        let start = self.at_start(rest);
        self.system.laws.retain(|law| law.of != *signal);
        for law in &mut self.system.laws {
            if law.of == *state {
                law.of = *signal;
                scale_state(&mut law.kind, factor, rest, &change, &start);
            }
        }
        for reset in self.system.modes.iter_mut().flat_map(|mode| &mut mode.transitions) {
            if let Some((of, to)) = &mut reset.reset
                && *of == *state
            {
                (*of, *to) = (*signal, to.times(factor).plus(rest));
            }
        }
        self.system.replace(*state, &value);
        self.system.per_volt.insert(*signal, factor.clone());
    }

    /// The derivative of an expression of drives and constants with respect to time.
    fn time_derivative(&mut self, rest: &Fraction) -> Fraction {
        let (symbols, time) = (&mut self.system.symbols, self.time);
        derivative(rest, &mut |symbol| {
            if symbol == time {
                return Fraction::whole(1);
            }
            if symbol.is_constant {
                return Fraction::zero();
            }
            Fraction::symbol(symbols.derivative(symbol))
        })
    }

    /// The value of an expression of drives at t = 0.
    fn at_start(&self, rest: &Fraction) -> Fraction {
        let with_drives = rest.mapped(&mut |symbol| match self.system.law(symbol) {
            Some(LawKind::Drive(value)) => value.clone(),
            _ => Fraction::symbol(symbol),
        });
        with_drives.mapped(&mut |symbol| {
            if symbol == self.time { Fraction::zero() } else { Fraction::symbol(symbol) }
        })
    }

    /// Gives a state without a name that of a derivative: x' if the rate of x is a constant factor times the state. A
    /// state deep in a long chain of integrators keeps the name of its element. Returns whether it found one.
    fn name_a_derivative(&mut self) -> bool {
        let unnamed: HashSet<Symbol> = self.unnamed_states().into_iter().collect();
        let found = self.system.laws.iter().find_map(|law| {
            let LawKind::State { rate, .. } = &law.kind else { return None };
            let primes = self.system.symbols.entry(law.of).primes;
            if unnamed.contains(&law.of) || primes >= MOST_PRIMES {
                return None;
            }
            let state = only_symbol(rate, |symbol| unnamed.contains(&symbol))?;
            let relation = self.relation(law.of, rate, state)?;
            relation.rest.is_zero().then_some(relation)
        });
        let Some(Relation { signal, state, factor, rest }) = found else { return false };
        let prime = self.system.symbols.derivative(signal);
        self.rename(&Relation { signal: prime, state, factor, rest });
        true
    }
}

/// The only symbol in an expression for which a condition holds. `None` if there are several or none.
fn only_symbol(value: &Fraction, is_wanted: impl Fn(Symbol) -> bool) -> Option<Symbol> {
    let (mut only, mut is_alone) = (None, true);
    value.contains(&mut |symbol| {
        if is_wanted(symbol) {
            is_alone = *only.get_or_insert(symbol) == symbol;
        }
        !is_alone
    });
    only.filter(|_| is_alone)
}

/// A signal as a function of a state: signal = factor x state + rest.
#[derive(Clone)]
struct Relation {
    signal: Symbol,
    state: Symbol,
    /// A constant.
    factor: Fraction,
    /// An expression of drives and time.
    rest: Fraction,
}

/// The law of a state in terms of the signal that names it. `change` is the rate of the rest, and `start` its value at
/// t = 0. A negative factor exchanges the limits.
fn scale_state(kind: &mut LawKind, factor: &Fraction, rest: &Fraction, change: &Fraction, start: &Fraction) {
    let LawKind::State { rate, initial, limits } = kind else { return };
    *rate = rate.times(factor).plus(change);
    *initial = initial.times(factor).plus(start);
    limits.iter_mut().flatten().for_each(|limit| *limit = limit.times(factor).plus(rest));
    if factor.negated().is_nonnegative() {
        limits.reverse();
    }
}

/// The value of a mode with two values 0 and 1 that follows from one comparison: 1 if it holds, otherwise 0. `None` if
/// the mode remembers anything, such as the position between two thresholds.
pub(super) fn comparison(mode: &ModeLaw) -> Option<Fraction> {
    let [first, second] = mode.transitions.as_slice() else { return None };
    let is_opposite = first.guard.plus(&second.guard).is_zero();
    let (rises, falls) = if first.to == 1.0 { (first, second) } else { (second, first) };
    let between = |transition: &TransitionLaw, from, to| {
        transition.from == from && transition.to == to && transition.reset.is_none()
    };
    let is_binary = between(rises, 0.0, 1.0) && between(falls, 1.0, 0.0);
    (is_opposite && is_binary).then(|| step(&rises.guard))
}
