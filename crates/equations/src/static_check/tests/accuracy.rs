//! Higher derivatives, tolerances and the search for random values.

use super::*;

/// A patch with pure numbers. Its integrators and other elements, its signals and its equations are given.
fn patch(elements: &Value, signals: &[(&str, &str, f64)], equations: &[&str]) -> Value {
    let signals = signals.iter().map(|(name, at, factor)| {
        let signal = json!({"at": at, "scale": "number", "factor": factor});
        ((*name).to_owned(), signal)
    });
    let signals: serde_json::Map<String, Value> = signals.collect();
    json!({
        "patchcord": 1,
        "scales": {"number": {"per_volt": 1, "unit": "1"}},
        "equations": equations,
        "elements": elements,
        "signals": signals,
    })
}

/// Four integrators in a row: A4 is x, A3 is -x', A2 is x'' and A1 is -x'''. P1 returns a share of x.
fn chain(share: f64) -> Value {
    let elements = json!({
        "P1": {"kind": "pot", "in": "A4", "setting": share},
        "A1": {"kind": "integrator", "in": {"x1": ["P1"]}, "initial": 5},
        "A2": {"kind": "integrator", "in": {"x1": ["A1"]}},
        "A3": {"kind": "integrator", "in": {"x1": ["A2"]}},
        "A4": {"kind": "integrator", "in": {"x1": ["A3"]}},
    });
    patch(&elements, &[("x", "A4", 1.0)], &["x'''' = 0.5 x"])
}

#[test]
fn a_fourth_derivative_is_exact() {
    let values = given(&[("x", 10.0), ("x'", -20.0), ("x''", 30.0), ("x'''", -5.0)]);
    let right = check(&chain(0.5), &values).unwrap();
    assert!(differences(&right).is_empty(), "{right:?}");
    let volts: Vec<f64> = ["A4", "A3", "A2", "A1"].map(|name| row(&right, name, 0).wired).to_vec();
    for (found, expected) in volts.into_iter().zip([10.0, 20.0, 30.0, 5.0]) {
        assert_near(found, expected);
    }
    let last = row(&right, "A1", 1);
    assert_near(last.expected.unwrap(), -5.0);
    let quantity = last.quantity.as_ref().unwrap();
    assert_eq!(quantity.name, "x''''");
    assert_near(quantity.expected.unwrap(), 5.0);
    assert_near(quantity.wired, 5.0);

    let wrong = check(&chain(0.4), &values).unwrap();
    assert_eq!(differences(&wrong), [("A1", 1)]);
    assert_near(row(&wrong, "A1", 1).expected.unwrap(), -5.0);
    assert_near(row(&wrong, "A1", 1).wired, -4.0);
    for seed in 0..3 {
        assert!(differences(&check(&chain(0.5), &TestValues::Random(seed)).unwrap()).is_empty());
    }
}

/// x' = -x, and w = x^2 / 100 at the multiplier, so w'' = 4 w.
#[test]
fn a_second_derivative_behind_a_multiplier_is_exact() {
    let square = |equation| {
        let elements = json!({
            "A1": {"kind": "integrator", "in": {"x1": ["A1"]}, "initial": 50},
            "M1": {"kind": "multiplier", "mode": "product", "a": "A1", "b": "A1"},
        });
        let signals = [("x", "A1", 1.0), ("w", "M1", 1.0)];
        check(&patch(&elements, &signals, &["x' = -x", equation]), &given(&[("x", 20.0)])).unwrap()
    };
    let right = square("w'' = 4 w");
    assert!(differences(&right).is_empty(), "{right:?}");
    let wrong = square("w'' = 4.1 w");
    assert_eq!(differences(&wrong), [("M1", 2)]);
    assert_near(row(&wrong, "M1", 2).wired.abs(), 16.0);
    assert_near(row(&wrong, "M1", 2).expected.unwrap().abs(), 16.4);
    // A deviation of 0.05 % is that of a setting.
    assert!(differences(&square("w'' = 4.002 w")).is_empty());
}

/// d = 10 (x - y). The pot in front of y is rounded, and the difference is 0.
#[test]
fn a_small_sum_may_deviate_by_a_share_of_its_large_terms() {
    let difference = |setting: f64| {
        let elements = json!({
            "A1": {"kind": "integrator", "in": {"x1": ["A1"]}, "initial": 50},
            "A2": {"kind": "integrator", "in": {"x1": ["A2"]}, "initial": 50},
            "B2": {"kind": "inverter", "in": "A2"},
            "P2": {"kind": "pot", "in": "B2", "setting": setting},
            "S1": {"kind": "summer", "in": {"x1": ["A1", "P2"]}},
            "S2": {"kind": "summer", "in": {"x10": ["S1"]}},
        });
        let signals = [("x", "A1", 1.0), ("y", "A2", 1.0), ("d", "S2", 1.0)];
        let values = given(&[("x", 50.0), ("y", 50.0)]);
        check(&patch(&elements, &signals, &["d = 10 (x - y)"]), &values).unwrap()
    };
    let near = difference(0.9996);
    assert!(differences(&near).is_empty(), "{near:?}");
    assert_near(row(&near, "S2", 0).expected.unwrap(), 0.0);
    assert_near(row(&near, "S2", 0).wired, 0.2);
    assert_eq!(differences(&difference(0.99)), [("S2", 0)]);
}

