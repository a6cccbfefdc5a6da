//! Delays of delays: the outputs of delay lines that have no name are written inside each other.

use std::collections::HashMap;

use crate::symbolic::{Fraction, Symbol, delay};

/// Functions inside each other at most. In a longer chain of delay lines, some keep the names of their elements.
const MAX_DEPTH: usize = 50;

/// A delay line: its output, its input and the time between them.
#[derive(Debug, Clone, Copy)]
pub(super) struct DelayLine<'a> {
    pub output: Symbol,
    pub input: &'a Fraction,
    pub time: &'a Fraction,
}

/// The outputs of delay lines as expressions of what is delayed. An output has none if it depends on itself, or if
/// delays would be too deep inside each other.
pub(super) fn nested(lines: &[DelayLine<'_>]) -> HashMap<Symbol, Fraction> {
    let (mut values, mut outputs) = (HashMap::new(), Vec::new());
    for place in in_order(lines) {
        let DelayLine { output, input, time } = lines[place];
        let value = delay(&input.with_symbols(&values), &time.with_symbols(&values));
        if value.depth() <= MAX_DEPTH && !value.contains(&mut |symbol| symbol == output) {
            values.insert(output, value);
            outputs.push(output);
        }
    }
    // In a circle of delay lines, an output can read one that comes later.
    for output in outputs.iter().rev() {
        let value = values[output].with_symbols(&values);
        values.insert(*output, value);
    }
    values
}

/// The indices of delay lines in an order in which each comes after those that it reads. A circle begins anywhere.
fn in_order(lines: &[DelayLine<'_>]) -> Vec<usize> {
    let places: HashMap<Symbol, usize> = lines.iter().map(|line| line.output).zip(0..).collect();
    let (mut order, mut is_begun) = (Vec::with_capacity(lines.len()), vec![false; lines.len()]);
    // Each line is on the stack with whether all that it reads is in the order.
    let mut stack: Vec<(usize, bool)> = (0..lines.len()).rev().map(|place| (place, false)).collect();
    while let Some((place, is_complete)) = stack.pop() {
        if is_complete {
            order.push(place);
        } else if !std::mem::replace(&mut is_begun[place], true) {
            stack.push((place, true));
            lines[place].input.contains(&mut |symbol| {
                stack.extend(places.get(&symbol).map(|inner| (*inner, false)));
                false
            });
        }
    }
    order
}

#[cfg(test)]
mod tests {
    use patchcord_expr::Dimension;

    use super::*;
    use crate::symbolic::Symbols;

    /// The symbols of x and of this number of delay lines.
    fn symbols(count: usize) -> (Symbol, Vec<Symbol>) {
        let mut all = Symbols::default();
        let mut symbol = |name: &str| all.variable(name, 0, Dimension::VOLTAGE);
        let x = symbol("x");
        (x, (0..count).map(|index| symbol(&format!("D{index}"))).collect())
    }

    /// The expressions of delay lines of 1 s with these outputs and inputs.
    fn nested_by_1_s(lines: &[(Symbol, Fraction)]) -> HashMap<Symbol, Fraction> {
        let time = Fraction::whole(1);
        let lines = lines.iter().map(|(output, input)| DelayLine { output: *output, input, time: &time });
        nested(&lines.collect::<Vec<_>>())
    }

    /// A chain of delay lines: each reads the one in front of it, and the first one reads x.
    fn chain(x: Symbol, lines: &[Symbol]) -> Vec<(Symbol, Fraction)> {
        let inputs = std::iter::once(&x).chain(lines);
        lines.iter().zip(inputs).map(|(line, input)| (*line, Fraction::symbol(*input))).collect()
    }

    #[test]
    fn the_order_of_the_lines_does_not_matter() {
        let (x, lines) = symbols(3);
        let once = |value: &Fraction| delay(value, &Fraction::whole(1));
        let first = once(&Fraction::symbol(x));
        let expected = [first.clone(), once(&first), once(&once(&first))];
        let mut pairs = chain(x, &lines);
        for _ in 0..3 {
            let values = nested_by_1_s(&pairs);
            assert_eq!(values.len(), 3);
            assert!(lines.iter().zip(&expected).all(|(line, value)| values[line] == *value));
            pairs.rotate_left(1);
        }
        pairs.reverse();
        assert_eq!(nested_by_1_s(&pairs)[&lines[2]], expected[2]);
    }

    #[test]
    fn long_chains_are_not_deep() {
        let (x, lines) = symbols(3000);
        let mut pairs = chain(x, &lines);
        for _ in 0..2 {
            let values = nested_by_1_s(&pairs);
            // Every 51st line keeps its name.
            assert_eq!(values.len(), 3000 - 3000 / 51);
            assert!(values.values().all(|value| value.depth() <= MAX_DEPTH));
            assert!(!values.values().any(|value| value.contains(&mut |symbol| values.contains_key(&symbol))));
            pairs.reverse();
        }
    }

    #[test]
    fn a_circle_keeps_the_name_of_one_line() {
        let (x, lines) = symbols(2);
        let [first, second] = [lines[0], lines[1]];
        let sum = Fraction::symbol(x).plus(&Fraction::symbol(second));
        let values = nested_by_1_s(&[(first, sum), (second, Fraction::symbol(first))]);
        assert_eq!(values.keys().collect::<Vec<_>>(), [&second]);
    }
}
