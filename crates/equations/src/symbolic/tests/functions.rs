//! The rules of functions.

use patchcord_expr::Function;

use super::{assert_different, assert_equal};
use crate::symbolic::{Fraction, Operation, Symbol, delay, opaque, sign, step, value};
use crate::testing::reading::read;
use crate::testing::{Point, symbol};

#[test]
fn absolute_values_are_even() {
    assert_equal(&[
        "abs(-x) = abs(x)",
        "abs(x - y) = abs(y - x)",
        "abs(x/(y - x)) = abs(x/(x - y))",
        "abs(-0.3) = 0.3",
        "abs(x - x) = 0",
    ]);
    assert_different(&["abs(x) = x", "abs(x + y) = abs(x) + abs(y)", "abs(x y) = x y"]);
}

#[test]
fn factors_of_known_sign_are_outside_of_absolute_values() {
    assert_equal(&[
        "abs(p x) = p abs(x)",
        "abs(-2 x) = 2 abs(x)",
        "abs(x/p) = abs(x)/p",
        "abs(x/(p + q)) = abs(x)/(p + q)",
        "abs(x^2 y) = x^2 abs(y)",
        "abs(p sqrt(x) y) = p sqrt(x) abs(y)",
        "abs(p + q) = p + q",
        "abs(x^2) = x^2",
        "abs(exp(x)) = exp(x)",
        "abs(abs(x)) = abs(x)",
    ]);
    assert_different(&["abs(z x) = z abs(x)", "abs(p - q) = p - q"]);
}

#[test]
fn an_absolute_value_covers_its_argument() {
    assert_equal(&[
        "abs(x + abs(x)) = x + abs(x)",
        "abs(abs(x - y) + y - x) = abs(x - y) + y - x",
        "abs(p abs(x) - p x) = p abs(x) - p x",
        "abs(abs(x) + x + abs(y) - y) = abs(x) + x + abs(y) - y",
    ]);
    assert_different(&["abs(abs(x) - 2 x) = abs(x) - 2 x", "abs(abs(x) - x - y) = abs(x) - x - y"]);
}

#[test]
fn powers_of_absolute_values_are_powers() {
    assert_equal(&[
        "abs(x)^2 = x^2",
        "abs(x)^3 = x^2 abs(x)",
        "1/abs(x)^2 = 1/x^2",
        "abs(x - y)^2 = x^2 - 2 x y + y^2",
        "abs(x)/abs(x) = 1",
    ]);
}

#[test]
fn minima_and_maxima_have_absolute_values() {
    assert_equal(&[
        "min(x, 1) = 1 - max(1 - x, 0)",
        "min(-x, x) = -abs(x)",
        "max(x, 0) - max(-x, 0) = x",
        "max(x, 0) + max(-x, 0) = abs(x)",
        "max(x, y) = max(y, x)",
        "min(x, y) = -max(-x, -y)",
        "max(x + z, y + z) = z + max(x, y)",
        "max(x, y) + min(x, y) = x + y",
        "max(x, y) min(x, y) = x y",
        "max(x, 0)^2 = x max(x, 0)",
        "max(x, 0) max(-x, 0) = 0",
        "max(p x, 0) = p max(x, 0)",
        "max(p, 0) = p",
        "min(p, 0) = 0",
        "max(abs(x), 0) = abs(x)",
        "max(max(x, 0), 0) = max(x, 0)",
        "max(x, x) = x",
        "max(3, 2) = 3",
        "min(3, 2) = 2",
    ]);
    assert_different(&["max(x, y) = x", "max(x, 0) = min(x, 0)", "max(z x, 0) = z max(x, 0)"]);
}

#[test]
fn steps_have_no_positive_factors() {
    assert_equal(&[
        "step(2 x) = step(x)",
        "step(p x) = step(x)",
        "step(x/(p + q)) = step(x)",
        "step(x)^2 = step(x)",
        "step(x)^3 = step(x)",
        "(1 - step(x)) step(x) = 0",
        "step(x^2) = 1",
        "step(abs(x) - x) = 1",
        "step(p) = 1",
        "step(2) = 1",
        "step(0) = 1",
        "step(-1) = 0",
    ]);
    // At 0 both a step and that of the opposite are 1.
    assert_different(&[
        "step(-x) = 1 - step(x)",
        "step(-x) = step(x)",
        "step(z x) = step(x)",
        "step(x y^2) = step(x)",
        "step(x abs(y)) = step(x)",
        "step(x step(y)) = step(x)",
        "step(x + 1) = step(x)",
    ]);
}

