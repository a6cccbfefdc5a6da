mod accuracy;

use super::*;
use patchcord_core::patch::Patch;
use serde_json::{Value, json};

/// A mass on a spring: m x'' = -k x with m = 1 kg and k = 40 N/m. 1 V is 1 mm, 10 mm/s and 5 mJ.
fn spring() -> Value {
    json!({
        "patchcord": 1,
        "parameters": {
            "m": {"value": 1, "unit": "kg"}, "k": {"value": 40, "unit": "N/m"},
            "x0": {"value": 80, "unit": "mm"},
        },
        "scales": {
            "position": {"per_volt": 1, "unit": "mm"},
            "velocity": {"per_volt": 10, "unit": "mm/s"},
            "energy": {"per_volt": 5, "unit": "mJ"},
        },
        "equations": ["m x'' = -k x", "v = x'", "kinetic = m v^2 / 2", "x(0) = x0", "v(0) = 0"],
        "elements": {
            "A1": {"kind": "integrator", "in": {"x10": ["P1"]}, "note": "velocity"},
            "A2": {"kind": "integrator", "in": {"x10": ["A1"]}, "initial": -80, "note": "- position"},
            "B1": {"kind": "inverter", "in": "A2", "note": "position"},
            "P1": {"kind": "pot", "in": "B1", "setting": "k / m * position / velocity / 10"},
            "M2": {"kind": "multiplier", "mode": "product", "a": "A1", "b": "A1"},
            "P3": {"kind": "pot", "in": "M2", "setting": "5 * m * velocity^2 / energy"},
            "B2": {"kind": "summer", "in": {"x10": ["P3"]}},
        },
        "signals": {
            "x": {"at": "B1", "scale": "position"},
            "v": {"at": "A1", "scale": "velocity"},
            "kinetic": {"at": "B2", "scale": "energy", "factor": -1},
        },
    })
}

/// The static check of a patch.
fn check(patch: &Value, values: &TestValues) -> Result<StaticCheck, TestError> {
    let patch = Patch::from_value("patch.json", patch).unwrap_or_else(|report| panic!("{report}"));
    let circuit = Circuit::new(&patch).unwrap_or_else(|report| panic!("{report}"));
    let program = Program::new(&circuit).unwrap_or_else(|report| panic!("{report}"));
    static_check(&circuit, &program, values)
}

/// Test values in SI.
fn given(values: &[(&str, f64)]) -> TestValues {
    TestValues::Given(values.iter().map(|(name, value)| ((*name).to_owned(), *value)).collect())
}

/// x = 20 mm and v = 300 mm/s.
fn moving() -> TestValues {
    given(&[("x", 0.02), ("v", 0.3)])
}

/// The row of an element with this number of derivatives.
fn row<'a>(check: &'a StaticCheck, element: &str, order: usize) -> &'a StaticRow {
    let mut rows = check.rows.iter().filter(|row| row.element == element && row.order == order);
    rows.next().unwrap_or_else(|| panic!("{element} has no row: {check:?}"))
}

/// The elements that differ, each with its number of derivatives.
fn differences(check: &StaticCheck) -> Vec<(&str, usize)> {
    check.differences().map(|row| (row.element.as_str(), row.order)).collect()
}

fn assert_near(found: f64, expected: f64) {
    assert!((found - expected).abs() < 1e-9 * expected.abs().max(1.0), "{found} is not {expected}");
}

#[test]
fn a_correct_patch_has_its_values_by_hand() {
    let check = check(&spring(), &moving()).unwrap();
    assert!(differences(&check).is_empty(), "{check:?}");
    // 20 mm and 300 mm/s are 20 V and 30 V. v' = -40 x = -800 mm/s2, and kinetic = 0.5 x 0.3^2 = 45 mJ.
    let cases = [
        ("A1", 0, 30.0, "v", 300.0, "mm/s"),
        ("B1", 0, 20.0, "x", 20.0, "mm"),
        ("B2", 0, -9.0, "kinetic", 45.0, "mJ"),
        ("A1", 1, -80.0, "v'", -800.0, "mm/s2"),
        ("A2", 1, -300.0, "x'", 300.0, "mm/s"),
    ];
    for (element, order, volts, name, value, unit) in cases {
        let row = row(&check, element, order);
        assert_near(row.expected.unwrap(), volts);
        assert_near(row.wired, volts);
        let quantity = row.quantity.as_ref().unwrap();
        assert_eq!((quantity.name.as_str(), quantity.unit.as_str()), (name, unit), "{element}");
        assert_near(quantity.expected.unwrap(), value);
        assert_near(quantity.wired, value);
    }
    assert_near(row(&check, "P1", 0).expected.unwrap(), 8.0);
    assert_eq!(row(&check, "A2", 0).source, RowSource::TestValue);
    assert_eq!(row(&check, "B2", 0).source, RowSource::Equations);
    assert_eq!(row(&check, "P3", 0).source, RowSource::Inputs);
    assert_eq!(row(&check, "A2", 0).note, "- position");
    let values: Vec<_> = check.values.iter().map(|value| (&value.name[..], &value.unit[..])).collect();
    assert_eq!(values, [("x", "mm"), ("v", "mm/s")]);
}

