//! patchcord's own runs of Fig 8.16.

use crate::clock::timed;
use crate::known::runs;
use crate::{Outcome, common};
use patchcord::circuit::Circuit;
use patchcord::ir::Program;
use patchcord::solve::{self, RunSettings};
use patchcord::trace::Trace;

/// A way of running a program: its name, and how it is asked for.
pub type Backend = (&'static str, fn(RunSettings) -> RunSettings);

/// Every way that there is for a run alone.
pub const BACKENDS: [Backend; 3] = [
    ("reference", |settings| with(settings, solve::Backend::Reference)),
    ("interpreter", |settings| with(settings, solve::Backend::Interpreter)),
    ("native", |settings| with(settings, solve::Backend::Native)),
];

/// Every way that there is for many.
pub const BACKENDS_OF_SWEEPS: [Backend; 5] = [
    BACKENDS[0],
    BACKENDS[1],
    BACKENDS[2],
    ("lanes", |settings| with(settings, solve::Backend::Lanes)),
    ("automatic", |settings| with(settings, solve::Backend::Automatic)),
];

fn with(settings: RunSettings, backend: solve::Backend) -> RunSettings {
    RunSettings { backend, ..settings }
}

/// How long a step is chosen.
#[derive(Debug, Clone, Copy)]
pub enum Steps {
    Equal(f64),
    Tolerance(f64),
}

/// The circuit and its program, of which the kernels are kept: runs after the first find them made.
pub struct Fig816 {
    pub circuit: Circuit,
    pub program: Program,
    settings: RunSettings,
}

/// The peak-scaled error is looked at over this time, in seconds.
pub const COMPARED: f64 = 2.0;
/// Samples in it, every 1 ms.
pub const SAMPLES: usize = 2000;
/// Steps of the reference, in seconds.
pub const REFERENCE: f64 = 2.5e-6;

impl Fig816 {
    pub fn read() -> Fig816 {
        let circuit = runs::circuit("thesis/fig-8-16", &[]);
        let settings = runs::settings(&circuit);
        Fig816 { program: common::program_of(&circuit), circuit, settings }
    }

    /// The whole run as the patch asks for it, with these steps.
    pub fn settings(&self, steps: Steps) -> RunSettings {
        let settings = self.settings.clone();
        match steps {
            Steps::Equal(step) => RunSettings { step, ..settings },
            Steps::Tolerance(tolerance) => RunSettings { tolerance: Some(tolerance), ..settings },
        }
    }

    /// Seconds that a run takes, and its record.
    pub fn run(&self, settings: &RunSettings) -> Outcome<(f64, Trace)> {
        ran(&self.program, settings)
    }

    /// The same of a program that nothing has run yet: folding and compiling are part of it.
    pub fn run_afresh(&self, settings: &RunSettings) -> Outcome<(f64, Trace)> {
        ran(&Program::new(&self.circuit)?, settings)
    }

    /// Output velocity over the first seconds, recorded alone.
    pub fn compared(&self, steps: Steps) -> RunSettings {
        RunSettings { record: vec!["v_o".to_owned()], ..self.settings(steps).lasting(COMPARED) }
    }

    /// The output velocity that all are compared with.
    pub fn reference(&self) -> Outcome<Vec<f64>> {
        let (_, trace) = self.run(&self.compared(Steps::Equal(REFERENCE)))?;
        // At the last instant itself some libraries give no number that could be used.
        Ok(velocity(&trace)[..SAMPLES].to_vec())
    }
}

/// Seconds that a run of any program takes, and its record.
pub fn ran(program: &Program, settings: &RunSettings) -> Outcome<(f64, Trace)> {
    let (seconds, trace) = timed(|| solve::run(program, settings));
    Ok((seconds, trace?))
}

/// Output velocity of a record.
pub fn velocity(trace: &Trace) -> Vec<f64> {
    trace.values("v_o").unwrap_or_default()
}

/// Parts of a millisecond that are tried as equal steps, from half of one on, each about 1.1 times as fine as the one before.
pub fn rungs() -> impl Iterator<Item = u32> {
    std::iter::successors(Some(2u32), |parts| Some((1.1 * f64::from(*parts)).ceil() as u32))
        .take_while(|parts| *parts <= 2000)
}

/// The largest difference as a share of the reference's peak; what is longer is not looked at, what is shorter is as wrong
/// as can be.
pub fn error(found: &[f64], reference: &[f64]) -> f64 {
    if found.len() < reference.len() {
        return f64::INFINITY;
    }
    found.iter().zip(reference).fold(0.0f64, |worst, (one, other)| {
        let off = (one - other).abs();
        // A solver that gave no number is as wrong as can be.
        if off.is_nan() { f64::INFINITY } else { worst.max(off) }
    }) / runs::peak(reference)
}
