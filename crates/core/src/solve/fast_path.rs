//! The fast path: long stretches in which no mode changes and no amplifier reaches a limit run in a kernel.
//!
//! A kernel is the program specialised for its present modes and amplifier states, interpreted or compiled. The machine
//! enters the fast path at the beginning of a step ([`Machine::enter_fast_path`]), runs the kernel as far as nothing
//! happens ([`Machine::run_kernel`]), and leaves it with the state where the kernel halted
//! ([`Machine::leave_fast_path`]). Kernels cross corners of diodes and tables by themselves.

use std::mem;
use std::sync::Arc;

use super::dense_output::hermite;
use super::discontinuities::{INSTANT_TOLERANCE, end_of_kernel_run};
use super::error::RunError;
use super::evaluate::Side;
use super::event_location::{EventFunction, first_event};
use super::lamps::Lamps;
use super::machine::Machine;
use super::observer::StepObserver;
use super::runge_kutta::flush_tiny_states;
use super::state::{Solver, SolverState};
use crate::delay_line::DelayLine;
use crate::ir::{Program, Register};
use crate::kernel::{Asked, Backend, Folded, Frame, Kernels, Kind, Look, Met, Stance, Steps};
use crate::machines::REFERENCE;
use crate::trace::Work;

/// After this number of steps, states that are too small to matter are set to 0.
pub(super) const FLUSH_INTERVAL: u64 = 64;
/// At most this many kernel runs are kept. The oldest is dropped for a new one.
const MAX_RUNS: usize = 64;
/// A kernel crosses at most this many corners within one step. The machine then takes the step and detects chatter.
const MAX_CROSSINGS: usize = 100;

/// The kernels of a machine, one for every specialisation that it has met.
#[derive(Debug, Clone)]
pub(super) struct FastPath {
    /// The backend that takes the steps. It is set to the reference if the program has no kernel.
    backend: Backend,
    /// Registers of the recorded voltages.
    recorded: Vec<Register>,
    /// The kernels, the oldest first.
    runs: Vec<KernelRun>,
    /// The state of every amplifier with a lamp when a kernel was looked for last.
    amplifiers: Vec<Asked>,
}

/// A kernel with its variables.
///
/// Between runs the variables are outdated. During a run the kernel also holds the delay lines of the machine, so the
/// machine cannot take steps by itself.
#[derive(Debug, Clone)]
pub(super) struct KernelRun {
    /// The specialised program, shared with other machines of the same program.
    pub folded: Arc<Folded>,
    backend: Backend,
    /// Time, states, rates, delay lines and recorded voltages of the kernel.
    pub frame: Frame<f64>,
    /// Whether the factors have to be calculated from the coefficients before the next start.
    needs_factors: bool,
}

/// A kernel run in progress. It stays valid until the machine leaves the fast path.
#[derive(Debug, Clone, Copy)]
pub(super) struct ActiveRun {
    /// Index of the run.
    run: usize,
    /// The first jump that is known to come, in problem seconds; infinity if there is none.
    until: f64,
    /// Number of steps that end before `until`.
    pub left: u64,
    /// Whether an event is known to come in the next step.
    pub meets: bool,
}

/// The reason why a kernel halted.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Halt {
    /// It took all its steps.
    Quiet,
    /// It is at a known jump.
    Jump,
    /// A mode changes after this time in seconds.
    Change(f64),
    /// It met something that a kernel cannot decide, such as the end of a range.
    Unclear,
}

impl FastPath {
    /// A fast path with the default backend that records nothing.
    pub fn new(program: &Program) -> Self {
        FastPath {
            backend: Backend::default(),
            recorded: Vec::new(),
            runs: Vec::new(),
            amplifiers: vec![Asked::Within; program.lamps.len()],
        }
    }

    /// Drops all kernels, and begins again with another backend and other recorded voltages.
    pub fn restart(&mut self, backend: Backend, recorded: Vec<Register>) {
        (self.backend, self.recorded, self.runs) = (backend, recorded, Vec::new());
    }

