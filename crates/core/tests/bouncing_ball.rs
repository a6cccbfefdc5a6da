//! A ball on a floor: parabolas between bounces, velocities in geometric series, then rest.

use crate::common::{
    built, check_derivatives, check_derivatives_but, element, patch, program, ran, voltage, volts,
};

const G: f64 = 9.81;
const H0: f64 = 1.0;
const HEIGHT: f64 = 0.02;
const VELOCITY: f64 = 0.1;

/// Flight of parabolas is worked out exactly by a method of order 4, and bounces are located to 1e-13 of a
/// step: only rounding and that are left, times the bounces that hand them on.
const NEAR: f64 = 1e-10;

/// Height and velocity by the geometric series; velocities thrown back under `rest` stay down.
fn ball(e: f64, rest: f64, time: f64) -> (f64, f64) {
    let (mut begin, mut thrown) = (-(2.0 * H0 / G).sqrt(), (2.0 * G * H0).sqrt());
    while time > begin + 2.0 * thrown / G {
        begin += 2.0 * thrown / G;
        thrown *= e;
        if thrown < rest {
            return (0.0, 0.0);
        }
    }
    let flown = time - begin;
    (thrown * flown - 0.5 * G * flown * flown, thrown - G * flown)
}

#[test]
fn heights_and_velocities_follow_the_series_until_rest() {
    for e in [0.3, 0.8, 0.9] {
        let program = program(&patch("bouncing-ball"), &[("e", e)]);
        let mut machine = ran(&program, 1e-2, 0.0);
        // Not a multiple of the step: every stretch ends with a part of one.
        for instant in 1..=400 {
            machine.operate(0.0123).unwrap();
            let (height, velocity) = ball(e, 0.01, 0.0123 * f64::from(instant));
            assert!(
                (voltage(&machine, "B1") * HEIGHT - height).abs() < NEAR,
                "{e} {instant} {}",
                voltage(&machine, "B1") * HEIGHT - height
            );
            assert!((voltage(&machine, "A1") * VELOCITY - velocity).abs() < NEAR * 10.0, "{e} {instant}");
        }
    }
}

#[test]
fn apexes_stand_where_the_series_puts_them() {
    let (e, program) = (0.8f64, program(&patch("bouncing-ball"), &[]));
    let first = (2.0 * H0 / G).sqrt();
    for bounce in 1..=20 {
        let before: f64 = (1..bounce).map(|bounce| 2.0 * first * e.powi(bounce)).sum();
        let machine = ran(&program, 1e-3, first + before + first * e.powi(bounce));
        let apex = voltage(&machine, "B1") * HEIGHT;
        assert!((apex - H0 * e.powi(2 * bounce)).abs() < NEAR, "bounce {bounce} rises to {apex}");
        assert!((voltage(&machine, "A1") * VELOCITY).abs() < NEAR * 10.0);
    }
}

#[test]
fn at_rest_the_ball_stays_exactly_where_it_is() {
    let program = program(&patch("bouncing-ball"), &[]);
    let mut machine = ran(&program, 1e-3, 4.5);
    let resting = machine.states().to_vec();
    assert_eq!(voltage(&machine, "A1"), 0.0);
    machine.operate(5.0).unwrap();
    assert_eq!(machine.states(), resting);
}

#[test]
fn without_restitution_the_first_contact_is_the_last() {
    let program = program(&patch("bouncing-ball"), &[("e", 0.0)]);
    let machine = ran(&program, 1e-2, 0.46);
    assert_eq!(voltage(&machine, "A1"), 0.0);
    assert!(voltage(&machine, "B1").abs() < 1e-9);
}

#[test]
fn a_ball_without_losses_bounces_for_ever_to_the_same_height() {
    let program = program(&patch("bouncing-ball"), &[("e", 1.0)]);
    let period = 2.0 * (2.0 * H0 / G).sqrt();
    let machine = ran(&program, 1e-2, 50.0 * period);
    assert!(
        (voltage(&machine, "B1") * HEIGHT - H0).abs() < NEAR,
        "{}",
        voltage(&machine, "B1") * HEIGHT - H0
    );
}

#[test]
fn many_bounces_in_one_step_are_all_met() {
    let program = program(&patch("bouncing-ball"), &[]);
    let machine = ran(&program, 1.0, 3.0);
    let (height, velocity) = ball(0.8, 0.01, 3.0);
    assert!((voltage(&machine, "B1") * HEIGHT - height).abs() < NEAR);
    assert!((voltage(&machine, "A1") * VELOCITY - velocity).abs() < NEAR * 10.0);
}

/// Gravity that turns round: it lies on the floor, and is lifted off again by 5 V/s of growing pull.
#[test]
fn what_rests_is_released_when_its_pull_turns() {
    let builder = volts("lifted")
        .drive("pull", "volt", element("ramp").set("start", -10).set("rate", 5))
        .element("S1", element("summer").cords("x1", ["pull"]))
        .element("A1", element("integrator").cords("x1", ["S1"]).cords("gap", ["B1"]))
        .element("A2", element("integrator").cords("x1", ["A1"]))
        .element("B1", element("summer").cords("x1", ["A2"]));
    let program = built(builder);
    for step in [1e-2, 0.3] {
        assert!(voltage(&ran(&program, step, 1.9), "B1").abs() < 1e-9);
        let lifted = ran(&program, step, 4.0);
        assert!((voltage(&lifted, "A1") - 10.0).abs() < NEAR, "{}", voltage(&lifted, "A1") - 10.0);
        assert!((voltage(&lifted, "B1") - 5.0 / 6.0 * 8.0).abs() < NEAR);
    }
}

#[test]
fn derivatives_agree_in_flight_and_at_rest() {
    let program = program(&patch("bouncing-ball"), &[]);
    check_derivatives(&program, 1e-3, &[0.2, 0.8, 2.0]);
    check_derivatives_but(&program, 1e-3, &[4.8], &["A1", "A2"]);
}
