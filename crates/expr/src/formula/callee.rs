//! The functions that a formula can call.

use crate::function::Function;

/// A function that a formula can call.
///
/// # Examples
///
/// ```
/// use patchcord_expr::{Callee, Function};
///
/// assert_eq!(Callee::from_name("max"), Some(Callee::Maximum));
/// assert_eq!(Callee::Maximum.argument_count(), 2);
/// assert_eq!(Callee::Maximum.apply(2.0, 3.0), 3.0);
/// assert_eq!(Callee::from_name("sqrt"), Some(Callee::Function(Function::Sqrt)));
/// assert_eq!(Callee::from_name("Max"), None);
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Callee {
    /// A function that a machine element can compute as well.
    Function(Function),
    /// `min(a, b)`: the smaller of two numbers.
    Minimum,
    /// `max(a, b)`: the larger of two numbers.
    Maximum,
    /// `abs(a)`: the absolute value.
    Absolute,
}

impl Callee {
    /// Returns every callable function: all of [`Function`], then `min`, `max` and `abs`.
    pub fn all() -> impl Iterator<Item = Self> {
        Function::all().map(Self::Function).chain([Self::Minimum, Self::Maximum, Self::Absolute])
    }

    /// Returns the function with this name; `None` if there is none. Names are case-sensitive.
    pub fn from_name(name: &str) -> Option<Self> {
        Self::all().find(|callee| callee.name() == name)
    }

    /// Returns the name used in formulas.
    pub fn name(self) -> &'static str {
        match self {
            Self::Function(function) => function.name(),
            Self::Minimum => "min",
            Self::Maximum => "max",
            Self::Absolute => "abs",
        }
    }

    /// Returns the number of arguments: 1 or 2.
    pub fn argument_count(self) -> usize {
        match self {
            Self::Function(function) => function.argument_count(),
            Self::Minimum | Self::Maximum => 2,
            Self::Absolute => 1,
        }
    }

    /// Returns the value of the function. A function of one argument ignores `b`.
    ///
    /// The value is infinite or NaN if the arguments are outside the domain.
    pub fn apply(self, a: f64, b: f64) -> f64 {
        match self {
            Self::Function(function) => function.apply(a, b),
            Self::Minimum => a.min(b),
            Self::Maximum => a.max(b),
            Self::Absolute => a.abs(),
        }
    }

    /// Returns a sentence about the permitted arguments; `None` if all are permitted.
    pub(super) fn domain(self) -> Option<&'static str> {
        match self {
            Self::Function(function) => function.domain(),
            Self::Minimum | Self::Maximum | Self::Absolute => None,
        }
    }
}
