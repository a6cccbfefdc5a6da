//! Symbols: the named quantities of expressions.

use std::collections::HashMap;

use patchcord_expr::Dimension;

/// A named quantity: a parameter, a variable, the time or pi. [`Symbols`] has its name.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub(crate) struct Symbol {
    /// The index in the table of symbols.
    pub index: u32,
    /// Whether the quantity is never negative. So it can be taken out of an absolute value.
    pub is_nonnegative: bool,
    /// Whether the quantity is always above 0. So it can be left out of a step.
    pub is_positive: bool,
    /// Whether the quantity is constant in a run. So it can be taken out of a delay.
    pub is_constant: bool,
}

/// What a symbol stands for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum SymbolKind {
    /// The number pi.
    Pi,
    /// Problem time in seconds.
    Time,
    /// A parameter of the patch, with its index.
    Parameter(usize),
    /// A quantity that varies in a run.
    Variable,
    /// A number that is constant within a step: a mode, a held value, noise or pulses.
    Held,
}

/// The entry of a symbol.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct SymbolEntry {
    /// The name without primes.
    pub name: String,
    /// The number of time derivatives.
    pub primes: u8,
    /// What it stands for.
    pub kind: SymbolKind,
    /// The dimension of its value; the value itself is in SI units.
    pub dimension: Dimension,
}

/// The table of all symbols. The order is that in which they appear in products.
#[derive(Debug, Clone, Default)]
pub(crate) struct Symbols {
    entries: Vec<SymbolEntry>,
    /// The symbol of each entry.
    symbols: Vec<Symbol>,
    /// The indices of the symbols with each name, in ascending order.
    by_name: HashMap<String, Vec<usize>>,
}

impl Symbols {
    /// Adds a symbol.
    pub(crate) fn add(&mut self, entry: SymbolEntry, is_nonnegative: bool) -> Symbol {
        let is_constant = matches!(entry.kind, SymbolKind::Pi | SymbolKind::Parameter(_));
        let index = self.entries.len() as u32;
        let symbol = Symbol { index, is_nonnegative, is_positive: false, is_constant };
        self.by_name.entry(entry.name.clone()).or_default().push(self.entries.len());
        self.entries.push(entry);
        self.symbols.push(symbol);
        symbol
    }

    /// Adds a symbol of a quantity that is always above 0.
    pub(crate) fn add_positive(&mut self, entry: SymbolEntry) -> Symbol {
        let symbol = Symbol { is_positive: true, ..self.add(entry, true) };
        self.symbols[symbol.index as usize] = symbol;
        symbol
    }

    /// Adds a variable of any sign.
    pub(crate) fn variable(&mut self, name: &str, primes: u8, dimension: Dimension) -> Symbol {
        let kind = SymbolKind::Variable;
        self.add(SymbolEntry { name: name.to_owned(), primes, kind, dimension }, false)
    }

    /// The derivative of a symbol with respect to time, which is added if it is new.
    pub(crate) fn derivative(&mut self, of: Symbol) -> Symbol {
        let SymbolEntry { name, primes, dimension, .. } = self.entry(of).clone();
        match self.find_variable(&name, primes + 1) {
            Some(known) => known,
            None => self.variable(&name, primes + 1, dimension.over(Dimension::TIME)),
        }
    }

    /// The first symbol with this name and number of primes. Pi, parameters and the time come before variables.
    pub(crate) fn find(&self, name: &str, primes: u8) -> Option<Symbol> {
        self.named(name).find(|(_, entry)| entry.primes == primes).map(|(symbol, _)| symbol)
    }

    /// The first variable with this name and number of primes. A parameter may have the same name.
    pub(crate) fn find_variable(&self, name: &str, primes: u8) -> Option<Symbol> {
        self.variables(name).find(|(_, entry)| entry.primes == primes).map(|(symbol, _)| symbol)
    }

    /// The symbols with a name, with their entries.
    fn named(&self, name: &str) -> impl Iterator<Item = (Symbol, &SymbolEntry)> {
        let indices = self.by_name.get(name).into_iter().flatten();
        indices.map(move |index| (self.symbols[*index], &self.entries[*index]))
    }

    /// The variables with a name, with their entries.
    fn variables(&self, name: &str) -> impl Iterator<Item = (Symbol, &SymbolEntry)> {
        self.named(name).filter(|(_, entry)| entry.kind == SymbolKind::Variable)
    }

    /// All symbols with their entries.
    pub(crate) fn entries(&self) -> impl Iterator<Item = (Symbol, &SymbolEntry)> {
        self.symbols.iter().copied().zip(&self.entries)
    }

    /// All symbols, in the order in which they were added.
    pub(crate) fn all(&self) -> impl Iterator<Item = Symbol> {
        self.symbols.iter().copied()
    }

    /// The entry of a symbol.
    pub(crate) fn entry(&self, symbol: Symbol) -> &SymbolEntry {
        &self.entries[symbol.index as usize]
    }

    /// Whether a symbol is a parameter.
    pub(crate) fn is_parameter(&self, symbol: Symbol) -> bool {
        matches!(self.entry(symbol).kind, SymbolKind::Parameter(_))
    }

    /// The index of the first variable with this name.
    pub(crate) fn first_of_name(&self, name: &str) -> Option<u32> {
        self.variables(name).next().map(|(symbol, _)| symbol.index)
    }
}
