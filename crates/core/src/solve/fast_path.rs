//! The fast path: while no mode changes and no amplifier enters or leaves overload, a kernel takes the equal steps.
//!
//! A kernel is the program specialised to its present modes and amplifier states, interpreted or compiled. The machine
//! enters the fast path at the beginning of a step ([`Machine::enter_fast_path`]). It runs the kernel until an event or
//! a jump is due ([`Machine::run_kernel`]), and takes over the state where the kernel halted
//! ([`Machine::leave_fast_path`]). Kernels cross corners of diodes and tables by themselves.
//!
//! Runs with and without the fast path give the same results, apart from rounding.

mod kernel_run;
mod trial;

use std::sync::Arc;

use super::discontinuities::{INSTANT_TOLERANCE, end_of_kernel_run};
use super::error::RunError;
use super::evaluate::Side;
use super::lamps::Lamps;
use super::machine::Machine;
use super::observer::StepObserver;
use super::runge_kutta::flush_tiny_states;
use super::state::{Solver, SolverState};
use crate::ir::{Program, Register};
use crate::kernel::{AmplifierState, Backend, Frame, Kernels, SharedKernel, Specialisation, Steps};
use crate::machines::REFERENCE;
use crate::trace::WorkCounters;
use trial::TrialEnd;

/// Number of steps of the grid after which states below [`MIN_STATE`](super::runge_kutta::MIN_STATE) are set to 0.
/// From there a decay needs many more steps to reach subnormal numbers.
pub(super) const FLUSH_INTERVAL: u64 = 64;
/// Largest number of kernel runs that a machine keeps. The oldest is dropped for a new one.
const MAX_RUNS: usize = 64;
/// Largest number of corners that a kernel crosses within one step. If there are more, the machine takes the step
/// without the kernel, and detects chatter.
const MAX_CROSSINGS: usize = 100;

/// The kernels of a machine, one for every specialisation in which it has run.
#[derive(Debug, Clone)]
pub(super) struct FastPath {
    /// The backend that takes the steps. It is set to the reference if the program turns out to have no kernel.
    backend: Backend,
    /// Registers of the recorded voltages, in the order of the tracks.
    recorded_registers: Vec<Register>,
    /// The kernels with their variables, the oldest first.
    runs: Vec<KernelRun>,
    /// The state of every amplifier with a lamp when the fast path was entered last, in the order of `Program::lamps`.
    amplifiers: Vec<AmplifierState>,
}

/// A kernel with its variables.
///
/// Between runs the variables are outdated. During a run the frame also contains the delay lines of the machine, so the
/// machine cannot take steps by itself.
#[derive(Debug, Clone)]
pub(super) struct KernelRun {
    /// The specialised program, which all machines of the same program share.
    pub shared: Arc<SharedKernel>,
    /// The backend that runs the kernel.
    backend: Backend,
    /// Time, states, rates, delay lines and recorded voltages of the kernel.
    pub frame: Frame<f64>,
    /// Whether the factors have to be calculated from the coefficients before the next start: at first, after a change
    /// of coefficients, and after the kernel was invalid.
    has_outdated_factors: bool,
    /// Whether the extremes are those of an earlier initial condition.
    has_outdated_extremes: bool,
}

/// A kernel run in progress. It stays valid until the machine leaves the fast path.
#[derive(Debug, Clone, Copy)]
pub(super) struct ActiveRun {
    /// Index of the kernel in `FastPath::runs`.
    run: usize,
    /// The time of the first known jump, in problem seconds; infinity if there is none.
    jump_time: f64,
    /// Number of whole steps that end before `jump_time`.
    pub steps_left: u64,
    /// Whether an event is known to occur in the next step.
    pub is_event_next: bool,
}

/// The reason why a kernel halted.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Halt {
    /// It took all its steps.
    Completed,
    /// It is at a known jump.
    Jump,
    /// A mode changes after this time from the present, in problem seconds.
    ModeChange(f64),
    /// Only the machine can take the next step, for example because an amplifier reaches the end of its range.
    Unsupported,
}

