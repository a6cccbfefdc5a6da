//! Runs side by side: where several machines are in quiet flight with the same kernel, their steps are taken together, a
//! lane each. What a machine meets it crosses alone, as in a run of its own, and all bits are those of such runs.

use std::mem;
use std::sync::Arc;

use super::error::RunError;
use super::glide::{Flight, SWEPT};
use super::machine::Witness as _;
use super::operation::Operation;
use super::player::{Operating, Player, begins_in_initial_condition};
use super::stride::SMALLEST;
use crate::document::{Phase, Until};
use crate::ir::Tables;
use crate::kernel::{Backend, FEWEST_ABREAST, Folded, Formation, Steps};

/// So many steps are gone at once where nobody flies beside others.
const APART: u64 = 32;
/// So many wings are kept for later.
const MOST_WINGS: usize = 8;

/// Machines that go through the same phases in equal steps, [`LANES`](crate::kernel::LANES) at most.
pub(super) struct Convoy<'p, 'w> {
    members: Vec<Member<'p, 'w>>,
    wings: Vec<Wing>,
    backend: Backend,
}

/// One of them.
struct Member<'p, 'w> {
    player: Player<'p, 'w>,
    outcome: Result<(), RunError>,
    /// What it is doing. While it is aboard, it is where it boarded, or looked up last.
    operation: Option<Operation>,
}

/// Members that fly side by side, each in the lane of its number.
struct Wing {
    folded: Arc<Folded>,
    tables: Arc<Tables>,
    formation: Formation,
    /// The steps before it.
    steps: Steps,
}

/// What all of a wing fly with: a kernel, and the tables that it looks up.
#[derive(Clone, Copy)]
struct Equipment<'a> {
    folded: &'a Arc<Folded>,
    tables: &'a Arc<Tables>,
}

impl<'p, 'w> Convoy<'p, 'w> {
    pub fn new(players: Vec<Player<'p, 'w>>, backend: Backend) -> Self {
        let members = players.into_iter().map(|player| Member { player, outcome: Ok(()), operation: None });
        Convoy { members: members.collect(), wings: Vec::new(), backend }
    }

    /// Goes through a whole run; it begins in initial condition whether it says so or not.
    pub fn run(&mut self, phases: &[Phase]) {
        if !begins_in_initial_condition(phases) {
            self.one(&Phase::InitialCondition);
        }
        self.all(phases);
    }

    /// The players, each with how its run ended.
    pub fn into_players(self) -> impl Iterator<Item = (Player<'p, 'w>, Result<(), RunError>)> {
        self.members.into_iter().map(|member| (member.player, member.outcome))
    }

    fn all(&mut self, phases: &[Phase]) {
        phases.iter().for_each(|phase| self.one(phase));
    }

    fn one(&mut self, phase: &Phase) {
        match phase {
            Phase::Repeat { times, phases } => (0..*times).for_each(|_| self.all(phases)),
            Phase::Operate { time, until } => self.operate(*time, until.as_ref()),
            _ => self.members.iter_mut().for_each(|member| member.act(|player| player.one(phase))),
        }
    }

    fn operate(&mut self, time: f64, until: Option<&Until>) {
        let begun: Vec<_> =
            self.members.iter_mut().map(|member| member.begin_operating(time, until)).collect();
        let mut next = 1;
        while self.members.iter().any(Member::is_under_way) {
            next = self.round(next);
        }
        for wing in &mut self.wings {
            wing.disband(&mut self.members);
        }
        for (member, operating) in self.members.iter_mut().zip(begun) {
            operating.into_iter().for_each(|operating| member.end_operating(operating));
        }
    }

    /// Goes a few steps from that of a number on: side by side where that can be, else alone. All have come to the step whose
    /// number is told.
    fn round(&mut self, first: u64) -> u64 {
        let Convoy { wings, members, backend } = self;
        let rooms = wings.iter_mut().filter_map(|wing| wing.make_ready(members, *backend));
        let count = rooms.min().unwrap_or_else(|| self.steps_apart());
        let next = first.saturating_add(count);
        for wing in &mut self.wings {
            wing.fly(&mut self.members, next, self.backend);
        }
        let aboard = self.aboard();
        let alone = self.members.iter_mut().enumerate().filter(|(lane, _)| !is_among(aboard, *lane));
        alone.for_each(|(_, member)| member.go_alone(next));
        for lane in 0..self.members.len() {
            if !is_among(aboard, lane) && self.has_company(lane) {
                self.board(lane);
            }
        }
        next
    }

