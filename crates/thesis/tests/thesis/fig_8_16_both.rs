//! Fig 8.16 twice in one patch: with its dead zone (elements D) and with a brake (elements B).

use serde_json::{Map, Value};

use crate::known_problems::runs::{difference, record};
use crate::thesis::circuit_readings::document;

/// The elements of a patch as the larger patch contains them: renamed, without notes and parts of the machine.
fn renamed(stem: &str, prefix: &str) -> Map<String, Value> {
    let patch = document(stem);
    let elements = patch["elements"].as_object().unwrap();
    let entry = |name: &String, entry: &Value| {
        let fields = entry.as_object().unwrap().iter();
        let kept = fields.filter(|(key, _)| !["note", "uses"].contains(&key.as_str()));
        let cords = kept.map(|(key, value)| (key.clone(), with_prefix(value, elements, prefix)));
        (format!("{prefix}{name}"), Value::Object(cords.collect()))
    };
    elements.iter().map(|(name, value)| entry(name, value)).collect()
}

/// A value with the prefix added to every name of an element.
fn with_prefix(value: &Value, elements: &Map<String, Value>, prefix: &str) -> Value {
    match value {
        Value::String(text) if elements.contains_key(text) => Value::from(format!("{prefix}{text}")),
        Value::Array(items) => items.iter().map(|item| with_prefix(item, elements, prefix)).collect(),
        Value::Object(fields) => {
            let fields =
                fields.iter().map(|(key, value)| (key.clone(), with_prefix(value, elements, prefix)));
            Value::Object(fields.collect())
        }
        other => other.clone(),
    }
}

#[test]
fn patch_contains_both_circuits_unchanged() {
    let both = document("thesis/fig-8-16-both");
    let mut expected = renamed("thesis/fig-8-16", "D.");
    expected.extend(renamed("thesis/fig-8-16-coulomb", "B."));
    // These elements read the acceleration, which this patch does not record.
    for name in ["X2", "PX", "KV", "A7", "KM"] {
        expected.remove(&format!("B.{name}")).unwrap();
    }
    assert_eq!(both["elements"], Value::Object(expected));
    for section in ["scales", "drives"] {
        assert_eq!(both[section], document("thesis/fig-8-16")[section]);
    }
}

#[test]
fn each_circuit_moves_as_alone() {
    let named = [("v_start", 0.5e-3), ("v_rate", 0.0)];
    let both = record("thesis/fig-8-16-both", &named, 0.3, 1e-3, &["dead-zone.v_o", "brake.v_o"]);
    for (signal, stem) in [("dead-zone.v_o", "thesis/fig-8-16"), ("brake.v_o", "thesis/fig-8-16-coulomb")] {
        let alone = record(stem, &named, 0.3, 1e-3, &["v_o"]).values("v_o").unwrap();
        let error = difference(&both.values(signal).unwrap(), &alone);
        // Switching and kinks of one circuit shift the steps of the other.
        assert!(error < 1e-8, "{signal} deviates by {error:e}");
    }
}