#[test]
fn amplifiers_come_before_networks_and_derivatives_come_last() {
    let check = check(&spring(), &moving()).unwrap();
    let names: Vec<(&str, usize)> = check.rows.iter().map(|row| (row.element.as_str(), row.order)).collect();
    let place = |name: &str, order| names.iter().position(|entry| *entry == (name, order)).unwrap();
    assert_eq!(names.len(), 9);
    for amplifier in ["A1", "A2", "B1", "B2"] {
        for network in ["P1", "P3"] {
            assert!(place(amplifier, 0) < place(network, 0), "{names:?}");
        }
    }
    assert!(place("A1", 1) > place("P3", 0) && place("A2", 1) > place("P3", 0), "{names:?}");
}

#[test]
fn a_wrong_cord_in_front_of_an_integrator_shows_at_its_derivative() {
    let mut slow = spring();
    slow["elements"]["A1"]["in"] = json!({"x1": ["P1"]});
    let slow = check(&slow, &moving()).unwrap();
    assert_eq!(differences(&slow), [("A1", 1)]);
    assert_near(row(&slow, "A1", 1).expected.unwrap(), -80.0);
    assert_near(row(&slow, "A1", 1).wired, -8.0);

    let mut unstable = spring();
    unstable["elements"]["P1"]["in"] = json!("A2");
    let unstable = check(&unstable, &moving()).unwrap();
    assert_eq!(differences(&unstable), [("A1", 1)]);
    assert_near(row(&unstable, "A1", 1).wired, 80.0);

    let mut lagging = spring();
    lagging["elements"]["A2"]["in"] = json!({"x1": ["A1"]});
    let lagging = check(&lagging, &moving()).unwrap();
    assert_eq!(differences(&lagging), [("A2", 1)]);
    assert_near(row(&lagging, "A2", 1).quantity.as_ref().unwrap().wired, 30.0);
}

#[test]
fn a_wrong_gain_inside_shows_at_the_next_named_output() {
    let mut wrong = spring();
    wrong["elements"]["P3"]["setting"] = json!("0.5 * m * velocity^2 / energy");
    let wrong = check(&wrong, &moving()).unwrap();
    assert_eq!(differences(&wrong), [("B2", 0)]);
    assert_near(row(&wrong, "B2", 0).wired, -0.9);
    let fix = |description: &str, solves| Fix {
        description: description.to_owned(),
        edits: Vec::new(),
        solves: vec![solves],
    };
    // The correction of another equation is none of this row.
    let other = fix("plug P1 into x1 of A1", 0);
    let fixes = [other.clone(), fix("set P3 to 1", 2)];
    assert_eq!(wrong.likely_correction(&fixes).as_deref(), Some("set P3 to 1"));
    assert!(wrong.likely_correction(&[other]).unwrap().contains("B2"));
    assert!(wrong.likely_correction(&[]).unwrap().contains("B2"));
}

#[test]
fn a_row_has_the_equations_behind_it_with_its_own_first() {
    let check = check(&spring(), &moving()).unwrap();
    // v' follows from v = x', and x'' there from m x'' = -k x.
    assert_eq!(row(&check, "A1", 1).equations, [1, 0]);
    assert_eq!(row(&check, "B2", 0).equations, [2]);
    assert_eq!(row(&check, "P1", 0).equations, Vec::<usize>::new());
}

