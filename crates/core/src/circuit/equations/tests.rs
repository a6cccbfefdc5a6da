use super::*;
use crate::document::Report;

/// A patch with these equations. x, v, u and w are signals, F is a drive, m, k, c, T, w, x0 and v0 are parameters.
fn patch_text(equations: &[&str]) -> String {
    let equations = serde_json::json!(equations);
    format!(
        r#"{{
  "patchcord": 1,
  "parameters": {{
    "m": {{"value": 2, "unit": "kg"}}, "k": {{"value": 3, "unit": "N/m"}}, "c": {{"value": 1, "unit": "N s/m"}},
    "T": {{"value": 0.5, "unit": "s"}}, "w": {{"value": 1, "unit": "m/s"}}, "x0": {{"value": 2, "unit": "mm"}},
    "v0": {{"value": 0.1, "unit": "m/s"}}
  }},
  "scales": {{
    "position": {{"per_volt": 1, "unit": "mm"}}, "velocity": {{"per_volt": 10, "unit": "mm/s"}},
    "force": {{"per_volt": 1, "unit": "N"}}
  }},
  "drives": {{"F": {{"kind": "step", "scale": "force", "height": 5}}}},
  "elements": {{
    "A1": {{"kind": "integrator", "in": {{"x1": ["F"]}}}},
    "A2": {{"kind": "integrator", "in": {{"x1": ["A1"]}}}},
    "B1": {{"kind": "inverter", "in": "A1"}}
  }},
  "signals": {{
    "x": {{"at": "A2", "scale": "position"}}, "v": {{"at": "A1", "scale": "velocity"}}, "u": {{"at": "A2"}},
    "w": {{"at": "A1", "scale": "velocity"}}, "x-2": {{"at": "A2", "scale": "position"}}
  }},
  "equations": {equations}
}}"#
    )
}

fn circuit_of(text: &str) -> Result<Circuit, Box<Report>> {
    Circuit::new(&Patch::parse("p.json", text).unwrap())
}

/// Code, position in the equations, message and hint of every error. A position is the text there.
fn faults(equations: &[&str]) -> Vec<(Code, String, String, String)> {
    let report = circuit_of(&patch_text(equations)).expect_err("the equations have a fault");
    let fault = |finding: &Diagnostic| {
        let span = finding.span.unwrap();
        let part = report.text[span.start..span.end].to_owned();
        (finding.code, part, finding.message.clone(), finding.hint.clone().unwrap_or_default())
    };
    report.findings.iter().map(fault).collect()
}

/// Asserts that the equations have one fault, with this code, position, message and hint.
fn assert_fault(equations: &[&str], code: Code, part: &str, message: &str, hint: &str) {
    let expected = (code, part.to_owned(), message.to_owned(), hint.to_owned());
    assert_eq!(faults(equations), [expected], "{equations:?}");
}

#[test]
fn names_have_the_dimensions_of_their_scales_and_definitions() {
    let equations = [
        "m x'' = -k x - c x' + F",
        "v = x'",
        "E = F_s x / 2",
        "F_s = k x",
        "0 = F_s - k x",
        "0 = v - x'",
        "u = 0",
        "T v' + v = x / T",
    ];
    let circuit = circuit_of(&patch_text(&equations)).unwrap_or_else(|report| panic!("{report}"));
    assert_eq!(circuit.equations().len(), equations.len());
    assert_eq!(circuit.auxiliary_quantities().collect::<Vec<_>>(), ["E", "F_s"]);
    assert!(!circuit.is_time_dimensionless());
    let speed = Dimension::LENGTH.over(Dimension::TIME);
    let cases = [
        ("x", Some(Dimension::LENGTH)),
        ("x'", Some(speed)),
        ("x''", Some(speed.over(Dimension::TIME))),
        ("v", Some(speed)),
        ("u", Some(Dimension::VOLTAGE)),
        ("F", Some(Dimension::FORCE)),
        ("F'", Some(Dimension::FORCE.over(Dimension::TIME))),
        ("F_s", Some(Dimension::FORCE)),
        ("E", Some(Dimension::ENERGY)),
        ("E'", Some(Dimension::POWER)),
        ("m", Some(Dimension::MASS)),
        ("m'", None),
        ("t", Some(Dimension::TIME)),
        ("t'", None),
        ("A1", None),
        ("position", None),
        ("unheard_of", None),
    ];
    for (name, dimension) in cases {
        assert_eq!(circuit.equation_dimension(name), dimension, "{name}");
    }
    let scope = circuit.equation_scope();
    assert_eq!(scope.declared_unit("x"), Some("mm"));
    assert_eq!(scope.declared_unit("x'"), None);
    assert_eq!(
        scope.names(),
        ["x", "v", "u", "w", "F", "E", "F_s", "m", "k", "c", "T", "w", "x0", "v0", "t"]
    );
}

