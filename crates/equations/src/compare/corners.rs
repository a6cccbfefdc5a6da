//! Compares expressions within short intervals, such as a short pulse or the narrow window of two comparators.
//!
//! Points in the whole range seldom lie within such an interval. Its ends are corners: the values of one quantity at
//! which the argument of a step or of an absolute value is 0, or at which a number that is rounded down jumps.

use std::collections::BTreeMap;
use std::slice::from_ref;

use patchcord_expr::Function;

use super::points::{Point, equal_at, points};
use crate::symbolic::{Application, CallOrder, Fraction, Operation, Roots, Symbol, TrialValues, Values, value};

/// Points at which corners are looked for.
const BASES: usize = 3;
/// Functions of an expression whose corners are looked for, at most.
const MAX_FUNCTIONS: usize = 32;
/// Longest argument of such a function, in terms.
const LONGEST: usize = 40;
/// Intervals at most: the shortest ones, because points in the whole range lie within the others.
const MAX_INTERVALS: usize = 24;
/// Places within an interval, as shares of its length.
const PLACES: [f64; 3] = [0.5, 0.23, 0.81];
/// Length of an interval, as a share of its ends, up to which they are one corner with two roundings.
const ROUNDING: f64 = 1e-9;

/// The values of a quantity between two neighbouring corners. All others have their values at a point.
struct Interval<'a> {
    point: Point<'a>,
    symbol: Symbol,
    ends: [f64; 2],
}

impl Interval<'_> {
    /// The length as a share of the range of the quantity.
    fn length(&self) -> f64 {
        let [low, high] = self.point.range(self.symbol);
        (self.ends[1] - self.ends[0]) / (high - low)
    }

    /// Whether the ends are different corners.
    fn has_length(&self) -> bool {
        let [low, high] = self.ends;
        high - low > ROUNDING * low.abs().max(high.abs())
    }

    /// Whether two expressions are equal where both have a value.
    fn are_equal(&self, sides: [&Fraction; 2]) -> bool {
        let [low, high] = self.ends;
        PLACES.iter().all(|place| {
            let at = [low + place * (high - low)];
            equal_at(&TrialValues::new(from_ref(&self.symbol), &at, &self.point), sides) != Some(false)
        })
    }
}

/// Whether two expressions are equal between the corners of each of them. `point` is any of the points.
pub(super) fn equal_between_corners(point: Point<'_>, sides: [&Fraction; 2]) -> bool {
    sides.iter().all(|side| intervals(point, side).iter().all(|interval| interval.are_equal(sides)))
}

/// The shortest intervals between the corners of an expression.
fn intervals<'a>(point: Point<'a>, expression: &Fraction) -> Vec<Interval<'a>> {
    let mut functions = expression.functions_with(&has_corners);
    functions.truncate(MAX_FUNCTIONS);
    let mut found = Vec::new();
    for point in points(point).take(BASES) {
        let mut places: BTreeMap<Symbol, Vec<f64>> = BTreeMap::new();
        for (symbol, place) in functions.iter().flat_map(|function| corners(function, &point)) {
            places.entry(symbol).or_default().push(place);
        }
        for (symbol, mut places) in places {
            places.sort_by(f64::total_cmp);
            let pairs = places.windows(2);
            found.extend(pairs.map(|pair| Interval { point, symbol, ends: [pair[0], pair[1]] }));
        }
    }
    found.retain(Interval::has_length);
    found.sort_by(|one, other| one.length().total_cmp(&other.length()));
    found.truncate(MAX_INTERVALS);
    found
}

/// Whether a function has corners that can be found fast.
fn has_corners(function: &Application) -> bool {
    let has_corner = matches!(
        function.operation,
        Operation::Absolute | Operation::Step | Operation::Call(CallOrder(Function::Floor))
    );
    has_corner && function.arguments.iter().all(|argument| argument.nested_size(LONGEST + 1) <= LONGEST)
}

/// The corners of a function near a point: each with the quantity that has this value there.
fn corners(function: &Application, point: &Point<'_>) -> Vec<(Symbol, f64)> {
    let Some(argument) = function.arguments.first() else { return Vec::new() };
    let levels = match function.operation {
        Operation::Call(_) => {
            let level = value(argument, point).floor();
            vec![level, level + 1.0]
        }
        _ => vec![0.0],
    };
    let zeros: Vec<Fraction> =
        levels.into_iter().map(|level| argument.minus(&Fraction::number(level))).collect();
    let symbols = argument.symbols().into_iter().filter(|symbol| !symbol.is_constant);
    let places = |symbol: Symbol| zeros.iter().filter_map(move |zero| root(zero, symbol, point));
    symbols.flat_map(|symbol| places(symbol).map(move |place| (symbol, place))).collect()
}

/// The value of a quantity within its range at which an expression is 0, near its value at a point.
fn root(expression: &Fraction, symbol: Symbol, point: &Point<'_>) -> Option<f64> {
    let roots = Roots::new(vec![symbol], vec![expression.clone()]);
    let found = *roots.near(vec![point.symbol(symbol)], point)?.first()?;
    let [low, high] = point.range(symbol);
    (low..=high).contains(&found).then_some(found)
}
