//! Buffers of a step. They are allocated once, so that a run allocates nothing from step to step.

use super::tableau::Tableau;
use super::turning_points::Samples;
use crate::ir::{Program, Scratch};

/// The step tried last, and the start of the step accepted last.
#[derive(Debug, Clone)]
pub(super) struct StepBuffers {
    /// Rates of the stages of the tried step, and the rates at its end, in volts per problem second.
    pub stage_rates: Vec<Vec<f64>>,
    /// Voltages of the stages that are checked for events within the step (`Tableau::checked_stages`).
    pub checked_voltages: Vec<Vec<f64>>,
    /// The share of the tried step at which an event may come and go; `None` if no stage shows one.
    pub hint: Option<f64>,
    /// States at the end of the tried step, or at the instant interpolated last.
    pub states: Vec<f64>,
    /// Every voltage at the end of the tried step, or at the instant interpolated last.
    pub voltages: Vec<f64>,
    /// Outputs of the delay lines for the present evaluation.
    pub delayed: Vec<f64>,
    /// Scratch memory of an evaluation, and the loops that it could not solve.
    pub evaluation: Scratch,
    /// Fourth differences of the inputs of the delay lines over the last step, in volts.
    pub fourth_differences: Vec<f64>,
    /// The start of the step accepted last.
    pub last: StepStart,
}

/// The start of a step.
#[derive(Debug, Clone)]
pub(super) struct StepStart {
    /// Problem time in seconds.
    pub time: f64,
    /// The states in volts.
    pub states: Vec<f64>,
    /// Every voltage.
    pub voltages: Vec<f64>,
}

impl StepBuffers {
    /// Buffers for the steps of a program by a method.
    pub fn new(program: &Program, method: &Tableau) -> Self {
        let zeros = |count: usize| vec![0.0; count];
        let (states, body, delays) = (program.states.len(), program.body.len(), program.delays.len());
        StepBuffers {
            stage_rates: vec![zeros(states); method.rates()],
            checked_voltages: vec![zeros(body); method.checked_stages.len()],
            hint: None,
            states: zeros(states),
            voltages: zeros(body),
            delayed: zeros(delays),
            evaluation: Scratch::new(program),
            fourth_differences: zeros(delays),
            last: StepStart { time: 0.0, states: zeros(states), voltages: zeros(body) },
        }
    }

    /// Samples of a voltage over the tried step: at both ends and at the two checked stages. `None` if the method
    /// checks fewer than two stages.
    pub fn samples(
        &self,
        method: &Tableau,
        [begin, end]: [&[f64]; 2],
        voltage: impl Fn(&[f64]) -> f64,
    ) -> Option<Samples> {
        let ([near, far], [early, late]) = (method.checked_stages, self.checked_voltages.as_slice()) else {
            return None;
        };
        let share = |stage: &usize| method.stages[*stage].at;
        let values = [begin, early, late, end].map(voltage);
        Some(Samples { shares: [0.0, share(near), share(far), 1.0], values })
    }
}
