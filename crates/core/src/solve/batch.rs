//! Runs several machines together. Machines that run the same kernel at the same step take their steps in lanes, one
//! lane for each.
//!
//! A machine with an event in the next step leaves its lane, takes the step alone as in a separate run, and joins
//! again. So all results are the same, to the bit, as those of separate runs. All phases except operation are played on
//! one machine after the other.

mod member;

use std::sync::Arc;

use super::error::RunError;
use super::fast_path::FLUSH_INTERVAL;
use super::operation::Operation;
use super::player::{Player, has_initial_condition_first};
use super::runge_kutta::MIN_STATE;
use crate::document::{Phase, SwitchCondition};
use crate::ir::Tables;
use crate::kernel::{Backend, LaneFrame, MIN_LANES, SharedKernel, Steps};

/// Number of steps that each machine takes alone before the batch checks again whether machines can share a kernel.
const STEPS_BEFORE_GROUPING: u64 = 32;
/// Number of lane groups from which unused groups are dropped before a new one is made.
const MAX_GROUPS: usize = 8;

/// Machines that play the same phases in equal steps, at most [`LANES`](crate::kernel::LANES).
pub(super) struct Batch<'p, 'w> {
    /// The machines in the order of their programs. The index of a machine is also its lane.
    members: Vec<Member<'p, 'w>>,
    /// The groups in use, and unused ones that a later group of the same kernel takes over.
    groups: Vec<LaneGroup>,
    /// The backend of all machines.
    backend: Backend,
}

/// A machine of a batch, with its recorder and the outcome of its run.
struct Member<'p, 'w> {
    /// The machine and its recorder.
    player: Player<'p, 'w>,
    /// The first error of the run. After an error the member takes no further steps.
    outcome: Result<(), RunError>,
    /// The present operation; `None` between operations. While the member is in a group, the operation is at the step
    /// at which the member joined or was updated last.
    operation: Option<Operation>,
}

/// Members that step together. The lane of a member is its index in the batch. A group without members is kept, so that
/// a later group of the same kernel needs no new memory.
struct LaneGroup {
    /// The kernel of all members.
    shared: Arc<SharedKernel>,
    /// The tables that the kernel reads.
    tables: Arc<Tables>,
    /// The variables of the kernel for all lanes.
    lanes: LaneFrame,
    /// The steps that are not taken yet. Only the first of them counts: the members limit the number.
    steps: Steps,
}

/// A kernel and the tables that it reads. All members of a group have the same.
#[derive(Clone, Copy)]
struct KernelWithTables<'a> {
    /// The kernel, compared by address.
    shared: &'a Arc<SharedKernel>,
    /// The tables, compared by address.
    tables: &'a Arc<Tables>,
}

impl<'p, 'w> Batch<'p, 'w> {
    /// A batch of the machines of at most [`LANES`](crate::kernel::LANES) players.
    pub(super) fn new(players: Vec<Player<'p, 'w>>, backend: Backend) -> Self {
        let members = players.into_iter().map(|player| Member { player, outcome: Ok(()), operation: None });
        Batch { members: members.collect(), groups: Vec::new(), backend }
    }

    /// Plays all phases. A run always begins in initial condition, even if its first phase is another one.
    pub(super) fn run(&mut self, phases: &[Phase]) {
        if !has_initial_condition_first(phases) {
            self.play(&Phase::InitialCondition);
        }
        self.play_all(phases);
    }

    /// The players in their order, each with the outcome of its run.
    pub(super) fn into_players(self) -> impl Iterator<Item = (Player<'p, 'w>, Result<(), RunError>)> {
        self.members.into_iter().map(|member| (member.player, member.outcome))
    }

    /// Plays phases in their order.
    fn play_all(&mut self, phases: &[Phase]) {
        phases.iter().for_each(|phase| self.play(phase));
    }

    /// Plays one phase on all machines. Only operation takes steps in groups.
    fn play(&mut self, phase: &Phase) {
        match phase {
            Phase::Repeat { times, phases } => (0..*times).for_each(|_| self.play_all(phases)),
            Phase::Operate { time, until } => self.operate(*time, until.as_ref()),
            _ => self.members.iter_mut().for_each(|member| member.try_play(|player| player.play(phase))),
        }
    }

    /// Operates all machines over a time in problem seconds. Each machine ends the phase earlier if its relay of
    /// `until` switches.
    fn operate(&mut self, time: f64, until: Option<&SwitchCondition>) {
        let phases_begun: Vec<_> =
            self.members.iter_mut().map(|member| member.begin_operating(time, until)).collect();
        let mut next = 1;
        while self.members.iter().any(Member::is_operating) {
            next = self.run_block(next);
        }
        for group in &mut self.groups {
            group.disband(&mut self.members);
        }
        for (member, phase) in self.members.iter_mut().zip(phases_begun) {
            phase.into_iter().for_each(|phase| member.end_operating(phase));
        }
    }

