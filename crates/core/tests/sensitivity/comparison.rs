//! Comparison of derivatives with differences of whole runs.

use patchcord_core::circuit::Circuit;
use patchcord_core::ir::Program;
use patchcord_core::patch::Patch;
use patchcord_core::solve::{self, RunSettings};
use patchcord_core::trace::Trace;

/// A patch with its run settings and the distance of the differences.
pub(super) struct Case {
    /// The patch that is run.
    pub patch: Patch,
    /// Parameter values that differ from those of the patch.
    pub changes: Vec<(&'static str, f64)>,
    /// Settings of every run.
    pub settings: RunSettings,
    /// Relative change of a parameter in the runs for the differences.
    pub relative_step: f64,
}

/// Relative sensitivities below this count as 0: the rounding of runs is larger.
const MIN_RELATIVE_SENSITIVITY: f64 = 1e-3;

/// The largest magnitude.
fn largest(values: &[f64]) -> f64 {
    values.iter().fold(0.0, |most, value| most.max(value.abs()))
}

impl Case {
    /// The patch with its own run settings, for a duration in seconds.
    pub(super) fn new(patch: Patch, changes: &[(&'static str, f64)], duration: f64) -> Self {
        let circuit = crate::common::circuit(&patch, changes);
        let base = RunSettings::of(&circuit).unwrap().with_duration(duration);
        // No sample is at a round time, where events are. A difference there mixes both sides of an event.
        let every = base.every * 1.0123456;
        let settings = base.with_sample_interval(every);
        Case { patch, changes: changes.to_vec(), settings, relative_step: 1e-5 }
    }

    /// The case with changed run settings.
    pub(super) fn with(self, change: impl FnOnce(RunSettings) -> RunSettings) -> Self {
        Case { settings: change(self.settings), ..self }
    }

    fn circuit(&self, more: &[(&str, f64)]) -> Circuit {
        let changes = self.changes.iter().copied();
        crate::common::circuit(&self.patch, &changes.chain(more.iter().copied()).collect::<Vec<_>>())
    }

    fn run(&self, more: &[(&str, f64)], by: &[&str]) -> Trace {
        let program = Program::new(&self.circuit(more)).unwrap_or_else(|report| panic!("{report}"));
        let settings = self.settings.clone().with_sensitivities(by.iter().copied());
        solve::run(&program, &settings).unwrap_or_else(|error| panic!("{error}"))
    }

    /// The run with its derivatives by these parameters.
    pub(super) fn trace(&self, by: &[&str]) -> Trace {
        self.run(&[], by)
    }

    /// Compares every derivative with central differences of runs at two distances (Richardson extrapolation).
    ///
    /// Samples at moving instants, and samples at which the two differences disagree because an event moves across
    /// them, are left out. At least the fraction `min_compared` of all samples must remain.
    pub(super) fn check(&self, by: &[&str], tolerance: f64, min_compared: f64) {
        let exact = self.trace(by);
        for name in by {
            let value = self.circuit(&[]).parameters().find(|(parameter, ..)| parameter == name).unwrap().2;
            let shifted = |change: f64| self.run(&[(*name, value * (1.0 + change))], &[]);
            let step = self.relative_step;
            let runs = [step, -step, 0.5 * step, -0.5 * step].map(shifted);
            let has_fixed_time =
                |sample: usize| runs.iter().all(|run| run.time[sample] == exact.time[sample]);
            assert!(runs.iter().all(|run| run.len() == exact.len()), "{name}");
            for signal in &self.settings.record {
                let values = [0, 1, 2, 3].map(|run| runs[run].values(signal).unwrap());
                let distance = 2.0 * step * value;
                let slopes = |sample: usize| {
                    let wide = (values[0][sample] - values[1][sample]) / distance;
                    [wide, (values[2][sample] - values[3][sample]) / distance * 2.0]
                };
                let found: Vec<f64> = exact.derivative(signal, name).unwrap().values().collect();
                // If a change of one percent alters the signal by less than 1e-5 of its size, rounding dominates.
                let size = largest(&exact.values(signal).unwrap()) / value.abs();
                let allowed = tolerance * largest(&found).max(MIN_RELATIVE_SENSITIVITY * size);
                let comparable = |sample: &usize| {
                    let [wide, narrow] = slopes(*sample);
                    has_fixed_time(*sample) && (narrow - wide).abs() <= 0.5 * allowed
                };
                let samples: Vec<usize> = (0..exact.len()).filter(comparable).collect();
                let name_of_derivative = format!("d {signal} / d {name}");
                for sample in &samples {
                    let [wide, narrow] = slopes(*sample);
                    let extrapolated = narrow + (narrow - wide) / 3.0;
                    let (found, time) = (found[*sample], exact.time[*sample]);
                    assert!(
                        (found - extrapolated).abs() <= allowed,
                        "{name_of_derivative} at {time}: {found}, difference {extrapolated}"
                    );
                }
                let compared = samples.len() as f64 / exact.len() as f64;
                assert!(
                    compared >= min_compared,
                    "{name_of_derivative}: only {compared} of the samples can be compared"
                );
            }
        }
    }
}
