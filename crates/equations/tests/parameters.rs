//! The patches of problems follow parameters that are changed after the scaling, and implicit equations have the right
//! branch.

use patchcord_core::circuit::Circuit;
use patchcord_core::ir::Program;
use patchcord_core::patch::{Patch, Problem};
use patchcord_core::solve::{RunSettings, run};
use patchcord_equations::{Agreement, ScaleOptions, compare_equations, scale_problem};

/// Largest difference of a value from its closed solution.
const TOLERANCE: f64 = 1e-6;

/// The problem of pure numbers with these sections.
fn problem(sections: &str) -> Problem {
    let text = format!(r#"{{"patchcord": 1, {sections}, "run": {{"for": 1, "step": 1e-3}}}}"#);
    Problem::parse("problem.json", &text).unwrap_or_else(|report| panic!("{report}"))
}

/// The patch of a problem of pure numbers. Its wiring solves its equations for all values of the parameters.
fn scaled(sections: &str) -> Patch {
    let scaled = scale_problem(&problem(sections), &ScaleOptions::default());
    let patch = scaled.unwrap_or_else(|error| panic!("{sections}: {error}")).patch;
    let circuit = Circuit::new(&patch).unwrap_or_else(|report| panic!("{report}"));
    for compared in compare_equations(&circuit, &Program::new(&circuit).unwrap()) {
        let equation = circuit.equations()[compared.index].value.text();
        let is_solved = compared.agreement.is_solved();
        assert!(is_solved, "{equation}: {:?}", compared.agreement);
        assert!(!matches!(compared.agreement, Agreement::SolvedAt(_)));
    }
    patch
}

/// The value of a signal at the end of a run with other values of some parameters.
fn last(patch: &Patch, parameters: &[(&str, f64)], signal: &str) -> f64 {
    let circuit = Circuit::with_parameters(patch, parameters.iter().copied());
    let circuit = circuit.unwrap_or_else(|report| panic!("{report}"));
    let program = Program::new(&circuit).unwrap_or_else(|report| panic!("{report}"));
    let trace = run(&program, &RunSettings::of(&circuit).unwrap()).unwrap();
    trace.values(signal).unwrap().last().copied().unwrap()
}

/// Asserts that a signal has a value at the end of a run with these values of parameters.
#[track_caller]
fn assert_last(patch: &Patch, parameters: &[(&str, f64)], signal: &str, expected: f64) {
    let found = last(patch, parameters, signal);
    assert!((found - expected).abs() <= TOLERANCE, "{signal} = {found}, expected {expected}");
}

/// exp(-1): the state x' = -x from 1 at the end of the run.
fn decayed() -> f64 {
    (-1f64).exp()
}

#[test]
fn an_exponential_with_an_offset_follows_its_parameters() {
    let patch = scaled(
        r#""parameters": {"k": {"value": 1e10, "unit": "1", "range": [8e9, 1.2e10]},
                       "E": {"value": 46, "unit": "1", "range": [45.8, 47]}},
        "quantities": {"x": {"unit": "1", "initial": 1}, "y": {"unit": "1"}},
        "equations": ["x' = 1", "y = k exp(-E/x)"]"#,
    );
    // x is 2 at the end of the run.
    for (k, e) in [(1e10, 46.0), (1.1e10, 46.0), (1e10, 45.8), (8e9, 47.0)] {
        assert_last(&patch, &[("k", k), ("E", e)], "y", k * f64::exp(-e / 2.0));
    }
}

#[test]
fn the_argument_of_a_table_follows_its_coefficient() {
    let patch = scaled(
        r#""parameters": {"a": {"value": 0.5, "unit": "1", "range": [0.1, 0.9]}},
        "quantities": {"x": {"unit": "1", "initial": 1}, "y": {"unit": "1"}},
        "tables": {"f": {"in": "1", "out": "1", "points": [[-10, -5], [0, 0], [10, 20]]}},
        "equations": ["x' = -x", "y = f(a x)"]"#,
    );
    assert_last(&patch, &[], "y", decayed());
    assert_last(&patch, &[("a", 0.3)], "y", 0.6 * decayed());
}

