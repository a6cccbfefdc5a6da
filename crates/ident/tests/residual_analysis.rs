//! Coloured residuals whose source is not a missing effect: noise of a drive, interpolation of a drive, slow sensor
//! noise.
//!
//! In these cases the verdict must be inconclusive, and its reason must name the source.

use super::noise::{autoregressive, white};
use super::oscillator::measured_with;
use super::search::{outcome, search_modified};
use patchcord_ident::fit::coloured_residual::ResidualSource;
use patchcord_ident::report::sentence::verdict_sentence;
use patchcord_ident::search::Verdict;
use patchcord_ident::search::inconclusive::Inconclusive;

/// Adds noise of standard deviation `sigma` to a column.
fn add_noise(samples: &mut [f64], sigma: f64, mut noise: impl FnMut() -> f64) {
    samples.iter_mut().for_each(|sample| *sample += sigma * noise());
}

#[test]
#[ignore = "takes several seconds: a whole search"]
fn noise_of_a_drive_is_not_named_as_an_effect() {
    for (sigma, seed) in [(0.5, 1), (2.0, 2)] {
        let outcome = search_modified("nothing", |experiment| {
            let records = experiment.train.iter_mut().chain(&mut experiment.validation);
            records.zip(0..).for_each(|(record, index)| {
                add_noise(&mut record.drives[0], sigma, white(seed + 10 * index));
            });
        });
        let Some(Inconclusive::ColouredResidual(coloured)) = &outcome.inconclusive else {
            panic!("{}", verdict_sentence(&outcome))
        };
        let ResidualSource::DriveNoise(drives, propagated) = &coloured.source else { panic!("{coloured:?}") };
        assert_eq!((outcome.verdict, drives.as_slice()), (Verdict::CannotJudge, &["F".to_owned()][..]));
        // The residual is about as large as the output noise that this drive noise causes.
        assert!((0.3..2.5).contains(&(coloured.normalised_rms / propagated)), "{coloured:?}");
    }
    // A drive that is set, not measured, has sigma 0: its jumps are not noise.
    let outcome = search_modified("nothing", |experiment| experiment.drives[0].sigma = Some(0.0));
    assert_eq!(outcome.verdict, Verdict::NothingMissing);
}

/// Force in N and steady-state position in m of the oscillator (3 kg, 500 N/m, 5 N s/m) at a time in s.
///
/// The force is a sum of sines, each with a frequency in Hz and an amplitude in N. The position follows from the
/// frequency response 1 / (k - m w^2 + i c w).
fn steady_state(sines: &[(f64, f64)], time: f64) -> [f64; 2] {
    sines.iter().fold([0.0; 2], |[force, position], (frequency, amplitude)| {
        let omega = std::f64::consts::TAU * frequency;
        let (real, imaginary) = (500.0 - 3.0 * omega * omega, 5.0 * omega);
        let phase_lag = imaginary.atan2(real);
        let position_amplitude = amplitude / real.hypot(imaginary);
        [
            force + amplitude * (omega * time).sin(),
            position + position_amplitude * (omega * time - phase_lag).sin(),
        ]
    })
}

#[test]
#[ignore = "takes several seconds: a whole search"]
fn the_error_of_linear_interpolation_of_a_drive_is_not_named_as_an_effect() {
    let (interval, sigma) = (0.02, 2e-4);
    let sines = [(1.0, 10.0), (2.5, 20.0), (6.0, 60.0)];
    let samples = (0..600).map(|sample| steady_state(&sines, interval * f64::from(sample)));
    let (forces, positions): (Vec<f64>, Vec<f64>) =
        samples.map(|[force, position]| (force, position)).unzip();
    let search_with = |hold| {
        let (experiment, problem) = measured_with([interval, sigma], &forces, &positions, hold);
        outcome(&experiment, &problem, 2)
    };
    let linear = search_with("linear");
    let Some(Inconclusive::ColouredResidual(coloured)) = &linear.inconclusive else {
        panic!("{}", verdict_sentence(&linear))
    };
    // The second value is the residual with smooth interpolation, over the noise.
    let ResidualSource::Intersample(drives, smooth_residual) = &coloured.source else {
        panic!("{coloured:?}")
    };
    assert_eq!((linear.verdict, drives.as_slice()), (Verdict::CannotJudge, &["F".to_owned()][..]));
    assert!(coloured.normalised_rms > 2.0 && (0.9..1.1).contains(smooth_residual), "{coloured:?}");
    let smooth = search_with("smooth");
    assert_eq!(smooth.verdict, Verdict::NothingMissing, "{}", verdict_sentence(&smooth));
    let fitted = smooth.base.train.estimate.parameters.iter().zip([3.0, 500.0, 5.0]);
    fitted
        .for_each(|(value, truth)| assert!((value / truth - 1.0).abs() < 0.01, "{value}, expected {truth}"));
}

#[test]
#[ignore = "takes several seconds: a whole search"]
fn an_effect_is_named_despite_noise_of_a_drive() {
    let outcome = search_modified("saturation", |experiment| {
        let records = experiment.train.iter_mut().chain(&mut experiment.validation);
        records.zip(0..).for_each(|(record, index)| add_noise(&mut record.drives[0], 0.005, white(index)));
    });
    assert_eq!((outcome.verdict, outcome.effects[0].effect.as_str()), (Verdict::Named, "saturation"));
}

#[test]
#[ignore = "takes several seconds: a whole search"]
fn slow_noise_of_a_sensor_is_not_named_as_an_effect() {
    let outcome = search_modified("nothing", |experiment| {
        let records = experiment.train.iter_mut().chain(&mut experiment.validation);
        records.zip(0..).for_each(|(record, index)| {
            add_noise(&mut record.outputs[0], 1e-3, autoregressive(index, 0.95));
        });
    });
    let Some(Inconclusive::SlowSensorNoise(slow)) = &outcome.inconclusive else {
        panic!("{}", verdict_sentence(&outcome))
    };
    assert_eq!((outcome.verdict, slow.output.as_str()), (Verdict::CannotJudge, "x"));
    // With a correlation of 0.95 from sample to sample, the autocorrelation falls to 1/e after 20 samples.
    assert!((0.05..0.2).contains(&slow.correlation_time), "{slow:?}");
    assert!(outcome.localisations.is_empty());
}
