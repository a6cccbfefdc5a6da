//! Where the machine takes its derivatives along.

use super::Sensitivities;
use super::column::{Column, Walk};
use super::saltation::STANDS;
use crate::ir::{Program, Standing, StandingSlopes, Transition};
use crate::solve::error::RunError;
use crate::solve::machine::{Machine, Wanted};
use crate::solve::stride::Curve;
use patchcord_expr::Formula;

impl Machine<'_> {
    /// Does something with the derivatives beside the rest of the machine; nothing where there are none.
    pub(in crate::solve) fn beside(&mut self, deed: impl FnOnce(&mut Sensitivities, &mut Self)) {
        if let Some(mut own) = self.sensitivities.take() {
            deed(&mut own, self);
            self.sensitivities = Some(own);
        }
    }

    /// Whether derivatives can go on from here.
    pub(in crate::solve) fn check_derivatives(&mut self) -> Result<(), RunError> {
        let Some(own) = &mut self.sensitivities else { return Ok(()) };
        if let Some(fault) = own.fault.take() {
            return Err(fault);
        }
        match own.columns.iter().find(|column| !column.is_finite(self.program)) {
            Some(column) => Err(RunError::NoDerivative {
                parameter: self.program.parameters[column.parameter].name.clone(),
                why: format!("at t = {} s it is no finite number", self.time),
            }),
            None => Ok(()),
        }
    }
}

impl Sensitivities {
    /// Goes through the stretch that the machine is about to accept.
    pub fn walk(&mut self, machine: &mut Machine<'_>, end: f64) {
        let (program, method) = (machine.program, machine.method);
        let begin = machine.time;
        self.length = end - begin;
        self.look_at_stages(machine);
        let walk = Walk {
            program,
            method,
            lines: &machine.lines,
            begin,
            length: self.length,
            stages: &self.stages,
            end: &machine.trial_registers,
        };
        self.columns.iter_mut().for_each(|column| column.walk(&walk));
    }

    /// Works out the voltages of all stages of a stretch once more; leaves the machine looking at its end.
    fn look_at_stages(&mut self, machine: &mut Machine<'_>) {
        let still = machine.program.parts.moving;
        self.stages[0].copy_from_slice(&machine.registers);
        std::mem::swap(&mut self.end, &mut machine.trial);
        for (stage, row) in machine.method.stages.iter().enumerate() {
            let voltages = &mut self.stages[stage + 1];
            voltages[..still].copy_from_slice(&machine.registers[..still]);
            std::mem::swap(voltages, &mut machine.trial_registers);
            machine.trial_from(row.from, self.length);
            let wanted = if stage == machine.method.middle { Wanted::Ahead } else { Wanted::Rates };
            machine.evaluate_trial(machine.time + row.at * self.length, wanted);
            std::mem::swap(&mut self.stages[stage + 1], &mut machine.trial_registers);
        }
        std::mem::swap(&mut self.end, &mut machine.trial);
    }

    /// Looks at the instant that the machine looks back at.
    pub fn look_back(&mut self, machine: &Machine<'_>, time: f64, curve: &Curve) {
        let at = (time, machine.lines.as_slice());
        for column in &mut self.columns {
            column.look_back(machine.program, at, curve, &machine.trial_registers);
        }
    }

    /// Works out the slopes of all voltages of now.
    pub fn evaluate(&mut self, machine: &Machine<'_>) {
        for column in &mut self.columns {
            column.evaluate(machine.program, machine.time, &machine.lines, &machine.registers);
        }
    }

    pub fn remember_values(&mut self, machine: &Machine<'_>) {
        self.columns.iter_mut().for_each(|column| column.remember_values(machine.program));
    }

    pub fn remember_delays(&mut self, machine: &Machine<'_>) {
        for column in &mut self.columns {
            for (line, delay) in column.lines.iter_mut().zip(&machine.program.delays) {
                line.put(machine.time, column.registers[delay.input.index()]);
            }
        }
    }