#[test]
fn a_delay_follows_its_time_in_a_problem_of_pure_numbers() {
    let patch = scaled(
        r#""parameters": {"tau": {"value": 0.5, "unit": "1", "range": [0.25, 1]}},
        "quantities": {"x": {"unit": "1", "initial": 1}}, "equations": ["x' = -delay(x, tau)"]"#,
    );
    // x is 1 - t up to tau, and then falls by the integral of 1 - t from 0 to 1 - tau.
    let expected = |tau: f64| (1.0 - tau).powi(2) / 2.0;
    assert_last(&patch, &[], "x", expected(0.5));
    assert_last(&patch, &[("tau", 0.75)], "x", expected(0.75));
}

#[test]
fn the_value_before_a_delay_follows_parameters() {
    let patch = scaled(
        r#""parameters": {"b": {"value": 2, "unit": "1", "range": [1.5, 4]},
                          "x0": {"value": 1, "unit": "1", "range": [0.5, 1]}},
        "quantities": {"x": {"unit": "1", "initial": "x0"}, "y": {"unit": "1"}, "z": {"unit": "1"}},
        "equations": ["x' = -x", "y = delay(x/(b + x), 2)", "z = delay(abs(sqrt(x) - b), 2)"]"#,
    );
    let expected = |b: f64, x0: f64| (x0 / (b + x0), (x0.sqrt() - b).abs());
    for (b, x0) in [(2.0, 1.0), (2.1, 0.8)] {
        let parameters = [("b", b), ("x0", x0)];
        let (y, z) = expected(b, x0);
        assert_last(&patch, &parameters, "y", y);
        assert_last(&patch, &parameters, "z", z);
    }
}

#[test]
fn a_delay_of_numbers_with_units_has_a_value() {
    let patch = scaled(
        r#""parameters": {"b": {"value": 10, "unit": "mm"}, "T": {"value": 1, "unit": "s"}},
        "quantities": {"x": {"unit": "mm", "initial": 50}, "y": {"unit": "mm"}},
        "equations": ["T x' = -x", "y = delay(x + b, 2 T)"]"#,
    );
    assert_last(&patch, &[], "y", 60.0);
}

