//! A program together with a run of it. The run borrows the program, so both are in one cell.

use std::collections::BTreeMap;
use std::sync::Arc;

use patchcord_core::ir::Program;
use patchcord_core::solve::{Checkpoint, LiveRun, RunError, RunSettings};
use self_cell::self_cell;

use crate::command::Mode;
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
    /// The mode whose phases the run plays; `None` before the first one.
    pub plays: Option<Mode>,
    /// Instants since the last initial condition, in order of time.
    checkpoints: Vec<Kept<'p>>,
    /// Least time between two checkpoints, in seconds.
    interval: f64,
    /// The times since the last initial condition at which a user changed something, in seconds, ascending.
    changes: Vec<f64>,
    /// The parameters that a user has set since the last initial condition, by their names: the time of the last change
    /// in seconds, and the value since then.
    turned: BTreeMap<String, (f64, f64)>,
    /// Where the run was moved back; `None` if it is at its end.
    back: Option<Back>,
}

/// An instant to which a run can return.
struct Kept<'p> {
    /// The instant.
    checkpoint: Checkpoint<'p>,
    /// The mode whose phases the run plays there.
    plays: Option<Mode>,
}

/// The position of a run that was moved back. Both times are by the recorder's clock, in seconds.
struct Back {
    /// The end of the run, up to which it can be repeated.
    latest: f64,
    /// The time of the checkpoint from which it was repeated. The run has the parameters of this time.
    begin: f64,
}

/// Makes a machine in initial condition.
///
/// # Errors
/// If the run cannot begin.
pub(super) fn live_machine(program: &Arc<Program>, settings: &RunSettings) -> Result<LiveMachine, RunError> {
    let interval = settings.duration() / MAX_CHECKPOINTS as f64;
    LiveMachine::try_new(Arc::clone(program), |program| {
        let run = LiveRun::new(program, settings)?;
        Ok(Live {
            run,
            plays: None,
            checkpoints: Vec::new(),
            interval,
            changes: Vec::new(),
            turned: BTreeMap::new(),
            back: None,
        })
    })
}

/// Lets a machine in initial condition continue the run of another one.
///
/// # Errors
/// If the voltages cannot be evaluated with the states of the other one. The machine stays in initial condition then.
pub(super) fn continue_run(machine: &mut LiveMachine, mut other: LiveMachine) -> Result<(), RunError> {
    machine.with_dependent_mut(|_, new| {
        other.with_dependent_mut(|_, old| {
            new.plays = old.plays;
            new.run.continue_from(&mut old.run)
        })
    })
}

impl Live<'_> {
    /// Forgets all checkpoints, because the machine was put into initial condition.
    pub(super) fn forget_checkpoints(&mut self) {
        self.checkpoints.clear();
        self.changes.clear();
        self.turned.clear();
        self.back = None;
    }

    /// Notes that a user has set a parameter to a value at the present instant.
    ///
    /// # Errors
    /// If the voltages cannot be evaluated.
    pub(super) fn note_turned(&mut self, name: &str, value: f64) -> Result<(), RunError> {
        self.turned.insert(name.to_owned(), (self.run.clock(), value));
        self.note_change()
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
        // A checkpoint at this instant has the state before the change.
        self.keep_checkpoint(clock > 0.0 || !self.checkpoints.is_empty())
    }

    /// The time of the earliest checkpoint by the recorder's clock, in seconds.
    pub(super) fn oldest(&self) -> Option<f64> {
        self.checkpoints.first().map(|kept| kept.checkpoint.clock())
    }

    /// The end of the run by the recorder's clock, in seconds, if the run was moved back.
    pub(super) fn latest(&self) -> Option<f64> {
        self.back.as_ref().map(|back| back.latest)
    }

    /// Keeps the present instant if enough time has passed since the last checkpoint, or if `is_needed`. With too many or
    /// too large checkpoints, every second one is dropped, and the next ones are twice as far apart.
    ///
    /// # Errors
    /// If the voltages cannot be evaluated.
    pub(super) fn keep_checkpoint(&mut self, is_needed: bool) -> Result<(), RunError> {
        let last = self.checkpoints.last();
        let since = last.map_or(f64::INFINITY, |kept| self.run.clock() - kept.checkpoint.clock());
        if since < self.interval && !is_needed {
            return Ok(());
        }
        let checkpoint = self.run.checkpoint()?;
        // A change at the same instant replaces the one before.
        if since == 0.0 {
            self.checkpoints.pop();
        }
        self.checkpoints.push(Kept { checkpoint, plays: self.plays });
        while self.has_too_many_checkpoints() {
            let (count, mut index) = (self.checkpoints.len(), 0);
            self.checkpoints.retain(|_| {
                index += 1;
                // Only from the last one can the run be repeated up to its end, if it is after a change.
                index % 2 == 1 || (index == count && count > 2)
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
        let bytes = || self.checkpoints.iter().map(|kept| kept.checkpoint.bytes()).sum::<usize>();
        count > MAX_CHECKPOINTS || (count > 1 && bytes() > MAX_CHECKPOINT_BYTES)
    }

    /// Returns to the last checkpoint that is not after a time by the recorder's clock. The later ones are kept. Returns
    /// the time up to which the run can be repeated from there: the given one, or an earlier one at which a user changed
    /// something. `None` if the time is after the end of the run, or if there is no checkpoint; then nothing changes.
    pub(super) fn return_before(&mut self, clock: f64) -> Option<f64> {
        let latest = self.latest().unwrap_or(self.run.clock());
        let count = self.checkpoints.partition_point(|kept| kept.checkpoint.clock() <= clock);
        let kept = self.checkpoints.get(count.checked_sub(1)?).filter(|_| clock <= latest)?;
        let begin = kept.checkpoint.clock();
        self.run.return_to(&kept.checkpoint);
        self.plays = kept.plays;
        self.back = Some(Back { latest, begin });
        let change = self.changes.iter().copied().find(|change| *change > begin).unwrap_or(f64::INFINITY);
        Some(clock.min(change))
    }

    /// The parameters that a user set after the present instant of a run that was moved back, with their last values.
    fn turned_later(&self) -> Vec<(String, f64)> {
        let begin = self.back.as_ref().map_or(f64::INFINITY, |back| back.begin);
        let later = self.turned.iter().filter(|(_, (last, _))| *last > begin);
        later.map(|(name, (_, value))| (name.clone(), *value)).collect()
    }

    /// Gives the parameters that a user set later their present values, after the run was moved back.
    ///
    /// # Errors
    /// If the voltages cannot be evaluated with these values.
    pub(super) fn adopt_later_values(&mut self) -> Result<(), RunError> {
        let later = self.turned_later();
        // Without a change, the bits of the run must stay.
        if !later.is_empty() {
            self.run.set_parameters(later)?;
        }
        self.run.points().clear();
        Ok(())
    }

    /// Forgets what the run did after the present instant, because it continues otherwise.
    ///
    /// # Errors
    /// If the voltages cannot be evaluated.
    pub(super) fn forget_later(&mut self) -> Result<(), RunError> {
        let (clock, later) = (self.run.clock(), self.turned_later());
        self.back = None;
        self.checkpoints.retain(|kept| kept.checkpoint.clock() <= clock);
        self.changes.retain(|change| *change <= clock);
        later.iter().try_for_each(|(name, value)| self.note_turned(name, *value))
    }
}
