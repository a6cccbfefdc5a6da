//! Mathematical functions of one or two numbers, shared by formulas and machine elements.
//!
//! Each function is one row of `table`: its name, its value, its derivatives and the places of its
//! extreme values. The values come from the `libm` crate, never from the platform's library, so that
//! every machine computes the same bits.

mod table;

use std::f64::consts::TAU;

use table::{Extrema, FunctionRow, Steepest, TABLE};

/// A function of one or two numbers.
///
/// All values come from one software library, so that every machine computes the same bits. The
/// square root comes from the processor, where it is exact by IEEE 754.
///
/// # Examples
///
/// ```
/// use patchcord_expr::Function;
///
/// assert_eq!(Function::from_name("sqrt"), Some(Function::Sqrt));
/// assert_eq!(Function::Sqrt.apply(9.0, 0.0), 3.0);
/// assert_eq!(Function::Sqrt.domain(), Some("sqrt needs 0 or more"));
/// assert!(Function::Sqrt.apply(-1.0, 0.0).is_nan());
/// assert_eq!(Function::Power.argument_count(), 2);
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Function {
    /// The square root.
    Sqrt,
    /// The sine of an angle in radians.
    Sin,
    /// The cosine of an angle in radians.
    Cos,
    /// The tangent of an angle in radians.
    Tan,
    /// The arc tangent, in radians between -pi/2 and pi/2.
    Atan,
    /// The angle of the point (second argument, first argument), in radians between -pi and pi.
    Atan2,
    /// The exponential function.
    Exp,
    /// 10 to the power of the argument.
    Exp10,
    /// The natural logarithm.
    Ln,
    /// The logarithm to base 10.
    Log10,
    /// The hyperbolic tangent.
    Tanh,
    /// The first argument raised to the power of the second.
    Power,
    /// The largest whole number that is at most the argument.
    Floor,
}

/// Whether the angle plus some number of whole turns is within the bounds.
fn is_angle_within(angle: f64, bounds: (f64, f64)) -> bool {
    let turns = libm::ceil((bounds.0 - angle) / TAU);
    angle + turns * TAU <= bounds.1
}

impl Function {
    /// Returns every function, in the order of the enumeration.
    pub fn all() -> impl Iterator<Item = Self> {
        TABLE.iter().map(|entry| entry.function)
    }

    /// Returns the function at this index of the enumeration; `None` beyond the end.
    ///
    /// Compiled code passes functions as numbers.
    pub fn from_index(index: usize) -> Option<Self> {
        TABLE.get(index).map(|entry| entry.function)
    }

    /// Returns the function with this name; `None` if there is none. Names are case-sensitive.
    pub fn from_name(name: &str) -> Option<Self> {
        Self::all().find(|function| function.name() == name)
    }

