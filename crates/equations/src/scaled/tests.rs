//! Scaling of whole problems.

use patchcord_core::machines;
use patchcord_core::patch::Problem;

use super::attempt::{Attempt, Basis, Last, last_attempt};
use super::built_patch::BuiltPatch;
use super::measured::{Measured, OverloadedAmplifier};
use super::overload;
use super::{ScaleError, ScaleOptions, ScaledProblem, ScaledQuantity, scale_problem};
use crate::findings::codes;
use crate::peaks::ranges;
use crate::plan::plan;

#[test]
fn an_angle_with_parameters_in_its_equation_is_scaled() {
    let problem = Problem::read("tests/systems/car-steering.json").unwrap_or_else(|error| panic!("{error}"));
    let options = ScaleOptions::default();
    let scaled = scale_problem(&problem, &options).unwrap_or_else(|error| panic!("{error}"));
    assert!(scaled.peaks.iter().all(|peak| peak.volts < 100.0), "{:?}", scaled.peaks);
    // By SciPy; see car-steering.reference.json.
    for (name, expected) in [("x", 46.021_727_002), ("command", 28.0)] {
        let found = row(&scaled, name).maximum;
        assert!((found / expected - 1.0).abs() < 1e-6, "{name}: {found} instead of {expected}");
    }
}

/// A problem with these quantities and equations. Its parameters are T = 1 s, w = 4 rad/s and d = 20 mm.
fn problem(quantities: &str, equations: &str) -> Problem {
    let text = format!(
        r#"{{"patchcord": 1, "parameters": {{"T": {{"value": 1, "unit": "s"}},
        "w": {{"value": 4, "unit": "rad/s"}}, "d": {{"value": 20, "unit": "mm"}}}},
        "quantities": {{{quantities}}}, "equations": [{equations}], "run": {{"for": 5, "step": 1e-3}}}}"#
    );
    Problem::parse("problem.json", &text).unwrap_or_else(|report| panic!("{report}"))
}

/// A scaled problem.
fn scaled(quantities: &str, equations: &str, options: &ScaleOptions) -> ScaledProblem {
    scale_problem(&problem(quantities, equations), options).unwrap_or_else(|error| panic!("{error}"))
}

/// The row of a quantity.
fn row<'s>(scaled: &'s ScaledProblem, name: &str) -> &'s ScaledQuantity {
    scaled.quantities.iter().find(|quantity| quantity.name == name).unwrap_or_else(|| panic!("{name}"))
}

/// The reason for the peak of the output with this quantity.
fn reason(scaled: &ScaledProblem, quantity: &str) -> Option<&'static str> {
    scaled.peaks.iter().find(|peak| peak.quantity == quantity).unwrap_or_else(|| panic!("{quantity}")).reason
}

/// An equation of the position x in mm. Its angular frequency is w.
const OSCILLATION: &str = r#""x'' = -w^2 x""#;

