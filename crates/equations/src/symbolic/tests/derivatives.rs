//! Derivatives.

use patchcord_expr::Function;

use crate::symbolic::{Fraction, Operation, Symbol, derivative, opaque, partial_derivative, value};
use crate::testing::reading::read;
use crate::testing::{Point, symbol};

/// Functions of x with continuous third derivatives near the point of the test.
const FUNCTIONS: [&str; 27] = [
    "x^3 - 2 x + y",
    "x y/(x + 2 y)",
    "x (1 + x^2)^(-2)",
    "sqrt(1 + x^2)",
    "x/sqrt(x)",
    "sin(2 x)",
    "cos(x y)",
    "tan(x)",
    "atan(x/y)",
    "atan2(x, y)",
    "atan2(y, 2 x)",
    "exp(-x)",
    "exp10(x/3)",
    "ln(1 + x^2)",
    "log10(2 + x)",
    "tanh(x y)",
    "power(1 + x, y)",
    "power(p, x)",
    "floor(3 x)",
    "abs(x - 1) x",
    "max(x y, z)",
    "min(x, y)",
    "step(x) x^2",
    "sin(abs(cos(3 x)))",
    "delay(x^2, 0.25)",
    "delay(x y + x, 0.25) x",
    "1/(x + 1/(x + y))",
];

/// Half the distance between the points of a central difference.
const DISTANCE: f64 = 1e-5;

#[test]
fn a_partial_derivative_is_the_limit_of_a_difference() {
    let at = |x: f64| Point([x, 0.4, -0.2, 1.3, 0.9]);
    for text in FUNCTIONS {
        let expression = read(text);
        let slope = value(&partial_derivative(&expression, symbol("x")), &at(0.7));
        let [before, after] = [-DISTANCE, DISTANCE].map(|change| value(&expression, &at(0.7 + change)));
        let difference = (after - before) / (2.0 * DISTANCE);
        assert!((slope - difference).abs() < 1e-8 * (1.0 + slope.abs()), "{text}: {slope} {difference}");
    }
}

#[test]
fn the_derivative_of_every_function_is_tested() {
    for function in Function::all() {
        let call = format!("{}(", function.name());
        assert!(FUNCTIONS.iter().any(|text| text.contains(&call)), "{call}");
    }
}

#[test]
fn partial_derivatives_have_a_normal_form() {
    let cases = [
        ("x/(x + y)", "x", "y (x + y)^(-2)"),
        ("x/(x + y)", "y", "-x (x + y)^(-2)"),
        ("(x^2 + 1)/(x - 1)", "x", "(x^2 - 2 x - 1) (x - 1)^(-2)"),
        ("1/x", "x", "-1/x^2"),
        ("y/z", "x", "0"),
        ("abs(x)", "x", "2 step(x) - 1"),
        ("sqrt(x^2 + y^2)", "x", "x/sqrt(x^2 + y^2)"),
        ("step(x)", "x", "0"),
        ("exp(x y)", "y", "x exp(x y)"),
    ];
    for (text, of, expected) in cases {
        assert_eq!(partial_derivative(&read(text), symbol(of)), read(expected), "d/d{of} of {text}");
    }
}

#[test]
fn a_derivative_has_the_rates_of_all_symbols() {
    // The rate of x is y, and the rate of y is -p x.
    let rates = [("x", "y"), ("y", "-p x")];
    let mut rate = |own: Symbol| {
        let rate = rates.iter().find(|(name, _)| symbol(name) == own);
        rate.map_or_else(Fraction::zero, |(_, rate)| read(rate))
    };
    let cases = [
        ("x", "y"),
        ("q", "0"),
        ("x y", "y^2 - p x^2"),
        ("x^2/(2 q)", "x y/q"),
        ("delay(x, T)", "delay(y, T)"),
        ("sin(x + y)", "(y - p x) cos(x + y)"),
    ];
    for (text, expected) in cases {
        assert_eq!(derivative(&read(text), &mut rate), read(expected), "{text}");
    }
}

#[test]
fn the_derivative_of_a_table_is_its_slope() {
    let table = |operation: Operation| opaque(operation, vec![read("x^2")]);
    let derivative = partial_derivative(&table(Operation::Table(0)), symbol("x"));
    assert_eq!(derivative, read("2 x").times(&table(Operation::TableSlope(0))));
    // The table is cubic: d/dx x^6 = 6 x^5.
    assert_eq!(value(&derivative, &Point([2.0, 0.0, 0.0, 0.0, 0.0])), 192.0);
    assert!(partial_derivative(&derivative, symbol("y")).is_zero());
}
