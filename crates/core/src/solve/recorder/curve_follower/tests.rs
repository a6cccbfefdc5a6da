use std::f64::consts::TAU;

use super::*;

/// A curve of two registers in steps of 1 ms.
fn follower() -> CurveFollower {
    let axes = ["x", "y"].map(|name| CurveAxis { name: name.into(), unit: "V".into(), per_volt: 1.0 });
    let settings = RunSettings::from_phases([], 1e-3);
    let corners = Arc::new(TableCorners::default());
    CurveFollower::new(vec![FollowedCurve::new([0, 1], axes)], corners, &settings)
}

/// The points of the only curve.
fn points(follower: CurveFollower) -> Vec<CurvePoint> {
    follower.into_curves().remove(0).points
}

/// The place on a circle whose radius in volts changes slowly. A turn takes 1 s.
fn on_spiral(time: f64) -> [f64; 2] {
    let radius = 40.0 + 10.0 * (0.37 * time).sin();
    [radius * (TAU * time).cos(), radius * (TAU * time).sin()]
}

/// The largest distance between places on the spiral and the straight lines between points at these times.
fn largest_distance(points: &[CurvePoint], times: impl Iterator<Item = f64>) -> f64 {
    let mut after = 1;
    let distances = times.map(|time| {
        while points[after].time < time {
            after += 1;
        }
        let [from, to] = [points[after - 1], points[after]];
        let share = (time - from.time) / (to.time - from.time);
        let exact = on_spiral(time);
        let [x, y] =
            [0, 1].map(|axis| from.volts[axis] + (to.volts[axis] - from.volts[axis]) * share - exact[axis]);
        x.hypot(y)
    });
    distances.fold(0.0, f64::max)
}

#[test]
fn a_curve_of_a_million_points_has_a_bounded_number_of_points() {
    let mut follower = follower();
    let time = |index: u32| f64::from(index) * 2e-4;
    (0..=1_000_000).for_each(|index| follower.add(time(index), &on_spiral(time(index))));
    let largest_tolerance = follower.curves[0].coarseness * MAX_TOLERANCE;
    let points = points(follower);
    assert!(points.len() > MAX_POINTS / 4 && points.len() <= MAX_POINTS, "{}", points.len());
    // 200 turns with the tolerances of all thinnings, which are at most twice the last one together.
    assert!(largest_tolerance < 0.2, "{largest_tolerance}");
    let distance = largest_distance(&points, (0..=1_000_000).map(time));
    assert!(distance <= 2.0 * largest_tolerance * 2.0_f64.sqrt(), "{distance}");
}

#[test]
fn points_are_as_far_apart_as_the_bend_permits() {
    let mut follower = follower();
    let mut time = 0.0;
    while time < 20.0 {
        follower.add(time, &[time, 2.0 * time]);
        time += follower.seconds();
    }
    assert_eq!(follower.seconds(), MAX_SPACING * 1e-3);
    // With a radius of 50 V, the chord of sqrt(8 * 0.02 / 50) = 0.057 is 0.02 V from the circle along an axis.
    let begin = time;
    while time < begin + 5.0 {
        let angle = TAU * (time - begin);
        follower.add(time, &[50.0 * angle.cos(), 50.0 * angle.sin()]);
        time += follower.seconds();
    }
    let angle = TAU * follower.seconds();
    assert!(angle <= 0.07 && angle > 0.04, "{angle}");
}

#[test]
fn a_fast_motion_has_points_within_steps_and_a_restart_as_well() {
    let mut follower = follower();
    let mut time: f64 = 0.0;
    while time < 1.0 {
        let angle = TAU * 200.0 * time;
        follower.add(time, &[50.0 * angle.cos(), 50.0 * angle.sin()]);
        time += follower.seconds();
    }
    assert!(follower.is_within_step() && follower.seconds() > 0.02e-3, "{}", follower.seconds());
    while time < 2.0 {
        follower.add(time, &[0.0, 0.0]);
        time += follower.seconds();
    }
    assert!(!follower.is_within_step());
    follower.restart();
    assert!(follower.is_within_step());
}

#[test]
fn corners_of_tables_are_points() {
    let table = [[0.0, 0.0], [0.02, 1.0], [0.5, 0.0]];
    let corners = Arc::new(TableCorners::from_tables([&table[..]].into_iter()));
    let mut follower = CurveFollower { corners, ..follower() };
    let mut time = 0.0;
    let mut times = Vec::new();
    while time < 1.0 {
        follower.add(time, &[time, time]);
        time = follower.next_point(time);
        times.push(time);
    }
    assert!(times.contains(&0.02) && times.contains(&0.5), "{times:?}");
}

#[test]
fn jumps_and_repetitions_are_points() {
    let mut follower = follower();
    for (time, volts) in [(0.0, [0.0, 0.0]), (1.0, [1.0, 0.0]), (1.0, [1.0, 90.0]), (2.0, [1.0, 90.0])] {
        follower.add(time, &volts);
    }
    follower.begin_repetition();
    follower.add(0.0, &[5.0, 5.0]);
    let found: Vec<_> =
        points(follower).iter().map(|point| (point.time, point.volts, point.begins)).collect();
    let expected = [
        (0.0, [0.0, 0.0], true),
        (1.0, [1.0, 0.0], false),
        (1.0, [1.0, 90.0], false),
        (2.0, [1.0, 90.0], false),
        (0.0, [5.0, 5.0], true),
    ];
    assert_eq!(found, expected);
}

#[test]
fn a_curve_of_very_many_repetitions_keeps_their_ends() {
    let mut follower = follower();
    for repetition in 0..15_000 {
        follower.begin_repetition();
        for time in 0..5 {
            follower.add(f64::from(time), &[f64::from(time), f64::from(repetition % 7 * time % 3)]);
        }
    }
    let points = points(follower);
    assert_eq!(points.iter().filter(|point| point.begins).count(), 15_000);
    assert!(points.len() <= 5 * 15_000 && points.len() >= 2 * 15_000, "{}", points.len());
}

#[test]
fn a_small_signal_has_a_small_tolerance() {
    assert_eq!([[0.0, 4.0], [-100.0, 100.0], [3.0, 3.0]].map(tolerance), [1e-3, 0.02, 1e-6]);
}
