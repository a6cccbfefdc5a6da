//! The derivatives of everything by one parameter.

use std::ops::Range;

use super::line::Line;
use crate::delay_line::DelayLine;
use crate::ir::{Beside, Probe, Program, Slopes};
use crate::solve::machine::Machine;
use crate::solve::stride::{Curve, combined};
use crate::solve::tableau::Tableau;

/// The derivatives of everything by one parameter, each times the parameter's size: in volts, as voltages are.
#[derive(Debug, Clone)]
pub(super) struct Column {
    /// Index of the parameter.
    pub parameter: usize,
    /// Its size in SI.
    pub size: f64,
    /// Of the parameters in SI: a run may set one by a formula of others.
    pub parameters: Vec<f64>,
    pub coefficients: Vec<f64>,
    pub states: Vec<f64>,
    pub kept: Vec<f64>,
    pub lines: Vec<Line>,
    /// Of every voltage of now.
    pub registers: Vec<f64>,
    /// Of the voltages looked back at, or of a stage.
    pub trial_registers: Vec<f64>,
    /// How the instant moves at which everything here is taken: 0 but at an event, while it is carried out.
    pub frame: f64,
    /// How the last event that was carried out moves, in problem seconds.
    pub event: f64,
    /// How the beginning of the present phase moves.
    pub phase: f64,
    delayed: Vec<f64>,
    trial: Vec<f64>,
    last: Vec<f64>,
    rates: Vec<Vec<f64>>,
}

/// A stretch gone in one piece: what the method did in it.
pub(super) struct Walk<'a> {
    pub program: &'a Program,
    pub method: &'a Tableau,
    pub lines: &'a [DelayLine],
    pub begin: f64,
    pub length: f64,
    /// The voltages of every stage.
    pub stages: &'a [Vec<f64>],
    /// Those at the end.
    pub end: &'a [f64],
}

impl Walk<'_> {
    /// Voltages between two kinks: those of the stage near the middle.
    fn guide(&self) -> &[f64] {
        &self.stages[self.method.middle + 1]
    }
}

impl Column {
    pub fn new(program: &Program, parameter: usize, method: &Tableau) -> Self {
        let zeros = |count: usize| vec![0.0; count];
        let (states, body) = (program.states.len(), program.body.len());
        let mut parameters = zeros(program.parameters.len());
        let slot = &program.parameters[parameter];
        let largest = slot.range.map_or(0.0, |(low, high)| low.abs().max(high.abs()));
        let size = [slot.value.abs(), largest * slot.per_unit, slot.per_unit];
        let fits = |size: &f64| *size > 0.0 && size.is_finite();
        let size = size.into_iter().find(fits).unwrap_or(1.0);
        parameters[parameter] = size;
        Column {
            parameter,
            size,
            parameters,
            coefficients: zeros(program.coefficients.len()),
            states: zeros(states),
            kept: zeros(program.kept.len()),
            lines: Vec::new(),
            registers: zeros(body),
            trial_registers: zeros(body),
            frame: 0.0,
            event: 0.0,
            phase: 0.0,
            delayed: zeros(program.delays.len()),
            trial: zeros(states),
            last: zeros(states),
            rates: vec![zeros(states); method.rates()],
        }
    }

    /// Puts the slopes of what the coefficients settle: initial conditions, kept values, delay lines.
    pub fn begin(&mut self, program: &Program) {
        (self.frame, self.event, self.phase) = (0.0, 0.0, 0.0);
        for (slope, state) in self.states.iter_mut().zip(&program.states) {
            *slope = self.coefficients[state.initial as usize];
        }
        for (slope, kept) in self.kept.iter_mut().zip(&program.kept) {
            *slope = self.coefficients[kept.initial as usize];
        }
        self.lines.iter_mut().for_each(Line::clear);
    }

    /// The slopes of all voltages of now.
    pub fn evaluate(&mut self, program: &Program, time: f64, lines: &[DelayLine], values: &[f64]) {
        let frame = self.frame;
        self.take_delayed(lines, |line, input| line.from(time, input, frame));
        let from = Slopes {
            coefficients: &self.coefficients,
            states: &self.states,
            time: self.frame,
            delayed: &self.delayed,
            kept: &self.kept,
        };
        let beside = Beside { values, guide: values };
        program.differentiate(0..program.body.len(), beside, &from, &mut self.registers);
    }

