//! Unit tests of `profile`.

use std::f64::consts::TAU;

use super::*;
use crate::instruments::sampled;

const CRITERION: ProfileCriterion = ProfileCriterion::usual(Criterion { threshold: 0.1, window: 0.04 });

/// A rising profile. The command rises by 0.5 per second to 3. The velocity sticks up to 0.1, jumps to 0.6 and
/// rings about the command. An oscillation at 50 Hz is added, with the amplitude `height(command)`. `sign`
/// mirrors it all.
fn read(sign: f64, height: impl Fn(f64) -> f64) -> Result<VelocityProfile, ProfileError> {
    let (time, command) = sampled(12_001, 5e-4, |t| sign * 0.5 * t);
    let (_, velocity) = sampled(12_001, 5e-4, |t| sign * velocity(t, &height));
    velocity_profile(&time, &command, &velocity, CRITERION, RampDirection::Rising)
}

fn velocity(t: f64, height: impl Fn(f64) -> f64) -> f64 {
    let rings = |t: f64| 0.5 * (-30.0 * t).exp() * (TAU * 50.0 * t).cos();
    let swing = height(0.5 * t) * (TAU * 50.0 * t).sin();
    if t < 0.2 { 0.0 } else { 0.5 * t + rings(t - 0.2) + swing }
}

/// The same reversed in time, after 6 s of smooth sliding.
fn read_back(sign: f64, height: impl Fn(f64) -> f64) -> VelocityProfile {
    let back = |t: f64| (12.0 - t).min(6.0);
    let (time, command) = sampled(24_001, 5e-4, |t| sign * 0.5 * t.min(back(t)));
    let (_, velocity) =
        sampled(24_001, 5e-4, |t| sign * if t < 6.0 { 0.5 * t } else { velocity(back(t), &height) });
    velocity_profile(&time, &command, &velocity, CRITERION, RampDirection::Falling).unwrap()
}

/// An amplitude that grows from command 0.5 on, exceeds the command from 0.9 to 1.6, and is 0 from 2 on.
fn whole(command: f64) -> f64 {
    match command {
        ..0.5 => 0.0,
        ..0.9 => 1.0 * (command - 0.5) / 0.4,
        ..1.6 => command + 0.2,
        _ => 1.5 * (1.0 - (command - 1.6) / 0.4).max(0.0),
    }
}

fn commands(profile: &VelocityProfile) -> [f64; 5] {
    profile.points.map(|point| point.unwrap().command)
}

fn near(got: impl IntoIterator<Item = f64>, wanted: &[f64], within: f64) {
    let got: Vec<f64> = got.into_iter().collect();
    assert!(got.iter().zip(wanted).all(|(got, wanted)| (got - wanted).abs() < within), "{got:?} {wanted:?}");
    assert_eq!(got.len(), wanted.len());
}

#[test]
fn a_complete_profile_has_all_points_and_sections() {
    let profile = read(1.0, whole).unwrap();
    near(commands(&profile), &[0.1, 0.51, 0.8, 1.6, 1.99], 0.02);
    assert!(profile.points.iter().all(|point| point.unwrap().coincides_with.is_none()), "{profile:?}");
    near(profile.jump, &[0.6], 0.01);
    let sections = profile.sections.map(|section| section.unwrap());
    for (section, [begin, end]) in sections.iter().zip([[0, 1], [1, 2], [2, 3], [3, 4]]) {
        near(section.command, &[commands(&profile)[begin], commands(&profile)[end]], 1e-12);
    }
    assert!(
        sections[0].cycles < 6 && sections[1..].iter().all(|section| section.cycles > 20),
        "{sections:?}"
    );
    near(sections[2].swing, &[3.6], 0.02);
    near(sections[2].frequency.unwrap(), &[50.0, 50.0], 1.0);
}

#[test]
fn a_mirrored_run_gives_the_mirrored_profile() {
    let [forward, backward] = [1.0, -1.0].map(|sign| read(sign, whole).unwrap());
    near(commands(&backward), &commands(&forward).map(|command| -command), 1e-9);
    assert_eq!(backward.jump, forward.jump.map(|jump| -jump));
}

#[test]
fn a_command_may_start_with_the_opposite_sign() {
    let (time, command) = sampled(8001, 1e-3, |t| 0.5 * t - 1.0);
    let (_, velocity) =
        sampled(8001, 1e-3, |t| 0.5 * t - 1.0 + if t < 1.0 { (TAU * 50.0 * t).sin() } else { 0.0 });
    let profile = velocity_profile(&time, &command, &velocity, CRITERION, RampDirection::Rising).unwrap();
    near([profile.points[4].unwrap().command], &[-0.5], 0.02);
}

