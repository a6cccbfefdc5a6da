//! Random points of a program, and the values of all symbols at them.

use std::collections::HashMap;

use patchcord_core::ir::{Level, Program, ProgramPoint};

use super::super::system::System;
use super::super::wiring::Wiring;
use crate::symbolic::{Fraction, Symbol, Values, value};

/// A sequence of numbers between -1 and 1 that are the same on every machine.
pub(super) struct Numbers(pub u64);

impl Numbers {
    /// The next number.
    pub(super) fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    }
}

/// A random point. The voltages of the states are at most `size`.
pub(super) fn point(program: &Program, numbers: &mut Numbers, size: f64) -> ProgramPoint {
    let mut point = program.initial_point();
    point.states.iter_mut().for_each(|volts| *volts = size * numbers.next());
    for (mode, value) in program.modes().iter().zip(&mut point.modes) {
        let values = mode.names.values;
        *value = values[((numbers.next() + 1.0) / 2.0 * values.len() as f64) as usize % values.len()].0;
    }
    point.time = 2.0 * (numbers.next() + 1.0);
    point.delayed.iter_mut().chain(&mut point.sampled).for_each(|volts| *volts = size * numbers.next());
    for (level, value) in program.levels().iter().zip(&mut point.levels) {
        *value = if matches!(level, Level::Pulses(_)) { 1.0 } else { numbers.next() };
    }
    point
}

/// The voltages of a program at a point without an overload. `None` if there is none.
pub(super) fn voltages(program: &Program, numbers: &mut Numbers) -> Option<(ProgramPoint, Vec<f64>)> {
    SIZES.iter().find_map(|size| {
        let point = point(program, numbers, *size);
        let voltages = program.voltages_at(&point)?;
        is_linear(program, &voltages).then_some((point, voltages))
    })
}

/// Voltages of the states at random points: at most one of these sizes. The first one without an overload is taken.
pub(super) const SIZES: [f64; 6] = [80.0, 20.0, 5.0, 1.0, 0.1, 1e-3];

/// Whether no amplifier is overloaded.
pub(super) fn is_linear(program: &Program, voltages: &[f64]) -> bool {
    program.lamps().iter().all(|lamp| voltages[lamp.demand.index()].abs() <= 100.0)
}

/// The values of all symbols at a point.
pub(super) struct Point<'a> {
    /// The system, for the names of its symbols.
    pub system: &'a System,
    /// The values, by the index of the symbol.
    pub values: HashMap<u32, f64>,
    /// The values of all symbols when the delayed quantities had the values that delay lines return now.
    pub past: Option<Box<Point<'a>>>,
}

impl Values for Point<'_> {
    fn symbol(&self, symbol: Symbol) -> f64 {
        *self
            .values
            .get(&symbol.index)
            .unwrap_or_else(|| panic!("{} has no value", self.system.symbols.entry(symbol).name))
    }

    fn table(&self, table: u32, at: f64) -> f64 {
        self.system.tables[table as usize].value_in_si(at)
    }

    fn slope(&self, _table: u32, _at: f64) -> f64 {
        f64::NAN
    }

    fn delayed(&self, expression: &Fraction, _time: f64) -> f64 {
        self.past.as_ref().map_or(f64::NAN, |past| value(expression, &**past))
    }
}

/// The values of all symbols of a wiring. Named outputs have the values that the program computes.
pub(super) fn symbol_values<'a>(
    wiring: &'a Wiring,
    program: &Program,
    point: &ProgramPoint,
    voltages: &[f64],
) -> Point<'a> {
    let mut values = Point { system: &wiring.system, values: HashMap::new(), past: None };
    values.values.insert(0, std::f64::consts::PI);
    for (symbol, parameter) in wiring.parameters.iter().zip(program.parameters()) {
        values.values.insert(symbol.index, parameter.value);
    }
    values.values.insert(wiring.time.index, point.time);
    for (register, output) in &wiring.names {
        let per_volt = value(&output.per_volt, &values);
        values.values.insert(output.symbol.index, per_volt * voltages[register.index()]);
    }
    let held = wiring.sampled.iter().zip(&point.sampled).chain(wiring.levels.iter().zip(&point.levels));
    let modes = wiring.system.modes.iter().map(|mode| &mode.symbol).zip(&point.modes);
    for (symbol, number) in held.chain(modes) {
        values.values.insert(symbol.index, *number);
    }
    for (index, level) in program.levels().iter().enumerate() {
        if let Level::Points { table } = level
            && let Some(unit) = &wiring.system.tables[*table].unit
        {
            *values.values.get_mut(&wiring.levels[index].index).unwrap() *= unit.factor;
        }
    }
    values
}

/// The sum of the sizes of the terms of an expression, with which rounding is compared.
pub(super) fn size(fraction: &Fraction, values: &Point<'_>) -> f64 {
    let terms = fraction.numerator().terms().map(|(product, number)| {
        let term = Fraction::from(crate::symbolic::Polynomial::term(number.clone(), product.clone()));
        value(&term, values).abs()
    });
    let divisors = Fraction::whole(1).over(
        &fraction.divisors().fold(Fraction::whole(1), |product, (divisor, power)| {
            product.times(&Fraction::from(divisor.clone()).power(power as i32))
        }),
    );
    terms.sum::<f64>() * value(&divisors, values).abs()
}