    /// Goes through a stretch beside the machine, stage by stage: the derivative of the step itself.
    pub fn walk(&mut self, walk: &Walk<'_>) {
        let Walk { program, method, .. } = *walk;
        let (still, watched, all) = (program.parts.moving, program.parts.watched, program.body.len());
        let guide = walk.guide();
        self.set_out(walk);
        for (stage, row) in method.stages.iter().enumerate() {
            self.trial_from(row.from, walk.length);
            let time = walk.begin + row.at * walk.length;
            self.take_delayed(walk.lines, |line, input| line.until(time, input));
            self.work_out(program, still..watched, Beside { values: &walk.stages[stage + 1], guide });
            self.keep_rates(program, stage + 1);
        }
        self.trial_from(method.end, walk.length / method.parts);
        let time = walk.begin + walk.length;
        self.take_delayed(walk.lines, |line, input| line.until(time, input));
        self.work_out(program, still..watched, Beside { values: walk.end, guide });
        // What no rate depends on may have turned a corner on the way.
        self.work_out(program, watched..all, Beside { values: walk.end, guide: walk.end });
        self.keep_rates(program, method.rates() - 1);
        self.states.copy_from_slice(&self.trial);
        std::mem::swap(&mut self.registers, &mut self.trial_registers);
        self.trial_registers[..still].copy_from_slice(&self.registers[..still]);
    }

    /// The first stage: the machine may stand on a kink, and the slopes are those of the side that it goes to.
    fn set_out(&mut self, walk: &Walk<'_>) {
        let program = walk.program;
        self.last.copy_from_slice(&self.states);
        self.trial.copy_from_slice(&self.states);
        self.take_delayed(walk.lines, |line, input| line.from(walk.begin, input, 0.0));
        // What goes into a delay line may be no rate's business.
        let wanted = if self.lines.is_empty() { program.parts.watched } else { program.body.len() };
        self.work_out(program, 0..wanted, Beside { values: &walk.stages[0], guide: walk.guide() });
        self.keep_rates(program, 0);
        for (line, delay) in self.lines.iter_mut().zip(&program.delays) {
            line.begin(walk.begin, self.trial_registers[delay.input.index()]);
        }
    }

    /// The slopes of all voltages of an instant within the last stretch.
    pub fn look_back(
        &mut self,
        program: &Program,
        (time, lines): (f64, &[DelayLine]),
        curve: &Curve,
        values: &[f64],
    ) {
        for (state, trial) in self.trial.iter_mut().enumerate() {
            let ends = [self.last[state], self.states[state]];
            *trial = curve.value(ends, &self.rates, state);
        }
        self.take_delayed(lines, |line, input| line.until(time, input));
        let still = program.parts.moving;
        self.work_out(program, still..program.body.len(), Beside { values, guide: values });
    }

    /// The slopes of what comes out of the delay lines, beside which stand the lines of the machine.
    fn take_delayed(&mut self, inputs: &[DelayLine], output: impl Fn(&Line, &DelayLine) -> f64) {
        for ((delayed, line), input) in self.delayed.iter_mut().zip(&self.lines).zip(inputs) {
            *delayed = output(line, input);
        }
    }

    fn trial_from(&mut self, shares: &[(usize, f64)], length: f64) {
        for (index, (trial, state)) in self.trial.iter_mut().zip(&self.states).enumerate() {
            *trial = state + length * combined(&self.rates, shares, index);
        }
    }

    fn work_out(&mut self, program: &Program, range: Range<usize>, beside: Beside<'_>) {
        let from = Slopes {
            coefficients: &self.coefficients,
            states: &self.trial,
            time: 0.0,
            delayed: &self.delayed,
            kept: &self.kept,
        };
        program.differentiate(range, beside, &from, &mut self.trial_registers);
    }

    fn keep_rates(&mut self, program: &Program, stage: usize) {
        for (rate, state) in self.rates[stage].iter_mut().zip(&program.states) {
            *rate = self.trial_registers[state.rate.index()];
        }
    }

    /// Takes note in the delay lines that what goes in jumps or turns a corner now, at an instant that moves so much.
    pub fn put_breaks(&mut self, machine: &Machine<'_>, moves: f64) {
        for (line, delay) in self.lines.iter_mut().zip(&machine.program.delays) {
            line.put_break(machine.time, self.registers[delay.input.index()], moves);
        }
    }

    /// Keeps the slopes of the values that are kept now.
    pub fn remember_values(&mut self, program: &Program) {
        for (slope, kept) in self.kept.iter_mut().zip(&program.kept) {
            *slope = self.registers[kept.next.index()];
        }
    }

    /// The derivative of a signal, in its unit per declared unit of the parameter, from its voltage and that one's slope.
    pub fn derivative(&self, machine: &Machine<'_>, probe: &Probe, [volts, slope]: [f64; 2]) -> f64 {
        let coefficient = |index: u32| (machine.coefficient(index), self.coefficients[index as usize]);
        let (per_volt, change) = probe.per_volt.map_or((1.0, 0.0), coefficient);
        let unit = self.size / machine.program.parameters[self.parameter].per_unit;
        (slope * per_volt + volts * change) / probe.per_unit / unit
    }

    /// Whether everything that it goes on from, and everything that can be recorded, is a number.
    pub fn is_finite(&self, program: &Program) -> bool {
        let recorded = program.signals.iter().map(|probe| &self.registers[probe.register.index()]);
        self.states.iter().chain(&self.kept).chain(recorded).all(|slope| slope.is_finite())
    }
}
