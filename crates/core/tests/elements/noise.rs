//! Drive: noise.

use std::f64::consts::{SQRT_2, TAU};

use chacha20::ChaCha8Rng;
use chacha20::rand_core::{Rng as _, SeedableRng as _};
use proptest::prelude::*;

use crate::common::{built, convergence_order, element, random_cases, run_for, voltage, volts};
use crate::elements::bench::{bench_drive, drive_stops_at_100_volts, near, out, waits_in_hold};
use patchcord_core::circuit::Circuit;
use patchcord_core::ir::{Program, SettingError, SettingFault};
use patchcord_core::patch::{ElementBuilder, PatchBuilder};
use patchcord_core::solve::{self, Phase, RunError, RunSettings};

/// Noise of 1 V rms.
fn noise(seed: u64, every: f64) -> ElementBuilder {
    element("noise").set("rms", 1).set("every", every).set("seed", seed)
}

/// The first numbers of a noise sequence, computed from the ChaCha8 stream in order.
fn sequence(seed: u64, uniform: bool, count: usize) -> Vec<f64> {
    let mut key = [0; 32];
    key[..8].copy_from_slice(&(seed as f64).to_le_bytes());
    let mut stream = ChaCha8Rng::from_seed(key);
    let mut next_unit = || ((stream.next_u64() >> 12) as f64 + 0.5) / 2f64.powi(52);
    let number = |first: f64, second: f64| match uniform {
        true => 12f64.sqrt() * (first - 0.5),
        false => (-2.0 * first.ln()).sqrt() * (TAU * second).cos(),
    };
    (0..count)
        .map(|_| {
            let first = next_unit();
            number(first, next_unit())
        })
        .collect()
}

proptest! {
    #![proptest_config(random_cases(48))]

    #[test]
    fn law(
        seed in 0..1u64 << 53, uniform: bool, rms in 0.0..10.0f64, offset in -30.0..30.0f64,
        every in 0.01..0.3f64, step in 0.001..0.2f64, time in 0.0..1.0f64,
    ) {
        let distribution = if uniform { "uniform" } else { "normal" };
        let drive = noise(seed, every).set("rms", rms).set("offset", offset).set("distribution", distribution);
        let index = (time / every).floor();
        prop_assume!((time - index * every).min((index + 1.0) * every - time) > 1e-6);
        let found = out(&run_for(&bench_drive(drive), step, time));
        let expected = offset + rms * sequence(seed, uniform, 101)[index as usize];
        prop_assert!(near(found, expected), "{found} {expected}");
    }
}

#[test]
fn overload() {
    drive_stops_at_100_volts(noise(1, 0.1).set("rms", 0).set("offset", -120), -120.0);
}

#[test]
fn modes() {
    let numbers = sequence(5, false, 10);
    waits_in_hold(noise(5, 0.1), |time| numbers[(time * 10.0) as usize]);
}

/// The expected numbers were computed by an independent implementation of ChaCha in another language.
#[test]
fn the_numbers_agree_with_an_independent_implementation() {
    let normal = [(0, -1.0916459870920308), (1, 0.9701778571107535), (1000, 0.270083015796877)];
    let uniform = [(0, -0.610815102637512), (1, 0.2354789139191683), (1000, -0.1610323722978622)];
    for (word, expected) in [("normal", normal), ("uniform", uniform)] {
        let program = bench_drive(noise(1, 1e-3).set("distribution", word));
        for (index, number) in expected {
            let machine = run_for(&program, 0.01, f64::from(index) * 1e-3);
            assert!(near(out(&machine), number), "{word} {index}: {}", out(&machine));
        }
    }
}

/// LENGTH numbers of a machine, one for each step.
fn long_sequence(distribution: &str) -> Vec<f64> {
    let program = bench_drive(noise(3, 0.01).set("distribution", distribution));
    let mut machine = run_for(&program, 0.01, 0.0);
    let next = |_| {
        let number = out(&machine);
        machine.operate(0.01).unwrap();
        number
    };
    (0..LENGTH).map(next).collect()
}

/// Numbers of a long sequence.
const LENGTH: usize = 20_000;
/// Four standard deviations of the mean of LENGTH numbers with the variance 1.
const FOUR_SIGMA: f64 = 4.0 / 141.4;

#[test]
fn numbers_have_mean_0_and_variance_1_and_are_uncorrelated() {
    for (distribution, fourth_moment) in [("normal", 3.0), ("uniform", 1.8)] {
        let sequence = long_sequence(distribution);
        let mean = |values: &mut dyn Iterator<Item = f64>| values.sum::<f64>() / LENGTH as f64;
        assert!(mean(&mut sequence.iter().copied()).abs() < FOUR_SIGMA, "{distribution}");
        let variance = mean(&mut sequence.iter().map(|number| number * number));
        let spread: f64 = fourth_moment - 1.0;
        assert!((variance - 1.0).abs() < FOUR_SIGMA * spread.sqrt(), "{distribution} {variance}");
        for lag in 1..=50 {
            let product = mean(&mut sequence.iter().zip(&sequence[lag..]).map(|(a, b)| a * b));
            assert!(product.abs() < FOUR_SIGMA, "{distribution} {lag} {product}");
        }
    }
}

