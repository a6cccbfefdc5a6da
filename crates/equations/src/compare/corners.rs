//! Points between the corners of characteristics, for identities that other points do not decide.
//!
//! A limiter follows its input between two corners only. If they are near each other, every other point can be beyond
//! them, and there all limiters with the same limits are equal. So each quantity is varied along a line through a point,
//! and two expressions are compared between all corners on this line.

use std::collections::BTreeSet;

use super::points::{Point, equal_at, points};
use crate::symbolic::{Fraction, Symbol, SymbolKind, Values, corner_arguments, term_size, value};

/// Points through which lines lead.
const LINES: usize = 8;
/// Corners that are examined at most.
const MAX_CORNERS: usize = 32;
/// Volts of the machine at most.
const FULL_SCALE: f64 = 100.0;
/// Secants at most in the search for a zero.
const SECANTS: usize = 12;
/// Halvings of the range in the search for a zero.
const HALVINGS: usize = 40;
/// Value of an expression at its zero, as a share of the size of its terms.
const ZERO: f64 = 1e-9;
/// The share by which the terms of an expression at a corner can be wrong. Settings are often rounded to three digits.
const ROUNDED: f64 = 2e-3;
/// The smallest interval, as a share of the range.
const RESOLUTION: f64 = 1e-6;

/// Whether two expressions are equal between the corners of both. `point` is any of the points.
pub(super) fn are_equal_between_corners(point: Point<'_>, sides: [&Fraction; 2]) -> bool {
    let corners: Vec<Fraction> = sides.into_iter().flat_map(corner_arguments).take(MAX_CORNERS).collect();
    let quantities = quantities(&point, &corners);
    points(point).take(LINES).all(|point| {
        quantities.iter().all(|quantity| {
            let line = Line { point, quantity: *quantity };
            line.places(&corners).into_iter().all(|place| equal_at(&line.at(place), sides) != Some(false))
        })
    })
}

/// The quantities in expressions that vary continuously.
fn quantities(point: &Point<'_>, expressions: &[Fraction]) -> BTreeSet<Symbol> {
    let mut found = BTreeSet::new();
    for expression in expressions {
        expression.contains(&mut |symbol| {
            let kind = point.system.symbols.entry(symbol).kind;
            if matches!(kind, SymbolKind::Variable | SymbolKind::Time) {
                found.insert(symbol);
            }
            false
        });
    }
    found
}

/// The line through a point on which one quantity varies.
#[derive(Clone, Copy)]
struct Line<'a> {
    /// The point.
    point: Point<'a>,
    /// The quantity that varies.
    quantity: Symbol,
}

/// A place on a line.
struct LinePlace<'a> {
    /// The line.
    line: Line<'a>,
    /// The value of the quantity that varies.
    value: f64,
}

/// An end of an interval on a line.
struct End {
    /// The value of the quantity that varies.
    place: f64,
    /// The distance by which it can be wrong.
    spread: f64,
}

impl<'a> Line<'a> {
    /// The place with this value of the quantity.
    fn at(self, value: f64) -> LinePlace<'a> {
        LinePlace { line: self, value }
    }

    /// The range of the quantity.
    fn range(&self) -> [f64; 2] {
        match self.point.system.symbols.entry(self.quantity).kind {
            SymbolKind::Time => [0.0, self.point.duration],
            _ => [-1.0, 1.0].map(|sign| sign * FULL_SCALE * self.point.volt(self.quantity).abs()),
        }
    }

    /// A place between every two neighbouring corners, and one on both sides of all.
    fn places(&self, corners: &[Fraction]) -> Vec<f64> {
        let [low, high] = self.range();
        let mut ends: Vec<End> = corners.iter().filter_map(|corner| self.end(corner)).collect();
        ends.retain(|end| (low..=high).contains(&end.place));
        if ends.is_empty() {
            return Vec::new();
        }
        ends.extend([low, high].map(|place| End { place, spread: RESOLUTION * (high - low) }));
        ends.sort_by(|one, other| one.place.total_cmp(&other.place));
        let is_interval = |pair: &&[End]| pair[1].place - pair[0].place > pair[0].spread.max(pair[1].spread);
        ends.windows(2).filter(is_interval).map(|pair| pair[0].place.midpoint(pair[1].place)).collect()
    }

    /// The corner at the zero of an expression. `None` if none is found.
    fn end(&self, expression: &Fraction) -> Option<End> {
        let place = self.zero(expression)?;
        let [low, high] = self.range();
        let near = RESOLUTION * (high - low);
        let [before, after] = [place - near, place + near].map(|near| value(expression, &self.at(near)));
        let moved = ROUNDED * term_size(expression, &self.at(place)) * 2.0 * near / (after - before).abs();
        Some(End { place, spread: near.max(moved) })
    }

    /// The place of a zero of an expression. `None` if none is found.
    fn zero(&self, expression: &Fraction) -> Option<f64> {
        self.zero_by_secants(expression).or_else(|| self.zero_by_halving(expression))
    }

    /// The place of a zero by secants, which are exact for a straight line.
    fn zero_by_secants(&self, expression: &Fraction) -> Option<f64> {
        let [mut before, mut place] = self.range();
        let mut value_before = value(expression, &self.at(before));
        for _ in 0..SECANTS {
            let here = value(expression, &self.at(place));
            if here.abs() <= ZERO * term_size(expression, &self.at(place)) {
                return Some(place);
            }
            let next = place - here * (place - before) / (here - value_before);
            if !next.is_finite() {
                return None;
            }
            (before, value_before, place) = (place, here, next);
        }
        None
    }

    /// The place of a zero between the ends of the range, if the expression has different signs there.
    fn zero_by_halving(&self, expression: &Fraction) -> Option<f64> {
        let is_above = |place: f64| value(expression, &self.at(place)) > 0.0;
        let [mut low, mut high] = self.range();
        let sign = is_above(low);
        if is_above(high) == sign {
            return None;
        }
        for _ in 0..HALVINGS {
            let middle = low.midpoint(high);
            if is_above(middle) == sign { low = middle } else { high = middle }
        }
        Some(low.midpoint(high))
    }
}

impl Values for LinePlace<'_> {
    fn symbol(&self, symbol: Symbol) -> f64 {
        if symbol == self.line.quantity { self.value } else { self.line.point.symbol(symbol) }
    }

    fn table(&self, table: u32, at: f64) -> f64 {
        self.line.point.table(table, at)
    }

    fn slope(&self, table: u32, at: f64) -> f64 {
        self.line.point.slope(table, at)
    }

    fn delayed(&self, expression: &Fraction, time: f64) -> f64 {
        self.line.point.delayed(expression, time)
    }
}
