//! Unit tests of the writer, and the quantities that they write.

mod conditions;
mod random_trees;
mod sums;
mod units;

use patchcord_expr::{Dimension, Unit, split_primes};

use super::{Purity, Writer};
use crate::derive::{ModeLaw, System};
use crate::notation::text;
use crate::symbolic::{Fraction, Symbol, SymbolEntry, SymbolKind, Symbols};
use crate::testing::reading::read_with;

/// The parameters with their units, in the order in which they are written. All of them are always above 0.
const PARAMETERS: [(&str, &str); 13] = [
    ("sigma", "1"),
    ("mu", "1"),
    ("F", "N"),
    ("m", "kg"),
    ("k", "N/m"),
    ("c", "N s/m"),
    ("VcL", "m/s"),
    ("Tc", "s"),
    ("Fs", "N"),
    ("a", "1"),
    ("q", "1"),
    ("g", "m/s2"),
    ("w", "m"),
];

/// The variables with their units.
const VARIABLES: [(&str, &str); 8] =
    [("x", "m"), ("y", "m"), ("z", "m"), ("v", "m/s"), ("u", "1"), ("pump", "1"), ("h", "m"), ("x'", "m/s")];

/// A system with the quantities of the tests. The position of the relay R is a mode. The parameter b can have any sign,
/// and the parameter share can be 0.
struct Fixture {
    system: System,
}

impl Fixture {
    fn new() -> Self {
        let mut fixture = Fixture { system: System::without_laws(Symbols::default()) };
        fixture.add("pi", "1", SymbolKind::Pi, true);
        for (index, (name, unit)) in PARAMETERS.into_iter().enumerate() {
            fixture.add(name, unit, SymbolKind::Parameter(index), true);
        }
        fixture.add("b", "1", SymbolKind::Parameter(PARAMETERS.len()), false);
        let share = entry("share", "1", SymbolKind::Parameter(PARAMETERS.len() + 1));
        fixture.system.symbols.add(share, true);
        fixture.add("t", "s", SymbolKind::Time, true);
        for (name, unit) in VARIABLES {
            fixture.add(name, unit, SymbolKind::Variable, false);
        }
        let symbol = fixture.add("relay", "1", SymbolKind::Held, false);
        fixture.system.modes.push(ModeLaw {
            symbol,
            element: "R".to_owned(),
            noun: "position",
            values: &[(0.0, "released"), (1.0, "pulled in")],
            initial: 0.0,
            transitions: Vec::new(),
        });
        fixture
    }

    /// Adds a quantity of any sign, or one that is always above 0.
    fn add(&mut self, text: &str, unit: &str, kind: SymbolKind, is_positive: bool) -> Symbol {
        let entry = entry(text, unit, kind);
        let symbols = &mut self.system.symbols;
        if is_positive { symbols.add_positive(entry) } else { symbols.add(entry, false) }
    }

    /// Reads an expression.
    fn read(&self, text: &str) -> Fraction {
        let symbol = |text: &str| {
            let (name, primes) = name_and_primes(text);
            let found = self.system.symbols.find(name, primes);
            found.unwrap_or_else(|| panic!("{text} is no quantity of the tests"))
        };
        read_with(text, &symbol)
    }

    /// A writer of the system.
    fn writer(&self, purity: Purity) -> Writer<'_> {
        Writer::with_purity(&self.system, purity)
    }

    /// An expression of this unit as text.
    fn written(&self, purity: Purity, expression: &str, unit: &str) -> String {
        text(&self.writer(purity).expression(&self.read(expression), Some(dimension(unit))))
    }
}

/// The entry of a quantity. The primes after its name are derivatives.
fn entry(text: &str, unit: &str, kind: SymbolKind) -> SymbolEntry {
    let (name, primes) = name_and_primes(text);
    SymbolEntry { name: name.to_owned(), primes, kind, dimension: dimension(unit) }
}

/// The name of a quantity and its number of primes.
fn name_and_primes(text: &str) -> (&str, u8) {
    let (name, primes) = split_primes(text);
    (name, u8::try_from(primes).unwrap())
}

/// The dimension of a unit.
fn dimension(unit: &str) -> Dimension {
    Unit::parse(unit).unwrap().dimension()
}

/// Asserts how expressions without units are written.
fn check(cases: &[(&str, &str)]) {
    let fixture = Fixture::new();
    for (expression, expected) in cases {
        assert_eq!(fixture.written(Purity::All, expression, "1"), *expected, "{expression}");
    }
}

/// Asserts that expressions are written as they are read.
fn check_unchanged(expressions: &[&str]) {
    let cases: Vec<(&str, &str)> = expressions.iter().map(|expression| (*expression, *expression)).collect();
    check(&cases);
}
