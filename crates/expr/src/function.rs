//! The functions that formulas and machines can take of one or two numbers.

use std::f64::consts::{FRAC_PI_2, LN_10, PI, TAU};

/// A function of one or two numbers.
///
/// All values come from one software library (the square root, being exact, from the processor),
/// so that every machine computes the same bits.
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
    /// The angle, in radians between -pi/2 and pi/2, with a given tangent.
    Atan,
    /// The angle, in radians between -pi and pi, of the point (second, first argument).
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
    /// The largest whole number that is not above the argument.
    Floor,
}

struct Entry {
    function: Function,
    name: &'static str,
    arguments: usize,
    meaning: &'static str,
    domain: Option<&'static str>,
    value: fn(f64, f64) -> f64,
    derivative: fn(f64, f64) -> (f64, f64),
    shape: Shape,
}

/// Where a function takes its least and largest values over ranges of its arguments.
enum Shape {
    /// At the ends: it rises or falls along each argument all the way.
    Monotonic,
    /// At the ends, as long as the base is above 0.
    MonotonicAboveZero,
    /// At the ends, and at 1 and -1 where the angle passes these, in radians and whole turns from them.
    Wave { crest: f64, trough: f64 },
    /// Nothing is known.
    Unknown,
}

// In the order of the enumeration, which is used as the index.
static TABLE: [Entry; 13] = [
    Entry {
        function: Function::Sqrt,
        name: "sqrt",
        arguments: 1,
        meaning: "the square root of a",
        domain: Some("sqrt needs 0 or more"),
        value: |a, _| a.sqrt(),
        derivative: |a, _| (0.5 / a.sqrt(), 0.0),
        shape: Shape::Monotonic,
    },
    Entry {
        function: Function::Sin,
        name: "sin",
        arguments: 1,
        meaning: "the sine of the angle a in radians",
        domain: None,
        value: |a, _| libm::sin(a),
        derivative: |a, _| (libm::cos(a), 0.0),
        shape: Shape::Wave { crest: FRAC_PI_2, trough: -FRAC_PI_2 },
    },
    Entry {
        function: Function::Cos,
        name: "cos",
        arguments: 1,
        meaning: "the cosine of the angle a in radians",
        domain: None,
        value: |a, _| libm::cos(a),
        derivative: |a, _| (-libm::sin(a), 0.0),
        shape: Shape::Wave { crest: 0.0, trough: PI },
    },
    Entry {
        function: Function::Tan,
        name: "tan",
        arguments: 1,
        meaning: "the tangent of the angle a in radians",
        domain: None,
        value: |a, _| libm::tan(a),
        derivative: |a, _| {
            let tangent = libm::tan(a);
            (1.0 + tangent * tangent, 0.0)
        },
        shape: Shape::Unknown,
    },
    Entry {
        function: Function::Atan,
        name: "atan",
        arguments: 1,
        meaning: "the angle in radians, from -pi/2 to pi/2, whose tangent is a",
        domain: None,
        value: |a, _| libm::atan(a),
        derivative: |a, _| (1.0 / (1.0 + a * a), 0.0),
        shape: Shape::Monotonic,
    },
    Entry {
        function: Function::Atan2,
        name: "atan2",
        arguments: 2,
        meaning: "the angle in radians, from -pi to pi, from the b axis to the point (b, a)",
        domain: None,
        value: libm::atan2,
        derivative: |a, b| {
            let square = a * a + b * b;
            (b / square, -a / square)
        },
        shape: Shape::Unknown,
    },
    Entry {
        function: Function::Exp,
        name: "exp",
        arguments: 1,
        meaning: "e to the power of a",
        domain: None,
        value: |a, _| libm::exp(a),
        derivative: |a, _| (libm::exp(a), 0.0),
        shape: Shape::Monotonic,
    },
    Entry {
        function: Function::Exp10,
        name: "exp10",
        arguments: 1,
        meaning: "10 to the power of a",
        domain: None,
        value: |a, _| libm::exp10(a),
        derivative: |a, _| (LN_10 * libm::exp10(a), 0.0),
        shape: Shape::Monotonic,
    },
    Entry {
        function: Function::Ln,
        name: "ln",
        arguments: 1,
        meaning: "the natural logarithm of a",
        domain: Some("ln needs more than 0"),
        value: |a, _| libm::log(a),
        derivative: |a, _| (1.0 / a, 0.0),
        shape: Shape::Monotonic,
    },
    Entry {
        function: Function::Log10,
        name: "log10",
        arguments: 1,
        meaning: "the logarithm of a to base 10",
        domain: Some("log10 needs more than 0"),
        value: |a, _| libm::log10(a),
        derivative: |a, _| (1.0 / (a * LN_10), 0.0),
        shape: Shape::Monotonic,
    },
    Entry {
        function: Function::Tanh,
        name: "tanh",
        arguments: 1,
        meaning: "the hyperbolic tangent of a",
        domain: None,
        value: |a, _| libm::tanh(a),
        derivative: |a, _| {
            let cosine = libm::cosh(a);
            (1.0 / (cosine * cosine), 0.0)
        },
        shape: Shape::Monotonic,
    },
    Entry {
        function: Function::Power,
        name: "power",
        arguments: 2,
        meaning: "a to the power of b",
        domain: Some("a negative base needs a whole exponent, and a base of 0 an exponent of 0 or more"),
        value: libm::pow,
        derivative: |a, b| (power_by_base(a, b), power_by_exponent(a, b)),
        shape: Shape::MonotonicAboveZero,
    },
    Entry {
        function: Function::Floor,
        name: "floor",
        arguments: 1,
        meaning: "the largest whole number not above a",
        domain: None,
        value: |a, _| libm::floor(a),
        derivative: |_, _| (0.0, 0.0),
        shape: Shape::Monotonic,
    },
];

