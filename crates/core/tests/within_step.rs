//! Events that come and go within one step, and turning points of a backlash, in every backend.

use std::f64::consts::TAU;

use serde_json::json;

use crate::common::random::SplitMix64;
use crate::common::{circuit, element, volts};
use patchcord_core::ir::Program;
use patchcord_core::patch::{ElementBuilder, Patch, PatchBuilder};
use patchcord_core::solve::{self, Backend, RunSettings};
use patchcord_core::trace::Trace;

/// Amplitude of the sine that a relay compares, in volts.
const AMPLITUDE: f64 = 99.0;

/// A relay from `off` to `on` volts at a threshold, with almost no hysteresis, and the integral of its output.
fn counted(builder: PatchBuilder, input: &str, threshold: f64) -> Patch {
    let relay = element("relay")
        .cord("in", input)
        .cord("on", "+100")
        .cord("off", "ground")
        .set("pull_in", threshold)
        .set("drop_out", threshold - 1e-9);
    builder
        .element("K", relay)
        .element("P", element("pot").cord("in", "K").set("setting", 0.1))
        .element("A", element("integrator").cords("x1", ["P"]))
        .build()
        .unwrap_or_else(|report| panic!("{report}"))
}

/// A sine of 1 Hz as a drive, with its phase in radians.
fn driven(phase: f64) -> PatchBuilder {
    volts("driven").drive(
        "S",
        "volt",
        element("sine").set("amplitude", AMPLITUDE).set("frequency", 1).set("phase", phase),
    )
}

/// The same sine as the output of an oscillator of two integrators.
fn oscillating(phase: f64) -> PatchBuilder {
    let pot = |input: &str| element("pot").cord("in", input).set("setting", TAU / 10.0);
    let integrator =
        |pot: &str, initial: f64| element("integrator").cords("x10", [pot]).set("initial", initial);
    volts("oscillating")
        .element("C", integrator("PS", AMPLITUDE * phase.cos()))
        .element("PS", pot("S"))
        .element("S", integrator("PC", AMPLITUDE * phase.sin()))
        .element("PC", pot("M"))
        .element("M", element("inverter").cord("in", "C"))
}

/// The square of the sine of an oscillator with half the phase, as a share of 100 V.
fn squared(phase: f64) -> PatchBuilder {
    let square = element("multiplier").set("mode", "product").cord("a", "H").cord("b", "H");
    oscillating(0.5 * phase).element("H", element("inverter").cord("in", "S")).element("Q", square)
}

/// The run of a patch with this step for this many seconds.
fn run(patch: &Patch, step: f64, length: f64, backend: Backend) -> Trace {
    let circuit = circuit(patch, &[]);
    let settings = RunSettings::of(&circuit).unwrap().with_duration(length).with_step(step);
    let settings = settings.with_sample_interval(length).with_signals(["A"]).with_backend(backend);
    solve::run(&Program::new(&circuit).unwrap(), &settings).unwrap_or_else(|stopped| panic!("{stopped}"))
}

/// The time during which the relay was on, in seconds.
fn time_on(trace: &Trace) -> f64 {
    -0.1 * trace.tracks[0].volts.last().unwrap()
}

#[test]
fn a_pulse_of_72_percent_of_a_step_is_counted_in_every_period() {
    // The sine is above 98.9 V for 14.3 ms of each of 10 periods.
    let expected = 10.0 * 2.0 * (98.9f64 / AMPLITUDE).acos() / TAU;
    assert!((expected - 0.143).abs() < 1e-3, "{expected}");
    for (builder, step, tolerance) in [
        (driven(0.0), 0.02, 1e-6),
        (driven(0.0), 0.03, 1e-6),
        (driven(1.0), 0.04, 1e-6),
        (oscillating(0.0), 0.02, 5e-4),
    ] {
        let patch = counted(builder, "S", 98.9);
        for backend in Backend::ALL {
            let found = time_on(&run(&patch, step, 10.0, backend));
            assert!((found - expected).abs() < tolerance, "step {step} by {backend}: {found} {expected}");
        }
    }
}

