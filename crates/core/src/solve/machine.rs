//! The machine: a program with a solver, events, lamps and a clock, in one of the modes of an analogue computer.
//!
//! The groups of a machine are separate fields, so that each function takes only what it needs. Evaluation and steps
//! need the [`Solver`]. Located events also need [`EventState`]. Long stretches without events run in a compiled kernel
//! ([`FastPath`]). This module holds construction, initial condition, the readings and the acceptance of a step; the
//! loops that advance time are in `operation` and `events`.

use super::buffers::StepBuffers;
use super::controls::check_times;
use super::error::{RunError, TimeSetting};
use super::evaluate::{Side, check_voltages};
use super::events::{EventState, settle_modes};
use super::fast_path::FastPath;
use super::lamps::Lamps;
use super::levels::{LevelSource, jump_rate};
use super::observer::{NoObserver, StepObserver};
use super::run::check_tolerance;
use super::state::{Setup, Solver, SolverState};
use super::step_control::StepControl;
use super::tableau::{CLASSICAL, DORMAND_PRINCE, Tableau};
use crate::delay_line::DelayLine;
use crate::grid::Grid;
use crate::ir::Program;
use crate::kernel::Backend;
use crate::trace::{Overload, Work};

/// The mode of operation of a machine.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum MachineMode {
    /// Integrators are at their initial conditions; all other elements compute (also the problem check).
    InitialCondition,
    /// Integrators integrate.
    Operate,
    /// Integrators keep their outputs and time does not advance. Pots may be set and voltages read.
    Hold,
}

/// A program that can be run step by step.
///
/// All times are problem times in seconds. Steps are equal and by the classical Runge-Kutta method of order 4
/// ([`Machine::new`]), or they adapt to a tolerance and are by the pair of orders 5 and 4 of Dormand and Prince
/// ([`Machine::adaptive`]). Steps end at changes of mode (relays, brakes, stops) and at kinks (diodes, limits, tables),
/// which are located within the step.
#[derive(Debug, Clone)]
pub struct Machine<'p> {
    pub(super) solver: Solver<'p>,
    /// The control of the step size; `None` for equal steps.
    pub(super) control: Option<StepControl>,
    pub(super) events: EventState,
    pub(super) lamps: Lamps,
    pub(super) fast_path: FastPath,
    pub(super) mode: MachineMode,
    /// Work done since the last initial condition.
    pub(super) work: Work,
}

impl<'p> Machine<'p> {
    /// Makes a machine in initial condition with equal steps, given in problem seconds.
    ///
    /// # Errors
    /// If the step is not a positive time, a delay or a lag is shorter than the step, or a voltage in initial condition
    /// is not a number.
    pub fn new(program: &'p Program, step: f64) -> Result<Self, RunError> {
        Machine::unstarted(program, step, &CLASSICAL, None)?.start()
    }

    /// Makes a machine in initial condition whose steps adapt to a tolerance. The tolerance bounds the sum of the
    /// errors of the steps of one problem second, in any state, in machine units of 100 V. `first` is the length of the
    /// first step tried, in problem seconds.
    ///
    /// # Errors
    /// If the tolerance is below [`LEAST_TOLERANCE`](super::LEAST_TOLERANCE) or not finite, the first step is not a
    /// positive time, or a voltage in initial condition is not a number.
    pub fn adaptive(program: &'p Program, tolerance: f64, first: f64) -> Result<Self, RunError> {
        check_tolerance(tolerance)?;
        let control = StepControl::new(tolerance, first);
        Machine::unstarted(program, first, &DORMAND_PRINCE, Some(control))?.start()
    }

    /// The same machine with another backend for its steps.
    pub fn on(mut self, backend: Backend) -> Self {
        self.fast_path.restart(backend, Vec::new());
        self
    }

    /// Checks the time constants and goes into initial condition.
    fn start(mut self) -> Result<Self, RunError> {
        check_times(&self.solver)?;
        self.initial_condition()?;
        Ok(self)
    }

