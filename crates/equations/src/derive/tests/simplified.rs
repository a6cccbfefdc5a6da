//! The simplified equations equal the program at random points.
//!
//! In them, signals and derivatives replace states. The expected values and rates of these follow from their definitions
//! before the simplification, and from the rates of the states in the program.

use std::collections::HashMap;
use std::path::Path;

use patchcord_core::circuit::Circuit;
use patchcord_core::ir::{Level, Program, ProgramPoint};
use patchcord_core::patch::Patch;

use super::super::simplify::{comparison, simplified};
use super::super::system::{LawKind, Source, System};
use super::super::wiring::{Options, Wiring, derive};
use super::patches;
use super::points::{Numbers, Point, SIZES, is_linear, point, size, symbol_values};
use crate::symbolic::{Fraction, Symbol, SymbolKind, derivative, value};

/// The equations as the program has them, without idealisation.
const OPTIONS: Options =
    Options { keeps_elements: false, has_ideal_amplifiers: false, stays_in_range: false };

/// Difference by rounding, as a share of the sum of the terms. A definition is differentiated and solved for its state.
const ROUNDING: f64 = 1e-9;

/// A program with its equations before and after the simplification.
struct Equations {
    program: Program,
    wiring: Wiring,
    system: System,
}

impl Equations {
    /// The equations of a patch.
    fn of(file: &Path) -> Self {
        let patch = Patch::read(file).unwrap();
        let circuit = Circuit::new(&patch).unwrap();
        let program = Program::new(&circuit).unwrap();
        let is_known = |name: &str| patch.signals.contains_key(name) || patch.drives.contains_key(name);
        let system = simplified(derive(&circuit, &program, OPTIONS), &is_known);
        let wiring = derive(&circuit, &program, OPTIONS);
        Equations { program, wiring, system }
    }

    /// A random instant. The delay lines return the voltages `delayed`.
    fn instant(&self, numbers: &mut Numbers, delayed: Option<&[f64]>) -> Option<Instant<'_>> {
        SIZES.iter().find_map(|size| {
            let mut point = point(&self.program, numbers, *size);
            if let Some(delayed) = delayed {
                point.delayed = delayed.to_vec();
            }
            let instant = self.settled(point)?;
            is_linear(&self.program, &instant.voltages).then_some(instant)
        })
    }

    /// The instant at a point. The modes of comparators and the pulses, which the simplification replaces, have the values
    /// that follow from the other quantities. `None` if there are no such values.
    fn settled(&self, mut point: ProgramPoint) -> Option<Instant<'_>> {
        for _ in 0..10 {
            let voltages = self.program.voltages_at(&point)?;
            let values = self.values(&point, &voltages);
            let before = point.clone();
            for (mode, own) in self.wiring.system.modes.iter().zip(&mut point.modes) {
                if let Some(expected) = comparison(mode) {
                    *own = value(&expected, &values);
                }
            }
            let sources = self.wiring.levels.iter().zip(self.program.levels());
            for ((symbol, level), own) in sources.zip(&mut point.levels) {
                if let (Level::Pulses(_), Some(LawKind::Source(Source::Pulses(expected)))) =
                    (level, self.wiring.system.law(*symbol))
                {
                    *own = value(expected, &values);
                }
            }
            if point == before {
                return Some(Instant { equations: self, voltages, values });
            }
        }
        None
    }

    /// The values of all symbols before the simplification.
    fn values(&self, point: &ProgramPoint, voltages: &[f64]) -> Point<'_> {
        let mut values = symbol_values(&self.wiring, &self.program, point, voltages);
        for law in &self.wiring.system.laws {
            if let LawKind::Definition(definition) = &law.kind
                && !values.values.contains_key(&law.of.index)
            {
                let found = value(definition, &values);
                values.values.insert(law.of.index, found);
            }
        }
        values
    }
}

/// The values of everything at one instant.
struct Instant<'a> {
    equations: &'a Equations,
    voltages: Vec<f64>,
    values: Point<'a>,
}

impl<'a> Instant<'a> {
    /// The rates of the states and the drives, by the index of the symbol. Those of the drives are chosen.
    fn rates(&self) -> HashMap<u32, f64> {
        let Equations { program, wiring, .. } = self.equations;
        let mut rates = HashMap::new();
        for (symbol, state) in wiring.states.iter().zip(program.state_laws()) {
            let register = program.element_outputs()[state.element].register;
            let per_volt = value(&wiring.names[&register].per_volt, &self.values);
            rates.insert(symbol.index, per_volt * self.voltages[state.demand.index()]);
        }
        for law in wiring.system.laws.iter().filter(|law| matches!(law.kind, LawKind::Drive(_))) {
            rates.insert(law.of.index, 0.01 + 0.7 * self.values.values[&law.of.index]);
        }
        rates
    }

