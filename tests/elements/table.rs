//! Drive: a table of points.

use proptest::prelude::*;
use serde_json::json;

use crate::bench::{ANY, bench_drive, drive_stops_at_100_volts, near, out, waits_in_hold};
use crate::common::{element, ran, random_cases};

/// The value of a table: straight between its points, level outside.
fn looked_up(points: &[[f64; 2]], time: f64) -> f64 {
    for pair in points.windows(2) {
        let ([from, low], [to, high]) = (pair[0], pair[1]);
        if (from..to).contains(&time) {
            return (low * (to - time) + high * (time - from)) / (to - from);
        }
    }
    if time < points[0][0] { points[0][1] } else { points[points.len() - 1][1] }
}

proptest! {
    #![proptest_config(random_cases(48))]

    #[test]
    fn law(first in -0.2..0.2f64, more in prop::collection::vec((0.01..0.3f64, ANY), 1..8), time in 0.0..1.0f64) {
        let mut points = vec![[first, 30.0]];
        for (wait, volts) in more {
            points.push([points[points.len() - 1][0] + wait, volts]);
        }
        let program = bench_drive(element("table").set("points", json!(points)));
        let (found, expected) = (out(&ran(&program, 0.1, time)), looked_up(&points, time));
        prop_assert!((found - expected).abs() < 1e-11, "{found} {expected}");
    }
}

#[test]
fn overload() {
    drive_stops_at_100_volts(element("table").set("points", json!([[0, 130]])), 130.0);
}

#[test]
fn modes() {
    let points = [[0.1, 20.0], [0.5, 60.0], [0.6, -30.0]];
    waits_in_hold(element("table").set("points", json!(points)), |time| looked_up(&points, time));
}

#[test]
fn it_is_level_outside_its_points() {
    let program = bench_drive(element("table").set("points", json!([[0.1, 20], [0.2, 60]])));
    for (time, expected) in [(0.0, 20.0), (0.05, 20.0), (0.3, 60.0)] {
        assert!(near(out(&ran(&program, 1e-2, time)), expected), "{time}");
    }
}
