//! The machine: a program with a solver, events, lamps and a clock, in one of the modes of an analogue computer.
//!
//! The parts of a machine are separate fields, so that each function borrows only what it needs. Evaluation and steps
//! need the [`Solver`]. Located events also need [`EventState`]. While no event is due, a kernel takes the steps
//! ([`FastPath`]). This module contains construction, initial condition and the acceptance of a step. The loops that
//! advance time are in `operation` and `events`, and the measurements in `readings`.

use super::amplifier_peaks::AmplifierPeaks;
use super::buffers::StepBuffers;
use super::controls::check_times;
use super::error::RunError;
use super::evaluate::{Side, check_voltages};
use super::events::{EventState, settle_modes};
use super::fast_path::FastPath;
use super::lamps::Lamps;
use super::levels::{LevelSource, jump_rate};
use super::observer::{NoObserver, StepObserver};
use super::settings_check::MAX_STEPS;
use super::settings_check::check_tolerance;
use super::state::{Setup, Solver, SolverState};
use super::step_check::StepCheck;
use super::step_control::StepControl;
use super::tableau::{CLASSICAL, DORMAND_PRINCE, Tableau};
use super::time_setting::TimeSetting;
use crate::delay_line::DelayLine;
use crate::grid::Grid;
use crate::ir::Program;
use crate::kernel::Backend;
use crate::trace::WorkCounters;

/// The mode of operation of a machine.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum MachineMode {
    /// Integrators are at their initial conditions and all other elements compute. The problem check uses this mode.
    InitialCondition,
    /// Integrators integrate, and problem time advances.
    Operate,
    /// Integrators keep their outputs and problem time does not advance. Parameters can be set and voltages read.
    Hold,
}

/// A program that can be run step by step.
///
/// All times are problem times in seconds. Equal steps use the classical Runge-Kutta method of order 4
/// ([`Machine::new`]). Steps that adapt to a tolerance use the pair of orders 5 and 4 of Dormand and Prince
/// ([`Machine::adaptive`]). Steps end at changes of mode (relays, brakes, stops) and at kinks (diodes, limits, tables).
/// These events are located within the step.
///
/// # Examples
///
/// ```
/// use patchcord_core::circuit::Circuit;
/// use patchcord_core::ir::Program;
/// use patchcord_core::patch::{ElementBuilder, PatchBuilder};
/// use patchcord_core::solve::Machine;
///
/// // dx/dt = -x, from 50 V
/// let decay = ElementBuilder::new("integrator").cords("x1", ["A1"]).set("initial", 50);
/// let patch = PatchBuilder::new("decay").element("A1", decay).build()?;
/// let program = Program::new(&Circuit::new(&patch)?)?;
/// let mut machine = Machine::new(&program, 1e-3)?;
/// machine.operate(1.0)?;
/// assert!((machine.voltage("A1")? - 50.0 * (-1.0f64).exp()).abs() < 1e-9);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone)]
pub struct Machine<'p> {
    /// The state at the present instant, and everything needed to take a step from it.
    pub(super) solver: Solver<'p>,
    /// The control of the step size; `None` for equal steps.
    pub(super) control: Option<StepControl>,
    /// Counts of events, by which chatter is detected.
    pub(super) events: EventState,
    /// The overload lamps.
    pub(super) lamps: Lamps,
    /// The kernels for steps without events.
    pub(super) fast_path: FastPath,
    /// The mode of operation.
    pub(super) mode: MachineMode,
    /// Work done since the last initial condition.
    pub(super) work: WorkCounters,
    /// Largest number of steps of a run.
    pub(super) max_steps: f64,
    /// Checks of the equal steps; `None` if there are none.
    pub(super) step_check: Option<StepCheck>,
    /// The largest outputs of all amplifiers; `None` if they are not needed.
    pub(super) amplifier_peaks: Option<AmplifierPeaks>,
}

