//! The machine: a program with states, modes and a clock, in one of the modes of an analogue computer.

use std::sync::Arc;

use super::control::Control;
use super::error::{RunError, TimeSetting};
use super::glide::{Flight, Glider};
use super::level_source::{LevelSource, most_jumps};
use super::overload::{self, Lit};
use super::run::check_tolerance;
use super::sensitivity::Sensitivities;
use super::tableau::{CLASSICAL, DORMAND_PRINCE, Tableau};
use crate::delay_line::DelayLine;
use crate::grid::Grid;
use crate::ir::{Program, Scratch, Sources};
use crate::kernel::{Asked, Backend, Steps};
use crate::trace::{Overload, Work};

/// What the machine is doing.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum MachineMode {
    /// Integrators stand at their initial conditions; everything else computes (also: problem check).
    InitialCondition,
    /// Integrators integrate.
    Operate,
    /// Integrators keep their outputs, time stands still; pots may be turned and voltages read.
    Hold,
}

/// A program that can be run step by step.
///
/// Time is problem time. Steps are equal, of the classical Runge-Kutta method of order 4 ([`Machine::new`]), or as
/// long as a tolerance allows, of the pair of orders 5 and 4 of Dormand and Prince ([`Machine::adaptive`]). They
/// end at changes of mode (relays, brakes, stops) and at kinks (diodes, limits, tables), which are located within
/// the step.
#[derive(Debug, Clone)]
pub struct Machine<'p> {
    pub(super) program: &'p Program,
    pub(super) time: f64,
    pub(super) states: Vec<f64>,
    pub(super) modes: Vec<f64>,
    /// Every voltage of now.
    pub(super) registers: Vec<f64>,
    /// The rates of now.
    pub(super) slopes: Vec<f64>,
    pub(super) method: &'static Tableau,
    /// The rates of the stages of the step last looked at, and at its end.
    pub(super) rates: Vec<Vec<f64>>,
    /// The voltages of the stages of the step last looked at that may show what comes and goes within it.
    pub(super) glances: Vec<Vec<f64>>,
    /// Where in the step last looked at an event may come and go.
    pub(super) hint: Option<f64>,
    pub(super) trial: Vec<f64>,
    pub(super) trial_registers: Vec<f64>,
    /// Where the last stretch began, for what is recorded within it.
    pub(super) last: Stretch,
    pub(super) parameters: Vec<f64>,
    pub(super) coefficients: Vec<f64>,
    delayed: Vec<f64>,
    pub(super) lines: Vec<DelayLine>,
    /// How much the input of each line bends within the last stretch.
    pub(super) bends: Vec<f64>,
    /// The kept values, which stay the same within a step.
    pub(super) kept: Vec<f64>,
    pub(super) level_sources: Vec<LevelSource>,
    /// The numbers that hold now of the noise voltages.
    pub(super) levels: Vec<f64>,
    pub(super) scratch: Scratch,
    pub(super) lamps: Vec<Option<Lit>>,
    /// Whether lamps light.
    pub(super) has_lamps: bool,
    /// What the amplifier of every lamp was asked for when a flight was last thought of.
    pub(super) asked: Vec<Asked>,
    pub(super) mode: MachineMode,
    pub(super) work: Work,
    /// Changes of every mode within the present step.
    pub(super) changes: Vec<u32>,
    /// Crossings of every kink within the present step.
    pub(super) crossings: Vec<u32>,
    /// How far every integrator has been driven on while it was held at a limit, in volts.
    pub(super) pushed: Vec<f64>,
    pub(super) step: f64,
    pub(super) grid: Grid,
    /// The corners of tables that no step of the present phase ends on by itself.
    pub(super) stray_corners: Arc<[f64]>,
    pub(super) glider: Glider,
    /// How long steps are, where they are not all as long as `step`.
    pub(super) control: Option<Control>,
    /// The derivatives that are carried along, if any are.
    pub(super) sensitivities: Option<Box<Sensitivities>>,
}

/// Which voltages are worked out.
#[derive(Clone, Copy)]
pub(super) enum Wanted {
    /// All, of the states, where the machine is.
    Now,
    /// Those of the trial states, where it may go; what does not move within a step stands there already.
    Ahead,
    /// Of those, what the rates depend on.
    Rates,
}

/// The beginning of a stretch of time gone in one piece.
#[derive(Debug, Clone, Default)]
pub(super) struct Stretch {
    pub time: f64,
    pub states: Vec<f64>,
    pub registers: Vec<f64>,
}

