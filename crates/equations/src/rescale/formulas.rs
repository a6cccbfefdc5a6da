//! Changes numbers and formulas of the document so that they have wanted values under the new scales.
//!
//! A formula of scales often has the wanted value as it is. Otherwise a number in it changes. If that is right for the
//! present values of the parameters only, the names of the scales are multiplied so that they mean the old scales.

use std::collections::BTreeMap;

use patchcord_core::circuit::Circuit;
use patchcord_core::document::TIME_SCALE;
use patchcord_expr::{Expression, Formula, format_significant};
use serde_json::{Value, json};

use super::values::{PointValues, Values, agree, ratio};
use crate::fixes::{Product, named_nodes};

/// A ratio that differs from 1 by at most this is 1.
const ROUNDING: f64 = 1e-13;
/// A logarithm that differs from a whole number by at most this is whole.
const WHOLE: f64 = 1e-11;
/// Significant digits of a factor in a formula.
const DIGITS: usize = 14;

/// What a number or formula of the document becomes.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Retuned {
    /// It has the wanted values as it is.
    Same,
    /// It becomes this.
    Changed(Value),
    /// No change of it that is known has the wanted values.
    Impossible,
}

/// The context in which the numbers and formulas of one element are changed.
pub(super) struct Retuning<'r> {
    pub circuit: &'r Circuit,
    /// The values under the new scales.
    pub new: &'r Values<'r>,
    /// The value of one volt of each scale before, as a multiple of the new one.
    pub scale_factors: &'r BTreeMap<String, f64>,
    /// Whether the value contains the time scale as a divisor (true) or as a factor (false), if the time scale changes.
    /// `None` if it does not depend on it.
    pub time_divides: Option<bool>,
    /// The instance of the macro that contains the element. `None` outside of macros.
    pub instance: Option<&'r str>,
}

impl Retuning<'_> {
    /// Changes a number or formula so that it has the wanted values.
    pub(super) fn retuned(&self, written: &Value, wanted: &PointValues) -> Retuned {
        if let Some(changed) = self.with_time_scale(written, wanted) {
            return Retuned::Changed(changed);
        }
        match self.values(written) {
            Some(now) if agree(&now, wanted) => return Retuned::Same,
            Some(_) => (),
            None => return Retuned::Impossible,
        }
        let changed = Product::new(written).and_then(|product| self.tuned(&product, wanted));
        let changed = changed.or_else(|| {
            let restored = restored(written.as_str()?, self.scale_factors)?;
            self.tuned(&Product::new(&json!(restored))?, wanted)
        });
        changed.map_or(Retuned::Impossible, Retuned::Changed)
    }

    /// The values of a number or formula of the document. `None` if it is neither.
    fn values(&self, written: &Value) -> Option<PointValues> {
        let formula = match written {
            Value::String(text) => Formula::parse(text).ok()?,
            other => Formula::constant(other.as_f64()?),
        };
        // Inside a macro, a formula can name the settings of the instance.
        let inner = |name: &str| {
            let inner = format!("{}.{name}", self.instance?);
            self.circuit.derived_index(&inner).map(|_| inner)
        };
        Some(self.new.all(&formula.renamed(&inner)))
    }

    /// A product times the number that gives it the wanted values. `None` if there is none.
    fn tuned(&self, product: &Product, wanted: &PointValues) -> Option<Value> {
        let ratio = ratio(wanted, &self.values(&product.value())?)?;
        let is_one = (ratio - 1.0).abs() <= ROUNDING;
        let changed = if is_one { product.value() } else { product.times_precisely(ratio).value() };
        agree(&self.values(&changed)?, wanted).then_some(changed)
    }

    /// A formula with the name of the time scale, if the time scale was 1 and changes. Another factor can only be a power
    /// of ten, for another gain. `None` if there is no such formula, and if a pot that is a number stays a short one.
    fn with_time_scale(&self, written: &Value, wanted: &PointValues) -> Option<Value> {
        let divides = self.time_divides?;
        let product = Product::new(written)?;
        let is_short = || self.tuned(&product, wanted).is_none_or(|value| value.is_number());
        if self.circuit.time_scale() != 1.0 || (written.is_number() && (!divides || is_short())) {
            return None;
        }
        let named = product.times_name(TIME_SCALE, divides);
        let decades = ratio(wanted, &self.values(&named.value())?)?.log10();
        let is_power = (decades - decades.round()).abs() <= WHOLE;
        is_power.then(|| self.tuned(&named, wanted)).flatten()
    }
}

/// A formula in which every scale is multiplied by its factor, so that it means the old scale. `None` if the text is no
/// formula.
fn restored(text: &str, factors: &BTreeMap<String, f64>) -> Option<String> {
    let formula = Formula::parse(text).ok()?;
    let mut changed = formula.text().to_owned();
    // From right to left, so that the places of the other names stay.
    for node in named_nodes(formula.root()).into_iter().rev() {
        let Expression::Name(name) = &node.expression else { continue };
        if let Some(factor) = factors.get(name).filter(|factor| (**factor - 1.0).abs() > ROUNDING) {
            let old = format!("({name} * {})", format_significant(*factor, DIGITS));
            changed.replace_range(node.range.clone(), &old);
        }
    }
    Some(changed)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn scales_in_a_formula_mean_the_old_ones() {
        let factors = [("force", 2.0), ("e", 0.5), ("same", 1.0)];
        let factors = BTreeMap::from(factors.map(|(name, factor)| (name.to_owned(), factor)));
        let cases = [
            ("Fs / (Fs + 50 * force)", "Fs / (Fs + 50 * (force * 2))"),
            ("1e3 * e + 2.5e-3*force2", "1e3 * (e * 0.5) + 2.5e-3*force2"),
            ("same^2 / force", "same^2 / (force * 2)"),
            ("-(force) / sqrt(e)", "-(force * 2) / sqrt((e * 0.5))"),
        ];
        for (text, expected) in cases {
            assert_eq!(restored(text, &factors).as_deref(), Some(expected));
        }
        assert_eq!(restored("2 *", &factors), None);
    }
}