    /// How many steps are gone where nobody flies beside others: all that are left where few could.
    fn steps_apart(&self) -> u64 {
        let under_way = self.members.iter().filter(|member| member.is_under_way());
        if under_way.count() < FEWEST_ABREAST { u64::MAX } else { APART }
    }

    /// A bit for every member that flies in a wing.
    fn aboard(&self) -> u64 {
        self.wings.iter().fold(0, |all, wing| all | wing.formation.aboard())
    }

    /// Whether enough members are in flight beside one of them.
    fn has_company(&self, lane: usize) -> bool {
        let Some(flight) = self.members[lane].in_flight() else { return false };
        let is_beside =
            |member: &&Member<'_, '_>| member.in_flight().is_some_and(|other| are_beside(flight, other));
        self.members.iter().filter(is_beside).count() >= flight.0.folded.fewest_abreast(self.backend)
    }

    fn board(&mut self, lane: usize) {
        let Some((equipment, steps)) = self.members[lane].in_flight() else { return };
        let is_there = |wing: &Wing| {
            wing.formation.aboard() != 0 && are_beside((wing.equipment(), wing.steps), (equipment, steps))
        };
        let is_free = |wing: &Wing| wing.formation.aboard() == 0 && wing.equipment().is(equipment);
        let known = self.wings.iter().position(is_there).or_else(|| self.wings.iter().position(is_free));
        let index = known.unwrap_or_else(|| {
            if self.wings.len() >= MOST_WINGS {
                self.wings.retain(|wing| wing.formation.aboard() != 0);
            }
            let Equipment { folded, tables } = equipment;
            let formation = Formation::of(&folded.kernel);
            self.wings.push(Wing {
                folded: Arc::clone(folded),
                tables: Arc::clone(tables),
                formation,
                steps,
            });
            self.wings.len() - 1
        });
        let wing = &mut self.wings[index];
        wing.steps = Steps { count: u64::MAX, ..steps };
        wing.board(lane, &mut self.members[lane]);
    }
}

/// Whether two fly with the same at the same place of the same grid.
fn are_beside((own, steps): (Equipment<'_>, Steps), (other, others): (Equipment<'_>, Steps)) -> bool {
    own.is(other) && steps.begin == others.begin && steps.first == others.first
}

impl Equipment<'_> {
    fn is(self, other: Equipment<'_>) -> bool {
        Arc::ptr_eq(self.folded, other.folded) && Arc::ptr_eq(self.tables, other.tables)
    }
}