#[test]
fn a_patch_without_equations_has_none() {
    let circuit = circuit_of(&patch_text(&[])).unwrap_or_else(|report| panic!("{report}"));
    assert!(circuit.equations().is_empty());
    assert_eq!(circuit.auxiliary_quantities().count(), 0);
}

#[test]
fn unknown_names_are_errors_with_a_hint() {
    let unknown = |equations: &[&str], part: &str, hint: &str| {
        let base = part.trim_end_matches('\'');
        let message = format!("{base} is not known here");
        assert_fault(equations, Code::UNKNOWN_NAME, part, &message, hint);
    };
    unknown(&["m x'' = -kk x"], "kk", "did you mean k?");
    unknown(&["x' = z"], "z", "add a signal z to the patch, or write x'");
    unknown(&["v = x' step"], "step", "step is a function: write step( ... )");
    unknown(
        &["x = 2 ft"],
        "ft",
        "numbers have no units in equations: declare 2 ft as a parameter, with \"value\": 2 and \"unit\": \"ft\"; or \
         declare ft, if it is a quantity",
    );
    unknown(&["F = unheard_of"], "unheard_of", "known here: x, v, u, w, F, m, k, c, T, w, ...");
    let both = faults(&["m z' = F + z", "x' = z"]);
    let parts: Vec<_> = both.iter().map(|(_, part, _, hint)| (part.as_str(), hint.as_str())).collect();
    let hint = "add a signal z to the patch, or write x'";
    assert_eq!(parts, [("z'", hint), ("z", hint)]);
}

#[test]
fn names_of_other_notations_are_errors_with_a_hint() {
    let unknown = |equation: &str, part: &str, hint: &str| {
        let message = format!("{} is not known here", part.trim_end_matches('\''));
        assert_fault(&[equation], Code::UNKNOWN_NAME, part, &message, hint);
    };
    let product = |text: &str| format!("write {text} for the product: names need a space between them");
    unknown("m x'' = -kx", "kx", &product("k x"));
    unknown("m x'' = -k x - cx'", "cx'", &product("c x'"));
    unknown("m x'' = -mkx / T^2", "mkx", &product("m k x"));
    let derivative = |text: &str| format!("write {text}: a prime is a derivative with respect to time");
    unknown("m x_ddot = -k x", "x_ddot", &derivative("x''"));
    unknown("m xdot' = -k x", "xdot'", &derivative("x''"));
    unknown("v = dxdt", "dxdt", &derivative("x'"));
    let acceleration = "numbers have no units in equations: declare 9.81 m/s2 as a parameter, with \"value\": 9.81 and \
                        \"unit\": \"m/s2\"; or declare s2, if it is a quantity";
    unknown("v' = -9.81 m/s2", "s2", acceleration);
}

