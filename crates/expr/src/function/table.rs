//! The table of functions: name, value, derivatives and extreme values of each one.

use std::f64::consts::{FRAC_PI_2, LN_10, PI};

use super::Function;

/// The row of a function in [`TABLE`].
pub(super) struct FunctionRow {
    /// The function, which is also the index of the row.
    pub function: Function,
    /// The name in formulas.
    pub name: &'static str,
    /// 1 or 2.
    pub argument_count: usize,
    /// What the function computes from its arguments a and b.
    pub description: &'static str,
    /// The permitted arguments, as a sentence; `None` if all are permitted.
    pub domain: Option<&'static str>,
    /// The value. A function of one argument ignores the second.
    pub value: fn(f64, f64) -> f64,
    /// The partial derivatives with respect to a and b.
    pub derivative: fn(f64, f64) -> (f64, f64),
    /// Where the extreme values are; [`Function::bounds`] uses it.
    pub extrema: Extrema,
    /// Where the extreme derivatives are; [`Function::slope_bounds`] uses it.
    pub steepest: Steepest,
}

/// The places where a function has its extreme values over ranges of its arguments.
pub(super) enum Extrema {
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

/// The places where the derivative of a function of one argument has its extreme values over a range.
pub(super) enum Steepest {
    /// At the ends of the range, because the derivative is monotonic.
    Ends,
    /// At the ends of the range, if the argument is positive throughout.
    EndsAboveZero,
    /// At the ends of the range, and at 0 with this value.
    EndsAndZero(f64),
    /// The derivative is the sine or cosine with these places of its extreme values.
    Periodic { crest: f64, trough: f64 },
    /// Not known. The bounds of the derivative are reported as infinite.
    Unknown,
}

/// The rows of all functions.
///
/// The rows are in the order of the enumeration, which is used as the index.
pub(super) static TABLE: [FunctionRow; 13] = [
    FunctionRow {
        function: Function::Sqrt,
        name: "sqrt",
        argument_count: 1,
        description: "the square root of a",
        domain: Some("sqrt needs 0 or more"),
        value: |a, _| a.sqrt(),
        derivative: |a, _| (0.5 / a.sqrt(), 0.0),
        extrema: Extrema::Monotonic,
        steepest: Steepest::Ends,
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
        steepest: Steepest::Periodic { crest: 0.0, trough: PI },
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
        steepest: Steepest::Periodic { crest: -FRAC_PI_2, trough: FRAC_PI_2 },
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
        steepest: Steepest::Unknown,
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
        steepest: Steepest::EndsAndZero(1.0),
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
        steepest: Steepest::Unknown,
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
        steepest: Steepest::Ends,
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
        steepest: Steepest::Ends,
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
        steepest: Steepest::EndsAboveZero,
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
        steepest: Steepest::EndsAboveZero,
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
        steepest: Steepest::EndsAndZero(1.0),
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
        steepest: Steepest::Unknown,
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
        steepest: Steepest::Unknown,
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
