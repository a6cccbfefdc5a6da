//! The linear model about an operating point: small motions between all drives and all signals.

use nalgebra::DMatrix;

use super::linearise::{Direction, OperatingPoint, Sense, upward};
use super::op::{Op, Register};
use super::{Delay, LAMP_LEVEL, Probe, Program, State};

/// Small motions about an operating point, in volts and problem seconds: with states x, what comes out of the delay
/// lines w, what goes into them z, the drives u and the signals y,
///
/// `[dx/dt; z; y] = matrix [x; w; u]` and `w_j(t) = z_j(t - T_j)`.
///
/// Modes, kept values and noise stand still.
#[derive(Debug, Clone, PartialEq)]
pub struct StateSpace {
    /// The states: integrators and lags.
    pub states: Vec<StateTerm>,
    /// The delay lines.
    pub delays: Vec<DelayTerm>,
    /// The drives, under the names of the signals that read them and under their own.
    pub inputs: Vec<Port>,
    /// The signals, drives and elements.
    pub outputs: Vec<Port>,
    /// Amplifiers that stand at ±100 V and are asked for more: nothing small comes through them.
    pub overloaded: Vec<String>,
    /// States, delay lines and drives along which the point stands on a kink.
    pub kinks: Vec<String>,
    /// Drives that change with time here.
    pub moving: Vec<String>,
    /// All derivatives, at a kink those towards higher voltages, and at a limit those away from it: rows of rates (per
    /// second), of what goes into delay lines, of signals; columns of states, of what comes out of delay lines, of drives.
    pub matrix: DMatrix<f64>,
}

/// A state of the linear model.
#[derive(Debug, Clone, PartialEq)]
pub struct StateTerm {
    /// Name of the integrator or lag.
    pub name: String,
    /// Its voltage at the operating point.
    pub volts: f64,
    /// Its rate there, in volts per second: 0 everywhere at an equilibrium.
    pub rate: f64,
    /// Why it stands still, where it does.
    pub hold: Option<Hold>,
}

/// What holds a state where it is: a mode, for as long as it lasts.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Hold {
    /// It stands at a limit and is driven outward.
    Limit,
    /// Its brake holds it, or it rests against a stop.
    Brake,
}

/// A delay line of the linear model.
#[derive(Debug, Clone, PartialEq)]
pub struct DelayTerm {
    /// Name of the element.
    pub name: String,
    /// Its delay T in problem seconds.
    pub seconds: f64,
}

/// Where the linear model is driven or read.
#[derive(Debug, Clone, PartialEq)]
pub struct Port {
    /// Name of the signal, drive or element.
    pub name: String,
    /// Text of its unit.
    pub unit: String,
    /// What one volt stands for, in that unit.
    pub per_volt: f64,
    /// Its voltage at the operating point.
    pub volts: f64,
    /// Whether the patch names it as a signal.
    pub is_named: bool,
}

impl StateSpace {
    /// d(rate) / d(state), in 1 per second.
    pub fn state_matrix(&self) -> DMatrix<f64> {
        self.matrix.view((0, 0), (self.states.len(), self.states.len())).into_owned()
    }

    /// The columns that differ from those towards the other side by more than rounding, which loops bring in.
    fn kinks_beside(&self, other: &DMatrix<f64>) -> Vec<String> {
        let sizes: Vec<f64> = self.matrix.row_iter().map(|row| row.amax().max(f64::MIN_POSITIVE)).collect();
        let differs = |column: usize| {
            let differences = self.matrix.column(column) - other.column(column);
            differences.iter().zip(&sizes).any(|(difference, size)| difference.abs() > ROUNDING * size)
        };
        let states = self.states.iter().map(|state| &state.name);
        let delays = self.delays.iter().map(|delay| &delay.name);
        let names = states.chain(delays).chain(self.inputs.iter().map(|port| &port.name));
        let named = names.enumerate().filter(|(column, _)| differs(*column));
        named.map(|(_, name)| name.clone()).collect()
    }
}

/// Share of the largest slope of a row by which rounding may make two sides differ.
const ROUNDING: f64 = 1e-9;

/// Along what a column is differentiated, and to which side.
struct Column {
    direction: Direction,
    sense: Sense,
    both_ways: bool,
}

impl Column {
    /// The other side, where there is one.
    fn beside(&self) -> Sense {
        if self.both_ways { self.sense.other() } else { self.sense }
    }
}

