//! Remembers the expansions of quantities, so that a quantity that many others read is expanded once.

use std::collections::{HashMap, HashSet};

use crate::symbolic::{Fraction, Symbol};

/// Which quantities are expanded into their laws of time. Otherwise they are quantities of their own.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct TimeLaws {
    /// Whether drives are.
    pub drives: bool,
    /// Whether ramps are.
    pub ramps: bool,
}

/// The expansions that are in progress, and those that are known.
#[derive(Debug, Default)]
pub(super) struct Expansions {
    /// The quantities that are being expanded, from the outermost one, each with what its expansion has met so far.
    open: Vec<(Symbol, Trace)>,
    /// The latest expansion of each quantity.
    known: HashMap<Symbol, Expansion>,
}

/// A finished expansion.
#[derive(Debug)]
struct Expansion {
    /// Its result.
    value: Fraction,
    /// What it has met.
    trace: Trace,
    /// What was expanded into laws of time.
    time_laws: TimeLaws,
}

/// What an expansion has met. It has the same result again if it meets the same.
#[derive(Debug, Default)]
struct Trace {
    /// The quantities that it expanded.
    expanded: HashSet<Symbol>,
    /// The quantities at which it stopped, because they were kept or being expanded.
    stopped: HashSet<Symbol>,
}

impl Trace {
    /// Adds what an inner expansion has met.
    fn extend(&mut self, inner: &Trace) {
        self.expanded.extend(&inner.expanded);
        self.stopped.extend(&inner.stopped);
    }
}

impl Expansions {
    /// Whether an expansion stops at a quantity: it is kept, or is being expanded. So a circle ends.
    pub(super) fn stops_at(&mut self, symbol: Symbol, kept: &HashSet<Symbol>) -> bool {
        let stops = kept.contains(&symbol) || self.is_open(symbol);
        if stops && let Some((_, trace)) = self.open.last_mut() {
            trace.stopped.insert(symbol);
        }
        stops
    }

    /// The known expansion of a quantity, if it would have the same result now.
    pub(super) fn known(
        &mut self,
        symbol: Symbol,
        kept: &HashSet<Symbol>,
        time_laws: TimeLaws,
    ) -> Option<Fraction> {
        let known = self.known.get(&symbol).filter(|known| known.time_laws == time_laws)?;
        let Trace { expanded, stopped } = &known.trace;
        let is_cut =
            kept.iter().chain(self.open.iter().map(|(open, _)| open)).any(|end| expanded.contains(end));
        if is_cut || !stopped.iter().all(|end| kept.contains(end) || self.is_open(*end)) {
            return None;
        }
        if let Some((_, trace)) = self.open.last_mut() {
            trace.extend(&known.trace);
        }
        Some(known.value.clone())
    }

    /// Whether a quantity is being expanded now.
    pub(super) fn is_in_progress(&self) -> bool {
        !self.open.is_empty()
    }

    /// Begins the expansion of a quantity.
    pub(super) fn begin(&mut self, symbol: Symbol) {
        self.open.push((symbol, Trace::default()));
    }

    /// Ends the expansion that was begun last.
    pub(super) fn end(&mut self, value: &Fraction, time_laws: TimeLaws) {
        let Some((symbol, mut trace)) = self.open.pop() else { return };
        trace.expanded.insert(symbol);
        trace.stopped.remove(&symbol);
        if let Some((_, outer)) = self.open.last_mut() {
            outer.extend(&trace);
        }
        self.known.insert(symbol, Expansion { value: value.clone(), trace, time_laws });
    }

    /// Whether a quantity is being expanded.
    fn is_open(&self, symbol: Symbol) -> bool {
        self.open.iter().any(|(open, _)| *open == symbol)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::symbol;

    /// No laws of time.
    const FREE: TimeLaws = TimeLaws { drives: false, ramps: false };

    /// Expands x, which reads y, which reads x. The result of x is 1, and that of y is 2.
    fn expand_circle(expansions: &mut Expansions) {
        let [x, y] = ["x", "y"].map(symbol);
        expansions.begin(x);
        expansions.begin(y);
        assert!(expansions.stops_at(x, &HashSet::new()));
        expansions.end(&Fraction::whole(2), FREE);
        expansions.end(&Fraction::whole(1), FREE);
    }

    #[test]
    fn a_known_expansion_is_used_if_it_would_meet_the_same_quantities() {
        let ([x, y, z], none) = (["x", "y", "z"].map(symbol), HashSet::new());
        let (one, two) = (Some(Fraction::whole(1)), Some(Fraction::whole(2)));
        let mut expansions = Expansions::default();
        expand_circle(&mut expansions);
        assert_eq!(expansions.known(x, &none, FREE), one);
        assert_eq!(expansions.known(x, &HashSet::from([z]), FREE), one);
        // The expansion of y stopped at x.
        assert_eq!(expansions.known(y, &none, FREE), None);
        assert_eq!(expansions.known(y, &HashSet::from([x]), FREE), two);
        // The expansion of x expanded y and no laws of time.
        assert_eq!(expansions.known(x, &HashSet::from([y]), FREE), None);
        assert_eq!(expansions.known(x, &none, TimeLaws { drives: true, ..FREE }), None);
        assert_eq!(expansions.known(x, &none, TimeLaws { ramps: true, ..FREE }), None);
        expansions.begin(y);
        assert_eq!(expansions.known(x, &none, FREE), None);
    }

    #[test]
    fn the_use_of_a_known_expansion_counts_as_an_expansion() {
        let ([x, y, z], none) = (["x", "y", "z"].map(symbol), HashSet::new());
        let mut expansions = Expansions::default();
        expand_circle(&mut expansions);
        expansions.begin(z);
        assert!(expansions.known(x, &none, FREE).is_some());
        expansions.end(&Fraction::whole(3), FREE);
        assert_eq!(expansions.known(z, &none, FREE), Some(Fraction::whole(3)));
        assert_eq!(expansions.known(z, &HashSet::from([y]), FREE), None);
    }
}
