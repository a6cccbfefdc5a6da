//! Runs side by side. Machines that run the same kernel at the same step take their steps together, one lane for each.
//!
//! A machine that meets an event leaves its lane, crosses the event alone as in a run by itself, and joins again. So
//! all results are the same, to the bit, as those of separate runs.

use std::mem;
use std::sync::Arc;

use super::error::RunError;
use super::fast_path::{FLUSH_INTERVAL, KernelRun};
use super::observer::StepObserver as _;
use super::operation::Operation;
use super::player::{Operating, Player, begins_in_initial_condition};
use super::runge_kutta::SMALLEST;
use crate::document::{Phase, Until};
use crate::ir::Tables;
use crate::kernel::{Backend, FEWEST_ABREAST, Folded, Formation, Steps};

/// The number of steps that each machine takes alone before it is checked again whether machines can share a kernel.
const STEPS_ALONE: u64 = 32;
/// At most this many lane groups are kept for later use.
const MAX_GROUPS: usize = 8;

/// Machines that go through the same phases in equal steps, at most [`LANES`](crate::kernel::LANES).
pub(super) struct Batch<'p, 'w> {
    /// The machines in the order of their programs. The index of a machine is also its lane.
    members: Vec<Member<'p, 'w>>,
    /// The groups in use and those kept for later.
    groups: Vec<LaneGroup>,
    backend: Backend,
}

/// A machine of a batch, with its recorder and the outcome of its run.
struct Member<'p, 'w> {
    player: Player<'p, 'w>,
    /// The first error of the run. After an error the member takes no further part.
    outcome: Result<(), RunError>,
    /// The present operation; `None` between operations. While the member is in a group, its position is that at which
    /// it joined or was updated last.
    operation: Option<Operation>,
}

/// Members that step together. The lane of a member is its index. A group without members is kept, so that a later
/// group of the same kernel needs no new memory.
struct LaneGroup {
    /// The kernel of all members.
    folded: Arc<Folded>,
    /// The tables that the kernel reads.
    tables: Arc<Tables>,
    /// The variables of the kernel for all lanes.
    lanes: Formation,
    /// The steps that are left, counted from the next one.
    steps: Steps,
}

/// What the members of a group have in common: a kernel, and the tables that it reads.
#[derive(Clone, Copy)]
struct SharedKernel<'a> {
    folded: &'a Arc<Folded>,
    tables: &'a Arc<Tables>,
}

impl<'p, 'w> Batch<'p, 'w> {
    /// A batch of the machines of some players.
    pub fn new(players: Vec<Player<'p, 'w>>, backend: Backend) -> Self {
        let members = players.into_iter().map(|player| Member { player, outcome: Ok(()), operation: None });
        Batch { members: members.collect(), groups: Vec::new(), backend }
    }

    /// Plays all phases. A run always begins in initial condition, even if its first phase does not say so.
    pub fn run(&mut self, phases: &[Phase]) {
        if !begins_in_initial_condition(phases) {
            self.play(&Phase::InitialCondition);
        }
        self.play_all(phases);
    }

    /// The players in their order, each with the outcome of its run.
    pub fn into_players(self) -> impl Iterator<Item = (Player<'p, 'w>, Result<(), RunError>)> {
        self.members.into_iter().map(|member| (member.player, member.outcome))
    }

    /// Plays phases in their order.
    fn play_all(&mut self, phases: &[Phase]) {
        phases.iter().for_each(|phase| self.play(phase));
    }

    /// Plays one phase on all machines. Only operation takes steps; all other phases are played one machine after the
    /// other.
    fn play(&mut self, phase: &Phase) {
        match phase {
            Phase::Repeat { times, phases } => (0..*times).for_each(|_| self.play_all(phases)),
            Phase::Operate { time, until } => self.operate(*time, until.as_ref()),
            _ => self.members.iter_mut().for_each(|member| member.act(|player| player.play(phase))),
        }
    }

