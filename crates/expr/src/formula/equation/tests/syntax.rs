//! What texts mean: sides, names, products and calls.

use super::super::{Expression, split_initial, split_primes};
use super::{assert_faults, equation, right, shape};

#[test]
fn the_sides_are_formulas() {
    let sides = equation("m x'' = -k x - c * x' + F");
    assert_eq!(shape(sides.left()), "(m * x'')");
    assert_eq!(shape(sides.right()), "((((-k) * x) - (c * x')) + F)");
    assert_eq!((sides.left().range.clone(), sides.right().range.clone()), (0..5, 8..25));
    assert_eq!(sides.text(), "m x'' = -k x - c * x' + F");
    assert_eq!(sides.to_string(), sides.text());
    let zero = equation("0=a+b");
    assert_eq!((shape(zero.left()), shape(zero.right())), ("0".to_owned(), "(a + b)".to_owned()));
}

#[test]
fn names_have_their_primes_and_are_listed_once() {
    assert_eq!(equation("m x'' + c x' + k x = pi m sin(x')").names(), ["m", "x''", "c", "x'", "k", "x"]);
    assert_eq!(equation("a = delay(b, T) + friction(a)").names(), ["a", "b", "T"]);
    assert_eq!(equation("q = x'''''''''").names(), ["q", "x'''''''''"]);
    let repeated = equation("x' = -x + 2 x'");
    assert_eq!(["x'", "x", "y"].map(|name| repeated.range_of(name)), [Some(0..2), Some(6..7), None]);
}

#[test]
fn a_name_directly_before_a_zero_in_parentheses_is_an_initial_value() {
    let stated = equation("x'(0) = v0 + 1");
    assert_eq!(stated.left().expression, Expression::Name("x'(0)".to_owned()));
    assert_eq!(stated.left().range, 0..5);
    assert_eq!(stated.names(), ["x'(0)", "v0"]);
    assert_eq!(stated.initial_quantity(), Some("x'"));
    let used = equation("x' = -x( 0.0 ) - x");
    assert_eq!(used.names(), ["x'", "x(0)", "x"]);
    assert_eq!(["x(0)", "x"].map(|name| used.range_of(name)), [Some(6..14), Some(17..18)]);
    assert_eq!(used.initial_quantity(), None);
    assert_eq!(equation("2 x(0) = 1").initial_quantity(), None);
    let cases = [
        ("2 x(0) y", "((2 * x(0)) * y)"),
        ("k x'(0)^2", "(k * (x'(0) ^ 2))"),
        ("x(0)(a)", "(x(0) * a)"),
        // The name of a quantity may resemble that of a function.
        ("tau(0)", "tau(0)"),
        ("round(0)", "round(0)"),
        // Names of functions and tables keep their meaning.
        ("cos(0)", "cos[0]"),
        ("step(0)", "step<0>"),
        ("friction(0)", "friction<0>"),
        // Other groups are factors.
        ("x(0 + 0)", "(x * (0 + 0))"),
        ("x(-0)", "(x * (-0))"),
        ("x (5)", "(x * 5)"),
        ("(x)(0)", "(x * 0)"),
    ];
    for (text, expected) in cases {
        assert_eq!(right(text), expected, "{text}");
    }
    assert_faults(&[
        (
            "x' (0) = v0",
            "x' (0)",
            "x' (0) is the product of x' and 0",
            "write x'(0) for the value at the start",
        ),
        ("x(0)' = v0", "'", "' is not allowed here", "a prime follows the name of a quantity"),
        ("x(0 = x0", "=", "= is not allowed inside parentheses", "close the parenthesis before the ="),
    ]);
}

#[test]
fn names_are_split_into_base_primes_and_initial_value() {
    assert_eq!(["x", "x''", "x(0)", "x''(0)"].map(split_primes), [("x", 0), ("x", 2), ("x", 0), ("x", 2)]);
    assert_eq!(["x", "x''", "x(0)", "x''(0)"].map(split_initial), [None, None, Some("x"), Some("x''")]);
}

#[test]
fn products_need_no_sign() {
    let cases = [
        ("m x''", "(m * x'')"),
        ("-k x", "((-k) * x)"),
        ("2 x", "(2 * x)"),
        ("2x", "(2 * x)"),
        ("2x'", "(2 * x')"),
        ("1.5e3x", "(1500 * x)"),
        ("2e", "(2 * e)"),
        ("k (a + b)", "(k * (a + b))"),
        ("k(a + b)", "(k * (a + b))"),
        ("(a + b) (c + d)", "((a + b) * (c + d))"),
        ("(a)(b)", "(a * b)"),
        ("k max(u, 0)^2", "(k * (max[u, 0] ^ 2))"),
        ("a b c", "((a * b) * c)"),
        ("x^2 y", "((x ^ 2) * y)"),
        ("x y^2", "(x * (y ^ 2))"),
        ("x^-2 y", "((x ^ (-2)) * y)"),
        ("-x^2 y", "((-(x ^ 2)) * y)"),
        ("a b + c d", "((a * b) + (c * d))"),
        ("a -b", "(a - b)"),
        ("a b / c", "((a * b) / c)"),
        ("a / b * c", "((a / b) * c)"),
        ("a / b * c d", "(((a / b) * c) * d)"),
        ("a * b c", "((a * b) * c)"),
        ("(a / b) c", "((a / b) * c)"),
        ("a / (b c)", "(a / (b * c))"),
        ("sin(a / b) c", "(sin[(a / b)] * c)"),
    ];
    for (text, expected) in cases {
        assert_eq!(right(text), expected, "{text}");
    }
    assert_eq!(right("2 pi f"), format!("((2 * {}) * f)", std::f64::consts::PI));
    // The range of a product without a sign extends over both factors.
    assert_eq!(equation("y = k (a + b)").right().range, 4..13);
}

#[test]
fn names_before_parentheses_are_functions_tables_or_factors() {
    let cases = [
        ("sin(x)", "sin[x]"),
        ("sin (x)", "sin[x]"),
        ("sign(x')", "sign<x'>"),
        ("step (t - 1)", "step<(t - 1)>"),
        ("dead_zone(x, w)", "dead_zone<x, w>"),
        ("limit(x, -1, 1)", "limit<x, (-1), 1>"),
        ("delay(x, T)", "delay<x, T>"),
        ("friction(x')", "friction<x'>"),
        ("2 friction (x') k", "((2 * friction<x'>) * k)"),
        ("curve(x')", "(curve * x')"),
        ("x'(a)", "(x' * a)"),
        ("t(a)", "(t * a)"),
        // With a blank, a name that resembles a function is a factor.
        ("tau (a + b)", "(tau * (a + b))"),
        ("lb (a)", "(lb * a)"),
        // Without an argument, the name of a function of equations is one of a quantity.
        ("k step", "(k * step)"),
        ("limit - delay", "(limit - delay)"),
    ];
    for (text, expected) in cases {
        assert_eq!(right(text), expected, "{text}");
    }
}
