//! The largest outputs of all amplifiers in a run, recorded or not.

use crate::common::{built, element, program_of, slideway, volts};
use patchcord_core::circuit::Circuit;
use patchcord_core::ir::Program;
use patchcord_core::solve::{Phase, RunSettings, run};
use patchcord_core::trace::Trace;

/// A = 3 cos 2t and B = -3 sin 2t, in volts. The summer S is -10 B.
fn oscillator() -> Program {
    built(
        volts("oscillator")
            .element("A", element("integrator").cords("x2", ["N"]).set("initial", 3))
            .element("B", element("integrator").cords("x2", ["A"]))
            .element("N", element("inverter").cord("in", "B"))
            .element("S", element("summer").cords("x10", ["B"])),
    )
}

/// Settings of a run over some seconds that finds the peaks and records these signals.
fn settings(seconds: f64, signals: &[&str]) -> RunSettings {
    let phases = [Phase::InitialCondition, Phase::operate(seconds)];
    RunSettings::from_phases(phases, 1e-3).with_signals(signals.iter().copied()).with_amplifier_peaks()
}

fn run_with(program: &Program, settings: &RunSettings) -> Trace {
    run(program, settings).unwrap_or_else(|stopped| panic!("{}", stopped.error))
}

#[test]
fn a_long_run_finds_the_peaks_of_outputs_that_are_not_recorded() {
    let trace = run_with(&oscillator(), &settings(50.0, &[]));
    let amplitudes = [("A", 3.0), ("B", 3.0), ("N", 3.0), ("S", 30.0)];
    assert_eq!(trace.amplifier_peaks.len(), amplitudes.len());
    for (peak, (name, amplitude)) in trace.amplifier_peaks.iter().zip(amplitudes) {
        assert_eq!(peak.element, name);
        let share = peak.volts / amplitude;
        assert!((0.97..1.0 + 1e-9).contains(&share), "{peak:?}");
    }
}

#[test]
fn a_recorded_output_counts_at_every_step() {
    let trace = run_with(&oscillator(), &settings(50.0, &["S"]));
    let extremes = trace.tracks[0].extremes[0];
    let largest = extremes.most.volts.max(-extremes.least.volts);
    let found = trace.amplifier_peaks.iter().find(|peak| peak.element == "S").unwrap();
    assert_eq!(found.volts, largest);
}

#[test]
fn all_repetitions_count_and_the_run_is_the_same() {
    let program = oscillator();
    // The first repetition ends before B grows, the second after a quarter of a period.
    let phases = [0.01, 0.8].map(|seconds| [Phase::InitialCondition, Phase::operate(seconds)]).concat();
    let with = RunSettings::from_phases(phases, 1e-3).with_signals(["A"]).with_amplifier_peaks();
    let found = run_with(&program, &with);
    assert!((found.amplifier_peaks[1].volts - 3.0).abs() < 0.01, "{:?}", found.amplifier_peaks);
    let mut plain = with;
    plain.finds_amplifier_peaks = false;
    let without = run_with(&program, &plain);
    assert!(without.amplifier_peaks.is_empty());
    assert_eq!(
        (found.time, found.tracks, found.repetitions),
        (without.time, without.tracks, without.repetitions)
    );
}

#[test]
fn the_peaks_of_the_slideway_are_near_those_of_all_steps() {
    let circuit = Circuit::new(&slideway()).unwrap();
    let program = program_of(&circuit);
    let settings = RunSettings::of(&circuit).unwrap().with_signals(["v_o"]).with_amplifier_peaks();
    let sampled = run_with(&program, &settings).amplifier_peaks;
    let names: Vec<&str> = sampled.iter().map(|peak| peak.element.as_str()).collect();
    let every_step = run_with(&program, &settings.clone().with_signals(names));
    for (sampled, exact) in sampled.iter().zip(&every_step.amplifier_peaks) {
        assert!(sampled.volts <= exact.volts + 1e-6, "{sampled:?} {exact:?}");
        // The 64 planned readings alone reach 0.777 of the peak of A2, and more of all others.
        assert!(sampled.volts >= 0.77 * exact.volts, "{sampled:?} {exact:?}");
    }
    // The position error is much smaller than full scale.
    let error = every_step.amplifier_peaks.iter().find(|peak| peak.element == "A6").unwrap();
    assert!((0.5..1.0).contains(&error.volts), "{error:?}");
}
