//! Problems without a circuit: diagnostics, and never a wrong patch.

use super::super::ScaleOptions;
use super::{Sketch, options};
use crate::graph::{FunctionKind, NodeId, Operation};

/// A problem in pure numbers with a constant a and a quantity y.
fn sketch(a: f64, quantities: &str) -> Sketch {
    let mut sketch = Sketch::new(&format!(
        r#"{{"patchcord": 1, "quantities": {{{quantities}}}, "equations": ["a' = 0", "y = a"],
        "run": {{"for": 1, "step": 1e-3}}}}"#
    ));
    sketch.constant("a", a);
    sketch
}

const QUANTITIES: &str = r#""a": {"unit": "1"}, "y": {"unit": "1"}"#;

#[test]
fn a_divisor_must_not_become_0() {
    let mut sketch = sketch(3.0, QUANTITIES);
    sketch.ranges.nodes[0] = [-1.0, 3.0];
    let dividend = sketch.sum(&[("1", 0)]);
    sketch.node("y", "1", [-1.0, 1.0], 0.0, Operation::Quotient { dividend, divisor: NodeId(0) });
    let faults = sketch.with_quantities().faults(&options());
    assert_eq!(faults, ["the divisor a of y is 0 at some time of the run"]);
}

#[test]
fn an_initial_value_must_be_below_100_volts() {
    let mut sketch = sketch(3.0, r#""a": {"unit": "1", "per_volt": 0.02}, "y": {"unit": "1"}"#);
    let sum = Operation::Sum(sketch.sum(&[("1", 0)]));
    sketch.node("y", "1", [3.0, 3.0], 0.0, sum);
    let faults = sketch.with_quantities().faults(&options());
    assert_eq!(faults, ["the initial value of a is 150 V with this scale"]);
}

#[test]
fn an_integrator_has_a_largest_gain() {
    let mut sketch = sketch(3.0, QUANTITIES);
    sketch.integral("y", "1", [1.0, 3e6], "0", &[("1000000", 0)]);
    let sketch = sketch.with_quantities();
    assert!(
        sketch.faults(&ScaleOptions { time_scale: Some(1.0), ..options() })[0]
            .starts_with("a has a gain of ")
    );
    // The chosen time scale makes the problem slower.
    assert!(sketch.scales().time_scale > 1000.0);
    assert_eq!(sketch.synthesis().patch.time_scale, sketch.scales().time_scale);
}

#[test]
fn a_small_difference_of_large_quantities_has_no_circuit() {
    let mut sketch =
        sketch(50.0, r#""a": {"unit": "1", "maximum": 100}, "y": {"unit": "1", "maximum": 0.01}"#);
    sketch.node("1", "1", [1.0, 1.0], 0.0, Operation::One);
    let difference = Operation::Sum(sketch.sum(&[("1", 0), ("-50", 1)]));
    sketch.node("y", "1", [0.0, 0.001], 0.0, difference);
    let faults = sketch.with_quantities().faults(&options());
    assert_eq!(faults, ["a has a gain of 10000 in y, and the largest gain of an amplifier is 10"]);
}

#[test]
fn a_logarithm_needs_a_positive_argument() {
    let mut sketch = sketch(-3.0, QUANTITIES);
    let argument = sketch.term("1", 0);
    let logarithm = Operation::Function { kind: FunctionKind::Ln, argument };
    sketch.node("y", "1", [-1.0, 1.0], 0.0, logarithm);
    let faults = sketch.with_quantities().faults(&options());
    assert_eq!(faults, ["the argument of the logarithm in y is not positive during the whole run"]);
}

#[test]
fn an_exponential_has_a_largest_argument() {
    let mut sketch = sketch(3.0, QUANTITIES);
    let argument = sketch.term("-1e6", 0);
    sketch.node("y", "1", [0.0, 1.0], 0.0, Operation::Function { kind: FunctionKind::Exp, argument });
    let faults = sketch.with_quantities().faults(&options());
    assert_eq!(faults.len(), 1);
    assert!(faults[0].starts_with("the argument of y does not fit a function generator"), "{faults:?}");
}

#[test]
fn a_sine_with_a_stated_scale_has_at_most_100_volts() {
    let mut sketch = sketch(3.0, r#""a": {"unit": "1"}, "y": {"unit": "1", "per_volt": 0.001}"#);
    let argument = sketch.term("1", 0);
    sketch.node("y", "1", [0.0, 0.05], 0.0, Operation::Function { kind: FunctionKind::Sin, argument });
    let faults = sketch.with_quantities().faults(&options());
    assert_eq!(faults, ["the amplitude of y is 1000 V, and a function generator has 0 to 100 V"]);
}

#[test]
fn a_delay_line_has_a_shortest_delay() {
    let mut sketch = sketch(3.0, QUANTITIES);
    let (time, initial) = (sketch.read("1e-12"), sketch.read("0"));
    sketch.node("y", "1", [3.0, 3.0], 0.0, Operation::Delay { input: NodeId(0), time, initial });
    let faults = sketch.with_quantities().faults(&options());
    assert_eq!(faults.len(), 1);
    assert!(faults[0].starts_with("the delay in y is "), "{faults:?}");
}

#[test]
fn a_missing_table_is_a_fault() {
    let mut sketch = sketch(3.0, QUANTITIES);
    let curve = Operation::Curve { table: "f".to_owned(), input: sketch.term("1", 0) };
    sketch.node("y", "1", [3.0, 3.0], 0.0, curve);
    let faults = sketch.with_quantities().faults(&options());
    assert_eq!(faults, ["the table f has no segment within ±100 V of f(a)"]);
}