#[test]
fn elements_scales_and_the_time_scale_are_no_quantities() {
    let foreign = |equation: &str, name: &str, hint: &str| {
        let message = format!("{name} is not a quantity of the equations");
        assert_fault(&[equation], Code::UNKNOWN_NAME, name, &message, hint);
    };
    foreign("F = k A2", "A2", "A2 is an element: name its signal x");
    foreign("v = B1", "B1", "B1 is an element: name a signal");
    foreign("B1 = v", "B1", "B1 is an element: name a signal");
    foreign("F = 2 force", "force", "force is a scale: name a signal or a parameter, or choose another name");
    foreign("force = k x", "force", "force is a scale: name a signal or a parameter, or choose another name");
    let hint = "equations are in problem time, so they do not contain the time scale";
    foreign("x' = v / time_scale", "time_scale", hint);
}

#[test]
fn a_name_has_one_meaning_and_primes_only_if_it_varies() {
    let message = "w is ambiguous: it is a signal and a parameter";
    assert_fault(&["x' = w"], Code::DUPLICATE_NAME, "w", message, "rename the parameter");
    let hint = "primes follow the names of signals, drives and auxiliary quantities";
    let message = "k is a parameter and has no derivative";
    assert_fault(&["F = k' x"], Code::BAD_FORMULA, "k'", message, hint);
    let message = "t is the time and has no derivative";
    assert_fault(&["v = x' t'"], Code::BAD_FORMULA, "t'", message, hint);
    let text = patch_text(&["x = v t"]).replace("\"T\": {", "\"t\": {");
    let report = circuit_of(&text).unwrap_err();
    assert_eq!(report.findings[0].message, "t is ambiguous: it is the time and a parameter");
}

#[test]
fn initial_values_are_expressions_of_parameters() {
    let equations = [
        "m x'' = -k x + F",
        "v = x'",
        "F_s = k x",
        "x(0) = 2 x0 - T v0",
        "x'(0) = limit(v0, 0, x0 / T) + step(v0 T / x0) v0",
        "x''(0) = 0",
        "u(0) = 0",
    ];
    let circuit = circuit_of(&patch_text(&equations)).unwrap_or_else(|report| panic!("{report}"));
    assert_eq!(circuit.auxiliary_quantities().collect::<Vec<_>>(), ["F_s"]);
    let speed = Dimension::LENGTH.over(Dimension::TIME);
    let cases = [
        ("x(0)", Some(Dimension::LENGTH)),
        ("x'(0)", Some(speed)),
        ("u(0)", Some(Dimension::VOLTAGE)),
        ("F(0)", None),
        ("F_s(0)", None),
        ("k(0)", None),
        ("t(0)", None),
        ("unheard_of(0)", None),
    ];
    for (name, dimension) in cases {
        assert_eq!(circuit.equation_dimension(name), dimension, "{name}");
    }
    let scope = circuit.equation_scope();
    assert_eq!((scope.declared_unit("x(0)"), scope.declared_unit("x'(0)")), (Some("mm"), None));
}

#[test]
fn initial_values_depend_on_parameters_only() {
    let dependent = |equations: &[&str], part: &str, hint: &str| {
        let message = "an initial value is an expression of parameters";
        assert_fault(equations, Code::BAD_FORMULA, part, message, hint);
    };
    dependent(&["x(0) = x0 + x"], "x", "x is a signal: declare a parameter for x at the start");
    dependent(&["v(0) = v0 + x'"], "x'", "x is a signal: declare a parameter for x' at the start");
    dependent(&["x(0) = F / k"], "F", "F is a drive: declare a parameter for F at the start");
    let hint = "F_s is an auxiliary quantity: declare a parameter for F_s at the start";
    dependent(&["F_s = k x", "x(0) = F_s / k"], "F_s", hint);
    dependent(&["x(0) = x0 + v0 t"], "t", "t is 0 at the start: write the expression without it");
    dependent(&["x(0) = x0", "v(0) = x(0) / T"], "x(0)", "write parameters in place of x(0)");
    // The position is that on the right side.
    let equation = "x(0) = 2 x(0)";
    let text = patch_text(&[equation]);
    let report = circuit_of(&text).unwrap_err();
    let start = report.findings[0].span.unwrap().start;
    assert_eq!(start, text.find(equation).unwrap() + "x(0) = 2 ".len());
}

