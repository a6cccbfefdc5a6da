//! Buffers of a step. They are allocated once, so that a step allocates no memory.
//!
//! The buffers hold the step that was tried last (stages, end), and the start of the step that was accepted last. A
//! step is tried by `runge_kutta` and accepted by `Solver::make_present`. Interpolation overwrites `states` and
//! `voltages`.

use super::grazing::Hint;
use super::tableau::Tableau;
use super::turning_points::Samples;
use crate::ir::{Program, Scratch};
use crate::parabola::Parabola;

/// The step tried last, and the start of the step accepted last.
#[derive(Debug, Clone)]
pub(super) struct StepBuffers {
    /// Rates of the stages of the tried step, and last the rates at its end, in volts per problem second. A row has one
    /// rate per state.
    pub stage_rates: Vec<Vec<f64>>,
    /// Voltages of the stages that are checked for events within the step, in the order of `Tableau::checked_stages`.
    /// With equal steps, only the voltages on which events depend are up to date.
    pub checked_voltages: [Vec<f64>; 2],
    /// The hint of an event that may come and go within the tried step; `None` if nothing suggests one.
    pub hint: Option<Hint>,
    /// Number of evaluations that the search for hints has taken and that are not counted as work yet.
    pub hint_evaluations: u64,
    /// The kink that was crossed last; `None` before the first.
    pub crossed: Option<Crossed>,
    /// States at the end of the tried step, or at the instant interpolated last.
    pub states: Vec<f64>,
    /// Every voltage at the end of the tried step, or at the instant interpolated last, one per operation of the body.
    pub voltages: Vec<f64>,
    /// The voltages on which events depend just after the beginning and just before the end of the tried step.
    pub near_ends: [Vec<f64>; 2],
    /// States at the end of the tried step, while other states are evaluated.
    pub end_states: Vec<f64>,
    /// Every voltage at the end of the tried step, while others are evaluated.
    pub end_voltages: Vec<f64>,
    /// Outputs of the delay lines for the present evaluation.
    pub delayed: Vec<f64>,
    /// Scratch memory of an evaluation, with the faults of loops that it could not solve.
    pub evaluation: Scratch,
    /// Fourth differences of the inputs of the delay lines over the quarters of the last step, in volts.
    pub fourth_differences: Vec<f64>,
    /// The start of the step accepted last.
    pub last: StepStart,
}

/// A kink that was crossed at the end of a step.
#[derive(Debug, Clone, Copy)]
pub(super) struct Crossed {
    /// Index of the kink in [`Setup::kinks`](super::state::Setup::kinks).
    pub kink: usize,
    /// Whether the voltage rose through the corner.
    pub is_rising: bool,
    /// The time of the crossing, in problem seconds.
    pub time: f64,
}

/// The start of a step.
#[derive(Debug, Clone)]
pub(super) struct StepStart {
    /// Problem time in seconds.
    pub time: f64,
    /// The states in volts.
    pub states: Vec<f64>,
    /// Every voltage, one per operation of the body.
    pub voltages: Vec<f64>,
}

impl StepBuffers {
    /// Buffers of the sizes that a program and a method need. All values are 0.
    pub(super) fn new(program: &Program, method: &Tableau) -> Self {
        let zeros = |count: usize| vec![0.0; count];
        let (states, body, delays) =
            (program.lowered.states.len(), program.lowered.body.len(), program.lowered.delays.len());
        StepBuffers {
            stage_rates: vec![zeros(states); method.rates()],
            checked_voltages: [(); 2].map(|()| zeros(body)),
            hint: None,
            hint_evaluations: 0,
            crossed: None,
            states: zeros(states),
            voltages: zeros(body),
            near_ends: [(); 2].map(|()| zeros(body)),
            end_states: zeros(states),
            end_voltages: zeros(body),
            delayed: zeros(delays),
            evaluation: Scratch::new(program),
            fourth_differences: zeros(delays),
            last: StepStart { time: 0.0, states: zeros(states), voltages: zeros(body) },
        }
    }

    /// Samples of a voltage over the tried adaptive step: at both ends and at the two checked stages. `ends` are all
    /// voltages at the ends, and `voltage` chooses or computes one from them.
    pub(super) fn samples(
        &self,
        method: &Tableau,
        ends: [&[f64]; 2],
        voltage: impl Fn(&[f64]) -> f64,
    ) -> Samples {
        let [early, late] = method.checked_stages.map(|stage| method.stages[stage].node);
        let [first, second] = self.checked_voltages.each_ref().map(|voltages| voltage(voltages));
        let [begin, end] = ends.map(voltage);
        Samples { shares: [0.0, early, late, 1.0], values: [begin, first, second, end] }
    }

    /// The parabola of a voltage over the tried equal step, both of whose checked stages are in its middle. The voltage
    /// must be one on which events depend.
    pub(super) fn parabola(&self, ends: [&[f64]; 2], voltage: impl Fn(&[f64]) -> f64) -> Parabola {
        let stages = self.checked_voltages.each_ref().map(|voltages| voltage(voltages));
        Parabola::of_stages(stages, ends.map(voltage))
    }
}
