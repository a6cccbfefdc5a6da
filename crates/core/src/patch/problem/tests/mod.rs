//! Tests of problems: what is decoded, which problems are right, and which findings others get.

mod entries;
mod relations;

use std::path::PathBuf;

use super::*;
use crate::circuit::Circuit;
use crate::document::Code;
use patchcord_expr::Dimension;

/// A mass on a spring that is a table, and an auxiliary frequency f.
const SPRING: &str = r#"{
  "patchcord": 1,
  "title": "A mass on a spring",
  "parameters": {
    "m": {"value": 2, "unit": "kg"}, "x0": {"value": 20, "unit": "mm"}, "n": {"value": 0, "unit": "1"},
    "w": {"value": 4, "unit": "rad/s"}, "F": {"value": 5, "unit": "N"}
  },
  "quantities": {
    "x": {"unit": "mm", "initial": "2 * x0", "maximum": 100, "description": "position"},
    "x'": {"unit": "m/s", "initial": 0, "per_volt": 0.5},
    "f": {"unit": "Hz"}
  },
  "drives": {"push": {"kind": "sine", "unit": "N", "amplitude": "F", "frequency": 2}},
  "tables": {"spring": {"in": "mm", "out": "N", "points": [[-1, -2], [1, 2]]}},
  "equations": ["m x'' = push - spring(x)", "f = w"],
  "run": {"for": 3, "step": 0.001}
}"#;

/// The text of [`SPRING`] with replacements, each of a part that occurs once.
fn changed(replacements: &[(&str, &str)]) -> String {
    let change = |text: String, (from, to): &(&str, &str)| {
        assert_eq!(text.matches(from).count(), 1, "{from}");
        text.replace(from, to)
    };
    replacements.iter().fold(SPRING.to_owned(), change)
}

/// Code, position in the text, message and hint of every finding about a problem. A position is the text there.
fn findings(text: &str) -> Vec<(Code, String, String, String)> {
    let problem = Problem::parse("p.json", text).unwrap_or_else(|report| panic!("{report}"));
    let report = match Circuit::new(&problem.patch) {
        Ok(circuit) => circuit.warnings(),
        Err(report) => *report,
    };
    let finding = |finding: &Diagnostic| {
        let span = finding.span.unwrap();
        let hint = finding.hint.clone().unwrap_or_default();
        (finding.code, text[span.start..span.end].to_owned(), finding.message.clone(), hint)
    };
    report.findings.iter().map(finding).collect()
}

/// Asserts that the changed problem has one finding, with this code, position, message and hint.
fn assert_finding(replacements: &[(&str, &str)], code: Code, part: &str, message: &str, hint: &str) {
    let expected = (code, part.to_owned(), message.to_owned(), hint.to_owned());
    assert_eq!(findings(&changed(replacements)), [expected], "{replacements:?}");
}

/// Asserts that a problem has no finding.
fn assert_no_finding(text: &str) {
    let found = findings(text);
    assert!(found.is_empty(), "{found:?}");
}

/// The problems for users and those for the tests of the scaling.
fn systems() -> Vec<PathBuf> {
    let folders = ["../../problems", "../equations/tests/systems"].into_iter();
    let entries = folders.flat_map(|folder| std::fs::read_dir(folder).unwrap());
    let paths = entries.map(|entry| entry.unwrap().path());
    let is_problem = |path: &PathBuf| {
        let name = path.file_name().unwrap().to_str().unwrap();
        name.ends_with(".json") && !name.ends_with(".reference.json")
    };
    paths.filter(is_problem).collect()
}

#[test]
fn the_fields_of_a_problem_are_decoded() {
    let problem = Problem::parse("spring.json", SPRING).unwrap();
    let circuit = Circuit::new(&problem.patch).unwrap_or_else(|report| panic!("{report}"));
    assert_eq!(circuit.warnings().to_string(), "");
    assert_eq!(problem.patch.title, "A mass on a spring");
    assert_eq!(problem.quantities.keys().collect::<Vec<_>>(), ["x", "x'", "f"]);
    let number = |placed: &Option<Placed<f64>>| placed.as_ref().map(|placed| placed.value);
    let [position, velocity, frequency] = ["x", "x'", "f"].map(|name| &problem.quantities[name]);
    assert_eq!((position.unit.text(), position.description.as_str()), ("mm", "position"));
    assert_eq!((number(&position.maximum), number(&position.per_volt)), (Some(100.0), None));
    assert_eq!((number(&velocity.maximum), number(&velocity.per_volt)), (None, Some(0.5)));
    assert!(frequency.initial.is_none());
    let table = &problem.tables["spring"];
    assert_eq!((table.input_unit.text(), table.output_unit.text()), ("mm", "N"));
    assert_eq!(table.points, [[-1.0, -2.0], [1.0, 2.0]]);
}

