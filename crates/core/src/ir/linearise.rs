//! Exact first derivatives of the rates with respect to states and parameters.

use nalgebra::DMatrix;

use super::Program;
use super::evaluate::Scratch;
use super::number::Dual;
use super::op::{Register, Sources};

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
    pub levels: &'a [f64],
}

/// The derivatives of a program's rates at an instant: modes, kept values, levels and the contents of delay lines
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
    /// At a kink these are the derivatives towards higher states and parameters.
    pub(crate) fn linearise(&self, at: &OperatingPoint<'_>) -> Linearisation {
        let rates: Vec<Register> = self.states.iter().map(|state| state.rate).collect();
        Linearisation {
            states: self.states().into_iter().map(str::to_owned).collect(),
            parameters: self.parameters.iter().map(|slot| slot.name.clone()).collect(),
            by_states: self.jacobian(at, &rates, upward((0..at.states.len()).map(Direction::State))),
            by_parameters: self.jacobian(
                at,
                &rates,
                upward((0..at.parameters.len()).map(Direction::Parameter)),
            ),
        }
    }

    /// d(register) / d(direction): a row for every register, a column for every direction.
    pub(super) fn jacobian(
        &self,
        at: &OperatingPoint<'_>,
        rows: &[Register],
        columns: impl ExactSizeIterator<Item = (Direction, Sense)>,
    ) -> DMatrix<f64> {
        let mut matrix = DMatrix::zeros(rows.len(), columns.len());
        for (column, (direction, sense)) in columns.enumerate() {
            let registers = self.slopes(at, direction, sense);
            for (row, register) in rows.iter().enumerate() {
                matrix[(row, column)] = sense.sign() * registers[register.index()].slope;
            }
        }
        matrix
    }

    /// Every voltage with its slope along one direction.
    fn slopes(&self, at: &OperatingPoint<'_>, direction: Direction, sense: Sense) -> Vec<Dual> {
        let seed = sense.sign();
        let parameters = seeded(at.parameters, direction.parameter(), seed);
        let states = seeded(at.states, direction.state(), seed);
        let coefficients = self.prepare(&parameters);
        let mut delayed = self.delayed(at, &coefficients);
        if let Direction::Delayed(index) = direction {
            delayed[index].slope = seed;
        }
        let (kept, levels) = (seeded(at.kept, None, seed), seeded(at.levels, None, seed));
        let from = Sources {
            parameters: &parameters,
            coefficients: &coefficients,
            states: &states,
            modes: at.modes,
            time: Dual::new(at.time, if matches!(direction, Direction::Time) { seed } else { 0.0 }),
            tables: &self.tables,
            delayed: &delayed,
            kept: &kept,
            levels: &levels,
        };
        let mut registers = vec![Dual::new(0.0, 0.0); self.body.len()];
        let mut scratch = Scratch::new(self);
        let rest = direction.output().map_or(0, |output| output.index() + 1);
        self.evaluate_range(0..rest, &from, &mut registers, &mut scratch);
        if let Some(output) = direction.output() {
            registers[output.index()].slope = seed;
        }
        self.evaluate_range(rest..self.body.len(), &from, &mut registers, &mut scratch);
        registers
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

/// To which side is differentiated.
#[derive(Clone, Copy, PartialEq)]
pub(super) enum Sense {
    Up,
    Down,
}

impl Sense {
    fn sign(self) -> f64 {
        match self {
            Sense::Up => 1.0,
            Sense::Down => -1.0,
        }
    }

    pub fn other(self) -> Self {
        match self {
            Sense::Up => Sense::Down,
            Sense::Down => Sense::Up,
        }
    }
}

/// Along what is differentiated.
#[derive(Clone, Copy)]
pub(super) enum Direction {
    /// The state of this index.
    State(usize),
    /// The parameter of this index.
    Parameter(usize),
    /// What comes out of the delay line of this index.
    Delayed(usize),
    /// Time.
    Time,
    /// An output that follows from parameters and time alone: a drive's.
    Output(Register),
}

impl Direction {
    fn state(self) -> Option<usize> {
        if let Direction::State(index) = self { Some(index) } else { None }
    }

    fn parameter(self) -> Option<usize> {
        if let Direction::Parameter(index) = self { Some(index) } else { None }
    }

    fn output(self) -> Option<Register> {
        if let Direction::Output(register) = self { Some(register) } else { None }
    }
}

/// Directions towards higher values.
pub(super) fn upward(
    directions: impl ExactSizeIterator<Item = Direction>,
) -> impl ExactSizeIterator<Item = (Direction, Sense)> {
    directions.map(|direction| (direction, Sense::Up))
}

fn seeded(values: &[f64], which: Option<usize>, seed: f64) -> Vec<Dual> {
    let slope = |index| if Some(index) == which { seed } else { 0.0 };
    values.iter().enumerate().map(|(index, value)| Dual::new(*value, slope(index))).collect()
}
