//! Delay lines: exact in responses, within loops too.

use std::f64::consts::TAU;

use nalgebra::Complex;

use crate::common::{built, element, volts};
use crate::linear::{model, near, response};
use patchcord_analysis::linear::{Band, LinearError, Transfer};
use patchcord_core::patch::PatchBuilder;

fn driven(title: &str) -> PatchBuilder {
    volts(title).drive("u", "volt", element("step").set("height", 1))
}

#[test]
fn a_delay_turns_the_phase_and_nothing_else() {
    let program = built(driven("late").element("D", element("delay").cord("in", "u").set("delay", 0.3)));
    let found = response(&program, "u", "D", [0.01, 500.0]);
    for point in &found.points {
        assert!(near(point.ratio, 1.0, 1e-12), "{point:?}");
        let turned = -TAU * point.frequency * 0.3;
        assert!((point.phase - turned).abs() < 1e-9, "{point:?} {turned}");
    }
}

#[test]
fn delays_have_machine_time() {
    let slow = driven("slow").time_scale(10.0);
    let program = built(slow.element("D", element("delay").cord("in", "u").set("delay", 3)));
    let point = response(&program, "u", "D", [0.5, 1.0]).points[0];
    assert!(near(point.phase, -TAU * 0.5 * 0.3, 1e-12), "{point:?}");
}

/// A' = -(4 u + 3 D), D what A was 0.2 s ago.
fn late_feedback() -> PatchBuilder {
    driven("late feedback")
        .element("A", element("integrator").cords("x4", ["u"]).cords("x3", ["D"]))
        .element("D", element("delay").cord("in", "A").set("delay", 0.2))
}

#[test]
fn a_loop_through_a_delay_is_solved_at_every_frequency() {
    let found = response(&built(late_feedback()), "u", "A", [0.01, 100.0]);
    for point in &found.points {
        let s = Complex::new(0.0, TAU * point.frequency);
        let wanted = -4.0 / (s + 3.0 * (-s * 0.2).exp());
        assert!(near(point.ratio, wanted.norm(), 1e-11), "{point:?} {wanted}");
        assert!(
            (Complex::from_polar(point.ratio, point.phase) - wanted).norm() < 1e-11,
            "{point:?} {wanted}"
        );
    }
}

#[test]
fn an_echo_without_an_integrator_is_a_comb() {
    // S = -(u + D / 2), D what S was 0.1 s ago.
    let builder = driven("echo")
        .element("S", element("summer").cords("x1", ["u"]).cords("x0.5", ["D"]))
        .element("D", element("delay").cord("in", "S").set("delay", 0.1));
    let found = response(&built(builder), "u", "S", [0.1, 100.0]);
    for point in &found.points {
        let late = Complex::new(0.0, -TAU * point.frequency * 0.1).exp();
        let wanted = -1.0 / (1.0 + 0.5 * late);
        assert!((Complex::from_polar(point.ratio, point.phase) - wanted).norm() < 1e-11, "{point:?}");
    }
    let (least, most) = found
        .points
        .iter()
        .fold((f64::MAX, 0.0f64), |(least, most), point| (least.min(point.ratio), most.max(point.ratio)));
    assert!(near(least, 2.0 / 3.0, 1e-2) && near(most, 2.0, 1e-2), "{least} {most}");
}

#[test]
fn more_turns_than_can_be_drawn_are_refused() {
    let program = built(driven("late").element("D", element("delay").cord("in", "u").set("delay", 0.3)));
    let model = model(&program);
    let transfer = Transfer::new(&model, "u", "D").unwrap();
    let refused = transfer.over(Band { low: 1.0, high: 1e6 });
    assert!(matches!(refused, Err(LinearError::TooManyTurns { .. })), "{refused:?}");
}
