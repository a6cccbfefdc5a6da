//! Quiet stretches: while no mode changes and no amplifier comes to an end of its range, a kernel of the program takes the
//! steps, and crosses the corners of diodes and tables on its way.

use std::mem;
use std::sync::Arc;

use super::breaks::SAME;
use super::error::RunError;
use super::locate::{self, Ahead};
use super::machine::{Machine, Witness};
use super::stride::{cubic, without_dust};
use crate::ir::Register;
use crate::kernel::{Asked, Backend, Folded, Frame, Kernels, Kind, Look, Met, Stance, Steps};
use crate::machines::REFERENCE;

/// What a machine glides with.
#[derive(Debug, Clone, Default)]
pub(super) struct Glider {
    backend: Backend,
    /// What is recorded.
    seen: Vec<Register>,
    /// One for every stance met.
    flights: Vec<Flight>,
}

/// A kernel at work.
#[derive(Debug, Clone)]
pub(super) struct Flight {
    pub folded: Arc<Folded>,
    backend: Backend,
    pub frame: Frame<f64>,
    /// Whether the factors have to be worked out for the machine's coefficients.
    is_due: bool,
}

/// After so many steps states that are too small to matter are set to 0.
pub(super) const SWEPT: u64 = 64;
/// So many flights are kept.
const MOST_FLIGHTS: usize = 64;
/// More crossings than this within one step are left to the step that tells of chatter.
const MOST_CROSSINGS: usize = 100;

impl Glider {
    /// A glider that gives the voltages of these registers.
    pub fn new(backend: Backend, seen: Vec<Register>) -> Self {
        Glider { backend, seen, flights: Vec::new() }
    }

    /// The coefficients are no longer what they were.
    pub fn forget_factors(&mut self) {
        self.flights.iter_mut().for_each(|flight| flight.is_due = true);
    }

    /// Index of the flight for the machine's stance.
    fn flight(&mut self, machine: &Machine<'_>) -> Option<usize> {
        let stance = Stance { modes: &machine.modes, asked: &machine.asked };
        let known = self.flights.iter().position(|flight| flight.folded.is_for(stance));
        if known.is_some() {
            return known;
        }
        let program = machine.program;
        let folded = Kernels::of(program, stance, &self.seen)?;
        let frame = folded.frame(self.backend);
        if self.flights.len() == MOST_FLIGHTS {
            self.flights.remove(0);
        }
        self.flights.push(Flight { folded, backend: self.backend, frame, is_due: true });
        Some(self.flights.len() - 1)
    }
}

impl Flight {
    /// Begins where the machine is. Tells whether the kernel holds there.
    fn begin(&mut self, machine: &Machine<'_>) -> bool {
        let (kernel, frame) = (&self.folded.kernel, &mut self.frame);
        frame.put_standing(kernel, &machine.kept, &machine.levels);
        frame.states.copy_from_slice(&machine.states);
        frame.rates.copy_from_slice(&machine.slopes);
        frame.time = machine.time;
        let holds = kernel.settle(frame, machine.program, &machine.coefficients, self.is_due);
        frame.see_anew();
        self.is_due = !holds;
        holds
    }

    /// Takes the delay lines over from a machine, or gives them back.
    fn exchange_lines(&mut self, machine: &mut Machine<'_>) {
        mem::swap(&mut self.frame.lines[0], &mut machine.lines);
    }

    /// Goes over to the other side of a corner on which it is. Tells whether the kernel holds there.
    fn cross(&mut self, machine: &Machine<'_>, met: Met) -> bool {
        let Flight { folded, frame, .. } = self;
        let fits = folded.kernel.cross(frame, machine.program, &machine.coefficients, met);
        self.show(&machine.program.tables);
        let Flight { folded, frame, .. } = self;
        let holds = folded.kernel.stand(frame) && fits;
        // What a limit holds from here on is just at it, as it was not before.
        folded.kernel.see_now(frame);
        self.is_due = !holds;
        holds
    }