/// Chi-square over fifty equally likely intervals has 49 degrees of freedom. It is between its quantiles of 0.1 and
/// 99.9 %.
#[test]
fn numbers_have_their_declared_distribution() {
    let normal = |number: f64| 0.5 * libm::erfc(-number / SQRT_2);
    let uniform = |number: f64| 0.5 + number / 12f64.sqrt();
    let distributions: [(&str, &dyn Fn(f64) -> f64); 2] = [("normal", &normal), ("uniform", &uniform)];
    for (distribution, cumulative) in distributions {
        let mut counts = [0.0; 50];
        for number in long_sequence(distribution) {
            counts[(50.0 * cumulative(number)) as usize] += 1.0;
        }
        let expected = LENGTH as f64 / 50.0;
        let chi_square: f64 = counts.iter().map(|count| (count - expected).powi(2) / expected).sum();
        assert!((23.9..85.4).contains(&chi_square), "{distribution} {chi_square}");
    }
}

/// Noise that drives one integrator directly and another through a delay line.
fn integrated() -> Program {
    built(
        volts("integrated")
            .drive("u", "volt", noise(11, 0.013).set("rms", 20))
            .element("D", element("delay").cord("in", "u").set("delay", 0.25))
            .element("A", element("integrator").cords("x1", ["u"]))
            .element("B", element("integrator").cords("x1", ["D"]))
            .element("C", element("integrator").cords("x1", ["A", "C"])),
    )
}

#[test]
fn voltages_do_not_depend_on_the_step() {
    let program = integrated();
    let numbers = sequence(11, false, 80);
    let sum = |time: f64| {
        let whole = (time / 0.013).floor();
        let before: f64 = numbers[..whole as usize].iter().sum();
        -20.0 * (0.013 * before + (time - 0.013 * whole) * numbers[whole as usize])
    };
    let reference = run_for(&program, 1e-4, 1.0);
    for step in [0.003, 0.013, 0.07, 0.25] {
        let machine = run_for(&program, step, 1.0);
        assert!((voltage(&machine, "A") - sum(1.0)).abs() < 1e-11, "{step}");
        assert!((voltage(&machine, "B") - sum(0.75)).abs() < 1e-11, "{step}: after a delay line");
        let difference = voltage(&machine, "C") - voltage(&reference, "C");
        assert!(difference.abs() < 1e-9, "{step} {difference:e}: no step is longer than 0.013 s");
    }
}

/// Six hundred integrated sequences: their variance is rms^2 x every x t.
#[test]
fn integrated_noise_grows_with_the_square_root_of_time() {
    let names = |index: u64| (format!("u{index}"), format!("A{index}"));
    let builder = (0..600).fold(volts("walks"), |builder: PatchBuilder, index| {
        let (drive, integrator) = names(index);
        let walk = element("integrator").cords("x1", [drive.as_str()]);
        builder.drive(&drive, "volt", noise(index, 0.05).set("rms", 3)).element(&integrator, walk)
    });
    let program = built(builder);
    let times = [1.0, 2.0, 4.0, 8.0];
    let deviations = times.map(|time| {
        let machine = run_for(&program, 0.05, time);
        let squares: f64 = machine.states().iter().map(|volts| volts * volts).sum();
        (squares / 600.0).sqrt()
    });
    for (time, deviation) in times.iter().zip(deviations) {
        // The relative uncertainty of a variance of 600 numbers is sqrt(2 / 600), that of its root half of that.
        let expected = 3.0 * (0.05 * time).sqrt();
        assert!((deviation / expected - 1.0).abs() < 4.0 * (0.5f64 / 600.0).sqrt(), "{time} {deviation}");
    }
    let power = convergence_order(&times, &deviations);
    assert!((0.45..0.55).contains(&power), "{power}");
}

#[test]
fn samples_before_and_after_a_jump_have_the_right_number() {
    let patch = volts("recorded").drive("u", "volt", noise(2, 0.1)).record(["u"]).build().unwrap();
    let circuit = Circuit::new(&patch).unwrap();
    let settings = RunSettings::of(&circuit).unwrap().with_step(0.03).with_sample_interval(0.05);
    let trace = solve::run(&Program::new(&circuit).unwrap(), &settings).unwrap();
    let numbers = sequence(2, false, 11);
    for (index, volts) in trace.tracks[0].volts.iter().enumerate() {
        assert!(near(*volts, numbers[index / 2]), "{index} {volts}");
    }
}

/// Noise whose seed and interval are parameters.
fn with_changeable_grid() -> Program {
    let drive = element("noise").set("rms", 1).set("every", "T").set("seed", "s");
    let builder =
        volts("changeable").parameter("s", 1.0, "1", [0.0, 10.0]).parameter("T", 0.1, "s", [0.01, 1.0]);
    built(builder.drive("u", "volt", drive))
}

