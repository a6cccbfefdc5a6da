//! Pictures have the axes, channels and marks that the patch and the trace call for.

use super::*;
use patchcord_core::chords::CurvePoint;
use patchcord_core::document::{Placed, Span};
use patchcord_core::trace::{CurveAxis, NewValue, PhaseEnd, Repetition, SignalCurve, Track};

fn spec(x: &str, y: &[&str]) -> PictureSpec {
    let placed = |name: &str| Placed { value: name.to_owned(), span: Span::default() };
    let y = y.iter().map(|name| placed(name)).collect();
    PictureSpec { title: String::new(), x: placed(x), y, equal_scales: true }
}

fn trace() -> Trace {
    let track = |name: &str, unit: &str| Track {
        name: name.into(),
        unit: unit.into(),
        per_volt: 1e-3,
        volts: vec![0.0, 2.0, 1.0, 0.0, 2.0, 1.0],
        extremes: Vec::new(),
        derivative: None,
    };
    Trace {
        time: vec![0.0, 1.0, 2.0, 0.0, 1.0, 2.0],
        tracks: vec![track("v", "m/s"), track("w", "m/s"), track("F", "N"), track("p", "Pa")],
        repetitions: vec![Repetition::default(), Repetition { first: 3, ..Repetition::default() }],
        ..Trace::default()
    }
}

#[test]
fn values_are_shown_in_a_prefixed_unit() {
    let picture = picture(&trace(), &spec("t", &["v", "w"]), None, &[]).unwrap();
    assert_eq!((picture.vertical.unit.as_str(), picture.vertical.label.as_str()), ("mm/s", "v, w"));
    assert_eq!(picture.channels[1].points[1], (1.0, 2.0));
    assert!(picture.vertical_right.is_none());
}

#[test]
fn a_second_unit_uses_the_right_axis() {
    let picture = picture(&trace(), &spec("v", &["w", "F"]), None, &[]).unwrap();
    assert_eq!(picture.vertical_right.unwrap().unit, "mN");
    assert_eq!(picture.channels.iter().map(|channel| channel.right).collect::<Vec<_>>(), [false, true]);
}

#[test]
fn signals_in_one_unit_have_equal_scales_unless_the_patch_says_otherwise() {
    let equal = picture(&trace(), &spec("v", &["w", "F"]), None, &[]).unwrap();
    let size = |axis: &Axis| (axis.high - axis.low) / axis.divisions as f64;
    assert!(equal.equal_scales && equal.horizontal.unit == equal.vertical.unit);
    assert_eq!(size(&equal.horizontal), size(&equal.vertical));
    let own = PictureSpec { equal_scales: false, ..spec("v", &["w"]) };
    for spec in [own, spec("t", &["v"]), spec("v", &["F"])] {
        assert!(!picture(&trace(), &spec, None, &[]).unwrap().equal_scales);
    }
}

#[test]
fn curves_against_a_signal_have_the_times_of_their_points() {
    let times = |x: &str| picture(&trace(), &spec(x, &["w"]), None, &[]).unwrap().channels[0].times.to_vec();
    assert_eq!(times("v"), trace().time);
    assert!(times("t").is_empty(), "x is the time");
}

fn fault(signal: &str, repetition: usize, time: f64) -> SignalFault {
    SignalFault { signal: signal.to_owned(), repetition, time, cause: format!("{signal} over 100 V") }
}

/// The beginnings and the ends of the wrong ranges of a channel.
fn wrong_points(channel: &Channel) -> Vec<(usize, usize)> {
    channel.wrong.iter().map(|range| (range.start, range.end)).collect()
}

#[test]
fn curves_are_wrong_from_the_time_of_a_fault() {
    let faults = [fault("v", 1, 0.5), fault("v", 0, 1.5), fault("F", 0, 2.0)];
    let shown = picture(&trace(), &spec("t", &["v", "w", "F"]), None, &faults).unwrap();
    let wrong: Vec<_> = shown.channels.iter().map(wrong_points).collect();
    assert_eq!(wrong, [vec![(4, 6), (2, 3)], vec![], vec![(2, 3)]]);
    assert_eq!((shown.spans, shown.markers[0].at), (vec![[0.5, 2.0]], 0.5));
    assert_eq!(shown.markers[0].label, "v over 100 V from 0.5 s");
    let warning = "v over 100 V from 0.5 s of run 2, and 2 more: curves are wrong where they are pale";
    assert_eq!(shown.warning.as_deref(), Some(warning));
}

#[test]
fn a_picture_against_a_wrong_signal_is_wrong() {
    let shown = picture(&trace(), &spec("v", &["w"]), None, &[fault("v", 0, 1.0)]).unwrap();
    assert_eq!(wrong_points(&shown.channels[0]), [(1, 3)]);
    assert!(shown.markers.is_empty() && shown.spans.is_empty());
    assert!(shown.warning.unwrap().starts_with("v over 100 V from 1 s of run 1: "));
    let clean = picture(&trace(), &spec("t", &["w"]), None, &[fault("v", 0, 1.0)]).unwrap();
    assert!(clean.warning.is_none() && clean.channels[0].wrong.is_empty());
}

