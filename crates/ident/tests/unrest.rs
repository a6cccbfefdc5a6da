//! Noise that is none of a missing effect: of a drive, and slow noise of a sensor.

use super::noise::{slow, white};
use super::oscillator::taken;
use super::search::{outcome, spoilt};
use patchcord_ident::fit::coloured_residual::Cause;
use patchcord_ident::report::sentence::verdict_sentence;
use patchcord_ident::search::Verdict;
use patchcord_ident::search::inconclusive::Blind;

/// A column with so much noise.
fn noisy(samples: &mut [f64], size: f64, mut noise: impl FnMut() -> f64) {
    samples.iter_mut().for_each(|sample| *sample += size * noise());
}

#[test]
#[ignore = "takes several seconds: a whole search"]
fn noise_of_a_drive_is_no_effect() {
    for (sigma, seed) in [(0.5, 1), (2.0, 2)] {
        let found = spoilt("nothing", |experiment| {
            let records = experiment.train.iter_mut().chain(&mut experiment.test);
            records.zip(0..).for_each(|(record, place)| {
                noisy(&mut record.drives[0], sigma, white(seed + 10 * place));
            });
        });
        let Some(Blind::NotWhite(own)) = &found.blind else { panic!("{}", verdict_sentence(&found)) };
        let Cause::Drives(drives, brought) = &own.cause else { panic!("{own:?}") };
        assert_eq!((found.verdict, drives.as_slice()), (Verdict::CannotJudge, &["F".to_owned()][..]));
        assert!((0.3..2.5).contains(&(own.left / brought)), "{own:?}");
    }
    // A drive that is set and not measured has none, however it jumps.
    let found = spoilt("nothing", |experiment| experiment.drives[0].sigma = Some(0.0));
    assert_eq!(found.verdict, Verdict::NothingMissing);
}

/// What sines of these frequencies in Hz and amplitudes in N do to the mass of 3 kg on its spring and damper, by its frequency response.
fn swings(sines: &[(f64, f64)], time: f64) -> [f64; 2] {
    sines.iter().fold([0.0; 2], |[force, place], (frequency, amplitude)| {
        let turns = std::f64::consts::TAU * frequency;
        let (stiff, damped) = (500.0 - 3.0 * turns * turns, 5.0 * turns);
        let late = damped.atan2(stiff);
        let swing = amplitude / stiff.hypot(damped);
        [force + amplitude * (turns * time).sin(), place + swing * (turns * time - late).sin()]
    })
}

#[test]
#[ignore = "takes several seconds: a whole search"]
fn what_straight_lines_between_the_samples_of_a_drive_bring_is_no_effect() {
    let (interval, sigma) = (0.02, 2e-4);
    let all =
        (0..600).map(|sample| swings(&[(1.0, 10.0), (2.5, 20.0), (6.0, 60.0)], interval * f64::from(sample)));
    let (forces, stood): (Vec<f64>, Vec<f64>) = all.map(|[force, place]| (force, place)).unzip();
    let found = |hold| {
        let (experiment, problem) = taken([interval, sigma], &forces, &stood, hold);
        outcome(&experiment, &problem, 2)
    };
    let straight = found("linear");
    let Some(Blind::NotWhite(own)) = &straight.blind else { panic!("{}", verdict_sentence(&straight)) };
    let Cause::Between(drives, smooth) = &own.cause else { panic!("{own:?}") };
    assert_eq!((straight.verdict, drives.as_slice()), (Verdict::CannotJudge, &["F".to_owned()][..]));
    assert!(own.left > 2.0 && (0.9..1.1).contains(smooth), "{own:?}");
    let smooth = found("smooth");
    assert_eq!(smooth.verdict, Verdict::NothingMissing, "{}", verdict_sentence(&smooth));
    let knobs = smooth.base.train.point.knobs.iter().zip([3.0, 500.0, 5.0]);
    knobs.for_each(|(found, hidden)| assert!((found / hidden - 1.0).abs() < 0.01, "{found} {hidden}"));
}

#[test]
#[ignore = "takes several seconds: a whole search"]
fn an_effect_shows_beside_noise_of_a_drive() {
    let found = spoilt("saturation", |experiment| {
        let records = experiment.train.iter_mut().chain(&mut experiment.test);
        records.zip(0..).for_each(|(record, place)| noisy(&mut record.drives[0], 0.005, white(place)));
    });
    assert_eq!((found.verdict, found.effects[0].effect.as_str()), (Verdict::Named, "saturation"));
}

#[test]
#[ignore = "takes several seconds: a whole search"]
fn slow_noise_of_a_sensor_is_no_effect() {
    let found = spoilt("nothing", |experiment| {
        let records = experiment.train.iter_mut().chain(&mut experiment.test);
        records.zip(0..).for_each(|(record, place)| noisy(&mut record.outputs[0], 1e-3, slow(place, 0.95)));
    });
    let Some(Blind::Slow(own)) = &found.blind else { panic!("{}", verdict_sentence(&found)) };
    assert_eq!((found.verdict, own.output.as_str()), (Verdict::CannotJudge, "x"));
    // Of 0.95 a sample an e-th is left after 20 of them.
    assert!((0.05..0.2).contains(&own.seconds), "{own:?}");
    assert!(found.whereabouts.is_empty());
}