/// For c = 0 the step of c x is 1 for every x.
#[test]
fn a_step_keeps_a_constant_that_can_be_0() {
    let x = Fraction::symbol(symbol("x"));
    let nonnegative = Symbol { is_positive: false, ..symbol("p") };
    for constant in [nonnegative, Symbol { is_nonnegative: false, ..nonnegative }] {
        let constant = Fraction::symbol(constant);
        for power in [1, 2] {
            let kept = step(&constant.power(power).times(&x));
            assert_ne!(kept, step(&x), "{power}");
            assert_eq!(value(&kept, &Point([-1.0, 0.0, 0.0, 0.0, 0.0])), 1.0, "{power}");
        }
        // A divisor is not 0.
        assert_eq!(step(&x.over(&constant.power(2))), step(&x));
    }
}

#[test]
fn a_choice_is_a_step() {
    let cases = [
        (["x", "y", "z", "z"], "z"),
        (["2", "1", "x", "y"], "x"),
        (["1", "2", "x", "y"], "y"),
        (["x", "x", "1", "0"], "1"),
        (["x", "y", "1", "0"], "step(x - y)"),
        (["p", "0", "x", "y"], "x"),
        (["x", "0", "z + y", "y"], "y + z step(x)"),
    ];
    for (operands, expected) in cases {
        let [left, right, then, otherwise] = operands.map(read);
        let choice = Fraction::select(&left, &right, &then, &otherwise);
        assert_eq!(choice, read(expected), "{operands:?}");
    }
}

#[test]
fn squares_are_outside_of_roots() {
    assert_equal(&[
        "sqrt(x^2) = abs(x)",
        "sqrt(p^2) = p",
        "sqrt(x^4) = x^2",
        "sqrt(x^6) = x^2 abs(x)",
        "sqrt(p^3) = p sqrt(p)",
        "sqrt(4 x) = 2 sqrt(x)",
        "sqrt(x/4) = sqrt(x)/2",
        "sqrt(p^2 x) = p sqrt(x)",
        "sqrt(1/p^2) = 1/p",
        "sqrt(1/p) = sqrt(p)/p",
        "sqrt(x^2/y^2) = abs(x)/abs(y)",
        "sqrt(p^2 x + p^2 y) = p sqrt(x + y)",
        "sqrt(9 x^2 + 9 y^2) = 3 sqrt(x^2 + y^2)",
    ]);
    assert_different(&["sqrt(x^2) = x", "sqrt(x + y) = sqrt(x) + sqrt(y)", "sqrt(-4 x) = 2 sqrt(x)"]);
}

#[test]
fn powers_of_roots_are_powers() {
    assert_equal(&[
        "sqrt(x)^2 = x",
        "sqrt(x)^3 = x sqrt(x)",
        "sqrt(x + y)^2 = x + y",
        "1/sqrt(x)^2 = 1/x",
        "1/sqrt(x + y)^2 = 1/(x + y)",
        "sqrt(x)/sqrt(x) = 1",
    ]);
}

#[test]
fn roots_of_numbers_are_exact() {
    assert_equal(&[
        "sqrt(2/0.0036) = 50/3 * sqrt(2)",
        "sqrt(8) = 2 sqrt(2)",
        "sqrt(2)^2 = 2",
        "sqrt(0.25) = 0.5",
        "sqrt(1) = 1",
        "sqrt(0) = 0",
    ]);
    assert_different(&["sqrt(2) = 1.4142135623730951"]);
}