#[test]
fn every_repetition_begins_a_new_line() {
    let picture = picture(&trace(), &spec("t", &["v"]), None, &[]).unwrap();
    assert_eq!(picture.channels[0].breaks, [0, 3]);
}

fn phase(phase: PhaseKind, repetition: usize, begin: f64) -> PhaseRecord {
    let (end, sample, ended) = (begin, 3 * repetition, PhaseEnd::Time);
    PhaseRecord { phase, repetition, begin, end, problem_time: begin, sample, ended }
}

#[test]
fn phases_within_a_run_are_marked_where_they_begin() {
    let operate = || PhaseKind::Operate { until: None };
    let set = |before: f64, value: f64| {
        PhaseKind::Set(vec![NewValue { parameter: "k".into(), value, before, unit: "N/m".into() }])
    };
    let mut trace = trace();
    trace.repetitions.iter_mut().for_each(|repetition| repetition.end = 2.0);
    for (repetition, first) in [(0, 1.0), (1, 3.0)] {
        trace.phase_records.extend([
            phase(PhaseKind::InitialCondition, repetition, 0.0),
            phase(operate(), repetition, 0.0),
            phase(PhaseKind::Hold, repetition, 0.5),
            phase(set(first, first + 1.0), repetition, 1.0),
            phase(operate(), repetition, 1.0),
            phase(set(first + 1.0, 3.0), repetition, 2.0),
        ]);
    }
    let against_time = picture(&trace, &spec("t", &["v", "w"]), None, &[]).unwrap();
    let markers: Vec<_> =
        against_time.markers.iter().map(|marker| (marker.at, marker.label.as_str())).collect();
    assert_eq!(markers, [(0.5, "hold"), (1.0, "k = 2 N/m, operate"), (1.0, "k = 4 N/m, operate")]);
    let labels = [(2, "k = 1, then 2 N/m".to_owned()), (5, "k = 3, then 4 N/m".to_owned())];
    assert_eq!(
        (&against_time.channels[0].labels[..], against_time.channels[1].labels.len()),
        (&labels[..], 0)
    );
    assert!(picture(&trace, &spec("v", &["w"]), None, &[]).unwrap().markers.is_empty());
}

#[test]
fn invalid_pictures_are_rejected() {
    assert!(matches!(picture(&trace(), &spec("t", &["x"]), None, &[]), Err(ScopeError::NotRecorded { .. })));
    let three = spec("t", &["v", "F", "p"]);
    assert!(matches!(picture(&trace(), &three, None, &[]), Err(ScopeError::TooManyUnits { .. })));
}

/// A curve with these times and volts. A curve begins at each time 0.
fn curve(x: &str, y: &str, points: &[(f64, [f64; 2])]) -> SignalCurve {
    let axis = |name: &str| CurveAxis { name: name.into(), unit: "m/s".into(), per_volt: 1e-3 };
    let point = |(time, volts)| CurvePoint { time, volts, begins: time == 0.0 };
    SignalCurve { axes: [axis(x), axis(y)], points: points.iter().copied().map(point).collect() }
}

#[test]
fn a_picture_against_a_signal_shows_the_curves_that_the_run_followed() {
    let with_curves = Trace {
        curves: vec![
            curve("v", "w", &[(0.0, [0.0, 9.0]), (0.5, [4.0, 3.0]), (2.0, [1.0, 2.0]), (0.0, [5.0, 6.0])]),
            curve("v", "F", &[(0.0, [0.0, 1.0]), (0.0, [7.0, 2.0]), (1.5, [8.0, 3.0])]),
        ],
        ..trace()
    };
    let one = picture(&with_curves, &spec("v", &["w"]), None, &[fault("w", 0, 0.5)]).unwrap();
    let points = [(0.0, 9.0), (4.0, 3.0), (1.0, 2.0), (5.0, 6.0)];
    let is_near =
        |found: (f64, f64), wanted: (f64, f64)| (found.0 - wanted.0).hypot(found.1 - wanted.1) < 1e-12;
    assert!(one.channels[0].points.iter().zip(points).all(|(found, wanted)| is_near(*found, wanted)));
    assert_eq!((&one.channels[0].breaks[..], wrong_points(&one.channels[0])), (&[0, 3][..], vec![(1, 3)]));
    assert!(one.vertical.high >= 9.0 && one.equal_scales);
    let two = picture(&with_curves, &spec("v", &["w", "F"]), None, &[]).unwrap();
    let shown = two.channels.iter().map(|channel| (channel.points.len(), channel.breaks.clone()));
    assert_eq!(shown.collect::<Vec<_>>(), [(4, vec![0, 3]), (3, vec![0, 1])]);
    assert!(is_near(two.channels[1].points[2], (8.0, 3.0)));
    // The curve of p was not followed.
    let samples = picture(&with_curves, &spec("v", &["w", "p"]), None, &[]).unwrap();
    assert_eq!(samples.channels[0].points.len(), 6);
}
