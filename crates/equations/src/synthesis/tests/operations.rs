//! Every operation as a small circuit with the right voltages.

use super::{Reading, Sketch, assert_close};
use crate::graph::{FunctionKind, NodeId, Operation};
use crate::symbolic::Fraction;

/// A problem with constants a and b, a quantity y with this equation, and further sections.
fn problem(equation: &str, sections: &str) -> Sketch {
    Sketch::new(&format!(
        r#"{{"patchcord": 1, "parameters": {{"p": {{"value": 2.5, "unit": "1", "range": [0.5, 5]}}}},
        "quantities": {{"a": {{"unit": "1", "initial": 1}}, "b": {{"unit": "1", "initial": 1}},
            "y": {{"unit": "1"}}}}, {sections}
        "equations": ["a' = 0", "b' = 0", "{equation}"], "run": {{"for": 1, "step": 1e-3}}}}"#
    ))
}

/// The value of y = operation(a, b), where a is the node 0, b the node 1 and the number 1 the node 2.
fn value(
    equation: &str,
    [a, b]: [f64; 2],
    expected: f64,
    operation: &dyn Fn(&mut Sketch) -> Operation,
) -> f64 {
    let mut sketch = problem(equation, "");
    sketch.constant("a", a);
    sketch.constant("b", b);
    sketch.node("1", "1", [1.0, 1.0], 0.0, Operation::One);
    let operation = operation(&mut sketch);
    let peak = expected.abs();
    sketch.node("y", "1", [-peak, peak], 0.0, operation);
    // The value of y is in the node that was added last.
    Reading::of(&sketch.with_quantities().synthesis()).value("y")
}

/// Adds a node without a name to the sketch, and returns its index.
fn add(sketch: &mut Sketch, name: &str, range: [f64; 2], operation: Operation) -> u32 {
    sketch.node(name, "1", range, 0.0, operation);
    sketch.plan.nodes.len() as u32 - 1
}

/// Four pairs of constants with all signs.
const PAIRS: [[f64; 2]; 4] = [[3.0, 2.0], [-3.0, 2.0], [3.0, -0.4], [-3.0, -0.4]];

#[test]
fn sums_have_pots_gains_and_the_reference() {
    for [a, b] in PAIRS {
        let expected = 1.0 - 2.5 * a + 0.3 * b;
        let sum = |sketch: &mut Sketch| Operation::Sum(sketch.sum(&[("-p", 0), ("0.3", 1), ("1", 2)]));
        assert_close(value("y = 1 - p a + 0.3 b", [a, b], expected, &sum), expected);
        let small = |sketch: &mut Sketch| Operation::Sum(sketch.sum(&[("p - 2", 0), ("-0.01", 1)]));
        let expected = 0.5 * a - 0.01 * b;
        assert_close(value("y = (p - 2) a - 0.01 b", [a, b], expected, &small), expected);
    }
}

#[test]
fn a_constant_is_a_pot_at_the_reference() {
    let constant = |sketch: &mut Sketch| Operation::Sum(sketch.sum(&[("-p", 2)]));
    assert_close(value("y = -p", PAIRS[0], -2.5, &constant), -2.5);
}

#[test]
fn multipliers_multiply_with_all_signs() {
    for [a, b] in PAIRS {
        let product = |_: &mut Sketch| Operation::Product([NodeId(0), NodeId(1)]);
        assert_close(value("y = a b", [a, b], a * b, &product), a * b);
        let negative_square = |sketch: &mut Sketch| {
            let square = add(sketch, "a^2", [a * a, a * a], Operation::Product([NodeId(0), NodeId(0)]));
            Operation::Sum(sketch.sum(&[("-1", square)]))
        };
        assert_close(value("y = -a^2", [a, b], -a * a, &negative_square), -a * a);
    }
}

#[test]
fn quotients_divide_by_divisors_of_both_signs() {
    for [a, b] in PAIRS {
        let quotient = |sketch: &mut Sketch| Operation::Quotient {
            dividend: sketch.sum(&[("p", 0), ("1", 2)]),
            divisor: NodeId(1),
        };
        let expected = (2.5 * a + 1.0) / b;
        assert_close(value("y = (p a + 1) / b", [a, b], expected, &quotient), expected);
    }
}

