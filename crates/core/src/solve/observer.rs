//! Observers of a machine: who records a run, and who decides when it stops.
//!
//! An observer sees the solver after every accepted step and after the events at its end. On the fast path it sees the
//! kernel instead. It never sees lamps (except to decide whether to stop), event counts or the fast path itself.

use super::fast_path::KernelRun;
use super::lamps::Lamps;
use super::state::Solver;
use crate::kernel::Steps;

/// An observer of the steps of a machine. Times are problem times in seconds.
pub(super) trait StepObserver {
    /// A step was accepted. The solver can interpolate in it; events at its end are not carried out yet.
    fn step_accepted(&mut self, solver: &mut Solver<'_>);

    /// A step has ended, and the events due at its end were carried out.
    fn step_ended(&mut self, solver: &Solver<'_>);

    /// The solver is at an instant at which something jumps, just before the jump.
    fn before_jump(&mut self, _solver: &Solver<'_>) {}

    /// A kernel ran up to a jump at this time. Samples before it may be due.
    fn kernel_reached_jump(&mut self, _time: f64, _tables: &[Vec<[f64; 2]>], _run: &mut KernelRun) {}

    /// A kernel took steps up to this time. Only the last of them may have passed a sample.
    fn kernel_stepped(&mut self, _time: f64, _tables: &[Vec<[f64; 2]>], _run: &mut KernelRun) {}

    /// A kernel took steps up to this time and kept the recorded voltages at the end of each. No sample is within one
    /// of these steps.
    fn kernel_stepped_recording(&mut self, _time: f64, _run: &KernelRun, _steps: Steps) {}

    /// The number of steps, from the first, that end before the first sample within a step.
    fn steps_before_inner_sample(&self, steps: Steps) -> u64 {
        steps.count
    }

    /// The machine left the fast path, and the kernel is where the machine continues.
    fn left_fast_path(&mut self, _run: &KernelRun) {}

    /// The time of the next sample; infinity if there is none.
    fn next_sample(&self) -> f64 {
        f64::INFINITY
    }

    /// Whether the machine has to go into hold at the end of a step, because of the lamps.
    fn should_stop(&self, lamps: &Lamps) -> bool;

    /// Whether the machine has to go into hold at this very instant.
    fn is_phase_over(&self) -> bool {
        false
    }
}

/// An observer that records nothing and never stops the machine.
pub(super) struct NoObserver;

impl StepObserver for NoObserver {
    fn step_accepted(&mut self, _: &mut Solver<'_>) {}

    fn step_ended(&mut self, _: &Solver<'_>) {}

    fn should_stop(&self, _: &Lamps) -> bool {
        false
    }
}
