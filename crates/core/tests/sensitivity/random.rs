//! Derivatives of random circuits.

use crate::common::circuits::{PARAMETERS, circuit};
use crate::common::dice::Dice;
use crate::sensitivity::bench::Case;
use patchcord_core::solve::RunSettings;

/// Random circuits, in steps short enough for the cubics of their delay lines.
fn cases(count: usize) -> impl Iterator<Item = Case> {
    let mut dice = Dice(8);
    (0..count).map(move |_| {
        let record = ["A0", "A1", "A2"].map(str::to_owned).to_vec();
        let case = Case::new(circuit(&mut dice), &[], 3.0);
        case.with(|own| RunSettings { step: 5e-4, every: 0.0123456, record, ..own })
    })
}

#[test]
fn random_circuits() {
    for (number, case) in cases(16).enumerate() {
        println!("circuit {number}");
        case.check(&PARAMETERS, 1e-5, 0.75);
    }
}

#[test]
fn random_circuits_with_a_tolerance() {
    for (number, case) in cases(16).enumerate() {
        let exact = case.trace(&PARAMETERS);
        let found = case.with(|own| RunSettings { tolerance: Some(1e-9), ..own }).trace(&PARAMETERS);
        for (found, exact) in found.tracks.iter().zip(&exact.tracks) {
            let largest = exact.values().fold(1.0f64, |most, slope| most.max(slope.abs()));
            let pairs = found.values().zip(exact.values());
            let worst = pairs.map(|(found, exact)| (found - exact).abs()).fold(0.0, f64::max);
            assert!(worst <= 1e-5 * largest, "circuit {number}, {}: {worst} of {largest}", exact.name);
        }
    }
}