    /// Marks the factors of all kernels as outdated, after coefficients changed.
    pub fn forget_factors(&mut self) {
        self.runs.iter_mut().for_each(|run| run.needs_factors = true);
    }

    /// The run in progress.
    pub fn run_mut(&mut self, active: ActiveRun) -> &mut KernelRun {
        &mut self.runs[active.run]
    }

    /// The kernel of the run in progress.
    pub fn kernel(&self, active: ActiveRun) -> &Arc<Folded> {
        &self.runs[active.run].folded
    }

    /// Reads the state of every amplifier with a lamp from the present voltages.
    fn read_amplifiers(&mut self, program: &Program, voltages: &[f64]) {
        for (amplifier, lamp) in self.amplifiers.iter_mut().zip(&program.lamps) {
            *amplifier = Asked::of(voltages[lamp.demand.index()]);
        }
    }

    /// Index of the run for these modes and the amplifier states read last; `None` if the program has no kernel there.
    fn run_for(&mut self, program: &Program, modes: &[f64]) -> Option<usize> {
        let stance = Stance { modes, asked: &self.amplifiers };
        let known = self.runs.iter().position(|run| run.folded.is_for(stance));
        if known.is_some() {
            return known;
        }
        let folded = Kernels::of(program, stance, &self.recorded)?;
        let frame = folded.frame(self.backend);
        if self.runs.len() == MAX_RUNS {
            self.runs.remove(0);
        }
        self.runs.push(KernelRun { folded, backend: self.backend, frame, needs_factors: true });
        Some(self.runs.len() - 1)
    }
}

impl KernelRun {
    /// Takes over the state and the delay lines of a machine. Returns whether the kernel is valid there; if not, the
    /// delay lines are given back.
    fn start(&mut self, program: &Program, state: &SolverState, delay_lines: &mut Vec<DelayLine>) -> bool {
        self.exchange_lines(delay_lines);
        let holds = self.begin(program, state);
        if !holds {
            self.exchange_lines(delay_lines);
        }
        holds
    }

    /// Begins at the state of a machine. Returns whether the kernel is valid there.
    fn begin(&mut self, program: &Program, state: &SolverState) -> bool {
        let (kernel, frame) = (&self.folded.kernel, &mut self.frame);
        frame.put_standing(kernel, &state.sampled, &state.levels);
        frame.states.copy_from_slice(&state.states);
        frame.rates.copy_from_slice(&state.rates);
        frame.time = state.time;
        let holds = kernel.settle(frame, program, &state.coefficients, self.needs_factors);
        frame.see_anew();
        self.needs_factors = !holds;
        holds
    }

    /// Exchanges the delay lines with those of a machine.
    fn exchange_lines(&mut self, delay_lines: &mut Vec<DelayLine>) {
        mem::swap(&mut self.frame.lines[0], delay_lines);
    }

    /// Gives time, states, sampled values and delay lines back to a machine.
    fn hand_back(&mut self, state: &mut SolverState, delay_lines: &mut Vec<DelayLine>) {
        self.exchange_lines(delay_lines);
        state.time = self.frame.time;
        state.states.copy_from_slice(&self.frame.states);
        state.sampled.copy_from_slice(self.frame.kept(&self.folded.kernel));
    }

    /// Crosses the corner at which the kernel is. Returns whether the kernel is valid on the other side.
    fn cross(&mut self, program: &Program, coefficients: &[f64], met: Met) -> bool {
        let KernelRun { folded, frame, .. } = self;
        let fits = folded.kernel.cross(frame, program, coefficients, met);
        self.show(&program.tables);
        let KernelRun { folded, frame, .. } = self;
        let holds = folded.kernel.stand(frame) && fits;
        // A state that a limit holds from here on is exactly at the limit, and was not before.
        folded.kernel.see_now(frame);
        self.needs_factors = !holds;
        holds
    }

    /// Takes steps of a grid until an event comes, and returns the number of steps taken. The recorded voltages at the
    /// end of each are kept if `is_remembered`.
    fn steps(&mut self, tables: &[Vec<[f64; 2]>], steps: &Steps, is_remembered: bool) -> u64 {
        self.frame.remember(is_remembered);
        self.folded.steps(&mut self.frame, tables, steps, self.backend)
    }

