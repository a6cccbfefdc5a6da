//! Observers of a machine: they record a run and decide when it stops.
//!
//! The machine calls an observer after every accepted step and after the events at its end. Without the fast path the
//! observer reads the solver, and on the fast path the kernel. The calls of a step come in this order: `step_accepted`,
//! `before_jump` if a voltage jumps, `step_ended`. [`Recorder`](super::recorder::Recorder) is the observer of a run.

use super::fast_path::KernelRun;
use super::lamps::Lamps;
use super::state::Solver;
use crate::kernel::Steps;

/// An observer of the steps of a machine. Times are problem times in seconds.
pub(super) trait StepObserver {
    /// A step was accepted. The solver can interpolate in it. Events at its end have not been handled yet.
    fn step_accepted(&mut self, solver: &mut Solver<'_>);

    /// A step has ended, and the events due at its end have been handled.
    fn step_ended(&mut self, solver: &Solver<'_>);

    /// The solver is at an instant at which something jumps, just before the jump.
    fn before_jump(&mut self, _solver: &Solver<'_>) {}

    /// A kernel ran up to a jump at this time. Samples before the jump may be due.
    fn kernel_reached_jump(&mut self, _time: f64, _tables: &[Vec<[f64; 2]>], _run: &mut KernelRun) {}

    /// A kernel took steps up to this time. The times of samples that are due are within the last of them or at its
    /// end.
    fn kernel_stepped(&mut self, _time: f64, _tables: &[Vec<[f64; 2]>], _run: &mut KernelRun) {}

    /// A kernel is at a corner of a diode or a table at this time, before it crosses it.
    fn kernel_at_corner(&mut self, _time: f64, _tables: &[Vec<[f64; 2]>], _run: &mut KernelRun) {}

    /// A kernel took these steps up to this time, and stored the recorded voltages at the end of each. Samples are due
    /// at ends of steps only.
    fn kernel_stepped_recording(&mut self, _time: f64, _run: &KernelRun, _steps: Steps) {}

    /// The number of steps, from the first, that come before the first step with a sample strictly inside it.
    fn steps_before_inner_sample(&self, steps: Steps) -> u64 {
        steps.count
    }

    /// The machine leaves the fast path. The kernel is at the instant at which the machine continues, and has the
    /// extremes since the initial condition. Their times are infinite if it has not exceeded them since it was entered.
    fn left_fast_path(&mut self, _run: &KernelRun) {}

    /// The time of the next sample; infinity if there is none.
    fn next_sample(&self) -> f64 {
        f64::INFINITY
    }

    /// Whether the machine has to go into hold at the end of a whole step, because a lamp is lit or the run is cancelled.
    fn should_stop(&self, lamps: &Lamps) -> bool;

    /// Whether the run is cancelled. A kernel then halts.
    fn is_cancelled(&self) -> bool {
        false
    }

    /// Whether the machine has to go into hold at the present instant, also within a step of the grid.
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
