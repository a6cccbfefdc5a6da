//! Remarks: what is not an equation.

use patchcord_expr::Dimension;

use super::lister::Lister;
use crate::derive::{Law, Source};
use crate::notation::{Notation, escaped, latex, text};
use crate::symbolic::{Fraction, Symbol, SymbolEntry, SymbolKind};

/// A statement that is not an equation, such as the meaning of a name.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Remark {
    /// The statement as plain text.
    pub text: String,
    /// The statement for a text in LaTeX.
    pub latex: String,
}

impl Remark {
    /// A remark on expressions. `write` returns it with the texts of the expressions.
    fn new<const N: usize>(expressions: &[Notation; N], write: impl Fn([String; N]) -> String) -> Self {
        let formula = |notation: &Notation| format!("${}$", latex(notation));
        Remark {
            text: write(expressions.each_ref().map(text)),
            latex: write(expressions.each_ref().map(formula)),
        }
    }
}

impl Lister<'_> {
    /// A remark on a source.
    pub(super) fn source(&self, of: Symbol, source: &Source) -> Remark {
        let name = self.writer.name(of);
        match source {
            Source::Noise => Remark::new(&[name], |[name]| {
                format!("{name}: random numbers with mean 0 and variance 1, each constant for a time")
            }),
            Source::Steps(table) => {
                let table = Notation::Name { name: self.writer.table_name(*table as u32), primes: 0 };
                Remark::new(&[name, table], |[name, table]| {
                    format!("{name}: the last value of {table} at or before t")
                })
            }
            Source::Pulses(value) => {
                let value = self.writer.expression(value, Some(Dimension::NONE));
                Remark::new(&[name, value], |[name, value]| format!("{name} = {value}"))
            }
        }
    }

    /// A remark on a value that is stored at the end of each step.
    pub(super) fn stored(&self, of: Symbol, next: &Fraction) -> Remark {
        let next = self.writer.expression(next, Some(Dimension::VOLTAGE));
        Remark::new(&[self.writer.name(of), next], |[name, next]| {
            format!("{name}: the value of {next} an instant before")
        })
    }

    /// Remarks on the quantities that are not written under their own names.
    pub(super) fn other_names(&self) -> Vec<Remark> {
        let symbols = &self.system.symbols;
        let is_listed = |entry: &SymbolEntry| {
            let is_own = |law: &Law| symbols.entry(law.of).name == entry.name;
            entry.kind == SymbolKind::Time || (entry.primes == 0 && self.system.laws.iter().any(is_own))
        };
        let others = symbols
            .entries()
            .filter(|(symbol, entry)| self.writer.written_name(*symbol) != entry.name && is_listed(entry));
        others.map(|(symbol, entry)| self.other_name(symbol, entry)).collect()
    }

    /// A remark on a quantity that is not written under its own name.
    fn other_name(&self, symbol: Symbol, entry: &SymbolEntry) -> Remark {
        let owner = if entry.name == "pi" { "a number" } else { "a parameter" };
        let meaning = |name: &str| format!("is {} {name}, because {name} is {owner}", self.noun(entry));
        let written = self.writer.name(symbol);
        Remark {
            text: format!("{} {}", text(&written), meaning(&entry.name)),
            latex: format!("${}$ {}", latex(&written), meaning(&escaped(&entry.name))),
        }
    }

    /// What a quantity is, with its article.
    fn noun(&self, entry: &SymbolEntry) -> &'static str {
        match entry.kind {
            SymbolKind::Time => "the time",
            _ if self.patch.signals.contains_key(&entry.name) => "the signal",
            _ if self.patch.drives.contains_key(&entry.name) => "the drive",
            _ => "the output of the element",
        }
    }
}