    /// Returns the name used in formulas.
    pub fn name(self) -> &'static str {
        self.entry().name
    }

    /// Returns the number of arguments: 1 or 2.
    pub fn argument_count(self) -> usize {
        self.entry().argument_count
    }

    /// Returns what the function computes from its arguments a and b, for lists of functions.
    pub fn description(self) -> &'static str {
        self.entry().description
    }

    /// Returns a sentence about the permitted arguments, without a full stop; `None` if all are
    /// permitted.
    pub fn domain(self) -> Option<&'static str> {
        self.entry().domain
    }

    /// Returns the value of the function. A function of one argument ignores `b`.
    ///
    /// The value is infinite or NaN if the arguments are outside the domain.
    pub fn apply(self, a: f64, b: f64) -> f64 {
        (self.entry().value)(a, b)
    }

    /// Returns the partial derivatives with respect to `a` and `b`. For a function of one argument the
    /// second is 0.
    ///
    /// A derivative that does not exist is infinite or NaN: `sqrt` at 0, `atan2` at the origin. The
    /// derivative of `power` with respect to its exponent is 0 if the base is not positive.
    ///
    /// # Examples
    ///
    /// ```
    /// use patchcord_expr::Function;
    ///
    /// // The derivatives of a^b at a = 3, b = 2: b a^(b - 1), and a^b ln a.
    /// let (by_base, by_exponent) = Function::Power.derivative(3.0, 2.0);
    /// assert!((by_base - 6.0).abs() < 1e-12);
    /// assert!((by_exponent - 9.0 * 3f64.ln()).abs() < 1e-12);
    /// assert_eq!(Function::Sin.derivative(0.0, 0.0), (1.0, 0.0));
    /// ```
    pub fn derivative(self, a: f64, b: f64) -> (f64, f64) {
        (self.entry().derivative)(a, b)
    }

    /// Returns bounds `(low, high)` of the values for arguments within the bounds `a` and `b`.
    ///
    /// The bounds are infinite if none are known.
    ///
    /// # Examples
    ///
    /// ```
    /// use patchcord_expr::Function;
    ///
    /// // The sine has its crest at pi/2, which is between 0 and 3.
    /// assert_eq!(Function::Sin.bounds((0.0, 3.0), (0.0, 0.0)), (0.0, 1.0));
    /// assert_eq!(Function::Sqrt.bounds((4.0, 9.0), (0.0, 0.0)), (2.0, 3.0));
    /// assert_eq!(Function::Tan.bounds((0.0, 1.0), (0.0, 0.0)), (f64::NEG_INFINITY, f64::INFINITY));
    /// ```
    pub fn bounds(self, a: (f64, f64), b: (f64, f64)) -> (f64, f64) {
        let ends = [(a.0, b.0), (a.0, b.1), (a.1, b.0), (a.1, b.1)].map(|(a, b)| self.apply(a, b));
        let lowest = ends.iter().copied().fold(f64::INFINITY, f64::min);
        let highest = ends.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let unknown = (f64::NEG_INFINITY, f64::INFINITY);
        match self.entry().extrema {
            _ if ends.iter().any(|end| end.is_nan()) => unknown,
            Extrema::Monotonic => (lowest, highest),
            Extrema::MonotonicAboveZero if a.0 > 0.0 => (lowest, highest),
            Extrema::Periodic { crest, trough } => (
                if is_angle_within(trough, a) { -1.0 } else { lowest },
                if is_angle_within(crest, a) { 1.0 } else { highest },
            ),
            _ => unknown,
        }
    }

    /// Returns bounds `(low, high)` of the derivative of a function of one argument, for arguments
    /// within the bounds.
    ///
    /// The bounds are infinite if none are known: for functions of two arguments, `tan` and `floor`.
    ///
    /// # Examples
    ///
    /// ```
    /// use patchcord_expr::Function;
    ///
    /// // The sine is steepest at 0, where its derivative is 1.
    /// assert_eq!(Function::Sin.slope_bounds((-1.5, 1.0)), (1.5f64.cos(), 1.0));
    /// assert_eq!(Function::Sqrt.slope_bounds((1.0, 4.0)), (0.25, 0.5));
    /// ```
    pub fn slope_bounds(self, argument: (f64, f64)) -> (f64, f64) {
        let ends = [argument.0, argument.1].map(|end| self.derivative(end, end).0);
        let (low, high) = (ends[0].min(ends[1]), ends[0].max(ends[1]));
        match self.entry().steepest {
            _ if ends.iter().any(|end| end.is_nan()) => (f64::NEG_INFINITY, f64::INFINITY),
            Steepest::Ends => (low, high),
            Steepest::EndsAboveZero if argument.0 > 0.0 => (low, high),
            Steepest::EndsAndZero(peak) if argument.0 <= 0.0 && argument.1 >= 0.0 => (low, high.max(peak)),
            Steepest::EndsAndZero(_) => (low, high),
            Steepest::Periodic { crest, trough } => (
                if is_angle_within(trough, argument) { -1.0 } else { low },
                if is_angle_within(crest, argument) { 1.0 } else { high },
            ),
            Steepest::EndsAboveZero | Steepest::Unknown => (f64::NEG_INFINITY, f64::INFINITY),
        }
    }

    /// Returns the row of the function.
    fn entry(self) -> &'static FunctionRow {
        &TABLE[self as usize]
    }
}

#[cfg(test)]
mod tests;