#[test]
fn stick_slip_from_the_beginning_makes_points_coincide() {
    let profile = read(1.0, |command| if command < 1.0 { command + 0.2 } else { 0.0 }).unwrap();
    let coincide = profile.points.map(|point| point.unwrap().coincides_with);
    assert_eq!(coincide, [None, Some(1), Some(2), None, Some(4)]);
    let absent = profile.sections.map(|section| section.err());
    let empty = |one, other| Some(MissingPointError::Coincide(one, other));
    assert_eq!(absent, [empty(1, 2), empty(2, 3), None, empty(4, 5)]);
}

#[test]
fn on_the_falling_ramp_the_same_points_are_in_reverse_order() {
    for sign in [1.0, -1.0] {
        let profile = read_back(sign, whole);
        near(commands(&profile).map(|command| sign * command), &[0.1, 0.52, 0.8, 1.6, 2.0], 0.02);
        for point in profile.points.map(Result::unwrap) {
            near([12.0 - 2.0 * sign * point.command], &[point.time], 1e-6);
        }
        near(profile.jump, &[sign * 0.6], 0.02);
        let sections = profile.sections.map(|section| section.unwrap());
        for (section, [begin, end]) in sections.iter().zip([[1, 0], [2, 1], [3, 2], [4, 3]]) {
            near(section.command, &[commands(&profile)[begin], commands(&profile)[end]], 1e-12);
            assert!(section.time[0] < section.time[1]);
        }
        near(sections[2].swing, &[3.6], 0.02);
    }
}

#[test]
fn on_the_falling_ramp_stick_slip_down_to_rest_makes_points_coincide() {
    let profile = read_back(1.0, |command| if command < 1.0 { command + 0.2 } else { 0.0 });
    assert_eq!(
        profile.points.map(|point| point.unwrap().coincides_with),
        [None, Some(1), Some(2), None, Some(4)]
    );
    near([profile.points[0].unwrap().time, profile.points[4].unwrap().time], &[11.8, 10.0], 0.05);
}

#[test]
fn missing_points_of_the_falling_ramp_have_a_reason() {
    let absent = |height: &dyn Fn(f64) -> f64| read_back(1.0, height).points.map(|point| point.err());
    let quiet = Some(MissingPointError::NoOscillation);
    assert_eq!(absent(&|_| 0.0), [None, quiet, quiet, quiet, quiet]);
    let before = absent(&|command| if command > 2.0 { 0.2 } else { 0.0 });
    let no = Some(MissingPointError::NoStickSlip);
    assert_eq!(before, [None, None, no, no, Some(MissingPointError::NotBegun)]);
    // The run ends during oscillation, or during sliding.
    let cut = |height: fn(f64) -> f64| {
        let (time, command) = sampled(10_001, 5e-4, |t| 0.5 * (6.0 - t));
        let (_, velocity) = sampled(10_001, 5e-4, |t| velocity(6.0 - t, height));
        velocity_profile(&time, &command, &velocity, CRITERION, RampDirection::Falling).unwrap()
    };
    let continues = cut(|command| if command < 2.0 { command + 0.2 } else { 0.0 });
    let (no_rest, on) = (Some(MissingPointError::NoRest), Some(MissingPointError::NotEnded));
    assert_eq!(continues.points.map(|point| point.err()), [no_rest, on, on, None, None]);
    let absent = [Some(MissingPointError::NoPoint(2)), Some(MissingPointError::NoPoint(3)), None];
    assert_eq!(continues.sections.map(|section| section.err())[..3], absent);
    let slides = cut(|command| if (1.0..2.0).contains(&command) { 0.3 } else { 0.0 });
    assert_eq!(slides.points.map(|point| point.err()), [no_rest, None, no, no, None]);
    let short = Some(MissingPointError::TooShort);
    let begins = cut(|command| if command < 0.55 { command + 0.2 } else { 0.0 });
    assert_eq!(begins.points.map(|point| point.err()), [no_rest, short, short, short, short]);
    let bout = cut(|command| if (1.5..1.53).contains(&command) { 0.3 } else { 0.0 });
    assert_eq!(bout.points.map(|point| point.err()), [no_rest, quiet, quiet, quiet, quiet]);
}