impl FastPath {
    /// A fast path with the default backend that records nothing.
    pub(super) fn new(program: &Program) -> Self {
        FastPath {
            backend: Backend::default(),
            recorded_registers: Vec::new(),
            runs: Vec::new(),
            amplifiers: vec![AmplifierState::Within; program.lowered.lamps.len()],
        }
    }

    /// Drops all kernels, and sets another backend and other recorded voltages.
    pub(super) fn restart(&mut self, backend: Backend, recorded_registers: Vec<Register>) {
        (self.backend, self.recorded_registers, self.runs) = (backend, recorded_registers, Vec::new());
    }

    /// Marks the factors of all kernels as outdated. Call it after coefficients changed.
    pub(super) fn invalidate_factors(&mut self) {
        self.runs.iter_mut().for_each(|run| run.has_outdated_factors = true);
    }

    /// Marks the extremes of all kernels as outdated, for a new initial condition.
    pub(super) fn invalidate_extremes(&mut self) {
        self.runs.iter_mut().for_each(|run| run.has_outdated_extremes = true);
    }

    /// The kernel run in progress.
    pub(super) fn run_mut(&mut self, active: ActiveRun) -> &mut KernelRun {
        &mut self.runs[active.run]
    }

    /// The kernel of the run in progress.
    pub(super) fn kernel(&self, active: ActiveRun) -> &Arc<SharedKernel> {
        &self.runs[active.run].shared
    }

    /// Reads the state of every amplifier with a lamp from the present voltages.
    fn read_amplifiers(&mut self, program: &Program, voltages: &[f64]) {
        for (amplifier, lamp) in self.amplifiers.iter_mut().zip(&program.lowered.lamps) {
            *amplifier = AmplifierState::of(voltages[lamp.demand.index()]);
        }
    }

    /// Index of the kernel run for these modes and the amplifier states read last; `None` if the program has no kernel.
    fn find_or_make_run(&mut self, program: &Program, modes: &[f64]) -> Option<usize> {
        let specialisation = Specialisation { modes, amplifiers: &self.amplifiers };
        let existing = self.runs.iter().position(|run| run.shared.is_for(specialisation));
        if existing.is_some() {
            return existing;
        }
        let shared = Kernels::of(program, specialisation, &self.recorded_registers)?;
        let frame = shared.frame(self.backend);
        if self.runs.len() == MAX_RUNS {
            self.runs.remove(0);
        }
        self.runs.push(KernelRun {
            shared,
            backend: self.backend,
            frame,
            has_outdated_factors: true,
            has_outdated_extremes: true,
        });
        Some(self.runs.len() - 1)
    }
}