    /// The problem time in seconds.
    pub fn time(&self) -> f64 {
        self.frame.time
    }

    /// Evaluates the recorded voltages at a problem time within the last step.
    pub fn interpolate(&mut self, tables: &[Vec<[f64; 2]>], time: f64) {
        let (kernel, frame) = (&self.folded.kernel, &mut self.frame);
        let [begin, length] = kernel.last_stretch(frame);
        kernel.go_back(frame, tables, time, hermite(length, (time - begin) / length));
        self.folded.work_out(frame, tables, self.backend);
    }

    /// Evaluates the recorded voltages at the present time.
    pub fn show(&mut self, tables: &[Vec<[f64; 2]>]) {
        self.folded.kernel.stay(&mut self.frame, tables);
        self.folded.work_out(&mut self.frame, tables, self.backend);
    }

    /// The recorded voltages at the end of one of the steps taken last, if these were kept. Steps count from 0.
    pub fn voltages_after(&self, step: u64) -> impl Iterator<Item = f64> + '_ {
        let kernel = &self.folded.kernel;
        (0..kernel.seen.len()).map(move |index| self.frame.seen_after(kernel, step, index))
    }

    /// The recorded voltages as they were evaluated last.
    pub fn voltages(&self) -> impl Iterator<Item = f64> + '_ {
        let kernel = &self.folded.kernel;
        (0..kernel.seen.len()).map(|index| self.frame.last_seen(kernel, index))
    }

    /// The minimum and the maximum of every recorded voltage since the start, each as problem time and volts, in the
    /// order in which they came; `None` for a voltage without extremum.
    pub fn extremes(&self) -> impl Iterator<Item = Option<[(f64, f64); 2]>> + '_ {
        let kernel = &self.folded.kernel;
        (0..kernel.seen.len()).map(|index| self.frame.extremes(kernel, index))
    }
}

impl Machine<'_> {
    /// Enters the fast path before the first of these steps: finds or makes the kernel for the present modes and
    /// amplifier states, and hands the state over to it. Returns `None` if that is not possible: with the reference
    /// backend, with derivatives, with a lamp that is due, or if the program has no kernel for its present modes.
    pub(super) fn enter_fast_path(&mut self, steps: Steps) -> Option<ActiveRun> {
        let Machine { solver, events, lamps, fast_path, .. } = self;
        if fast_path.backend == Backend::Reference || solver.sensitivities.is_some() {
            return None;
        }
        let Solver { setup, state, delay_lines, .. } = solver;
        fast_path.read_amplifiers(setup.program, &state.voltages);
        if lamps.is_on && !is_no_lamp_due(setup.program, state, &fast_path.amplifiers, lamps) {
            return None;
        }
        let until = end_of_kernel_run(setup, state, delay_lines, &events.corners_off_grid);
        let left = steps.before(until, INSTANT_TOLERANCE * setup.step);
        let Some(run) = fast_path.run_for(setup.program, &state.modes) else {
            fast_path.backend = Backend::Reference;
            return None;
        };
        let is_started = fast_path.runs[run].start(setup.program, state, delay_lines);
        is_started.then_some(ActiveRun { run, until, left, meets: false })
    }

    /// Runs the kernel for some steps of a grid. Returns the number of steps taken and why it halted. If not all steps
    /// were taken, the machine is inside the next one, or at its beginning.
    pub(super) fn run_kernel(
        &mut self,
        active: ActiveRun,
        steps: Steps,
        observer: &mut impl StepObserver,
    ) -> (u64, Halt) {
        let Machine { solver, fast_path, work, .. } = self;
        let run = &mut fast_path.runs[active.run];
        run_steps(solver.setup.program, &mut solver.state, work, run, steps, active.meets, observer)
    }

    /// Runs the kernel to the known jump, or to `end` if that comes first. The result is [`Halt::Jump`] if it reached
    /// that time, even if nothing jumps at `end`: the machine then carries out whatever is due there.
    pub(super) fn run_kernel_to(
        &mut self,
        active: ActiveRun,
        end: f64,
        observer: &mut impl StepObserver,
    ) -> Halt {
        let Machine { solver, fast_path, work, .. } = self;
        let Solver { setup, state, .. } = solver;
        let end = if active.until < end - INSTANT_TOLERANCE * setup.step { active.until } else { end };
        step_across(setup.program, state, work, &mut fast_path.runs[active.run], end, true, observer)
    }

    /// Leaves the fast path where the kernel halted, and evaluates all voltages there. At a jump the voltages are those
    /// before it.
    pub(super) fn leave_fast_path(
        &mut self,
        active: ActiveRun,
        halt: Halt,
        observer: &mut impl StepObserver,
    ) -> Result<(), RunError> {
        let Machine { solver, fast_path, .. } = &mut *self;
        let run = &mut fast_path.runs[active.run];
        // The kernel may have evaluated a later instant last.
        run.show(&solver.setup.program.tables);
        observer.left_fast_path(run);
        run.hand_back(&mut solver.state, &mut solver.delay_lines);
        if halt != Halt::Jump {
            return self.show_side(Side::After);
        }
        self.show_side(Side::Before)?;
        observer.before_jump(&self.solver);
        Ok(())
    }

    /// Counts steps that a batch took for this machine up to a problem time. Each step takes four evaluations.
    pub(super) fn note_kernel_steps(&mut self, count: u64, time: f64) {
        self.work.steps += count;
        self.work.evaluations += 4 * count;
        self.solver.state.time = time;
    }
}

