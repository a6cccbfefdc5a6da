//! The derivatives of all quantities of a solver by one parameter.
//!
//! A column follows each step with the derivative of the step itself, stage by stage, so it is exact for the discrete
//! solution. All slopes are multiplied by the size of the parameter: they are in volts, as voltages are.

use std::ops::Range;

use super::line::Line;
use crate::delay_line::DelayLine;
use crate::ir::{Beside, Probe, Program, Slopes};
use crate::solve::dense_output::Curve;
use crate::solve::error::RunError;
use crate::solve::runge_kutta::advance_states;
use crate::solve::state::read_rates;
use crate::solve::tableau::Tableau;

/// The derivatives of all quantities by one parameter, each multiplied by the size of the parameter.
#[derive(Debug, Clone)]
pub(super) struct Column {
    /// Index of the parameter.
    pub parameter: usize,
    /// Size of the parameter in SI units: its value, or else the largest value of its range, or else one unit.
    pub size: f64,
    /// Slopes of the parameters in SI units. A run may set one parameter by a formula of others.
    pub parameters: Vec<f64>,
    /// Slopes of the coefficients.
    pub coefficients: Vec<f64>,
    /// Slopes of the states, in volts.
    pub states: Vec<f64>,
    /// Slopes of the sampled values.
    pub sampled: Vec<f64>,
    /// Slopes in the delay lines.
    pub lines: Vec<Line>,
    /// Slopes of the present voltages, in volts.
    pub voltages: Vec<f64>,
    /// Slopes of the voltages at the instant interpolated last, or of a stage.
    pub trial_voltages: Vec<f64>,
    /// The shift of the instant at which all slopes are taken, in problem seconds: 0 except during an event.
    pub shift: f64,
    /// The shift of the last event that was carried out, in problem seconds.
    pub event_shift: f64,
    /// The shift of the beginning of the present phase, in problem seconds.
    pub phase_shift: f64,
    /// Slopes of the outputs of the delay lines.
    delayed: Vec<f64>,
    /// Slopes of the states at a stage or at the instant interpolated last.
    trial_states: Vec<f64>,
    /// Slopes of the states at the beginning of the last step.
    last_states: Vec<f64>,
    /// Slopes of the rates at the stages of the last step and at its end.
    stage_rates: Vec<Vec<f64>>,
}

/// A step of the solver that is about to be accepted.
pub(super) struct TakenStep<'a> {
    pub program: &'a Program,
    pub method: &'a Tableau,
    pub delay_lines: &'a [DelayLine],
    /// Problem time at its beginning, in seconds.
    pub begin: f64,
    /// Length in problem seconds.
    pub length: f64,
    /// The voltages of every stage.
    pub stages: &'a [Vec<f64>],
    /// The voltages at its end.
    pub end: &'a [f64],
}

impl TakenStep<'_> {
    /// Voltages between two kinks, by which the side of each kink is chosen: those of the stage near the middle.
    fn guide(&self) -> &[f64] {
        &self.stages[self.method.middle + 1]
    }
}