impl Wing {
    fn equipment(&self) -> Equipment<'_> {
        Equipment { folded: &self.folded, tables: &self.tables }
    }

    /// Lets those leave who cannot go the next step together with others. How many steps the rest can go, one where none is
    /// left; nothing where nobody was aboard.
    fn make_ready(&mut self, members: &mut [Member<'_, '_>], backend: Backend) -> Option<u64> {
        let aboard = self.formation.aboard();
        let mut count = self.steps.up_to_multiple_of(SWEPT);
        for lane in lanes(aboard) {
            match members[lane].steps_together() {
                0 => self.leave(lane, &mut members[lane]),
                room => count = count.min(room),
            }
        }
        if (self.formation.aboard().count_ones() as usize) < self.folded.fewest_abreast(backend) {
            self.disband(members);
            count = 1;
        }
        (aboard != 0).then_some(count)
    }

    fn disband(&mut self, members: &mut [Member<'_, '_>]) {
        lanes(self.formation.aboard()).for_each(|lane| self.leave(lane, &mut members[lane]));
    }

    /// Goes on to the step of a number.
    fn fly(&mut self, members: &mut [Member<'_, '_>], next: u64, backend: Backend) {
        while self.formation.aboard() != 0 && self.steps.first < next {
            let steps = Steps { count: next - self.steps.first, ..self.steps };
            let gone = self.folded.steps_abreast(&mut self.formation, &self.tables, &steps, backend);
            self.steps = self.steps.after(gone);
            if gone < steps.count {
                self.part(members);
            }
        }
        self.look_up(members);
        // As alone: what is recorded there still has its dust.
        if self.steps.up_to_multiple_of(SWEPT) == SWEPT {
            self.formation.without_dust(SMALLEST);
        }
    }

    /// Shows what they have come to to all but those that went the last step alone, and have seen it.
    fn look_up(&mut self, members: &mut [Member<'_, '_>]) {
        let (steps, time) = (self.steps, self.formation.time());
        let (mut behind, mut any_due) = (0, false);
        for lane in lanes(self.formation.aboard()) {
            let member = &mut members[lane];
            if member.is_behind(steps) {
                behind |= 1 << lane;
                member.pass(steps.first, time);
                any_due |= member.is_sample_due();
            }
        }
        // What is recorded is worked out where some of it is due.
        if any_due {
            self.formation.work_out(&self.folded.kernel, &self.tables);
        }
        lanes(behind).for_each(|lane| members[lane].look_up(self, lane));
    }

    /// Takes a step in which some meet something: these go alone, and come back where they are still in flight then.
    fn part(&mut self, members: &mut [Member<'_, '_>]) {
        let (mut gone, end) = (0, self.steps.end_of(0));
        loop {
            let beyond = self.formation.beyond();
            lanes(beyond).for_each(|lane| self.leave(lane, &mut members[lane]));
            gone |= beyond;
            if self.formation.go_without(&self.folded.kernel, &self.tables, end) {
                break;
            }
        }
        self.steps = self.steps.after(1);
        for lane in lanes(gone) {
            members[lane].expect_to_meet();
            members[lane].go_alone(self.steps.first);
            if members[lane].in_flight().is_some() {
                self.board(lane, &mut members[lane]);
            }
        }
    }

    fn board(&mut self, lane: usize, member: &mut Member<'_, '_>) {
        let (kernel, formation) = (&self.folded.kernel, &mut self.formation);
        member.flight_mut().into_iter().for_each(|flight| formation.board(kernel, lane, &mut flight.frame));
    }

    fn leave(&mut self, lane: usize, member: &mut Member<'_, '_>) {
        let (kernel, formation) = (&self.folded.kernel, &mut self.formation);
        let Some(flight) = member.flight_mut() else { return };
        formation.leave(kernel, lane, &mut flight.frame);
        let time = flight.time();
        member.pass(self.steps.first, time);
    }
}