#[test]
fn a_coefficient_of_0_can_be_changed_in_its_range() {
    let with = |range: &str, term: &str| {
        scaled(&format!(
            r#""parameters": {{"a": {{"value": 0, "unit": "1"{range}}}}},
            "quantities": {{"x": {{"unit": "1", "initial": 1}}, "y": {{"unit": "1", "initial": 1}}}},
            "equations": ["x' = -x {term}", "y' = -y"]"#
        ))
    };
    // x is (1 + c t) exp(-t) with the factor c of y.
    for (range, term, a, factor) in [
        ("", "- a y", 0.5, -0.5),
        ("", "+ a y", 0.5, 0.5),
        (r#", "range": [-1, 0]"#, "+ a y", -0.5, -0.5),
        (r#", "range": [-1, 0]"#, "- a y", -0.5, 0.5),
        (r#", "range": [0, 1]"#, "- a y", 0.5, -0.5),
    ] {
        let patch = with(range, term);
        assert_last(&patch, &[], "x", decayed());
        assert_last(&patch, &[("a", a)], "x", (1.0 + factor) * decayed());
    }
}

#[test]
fn signs_and_steps_of_parameters_follow_them() {
    let with = |value: &str, c: &str| {
        scaled(&format!(
            r#""parameters": {{"c": {{"value": {c}, "unit": "1", "range": [0, 1]}}}},
            "quantities": {{"x": {{"unit": "1", "initial": 1}}}}, "equations": ["x' = -x + {value}"]"#
        ))
    };
    // With a constant a in place of the sign or the step, x is a + (1 - a) exp(-t).
    let expected = |a: f64| a + (1.0 - a) * decayed();
    let sign = with("0.5 sign(c)", "0");
    assert_last(&sign, &[], "x", expected(0.0));
    assert_last(&sign, &[("c", 0.7)], "x", expected(0.5));
    let step = with("step(c - 0.5)", "0.7");
    assert_last(&step, &[], "x", expected(1.0));
    assert_last(&step, &[("c", 0.5)], "x", expected(1.0));
    assert_last(&step, &[("c", 0.2)], "x", expected(0.0));
}

#[test]
fn functions_of_a_coefficient_that_is_0_at_present_follow_it() {
    let with = |equations: &str| {
        scaled(&format!(
            r#""parameters": {{"a": {{"value": 0, "unit": "1", "range": [0, 1]}}}},
            "quantities": {{"x": {{"unit": "1", "initial": 1}}, "y": {{"unit": "1"}}}}, "equations": [{equations}]"#
        ))
    };
    let x = decayed();
    let cases: [(&str, &dyn Fn(f64) -> f64); 4] = [
        ("exp(a x)", &|a| (a * x).exp()),
        ("x^a", &|a| x.powf(a)),
        ("tanh(a x)", &|a| (a * x).tanh()),
        ("ln(1 + a x)", &|a| (a * x).ln_1p()),
    ];
    for (value, expected) in cases {
        let patch = with(&format!(r#""x' = -x", "y = {value}""#));
        for a in [0.0, 0.2] {
            assert_last(&patch, &[("a", a)], "y", expected(a));
        }
    }
    // The scale of the logarithm is within its limits, although its peak is 0.
    assert_last(&with(r#""x' = -x + ln(1 + a x)", "y = 2 x""#), &[], "x", x);
}

#[test]
fn the_sign_of_a_product_with_a_parameter_that_is_0_is_0() {
    let patch = scaled(
        r#""parameters": {"a": {"value": 0, "unit": "1", "range": [0, 1]}},
        "quantities": {"x": {"unit": "1", "initial": 1}, "y": {"unit": "1", "initial": 0}},
        "equations": ["x' = -x", "y' = sign(a x)"]"#,
    );
    assert_last(&patch, &[], "y", 0.0);
    assert_last(&patch, &[("a", 0.5)], "y", 1.0);
}

#[test]
fn a_constant_mass_matrix_is_inverted() {
    let patch = scaled(
        r#""parameters": {"m": {"value": 1, "unit": "1", "range": [0.8, 1.2]}},
        "quantities": {"x": {"unit": "1", "initial": 1}, "x'": {"unit": "1", "initial": 0},
                       "y": {"unit": "1", "initial": 0.5},
                       "y'": {"unit": "1", "initial": 0, "per_volt": 0.0004}},
        "equations": ["m x'' + 3 y'' = -y", "2 x'' + y'' = -x"]"#,
    );
    // x and y at the end, by 20000 steps of the method of Runge and Kutta.
    for (m, x, y) in
        [(1.0, 0.762_225_667_037, 0.495_970_254_538), (1.2, 0.753_180_012_401, 0.514_883_089_123)]
    {
        assert_last(&patch, &[("m", m)], "x", x);
        assert_last(&patch, &[("m", m)], "y", y);
    }
}

#[test]
fn a_quadratic_equation_has_the_branch_of_its_start() {
    let with = |initial: &str, start: &str, equation: &str| {
        scaled(&format!(
            r#""quantities": {{"x": {{"unit": "1", "initial": 0.9}}, "y": {{"unit": "1"{initial}}}}},
            "equations": ["x' = -x", "{equation}"{start}]"#
        ))
    };
    let x = 0.9 * decayed();
    let circle = "0 = x^2 + y^2 - 1";
    let root = (1.0 - x * x).sqrt();
    assert_last(&with("", "", circle), &[], "y", root);
    assert_last(&with(r#", "initial": -0.4"#, "", circle), &[], "y", -root);
    assert_last(&with("", r#", "y(0) = -0.4""#, circle), &[], "y", -root);
    let parabola = "y^2 + 3 y = x";
    assert_last(&with("", "", parabola), &[], "y", (2.25 + x).sqrt() - 1.5);
    assert_last(&with(r#", "initial": -3"#, "", parabola), &[], "y", -(2.25 + x).sqrt() - 1.5);
}

#[test]
fn an_equation_with_the_unknown_in_a_divisor_is_solved() {
    let with = |equation: &str| {
        scaled(&format!(
            r#""quantities": {{"x": {{"unit": "1", "initial": 0.5}}, "y": {{"unit": "1"}}}},
            "equations": ["x' = -x", "{equation}"]"#
        ))
    };
    let x = 0.5 * decayed();
    assert_last(&with("1/y = 1 + x"), &[], "y", 1.0 / (1.0 + x));
    assert_last(&with("x = y/(1 + y)"), &[], "y", x / (1.0 - x));
}

#[test]
fn nested_bounds_can_be_in_any_order() {
    let with = |value: &str| {
        scaled(&format!(
            r#""parameters": {{"a": {{"value": 2, "unit": "1", "range": [1, 3]}}}},
            "quantities": {{"x": {{"unit": "1", "initial": 0}}, "y": {{"unit": "1"}}}},
            "equations": ["x' = 8", "y = {value}"]"#
        ))
    };
    assert_last(&with("min(max(x, 5), 3)"), &[], "y", 3.0);
    assert_last(&with("max(min(x, 3), 5)"), &[], "y", 5.0);
    assert_last(&with("limit(x, a, a)"), &[], "y", 2.0);
    assert_last(&with("min(max(x, 3), 5)"), &[], "y", 5.0);
}

#[test]
fn an_angle_that_turns_through_more_than_half_a_turn_is_a_fault() {
    let problem = Problem::parse(
        "turn.json",
        r#"{"patchcord": 1, "quantities": {"x": {"unit": "1", "initial": 1}, "y": {"unit": "1", "initial": 0},
        "p": {"unit": "1"}}, "equations": ["x' = y", "y' = -x", "p = atan2(y, x)"],
        "run": {"for": 6, "step": 1e-3}}"#,
    );
    let error = scale_problem(&problem.unwrap(), &ScaleOptions::default()).unwrap_err().to_string();
    assert!(error.contains("the angle p turns through 6 rad"), "{error}");
}

/// The patch of x' = -a_n x, in which each of the n constants a_1, a_2 and so on follows from the one before.
fn chain(length: usize, next: &str) -> Patch {
    let equation = |index: usize| {
        let right = next.replace("last", &format!("a{index}"));
        format!(r#""a{} = {right}""#, index + 1)
    };
    let equations: Vec<String> = (0..length).map(equation).collect();
    let problem = problem(&format!(
        r#""parameters": {{"a0": {{"value": 1, "unit": "1"}}, "b": {{"value": 0.1, "unit": "1"}}}},
        "quantities": {{"x": {{"unit": "1", "initial": 1}}}},
        "equations": [{}, "x' = -a{length} x"]"#,
        equations.join(", ")
    ));
    let scaled = scale_problem(&problem, &ScaleOptions::default());
    scaled.unwrap_or_else(|error| panic!("{error}")).patch
}

#[test]
fn long_chains_of_constants_take_no_long_time() {
    for next in ["last^2", "last last"] {
        assert_last(&chain(30, next), &[], "x", decayed());
    }
    // 2^12 terms, if it were multiplied out.
    let value = (0..12).fold(1.0, |last: f64, _| (0.5 * last + 0.1).powi(2));
    assert_last(&chain(12, "(0.5 last + b)^2"), &[], "x", (-value).exp());
    let changed = (0..12).fold(1.0, |last: f64, _| (0.5 * last + 0.102).powi(2));
    assert_last(&chain(12, "(0.5 last + b)^2"), &[("b", 0.102)], "x", (-changed).exp());
}
