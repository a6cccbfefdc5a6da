//! A program together with a run of it. The run borrows the program, so both are in one cell.

use std::sync::Arc;

use patchcord_core::ir::Program;
use patchcord_core::solve::{Checkpoint, LiveRun, RunError, RunSettings};
use self_cell::self_cell;

use crate::limits::MAX_CHECKPOINT_BYTES;

/// Largest number of checkpoints of a run.
const MAX_CHECKPOINTS: usize = 32;

self_cell!(
    /// A program and its run.
    pub(super) struct LiveMachine {
        owner: Arc<Program>,
        #[not_covariant]
        dependent: Live,
    }
);

/// A run with instants to which it can return.
pub(super) struct Live<'p> {
    /// The run.
    pub run: LiveRun<'p>,
    /// Checkpoints since the last initial condition, in order of time.
    checkpoints: Vec<Checkpoint<'p>>,
    /// Least time between two checkpoints, in seconds.
    interval: f64,
    /// The times since the last initial condition at which a user changed something, in seconds, ascending.
    changes: Vec<f64>,
}

/// Makes a machine in initial condition.
///
/// # Errors
/// If the run cannot begin.
pub(super) fn live_machine(program: &Arc<Program>, settings: &RunSettings) -> Result<LiveMachine, RunError> {
    let interval = settings.duration() / MAX_CHECKPOINTS as f64;
    LiveMachine::try_new(Arc::clone(program), |program| {
        let run = LiveRun::new(program, settings)?;
        Ok(Live { run, checkpoints: Vec::new(), interval, changes: Vec::new() })
    })
}

/// Lets a machine in initial condition continue the run of another one.
///
/// # Errors
/// If the voltages cannot be evaluated with the states of the other one. The machine stays in initial condition then.
pub(super) fn continue_run(machine: &mut LiveMachine, mut other: LiveMachine) -> Result<(), RunError> {
    machine
        .with_dependent_mut(|_, new| other.with_dependent_mut(|_, old| new.run.continue_from(&mut old.run)))
}

impl Live<'_> {
    /// Forgets all checkpoints, because the machine was put into initial condition.
    pub(super) fn forget_checkpoints(&mut self) {
        self.checkpoints.clear();
        self.changes.clear();
    }

    /// Notes that a user has changed something at the present instant.
    ///
    /// # Errors
    /// If the voltages cannot be evaluated.
    pub(super) fn note_change(&mut self) -> Result<(), RunError> {
        let clock = self.run.clock();
        if clock > 0.0 && self.changes.last() != Some(&clock) {
            self.changes.push(clock);
        }
        self.keep_checkpoint(clock > 0.0)
    }

    /// The time of the earliest checkpoint by the recorder's clock, in seconds.
    pub(super) fn oldest(&self) -> Option<f64> {
        self.checkpoints.first().map(Checkpoint::clock)
    }

    /// Keeps the present instant if enough time has passed since the last checkpoint, or if `is_needed`. With too many or
    /// too large checkpoints, every second one is dropped, and the next ones are twice as far apart.
    ///
    /// # Errors
    /// If the voltages cannot be evaluated.
    pub(super) fn keep_checkpoint(&mut self, is_needed: bool) -> Result<(), RunError> {
        let since = self.checkpoints.last().map_or(f64::INFINITY, |last| self.run.clock() - last.clock());
        if since < self.interval && !is_needed {
            return Ok(());
        }
        let checkpoint = self.run.checkpoint()?;
        // A change at the same instant replaces the one before.
        if since == 0.0 {
            self.checkpoints.pop();
        }
        self.checkpoints.push(checkpoint);
        while self.has_too_many_checkpoints() {
            let mut index = 0;
            self.checkpoints.retain(|_| {
                index += 1;
                index % 2 == 1
            });
            // The changes of a user come at any rate. They do not decide how far the others are apart.
            if !is_needed {
                self.interval *= 2.0;
            }
        }
        Ok(())
    }

    /// Whether there are more checkpoints than permitted, or they need too much memory. One is always kept.
    fn has_too_many_checkpoints(&self) -> bool {
        let count = self.checkpoints.len();
        let bytes = || self.checkpoints.iter().map(Checkpoint::bytes).sum::<usize>();
        count > MAX_CHECKPOINTS || (count > 1 && bytes() > MAX_CHECKPOINT_BYTES)
    }

    /// Returns to the last checkpoint that is not after a time by the recorder's clock, and drops later ones. Returns
    /// the time up to which the run can be repeated from there: the given one, or an earlier one at which a user changed
    /// something. `None` if there is no checkpoint; then nothing changes.
    pub(super) fn return_before(&mut self, clock: f64) -> Option<f64> {
        let count = self.checkpoints.partition_point(|checkpoint| checkpoint.clock() <= clock);
        let checkpoint = self.checkpoints.get(count.checked_sub(1)?)?;
        let begin = checkpoint.clock();
        self.run.return_to(checkpoint);
        self.checkpoints.truncate(count);
        let change = self.changes.iter().copied().find(|change| *change > begin).unwrap_or(f64::INFINITY);
        self.changes.retain(|change| *change <= begin);
        Some(clock.min(change))
    }
}
