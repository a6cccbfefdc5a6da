//! The names under which quantities are written: each has one meaning.
//!
//! Parameters have their own set of names, and so have signals, drives and elements. So a parameter and an output can
//! have the same name in a patch. In equations the output then has another name.

use std::collections::{BTreeMap, HashMap};

use super::Writer;
use crate::symbolic::{Symbol, SymbolEntry, SymbolKind, Symbols};

/// The written names of the symbols that do not keep their own, by the index of the symbol.
pub(super) fn other_names(symbols: &Symbols) -> BTreeMap<u32, String> {
    let mut owners: HashMap<&str, u8> = HashMap::new();
    for (_, entry) in symbols.entries() {
        let owner = owners.entry(&entry.name).or_insert_with(|| rank(entry));
        *owner = (*owner).min(rank(entry));
    }
    let others = symbols.entries().filter(|(_, entry)| owners[entry.name.as_str()] < rank(entry));
    let written = others.map(|(symbol, entry)| {
        let mut name =
            if entry.kind == SymbolKind::Time { "time".to_owned() } else { format!("{}_out", entry.name) };
        while owners.contains_key(name.as_str()) {
            name.push('_');
        }
        (symbol.index, name)
    });
    written.collect()
}

/// The rank of a quantity for its name. Of several quantities, the one with the lowest rank keeps it.
fn rank(entry: &SymbolEntry) -> u8 {
    match entry.kind {
        SymbolKind::Pi => 0,
        SymbolKind::Parameter(_) => 1,
        SymbolKind::Time => 2,
        SymbolKind::Variable => 3,
        SymbolKind::Held => 4,
    }
}

impl Writer<'_> {
    /// The written name of a quantity, without primes.
    pub(crate) fn written_name(&self, symbol: Symbol) -> &str {
        let own = || self.system.symbols.entry(symbol).name.as_str();
        self.other_names.get(&symbol.index).map_or_else(own, String::as_str)
    }
}
