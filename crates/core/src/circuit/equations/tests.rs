use super::*;
use crate::document::Report;

/// A patch with these equations. x, v, u and w are signals, F is a drive, m, k, c, T and w are parameters.
fn patch_text(equations: &[&str]) -> String {
    let equations = serde_json::json!(equations);
    format!(
        r#"{{
  "patchcord": 1,
  "parameters": {{
    "m": {{"value": 2, "unit": "kg"}}, "k": {{"value": 3, "unit": "N/m"}}, "c": {{"value": 1, "unit": "N s/m"}},
    "T": {{"value": 0.5, "unit": "s"}}, "w": {{"value": 1, "unit": "m/s"}}
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
    assert_eq!(scope.names(), ["x", "v", "u", "w", "F", "E", "F_s", "m", "k", "c", "T", "w", "t"]);
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
        "numbers have no units in equations: declare a parameter in ft, or a quantity ft as a parameter",
    );
    unknown(&["F = unheard_of"], "unheard_of", "known here: x, v, u, w, F, m, k, c, T, w, ...");
    let both = faults(&["m z' = F + z", "x' = z"]);
    let parts: Vec<_> = both.iter().map(|(_, part, _, hint)| (part.as_str(), hint.as_str())).collect();
    let hint = "add a signal z to the patch, or write x'";
    assert_eq!(parts, [("z'", hint), ("z", hint)]);
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
fn left_sides_differ() {
    let hint = "remove one of the two, or write it for another quantity";
    let message = "another equation has the same left side";
    assert_fault(&["v = x'", "v = x' + x / T"], Code::DUPLICATE_NAME, "v", message, hint);
    assert_fault(&["m x'' = F", "m*(x'') = -k x"], Code::DUPLICATE_NAME, "m*(x'')", message, hint);
    assert_fault(&["F_s = k x", "F_s = -k x"], Code::DUPLICATE_NAME, "F_s", message, hint);
    for equations in [["0 = v - x'", "0 = F - k x"], ["x' = v", "x'' = v'"]] {
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
    let mismatch = |equations: &[&str], part: &str, message: &str, hint: &str| {
        assert_fault(equations, Code::UNIT_MISMATCH, part, message, hint);
    };
    mismatch(&["m x'' = -k x'"], "m x'' = -k x'", "m x'' is in N but -k x' is in N/s", "");
    mismatch(&["x = 5"], "x = 5", "x is in mm but 5 is a pure number", "declare 5 as a parameter in mm");
    // The fault of a definition is not reported again where its quantity is used.
    mismatch(&["b = a", "a = k + x", "F = b"], "k + x", "k is in N/m but x is in mm", "");
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
