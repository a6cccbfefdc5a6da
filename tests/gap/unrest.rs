//! Noise that is none of a missing effect: of a drive, and slow noise of a sensor.

use patchcord::gap::blind::Blind;
use patchcord::gap::search::Verdict;

use super::noise::{slow, white};
use super::search::spoilt;

/// A column with so much noise.
fn noisy(samples: &mut [f64], size: f64, mut noise: impl FnMut() -> f64) {
    samples.iter_mut().for_each(|sample| *sample += size * noise());
}

#[test]
fn noise_of_a_drive_is_no_effect() {
    for (sigma, seed) in [(0.5, 1), (2.0, 2)] {
        let found = spoilt("nothing", |experiment| {
            let records = experiment.train.iter_mut().chain(&mut experiment.test);
            records.zip(0..).for_each(|(record, place)| {
                noisy(&mut record.drives[0], sigma, white(seed + 10 * place));
            });
        });
        let Some(Blind::NotWhite(own)) = &found.blind else { panic!("{}", found.sentence()) };
        assert_eq!((found.verdict, own.drives.as_slice()), (Verdict::CannotJudge, &["F".to_owned()][..]));
        assert!(own.is_of_drives() && (0.3..2.5).contains(&(own.left / own.brought)), "{own:?}");
    }
    // A drive that is set and not measured has none, however it jumps.
    let found = spoilt("nothing", |experiment| experiment.drives[0].sigma = Some(0.0));
    assert_eq!(found.verdict, Verdict::NothingMissing);
}

#[test]
fn an_effect_shows_beside_noise_of_a_drive() {
    let found = spoilt("saturation", |experiment| {
        let records = experiment.train.iter_mut().chain(&mut experiment.test);
        records.zip(0..).for_each(|(record, place)| noisy(&mut record.drives[0], 0.005, white(place)));
    });
    assert_eq!((found.verdict, found.effects[0].effect.as_str()), (Verdict::Named, "saturation"));
}

#[test]
fn slow_noise_of_a_sensor_is_no_effect() {
    let found = spoilt("nothing", |experiment| {
        let records = experiment.train.iter_mut().chain(&mut experiment.test);
        records.zip(0..).for_each(|(record, place)| noisy(&mut record.outputs[0], 1e-3, slow(place, 0.95)));
    });
    let Some(Blind::Slow(own)) = &found.blind else { panic!("{}", found.sentence()) };
    assert_eq!((found.verdict, own.output.as_str()), (Verdict::CannotJudge, "x"));
    // Of 0.95 a sample an e-th is left after 20 of them.
    assert!((0.05..0.2).contains(&own.seconds), "{own:?}");
    assert!(found.whereabouts.is_empty());
}