    /// Goes so many steps of a grid as long as nothing is met: how many were gone. What is recorded is remembered of each, or not.
    fn steps(&mut self, tables: &[Vec<[f64; 2]>], steps: &Steps, is_remembered: bool) -> u64 {
        self.frame.remember(is_remembered);
        self.folded.steps(&mut self.frame, tables, steps, self.backend)
    }

    /// When it is.
    pub fn time(&self) -> f64 {
        self.frame.time
    }

    /// Works the recorded voltages out at an instant within the last step.
    pub fn look_back(&mut self, tables: &[Vec<[f64; 2]>], time: f64) {
        let (kernel, frame) = (&self.folded.kernel, &mut self.frame);
        let [begin, length] = kernel.last_stretch(frame);
        kernel.go_back(frame, tables, time, cubic(length, (time - begin) / length));
        self.folded.work_out(frame, tables, self.backend);
    }

    /// The same where it is.
    pub fn show(&mut self, tables: &[Vec<[f64; 2]>]) {
        self.folded.kernel.stay(&mut self.frame, tables);
        self.folded.work_out(&mut self.frame, tables, self.backend);
    }

    /// The recorded voltages at the end of one of the steps gone last, which are remembered.
    pub fn seen_after(&self, step: u64) -> impl Iterator<Item = f64> + '_ {
        let kernel = &self.folded.kernel;
        (0..kernel.seen.len()).map(move |index| self.frame.seen_after(kernel, step, index))
    }

    /// The recorded voltages as they were worked out last.
    pub fn seen(&self) -> impl Iterator<Item = f64> + '_ {
        let kernel = &self.folded.kernel;
        (0..kernel.seen.len()).map(|index| self.frame.last_seen(kernel, index))
    }

    /// The least and the largest of every recorded voltage since it began, with their instants, in the order in which
    /// they were met; none of one that did not turn.
    pub fn extremes(&self) -> impl Iterator<Item = Option<[(f64, f64); 2]>> + '_ {
        let kernel = &self.folded.kernel;
        (0..kernel.seen.len()).map(|index| self.frame.extremes(kernel, index))
    }
}

/// A flight that is under way.
#[derive(Debug, Clone, Copy)]
pub(super) struct Aloft {
    /// Its index.
    flight: usize,
    /// When the first thing comes that is known to come.
    until: f64,
    /// So many steps are left that end before that.
    pub left: u64,
    /// Whether something is known to be met in the next step.
    pub meets: bool,
}

/// Why a flight goes no further.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Halt {
    /// It could.
    Quiet,
    /// It has come to where something jumps that was known to.
    Jump,
    /// A mode changes so much later.
    Change(f64),
    /// Something is met that it cannot tell of.
    Unclear,
}

