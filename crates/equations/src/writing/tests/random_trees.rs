//! Random expressions keep their values when they are written.

use patchcord_expr::Dimension;
use proptest::array::uniform3;
use proptest::prelude::*;

use super::{Purity, Writer};
use crate::derive::System;
use crate::notation::text;
use crate::symbolic::{Fraction, SymbolEntry, SymbolKind, Symbols, value};
use crate::testing::reading::read;
use crate::testing::trees::{continuous, point};
use crate::testing::{QUANTITIES, symbol};
use crate::writing::maxima::with_maxima;

/// The quantities of random trees.
fn symbols() -> Symbols {
    let mut symbols = Symbols::default();
    for (index, name) in QUANTITIES.into_iter().enumerate() {
        let is_nonnegative = symbol(name).is_nonnegative;
        let kind = if is_nonnegative { SymbolKind::Parameter(index) } else { SymbolKind::Variable };
        let entry = SymbolEntry { name: name.to_owned(), primes: 0, kind, dimension: Dimension::NONE };
        symbols.add(entry, is_nonnegative);
    }
    symbols
}

proptest! {
    #[test]
    fn a_text_has_the_value_of_its_expression(tree in continuous(3), points in uniform3(point())) {
        let system = System::without_laws(symbols());
        let writer = Writer::with_purity(&system, Purity::All);
        let written = text(&writer.expression(&tree.fraction(), Some(Dimension::NONE)));
        // An equation has at most 2000 bytes.
        prop_assume!(written.len() < 1990);
        let fraction = read(&written);
        for point in points {
            let Some(expected) = tree.measured(&point) else { continue };
            let found = value(&fraction, &point);
            prop_assert!(expected.is_near(found), "{written}: {found}, not {expected:?}");
        }
    }

    #[test]
    fn minima_and_maxima_have_the_value_of_the_absolute_values(
        tree in continuous(3), points in uniform3(point()),
    ) {
        let fraction = tree.fraction();
        prop_assert_eq!(fraction.divisors().len(), 0);
        let written = Fraction::from(with_maxima(fraction.numerator()));
        for point in points {
            let Some(expected) = tree.measured(&point) else { continue };
            let found = value(&written, &point);
            prop_assert!(expected.is_near(found), "{written:?}: {found}, not {expected:?}");
        }
    }
}
