//! Unit tests of `critical_velocity`.

use super::*;
use crate::instruments::sampled;

const CRITERION: Criterion = Criterion { threshold: 0.2, window: 0.04 };

/// The command rises by 1 per second up to the time `turn` and falls from there. The velocity swings by 1 at 50 Hz
/// up to the command `until` while it rises, and from the command `from` on while it falls.
fn profile(turn: f64, until: f64, from: f64) -> [Vec<f64>; 3] {
    let ramp = move |t: f64| t.min(2.0 * turn - t);
    let (time, command) = sampled(8001, 1e-3, ramp);
    let swinging = |t: f64| if t < turn { ramp(t) < until } else { ramp(t) < from };
    let (_, velocity) = sampled(8001, 1e-3, |t| {
        ramp(t) + if swinging(t) { 0.5 * (100.0 * std::f64::consts::PI * t).sin() } else { 0.0 }
    });
    [time, command, velocity]
}

fn read([time, command, velocity]: &[Vec<f64>; 3]) -> CriticalVelocity {
    critical_velocity(time, command, velocity, CRITERION)
}

#[test]
fn oscillation_ends_rising_and_begins_falling() {
    let found = read(&profile(4.0, 3.0, 1.0));
    assert!((found.rising.unwrap() - 3.0).abs() < 0.011, "{found:?}");
    // The first window that detects the oscillation starts up to one window before it.
    assert!((0.99..1.041).contains(&found.falling.unwrap()), "{found:?}");
}

#[test]
fn a_mirrored_run_gives_the_same_values_with_the_opposite_sign() {
    let [time, command, velocity] = profile(4.0, 3.0, 1.0);
    let negative = |values: &[f64]| values.iter().map(|value| -value).collect::<Vec<_>>();
    let forward = critical_velocity(&time, &command, &velocity, CRITERION);
    let backward = critical_velocity(&time, &negative(&command), &negative(&velocity), CRITERION);
    assert_eq!(backward.rising.unwrap(), -forward.rising.unwrap());
    assert_eq!(backward.falling.unwrap(), -forward.falling.unwrap());
}

#[test]
fn swings_match_a_direct_computation() {
    let (_, values) = sampled(300, 1.0, |t| (t * t).sin() * t);
    for span in [1, 2, 7, 300] {
        let plain = values.windows(span).map(|window| {
            let most = window.iter().copied().fold(f64::MIN, f64::max);
            most - window.iter().copied().fold(f64::MAX, f64::min)
        });
        assert!(swings(&values, span).eq(plain), "{span}");
    }
}

#[test]
fn runs_without_a_critical_velocity_return_errors() {
    use CriticalVelocityError::*;
    let both = |found: CriticalVelocity| (found.rising.unwrap_err(), found.falling.unwrap_err());
    assert_eq!(both(read(&profile(4.0, 0.0, 0.0))), (NoOscillation, NoOscillation));
    assert_eq!(read(&profile(4.0, 0.15, 0.0)).rising, Err(NoOscillation), "breaking away only");
    let continues = read(&profile(4.0, 3.9, 1.0));
    assert_eq!(both(continues), (NotEnded(4.0), NotBegun));
    assert_eq!(read(&profile(9.0, 3.0, 1.0)).falling, Err(NeverBack));
    let [time, command, velocity] = profile(4.0, 3.0, 1.0);
    let with = |criterion| both(critical_velocity(&time, &command, &velocity, criterion)).0;
    let window = |window| Criterion { window, ..CRITERION };
    assert_eq!(with(window(0.005)), Window(WindowError::TooCoarse(5)));
    assert_eq!(with(window(9.0)), Window(WindowError::TooLong { window: 9.0, run: 8.0 }));
    assert_eq!(with(Criterion { threshold: 0.0, ..CRITERION }), Window(WindowError::BadCriterion));
    assert!(matches!(with(Criterion { threshold: 0.03, ..CRITERION }), CommandTooFast(_)));
    let message = "the command alone changes by 1.95 mm/s within a window: it must stay below the threshold";
    assert_eq!(CommandTooFast(1.95e-3).message_in("m/s"), message);
    assert_eq!(NotEnded(0.02).message_in("m/s"), "oscillation has not ended at a command of 20 mm/s");
    assert_eq!(NoRise.message_in("m/s"), NoRise.to_string());
    let (time, wave) = sampled(8001, 1e-3, |t| (t.sin() + 0.3 * (9.0 * t).sin()) * (1.0 - t / 8.0));
    assert_eq!(both(critical_velocity(&time, &wave, &velocity, CRITERION)), (NoRise, NoFall));
    let constant = vec![1.0; 8001];
    assert_eq!(both(critical_velocity(&time, &constant, &velocity, CRITERION)), (Constant, Constant));
    assert_eq!(both(critical_velocity(&time, &constant[1..], &velocity, CRITERION)).0, NotASignal);
    assert_eq!(both(critical_velocity(&[], &[], &[], CRITERION)).0, NotASignal);
}
