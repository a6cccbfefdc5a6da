//! The values that a program gives to the symbols of a system at a place.

use std::collections::BTreeMap;

use patchcord_core::ir::{Program, Register};
use patchcord_core::low_discrepancy::golden_place;

use super::places::Place;
use crate::compare::points::ParameterValues;
use crate::derive::{LawKind, System, Wiring};
use crate::symbolic::{Fraction, Roots, Symbol, SymbolKind, Values, value};

/// A solution of a loop for ideal amplifiers differs from that of the program by at most this share of it, or by
/// [`MAX_VOLTS`].
const MAX_SHARE: f64 = 0.1;
/// The same in volts.
const MAX_VOLTS: f64 = 5.0;

/// The symbols of a system that are outputs or stored values of a program.
pub(super) struct Outputs {
    /// The outputs with a symbol, each with its register and its value at 1 V.
    named: Vec<(Symbol, Register, Fraction)>,
    /// The symbols of the states, in the order of the program.
    pub states: Vec<Symbol>,
    /// The symbols of the modes, in the order of the program.
    modes: Vec<Symbol>,
    /// The symbols of the sampled values, in the order of the program.
    sampled: Vec<Symbol>,
}

impl Outputs {
    /// The outputs of a wiring.
    pub(super) fn new(wiring: &Wiring) -> Self {
        let named = wiring.names.iter();
        let named = named.map(|(register, output)| (output.symbol, *register, output.per_volt.clone()));
        let mut named: Vec<_> = named.collect();
        named.sort_by_key(|(_, register, _)| *register);
        let modes = wiring.system.modes.iter().map(|mode| mode.symbol).collect();
        Outputs { named, states: wiring.states.clone(), modes, sampled: wiring.sampled.clone() }
    }
}

/// The values of all symbols of a system at a place.
pub(super) struct Known<'a> {
    system: &'a System,
    program: &'a Program,
    parameters: ParameterValues,
    time: f64,
    /// The values in SI, by the index of the symbol.
    values: BTreeMap<u32, f64>,
    /// The values of outputs at 1 V, by the index of the symbol.
    per_volt: BTreeMap<u32, f64>,
}

impl<'a> Known<'a> {
    /// The values at a place, for these values of the parameters. The voltages are those for the present ones.
    pub(super) fn new(
        (system, program): (&'a System, &'a Program),
        outputs: &Outputs,
        place: &Place,
        parameters: ParameterValues,
    ) -> Self {
        let (values, per_volt) = (BTreeMap::new(), BTreeMap::new());
        let mut known = Known { system, program, parameters, time: place.point.time, values, per_volt };
        for (symbol, register, at_1_volt) in &outputs.named {
            let at_1_volt = value(at_1_volt, &known);
            known.per_volt.insert(symbol.index, at_1_volt);
            known.values.insert(symbol.index, at_1_volt * place.voltages[register.index()]);
        }
        let modes = outputs.modes.iter().zip(&place.point.modes);
        let sampled = outputs.sampled.iter().zip(&place.point.sampled);
        known.values.extend(modes.chain(sampled).map(|(symbol, value)| (symbol.index, *value)));
        known
    }

    /// Replaces the values of quantities that loops determine by those at which the inputs of the amplifiers cancel
    /// exactly, and adds those of their derivatives. `None` if there are none near the present values.
    pub(super) fn solve(&mut self, loops: &[Roots]) -> Option<()> {
        for roots in loops {
            let present = |symbol: &Symbol| self.values.get(&symbol.index).copied();
            let start: Vec<Option<f64>> = roots.unknowns().iter().map(present).collect();
            let begin = start.iter().map(|value| value.unwrap_or(0.0)).collect();
            let found = roots.near(begin, &*self)?;
            if !roots.is_regular(&found, &*self) {
                return None;
            }
            for ((symbol, start), found) in roots.unknowns().iter().zip(start).zip(found) {
                let at_1_volt = self.per_volt.get(&symbol.index).copied().unwrap_or_default();
                let is_far = |start: f64| {
                    (found - start).abs() > MAX_SHARE * start.abs() + MAX_VOLTS * at_1_volt.abs()
                };
                if start.is_some_and(is_far) {
                    return None;
                }
                self.values.insert(symbol.index, found);
            }
        }
        Some(())
    }

    /// The value of an output at 1 V. `None` if the symbol is that of no output.
    pub(super) fn per_volt(&self, symbol: Symbol) -> Option<f64> {
        self.per_volt.get(&symbol.index).copied()
    }

    /// A value for the derivative of a drive. Any is right, because drives are arbitrary functions of time. NaN for other
    /// quantities.
    fn derivative_of_drive(&self, symbol: Symbol) -> f64 {
        let entry = self.system.symbols.entry(symbol);
        let drive = self.system.symbols.find_variable(&entry.name, 0);
        let is_drive = drive.is_some_and(|drive| matches!(self.system.law(drive), Some(LawKind::Drive(_))));
        if !is_drive || entry.primes == 0 {
            return f64::NAN;
        }
        let volts = drive.and_then(|drive| self.per_volt.get(&drive.index)).copied().unwrap_or(f64::NAN);
        volts * (2.0 * golden_place(u64::from(symbol.index)) - 1.0)
    }
}

impl Values for Known<'_> {
    fn symbol(&self, symbol: Symbol) -> f64 {
        match self.system.symbols.entry(symbol).kind {
            SymbolKind::Pi => std::f64::consts::PI,
            SymbolKind::Parameter(index) => self.parameters.value(self.program, index),
            SymbolKind::Time => self.time,
            SymbolKind::Variable | SymbolKind::Held => {
                let known = self.values.get(&symbol.index).copied();
                known.unwrap_or_else(|| self.derivative_of_drive(symbol))
            }
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
