use std::f64::consts::TAU;

use super::super::{CHANNELS, TOLERANCE};
use super::*;

/// The sample of a circle with a radius of 50 V and a period of 1 s.
fn on_circle(time: f64) -> Sample {
    Sample { time, volts: [50.0 * (TAU * time).cos(), 50.0 * (TAU * time).sin()] }
}

/// The points of a curve, with its provisional end.
fn points(curve: &Curve) -> Vec<CurvePoint> {
    curve.current.points.iter().copied().chain(curve.chord.and_then(|chord| chord.open_end())).collect()
}

/// The largest distance between samples and the place of the curve at their times. Samples before the first point are
/// not compared.
fn largest_distance(points: &[CurvePoint], samples: &[Sample]) -> f64 {
    let mut largest: f64 = 0.0;
    let mut after = 1;
    for sample in samples.iter().filter(|sample| sample.time >= points[0].time) {
        while points[after].time < sample.time {
            after += 1;
        }
        let [before, after] = [points[after - 1], points[after]];
        let share = (sample.time - before.time) / (after.time - before.time);
        let difference = |axis: usize| {
            before.volts[axis] + (after.volts[axis] - before.volts[axis]) * share - sample.volts[axis]
        };
        largest = largest.max(difference(0).hypot(difference(1)));
    }
    largest
}

#[test]
fn a_circle_is_within_the_tolerance_with_few_points() {
    let samples: Vec<Sample> = (0..=300_000).map(|index| on_circle(f64::from(index) * 1e-5)).collect();
    let mut curve = Curve::new(TOLERANCE);
    samples.iter().for_each(|sample| curve.add(sample));
    let points = points(&curve);
    let distance = largest_distance(&points, &samples);
    assert!(distance <= TOLERANCE * (1.0 + 1e-9) && distance > 0.7 * TOLERANCE, "{distance}");
    // The sagitta of a chord with the angle a is 50 V · a² / 8. It is between 0.02 V/√2 and 0.02 V.
    let least = 3.0 * TAU / (8.0 * TOLERANCE / 50.0_f64).sqrt();
    let count = points.len() as f64;
    assert!(count >= least && count <= 1.2 * least + 2.0, "{count} points, at least {least}");
}

#[test]
fn a_long_curve_has_a_bounded_number_of_points() {
    let spiral = |index: u32| {
        let time = f64::from(index) * 2e-3;
        let radius = 0.8 + 0.2 * (0.37 * time).sin();
        Sample { time, volts: on_circle(time).volts.map(|volts| radius * volts) }
    };
    let samples: Vec<Sample> = (0..=500_000).map(spiral).collect();
    let mut curve = Curve::new(TOLERANCE);
    for (index, sample) in samples.iter().enumerate() {
        let was_coarse = curve.is_coarse;
        curve.add(sample);
        assert!(curve.current.points.len() < MAX_POINTS);
        if curve.is_coarse && !was_coarse {
            // The tolerance of the points that remain adds to the one that they were chosen with.
            let points = points(&curve);
            let distance = largest_distance(&points, &samples[..=index]);
            assert!(distance <= (1.0 + COARSER) * TOLERANCE, "{distance}");
            assert!(points.len() < MAX_POINTS * 6 / 10, "{} points", points.len());
        }
    }
    let points = points(&curve);
    assert!(points.len() >= MAX_POINTS / 2 && points[0].begins);
    let distance = largest_distance(&points, &samples);
    assert!(distance <= (1.0 + 1e-9) * COARSER * TOLERANCE, "{distance}");
}

#[test]
fn a_resting_beam_needs_two_points() {
    let mut curve = Curve::new(TOLERANCE);
    (0..1000).for_each(|index| {
        let volts = [5.0 + 0.001 * f64::from(index % 3), 7.0];
        curve.add(&Sample { time: f64::from(index), volts });
    });
    assert_eq!(points(&curve).len(), 2);
}

#[test]
fn a_line_at_another_speed_is_another_chord() {
    let mut curve = Curve::new(TOLERANCE);
    for (time, volts) in [(0.0, 0.0), (100.0, 0.0), (101.0, 10.0), (102.0, 20.0), (103.0, 30.0)] {
        curve.add(&Sample { time, volts: [volts; CHANNELS] });
    }
    let times: Vec<f64> = points(&curve).iter().map(|point| point.time).collect();
    assert_eq!(times, [0.0, 100.0, 103.0]);
}

#[test]
fn a_jump_is_a_line_without_time() {
    let mut curve = Curve::new(TOLERANCE);
    for (time, volts) in [(0.0, [0.0, 0.0]), (1.0, [1.0, 0.0]), (1.0, [1.0, 9.0]), (1.0, [4.0, 9.0])] {
        curve.add(&Sample { time, volts });
    }
    let found: Vec<_> = points(&curve).iter().map(|point| (point.time, point.volts, point.begins)).collect();
    assert_eq!(
        found,
        [
            (0.0, [0.0, 0.0], true),
            (1.0, [1.0, 0.0], false),
            (1.0, [1.0, 9.0], false),
            (1.0, [4.0, 9.0], false)
        ]
    );
}

#[test]
fn a_gap_begins_a_curve() {
    let mut curve = Curve::new(TOLERANCE);
    for (time, volts) in [(0.0, 0.0), (1.0, 1.0), (2.0, f64::NAN), (3.0, 3.0), (4.0, 4.0)] {
        curve.add(&Sample { time, volts: [volts, 0.0] });
    }
    let found: Vec<_> = points(&curve).iter().map(|point| (point.time, point.begins)).collect();
    assert_eq!(found, [(0.0, true), (1.0, false), (3.0, true), (4.0, false)]);
}

#[test]
fn a_cut_curve_continues_from_the_point_before() {
    let mut curve = Curve::new(TOLERANCE);
    for time in 0..=100 {
        curve.add(&on_circle(f64::from(time) / 100.0));
    }
    curve.cut(0.505);
    curve.add(&on_circle(0.505));
    let points = points(&curve);
    assert!(points.windows(2).all(|pair| pair[0].time < pair[1].time));
    assert!(points.last().is_some_and(|end| end.time == 0.505 && !end.begins));
}
