//! The linear model about an operating point, from all drives to all signals.
//!
//! Instruments compute roots and frequency responses from it. Modes are constant in the model, so it describes small
//! motions that switch nothing.

use super::linearise::{Direction, OperatingPoint, Sense, upward};
use super::op::{Op, Register};
use super::{Delay, LAMP_THRESHOLD, Program, SignalInfo, State};

/// The linear model of small motions about an operating point, in volts and problem seconds.
///
/// The symbols are: states x, outputs w and inputs z of the delay lines, drives u, signals y. Then
///
/// `[dx/dt; z; y] = matrix [x; w; u]` and `w_j(t) = z_j(t - T_j)`.
///
/// Modes, sampled values and noise are constant.
#[derive(Debug, Clone, PartialEq)]
pub struct StateSpace {
    /// The states: integrators and lags.
    pub states: Vec<StateTerm>,
    /// The delay lines.
    pub delays: Vec<DelayTerm>,
    /// The drives: under the names of the signals that read them, and under their own names.
    pub inputs: Vec<Port>,
    /// The signals, drives and elements.
    pub outputs: Vec<Port>,
    /// Names of the overloaded amplifiers. Their output is constant, so small motions do not pass through them.
    pub overloaded: Vec<String>,
    /// Names of the states, delay lines and drives for which the point is on a kink.
    pub kinks: Vec<String>,
    /// Names of the drives that change with time at this instant.
    pub moving: Vec<String>,
    /// The derivatives: at a kink those towards higher voltages, at a limit those away from it. The rows are the rates
    /// (per second), the inputs of delay lines and the signals. The columns are the states, the outputs of delay lines
    /// and the drives.
    pub matrix: Vec<Vec<f64>>,
}

/// A state of the linear model.
#[derive(Debug, Clone, PartialEq)]
pub struct StateTerm {
    /// Name of the integrator or lag.
    pub name: String,
    /// Its voltage at the operating point.
    pub volts: f64,
    /// Its rate there, in volts per second; 0 at an equilibrium.
    pub rate: f64,
    /// The reason if a mode holds the state; `None` if the state is free.
    pub hold: Option<StateHold>,
}

/// The reason why a state cannot move while the modes stay as they are.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum StateHold {
    /// It is at a limit and its rate points outward.
    Limit,
    /// Its brake holds it, it rests against a stop, or it is reset.
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

/// An input or output of the linear model.
#[derive(Debug, Clone, PartialEq)]
pub struct Port {
    /// Name of the signal, drive or element.
    pub name: String,
    /// Text of its unit.
    pub unit: String,
    /// Value of one volt in that unit.
    pub per_volt: f64,
    /// Its voltage at the operating point.
    pub volts: f64,
    /// Whether the patch defines it under `signals`.
    pub is_named: bool,
}

impl StateSpace {
    /// The derivatives of the rates with respect to the states, in 1 per second.
    ///
    /// # Examples
    ///
    /// ```
    /// use patchcord_core::circuit::Circuit;
    /// use patchcord_core::ir::Program;
    /// use patchcord_core::patch::{ElementBuilder, PatchBuilder};
    /// use patchcord_core::solve::Machine;
    ///
    /// let pot = ElementBuilder::new("pot").cord("in", "A1").set("setting", "k");
    /// let decay = ElementBuilder::new("integrator").cords("x1", ["P1"]).set("initial", 50);
    /// let patch = PatchBuilder::new("dx/dt = -k x").parameter("k", 0.5, "1", [0.0, 1.0]);
    /// let patch = patch.element("A1", decay).element("P1", pot).build()?;
    /// let program = Program::new(&Circuit::new(&patch)?)?;
    /// let model = Machine::new(&program, 1e-3)?.state_space();
    /// assert_eq!(model.state_matrix(), [[-0.5]]);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn state_matrix(&self) -> Vec<Vec<f64>> {
        let count = self.states.len();
        self.matrix[..count].iter().map(|row| row[..count].to_vec()).collect()
    }

    /// Names of the columns that differ from those of the other side by more than the rounding of loop solutions.
    fn kink_names(&self, other: &[Vec<f64>]) -> Vec<String> {
        let size = |row: &Vec<f64>| row.iter().fold(f64::MIN_POSITIVE, |size, slope| size.max(slope.abs()));
        let sizes: Vec<f64> = self.matrix.iter().map(size).collect();
        let differs = |column: usize| {
            let pairs = self.matrix.iter().zip(other).map(|(one, other)| (one[column] - other[column]).abs());
            pairs.zip(&sizes).any(|(difference, size)| difference > KINK_SLOPE_SHARE * size)
        };
        let states = self.states.iter().map(|state| &state.name);
        let delays = self.delays.iter().map(|delay| &delay.name);
        let names = states.chain(delays).chain(self.inputs.iter().map(|port| &port.name));
        let named = names.enumerate().filter(|(column, _)| differs(*column));
        named.map(|(_, name)| name.clone()).collect()
    }
}

/// Difference between the derivatives of two sides above which there is a kink, as a share of the row's largest
/// derivative.
const KINK_SLOPE_SHARE: f64 = 1e-9;

/// The direction and the side of a column of derivatives.
struct JacobianColumn {
    /// The variable of the column.
    direction: Direction,
    /// The side towards which the derivatives are taken first.
    sense: Sense,
    /// Whether motion in both directions is possible.
    is_two_sided: bool,
}

impl JacobianColumn {
    /// The opposite side, if motion in both directions is possible.
    fn other_side(&self) -> Sense {
        if self.is_two_sided { self.sense.other() } else { self.sense }
    }
}

