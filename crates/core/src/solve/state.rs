//! The solver: a program at an instant, with the data and buffers to take a step from this instant.
//!
//! [`Setup`] is constant in a run. The rest of a run depends on [`SolverState`] and the delay lines. [`Solver`] joins
//! both with the buffers of a step and the derivatives. It is the only part of a machine that an observer reads. It
//! contains no lamps, event counts or kernels.

use super::buffers::StepBuffers;
use super::levels::LevelSource;
use super::sensitivity::Sensitivities;
use super::tableau::Tableau;
use crate::delay_line::DelayLine;
use crate::grid::Grid;
use crate::ir::{Kink, Program, TimeConstant};

/// The constants of a run: program, method and step length.
#[derive(Debug, Clone)]
pub(super) struct Setup<'p> {
    /// The program that is run.
    pub program: &'p Program,
    /// The Runge-Kutta method.
    pub method: &'static Tableau,
    /// Length of equal steps, or of the first step tried if steps adapt, in problem seconds.
    pub step: f64,
    /// The instants at which equal steps end.
    pub grid: Grid,
    /// Whether the length of steps adapts to a tolerance.
    pub is_adaptive: bool,
}

impl Setup<'_> {
    /// The kinks at which a step has to end. Kinks that change guards only are included only if steps adapt: a long
    /// step could miss an event beyond such a kink. Indices of kinks count in this order.
    pub(super) fn kinks(&self) -> impl Iterator<Item = &Kink> {
        let of_guards = if self.is_adaptive { self.program.lowered.guard_kinks.as_slice() } else { &[] };
        self.program.lowered.kinks.iter().chain(of_guards)
    }
}

/// The state of the solver: all quantities on which the rest of a run depends, except the contents of the delay lines.
#[derive(Debug, Clone)]
pub(super) struct SolverState {
    /// Problem time since initial condition, in seconds.
    pub time: f64,
    /// Outputs of integrators and lags in volts, in the order of `Program::states`.
    pub states: Vec<f64>,
    /// Discrete modes: the positions of relays, brakes and stops, in the order of `Program::modes`.
    pub modes: Vec<f64>,
    /// Every voltage at `time`, one for each operation of the program's body.
    pub voltages: Vec<f64>,
    /// Rates of the states at `time`, in volts per problem second.
    pub rates: Vec<f64>,
    /// Values sampled at the end of a step, in the order of `Program::sampled`. They stay constant within the next
    /// step.
    pub sampled: Vec<f64>,
    /// The present value of every level (noise, or a table whose values are held), in the order of `Program::levels`.
    pub levels: Vec<f64>,
    /// The position of every level in its sequence of values, in the same order.
    pub level_sources: Vec<LevelSource>,
    /// Parameters in SI units, in the order of `Program::parameters`.
    pub parameters: Vec<f64>,
    /// Coefficients calculated from the parameters, in the order of `Program::coefficients`.
    pub coefficients: Vec<f64>,
}

impl SolverState {
    /// The state of a program before its initial condition: all voltages are 0.
    pub(super) fn new(program: &Program, parameters: Vec<f64>, coefficients: Vec<f64>) -> Self {
        let zeros = |count: usize| vec![0.0; count];
        SolverState {
            time: 0.0,
            states: zeros(program.lowered.states.len()),
            modes: zeros(program.lowered.modes.len()),
            voltages: zeros(program.lowered.body.len()),
            rates: zeros(program.lowered.states.len()),
            sampled: zeros(program.lowered.sampled.len()),
            levels: zeros(program.lowered.levels.len()),
            level_sources: LevelSource::all(program, &coefficients),
            parameters,
            coefficients,
        }
    }

