//! Bode plots have the right axes, markers and divisions.

use std::f64::consts::TAU;

use crate::common::{program, shipped};
use patchcord_analysis::linear::{FrequencyBand, TransferFunction, roots};
use patchcord_core::solve::Machine;
use patchcord_draw::bode;

fn near(found: f64, expected: f64, tolerance: f64) -> bool {
    (found - expected).abs() <= tolerance * expected.abs()
}

#[test]
fn a_plot_shows_decibels_degrees_and_natural_frequencies() {
    let program = program(&shipped("lessons/driven-oscillator"), &[]);
    let model = Machine::new(&program, 1e-5).unwrap().state_space();
    let found = TransferFunction::new(&model, "push", "x")
        .unwrap()
        .response(FrequencyBand { low: 0.1, high: 100.0 })
        .unwrap();
    let roots = roots(&model).unwrap();
    let [magnitude, phase] = bode(&found, &roots, Some("note"));
    assert_eq!(magnitude.vertical.unit, "dB (0 dB: 1 mm per N)");
    assert_eq!((phase.vertical.low, phase.vertical.high, phase.vertical.divisions), (-180.0, 0.0, 4));
    assert!(magnitude.horizontal.logarithmic && magnitude.horizontal == phase.horizontal);
    assert!(near(phase.markers[0].at, 40f64.sqrt() / TAU, 1e-12) && phase.markers[0].label == "1.007 Hz");
    assert!(near(magnitude.channels[0].points[0].1, found.points[0].decibels(), 1e-15));
    // A constant curve is drawn as a straight line in spite of rounding.
    let mut level = found.clone();
    level.points.iter_mut().enumerate().for_each(|(n, point)| point.ratio = 10.0 + 1e-15 * (n % 3) as f64);
    let [magnitude, _] = bode(&level, &roots, None);
    assert_eq!((magnitude.vertical.low, magnitude.vertical.high), (19.0, 21.0));
    // The phase of a long delay covers many turns; its divisions are whole turns.
    let mut turning = found.clone();
    turning.points.iter_mut().for_each(|point| point.phase *= 30.0);
    let [_, phase] = bode(&turning, &roots, None);
    assert!(phase.vertical.divisions <= 8 && phase.vertical.low <= -5400.0, "{:?}", phase.vertical);
}
