//! A machine of a batch: its phases, its position, and the steps that it takes alone.
//!
//! While the member is in a group, its kernel run is in a lane of the group. Its own operation is then outdated, until
//! the group updates it.

use std::mem;

use super::{KernelWithTables, LaneGroup, Member};
use crate::document::SwitchCondition;
use crate::kernel::Steps;
use crate::solve::error::RunError;
use crate::solve::fast_path::KernelRun;
use crate::solve::observer::StepObserver as _;
use crate::solve::operation::Operation;
use crate::solve::player::{OperatePhase, Player};

impl<'p> Member<'p, '_> {
    /// Calls a function with the player, and keeps its error. Does nothing if the run has failed.
    pub(super) fn try_play(&mut self, play: impl FnOnce(&mut Player<'p, '_>) -> Result<(), RunError>) {
        if self.outcome.is_ok() {
            self.outcome = play(&mut self.player);
        }
    }

    /// Begins a phase in which the machine operates; `None` if the phase is skipped or the run has failed.
    pub(super) fn begin_operating(
        &mut self,
        time: f64,
        until: Option<&SwitchCondition>,
    ) -> Option<OperatePhase<'p>> {
        let (mut phase, mut operation) = (None, None);
        self.try_play(|player| {
            phase = player.begin_operating(time, until)?;
            let time = phase.as_ref().map(|phase| phase.time);
            operation = time.map(|time| player.machine.begin_operation(time)).transpose()?;
            Ok(())
        });
        self.operation = operation;
        phase
    }

    /// Ends the phase, after a shorter step if the phase is not a whole number of steps.
    pub(super) fn end_operating(&mut self, phase: OperatePhase<'p>) {
        let operation = self.operation.take();
        let Player { machine, recorder, .. } = &mut self.player;
        let outcome = mem::replace(&mut self.outcome, Ok(()));
        let outcome = outcome
            .and_then(|()| operation.map_or(Ok(()), |operation| machine.end_operation(operation, recorder)));
        self.outcome = self.player.end_operating(phase, outcome);
    }

    /// The present operation; `None` if it has no steps left or the run has failed.
    pub(super) fn active_operation(&self) -> Option<&Operation> {
        self.operation.as_ref().filter(|operation| operation.steps.count > 0 && self.outcome.is_ok())
    }

    /// Whether the member has steps left in the present phase.
    pub(super) fn is_operating(&self) -> bool {
        self.active_operation().is_some()
    }

    /// The kernel and the steps that are left; `None` if the machine is not on the fast path.
    pub(super) fn position(&self) -> Option<(KernelWithTables<'_>, Steps)> {
        let (operation, machine) = (self.active_operation()?, &self.player.machine);
        let shared = machine.fast_path.kernel(operation.active?);
        Some((KernelWithTables { shared, tables: &machine.solver.setup.program.tables }, operation.steps))
    }

    /// The kernel run in progress; `None` if the machine is not on the fast path.
    pub(super) fn kernel_run(&mut self) -> Option<&mut KernelRun> {
        Some(self.player.machine.fast_path.run_mut(self.operation?.active?))
    }

    /// Counts the steps that were taken in a group as work of this machine. The step of index `first` is then the next
    /// one, at the problem time `time`.
    pub(super) fn count_steps(&mut self, first: u64, time: f64) {
        let Some(operation) = &mut self.operation else { return };
        let taken = first - operation.steps.first;
        operation.count_taken(taken);
        self.player.machine.count_kernel_steps(taken, time);
    }

    /// Notes that an event is due in the next step.
    pub(super) fn expect_event(&mut self) {
        let active = self.operation.as_mut().and_then(|operation| operation.active.as_mut());
        active.into_iter().for_each(|active| active.is_event_next = true);
    }

    /// Whether the member is in a group, but at another step than the group.
    pub(super) fn is_outdated(&self, steps: Steps) -> bool {
        self.operation
            .is_some_and(|operation| operation.active.is_some() && operation.steps.first != steps.first)
    }

    /// Whether a sample is due at the present time of the machine.
    pub(super) fn is_sample_due(&self) -> bool {
        let Player { machine, recorder, .. } = &self.player;
        recorder.due_sample(machine.time()).is_some()
    }

    /// Records the sample of a lane of a group, if it is due.
    pub(super) fn sample(&mut self, group: &LaneGroup, lane: usize) {
        let Some(Operation { active: Some(active), .. }) = self.operation else { return };
        let Player { machine, recorder, .. } = &mut self.player;
        let run = machine.fast_path.run_mut(active);
        group.lanes.export(&group.shared.kernel, lane, &mut run.frame);
        recorder.sample_kernel(machine.solver.state.time, run);
    }

    /// The number of steps that the member can take in a group: up to the next sample or known jump; 0 if it is not on
    /// the fast path.
    pub(super) fn steps_in_group(&self) -> u64 {
        let Some(Operation { steps, active: Some(active), .. }) = self.active_operation() else { return 0 };
        steps.until(self.player.recorder.next_sample()).min(active.steps_left)
    }

    /// Takes steps alone until the step of index `next` is the next one.
    pub(super) fn continue_alone(&mut self, next: u64) {
        let is_operating = self.is_operating();
        if let Some(operation) = self.operation.as_mut().filter(|_| is_operating) {
            let Player { machine, recorder, .. } = &mut self.player;
            let count = next.saturating_sub(operation.steps.first);
            self.outcome = machine.continue_operation(operation, count, recorder);
        }
    }
}
