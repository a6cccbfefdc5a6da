//! The derived equations equal the program at random points.

use std::collections::HashMap;
use std::fs;
use std::path::{Path, PathBuf};

use patchcord_core::circuit::Circuit;
use patchcord_core::ir::{Level, Program, ProgramPoint, Register};
use patchcord_core::patch::Patch;

use super::system::{LawKind, System};
use super::wiring::{Options, Wiring, derive};
use crate::symbolic::{Fraction, Symbol, Values, value};

/// A sequence of numbers between -1 and 1 that are the same on every machine.
struct Numbers(u64);

impl Numbers {
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    }
}

/// A random point. The voltages of the states are at most `size`.
fn point(program: &Program, numbers: &mut Numbers, size: f64) -> ProgramPoint {
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
fn voltages(program: &Program, numbers: &mut Numbers) -> Option<(ProgramPoint, Vec<f64>)> {
    [80.0, 20.0, 5.0, 1.0, 0.1, 1e-3].iter().find_map(|size| {
        let point = point(program, numbers, *size);
        let voltages = program.voltages_at(&point)?;
        let is_linear = program.lamps().iter().all(|lamp| voltages[lamp.demand.index()].abs() <= 100.0);
        is_linear.then_some((point, voltages))
    })
}

/// The values of all symbols at a point.
struct Point<'a> {
    system: &'a System,
    values: HashMap<u32, f64>,
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

    fn delayed(&self, _expression: &Fraction, _time: f64) -> f64 {
        f64::NAN
    }
}

/// The values of all symbols of a wiring. Named outputs have the values that the program computes.
fn symbol_values<'a>(
    wiring: &'a Wiring,
    program: &Program,
    point: &ProgramPoint,
    voltages: &[f64],
) -> Point<'a> {
    let mut values = Point { system: &wiring.system, values: HashMap::new() };
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
fn size(fraction: &Fraction, values: &Point<'_>) -> f64 {
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

/// Compares every law of a patch with its program at random points. Returns the number of comparisons.
fn compare(file: &Path, options: Options) -> usize {
    let patch = Patch::read(file).unwrap();
    let circuit = Circuit::new(&patch).unwrap();
    let program = Program::new(&circuit).unwrap();
    let wiring = derive(&circuit, &program, options);
    let mut numbers = Numbers(7);
    let mut compared = 0;
    for _ in 0..5 {
        let Some((point, voltages)) = voltages(&program, &mut numbers) else { continue };
        let mut values = symbol_values(&wiring, &program, &point, &voltages);
        for law in &wiring.system.laws {
            let name = &wiring.system.symbols.entry(law.of).name;
            let close = |fraction: &Fraction, expected: f64, values: &Point<'_>| {
                let (found, size) = (value(fraction, values), size(fraction, values).max(expected.abs()));
                assert!(
                    (found - expected).abs() <= 1e-12 * size,
                    "{}: {name} is {found}, not {expected} (terms {size})",
                    file.display()
                );
            };
            match &law.kind {
                LawKind::Definition(definition) | LawKind::Drive(definition) => {
                    match values.values.get(&law.of.index) {
                        Some(expected) => close(definition, *expected, &values),
                        // Signals with a second name and long sums are computed here.
                        None => {
                            let found = value(definition, &values);
                            values.values.insert(law.of.index, found);
                        }
                    }
                }
                LawKind::Implicit(residual) => {
                    let (found, size) = (value(residual, &values), size(residual, &values));
                    assert!(found.abs() <= 1e-9 * size, "{}: {name}: {found} of {size}", file.display());
                }
                _ => continue,
            }
            compared += 1;
        }
        for (symbol, state) in wiring.states.iter().zip(program.state_laws()) {
            let register: Register = program.element_outputs()[state.element].register;
            let per_volt = value(&wiring.names[&register].per_volt, &values);
            let Some(LawKind::State { rate, .. }) = wiring.system.law(*symbol) else {
                panic!("a state has a rate")
            };
            let expected = per_volt * voltages[state.demand.index()];
            let (found, size) = (value(rate, &values), size(rate, &values).max(expected.abs()));
            let name = &wiring.system.symbols.entry(*symbol).name;
            assert!(
                (found - expected).abs() <= 1e-12 * size,
                "{}: rate of {name} is {found}, not {expected} (terms {size})",
                file.display()
            );
            compared += 1;
        }
    }
    compared
}

/// All patches in a folder and its subfolders.
fn patches(folder: &str) -> Vec<PathBuf> {
    let mut found = Vec::new();
    let mut open = vec![PathBuf::from(folder)];
    while let Some(folder) = open.pop() {
        for entry in fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                open.push(path);
            } else if path.extension().is_some_and(|ending| ending == "json")
                && Patch::read(&path).is_ok_and(|patch| {
                    Circuit::new(&patch).is_ok_and(|circuit| Program::new(&circuit).is_ok())
                })
            {
                found.push(path);
            }
        }
    }
    found.sort();
    found
}

#[test]
fn equations_of_shipped_patches_equal_their_programs() {
    let files = patches("../../patches");
    assert!(files.len() > 35, "{}", files.len());
    for file in files {
        for keeps_elements in [false, true] {
            let compared = compare(
                &file,
                Options { keeps_elements, has_ideal_amplifiers: false, stays_in_range: false },
            );
            assert!(compared > 0, "{}", file.display());
        }
    }
}

#[test]
fn equations_of_the_engine_s_test_patches_equal_their_programs() {
    let files = patches("../core/tests/patches");
    assert!(files.len() > 8, "{}", files.len());
    let compared: usize = files
        .iter()
        .map(|file| {
            compare(
                file,
                Options { keeps_elements: false, has_ideal_amplifiers: false, stays_in_range: false },
            )
        })
        .sum();
    assert!(compared > 100, "{compared}");
}