impl Machine<'_> {
    /// Enters the fast path before the first of these steps: finds or makes the kernel for the present modes and
    /// amplifier states, and moves the state into it. Returns `None` if that is not possible: with the reference
    /// backend, with derivatives, while a lamp can light, or if the program has no kernel that is valid at present.
    pub(super) fn enter_fast_path(&mut self, steps: Steps) -> Option<ActiveRun> {
        let Machine { solver, events, lamps, fast_path, .. } = self;
        if fast_path.backend == Backend::Reference || solver.sensitivities.is_some() {
            return None;
        }
        let Solver { setup, state, delay_lines, .. } = solver;
        fast_path.read_amplifiers(setup.program, &state.voltages);
        if lamps.is_on && !has_no_lamp_due(setup.program, state, &fast_path.amplifiers, lamps) {
            return None;
        }
        let jump_time = end_of_kernel_run(setup, state, delay_lines, &events.corners_off_grid);
        let steps_left = steps.before(jump_time, INSTANT_TOLERANCE * setup.step);
        let Some(run) = fast_path.find_or_make_run(setup.program, &state.modes) else {
            fast_path.backend = Backend::Reference;
            return None;
        };
        let is_started = fast_path.runs[run].start(setup.program, state, delay_lines);
        is_started.then_some(ActiveRun { run, jump_time, steps_left, is_event_next: false })
    }

    /// Runs the kernel for some steps of a grid. Returns the number of whole steps taken and why the kernel halted. If
    /// not all steps were taken, the machine is inside the next one, or at its beginning.
    pub(super) fn run_kernel(
        &mut self,
        active: ActiveRun,
        steps: Steps,
        observer: &mut impl StepObserver,
    ) -> (u64, Halt) {
        let Machine { solver, fast_path, work, .. } = self;
        let run = &mut fast_path.runs[active.run];
        run_steps(solver.setup.program, &mut solver.state, work, run, steps, active.is_event_next, observer)
    }

    /// Runs the kernel to the known jump, or to the problem time `end` if that is earlier. The result is [`Halt::Jump`]
    /// if the kernel reached that time, also if no voltage jumps at `end`. The machine then handles what is due there.
    pub(super) fn run_kernel_to(
        &mut self,
        active: ActiveRun,
        end: f64,
        observer: &mut impl StepObserver,
    ) -> Halt {
        let Machine { solver, fast_path, work, .. } = self;
        let Solver { setup, state, .. } = solver;
        let end =
            if active.jump_time < end - INSTANT_TOLERANCE * setup.step { active.jump_time } else { end };
        step_across(setup.program, state, work, &mut fast_path.runs[active.run], end, true, observer)
    }

    /// Leaves the fast path where the kernel halted, and evaluates all voltages there. At a jump the voltages are those
    /// before it, and the caller handles the jump.
    ///
    /// # Errors
    /// If a voltage is not a number, or a loop does not have exactly one solution.
    pub(super) fn leave_fast_path(
        &mut self,
        active: ActiveRun,
        halt: Halt,
        observer: &mut impl StepObserver,
    ) -> Result<(), RunError> {
        let Machine { solver, fast_path, .. } = &mut *self;
        let run = &mut fast_path.runs[active.run];
        // The kernel may have evaluated a later instant last.
        run.evaluate_present(&solver.setup.program.tables);
        observer.left_fast_path(run);
        run.return_state(&mut solver.state, &mut solver.delay_lines);
        if halt != Halt::Jump {
            return self.evaluate_side(Side::After);
        }
        self.evaluate_side(Side::Before)?;
        observer.before_jump(&self.solver);
        Ok(())
    }

    /// Counts steps that a batch took for this machine up to a problem time. Each step counts as four evaluations.
    pub(super) fn count_kernel_steps(&mut self, count: u64, time: f64) {
        self.work.steps += count;
        self.work.evaluations += 4 * count;
        self.solver.state.time = time;
    }
}

/// Whether no lamp can light within a kernel run: no amplifier is demanded beyond its range, and no integrator is held
/// at ±100 V and driven further. Kernels light no lamps; they halt at the end of a range instead.
fn has_no_lamp_due(
    program: &Program,
    state: &SolverState,
    amplifiers: &[AmplifierState],
    lamps: &Lamps,
) -> bool {
    let has_no_overdrive = lamps.overdrive.iter().all(|overdrive| *overdrive == 0.0);
    let are_in_range = amplifiers.iter().all(|amplifier| *amplifier == AmplifierState::Within);
    let mut states = program.lowered.states.iter().zip(&state.states);
    has_no_overdrive
        && are_in_range
        && states.all(|(integrator, volts)| {
            volts.abs() < REFERENCE || state.voltages[integrator.demand.index()] * volts <= 0.0
        })
}