#[test]
fn odd_and_even_functions_have_one_sign_of_the_argument() {
    assert_equal(&[
        "sin(-x) = -sin(x)",
        "sin(x - y) = -sin(y - x)",
        "sin(-x)^2 = sin(x)^2",
        "tan(-x) = -tan(x)",
        "atan(-x) = -atan(x)",
        "tanh(-x) = -tanh(x)",
        "cos(-x) = cos(x)",
        "cos(x - y) = cos(y - x)",
    ]);
    assert_different(&[
        "sin(-x) = sin(x)",
        "cos(-x) = -cos(x)",
        "exp(-x) = exp(x)",
        "floor(-x) = -floor(x)",
        "atan2(-x, y) = atan2(x, y)",
        "atan2(x, y) = atan2(y, x)",
        "sin(x) = cos(x)",
    ]);
}

#[test]
fn an_exponential_of_a_logarithm_is_a_power() {
    assert_equal(&[
        "exp(ln(x)) = x",
        "exp(2 ln(x)) = x^2",
        "exp(-ln(x + y)) = 1/(x + y)",
        "exp(0.5 ln(x)) = sqrt(x)",
        "exp(y ln(x)) = x^y",
        "exp10(3 log10(x)) = x^3",
        "exp10(p log10(x/q)) = (x/q)^p",
    ]);
    assert_different(&[
        "exp(log10(x)) = x",
        "exp10(ln(x)) = x",
        "exp(ln(x) + y) = x exp(y)",
        "exp(ln(x)^2) = x^2",
    ]);
}

#[test]
fn functions_of_numbers_are_numbers() {
    assert_equal(&[
        "cos(0) = 1",
        "exp(x - x) = 1",
        "ln(1) = 0",
        "sin(0) = 0",
        "floor(-2.5) = -3",
        "atan2(0, 1) = 0",
    ]);
    assert_eq!(read("exp(1)"), Fraction::number(Function::Exp.apply(1.0, 0.0)));
    // A value that is not finite has no number.
    assert!(read("ln(0)").as_rational().is_none());
}

#[test]
fn a_delay_is_linear() {
    let cases = [
        ("p x + 2 y - 3", "p delay(x, T) + 2 delay(y, T) - 3"),
        ("x/q + z p/q", "delay(x, T)/q + (p/q) delay(z, T)"),
        ("x y", "delay(x y, T)"),
        ("p x^2 - abs(x)", "p delay(x^2, T) - delay(abs(x), T)"),
        ("x/(x + 1)", "delay(x/(x + 1), T)"),
        ("p + q", "p + q"),
        ("p/(1 + q) + sqrt(p)", "p/(1 + q) + sqrt(p)"),
        ("0", "0"),
    ];
    for (text, expected) in cases {
        assert_eq!(delay(&read(text), &read("T")), read(expected), "{text}");
    }
}

#[test]
fn functions_have_values() {
    let point = Point([0.7, -0.4, 2.0, 1.3, 0.9]);
    let cases = [
        ("x + y z", -0.1),
        ("p/(x + 0.3)/z^2", 0.325),
        ("abs(y) + step(y) + step(x)", 1.4),
        ("max(x, y) - min(x, y)", 1.1),
        ("sqrt(x + 0.3) + floor(z + y)", 2.0),
        ("atan2(0 + x - x, z)", 0.0),
        ("delay(x z, 0.5)", 0.3),
    ];
    for (text, expected) in cases {
        let found = value(&read(text), &point);
        assert!((found - expected).abs() < 1e-14, "{text}: {found}");
    }
    assert_eq!(value(&opaque(Operation::Table(0), vec![read("z")]), &point), 8.0);
    assert_eq!(value(&opaque(Operation::Minimum, vec![read("z"), read("p")]), &point), 1.3);
    assert_eq!(value(&opaque(Operation::Maximum, vec![read("z"), read("p")]), &point), 2.0);
    for (text, expected) in [("z", 1.0), ("y", -1.0), ("-2 p y", 1.0), ("x - x", 0.0)] {
        assert_eq!(value(&sign(&read(text)), &point), expected, "{text}");
    }
    for (text, expected) in [("z", 1.3), ("x", 0.7), ("y", 0.5)] {
        let arguments = vec![read(text), read("0.5"), read("p")];
        assert_eq!(value(&opaque(Operation::Limit, arguments), &point), expected, "{text}");
    }
}
