//! Exact first derivatives of the rates with respect to states and parameters.

use nalgebra::DMatrix;

use super::Program;
use super::evaluate::Scratch;
use super::number::Dual;
use super::op::Sources;

/// Where a program is differentiated.
pub(crate) struct OperatingPoint<'a> {
    /// Parameters in SI.
    pub parameters: &'a [f64],
    pub states: &'a [f64],
    pub modes: &'a [f64],
    pub time: f64,
    /// What has arrived in the delay lines, and its slope in volts per second; `None` before anything has.
    pub delayed: &'a [Option<(f64, f64)>],
    pub kept: &'a [f64],
    pub noise: &'a [f64],
}

/// The derivatives of a program's rates at an instant: modes, kept values, noise and the contents of delay lines
/// stand still.
#[derive(Debug, Clone, PartialEq)]
pub struct Linearisation {
    /// Names of the states: rows of both matrices, columns of the first.
    pub states: Vec<String>,
    /// Names of the parameters: columns of the second matrix.
    pub parameters: Vec<String>,
    /// d(rate) / d(state), in 1 per problem second.
    pub by_states: DMatrix<f64>,
    /// d(rate) / d(parameter), in volts per problem second per SI unit of the parameter.
    pub by_parameters: DMatrix<f64>,
}

impl Program {
    /// Differentiates the rates at a point: forward mode over the operations, so exact but for rounding.
    /// At a kink the side counts on which the operations stand.
    pub(crate) fn linearise(&self, at: &OperatingPoint<'_>) -> Linearisation {
        let by_states = self.jacobian(at, at.states.len(), Direction::State);
        let by_parameters = self.jacobian(at, at.parameters.len(), Direction::Parameter);
        Linearisation {
            states: self.states().into_iter().map(str::to_owned).collect(),
            parameters: self.parameters.iter().map(|slot| slot.name.clone()).collect(),
            by_states,
            by_parameters,
        }
    }

    fn jacobian(
        &self,
        at: &OperatingPoint<'_>,
        columns: usize,
        along: impl Fn(usize) -> Direction,
    ) -> DMatrix<f64> {
        let mut matrix = DMatrix::zeros(self.states.len(), columns);
        for column in 0..columns {
            let slopes = self.slopes(at, along(column));
            slopes.into_iter().enumerate().for_each(|(row, slope)| matrix[(row, column)] = slope);
        }
        matrix
    }

    /// d(rate) along one direction, for every state.
    fn slopes(&self, at: &OperatingPoint<'_>, direction: Direction) -> Vec<f64> {
        let parameters = seeded(at.parameters, direction.parameter());
        let states = seeded(at.states, direction.state());
        let coefficients = self.prepare(&parameters);
        let delayed = self.delayed(at, &coefficients);
        let (kept, noise) = (seeded(at.kept, None), seeded(at.noise, None));
        let from = Sources {
            parameters: &parameters,
            coefficients: &coefficients,
            states: &states,
            modes: at.modes,
            time: Dual::new(at.time, 0.0),
            tables: &self.tables,
            delayed: &delayed,
            kept: &kept,
            noise: &noise,
        };
        let mut registers = vec![Dual::new(0.0, 0.0); self.body.len()];
        self.evaluate(&from, &mut registers, &mut Scratch::new(self));
        self.states.iter().map(|state| registers[state.rate.index()].slope).collect()
    }

    /// What the delay lines give: a longer delay reads further back in what they hold.
    fn delayed(&self, at: &OperatingPoint<'_>, coefficients: &[Dual]) -> Vec<Dual> {
        let pairs = self.delays.iter().zip(at.delayed);
        pairs
            .map(|(delay, arrived)| match *arrived {
                None => coefficients[delay.initial as usize],
                Some((volts, slope)) => {
                    let longer = coefficients[delay.time as usize].slope * delay.problem_seconds;
                    Dual::new(volts, -slope * longer)
                }
            })
            .collect()
    }
}

#[derive(Clone, Copy)]
enum Direction {
    State(usize),
    Parameter(usize),
}

impl Direction {
    fn state(self) -> Option<usize> {
        if let Direction::State(index) = self { Some(index) } else { None }
    }

    fn parameter(self) -> Option<usize> {
        if let Direction::Parameter(index) = self { Some(index) } else { None }
    }
}

fn seeded(values: &[f64], seed: Option<usize>) -> Vec<Dual> {
    let slope = |index| if Some(index) == seed { 1.0 } else { 0.0 };
    values.iter().enumerate().map(|(index, value)| Dual::new(*value, slope(index))).collect()
}