/// A pulse that lasts for a third of a step or more is found wherever in a step it is.
#[test]
fn pulses_of_a_third_of_a_step_are_found() {
    let mut random = SplitMix64(53);
    for number in 0..300 {
        // The peak is not near the beginning or the end of the period.
        let (peak, steps) = (random.uniform(0.1, 0.9), random.uniform(25.0, 120.0));
        let (step, share) = (1.0 / steps, random.uniform(0.34, 1.5));
        let width = TAU * share * step;
        let (patch, period) = match number % 3 {
            0 => (counted(driven(TAU * (0.25 - peak)), "S", AMPLITUDE * (0.5 * width).cos()), 1.0),
            1 => (counted(oscillating(TAU * (0.25 - peak)), "S", AMPLITUDE * (0.5 * width).cos()), 1.0),
            // sin^2 (TAU time + phase / 2), with two peaks per second.
            _ => {
                let least = AMPLITUDE * AMPLITUDE / 100.0 * (0.5 * width).cos().powi(2);
                (counted(squared(TAU * (0.5 - peak)), "Q", least), 0.5)
            }
        };
        for backend in Backend::ALL {
            let trace = run(&patch, step, period, backend);
            let changes = trace.repetitions[0].work.changes;
            assert!(changes == 2, "{number}: share {share}, {steps} steps, by {backend}: {changes} changes");
        }
    }
}

/// The integral of what a diode passes of a sine above a constant state, in every backend. Within a period the sine of
/// 60 V at 1 Hz is above the state for a part of a step.
fn passed_by_diode(threshold: f64, gain: f64, phase: f64) -> Patch {
    let sine = element("sine").set("amplitude", 60).set("frequency", 1).set("phase", phase);
    volts("diode")
        .drive("S", "volt", sine)
        .element("T", element("integrator").cords("x1", ["ground"]).set("initial", -threshold))
        .element("M", element("summer").cords("x0.5", ["S", "T"]))
        .element("Z", element("diode-lower-of").set("in", json!(["M", "ground"])))
        .element("A", element("integrator").cords(&format!("x{gain}"), ["Z"]).set("initial", 0))
        .build()
        .unwrap_or_else(|report| panic!("{report}"))
}

/// What the diode passes in this number of periods, without limits.
fn passed(threshold: f64, gain: f64, periods: f64) -> f64 {
    let angle = (threshold / 60.0).acos();
    gain * periods * 0.5 * (60.0 * 2.0 * angle.sin() - threshold * 2.0 * angle) / TAU
}

#[test]
fn a_diode_passes_pulses_of_half_a_step() {
    let expected = passed(59.8, 200.0, 5.0);
    assert!((expected - 1.73295).abs() < 1e-4, "{expected}");
    for (phase, step) in [(2.0, 0.05), (2.0, 0.04), (0.3, 0.05), (1.0, 0.03), (4.0, 0.02)] {
        let patch = passed_by_diode(59.8, 200.0, phase);
        for backend in Backend::ALL {
            let trace = run(&patch, step, 5.0, backend);
            let found = trace.tracks[0].volts.last().unwrap();
            assert!(
                (found - expected).abs() < 1e-3 * expected,
                "{phase} {step} {backend}: {found} {expected}"
            );
        }
    }
    for (phase, tolerance) in [(2.0, 1e-4), (2.0, 1e-8), (0.3, 1e-6), (1.0, 1e-6)] {
        let found = run_to_tolerance(&passed_by_diode(59.8, 200.0, phase), tolerance, 5.0, "A");
        assert!((found - expected).abs() < 200.0 * tolerance, "{phase} {tolerance}: {found} {expected}");
    }
}

/// The last voltage of a run with steps that adapt to a tolerance in machine units.
fn run_to_tolerance(patch: &Patch, tolerance: f64, length: f64, signal: &str) -> f64 {
    let circuit = circuit(patch, &[]);
    let settings = RunSettings::of(&circuit).unwrap().with_duration(length).with_tolerance(tolerance);
    let settings = settings.with_sample_interval(length).with_signals([signal]);
    let trace = solve::run(&Program::new(&circuit).unwrap(), &settings).unwrap();
    *trace.tracks[0].volts.last().unwrap()
}

/// The solution of P' = 1000 (max(S, P) - P) for a sine after 5 s, by the midpoint method with steps of 5e-6 s.
fn held_peak(sine: impl Fn(f64) -> f64) -> f64 {
    let step = 5e-6;
    let rate = |time: f64, held: f64| 1000.0 * f64::max(sine(time) - held, 0.0);
    (0..1_000_000).fold(0.0, |held, index| {
        let time = step * f64::from(index);
        held + step * rate(time + 0.5 * step, held + 0.5 * step * rate(time, held))
    })
}