impl Program {
    /// The linear model at a point with these voltages. `delays` are the delays of the lines, in problem seconds.
    pub(crate) fn state_space(
        &self,
        at: &OperatingPoint<'_>,
        registers: &[f64],
        delays: impl Iterator<Item = f64>,
    ) -> StateSpace {
        let coefficients = self.prepare(at.parameters);
        let port = |signal: &SignalInfo| self.port(signal, &coefficients, registers);
        let delay = |(delay, seconds): (&Delay, f64)| DelayTerm {
            name: self.name(delay.element).to_owned(),
            seconds,
        };
        let (rows, columns) = (self.rows(), self.columns(registers));
        let other_side = columns.iter().map(|column| (column.direction, column.other_side()));
        let mut model = StateSpace {
            states: self.state_terms(registers),
            delays: self.lowered.delays.iter().zip(delays).map(delay).collect(),
            inputs: self.driven().map(port).collect(),
            outputs: self.lowered.signals.iter().map(port).collect(),
            overloaded: self.overloaded(registers),
            kinks: Vec::new(),
            moving: self.time_driven(at),
            matrix: self.jacobian(at, &rows, columns.iter().map(|column| (column.direction, column.sense))),
        };
        model.kinks = model.kink_names(&self.jacobian(at, &rows, other_side));
        model
    }

    /// Number of rows and columns of the matrix of its [`StateSpace`]: states, delay lines and signals; and states, delay
    /// lines and drives.
    pub fn state_space_size(&self) -> [usize; 2] {
        let inner = self.lowered.states.len() + self.lowered.delays.len();
        [inner + self.lowered.signals.len(), inner + self.driven().count()]
    }

    /// The registers of the rows: rates, inputs of delay lines, signals.
    fn rows(&self) -> Vec<Register> {
        let rates = self.lowered.states.iter().map(|state| state.rate);
        let stored = self.lowered.delays.iter().map(|delay| delay.input);
        rates.chain(stored).chain(self.lowered.signals.iter().map(|signal| signal.register)).collect()
    }

    /// The directions of the columns: states, outputs of delay lines, drives. A state at a limit can only move away
    /// from it.
    fn columns(&self, registers: &[f64]) -> Vec<JacobianColumn> {
        let delayed = (0..self.lowered.delays.len()).map(Direction::Delayed);
        let drives = self.driven().map(|signal| Direction::Output(signal.register));
        let others = delayed.chain(drives);
        let others =
            others.map(|direction| JacobianColumn { direction, sense: Sense::Up, is_two_sided: true });
        let states = self.lowered.states.iter().enumerate().map(|(index, state)| {
            let volts = registers[self.lowered.elements[state.element].register.index()];
            let [lower, upper] = state.limits.map(|limit| registers[limit.index()]);
            JacobianColumn {
                direction: Direction::State(index),
                sense: if volts >= upper { Sense::Down } else { Sense::Up },
                is_two_sided: lower < volts && volts < upper,
            }
        });
        states.chain(others).collect()
    }

    /// The signals that read a drive.
    fn driven(&self) -> impl Iterator<Item = &SignalInfo> {
        self.lowered.signals.iter().filter(|signal| self.lowered.drives.contains(&signal.register))
    }

    /// Names of the drives that change with time at this instant.
    fn time_driven(&self, at: &OperatingPoint<'_>) -> Vec<String> {
        let slopes = self.jacobian(at, &self.lowered.drives, upward([Direction::Time].into_iter()));
        let moving = self.lowered.drives.iter().zip(slopes.iter()).filter(|(_, row)| row[0] != 0.0);
        let name = |drive: &Register| self.lowered.elements.iter().find(|output| output.register == *drive);
        moving.filter_map(|(drive, _)| Some(name(drive)?.name.clone())).collect()
    }

    /// Names of the amplifiers whose demanded output exceeds the reference.
    fn overloaded(&self, registers: &[f64]) -> Vec<String> {
        let lit =
            self.lowered.lamps.iter().filter(|lamp| registers[lamp.demand.index()].abs() > LAMP_THRESHOLD);
        lit.map(|lamp| self.name(lamp.element).to_owned()).collect()
    }

    /// A signal as an input or output of the model.
    fn port(&self, signal: &SignalInfo, coefficients: &[f64], registers: &[f64]) -> Port {
        Port {
            name: signal.name.clone(),
            unit: signal.unit.clone(),
            per_volt: signal.per_volt.map_or(1.0, |index| coefficients[index as usize] / signal.per_unit),
            volts: registers[signal.register.index()],
            is_named: signal.is_named,
        }
    }

    /// The states with their voltages, rates and holds.
    fn state_terms(&self, registers: &[f64]) -> Vec<StateTerm> {
        let term = |state: &State| StateTerm {
            name: self.name(state.element).to_owned(),
            volts: registers[self.lowered.elements[state.element].register.index()],
            rate: registers[state.rate.index()],
            hold: if self.is_held(state.demand, registers) {
                Some(StateHold::Brake)
            } else {
                self.is_held(state.rate, registers).then_some(StateHold::Limit)
            },
        };
        self.lowered.states.iter().map(term).collect()
    }

    /// Whether a mode has set this rate to 0.
    fn is_held(&self, rate: Register, registers: &[f64]) -> bool {
        match self.lowered.body[rate.index()] {
            Op::Select { left, right, then, otherwise } => {
                let is_left = registers[left.index()] >= registers[right.index()];
                let chosen = if is_left { then } else { otherwise };
                self.lowered.body[chosen.index()] == Op::Constant(0.0) || self.is_held(chosen, registers)
            }
            // This is the factor of the time scale.
            Op::Multiply(_, rate) => self.is_held(rate, registers),
            _ => false,
        }
    }
}