/// Whether no lamp can light within a kernel run: no amplifier is driven beyond its range, and no integrator is held at
/// ±100 V and driven further. Kernels light no lamps.
fn is_no_lamp_due(program: &Program, state: &SolverState, amplifiers: &[Asked], lamps: &Lamps) -> bool {
    let at_rest = lamps.overdrive.iter().all(|overdrive| *overdrive == 0.0);
    let in_range = amplifiers.iter().all(|amplifier| *amplifier == Asked::Within);
    let mut states = program.states.iter().zip(&state.states);
    at_rest
        && in_range
        && states
            .all(|(own, volts)| volts.abs() < REFERENCE || state.voltages[own.demand.index()] * volts <= 0.0)
}

/// Runs a kernel for some steps of a grid, in blocks that end where a sample is due or tiny states are flushed. `meets`
/// is whether an event comes in the first step. Returns the number of steps taken and why the kernel halted.
fn run_steps(
    program: &Program,
    state: &mut SolverState,
    work: &mut Work,
    run: &mut KernelRun,
    steps: Steps,
    mut meets: bool,
    observer: &mut impl StepObserver,
) -> (u64, Halt) {
    let mut taken = 0;
    while taken < steps.count {
        let left = steps.after(taken);
        // Tiny states are flushed on a separate grid, so that recording changes no bit.
        let most = Steps { count: left.up_to_multiple_of(FLUSH_INTERVAL).min(left.count), ..left };
        let remembers = run.folded.remembers(run.backend);
        let count = match remembers {
            true => observer.steps_before_inner_sample(most),
            false => most.until(observer.next_sample()),
        };
        let block = Steps { count: if meets { 0 } else { count }, ..left };
        let done = run.steps(&program.tables, &block, remembers);
        meets = false;
        work.steps += done;
        work.evaluations += 4 * done;
        if done > 0 {
            state.time = run.frame.time;
            match remembers {
                true => observer.kernel_stepped_recording(state.time, run, Steps { count: done, ..left }),
                false => observer.kernel_stepped(state.time, &program.tables, run),
            }
        }
        taken += done;
        // An event is crossed within the step, and a sample within a step is interpolated in it.
        if done < count || count == 0 {
            match step_across(program, state, work, run, left.end_of(done), false, observer) {
                Halt::Quiet => taken += 1,
                halt => return (taken, halt),
            }
        }
        if steps.after(taken).up_to_multiple_of(FLUSH_INTERVAL) == FLUSH_INTERVAL {
            flush_tiny_states(&mut run.frame.states);
        }
    }
    (taken, Halt::Quiet)
}

