//! Scopes of a machine that is moved to another time of its run.

use super::*;

#[test]
fn an_earlier_time_replaces_what_was_after_it() {
    let mut scope = scope(|_| {});
    scope.begin_run(1.0);
    run(&mut scope, 0.0, 0.8, 800, |time| 30.0 * time);
    let before = time_picture(&mut scope);
    run(&mut scope, 0.4, 0.6, 200, |_| 12.0);
    let after = time_picture(&mut scope);
    assert_eq!((after.generation, after.reached), (before.generation, 601));
    assert_ramp(&after, 400, 30.0, 0.0);
    let channel = after.channels[0].as_ref().unwrap();
    assert!(channel[402..].iter().all(|extremes| *extremes == [12.0, 12.0]));
}

#[test]
fn a_machine_that_is_moved_back_leaves_the_trace_until_its_run_continues() {
    let mut scope = scope(|_| {});
    scope.begin_run(1.0);
    run(&mut scope, 0.0, 0.8, 800, |time| 30.0 * time);
    let before = time_picture(&mut scope);
    for time in [0.4, 0.0, 0.8] {
        scope.show(time);
        assert_eq!(time_picture(&mut scope), before, "{time} s");
    }
    scope.show(0.4);
    scope.point(0.4, [12.0; CHANNELS]);
    let after = time_picture(&mut scope);
    assert_eq!((after.generation, after.reached), (before.generation, 401));
    assert_ramp(&after, 400, 30.0, 0.0);
}

#[test]
fn a_machine_that_is_moved_to_another_screen_shows_this_screen() {
    let mut scope = scope(|controls| controls.seconds_per_division = 0.1);
    scope.begin_run(4.0);
    run(&mut scope, 0.0, 2.5, 10_000, |time| 10.0 * time);
    // The screen before the last one comes first.
    assert_eq!(time_picture(&mut scope).left, 1.0);
    let last = time_picture(&mut scope);
    assert_eq!((last.left, last.reached), (2.0, 501));
    // A bucket of the memory may overlap two columns.
    let excess = 2.0 * 10.0 * 4.0 / BUCKETS as f64;
    scope.show(0.7);
    let first = time_picture(&mut scope);
    assert_eq!((first.left, first.reached), (0.0, COLUMNS));
    assert_ramp(&first, COLUMNS, 10.0, excess);
    scope.show(0.2);
    assert_eq!(time_picture(&mut scope), first);
    scope.show(2.5);
    let again = time_picture(&mut scope);
    assert_eq!((again.left, again.reached), (2.0, 501));
    assert_ramp(&again, 500, 10.0, excess);
    // Another time base also shows the screen with this time.
    scope.show(0.7);
    set(&mut scope, |controls| controls.seconds_per_division = 0.05);
    let short = time_picture(&mut scope);
    assert_eq!((short.left, short.reached), (0.5, COLUMNS));
    assert_ramp(&short, COLUMNS, 10.0, excess);
    // The run continues on the screen that is shown.
    scope.point(0.7, [7.0; CHANNELS]);
    scope.point(0.75, [7.0; CHANNELS]);
    let after = time_picture(&mut scope);
    assert_eq!((after.generation, after.left, after.reached), (short.generation, 0.5, 501));
    let channel = after.channels[0].as_ref().unwrap();
    assert!(channel[402..].iter().all(|extremes| *extremes == [7.0, 7.0]));
}