// At base 0 the plain formula would give 0 times infinity.
fn power_by_base(base: f64, exponent: f64) -> f64 {
    if exponent == 0.0 { 0.0 } else { exponent * libm::pow(base, exponent - 1.0) }
}

// Only whole exponents are defined for a negative base, so there is no neighbour to compare with;
// 0 lets a constant exponent pass through the chain rule.
fn power_by_exponent(base: f64, exponent: f64) -> f64 {
    if base > 0.0 { libm::pow(base, exponent) * libm::log(base) } else { 0.0 }
}

/// Whether an angle, or one that is whole turns from it, lies within bounds.
fn passes(angle: f64, bounds: (f64, f64)) -> bool {
    let turns = libm::ceil((bounds.0 - angle) / TAU);
    angle + turns * TAU <= bounds.1
}

impl Function {
    /// Every function, in the order of the enumeration.
    pub fn all() -> impl Iterator<Item = Self> {
        TABLE.iter().map(|entry| entry.function)
    }

    /// The function at this place of the enumeration.
    pub fn at(place: usize) -> Option<Self> {
        TABLE.get(place).map(|entry| entry.function)
    }

    /// The function of this name, if there is one. Upper and lower case differ.
    pub fn named(name: &str) -> Option<Self> {
        Self::all().find(|function| function.name() == name)
    }

    /// The name under which it is called.
    pub fn name(self) -> &'static str {
        self.entry().name
    }

    /// How many arguments it takes: 1 or 2.
    pub fn arguments(self) -> usize {
        self.entry().arguments
    }

    /// What it computes from its arguments a and b, for lists of functions.
    pub fn meaning(self) -> &'static str {
        self.entry().meaning
    }

    /// Which arguments it needs, if it does not take all; as a sentence without a full stop.
    pub fn domain(self) -> Option<&'static str> {
        self.entry().domain
    }

    /// Its value; a function of one argument ignores `b`.
    ///
    /// The value is not a number, or infinite, for arguments it does not take.
    pub fn apply(self, a: f64, b: f64) -> f64 {
        (self.entry().value)(a, b)
    }

    /// Its partial derivatives to `a` and to `b`; the second is 0 for a function of one argument.
    ///
    /// They are infinite or not a number where there is none: `sqrt` at 0, `atan2` at the origin.
    /// The derivative of `power` to its exponent is given as 0 for a base that is not positive.
    pub fn derivative(self, a: f64, b: f64) -> (f64, f64) {
        (self.entry().derivative)(a, b)
    }

    /// Bounds of its values where `a` and `b` lie within these bounds: infinite where none are known.
    pub fn over(self, a: (f64, f64), b: (f64, f64)) -> (f64, f64) {
        let ends = [(a.0, b.0), (a.0, b.1), (a.1, b.0), (a.1, b.1)].map(|(a, b)| self.apply(a, b));
        let least = ends.iter().copied().fold(f64::INFINITY, f64::min);
        let most = ends.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let unknown = (f64::NEG_INFINITY, f64::INFINITY);
        match self.entry().shape {
            _ if ends.iter().any(|end| end.is_nan()) => unknown,
            Shape::Monotonic => (least, most),
            Shape::MonotonicAboveZero if a.0 > 0.0 => (least, most),
            Shape::Wave { crest, trough } => {
                (if passes(trough, a) { -1.0 } else { least }, if passes(crest, a) { 1.0 } else { most })
            }
            _ => unknown,
        }
    }

    fn entry(self) -> &'static Entry {
        &TABLE[self as usize]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_table_is_in_the_order_of_the_enumeration() {
        for (place, entry) in TABLE.iter().enumerate() {
            assert_eq!(entry.function as usize, place, "{}", entry.name);
            assert_eq!(Function::named(entry.name), Some(entry.function));
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