impl Program {
    /// The linear model at a point with these voltages; `delays` are those of the lines in problem seconds.
    pub(crate) fn state_space(
        &self,
        at: &OperatingPoint<'_>,
        registers: &[f64],
        delays: impl Iterator<Item = f64>,
    ) -> StateSpace {
        let coefficients = self.prepare(at.parameters);
        let port = |probe: &Probe| self.port(probe, &coefficients, registers);
        let delay = |(delay, seconds): (&Delay, f64)| DelayTerm {
            name: self.name(delay.element).to_owned(),
            seconds,
        };
        let (rows, columns) = (self.rows(), self.columns(registers));
        let beside = columns.iter().map(|column| (column.direction, column.beside()));
        let mut model = StateSpace {
            states: self.state_terms(registers),
            delays: self.delays.iter().zip(delays).map(delay).collect(),
            inputs: self.driven().map(port).collect(),
            outputs: self.signals.iter().map(port).collect(),
            overloaded: self.overloaded(registers),
            kinks: Vec::new(),
            moving: self.driven_by_time(at),
            matrix: self.jacobian(at, &rows, columns.iter().map(|column| (column.direction, column.sense))),
        };
        model.kinks = model.kinks_beside(&self.jacobian(at, &rows, beside));
        model
    }

    /// What is differentiated: rates, what goes into delay lines, signals.
    fn rows(&self) -> Vec<Register> {
        let rates = self.states.iter().map(|state| state.rate);
        let stored = self.delays.iter().map(|delay| delay.input);
        rates.chain(stored).chain(self.signals.iter().map(|probe| probe.register)).collect()
    }

    /// Along what: states, what comes out of delay lines, drives. A state at a limit can only go away from it.
    fn columns(&self, registers: &[f64]) -> Vec<Column> {
        let delayed = (0..self.delays.len()).map(Direction::Delayed);
        let drives = self.driven().map(|probe| Direction::Output(probe.register));
        let others = delayed.chain(drives);
        let others = others.map(|direction| Column { direction, sense: Sense::Up, both_ways: true });
        let states = self.states.iter().enumerate().map(|(index, state)| {
            let volts = registers[self.elements[state.element].register.index()];
            let [lower, upper] = state.limits.map(|limit| registers[limit.index()]);
            Column {
                direction: Direction::State(index),
                sense: if volts >= upper { Sense::Down } else { Sense::Up },
                both_ways: lower < volts && volts < upper,
            }
        });
        states.chain(others).collect()
    }

    /// The signals that read drives.
    fn driven(&self) -> impl Iterator<Item = &Probe> {
        self.signals.iter().filter(|probe| self.drives.contains(&probe.register))
    }

    /// Names of the drives that time moves at this instant.
    fn driven_by_time(&self, at: &OperatingPoint<'_>) -> Vec<String> {
        let slopes = self.jacobian(at, &self.drives, upward([Direction::Time].into_iter()));
        let moving = self.drives.iter().zip(slopes.iter()).filter(|(_, slope)| **slope != 0.0);
        let name = |drive: &Register| self.elements.iter().find(|outlet| outlet.register == *drive);
        moving.filter_map(|(drive, _)| Some(name(drive)?.name.clone())).collect()
    }

    fn overloaded(&self, registers: &[f64]) -> Vec<String> {
        let lit = self.lamps.iter().filter(|lamp| registers[lamp.demand.index()].abs() > LAMP_LEVEL);
        lit.map(|lamp| self.name(lamp.element).to_owned()).collect()
    }

    fn port(&self, probe: &Probe, coefficients: &[f64], registers: &[f64]) -> Port {
        Port {
            name: probe.name.clone(),
            unit: probe.unit.clone(),
            per_volt: probe.per_volt.map_or(1.0, |index| coefficients[index as usize] / probe.per_unit),
            volts: registers[probe.register.index()],
            is_named: probe.is_named,
        }
    }

    fn state_terms(&self, registers: &[f64]) -> Vec<StateTerm> {
        let term = |state: &State| StateTerm {
            name: self.name(state.element).to_owned(),
            volts: registers[self.elements[state.element].register.index()],
            rate: registers[state.rate.index()],
            hold: if self.is_stopped(state.demand, registers) {
                Some(Hold::Brake)
            } else {
                self.is_stopped(state.rate, registers).then_some(Hold::Limit)
            },
        };
        self.states.iter().map(term).collect()
    }

    /// Whether a rate is the nothing that a mode has chosen.
    fn is_stopped(&self, rate: Register, registers: &[f64]) -> bool {
        match self.body[rate.index()] {
            Op::Select { left, right, then, otherwise } => {
                let is_left = registers[left.index()] >= registers[right.index()];
                let chosen = if is_left { then } else { otherwise };
                self.body[chosen.index()] == Op::Constant(0.0) || self.is_stopped(chosen, registers)
            }
            // The time scale.
            Op::Multiply(_, rate) => self.is_stopped(rate, registers),
            _ => false,
        }
    }
}
