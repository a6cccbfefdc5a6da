//! Compares expressions between their corners, such as within a short pulse or between two thresholds.
//!
//! Points in the whole range seldom lie within a short interval. Its ends are corners: the values of one quantity at
//! which the argument of a step or of an absolute value is 0, at which a number that is rounded down jumps, and those of
//! the points of a table. If a threshold is wrong, the expressions differ between the right and the wrong one only.

use std::collections::BTreeMap;
use std::slice::from_ref;
use std::sync::Arc;

use patchcord_expr::Function;

use super::points::{Point, equal_at, points};
use super::terms::TOLERANCE;
use crate::derive::System;
use crate::symbolic::{
    Application, CallOrder, Fraction, Operation, Roots, Symbol, TrialValues, Values, value,
};

/// Points at which corners are looked for.
const BASES: usize = 3;
/// Functions of an expression whose corners are looked for, at most.
const MAX_FUNCTIONS: usize = 32;
/// Longest argument of such a function, in terms.
const LONGEST: usize = 40;
/// Points of a table that are corners, at most.
const MAX_TABLE_POINTS: usize = 64;
/// Intervals at most: the shortest ones, because points in the whole range lie within the others.
const MAX_INTERVALS: usize = 48;
/// Places within an interval, as shares of its length.
const PLACES: [f64; 3] = [0.5, 0.23, 0.81];
/// Length of an interval between corners of one expression, as a share of them, up to which they are one corner. Those
/// of two expressions can be rounded settings, so they have the tolerance of a factor.
const ROUNDING: f64 = 1e-9;
/// Length of any interval, as a share of the range, up to which its ends are one corner.
const SHORTEST: f64 = 1e-12;

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

    /// Whether the ends are different corners. Up to this share of them they are one corner.
    fn is_longer(&self, share: f64) -> bool {
        let [low, high] = self.ends;
        high - low > share * low.abs().max(high.abs()) && self.length() > SHORTEST
    }

    /// Whether two expressions are equal, up to this share of their terms, where both have a value.
    fn has_equal(&self, sides: [&Fraction; 2], tolerance: f64) -> bool {
        let [low, high] = self.ends;
        PLACES.iter().all(|place| {
            let at = [low + place * (high - low)];
            let values = TrialValues::new(from_ref(&self.symbol), &at, &self.point);
            equal_at(&values, sides, tolerance) != Some(false)
        })
    }
}

/// Whether two expressions are equal between all corners of both, up to this share of their terms. `point` is any of the
/// points.
pub(super) fn equal_between_corners(point: Point<'_>, sides: [&Fraction; 2], tolerance: f64) -> bool {
    let functions = sides.map(corner_functions);
    let mut found: Vec<Interval<'_>> = Vec::new();
    for point in points(point).take(BASES) {
        let corners = functions.each_ref().map(|functions| corners_at(point, functions));
        for own in &corners {
            found.extend(intervals(point, own, ROUNDING));
        }
        found.extend(intervals(point, &with_ends_of_ranges(point, corners), TOLERANCE));
    }
    found.sort_by(|one, other| one.length().total_cmp(&other.length()));
    found.iter().take(MAX_INTERVALS).all(|interval| interval.has_equal(sides, tolerance))
}

/// Values of quantities, by quantity.
type Corners = BTreeMap<Symbol, Vec<f64>>;

/// The corners of functions near a point.
fn corners_at(point: Point<'_>, functions: &[Arc<Application>]) -> Corners {
    let mut found = Corners::new();
    for (symbol, place) in functions.iter().flat_map(|function| corners(function, &point)) {
        found.entry(symbol).or_default().push(place);
    }
    found
}

/// The corners of two expressions, with the ends of the ranges of their quantities.
fn with_ends_of_ranges(point: Point<'_>, [mut all, other]: [Corners; 2]) -> Corners {
    for (symbol, places) in other {
        all.entry(symbol).or_default().extend(places);
    }
    for (symbol, places) in &mut all {
        places.extend(point.range(*symbol));
    }
    all
}

/// The intervals between neighbouring corners that differ by more than this share of them.
fn intervals<'a>(point: Point<'a>, corners: &Corners, share: f64) -> Vec<Interval<'a>> {
    let mut found = Vec::new();
    for (symbol, places) in corners {
        let mut places = places.clone();
        places.sort_by(f64::total_cmp);
        let pairs = places.windows(2);
        found.extend(pairs.map(|pair| Interval { point, symbol: *symbol, ends: [pair[0], pair[1]] }));
    }
    found.retain(|interval| interval.is_longer(share));
    found
}

/// The functions of an expression whose corners are looked for.
pub(super) fn corner_functions(expression: &Fraction) -> Vec<Arc<Application>> {
    let mut functions = expression.functions_with(&has_corners);
    functions.truncate(MAX_FUNCTIONS);
    functions
}

/// Whether a function has corners that can be found fast.
fn has_corners(function: &Application) -> bool {
    let has_corner = matches!(
        function.operation,
        Operation::Absolute
            | Operation::Step
            | Operation::Table(_)
            | Operation::Call(CallOrder(Function::Floor))
    );
    has_corner && function.arguments.iter().all(|argument| argument.nested_size(LONGEST + 1) <= LONGEST)
}

/// The expressions that are 0 at the corners of a function near some values.
pub(super) fn corner_residuals(
    function: &Application,
    system: &System,
    values: &dyn Values,
) -> Vec<Fraction> {
    let Some(argument) = function.arguments.first() else { return Vec::new() };
    let levels = match function.operation {
        Operation::Call(_) => {
            let level = value(argument, values).floor();
            vec![level, level + 1.0]
        }
        Operation::Table(table) => {
            let points = &system.tables[table as usize].points;
            points.iter().take(MAX_TABLE_POINTS).map(|[abscissa, _]| *abscissa).collect()
        }
        _ => vec![0.0],
    };
    levels.into_iter().map(|level| argument.minus(&Fraction::number(level))).collect()
}

/// The value of a quantity at which an expression is 0, near its present value. `None` if it is outside of a range.
pub(super) fn root(
    expression: &Fraction,
    symbol: Symbol,
    values: &dyn Values,
    [low, high]: [f64; 2],
) -> Option<f64> {
    let roots = Roots::new(vec![symbol], vec![expression.clone()]);
    let found = *roots.near(vec![values.symbol(symbol)], values)?.first()?;
    (low..=high).contains(&found).then_some(found)
}

/// The corners of a function near a point: each with the quantity that has this value there.
fn corners(function: &Application, point: &Point<'_>) -> Vec<(Symbol, f64)> {
    let mut found = Vec::new();
    for residual in corner_residuals(function, point.system, point) {
        for symbol in residual.symbols().into_iter().filter(|symbol| !symbol.is_constant) {
            found.extend(root(&residual, symbol, point, point.range(symbol)).map(|place| (symbol, place)));
        }
    }
    found
}