#[test]
fn the_feedback_of_a_quotient_fits_small_and_large_coefficients() {
    // (3 - 2.9) / 2: the dividend is a small difference of large voltages, so its coefficients are above 10.
    let small_difference = |sketch: &mut Sketch| Operation::Quotient {
        dividend: sketch.sum(&[("1", 0), ("-2.9", 2)]),
        divisor: NodeId(1),
    };
    assert_close(value("y = (a - 2.9) / b", PAIRS[0], 0.05, &small_difference), 0.05);
    // The maximum of y is large, so the coefficient of the dividend is below 0.1.
    let mut sketch = Sketch::new(
        r#"{"patchcord": 1, "quantities": {"a": {"unit": "1", "initial": 3}, "b": {"unit": "1", "initial": 2},
            "y": {"unit": "1", "maximum": 100}},
        "equations": ["a' = 0", "b' = 0", "y = a / b"], "run": {"for": 1, "step": 1e-3}}"#,
    );
    sketch.constant("a", 3.0);
    sketch.constant("b", 2.0);
    let dividend = sketch.sum(&[("1", 0)]);
    sketch.node("y", "1", [1.5, 1.5], 0.0, Operation::Quotient { dividend, divisor: NodeId(1) });
    assert_close(Reading::of(&sketch.with_quantities().synthesis()).value("y"), 1.5);
}

#[test]
fn roots_are_positive() {
    for a in [3.0_f64, 0.02] {
        let root = |sketch: &mut Sketch| Operation::Root(sketch.sum(&[("p", 0)]));
        let expected = (2.5 * a).sqrt();
        assert_close(value("y = sqrt(p a)", [a, 1.0], expected, &root), expected);
    }
    let of_negative = |sketch: &mut Sketch| Operation::Root(sketch.sum(&[("-1", 0), ("1", 2)]));
    assert_close(value("y = sqrt(1 - a)", [-3.0, 1.0], 2.0, &of_negative), 2.0);
}

#[test]
fn the_error_of_a_quotient_by_its_finite_amplification_is_small() {
    // The divisor has 80 V, so the error is 1.25 / (10 x 1e9) with a gain of 10 in the feedback.
    let quotient = |sketch: &mut Sketch| Operation::Quotient {
        dividend: sketch.sum(&[("p", 0), ("1", 2)]),
        divisor: NodeId(1),
    };
    let expected = (2.5 * 2.2 + 1.0) / 2.0;
    let found = value("y = (p a + 1) / b", [2.2, 2.0], expected, &quotient);
    assert!((found / expected - 1.0).abs() < 1e-9, "{found} instead of {expected}");
}

/// The node y = atan(coefficient a): sin(y) - coefficient a cos(y) = 0.
fn arctangent(sketch: &mut Sketch, coefficient: &str) -> Operation {
    let y = sketch.plan.nodes.len() as u32 + 3;
    let function = |sketch: &mut Sketch, kind, name: &str| {
        let argument = sketch.term("1", y);
        add(sketch, name, [-1.0, 1.0], Operation::Function { kind, argument })
    };
    let sine = function(sketch, FunctionKind::Sin, "sin(y)");
    let cosine = function(sketch, FunctionKind::Cos, "cos(y)");
    let product = Operation::Product([NodeId(0), NodeId(cosine)]);
    let product = add(sketch, "a cos(y)", [-1.0, 1.0], product);
    Operation::Zero(sketch.sum(&[("1", sine), (coefficient, product)]))
}

#[test]
fn an_open_amplifier_solves_an_equation() {
    // It is the only solution within ±100 V.
    for a in [0.5, -1.0] {
        let solution = |sketch: &mut Sketch| arctangent(sketch, "-1");
        assert_close(value("y = atan(a)", [a, 1.0], a.atan(), &solution), a.atan());
        // The largest coefficient is that of the parameter, which can rise.
        let solution = |sketch: &mut Sketch| arctangent(sketch, "-p");
        let expected = (2.5 * a / 2.0).atan();
        assert_close(value("y = atan(p a)", [a / 2.0, 1.0], expected, &solution), expected);
    }
}

