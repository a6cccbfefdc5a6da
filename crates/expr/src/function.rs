//! Mathematical functions of one or two numbers, shared by formulas and machine elements.
//!
//! Each function is one row of [`TABLE`]: its name, its value, its derivatives and the places of its
//! extreme values. The values come from the `libm` crate, never from the platform's library, so that
//! every machine computes the same bits.

use std::f64::consts::{FRAC_PI_2, LN_10, PI, TAU};

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
/// let root = Function::from_name("sqrt").expect("sqrt is a function");
/// assert_eq!(root.apply(9.0, 0.0), 3.0);
/// assert_eq!(root.domain(), Some("sqrt needs 0 or more"));
/// assert!(root.apply(-1.0, 0.0).is_nan());
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

/// The row of a function in [`TABLE`].
struct FunctionRow {
    /// The function, which is also the index of the row.
    function: Function,
    /// The name in formulas.
    name: &'static str,
    /// 1 or 2.
    argument_count: usize,
    /// What the function computes from its arguments a and b.
    description: &'static str,
    /// The permitted arguments, as a sentence; `None` if all are permitted.
    domain: Option<&'static str>,
    /// The value. A function of one argument ignores the second.
    value: fn(f64, f64) -> f64,
    /// The partial derivatives with respect to a and b.
    derivative: fn(f64, f64) -> (f64, f64),
    /// Where the extreme values are; [`Function::bounds`] uses it.
    extrema: Extrema,
}

/// The places where a function has its extreme values over ranges of its arguments.
enum Extrema {
    /// At the ends of the ranges, because the function is monotonic in each argument.
    Monotonic,
    /// At the ends of the ranges, if the first argument is positive throughout.
    MonotonicAboveZero,
    /// At the ends, and where the angle equals `crest` (value 1) or `trough` (value -1), in radians
    /// and up to whole turns.
    Periodic { crest: f64, trough: f64 },
    /// Not known. The bounds of the values are reported as infinite.
    Unknown,
}

/// The rows of all functions.
///
/// The rows are in the order of the enumeration, which is used as the index.
static TABLE: [FunctionRow; 13] = [
    FunctionRow {
        function: Function::Sqrt,
        name: "sqrt",
        argument_count: 1,
        description: "the square root of a",
        domain: Some("sqrt needs 0 or more"),
        value: |a, _| a.sqrt(),
        derivative: |a, _| (0.5 / a.sqrt(), 0.0),
        extrema: Extrema::Monotonic,
    },
    FunctionRow {
        function: Function::Sin,
        name: "sin",
        argument_count: 1,
        description: "the sine of the angle a in radians",
        domain: None,
        value: |a, _| libm::sin(a),
        derivative: |a, _| (libm::cos(a), 0.0),
        extrema: Extrema::Periodic { crest: FRAC_PI_2, trough: -FRAC_PI_2 },
    },
    FunctionRow {
        function: Function::Cos,
        name: "cos",
        argument_count: 1,
        description: "the cosine of the angle a in radians",
        domain: None,
        value: |a, _| libm::cos(a),
        derivative: |a, _| (-libm::sin(a), 0.0),
        extrema: Extrema::Periodic { crest: 0.0, trough: PI },
    },
    FunctionRow {
        function: Function::Tan,
        name: "tan",
        argument_count: 1,
        description: "the tangent of the angle a in radians",
        domain: None,
        value: |a, _| libm::tan(a),
        derivative: |a, _| {
            let tangent = libm::tan(a);
            (1.0 + tangent * tangent, 0.0)
        },
        extrema: Extrema::Unknown,
    },
    FunctionRow {
        function: Function::Atan,
        name: "atan",
        argument_count: 1,
        description: "the angle in radians, from -pi/2 to pi/2, whose tangent is a",
        domain: None,
        value: |a, _| libm::atan(a),
        derivative: |a, _| (1.0 / (1.0 + a * a), 0.0),
        extrema: Extrema::Monotonic,
    },
    FunctionRow {
        function: Function::Atan2,
        name: "atan2",
        argument_count: 2,
        description: "the angle in radians, from -pi to pi, from the b axis to the point (b, a)",
        domain: None,
        value: libm::atan2,
        derivative: |a, b| {
            let square = a * a + b * b;
            (b / square, -a / square)
        },
        extrema: Extrema::Unknown,
    },
    FunctionRow {
        function: Function::Exp,
        name: "exp",
        argument_count: 1,
        description: "e to the power of a",
        domain: None,
        value: |a, _| libm::exp(a),
        derivative: |a, _| (libm::exp(a), 0.0),
        extrema: Extrema::Monotonic,
    },
    FunctionRow {
        function: Function::Exp10,
        name: "exp10",
        argument_count: 1,
        description: "10 to the power of a",
        domain: None,
        value: |a, _| libm::exp10(a),
        derivative: |a, _| (LN_10 * libm::exp10(a), 0.0),
        extrema: Extrema::Monotonic,
    },
    FunctionRow {
        function: Function::Ln,
        name: "ln",
        argument_count: 1,
        description: "the natural logarithm of a",
        domain: Some("ln needs more than 0"),
        value: |a, _| libm::log(a),
        derivative: |a, _| (1.0 / a, 0.0),
        extrema: Extrema::Monotonic,
    },
    FunctionRow {
        function: Function::Log10,
        name: "log10",
        argument_count: 1,
        description: "the logarithm of a to base 10",
        domain: Some("log10 needs more than 0"),
        value: |a, _| libm::log10(a),
        derivative: |a, _| (1.0 / (a * LN_10), 0.0),
        extrema: Extrema::Monotonic,
    },
    FunctionRow {
        function: Function::Tanh,
        name: "tanh",
        argument_count: 1,
        description: "the hyperbolic tangent of a",
        domain: None,
        value: |a, _| libm::tanh(a),
        derivative: |a, _| {
            let cosine = libm::cosh(a);
            (1.0 / (cosine * cosine), 0.0)
        },
        extrema: Extrema::Monotonic,
    },
    FunctionRow {
        function: Function::Power,
        name: "power",
        argument_count: 2,
        description: "a to the power of b",
        domain: Some("a negative base needs a whole exponent, and a base of 0 an exponent of 0 or more"),
        value: libm::pow,
        derivative: |a, b| (power_by_base(a, b), power_by_exponent(a, b)),
        extrema: Extrema::MonotonicAboveZero,
    },
    FunctionRow {
        function: Function::Floor,
        name: "floor",
        argument_count: 1,
        description: "the largest whole number that is at most a",
        domain: None,
        value: |a, _| libm::floor(a),
        derivative: |_, _| (0.0, 0.0),
        extrema: Extrema::Monotonic,
    },
];

