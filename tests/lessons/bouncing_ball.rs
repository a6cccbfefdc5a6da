//! A ball in a box: parabolas between blows, heights and velocities in geometric series.

use crate::common::{ran, voltage};
use crate::known::runs::{program, run, step_of, values};

const STEM: &str = "lessons/bouncing-ball";
const G: f64 = 9.81;
const H0: f64 = 1.8;
const E: f64 = 0.85;
const WIDTH: f64 = 1.6;
const V0: f64 = 1.5;
const E_WALL: f64 = 0.9;
const LENGTH: f64 = 0.02;

/// Free flight is a parabola, which a method of order 4 works out exactly, and blows are located to 1e-13 of a
/// step: what is left is rounding, handed on from blow to blow.
const NEAR: f64 = 1e-10;

#[test]
fn every_bounce_rises_to_e_squared_of_the_one_before() {
    let program = program(STEM, &[]);
    let falls = (2.0 * H0 / G).sqrt();
    for bounce in 1..=20 {
        let earlier: f64 = (1..bounce).map(|bounce| 2.0 * falls * E.powi(bounce)).sum();
        let machine = ran(&program, step_of(STEM), falls + earlier + falls * E.powi(bounce));
        let apex = voltage(&machine, "B1") * LENGTH;
        assert!((apex - H0 * E.powi(2 * bounce)).abs() < NEAR, "bounce {bounce} rises to {apex} m");
    }
}

/// Distance from the left wall: from wall to wall, each time slower.
fn across(time: f64) -> f64 {
    let (mut begin, mut speed, mut blows) = (0.0, V0, 0);
    while time > begin + WIDTH / speed {
        begin += WIDTH / speed;
        speed *= E_WALL;
        blows += 1;
    }
    let gone = speed * (time - begin);
    if blows % 2 == 0 { gone } else { WIDTH - gone }
}

#[test]
fn it_goes_from_wall_to_wall_each_time_slower() {
    let trace = run(STEM, &[], 20.0);
    for (time, x) in trace.time.iter().zip(values(&trace, "x")) {
        assert!((x - across(*time)).abs() < NEAR, "{x} m at {time} s, not {}", across(*time));
    }
}

#[test]
fn it_stays_in_the_box() {
    for changes in [&[][..], &[("v0", 3.9), ("e", 1.0), ("e_wall", 1.0), ("width", 0.5)]] {
        let trace = run(STEM, changes, 20.0);
        let width = if changes.is_empty() { WIDTH } else { 0.5 };
        for (signal, end) in [("x", width), ("y", H0)] {
            let track = trace.track(signal).unwrap();
            let course = track.courses[0];
            let (least, most) = (course.least.volts * LENGTH, course.most.volts * LENGTH);
            assert!(least > -NEAR && most < end + NEAR, "{signal} goes from {least} m to {most} m");
        }
        assert_eq!(trace.overloads().count(), 0);
    }
}