#[test]
fn the_inputs_of_an_open_amplifier_have_the_largest_gain() {
    // The scales are 5 mV of a and 15 mV of sine and cosine. So the weights are 15e-3 and 2.5 x 100 x 5e-3 x 15e-3.
    let mut sketch = problem("y = atan(p a)", "");
    sketch.constant("a", 0.4);
    sketch.constant("b", 1.0);
    sketch.node("1", "1", [1.0, 1.0], 0.0, Operation::One);
    let solution = arctangent(&mut sketch, "-p");
    sketch.node("y", "1", [0.7, 0.8], 0.0, solution);
    let made = sketch.with_quantities().synthesis();
    let open = made.patch.elements.values().find(|element| element.kind.name == "open-amplifier").unwrap();
    let jacks: Vec<&str> = open.plugs.iter().map(|plug| plug.jack.value.as_str()).collect();
    assert_eq!(jacks, ["x10", "x10"]);
}

#[test]
fn an_angle_far_from_0_has_a_range_around_its_middle() {
    // y = atan2(a, b) = atan2(3, -1) = 1.89 rad, between 1.5 and 2.3 rad: the opposite angle is -1.25 rad.
    let mut sketch = problem("y = atan2(a, b)", "");
    sketch.constant("a", 3.0);
    sketch.constant("b", -1.0);
    let function = |sketch: &mut Sketch, kind, name: &str| {
        let argument = sketch.term("1", 6);
        add(sketch, name, [-1.0, 1.0], Operation::Function { kind, argument })
    };
    let sine = function(&mut sketch, FunctionKind::Sin, "sin(y)");
    let cosine = function(&mut sketch, FunctionKind::Cos, "cos(y)");
    let [first, second] = [(1, sine, "b sin(y)"), (0, cosine, "a cos(y)")].map(|(node, wave, name)| {
        add(&mut sketch, name, [-3.0, 3.0], Operation::Product([NodeId(node), NodeId(wave)]))
    });
    let solution = Operation::Zero(sketch.sum(&[("1", first), ("-1", second)]));
    sketch.node("y", "1", [1.5, 2.3], 0.0, solution);
    let made = sketch.with_quantities().synthesis();
    assert_close(Reading::of(&made).value("y"), 3f64.atan2(-1.0));
}

#[test]
fn diode_pairs_compute_absolute_values_and_the_lower_and_higher_of_two() {
    for [a, b] in PAIRS {
        let absolute = |_: &mut Sketch| Operation::Absolute(NodeId(0));
        assert_close(value("y = abs(a)", [a, b], a.abs(), &absolute), a.abs());
        let negative = |sketch: &mut Sketch| {
            let size = add(sketch, "abs(a)", [0.0, a.abs()], Operation::Absolute(NodeId(0)));
            Operation::Sum(sketch.sum(&[("-1", size)]))
        };
        assert_close(value("y = -abs(a)", [a, b], -a.abs(), &negative), -a.abs());
        let terms = |sketch: &Sketch| [sketch.term("p", 0), sketch.term("0.5", 1)];
        let lower = |sketch: &mut Sketch| Operation::Lower(terms(sketch));
        let expected = (2.5 * a).min(0.5 * b);
        assert_close(value("y = min(p a, 0.5 b)", [a, b], expected, &lower), expected);
        let higher = |sketch: &mut Sketch| Operation::Higher(terms(sketch));
        let expected = (2.5 * a).max(0.5 * b);
        assert_close(value("y = max(p a, 0.5 b)", [a, b], expected, &higher), expected);
        let negative_lower = |sketch: &mut Sketch| {
            let terms = terms(sketch);
            let lower = add(sketch, "min(p a, 0.5 b)", [-8.0, 8.0], Operation::Lower(terms));
            Operation::Sum(sketch.sum(&[("-1", lower)]))
        };
        let expected = -(2.5 * a).min(0.5 * b);
        assert_close(value("y = -min(p a, 0.5 b)", [a, b], expected, &negative_lower), expected);
    }
}

#[test]
fn dead_zones_have_constant_and_variable_widths() {
    let zone = |x: f64, width: f64| (x - width).max(0.0) + (x + width).min(0.0);
    for a in [3.0, -3.0, 1.0] {
        let constant = |sketch: &mut Sketch| {
            let width = sketch.term("p / 2", 2);
            Operation::DeadZone { input: NodeId(0), width }
        };
        let expected = zone(a, 1.25);
        assert_close(value("y = dead_zone(a, p / 2)", [a, 1.0], expected, &constant), expected);
        let variable = |sketch: &mut Sketch| {
            let width = sketch.term("p", 1);
            Operation::DeadZone { input: NodeId(0), width }
        };
        let expected = zone(a, 2.5 * 0.8);
        assert_close(value("y = dead_zone(a, p b)", [a, 0.8], expected, &variable), expected);
    }
}

