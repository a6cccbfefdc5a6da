//! Read access to the parts of a program, for code that derives equations or evaluates a program at a chosen point.

use super::evaluate::Scratch;
use super::op::Sources;
use super::{Coefficient, Delay, Lamp, Level, Mode, Op, Program, Register, SampledValue, State};

/// A point at which a program is evaluated: a value for everything that varies in a run.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct ProgramPoint {
    /// Voltages of the states, in the order of [`Program::state_laws`].
    pub states: Vec<f64>,
    /// Values of the modes, in the order of [`Program::modes`].
    pub modes: Vec<f64>,
    /// Problem time in seconds.
    pub time: f64,
    /// Outputs of the delay lines in volts, in the order of [`Program::delays`].
    pub delayed: Vec<f64>,
    /// Sampled values in volts, in the order of [`Program::sampled_values`].
    pub sampled: Vec<f64>,
    /// Values of the levels, in the order of [`Program::levels`].
    pub levels: Vec<f64>,
}

impl Program {
    /// The operations that compute the coefficients from the parameters, in order of evaluation.
    pub fn prologue(&self) -> &[Op] {
        &self.lowered.prologue
    }

    /// The coefficients. Each is a register of the prologue, and the index is the one in [`Op::Coefficient`].
    pub fn coefficients(&self) -> &[Coefficient] {
        &self.lowered.coefficients
    }

    /// The values of the coefficients for the present parameters.
    pub fn coefficient_values(&self) -> Vec<f64> {
        let parameters: Vec<f64> = self.parameters.iter().map(|parameter| parameter.value).collect();
        self.prepare(&parameters)
    }

    /// The states; the index is the one in [`Op::State`].
    pub fn state_laws(&self) -> &[State] {
        &self.lowered.states
    }

    /// The modes; the index is the one in [`Op::Mode`].
    pub fn modes(&self) -> &[Mode] {
        &self.lowered.modes
    }

    /// The delay lines; the index is the one in [`Op::Delayed`].
    pub fn delays(&self) -> &[Delay] {
        &self.lowered.delays
    }

    /// The sampled values; the index is the one in [`Op::Sampled`].
    pub fn sampled_values(&self) -> &[SampledValue] {
        &self.lowered.sampled
    }

    /// The sources that are constant between known instants; the index is the one in [`Op::Level`].
    pub fn levels(&self) -> &[Level] {
        &self.lowered.levels
    }

    /// The overload lamps: the demanded and the limited output of each amplifier without a state.
    pub fn lamps(&self) -> &[Lamp] {
        &self.lowered.lamps
    }

    /// The points of the tables; the index is the one in [`Op::Table`].
    pub fn table_points(&self) -> &[Vec<[f64; 2]>] {
        &self.tables
    }

    /// The registers with the outputs of the drives.
    pub fn drive_registers(&self) -> &[Register] {
        &self.lowered.drives
    }

    /// Machine seconds per problem second.
    pub fn time_scale(&self) -> f64 {
        self.lowered.time_scale
    }

    /// The point with every state, mode and stored value as in initial condition, before loops and modes settle.
    pub fn initial_point(&self) -> ProgramPoint {
        self.initial_point_with(&self.coefficient_values())
    }

    /// The point of [`Program::initial_point`] for these coefficients.
    pub(crate) fn initial_point_with(&self, coefficients: &[f64]) -> ProgramPoint {
        let value = |index: u32| coefficients[index as usize];
        ProgramPoint {
            states: self.lowered.states.iter().map(|state| value(state.initial)).collect(),
            modes: self.lowered.modes.iter().map(|mode| mode.initial).collect(),
            time: 0.0,
            delayed: self.lowered.delays.iter().map(|delay| value(delay.initial)).collect(),
            sampled: self.lowered.sampled.iter().map(|sampled| value(sampled.initial)).collect(),
            levels: self.initial_levels(coefficients),
        }
    }

    /// Every voltage and rate at a point, with the present parameters. `None` if a loop without an integrator has no
    /// single solution there.
    ///
    /// # Panics
    /// If a list of the point is shorter than that of the program.
    ///
    /// # Examples
    ///
    /// ```
    /// use patchcord_core::circuit::Circuit;
    /// use patchcord_core::ir::Program;
    /// use patchcord_core::patch::{ElementBuilder, PatchBuilder};
    ///
    /// let decay = ElementBuilder::new("integrator").cords("x10", ["A1"]).set("initial", 50);
    /// let patch = PatchBuilder::new("decay").element("A1", decay).build()?;
    /// let program = Program::new(&Circuit::new(&patch)?)?;
    /// let mut point = program.initial_point();
    /// point.states[0] = 20.0;
    /// let voltages = program.voltages_at(&point).expect("there is no loop");
    /// assert_eq!(voltages[program.state_laws()[0].rate.index()], -200.0);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn voltages_at(&self, point: &ProgramPoint) -> Option<Vec<f64>> {
        let parameters: Vec<f64> = self.parameters.iter().map(|parameter| parameter.value).collect();
        let coefficients = self.prepare(&parameters);
        let from = Sources {
            parameters: &parameters,
            coefficients: &coefficients,
            states: &point.states,
            modes: &point.modes,
            time: point.time,
            tables: &self.tables,
            delayed: &point.delayed,
            sampled: &point.sampled,
            levels: &point.levels,
        };
        let mut registers = vec![0.0; self.lowered.body.len()];
        let mut scratch = Scratch::new(self);
        self.evaluate(&from, &mut registers, &mut scratch);
        scratch.faults.is_empty().then_some(registers)
    }
}
