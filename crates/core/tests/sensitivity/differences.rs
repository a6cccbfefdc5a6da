//! Derivatives through every kind of event, compared with differences of runs.

use crate::common::{element, patch, slideway, volts};
use crate::sensitivity::comparison::Case;
use patchcord_core::patch::Patch;

fn shipped(file: &str) -> Patch {
    Patch::read(format!("../../patches/{file}.json")).unwrap_or_else(|error| panic!("{error}"))
}

#[test]
fn derivatives_of_a_bouncing_ball_agree() {
    let case = || Case::new(patch("bouncing-ball"), &[], 3.3);
    case().check(&["g", "h0", "e"], 1e-6, 0.97);
    case().with(|settings| settings.with_tolerance(1e-10)).check(&["g", "e"], 1e-6, 0.9);
}

#[test]
fn derivatives_of_a_relay_oscillator_agree() {
    Case::new(patch("relay-oscillator"), &[], 3.0).check(&["slope", "a_high", "a_low"], 1e-6, 0.95);
}

#[test]
fn derivatives_of_stick_slip_with_a_brake_agree() {
    Case::new(patch("stick-slip-brake"), &[], 4.0).check(
        &["m", "k", "Fs", "Fk", "v_pull", "v_relay"],
        1e-5,
        0.9,
    );
}

#[test]
fn derivatives_of_delay_lines_agree() {
    // The slope of the cubic in the delay line has order 3: an error of 1e-6 of the largest derivative at 5 ms.
    Case::new(patch("delay-line"), &[], 4.0).with(|settings| settings.with_step(5e-3)).check(
        &["T", "T_x", "x0", "height", "tone"],
        1e-6,
        0.95,
    );
}

#[test]
fn derivatives_of_fig_8_16_agree() {
    let case = || Case { relative_step: 1e-6, ..Case::new(slideway(), &[], 0.5) };
    case().check(&["M", "K", "f", "Fs", "VcL", "Tc"], 1e-5, 0.9);
    case().with(|settings| settings.with_tolerance(1e-9)).check(&["M", "Fs"], 1e-6, 0.9);
}

#[test]
fn derivatives_of_fig_8_16_with_a_brake_agree() {
    let case = Case { relative_step: 1e-6, ..Case::new(shipped("thesis/fig-8-16-coulomb"), &[], 0.5) };
    case.check(&["M", "K", "f", "Fs", "VcL", "Tc"], 1e-6, 0.9);
}

/// A time-scaled patch with a table whose corners are within steps, and a loop without an integrator.
#[test]
fn derivatives_of_a_time_scaled_patch_agree() {
    let points = serde_json::json!([[0.313, 0], [1.271, 30], [1.277, -30], [1.9, 5]]);
    let builder = volts("slow")
        .time_scale(2.5)
        .parameter("late", 0.9, "s", [0.1, 3.0])
        .parameter("back", 0.4, "1", [0.0, 1.0])
        .parameter("width", 0.05, "m", [0.01, 1.0])
        .scale("length", "width / 40", "m")
        .drive("u", "volt", element("table").set("points", points))
        .element("S1", element("summer").cords("x1", ["u", "PB"]))
        .element("PB", element("pot").cord("in", "S1").set("setting", "back"))
        .element("D1", element("delay").cord("in", "S1").set("delay", "late"))
        .element("L1", element("lag").cords("x1", ["D1"]).set("time", "late / 3"))
        .element(
            "A1",
            element("integrator").cords("x0.5", ["L1", "A1"]).set("initial", "width / length / 10"),
        )
        .signal("x", "A1", "length", 1.0)
        .signal("lagged", "L1", "volt", 1.0)
        .run(3.0, 1e-3);
    let patch = builder.build().unwrap_or_else(|report| panic!("{report}"));
    Case::new(patch, &[], 3.0).check(&["late", "back", "width"], 1e-6, 0.95);
}

#[test]
fn derivatives_agree_at_and_after_a_limit() {
    let case = Case::new(patch("integrator-limit"), &[("t_turn", 19.3)], 30.0);
    case.check(&["u", "t_turn"], 1e-7, 0.95);
}

#[test]
fn derivatives_of_noise_through_elements_with_memory_agree() {
    // Noise gives the delay lines pieces of few samples, which need short steps.
    Case::new(patch("memory"), &[], 4.0).with(|settings| settings.with_step(1e-3)).check(&["top"], 1e-7, 0.9);
}
