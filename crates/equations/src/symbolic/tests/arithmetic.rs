//! Sums, products, quotients and powers, and the parts of an expression.

use std::collections::BTreeMap;

use patchcord_expr::Function;

use super::{assert_different, assert_equal};
use crate::symbolic::{
    Atom, Fraction, Monomial, Operation, Polynomial, Rational, Symbol, whole, with_reduced_powers,
};
use crate::testing::reading::read;
use crate::testing::symbol;

/// A quotient of two whole numbers.
fn ratio(numerator: i64, denominator: i64) -> Rational {
    Rational::new(numerator.into(), denominator.into())
}

/// The factor of a quantity.
fn atom(name: &str) -> Atom {
    Atom::Symbol(symbol(name))
}

/// Whether an expression contains a quantity.
fn contains(expression: &Fraction, name: &str) -> bool {
    expression.contains(&mut |own| own == symbol(name))
}

#[test]
fn decimals_are_exact() {
    assert_equal(&[
        "0.1 * 10 = 1",
        "0.1 + 0.2 = 0.3",
        "1.1 * 1.1 = 1.21",
        "4.5e7 * 2e-8 = 0.9",
        "x/3 * 3 = x",
        "0.7 x - 0.4 x - 0.3 x = 0",
    ]);
    assert_different(&["1/3 = 0.3333333333333333", "x = 1.0000000000000002 x"]);
    let numbers = [("0.1 * 10", ratio(1, 1)), ("2/3 - 1/6", ratio(1, 2)), ("-1.5^2", ratio(-9, 4))];
    for (text, expected) in numbers {
        assert_eq!(read(text).as_rational(), Some(expected), "{text}");
    }
    assert_eq!(read("x").as_rational(), None);
    for number in [f64::INFINITY, f64::NAN] {
        // It is no number, and nothing cancels it.
        assert!(Fraction::number(number).as_rational().is_none());
    }
}

#[test]
fn like_terms_are_added() {
    assert_equal(&[
        "x + y + x - y = 2 x",
        "x y + y x = 2 x y",
        "-(-x) = x",
        "x - x = 0",
        "x (y + z) - x y = x z",
        "(x + y)^2 = x^2 + 2 x y + y^2",
        "(x + y) (x - y) = x^2 - y^2",
    ]);
    assert_different(&["x + 1 = x", "x - y = y - x", "x^2 = x", "x = y", "x = p"]);
}

#[test]
fn quotients_have_a_common_denominator() {
    assert_equal(&[
        "(1 - Fs/(Fs + 50 F)) (Fs + 50 F)/(50 F) = 1",
        "x/(x + y) + y/(x + y) = 1",
        "1/x + 1/y = (x + y)/(x y)",
        "1/(x + 1) + 1/(x - 1) = 2 x/(x + 1)/(x - 1)",
        "x^2 (x + 1)^(-2) - (x + 1)^(-2) = (x - 1)/(x + 1)",
        "x (x + 1)^(-2) + (x + 1)^(-2) = 1/(x + 1)",
        "1/(x + 1) - 1/(x + 1) = 0",
    ]);
    assert_different(&["x/y = y/x", "1/(x + y) = 1/x + 1/y"]);
}

#[test]
fn common_factors_are_cancelled() {
    assert_equal(&[
        "(x^2 - y^2)/(x - y) = x + y",
        "(x^3 + 1)/(x + 1) = x^2 - x + 1",
        "(x^4 - 1)/(x^2 + 1)/(x + 1) = x - 1",
        "(x + y)^2/(x + y) = x + y",
        "(2 x + 2)/(x + 1) = 2",
        "(p x + p y)/(x + y) = p",
        "(x y + x)/(y + 1) = x",
        "(x/y - y/x)/(x - y) = 1/x + 1/y",
        "0/(x + 1) = 0",
    ]);
}

#[test]
fn a_division_with_a_remainder_stays() {
    let quotient = read("(x^2 + 1)/(2 x + 2)");
    assert_eq!(Fraction::from(quotient.numerator().clone()), read("x^2/2 + 0.5"));
    let divisors: Vec<(Fraction, u32)> =
        quotient.divisors().map(|(divisor, power)| (Fraction::from(divisor.clone()), power)).collect();
    assert_eq!(divisors, [(read("x + 1"), 1)]);
    assert_eq!(quotient.size(), 4);
    let [square, sum] = [read("x^2 + 1"), read("x + y")].map(|own| own.numerator().clone());
    assert_eq!(square.divided_by(&sum), None);
    assert_eq!(square.times(&sum).divided_by(&sum), Some(square));
    // The quotient of this division would have no end.
    assert_eq!(read("1").numerator().divided_by(read("1 - x").numerator()), None);
}

#[test]
fn the_reciprocal_of_a_sum_is_a_divisor() {
    assert_equal(&[
        "1/(2 x + 2 y) = 0.5/(x + y)",
        "1/(1/x + 1/y) = x y/(x + y)",
        "1/(x/(x + 1)) = 1 + 1/x",
        "1/(1/(x + y)) = x + y",
        "x/(y - x) = -x/(x - y)",
        "1/(p x + p y) = 1/p/(x + y)",
    ]);
}

