//! The values of constant expressions: coefficients, bounds, initial values and delays.

use std::f64::consts::PI;

use patchcord_core::circuit::Circuit;
use patchcord_expr::Scope as _;

use crate::symbolic::{Fraction, Symbol, SymbolEntry, SymbolKind, Symbols, Values, value};

/// The values of the symbols of constant expressions, in SI units.
#[derive(Debug, Clone)]
pub(crate) struct ConstantValues {
    /// The value of each symbol, by its index. NaN if the symbol is not constant in a run.
    values: Vec<f64>,
}

impl ConstantValues {
    /// The values of pi and of the parameters of a circuit, which are found by their names.
    pub(crate) fn new(symbols: &Symbols, circuit: &Circuit) -> Self {
        let value_of = |(_, entry): (Symbol, &SymbolEntry)| match entry.kind {
            SymbolKind::Pi => PI,
            SymbolKind::Parameter(_) => circuit.quantities().value(&entry.name).unwrap_or(f64::NAN),
            SymbolKind::Time | SymbolKind::Variable | SymbolKind::Held => f64::NAN,
        };
        ConstantValues { values: symbols.entries().map(value_of).collect() }
    }

    /// Sets the value of a symbol, which can be new.
    pub(crate) fn set(&mut self, symbol: Symbol, value: f64) {
        let index = symbol.index as usize;
        if index >= self.values.len() {
            self.values.resize(index + 1, f64::NAN);
        }
        self.values[index] = value;
    }

    /// The value of an expression in SI units. It is not finite if the expression has no value, and NaN if it contains a
    /// quantity that varies in a run.
    pub(crate) fn value(&self, expression: &Fraction) -> f64 {
        value(expression, self)
    }
}

impl Values for ConstantValues {
    fn symbol(&self, symbol: Symbol) -> f64 {
        self.values.get(symbol.index as usize).copied().unwrap_or(f64::NAN)
    }

    /// Constants contain no tables.
    fn table(&self, _table: u32, _at: f64) -> f64 {
        f64::NAN
    }

    fn slope(&self, _table: u32, _at: f64) -> f64 {
        f64::NAN
    }

    /// Constants contain no delays.
    fn delayed(&self, _expression: &Fraction, _time: f64) -> f64 {
        f64::NAN
    }
}

#[cfg(test)]
mod tests;
