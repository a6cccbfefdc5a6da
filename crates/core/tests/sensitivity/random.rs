//! Derivatives of random circuits.

use crate::common::circuits::{PARAMETERS, random_circuit};
use crate::common::random::SplitMix64;
use crate::sensitivity::comparison::Case;

/// Random circuits with steps that are short enough for the interpolation in their delay lines.
fn cases(count: usize) -> impl Iterator<Item = Case> {
    let mut random = SplitMix64(8);
    (0..count).map(move |_| {
        let record = ["A0", "A1", "A2"];
        let case = Case::new(random_circuit(&mut random), &[], 3.0);
        case.with(|settings| settings.with_step(5e-4).with_sample_interval(0.0123456).with_signals(record))
    })
}

#[test]
#[ignore = "takes several seconds: random circuits with many derivatives"]
fn derivatives_of_random_circuits_agree_with_differences() {
    for (number, case) in cases(8).enumerate() {
        println!("circuit {number}");
        case.check(&PARAMETERS, 1e-5, 0.75);
    }
}

#[test]
#[ignore = "takes several seconds: random circuits with many derivatives"]
fn derivatives_of_random_circuits_agree_with_equal_and_adaptive_steps() {
    for (number, case) in cases(8).enumerate() {
        let exact = case.trace(&PARAMETERS);
        let found = case.with(|settings| settings.with_tolerance(1e-9)).trace(&PARAMETERS);
        for (found, exact) in found.tracks.iter().zip(&exact.tracks) {
            let largest = exact.values().fold(1.0f64, |maximum, slope| maximum.max(slope.abs()));
            let pairs = found.values().zip(exact.values());
            let largest_difference = pairs.map(|(found, exact)| (found - exact).abs()).fold(0.0, f64::max);
            assert!(
                largest_difference <= 1e-5 * largest,
                "circuit {number}, {}: {largest_difference} of {largest}",
                exact.name
            );
        }
    }
}