    /// Takes a few steps from the step of index `first`: in groups if possible, else alone. Then members that can share
    /// a kernel join groups. Returns the index of the next step of all members.
    fn run_block(&mut self, first: u64) -> u64 {
        let Batch { groups, members, backend } = self;
        let counts = groups.iter_mut().filter_map(|group| group.prepare(members, *backend));
        let count = counts.min().unwrap_or_else(|| self.steps_alone());
        let next = first.saturating_add(count);
        for group in &mut self.groups {
            group.run(&mut self.members, next, self.backend);
        }
        let grouped_lanes = self.grouped_lanes();
        let alone = self.members.iter_mut().enumerate().filter(|(lane, _)| !has_lane(grouped_lanes, *lane));
        alone.for_each(|(_, member)| member.continue_alone(next));
        for lane in 0..self.members.len() {
            if !has_lane(grouped_lanes, lane) && self.can_share_kernel(lane) {
                self.join(lane);
            }
        }
        next
    }

    /// The number of steps to take if no member is in a group: all that are left if fewer than [`MIN_LANES`] members
    /// operate.
    fn steps_alone(&self) -> u64 {
        let operating_members = self.members.iter().filter(|member| member.is_operating());
        if operating_members.count() < MIN_LANES { u64::MAX } else { STEPS_BEFORE_GROUPING }
    }

    /// A bit mask of the members that are in a group.
    fn grouped_lanes(&self) -> u64 {
        self.groups.iter().fold(0, |all, group| all | group.lanes.active_lanes())
    }

    /// Whether enough members run the kernel of this member at the same step to make lanes faster.
    fn can_share_kernel(&self, lane: usize) -> bool {
        let Some(position) = self.members[lane].position() else { return false };
        let is_same = |member: &&Member<'_, '_>| {
            member.position().is_some_and(|other| are_at_same_step(position, other))
        };
        self.members.iter().filter(is_same).count() >= position.0.shared.min_lanes(self.backend)
    }

    /// Puts a member into the group of its kernel and step, into an unused group of its kernel, or into a new group.
    fn join(&mut self, lane: usize) {
        let Some((kernel, steps)) = self.members[lane].position() else { return };
        let is_at_same_step = |group: &LaneGroup| {
            group.lanes.active_lanes() != 0
                && are_at_same_step((group.kernel(), group.steps), (kernel, steps))
        };
        let is_unused =
            |group: &LaneGroup| group.lanes.active_lanes() == 0 && group.kernel().is_same_as(kernel);
        let existing =
            self.groups.iter().position(is_at_same_step).or_else(|| self.groups.iter().position(is_unused));
        let index = existing.unwrap_or_else(|| {
            if self.groups.len() >= MAX_GROUPS {
                self.groups.retain(|group| group.lanes.active_lanes() != 0);
            }
            let KernelWithTables { shared, tables } = kernel;
            let lanes = LaneFrame::of(&shared.kernel);
            self.groups.push(LaneGroup {
                shared: Arc::clone(shared),
                tables: Arc::clone(tables),
                lanes,
                steps,
            });
            self.groups.len() - 1
        });
        let group = &mut self.groups[index];
        group.steps = Steps { count: u64::MAX, ..steps };
        group.join(lane, &mut self.members[lane]);
    }
}

