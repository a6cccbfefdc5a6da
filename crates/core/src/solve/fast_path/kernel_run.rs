//! A kernel on the variables of one machine: start, steps, corners, and the voltages that it records.

use std::mem;

use super::KernelRun;
use super::trial::KernelTrial;
use crate::delay_line::DelayLine;
use crate::ir::Program;
use crate::kernel::{LookResult, Steps, WatchHit};
use crate::solve::dense_output::hermite;
use crate::solve::state::SolverState;
use crate::trace::WorkCounters;

impl KernelRun {
    /// Takes over the state and the delay lines of a machine. Returns whether the kernel is valid there. If not, the
    /// delay lines are returned.
    pub(super) fn start(
        &mut self,
        program: &Program,
        state: &SolverState,
        delay_lines: &mut Vec<DelayLine>,
    ) -> bool {
        self.swap_delay_lines(delay_lines);
        let is_valid = self.begin(program, state);
        if !is_valid {
            self.swap_delay_lines(delay_lines);
        }
        is_valid
    }

    /// Copies the state of a machine into the frame and evaluates it. Returns whether the kernel is valid there.
    fn begin(&mut self, program: &Program, state: &SolverState) -> bool {
        let (kernel, frame) = (&self.shared.kernel, &mut self.frame);
        frame.set_held_inputs(kernel, &state.sampled, &state.levels);
        frame.states.copy_from_slice(&state.states);
        frame.rates.copy_from_slice(&state.rates);
        frame.time = state.time;
        // Recorded extremes are kept, because in a ramp each new one costs a search for its step.
        if self.has_outdated_factors || self.has_outdated_extremes {
            frame.reset_extremes();
        } else {
            frame.keep_extremes();
        }
        let is_valid = kernel.settle(frame, program, &state.coefficients, self.has_outdated_factors);
        (self.has_outdated_factors, self.has_outdated_extremes) = (!is_valid, false);
        is_valid
    }

    /// Exchanges the delay lines of the frame with those of a machine.
    fn swap_delay_lines(&mut self, delay_lines: &mut Vec<DelayLine>) {
        mem::swap(&mut self.frame.lines[0], delay_lines);
    }

    /// Returns time, states, sampled values and delay lines to a machine.
    pub(super) fn return_state(&mut self, state: &mut SolverState, delay_lines: &mut Vec<DelayLine>) {
        self.swap_delay_lines(delay_lines);
        state.time = self.frame.time;
        state.states.copy_from_slice(&self.frame.states);
        state.sampled.copy_from_slice(self.frame.sampled(&self.shared.kernel));
    }

    /// Crosses the corner at which the kernel is, and evaluates everything on the other side. Returns whether the
    /// kernel is valid there.
    pub(super) fn cross_corner(&mut self, program: &Program, coefficients: &[f64], hit: WatchHit) -> bool {
        let KernelRun { shared, frame, .. } = self;
        let are_factors_valid = shared.kernel.switch_branch(frame, program, coefficients, hit);
        self.evaluate_present(&program.tables);
        let KernelRun { shared, frame, .. } = self;
        let is_valid = shared.kernel.accept_present(frame) && are_factors_valid;
        // A state that a limit holds from now on is exactly at the limit only after the corner.
        shared.kernel.observe_present(frame);
        self.has_outdated_factors = !is_valid;
        is_valid
    }

    /// A step of the kernel that was not tried yet. `work` counts its evaluations.
    #[inline]
    pub(super) fn trial<'a>(
        &'a mut self,
        tables: &'a [Vec<[f64; 2]>],
        work: &'a mut WorkCounters,
    ) -> KernelTrial<'a> {
        let KernelRun { shared, frame, backend, .. } = self;
        KernelTrial { shared, backend: *backend, frame, tables, work, last: LookResult::Quiet }
    }

    /// Takes steps of a grid until an event is due in the next one, and returns the number of steps taken. If
    /// `has_trail`, the recorded voltages at the end of each step are stored.
    pub(super) fn steps(&mut self, tables: &[Vec<[f64; 2]>], steps: &Steps, has_trail: bool) -> u64 {
        self.frame.record_trail(has_trail);
        self.shared.steps(&mut self.frame, tables, steps, self.backend)
    }

    /// The problem time in seconds.
    pub(crate) fn time(&self) -> f64 {
        self.frame.time
    }

    /// Evaluates the recorded voltages at a problem time within the last step, by the cubic through its ends.
    pub(crate) fn interpolate(&mut self, tables: &[Vec<[f64; 2]>], time: f64) {
        let (kernel, frame) = (&self.shared.kernel, &mut self.frame);
        let [begin, length] = kernel.last_step(frame);
        kernel.set_past_inputs(frame, tables, time, hermite(length, (time - begin) / length));
        self.shared.evaluate(frame, tables, self.backend);
    }

    /// Evaluates the recorded voltages at the present time and states.
    pub(crate) fn evaluate_present(&mut self, tables: &[Vec<[f64; 2]>]) {
        self.shared.kernel.set_present_inputs(&mut self.frame, tables);
        self.shared.evaluate(&mut self.frame, tables, self.backend);
    }

    /// The recorded voltages at the end of one of the steps taken last, which were stored. Steps count from 0.
    pub(crate) fn voltages_after(&self, step: u64) -> impl Iterator<Item = f64> + '_ {
        let kernel = &self.shared.kernel;
        (0..kernel.recorded.len()).map(move |index| self.frame.recorded_after(kernel, step, index))
    }

    /// The recorded voltages at the instant that was evaluated last, in volts, in the order of the tracks.
    pub(crate) fn voltages(&self) -> impl Iterator<Item = f64> + '_ {
        let kernel = &self.shared.kernel;
        (0..kernel.recorded.len()).map(|index| self.frame.last_recorded(kernel, index))
    }

    /// The minimum and the maximum of every recorded voltage that the kernel has met since the initial condition, each as
    /// problem time and volts, in order of time. The time is infinite if it was not exceeded since the kernel was
    /// entered. `None` for a voltage that is constant or linear in time.
    pub(crate) fn extremes(&self) -> impl Iterator<Item = Option<[(f64, f64); 2]>> + '_ {
        let kernel = &self.shared.kernel;
        (0..kernel.recorded.len()).map(|index| self.frame.extremes(kernel, index))
    }
}
