//! Grouping, order and factors.

use super::{check, check_unchanged};

#[test]
fn equations_read_as_in_a_textbook() {
    check(&[
        ("sigma y - sigma x", "sigma (y - x)"),
        ("mu v - mu x^2 v - x", "mu (1 - x^2) v - x"),
        ("(F - k x - c v)/m", "F/m - (k/m) x - (c/m) v"),
        ("max(VcL - abs(v), 0)/(VcL Tc) - u/Tc", "(max(1 - abs(v)/VcL, 0) - u)/Tc"),
        ("Fs u max(u, 0)", "Fs max(u, 0)^2"),
        ("2 q pump y - a y", "(2 q pump - a) y"),
        ("g sin(x)/w", "(g/w) sin(x)"),
        ("2 sqrt(g h/2)", "sqrt(2 g h)"),
        ("exp(0.3 ln(x))", "x^0.3"),
    ]);
    check_unchanged(&[
        "exp(-t/Tc)",
        "x sqrt(x^2 + y^2)",
        "k v abs(v)",
        "2 x x'",
        "atan2(x, y)",
        "delay(x, Tc)",
    ]);
}

#[test]
fn terms_with_equal_constants_have_a_common_factor() {
    check(&[
        ("k x y + c x", "(k y + c) x"),
        ("k x + k y - k x^2", "k (x + y - x^2)"),
        ("-k x - k y", "-k (x + y)"),
        ("2 k x + 2 k y", "2 k (x + y)"),
        ("2 k x + 3 k y", "k (2 x + 3 y)"),
        ("k x/m + k y/m", "(k/m) (x + y)"),
        ("x^3 - x", "(x^2 - 1) x"),
        ("-2 q pump y - a y", "-(2 q pump + a) y"),
    ]);
    check_unchanged(&["x + y", "2 x + 2 y", "k x + c y", "k x y + c x z"]);
}

#[test]
fn a_positive_term_is_first() {
    check(&[("-x + y", "y - x"), ("-x - 3 + y", "y - x - 3"), ("-k x + F", "F - k x")]);
    check_unchanged(&["3 - x", "x - y + 2", "-x - y", "-x", "-k", "-x - 3"]);
}

#[test]
fn terms_of_low_degree_are_first_and_constants_are_last() {
    check(&[
        ("m - c y + k x", "k x - c y + m"),
        ("2 + x^2 + x", "x + x^2 + 2"),
        ("-x^3/3 - y + x", "x - y - x^3/3"),
        ("x y + z", "z + x y"),
        ("k t + 3 + x", "x + 3 + k t"),
        ("2 t + 1", "1 + 2 t"),
    ]);
}

#[test]
fn small_quotients_are_not_decimals() {
    check(&[
        ("0.5 x", "0.5 x"),
        ("x/8", "0.125 x"),
        ("x y/100", "0.01 x y"),
        ("2 x/3", "(2/3) x"),
        ("k x/3", "(k/3) x"),
        ("2 k x/3", "(2 k/3) x"),
        ("1/3", "1/3"),
        ("x/16384", "6.103515625e-5 x"),
    ]);
    check_unchanged(&["x/3", "-x/3", "x/7 - y/3", "x/4096"]);
}

#[test]
fn divisors_are_below_the_terms_that_they_divide() {
    check(&[
        ("x (1 + y)^(-2)", "x/(y + 1)^2"),
        ("(x + 1)/(2 y + 2)", "(0.5 x + 0.5)/(y + 1)"),
        ("1/(k + 1) - x/(k + 1)", "(1 - x)/(1 + k)"),
        ("k/x + k y/x", "k (y + 1)/x"),
    ]);
    check_unchanged(&[
        "x/y",
        "k x/y",
        "x/k",
        "x y/k",
        "1/k",
        "1/x",
        "k/(m x)",
        "x^2/y",
        "x/(y + 1)",
        "-x/(y + 1)",
    ]);
}

#[test]
fn absolute_values_are_written_as_maxima_if_that_is_shorter() {
    check(&[
        ("(x + abs(x))/2", "max(x, 0)"),
        ("x + abs(x)", "2 max(x, 0)"),
        ("(x + y + abs(x - y))/2", "max(x, y)"),
        ("max(x, 0) - x", "max(-x, 0)"),
        ("min(y, x)", "min(y, x)"),
        ("max(k x, 0)", "k max(x, 0)"),
        ("k x - max(k x, 0)", "k min(x, 0)"),
        ("abs(x)/2", "0.5 abs(x)"),
        ("u max(u, 0)", "max(u, 0)^2"),
        ("u^2 max(u, 0)", "max(u, 0)^3"),
        ("max(x - y, 0) - max(y - x, 0)", "x - y"),
    ]);
    check_unchanged(&[
        "abs(x)",
        "-abs(x)",
        "-max(x, 0)",
        "min(x, 0)",
        "max(x, -w)",
        "min(x, w)",
        "min(k x, F)",
        "max(abs(x) - 1, 0)",
        "max(x, 0) - max(y, 0)",
    ]);
}

#[test]
fn a_dead_zone_and_a_clamp_have_minima_and_maxima() {
    check_unchanged(&[
        "max(x - w, 0) + min(x + w, 0)",
        "k (max(x - w, 0) + min(x + w, 0))",
        "min(max(x, 0), w)",
        "k min(max(x, 0), w)",
    ]);
}