/// Runs a kernel to a problem time and across every corner on the way. Each pass of the loop tries a step to the end of
/// the present piece, locates the first event in it, and accepts the step up to the event. It halts at other events,
/// and at `end` if something `jumps` there.
fn step_across(
    program: &Program,
    state: &mut SolverState,
    work: &mut Work,
    run: &mut KernelRun,
    end: f64,
    jumps: bool,
    observer: &mut impl StepObserver,
) -> Halt {
    let tables: &[Vec<[f64; 2]>] = &program.tables;
    run.show(tables);
    run.frame.stand();
    for _ in 0..MAX_CROSSINGS {
        let KernelRun { folded, frame, backend, .. } = &mut *run;
        let mut trial =
            KernelTrial { folded, frame, backend: *backend, tables, work: &mut *work, last: Look::Quiet };
        let target = folded.kernel.end_of_piece(trial.frame, end);
        let length = target - trial.frame.time;
        trial.evaluate(length);
        // The kernel leaves the corner to the other side than the one it is on.
        if let Some(met) = folded.kernel.left_behind(trial.frame) {
            if !run.cross(program, &state.coefficients, met) {
                return Halt::Unclear;
            }
            continue;
        }
        // The machine takes the step if a range ends.
        if trial.event().is_some_and(|met| met.kind == Kind::Range) {
            return Halt::Unclear;
        }
        let (share, met) = first_event(&mut trial, length, None);
        let time = if share >= 1.0 { target } else { trial.frame.time + share * length };
        match met.map(|met| met.kind) {
            Some(Kind::Guard) => return Halt::Change(share * length),
            Some(Kind::Range) => return Halt::Unclear,
            _ if time >= end && jumps => {
                trial.accept_up_to(time);
                state.time = time;
                observer.kernel_reached_jump(time, tables, run);
                return Halt::Jump;
            }
            _ => {}
        }
        trial.accept(time);
        if met.is_some() {
            folded.kernel.remember_corner(trial.frame);
        }
        state.time = time;
        observer.kernel_stepped(time, tables, run);
        if let Some(met) = met {
            work.crossings += 1;
            if !run.cross(program, &state.coefficients, met) {
                return Halt::Unclear;
            }
        }
        if time >= end {
            return Halt::Quiet;
        }
    }
    Halt::Unclear
}

/// A tried step of a kernel, in which events are located. Its values are in volts, as those of the machine.
struct KernelTrial<'a> {
    folded: &'a Folded,
    backend: Backend,
    frame: &'a mut Frame<f64>,
    tables: &'a [Vec<[f64; 2]>],
    work: &'a mut Work,
    /// The result of the step tried last.
    last: Look,
}

impl KernelTrial<'_> {
    /// Accepts the tried step up to a time.
    fn accept(&mut self, time: f64) {
        self.work.steps += 1;
        self.folded.kernel.take(self.frame, time);
    }

    /// Accepts the tried step up to a jump, which the machine carries out.
    fn accept_up_to(&mut self, time: f64) {
        self.work.steps += 1;
        self.folded.kernel.take_up_to(self.frame, time);
    }
}

impl EventFunction for KernelTrial<'_> {
    type Event = Met;

    fn evaluate(&mut self, length: f64) {
        self.work.evaluations += 4;
        self.last = self.folded.look(self.frame, self.tables, length, self.backend);
    }

    fn event(&self) -> Option<Met> {
        if self.last == Look::Ahead { self.folded.kernel.met(self.frame) } else { None }
    }

    fn has_hint(&self) -> bool {
        self.last == Look::Within
    }

    fn hint_share(&self) -> f64 {
        0.5
    }

    fn present_value(&self, met: Met) -> f64 {
        self.folded.kernel.excess_now(self.frame, met)
    }

    fn value(&self, met: Met) -> f64 {
        self.folded.kernel.excess(self.frame, met)
    }

    fn tolerance(&self, met: Met) -> f64 {
        met.room()
    }
}
