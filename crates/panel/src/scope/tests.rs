mod moved_back;

use std::f64::consts::TAU;

use proptest::prelude::*;

use super::*;
use crate::frame::{self, FrameHeader, Picture, PlanePicture, TimePicture};

/// A scope with probes at both channels.
fn scope(change: impl FnOnce(&mut ScopeControls)) -> Scope {
    let mut scope = Scope::new();
    set(&mut scope, |controls| {
        for (channel, output) in controls.channels.iter_mut().zip(["A1", "A2"]) {
            channel.output = Some(output.to_owned());
        }
        change(controls);
    });
    scope
}

/// Changes controls of a scope.
fn set(scope: &mut Scope, change: impl FnOnce(&mut ScopeControls)) {
    let mut controls = scope.controls().clone();
    change(&mut controls);
    scope.set_controls(controls).unwrap();
}

/// The next frame's picture of a scope.
fn picture(scope: &mut Scope) -> Picture {
    let mut scopes = [mem::take(scope), Scope::new()];
    let bytes = frame::encode(&FrameHeader::default(), &[], &[], &mut scopes);
    let [encoded, _] = scopes;
    *scope = encoded;
    let [first, _] = frame::decode(&bytes).unwrap().scopes;
    first
}

/// The next frame's picture of a scope that shows channels against time.
fn time_picture(scope: &mut Scope) -> TimePicture {
    match picture(scope) {
        Picture::Time(picture) => picture,
        Picture::Plane(_) => panic!("the scope shows channels against time"),
    }
}

/// The next frame's picture of a scope that shows an X-Y curve.
fn plane_picture(scope: &mut Scope) -> PlanePicture {
    match picture(scope) {
        Picture::Plane(picture) => picture,
        Picture::Time(_) => panic!("the scope shows a curve"),
    }
}

/// Adds points at equal intervals. The second channel has the opposite voltage.
fn run(scope: &mut Scope, from: f64, to: f64, intervals: u32, volts: impl Fn(f64) -> f64) {
    for index in 0..=intervals {
        let time = from + (to - from) * f64::from(index) / f64::from(intervals);
        scope.point(time, [volts(time), -volts(time)]);
    }
}

/// Checks that the first channel of a picture is a line through 0 V at time 0 with this slope in volts per second.
/// Columns may be larger by `excess` in volts.
fn assert_ramp(picture: &TimePicture, columns: usize, slope: f64, excess: f64) {
    let channel = picture.channels[0].as_ref().unwrap();
    for (index, extremes) in channel[..columns].iter().enumerate() {
        let start = picture.left + index as f64 * picture.column_seconds;
        let ends = [start, start + picture.column_seconds].map(|time| slope * time);
        let outside = [ends[0] - f64::from(extremes[0]), f64::from(extremes[1]) - ends[1]];
        assert!(outside.iter().all(|volts| (-1e-4..=excess + 1e-4).contains(volts)), "{index}: {extremes:?}");
    }
}

#[test]
fn a_sweep_fills_the_screen() {
    let mut scope = scope(|_| {});
    scope.begin_run(2.0);
    run(&mut scope, 0.0, 1.0, 777, |time| 30.0 * time);
    let half = time_picture(&mut scope);
    assert_eq!((half.left, half.column_seconds, half.reached), (0.0, 0.002, 501));
    assert_ramp(&half, 500, 30.0, 0.0);
    run(&mut scope, 1.0, 2.0, 777, |time| 30.0 * time);
    let whole = time_picture(&mut scope);
    assert_eq!((whole.generation, whole.left, whole.reached), (half.generation, 0.0, COLUMNS));
    assert_ramp(&whole, COLUMNS, 30.0, 0.0);
    let second = whole.channels[1].as_ref().unwrap();
    assert!((second[0][0] + 0.06).abs() < 1e-6 && second[0][1] == 0.0);
}

#[test]
fn a_free_channel_is_absent() {
    let mut scope = scope(|controls| controls.channels[0].output = None);
    scope.begin_run(1.0);
    scope.point(0.0, [f64::NAN, 1.0]);
    scope.point(0.001, [f64::NAN, 1.0]);
    let picture = time_picture(&mut scope);
    assert_eq!(picture.channels, [None, Some(vec![[1.0, 1.0]; picture.reached])]);
}