#[test]
fn the_patch_of_a_problem_has_its_scales_and_signals() {
    let problem = Problem::parse("spring.json", SPRING).unwrap();
    let patch = &problem.patch;
    assert_eq!(patch.scales.keys().collect::<Vec<_>>(), ["x", "f", "push"]);
    assert_eq!(patch.signals.keys().collect::<Vec<_>>(), ["x", "f"]);
    let circuit = Circuit::new(patch).unwrap_or_else(|report| panic!("{report}"));
    let scale = circuit.derived_index("push").unwrap();
    assert_eq!((circuit.per_volt(scale), circuit.derived_unit(scale).text()), (Some(1e9), "N"));
    assert_eq!(circuit.equation_dimension("x'"), Some(Dimension::LENGTH.over(Dimension::TIME)));
    assert_eq!(circuit.equation_dimension("push"), Some(Dimension::FORCE));
}

#[test]
fn initial_values_are_evaluated_in_si_units() {
    let problem = Problem::parse("spring.json", SPRING).unwrap();
    let value = |name: &str, x0: f64| {
        let circuit = Circuit::with_parameters(&problem.patch, [("x0", x0)]).unwrap();
        problem.quantities[name].initial_in_si(circuit.quantities()).unwrap()
    };
    // 2 x 20 mm and 2 x 35 mm.
    assert_eq!([value("x", 20.0), value("x", 35.0)], [Some(0.04), Some(0.07)]);
    assert_eq!([value("x'", 20.0), value("f", 20.0)], [Some(0.0), None]);
    // A number without names is in the unit of the quantity: 2 x 3 m/s.
    let text = changed(&[("\"initial\": 0", "\"initial\": \"2 * 3\"")]);
    let problem = Problem::parse("spring.json", &text).unwrap();
    let circuit = Circuit::new(&problem.patch).unwrap();
    let (placed, factor) = problem.quantities["x"].initial_formula(circuit.quantities()).unwrap();
    assert_eq!((placed.value.text(), factor), ("2 * x0", 1.0));
    let in_km = text.replace("\"m/s\"", "\"km/s\"");
    let problem = Problem::parse("spring.json", &in_km).unwrap();
    let velocity = &problem.quantities["x'"];
    assert_eq!(velocity.initial_formula(circuit.quantities()).map(|(_, factor)| factor), Some(1000.0));
    assert_eq!(velocity.initial_in_si(circuit.quantities()), Ok(Some(6000.0)));
}

#[test]
fn an_initial_value_that_a_parameter_makes_infinite_is_an_error() {
    let text = changed(&[("\"2 * x0\"", "\"x0 / n\""), ("\"n\": {\"value\": 0", "\"n\": {\"value\": 2")]);
    let problem = Problem::parse("spring.json", &text).unwrap();
    let circuit = Circuit::with_parameters(&problem.patch, [("n", 0.0)]).unwrap();
    let error = problem.quantities["x"].initial_in_si(circuit.quantities()).unwrap_err();
    assert_eq!((error.code, error.message.as_str()), (Code::BAD_FORMULA, "the denominator n is 0"));
    let span = error.span.unwrap();
    assert_eq!(&text[span.start..span.end], "n");
}

#[test]
fn all_problems_of_the_scaling_are_decoded_without_a_finding() {
    let systems = systems();
    assert!(systems.len() >= 58, "{}", systems.len());
    for path in systems {
        let name = path.display();
        assert!(Problem::is_problem(&std::fs::read_to_string(&path).unwrap()), "{name}");
        let problem = Problem::read(&path).unwrap_or_else(|error| panic!("{error}"));
        let circuit = Circuit::new(&problem.patch).unwrap_or_else(|report| panic!("{report}"));
        assert_eq!(circuit.warnings().to_string(), "", "{name}");
        for (quantity, declared) in &problem.quantities {
            assert_eq!(
                circuit.equation_dimension(quantity),
                Some(declared.unit.dimension()),
                "{name}: {quantity}"
            );
            declared.initial_in_si(circuit.quantities()).unwrap();
        }
    }
}