impl Column {
    /// The derivatives by the parameter of this index, for steps of a method. All slopes but that of the parameter
    /// itself are 0.
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
            sampled: zeros(program.kept.len()),
            lines: Vec::new(),
            voltages: zeros(body),
            trial_voltages: zeros(body),
            shift: 0.0,
            event_shift: 0.0,
            phase_shift: 0.0,
            delayed: zeros(program.delays.len()),
            trial_states: zeros(states),
            last_states: zeros(states),
            stage_rates: vec![zeros(states); method.rates()],
        }
    }

    /// Checks that everything depends on the parameter in a way that has a derivative.
    ///
    /// # Errors
    /// If noise would draw other numbers for another value, or a coefficient has no finite derivative.
    pub fn check(&self, program: &Program) -> Result<(), RunError> {
        let refused = |why: String| RunError::NoDerivative {
            parameter: program.parameters[self.parameter].name.clone(),
            why,
        };
        for noise in program.noises() {
            let slopes = [noise.seed, noise.every].map(|index| self.coefficients[index as usize]);
            if slopes.iter().any(|slope| *slope != 0.0) {
                let name = program.name(noise.element);
                return Err(refused(format!("{name} draws other numbers for every other value")));
            }
        }
        match self.coefficients.iter().position(|slope| !slope.is_finite()) {
            Some(index) => {
                let label = &program.coefficients[index].label;
                Err(refused(format!("{label} has no finite derivative")))
            }
            None => Ok(()),
        }
    }

    /// Begins at initial condition: sets the slopes that follow from the coefficients (initial conditions, sampled
    /// values, delay lines).
    pub fn begin(&mut self, program: &Program) {
        (self.shift, self.event_shift, self.phase_shift) = (0.0, 0.0, 0.0);
        for (slope, state) in self.states.iter_mut().zip(&program.states) {
            *slope = self.coefficients[state.initial as usize];
        }
        for (slope, kept) in self.sampled.iter_mut().zip(&program.kept) {
            *slope = self.coefficients[kept.initial as usize];
        }
        self.lines.iter_mut().for_each(Line::clear);
    }

    /// Evaluates the slopes of all present voltages. `values` are the voltages.
    pub fn evaluate(&mut self, program: &Program, time: f64, delay_lines: &[DelayLine], values: &[f64]) {
        let shift = self.shift;
        self.read_delay_lines(delay_lines, |line, input| line.from(time, input, shift));
        let from = Slopes {
            coefficients: &self.coefficients,
            states: &self.states,
            time: self.shift,
            delayed: &self.delayed,
            kept: &self.sampled,
        };
        let beside = Beside { values, guide: values };
        program.differentiate(0..program.body.len(), beside, &from, &mut self.voltages);
    }

    /// Follows a step of the solver stage by stage: the derivative of the step itself.
    pub fn follow_step(&mut self, step: &TakenStep<'_>) {
        let TakenStep { program, method, .. } = *step;
        let (still, watched, all) = (program.parts.moving, program.parts.watched, program.body.len());
        let guide = step.guide();
        self.evaluate_first_stage(step);
        for (stage, row) in method.stages.iter().enumerate() {
            advance_states(&mut self.trial_states, &self.states, &self.stage_rates, row.from, step.length);
            let time = step.begin + row.at * step.length;
            self.read_delay_lines(step.delay_lines, |line, input| line.until(time, input));
            self.differentiate(program, still..watched, Beside { values: &step.stages[stage + 1], guide });
            read_rates(program, &self.trial_voltages, &mut self.stage_rates[stage + 1]);
        }
        let part = step.length / method.parts;
        advance_states(&mut self.trial_states, &self.states, &self.stage_rates, method.end, part);
        let time = step.begin + step.length;
        self.read_delay_lines(step.delay_lines, |line, input| line.until(time, input));
        self.differentiate(program, still..watched, Beside { values: step.end, guide });
        // A voltage on which no rate depends may have turned a corner within the step.
        self.differentiate(program, watched..all, Beside { values: step.end, guide: step.end });
        read_rates(program, &self.trial_voltages, &mut self.stage_rates[method.rates() - 1]);
        self.states.copy_from_slice(&self.trial_states);
        std::mem::swap(&mut self.voltages, &mut self.trial_voltages);
        self.trial_voltages[..still].copy_from_slice(&self.voltages[..still]);
    }

    /// Evaluates the slopes of the first stage. If the solver is on a kink, they are those of the side to which it
    /// goes.
    fn evaluate_first_stage(&mut self, step: &TakenStep<'_>) {
        let program = step.program;
        self.last_states.copy_from_slice(&self.states);
        self.trial_states.copy_from_slice(&self.states);
        self.read_delay_lines(step.delay_lines, |line, input| line.from(step.begin, input, 0.0));
        // Inputs of delay lines need not be among the voltages on which rates depend.
        let wanted = if self.lines.is_empty() { program.parts.watched } else { program.body.len() };
        self.differentiate(program, 0..wanted, Beside { values: &step.stages[0], guide: step.guide() });
        read_rates(program, &self.trial_voltages, &mut self.stage_rates[0]);
        for (line, delay) in self.lines.iter_mut().zip(&program.delays) {
            line.begin(step.begin, self.trial_voltages[delay.input.index()]);
        }
    }

    /// Evaluates the slopes of all voltages at an instant within the last step. `values` are the voltages there.
    pub fn interpolate(
        &mut self,
        program: &Program,
        (time, delay_lines): (f64, &[DelayLine]),
        curve: &Curve,
        values: &[f64],
    ) {
        for (state, trial) in self.trial_states.iter_mut().enumerate() {
            let ends = [self.last_states[state], self.states[state]];
            *trial = curve.value(ends, &self.stage_rates, state);
        }
        self.read_delay_lines(delay_lines, |line, input| line.until(time, input));
        let still = program.parts.moving;
        self.differentiate(program, still..program.body.len(), Beside { values, guide: values });
    }

    /// Reads the slopes of the outputs of the delay lines. `inputs` are the delay lines of the solver.
    fn read_delay_lines(&mut self, inputs: &[DelayLine], output: impl Fn(&Line, &DelayLine) -> f64) {
        for ((delayed, line), input) in self.delayed.iter_mut().zip(&self.lines).zip(inputs) {
            *delayed = output(line, input);
        }
    }

    /// Evaluates the slopes of a range of voltages from the slopes of the trial states, at a fixed time.
    fn differentiate(&mut self, program: &Program, range: Range<usize>, beside: Beside<'_>) {
        let from = Slopes {
            coefficients: &self.coefficients,
            states: &self.trial_states,
            time: 0.0,
            delayed: &self.delayed,
            kept: &self.sampled,
        };
        program.differentiate(range, beside, &from, &mut self.trial_voltages);
    }

    /// Records in the delay lines that their inputs jump or turn a corner at a time, which shifts by `shift` seconds.
    pub fn record_discontinuity(&mut self, program: &Program, time: f64, shift: f64) {
        for (line, delay) in self.lines.iter_mut().zip(&program.delays) {
            line.put_break(time, self.voltages[delay.input.index()], shift);
        }
    }

    /// Samples the slopes of the values that stay constant within the next step.
    pub fn sample_values(&mut self, program: &Program) {
        for (slope, kept) in self.sampled.iter_mut().zip(&program.kept) {
            *slope = self.voltages[kept.next.index()];
        }
    }

    /// The derivative of a signal, in its unit per declared unit of the parameter, from its voltage and the slope of
    /// that.
    pub fn derivative(
        &self,
        program: &Program,
        coefficients: &[f64],
        probe: &Probe,
        [volts, slope]: [f64; 2],
    ) -> f64 {
        let coefficient = |index: u32| (coefficients[index as usize], self.coefficients[index as usize]);
        let (per_volt, change) = probe.per_volt.map_or((1.0, 0.0), coefficient);
        let unit = self.size / program.parameters[self.parameter].per_unit;
        (slope * per_volt + volts * change) / probe.per_unit / unit
    }

    /// Whether the slopes of all states, sampled values and recordable signals are finite.
    pub fn is_finite(&self, program: &Program) -> bool {
        let recorded = program.signals.iter().map(|probe| &self.voltages[probe.register.index()]);
        self.states.iter().chain(&self.sampled).chain(recorded).all(|slope| slope.is_finite())
    }
}