#[test]
fn an_initial_value_stands_alone_on_the_left() {
    let misplaced = |equation: &str, hint: &str| {
        let message = "x(0) must stand alone on the left of an equation";
        assert_fault(&[equation], Code::BAD_FORMULA, "x(0)", message, hint);
    };
    let hint = "write an equation x(0) = ... with parameters, and these parameters here";
    misplaced("x' = -x(0) / T", hint);
    misplaced("x0 = x(0)", hint);
    let hint = "write x(0) = ... with all other factors and terms on the right";
    misplaced("2 x(0) = x0", hint);
    misplaced("x - x(0) = v T", hint);
}

#[test]
fn only_signals_have_initial_values() {
    let other = |equations: &[&str], part: &str, noun: &str| {
        let message = format!("{} is {noun} and has no initial value", part.trim_end_matches("(0)"));
        let hint = "only signals have initial values, such as x(0)";
        assert_fault(equations, Code::BAD_FORMULA, part, &message, hint);
    };
    other(&["F(0) = k x0"], "F(0)", "a drive");
    other(&["F_s = k x", "F_s(0) = k x0"], "F_s(0)", "an auxiliary quantity");
    other(&["T(0) = x0 / v0"], "T(0)", "a parameter");
    other(&["t(0) = 0"], "t(0)", "the time");
    let message = "A2 is not a quantity of the equations";
    assert_fault(
        &["A2(0) = x0"],
        Code::UNKNOWN_NAME,
        "A2(0)",
        message,
        "A2 is an element: name its signal x",
    );
}

#[test]
fn an_unknown_name_in_an_initial_value_is_meant_as_a_parameter() {
    let unknown = |equations: &[&str], part: &str, hint: &str| {
        let message = format!("{} is not known here", part.trim_end_matches("(0)"));
        assert_fault(equations, Code::UNKNOWN_NAME, part, &message, hint);
    };
    unknown(&["x'(0) = speed_0"], "speed_0", "declare speed_0 as a parameter");
    unknown(&["x(0) = V0 T"], "V0", "did you mean v0?");
    unknown(&["x(0) = step"], "step", "step is a function: write step( ... )");
    let hint = "numbers have no units in equations: declare 2 ft as a parameter, with \"value\": 2 and \"unit\": \"ft\"; or \
         declare ft, if it is a quantity";
    unknown(&["x(0) = 2 ft"], "ft", hint);
    unknown(&["z(0) = x0"], "z(0)", "known here: x, v, u, w, F, m, k, c, T, w, ...");
    // The signal that an equation needs is not an initial value.
    let faults = faults(&["x'(0) = z", "m z' = F"]);
    let hints: Vec<_> = faults.iter().map(|(_, part, _, hint)| (part.as_str(), hint.as_str())).collect();
    let list = "known here: x, v, u, w, F, m, k, c, T, w, ...";
    assert_eq!(hints, [("z", "declare z as a parameter"), ("z'", list)]);
}

#[test]
fn left_sides_differ() {
    let hint = "remove one of the two, or write it for another quantity";
    let message = "another equation has the same left side";
    assert_fault(&["v = x'", "v = x' + x / T"], Code::DUPLICATE_NAME, "v", message, hint);
    assert_fault(&["m x'' = F", "m*(x'') = -k x"], Code::DUPLICATE_NAME, "m*(x'')", message, hint);
    assert_fault(&["F_s = k x", "F_s = -k x"], Code::DUPLICATE_NAME, "F_s", message, hint);
    assert_fault(&["x(0) = x0", "x( 0 ) = 0"], Code::DUPLICATE_NAME, "x( 0 )", message, hint);
    for equations in [["0 = v - x'", "0 = F - k x"], ["x' = v", "x'' = v'"], ["x = v0 t", "x(0) = 0"]] {
        assert!(circuit_of(&patch_text(&equations)).is_ok(), "{equations:?}");
    }
}