impl<'p> Member<'p, '_> {
    /// Does something with the player, unless the run has come to an end.
    fn act(&mut self, act: impl FnOnce(&mut Player<'p, '_>) -> Result<(), RunError>) {
        if self.outcome.is_ok() {
            self.outcome = act(&mut self.player);
        }
    }

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

    fn end_operating(&mut self, operating: Operating<'p>) {
        let operation = self.operation.take();
        let Player { machine, recorder, .. } = &mut self.player;
        let outcome = mem::replace(&mut self.outcome, Ok(()));
        let outcome = outcome
            .and_then(|()| operation.map_or(Ok(()), |operation| machine.end_operation(operation, recorder)));
        self.outcome = self.player.end_operating(operating, outcome);
    }

    /// What it is doing, unless it has done it.
    fn under_way(&self) -> Option<&Operation> {
        self.operation.as_ref().filter(|operation| operation.steps.count > 0 && self.outcome.is_ok())
    }

    fn is_under_way(&self) -> bool {
        self.under_way().is_some()
    }

    /// What it flies with, and the steps before it, where it is in flight.
    fn in_flight(&self) -> Option<(Equipment<'_>, Steps)> {
        let (operation, machine) = (self.under_way()?, &self.player.machine);
        let folded = machine.kernel_of(operation.aloft?);
        Some((Equipment { folded, tables: &machine.program.tables }, operation.steps))
    }

    fn flight_mut(&mut self) -> Option<&mut Flight> {
        Some(self.player.machine.flight_mut(self.operation?.aloft?))
    }

    /// Counts the steps that it has gone in a wing, which is before the step of this number, and tells when it is there.
    fn pass(&mut self, first: u64, time: f64) {
        let Some(operation) = &mut self.operation else { return };
        let (gone, machine) = (first - operation.steps.first, &mut self.player.machine);
        operation.pass(gone);
        machine.work.steps += gone;
        machine.work.evaluations += 4 * gone;
        machine.time = time;
    }

    /// Something is met in the next step.
    fn expect_to_meet(&mut self) {
        let aloft = self.operation.as_mut().and_then(|operation| operation.aloft.as_mut());
        aloft.into_iter().for_each(|aloft| aloft.meets = true);
    }

    /// Whether it is before another step than a wing, in which it is aboard.
    fn is_behind(&self, steps: Steps) -> bool {
        self.operation
            .is_some_and(|operation| operation.aloft.is_some() && operation.steps.first != steps.first)
    }

    /// Whether it has come to an instant that is written down.
    fn is_sample_due(&self) -> bool {
        let Player { machine, recorder, .. } = &self.player;
        recorder.due(machine).is_some()
    }

    /// Sees what a wing has come to.
    fn look_up(&mut self, wing: &Wing, lane: usize) {
        let Some(Operation { aloft: Some(aloft), .. }) = self.operation else { return };
        let Player { machine, recorder, .. } = &mut self.player;
        machine.with_flight(aloft, |machine, flight| {
            wing.formation.show(&wing.folded.kernel, lane, &mut flight.frame);
            recorder.glided_to(machine, flight);
        });
    }

    /// How many steps it can go in a wing.
    fn steps_together(&self) -> u64 {
        let Some(Operation { steps, aloft: Some(aloft), .. }) = self.under_way() else { return 0 };
        steps.until(self.player.recorder.next_sample()).min(aloft.left)
    }

    /// Goes on alone to the step of a number.
    fn go_alone(&mut self, next: u64) {
        let is_under_way = self.is_under_way();
        if let Some(operation) = self.operation.as_mut().filter(|_| is_under_way) {
            let Player { machine, recorder, .. } = &mut self.player;
            self.outcome = machine.go_on(operation, next.saturating_sub(operation.steps.first), recorder);
        }
    }
}

/// The lanes of which a bit is set.
fn lanes(mut bits: u64) -> impl Iterator<Item = usize> {
    std::iter::from_fn(move || {
        let lane = bits.trailing_zeros();
        bits &= bits.wrapping_sub(1);
        (lane < u64::BITS).then_some(lane as usize)
    })
}

fn is_among(bits: u64, lane: usize) -> bool {
    bits >> lane & 1 == 1
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::circuit::Circuit;
    use crate::ir::Program;
    use crate::patch::{ElementBuilder, PatchBuilder};
    use crate::solve::run::ready;
    use crate::solve::{RunSettings, preset};

    /// An integrator that a relay turns back at ±20 V, from many initial voltages.
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
        let turned = |run: u32| {
            let mut program = program.clone();
            preset(&mut program, &[("start", f64::from(run) - 8.0)]).unwrap();
            program
        };
        let record = vec!["A1".to_owned()];
        let settings = RunSettings { record, every: 0.01, ..RunSettings::of(&circuit).unwrap() };
        ((0..16).map(turned).collect(), settings)
    }

    /// Changes of mode, another instant in every run, bring nobody out of step, and most steps are gone side by side.
    #[test]
    fn members_stay_in_step() {
        let (programs, settings) = programs();
        let mut progress = vec![|_: f64| (); programs.len()];
        let pairs = programs.iter().zip(&mut progress);
        let players = pairs.map(|(program, progress)| ready(program, &settings, progress).unwrap());
        let mut convoy = Convoy::new(players.collect(), Backend::Lanes);
        convoy.one(&Phase::InitialCondition);
        for member in &mut convoy.members {
            assert!(member.begin_operating(2.0, None).is_some());
        }
        let (mut next, mut together) = (1, 0);
        while convoy.members.iter().any(Member::is_under_way) {
            let aboard = u64::from(convoy.aboard().count_ones());
            let first = next;
            next = convoy.round(first);
            together += aboard * (next - first);
            let steps = convoy.members.iter().map(|member| member.operation.unwrap().steps);
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
