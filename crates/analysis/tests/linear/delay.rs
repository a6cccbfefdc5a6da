//! Delay lines are exact in frequency responses, also within loops.

use std::f64::consts::TAU;

use nalgebra::Complex;

use crate::common::{built, element, volts};
use crate::linear::{model, near, response};
use patchcord_analysis::linear::{FrequencyBand, LinearError, TransferFunction};
use patchcord_core::patch::PatchBuilder;

/// A patch in volts with the drive u.
fn driven(title: &str) -> PatchBuilder {
    volts(title).drive("u", "volt", element("step").set("height", 1))
}

#[test]
fn a_delay_changes_only_the_phase() {
    let program = built(driven("delayed").element("D", element("delay").cord("in", "u").set("delay", 0.3)));
    let found = response(&program, "u", "D", [0.01, 500.0]);
    for point in &found.points {
        assert!(near(point.ratio, 1.0, 1e-12), "{point:?}");
        let expected_phase = -TAU * point.frequency * 0.3;
        assert!((point.phase - expected_phase).abs() < 1e-9, "{point:?} {expected_phase}");
    }
}

#[test]
fn delays_are_in_machine_seconds() {
    let slow = driven("slow").time_scale(10.0);
    let program = built(slow.element("D", element("delay").cord("in", "u").set("delay", 3)));
    let point = response(&program, "u", "D", [0.5, 1.0]).points[0];
    assert!(near(point.phase, -TAU * 0.5 * 0.3, 1e-12), "{point:?}");
}

/// A'(t) = -(4 u(t) + 3 D(t)), D(t) = A(t - 0.2 s).
fn delayed_feedback() -> PatchBuilder {
    driven("delayed feedback")
        .element("A", element("integrator").cords("x4", ["u"]).cords("x3", ["D"]))
        .element("D", element("delay").cord("in", "A").set("delay", 0.2))
}

#[test]
fn a_loop_through_a_delay_is_solved_at_every_frequency() {
    let found = response(&built(delayed_feedback()), "u", "A", [0.01, 100.0]);
    for point in &found.points {
        let s = Complex::new(0.0, TAU * point.frequency);
        let expected = -4.0 / (s + 3.0 * (-s * 0.2).exp());
        assert!(near(point.ratio, expected.norm(), 1e-11), "{point:?} {expected}");
        assert!(
            (Complex::from_polar(point.ratio, point.phase) - expected).norm() < 1e-11,
            "{point:?} {expected}"
        );
    }
}

#[test]
fn a_delayed_feedback_without_an_integrator_is_a_comb_filter() {
    // S(t) = -(u(t) + D(t) / 2), D(t) = S(t - 0.1 s).
    let builder = driven("comb filter")
        .element("S", element("summer").cords("x1", ["u"]).cords("x0.5", ["D"]))
        .element("D", element("delay").cord("in", "S").set("delay", 0.1));
    let found = response(&built(builder), "u", "S", [0.1, 100.0]);
    for point in &found.points {
        let delayed = Complex::new(0.0, -TAU * point.frequency * 0.1).exp();
        let expected = -1.0 / (1.0 + 0.5 * delayed);
        assert!((Complex::from_polar(point.ratio, point.phase) - expected).norm() < 1e-11, "{point:?}");
    }
    let (minimum, maximum) = found.points.iter().fold((f64::MAX, 0.0f64), |(minimum, maximum), point| {
        (minimum.min(point.ratio), maximum.max(point.ratio))
    });
    assert!(near(minimum, 2.0 / 3.0, 1e-2) && near(maximum, 2.0, 1e-2), "{minimum} {maximum}");
}

#[test]
fn a_band_with_too_many_phase_turns_is_an_error() {
    let program = built(driven("delayed").element("D", element("delay").cord("in", "u").set("delay", 0.3)));
    let model = model(&program);
    let transfer = TransferFunction::new(&model, "u", "D").unwrap();
    let result = transfer.response(FrequencyBand { low: 1.0, high: 1e6 });
    assert!(matches!(result, Err(LinearError::TooManyTurns { .. })), "{result:?}");
}