#[test]
fn auxiliary_quantities_do_not_depend_on_themselves() {
    let message = "the auxiliary quantities a, b depend on each other";
    let hint = "add a signal a to the patch, or define a by other quantities";
    assert_fault(&["a = b + k x", "b = a", "F = a"], Code::BAD_FORMULA, "a", message, hint);
    let message = "the auxiliary quantity z depends on itself";
    let hint = "add a signal z to the patch, or define z by other quantities";
    assert_fault(&["z = k x - T z'"], Code::BAD_FORMULA, "z", message, hint);
}

#[test]
fn sides_and_terms_agree_in_dimension() {
    let advice = "multiply or divide by parameters until both sides have the same unit";
    let mismatch = |equations: &[&str], part: &str, message: &str, hint: &str| {
        assert_fault(equations, Code::UNIT_MISMATCH, part, message, hint);
    };
    mismatch(&["m x'' = -k x'"], "m x'' = -k x'", "m x'' is in N but -k x' is in N/s", advice);
    mismatch(&["x = 5"], "x = 5", "x is in mm but 5 is a pure number", "declare 5 as a parameter in mm");
    let message = "x(0) is in mm but 5 is a pure number";
    mismatch(&["x(0) = 5"], "x(0) = 5", message, "declare 5 as a parameter in mm");
    mismatch(&["x'(0) = x0"], "x'(0) = x0", "x'(0) is in m/s but x0 is in mm", advice);
    // The fault of a definition is not reported again where its quantity is used.
    mismatch(&["b = a", "a = k + x", "F = b"], "k + x", "k is in N/m but x is in mm", advice);
}

#[test]
fn an_equation_that_cannot_be_read_is_reported_alone() {
    let message = "this parenthesis is not closed";
    assert_fault(&["F_s = k (x", "m x'' = F - F_s"], Code::BAD_FORMULA, "(", message, "");
}

#[test]
fn time_is_a_pure_number_if_no_unit_contains_it() {
    let text = |parameter: &str, equation: &str| {
        format!(
            r#"{{"patchcord": 1, "parameters": {{"s": {{"value": 10, "unit": "{parameter}"}}}},
                "scales": {{"number": {{"per_volt": 0.1, "unit": "1"}}, "volt": {{"per_volt": 1, "unit": "V"}}}},
                "drives": {{"F": {{"kind": "step", "scale": "volt", "height": 5}}}},
                "elements": {{"A1": {{"kind": "integrator", "in": {{"x1": ["F"]}}}}}},
                "signals": {{"x": {{"at": "A1", "scale": "number"}}, "y": {{"at": "A1"}}}},
                "equations": ["{equation}"]}}"#
        )
    };
    for equation in ["x' = s (1 - x)", "x''' = x + sin(2 t)", "x = delay(x, 2)", "y' = -F"] {
        let circuit = circuit_of(&text("1", equation)).unwrap_or_else(|report| panic!("{report}"));
        assert!(circuit.is_time_dimensionless());
        assert!(circuit_of(&text("s", equation)).is_err(), "{equation}");
    }
    assert!(circuit_of(&text("Hz", "x' = s (1 - x)")).is_ok());
}

#[test]
fn many_unknown_names_are_reported_without_hints() {
    let equations: Vec<String> = (0..60).map(|index| format!("{index} = unheard_{index}")).collect();
    let faults = faults(&equations.iter().map(String::as_str).collect::<Vec<_>>());
    assert_eq!(faults.len(), 60);
    assert!(!faults[0].3.is_empty() && faults[59].3.is_empty());
}

#[test]
fn equations_are_a_list_or_one_text() {
    let list = patch_text(&["v = x'"]);
    let single = list.replace("[\"v = x'\"]", "\"v = x'\"");
    assert_ne!(list, single);
    for text in [list, single] {
        let circuit = circuit_of(&text).unwrap_or_else(|report| panic!("{report}"));
        assert_eq!(circuit.equations()[0].value.text(), "v = x'");
    }
}
