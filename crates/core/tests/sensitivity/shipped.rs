//! Derivatives of all shipped patches, and those of the tests, by all of their parameters, against differences.

use std::path::PathBuf;

use crate::common::files::{of_tests, representative, shipped};
use crate::common::{circuit, patch_of};
use crate::sensitivity::bench::Case;
use patchcord_core::patch::Parameter;
use patchcord_core::solve::RunSettings;

/// So many of its own steps of each.
const STEPS: f64 = 400.0;
/// They are halved: noise leaves delay lines with pieces of few samples.
const FINER: f64 = 0.5;

/// Whether runs on both sides of a parameter can be made.
fn is_inside(parameter: &Parameter, value: f64) -> bool {
    value != 0.0 && parameter.range.is_none_or(|(low, high)| low < value && value < high)
}

#[test]
fn every_parameter_of_representative_patches() {
    assert!(parameters_checked(representative()) > 20);
}

#[test]
#[ignore = "takes twenty seconds"]
fn every_parameter_of_every_patch() {
    assert!(parameters_checked([shipped(), of_tests()].concat()) > 100);
}

fn parameters_checked(files: Vec<PathBuf>) -> usize {
    let mut parameters = 0;
    for file in files {
        let patch = patch_of(&file);
        let circuit = circuit(&patch, &[]);
        let own = RunSettings::of(&circuit).unwrap();
        let names = circuit.parameters().filter(|(_, parameter, value)| is_inside(parameter, *value));
        for (name, ..) in names {
            println!("{} by {name}", file.display());
            let case = Case::new(patch.clone(), &[], own.duration().min(STEPS * own.step));
            case.with(|own| RunSettings { step: FINER * own.step, ..own }).check(&[name], 1e-5, 0.9);
            parameters += 1;
        }
    }
    parameters
}
