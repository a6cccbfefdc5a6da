//! Derivatives of random circuits.

use crate::common::circuits::{PARAMETERS, random_circuit};
use crate::common::random::SplitMix64;
use crate::sensitivity::comparison::Case;
use patchcord_core::solve::RunSettings;

/// Random circuits with steps that are short enough for the interpolation in their delay lines.
fn cases(count: usize) -> impl Iterator<Item = Case> {
    let mut random = SplitMix64(8);
    (0..count).map(move |_| {
        let record = ["A0", "A1", "A2"].map(str::to_owned).to_vec();
        let case = Case::new(random_circuit(&mut random), &[], 3.0);
        case.with(|settings| RunSettings { step: 5e-4, every: 0.0123456, record, ..settings })
    })
}

#[test]
fn derivatives_of_random_circuits_agree_with_differences() {
    for (number, case) in cases(16).enumerate() {
        println!("circuit {number}");
        case.check(&PARAMETERS, 1e-5, 0.75);
    }
}

#[test]
fn derivatives_of_random_circuits_agree_with_equal_and_adaptive_steps() {
    for (number, case) in cases(16).enumerate() {
        let exact = case.trace(&PARAMETERS);
        let found =
            case.with(|settings| RunSettings { tolerance: Some(1e-9), ..settings }).trace(&PARAMETERS);
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