impl Machine<'_> {
    /// Begins a flight where the machine is, if that can be: before steps of a grid.
    pub(super) fn take_off(&mut self, steps: Steps) -> Option<Aloft> {
        if self.glider.backend == Backend::Reference || self.sensitivities.is_some() {
            return None;
        }
        self.take_note_of_what_is_asked();
        if self.has_lamps && !self.is_calm() {
            return None;
        }
        let until = self.end_of_flight();
        let left = steps.before(until, SAME * self.step);
        let mut glider = mem::take(&mut self.glider);
        let flight = glider.flight(self);
        if flight.is_none() {
            glider.backend = Backend::Reference;
        }
        let begun = flight.filter(|index| {
            let flight = &mut glider.flights[*index];
            flight.exchange_lines(self);
            let holds = flight.begin(self);
            if !holds {
                flight.exchange_lines(self);
            }
            holds
        });
        self.glider = glider;
        begun.map(|flight| Aloft { flight, until, left, meets: false })
    }

    fn take_note_of_what_is_asked(&mut self) {
        for (asked, lamp) in self.asked.iter_mut().zip(&self.program.lamps) {
            *asked = Asked::of(self.registers[lamp.demand.index()]);
        }
    }

    /// Whether no lamp lights: no amplifier is asked for more than it can give, no integrator is held at ±100 V and driven on.
    /// A kernel lights none.
    fn is_calm(&self) -> bool {
        let at_rest = self.pushed.iter().all(|pushed| *pushed == 0.0);
        let in_range = self.asked.iter().all(|asked| *asked == Asked::Within);
        let mut states = self.program.states.iter().zip(&self.states);
        at_rest
            && in_range
            && states.all(|(state, volts)| {
                volts.abs() < REFERENCE || self.registers[state.demand.index()] * volts <= 0.0
            })
    }

    /// A flight that is under way.
    pub(super) fn flight_mut(&mut self, aloft: Aloft) -> &mut Flight {
        &mut self.glider.flights[aloft.flight]
    }

    /// Its kernel.
    pub(super) fn kernel_of(&self, aloft: Aloft) -> &Arc<Folded> {
        &self.glider.flights[aloft.flight].folded
    }

    /// Does something with a flight that is under way.
    pub(super) fn with_flight<T>(
        &mut self,
        aloft: Aloft,
        act: impl FnOnce(&mut Self, &mut Flight) -> T,
    ) -> T {
        let mut glider = mem::take(&mut self.glider);
        let done = act(self, &mut glider.flights[aloft.flight]);
        self.glider = glider;
        done
    }

    /// Goes steps of a grid as long as they are quiet, and tells how many were gone. Where these are not all, the machine
    /// is on its way through the next, and halted.
    pub(super) fn fly(&mut self, aloft: Aloft, steps: Steps, witness: &mut impl Witness) -> (u64, Halt) {
        self.with_flight(aloft, |machine, flight| machine.fly_with(flight, steps, aloft.meets, witness))
    }

    fn fly_with(
        &mut self,
        flight: &mut Flight,
        steps: Steps,
        mut meets: bool,
        witness: &mut impl Witness,
    ) -> (u64, Halt) {
        let mut gone = 0;
        while gone < steps.count {
            let left = steps.after(gone);
            // Dust is swept on a grid of its own, so that what is recorded changes nothing.
            let most = Steps { count: left.up_to_multiple_of(SWEPT).min(left.count), ..left };
            let remembers = flight.folded.remembers(flight.backend);
            let count = match remembers {
                true => witness.steps_before_stray(most),
                false => most.until(witness.next_sample()),
            };
            let block = Steps { count: if meets { 0 } else { count }, ..left };
            let done = flight.steps(&self.program.tables, &block, remembers);
            meets = false;
            self.work.steps += done;
            self.work.evaluations += 4 * done;
            if done > 0 {
                self.time = flight.frame.time;
                match remembers {
                    true => witness.glided_along(self, flight, Steps { count: done, ..left }),
                    false => witness.glided(self, flight),
                }
            }
            gone += done;
            // What is met is crossed, and a sample within a step is read off that step.
            if done < count || count == 0 {
                match self.fly_across(flight, left.end_of(done), false, witness) {
                    Halt::Quiet => gone += 1,
                    halt => return (gone, halt),
                }
            }
            if steps.after(gone).up_to_multiple_of(SWEPT) == SWEPT {
                without_dust(&mut flight.frame.states);
            }
        }
        (gone, Halt::Quiet)
    }

    /// Goes on to what is known to come before the end of a step, or at it.
    pub(super) fn fly_to_jump(&mut self, aloft: Aloft, end: f64, witness: &mut impl Witness) -> Halt {
        let end = if aloft.until < end - SAME * self.step { aloft.until } else { end };
        self.with_flight(aloft, |machine, flight| machine.fly_across(flight, end, true, witness))
    }

    /// Ends a flight where it is, and was halted.
    pub(super) fn come_down(
        &mut self,
        aloft: Aloft,
        halt: Halt,
        witness: &mut impl Witness,
    ) -> Result<(), RunError> {
        self.with_flight(aloft, |machine, flight| {
            // What was looked at last may lie beyond what stopped it.
            flight.show(&machine.program.tables);
            witness.landed(flight);
            machine.take_over(flight);
            if halt != Halt::Jump {
                machine.work_out_now();
                return machine.check_now();
            }
            machine.work_out_before_now();
            machine.check_now()?;
            witness.before_jump(machine);
            Ok(())
        })
    }

    /// Goes on to a time across every corner, unless something else is met or something jumps at that time. Tells what has
    /// halted it.
    fn fly_across(&mut self, flight: &mut Flight, end: f64, jumps: bool, witness: &mut impl Witness) -> Halt {
        flight.show(&self.program.tables);
        flight.frame.stand();
        for _ in 0..MOST_CROSSINGS {
            let Flight { folded, frame, backend, .. } = flight;
            let mut sight = Sight { folded, frame, backend: *backend, machine: self, last: Look::Quiet };
            let target = folded.kernel.end_of_piece(sight.frame, end);
            let length = target - sight.frame.time;
            sight.look(length);
            // It goes off on the other side from where it is.
            if let Some(met) = folded.kernel.left_behind(sight.frame) {
                if !flight.cross(self, met) {
                    return Halt::Unclear;
                }
                continue;
            }
            // What is beyond a range is left to the machine.
            if sight.event().is_some_and(|met| met.kind == Kind::Range) {
                return Halt::Unclear;
            }
            let (share, met) = locate::first_event(&mut sight, length, None);
            let time = if share >= 1.0 { target } else { sight.frame.time + share * length };
            match met.map(|met| met.kind) {
                Some(Kind::Guard) => return Halt::Change(share * length),
                Some(Kind::Range) => return Halt::Unclear,
                _ if time >= end && jumps => {
                    sight.accept_up_to(time);
                    self.time = time;
                    witness.glided_up_to(self, flight);
                    return Halt::Jump;
                }
                _ => {}
            }
            sight.accept(time);
            if met.is_some() {
                folded.kernel.remember_corner(sight.frame);
            }
            self.time = time;
            witness.glided(self, flight);
            if let Some(met) = met {
                self.work.crossings += 1;
                if !flight.cross(self, met) {
                    return Halt::Unclear;
                }
            }
            if time >= end {
                return Halt::Quiet;
            }
        }
        Halt::Unclear
    }

    /// Goes to where a flight has ended.
    fn take_over(&mut self, flight: &mut Flight) {
        flight.exchange_lines(self);
        self.time = flight.frame.time;
        self.states.copy_from_slice(&flight.frame.states);
        self.kept.copy_from_slice(flight.frame.kept(&flight.folded.kernel));
    }
}

