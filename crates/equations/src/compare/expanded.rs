//! Expresses quantities of the wiring by states, drives, time and parameters.

use std::collections::{BTreeSet, HashSet};

use patchcord_expr::Node;

use super::expansions::TimeLaws;
use super::intended::fraction;
use super::model::{Model, Obstacle};
use crate::derive::LawKind;
use crate::notation::primed;
use crate::symbolic::{Fraction, Symbol, delay};

/// The largest number of functions inside each other in an expression that is compared. Walks through an expression use
/// the stack by this number.
pub(super) const MAX_DEPTH: usize = 200;

/// The value of an auxiliary quantity.
#[derive(Debug)]
pub(super) struct AuxiliaryValue {
    value: Fraction,
    /// The states with limits whose rates it contains.
    limited: BTreeSet<Symbol>,
    /// The signals that stay as they are in it.
    kept: HashSet<Symbol>,
    /// What was expanded into laws of time.
    time_laws: TimeLaws,
}

impl<'a> Model<'a> {
    /// The value of an auxiliary quantity with this right side. The latest value of each is remembered, because many
    /// others may contain it.
    pub(super) fn auxiliary(
        &mut self,
        name: &'a str,
        node: &Node,
        kept: &HashSet<Symbol>,
    ) -> Result<Fraction, Obstacle> {
        let is_same = |known: &&AuxiliaryValue| known.time_laws == self.time_laws && known.kept == *kept;
        if let Some(known) = self.known_auxiliaries.get(name).filter(is_same) {
            self.limited.extend(&known.limited);
            return Ok(known.value.clone());
        }
        let before = std::mem::take(&mut self.limited);
        let value = fraction(node, &mut |name| self.named(name, kept));
        let limited = std::mem::replace(&mut self.limited, before);
        self.limited.extend(&limited);
        let value = value?;
        let (kept, time_laws) = (kept.clone(), self.time_laws);
        let known = AuxiliaryValue { value: value.clone(), limited, kept, time_laws };
        self.known_auxiliaries.insert(name, known);
        Ok(value)
    }

    /// A symbol as a function of states, drives, time and parameters.
    pub(super) fn expanded(&mut self, symbol: Symbol, kept: &HashSet<Symbol>) -> Fraction {
        if self.expansions.stops_at(symbol, kept) {
            return Fraction::symbol(symbol);
        }
        if let Some(known) = self.expansions.known(symbol, kept, self.time_laws) {
            return known;
        }
        if !self.expansions.is_in_progress() {
            // A long chain is expanded from its begin, because the stack is too short for the other direction.
            for inner in self.inner_quantities(symbol, kept) {
                if inner != symbol && self.expansions.known(inner, kept, self.time_laws).is_none() {
                    self.expand(inner, kept);
                }
            }
        }
        self.expand(symbol, kept)
    }

    /// Expands a symbol. A quantity whose expression would be too deep stays as it is.
    fn expand(&mut self, symbol: Symbol, kept: &HashSet<Symbol>) -> Fraction {
        let Some((value, time)) = self.formula(symbol) else { return Fraction::symbol(symbol) };
        let (value, time) = (value.clone(), time.cloned());
        self.expansions.begin(symbol);
        let mut value = self.expanded_fraction(&value, kept);
        if let Some(time) = time {
            value = delay(&value, &time);
        }
        if value.depth() > MAX_DEPTH {
            self.too_deep.insert(symbol);
            value = Fraction::symbol(symbol);
        }
        self.expansions.end(&value, self.time_laws);
        value
    }

    /// The formula of a quantity that is expanded, and the time by which it is delayed.
    fn formula(&self, symbol: Symbol) -> Option<(&Fraction, Option<&Fraction>)> {
        match self.system.law(symbol)? {
            LawKind::Definition(value) => Some((value, None)),
            LawKind::Drive(value) if self.time_laws.drives => Some((value, None)),
            LawKind::State { .. } if self.time_laws.ramps => Some((self.ramps.get(&symbol)?, None)),
            LawKind::Delay { input, time, .. } if !self.is_evaluated => Some((input, Some(time))),
            _ => None,
        }
    }

    /// The quantity and all others that its expansion expands. A quantity comes after those that its formula reads.
    fn inner_quantities(&self, symbol: Symbol, kept: &HashSet<Symbol>) -> Vec<Symbol> {
        let (mut open, mut places) = (vec![symbol], BTreeSet::new());
        while let Some(symbol) = open.pop() {
            let place = self.system.laws.iter().position(|law| law.of == symbol);
            let (Some(place), Some((value, _))) = (place, self.formula(symbol)) else { continue };
            if !kept.contains(&symbol) && places.insert(place) {
                value.contains(&mut |inner| {
                    open.push(inner);
                    false
                });
            }
        }
        places.into_iter().map(|place| self.system.laws[place].of).collect()
    }

    /// Checks that the expression of a quantity with this number of derivatives is complete and can be compared.
    ///
    /// # Errors
    /// If functions are too deep inside each other.
    pub(super) fn check_depth(&self, name: &str, primes: usize, value: &Fraction) -> Result<(), Obstacle> {
        let is_incomplete =
            !self.too_deep.is_empty() && value.contains(&mut |symbol| self.too_deep.contains(&symbol));
        if is_incomplete || value.depth() > MAX_DEPTH {
            return Err(Obstacle::TooDeep(primed(name, primes)));
        }
        Ok(())
    }
}