#[test]
fn a_longer_run_continues_on_a_new_screen() {
    let mut scope = scope(|controls| controls.seconds_per_division = 0.1);
    scope.begin_run(5.0);
    run(&mut scope, 0.0, 1.25, 1250, |time| 30.0 * time);
    let first = time_picture(&mut scope);
    assert_eq!((first.left, first.reached), (0.0, COLUMNS));
    assert_ramp(&first, COLUMNS, 30.0, 0.0);
    let second = time_picture(&mut scope);
    assert_eq!((second.generation, second.left, second.reached), (first.generation + 1, 1.0, 251));
    assert_ramp(&second, 250, 30.0, 0.0);
    // A step over many screens ends on the last one.
    scope.point(7.5, [225.0, 0.0]);
    time_picture(&mut scope);
    let last = time_picture(&mut scope);
    assert_eq!((last.left, last.reached), (7.0, 501));
    assert_ramp(&last, 500, 30.0, 0.0);
}

#[test]
fn frames_between_fast_sweeps_have_complete_traces() {
    let mut scope = scope(|_| {});
    for sweep in 1..=5 {
        scope.begin_run(1.0);
        run(&mut scope, 0.0, 1.0, 100, |time| 30.0 * time);
        scope.begin_run(1.0);
        run(&mut scope, 0.0, 0.3, 30, |time| 30.0 * time);
        let picture = time_picture(&mut scope);
        assert_eq!(picture.reached, COLUMNS, "sweep {sweep}");
        assert_ramp(&picture, COLUMNS, 30.0, 0.0);
    }
    assert_eq!(time_picture(&mut scope).reached, 301);
}

#[test]
fn a_trace_remains_until_time_moves() {
    let mut scope = scope(|_| {});
    scope.begin_run(1.0);
    run(&mut scope, 0.0, 1.0, 100, |time| 30.0 * time);
    let before = time_picture(&mut scope);
    scope.begin_run(1.0);
    for volts in [10.0, 50.0, 20.0] {
        scope.point(0.0, [volts; CHANNELS]);
    }
    assert_eq!(time_picture(&mut scope), before);
    scope.point(0.5, [20.0; CHANNELS]);
    let after = time_picture(&mut scope);
    assert_eq!(after.channels[0], Some(vec![[20.0, 20.0]; 501]));
    assert_eq!(after.generation, before.generation + 1);
}

/// The left edge and the generation of the trace of a scope that is triggered by 50 V · sin(2π t) at 25 V.
fn triggered(scope: &mut Scope, from: f64, to: f64) -> (f64, u32) {
    let intervals = ((to - from) * 1e4).round() as u32;
    run(scope, from, to, intervals, |time| 50.0 * (TAU * time).sin());
    time_picture(scope);
    let picture = time_picture(scope);
    (picture.left, picture.generation)
}

#[test]
fn a_level_triggers_where_the_sine_passes_it() {
    for (rising, first) in [(true, 1.0 / 12.0), (false, 5.0 / 12.0)] {
        let mut scope = scope(|controls| {
            controls.seconds_per_division = 0.05;
            controls.trigger = Trigger { mode: TriggerMode::Level, channel: 0, level: 25.0, rising };
        });
        scope.begin_run(3.0);
        let (left, generation) = triggered(&mut scope, 0.0, 0.9);
        // A chord of 1e-4 s is less than 3e-6 V from the sine, which rises by 272 V/s there.
        assert!((left - first).abs() < 1e-7, "{left}");
        let (left, next) = triggered(&mut scope, 0.9, 1.7);
        assert!((left - first - 1.0).abs() < 1e-7, "{left}");
        assert_eq!(next, generation + 1);
    }
}

#[test]
fn a_single_shot_waits_for_erase() {
    let mut scope = scope(|controls| {
        controls.seconds_per_division = 0.01;
        controls.trigger = Trigger { mode: TriggerMode::SingleShot, channel: 0, level: 25.0, rising: true };
    });
    scope.begin_run(9.0);
    let (left, generation) = triggered(&mut scope, 0.0, 2.5);
    assert!((left - 1.0 / 12.0).abs() < 1e-7);
    scope.erase();
    assert_eq!(time_picture(&mut scope).reached, 0);
    let (left, next) = triggered(&mut scope, 2.5, 5.5);
    assert!((left - 3.0 - 1.0 / 12.0).abs() < 1e-7);
    assert!(next > generation);
}