/// The quotient 20 / x by an open amplifier needs more than 100 V for |x| below 20.
#[test]
fn random_values_move_to_the_initial_condition_if_0_overloads() {
    let elements = json!({
        "A1": {"kind": "integrator", "in": {"x1": ["A1"]}, "initial": 60},
        "P1": {"kind": "pot", "in": "+100", "setting": 0.2},
        "A2": {"kind": "open-amplifier", "in": {"x1": ["P1", "M1"]}},
        "M1": {"kind": "multiplier", "mode": "product", "a": "A1", "b": "A2"},
    });
    // The feedback is x q / 100, so q = -100 x 20 / x.
    let signals = [("x", "A1", 1.0), ("q", "A2", -1.0)];
    let patch = patch(&elements, &signals, &["x' = -x", "q x = 2000"]);
    for seed in 0..5 {
        let check = check(&patch, &TestValues::Random(seed)).unwrap();
        assert!(check.is_random && differences(&check).is_empty(), "{check:?}");
        assert!(check.rows.iter().all(|row| !row.is_overloaded && row.not_compared.is_none()), "{check:?}");
        assert_eq!(row(&check, "A2", 0).source, RowSource::Equations);
    }
}

/// At x = 0 the quotient needs infinitely many volts, so what follows from it has no expected value to be compared with.
#[test]
fn an_overloaded_loop_is_not_compared() {
    let elements = json!({
        "A1": {"kind": "integrator", "in": {"x1": ["A1"]}, "initial": 60},
        "P1": {"kind": "pot", "in": "+100", "setting": 0.2},
        "A2": {"kind": "open-amplifier", "in": {"x1": ["P1", "M1"]}},
        "M1": {"kind": "multiplier", "mode": "product", "a": "A1", "b": "A2"},
        "B1": {"kind": "inverter", "in": "A2"},
    });
    let signals = [("x", "A1", 1.0), ("q", "B1", 1.0)];
    let patch = patch(&elements, &signals, &["x' = -x", "q x = 2000"]);
    let check = check(&patch, &given(&[("x", 5.0)])).unwrap();
    assert!(differences(&check).is_empty(), "{check:?}");
    assert_near(row(&check, "B1", 0).expected.unwrap(), 400.0);
    assert!((row(&check, "B1", 0).wired - 100.0).abs() < 1e-3);
    for element in ["A2", "M1", "B1"] {
        let reason = row(&check, element, 0).not_compared.as_deref();
        assert_eq!(reason, Some("A2 is overloaded"), "{element}");
    }
    assert_eq!(row(&check, "A1", 1).not_compared, None);
}

/// Every cell T' = T_left - 2 T + T_right has an integrator and an inverter.
#[test]
fn a_long_rod_and_a_long_chain_are_checked() {
    let cells = 300;
    let near = |cell: usize| [cell.wrapping_sub(1), cell + 1].into_iter().filter(move |other| *other < cells);
    let (mut elements, mut signals, mut equations) = (serde_json::Map::new(), Vec::new(), Vec::new());
    for cell in 0..cells {
        let inputs: Vec<String> = near(cell).map(|other| format!("B{other}")).collect();
        let integrator = json!({"kind": "integrator", "in": {"x2": [format!("A{cell}")], "x1": inputs}});
        elements.insert(format!("A{cell}"), integrator);
        elements.insert(format!("B{cell}"), json!({"kind": "inverter", "in": format!("A{cell}")}));
        signals.push((format!("T{cell}"), format!("A{cell}"), 1.0));
        let sum: Vec<String> = near(cell).map(|other| format!("T{other}")).collect();
        equations.push(format!("T{cell}' = {} - 2 T{cell}", sum.join(" + ")));
    }
    let signals: Vec<(&str, &str, f64)> =
        signals.iter().map(|(name, at, factor)| (name.as_str(), at.as_str(), *factor)).collect();
    let equations: Vec<&str> = equations.iter().map(String::as_str).collect();
    let rod = patch(&Value::Object(elements), &signals, &equations);
    let found = check(&rod, &TestValues::Random(1)).unwrap();
    assert!(differences(&found).is_empty());
    let rates = found.rows.iter().filter(|row| row.order == 1 && row.source == RowSource::Equations);
    assert_eq!(rates.count(), cells);

    let mut elements = serde_json::Map::new();
    elements.insert("B0".to_owned(), json!({"kind": "integrator", "in": {"x1": ["B0"]}, "initial": 50}));
    for place in 1..=1100 {
        let inverter = json!({"kind": "inverter", "in": format!("B{}", place - 1)});
        elements.insert(format!("B{place}"), inverter);
    }
    let chain =
        patch(&Value::Object(elements), &[("x", "B0", 1.0), ("y", "B1100", 1.0)], &["x' = -x", "y = x"]);
    assert!(differences(&check(&chain, &TestValues::Random(1)).unwrap()).is_empty());
}