#[test]
fn bouts_separated_by_steady_sliding_are_not_added() {
    // Three cycles every half second.
    let bouts = |command: f64| if (4.0 * command).fract() < 0.12 { 0.3 } else { 0.0 };
    let rings = Some(MissingPointError::RingsOnly);
    assert_eq!(read(1.0, bouts).unwrap().points.map(|point| point.err()), [None, rings, rings, rings, rings]);
    // Two cycles reach standstill before steady sliding, two after it.
    let parted = |command: f64| match command {
        0.98..1.0 | 1.2..1.22 => command + 0.2,
        0.5..0.98 | 1.22..1.7 => 0.2,
        _ => 0.0,
    };
    let profile = read(1.0, parted).unwrap();
    assert_eq!(profile.points[2], Err(MissingPointError::NoStickSlip));
    near([1, 4].map(|index| profile.points[index].unwrap().command), &[0.5, 1.7], 0.02);
}

#[test]
fn without_stick_slip_sections_b_and_d_meet_at_the_largest_swing() {
    let profile = read(1.0, |command| 0.4 * (1.0 - ((command - 1.5) / 0.5).powi(2)).max(0.0)).unwrap();
    let absent = profile.points.map(|point| point.err());
    assert_eq!(
        absent,
        [None, None, Some(MissingPointError::NoStickSlip), Some(MissingPointError::NoStickSlip), None]
    );
    let [_, grows, sticks, dies] = profile.sections;
    near([grows.unwrap().command[1], dies.unwrap().command[0]], &[1.5, 1.5], 0.02);
    assert_eq!(sticks, Err(MissingPointError::NoStickSlip));
}

#[test]
fn missing_points_of_the_rising_ramp_have_a_reason() {
    let absent = |height: &dyn Fn(f64) -> f64| read(1.0, height).unwrap().points.map(|point| point.err());
    let rings = Some(MissingPointError::RingsOnly);
    assert_eq!(absent(&|_| 0.0), [None, rings, rings, rings, rings]);
    let continues = absent(&|command| if command > 1.0 { command + 0.2 } else { 0.0 });
    assert_eq!(
        continues,
        [None, None, None, Some(MissingPointError::NotEnded), Some(MissingPointError::NotEnded)]
    );
    let (time, command) = sampled(6001, 1e-3, |t| 0.5 * t);
    let of = |velocity: &[f64]| {
        velocity_profile(&time, &command, velocity, CRITERION, RampDirection::Rising).unwrap()
    };
    assert_eq!(of(&vec![0.0; 6001]).points, [Err(MissingPointError::Sticks); 5]);
    let late: Vec<f64> =
        time.iter().map(|t| 0.5 * t + if *t < 5.9 { 0.0 } else { (TAU * 50.0 * t).sin() }).collect();
    assert_eq!(of(&late).points[1..], [Err(MissingPointError::TooShort); 4]);
    let follows = of(&command);
    assert_eq!(
        (follows.points[0], follows.points[4]),
        (Err(MissingPointError::NoJump), Err(MissingPointError::NoOscillation))
    );
    assert_eq!(follows.sections[0].unwrap().command, [0.0, 3.0]);
}

#[test]
fn unusable_runs_return_errors() {
    let (time, command) = sampled(6001, 1e-3, |t| 0.5 * t);
    let with = |command: &[f64], criterion| {
        velocity_profile(&time, command, &vec![0.0; 6001], criterion, RampDirection::Rising)
    };
    let error = |command: &[f64]| with(command, CRITERION).unwrap_err();
    assert_eq!(error(&vec![1.0; 6001]), ProfileError::Unreadable(CriticalVelocityError::Constant));
    let falls: Vec<f64> = command.iter().map(|value| 3.0 - value).collect();
    assert_eq!(error(&falls), ProfileError::Unreadable(CriticalVelocityError::NoRise));
    assert_eq!(error(&command[1..]), ProfileError::Unreadable(CriticalVelocityError::NotASignal));
    let still = |standstill| with(&command, ProfileCriterion { standstill, ..CRITERION }).unwrap_err();
    assert_eq!(still(0.0), ProfileError::BadStandstill(0.0));
    assert!(matches!(still(f64::NAN), ProfileError::BadStandstill(_)));
    assert_eq!(still(3.0), ProfileError::Motionless { standstill: 3.0, reached: 3.0 });
    assert!(with(&command, ProfileCriterion { standstill: 2.9, ..CRITERION }).is_ok());
}
