//! A ball in a box: parabolas between bounces, heights and velocities in geometric series.

use crate::common::{run_for, voltage};
use crate::known_problems::runs::{program, run, step_of, values};

const STEM: &str = "lessons/bouncing-ball";
/// Gravity in m/s2.
const G: f64 = 9.81;
/// Initial height in m.
const H0: f64 = 1.8;
/// Restitution of the floor.
const E: f64 = 0.85;
/// Width of the box in m.
const WIDTH: f64 = 1.6;
/// Initial horizontal velocity in m/s.
const V0: f64 = 1.5;
/// Restitution of the walls.
const E_WALL: f64 = 0.9;
/// Metres per volt.
const LENGTH: f64 = 0.02;

/// A method of order 4 computes a parabola exactly, and bounces are located to 1e-13 of a step. The remaining error is
/// rounding that accumulates from bounce to bounce.
const BOUNCE_TOLERANCE: f64 = 1e-10;

#[test]
fn every_bounce_rises_to_e_squared_of_the_one_before() {
    let program = program(STEM, &[]);
    let falls = (2.0 * H0 / G).sqrt();
    for bounce in 1..=20 {
        let earlier: f64 = (1..bounce).map(|bounce| 2.0 * falls * E.powi(bounce)).sum();
        let machine = run_for(&program, step_of(STEM), falls + earlier + falls * E.powi(bounce));
        let apex = voltage(&machine, "B1") * LENGTH;
        assert!(
            (apex - H0 * E.powi(2 * bounce)).abs() < BOUNCE_TOLERANCE,
            "bounce {bounce} rises to {apex} m"
        );
    }
}

/// Distance from the left wall: the ball moves from wall to wall, each time slower.
fn across(time: f64) -> f64 {
    let (mut begin, mut speed, mut bounces) = (0.0, V0, 0);
    while time > begin + WIDTH / speed {
        begin += WIDTH / speed;
        speed *= E_WALL;
        bounces += 1;
    }
    let distance = speed * (time - begin);
    if bounces % 2 == 0 { distance } else { WIDTH - distance }
}

#[test]
fn the_ball_moves_from_wall_to_wall_each_time_slower() {
    let trace = run(STEM, &[], 20.0);
    for (time, x) in trace.time.iter().zip(values(&trace, "x")) {
        assert!((x - across(*time)).abs() < BOUNCE_TOLERANCE, "{x} m at {time} s, not {}", across(*time));
    }
}

#[test]
fn the_ball_stays_in_the_box() {
    for changes in [&[][..], &[("v0", 3.9), ("e", 1.0), ("e_wall", 1.0), ("width", 0.5)]] {
        let trace = run(STEM, changes, 20.0);
        let width = if changes.is_empty() { WIDTH } else { 0.5 };
        for (signal, end) in [("x", width), ("y", H0)] {
            let track = trace.track(signal).unwrap();
            let extremes = track.extremes[0];
            let (least, most) = (extremes.least.volts * LENGTH, extremes.most.volts * LENGTH);
            assert!(
                least > -BOUNCE_TOLERANCE && most < end + BOUNCE_TOLERANCE,
                "{signal} goes from {least} m to {most} m"
            );
        }
        assert_eq!(trace.overloads().count(), 0);
    }
}
