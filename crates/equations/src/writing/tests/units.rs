//! Numbers with units.

use patchcord_core::circuit::Circuit;
use patchcord_core::patch::{ElementBuilder, PatchBuilder};

use super::{Fixture, Purity, dimension};

#[test]
fn numbers_have_the_unit_that_their_place_requires() {
    let fixture = Fixture::new();
    let cases = [
        ("40 x", "m/s2", "(40 1/s2) x"),
        ("5 v", "1", "(5 s/m) v"),
        ("2 x", "m", "2 x"),
        ("x/3", "m", "x/3"),
        ("F/m - 9.81", "m/s2", "F/m - 9.81 m/s2"),
        ("v - 0.01", "m/s", "v - 0.01 m/s"),
        ("k (x - 0.2)", "N", "k (x - 0.2 m)"),
        ("k x + 2", "N", "k x + 2 N"),
        ("F (1 - v/10)", "N", "F (1 - (0.1 s/m) v)"),
        ("x (x - 0.1)", "m2", "(x - 0.1 m) x"),
        ("g t^2/2", "m", "0.5 g t^2"),
        ("sqrt(2 g h)", "m/s", "sqrt(2 g h)"),
        ("sqrt(x^2 + 4)", "m", "sqrt(x^2 + 4 m2)"),
        ("sin(0.5 x)", "1", "sin((0.5 1/m) x)"),
        ("exp(-t/2)", "1", "exp(-(0.5 1/s) t)"),
        ("delay(x, 0.5)", "m", "delay(x, 0.5 s)"),
        ("max(v - 0.01, 0)", "m/s", "max(v - 0.01 m/s, 0)"),
        ("max(x, 0.5)", "m", "max(x, 0.5 m)"),
        ("1/(x + 0.5)", "1/s", "(1 m/s)/(x + 0.5 m)"),
        ("F step(x - 0.1)", "N", "{F if x >= 0.1 m; 0 otherwise}"),
        ("100 step(t - 1)", "N", "{0 if t < 1 s; 100 N otherwise}"),
        ("t - 0.1 floor(10 t)", "s", "t - (0.1 s) floor((10 1/s) t)"),
        ("3", "s", "3 s"),
        ("-5", "m", "-5 m"),
        ("0", "m", "0"),
    ];
    for (expression, unit, expected) in cases {
        assert_eq!(fixture.written(Purity::Physical, expression, unit), expected, "{expression}");
    }
}

#[test]
fn times_are_pure_numbers_if_no_quantity_of_the_patch_has_a_time() {
    let fixture = Fixture::new();
    let cases = [
        ("40 x", "m/s2", "40 x"),
        ("v - 0.01", "m/s", "v - 0.01 m"),
        ("exp(-t/2)", "1", "exp(-0.5 t)"),
        ("F step(t - 3)", "N", "{0 if t < 3; F otherwise}"),
        ("3", "s", "3"),
        ("3", "V/s", "3 V"),
        ("3", "m/(s V)", "3 m/V"),
    ];
    for (expression, unit, expected) in cases {
        assert_eq!(fixture.written(Purity::Times, expression, unit), expected, "{expression}");
    }
}

#[test]
fn the_units_of_a_patch_decide_which_dimensions_are_pure_numbers() {
    let purity = |parameter: &str, scale: &str| {
        let patch = PatchBuilder::new("units")
            .parameter("p", 1.0, parameter, [0.5, 2.0])
            .scale("s", 1.0, scale)
            .element("A1", ElementBuilder::new("integrator").cords("x1", ["A1"]).set("initial", 1))
            .build()
            .unwrap();
        Purity::of(&Circuit::new(&patch).unwrap())
    };
    let cases = [
        ("1", "V", Purity::All),
        ("1", "1", Purity::All),
        ("1", "m", Purity::Times),
        ("K", "m2", Purity::Times),
        ("V", "m", Purity::Times),
        ("s", "1", Purity::Physical),
        ("m", "m/s", Purity::Physical),
        ("N", "m", Purity::Physical),
    ];
    for (parameter, scale, expected) in cases {
        assert_eq!(purity(parameter, scale), expected, "{parameter}, {scale}");
    }
}

#[test]
fn an_expression_has_the_dimension_of_a_term_with_a_variable() {
    let fixture = Fixture::new();
    let writer = fixture.writer(Purity::Physical);
    let cases = [
        ("k x + 2", "N"),
        ("2 + m x", "kg m"),
        ("k + c", "N s/m"),
        ("x/(y + 1)", "1"),
        ("abs(v)", "m/s"),
        ("max(x, 2)", "m"),
        ("sqrt(g h)", "m/s"),
        ("delay(v, Tc)", "m/s"),
        ("sin(x)", "1"),
        ("step(x)", "1"),
        // The number of the other term gets the unit.
        ("t - 0.1 floor(10 t)", "s"),
        ("3 v - sin(x)", "1"),
    ];
    for (expression, unit) in cases {
        assert_eq!(writer.dimension(&fixture.read(expression)), Some(dimension(unit)), "{expression}");
    }
    assert_eq!(writer.dimension(&fixture.read("3")), None);
}
