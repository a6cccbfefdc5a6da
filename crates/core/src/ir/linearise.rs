//! Exact first derivatives of the program with respect to states, parameters and drives.
//!
//! The body is evaluated once per direction with dual numbers (forward mode of automatic differentiation). The results
//! are exact except for rounding. At a kink the derivative depends on the side, so every direction has a sense.

use super::Program;
use super::evaluate::Scratch;
use super::number::Dual;
use super::op::{Register, Sources};

/// The point at which a program is differentiated.
pub(crate) struct OperatingPoint<'a> {
    /// Parameters in SI.
    pub parameters: &'a [f64],
    /// Voltages of the states.
    pub states: &'a [f64],
    /// Values of the modes.
    pub modes: &'a [f64],
    /// Problem time in seconds.
    pub time: f64,
    /// Output of every delay line in volts, and its slope in volts per second. `None` before the first input arrives.
    pub delayed: &'a [Option<(f64, f64)>],
    /// Sampled values.
    pub sampled: &'a [f64],
    /// Present values of the levels.
    pub levels: &'a [f64],
}

/// The derivatives of a program's rates at one instant. Modes, sampled values, levels and the contents of delay lines
/// are constant.
#[derive(Debug, Clone, PartialEq)]
pub struct Linearisation {
    /// Names of the states: the rows of both matrices and the columns of `by_states`.
    pub states: Vec<String>,
    /// Names of the parameters: the columns of `by_parameters`.
    pub parameters: Vec<String>,
    /// d(rate) / d(state), in 1 per problem second, row by row.
    pub by_states: Vec<Vec<f64>>,
    /// d(rate) / d(parameter), in volts per problem second per SI unit of the parameter, row by row.
    pub by_parameters: Vec<Vec<f64>>,
}

impl Program {
    /// The derivatives of all rates at a point. At a kink they are those towards higher states and parameters.
    pub(crate) fn linearise(&self, at: &OperatingPoint<'_>) -> Linearisation {
        let rates: Vec<Register> = self.lowered.states.iter().map(|state| state.rate).collect();
        Linearisation {
            states: self.states().into_iter().map(str::to_owned).collect(),
            parameters: self.parameters.iter().map(|parameter| parameter.declared.name.clone()).collect(),
            by_states: self.jacobian(at, &rates, upward((0..at.states.len()).map(Direction::State))),
            by_parameters: self.jacobian(
                at,
                &rates,
                upward((0..at.parameters.len()).map(Direction::Parameter)),
            ),
        }
    }

    /// The derivatives d(register) / d(direction): one row per register, one column per direction.
    pub(super) fn jacobian(
        &self,
        at: &OperatingPoint<'_>,
        rows: &[Register],
        columns: impl ExactSizeIterator<Item = (Direction, Sense)>,
    ) -> Vec<Vec<f64>> {
        let mut matrix = vec![vec![0.0; columns.len()]; rows.len()];
        for (column, (direction, sense)) in columns.enumerate() {
            let registers = self.slopes(at, direction, sense);
            for (row, register) in rows.iter().enumerate() {
                matrix[row][column] = sense.sign() * registers[register.index()].slope;
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
        let (sampled, levels) = (seeded(at.sampled, None, seed), seeded(at.levels, None, seed));
        let from = Sources {
            parameters: &parameters,
            coefficients: &coefficients,
            states: &states,
            modes: at.modes,
            time: Dual::new(at.time, if matches!(direction, Direction::Time) { seed } else { 0.0 }),
            tables: &self.tables,
            delayed: &delayed,
            sampled: &sampled,
            levels: &levels,
        };
        let mut registers = vec![Dual::new(0.0, 0.0); self.lowered.body.len()];
        let mut scratch = Scratch::new(self);
        let rest = direction.output().map_or(0, |output| output.index() + 1);
        self.evaluate_range(0..rest, &from, &mut registers, &mut scratch);
        if let Some(output) = direction.output() {
            registers[output.index()].slope = seed;
        }
        self.evaluate_range(rest..self.lowered.body.len(), &from, &mut registers, &mut scratch);
        registers
    }

    /// The outputs of the delay lines. A longer delay reads older inputs, so its slope is minus that of the output.
    fn delayed(&self, at: &OperatingPoint<'_>, coefficients: &[Dual]) -> Vec<Dual> {
        let pairs = self.lowered.delays.iter().zip(at.delayed);
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

/// The side towards which a derivative is taken.
#[derive(Clone, Copy, PartialEq)]
pub(super) enum Sense {
    /// Towards higher values of the variable.
    Up,
    /// Towards lower values of the variable.
    Down,
}

impl Sense {
    /// The seed of the derivative: 1 or -1.
    fn sign(self) -> f64 {
        match self {
            Sense::Up => 1.0,
            Sense::Down => -1.0,
        }
    }

    /// The opposite sense.
    pub(super) fn other(self) -> Self {
        match self {
            Sense::Up => Sense::Down,
            Sense::Down => Sense::Up,
        }
    }
}

/// The variable with respect to which a derivative is taken.
#[derive(Clone, Copy)]
pub(super) enum Direction {
    /// The state with this index.
    State(usize),
    /// The parameter with this index.
    Parameter(usize),
    /// The output of the delay line with this index.
    Delayed(usize),
    /// Problem time.
    Time,
    /// An output that depends on parameters and time only: that of a drive.
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

/// These directions, each towards higher values.
pub(super) fn upward(
    directions: impl ExactSizeIterator<Item = Direction>,
) -> impl ExactSizeIterator<Item = (Direction, Sense)> {
    directions.map(|direction| (direction, Sense::Up))
}

/// Values as dual numbers. The one with index `which` has slope `seed`, all others have slope 0.
fn seeded(values: &[f64], which: Option<usize>, seed: f64) -> Vec<Dual> {
    let slope = |index| if Some(index) == which { seed } else { 0.0 };
    values.iter().enumerate().map(|(index, value)| Dual::new(*value, slope(index))).collect()
}