/// B1 reads the velocity in place of the position, so no integrator represents x.
#[test]
fn a_derivative_that_no_integrator_has_is_listed_if_it_differs() {
    let mut wrong = spring();
    wrong["elements"]["B1"]["in"] = json!("A1");
    wrong["equations"] = json!(["v = x'"]);
    let twice = check(&wrong, &moving());
    assert!(matches!(twice, Err(TestError::Twice { .. })), "{twice:?}");
    let wrong = check(&wrong, &given(&[("A1", 30.0)])).unwrap();
    assert_eq!(differences(&wrong), [("B1", 1)]);
    // x = -A1, and the rate of A1 is -10 P1 = 120 V/s.
    let quantity = row(&wrong, "B1", 1).quantity.clone().unwrap();
    assert_eq!(quantity.name, "x'");
    assert_near(quantity.expected.unwrap(), 300.0);
    assert_near(quantity.wired, -120.0);
}

#[test]
fn a_derivative_can_be_a_test_value() {
    let check = check(&spring(), &given(&[("x'", 0.3), ("A2", -20.0)])).unwrap();
    assert_near(row(&check, "A1", 0).wired, 30.0);
    assert_near(row(&check, "B1", 0).quantity.as_ref().unwrap().wired, 20.0);
    assert!(differences(&check).is_empty(), "{check:?}");
}

#[test]
fn stated_initial_values_are_expected_in_initial_condition() {
    let right = check(&spring(), &TestValues::Initial).unwrap();
    assert!(differences(&right).is_empty(), "{right:?}");
    let mut wrong = spring();
    wrong["elements"]["A2"]["initial"] = json!(-40);
    let wrong = check(&wrong, &TestValues::Initial).unwrap();
    let found = differences(&wrong);
    assert!(found.contains(&("A2", 0)) && found.contains(&("B1", 0)), "{found:?}");
    assert!(["A2", "B1"].contains(&wrong.first_difference().unwrap().element.as_str()), "{found:?}");
    assert_near(row(&wrong, "A2", 0).expected.unwrap(), -80.0);
    assert_near(row(&wrong, "B1", 0).wired, 40.0);
    // -k/m x0 is -3.2 m/s2.
    assert_near(row(&wrong, "A1", 1).expected.unwrap(), -320.0);
    assert_near(row(&wrong, "A1", 1).wired, -160.0);
}

#[test]
fn names_that_cannot_be_set_are_refused() {
    let message = |values: &[(&str, f64)]| check(&spring(), &given(values)).unwrap_err().to_string();
    assert_eq!(message(&[("pressure", 1.0)]), "there is no quantity pressure; known here: v, x");
    let follows = "kinetic follows from the outputs of integrators and cannot be set; set v, x";
    assert_eq!(message(&[("kinetic", 1.0)]), follows);
    assert_eq!(message(&[("x''", 1.0)]), follows.replace("kinetic", "x''"));
    let twice = "x and A2 set the same output; give one of them";
    assert_eq!(message(&[("x", 0.01), ("A2", 1.0)]), twice);
}

#[test]
fn an_overload_is_marked_and_is_no_difference() {
    let check = check(&spring(), &given(&[("x", 0.2)])).unwrap();
    assert!(differences(&check).is_empty(), "{check:?}");
    let overloaded: Vec<&str> =
        check.rows.iter().filter(|row| row.is_overloaded).map(|row| row.element.as_str()).collect();
    assert_eq!(overloaded.len(), 2, "{overloaded:?}");
    assert!(overloaded.contains(&"A2") && overloaded.contains(&"B1"), "{overloaded:?}");
    let reason = |element: &str, order| row(&check, element, order).not_compared.clone();
    // The derivative of A2 is that of x at B1, which is overloaded.
    for (element, order) in [("A2", 0), ("B1", 0), ("P1", 0), ("A1", 1), ("A2", 1)] {
        assert_eq!(reason(element, order).as_deref(), Some("A2 is overloaded"), "{element}");
    }
    for (element, order) in [("A1", 0), ("M2", 0), ("B2", 0)] {
        assert_eq!(reason(element, order), None, "{element}");
    }
}

#[test]
fn a_wrong_gain_behind_an_overload_is_not_compared() {
    let mut wrong = spring();
    wrong["elements"]["A1"]["in"] = json!({"x1": ["P1"]});
    let wrong = check(&wrong, &given(&[("x", 0.2)])).unwrap();
    assert!(differences(&wrong).is_empty(), "{wrong:?}");
    assert_eq!(row(&wrong, "A1", 1).not_compared.as_deref(), Some("A2 is overloaded"));
}