/// Runs a kernel for some steps of a grid, in blocks that end where a sample is due or tiny states are flushed.
/// `is_event_next` is whether an event is due in the first step. Returns the number of whole steps taken and why the
/// kernel halted.
fn run_steps(
    program: &Program,
    state: &mut SolverState,
    work: &mut WorkCounters,
    run: &mut KernelRun,
    steps: Steps,
    mut is_event_next: bool,
    observer: &mut impl StepObserver,
) -> (u64, Halt) {
    let mut taken = 0;
    while taken < steps.count {
        let remaining = steps.after(taken);
        let has_trail = run.shared.can_keep_trail(run.backend);
        let count = block_length(remaining, has_trail, observer);
        let block = Steps { count: if is_event_next { 0 } else { count }, ..remaining };
        let done = run.steps(&program.tables, &block, has_trail);
        is_event_next = false;
        work.steps += done;
        work.evaluations += 4 * done;
        if done > 0 {
            state.time = run.frame.time;
            match has_trail {
                true => {
                    observer.kernel_stepped_recording(state.time, run, Steps { count: done, ..remaining })
                }
                false => observer.kernel_stepped(state.time, &program.tables, run),
            }
        }
        taken += done;
        // An event is crossed within the step, and a sample within a step is interpolated in it.
        if done < count || count == 0 {
            match step_across(program, state, work, run, remaining.end_of(done), false, observer) {
                Halt::Completed => taken += 1,
                halt => return (taken, halt),
            }
        }
        if steps.after(taken).up_to_multiple_of(FLUSH_INTERVAL) == FLUSH_INTERVAL {
            flush_tiny_states(&mut run.frame.states);
        }
        if observer.is_cancelled() {
            return (taken, Halt::Unsupported);
        }
    }
    (taken, Halt::Completed)
}

/// The number of steps up to the next sample or the next flush of tiny states. If `has_trail`, samples at the ends of
/// steps are written afterwards, and only a sample within a step ends the block.
fn block_length(remaining: Steps, has_trail: bool, observer: &impl StepObserver) -> u64 {
    // Tiny states are flushed on a separate grid, so that recording changes no bit.
    let flush_block =
        Steps { count: remaining.up_to_multiple_of(FLUSH_INTERVAL).min(remaining.count), ..remaining };
    match has_trail {
        true => observer.steps_before_inner_sample(flush_block),
        false => flush_block.until(observer.next_sample()),
    }
}

/// Runs a kernel to the problem time `end`, and crosses every corner before it. Each pass of the loop tries a step to
/// the end of the present piece, locates the first event in it, and accepts the step up to the event. The kernel halts
/// at other events, and at `end` if `is_jump_at_end`.
fn step_across(
    program: &Program,
    state: &mut SolverState,
    work: &mut WorkCounters,
    run: &mut KernelRun,
    end: f64,
    is_jump_at_end: bool,
    observer: &mut impl StepObserver,
) -> Halt {
    let tables: &[Vec<[f64; 2]>] = &program.tables;
    run.evaluate_present(tables);
    run.frame.accept_present();
    for _ in 0..MAX_CROSSINGS {
        let mut trial = run.trial(tables, work);
        let (time, corner) = match trial.locate_end(end) {
            TrialEnd::OnCorner(hit) => {
                if !run.cross_corner(program, &state.coefficients, hit) {
                    return Halt::Unsupported;
                }
                continue;
            }
            TrialEnd::Halted(halt) => return halt,
            TrialEnd::At { time, corner } => (time, corner),
        };
        if time >= end && is_jump_at_end {
            trial.accept_up_to(time);
            state.time = time;
            observer.kernel_reached_jump(time, tables, run);
            return Halt::Jump;
        }
        trial.accept(time, corner.is_some());
        state.time = time;
        observer.kernel_stepped(time, tables, run);
        if let Some(hit) = corner {
            work.crossings += 1;
            observer.kernel_at_corner(time, tables, run);
            if !run.cross_corner(program, &state.coefficients, hit) {
                return Halt::Unsupported;
            }
        }
        if time >= end {
            return Halt::Completed;
        }
    }
    Halt::Unsupported
}
