//! Problems whose solution is known independently of this program. Tests and the measurements of benches/performance
//! use them, and docs/problems.md describes them. Every shipped patch is one of them, except those of patches/measured:
//! crates/ident/tests/measured.rs compares these with their equations.

#![allow(dead_code, reason = "no test binary uses all problems and helpers")]

pub(crate) mod closed_form;
pub(crate) mod equations;
pub(crate) mod heat_rod;
pub(crate) mod lessons;
pub(crate) mod others;
pub(crate) mod runs;
pub(crate) mod slideway;
mod stick_slip;
pub(crate) mod thesis;

use crate::common;
use patchcord_core::ir::Program;
use patchcord_core::solve::{self, RunSettings};

/// A patch with the known solution of one of its signals.
#[derive(Debug)]
pub(crate) struct Problem {
    /// Its name in docs/problems.md.
    pub name: &'static str,
    /// The patch, such as "lessons/lorenz".
    pub patch: &'static str,
    /// Parameter values that differ from those of the patch.
    pub changes: &'static [(&'static str, f64)],
    /// The signal whose solution is known.
    pub signal: &'static str,
    /// Duration of the comparison in seconds of problem time.
    pub duration: f64,
    /// Interval between compared samples in seconds.
    pub every: f64,
    /// The known solution of the signal.
    pub solution: Solution,
    /// Bound of the error in machine units, with equal steps of the patch's own length.
    pub max_error: f64,
    /// The main source of the error.
    pub error_source: ErrorSource,
    /// The order of convergence is measured with 8, 4, 2 and 1 times this fraction of the patch's step.
    pub step_factor: f64,
}

/// The main source of a problem's error.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum ErrorSource {
    /// The step: the error is proportional to its fourth power.
    Step,
    /// Rounding, at every step.
    Rounding,
    /// The finite amplification of open amplifiers in the patch. The error is the same at every step and tolerance.
    Amplification,
}

/// The known solution of a signal, in the unit of its scale.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Solution {
    /// A function of time in seconds. It is valid at least at multiples of `every` and at the end of the run.
    ClosedForm(fn(f64) -> f64),
    /// The samples at 0, every, 2 every, ... by integration of the equations in the problem's own units. The arguments
    /// are the duration and `every`; the duration is a multiple of `every`.
    Integrated(fn(f64, f64) -> Vec<f64>),
}

/// Defaults of a problem: the patch's own parameters, and the error of the step.
const DEFAULTS: Problem = Problem {
    name: "",
    patch: "",
    changes: &[],
    signal: "",
    duration: 0.0,
    every: 0.0,
    solution: Solution::ClosedForm(|_| 0.0),
    max_error: 0.0,
    error_source: ErrorSource::Step,
    step_factor: 1.0,
};

/// All problems, in the order of docs/problems.md.
pub(crate) fn all() -> impl Iterator<Item = &'static Problem> {
    closed_form::PROBLEMS.iter().chain(&lessons::PROBLEMS).chain(&thesis::PROBLEMS).chain(&others::PROBLEMS)
}

/// A problem that is ready to run.
pub(crate) struct PreparedProblem {
    name: &'static str,
    pub program: Program,
    /// Settings of a run with the patch's step over the problem's duration. It records the signal.
    pub settings: RunSettings,
    /// The solution at every sample, in the unit of the signal's scale.
    expected: Vec<f64>,
}

impl Problem {
    /// Builds the program, the run settings and the expected samples.
    pub(crate) fn prepare(&self) -> PreparedProblem {
        let circuit = runs::circuit(self.patch, self.changes);
        let settings = runs::recording_settings(&circuit, self.duration, self.every, &[self.signal]);
        PreparedProblem {
            name: self.name,
            program: common::program_of(&circuit),
            settings,
            expected: self.expected(),
        }
    }

    /// The closed solution. Panics if the problem has none.
    pub(crate) fn closed_form(&self) -> fn(f64) -> f64 {
        let Solution::ClosedForm(solution) = self.solution else {
            panic!("{} has no closed solution", self.name)
        };
        solution
    }

    /// The expected value at every sample, in the unit of the signal's scale.
    fn expected(&self) -> Vec<f64> {
        match self.solution {
            Solution::ClosedForm(solution) => {
                let last = (self.duration / self.every * (1.0 + 1e-12)) as usize;
                let times = (0..=last).map(|sample| sample as f64 * self.every);
                // The end of the run is recorded, too.
                let is_end_on_grid = last as f64 * self.every > self.duration * (1.0 - 1e-12);
                times.chain((!is_end_on_grid).then_some(self.duration)).map(solution).collect()
            }
            Solution::Integrated(integrate) => integrate(self.duration, self.every),
        }
    }
}

impl PreparedProblem {
    /// The largest error of a run over all samples, in machine units.
    pub(crate) fn error(&self, settings: &RunSettings) -> f64 {
        let run = solve::run(&self.program, settings);
        let trace = run.unwrap_or_else(|error| panic!("{}: {error}", self.name));
        let track = &trace.tracks[0];
        assert_eq!(track.volts.len(), self.expected.len(), "samples of {}", self.name);
        let error = |(volts, expected): (&f64, &f64)| (volts - expected / track.per_volt) / 100.0;
        runs::peak(&track.volts.iter().zip(&self.expected).map(error).collect::<Vec<_>>())
    }
}
