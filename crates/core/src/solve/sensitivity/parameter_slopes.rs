//! The derivatives of all quantities of a solver by one parameter.
//!
//! Each step is differentiated stage by stage, so the slopes are exact for the discrete solution. All slopes are
//! multiplied by the size of the parameter. So they have the units of the quantities themselves, such as volts, and
//! tolerances for voltages apply to them.

use std::ops::Range;

use super::delayed_slopes::DelayedSlopes;
use crate::delay_line::DelayLine;
use crate::ir::{ParameterValue, Program, Pulses, SignalInfo, SourceSlopes, TangentBase};
use crate::solve::dense_output::Curve;
use crate::solve::discontinuities::INSTANT_TOLERANCE;
use crate::solve::error::RunError;
use crate::solve::runge_kutta::advance_states;
use crate::solve::state::{Setup, SolverState, read_rates};
use crate::solve::tableau::Tableau;

/// The derivatives of all quantities by one parameter, each multiplied by the size of the parameter.
#[derive(Debug, Clone)]
pub(super) struct ParameterSlopes {
    /// Index of the parameter in `Program::parameters`.
    pub parameter: usize,
    /// Size of the parameter in SI units: its value without sign if that is not 0, else the largest value of its range,
    /// else one declared unit.
    pub size: f64,
    /// Slopes of all parameters in SI units. Other parameters have one if a phase sets them by a formula.
    pub parameters: Vec<f64>,
    /// Slopes of the coefficients.
    pub coefficients: Vec<f64>,
    /// Slopes of the states, in volts.
    pub states: Vec<f64>,
    /// Slopes of the sampled values, in volts.
    pub sampled: Vec<f64>,
    /// Slopes in the delay lines, in the order of `Program::delays`.
    pub lines: Vec<DelayedSlopes>,
    /// Slopes of the present voltages, in volts.
    pub voltages: Vec<f64>,
    /// Slopes of the voltages at the instant interpolated last or at a stage, in volts.
    pub trial_voltages: Vec<f64>,
    /// The slope of the instant to which all slopes refer, in problem seconds: 0 except during an event.
    pub shift: f64,
    /// The slope of the instant of the last event, in problem seconds.
    pub event_shift: f64,
    /// The slope of the beginning of the present phase, in problem seconds.
    pub phase_shift: f64,
    /// Slopes of the outputs of the delay lines, in volts.
    delayed: Vec<f64>,
    /// Slopes of the states at a stage or at the instant interpolated last, in volts.
    trial_states: Vec<f64>,
    /// Slopes of the states at the beginning of the last step, in volts.
    last_states: Vec<f64>,
    /// Slopes of the rates at the stages of the last step and at its end, in volts per problem second.
    stage_rates: Vec<Vec<f64>>,
}

/// A step of the solver that is about to be accepted.
pub(super) struct AcceptedStep<'a> {
    /// The program that is run.
    pub program: &'a Program,
    /// The method of the step.
    pub method: &'a Tableau,
    /// The delay lines of the solver.
    pub delay_lines: &'a [DelayLine],
    /// Problem time at its beginning, in seconds.
    pub begin: f64,
    /// Length in problem seconds.
    pub length: f64,
    /// The voltages of every stage, the first stage included.
    pub stages: &'a [Vec<f64>],
    /// The voltages at its end.
    pub end: &'a [f64],
}

impl AcceptedStep<'_> {
    /// Voltages that choose the side of each kink: those of the stage near the middle. A step may begin and end on
    /// kinks, but it crosses none.
    fn guide(&self) -> &[f64] {
        &self.stages[self.method.middle_stage + 1]
    }
}

impl ParameterSlopes {
    /// The slopes by the parameter with this index, for steps of a method. All slopes except that of the parameter
    /// itself are 0.
    pub(super) fn new(program: &Program, parameter: usize, method: &Tableau) -> Self {
        let zeros = |count: usize| vec![0.0; count];
        let (states, body) = (program.lowered.states.len(), program.lowered.body.len());
        let mut parameters = zeros(program.parameters.len());
        let ParameterValue { value, declared } = &program.parameters[parameter];
        let largest = declared.range.map_or(0.0, |(low, high)| low.abs().max(high.abs()));
        let size = [value.abs(), largest * declared.per_unit, declared.per_unit];
        let is_valid = |size: &f64| *size > 0.0 && size.is_finite();
        let size = size.into_iter().find(is_valid).unwrap_or(1.0);
        parameters[parameter] = size;
        ParameterSlopes {
            parameter,
            size,
            parameters,
            coefficients: zeros(program.lowered.coefficients.len()),
            states: zeros(states),
            sampled: zeros(program.lowered.sampled.len()),
            lines: Vec::new(),
            voltages: zeros(body),
            trial_voltages: zeros(body),
            shift: 0.0,
            event_shift: 0.0,
            phase_shift: 0.0,
            delayed: zeros(program.lowered.delays.len()),
            trial_states: zeros(states),
            last_states: zeros(states),
            stage_rates: vec![zeros(states); method.rates()],
        }
    }