impl<'p> Machine<'p> {
    /// Makes a machine in initial condition with equal steps, given in problem seconds.
    ///
    /// # Errors
    /// If the step is not a positive time, a delay or a lag is shorter than the step, or
    /// [`Machine::initial_condition`] fails.
    ///
    /// # Examples
    ///
    /// ```
    /// use patchcord_core::circuit::Circuit;
    /// use patchcord_core::ir::Program;
    /// use patchcord_core::patch::{ElementBuilder, PatchBuilder};
    /// use patchcord_core::solve::Machine;
    ///
    /// // dx/dt = -x, from 50 V
    /// let decay = ElementBuilder::new("integrator").cords("x1", ["A1"]).set("initial", 50);
    /// let patch = PatchBuilder::new("decay").element("A1", decay).build()?;
    /// let program = Program::new(&Circuit::new(&patch)?)?;
    /// let machine = Machine::new(&program, 1e-3)?;
    /// assert_eq!((machine.time(), machine.step(), machine.voltage("A1")?), (0.0, 1e-3, 50.0));
    /// let error = Machine::new(&program, 0.0).unwrap_err();
    /// assert_eq!(error.to_string(), "the step must be positive and finite, got 0 s");
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn new(program: &'p Program, step: f64) -> Result<Self, RunError> {
        Machine::allocate(program, step, &CLASSICAL, None)?.start()
    }

    /// Makes a machine in initial condition whose steps adapt to a tolerance. The tolerance bounds the sum of the
    /// errors of the steps of one problem second, in any state, in machine units of 100 V. `first` is the length of the
    /// first step tried, in problem seconds.
    ///
    /// # Errors
    /// If the tolerance is not from [`MIN_TOLERANCE`](super::MIN_TOLERANCE) to
    /// [`MAX_TOLERANCE`](super::MAX_TOLERANCE), the first step is not a positive time, or
    /// [`Machine::initial_condition`] fails.
    ///
    /// # Examples
    ///
    /// ```
    /// use patchcord_core::circuit::Circuit;
    /// use patchcord_core::ir::Program;
    /// use patchcord_core::patch::{ElementBuilder, PatchBuilder};
    /// use patchcord_core::solve::Machine;
    ///
    /// // dx/dt = -x, from 50 V
    /// let decay = ElementBuilder::new("integrator").cords("x1", ["A1"]).set("initial", 50);
    /// let patch = PatchBuilder::new("decay").element("A1", decay).build()?;
    /// let program = Program::new(&Circuit::new(&patch)?)?;
    /// let mut machine = Machine::adaptive(&program, 1e-9, 1e-3)?;
    /// machine.operate(1.0)?;
    /// assert!((machine.voltage("A1")? - 50.0 * (-1.0f64).exp()).abs() < 1e-5);
    /// assert_eq!(Machine::adaptive(&program, 0.0, 1e-3).unwrap_err().code(), "not-a-tolerance");
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn adaptive(program: &'p Program, tolerance: f64, first: f64) -> Result<Self, RunError> {
        check_tolerance(tolerance)?;
        Machine::with_error_rate(program, tolerance, first)
    }

    /// The same for an error per problem second that need not be a tolerance of a run. A long or short run divides its
    /// tolerance by its duration, and the quotient may be outside the range of tolerances.
    ///
    /// # Errors
    /// If the first step is not a positive time, or [`Machine::initial_condition`] fails.
    pub(super) fn with_error_rate(program: &'p Program, rate: f64, first: f64) -> Result<Self, RunError> {
        let control = StepControl::new(rate, first);
        Machine::allocate(program, first, &DORMAND_PRINCE, Some(control))?.start()
    }

    /// The same machine with another backend for its steps. All backends except the reference give the same bits.
    pub fn with_backend(mut self, backend: Backend) -> Self {
        self.fast_path.restart(backend, Vec::new());
        self
    }

    /// Checks the time constants, and puts the machine into initial condition.
    ///
    /// # Errors
    /// If a delay or a lag is shorter than equal steps, or [`Machine::initial_condition`] fails.
    fn start(mut self) -> Result<Self, RunError> {
        check_times(&self.solver)?;
        self.initial_condition()?;
        Ok(self)
    }

