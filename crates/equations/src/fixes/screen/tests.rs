use patchcord_core::patch::Patch;

use super::super::netlist::Link;
use super::*;

/// The circuit of a patch with these sections and equations.
fn circuit(sections: &str, equations: &[&str]) -> Circuit {
    let equations = serde_json::json!(equations);
    let text = format!(r#"{{"patchcord": 1, "equations": {equations}, {sections}}}"#);
    Circuit::new(&Patch::parse("p.json", &text).unwrap()).unwrap_or_else(|report| panic!("{report}"))
}

/// For each equation, whether it passes for a rewiring.
fn passes(circuit: &Circuit, rewiring: &Rewiring, validity: Validity) -> Vec<bool> {
    let screen = Screen::new(circuit, validity);
    let trial = screen.trial(rewiring);
    circuit.equations().iter().map(|placed| trial.passes(&placed.value)).collect()
}

/// The index of an element with this name.
fn index(circuit: &Circuit, name: &str) -> usize {
    circuit.elements().iter().position(|element| element.name == name).unwrap()
}

/// A driven mass on a spring whose amplifier S exceeds 100 V at nearly all states: x'' = F - 40 x. The force is 0 at
/// present.
const SPRING: &str = r#"
  "parameters": {"F0": {"value": 0, "unit": "1", "range": [-1, 1]}, "x0": {"value": 0, "unit": "1", "range": [-1, 1]}},
  "scales": {"one": {"per_volt": 0.01, "unit": "1"}},
  "drives": {"F": {"kind": "ramp", "scale": "one", "start": "F0", "rate": 0}},
  "elements": {"S": {"kind": "summer", "in": {"x1": ["F"], "x10": ["A2", "A2", "A2", "A2"]}},
               "A1": {"kind": "integrator", "in": {"x1": ["S"]}},
               "A2": {"kind": "integrator", "in": {"x1": ["B1"]}, "initial": "x0 / one"},
               "B1": {"kind": "inverter", "in": "A1"}},
  "signals": {"x": {"at": "A2", "scale": "one"}, "v": {"at": "A1", "scale": "one"}}"#;

#[test]
fn equations_are_tested_at_points_at_which_amplifiers_overload() {
    let circuit = circuit(SPRING, &["x'' = F + 40 x", "v' = F - 40 x", "x' = v", "x'' - 40 x = F - v"]);
    assert_eq!(passes(&circuit, &Rewiring::default(), Validity::Present), [true, false, true, false]);
}

#[test]
fn a_drive_that_is_0_at_present_does_not_hide_a_missing_cord() {
    let circuit = circuit(SPRING, &["x'' = F + 40 x", "v' = F0 + 40 x"]);
    assert_eq!(passes(&circuit, &Rewiring::default(), Validity::Present), [true, true]);
    let summer = index(&circuit, "S");
    let links = vec![Link { input: 0, from: index(&circuit, "A2"), factor: 40.0 }];
    let mut without_force = Rewiring::default();
    without_force.set(summer, links);
    // The second equation names the parameter, which is 0 at present.
    assert_eq!(passes(&circuit, &without_force, Validity::Present), [false, true]);
}

#[test]
fn other_parameters_decide_about_initial_values_of_0() {
    let circuit = circuit(SPRING, &["x(0) = x0", "v(0) = 0", "v'(0) = F0 + 40 x0", "2 x' = 2 v"]);
    assert_eq!(passes(&circuit, &Rewiring::default(), Validity::Present), [true, true, true, true]);
    let wrong = SPRING.replace("\"x0 / one\"", "\"-x0 / one\"");
    let circuit = self::circuit(&wrong, &["x(0) = x0"]);
    assert_eq!(passes(&circuit, &Rewiring::default(), Validity::Present), [false]);
}

#[test]
fn a_number_in_place_of_a_parameter_holds_at_present_only() {
    let decay = r#"
      "parameters": {"k": {"value": 0.5, "unit": "1"}},
      "scales": {"one": {"per_volt": 1, "unit": "1"}},
      "elements": {"P": {"kind": "pot", "in": "A", "setting": 0.5},
                   "A": {"kind": "integrator", "in": {"x1": ["P"]}, "initial": 50}},
      "signals": {"x": {"at": "A", "scale": "one"}}"#;
    let circuit = circuit(decay, &["x' = -k x"]);
    assert_eq!(passes(&circuit, &Rewiring::default(), Validity::Present), [true]);
    assert_eq!(passes(&circuit, &Rewiring::default(), Validity::General), [false]);
}

#[test]
fn equations_may_hold_within_the_range_of_a_squaring_network_only() {
    let square = r#"
      "scales": {"one": {"per_volt": 0.1, "unit": "1"}},
      "elements": {"A": {"kind": "integrator", "in": {"x1": ["M"]}, "initial": 50},
                   "M": {"kind": "multiplier", "mode": "sum-of-squares", "a": "A", "b": "ground"}},
      "signals": {"x": {"at": "A", "scale": "one"}}"#;
    let circuit = circuit(square, &["x' = -x^2 / 10", "-x' = max(x, 0)^2 / 10", "x' + x^2 = 0"]);
    assert_eq!(passes(&circuit, &Rewiring::default(), Validity::Present), [true, true, false]);
}

#[test]
fn auxiliary_quantities_are_computed_once_at_each_instant() {
    let decay = r#"
      "scales": {"one": {"per_volt": 1, "unit": "1"}},
      "elements": {"A": {"kind": "integrator", "in": {"x1": ["A"]}, "initial": 50}},
      "signals": {"x": {"at": "A", "scale": "one"}}"#;
    // Each quantity reads the one before it twice: a40 is 2^40 x. The last one is also differentiated twice.
    let doubled = (1..=40).map(|index| format!("a{index} = a{} + a{}", index - 1, index - 1));
    let mut equations: Vec<String> = std::iter::once("a0 = x".to_owned()).chain(doubled).collect();
    let factor = 2_u64.pow(40);
    equations.extend([
        format!("{factor} x' = -a40"),
        format!("-{factor} x' = -a40"),
        "a40'' = a40".to_owned(),
    ]);
    let equations: Vec<&str> = equations.iter().map(String::as_str).collect();
    let passed = passes(&circuit(decay, &equations), &Rewiring::default(), Validity::Present);
    assert_eq!(passed[41..], [true, false, true]);
}

#[test]
fn a_difference_of_second_differences_has_no_value() {
    let decay = r#"
      "scales": {"one": {"per_volt": 1, "unit": "1"}},
      "elements": {"A": {"kind": "integrator", "in": {"x1": ["A"]}, "initial": 50},
                   "B": {"kind": "inverter", "in": "A"}},
      "signals": {"x": {"at": "A", "scale": "one"}, "y": {"at": "B", "scale": "one"}}"#;
    // a = -y, b = y and c = -y. The last one would be a third difference, which has no digits.
    let circuit = circuit(decay, &["a = y'", "b = a'", "c = b'", "y = -a", "2 y = -2 b", "3 y = 3 c"]);
    let passed = passes(&circuit, &Rewiring::default(), Validity::Present);
    assert_eq!(passed[3..], [true, false, true]);
}

/// The integrator A2 = 50 - 2 t stands for the time in x' = 3 t - x/2.
const RAMP: &str = r#"
  "scales": {"one": {"per_volt": 1, "unit": "1"}},
  "elements": {"P1": {"kind": "pot", "in": "A1", "setting": 0.5},
               "P2": {"kind": "pot", "in": "A2", "setting": 0.15},
               "P3": {"kind": "pot", "in": "-100", "setting": 0.75},
               "A1": {"kind": "integrator", "in": {"x1": ["P1", "P3"], "x10": ["P2"]}},
               "P4": {"kind": "pot", "in": "+100", "setting": 0.02},
               "A2": {"kind": "integrator", "in": {"x1": ["P4"]}, "initial": 50}},
  "signals": {"x": {"at": "A1", "scale": "one"}}"#;

#[test]
fn an_integrator_with_a_constant_input_follows_the_time() {
    let equations = ["x' = 3 t - x/2", "x'' = 3 - x'/2", "2 x' = 7 t - x", "3 x' = 9 t + 3 x/2"];
    let right = circuit(RAMP, &equations);
    assert_eq!(passes(&right, &Rewiring::default(), Validity::Present), [true, true, false, false]);
    for (part, wrong) in [("0.02", "0.03"), ("\"initial\": 50", "\"initial\": 40"), ("-100", "+100")] {
        let circuit = circuit(&RAMP.replace(part, wrong), &equations[..1]);
        assert_eq!(passes(&circuit, &Rewiring::default(), Validity::Present), [false], "{wrong}");
    }
}
