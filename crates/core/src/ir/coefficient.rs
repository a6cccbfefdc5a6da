//! Coefficients: the numbers that the prologue computes for the body, and their permitted values.
//!
//! Coefficients come from formulas of parameters, so their values are known only when a run sets the parameters. The
//! checks here run before every run and again after every change of parameters.

use super::{Program, Register};
use crate::document::{Span, format_distinct, format_outside, range_violation};

/// A number that the prologue computes for the body, such as a setting in volts.
#[derive(Debug, Clone)]
pub struct Coefficient {
    /// The register of the prologue that contains it.
    pub register: Register,
    /// Its element and setting, for messages: "PC5 setting".
    pub label: String,
    /// Least and largest permitted value.
    pub range: (f64, f64),
    /// Whether only whole numbers are permitted.
    pub is_whole: bool,
    /// The position in the patch to which messages refer.
    pub(crate) span: Option<Span>,
}

/// A required order of two settings of one element, such as a lower below an upper limit.
#[derive(Debug, Clone, Copy)]
pub(crate) struct SettingOrder {
    /// Index of the coefficient.
    pub of: u32,
    /// The required order.
    pub relation: Relation,
    /// Index of the other coefficient.
    pub to: u32,
}

/// The required order of two numbers.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Relation {
    /// The first number must be less than the second.
    Below,
    /// The first number must not be less than the second.
    AtLeast,
    /// The first number must not be greater than the second.
    AtMost,
}

/// A coefficient with an invalid value.
pub(crate) struct InvalidCoefficient<'a> {
    /// The coefficient, with its label and its position in the patch.
    pub coefficient: &'a Coefficient,
    /// Its value in this run.
    pub value: f64,
    /// The rule that the value breaks.
    pub fault: SettingFault,
}

/// The rule that the value of a setting breaks.
///
/// # Examples
///
/// ```
/// use patchcord_core::ir::SettingFault;
///
/// assert_eq!(SettingFault::Range { low: 0.0, high: 1.0 }.describe(2.0), "outside 0 ... 1");
/// assert_eq!(SettingFault::NotWhole.describe(1.5), "and must be a whole number");
/// let order = SettingFault::Order { relation: "not below", other: "R pull_in".to_owned(), limit: 5.0 };
/// assert_eq!(order.describe(6.0), "not below R pull_in at 5");
/// ```
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum SettingFault {
    /// The value is outside its range, or not finite.
    Range {
        /// Least value allowed.
        low: f64,
        /// Largest value allowed.
        high: f64,
    },
    /// The value must be a whole number.
    NotWhole,
    /// The value is in the wrong order with another setting of the element.
    Order {
        /// The relation that was found: "not below", "below" or "above".
        relation: &'static str,
        /// The other setting, such as "R pull_in".
        other: String,
        /// Value of the other setting.
        limit: f64,
    },
}

impl Relation {
    /// The actual order in words if it violates the required one, otherwise `None`.
    fn violation(self, value: f64, other: f64) -> Option<&'static str> {
        let (is_satisfied, text) = match self {
            Relation::Below => (value < other, "not below"),
            Relation::AtLeast => (value >= other, "below"),
            Relation::AtMost => (value <= other, "above"),
        };
        (!is_satisfied).then_some(text)
    }
}

impl Coefficient {
    /// The rule that a value breaks by itself; `None` if it is valid.
    fn fault(&self, value: f64) -> Option<SettingFault> {
        let (low, high) = self.range;
        if !(value.is_finite() && low <= value && value <= high) {
            return Some(SettingFault::Range { low, high });
        }
        (self.is_whole && value.fract() != 0.0).then_some(SettingFault::NotWhole)
    }
}

impl SettingFault {
    /// A phrase that follows the value in a message, such as "outside 0 ... 1".
    pub fn describe(&self, value: f64) -> String {
        match self {
            SettingFault::Range { low, high } => range_violation(value, (*low, *high), ""),
            SettingFault::NotWhole => "and must be a whole number".to_owned(),
            SettingFault::Order { relation, other, limit } => {
                format!("{relation} {other} at {}", format_distinct(*limit, value))
            }
        }
    }

    /// The value in a message, with as many digits as it needs to break the rule.
    pub(crate) fn value_text(&self, value: f64) -> String {
        match self {
            SettingFault::Range { low, high } => format_outside(value, (*low, *high)),
            SettingFault::NotWhole => format_distinct(value, value.round()),
            SettingFault::Order { limit, .. } => format_distinct(value, *limit),
        }
    }
}

impl Program {
    /// The first coefficient that is out of range or violates a required order; `None` if all are valid.
    pub(crate) fn first_invalid_coefficient(&self, values: &[f64]) -> Option<InvalidCoefficient<'_>> {
        let alone = self.lowered.coefficients.iter().zip(values).find_map(|(coefficient, value)| {
            Some(InvalidCoefficient { coefficient, value: *value, fault: coefficient.fault(*value)? })
        });
        alone.or_else(|| self.lowered.orders.iter().find_map(|order| self.order_violation(*order, values)))
    }

    /// The violation of a required order; `None` if the order is satisfied.
    fn order_violation(&self, order: SettingOrder, values: &[f64]) -> Option<InvalidCoefficient<'_>> {
        let [of, to] = [order.of, order.to].map(|index| index as usize);
        let (value, limit) = (values[of], values[to]);
        let relation = order.relation.violation(value, limit)?;
        let fault =
            SettingFault::Order { relation, other: self.lowered.coefficients[to].label.clone(), limit };
        Some(InvalidCoefficient { coefficient: &self.lowered.coefficients[of], value, fault })
    }
}