    /// Makes a machine with all its buffers. No voltage is evaluated yet.
    ///
    /// # Errors
    /// If the step is not positive and finite.
    fn allocate(
        program: &'p Program,
        step: f64,
        method: &'static Tableau,
        control: Option<StepControl>,
    ) -> Result<Self, RunError> {
        if !(step > 0.0 && step.is_finite()) {
            return Err(RunError::NotATime { which: TimeSetting::Step, value: step });
        }
        let parameters: Vec<f64> = program.parameters.iter().map(|parameter| parameter.value).collect();
        let coefficients = program.prepare(&parameters);
        let setup = Setup { program, method, step, grid: Grid::new(step), is_adaptive: control.is_some() };
        let solver = Solver {
            setup,
            delay_lines: delay_lines(program, &coefficients, step),
            state: SolverState::new(program, parameters, coefficients),
            buffers: StepBuffers::new(program, method),
            sensitivities: None,
        };
        Ok(Machine {
            solver,
            control,
            events: EventState::new(program),
            lamps: Lamps::new(program),
            fast_path: FastPath::new(program),
            mode: MachineMode::InitialCondition,
            work: WorkCounters::default(),
            max_steps: MAX_STEPS,
            step_check: None,
            amplifier_peaks: None,
        })
    }

    /// Puts every integrator at its initial condition, sets time to 0, and turns all lamps off. Delay lines are
    /// emptied, and levels begin with their first number.
    ///
    /// # Errors
    /// If a voltage is not a number, a loop does not have exactly one solution, a mode chatters, or a derivative does
    /// not exist.
    pub fn initial_condition(&mut self) -> Result<(), RunError> {
        self.mode = MachineMode::InitialCondition;
        let Solver { setup, state, delay_lines, buffers, sensitivities } = &mut self.solver;
        if let Some(control) = &mut self.control {
            control.reset(setup.step);
        }
        self.events.reset();
        state.reset(setup.program);
        delay_lines.iter_mut().for_each(DelayLine::clear);
        state.begin_levels(setup);
        self.lamps.reset();
        buffers.evaluation.forget();
        if let Some(check) = &mut self.step_check {
            check.reset();
        }
        self.work = WorkCounters::default();
        self.fast_path.invalidate_extremes();
        if let Some(sensitivities) = sensitivities {
            sensitivities.begin(setup.program);
        }
        let outcome = self.reevaluate();
        if let Some(sensitivities) = &mut self.solver.sensitivities {
            sensitivities.finish_begin();
        }
        outcome?;
        self.solver.check_derivatives()
    }

    /// Integrates for a length of problem time in seconds, which may be 0. If the length is not a whole number of
    /// steps, a shorter step follows.
    ///
    /// # Errors
    /// If the length is negative or not finite, a voltage is not a number, a loop does not have exactly one solution, a
    /// mode chatters, an adaptive step becomes too short, or a derivative does not exist.
    ///
    /// # Examples
    ///
    /// ```
    /// use patchcord_core::circuit::Circuit;
    /// use patchcord_core::ir::Program;
    /// use patchcord_core::patch::{ElementBuilder, PatchBuilder};
    /// use patchcord_core::solve::Machine;
    ///
    /// // dx/dt = -x, from 50 V
    /// let decay = ElementBuilder::new("integrator").cords("x1", ["A1"]).set("initial", 50);
    /// let patch = PatchBuilder::new("decay").element("A1", decay).build()?;
    /// let program = Program::new(&Circuit::new(&patch)?)?;
    /// let mut machine = Machine::new(&program, 1e-3)?;
    /// machine.operate(0.25)?;
    /// machine.operate(0.75)?;
    /// assert!((machine.time() - 1.0).abs() < 1e-12);
    /// let error = machine.operate(-1.0).unwrap_err();
    /// assert_eq!(error.to_string(), "the time to operate must be finite and at least 0 s, got -1 s");
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn operate(&mut self, length: f64) -> Result<(), RunError> {
        self.operate_observed(length, &mut NoObserver)
    }