/// A kernel that looks ahead from where its frame is.
struct Sight<'a, 'p> {
    folded: &'a Folded,
    backend: Backend,
    frame: &'a mut Frame<f64>,
    machine: &'a mut Machine<'p>,
    last: Look,
}

impl Sight<'_, '_> {
    fn accept(&mut self, time: f64) {
        self.machine.work.steps += 1;
        self.folded.kernel.take(self.frame, time);
    }

    /// The same; what is due there is left to the machine.
    fn accept_up_to(&mut self, time: f64) {
        self.machine.work.steps += 1;
        self.folded.kernel.take_up_to(self.frame, time);
    }
}

impl Ahead for Sight<'_, '_> {
    type Event = Met;

    fn look(&mut self, length: f64) {
        self.machine.work.evaluations += 4;
        self.last = self.folded.look(self.frame, &self.machine.program.tables, length, self.backend);
    }

    fn event(&self) -> Option<Met> {
        if self.last == Look::Ahead { self.folded.kernel.met(self.frame) } else { None }
    }

    fn is_hinted(&self) -> bool {
        self.last == Look::Within
    }

    fn middle(&self) -> f64 {
        0.5
    }

    fn excess_now(&self, met: Met) -> f64 {
        self.folded.kernel.excess_now(self.frame, met)
    }

    fn excess(&self, met: Met) -> f64 {
        self.folded.kernel.excess(self.frame, met)
    }

    fn room(&self, met: Met) -> f64 {
        met.room()
    }
}