#[test]
fn comparators_switch_between_two_values() {
    for a in [3.0, -3.0, 0.0] {
        let sign = |_: &mut Sketch| Operation::Switch {
            input: NodeId(0),
            at_least_0: Fraction::whole(1),
            below_0: Fraction::whole(-1),
        };
        let expected = if a < 0.0 { -1.0 } else { 1.0 };
        assert_close(value("y = 2 step(a) - 1", [a, 1.0], expected, &sign), expected);
        // An odd number of inversions between a and the comparator.
        let of_negative = |sketch: &mut Sketch| {
            let negative = Operation::Sum(sketch.sum(&[("-1", 0)]));
            let input = NodeId(add(sketch, "-a", [-a, -a], negative));
            let (at_least_0, below_0) = (sketch.read("p"), Fraction::zero());
            Operation::Switch { input, at_least_0, below_0 }
        };
        let expected = if a <= 0.0 { 2.5 } else { 0.0 };
        assert_close(value("y = p step(-a)", [a, 1.0], expected, &of_negative), expected);
    }
}

#[test]
fn limiters_have_one_or_two_bounds() {
    for a in [3.0_f64, -3.0, 0.2] {
        let both = |sketch: &mut Sketch| Operation::Limited {
            sum: sketch.sum(&[("2", 0)]),
            lower: Some(sketch.read("-p")),
            upper: Some(sketch.read("3")),
        };
        let expected = (2.0 * a).clamp(-2.5, 3.0);
        assert_close(value("y = limit(2 a, -p, 3)", [a, 1.0], expected, &both), expected);
        let negative = |sketch: &mut Sketch| {
            let limited = Operation::Limited {
                sum: sketch.sum(&[("1", 0)]),
                lower: Some(Fraction::zero()),
                upper: None,
            };
            let limited = add(sketch, "max(a, 0)", [0.0, 3.0], limited);
            Operation::Sum(sketch.sum(&[("-0.7", limited)]))
        };
        let expected = -0.7 * a.max(0.0);
        assert_close(value("y = -0.7 max(a, 0)", [a, 1.0], expected, &negative), expected);
    }
}

/// The value of a function of a coefficient times a.
fn function_value(kind: FunctionKind, coefficient: &str, a: f64, expected: f64) -> f64 {
    let function = |sketch: &mut Sketch| {
        let argument = sketch.term(coefficient, 0);
        Operation::Function { kind, argument }
    };
    value("y = a", [a, 1.0], expected, &function)
}

#[test]
fn sines_and_cosines_take_angles_of_both_signs() {
    for a in [3.0, -3.0, 0.1] {
        for (coefficient, factor) in [("p", 2.5), ("-p", -2.5), ("0.001", 0.001)] {
            let angle: f64 = factor * a;
            for (kind, expected) in [(FunctionKind::Sin, angle.sin()), (FunctionKind::Cos, angle.cos())] {
                assert_close(function_value(kind, coefficient, a, expected), expected);
            }
        }
    }
}

#[test]
fn exponentials_have_small_and_large_arguments() {
    for (coefficient, factor) in [("1", 1.0), ("p", 2.5), ("-0.2", -0.2), ("0.001", 0.001), ("-3", -3.0)] {
        for a in [3.0, -1.5] {
            let argument: f64 = factor * a;
            let expected = argument.exp();
            let found = function_value(FunctionKind::Exp, coefficient, a, expected);
            assert!((found - expected).abs() <= 1e-9 * expected.max(1.0), "{coefficient} {a}: {found}");
        }
    }
    // exp(-250) and exp(-1000) are 0, with a summer that is limited to 95 V in front of the function generator.
    for coefficient in ["-100", "-500"] {
        let found = function_value(FunctionKind::Exp, coefficient, 2.5, 1.0);
        assert!(found.abs() < 1e-30, "{found}");
    }
}