#[test]
fn random_values_overload_nothing_and_depend_on_the_seed_only() {
    let random = |seed| check(&spring(), &TestValues::Random(seed)).unwrap();
    for seed in 0..5 {
        let check = random(seed);
        assert!(differences(&check).is_empty(), "{check:?}");
        let outputs = check.rows.iter().filter(|row| row.order == 0);
        let largest = outputs.fold(0.0, |largest: f64, row| largest.max(row.wired.abs()));
        assert!((1.0..=80.0 + 1e-6).contains(&largest), "{largest}");
        let names: Vec<_> = check.values.iter().map(|value| value.name.as_str()).collect();
        assert_eq!(names, ["v", "x"]);
        assert!(check.values.iter().all(|value| value.value != 0.0));
    }
    assert_eq!(random(1), random(1));
    assert_ne!(random(1).values, random(2).values);
}

/// x' = 3 t - x/2, in which the integrator A2 = 50 - 2 t stands for the time.
#[test]
fn an_integrator_for_the_time_keeps_its_value_at_the_start() {
    let patch = json!({
        "patchcord": 1,
        "equations": "x' = 3 t - x/2",
        "scales": {"x": {"per_volt": 1, "unit": "1"}},
        "elements": {
            "P1": {"kind": "pot", "in": "A1", "setting": 0.5},
            "P2": {"kind": "pot", "in": "A2", "setting": 0.15},
            "P3": {"kind": "pot", "in": "-100", "setting": 0.75},
            "A1": {"kind": "integrator", "in": {"x1": ["P1", "P3"], "x10": ["P2"]}},
            "P4": {"kind": "pot", "in": "+100", "setting": 0.02},
            "A2": {"kind": "integrator", "in": {"x1": ["P4"]}, "initial": 50},
        },
        "signals": {"x": {"at": "A1", "scale": "x"}},
    });
    for seed in 0..5 {
        let check = check(&patch, &TestValues::Random(seed)).unwrap();
        assert!(differences(&check).is_empty(), "{check:?}");
        assert_near(row(&check, "A2", 0).wired, 50.0);
        assert!(row(&check, "A1", 0).wired != 0.0);
    }
    let set = check(&patch, &given(&[("A2", 20.0)])).unwrap_err().to_string();
    assert_eq!(set, "A2 keeps its value at t = 0, because the equations contain the time t");
}

#[test]
fn a_patch_without_equations_has_no_expected_values() {
    let mut patch = spring();
    patch["equations"] = json!([]);
    let check = check(&patch, &moving()).unwrap();
    assert!(!check.has_equations);
    assert!(check.rows.iter().all(|row| row.expected.is_none() && row.source == RowSource::NoEquations));
    assert_eq!(check.likely_correction(&[]), None);
    assert_near(row(&check, "A1", 1).wired, -80.0);
}

/// p = x + v and q = x - v, stated so that neither equation gives one of them alone.
#[test]
fn equations_are_solved_together() {
    let sums = |last: &str| {
        json!({
            "patchcord": 1,
            "scales": {"number": {"per_volt": 1, "unit": "1"}},
            "equations": ["p + q = 2 x", "p - q = 2 v", "r^3 = x^3"],
            "elements": {
                "A1": {"kind": "integrator", "in": {"x1": ["A1"]}, "initial": 5},
                "A2": {"kind": "integrator", "in": {"x1": ["A2"]}, "initial": 5},
                "B2": {"kind": "inverter", "in": "A2"},
                "S1": {"kind": "summer", "in": {"x1": ["A1", "A2"]}},
                "S2": {"kind": "summer", "in": {"x1": ["A1", last]}},
                "S3": {"kind": "summer", "in": {"x1": ["B3"]}},
                "B3": {"kind": "inverter", "in": "M3"},
                "M3": {"kind": "multiplier", "mode": "product", "a": "A1", "b": "+100"},
            },
            "signals": {
                "x": {"at": "A1", "scale": "number"}, "v": {"at": "A2", "scale": "number"},
                "p": {"at": "S1", "scale": "number", "factor": -1},
                "q": {"at": "S2", "scale": "number", "factor": -1},
                "r": {"at": "S3", "scale": "number"},
            },
        })
    };
    let values = given(&[("x", 3.0), ("v", 1.0)]);
    let right = check(&sums("B2"), &values).unwrap();
    assert!(differences(&right).is_empty(), "{right:?}");
    assert_near(row(&right, "S1", 0).expected.unwrap(), -4.0);
    assert_near(row(&right, "S2", 0).expected.unwrap(), -2.0);
    let wrong = check(&sums("A2"), &values).unwrap();
    assert_eq!(differences(&wrong), [("S2", 0)]);
}
