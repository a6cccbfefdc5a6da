//! Problems of which is known, apart from this program, what they do: for tests, and for the measurements of
//! benches/performance; told in docs/problems.md. Every patch that comes with the program is one of them,
//! but for those of patches/measured, which crates/ident/tests/measured.rs holds against their equations.

#![allow(dead_code, reason = "tests and measurements take what they need")]

pub mod closed;
pub mod equations;
pub mod heat_rod;
pub mod lessons;
pub mod others;
pub mod runs;
pub mod slideway;
mod stick_slip;
pub mod thesis;

use crate::common;
use patchcord_core::ir::Program;
use patchcord_core::solve::{self, RunSettings};

/// A patch, and what one of its signals does.
#[derive(Debug)]
pub struct Problem {
    /// What it is called in docs/problems.md.
    pub name: &'static str,
    /// The patch, such as "lessons/lorenz".
    pub patch: &'static str,
    /// Parameters that are set otherwise than in the patch.
    pub changes: &'static [(&'static str, f64)],
    /// The signal that is known.
    pub signal: &'static str,
    /// How long it is looked at, in seconds, and how often.
    pub duration: f64,
    pub every: f64,
    /// What it does.
    pub known: Known,
    /// Equal steps as long as the patch asks for err by less than that, in machine units.
    pub within: f64,
    /// What these errors come from.
    pub left: Left,
    /// The order shows on steps of 8, 4, 2 and 1 times so much of the patch's step.
    pub ladder: f64,
}

/// What errors come from.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Left {
    /// The step, with its fourth power.
    Step,
    /// Rounding, at any step.
    Rounding,
    /// The patch: amplifications are finite, which leaves the same error at any step and tolerance.
    Amplification,
}

/// What a signal does, in the unit of its scale.
#[derive(Debug, Clone, Copy)]
pub enum Known {
    /// At a time, in closed form; at multiples of `every` at least.
    Closed(fn(f64) -> f64),
    /// At 0, every, 2 every, ... for a duration that is a multiple of it, by stepping the equations in the problem's own units.
    Stepped(fn(f64, f64) -> Vec<f64>),
}

/// A patch as it stands, with the error of its steps.
const USUAL: Problem = Problem {
    name: "",
    patch: "",
    changes: &[],
    signal: "",
    duration: 0.0,
    every: 0.0,
    known: Known::Closed(|_| 0.0),
    within: 0.0,
    left: Left::Step,
    ladder: 1.0,
};

/// All of them.
pub fn all() -> impl Iterator<Item = &'static Problem> {
    closed::PROBLEMS.iter().chain(&lessons::PROBLEMS).chain(&thesis::PROBLEMS).chain(&others::PROBLEMS)
}

/// A problem that can be run: its program, a run over the problem's time, and what has to come out.
pub struct Ready {
    name: &'static str,
    pub program: Program,
    pub settings: RunSettings,
    expected: Vec<f64>,
}

impl Problem {
    pub fn ready(&self) -> Ready {
        let circuit = runs::circuit(self.patch, self.changes);
        let settings = runs::recording(&circuit, self.duration, self.every, &[self.signal]);
        Ready { name: self.name, program: common::program_of(&circuit), settings, expected: self.expected() }
    }

    /// The solution of a problem that has one in closed form.
    pub fn closed(&self) -> fn(f64) -> f64 {
        let Known::Closed(solution) = self.known else { panic!("{} has no closed solution", self.name) };
        solution
    }

    /// The signal at every sample.
    fn expected(&self) -> Vec<f64> {
        match self.known {
            Known::Closed(solution) => {
                let last = (self.duration / self.every * (1.0 + 1e-12)) as usize;
                (0..=last).map(|sample| solution(sample as f64 * self.every)).collect()
            }
            Known::Stepped(course) => course(self.duration, self.every),
        }
    }
}

impl Ready {
    /// The largest error of a run over all samples, in machine units.
    pub fn error(&self, settings: &RunSettings) -> f64 {
        let run = solve::run(&self.program, settings);
        let trace = run.unwrap_or_else(|error| panic!("{}: {error}", self.name));
        let found = &trace.tracks[0];
        assert_eq!(found.volts.len(), self.expected.len(), "samples of {}", self.name);
        let off = |(volts, expected): (&f64, &f64)| (volts - expected / found.per_volt) / 100.0;
        runs::peak(&found.volts.iter().zip(&self.expected).map(off).collect::<Vec<_>>())
    }
}