    /// Operates all machines over a time in seconds, at most until the relay of `until` switches in each of them.
    fn operate(&mut self, time: f64, until: Option<&Until>) {
        let begun: Vec<_> =
            self.members.iter_mut().map(|member| member.begin_operating(time, until)).collect();
        let mut next = 1;
        while self.members.iter().any(Member::is_operating) {
            next = self.round(next);
        }
        for group in &mut self.groups {
            group.disband(&mut self.members);
        }
        for (member, operating) in self.members.iter_mut().zip(begun) {
            operating.into_iter().for_each(|operating| member.end_operating(operating));
        }
    }

    /// Takes a few steps from the step of index `first`: in groups if possible, else alone. Returns the index of the
    /// step before which all members are then.
    fn round(&mut self, first: u64) -> u64 {
        let Batch { groups, members, backend } = self;
        let counts = groups.iter_mut().filter_map(|group| group.prepare(members, *backend));
        let count = counts.min().unwrap_or_else(|| self.steps_alone());
        let next = first.saturating_add(count);
        for group in &mut self.groups {
            group.run(&mut self.members, next, self.backend);
        }
        let joined = self.joined();
        let alone = self.members.iter_mut().enumerate().filter(|(lane, _)| !is_among(joined, *lane));
        alone.for_each(|(_, member)| member.continue_alone(next));
        for lane in 0..self.members.len() {
            if !is_among(joined, lane) && self.shares_kernel(lane) {
                self.join(lane);
            }
        }
        next
    }

    /// The number of steps to take if no member is in a group: all that are left if too few members operate for a
    /// group.
    fn steps_alone(&self) -> u64 {
        let operating = self.members.iter().filter(|member| member.is_operating());
        if operating.count() < FEWEST_ABREAST { u64::MAX } else { STEPS_ALONE }
    }

    /// A bit for every member that is in a group.
    fn joined(&self) -> u64 {
        self.groups.iter().fold(0, |all, group| all | group.lanes.aboard())
    }

    /// Whether enough members run the kernel of this one at the same step.
    fn shares_kernel(&self, lane: usize) -> bool {
        let Some(own) = self.members[lane].position() else { return false };
        let is_same =
            |member: &&Member<'_, '_>| member.position().is_some_and(|other| are_together(own, other));
        self.members.iter().filter(is_same).count() >= own.0.folded.fewest_abreast(self.backend)
    }

