//! Unit tests of the plain text.

use super::{
    call, compare, equation, friction, limited_rate, lorenz, measured, memory, name, negative, number,
    one_minus_square, oscillator, power, product, quotient, sum, van_der_pol, words,
};
use crate::notation::{Condition, LINE_WIDTH, Notation, Relation, equation_text, text};

/// Asserts the text of each expression.
fn check(cases: impl IntoIterator<Item = (Notation, &'static str)>) {
    for (notation, expected) in cases {
        assert_eq!(text(&notation), expected, "{notation:?}");
    }
}

/// a + b
fn a_plus_b() -> Notation {
    sum([name("a"), name("b")])
}

/// a b
fn a_times_b() -> Notation {
    product([name("a"), name("b")])
}

/// a/b
fn a_over_b() -> Notation {
    quotient(name("a"), name("b"))
}

#[test]
fn equations_read_as_in_a_textbook() {
    let cases = [
        (oscillator(), "v' = -(k/m) x - (c/m) v"),
        (friction(), "friction = Fs max(u, 0)^2"),
        (lorenz(), "x' = sigma (y - x)"),
        (memory(), "memory' = (max(1 - abs(v_o)/VcL, 0) - memory)/Tc"),
        (van_der_pol(), "v' = mu (1 - x^2) v - x"),
        (
            equation(product([name("m"), name("x''")]), negative(product([name("k"), name("x")]))),
            "m x'' = -k x",
        ),
    ];
    for (equation, expected) in cases {
        assert_eq!(equation_text(&equation, LINE_WIDTH), expected);
    }
}

#[test]
fn expressions_read_as_in_a_textbook() {
    let root = product([number(2.0), name("g"), name("h")]);
    check([
        (quotient(name("F"), name("m")), "F/m"),
        (product([measured(40.0, "1/s2"), name("x")]), "(40 1/s2) x"),
        (product([number(2.0), name("x"), name("y")]), "2 x y"),
        (quotient(product([name("x"), name("y")]), number(100.0)), "x y/100"),
        (call("sqrt", [root]), "sqrt(2 g h)"),
        (quotient(name("F"), product([name("m"), name("g")])), "F/(m g)"),
    ]);
}

#[test]
fn numbers_have_the_fewest_digits_that_are_exact() {
    check([
        (number(0.0), "0"),
        (number(0.1 + 0.2), "0.30000000000000004"),
        (number(1.0 / 3.0), "0.3333333333333333"),
        (number(45e6), "4.5e7"),
        (number(1e-5), "1e-5"),
        (number(1200.0), "1200"),
        (measured(9.81, "m/s2"), "9.81 m/s2"),
    ]);
}

#[test]
fn terms_keep_their_grouping() {
    check([
        (sum([name("c"), a_plus_b()]), "c + (a + b)"),
        (sum([a_plus_b(), name("c")]), "(a + b) + c"),
        (sum([name("c"), negative(a_plus_b())]), "c - (a + b)"),
        (sum([negative(a_plus_b()), name("c")]), "-(a + b) + c"),
        (sum([name("c"), negative(negative(name("a")))]), "c - (-a)"),
        (sum([name("c"), negative(a_times_b())]), "c - a b"),
        (sum([name("c"), negative(a_over_b())]), "c - a/b"),
        (sum([negative(name("a")), negative(name("b"))]), "-a - b"),
        (sum([name("v"), negative(measured(5.0, "mm/s"))]), "v - 5 mm/s"),
    ]);
}

#[test]
fn a_sign_is_in_front_of_a_term() {
    check([
        (negative(name("a")), "-a"),
        (negative(a_plus_b()), "-(a + b)"),
        (negative(negative(name("a"))), "-(-a)"),
        (negative(a_times_b()), "-a b"),
        (negative(a_over_b()), "-a/b"),
        (negative(power(name("a"), number(2.0))), "-a^2"),
    ]);
}

#[test]
fn factors_have_parentheses_if_they_need_them() {
    check([
        (product([name("c"), a_plus_b()]), "c (a + b)"),
        (product([a_plus_b(), a_plus_b()]), "(a + b) (a + b)"),
        (product([name("c"), negative(name("a"))]), "c (-a)"),
        (product([negative(name("a")), name("c")]), "(-a) c"),
        (product([name("c"), a_over_b()]), "c (a/b)"),
        (product([a_over_b(), a_over_b()]), "(a/b) (a/b)"),
        (product([name("c"), a_times_b()]), "c (a b)"),
        (product([name("c"), power(name("a"), number(2.0)), name("b")]), "c a^2 b"),
        (product([call("sin", [name("a")]), call("cos", [name("b")])]), "sin(a) cos(b)"),
    ]);
}

#[test]
fn factors_have_a_sign_only_if_they_would_be_misread() {
    check([
        (product([number(2.0), number(3.0)]), "2 * 3"),
        (product([name("x"), number(3.0), name("y")]), "x * 3 y"),
        (product([name("x"), power(number(2.0), name("n"))]), "x * 2^n"),
        (product([number(2.0), name("e3")]), "2 e3"),
        (product([number(2.0), a_plus_b()]), "2 (a + b)"),
        (product([name("step"), a_plus_b()]), "step * (a + b)"),
        (product([name("max"), name("a")]), "max * a"),
        (product([power(name("a"), name("sin")), a_plus_b()]), "a^sin * (a + b)"),
        (product([name("step'"), a_plus_b()]), "step' (a + b)"),
        (product([name("stepper"), a_plus_b()]), "stepper (a + b)"),
    ]);
}

#[test]
fn a_quotient_has_one_division() {
    check([
        (quotient(a_plus_b(), name("c")), "(a + b)/c"),
        (quotient(negative(name("a")), name("c")), "(-a)/c"),
        (quotient(a_over_b(), name("c")), "(a/b)/c"),
        (quotient(power(name("a"), number(2.0)), name("c")), "a^2/c"),
        (quotient(measured(2.0, "N"), name("c")), "(2 N)/c"),
        (quotient(name("c"), a_plus_b()), "c/(a + b)"),
        (quotient(name("c"), negative(name("a"))), "c/(-a)"),
        (quotient(name("c"), a_over_b()), "c/(a/b)"),
        (quotient(name("c"), a_times_b()), "c/(a b)"),
        (quotient(name("c"), power(name("a"), number(2.0))), "c/a^2"),
        (quotient(name("c"), call("abs", [name("a")])), "c/abs(a)"),
        (quotient(number(1.0), number(2.0)), "1/2"),
    ]);
}

#[test]
fn bases_and_exponents_are_single_signs_or_in_parentheses() {
    let base = |base: Notation| power(base, number(2.0));
    let exponent = |exponent: Notation| power(name("c"), exponent);
    check([
        (base(a_plus_b()), "(a + b)^2"),
        (base(negative(name("a"))), "(-a)^2"),
        (base(a_times_b()), "(a b)^2"),
        (base(a_over_b()), "(a/b)^2"),
        (base(power(name("a"), name("b"))), "(a^b)^2"),
        (base(name("x''")), "x''^2"),
        (base(number(10.0)), "10^2"),
        (base(measured(10.0, "s")), "(10 s)^2"),
        (exponent(name("n")), "c^n"),
        (exponent(number(0.5)), "c^0.5"),
        (exponent(call("abs", [name("a")])), "c^abs(a)"),
        (exponent(negative(number(1.0))), "c^(-1)"),
        (exponent(a_plus_b()), "c^(a + b)"),
        (exponent(a_times_b()), "c^(a b)"),
        (exponent(a_over_b()), "c^(a/b)"),
        (exponent(power(name("a"), name("b"))), "c^(a^b)"),
    ]);
}

#[test]
fn arguments_have_no_parentheses() {
    check([
        (call("max", [a_plus_b(), negative(name("c"))]), "max(a + b, -c)"),
        (call("delay", [name("v"), measured(0.1, "s")]), "delay(v, 0.1 s)"),
        (call("spring", [a_over_b()]), "spring(a/b)"),
    ]);
}

#[test]
fn sums_and_products_of_one_operand_are_the_operand() {
    check([
        (sum([name("a")]), "a"),
        (product([sum([negative(name("a"))]), name("b")]), "(-a) b"),
        (sum([name("b"), product([negative(name("a"))])]), "b - a"),
        (power(product([a_plus_b()]), number(2.0)), "(a + b)^2"),
        (sum([name("a"), sum([])]), "a + 0"),
        (power(product([]), name("n")), "1^n"),
    ]);
}

#[test]
fn a_number_with_a_sign_is_grouped_as_a_negative_one() {
    check([
        (product([name("a"), number(-3.0)]), "a (-3)"),
        (sum([name("a"), number(-3.0)]), "a + (-3)"),
        (negative(number(-3.0)), "-(-3)"),
    ]);
}

#[test]
fn nested_cases_are_on_one_line() {
    check([
        (limited_rate(), "{0 if x >= 100 and v > 0; v - x otherwise}"),
        (product([number(2.0), limited_rate()]), "2 {0 if x >= 100 and v > 0; v - x otherwise}"),
    ]);
}

#[test]
fn conditions_have_relations_or_words() {
    let case = |comparison| Notation::Cases(vec![(number(1.0), Some(Condition(vec![comparison])))]);
    let compared = |relation| case(compare(name("x"), relation, negative(name("a"))));
    check([
        (compared(Relation::Less), "{1 if x < -a}"),
        (compared(Relation::AtMost), "{1 if x <= -a}"),
        (compared(Relation::Greater), "{1 if x > -a}"),
        (compared(Relation::AtLeast), "{1 if x >= -a}"),
        (compared(Relation::Equal), "{1 if x = -a}"),
        (case(words("R is pulled in")), "{1 if R is pulled in}"),
        (Notation::Cases(vec![(number(1.0), Some(Condition(Vec::new())))]), "{1 otherwise}"),
    ]);
}

#[test]
fn an_equation_with_cases_has_a_line_for_each() {
    let expected = "y' = 0             if x >= 100 and v > 0\n     v - x         otherwise";
    assert_eq!(equation_text(&equation(name("y'"), limited_rate()), LINE_WIDTH), expected);
}

#[test]
fn long_values_widen_the_column() {
    let condition = Condition(vec![words("R is pulled in")]);
    let product = product([name("mu"), one_minus_square(), name("v")]);
    let cases = Notation::Cases(vec![(product, Some(condition)), (number(0.0), None)]);
    let expected = "a = mu (1 - x^2) v  if R is pulled in\n    0               otherwise";
    assert_eq!(equation_text(&equation(name("a"), cases), LINE_WIDTH), expected);
}

#[test]
fn a_long_sum_has_line_breaks_before_signs() {
    let right = sum([name("aa"), negative(name("bb")), name("cc"), negative(name("dd"))]);
    let long = equation(name("x'"), right);
    assert_eq!(equation_text(&long, 22), "x' = aa - bb + cc - dd");
    assert_eq!(equation_text(&long, 21), "x' = aa - bb + cc\n     - dd");
    assert_eq!(equation_text(&long, 14), "x' = aa - bb\n     + cc - dd");
    assert_eq!(equation_text(&long, 11), "x' = aa\n     - bb\n     + cc\n     - dd");
    assert_eq!(equation_text(&long, 0), "x' = aa\n     - bb\n     + cc\n     - dd");
}

#[test]
fn only_sums_have_line_breaks() {
    let long = equation(name("x"), product([name("aa"), a_plus_b()]));
    assert_eq!(equation_text(&long, 5), "x = aa (a + b)");
    assert_eq!(equation_text(&equation(name("x"), sum([])), 5), "x = 0");
}
