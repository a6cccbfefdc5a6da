//! Unit tests of the comparison.

use patchcord_core::circuit::Circuit;
use patchcord_core::ir::Program;
use patchcord_core::patch::Patch;
use serde_json::json;

use super::EquationComparer;

#[test]
fn signals_with_the_name_of_a_parameter_or_of_pi_vary() {
    let patch = json!({
        "patchcord": 1,
        "parameters": {"m": {"value": 0.5, "unit": "1"}},
        "elements": {
            "P1": {"kind": "pot", "in": "A1", "setting": "m"},
            "P2": {"kind": "pot", "in": "+100", "setting": "m"},
            "A1": {"kind": "integrator", "in": {"x1": ["P1"]}, "initial": 50},
        },
        "signals": {"m": {"at": "A1"}, "pi": {"at": "P1"}, "constant": {"at": "P2"}},
    });
    let patch = Patch::from_value("patch.json", &patch).unwrap();
    let circuit = Circuit::new(&patch).unwrap();
    let program = Program::new(&circuit).unwrap();
    let mut comparer = EquationComparer::new(&circuit, &program);
    assert_eq!(comparer.varying_signals(), [true, true, false]);
}