#[test]
fn logarithms_have_small_and_large_arguments() {
    for (coefficient, a) in [("1", 3.0), ("p", 0.02), ("-1", -40.0), ("0.001", 3.0), ("1000", 3.0)] {
        let sketch = problem("y = a", "");
        let factor =
            sketch.read(coefficient).as_rational().map_or(2.5, |number| crate::symbolic::nearest(&number));
        let expected = (factor * a).ln();
        assert_close(function_value(FunctionKind::Ln, coefficient, a, expected), expected);
    }
}

#[test]
fn curves_go_through_their_points_with_all_signs() {
    let tables =
        r#""tables": {"f": {"in": "1", "out": "1", "points": [[-4, 6], [-1, 0], [2, 3], [5, -90]]}},"#;
    for (coefficient, a, expected) in
        [("1", 0.5, 1.5), ("-1", 0.5, 0.5), ("1", -2.5, 3.0), ("2", 0.25, 1.5), ("1", 2.1, -0.1)]
    {
        let mut sketch = problem("y = f(a)", tables);
        sketch.constant("a", a);
        sketch.constant("b", 1.0);
        let curve = Operation::Curve { table: "f".to_owned(), input: sketch.term(coefficient, 0) };
        sketch.node("y", "1", [0.0, f64::abs(expected)], 0.0, curve);
        assert_close(Reading::of(&sketch.with_quantities().synthesis()).value("y"), expected);
    }
}

#[test]
fn delay_lines_begin_with_their_initial_value() {
    for initial in ["p", "-2"] {
        let delay = |sketch: &mut Sketch| {
            let time = sketch.read("p / 10");
            Operation::Delay { input: NodeId(0), time, initial: sketch.read(initial) }
        };
        let expected = if initial == "p" { 2.5 } else { -2.0 };
        assert_close(value("y = delay(a, p / 10)", [3.0, 1.0], expected, &delay), expected);
    }
}

#[test]
fn integrators_have_the_rate_of_the_equation() {
    let mut sketch = Sketch::new(
        r#"{"patchcord": 1, "parameters": {"m": {"value": 2, "unit": "kg"}, "k": {"value": 450, "unit": "N/m"},
            "c": {"value": 0.3, "unit": "N s/m"}, "x0": {"value": -30, "unit": "mm"}, "g": {"value": 9.81, "unit": "m/s2"}},
        "quantities": {"x": {"unit": "mm", "initial": "x0"}, "x'": {"unit": "mm/s", "initial": 200}},
        "equations": ["m x'' = -k x - c x' - m g"], "run": {"for": 1, "step": 1e-3}}"#,
    );
    sketch.node("1", "1", [1.0, 1.0], 0.0, Operation::One);
    sketch.integral("x", "m", [0.06, 0.7], "x0", &[("1", 2)]);
    sketch.integral("x'", "m/s", [0.7, 14.0], "0.2", &[("-g", 0), ("-k/m", 1), ("-c/m", 2)]);
    let reading = Reading::of(&sketch.with_quantities().synthesis());
    assert_close(reading.value("x"), -0.03);
    assert_close(reading.value("x_dot"), 0.2);
    assert_close(reading.rate("x"), 0.2);
    assert_close(reading.rate("x_dot"), 225.0 * 0.03 - 0.15 * 0.2 - 9.81);
}

#[test]
fn a_stated_maximum_can_need_an_additional_summer() {
    let mut sketch = Sketch::new(
        r#"{"patchcord": 1, "quantities": {"a": {"unit": "1", "maximum": 100}, "b": {"unit": "1", "maximum": 100},
            "y": {"unit": "1", "maximum": 1}},
        "equations": ["a' = 0", "b' = 0", "y = a - b"], "run": {"for": 1, "step": 1e-3}}"#,
    );
    sketch.constant("a", 0.8);
    sketch.constant("b", 0.3);
    let difference = Operation::Sum(sketch.sum(&[("1", 0), ("-1", 1)]));
    sketch.node("y", "1", [0.5, 0.5], 0.0, difference);
    let made = sketch.with_quantities().synthesis();
    assert!(made.steps.iter().filter(|step| step.output == "y").all(|step| step.summers == 1));
    assert_close(Reading::of(&made).value("y"), 0.5);
}