    /// The same at the instant looked back at.
    pub fn remember_within(&mut self, machine: &Machine<'_>, time: f64) {
        for column in &mut self.columns {
            for (line, delay) in column.lines.iter_mut().zip(&machine.program.delays) {
                line.put(time, column.trial_registers[delay.input.index()]);
            }
        }
    }

    /// The same at an instant at which voltages jump or turn a corner; at an event that is told at its end.
    pub fn remember_break(&mut self, machine: &Machine<'_>) {
        if !self.is_at_event {
            self.columns.iter_mut().for_each(|column| column.put_breaks(machine, 0.0));
        }
    }

    /// Sets the slope of a state anew where a change of mode does so.
    pub fn carry_out(&mut self, program: &Program, registers: &[f64], mode: usize, transition: &Transition) {
        self.look_at_mark(program, registers, mode, transition);
        let Some(reset) = transition.reset else { return };
        for column in &mut self.columns {
            column.states[reset.state as usize] = column.registers[reset.to.index()];
        }
    }

    /// A state put to a voltage by hand depends on nothing.
    pub fn put_state(&mut self, state: usize) {
        self.columns.iter_mut().for_each(|column| column.states[state] = 0.0);
    }

    /// Begins at initial condition.
    pub fn begin(&mut self, machine: &Machine<'_>) {
        (self.is_at_event, self.begins) = (false, true);
        self.columns.iter_mut().for_each(|column| column.begin(machine.program));
    }

    /// Takes note that initial condition has been reached.
    pub fn begun(&mut self) {
        self.begins = false;
    }

    /// Finds fault with a transition in initial condition that stands exactly at its mark, and would not for another
    /// value.
    fn look_at_mark(&mut self, program: &Program, registers: &[f64], mode: usize, transition: &Transition) {
        if !self.begins || transition.guard.excess(registers) != 0.0 {
            return;
        }
        let guard = transition.guard.register.index();
        let depends = |column: &&Column| column.registers[guard].abs() > STANDS;
        if let Some(column) = self.columns.iter().find(depends) {
            let element = program.name(program.modes[mode].element);
            self.fault.get_or_insert(RunError::NoDerivative {
                parameter: program.parameters[column.parameter].name.clone(),
                why: format!("{element} stands exactly where it switches in initial condition"),
            });
        }
    }

    /// The parameters that a hand has set, by index, with what their new values' slopes are; nothing in those that
    /// are not told depends on anything.
    pub fn set(&mut self, parameters: impl Iterator<Item = usize>, slopes: &[Vec<f64>]) {
        for (changed, index) in parameters.enumerate() {
            for (place, column) in self.columns.iter_mut().enumerate() {
                column.parameters[index] = slopes.get(changed).map_or(0.0, |slopes| slopes[place]);
            }
        }
    }

    /// Follows the machine's coefficients once they are new.
    pub fn follow_coefficients(&mut self, machine: &Machine<'_>) {
        self.follow(machine.program, &machine.parameters);
        for column in &mut self.columns {
            let pairs = column.lines.iter_mut().zip(&machine.lines).zip(&machine.program.delays);
            for ((line, input), delay) in pairs {
                let longer = column.coefficients[delay.time as usize] * delay.problem_seconds;
                let initial = column.coefficients[delay.initial as usize];
                line.set(input.delay(), longer, initial, machine.time);
            }
        }
    }

    /// The slopes of what a formula of the run comes to, in SI, for every parameter carried along.
    pub fn of_formula(&self, standing: &Standing<'_>, formula: &Formula) -> Vec<f64> {
        let slope = |column: &Column| {
            let slopes = StandingSlopes {
                parameters: &column.parameters,
                coefficients: &column.coefficients,
                registers: &column.registers,
            };
            standing.slope(formula, &slopes)
        };
        self.columns.iter().map(slope).collect()
    }
}
