//! The derived equations equal the program at random points.

mod points;
mod simplified;

use std::fs;
use std::path::{Path, PathBuf};

use patchcord_core::circuit::Circuit;
use patchcord_core::ir::{Program, Register};
use patchcord_core::patch::Patch;

use super::system::LawKind;
use super::wiring::{Options, derive};
use crate::symbolic::{Fraction, value};
use points::{Numbers, Point, size, symbol_values, voltages};

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