/// Whether two members run the same kernel at the same step of the same grid.
fn are_at_same_step(
    (kernel, steps): (KernelWithTables<'_>, Steps),
    (other_kernel, other_steps): (KernelWithTables<'_>, Steps),
) -> bool {
    kernel.is_same_as(other_kernel) && steps.begin == other_steps.begin && steps.first == other_steps.first
}

impl KernelWithTables<'_> {
    /// Whether this is the same kernel with the same tables.
    fn is_same_as(self, other: KernelWithTables<'_>) -> bool {
        Arc::ptr_eq(self.shared, other.shared) && Arc::ptr_eq(self.tables, other.tables)
    }
}

impl LaneGroup {
    /// The kernel and the tables of the group.
    fn kernel(&self) -> KernelWithTables<'_> {
        KernelWithTables { shared: &self.shared, tables: &self.tables }
    }

    /// Removes the members that cannot take the next step in the group. Returns the number of steps that the others can
    /// take together, at most up to the next flush of tiny states. If too few members are left, all are removed and the
    /// number is 1. `None` if the group was empty.
    fn prepare(&mut self, members: &mut [Member<'_, '_>], backend: Backend) -> Option<u64> {
        let grouped_lanes = self.lanes.active_lanes();
        let mut count = self.steps.up_to_multiple_of(FLUSH_INTERVAL);
        for lane in lanes(grouped_lanes) {
            match members[lane].steps_in_group() {
                0 => self.leave(lane, &mut members[lane]),
                most => count = count.min(most),
            }
        }
        if (self.lanes.active_lanes().count_ones() as usize) < self.shared.min_lanes(backend) {
            self.disband(members);
            count = 1;
        }
        (grouped_lanes != 0).then_some(count)
    }

    /// Removes all members.
    fn disband(&mut self, members: &mut [Member<'_, '_>]) {
        lanes(self.lanes.active_lanes()).for_each(|lane| self.leave(lane, &mut members[lane]));
    }

    /// Advances all lanes to the step of index `next`. Members with an event in a step take this step alone. At the end
    /// all members of the group are updated.
    fn run(&mut self, members: &mut [Member<'_, '_>], next: u64, backend: Backend) {
        while self.lanes.active_lanes() != 0 && self.steps.first < next {
            let steps = Steps { count: next - self.steps.first, ..self.steps };
            let taken = self.shared.steps_in_lanes(&mut self.lanes, &self.tables, &steps, backend);
            self.steps = self.steps.after(taken);
            if taken < steps.count {
                self.step_with_events(members);
            }
        }
        self.update(members);
        // Tiny states are flushed after the sample, as in a separate run.
        if self.steps.up_to_multiple_of(FLUSH_INTERVAL) == FLUSH_INTERVAL {
            self.lanes.flush_tiny_states(MIN_STATE);
        }
    }

    /// Updates the members to the step of the group, and records the samples that are due. Members that took the last
    /// step alone are already up to date.
    fn update(&mut self, members: &mut [Member<'_, '_>]) {
        let (steps, time) = (self.steps, self.lanes.time());
        let (mut outdated, mut is_sample_due) = (0, false);
        for lane in lanes(self.lanes.active_lanes()) {
            let member = &mut members[lane];
            if member.is_outdated(steps) {
                outdated |= 1 << lane;
                member.count_steps(steps.first, time);
                is_sample_due |= member.is_sample_due();
            }
        }
        // The recorded voltages are evaluated only if a sample is due.
        if is_sample_due {
            self.lanes.evaluate(&self.shared.kernel, &self.tables);
        }
        lanes(outdated).for_each(|lane| members[lane].sample(self, lane));
    }

    /// Takes one step in which some members have events. These take it alone, and join again if their kernel is still
    /// valid after it.
    fn step_with_events(&mut self, members: &mut [Member<'_, '_>]) {
        let (mut removed_lanes, end) = (0, self.steps.end_of(0));
        loop {
            let hit_lanes = self.lanes.hit_lanes();
            lanes(hit_lanes).for_each(|lane| self.leave(lane, &mut members[lane]));
            removed_lanes |= hit_lanes;
            if self.lanes.finish_step(&self.shared.kernel, &self.tables, end) {
                break;
            }
        }
        self.steps = self.steps.after(1);
        for lane in lanes(removed_lanes) {
            members[lane].expect_event();
            members[lane].continue_alone(self.steps.first);
            if members[lane].position().is_some() {
                self.join(lane, &mut members[lane]);
            }
        }
    }

    /// Moves the variables of a member's kernel into its lane.
    fn join(&mut self, lane: usize, member: &mut Member<'_, '_>) {
        let (kernel, lanes) = (&self.shared.kernel, &mut self.lanes);
        member.kernel_run().into_iter().for_each(|run| lanes.load_lane(kernel, lane, &mut run.frame));
    }

    /// Moves the variables of a lane back into the kernel of its member, and updates the member.
    fn leave(&mut self, lane: usize, member: &mut Member<'_, '_>) {
        let (kernel, lanes) = (&self.shared.kernel, &mut self.lanes);
        let Some(run) = member.kernel_run() else { return };
        lanes.unload_lane(kernel, lane, &mut run.frame);
        let time = run.time();
        member.count_steps(self.steps.first, time);
    }
}

/// The indices of the bits that are set, from the lowest.
fn lanes(mut bits: u64) -> impl Iterator<Item = usize> {
    std::iter::from_fn(move || {
        let lane = bits.trailing_zeros();
        bits &= bits.wrapping_sub(1);
        (lane < u64::BITS).then_some(lane as usize)
    })
}

/// Whether the bit of a lane is set.
fn has_lane(bits: u64, lane: usize) -> bool {
    bits >> lane & 1 == 1
}

#[cfg(test)]
mod tests;
