//! The values of constants.

use std::f64::consts::PI;

use patchcord_core::circuit::Circuit;
use patchcord_core::patch::Patch;
use patchcord_expr::Dimension;

use super::ConstantValues;
use crate::symbolic::{Fraction, Symbol, SymbolEntry, SymbolKind, Symbols};

/// Adds a symbol with this name.
fn add(symbols: &mut Symbols, name: &str, kind: SymbolKind) -> Symbol {
    symbols.add(SymbolEntry { name: name.to_owned(), primes: 0, kind, dimension: Dimension::NONE }, true)
}

#[test]
fn constants_are_expressions_of_parameters_in_si_units() {
    let text = r#"{"patchcord": 1,
        "parameters": {"k": {"value": 40, "unit": "N/m"}, "d": {"value": 3, "unit": "mm"}},
        "scales": {"length": {"per_volt": 1, "unit": "m"}},
        "drives": {"u": {"kind": "step", "height": 1, "scale": "length"}}, "run": {"for": 1, "step": 0.01}}"#;
    let patch = Patch::parse("p.json", text).unwrap_or_else(|report| panic!("{report}"));
    let circuit = Circuit::new(&patch).unwrap_or_else(|report| panic!("{report}"));
    let mut symbols = Symbols::default();
    // The symbols have another order than the parameters.
    let d = add(&mut symbols, "d", SymbolKind::Parameter(1));
    let pi = add(&mut symbols, "pi", SymbolKind::Pi);
    let k = add(&mut symbols, "k", SymbolKind::Parameter(0));
    let x = add(&mut symbols, "x", SymbolKind::Variable);
    let mut values = ConstantValues::new(&symbols, &circuit);
    let [d, pi, k, x] = [d, pi, k, x].map(|symbol| (symbol, Fraction::symbol(symbol)));
    let found = values.value(&pi.1.times(&d.1).over(&k.1));
    assert!((found - PI * 3e-3 / 40.0).abs() < 1e-18, "{found}");
    assert!(values.value(&x.1).is_nan());
    values.set(x.0, 0.25);
    assert_eq!(values.value(&x.1), 0.25);
    let new = add(&mut symbols, "scale", SymbolKind::Variable);
    assert!(values.value(&Fraction::symbol(new)).is_nan());
    values.set(new, 5.0);
    assert_eq!(values.value(&Fraction::symbol(new).times(&x.1)), 1.25);
}
