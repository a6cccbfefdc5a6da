//! Read access to the parts of a program, for code that derives equations or evaluates a program at a chosen point.

use std::collections::{BTreeMap, HashMap};

use super::evaluate::{Evaluation as _, Scratch};
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
        self.with_sources(point, |from| {
            let mut registers = vec![0.0; self.lowered.body.len()];
            let mut scratch = Scratch::new(self);
            self.evaluate(from, &mut registers, &mut scratch);
            scratch.faults.is_empty().then_some(registers)
        })
    }

    /// Every voltage and rate at a point, as by [`Program::voltages_at`], with two differences. The given outputs have
    /// the given voltages in volts, whatever their inputs are. Amplifiers outside loops without an integrator are not
    /// limited at ±100 V. `None` if such a loop has no single solution.
    ///
    /// In a loop, given outputs count inside only if all its tears are given.
    ///
    /// # Panics
    /// If a list of the point is shorter than that of the program.
    ///
    /// # Examples
    ///
    /// ```
    /// use std::collections::BTreeMap;
    ///
    /// use patchcord_core::circuit::Circuit;
    /// use patchcord_core::ir::Program;
    /// use patchcord_core::patch::{ElementBuilder, PatchBuilder};
    ///
    /// let first = ElementBuilder::new("summer").cords("x10", ["+100"]);
    /// let second = ElementBuilder::new("inverter").cord("in", "S1");
    /// let patch = PatchBuilder::new("chain").element("S1", first).element("B1", second).build()?;
    /// let program = Program::new(&Circuit::new(&patch)?)?;
    /// let outputs: Vec<_> = program.element_outputs().iter().map(|output| output.register).collect();
    /// let [.., s1, b1] = outputs[..] else { unreachable!("there are two elements") };
    /// let point = program.initial_point();
    /// let free = program.unlimited_voltages_at(&point, &BTreeMap::new()).expect("there is no loop");
    /// assert_eq!((free[s1.index()], free[b1.index()]), (-1000.0, 1000.0));
    /// let given = program.unlimited_voltages_at(&point, &BTreeMap::from([(s1, 30.0)])).expect("there is no loop");
    /// assert_eq!(given[b1.index()], -30.0);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn unlimited_voltages_at(
        &self,
        point: &ProgramPoint,
        given: &BTreeMap<Register, f64>,
    ) -> Option<Vec<f64>> {
        self.with_sources(point, |from| {
            let registers = vec![0.0; self.lowered.body.len()];
            let (demands, scratch) = (self.demands_outside_loops(), Scratch::new(self));
            let mut evaluation = Unlimited { program: self, from, given, demands, registers, scratch };
            let mut at = 0;
            while at < self.lowered.body.len() {
                at = evaluation.step(at);
            }
            evaluation.scratch.faults.is_empty().then_some(evaluation.registers)
        })
    }

    /// Calls a function with everything that operations read at a point, for the present parameters.
    fn with_sources<T>(&self, point: &ProgramPoint, evaluate: impl FnOnce(&Sources<'_, f64>) -> T) -> T {
        let parameters: Vec<f64> = self.parameters.iter().map(|parameter| parameter.value).collect();
        let coefficients = self.prepare(&parameters);
        evaluate(&Sources {
            parameters: &parameters,
            coefficients: &coefficients,
            states: &point.states,
            modes: &point.modes,
            time: point.time,
            tables: &self.tables,
            delayed: &point.delayed,
            sampled: &point.sampled,
            levels: &point.levels,
        })
    }

    /// The demanded outputs of the amplifiers outside loops, by the registers of their outputs.
    pub(super) fn demands_outside_loops(&self) -> HashMap<Register, Register> {
        let is_in_loop = |index: &usize| self.lowered.loops.iter().any(|entry| entry.lamps.contains(index));
        let lamps = self.lowered.lamps.iter().enumerate().filter(|(index, _)| !is_in_loop(index));
        lamps.map(|(_, lamp)| (lamp.output, lamp.demand)).collect()
    }
}

/// An evaluation with given outputs and without the limits of amplifiers.
struct Unlimited<'a> {
    program: &'a Program,
    from: &'a Sources<'a, f64>,
    /// Voltages of given outputs.
    given: &'a BTreeMap<Register, f64>,
    /// The demanded outputs that replace limited ones.
    demands: HashMap<Register, Register>,
    /// The values so far.
    registers: Vec<f64>,
    scratch: Scratch,
}

impl Unlimited<'_> {
    /// Computes the register at an index, or the loop that begins there. Returns the index that follows.
    fn step(&mut self, at: usize) -> usize {
        let program = self.program;
        let Op::Tear { index, .. } = program.lowered.body[at] else {
            self.registers[at] = self.value(Register(at as u32));
            return at + 1;
        };
        let entry = &program.lowered.loops[index as usize];
        let are_tears_given = entry.tears.iter().all(|tear| self.given.contains_key(&tear.register));
        if !are_tears_given {
            f64::close(program, index as usize, self.from, &mut self.registers, &mut self.scratch);
        }
        let end = if are_tears_given { entry.operations.start } else { entry.operations.end };
        for (register, volts) in self.given.range(Register(at as u32)..Register(end as u32)) {
            self.registers[register.index()] = *volts;
        }
        end
    }

    /// The value of a register outside loops.
    fn value(&self, register: Register) -> f64 {
        if let Some(volts) = self.given.get(&register) {
            return *volts;
        }
        match self.demands.get(&register) {
            Some(demand) => self.registers[demand.index()],
            None => {
                let op = self.program.lowered.body[register.index()];
                op.apply(self.from, |operand| self.registers[operand.index()])
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::circuit::Circuit;
    use crate::patch::{ElementBuilder, PatchBuilder};

    /// S1 = -(60 V + S1 / 2), which is -40 V.
    fn loop_with_a_pot() -> Program {
        let input = ElementBuilder::new("pot").cord("in", "+100").set("setting", 0.6);
        let feedback = ElementBuilder::new("pot").cord("in", "S1").set("setting", 0.5);
        let summer = ElementBuilder::new("summer").cords("x1", ["P1", "P2"]);
        let patch = PatchBuilder::new("loop").element("P1", input).element("P2", feedback);
        Program::new(&Circuit::new(&patch.element("S1", summer).build().unwrap()).unwrap()).unwrap()
    }

    /// The voltages of P2 and S1, with these given outputs.
    fn voltages(given: &[(&str, f64)]) -> [f64; 2] {
        let program = loop_with_a_pot();
        let register = |name: &str| program.element_outputs()[program.element(name).unwrap()].register;
        let given = given.iter().map(|(name, volts)| (register(name), *volts)).collect();
        let registers = program.unlimited_voltages_at(&program.initial_point(), &given).unwrap();
        ["P2", "S1"].map(|name| registers[register(name).index()])
    }

    #[test]
    fn a_loop_is_solved_unless_its_tears_are_given() {
        let near = |found: [f64; 2], expected: [f64; 2]| {
            found.iter().zip(expected).all(|(one, other)| (one - other).abs() < 1e-9)
        };
        assert!(near(voltages(&[]), [-20.0, -40.0]), "{:?}", voltages(&[]));
        // P2 is half of S1, whatever S1 should be.
        assert_eq!(voltages(&[("S1", -30.0)]), [-15.0, -30.0]);
    }
}