#[test]
fn a_peak_holder_reaches_the_peak_with_a_tolerance() {
    for (amplitude, frequency, phase) in
        [(70.0, 1.0, 0.0), (70.0, 1.0, 2.0), (30.0, 1.0, 1.0), (70.0, 3.3, 4.0)]
    {
        let sine =
            element("sine").set("amplitude", amplitude).set("frequency", frequency).set("phase", phase);
        let patch = volts("holder")
            .drive("S", "volt", sine)
            .element("U", element("diode-upper-of").set("in", json!(["S", "P"])).set("drop", 0))
            .element("N", element("inverter").cord("in", "U"))
            .element("P", element("integrator").cords("x1000", ["N", "P"]))
            .build()
            .unwrap_or_else(|report| panic!("{report}"));
        let expected = held_peak(|time| amplitude * (TAU * frequency * time + phase).sin());
        for tolerance in [1e-4, 1e-6, 1e-8] {
            let found = run_to_tolerance(&patch, tolerance, 5.0, "P");
            let error = (found - expected).abs();
            assert!(error < 100.0 * tolerance + 1e-6, "{amplitude} {phase} {tolerance}: {found} {expected}");
        }
    }
}

/// Adaptive steps of a sine are up to an eighth of its period. A relay sees pulses of 0.02 to 0.3 of a step.
#[test]
fn short_pulses_within_adaptive_steps_are_found() {
    let mut random = SplitMix64(54);
    for number in 0..300 {
        let (peak, share) = (random.uniform(0.1, 0.9), random.log_uniform(0.02, 0.3));
        let threshold = AMPLITUDE * (0.5 * TAU * share * 0.125).cos();
        let phase = TAU * (0.25 - peak);
        let builder = if number % 2 == 0 { driven(phase) } else { oscillating(phase) };
        let patch = counted(builder, "S", threshold);
        let circuit = circuit(&patch, &[]);
        let settings = RunSettings::of(&circuit).unwrap().with_duration(1.0).with_tolerance(1e-7);
        let settings = settings.with_sample_interval(1.0).with_signals(["A"]);
        let trace = solve::run(&Program::new(&circuit).unwrap(), &settings).unwrap();
        let changes = trace.repetitions[0].work.changes;
        assert!(changes == 2, "{number}: share {share}: {changes} changes");
        let expected = share * 0.125;
        assert!((time_on(&trace) - expected).abs() < 1e-4 * expected + 1e-5, "{number}: {}", time_on(&trace));
    }
}

/// A backlash behind an input.
fn with_backlash(builder: PatchBuilder, width: f64) -> Patch {
    let backlash = element("backlash").cord("in", "S").set("width", width);
    builder.element("B", backlash).build().unwrap_or_else(|report| panic!("{report}"))
}

/// The output of a backlash at these times, the first of which is 0 s. `turns` are the turning points of the input.
fn play(input: impl Fn(f64) -> f64, turns: &[f64], width: f64, times: &[f64]) -> Vec<f64> {
    let mut instants: Vec<f64> = turns.iter().chain(times).copied().collect();
    instants.sort_by(f64::total_cmp);
    let mut output = 0.0;
    let mut found = Vec::new();
    for time in instants {
        let pushed = input(time);
        output = f64::clamp(output, pushed - 0.5 * width, pushed + 0.5 * width);
        if times.contains(&time) {
            found.push(output);
        }
    }
    found
}

#[test]
fn a_backlash_reaches_the_turning_points_of_its_input() {
    let (frequency, phase, width) = (0.8, 0.3, 20.0);
    let input = |time: f64| 60.0 * (TAU * frequency * time + phase).sin();
    let turns: Vec<f64> =
        (0..4).map(|turn| ((0.25 + 0.5 * f64::from(turn)) * TAU - phase) / (TAU * frequency)).collect();
    let sine: ElementBuilder =
        element("sine").set("amplitude", 60).set("frequency", frequency).set("phase", phase);
    let patch = with_backlash(volts("play").drive("S", "volt", sine), width);
    let circuit = circuit(&patch, &[]);
    let program = Program::new(&circuit).unwrap();
    let settings = RunSettings::of(&circuit).unwrap().with_duration(2.0).with_sample_interval(0.05);
    let settings = settings.with_signals(["B"]);
    let adaptive = [1e-4, 1e-8, 1e-12].map(|tolerance| settings.clone().with_tolerance(tolerance));
    let equal = Backend::ALL.into_iter().flat_map(|backend| {
        [0.05, 0.01, 0.007, 1e-3].map(|step| settings.clone().with_step(step).with_backend(backend))
    });
    for settings in adaptive.into_iter().chain(equal) {
        let trace = solve::run(&program, &settings).unwrap();
        let expected = play(input, &turns, width, &trace.time);
        for ((time, found), expected) in trace.time.iter().zip(&trace.tracks[0].volts).zip(expected) {
            assert!((found - expected).abs() < 1e-8, "{settings:?}: {found} for {expected} at {time}");
        }
    }
}