    /// Puts a member into the group of its kernel and step, or into an unused group of its kernel, or into a new one.
    fn join(&mut self, lane: usize) {
        let Some((kernel, steps)) = self.members[lane].position() else { return };
        let is_there = |group: &LaneGroup| {
            group.lanes.aboard() != 0 && are_together((group.kernel(), group.steps), (kernel, steps))
        };
        let is_free = |group: &LaneGroup| group.lanes.aboard() == 0 && group.kernel().is(kernel);
        let known = self.groups.iter().position(is_there).or_else(|| self.groups.iter().position(is_free));
        let index = known.unwrap_or_else(|| {
            if self.groups.len() >= MAX_GROUPS {
                self.groups.retain(|group| group.lanes.aboard() != 0);
            }
            let SharedKernel { folded, tables } = kernel;
            let lanes = Formation::of(&folded.kernel);
            self.groups.push(LaneGroup {
                folded: Arc::clone(folded),
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
fn are_together((own, steps): (SharedKernel<'_>, Steps), (other, others): (SharedKernel<'_>, Steps)) -> bool {
    own.is(other) && steps.begin == others.begin && steps.first == others.first
}

impl SharedKernel<'_> {
    /// Whether this is the same kernel with the same tables.
    fn is(self, other: SharedKernel<'_>) -> bool {
        Arc::ptr_eq(self.folded, other.folded) && Arc::ptr_eq(self.tables, other.tables)
    }
}

impl LaneGroup {
    /// The kernel and the tables of the group.
    fn kernel(&self) -> SharedKernel<'_> {
        SharedKernel { folded: &self.folded, tables: &self.tables }
    }

    /// Removes the members that cannot take the next step in the group. Returns the number of steps that the others can
    /// take, 1 if too few are left, and `None` if the group was empty.
    fn prepare(&mut self, members: &mut [Member<'_, '_>], backend: Backend) -> Option<u64> {
        let joined = self.lanes.aboard();
        let mut count = self.steps.up_to_multiple_of(FLUSH_INTERVAL);
        for lane in lanes(joined) {
            match members[lane].steps_in_group() {
                0 => self.leave(lane, &mut members[lane]),
                most => count = count.min(most),
            }
        }
        if (self.lanes.aboard().count_ones() as usize) < self.folded.fewest_abreast(backend) {
            self.disband(members);
            count = 1;
        }
        (joined != 0).then_some(count)
    }

    /// Removes all members.
    fn disband(&mut self, members: &mut [Member<'_, '_>]) {
        lanes(self.lanes.aboard()).for_each(|lane| self.leave(lane, &mut members[lane]));
    }

    /// Steps all lanes to the step of index `next`. Members that meet events on the way take these steps alone. At the
    /// end all members of the group are updated.
    fn run(&mut self, members: &mut [Member<'_, '_>], next: u64, backend: Backend) {
        while self.lanes.aboard() != 0 && self.steps.first < next {
            let steps = Steps { count: next - self.steps.first, ..self.steps };
            let taken = self.folded.steps_abreast(&mut self.lanes, &self.tables, &steps, backend);
            self.steps = self.steps.after(taken);
            if taken < steps.count {
                self.step_apart(members);
            }
        }
        self.update(members);
        // As in a run alone, tiny states are flushed after the sample.
        if self.steps.up_to_multiple_of(FLUSH_INTERVAL) == FLUSH_INTERVAL {
            self.lanes.without_dust(SMALLEST);
        }
    }

    /// Updates the members to the step of the group, and lets them sample. Members that took the last step alone are
    /// already up to date.
    fn update(&mut self, members: &mut [Member<'_, '_>]) {
        let (steps, time) = (self.steps, self.lanes.time());
        let (mut outdated, mut any_due) = (0, false);
        for lane in lanes(self.lanes.aboard()) {
            let member = &mut members[lane];
            if member.is_outdated(steps) {
                outdated |= 1 << lane;
                member.pass(steps.first, time);
                any_due |= member.is_sample_due();
            }
        }
        // The recorded voltages are evaluated only if a sample is due.
        if any_due {
            self.lanes.work_out(&self.folded.kernel, &self.tables);
        }
        lanes(outdated).for_each(|lane| members[lane].sample(self, lane));
    }

    /// Takes one step in which some members meet events. These take it alone, and join again if their kernel is still
    /// valid after it.
    fn step_apart(&mut self, members: &mut [Member<'_, '_>]) {
        let (mut left, end) = (0, self.steps.end_of(0));
        loop {
            let beyond = self.lanes.beyond();
            lanes(beyond).for_each(|lane| self.leave(lane, &mut members[lane]));
            left |= beyond;
            if self.lanes.go_without(&self.folded.kernel, &self.tables, end) {
                break;
            }
        }
        self.steps = self.steps.after(1);
        for lane in lanes(left) {
            members[lane].expect_event();
            members[lane].continue_alone(self.steps.first);
            if members[lane].position().is_some() {
                self.join(lane, &mut members[lane]);
            }
        }
    }

    /// Moves the variables of a member's kernel into its lane.
    fn join(&mut self, lane: usize, member: &mut Member<'_, '_>) {
        let (kernel, lanes) = (&self.folded.kernel, &mut self.lanes);
        member.kernel_run().into_iter().for_each(|run| lanes.board(kernel, lane, &mut run.frame));
    }

    /// Moves the variables of a lane back into the kernel of its member, and updates the member.
    fn leave(&mut self, lane: usize, member: &mut Member<'_, '_>) {
        let (kernel, lanes) = (&self.folded.kernel, &mut self.lanes);
        let Some(run) = member.kernel_run() else { return };
        lanes.leave(kernel, lane, &mut run.frame);
        let time = run.time();
        member.pass(self.steps.first, time);
    }
}

impl<'p> Member<'p, '_> {
    /// Calls a function with the player, unless the run has failed.
    fn act(&mut self, act: impl FnOnce(&mut Player<'p, '_>) -> Result<(), RunError>) {
        if self.outcome.is_ok() {
            self.outcome = act(&mut self.player);
        }
    }

    /// Begins a phase in which the machine operates; `None` if the phase is skipped or the run has failed.
    fn begin_operating(&mut self, time: f64, until: Option<&Until>) -> Option<Operating<'p>> {
        let (mut begun, mut operation) = (None, None);
        self.act(|player| {
            begun = player.begin_operating(time, until)?;
            let time = begun.as_ref().map(|operating| operating.time);
            operation = time.map(|time| player.machine.begin_operation(time)).transpose()?;
            Ok(())
        });
        self.operation = operation;
        begun
    }

    /// Ends the phase, with the rest beyond its last whole step.
    fn end_operating(&mut self, operating: Operating<'p>) {
        let operation = self.operation.take();
        let Player { machine, recorder, .. } = &mut self.player;
        let outcome = mem::replace(&mut self.outcome, Ok(()));
        let outcome = outcome
            .and_then(|()| operation.map_or(Ok(()), |operation| machine.end_operation(operation, recorder)));
        self.outcome = self.player.end_operating(operating, outcome);
    }

    /// The present operation, if it has steps left and the run has not failed.
    fn under_way(&self) -> Option<&Operation> {
        self.operation.as_ref().filter(|operation| operation.steps.count > 0 && self.outcome.is_ok())
    }

    /// Whether the member has steps left in the present phase.
    fn is_operating(&self) -> bool {
        self.under_way().is_some()
    }

    /// The kernel and the steps that are left; `None` if the machine is not on the fast path.
    fn position(&self) -> Option<(SharedKernel<'_>, Steps)> {
        let (operation, machine) = (self.under_way()?, &self.player.machine);
        let folded = machine.fast_path.kernel(operation.active?);
        Some((SharedKernel { folded, tables: &machine.solver.setup.program.tables }, operation.steps))
    }

    /// The kernel run in progress; `None` if the machine is not on the fast path.
    fn kernel_run(&mut self) -> Option<&mut KernelRun> {
        Some(self.player.machine.fast_path.run_mut(self.operation?.active?))
    }

    /// Counts the steps that were taken in a group as work of this machine, up to the step of index `first` at this
    /// problem time.
    fn pass(&mut self, first: u64, time: f64) {
        let Some(operation) = &mut self.operation else { return };
        let taken = first - operation.steps.first;
        operation.pass(taken);
        self.player.machine.note_kernel_steps(taken, time);
    }

    /// Notes that an event comes in the next step.
    fn expect_event(&mut self) {
        let active = self.operation.as_mut().and_then(|operation| operation.active.as_mut());
        active.into_iter().for_each(|active| active.meets = true);
    }

    /// Whether the member is in a group, but at another step than the group.
    fn is_outdated(&self, steps: Steps) -> bool {
        self.operation
            .is_some_and(|operation| operation.active.is_some() && operation.steps.first != steps.first)
    }

    /// Whether a sample is due at the present time.
    fn is_sample_due(&self) -> bool {
        let Player { machine, recorder, .. } = &self.player;
        recorder.due(machine.time()).is_some()
    }

    /// Samples the voltages of a lane of a group.
    fn sample(&mut self, group: &LaneGroup, lane: usize) {
        let Some(Operation { active: Some(active), .. }) = self.operation else { return };
        let Player { machine, recorder, .. } = &mut self.player;
        let run = machine.fast_path.run_mut(active);
        group.lanes.show(&group.folded.kernel, lane, &mut run.frame);
        recorder.sample_kernel(machine.solver.state.time, run);
    }

    /// The number of steps that the member can take in a group: up to the next sample or known jump.
    fn steps_in_group(&self) -> u64 {
        let Some(Operation { steps, active: Some(active), .. }) = self.under_way() else { return 0 };
        steps.until(self.player.recorder.next_sample()).min(active.left)
    }

    /// Takes steps alone up to the step of index `next`.
    fn continue_alone(&mut self, next: u64) {
        let is_operating = self.is_operating();
        if let Some(operation) = self.operation.as_mut().filter(|_| is_operating) {
            let Player { machine, recorder, .. } = &mut self.player;
            let count = next.saturating_sub(operation.steps.first);
            self.outcome = machine.continue_operation(operation, count, recorder);
        }
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
fn is_among(bits: u64, lane: usize) -> bool {
    bits >> lane & 1 == 1
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::circuit::Circuit;
    use crate::ir::Program;
    use crate::patch::{ElementBuilder, PatchBuilder};
    use crate::solve::RunSettings;
    use crate::solve::run::ready;

    /// An integrator that a relay reverses at ±20 V, from many initial voltages.
    fn programs() -> (Vec<Program>, RunSettings) {
        let element = ElementBuilder::new;
        let relay = element("relay").cord("in", "A1").cord("on", "+100").cord("off", "-100");
        let patch = PatchBuilder::new("turned back")
            .scale("volt", 1, "V")
            .parameter("start", 0.0, "1", [-50.0, 50.0])
            .element("K1", relay.set("pull_in", 20).set("drop_out", -20))
            .element("A1", element("integrator").cords("x1", ["K1"]).set("initial", "start"))
            .run(2.0, 1e-3)
            .build()
            .unwrap();
        let circuit = Circuit::new(&patch, &[]).unwrap();
        let program = Program::new(&circuit).unwrap();
        let with_start = |run: u32| {
            let mut program = program.clone();
            program.set_parameters([("start", f64::from(run) - 8.0)]).unwrap();
            program
        };
        let record = vec!["A1".to_owned()];
        let settings = RunSettings { record, every: 0.01, ..RunSettings::of(&circuit).unwrap() };
        ((0..16).map(with_start).collect(), settings)
    }

    /// Changes of mode come at another instant in every run. They put no member out of step, and most steps are taken
    /// in groups.
    #[test]
    fn members_stay_in_step() {
        let (programs, settings) = programs();
        let mut progress = vec![|_: f64| (); programs.len()];
        let pairs = programs.iter().zip(&mut progress);
        let players = pairs.map(|(program, progress)| ready(program, &settings, progress).unwrap());
        let mut batch = Batch::new(players.collect(), Backend::Lanes);
        batch.play(&Phase::InitialCondition);
        for member in &mut batch.members {
            assert!(member.begin_operating(2.0, None).is_some());
        }
        let (mut next, mut together) = (1, 0);
        while batch.members.iter().any(Member::is_operating) {
            let joined = u64::from(batch.joined().count_ones());
            let first = next;
            next = batch.round(first);
            together += joined * (next - first);
            let steps = batch.members.iter().map(|member| member.operation.unwrap().steps);
            assert!(steps.clone().all(|steps| steps.first == next || steps.count == 0));
        }
        assert_eq!(next, 2001);
        assert!(together > 16 * 1600, "{together}");
    }

    #[test]
    fn lanes_are_counted_from_the_lowest_bit() {
        assert!(lanes(0).next().is_none());
        assert!(lanes(1 << 63 | 0b1010).eq([1, 3, 63]));
        assert!(is_among(0b1010, 3) && !is_among(0b1010, 2));
    }
}