    /// Makes a machine with all its buffers. No voltage is evaluated yet.
    fn unstarted(
        program: &'p Program,
        step: f64,
        method: &'static Tableau,
        control: Option<StepControl>,
    ) -> Result<Self, RunError> {
        if !(step > 0.0 && step.is_finite()) {
            return Err(RunError::NotATime { which: TimeSetting::Step, value: step });
        }
        let parameters: Vec<f64> = program.parameters.iter().map(|slot| slot.value).collect();
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
            work: Work::default(),
        })
    }

    /// Puts every integrator at its initial condition, sets time to 0, and turns all lamps off.
    ///
    /// # Errors
    /// If a voltage is not a number, or modes do not settle.
    pub fn initial_condition(&mut self) -> Result<(), RunError> {
        self.mode = MachineMode::InitialCondition;
        let Solver { setup, state, delay_lines, sensitivities, .. } = &mut self.solver;
        if let Some(control) = &mut self.control {
            control.reset(setup.step);
        }
        self.events.reset();
        state.reset(setup.program);
        delay_lines.iter_mut().for_each(DelayLine::clear);
        state.begin_levels(setup);
        self.lamps.reset();
        self.work = Work::default();
        if let Some(own) = sensitivities {
            own.begin(setup.program);
        }
        let outcome = self.reevaluate();
        if let Some(own) = &mut self.solver.sensitivities {
            own.finish_begin();
        }
        outcome?;
        self.solver.check_derivatives()
    }

    /// Integrates for a length of problem time in seconds.
    ///
    /// # Errors
    /// If a voltage is not a number, a loop does not have exactly one solution, or a mode chatters.
    pub fn operate(&mut self, length: f64) -> Result<(), RunError> {
        self.operate_observed(length, &mut NoObserver)
    }

    /// Holds every integrator at its output. Time does not advance.
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

    /// Evaluates everything again after an operator changed something at the present instant.
    pub(super) fn reevaluate(&mut self) -> Result<(), RunError> {
        self.events.changes.fill(0);
        self.solver.evaluate(&mut self.work);
        self.solver.record_discontinuity();
        settle_modes(&mut self.solver, &mut self.events, &mut self.work)?;
        self.solver.sample_values();
        self.check_present()
    }

    /// Checks the voltages of the present instant after a jump, and lights lamps of amplifiers. The last step has no
    /// length then.
    pub(super) fn check_present(&mut self) -> Result<(), RunError> {
        let Solver { setup, state, buffers, .. } = &mut self.solver;
        buffers.last.time = state.time;
        check_voltages(setup.program, state, &buffers.evaluation.faults)?;
        if self.lamps.is_on {
            self.lamps.watch_amplifiers(&mut self.solver);
        }
        Ok(())
    }

    /// The voltage at an element's output, in volts.
    ///
    /// # Errors
    /// If no element, drive or reference has this name.
    pub fn voltage(&self, element: &str) -> Result<f64, RunError> {
        let program = self.solver.setup.program;
        let index = program.element(element).ok_or_else(|| RunError::UnknownElement(element.to_owned()))?;
        Ok(self.solver.state.voltages[program.elements[index].register.index()])
    }

    /// The position of a switching element, such as "pulled-in"; `None` if the element has no positions or does not
    /// exist.
    pub fn position(&self, element: &str) -> Option<&'static str> {
        let program = self.solver.setup.program;
        let index = program.element(element)?;
        let switch = program.switches.iter().find(|switch| switch.element == index)?;
        switch.positions.get(self.solver.state.modes[switch.mode] as usize).copied()
    }

    /// The overloads since the last initial condition, in the order in which the lamps lit.
    pub fn overloads(&self) -> Vec<Overload> {
        self.lamps.history(self.solver.setup.program)
    }

    /// The work done since the last initial condition.
    pub fn work(&self) -> Work {
        self.work
    }

    /// Whether any overload lamp is lit.
    pub fn is_overloaded(&self) -> bool {
        self.lamps.is_any_lit()
    }

    /// The rates of the states, in volts per problem second, in the order of [`Program::states`].
    pub fn rates(&self) -> &[f64] {
        &self.solver.state.rates
    }

    /// The states, in volts, in the order of [`Program::states`].
    pub fn states(&self) -> &[f64] {
        &self.solver.state.states
    }

    /// Accepts the tried step, which ends at this time: moves the solver there, checks voltages and lamps, and shows
    /// the step to the observer.
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
        if self.lamps.is_on {
            let Solver { setup, state, buffers, .. } = &self.solver;
            self.lamps.watch_integrators(setup.program, state, &buffers.last);
            self.lamps.watch_amplifiers(&mut self.solver);
        }
        self.solver.record_delay_inputs(self.control.as_ref());
        observer.step_accepted(&mut self.solver);
        self.solver.sample_values();
        Ok(())
    }

    /// Moves back to just before or after a jump at the present instant, without counting work.
    pub(super) fn show_side(&mut self, side: Side) -> Result<(), RunError> {
        self.solver.evaluate_now(side);
        self.check_present()
    }
}

/// The empty delay lines of a program. Each has room for the jumps that levels can bring within its delay.
fn delay_lines(program: &Program, coefficients: &[f64], step: f64) -> Vec<DelayLine> {
    let jumps = jump_rate(program, &LevelSource::all(program, coefficients));
    let lines = program.delays.iter().map(|delay| {
        let time = coefficients[delay.time as usize] * delay.problem_seconds;
        DelayLine::new(time, coefficients[delay.initial as usize], step)
            .with_room_for(jumps)
            .hearing(&delay.hears)
    });
    lines.collect()
}
