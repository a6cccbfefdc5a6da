//! Delays of delays: the outputs of delay lines that have no name are written inside each other.

use std::collections::{BTreeSet, HashMap};

use crate::symbolic::{Fraction, Symbol, delay};

/// Functions inside each other at most. In a longer chain of delay lines, some keep the names of their elements.
const MAX_DEPTH: usize = 50;

/// The outputs of delay lines as expressions of what is delayed.
#[derive(Debug, Default)]
pub(super) struct NestedDelays {
    /// The outputs that have an expression.
    pub values: HashMap<Symbol, Fraction>,
    /// For every symbol, the outputs whose expressions contain it.
    readers: HashMap<Symbol, BTreeSet<Symbol>>,
}

impl NestedDelays {
    /// Adds an output if it does not depend on itself, and if no expression becomes too deep.
    pub(super) fn add(&mut self, output: Symbol, input: &Fraction, time: &Fraction) {
        let value = delay(&input.with_symbols(&self.values), &time.with_symbols(&self.values));
        // Outputs that were added before may read this one.
        let readers = self.readers.get(&output).cloned().unwrap_or_default();
        let inside = readers.iter().map(|reader| self.values[reader].depth()).max().unwrap_or_default();
        if inside + value.depth() > MAX_DEPTH || value.contains(&mut |symbol| symbol == output) {
            return;
        }
        self.readers.remove(&output);
        let by = HashMap::from([(output, value)]);
        for reader in readers {
            let known = self.values[&reader].with_symbols(&by);
            self.set(reader, known);
        }
        by.into_iter().for_each(|(output, value)| self.set(output, value));
    }

    /// Sets the expression of an output.
    fn set(&mut self, output: Symbol, value: Fraction) {
        value.contains(&mut |symbol| {
            if !symbol.is_constant {
                self.readers.entry(symbol).or_default().insert(output);
            }
            false
        });
        self.values.insert(output, value);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::symbolic::Symbols;
    use patchcord_expr::Dimension;

    /// The symbols of x and of this number of delay lines.
    fn symbols(count: usize) -> (Symbol, Vec<Symbol>) {
        let mut all = Symbols::default();
        let mut symbol = |name: &str| all.variable(name, 0, Dimension::VOLTAGE);
        let x = symbol("x");
        (x, (0..count).map(|index| symbol(&format!("D{index}"))).collect())
    }

    /// The expressions of delay lines of 1 s. Each reads the one in front of it; the first one reads x.
    fn chain(x: Symbol, lines: &[Symbol], is_reversed: bool) -> NestedDelays {
        let inputs = std::iter::once(&x).chain(lines);
        let mut pairs: Vec<(Symbol, Symbol)> = lines.iter().copied().zip(inputs.copied()).collect();
        if is_reversed {
            pairs.reverse();
        }
        let mut delays = NestedDelays::default();
        let one = Fraction::whole(1);
        pairs.iter().for_each(|(line, input)| delays.add(*line, &Fraction::symbol(*input), &one));
        delays
    }

    #[test]
    fn the_order_of_the_lines_does_not_matter() {
        let (x, lines) = symbols(3);
        let once = |value: &Fraction| delay(value, &Fraction::whole(1));
        let first = once(&Fraction::symbol(x));
        let expected = [first.clone(), once(&first), once(&once(&first))];
        for is_reversed in [false, true] {
            let delays = chain(x, &lines, is_reversed);
            let found: Vec<&Fraction> = lines.iter().map(|line| &delays.values[line]).collect();
            assert_eq!(found, expected.iter().collect::<Vec<_>>(), "{is_reversed}");
        }
    }

    #[test]
    fn long_chains_are_not_deep() {
        let (x, lines) = symbols(3000);
        for is_reversed in [false, true] {
            let delays = chain(x, &lines, is_reversed);
            assert!(delays.values.len() > 2900 && delays.values.len() < 3000);
            assert!(delays.values.values().all(|value| value.depth() <= MAX_DEPTH));
            // A line without an expression stays as it is in those of others.
            let is_kept = |symbol: Symbol| symbol == x || !delays.values.contains_key(&symbol);
            let mut values = delays.values.values();
            assert!(values.all(|value| !value.contains(&mut |symbol| !is_kept(symbol))));
        }
    }

    #[test]
    fn a_line_that_reads_itself_keeps_its_name() {
        let (x, lines) = symbols(2);
        let [first, second] = [lines[0], lines[1]];
        let mut delays = NestedDelays::default();
        let sum = Fraction::symbol(x).plus(&Fraction::symbol(second));
        delays.add(first, &sum, &Fraction::whole(1));
        delays.add(second, &Fraction::symbol(first), &Fraction::whole(1));
        assert_eq!(delays.values.keys().collect::<Vec<_>>(), [&first]);
    }
}
