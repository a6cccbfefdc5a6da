//! Unit tests of `delay_line`.

use super::*;

fn arrival(passes: u8, is_jump: bool) -> Option<Arrival> {
    Some(Arrival { passes, is_jump })
}

#[test]
fn a_cubic_and_its_slope_are_reproduced() {
    let cubic = |t: f64| 1.0 + t - 2.0 * t * t + 0.5 * t * t * t;
    let slope = |t: f64| 1.0 - 4.0 * t + 1.5 * t * t;
    let mut line = DelayLine::new(1.0, 0.0, 0.1);
    (0..=30).for_each(|k| line.put(f64::from(k) * 0.1, cubic(f64::from(k) * 0.1)));
    for t in [3.05, 3.51, 3.77, 3.97] {
        assert!((line.right_limit(t) - cubic(t - 1.0)).abs() < 1e-12, "{t}");
        let DelayOutput::Arrived(volts, found) = line.output(t) else { panic!("{t}") };
        assert!((volts - line.right_limit(t)).abs() < 1e-12 && (found - slope(t - 1.0)).abs() < 1e-11, "{t}");
    }
}

#[test]
fn before_the_delay_the_initial_voltage_comes_out() {
    let mut line = DelayLine::new(1.0, 7.0, 0.1);
    line.put_discontinuity(0.0, 3.0, 0);
    line.put(0.1, 3.0);
    assert_eq!((line.right_limit(0.5), line.left_limit(1.0), line.right_limit(1.0)), (7.0, 7.0, 3.0));
}

#[test]
fn a_jump_stays_a_jump() {
    let mut line = DelayLine::new(1.0, 0.0, 0.1);
    [0.0, 0.1, 0.15].iter().for_each(|time| line.put(*time, 1.0));
    line.put_discontinuity(0.15, 5.0, 0);
    [0.2, 0.3].iter().for_each(|time| line.put(*time, 5.0));
    assert_eq!((line.right_limit(1.149), line.right_limit(1.151)), (1.0, 5.0));
    assert_eq!((line.left_limit(1.15), line.right_limit(1.15)), (1.0, 5.0));
}

#[test]
fn a_corner_is_not_rounded() {
    let mut line = DelayLine::new(1.0, 0.0, 0.1);
    let corner = |k: i32| (f64::from(k) * 0.1, f64::from((k - 5).max(0)).powi(3));
    for (time, volts) in (0..=10).map(corner) {
        line.put(time, volts);
        if volts == 0.0 && time > 0.45 {
            line.put_discontinuity(time, volts, 0);
        }
    }
    assert_eq!(line.right_limit(1.45), 0.0);
    assert!((line.right_limit(1.55) - 0.125).abs() < 1e-9);
}

#[test]
fn close_samples_do_not_amplify_rounding() {
    let mut line = DelayLine::new(1.0, 0.0, 0.1);
    for k in 0..20 {
        let time = f64::from(k) * 0.1;
        line.put(time, time);
        line.put(time + 1e-14, time + 5e-14);
    }
    assert!(
        (1..10)
            .all(|k| (line.right_limit(1.05 + f64::from(k) * 0.1) - f64::from(k) * 0.1 - 0.05).abs() < 1e-11)
    );
}

#[test]
fn discontinuities_come_out_in_order_and_fade() {
    let mut line = DelayLine::new(1.0, 0.0, 0.1);
    line.put_discontinuity(0.0, 1.0, 0);
    line.put_discontinuity(0.25, 1.0, MAX_PASSES);
    line.put_discontinuity(0.5, 1.0, 3);
    assert_eq!((line.next_arrival_before(1.0), line.next_arrival_before(1.1)), (None, Some(1.0)));
    assert_eq!((line.take_arrivals(0.9), line.take_arrivals(1.0)), (None, arrival(0, true)));
    assert_eq!(line.next_arrival_before(9.0), Some(1.5));
}

#[test]
fn sequential_reads_equal_random_reads() {
    for delay in [0.1, 0.137, 0.25, 1.0] {
        let mut line = DelayLine::new(delay, 7.0, 0.1);
        line.put_discontinuity(0.0, 3.0, 0);
        for k in 1..100 {
            let time = f64::from(k) * 0.1;
            for share in [-0.9, -0.5, -0.31, 0.0] {
                let at = time + 0.1 * share;
                assert_eq!(line.next_left_limit(at).to_bits(), line.left_limit(at).to_bits(), "{delay} {at}");
                assert_eq!(
                    line.next_right_limit(at).to_bits(),
                    line.right_limit(at).to_bits(),
                    "{delay} {at}"
                );
            }
            line.put(time, (0.9 * time).sin());
            match k % 7 {
                2 => line.put_discontinuity(time, (0.9 * time).sin(), 0),
                5 => line.put(time + 3e-5, (0.9 * (time + 3e-5)).sin()),
                _ => {}
            }
        }
    }
}

#[test]
fn jumps_differ_from_corners() {
    let mut line = DelayLine::new(1.0, 0.0, 0.1);
    line.put_discontinuity(0.0, 1.0, 0);
    line.put_discontinuity(0.25, 1.0, 0);
    line.put_discontinuity(0.5, 2.0, 1);
    assert_eq!(line.next_jump(), Some(1.0));
    assert_eq!(line.take_arrivals(1.3), arrival(0, true));
    // A voltage that is the same on both sides of the instant has a corner, but no jump.
    assert_eq!((line.next_jump(), line.next_arrival_before(9.0)), (None, Some(1.5)));
    line.put(0.75, 2.0);
    line.put_discontinuity(0.75, 3.0, 1);
    assert_eq!((line.next_jump(), line.take_arrivals(1.5)), (Some(1.75), arrival(1, false)));
}

#[test]
fn discontinuities_pass_to_lines_downstream() {
    let mut lines =
        [&[][..], &[0], &[0, 1]].map(|upstream| DelayLine::new(1.0, 0.0, 0.1).with_upstream(upstream));
    let mut step_to =
        |time: f64, is_at_corner| record_inputs(&mut lines, time, [time; 3].into_iter(), is_at_corner);
    step_to(0.0, true);
    (1..=10).for_each(|k| step_to(f64::from(k) * 0.1, false));
    assert_eq!(lines.each_ref().map(|line| line.next_arrival_before(9.0)), [None, Some(2.0), Some(2.0)]);
    let mut step_to = |time: f64| record_inputs(&mut lines, time, [time; 3].into_iter(), false);
    (11..=20).for_each(|k| step_to(f64::from(k) * 0.1));
    assert_eq!(lines.each_ref().map(|line| line.next_arrival_before(9.0)), [None, None, Some(3.0)]);
}

#[test]
fn a_sample_does_not_change_earlier_outputs() {
    for delay in [0.1, 0.137, 0.25, 0.31] {
        let mut line = DelayLine::new(delay, 7.0, 0.1);
        for time in (0..40).map(|k| f64::from(k) * 0.1) {
            let before = line.next_left_limit(time);
            line.put(time, (0.9 * time).sin());
            assert_eq!(before.to_bits(), line.next_left_limit(time).to_bits(), "{delay} {time}");
            let after = line.next_right_limit(time);
            assert!(time < delay + 0.05 || (after - before).abs() < 1e-9, "{delay} {time}");
        }
    }
}
