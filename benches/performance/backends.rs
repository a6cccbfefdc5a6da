//! The backends of patchcord, and runs of Fig 8.16 on them.

use crate::known_problems::runs;
use crate::timing::timed;
use crate::{Outcome, common};
use patchcord::circuit::Circuit;
use patchcord::ir::Program;
use patchcord::solve::{self, RunSettings};
use patchcord::trace::Trace;

/// A backend: its name in the tables, and the function that selects it in the settings of a run.
pub(crate) type BackendChoice = (&'static str, fn(RunSettings) -> RunSettings);

/// The backends of single runs. CONTRIBUTING.md says to add a new backend here.
pub(crate) const BACKENDS: [BackendChoice; 3] = [
    ("reference", |settings| with(settings, solve::Backend::Reference)),
    ("interpreter", |settings| with(settings, solve::Backend::Interpreter)),
    ("native", |settings| with(settings, solve::Backend::Native)),
];

/// The backends of sweeps.
pub(crate) const BACKENDS_OF_SWEEPS: [BackendChoice; 5] = [
    BACKENDS[0],
    BACKENDS[1],
    BACKENDS[2],
    ("lanes", |settings| with(settings, solve::Backend::Lanes)),
    ("automatic", |settings| with(settings, solve::Backend::Automatic)),
];

/// The settings with another backend.
fn with(settings: RunSettings, backend: solve::Backend) -> RunSettings {
    settings.with_backend(backend)
}

/// The choice of the step.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Steps {
    /// Equal steps of this length in s.
    Equal(f64),
    /// Variable steps with this tolerance in machine units.
    Tolerance(f64),
}

/// The circuit of Fig 8.16 and its program. The program stores its kernels, so runs after the first need not make them.
pub(crate) struct Fig816 {
    pub circuit: Circuit,
    pub program: Program,
    settings: RunSettings,
}

/// Duration in s over which results are compared: the first two seconds of the run.
pub(crate) const COMPARED: f64 = 2.0;
/// Compared samples, one every 1 ms. The sample at the end of the duration is excluded.
pub(crate) const SAMPLES: usize = 2000;
/// Step of the reference in s. Its error is about 1e-10 of the peak.
pub(crate) const REFERENCE_STEP: f64 = 2.5e-6;

impl Fig816 {
    /// Reads the shipped patch.
    pub(crate) fn read() -> Fig816 {
        let circuit = runs::circuit("thesis/fig-8-16", &[]);
        let settings = runs::settings(&circuit);
        Fig816 { program: common::program_of(&circuit), circuit, settings }
    }

    /// The settings of the patch's whole run, with these steps.
    pub(crate) fn settings(&self, steps: Steps) -> RunSettings {
        let settings = self.settings.clone();
        match steps {
            Steps::Equal(step) => settings.with_step(step),
            Steps::Tolerance(tolerance) => settings.with_tolerance(tolerance),
        }
    }

    /// Duration of a run in s, and its trace.
    pub(crate) fn run(&self, settings: &RunSettings) -> Outcome<(f64, Trace)> {
        run_timed(&self.program, settings)
    }

    /// Duration and trace of the first run of a new program. It includes specialising and compiling.
    pub(crate) fn run_first(&self, settings: &RunSettings) -> Outcome<(f64, Trace)> {
        run_timed(&Program::new(&self.circuit)?, settings)
    }

    /// The settings of a run over the compared duration that records only the output velocity.
    pub(crate) fn compared_settings(&self, steps: Steps) -> RunSettings {
        self.settings(steps).with_duration(COMPARED).with_signals(["v_o"])
    }

    /// The reference: the output velocity by the reference step, at the compared samples.
    pub(crate) fn reference(&self) -> Outcome<Vec<f64>> {
        let (_, trace) = self.run(&self.compared_settings(Steps::Equal(REFERENCE_STEP)))?;
        // Some libraries return no usable value at the last instant.
        Ok(velocity(&trace)[..SAMPLES].to_vec())
    }
}

/// Duration of a run of a program in s, and its trace.
pub(crate) fn run_timed(program: &Program, settings: &RunSettings) -> Outcome<(f64, Trace)> {
    let (seconds, trace) = timed(|| solve::run(program, settings));
    Ok((seconds, trace?))
}

/// The output velocity of a trace. Empty if it is not recorded.
pub(crate) fn velocity(trace: &Trace) -> Vec<f64> {
    trace.values("v_o").unwrap_or_default()
}

/// The tried equal steps as numbers of steps per millisecond: from 2 to 2000, each about 1.1 times the one before.
pub(crate) fn steps_per_millisecond() -> impl Iterator<Item = u32> {
    std::iter::successors(Some(2u32), |count| Some((1.1 * f64::from(*count)).ceil() as u32))
        .take_while(|count| *count <= 2000)
}

/// The largest difference between two sequences as a share of the reference's peak.
///
/// Samples after the end of the reference are ignored. The error is infinite if samples are missing or are NaN.
pub(crate) fn error(found: &[f64], reference: &[f64]) -> f64 {
    if found.len() < reference.len() {
        return f64::INFINITY;
    }
    found.iter().zip(reference).fold(0.0f64, |worst, (value, expected)| {
        let error = (value - expected).abs();
        if error.is_nan() { f64::INFINITY } else { worst.max(error) }
    }) / runs::peak(reference)
}
