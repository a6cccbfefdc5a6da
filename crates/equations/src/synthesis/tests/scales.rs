//! The choice of scales and of the time scale.

use patchcord_core::machines;

use super::super::{ScaleOptions, choose_scales, improved_scales};
use super::{Sketch, options};
use crate::graph::{FunctionKind, NodeId, Operation};

/// An oscillator x'' = -w^2 x with these peaks of x and x' in SI units.
fn oscillator(quantities: &str, w: f64, [x, v]: [f64; 2]) -> Sketch {
    let text = format!(
        r#"{{"patchcord": 1, "parameters": {{"w": {{"value": {w}, "unit": "rad/s"}}}},
        "quantities": {{{quantities}}}, "equations": ["x'' = -w^2 x"], "run": {{"for": 1, "step": 1e-3}}}}"#
    );
    let mut sketch = Sketch::new(&text);
    sketch.integral("x", "m", [x, v], "0", &[("1", 1)]);
    sketch.integral("x'", "m/s", [v, w * v], "0", &[("-w^2", 0)]);
    sketch.with_quantities()
}

/// Fails if the scales are not these values in mm and mm/s per volt.
#[track_caller]
fn assert_in_mm(sketch: &Sketch, expected: [f64; 2]) {
    let found = sketch.scales().per_volt;
    for (found, expected) in found.iter().zip(expected) {
        assert!((found * 1e3 / expected - 1.0).abs() < 1e-12, "{found} instead of {expected} mm");
    }
}

const MILLIMETRES: &str = r#""x": {"unit": "mm", "initial": 0}, "x'": {"unit": "mm/s"}"#;

#[test]
fn a_peak_is_between_50_and_95_volts_and_one_volt_is_a_round_number() {
    // 80 mm and 500 mm/s: 80 V and 50 V are the roundest, but 50 V is at the limit.
    assert_in_mm(&oscillator(MILLIMETRES, 6.0, [0.08, 0.5]), [1.0, 6.0]);
    assert_in_mm(&oscillator(MILLIMETRES, 6.0, [0.013, 0.078]), [0.2, 1.0]);
}

#[test]
fn the_unit_of_the_quantity_decides_which_numbers_are_round() {
    let degrees = r#""x": {"unit": "deg", "initial": 0}, "x'": {"unit": "deg/s"}"#;
    let sketch = oscillator(degrees, 1.0, [1.0, 1.0]);
    // 57.3 deg are 57.3 V.
    let found = sketch.scales().per_volt[0].to_degrees();
    assert!((found - 1.0).abs() < 1e-12, "{found}");
}

#[test]
fn a_stated_maximum_is_100_volts_and_a_stated_scale_is_kept() {
    let stated =
        r#""x": {"unit": "mm", "initial": 0, "maximum": 254}, "x'": {"unit": "mm/s", "per_volt": 7}"#;
    assert_in_mm(&oscillator(stated, 6.0, [0.08, 0.5]), [2.54, 7.0]);
}

#[test]
fn unknown_peaks_follow_from_the_equal_coefficient_rule() {
    let stated = r#""x": {"unit": "mm", "initial": 0, "maximum": 100}, "x'": {"unit": "mm/s"}"#;
    // The peak of x' is 20 rad/s times that of x.
    assert_in_mm(&oscillator(stated, 20.0, [0.0, 0.0]), [1.0, 20.0]);
    // Without a maximum, one volt is one unit, and x' has a gain of 1.
    let sketch = oscillator(MILLIMETRES, 20.0, [0.0, 0.0]);
    assert!(sketch.scales().per_volt.iter().all(|scale| scale.is_normal()));
}

#[test]
fn differences_of_equal_quantities_are_0() {
    let mut sketch = Sketch::new(
        r#"{"patchcord": 1, "quantities": {"a": {"unit": "1", "initial": 1}, "b": {"unit": "1", "initial": 1},
        "d": {"unit": "1"}}, "equations": ["a' = 0", "b' = 0", "d = a - b"], "run": {"for": 1, "step": 1e-3}}"#,
    );
    sketch.constant("a", 1.0);
    sketch.constant("b", 1.0);
    let difference = Operation::Sum(sketch.sum(&[("1", 0), ("-1", 1)]));
    sketch.node("d", "1", [-1e-16, 1e-16], 0.0, difference);
    // What follows from the difference is 0, too.
    let multiple = Operation::Sum(sketch.sum(&[("3", 2)]));
    sketch.node("3 d", "1", [-3e-16, 3e-16], 0.0, multiple);
    sketch.node("a d", "1", [-1e-16, 1e-16], 0.0, Operation::Product([NodeId(0), NodeId(2)]));
    let of_product = Operation::Sum(sketch.sum(&[("1", 4), ("0.5", 3)]));
    sketch.node("a d + 1.5 d", "1", [-3e-16, 3e-16], 0.0, of_product);
    let scales = sketch.with_quantities().scales().per_volt;
    assert!([2, 3, 5].into_iter().all(|node| scales[node] > 1e-3), "{scales:?}");
}