#[test]
fn every_row_is_in_its_own_unit() {
    let quantities = r#""x": {"unit": "mm", "initial": 80}, "v": {"unit": "m/s"}, "x'": {"unit": "mm/s"},
        "y": {"unit": "cm", "maximum": 10}"#;
    let made = scaled(quantities, r#""x' = v", "v = -x/T", "y = x""#, &ScaleOptions::default());
    let expected = [("x", "mm", 80.0), ("v", "m/s", 0.08), ("x'", "mm/s", 80.0), ("y", "cm", 8.0)];
    for (name, unit, maximum) in expected {
        let row = row(&made, name);
        assert_eq!(row.unit, unit);
        assert!((row.maximum / maximum - 1.0).abs() < 1e-9, "{name}: {}", row.maximum);
        assert!((row.per_volt * row.peak / maximum - 1.0).abs() < 1e-9, "{name}: {}", row.per_volt);
    }
    // Two names of one voltage are equal.
    let equations: Vec<&str> = ["v", "x'"].map(|name| row(&made, name).scaled_equation.as_str()).to_vec();
    assert!(equations.contains(&"[x'] = [v]") || equations.contains(&"[v] = [x']"), "{equations:?}");
    // The outputs of x and x' are listed once.
    assert_eq!(made.peaks.len(), 2, "{:?}", made.peaks);
}

/// 5 V are 83 V of the machine with 0.06 V per volt, the roundest scale from 5 / 94 to 5 / 51.
#[test]
fn a_drive_of_the_scaled_equations_has_its_scale() {
    let text = r#"{"patchcord": 1, "parameters": {"T": {"value": 1, "unit": "s"}},
        "quantities": {"x": {"unit": "mV", "initial": 0}},
        "drives": {"u": {"kind": "square", "unit": "V", "amplitude": 5, "frequency": 0.1}},
        "equations": ["T x' = u - x"], "run": {"for": 5, "step": 1e-3}}"#;
    let problem = Problem::parse("problem.json", text).unwrap_or_else(|report| panic!("{report}"));
    let made = scale_problem(&problem, &ScaleOptions::default()).unwrap_or_else(|error| panic!("{error}"));
    let [drive] = made.drives.as_slice() else { panic!("{:?}", made.drives) };
    assert_eq!((drive.name.as_str(), drive.unit.as_str(), drive.per_volt), ("u", "V", 0.06));
    assert!((drive.maximum / 5.0 - 1.0).abs() < 1e-9, "{}", drive.maximum);
    assert!((drive.peak / (5.0 / 0.06) - 1.0).abs() < 1e-9, "{}", drive.peak);
    assert!(row(&made, "x").scaled_equation.contains("[u]"), "{:?}", made.quantities);
    let free = scaled(r#""x": {"unit": "mm", "initial": 80}"#, r#""T x' = -x""#, &ScaleOptions::default());
    assert_eq!(free.drives, []);
}

#[test]
fn a_product_and_an_absolute_value_with_scales_of_their_own_have_factors() {
    let quantities = r#""x": {"unit": "mm", "initial": 50, "per_volt": 0.6},
        "p": {"unit": "mm2", "per_volt": 100}, "q": {"unit": "mm", "per_volt": 2}"#;
    let equations = r#""x' = -x/T", "p = x^2", "q = abs(x - d)""#;
    let made = scaled(quantities, equations, &ScaleOptions::default());
    // 100 V x 0.6 mm x 0.6 mm / 100 mm2 = 0.36.
    assert_eq!(row(&made, "p").scaled_equation, "[p] = 0.36 [x]^2/100");
    // One volt of x - d is 0.5 mm.
    assert_eq!(row(&made, "q").scaled_equation, "[q] = 0.25 abs(-40 + 1.2 [x])");
    // 2500 mm2 are 25 V.
    // The multiplier has p with another scale, and a good peak.
    assert_eq!(reason(&made, "p"), None);
    let pot = made.peaks.iter().rfind(|peak| peak.quantity == "p");
    assert_eq!(pot.and_then(|pot| pot.reason), Some("the problem prescribes its scale"));
    assert_eq!(reason(&made, "x"), None);
}

#[test]
fn every_maximum_that_is_kept_is_100_volts() {
    let quantities = r#""x": {"unit": "mm", "initial": 50, "maximum": 60},
        "p": {"unit": "mm2", "maximum": 3000}, "q": {"unit": "mm", "maximum": 80}"#;
    let equations = r#""x' = -x/T", "p = x^2", "q = abs(x)""#;
    let keeps_maxima = ScaleOptions { keeps_maxima: true, ..ScaleOptions::default() };
    let made = scaled(quantities, equations, &keeps_maxima);
    for (name, per_volt, equation) in [
        ("x", 0.6, "[x]' = -[x]"),
        // 100 V x 0.6 mm x 0.6 mm / 30 mm2 = 1.2.
        ("p", 30.0, "[p] = 1.2 [x]^2/100"),
        ("q", 0.8, "[q] = 0.75 abs([x])"),
    ] {
        let row = row(&made, name);
        assert!((row.per_volt / per_volt - 1.0).abs() < 1e-12, "{name}: {}", row.per_volt);
        assert_eq!(row.scaled_equation, equation);
    }
}

#[test]
fn the_reason_for_a_low_peak_is_that_of_the_choice() {
    let quantities = r#""x": {"unit": "mm", "initial": 0, "maximum": 100},
        "x'": {"unit": "mm/s", "initial": 72}, "z": {"unit": "mm2"}"#;
    let equations = r#""x'' = -w^2 x", "z = x x'*T""#;
    let keeps_maxima = ScaleOptions { keeps_maxima: true, ..ScaleOptions::default() };
    let made = scaled(quantities, equations, &keeps_maxima);
    // x reaches 72 / 4 = 18 mm.
    assert!((row(&made, "x").peak - 18.0).abs() < 1e-3);
    assert_eq!(reason(&made, "x"), Some("its stated maximum is kept"));
    let made = scaled(quantities, equations, &ScaleOptions::default());
    assert_eq!(reason(&made, "x"), None);
    // x is 0 where x' is largest.
    assert_eq!(reason(&made, "x x'"), Some("its factors are not large at the same time"));
    // The square of 60 V is 36 V.
    let quantities = r#""x": {"unit": "mm", "initial": 60, "per_volt": 1}, "p": {"unit": "mm2"}"#;
    let made = scaled(quantities, r#""x' = -x/T", "p = x^2""#, &ScaleOptions::default());
    let expected = "a multiplier gives the product of its factors divided by 100 V";
    assert_eq!(reason(&made, "p"), Some(expected));
}

#[test]
fn a_prescribed_scale_that_is_too_small_is_an_error() {
    let quantities = r#""x": {"unit": "mm", "initial": 0, "per_volt": 0.1},
        "x'": {"unit": "mm/s", "initial": 72}"#;
    let problem = problem(quantities, OSCILLATION);
    let error = scale_problem(&problem, &ScaleOptions::default()).unwrap_err();
    let ScaleError::Problem(report) = error else { panic!("{error}") };
    let finding = &report.findings[0];
    assert_eq!(finding.message, "the scale of x is prescribed as 0.1 mm per volt, but x reaches 180 V");
    assert_eq!(finding.hint.as_deref(), Some("let 1 V represent at least 0.2 mm"));
    let per_volt = problem.quantities["x"].per_volt.as_ref().unwrap();
    assert_eq!(finding.span, Some(per_volt.span));
}

#[test]
fn a_kept_maximum_with_which_an_amplifier_overloads_is_an_error() {
    let quantities =
        r#""x": {"unit": "mm", "initial": 50, "maximum": 50}, "x'": {"unit": "mm/s", "initial": 0}"#;
    let problem = problem(quantities, OSCILLATION);
    let keeps_maxima = ScaleOptions { keeps_maxima: true, ..ScaleOptions::default() };
    // An integrator at 100 V is at its limit.
    let error = scale_problem(&problem, &keeps_maxima).unwrap_err();
    let ScaleError::Problem(report) = error else { panic!("{error}") };
    let finding = &report.findings[0];
    assert_eq!(finding.message, "A1 overloads: x would need more than 100 V with 1 V for 0.5 mm");
    assert_eq!(
        finding.hint.as_deref(),
        Some("state a larger \"maximum\", or let the scales follow from the peaks")
    );
    assert_eq!(finding.span, problem.quantities["x"].maximum.as_ref().map(|maximum| maximum.span));
    let free = scale_problem(&problem, &ScaleOptions::default()).unwrap_or_else(|error| panic!("{error}"));
    assert!(row(&free, "x").per_volt > 0.5);
}

#[test]
fn a_maximum_has_no_effect_if_another_name_prescribes_the_scale() {
    let quantities = r#""x": {"unit": "mm", "initial": 0}, "v": {"unit": "mm/s", "maximum": 10},
        "x'": {"unit": "mm/s", "initial": 72, "per_volt": 1}"#;
    let equations = r#""x'' = -w^2 x", "v = x'""#;
    for keeps_maxima in [false, true] {
        let made = scaled(quantities, equations, &ScaleOptions { keeps_maxima, ..ScaleOptions::default() });
        assert!(made.warnings.findings.is_empty(), "{}", made.warnings);
        assert!((row(&made, "v").per_volt - 1.0).abs() < 1e-12);
    }
}

#[test]
fn a_maximum_that_is_far_too_small_costs_no_run() {
    let quantities = |maximum: &str| {
        format!(
            r#""x": {{"unit": "mm", "initial": 0 {maximum}}}, "x'": {{"unit": "mm/s", "initial": 72 {maximum}}}"#
        )
    };
    let options = ScaleOptions::default();
    let without = scaled(&quantities(""), OSCILLATION, &options);
    let with = scaled(&quantities(r#", "maximum": 1e-6"#), OSCILLATION, &options);
    assert_eq!(with.runs, without.runs);
    let scales = |scaled: &ScaledProblem| ["x", "x'"].map(|name| row(scaled, name).per_volt);
    assert_eq!(scales(&with), scales(&without));
    assert_eq!(row(&with, "x").expected_maximum, Some(1e-6));
}

/// The faults of the last attempt of a problem if these amplifiers overloaded.
fn faults_with(problem: &Problem, overloads: Vec<OverloadedAmplifier>) -> Vec<[String; 2]> {
    let circuit = patchcord_core::circuit::Circuit::new(&problem.patch).unwrap();
    let plan = plan(problem, &circuit).unwrap();
    let ranges = ranges(&plan, problem, &circuit).unwrap();
    let options = ScaleOptions::default();
    let basis = Basis { plan: &plan, problem, circuit: &circuit, ranges: &ranges, options: &options };
    let Last { attempt, .. } = last_attempt(&basis).unwrap_or_else(|error| panic!("{error}"));
    let faults = |attempt: &Attempt| overload::faults(attempt, &BuiltPatch::new(&basis, &attempt.synthesis));
    assert_eq!(faults(&attempt), []);
    let Attempt { scales, synthesis, measured: Measured { volts, .. } } = attempt;
    let attempt = Attempt { scales, synthesis, measured: Measured { volts, overloads } };
    faults(&attempt).into_iter().map(|fault| [fault.message, fault.hint.unwrap_or_default()]).collect()
}

#[test]
fn an_overload_with_every_scale_has_its_output_its_peak_and_a_cure() {
    // One volt of x is 0.2 mm, and one volt of x' is 1 mm/s. A1 has x and A2 has x'.
    let quantities =
        r#""x": {"unit": "mm", "initial": 0}, "x'": {"unit": "mm/s", "initial": 72, "per_volt": 1}"#;
    let overload = |element: &str, demand| OverloadedAmplifier { element: element.to_owned(), demand };
    let overloads = vec![overload("A1", Some(400.0)), overload("A2", None), overload("B1", Some(120.0))];
    let found = faults_with(&problem(quantities, OSCILLATION), overloads);
    let expected = [
        // 80 mm are from 51 to 94 V with 1 mm per volt.
        ["A1 overloads: x would need 400 V with 1 V for 0.2 mm", "give x a \"per_volt\" of 1 mm"],
        [
            "the scale of x' is prescribed as 1 mm/s per volt, but x' exceeds 100 V",
            "let 1 V represent at least 2.5 mm/s",
        ],
        [
            "B1 (- x') overloads: it would need 120 V",
            "state a larger \"maximum\" for the quantity in its note, or write the equation in another form",
        ],
    ];
    assert_eq!(found, expected.map(|texts| texts.map(str::to_owned)));
}

#[test]
fn a_machine_with_too_few_parts_gives_warnings() {
    let path = "tests/systems/projectile.json";
    let problem = Problem::read(path).unwrap_or_else(|error| panic!("{error}"));
    let machine = machines::find("solartron-1451").unwrap();
    let options = ScaleOptions { machine, ..ScaleOptions::default() };
    let scaled = scale_problem(&problem, &options).unwrap_or_else(|error| panic!("{error}"));
    let missing = scaled.warnings.findings.iter().filter(|finding| finding.code == codes::MISSING_PARTS);
    let messages: Vec<&str> = missing.map(|finding| finding.message.as_str()).collect();
    assert_eq!(messages, ["the patch uses 5 multipliers, and the solartron-1451 has 2"]);
    assert!(!scaled.warnings.has_errors());
    assert_eq!(scaled.patch.machine.as_ref().map(|name| name.value.as_str()), Some("solartron-1451"));
    let unlimited =
        scale_problem(&problem, &ScaleOptions::default()).unwrap_or_else(|error| panic!("{error}"));
    assert!(unlimited.warnings.findings.iter().all(|finding| finding.code != codes::MISSING_PARTS));
}
