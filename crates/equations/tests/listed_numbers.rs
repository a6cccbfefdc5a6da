//! The numbers of a listing: few digits, and units that a reader expects.

use patchcord_equations::{Detail, EquationListing};
use serde_json::{Value, json};

use crate::listing::compiled;

#[test]
fn initial_values_are_in_the_unit_of_the_quantity() {
    let patch = |unit: &str, initial: Value| {
        json!({
            "patchcord": 1,
            "scales": {"x": {"per_volt": 1, "unit": unit}, "v": {"per_volt": 5, "unit": "mm/s"}},
            "elements": {
                "A1": {"kind": "integrator", "in": {"x1": ["A1"]}, "initial": initial},
                "A2": {"kind": "integrator", "in": {"x1": ["A2"]}, "initial": -20},
            },
            "signals": {"x": {"at": "A1", "scale": "x"}, "v": {"at": "A2", "scale": "v"}},
        })
    };
    let cases = [
        ("mm", json!(80), "x = 80 mm, v = -100 mm/s"),
        ("um", json!(0.3), "x = 0.3 um, v = -100 mm/s"),
        ("N", json!("1 / 3"), "x = 0.333333333333 N, v = -100 mm/s"),
        ("1", json!(2), "x = 2, v = -100 mm/s"),
    ];
    for (unit, initial, expected) in cases {
        let (circuit, program) = compiled(&patch(unit, initial));
        let text = EquationListing::new(&circuit, &program, Detail::Signals).text();
        assert!(text.ends_with(&format!("\nat t = 0: {expected}\n")), "{text}");
    }
}

#[test]
fn numbers_for_readers_have_at_most_12_digits() {
    let patch = json!({
        "patchcord": 1,
        "scales": {"x": {"per_volt": 0.254, "unit": "mm"}, "v": {"per_volt": 5, "unit": "mm/s"}},
        "elements": {
            "A1": {"kind": "integrator", "in": {"x1": ["A2"]}},
            "A2": {"kind": "integrator", "in": {"x1": ["A1"]}},
        },
        "signals": {"x": {"at": "A1", "scale": "x"}},
    });
    let (circuit, program) = compiled(&patch);
    let text = EquationListing::new(&circuit, &program, Detail::Elements).text();
    assert!(text.contains("A2' = -(3937.00787402 V/(m s)) x\n"), "{text}");
}
