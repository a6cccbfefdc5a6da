//! Derivatives of all shipped patches and test patches by all of their parameters, compared with differences.

use std::path::PathBuf;

use crate::common::files::{representative_files, shipped_files, test_patch_files};
use crate::common::{circuit, patch_of};
use crate::sensitivity::comparison::Case;
use patchcord_core::patch::Parameter;
use patchcord_core::solve::RunSettings;

/// Longest run of a patch, in steps of the patch.
const MAX_STEPS: f64 = 400.0;
/// Factor of the patch's step. Noise in delay lines gives pieces of few samples, which need shorter steps.
const STEP_FACTOR: f64 = 0.5;

/// Whether a parameter can be varied in both directions.
fn is_inside(parameter: &Parameter, value: f64) -> bool {
    value != 0.0 && parameter.range.is_none_or(|(low, high)| low < value && value < high)
}

#[test]
fn derivatives_of_representative_patches_agree_with_differences() {
    assert!(parameters_checked(representative_files()) > 20);
}

#[test]
#[ignore = "takes twenty seconds"]
fn derivatives_of_every_patch_agree_with_differences() {
    assert!(parameters_checked([shipped_files(), test_patch_files()].concat()) > 100);
}

/// Checks the derivatives by every parameter and returns the number of parameters.
fn parameters_checked(files: Vec<PathBuf>) -> usize {
    let mut parameters = 0;
    for file in files {
        let patch = patch_of(&file);
        let circuit = circuit(&patch, &[]);
        let settings = RunSettings::of(&circuit).unwrap();
        let names = circuit.parameters().filter(|(_, parameter, value)| is_inside(parameter, *value));
        for (name, ..) in names {
            println!("{} by {name}", file.display());
            let case = Case::new(patch.clone(), &[], settings.duration().min(MAX_STEPS * settings.step));
            let step = STEP_FACTOR * settings.step;
            case.with(|settings| settings.with_step(step)).check(&[name], 1e-5, 0.9);
            parameters += 1;
        }
    }
    parameters
}
