//! Diode function generator.

use proptest::prelude::*;
use serde_json::json;

use crate::common::{element, random_cases};
use crate::elements::bench::{
    ANY, assert_out, at, bench, clip, computes_in_every_mode, has_exact_derivatives, near, output,
    stops_at_100_volts,
};
use patchcord_core::patch::ElementBuilder;

fn generator(points: &[[f64; 2]], symmetry: &str) -> ElementBuilder {
    element("function-generator").cord("in", "a").set("points", json!(points)).set("symmetry", symmetry)
}

/// The value of the curve at an input. The outermost segments continue beyond the points.
fn curve(points: &[[f64; 2]], input: f64) -> f64 {
    let last = points.len() - 1;
    let above = (1..last).find(|index| input < points[*index][0]).unwrap_or(last);
    let ([x0, y0], [x1, y1]) = (points[above - 1], points[above]);
    (y0 * (x1 - input) + y1 * (input - x0)) / (x1 - x0)
}

/// Two to eight points at least 0.5 V apart. The first is within `from`.
fn points(from: std::ops::Range<f64>) -> impl Strategy<Value = Vec<[f64; 2]>> {
    (from, prop::collection::vec((0.5..15.0f64, ANY), 1..8), ANY).prop_map(|(first, more, out)| {
        let mut points = vec![[first, out]];
        for (distance, volts) in more {
            points.push([(points[points.len() - 1][0] + distance).min(100.0), volts]);
        }
        points.dedup_by_key(|point| point[0]);
        points
    })
}

proptest! {
    #![proptest_config(random_cases(96))]

    #[test]
    fn law(a in ANY, points in points(-100.0..0.0)) {
        let (found, expected) = (output(generator(&points, "none"), &[a]), clip(curve(&points, a)));
        // A segment of 0.5 V that continues over 200 V amplifies the rounding of 100 V 400 times.
        prop_assert!((found - expected).abs() < 1e-10, "{found} {expected}");
    }

    #[test]
    fn symmetry_mirrors_the_points(a in ANY, points in points(0.1..30.0)) {
        for (symmetry, sign) in [("odd", -1.0), ("even", 1.0)] {
            let side = if a < 0.0 { sign } else { 1.0 };
            let first = [[-points[0][0], sign * points[0][1]]];
            let expected = clip(side * curve(&[&first, &points[..]].concat(), a.abs()));
            let found = output(generator(&points, symmetry), &[a]);
            prop_assert!((found - expected).abs() < 1e-10, "{symmetry}: {found} {expected}");
        }
    }
}

/// The upper half of a dead zone of 20 V.
const ZONE: [[f64; 2]; 2] = [[20.0, 0.0], [100.0, 80.0]];
/// x^2 / 100 V in three segments.
const SQUARE: [[f64; 2]; 4] = [[0.0, 0.0], [30.0, 9.0], [60.0, 36.0], [100.0, 100.0]];

#[test]
fn overload() {
    stops_at_100_volts(generator(&[[0.0, 10.0], [20.0, 50.0]], "none"), &[80.0], 170.0);
    stops_at_100_volts(generator(&[[0.0, 10.0], [20.0, 50.0]], "none"), &[-80.0], -150.0);
}

#[test]
fn beyond_100_volts_the_last_segment_continues() {
    for (symmetry, from, expected) in [("odd", "high", 90.0), ("odd", "low", -90.0), ("even", "low", 90.0)] {
        let program = bench(generator(&[[0.0, 0.0], ZONE[0], ZONE[1]], symmetry).cord("in", from));
        let volts = if from == "high" { 100.0 } else { -100.0 };
        assert_out(&at(&program, &[volts]), expected, from);
    }
}

#[test]
fn modes() {
    computes_in_every_mode(generator(&SQUARE, "even"), [(&[60.0], 36.0), (&[-60.0], 36.0), (&[15.0], 4.5)]);
}

#[test]
fn an_odd_generator_equals_a_dead_zone() {
    let zone = element("dead-zone").cord("in", "a").set("lower", -20).set("upper", 20);
    let odd_generator = generator(&[[0.0, 0.0], ZONE[0], ZONE[1]], "odd");
    for volts in [-100.0, -33.0, -20.0, -5.0, 0.0, 12.0, 20.0, 81.0, 100.0] {
        assert!(near(output(odd_generator.clone(), &[volts]), output(zone.clone(), &[volts])), "{volts}");
    }
}

#[test]
fn derivatives() {
    for start in [50.0, -40.0, 20.0] {
        has_exact_derivatives(generator(&SQUARE, "even"), start, &[]);
        has_exact_derivatives(generator(&[[0.0, 5.0], [10.0, -5.0]], "none"), start, &[]);
    }
}