/// The input may push for a small part of a step only, and every step is recorded.
#[test]
fn a_backlash_reaches_turning_points_at_any_place_of_a_step() {
    let mut random = SplitMix64(54);
    for _ in 0..40 {
        let (frequency, phase) = (random.uniform(0.5, 3.0), random.uniform(0.0, TAU));
        let (width, step) = (random.uniform(2.0, 60.0), random.uniform(0.002, 0.03));
        let input = |time: f64| 60.0 * (TAU * frequency * time + phase).sin();
        let turns = (0..20).map(|turn| ((0.25 + 0.5 * f64::from(turn)) * TAU - phase) / (TAU * frequency));
        let turns: Vec<f64> = turns.filter(|time| (0.0..2.0).contains(time)).collect();
        let sine = element("sine").set("amplitude", 60).set("frequency", frequency).set("phase", phase);
        let patch = with_backlash(volts("play").drive("S", "volt", sine), width);
        let circuit = circuit(&patch, &[]);
        let program = Program::new(&circuit).unwrap();
        let settings = RunSettings::of(&circuit).unwrap().with_duration(2.0).with_step(step);
        let settings = settings.with_sample_interval(step).with_signals(["B"]);
        for backend in Backend::ALL {
            let trace = solve::run(&program, &settings.clone().with_backend(backend)).unwrap();
            let expected = play(input, &turns, width, &trace.time);
            for ((time, found), expected) in trace.time.iter().zip(&trace.tracks[0].volts).zip(expected) {
                assert!(
                    (found - expected).abs() < 1e-8,
                    "{frequency} Hz, phase {phase}, width {width}, step {step} by {backend}: {found} for {expected} at \
                     {time}"
                );
            }
        }
    }
}

/// The play turns while it is not pushed, and several inputs turn in the same step.
#[test]
fn backlashes_in_a_chain_reach_their_turning_points() {
    let sine = element("sine").set("amplitude", 60).set("frequency", 1).set("phase", json!(0.7));
    let second = element("backlash").cord("in", "B").set("width", 30);
    let patch = volts("chain").drive("S", "volt", sine).element("C", second);
    let patch = with_backlash(patch, 20.0);
    let circuit = circuit(&patch, &[]);
    let program = Program::new(&circuit).unwrap();
    for backend in Backend::ALL {
        let settings = RunSettings::of(&circuit).unwrap().with_duration(3.0).with_step(1.0 / 33.0);
        let settings = settings.with_signals(["B", "C"]).with_backend(backend);
        let trace = solve::run(&program, &settings).unwrap();
        let extremes = [0, 1].map(|track: usize| trace.tracks[track].extremes[0]);
        for (extremes, expected) in extremes.iter().zip([50.0, 35.0]) {
            let found = [-extremes.least.volts, extremes.most.volts];
            assert!(found.iter().all(|found| (found - expected).abs() < 1e-8), "{backend}: {found:?}");
        }
    }
}

/// After a turning point the output is the amplitude less half of the width, so its derivative by the amplitude is 1.
#[test]
fn derivatives_behind_a_backlash_are_exact_after_a_turning_point() {
    let sine = element("sine").set("amplitude", "a").set("frequency", 1);
    let drive = volts("amplitude").parameter("a", 60.0, "V", [10.0, 90.0]).drive("S", "volt", sine);
    let patch = with_backlash(drive, 20.0);
    let circuit = circuit(&patch, &[]);
    let program = Program::new(&circuit).unwrap();
    for step in [1.0 / 22.0, 1.0 / 42.0] {
        let settings = RunSettings::of(&circuit).unwrap().with_duration(0.3).with_step(step);
        let settings = settings.with_signals(["B"]).with_sensitivities(["a"]);
        let trace = solve::run(&program, &settings).unwrap();
        let slope = trace.derivative("B", "a").unwrap().volts.last().unwrap();
        assert!((slope - 1.0).abs() < 1e-9, "{step}: {slope}");
    }
}
