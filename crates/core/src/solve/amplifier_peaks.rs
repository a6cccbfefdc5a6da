//! The largest output of every amplifier in a run.
//!
//! A kernel computes the rates and the recorded voltages only, and no other outputs. To compute all of them in every step
//! would make the fast path a third slower. So they are read whenever the machine computes all voltages: in initial
//! condition, at changes of mode and jumps, at the ends of phases, at checked steps, and at every step without a kernel.
//! In addition, a run with equal steps leaves the kernel before some steps, which are spread evenly. An output that is
//! recorded counts at every step.

use std::collections::HashMap;

use super::check_plan::CheckPlan;
use crate::ir::{Program, Register};
use crate::trace::{AmplifierPeak, Track};

/// Number of steps before which a run leaves the kernel to read the outputs. Together with the checks of steps, an output
/// that is large for a twentieth of the run is missed in one run of a hundred.
const READINGS: u64 = 64;

/// The largest outputs so far.
#[derive(Debug, Clone)]
pub(super) struct AmplifierPeaks {
    /// Index of the element and register of the output of every amplifier and drive, in the order of the circuit.
    outputs: Vec<(usize, Register)>,
    /// The largest outputs in volts without sign, in the same order.
    largest: Vec<f64>,
    /// The steps before which the outputs are read.
    plan: CheckPlan,
    /// Number of the next of these steps, counted from 1 in the present phase.
    next: u64,
}

impl AmplifierPeaks {
    /// The peaks before a run that takes `run_steps` equal steps if no phase ends early.
    pub(super) fn new(program: &Program, run_steps: u64) -> Self {
        let lowered = &program.lowered;
        let without_state = lowered.lamps.iter().map(|lamp| lamp.element);
        let mut elements: Vec<usize> =
            without_state.chain(lowered.states.iter().map(|state| state.element)).collect();
        elements.sort_unstable();
        let output = |element: usize| (element, lowered.elements[element].register);
        let outputs: Vec<_> = elements.into_iter().map(output).collect();
        let largest = vec![0.0; outputs.len()];
        AmplifierPeaks { outputs, largest, plan: CheckPlan::with_checks(run_steps, READINGS), next: u64::MAX }
    }

    /// Plans the readings of a phase with this number of steps.
    pub(super) fn begin_phase(&mut self, steps: u64) {
        self.plan.begin_phase(steps);
        self.next = self.plan.next();
    }

    /// Number of steps before the next reading, if the next step has this number in the present phase.
    pub(super) fn steps_before(&self, next_step: u64) -> u64 {
        self.next.saturating_sub(next_step)
    }

    /// Plans the first reading after the step with this number in the present phase.
    pub(super) fn advance(&mut self, step: u64) {
        self.plan.advance(step);
        self.next = self.plan.next();
    }

    /// Includes the outputs among these voltages, which are those of all registers.
    pub(super) fn observe(&mut self, voltages: &[f64]) {
        for (largest, (_, register)) in self.largest.iter_mut().zip(&self.outputs) {
            *largest = largest.max(voltages[register.index()].abs());
        }
    }

    /// The peaks of the run. `recorded` has the recorded outputs with their tracks, whose extremes include every step.
    pub(super) fn with_recorded<'a>(
        &self,
        program: &Program,
        recorded: impl Iterator<Item = (Register, &'a Track)>,
    ) -> Vec<AmplifierPeak> {
        let recorded: HashMap<usize, f64> =
            recorded.map(|(register, track)| (register.index(), largest_of(track))).collect();
        let outputs = self.outputs.iter().zip(&self.largest);
        let peak = |((element, register), observed): (&(usize, Register), &f64)| AmplifierPeak {
            element: program.name(*element).to_owned(),
            volts: recorded.get(&register.index()).map_or(*observed, |volts| volts.max(*observed)),
        };
        outputs.map(peak).collect()
    }
}

/// The largest voltage of a track in all repetitions, in volts without sign.
fn largest_of(track: &Track) -> f64 {
    let ends = track.extremes.iter().flat_map(|extremes| [extremes.least.volts, extremes.most.volts]);
    ends.fold(0.0, |largest, volts| largest.max(volts.abs()))
}