#[test]
fn another_time_base_shows_what_is_known() {
    let mut scope = scope(|_| {});
    scope.begin_run(4.0);
    run(&mut scope, 0.0, 4.0, 9000, |time| 10.0 * time);
    set(&mut scope, |controls| controls.seconds_per_division = 0.1);
    // A bucket of the memory may overlap two columns.
    let excess = 10.0 * 4.0 / BUCKETS as f64;
    for left in [2.0, 3.0] {
        let picture = time_picture(&mut scope);
        assert_eq!((picture.left, picture.column_seconds, picture.reached), (left, 0.001, COLUMNS));
        assert_ramp(&picture, COLUMNS, 10.0, excess);
    }
    run(&mut scope, 4.0, 4.5, 1000, |time| 10.0 * time);
    set(&mut scope, |controls| controls.seconds_per_division = 1.0);
    let picture = time_picture(&mut scope);
    assert_eq!((picture.left, picture.reached), (0.0, 451));
    assert_ramp(&picture, 450, 10.0, 2.0 * excess);
}

#[test]
fn a_triggered_trace_is_longer_with_a_longer_screen() {
    let mut scope = scope(|controls| {
        controls.seconds_per_division = 0.01;
        controls.trigger = Trigger { mode: TriggerMode::Level, channel: 0, level: 5.0, rising: true };
    });
    scope.begin_run(4.0);
    run(&mut scope, 0.0, 2.0, 2000, |time| 10.0 * time);
    let short = time_picture(&mut scope);
    assert_eq!(short.reached, COLUMNS);
    set(&mut scope, |controls| controls.seconds_per_division = 0.3);
    let long = time_picture(&mut scope);
    assert!((long.left - 0.5).abs() < 1e-12 && (500..=501).contains(&long.reached));
    assert_ramp(&long, 499, 10.0, 10.0 * 4.0 / BUCKETS as f64);
    run(&mut scope, 2.0, 4.0, 2000, |time| 10.0 * time);
    assert_eq!(time_picture(&mut scope).reached, COLUMNS);
}

#[test]
fn another_probe_begins_empty() {
    let mut scope = scope(|_| {});
    scope.begin_run(1.0);
    run(&mut scope, 0.0, 0.5, 500, |time| 30.0 * time);
    set(&mut scope, |controls| controls.channels[1].output = Some("A9".to_owned()));
    run(&mut scope, 0.5, 1.0, 500, |time| 30.0 * time);
    for seconds_per_division in [0.0, 0.2] {
        set(&mut scope, |controls| controls.seconds_per_division = seconds_per_division);
        let picture = time_picture(&mut scope);
        let columns = (0.5 / picture.column_seconds).round() as usize;
        assert_ramp(&picture, columns * 2, 30.0, 30.0 / BUCKETS as f64);
        let second = picture.channels[1].as_ref().unwrap();
        assert!(second[..columns].iter().flatten().all(|volts| volts.is_nan()));
        assert!(second[columns..2 * columns].iter().flatten().all(|volts| (-30.01..=-14.9).contains(volts)));
    }
}

#[test]
fn erase_continues_a_run_from_the_beam() {
    let mut scope = scope(|_| {});
    scope.begin_run(1.0);
    run(&mut scope, 0.0, 0.4, 400, |time| 30.0 * time);
    let before = time_picture(&mut scope);
    scope.erase();
    scope.point(0.6, [18.0; CHANNELS]);
    let after = time_picture(&mut scope);
    assert_eq!((after.generation, after.left, after.reached), (before.generation + 1, 0.0, 601));
    let channel = after.channels[0].as_ref().unwrap();
    assert!(channel[..400].iter().flatten().all(|volts| volts.is_nan()));
    assert!(channel[401..].iter().flatten().all(|volts| !volts.is_nan()));
}

#[test]
fn refused_controls_have_no_effect() {
    let mut scope = scope(|_| {});
    let controls = scope.controls().clone();
    let wrong = ScopeControls { seconds_per_division: f64::NAN, store: true, ..controls.clone() };
    assert!(scope.set_controls(wrong).is_err());
    assert_eq!(scope.controls(), &controls);
}

#[test]
fn resolution_follows_the_screen() {
    let mut scope = scope(|_| {});
    scope.begin_run(4.0);
    assert_eq!((scope.resolution(), scope.needs_curve()), (0.002, false));
    set(&mut scope, |controls| controls.seconds_per_division = 0.1);
    assert_eq!(scope.resolution(), 0.0005);
    set(&mut scope, |controls| controls.display = Display::Plane);
    assert_eq!((scope.resolution(), scope.needs_curve()), (0.002, true));
}

/// Adds the points of a frame to those of a client.
fn take(points: &mut Vec<[f32; 3]>, picture: &PlanePicture) {
    assert!(picture.first <= points.len());
    points.truncate(picture.first);
    points.extend(&picture.points);
}

