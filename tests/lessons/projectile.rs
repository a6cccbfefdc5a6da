//! A thrown ball: range and time of flight with and without drag.

use crate::common::{ran, voltage};
use crate::known::runs::{circuit, program, ran_circuit, settings, step_of, values};
use crate::lessons::bench::next_rise;

const STEM: &str = "lessons/projectile";
const M: f64 = 0.145;
const C: f64 = 8.8e-4;
const G: f64 = 9.81;
const DISTANCE: f64 = 2.5;
const HEIGHT: f64 = 1.1;
const VELOCITY: f64 = 0.6;

/// An amplification of 1e6 leaves the speed wrong by a millionth, and what follows from it by about as much.
const NEAR: f64 = 2e-6;

/// Time of flight in s, range in m, speed at the end in m/s.
fn landing(changes: &[(&str, f64)]) -> [f64; 3] {
    let program = program(STEM, changes);
    let mut machine = ran(&program, step_of(STEM), 0.0);
    let time = next_rise(&mut machine, |machine| voltage(machine, "A4"));
    [time, -voltage(&machine, "A2") * DISTANCE, voltage(&machine, "A5") * VELOCITY]
}

#[test]
fn range_and_time_are_those_of_an_independent_solver() {
    // scipy 1.17, DOP853 at 1e-13, until the height is 0 again: speed, angle, c; time, range.
    let thrown = [
        (45.0, 40.0, 8.8e-4, 4.922_550_346_28, 112.298_851_802_9),
        (45.0, 30.0, 8.8e-4, 3.933_735_040_39, 106.474_732_062_6),
        (50.0, 45.0, 1.2e-3, 5.470_298_416_47, 107.659_329_589_2),
    ];
    for (v0, angle, c, time, range) in thrown {
        let found = landing(&[("v0", v0), ("angle", angle), ("c", c)]);
        assert!((found[0] / time - 1.0).abs() < NEAR, "{v0} m/s, {angle} deg: {found:?} {time}");
        assert!((found[1] / range - 1.0).abs() < NEAR, "{v0} m/s, {angle} deg: {found:?} {range}");
    }
}

#[test]
fn without_drag_the_path_is_a_parabola() {
    for angle in [20.0f64, 45.0, 70.0] {
        let [time, range, speed] = landing(&[("c", 0.0), ("v0", 30.0), ("angle", angle)]);
        let (sine, cosine) = angle.to_radians().sin_cos();
        assert!((time - 60.0 * sine / G).abs() < 1e-10, "{time}");
        assert!((range - 1800.0 * sine * cosine / G).abs() < 1e-9, "{range}");
        assert!((speed / 30.0 - 1.0).abs() < NEAR, "as fast as it was thrown: {speed}");
    }
}

#[test]
fn straight_up_it_follows_the_closed_solution() {
    let terminal = (M * G / C).sqrt();
    for v0 in [20.0f64, 45.0] {
        let program = program(STEM, &[("v0", v0), ("angle", 90.0)]);
        let mut machine = ran(&program, step_of(STEM), 0.0);
        let top = next_rise(&mut machine, |machine| -voltage(machine, "A3"));
        let height = -voltage(&machine, "A4") * HEIGHT;
        assert!((top / (terminal / G * (v0 / terminal).atan()) - 1.0).abs() < NEAR, "{top}");
        let expected = terminal.powi(2) / (2.0 * G) * (v0 / terminal).powi(2).ln_1p();
        assert!((height / expected - 1.0).abs() < NEAR, "{height} {expected}");
        let [_, _, speed] = landing(&[("v0", v0), ("angle", 90.0)]);
        assert!((speed / (v0 * terminal / v0.hypot(terminal)) - 1.0).abs() < NEAR, "{speed}");
    }
}

#[test]
fn the_run_ends_each_throw_on_the_ground() {
    let circuit = circuit(STEM, &[]);
    let trace = ran_circuit(&circuit, &settings(&circuit));
    let (x, y) = (values(&trace, "x"), values(&trace, "y"));
    let ends = [trace.sweeps[1].first - 1, trace.len() - 1];
    // With air as the independent solver says, without air v0^2 sin(2 angle) / g.
    let ranges = [112.298_851_802_9, 45.0 * 45.0 * 80f64.to_radians().sin() / G];
    for (end, range) in ends.into_iter().zip(ranges) {
        assert!((x[end] / range - 1.0).abs() < NEAR, "{} m, not {range} m", x[end]);
        assert!(y[end].abs() < 1e-9, "{} m above the ground", y[end]);
    }
}