    /// Checks that everything depends on the parameter in a way that has a derivative. `coefficients` are the present
    /// ones.
    ///
    /// # Errors
    /// If a noise voltage would draw different numbers for another value, the edge of a pulse counts as one at t = 0,
    /// or a coefficient has no finite derivative.
    pub(super) fn check(&self, setup: &Setup<'_>, coefficients: &[f64]) -> Result<(), RunError> {
        let program = setup.program;
        let no_derivative = |why: String| RunError::NoDerivative {
            parameter: program.parameters[self.parameter].declared.name.clone(),
            why,
        };
        for noise in program.noises() {
            let slopes = [noise.seed, noise.every].map(|index| self.coefficients[index as usize]);
            if slopes.iter().any(|slope| *slope != 0.0) {
                let name = program.name(noise.element);
                return Err(no_derivative(format!(
                    "{name} draws different numbers for every value; make its seed and its \"every\" independent of \
                     the parameter"
                )));
            }
        }
        let tolerance = INSTANT_TOLERANCE * setup.step;
        let is_at_start =
            |pulses: &&Pulses| pulses.has_shifting_edge_at_start(coefficients, &self.coefficients, tolerance);
        if let Some(drive) = program.pulses().find(is_at_start) {
            let name = program.name(drive.element);
            return Err(no_derivative(format!(
                "{name} has an edge exactly at t = 0; change its phase or its beginning slightly"
            )));
        }
        match self.coefficients.iter().position(|slope| !slope.is_finite()) {
            Some(index) => {
                let label = &program.lowered.coefficients[index].label;
                Err(no_derivative(format!("{label} has no finite derivative; choose another value")))
            }
            None => Ok(()),
        }
    }

    /// Begins at initial condition: sets the slopes that follow from the coefficients (initial voltages and sampled
    /// values), and clears the delay lines.
    pub(super) fn begin(&mut self, program: &Program) {
        (self.shift, self.event_shift, self.phase_shift) = (0.0, 0.0, 0.0);
        for (slope, state) in self.states.iter_mut().zip(&program.lowered.states) {
            *slope = self.coefficients[state.initial as usize];
        }
        for (slope, sampled) in self.sampled.iter_mut().zip(&program.lowered.sampled) {
            *slope = self.coefficients[sampled.initial as usize];
        }
        self.lines.iter_mut().for_each(DelayedSlopes::clear);
    }

    /// Evaluates the slopes of all present voltages at a problem time. `values` are the voltages.
    pub(super) fn evaluate(
        &mut self,
        program: &Program,
        time: f64,
        delay_lines: &[DelayLine],
        values: &[f64],
    ) {
        let shift = self.shift;
        self.read_delay_lines(delay_lines, |line, input| line.right_limit(time, input, shift));
        let from = SourceSlopes {
            coefficients: &self.coefficients,
            states: &self.states,
            time: self.shift,
            delayed: &self.delayed,
            sampled: &self.sampled,
        };
        let base = TangentBase { values, guide: values };
        program.differentiate(0..program.lowered.body.len(), base, &from, &mut self.voltages);
    }

    /// Differentiates a step of the solver stage by stage, and moves the slopes to its end.
    pub(super) fn follow_step(&mut self, step: &AcceptedStep<'_>) {
        let AcceptedStep { program, method, .. } = *step;
        let (first_moving, checked, all) =
            (program.lowered.sections.moving, program.lowered.sections.checked, program.lowered.body.len());
        let guide = step.guide();
        self.evaluate_first_stage(step);
        for (stage, row) in method.stages.iter().enumerate() {
            advance_states(&mut self.trial_states, &self.states, &self.stage_rates, row.weights, step.length);
            let time = step.begin + row.node * step.length;
            self.read_delay_lines(step.delay_lines, |line, input| line.left_limit(time, input));
            self.differentiate(
                program,
                first_moving..checked,
                TangentBase { values: &step.stages[stage + 1], guide },
            );
            read_rates(program, &self.trial_voltages, &mut self.stage_rates[stage + 1]);
        }
        let end_length = step.length / method.divisor;
        advance_states(
            &mut self.trial_states,
            &self.states,
            &self.stage_rates,
            method.end_weights,
            end_length,
        );
        let time = step.begin + step.length;
        self.read_delay_lines(step.delay_lines, |line, input| line.left_limit(time, input));
        self.differentiate(program, first_moving..checked, TangentBase { values: step.end, guide });
        // A voltage on which no rate depends may have crossed a kink within the step.
        self.differentiate(program, checked..all, TangentBase { values: step.end, guide: step.end });
        read_rates(program, &self.trial_voltages, &mut self.stage_rates[method.rates() - 1]);
        self.states.copy_from_slice(&self.trial_states);
        std::mem::swap(&mut self.voltages, &mut self.trial_voltages);
        self.trial_voltages[..first_moving].copy_from_slice(&self.voltages[..first_moving]);
    }

