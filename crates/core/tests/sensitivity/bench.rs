//! What the tests share: derivatives held against differences of whole runs.

use patchcord_core::circuit::Circuit;
use patchcord_core::ir::Program;
use patchcord_core::patch::Patch;
use patchcord_core::solve::{self, RunSettings};
use patchcord_core::trace::Trace;

/// A patch, how it is run, and by what it is differentiated.
pub struct Case {
    pub patch: Patch,
    pub changes: Vec<(&'static str, f64)>,
    pub settings: RunSettings,
    /// Share of a parameter by which the runs beside it differ.
    pub share: f64,
}

/// Relative sensitivities below this are not told apart from 0.
const LEAST: f64 = 1e-3;

fn largest(values: &[f64]) -> f64 {
    values.iter().fold(0.0, |most, value| most.max(value.abs()))
}

impl Case {
    /// The patch as it runs by itself, for a time.
    pub fn new(patch: Patch, changes: &[(&'static str, f64)], duration: f64) -> Self {
        let circuit = crate::common::circuit(&patch, changes);
        let own = RunSettings::of(&circuit).unwrap().lasting(duration);
        // No sample falls on an event that stands at a round time: differences there are of both sides.
        let settings = RunSettings { every: own.every * 1.0123456, ..own };
        Case { patch, changes: changes.to_vec(), settings, share: 1e-5 }
    }

    pub fn with(self, change: impl FnOnce(RunSettings) -> RunSettings) -> Self {
        Case { settings: change(self.settings), ..self }
    }

    fn circuit(&self, more: &[(&str, f64)]) -> Circuit {
        let own = self.changes.iter().copied();
        crate::common::circuit(&self.patch, &own.chain(more.iter().copied()).collect::<Vec<_>>())
    }

    fn run(&self, more: &[(&str, f64)], by: &[&str]) -> Trace {
        let program = Program::new(&self.circuit(more)).unwrap_or_else(|report| panic!("{report}"));
        let sensitivities = by.iter().map(|name| (*name).to_owned()).collect();
        let settings = RunSettings { sensitivities, ..self.settings.clone() };
        solve::run(&program, &settings).unwrap_or_else(|error| panic!("{error}"))
    }

    /// The run with its derivatives.
    pub fn trace(&self, by: &[&str]) -> Trace {
        self.run(&[], by)
    }

    /// Holds every derivative against central differences of runs at two distances (Richardson). Samples where the
    /// two differ by more than they may stand beside an event that moves across them, and those that stand at a moving
    /// instant tell another thing; this share of all has to be left.
    pub fn check(&self, by: &[&str], tolerance: f64, left: f64) {
        let exact = self.trace(by);
        for name in by {
            let value = self.circuit(&[]).parameters().find(|(own, ..)| own == name).unwrap().2;
            let near = |share: f64| self.run(&[(*name, value * (1.0 + share))], &[]);
            let beside = [self.share, -self.share, 0.5 * self.share, -0.5 * self.share].map(near);
            let fixed = |sample: usize| beside.iter().all(|run| run.time[sample] == exact.time[sample]);
            assert!(beside.iter().all(|run| run.len() == exact.len()), "{name}");
            for signal in &self.settings.record {
                let values = [0, 1, 2, 3].map(|run| beside[run].values(signal).unwrap());
                let distance = 2.0 * self.share * value;
                let slopes = |sample: usize| {
                    let wide = (values[0][sample] - values[1][sample]) / distance;
                    [wide, (values[2][sample] - values[3][sample]) / distance * 2.0]
                };
                let found: Vec<f64> = exact.derivative(signal, name).unwrap().values().collect();
                // Where a percent changes less than a hundred-thousandth, the rounding of runs counts.
                let size = largest(&exact.values(signal).unwrap()) / value.abs();
                let allowed = tolerance * largest(&found).max(LEAST * size);
                let comparable = |sample: &usize| {
                    let [wide, narrow] = slopes(*sample);
                    fixed(*sample) && (narrow - wide).abs() <= 0.5 * allowed
                };
                let samples: Vec<usize> = (0..exact.len()).filter(comparable).collect();
                let told = format!("d {signal} / d {name}");
                for sample in &samples {
                    let [wide, narrow] = slopes(*sample);
                    let better = narrow + (narrow - wide) / 3.0;
                    let (found, time) = (found[*sample], exact.time[*sample]);
                    assert!((found - better).abs() <= allowed, "{told} at {time}: {found} and not {better}");
                }
                let share = samples.len() as f64 / exact.len() as f64;
                assert!(share >= left, "{told}: only {share} of the samples can be compared");
            }
        }
    }
}