#[test]
fn a_client_gets_a_curve_in_parts() {
    let mut scope = scope(|controls| controls.display = Display::Plane);
    scope.begin_run(1.0);
    let mut points = Vec::new();
    for index in 0..=10_000 {
        let angle = TAU * f64::from(index) * 1e-4;
        scope.point(f64::from(index) * 1e-4, [50.0 * angle.cos(), 50.0 * angle.sin()]);
        if index % 777 == 0 {
            take(&mut points, &plane_picture(&mut scope));
        }
    }
    take(&mut points, &plane_picture(&mut scope));
    assert!(points.len() < 135, "{} points", points.len());
    assert_eq!(points[0], [50.0, 0.0, -1.0]);
    let seconds: f32 = points[1..].iter().map(|point| point[2]).sum();
    assert!((seconds - 1.0).abs() < 1e-5, "{seconds}");
    assert!(points.iter().all(|[x, y, _]| (x.hypot(*y) - 50.0).abs() < 1e-4));
    assert_eq!(plane_picture(&mut scope).points.len(), 1, "the provisional end is sent again");
}

#[test]
fn a_new_run_begins_a_curve_and_completes_the_one_before() {
    let mut scope = scope(|controls| controls.display = Display::Plane);
    for _ in 0..2 {
        scope.begin_run(1.0);
        scope.point(0.0, [0.0, 0.0]);
        scope.point(1.0, [10.0, 0.0]);
    }
    let first = plane_picture(&mut scope);
    assert_eq!((first.first, first.points), (0, vec![[0.0, 0.0, -1.0], [10.0, 0.0, 1.0]]));
    scope.point(1.0, [10.0, 5.0]);
    let second = plane_picture(&mut scope);
    assert_eq!(second.generation, first.generation + 1);
    assert_eq!(second.points, [[0.0, 0.0, -1.0], [10.0, 0.0, 1.0], [10.0, 5.0, 0.0]]);
}

#[test]
fn another_display_has_another_generation() {
    let mut scope = scope(|_| {});
    scope.begin_run(1.0);
    run(&mut scope, 0.0, 1.0, 10, |time| 30.0 * time);
    let before = time_picture(&mut scope);
    set(&mut scope, |controls| controls.display = Display::Plane);
    let plane = plane_picture(&mut scope);
    assert!(plane.generation > before.generation);
    assert_eq!((plane.first, plane.points.len()), (0, 2));
    set(&mut scope, |controls| controls.display = Display::Time);
    let after = time_picture(&mut scope);
    assert!(after.generation > plane.generation);
    assert_eq!(after.channels, before.channels);
}

#[test]
fn a_curve_needs_both_channels() {
    let mut scope = scope(|controls| {
        controls.display = Display::Plane;
        controls.channels[1].output = None;
    });
    scope.begin_run(1.0);
    run(&mut scope, 0.0, 1.0, 10, |time| 30.0 * time);
    let picture = plane_picture(&mut scope);
    assert_eq!((picture.first, picture.points.len()), (0, 0));
}

#[test]
fn a_sweep_that_is_too_short_for_buckets_is_not_used() {
    for sweep in [0.0, -1.0, 5e-324, 1e-320, f64::INFINITY, f64::NAN] {
        let mut scope = scope(|_| {});
        scope.begin_run(2.0);
        scope.begin_run(sweep);
        run(&mut scope, 0.0, 1.0, 10, |time| 30.0 * time);
        let picture = time_picture(&mut scope);
        assert_eq!((picture.column_seconds, picture.reached), (0.002, 501), "{sweep}");
    }
}

proptest! {
    #[test]
    fn neighbouring_columns_overlap(steps in prop::collection::vec((0.0..0.02f64, -100.0..100.0f64), 1..40)) {
        let mut scope = scope(|_| {});
        scope.begin_run(1.0);
        scope.point(0.0, [0.0; CHANNELS]);
        let mut time = 0.0;
        for (seconds, volts) in steps {
            // A short step is a jump.
            time += if seconds < 0.005 { 0.0 } else { seconds };
            scope.point(time, [volts; CHANNELS]);
        }
        let picture = time_picture(&mut scope);
        for channel in picture.channels.iter().flatten() {
            for pair in channel.windows(2) {
                prop_assert!(pair[1][0] <= pair[0][1] && pair[0][0] <= pair[1][1], "{pair:?}");
            }
        }
    }
}
