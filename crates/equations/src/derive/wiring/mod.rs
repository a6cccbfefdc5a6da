//! From the operations of a program to exact equations.
//!
//! The body is evaluated once with expressions in place of numbers. The outputs that have a name become symbols, and
//! the expression that computes an output becomes its definition. The limits of the amplifiers at ±100 V are left out:
//! the equations hold while no amplifier is overloaded.

mod body;
mod laws;
mod naming;
mod operations;
mod tables;

use std::collections::{BTreeSet, HashMap};

use patchcord_core::circuit::Circuit;
use patchcord_core::ir::{ParameterValue, Program, Register, SignalInfo};
use patchcord_expr::Dimension;

use super::system::System;
use crate::symbolic::{Fraction, Symbol, SymbolEntry, SymbolKind, Symbols};
pub(crate) use operations::ranged;
use tables::tables;

/// What the derivation keeps and what it eliminates.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Options {
    /// Whether the output of every element keeps its own equation. Otherwise only signals, drives and states do.
    pub keeps_elements: bool,
    /// Whether open amplifiers are ideal: the sum of their inputs is exactly 0.
    pub has_ideal_amplifiers: bool,
    /// Whether the inputs of squaring networks and logarithms count as within their range: above 0, or above the least
    /// value of a logarithm.
    pub stays_in_range: bool,
}

/// The equations of a program, and how they refer to it.
pub(crate) struct Wiring {
    /// The equations.
    pub system: System,
    /// The symbols of the states, in the order of the program.
    pub states: Vec<Symbol>,
    /// The quantity and the value per volt of every register with a name.
    pub names: HashMap<Register, Output>,
    /// The symbols of the delay lines, in the order of the program.
    pub delayed: Vec<Symbol>,
    /// The symbols of the sampled values, in the order of the program.
    pub sampled: Vec<Symbol>,
    /// The symbols of the levels, in the order of the program.
    pub levels: Vec<Symbol>,
    /// The parameters, in the order of the program.
    pub parameters: Vec<Symbol>,
    /// Problem time.
    pub time: Symbol,
}

/// The quantity at an output.
#[derive(Debug, Clone)]
pub(crate) struct Output {
    /// The quantity.
    pub symbol: Symbol,
    /// Its value at 1 V, in SI.
    pub per_volt: Fraction,
}

impl Output {
    /// The voltage as an expression of the quantity.
    pub(crate) fn volts(&self) -> Fraction {
        Fraction::symbol(self.symbol).over(&self.per_volt)
    }
}

/// Derives the equations of a program.
pub(crate) fn derive(circuit: &Circuit, program: &Program, options: Options) -> Wiring {
    let mut derivation = Derivation::new(circuit, program, options);
    derivation.name_outputs();
    derivation.body();
    derivation.finish()
}

/// Whether a parameter counts as never negative: so says its range, or its value if it has none. A value of 0 says
/// nothing about the sign of other values, but a range does.
pub(crate) fn is_nonnegative(parameter: &ParameterValue) -> bool {
    let least = least_value(parameter);
    least > 0.0 || (least == 0.0 && parameter.declared.range.is_some())
}

/// The least value of a parameter by its range, or its value if it has none.
fn least_value(parameter: &ParameterValue) -> f64 {
    parameter.declared.range.map_or(parameter.value, |(low, _)| low)
}

/// The symbol of pi, and a wiring with the symbols of pi, the parameters and the time, and with no laws.
fn without_laws(program: &Program) -> (Symbol, Wiring) {
    let mut symbols = Symbols::default();
    let entry =
        |name: &str, kind, dimension| SymbolEntry { name: name.to_owned(), primes: 0, kind, dimension };
    let pi = symbols.add_positive(entry("pi", SymbolKind::Pi, Dimension::NONE));
    let parameters = program.parameters().iter().enumerate().map(|(index, parameter)| {
        let declared = &parameter.declared;
        let entry = entry(&declared.name, SymbolKind::Parameter(index), declared.dimension);
        if least_value(parameter) > 0.0 {
            return symbols.add_positive(entry);
        }
        symbols.add(entry, is_nonnegative(parameter))
    });
    let parameters: Vec<Symbol> = parameters.collect();
    let time = symbols.add(entry("t", SymbolKind::Time, Dimension::TIME), true);
    let tables = tables(program);
    let wiring = Wiring {
        system: System { tables, ..System::without_laws(symbols) },
        states: Vec::new(),
        names: HashMap::new(),
        delayed: Vec::new(),
        sampled: Vec::new(),
        levels: Vec::new(),
        parameters,
        time,
    };
    (pi, wiring)
}

/// A derivation in progress.
struct Derivation<'a> {
    program: &'a Program,
    circuit: &'a Circuit,
    options: Options,
    wiring: Wiring,
    pi: Symbol,
    /// The coefficients as expressions of the parameters.
    coefficients: Vec<Fraction>,
    /// For outputs of amplifiers, the register before the limit.
    unlimited: HashMap<Register, Register>,
    /// The inputs of squaring networks and logarithms after the limit of their range.
    ranged: BTreeSet<Register>,
    /// The value of each register that was computed.
    values: Vec<Option<Fraction>>,
    /// Number in the name of the last intermediate quantity that was named because it is long.
    intermediates: usize,
}

impl<'a> Derivation<'a> {
    /// Adds the symbols of everything that has no voltage, and evaluates the prologue.
    fn new(circuit: &'a Circuit, program: &'a Program, options: Options) -> Self {
        let (pi, wiring) = without_laws(program);
        let mut derivation = Derivation {
            program,
            circuit,
            options,
            wiring,
            pi,
            coefficients: Vec::new(),
            unlimited: program.lamps().iter().map(|lamp| (lamp.output, lamp.demand)).collect(),
            ranged: ranged(program.body()),
            values: vec![None; program.body().len()],
            intermediates: 0,
        };
        derivation.coefficients = derivation.prologue();
        derivation
    }

    /// The coefficients as expressions of the parameters.
    fn prologue(&mut self) -> Vec<Fraction> {
        let mut registers: Vec<Fraction> = Vec::with_capacity(self.program.prologue().len());
        for op in self.program.prologue() {
            let value = self.operation(*op, false, &|register: Register| registers[register.index()].clone());
            registers.push(value);
        }
        let coefficients = self.program.coefficients().iter();
        coefficients.map(|coefficient| registers[coefficient.register.index()].clone()).collect()
    }

    /// Name and register of an element's output.
    fn output(&self, element: usize) -> (String, Register) {
        let output = &self.program.element_outputs()[element];
        (output.name.clone(), output.register)
    }

    /// Whether a register is the output of a drive.
    fn is_drive(&self, register: Register) -> bool {
        self.program.drive_registers().contains(&register)
    }

    /// Value of a signal at 1 V.
    fn per_volt(&self, signal: &SignalInfo) -> Fraction {
        signal.per_volt.map_or_else(|| Fraction::whole(1), |index| self.coefficients[index as usize].clone())
    }

    /// The value of a register that was computed before.
    fn value(&self, register: Register) -> Fraction {
        self.values[register.index()].clone().unwrap_or_default()
    }
}
