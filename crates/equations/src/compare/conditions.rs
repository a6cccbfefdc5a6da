//! The conditions under which an equation holds.

use std::collections::HashSet;

use patchcord_expr::Equation;

use super::comparison::Comparison;
use crate::derive::LawKind;
use crate::symbolic::{Application, Atom, Fraction, absolute};
use crate::writing::Writer;

impl Comparison<'_> {
    /// The conditions under which the inputs of the squaring networks and logarithms behind an equation are within their
    /// range.
    pub(super) fn range_conditions(&mut self, equation: &Equation) -> Vec<String> {
        let none = HashSet::new();
        let names: Vec<String> = equation.names().into_iter().map(str::to_owned).collect();
        let quantities: Vec<Fraction> =
            names.iter().filter_map(|name| self.model.named(name, &none).ok()).collect();
        let mut inputs = self.model.system.margins.clone();
        inputs.iter_mut().for_each(|input| *input = self.model.expanded_fraction(input, &none));
        // An input matters if the absolute value of it remains in a quantity.
        inputs.retain(|input| !input.is_nonnegative());
        inputs.retain(|input| quantities.iter().any(|quantity| has_absolute_value_of(quantity, input)));
        let writer = Writer::new(self.circuit, &self.model.system);
        let mut conditions: Vec<String> =
            inputs.iter().map(|input| writer.condition_text(input, false)).collect();
        conditions.dedup();
        conditions
    }

    /// The conditions under which the integrators, whose rates the last comparison has used, are within their limits. At a
    /// limit the rate is 0 while it points outward.
    pub(super) fn limit_conditions(&mut self) -> Vec<String> {
        let mut margins = Vec::new();
        for symbol in &self.model.limited {
            let Some(LawKind::State { limits: [lower, upper], .. }) = self.model.system.law(*symbol) else {
                continue;
            };
            let state = Fraction::symbol(*symbol);
            margins.extend(lower.iter().map(|lower| state.minus(lower)));
            margins.extend(upper.iter().map(|upper| upper.minus(&state)));
        }
        if margins.is_empty() {
            return Vec::new();
        }
        let none = HashSet::new();
        margins.iter_mut().for_each(|margin| *margin = self.model.expanded_fraction(margin, &none));
        let writer = Writer::new(self.circuit, &self.model.system);
        margins.iter().map(|margin| writer.condition_text(margin, true)).collect()
    }
}

/// Whether an expression contains the absolute value of another one, but for a positive factor.
fn has_absolute_value_of(value: &Fraction, inside: &Fraction) -> bool {
    let size = absolute(inside);
    let Some((product, _)) = size.numerator().as_term() else { return false };
    let inside = product.factors().iter().filter_map(|(atom, _)| match atom {
        Atom::Symbol(_) => None,
        Atom::Apply(applied) => Some(applied.as_ref()),
    });
    let functions: Vec<&Application> = inside.collect();
    !value.functions_with(&|function| functions.contains(&function)).is_empty()
}
