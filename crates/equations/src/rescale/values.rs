//! Values of formulas under old and new scales, at the present values of the parameters and at others.
//!
//! A changed formula must be right for all values of the parameters, so it is compared at several points.

use std::collections::{BTreeMap, BTreeSet};

use patchcord_core::circuit::Circuit;
use patchcord_core::document::TIME_SCALE;
use patchcord_expr::{Dimension, Formula, Scope};

use crate::operating_point::Numbers;

/// The number of points: the present values of the parameters, and random ones.
const POINTS: usize = 7;
/// The seed of the random values.
const SEED: u64 = 8;
/// The share by which a parameter without a range varies.
const VARIATION: f64 = 0.2;
/// Two values of a formula are equal if they differ by at most this share. Numbers in changed formulas have 14 digits.
const ROUNDING: f64 = 1e-12;

/// The share of the largest value by which a value that is a small difference can be wrong.
const CANCELLED: f64 = 1e-13;

/// Parameters that are varied over their ranges at most, as the check of a patch does.
const MOST_VARIED: usize = 6;

/// The value of a formula at each point. `None` where it has none.
pub(super) type PointValues = [Option<f64>; POINTS];

/// The values of everything that formulas can name.
pub(super) struct Values<'c> {
    circuit: &'c Circuit,
    /// The formulas of scales that differ from those of the circuit.
    pub scales: BTreeMap<String, Formula>,
    /// Machine seconds per problem second.
    pub time_scale: f64,
    /// The values of the parameters in SI units at each point, by name. The first point has none, so it has the present
    /// values.
    points: Vec<BTreeMap<String, f64>>,
}

impl<'c> Values<'c> {
    /// The values of a circuit as it is.
    pub(super) fn of(circuit: &'c Circuit) -> Self {
        let mut numbers = Numbers::new(SEED);
        let mut points = vec![BTreeMap::new()];
        for _ in 1..POINTS {
            let varied = circuit.parameters().map(|(name, parameter, value)| {
                let share = numbers.share();
                let value = match parameter.range {
                    Some((low, high)) => low + (high - low) * f64::midpoint(1.0, share),
                    None => value * (1.0 + VARIATION * share),
                };
                (name.to_owned(), parameter.unit.to_si(value))
            });
            points.push(varied.collect());
        }
        let time_scale = circuit.time_scale();
        Values { circuit, scales: BTreeMap::new(), time_scale, points }
    }

    /// The value of a formula at a point, in SI units or as a bare number.
    pub(super) fn value(&self, formula: &Formula, point: usize) -> Option<f64> {
        self.value_with(formula, &self.points[point])
    }

    /// The value of a formula for these values of parameters in SI units. Other parameters have their present values.
    fn value_with(&self, formula: &Formula, parameters: &BTreeMap<String, f64>) -> Option<f64> {
        let value = formula.evaluate(&PointScope { values: self, parameters }).ok()?;
        value.is_finite().then_some(value)
    }

    /// The largest value of a formula at the present values of the parameters and at the lower bounds, the middles and
    /// the upper bounds of their ranges. The check of a patch tries the same values.
    pub(super) fn largest(&self, formula: &Formula) -> Option<f64> {
        let mut combinations = vec![BTreeMap::new()];
        for (name, values) in self.varied(formula).into_iter().take(MOST_VARIED) {
            let with = |known: &BTreeMap<String, f64>, value: f64| {
                let mut parameters = known.clone();
                parameters.insert(name.clone(), value);
                parameters
            };
            combinations =
                combinations.iter().flat_map(|known| values.map(|value| with(known, value))).collect();
        }
        let values = combinations.iter().filter_map(|parameters| self.value_with(formula, parameters));
        values.chain(self.value(formula, 0)).reduce(f64::max)
    }

    /// The parameters with a range on which a formula depends, each with its lower bound, middle and upper bound in SI
    /// units.
    fn varied(&self, formula: &Formula) -> Vec<(String, [f64; 3])> {
        let mut names: BTreeSet<&str> = BTreeSet::new();
        let mut open = vec![formula];
        while let Some(formula) = open.pop() {
            for name in formula.names() {
                let index = self.circuit.derived_index(name).filter(|_| !names.contains(name));
                let own = |index: usize| self.scales.get(name).unwrap_or(self.circuit.derived(index).1);
                open.extend(index.map(own));
                names.insert(name);
            }
        }
        let own = self.circuit.parameters().filter(|(name, ..)| names.contains(name));
        let varied = own.filter_map(|(name, parameter, _)| {
            let (low, high) = parameter.range?;
            let values = [low, f64::midpoint(low, high), high].map(|value| parameter.unit.to_si(value));
            Some((name.to_owned(), values))
        });
        varied.collect()
    }

    /// The values of a formula at all points.
    pub(super) fn all(&self, formula: &Formula) -> PointValues {
        std::array::from_fn(|point| self.value(formula, point))
    }

    /// The values of one volt of a scale at all points, in SI units.
    pub(super) fn per_volt(&self, scale: &str) -> PointValues {
        std::array::from_fn(|point| {
            let scope = PointScope { values: self, parameters: &self.points[point] };
            scope.value(scale).filter(|value| value.is_finite())
        })
    }
}

/// Whether two formulas have the same values. Points at which one has none do not count, except for the present values.
pub(super) fn agree(one: &PointValues, other: &PointValues) -> bool {
    let largest = one.iter().chain(other).flatten().fold(0.0, |largest: f64, value| largest.max(value.abs()));
    let are_equal = |one: f64, other: f64| {
        (one - other).abs() <= ROUNDING * one.abs().max(other.abs()) + CANCELLED * largest
    };
    let mut pairs = one.iter().zip(other).enumerate();
    pairs.all(|(point, pair)| match pair {
        (Some(one), Some(other)) => are_equal(*one, *other),
        _ => point > 0,
    })
}

/// The factor between two formulas at the first point at which both are not 0. `None` if it is not positive.
pub(super) fn ratio(wanted: &PointValues, now: &PointValues) -> Option<f64> {
    let mut ratios = wanted.iter().zip(now).filter_map(|pair| match pair {
        (Some(wanted), Some(now)) if *wanted != 0.0 && *now != 0.0 => Some(wanted / now),
        _ => None,
    });
    ratios.next().filter(|ratio| *ratio > 0.0 && ratio.is_finite())
}

/// The names of formulas at a point.
struct PointScope<'v> {
    values: &'v Values<'v>,
    /// The values of parameters in SI units, by name. Others have their present values.
    parameters: &'v BTreeMap<String, f64>,
}

impl Scope for PointScope<'_> {
    fn value(&self, name: &str) -> Option<f64> {
        let Values { circuit, scales, time_scale, .. } = self.values;
        if name == TIME_SCALE {
            return Some(*time_scale);
        }
        if let Some(value) = self.parameters.get(name) {
            return Some(*value);
        }
        let Some(index) = circuit.derived_index(name) else { return circuit.quantities().value(name) };
        let (_, own) = circuit.derived(index);
        let formula = scales.get(name).unwrap_or(own);
        let value = formula.evaluate(self).ok()?;
        let unit = circuit.derived_unit(index);
        Some(if circuit.is_literal(formula) { unit.to_si(value) } else { value })
    }

    fn dimension(&self, name: &str) -> Option<Dimension> {
        self.values.circuit.quantities().dimension(name)
    }

    fn names(&self) -> Vec<&str> {
        self.values.circuit.quantities().names()
    }
}