#[test]
fn initial_values_of_known_problems_are_right() {
    let initial = |file: &str, quantity: &str| {
        let problem = Problem::read(format!("../equations/tests/systems/{file}.json")).unwrap();
        let circuit = Circuit::new(&problem.patch).unwrap();
        problem.quantities[quantity].initial_in_si(circuit.quantities()).unwrap().unwrap()
    };
    // sqrt(1.3 x 398600.4418 km3/s2 / 7000 km) = 8.6038245 km/s, and 560 m/s x cos(48 deg) = 374.713 m/s, and 95 %.
    for (file, quantity, expected) in [
        ("kepler", "y'", 8603.8245),
        ("kepler", "x", 7e6),
        ("shell", "x'", 374.71314),
        ("battery", "charge", 0.95),
    ] {
        let value = initial(file, quantity);
        assert!((value / expected - 1.0).abs() < 1e-6, "{file} {quantity}: {value}");
    }
}

#[test]
fn problems_and_patches_are_not_confused() {
    let patch = r#"{"patchcord": 1, "elements": {}, "quantities": {}}"#;
    let message = |report: Box<Report>| report.findings[0].message.clone();
    let kind = Patch::parse("p.json", SPRING).unwrap_err();
    assert_eq!(kind.findings[0].message, "this is a problem, where a patch is needed");
    let hint =
        "`patchcord scale PROBLEM.json --out PATCH.json` makes a patch from it: see docs/problem-format.md";
    assert_eq!(kind.findings[0].advice(), hint);
    let span = kind.findings[0].span.unwrap();
    assert_eq!(&SPRING[span.start..span.end], "\"quantities\"");
    assert_eq!(
        message(Problem::parse("p.json", patch).unwrap_err()),
        "this is a patch, where a problem is needed"
    );
    assert_eq!(
        message(Problem::parse("p.json", "[]").unwrap_err()),
        "the problem must be an object, not a list"
    );
    let other = Problem::parse("p.json", "{\"patchcord\": 1}").unwrap_err();
    assert_eq!(message(other), "this is not a problem: it has no key \"quantities\"");
    for text in ["", "[]", "x' = -x"] {
        let report = Problem::parse("p.json", text).unwrap_err();
        let hint = report.findings[0].advice();
        assert!(hint.starts_with("a problem is {\"patchcord\": 1, "), "{text}: {hint}");
    }
    let other = Problem::parse("p.json", "{}").unwrap_err();
    assert_eq!(message(other), "this is not a problem: it has no key \"quantities\"");
    let texts = [
        (SPRING, true),
        (patch, false),
        ("{\"patchcord\": 1}", false),
        ("{\"patchcord\": 1, \"drives\": {}, \"equations\": []}", false),
        ("{\"patchcord\": 1, \"title\": \"a\", \"equations\": []}", true),
        ("{\"patchcord\": 1, \"Quantites\": {}}", true),
        ("{\"patchcord\": 1, \"state variables\": {}}", true),
        ("{\"quantities\": {}}", false),
        ("\u{feff}{\"patchcord\": 1, \"quantities\": {}}", true),
    ];
    for (text, expected) in texts {
        assert_eq!(Problem::is_problem(text), expected, "{text}");
    }
}

#[test]
fn several_faults_are_reported_at_once() {
    let text = changed(&[
        ("\"Hz\"", "\"Hertz\""),
        ("\"kg\"", "\"kgg\""),
        ("\"maximum\": 100", "\"maximum\": -1"),
        ("spring(x)", "sping"),
    ]);
    let codes: Vec<Code> = findings(&text).into_iter().map(|(code, ..)| code).collect();
    assert_eq!(codes, [Code::UNKNOWN_UNIT, Code::BAD_NUMBER, Code::UNKNOWN_UNIT, Code::UNKNOWN_NAME]);
}