#[test]
fn sines_and_angles_without_a_peak_have_their_natural_range() {
    let mut sketch = Sketch::new(
        r#"{"patchcord": 1, "quantities": {"a": {"unit": "1", "initial": 0}, "y": {"unit": "1"},
        "s": {"unit": "1"}}, "equations": ["a' = 0", "y = atan(a)", "s = 20 sin(a)"],
        "run": {"for": 1, "step": 1e-3}}"#,
    );
    sketch.constant("a", 0.0);
    let function = |sketch: &mut Sketch, kind, name: &str, (node, peak): (u32, f64)| {
        let operation = Operation::Function { kind, argument: sketch.term("1", node) };
        sketch.node(name, "1", [0.0, peak], 0.0, operation);
    };
    function(&mut sketch, FunctionKind::Sin, "sin(y)", (4, 0.0));
    function(&mut sketch, FunctionKind::Cos, "cos(y)", (4, 1.0));
    sketch.node("a cos(y)", "1", [0.0, 0.0], 0.0, Operation::Product([NodeId(0), NodeId(2)]));
    let zero = Operation::Zero(sketch.sum(&[("1", 1), ("-1", 3)]));
    // The peak consists of rounding.
    sketch.node("y", "1", [-1e-17, 1e-17], 0.0, zero);
    function(&mut sketch, FunctionKind::Sin, "sin(a)", (0, 0.0));
    let multiple = Operation::Sum(sketch.sum(&[("20", 5)]));
    sketch.node("s", "1", [0.0, 0.0], 0.0, multiple);
    let scales = sketch.with_quantities().scales().per_volt;
    for node in [1, 4, 5] {
        assert!((scales[node] - 0.01).abs() < 1e-15, "{node}: {scales:?}");
    }
}

#[test]
fn a_sum_with_one_term_is_a_pot_if_its_peak_is_high_enough() {
    let mut sketch = Sketch::new(
        r#"{"patchcord": 1, "parameters": {"K": {"value": 3, "unit": "N/m"}},
        "quantities": {"x": {"unit": "m", "initial": 8}, "force": {"unit": "N"}, "same": {"unit": "m"}},
        "equations": ["x' = 0", "force = K x", "same = -x"], "run": {"for": 1, "step": 1e-3}}"#,
    );
    sketch.integral("x", "m", [8.0, 0.0], "8", &[]);
    let force = Operation::Sum(sketch.sum(&[("K", 0)]));
    sketch.node("force", "N", [-24.0, 24.0], 0.0, force);
    let same = Operation::Sum(sketch.sum(&[("-1", 0)]));
    sketch.node("same", "m", [-8.0, 8.0], 0.0, same);
    let sketch = sketch.with_quantities();
    // 8 m are 80 V, and 24 N are 60 V. With 80 V for 24 N, the pot would be fully open.
    let made = sketch.synthesis();
    let scales = sketch.scales().per_volt;
    assert!((scales[1] / 0.4 - 1.0).abs() < 1e-9, "{scales:?}");
    assert_eq!(made.patch.elements[made.patch.signals["force"].element.value.as_str()].kind.name, "pot");
    assert_eq!(scales[2], scales[0]);
    let kinds: Vec<&str> = made.patch.elements.values().map(|element| element.kind.name).collect();
    assert_eq!(kinds, ["integrator", "pot"]);
    assert_eq!(made.patch.signals["same"].factor, -1.0);
}

#[test]
fn a_stated_scale_of_a_product_needs_an_amplifier_after_the_multiplier() {
    let mut sketch = Sketch::new(
        r#"{"patchcord": 1, "quantities": {"a": {"unit": "1", "initial": 4}, "b": {"unit": "1", "initial": 2},
        "p": {"unit": "1", "per_volt": 0.1}}, "equations": ["a' = 0", "b' = 0", "p = a b"],
        "run": {"for": 1, "step": 1e-3}}"#,
    );
    sketch.constant("a", 4.0);
    sketch.constant("b", 2.0);
    sketch.node("p", "1", [8.0, 8.0], 0.0, Operation::Product([NodeId(0), NodeId(1)]));
    let sketch = sketch.with_quantities();
    let scales = sketch.scales();
    assert_eq!(scales.per_volt.len(), 4);
    assert_eq!(scales.per_volt[2], 0.1);
    let reading = super::Reading::of(&sketch.synthesis());
    super::assert_close(reading.value("p"), 8.0);
}

#[test]
fn the_time_scale_is_1_if_all_coefficients_are_usable() {
    assert_eq!(oscillator(MILLIMETRES, 6.0, [0.08, 0.48]).scales().time_scale, 1.0);
    let machine = machines::DEFAULT_MACHINE;
    let sketch = oscillator(MILLIMETRES, 6.0, [0.08, 0.48]);
    let fixed = ScaleOptions { machine, time_scale: Some(4.0), ..options() };
    let chosen = super::choose_scales(&sketch.plan, &sketch.problem, &sketch.circuit, &sketch.ranges, &fixed);
    assert_eq!(chosen.time_scale, 4.0);
}