    /// Resets time, states, modes and sampled values to the initial condition. Voltages and rates stay as they are
    /// until the next evaluation.
    pub(super) fn reset(&mut self, program: &Program) {
        self.time = 0.0;
        for (value, state) in self.states.iter_mut().zip(&program.lowered.states) {
            *value = self.coefficients[state.initial as usize];
        }
        for (value, mode) in self.modes.iter_mut().zip(&program.lowered.modes) {
            *value = mode.initial;
        }
        for (value, sampled) in self.sampled.iter_mut().zip(&program.lowered.sampled) {
            *value = self.coefficients[sampled.initial as usize];
        }
    }

    /// Resets the modes of one element, given by its index, to the initial condition.
    pub(super) fn reset_modes(&mut self, program: &Program, element: usize) {
        for (value, mode) in self.modes.iter_mut().zip(&program.lowered.modes) {
            if mode.element == element {
                *value = mode.initial;
            }
        }
    }

    /// Samples the present values that stay constant within the next step.
    pub(super) fn sample_values(&mut self, program: &Program) {
        for (value, sampled) in self.sampled.iter_mut().zip(&program.lowered.sampled) {
            *value = self.voltages[sampled.next.index()];
        }
    }

    /// The value of a coefficient.
    pub(super) fn coefficient(&self, index: u32) -> f64 {
        self.coefficients[index as usize]
    }

    /// A time constant in problem seconds.
    pub(super) fn time_constant(&self, lag: TimeConstant) -> f64 {
        self.coefficient(lag.time) * lag.problem_seconds
    }
}

/// A program at an instant, with the data and buffers to try a step, to accept it and to interpolate in it.
#[derive(Debug, Clone)]
pub(super) struct Solver<'p> {
    /// The constants of the run.
    pub setup: Setup<'p>,
    /// The state at the present instant.
    pub state: SolverState,
    /// The past of every delayed input, in the order of `Program::delays`. Reading a line moves its cursor, so the
    /// lines are not part of the state, which is only read while a step is tried.
    pub delay_lines: Vec<DelayLine>,
    /// The tried step, and the start of the last accepted one.
    pub buffers: StepBuffers,
    /// Derivatives by parameters; `None` if none are computed.
    pub sensitivities: Option<Box<Sensitivities>>,
}

impl Solver<'_> {
    /// Advances the derivatives over the tried step, which ends at this problem time. Call it before
    /// [`Solver::make_present`], while the state is still that of the beginning.
    pub(super) fn follow_step(&mut self, end: f64) {
        let Solver { setup, state, delay_lines, buffers, sensitivities } = self;
        if let Some(sensitivities) = sensitivities {
            sensitivities.follow_step(setup, state, delay_lines, buffers, end);
        }
    }

    /// Moves the state to the end of the tried step, at this problem time, and keeps the start of that step in the
    /// buffers.
    pub(super) fn make_present(&mut self, time: f64) {
        let Solver { setup, state, buffers, .. } = self;
        buffers.last.time = state.time;
        buffers.last.states.copy_from_slice(&state.states);
        buffers.last.voltages.copy_from_slice(&state.voltages);
        state.time = time;
        state.states.copy_from_slice(&buffers.states);
        std::mem::swap(&mut state.voltages, &mut buffers.voltages);
        read_rates(setup.program, &state.voltages, &mut state.rates);
    }

    /// Samples the present values that stay constant within the next step. Call this after the observer: interpolation
    /// in the last step needs the values from its beginning.
    pub(super) fn sample_values(&mut self) {
        let Solver { setup, state, sensitivities, .. } = self;
        state.sample_values(setup.program);
        if let Some(sensitivities) = sensitivities {
            sensitivities.sample_values(setup.program);
        }
    }
}

/// Reads the rates of the states from the voltages of an instant, or the slopes of the rates from the slopes of the
/// voltages. The order is that of `Program::states`.
#[inline]
pub(super) fn read_rates(program: &Program, voltages: &[f64], into: &mut [f64]) {
    for (rate, state) in into.iter_mut().zip(&program.lowered.states) {
        *rate = voltages[state.rate.index()];
    }
}