#[test]
fn whole_powers_are_multiplied_out() {
    assert_equal(&[
        "x^0 = 1",
        "x^(-2) = 1/x^2",
        "x^12 = x^6 x^6",
        "(x^2)^3 = x^6",
        "(-2)^3 = -8",
        "(2 x/y)^3 = 8 x^3/y^3",
        "(x + 1)^(-2) (x + 1)^2 = 1",
        "x^0.5 = sqrt(x)",
        "x^1.5 = x sqrt(x)",
        "4^0.5 = 2",
        "2^0.5 = sqrt(2)",
    ]);
    assert_different(&["x^13 = x^12", "x^y = x^z", "x^0.3 = x"]);
    assert_eq!(read("2^0.3"), Fraction::number(Function::Power.apply(2.0, 0.3)));
}

#[test]
fn the_content_is_what_all_terms_have_in_common() {
    let (number, content, rest) = read("6 x^2 y - 3 x y").numerator().clone().into_primitive();
    assert_eq!(number, whole(6));
    assert_eq!(Fraction::from(Polynomial::term(whole(1), content)), read("x y"));
    assert_eq!(Fraction::from(rest), read("x - 0.5"));
    let (_, content, rest) = read("x/p + y/p^2").numerator().clone().into_primitive();
    assert_eq!(content, Monomial::power_of(atom("p"), -2));
    assert_eq!(Fraction::from(rest), read("p x + y"));
}

#[test]
fn powers_of_one_factor_are_collected() {
    let powers = read("x^2 y + 3 x^2 + x + 5").numerator().by_powers(&atom("x"));
    let expected =
        [(0, "5"), (1, "1"), (2, "y + 3")].map(|(power, text)| (power, read(text).numerator().clone()));
    assert_eq!(powers, BTreeMap::from(expected));
}

#[test]
fn powers_of_functions_are_reduced() {
    let square = |text: &str| read(text).numerator().times(read(text).numerator());
    for (text, expected) in
        [("abs(x)", "x^2"), ("sqrt(x + y)", "x + y"), ("step(x)", "step(x)"), ("y", "y^2")]
    {
        assert_eq!(Fraction::from(with_reduced_powers(square(text))), read(expected), "{text}");
    }
}

#[test]
fn symbols_are_replaced_everywhere() {
    let replaced = |text: &str, by: &str| {
        let by = read(by);
        read(text)
            .mapped(&mut |own: Symbol| if own == symbol("x") { by.clone() } else { Fraction::symbol(own) })
    };
    let cases = [
        ("x abs(x - y) + 1/(x + z)", "2", "2 abs(2 - y) + 1/(2 + z)"),
        ("abs(x)", "p", "p"),
        ("max(x, 0) + step(x)", "-1", "0"),
        ("1/(x - y)^2", "y + 1", "1"),
        ("sqrt(x)", "p^2", "p"),
    ];
    for (text, by, expected) in cases {
        assert_eq!(replaced(text, by), read(expected), "{text}");
    }
}

#[test]
fn functions_are_replaced_everywhere() {
    // |a| becomes a.
    let mut argument = |atom: &Atom| match atom {
        Atom::Apply(applied) if applied.operation == Operation::Absolute => {
            applied.arguments.first().cloned()
        }
        _ => None,
    };
    let cases = [
        ("y abs(x) + abs(x)/p", "x y + x/p"),
        ("sin(abs(x) + 1)/(abs(y) + 2)", "sin(x + 1)/(y + 2)"),
        ("max(x, y)", "x"),
        ("x y", "x y"),
    ];
    for (text, expected) in cases {
        assert_eq!(read(text).with_factors(&mut argument), read(expected), "{text}");
    }
}

#[test]
fn a_sum_is_split_by_a_condition() {
    let cases = [
        ("x y + x + 2 y + 3", ["x y + x", "2 y + 3"]),
        ("(x + y)/(1 + z)", ["x/(1 + z)", "y/(1 + z)"]),
        ("y + abs(x - y)", ["abs(x - y)", "y"]),
        ("y", ["0", "y"]),
    ];
    for (text, expected) in cases {
        let parts = read(text).split(&mut |term| contains(term, "x"));
        assert_eq!(parts, expected.map(read), "{text}");
    }
}

#[test]
fn an_expression_contains_the_symbols_in_it() {
    let cases = [
        ("x + abs(y)", "y", true),
        ("1/(x + z)", "z", true),
        ("sin(2 + 1/(1 + max(y, z)))", "z", true),
        ("x - x + y", "x", false),
        ("sin(x)", "y", false),
        ("0", "x", false),
    ];
    for (text, name, expected) in cases {
        assert_eq!(contains(&read(text), name), expected, "{text}");
    }
}

#[test]
fn the_order_of_products_is_kept_by_multiplication() {
    let texts = ["1", "x", "y", "x y", "1/x", "y/x", "x^2", "1/y", "p", "abs(x)", "x abs(x)"];
    let product = |text: &str| read(text).numerator().as_term().unwrap().0.clone();
    for (first, second) in texts.iter().flat_map(|first| texts.iter().map(move |second| (first, second))) {
        for factor in texts {
            let times = |text: &str| product(text).times(&product(factor));
            let order = product(first).cmp(&product(second));
            assert_eq!(times(first).cmp(&times(second)), order, "{first}, {second}, {factor}");
        }
    }
}