#[test]
fn seed_and_interval_can_be_changed_during_a_run() {
    let program = with_changeable_grid();
    let mut machine = run_for(&program, 0.01, 0.55);
    assert!(near(voltage(&machine, "u"), sequence(1, false, 6)[5]));
    machine.set_parameter("s", 4.0).unwrap();
    assert!(near(voltage(&machine, "u"), sequence(4, false, 6)[5]), "another sequence with the same index");
    machine.set_parameter("T", 0.05).unwrap();
    machine.operate(0.06).unwrap();
    assert!(near(voltage(&machine, "u"), sequence(4, false, 13)[12]), "another interval, counted from t = 0");
    let refused = machine.set_parameter("s", 4.5);
    let is_not_whole = matches!(
        refused,
        Err(RunError::Setting(SettingError::Unfit { value: 4.5, fault: SettingFault::NotWhole, .. }))
    );
    assert!(is_not_whole, "{refused:?}");
    machine.initial_condition().unwrap();
    assert!(near(voltage(&machine, "u"), sequence(4, false, 1)[0]));
}

#[test]
fn too_many_numbers_in_a_run_are_refused() {
    let patch = volts("fine").drive("u", "volt", noise(1, 1e-9)).record(["u"]).build().unwrap();
    let circuit = Circuit::new(&patch).unwrap();
    let settings = RunSettings::of(&circuit).unwrap().with_step(1.0).with_sample_interval(1.0);
    let settings = settings.with_duration(200.0);
    let stopped = solve::run(&Program::new(&circuit).unwrap(), &settings).unwrap_err();
    assert!(matches!(&stopped.error, RunError::NoiseTooFine { element, .. } if element == "u"), "{stopped}");
}

#[test]
fn the_limit_counts_equal_steps_and_the_steps_of_all_drives() {
    let square = element("square").set("amplitude", 1).set("frequency", 300);
    let builder = volts("many steps").drive("u", "volt", noise(1, 1e-3)).drive("s", "volt", square);
    let circuit = Circuit::new(&builder.record(["u"]).build().unwrap()).unwrap();
    let program = Program::new(&circuit).unwrap();
    let settings = RunSettings::of(&circuit).unwrap().with_step(1e-3);
    let error = |settings: &RunSettings| solve::check(&program, settings).unwrap_err();
    // For each second 1000 equal steps, 1000 numbers and 600 edges.
    let settings = settings.with_duration(4e6).with_sample_interval(4e6);
    let message = "u draws a number every 0.001 s, 4e9 in the run, and each ends a step; the run would take \
                   up to 1.04e10 steps, 3 hours at a million steps a second; at most 1e10 are allowed; \
                   choose a longer \"every\" of u";
    assert_eq!((error(&settings).code(), error(&settings).to_string().as_str()), ("noise-too-fine", message));
    let shorter = settings.clone().with_duration(3.8e6).with_sample_interval(1e6);
    assert_eq!(solve::check(&program, &shorter), Ok(()));
    // Of 1.1e10 steps, 9.4e9 are equal steps.
    let equal = error(&shorter.with_duration(1e6).with_step(1.0 / 9400.0));
    assert!(matches!(equal, RunError::TooManySteps { steps, .. } if steps > 1e10), "{equal}");
    // Steps that adapt to a tolerance are counted during the run.
    assert_eq!(solve::check(&program, &settings.with_tolerance(1e-6)), Ok(()));
}

/// Noise whose rms is a parameter, on a scale of -0.5 m/s per volt.
fn with_changeable_rms() -> Program {
    let drive = element("noise").set("rms", "r").set("every", "T").set("seed", 3);
    let builder = PatchBuilder::new("height").scale("velocity", -0.5, "m/s");
    let builder = builder.parameter("r", 1.0, "m/s", [-5.0, 5.0]).parameter("T", 0.1, "s", [1e-9, 1.0]);
    built(builder.drive("u", "velocity", drive).record(["u"]).run(200.0, 0.1))
}

#[test]
fn a_negative_rms_cannot_be_set_on_a_negative_scale() {
    let program = with_changeable_rms();
    let mut machine = run_for(&program, 0.1, 0.0);
    machine.set_parameter("r", 2.0).unwrap();
    assert!(near(voltage(&machine, "u"), -4.0 * sequence(3, false, 1)[0]));
    assert_eq!(machine.set_parameter("r", -2.0).unwrap_err().to_string(), "u rms is -2, below 0");
}

#[test]
fn a_phase_that_sets_a_too_short_interval_stops_the_run() {
    let program = with_changeable_rms();
    let phases = vec![Phase::operate(50.0), Phase::set("T", 1e-9), Phase::operate(150.0)];
    let settings = RunSettings::from_phases(phases, 0.1).with_signals(["u"]);
    let stopped = solve::run(&program, &settings).unwrap_err();
    assert!(
        matches!(&stopped.error, RunError::NoiseTooFine { numbers, .. } if *numbers > 1.4e11),
        "{stopped}"
    );
    assert!((stopped.trace.time.last().unwrap() - 50.0).abs() < 1e-9, "the record up to that phase is kept");
}
