//! The numbers that the prologue works out for the body, and what they may be.

use super::{Program, Register};
use crate::document::{Span, outside, told};

/// A number that the prologue works out for the body.
#[derive(Debug, Clone)]
pub struct Coefficient {
    /// Where the prologue leaves it.
    pub(crate) register: Register,
    /// Whose it is, for messages: "PC5 setting".
    pub label: String,
    /// Least and largest value allowed.
    pub range: (f64, f64),
    /// Whether only whole numbers are allowed.
    pub whole: bool,
    /// Where the patch speaks of it.
    pub(crate) span: Option<Span>,
}

/// How a coefficient must stand to another of its element.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Order {
    /// Index of the coefficient.
    pub of: u32,
    pub relation: Relation,
    /// Index of the other.
    pub to: u32,
}

/// How one number must stand to another.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Relation {
    Below,
    AtLeast,
    AtMost,
}

/// A coefficient that cannot be used, with its value.
pub(crate) struct Unfit<'a> {
    pub coefficient: &'a Coefficient,
    pub value: f64,
    pub fault: SettingFault,
}

/// The rule that the value of a setting breaks.
#[derive(Debug, Clone, PartialEq)]
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
    /// How a number stands to another where it must not.
    fn broken(self, value: f64, other: f64) -> Option<&'static str> {
        let (is_kept, told) = match self {
            Relation::Below => (value < other, "not below"),
            Relation::AtLeast => (value >= other, "below"),
            Relation::AtMost => (value <= other, "above"),
        };
        (!is_kept).then_some(told)
    }
}

impl Coefficient {
    fn fault(&self, value: f64) -> Option<SettingFault> {
        let (low, high) = self.range;
        if !(value.is_finite() && low <= value && value <= high) {
            return Some(SettingFault::Range { low, high });
        }
        (self.whole && value.fract() != 0.0).then_some(SettingFault::NotWhole)
    }
}

impl SettingFault {
    /// A phrase that follows the value in a message, such as "outside 0 ... 1".
    pub fn describe(&self, value: f64) -> String {
        match self {
            SettingFault::Range { low, high } => outside(value, (*low, *high), ""),
            SettingFault::NotWhole => "and must be a whole number".to_owned(),
            SettingFault::Order { relation, other, limit } => {
                format!("{relation} {other} at {}", told(*limit))
            }
        }
    }
}

impl Program {
    /// The first coefficient that is not what it may be.
    pub(crate) fn first_unfit(&self, values: &[f64]) -> Option<Unfit<'_>> {
        let alone = self.coefficients.iter().zip(values).find_map(|(coefficient, value)| {
            Some(Unfit { coefficient, value: *value, fault: coefficient.fault(*value)? })
        });
        alone.or_else(|| self.orders.iter().find_map(|order| self.disorder(*order, values)))
    }

    fn disorder(&self, order: Order, values: &[f64]) -> Option<Unfit<'_>> {
        let [of, to] = [order.of, order.to].map(|index| index as usize);
        let (value, limit) = (values[of], values[to]);
        let relation = order.relation.broken(value, limit)?;
        let fault = SettingFault::Order { relation, other: self.coefficients[to].label.clone(), limit };
        Some(Unfit { coefficient: &self.coefficients[of], value, fault })
    }
}
