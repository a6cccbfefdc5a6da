use std::f64::consts::{FRAC_PI_2, TAU};

use super::*;

/// A sample with a free second channel.
fn sample(time: f64, volts: f64) -> Sample {
    Sample { time, volts: [volts, f64::NAN] }
}

/// Adds lines through a function of time at equal intervals.
fn draw(envelope: &mut Envelope, intervals: usize, seconds: f64, volts: impl Fn(f64) -> f64) {
    let samples = (0..=intervals).map(|index| {
        let time = seconds * index as f64 / intervals as f64;
        sample(time, volts(time))
    });
    let samples: Vec<Sample> = samples.collect();
    for pair in samples.windows(2) {
        envelope.grow_to(pair[1].time);
        envelope.add_line(&pair[0], &pair[1]);
    }
}

/// Checks the extremes of every bucket of the first channel.
fn assert_extremes(envelope: &Envelope, expected: impl Fn(f64, f64) -> Extremes, tolerance: f64) {
    for (index, extremes) in envelope.extremes(0).iter().enumerate() {
        let start = envelope.left() + index as f64 * envelope.width();
        let right = expected(start, start + envelope.width());
        for (value, right) in extremes.iter().zip(right) {
            assert!((value - right).abs() <= tolerance, "bucket {index}: {extremes:?}, {right}");
        }
    }
}

#[test]
fn one_line_reaches_every_bucket() {
    let mut envelope = Envelope::new(10, 0.0, 1.0);
    envelope.add_line(&sample(-5.0, -50.0), &sample(20.0, 200.0));
    assert_eq!(envelope.reached(), 10);
    assert_extremes(&envelope, |start, end| [10.0 * start, 10.0 * end], 1e-12);
    assert!(envelope.extremes(1).iter().all(|extremes| *extremes == EMPTY));
}

#[test]
fn lines_outside_have_no_effect() {
    let mut envelope = Envelope::new(10, 0.0, 1.0);
    envelope.add_line(&sample(-2.0, 1.0), &sample(-1.0, 2.0));
    envelope.add_line(&sample(11.0, 1.0), &sample(12.0, 2.0));
    assert_eq!(envelope.reached(), 0);
    assert!(!envelope.is_past(10.0) && envelope.is_past(10.01));
}

#[test]
fn extremes_of_a_sine_are_those_of_each_bucket() {
    let mut envelope = Envelope::new(1000, 0.0, 1e-3);
    let speed = 3.0 * TAU;
    draw(&mut envelope, 20_000, 1.0, |time| 80.0 * (speed * time).sin());
    assert_eq!(envelope.reached(), 1000);
    // A maximum is in the interval if a whole number of periods after a quarter is.
    let has_peak = |start: f64, end: f64, quarter: f64| {
        let [first, last] = [start, end].map(|time| ((speed * time - quarter) / TAU).floor());
        first != last
    };
    let expected = |start: f64, end: f64| {
        let ends = [start, end].map(|time| 80.0 * (speed * time).sin());
        let low = if has_peak(start, end, -FRAC_PI_2) { -80.0 } else { ends[0].min(ends[1]) };
        let high = if has_peak(start, end, FRAC_PI_2) { 80.0 } else { ends[0].max(ends[1]) };
        [low, high]
    };
    // A chord of 1/20000 s is at most 80 V · (3 · 2π/s)² · (1/20000 s)² / 8 from the sine.
    assert_extremes(&envelope, expected, 9e-6);
}

#[test]
fn a_spike_narrower_than_a_bucket_is_visible() {
    let mut envelope = Envelope::new(10, 0.0, 1.0);
    let corners = [(0.0, 0.0), (4.5, 0.0), (4.5001, 70.0), (4.5002, 0.0), (10.0, 0.0)];
    for pair in corners.map(|(time, volts)| sample(time, volts)).windows(2) {
        envelope.add_line(&pair[0], &pair[1]);
    }
    let highs: Vec<f64> = envelope.extremes(0).iter().map(|extremes| extremes[1]).collect();
    assert_eq!(highs, [0.0, 0.0, 0.0, 0.0, 70.0, 0.0, 0.0, 0.0, 0.0, 0.0]);
}

#[test]
fn a_jump_is_closed() {
    let mut envelope = Envelope::new(4, 0.0, 1.0);
    for pair in [(0.0, 1.0), (2.5, 1.0), (2.5, -9.0), (4.0, -9.0)].map(|(t, v)| sample(t, v)).windows(2) {
        envelope.add_line(&pair[0], &pair[1]);
    }
    assert_eq!(envelope.extremes(0), [[1.0, 1.0], [1.0, 1.0], [-9.0, 1.0], [-9.0, -9.0]]);
}

#[test]
fn buckets_that_doubled_have_the_extremes_of_longer_ones() {
    let volts = |time: f64| 60.0 * (0.7 * time).sin() + 7.0 * (11.0 * time).cos();
    let mut grown = Envelope::new(8, 0.0, 1.0);
    draw(&mut grown, 5000, 50.0, volts);
    let mut long = Envelope::new(8, 0.0, 8.0);
    draw(&mut long, 5000, 50.0, volts);
    assert_eq!((grown.width(), grown.reached()), (8.0, 7));
    let expected = |start: f64, _: f64| long.extremes(0)[(start / 8.0) as usize];
    assert_extremes(&grown, expected, 1e-9);
}

#[test]
fn a_cut_removes_later_buckets() {
    let mut envelope = Envelope::new(10, 0.0, 1.0);
    envelope.add_line(&sample(0.0, 0.0), &sample(10.0, 100.0));
    envelope.cut(3.5);
    assert_eq!(envelope.reached(), 4);
    envelope.add_line(&sample(9.0, 0.0), &sample(9.5, 0.0));
    assert_eq!(envelope.extremes(0)[4..9], [EMPTY; 5]);
}

#[test]
fn an_envelope_is_drawn_from_a_finer_one() {
    let mut fine = Envelope::new(1024, 0.0, 1.0 / 128.0);
    draw(&mut fine, 700, 7.0, |time| 10.0 * time);
    let mut coarse = Envelope::new(10, 2.0, 0.5);
    coarse.add_envelope(&fine, 4.5);
    assert_eq!(coarse.reached(), 6);
    assert_eq!(coarse.extremes(0)[5], EMPTY);
    for (index, extremes) in coarse.extremes(0)[..5].iter().enumerate() {
        let low = 20.0 + 5.0 * index as f64;
        assert!((extremes[0] - low).abs() < 1e-9 && (extremes[1] - low - 5.0).abs() < 1e-9, "{extremes:?}");
    }
}

#[test]
fn an_envelope_is_drawn_from_a_coarser_one() {
    let mut coarse = Envelope::new(4, 0.0, 1.0);
    coarse.add_line(&sample(0.0, 0.0), &sample(4.0, 4.0));
    let mut fine = Envelope::new(4, 1.0, 0.5);
    fine.add_envelope(&coarse, 2.25);
    assert_eq!(fine.extremes(0), [[1.0, 2.0], [1.0, 2.0], [2.0, 3.0]]);
}