    /// Evaluates the slopes of the first stage. If the step begins on a kink, they are those of the side on which the
    /// step continues.
    fn evaluate_first_stage(&mut self, step: &AcceptedStep<'_>) {
        let program = step.program;
        self.last_states.copy_from_slice(&self.states);
        self.trial_states.copy_from_slice(&self.states);
        self.read_delay_lines(step.delay_lines, |line, input| line.right_limit(step.begin, input, 0.0));
        // Inputs of delay lines need not be among the voltages on which rates depend.
        let sections = program.lowered.sections;
        let needed = if self.lines.is_empty() { sections.checked } else { sections.watched };
        self.differentiate(program, 0..needed, TangentBase { values: &step.stages[0], guide: step.guide() });
        read_rates(program, &self.trial_voltages, &mut self.stage_rates[0]);
        for (line, delay) in self.lines.iter_mut().zip(&program.lowered.delays) {
            line.begin_step(step.begin, self.trial_voltages[delay.input.index()]);
        }
    }

    /// Evaluates the slopes of all voltages at a problem time within the last step. `values` are the voltages there.
    pub(super) fn interpolate(
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
        self.read_delay_lines(delay_lines, |line, input| line.left_limit(time, input));
        let first_moving = program.lowered.sections.moving;
        self.differentiate(
            program,
            first_moving..program.lowered.body.len(),
            TangentBase { values, guide: values },
        );
    }

    /// Reads the slopes of the outputs of the delay lines by `output`. `inputs` are the delay lines of the solver.
    fn read_delay_lines(&mut self, inputs: &[DelayLine], output: impl Fn(&DelayedSlopes, &DelayLine) -> f64) {
        for ((delayed, line), input) in self.delayed.iter_mut().zip(&self.lines).zip(inputs) {
            *delayed = output(line, input);
        }
    }

    /// Evaluates the slopes of a range of voltages from the slopes of the trial states, at a fixed time. `base`
    /// contains the voltages at which, and the side of kinks on which, the derivatives are taken.
    fn differentiate(&mut self, program: &Program, range: Range<usize>, base: TangentBase<'_>) {
        let from = SourceSlopes {
            coefficients: &self.coefficients,
            states: &self.trial_states,
            time: 0.0,
            delayed: &self.delayed,
            sampled: &self.sampled,
        };
        program.differentiate(range, base, &from, &mut self.trial_voltages);
    }

    /// Records in the delay lines that their inputs may have a jump or a corner at a problem time, whose slope is
    /// `shift` in problem seconds.
    pub(super) fn record_discontinuity(&mut self, program: &Program, time: f64, shift: f64) {
        for (line, delay) in self.lines.iter_mut().zip(&program.lowered.delays) {
            line.put_discontinuity(time, self.voltages[delay.input.index()], shift);
        }
    }

    /// Samples the slopes of the values that stay constant within the next step.
    pub(super) fn sample_values(&mut self, program: &Program) {
        for (slope, sampled) in self.sampled.iter_mut().zip(&program.lowered.sampled) {
            *slope = self.voltages[sampled.next.index()];
        }
    }

    /// The derivative of a signal, in its unit per declared unit of the parameter, from its voltage and the slope of
    /// its voltage. The scale of the signal may depend on the parameter, too.
    pub(super) fn derivative(
        &self,
        program: &Program,
        coefficients: &[f64],
        signal: &SignalInfo,
        [volts, slope]: [f64; 2],
    ) -> f64 {
        let coefficient = |index: u32| (coefficients[index as usize], self.coefficients[index as usize]);
        let (per_volt, per_volt_slope) = signal.per_volt.map_or((1.0, 0.0), coefficient);
        let unit = self.size / program.parameters[self.parameter].declared.per_unit;
        (slope * per_volt + volts * per_volt_slope) / signal.per_unit / unit
    }

    /// Whether the slopes of all states and sampled values are finite, and the present derivatives of all recordable
    /// signals. A derivative in units may be infinite although its slope in volts is not.
    pub(super) fn is_finite(&self, program: &Program, state: &SolverState) -> bool {
        let recordable = program.lowered.signals.iter().map(|signal| {
            let register = signal.register.index();
            let pair = [state.voltages[register], self.voltages[register]];
            self.derivative(program, &state.coefficients, signal, pair)
        });
        self.states.iter().chain(&self.sampled).copied().chain(recordable).all(f64::is_finite)
    }
}