/// Somebody who looks on while a machine runs.
pub(super) trait Witness {
    /// A stretch was gone in one piece; the machine still knows both of its ends.
    fn stretch(&mut self, machine: &mut Machine<'_>);
    /// The end of a stretch, after the changes of mode that were due there.
    fn arrival(&mut self, machine: &Machine<'_>);
    /// A stretch was gone in quiet that may have gone past the next sample; at its end something jumps.
    fn glided_up_to(&mut self, _: &Machine<'_>, _: &mut Flight) {}
    /// The machine stands where something jumps, and it has not yet.
    fn before_jump(&mut self, _: &Machine<'_>) {}
    /// Quiet steps were gone, the last of which may have gone past the next sample.
    fn glided(&mut self, _: &Machine<'_>, _: &mut Flight) {}
    /// Quiet steps were gone that are remembered, past no sample within one of them.
    fn glided_along(&mut self, _: &Machine<'_>, _: &Flight, _: Steps) {}
    /// How many of some steps, the first, end before a sample that is due within a step.
    fn steps_before_stray(&self, steps: Steps) -> u64 {
        steps.count
    }
    /// The machine no longer glides.
    fn landed(&mut self, _: &Flight) {}
    /// When the next sample is due, in problem time.
    fn next_sample(&self) -> f64 {
        f64::INFINITY
    }
    /// Whether the machine should go into hold, at the end of a step.
    fn has_seen_enough(&self, machine: &Machine<'_>) -> bool;
    /// Whether the machine should go into hold at this very instant.
    fn has_met(&self) -> bool {
        false
    }
}

struct Nobody;

impl Witness for Nobody {
    fn stretch(&mut self, _: &mut Machine<'_>) {}
    fn arrival(&mut self, _: &Machine<'_>) {}
    fn has_seen_enough(&self, _: &Machine<'_>) -> bool {
        false
    }
}

impl<'p> Machine<'p> {
    /// A machine in initial condition, with a step in problem seconds.
    ///
    /// # Errors
    /// When the step is not a time above 0, a delay or a lag is shorter than the step, or a voltage in
    /// initial condition is not a number.
    pub fn new(program: &'p Program, step: f64) -> Result<Self, RunError> {
        Machine::begun(Machine::bare(program, step)?)
    }

    /// A machine in initial condition whose steps are as long as a tolerance allows: what the errors of the steps of
    /// a problem second may add up to in any state, in machine units of 100 V. The first step tried is given in
    /// problem seconds.
    ///
    /// # Errors
    /// When the tolerance is not a number from [`LEAST_TOLERANCE`](super::LEAST_TOLERANCE) on, the step is not a time above 0, or a voltage in initial condition
    /// is not a number.
    pub fn adaptive(program: &'p Program, tolerance: f64, first: f64) -> Result<Self, RunError> {
        check_tolerance(tolerance)?;
        let mut machine = Machine::bare(program, first)?;
        machine.method = &DORMAND_PRINCE;
        machine.rates = vec![vec![0.0; program.states.len()]; DORMAND_PRINCE.rates()];
        machine.glances = vec![vec![0.0; program.body.len()]; DORMAND_PRINCE.glances.len()];
        machine.control = Some(Control::new(tolerance, first));
        Machine::begun(machine)
    }

    /// The same machine, its steps worked out by a backend.
    pub fn on(mut self, backend: Backend) -> Self {
        self.glider = Glider::new(backend, Vec::new());
        self
    }

    fn begun(mut machine: Self) -> Result<Self, RunError> {
        machine.check_times()?;
        machine.initial_condition()?;
        Ok(machine)
    }

    fn bare(program: &'p Program, step: f64) -> Result<Self, RunError> {
        if !(step > 0.0 && step.is_finite()) {
            return Err(RunError::NotATime { which: TimeSetting::Step, value: step });
        }
        let parameters: Vec<f64> = program.parameters.iter().map(|slot| slot.value).collect();
        let coefficients = program.prepare(&parameters);
        let count = program.states.len();
        let zeros = || vec![0.0; count];
        Ok(Machine {
            program,
            time: 0.0,
            states: zeros(),
            modes: vec![0.0; program.modes.len()],
            registers: vec![0.0; program.body.len()],
            slopes: zeros(),
            method: &CLASSICAL,
            rates: vec![zeros(); CLASSICAL.rates()],
            glances: vec![vec![0.0; program.body.len()]; CLASSICAL.glances.len()],
            hint: None,
            trial: zeros(),
            trial_registers: vec![0.0; program.body.len()],
            last: Stretch { time: 0.0, states: zeros(), registers: vec![0.0; program.body.len()] },
            delayed: vec![0.0; program.delays.len()],
            lines: delay_lines(program, &coefficients, step),
            bends: vec![0.0; program.delays.len()],
            kept: vec![0.0; program.kept.len()],
            level_sources: LevelSource::all(program, &coefficients),
            levels: vec![0.0; program.levels.len()],
            scratch: Scratch::new(program),
            lamps: vec![None; program.elements.len()],
            has_lamps: true,
            asked: vec![Asked::Within; program.lamps.len()],
            mode: MachineMode::InitialCondition,
            work: Work::default(),
            changes: vec![0; program.modes.len()],
            crossings: vec![0; program.kinks.len() + program.guard_kinks.len()],
            pushed: zeros(),
            step,
            grid: Grid::new(step),
            stray_corners: Arc::default(),
            glider: Glider::default(),
            control: None,
            sensitivities: None,
            parameters,
            coefficients,
        })
    }

    /// Puts every integrator at its initial condition, time at 0, and the lamps out.
    ///
    /// # Errors
    /// When a voltage is not a number, or modes do not settle.
    pub fn initial_condition(&mut self) -> Result<(), RunError> {
        self.mode = MachineMode::InitialCondition;
        self.time = 0.0;
        self.control = self.control.map(|control| control.begun(self.step));
        for (value, state) in self.states.iter_mut().zip(&self.program.states) {
            *value = self.coefficients[state.initial as usize];
        }
        for (value, mode) in self.modes.iter_mut().zip(&self.program.modes) {
            *value = mode.initial;
        }
        for (value, kept) in self.kept.iter_mut().zip(&self.program.kept) {
            *value = self.coefficients[kept.initial as usize];
        }
        self.lines.iter_mut().for_each(DelayLine::clear);
        self.begin_levels();
        self.lamps.fill(None);
        self.pushed.fill(0.0);
        self.work = Work::default();
        self.beside(|own, machine| own.begin(machine));
        let outcome = self.disturbed();
        self.beside(|own, _| own.begun());
        outcome?;
        self.check_derivatives()
    }

    /// Integrates for a length of problem time.
    ///
    /// # Errors
    /// When a voltage is not a number, a loop has not one solution, or a mode chatters.
    pub fn operate(&mut self, length: f64) -> Result<(), RunError> {
        self.operate_with(length, &mut Nobody)
    }

    /// The same, seen by a witness.
    pub(super) fn operate_with(&mut self, length: f64, witness: &mut impl Witness) -> Result<(), RunError> {
        let mut operation = self.begin_operation(length)?;
        if self.control.is_some() {
            return self.operate_within_tolerance(self.time + length, witness);
        }
        self.go_on(&mut operation, u64::MAX, witness)?;
        self.end_operation(operation, witness)
    }

    /// Goes into hold when the witness has seen enough.
    pub(super) fn is_stopped_by(&mut self, witness: &impl Witness) -> bool {
        if witness.has_met() || witness.has_seen_enough(self) {
            self.hold();
        }
        self.mode == MachineMode::Hold
    }

    /// Keeps every integrator where it is; time stands still.
    pub fn hold(&mut self) {
        self.mode = MachineMode::Hold;
    }

    /// What the machine is doing.
    pub fn mode(&self) -> MachineMode {
        self.mode
    }

    /// Problem time since initial condition, in seconds.
    pub fn time(&self) -> f64 {
        self.time
    }

    /// The step in problem seconds, or the first one tried.
    pub fn step(&self) -> f64 {
        self.step
    }

    /// Works everything out anew after a hand has changed something at this instant.
    pub(super) fn disturbed(&mut self) -> Result<(), RunError> {
        self.changes.fill(0);
        self.evaluate();
        self.remember_break();
        self.settle()?;
        self.remember_values();
        self.check_now()
    }

    /// Looks at the voltages of this instant after something has jumped.
    pub(super) fn check_now(&mut self) -> Result<(), RunError> {
        self.last.time = self.time;
        self.check_voltages()?;
        if self.has_lamps {
            self.watch_amplifiers();
        }
        Ok(())
    }

    /// The voltage at an element's output.
    ///
    /// # Errors
    /// When there is no such element, drive or reference.
    pub fn voltage(&self, element: &str) -> Result<f64, RunError> {
        let index = self.program.element(element);
        let index = index.ok_or_else(|| RunError::UnknownElement(element.to_owned()))?;
        Ok(self.registers[self.program.elements[index].register.index()])
    }

    /// The position that an element stands in, such as "pulled-in"; nothing where it has none, or is not known.
    pub fn position(&self, element: &str) -> Option<&'static str> {
        let index = self.program.element(element)?;
        let switch = self.program.switches.iter().find(|switch| switch.element == index)?;
        switch.positions.get(self.modes[switch.mode] as usize).copied()
    }

    /// The overloads since the last initial condition, in the order in which the lamps lit.
    pub fn overloads(&self) -> Vec<Overload> {
        overload::history(self.program, &self.lamps)
    }

    /// What has been done since the last initial condition.
    pub fn work(&self) -> Work {
        self.work
    }

    /// Whether any lamp is lit.
    pub fn is_overloaded(&self) -> bool {
        self.lamps.iter().any(Option::is_some)
    }

    /// The states' rates, in volts per problem second, in the order of [`Program::states`].
    pub fn rates(&self) -> &[f64] {
        &self.slopes
    }

    /// The states, in volts, in the order of [`Program::states`].
    pub fn states(&self) -> &[f64] {
        &self.states
    }

    pub(super) fn coefficient(&self, index: u32) -> f64 {
        self.coefficients[index as usize]
    }

    /// Works out every voltage of now, and the rates.
    pub(super) fn evaluate(&mut self) {
        self.work.evaluations += 1;
        self.work_out_now();
    }

    /// The same, not counted as work.
    pub(super) fn work_out_now(&mut self) {
        self.work_out_by(DelayLine::next_from);
    }

    /// The same as it was before anything jumped now.
    pub(super) fn work_out_before_now(&mut self) {
        self.work_out_by(DelayLine::next_until);
    }

    fn work_out_by(&mut self, output: fn(&mut DelayLine, f64) -> f64) {
        self.scratch.faults.clear();
        for (delayed, line) in self.delayed.iter_mut().zip(&mut self.lines) {
            *delayed = output(line, self.time);
        }
        self.work_out(self.time, Wanted::Now);
        let still = self.program.parts.moving;
        self.trial_registers[..still].copy_from_slice(&self.registers[..still]);
        self.take_rates();
        self.beside(|own, machine| own.evaluate(machine));
    }

    /// Works out the voltages for the trial states at a later time, which nothing has reached yet: what jumps there
    /// stands as before its jump.
    pub(super) fn evaluate_trial(&mut self, time: f64, wanted: Wanted) {
        for (delayed, line) in self.delayed.iter_mut().zip(&mut self.lines) {
            *delayed = line.next_until(time);
        }
        self.work_out(time, wanted);
    }

    fn work_out(&mut self, time: f64, wanted: Wanted) {
        let (moving, watched, all) =
            (self.program.parts.moving, self.program.parts.watched, self.program.body.len());
        let (states, registers, range) = match wanted {
            Wanted::Now => (&self.states, &mut self.registers, 0..all),
            Wanted::Ahead => (&self.trial, &mut self.trial_registers, moving..all),
            Wanted::Rates => (&self.trial, &mut self.trial_registers, moving..watched),
        };
        let from = Sources {
            parameters: &self.parameters,
            coefficients: &self.coefficients,
            states,
            modes: &self.modes,
            time,
            tables: &self.program.tables,
            delayed: &self.delayed,
            kept: &self.kept,
            levels: &self.levels,
        };
        self.program.evaluate_range(range, &from, registers, &mut self.scratch);
    }

    fn take_rates(&mut self) {
        for (rate, state) in self.slopes.iter_mut().zip(&self.program.states) {
            *rate = self.registers[state.rate.index()];
        }
    }

    /// Makes what was looked at the present.
    pub(super) fn accept(&mut self, time: f64, witness: &mut impl Witness) -> Result<(), RunError> {
        self.work.steps += 1;
        self.beside(|own, machine| own.walk(machine, time));
        self.last.time = self.time;
        self.last.states.copy_from_slice(&self.states);
        self.last.registers.copy_from_slice(&self.registers);
        self.time = time;
        self.states.copy_from_slice(&self.trial);
        std::mem::swap(&mut self.registers, &mut self.trial_registers);
        self.take_rates();
        self.check_voltages()?;
        self.check_derivatives()?;
        if self.has_lamps {
            self.watch_integrators();
            self.watch_amplifiers();
        }
        self.remember_delays();
        witness.stretch(self);
        self.remember_values();
        Ok(())
    }

    /// Keeps the values of now. What the witness saw of the stretch before needed those from its beginning.
    pub(super) fn remember_values(&mut self) {
        for (value, kept) in self.kept.iter_mut().zip(&self.program.kept) {
            *value = self.registers[kept.next.index()];
        }
        self.beside(|own, machine| own.remember_values(machine));
    }
}

fn delay_lines(program: &Program, coefficients: &[f64], step: f64) -> Vec<DelayLine> {
    let jumps = most_jumps(program, &LevelSource::all(program, coefficients));
    let lines = program.delays.iter().map(|delay| {
        let time = coefficients[delay.time as usize] * delay.problem_seconds;
        DelayLine::new(time, coefficients[delay.initial as usize], step)
            .with_room_for(jumps)
            .hearing(&delay.hears)
    });
    lines.collect()
}
