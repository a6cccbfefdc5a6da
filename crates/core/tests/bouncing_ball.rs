//! A ball on a floor: parabolas between bounces, bounce velocities in a geometric series, then rest.

use crate::common::{
    built, check_derivatives, check_derivatives_except, element, patch, program, run_for, voltage, volts,
};

/// Gravity in m/s2.
const G: f64 = 9.81;
/// Initial height in m.
const H0: f64 = 1.0;
/// Metres per volt of the height.
const HEIGHT: f64 = 0.02;
/// Metres per second per volt of the velocity.
const VELOCITY: f64 = 0.1;

/// Permitted error of heights in m. A method of order 4 computes parabolas exactly and bounces are located to 1e-13 of
/// a step, so only rounding remains, and every bounce amplifies it.
const MAX_ERROR: f64 = 1e-10;

/// Height in m and velocity in m/s by the geometric series. The ball stays down after a bounce slower than `rest`.
fn ball(e: f64, rest: f64, time: f64) -> (f64, f64) {
    let (mut begin, mut speed) = (-(2.0 * H0 / G).sqrt(), (2.0 * G * H0).sqrt());
    while time > begin + 2.0 * speed / G {
        begin += 2.0 * speed / G;
        speed *= e;
        if speed < rest {
            return (0.0, 0.0);
        }
    }
    let elapsed = time - begin;
    (speed * elapsed - 0.5 * G * elapsed * elapsed, speed - G * elapsed)
}

#[test]
fn heights_and_velocities_follow_the_series_until_rest() {
    for e in [0.3, 0.8, 0.9] {
        let program = program(&patch("bouncing-ball"), &[("e", e)]);
        let mut machine = run_for(&program, 1e-2, 0.0);
        // Not a multiple of the step, so every run ends with a partial step.
        for instant in 1..=400 {
            machine.operate(0.0123).unwrap();
            let (height, velocity) = ball(e, 0.01, 0.0123 * f64::from(instant));
            assert!(
                (voltage(&machine, "B1") * HEIGHT - height).abs() < MAX_ERROR,
                "{e} {instant} {}",
                voltage(&machine, "B1") * HEIGHT - height
            );
            assert!(
                (voltage(&machine, "A1") * VELOCITY - velocity).abs() < MAX_ERROR * 10.0,
                "{e} {instant}"
            );
        }
    }
}

#[test]
fn apexes_agree_with_the_series() {
    let (e, program) = (0.8f64, program(&patch("bouncing-ball"), &[]));
    let first = (2.0 * H0 / G).sqrt();
    for bounce in 1..=20 {
        let before: f64 = (1..bounce).map(|bounce| 2.0 * first * e.powi(bounce)).sum();
        let machine = run_for(&program, 1e-3, first + before + first * e.powi(bounce));
        let apex = voltage(&machine, "B1") * HEIGHT;
        assert!((apex - H0 * e.powi(2 * bounce)).abs() < MAX_ERROR, "bounce {bounce} rises to {apex}");
        assert!((voltage(&machine, "A1") * VELOCITY).abs() < MAX_ERROR * 10.0);
    }
}

#[test]
fn a_ball_at_rest_does_not_move() {
    let program = program(&patch("bouncing-ball"), &[]);
    let mut machine = run_for(&program, 1e-3, 4.5);
    let resting = machine.states().to_vec();
    assert_eq!(voltage(&machine, "A1"), 0.0);
    machine.operate(5.0).unwrap();
    assert_eq!(machine.states(), resting);
}

#[test]
fn a_ball_without_restitution_stays_down_at_the_first_contact() {
    let program = program(&patch("bouncing-ball"), &[("e", 0.0)]);
    let machine = run_for(&program, 1e-2, 0.46);
    assert_eq!(voltage(&machine, "A1"), 0.0);
    assert!(voltage(&machine, "B1").abs() < 1e-9);
}

#[test]
fn a_ball_without_losses_always_returns_to_the_same_height() {
    let program = program(&patch("bouncing-ball"), &[("e", 1.0)]);
    let period = 2.0 * (2.0 * H0 / G).sqrt();
    let machine = run_for(&program, 1e-2, 50.0 * period);
    assert!(
        (voltage(&machine, "B1") * HEIGHT - H0).abs() < MAX_ERROR,
        "{}",
        voltage(&machine, "B1") * HEIGHT - H0
    );
}

#[test]
fn many_bounces_within_one_step_are_located() {
    let program = program(&patch("bouncing-ball"), &[]);
    let machine = run_for(&program, 1.0, 3.0);
    let (height, velocity) = ball(0.8, 0.01, 3.0);
    assert!((voltage(&machine, "B1") * HEIGHT - height).abs() < MAX_ERROR);
    assert!((voltage(&machine, "A1") * VELOCITY - velocity).abs() < MAX_ERROR * 10.0);
}

/// Gravity changes its sign: the ball rests on the floor, and a pull that grows by 5 V/s lifts it.
#[test]
fn a_resting_ball_is_released_when_its_pull_changes_sign() {
    let builder = volts("lifted")
        .drive("pull", "volt", element("ramp").set("start", -10).set("rate", 5))
        .element("S1", element("summer").cords("x1", ["pull"]))
        .element("A1", element("integrator").cords("x1", ["S1"]).cords("gap", ["B1"]))
        .element("A2", element("integrator").cords("x1", ["A1"]))
        .element("B1", element("summer").cords("x1", ["A2"]));
    let program = built(builder);
    for step in [1e-2, 0.3] {
        assert!(voltage(&run_for(&program, step, 1.9), "B1").abs() < 1e-9);
        let lifted = run_for(&program, step, 4.0);
        assert!((voltage(&lifted, "A1") - 10.0).abs() < MAX_ERROR, "{}", voltage(&lifted, "A1") - 10.0);
        assert!((voltage(&lifted, "B1") - 5.0 / 6.0 * 8.0).abs() < MAX_ERROR);
    }
}

#[test]
fn derivatives_agree_above_the_floor_and_at_rest() {
    let program = program(&patch("bouncing-ball"), &[]);
    check_derivatives(&program, 1e-3, &[0.2, 0.8, 2.0]);
    check_derivatives_except(&program, 1e-3, &[4.8], &["A1", "A2"]);
}