/// Returns the derivative of a power with respect to its base.
///
/// At base 0 and exponent 0 the plain formula would give 0 times infinity.
fn power_by_base(base: f64, exponent: f64) -> f64 {
    if exponent == 0.0 { 0.0 } else { exponent * libm::pow(base, exponent - 1.0) }
}

/// Returns the derivative of a power with respect to its exponent.
///
/// A negative base has values at whole exponents only, so there is no derivative with respect to the
/// exponent. The value 0 keeps the chain rule correct for a constant exponent.
fn power_by_exponent(base: f64, exponent: f64) -> f64 {
    if base > 0.0 { libm::pow(base, exponent) * libm::log(base) } else { 0.0 }
}

/// Whether the bounds contain the angle plus some number of whole turns.
fn contains_angle(angle: f64, bounds: (f64, f64)) -> bool {
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
                if contains_angle(trough, a) { -1.0 } else { lowest },
                if contains_angle(crest, a) { 1.0 } else { highest },
            ),
            _ => unknown,
        }
    }

    /// Returns the row of the function.
    fn entry(self) -> &'static FunctionRow {
        &TABLE[self as usize]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_table_is_in_the_order_of_the_enumeration() {
        for (index, entry) in TABLE.iter().enumerate() {
            assert_eq!(entry.function as usize, index, "{}", entry.name);
            assert_eq!(Function::from_name(entry.name), Some(entry.function));
        }
    }

    #[test]
    fn values() {
        assert_eq!(Function::Sqrt.apply(9.0, 0.0), 3.0);
        assert_eq!(Function::Power.apply(2.0, 10.0), 1024.0);
        assert_eq!(Function::Log10.apply(1000.0, 0.0), 3.0);
        assert_eq!(Function::Exp10.apply(3.0, 0.0), 1000.0);
        assert_eq!(Function::Atan2.apply(1.0, 0.0), std::f64::consts::FRAC_PI_2);
        assert!(Function::Sqrt.apply(-1.0, 0.0).is_nan());
    }

    #[test]
    fn derivatives_agree_with_central_differences() {
        let step = 1e-5;
        for function in Function::all() {
            for (a, b) in [(0.3, 1.7), (1.2, 2.5), (2.9, -0.8), (0.05, 3.0)] {
                let value = |a, b| function.apply(a, b);
                let by_a = (value(a + step, b) - value(a - step, b)) / (2.0 * step);
                let by_b = (value(a, b + step) - value(a, b - step)) / (2.0 * step);
                let (exact_a, exact_b) = function.derivative(a, b);
                let near = |found: f64, exact: f64| (found - exact).abs() < 1e-5 * (1.0 + exact.abs());
                assert!(near(by_a, exact_a), "{function:?} {a} {b}: {by_a} {exact_a}");
                assert!(near(by_b, exact_b), "{function:?} {a} {b}: {by_b} {exact_b}");
            }
        }
    }

    #[test]
    fn derivatives_of_power_at_the_edge() {
        assert_eq!(Function::Power.derivative(0.0, 2.0), (0.0, 0.0));
        assert_eq!(Function::Power.derivative(0.0, 0.0), (0.0, 0.0));
        assert_eq!(Function::Power.derivative(-3.0, 2.0), (-6.0, 0.0));
        assert_eq!(Function::Tanh.derivative(1000.0, 0.0), (0.0, 0.0));
    }
}