    /// Holds every integrator at its output. Time does not advance.
    ///
    /// # Examples
    ///
    /// ```
    /// use patchcord_core::circuit::Circuit;
    /// use patchcord_core::ir::Program;
    /// use patchcord_core::patch::{ElementBuilder, PatchBuilder};
    /// use patchcord_core::solve::{Machine, MachineMode};
    ///
    /// // dx/dt = -x, from 50 V
    /// let decay = ElementBuilder::new("integrator").cords("x1", ["A1"]).set("initial", 50);
    /// let patch = PatchBuilder::new("decay").element("A1", decay).build()?;
    /// let program = Program::new(&Circuit::new(&patch)?)?;
    /// let mut machine = Machine::new(&program, 1e-3)?;
    /// assert_eq!(machine.mode(), MachineMode::InitialCondition);
    /// machine.operate(0.5)?;
    /// machine.hold();
    /// assert_eq!(machine.mode(), MachineMode::Hold);
    /// machine.initial_condition()?;
    /// assert_eq!((machine.time(), machine.voltage("A1")?), (0.0, 50.0));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn hold(&mut self) {
        self.mode = MachineMode::Hold;
    }

    /// The mode of operation.
    pub fn mode(&self) -> MachineMode {
        self.mode
    }

    /// Problem time since initial condition, in seconds.
    pub fn time(&self) -> f64 {
        self.solver.state.time
    }

    /// Length of equal steps, or of the first step tried, in problem seconds.
    pub fn step(&self) -> f64 {
        self.solver.setup.step
    }

    /// Evaluates all voltages again and settles the modes, after an operator changed something at the present instant.
    ///
    /// # Errors
    /// If a voltage is not a number, a loop does not have exactly one solution, or a mode chatters.
    pub(super) fn reevaluate(&mut self) -> Result<(), RunError> {
        self.events.changes.fill(0);
        self.solver.evaluate(&mut self.work);
        self.solver.record_discontinuity();
        settle_modes(&mut self.solver, &mut self.events, &mut self.work)?;
        self.solver.sample_values();
        self.check_present()
    }

    /// Checks the voltages of the present instant after a jump, and lights lamps of amplifiers. The last step counts as
    /// a step of length 0 at the present.
    ///
    /// # Errors
    /// If a voltage is not a number, or a loop does not have exactly one solution.
    pub(super) fn check_present(&mut self) -> Result<(), RunError> {
        let Solver { setup, state, buffers, .. } = &mut self.solver;
        buffers.last.time = state.time;
        check_voltages(setup.program, state, &buffers.evaluation.faults)?;
        if let Some(peaks) = &mut self.amplifier_peaks {
            peaks.observe(&state.voltages);
        }
        if self.lamps.is_on {
            self.lamps.check_amplifiers(&mut self.solver);
        }
        Ok(())
    }

    /// Accepts the tried step, which ends at this time. The solver moves there, voltages and lamps are checked, delay
    /// lines are filled, and the observer is called. Values are sampled last: the observer needs those of the beginning
    /// of the step.
    ///
    /// # Errors
    /// If a voltage is not a number, a loop does not have exactly one solution, or a derivative does not exist.
    pub(super) fn accept_step(
        &mut self,
        time: f64,
        observer: &mut impl StepObserver,
    ) -> Result<(), RunError> {
        self.work.steps += 1;
        self.solver.follow_step(time);
        self.solver.make_present(time);
        let Solver { setup, state, buffers, .. } = &self.solver;
        check_voltages(setup.program, state, &buffers.evaluation.faults)?;
        self.solver.check_derivatives()?;
        if let Some(peaks) = &mut self.amplifier_peaks {
            peaks.observe(&self.solver.state.voltages);
        }
        if self.lamps.is_on {
            let Solver { setup, state, buffers, .. } = &self.solver;
            self.lamps.check_integrators(setup.program, state, &buffers.last);
            self.lamps.check_amplifiers(&mut self.solver);
        }
        self.solver.record_delay_inputs(self.control.as_ref());
        observer.step_accepted(&mut self.solver);
        self.solver.sample_values();
        Ok(())
    }

    /// Evaluates the voltages just before or after a jump at the present instant, without counting work.
    ///
    /// # Errors
    /// As for [`Machine::check_present`].
    pub(super) fn evaluate_side(&mut self, side: Side) -> Result<(), RunError> {
        self.solver.evaluate_now(side);
        self.check_present()
    }
}

/// The empty delay lines of a program, in the order of `Program::delays`. Each has capacity for the jumps that levels
/// can put into it within its delay.
fn delay_lines(program: &Program, coefficients: &[f64], step: f64) -> Vec<DelayLine> {
    let jumps = jump_rate(program, &LevelSource::all(program, coefficients));
    let lines = program.lowered.delays.iter().map(|delay| {
        let time = coefficients[delay.time as usize] * delay.problem_seconds;
        DelayLine::new(time, coefficients[delay.initial as usize], step)
            .with_capacity_for(jumps)
            .with_upstream(&delay.upstream)
    });
    lines.collect()
}
