//! Tests of formulas that change by one factor.

use super::*;

/// The product of a formula.
fn product(text: &str) -> Product {
    Product::new(&json!(text)).unwrap()
}

#[test]
fn a_number_of_the_formula_takes_a_factor() {
    let cases = [
        ("K * position / force / 100", 10.0, "K * position / force / 10"),
        ("k / m / 10", 10.0, "k / m"),
        ("k / m", 0.1, "k / m / 10"),
        ("k / m", 10.0, "k / m * 10"),
        ("50 * m * v^2 / energy", 0.1, "5 * m * v^2 / energy"),
        ("10 * y0 / lynxes", 0.1, "y0 / lynxes"),
        ("k / 10 / 10", 10.0, "k / 10"),
        ("sqrt(0.5) / 10", 10.0, "sqrt(0.5)"),
        ("2 * pi / 10", 10.0, "2 * pi"),
        ("a + b", 0.1, "(a + b) / 10"),
        ("(a) + (b)", 0.1, "((a) + (b)) / 10"),
        ("2.6666666666666665 * k / 10", 10.0, "2.6666666666666665 * k"),
        ("1", 0.1, "0.1"),
    ];
    for (text, factor, expected) in cases {
        assert_eq!(product(text).times(factor).value(), json!(expected), "{text}");
    }
    assert_eq!(Product::new(&json!(0.3)).unwrap().times(0.1).value(), json!(0.03));
    assert_eq!(Product::new(&json!(-5)).unwrap().times(10.0).value(), json!(-50));
    assert_eq!(Product::new(&json!(10)).unwrap().times(1.0 / 3.0).value(), json!(3.333_333_333_33));
}

#[test]
fn a_precise_number_with_many_digits_is_a_quotient() {
    let cases = [
        (json!(10), 1.0 / 3.0, json!("10 / 3")),
        (json!(-100), 5.0 / 7.0, json!("-500 / 7")),
        (json!("f / force"), 5.0 / 4.536, json!("f / force * 625 / 567")),
        (json!("f / force / 100"), 49.0 / 250.0, json!("f / force / 25000 * 49")),
        (json!("k / 3"), 3.0, json!("k")),
        (json!("k / m"), 0.9, json!("k / m * 0.9")),
        (json!("k / m"), 0.8, json!("k / m / 1.25")),
        (json!(10), 0.345, json!(3.45)),
        (json!(10), 2f64.sqrt(), json!(14.142_135_623_731)),
    ];
    for (value, factor, expected) in cases {
        assert_eq!(Product::new(&value).unwrap().times_precisely(factor).value(), expected, "{value}");
    }
}

#[test]
fn a_name_cancels_the_same_name_below_the_line() {
    let cases = [
        ("rho / 100 * flow", "difference", true, "rho / 100 * flow / difference"),
        ("a / b", "b", false, "a"),
        ("a / b^2", "b", false, "a / b^2 * b"),
        ("a", "a", true, "1"),
        ("1", "mu", false, "mu"),
        ("1", "mu", true, "1 / mu"),
    ];
    for (text, name, divides, expected) in cases {
        assert_eq!(product(text).times_name(name, divides).value(), json!(expected), "{text}");
    }
    let number = Product::new(&json!(0.4)).unwrap();
    assert_eq!(number.times_name("k", false).value(), json!("0.4 * k"));
}

#[test]
fn two_minus_signs_cancel() {
    let cases = [
        ("x0 / position", "-x0 / position"),
        ("-x0 / position", "x0 / position"),
        ("-(-(Fk + drop) / K)", "-(Fk + drop) / K"),
        ("a - b", "-(a - b)"),
        ("a * (-b)", "a * b"),
    ];
    for (text, expected) in cases {
        assert_eq!(product(text).negated().value(), json!(expected), "{text}");
    }
    assert_eq!(Product::new(&json!(-100)).unwrap().negated().value(), json!(100));
}

#[test]
fn named_factors_above_and_below_the_line_are_exchanged() {
    let found: Vec<Value> =
        product("velocity / position / 10").exchanges().iter().map(|(_, product)| product.value()).collect();
    assert_eq!(found, [json!("position / velocity / 10")]);
    assert_eq!(product("a * b / c^2 / d").exchanges().len(), 4);
    assert!(product("a / (b + c)").exchanges().is_empty());
}

#[test]
fn divisors_that_are_powers_of_ten_count() {
    let cases =
        [("k / 100", 2), ("0.1 * k", 1), ("k", 0), ("50 * k", 0), ("100 * k / 10", 1), ("k / 10 / 10", 2)];
    for (text, expected) in cases {
        assert_eq!(product(text).divided_decades(), expected, "{text}");
    }
}

#[test]
fn every_name_of_a_formula_can_be_another() {
    let others = |name: &str| if name == "c" { vec!["k", "d"] } else { Vec::new() };
    let found = renamed(&json!("sqrt(c / m) + c"), others);
    let texts: Vec<&str> = found.iter().filter_map(Value::as_str).collect();
    assert_eq!(texts, ["sqrt(k / m) + c", "sqrt(d / m) + c", "sqrt(c / m) + k", "sqrt(c / m) + d"]);
    assert!(renamed(&json!(5), |_| vec!["k"]).is_empty());
}

#[test]
fn other_values_are_no_products() {
    for value in [json!(null), json!([1]), json!("k *"), json!(true)] {
        assert_eq!(Product::new(&value), None, "{value}");
    }
}