    /// The derivative of an expression before the simplification: of the states, with the rates of their laws or with
    /// those of the program. `None` if it depends on a quantity without a rate.
    fn derivative(&self, expression: &Fraction, takes_program: bool) -> Option<Fraction> {
        let rates = self.rates();
        let mut is_known = true;
        let found = derivative(expression, &mut |symbol| {
            let rate = self.rate(symbol, takes_program, &rates);
            is_known &= rate.is_some();
            rate.unwrap_or_default()
        });
        is_known.then_some(found)
    }

    /// The rate of a symbol before the simplification.
    fn rate(&self, symbol: Symbol, takes_program: bool, rates: &HashMap<u32, f64>) -> Option<Fraction> {
        let system = &self.equations.wiring.system;
        match (system.symbols.entry(symbol).kind, system.law(symbol)) {
            (SymbolKind::Time, _) => Some(Fraction::whole(1)),
            (SymbolKind::Pi | SymbolKind::Parameter(_) | SymbolKind::Held, _) => Some(Fraction::zero()),
            (_, Some(LawKind::Definition(definition))) => self.derivative(definition, takes_program),
            (_, Some(LawKind::State { rate, .. })) if !takes_program => Some(rate.clone()),
            _ => rates.get(&symbol.index).map(|rate| Fraction::number(*rate)),
        }
    }

    /// A quantity of the simplified equations as an expression before the simplification: a signal, a state or one of
    /// their derivatives.
    fn expression(&self, symbol: Symbol) -> Option<Fraction> {
        let entry = self.equations.system.symbols.entry(symbol);
        let base = self.equations.wiring.system.symbols.find_variable(&entry.name, 0)?;
        (0..entry.primes).try_fold(Fraction::symbol(base), |of, _| self.derivative(&of, false))
    }

    /// The values of all symbols after the simplification.
    fn simplified_values(&self, past: Option<Box<Point<'a>>>) -> Point<'a> {
        let (system, rates) = (&self.equations.system, self.rates());
        let mut values = self.values.values.clone();
        for (symbol, entry) in system.symbols.entries().filter(|(_, entry)| entry.primes > 0) {
            let base = self.equations.wiring.system.symbols.find_variable(&entry.name, 0);
            let of_drive = base.filter(|_| entry.primes == 1).and_then(|base| {
                let is_drive = matches!(self.equations.wiring.system.law(base), Some(LawKind::Drive(_)));
                rates.get(&base.index).copied().filter(|_| is_drive)
            });
            let found = of_drive.or_else(|| Some(value(&self.expression(symbol)?, &self.values)));
            values.extend(found.map(|found| (symbol.index, found)));
        }
        Point { system, values, past }
    }

    /// Compares the simplified laws with the program. Returns the number of comparisons.
    fn compare(&self, past: Option<Box<Point<'a>>>, file: &Path) -> usize {
        let mut values = self.simplified_values(past);
        let mut compared = 0;
        for law in &self.equations.system.laws {
            let (found, expected) = match &law.kind {
                LawKind::Definition(definition) | LawKind::Drive(definition) => {
                    let found = value(definition, &values);
                    let expected = *values.values.entry(law.of.index).or_insert(found);
                    (definition, Some(expected))
                }
                LawKind::State { rate, .. } => {
                    let expected = self.expression(law.of).and_then(|of| self.derivative(&of, true));
                    (rate, expected.map(|expected| value(&expected, &self.values)))
                }
                LawKind::Implicit(residual) => (residual, Some(0.0)),
                _ => continue,
            };
            let (found, size) = (value(found, &values), size(found, &values));
            let Some(expected) = expected.filter(|expected| expected.is_finite() && found.is_finite()) else {
                continue;
            };
            let name = &self.equations.system.symbols.entry(law.of).name;
            assert!(
                (found - expected).abs() <= ROUNDING * size.max(expected.abs()),
                "{}: {name}: {found}, not {expected} (terms {size})",
                file.display()
            );
            compared += 1;
        }
        compared
    }
}

/// Compares the simplified laws of a patch with its program at random points. Returns the number of comparisons.
fn compare(file: &Path) -> usize {
    let equations = Equations::of(file);
    let mut numbers = Numbers(7);
    let mut compared = 0;
    for _ in 0..5 {
        let Some(past) = equations.instant(&mut numbers, None) else { continue };
        let delays = equations.program.delays().iter();
        let delayed: Vec<f64> = delays.map(|delay| past.voltages[delay.input.index()]).collect();
        let Some(present) = equations.instant(&mut numbers, Some(&delayed)) else { continue };
        let past = past.simplified_values(None);
        compared += present.compare(Some(Box::new(past)), file);
    }
    compared
}

#[test]
fn simplified_equations_of_shipped_patches_equal_their_programs() {
    let counts: Vec<usize> = patches("../../patches").iter().map(|file| compare(file)).collect();
    let compared = counts.iter().filter(|count| **count > 0).count();
    assert!(compared > 30 && counts.iter().sum::<usize>() > 300, "{counts:?}");
}

#[test]
fn simplified_equations_of_the_engine_s_test_patches_equal_their_programs() {
    let counts: Vec<usize> = patches("../core/tests/patches").iter().map(|file| compare(file)).collect();
    assert!(counts.iter().sum::<usize>() > 20, "{counts:?}");
}
