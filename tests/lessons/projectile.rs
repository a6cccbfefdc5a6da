//! A thrown ball: range and duration of the throw with and without drag.

use crate::common::{run_for, voltage};
use crate::known_problems::runs::{circuit, program, run_circuit, settings, step_of, values};
use crate::lessons::crossings::next_rise;

const STEM: &str = "lessons/projectile";
/// Mass in kg.
const M: f64 = 0.145;
/// Drag coefficient in N s2/m2.
const C: f64 = 8.8e-4;
/// Gravity in m/s2.
const G: f64 = 9.81;
/// Metres per volt of the distance.
const DISTANCE: f64 = 2.5;
/// Metres per volt of the height.
const HEIGHT: f64 = 1.1;
/// Metres per second per volt.
const VELOCITY: f64 = 0.6;

/// An open-loop gain of 1e6 gives a relative error of 1e-6 in the speed, and about as much in derived values.
const GAIN_TOLERANCE: f64 = 2e-6;

/// Duration of the throw in s, range in m, speed at the end in m/s.
fn landing(changes: &[(&str, f64)]) -> [f64; 3] {
    let program = program(STEM, changes);
    let mut machine = run_for(&program, step_of(STEM), 0.0);
    let time = next_rise(&mut machine, |machine| voltage(machine, "A4"));
    [time, -voltage(&machine, "A2") * DISTANCE, voltage(&machine, "A5") * VELOCITY]
}

#[test]
fn range_and_time_match_an_independent_solver() {
    // scipy 1.17, DOP853 at 1e-13, until the height returns to 0. Columns: speed, angle, c; time, range.
    let thrown = [
        (45.0, 40.0, 8.8e-4, 4.922_550_346_28, 112.298_851_802_9),
        (45.0, 30.0, 8.8e-4, 3.933_735_040_39, 106.474_732_062_6),
        (50.0, 45.0, 1.2e-3, 5.470_298_416_47, 107.659_329_589_2),
    ];
    for (v0, angle, c, time, range) in thrown {
        let found = landing(&[("v0", v0), ("angle", angle), ("c", c)]);
        assert!((found[0] / time - 1.0).abs() < GAIN_TOLERANCE, "{v0} m/s, {angle} deg: {found:?} {time}");
        assert!((found[1] / range - 1.0).abs() < GAIN_TOLERANCE, "{v0} m/s, {angle} deg: {found:?} {range}");
    }
}

#[test]
fn without_drag_the_path_is_a_parabola() {
    for angle in [20.0f64, 45.0, 70.0] {
        let [time, range, speed] = landing(&[("c", 0.0), ("v0", 30.0), ("angle", angle)]);
        let (sine, cosine) = angle.to_radians().sin_cos();
        assert!((time - 60.0 * sine / G).abs() < 1e-10, "{time}");
        assert!((range - 1800.0 * sine * cosine / G).abs() < 1e-9, "{range}");
        assert!(
            (speed / 30.0 - 1.0).abs() < GAIN_TOLERANCE,
            "the final speed equals the initial speed: {speed}"
        );
    }
}

#[test]
fn a_vertical_throw_agrees_with_the_closed_solution() {
    let terminal = (M * G / C).sqrt();
    for v0 in [20.0f64, 45.0] {
        let program = program(STEM, &[("v0", v0), ("angle", 90.0)]);
        let mut machine = run_for(&program, step_of(STEM), 0.0);
        let top = next_rise(&mut machine, |machine| -voltage(machine, "A3"));
        let height = -voltage(&machine, "A4") * HEIGHT;
        assert!((top / (terminal / G * (v0 / terminal).atan()) - 1.0).abs() < GAIN_TOLERANCE, "{top}");
        let expected = terminal.powi(2) / (2.0 * G) * (v0 / terminal).powi(2).ln_1p();
        assert!((height / expected - 1.0).abs() < GAIN_TOLERANCE, "{height} {expected}");
        let [_, _, speed] = landing(&[("v0", v0), ("angle", 90.0)]);
        assert!((speed / (v0 * terminal / v0.hypot(terminal)) - 1.0).abs() < GAIN_TOLERANCE, "{speed}");
    }
}

#[test]
fn the_run_ends_each_throw_on_the_ground() {
    let circuit = circuit(STEM, &[]);
    let trace = run_circuit(&circuit, &settings(&circuit));
    let (x, y) = (values(&trace, "x"), values(&trace, "y"));
    let ends = [trace.repetitions[1].first - 1, trace.len() - 1];
    // With air: result of the independent solver. Without air: v0^2 sin(2 angle) / g.
    let ranges = [112.298_851_802_9, 45.0 * 45.0 * 80f64.to_radians().sin() / G];
    for (end, range) in ends.into_iter().zip(ranges) {
        assert!((x[end] / range - 1.0).abs() < GAIN_TOLERANCE, "{} m, not {range} m", x[end]);
        assert!(y[end].abs() < 1e-9, "{} m above the ground", y[end]);
    }
}
