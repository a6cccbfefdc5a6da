//! Values of all quantities at points, for identities that the normal form does not show.

use patchcord_core::ir::{ParameterValue, Program};
use patchcord_core::low_discrepancy::golden_place;
use patchcord_core::machines::REFERENCE;

use crate::derive::System;
use crate::symbolic::{Fraction, Symbol, SymbolKind, Values, term_size, value};

/// Points at which two expressions are compared.
const POINTS: u32 = 64;
/// Points at which both expressions must have a value.
pub(super) const MIN_POINTS: u32 = 8;
/// Difference of two equal expressions by rounding, as a share of the sum of their terms.
pub(super) const ROUNDING: f64 = 1e-9;
/// The golden ratio, whose multiples have irregular fractions.
pub(crate) const GOLDEN: f64 = 1.618_033_988_749_895;

/// A value for every quantity, which depends on the index of the point for those that vary.
#[derive(Clone, Copy)]
pub(super) struct Point<'a> {
    pub system: &'a System,
    pub program: &'a Program,
    /// Values of the coefficients of the program.
    pub coefficients: &'a [f64],
    /// Values of the parameters.
    pub parameters: ParameterValues,
    /// Length of the run in seconds. All times are within it, so that motions that decay have not died out.
    pub duration: f64,
    /// Index of the point.
    pub index: u32,
}

/// Values of the parameters at a point.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum ParameterValues {
    /// Those of the circuit.
    Present,
    /// Others, up to 4 % larger, so that a solution of a loop is near the present one.
    Near,
    /// Others, all larger by different factors, so that no relation between them holds by chance.
    Other,
}

impl ParameterValues {
    /// The value of the parameter with this index.
    pub(super) fn value(self, program: &Program, index: usize) -> f64 {
        let parameter = &program.parameters()[index];
        match self {
            ParameterValues::Present => parameter.value,
            ParameterValues::Near => near_value(parameter, index),
            ParameterValues::Other => other_value(parameter.value, index),
        }
    }
}

/// A value near the present one for the parameter with this index. The distance from 0 is a share of the range.
fn near_value(parameter: &ParameterValue, index: usize) -> f64 {
    let declared = &parameter.declared;
    let size = match declared.range {
        Some((low, high)) if parameter.value == 0.0 => low.abs().max(high.abs()) * declared.per_unit,
        None if parameter.value == 0.0 => 1.0,
        _ => parameter.value,
    };
    parameter.value + size * (0.01 + 0.03 * golden_place(index as u64))
}

/// The points at which expressions are compared. `point` is any of them.
pub(super) fn points(point: Point<'_>) -> impl Iterator<Item = Point<'_>> {
    (1..=POINTS).map(move |index| Point { index, ..point })
}

/// Whether two expressions are equal at all points at which both have a value. `None` if they have one at few points, as
/// the root of a quantity that is mostly negative. `point` is any of the points.
pub(super) fn equal_at_points(point: Point<'_>, sides: [&Fraction; 2]) -> Option<bool> {
    let mut compared = 0;
    for point in points(point) {
        match equal_at(&point, sides, ROUNDING) {
            Some(true) => compared += 1,
            Some(false) => return Some(false),
            None => {}
        }
    }
    (compared >= MIN_POINTS).then_some(true)
}

/// Whether two expressions have values that are equal up to this share of their terms. `None` if one has no value.
pub(super) fn equal_at(values: &dyn Values, [first, second]: [&Fraction; 2], tolerance: f64) -> Option<bool> {
    let [one, other] = [first, second].map(|fraction| value(fraction, values));
    if !(one.is_finite() && other.is_finite()) {
        return None;
    }
    let size = term_size(first, values) + term_size(second, values);
    let is_different = (one - other).abs() > tolerance * size;
    Some(!is_different)
}

/// Another value for the parameter with this index.
pub(crate) fn other_value(present: f64, index: usize) -> f64 {
    let share = golden_place(index as u64);
    if present == 0.0 { 1.0 + share } else { present * (1.1 + 0.3 * share) }
}

impl Point<'_> {
    /// A value for a quantity that varies. Most are some volts; the sizes differ from point to point.
    fn variable(&self, symbol: Symbol) -> f64 {
        let share = 2.0 * golden_place(u64::from(self.index) + u64::from(symbol.index)) - 1.0;
        let volts = share * 10f64.powi(self.index as i32 % 3);
        volts * self.per_volt(symbol)
    }

    /// The value of a quantity that varies at 1 V.
    fn per_volt(&self, symbol: Symbol) -> f64 {
        if let Some(per_volt) = self.system.per_volt.get(&symbol) {
            return value(per_volt, self);
        }
        let name = &self.system.symbols.entry(symbol).name;
        let signal = self.program.signals().iter().find(|signal| signal.name == *name);
        let per_volt = signal.and_then(|signal| signal.per_volt);
        per_volt.map_or(1.0, |index| self.coefficients[index as usize])
    }

    /// The range of a quantity that varies: times within the run, and ±100 V for all others.
    pub(super) fn range(&self, symbol: Symbol) -> [f64; 2] {
        if self.system.symbols.entry(symbol).kind == SymbolKind::Time {
            return [0.0, self.duration];
        }
        let end = REFERENCE * self.per_volt(symbol).abs();
        [-end, end]
    }
}

impl Values for Point<'_> {
    fn symbol(&self, symbol: Symbol) -> f64 {
        match self.system.symbols.entry(symbol).kind {
            SymbolKind::Pi => std::f64::consts::PI,
            SymbolKind::Parameter(index) => self.parameters.value(self.program, index),
            SymbolKind::Time => self.duration * golden_place(u64::from(self.index).pow(2)),
            SymbolKind::Variable | SymbolKind::Held => self.variable(symbol),
        }
    }

    fn table(&self, table: u32, at: f64) -> f64 {
        self.system.tables[table as usize].value_in_si(at)
    }

    fn slope(&self, _table: u32, _at: f64) -> f64 {
        f64::NAN
    }

    fn delayed(&self, _expression: &Fraction, _time: f64) -> f64 {
        f64::NAN
    }
}