#[test]
fn the_fastest_oscillation_becomes_1_hertz() {
    // 0.02 rad/s are 0.0032 Hz; 2 pi 5000 rad/s are 5 kHz.
    assert_eq!(oscillator(MILLIMETRES, 0.02, [0.08, 0.0016]).scales().time_scale, 0.005);
    let w = std::f64::consts::TAU * 5000.0;
    assert_eq!(oscillator(MILLIMETRES, w, [0.001, 0.001 * w]).scales().time_scale, 5000.0);
}

#[test]
fn measured_peaks_outside_50_to_95_volts_change_a_scale() {
    let sketch = oscillator(MILLIMETRES, 6.0, [0.08, 0.48]);
    let scales = sketch.scales();
    let improve = |sketch: &Sketch, volts: [f64; 2]| {
        let volts = [(NodeId(0), volts[0]), (NodeId(1), volts[1])];
        let Sketch { plan, problem, circuit, ranges, .. } = sketch;
        improved_scales(plan, problem, circuit, ranges, &options(), &scales, &volts)
    };
    assert_eq!(improve(&sketch, [80.0, 60.0]), scales);
    let larger = improve(&sketch, [100.0, 60.0]).per_volt;
    assert!(larger[0] >= 1.5 * scales.per_volt[0] && larger[1] == scales.per_volt[1], "{larger:?}");
    // In a run with an overload, the other voltages mean nothing.
    assert_eq!(improve(&sketch, [100.0, 20.0]).per_volt[1], scales.per_volt[1]);
    // A voltage that is far too large is not believed.
    let after_large = improve(&sketch, [1e9, 60.0]).per_volt;
    assert!(after_large[0] <= 10.0 * scales.per_volt[0], "{after_large:?}");
    let smaller = improve(&sketch, [80.0, 20.0]).per_volt;
    let peak = 20.0 * scales.per_volt[1] / smaller[1];
    assert!((50.0..=95.0).contains(&peak) && smaller[0] == scales.per_volt[0], "{smaller:?}");
}

#[test]
fn a_stated_maximum_that_is_kept_never_changes() {
    let stated =
        r#""x": {"unit": "mm", "initial": 0, "maximum": 100}, "x'": {"unit": "mm/s", "maximum": 600}"#;
    let sketch = oscillator(stated, 6.0, [0.02, 0.7]);
    let scales = sketch.scales();
    let Sketch { plan, problem, circuit, ranges, .. } = &sketch;
    let improve = |options: &ScaleOptions, volts: [f64; 2]| {
        let volts = [(NodeId(0), volts[0]), (NodeId(1), volts[1])];
        improved_scales(plan, problem, circuit, ranges, options, &scales, &volts).per_volt
    };
    for volts in [[20.0, 100.0], [20.0, 80.0]] {
        assert_eq!(improve(&options(), volts), scales.per_volt);
    }
    let free = ScaleOptions { keeps_maxima: false, ..options() };
    assert!(improve(&free, [20.0, 100.0])[1] > scales.per_volt[1]);
    assert!(improve(&free, [20.0, 80.0])[0] < scales.per_volt[0]);
}

#[test]
fn a_stated_maximum_that_the_solution_exceeds_is_not_used() {
    let stated =
        r#""x": {"unit": "mm", "initial": 0, "maximum": 70}, "x'": {"unit": "mm/s", "maximum": 500}"#;
    let sketch = oscillator(stated, 6.0, [0.08, 0.5]);
    let Sketch { plan, problem, circuit, ranges, .. } = &sketch;
    let options = ScaleOptions { keeps_maxima: false, ..options() };
    let scales = choose_scales(plan, problem, circuit, ranges, &options).per_volt;
    // 80 mm exceed 70 mm. 500 mm/s do not exceed 500 mm/s.
    assert!((scales[0] - 1e-3).abs() < 1e-15 && (scales[1] - 5e-3).abs() < 1e-15, "{scales:?}");
}

#[test]
fn the_bounds_of_a_limiter_are_within_100_volts() {
    let mut sketch = Sketch::new(
        r#"{"patchcord": 1, "quantities": {"a": {"unit": "1", "initial": 1}, "y": {"unit": "1"}},
        "equations": ["a' = 0", "y = limit(a, -20, 30)"], "run": {"for": 1, "step": 1e-3}}"#,
    );
    sketch.constant("a", 1.0);
    let [lower, upper] = ["-20", "30"].map(|bound| Some(sketch.read(bound)));
    let limited = Operation::Limited { sum: sketch.sum(&[("1", 0)]), lower, upper };
    sketch.node("y", "1", [1.0, 1.0], 0.0, limited);
    let scales = sketch.with_quantities().scales().per_volt;
    assert!((30.0 / 95.0..=30.0 / 50.0).contains(&scales[1]), "{scales:?}");
}
