//! Fig 8.16 twice in one patch: with its dead zone (elements D) and with a brake (elements B).

use serde_json::{Map, Value};

use crate::known::runs::{difference, record};
use crate::thesis::bench::document;

/// The elements of a patch as they stand in the larger one: renamed, without notes and parts of the machine.
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

/// A value with the prefix before every name of an element.
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
fn it_holds_both_circuits_as_they_are() {
    let both = document("thesis/fig-8-16-both");
    let mut expected = renamed("thesis/fig-8-16", "D.");
    expected.extend(renamed("thesis/fig-8-16-coulomb", "B."));
    // What serves to read the acceleration, which is not read here.
    for name in ["X2", "PX", "KV", "A7", "KM"] {
        expected.remove(&format!("B.{name}")).unwrap();
    }
    assert_eq!(both["elements"], Value::Object(expected));
    for section in ["scales", "drives"] {
        assert_eq!(both[section], document("thesis/fig-8-16")[section]);
    }
}

#[test]
fn each_moves_as_it_does_alone() {
    let named = [("v_start", 0.5e-3), ("v_rate", 0.0)];
    let both = record("thesis/fig-8-16-both", &named, 0.3, 1e-3, &["dead-zone.v_o", "brake.v_o"]);
    for (signal, stem) in [("dead-zone.v_o", "thesis/fig-8-16"), ("brake.v_o", "thesis/fig-8-16-coulomb")] {
        let alone = record(stem, &named, 0.3, 1e-3, &["v_o"]).values("v_o").unwrap();
        let off = difference(&both.values(signal).unwrap(), &alone);
        // The switchings and kinks of one shift the steps of the other.
        assert!(off < 1e-8, "{signal} is {off:e} off");
    }
}
