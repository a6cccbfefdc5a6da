//! The derivatives of all voltages with respect to time at a point, without a run.

use std::collections::{BTreeMap, HashMap};

use super::loops::close_slopes;
use super::number::Number as _;
use super::op::Sources;
use super::series::{Series, TERMS};
use super::{Loop, Op, Program, ProgramPoint, Register, Tear};
use crate::machines::REFERENCE;

/// The highest derivative that [`Program::derivatives_at`] computes.
pub const MAX_DERIVATIVE: usize = TERMS - 1;

impl Program {
    /// The derivatives of every voltage with respect to problem time. Entry n has the n-th derivatives of all registers,
    /// from entry 0 with the voltages. There are at most [`MAX_DERIVATIVE`] of them.
    ///
    /// `voltages` are those of [`Program::unlimited_voltages_at`] at this point with these given outputs. The states move
    /// at their rates, without their limits. Drives follow their laws of time. Given outputs, modes, and what delay
    /// lines, samplers and levels give out are constant. At a kink the derivatives are those after the instant.
    ///
    /// The derivatives are exact up to rounding: they follow from Taylor series of all voltages, not from differences.
    /// A derivative that does not exist is infinite or NaN.
    ///
    /// # Panics
    /// If a list of the point, or that of the voltages, is shorter than that of the program.
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
    /// // The output falls as 50 V x exp(-10 t).
    /// let decay = ElementBuilder::new("integrator").cords("x10", ["A1"]).set("initial", 50);
    /// let patch = PatchBuilder::new("decay").element("A1", decay).build()?;
    /// let program = Program::new(&Circuit::new(&patch)?)?;
    /// let (point, given) = (program.initial_point(), BTreeMap::new());
    /// let voltages = program.unlimited_voltages_at(&point, &given).expect("there is no loop");
    /// let derivatives = program.derivatives_at(&point, &given, &voltages, 3);
    /// let output = program.element_outputs().last().expect("there is an integrator").register.index();
    /// assert!((derivatives[3][output] + 50_000.0).abs() < 1e-6);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn derivatives_at(
        &self,
        point: &ProgramPoint,
        given: &BTreeMap<Register, f64>,
        voltages: &[f64],
        order: usize,
    ) -> Vec<Vec<f64>> {
        let mut motion = Motion::new(self, point, given, voltages, self.unit_of_time(voltages));
        let order = order.min(MAX_DERIVATIVE);
        (1..=order).for_each(|term| motion.add_term(term));
        (0..=order).map(|order| motion.derivatives(order)).collect()
    }

    /// The voltages of all registers with infinite amplification of the open amplifiers, less those with their finite
    /// amplification, to first order. `voltages` are those of [`Program::unlimited_voltages_at`] at this point with
    /// these given outputs.
    ///
    /// An entry is infinite or NaN if the feedback of an amplifier does not depend on its output.
    ///
    /// # Panics
    /// As [`Program::derivatives_at`].
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
    /// // The sum 50 V + S1 is 0 V for S1 = -50 V. With an amplification of 1e4 it is 5 mV.
    /// let half = ElementBuilder::new("pot").cord("in", "+100").set("setting", 0.5);
    /// let open = ElementBuilder::new("open-amplifier").cords("x1", ["P1", "S1"]).set("amplification", 1e4);
    /// let patch = PatchBuilder::new("inverter").element("P1", half).element("S1", open).build()?;
    /// let program = Program::new(&Circuit::new(&patch)?)?;
    /// let (point, given) = (program.initial_point(), BTreeMap::new());
    /// let voltages = program.unlimited_voltages_at(&point, &given).expect("there is one solution");
    /// let output = program.element_outputs().last().expect("there is an amplifier").register.index();
    /// let error = program.amplification_errors_at(&point, &given, &voltages)[output];
    /// assert!((voltages[output] + error + 50.0).abs() < 1e-5);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn amplification_errors_at(
        &self,
        point: &ProgramPoint,
        given: &BTreeMap<Register, f64>,
        voltages: &[f64],
    ) -> Vec<f64> {
        // In a unit of time of 0 s neither states nor drives move.
        let mut motion = Motion::new(self, point, given, voltages, 0.0);
        motion.corrects_amplification = true;
        motion.add_term(1);
        motion.registers.iter().map(|series| series.terms[1]).collect()
    }

    /// The time in problem seconds in which the fastest state changes by 100 V; 1 s if none moves. With this unit of
    /// time the terms of all series have the size of voltages.
    fn unit_of_time(&self, voltages: &[f64]) -> f64 {
        let rates = self.lowered.states.iter().map(|state| voltages[state.demand.index()].abs());
        let unit = REFERENCE / rates.fold(0.0, f64::max);
        if unit.is_finite() && unit > 0.0 { unit } else { 1.0 }
    }
}

/// The motion of a machine from a point, as series of time in its own unit.
struct Motion<'a> {
    program: &'a Program,
    point: &'a ProgramPoint,
    given: &'a BTreeMap<Register, f64>,
    /// The demanded outputs that replace limited ones.
    demands: HashMap<Register, Register>,
    /// The unit of time in problem seconds.
    unit: f64,
    /// What operations read in addition to registers.
    inputs: Inputs,
    /// The registers. The terms are known up to the last one that was added.
    registers: Vec<Series>,
    /// Whether the inputs of open amplifiers change by what a finite amplification leaves there.
    corrects_amplification: bool,
}

/// What operations read in addition to registers, as series. Only time and the states vary.
struct Inputs {
    coefficients: Vec<Series>,
    states: Vec<Series>,
    delayed: Vec<Series>,
    sampled: Vec<Series>,
    levels: Vec<Series>,
    time: Series,
}

impl Inputs {
    /// The values at a point. Time has its rate.
    fn new(program: &Program, point: &ProgramPoint, unit: f64) -> Self {
        let constants =
            |values: &[f64]| -> Vec<Series> { values.iter().map(|value| Series::constant(*value)).collect() };
        Inputs {
            coefficients: constants(&program.coefficient_values()),
            states: constants(&point.states),
            delayed: constants(&point.delayed),
            sampled: constants(&point.sampled),
            levels: constants(&point.levels),
            time: Series::rising(point.time, unit),
        }
    }
}

impl<'a> Motion<'a> {
    /// The motion at its first instant, with a unit of time in problem seconds.
    fn new(
        program: &'a Program,
        point: &'a ProgramPoint,
        given: &'a BTreeMap<Register, f64>,
        voltages: &[f64],
        unit: f64,
    ) -> Self {
        let inputs = Inputs::new(program, point, unit);
        let registers = voltages.iter().map(|volts| Series::constant(*volts)).collect();
        let demands = program.demands_outside_loops();
        Motion { program, point, given, demands, unit, inputs, registers, corrects_amplification: false }
    }

    /// Adds a term to all series. The terms before it must be known.
    fn add_term(&mut self, term: usize) {
        for (state, law) in self.inputs.states.iter_mut().zip(&self.program.lowered.states) {
            let rate = self.registers[law.demand.index()].terms[term - 1];
            state.terms[term] = rate * self.unit / term as f64;
        }
        let mut at = 0;
        while at < self.registers.len() {
            at = self.step(at, term);
        }
    }

    /// Adds a term to the register at an index, or to the loop that begins there. Returns the index that follows.
    fn step(&mut self, at: usize, term: usize) -> usize {
        let program = self.program;
        let Op::Tear { index, .. } = program.lowered.body[at] else {
            self.registers[at].terms[term] = self.term(Register(at as u32), term);
            return at + 1;
        };
        let entry = &program.lowered.loops[index as usize];
        if entry.tears.iter().all(|tear| self.given.contains_key(&tear.register)) {
            return entry.operations.start;
        }
        self.close(entry, term);
        for (register, _) in self.given.range(Register(at as u32)..Register(entry.operations.end as u32)) {
            self.registers[register.index()].terms[term] = 0.0;
        }
        entry.operations.end
    }

    /// The term of a register outside loops.
    fn term(&self, register: Register, term: usize) -> f64 {
        if self.given.contains_key(&register) {
            return 0.0;
        }
        match self.demands.get(&register) {
            Some(demand) => self.registers[demand.index()].terms[term],
            None => self.computed(register.index(), term),
        }
    }

    /// The term of the operation at an index.
    fn computed(&self, at: usize, term: usize) -> f64 {
        let from = Sources {
            parameters: &[],
            coefficients: &self.inputs.coefficients,
            states: &self.inputs.states,
            modes: &self.point.modes,
            time: self.inputs.time,
            tables: &self.program.tables,
            delayed: &self.inputs.delayed,
            sampled: &self.inputs.sampled,
            levels: &self.inputs.levels,
        };
        let op = self.program.lowered.body[at];
        op.apply(&from, |register| self.registers[register.index()]).terms[term]
    }

    /// Adds a term to a loop. The recomputed outputs are linear in the terms of the tears.
    fn close(&mut self, entry: &Loop, term: usize) {
        close_slopes(entry.tears.len(), |tears| {
            for (tear, value) in entry.tears.iter().zip(&*tears) {
                self.registers[tear.register.index()].terms[term] = *value;
            }
            for at in entry.operations.clone() {
                self.registers[at].terms[term] = self.computed(at, term);
            }
            for (tear, value) in entry.tears.iter().zip(tears) {
                *value = self.registers[tear.result.index()].terms[term] + self.correction(tear);
            }
        });
    }

    /// The change of an open amplifier's demanded output if its amplification becomes infinite, and its output is kept.
    fn correction(&self, tear: &Tear) -> f64 {
        let is_corrected = self.corrects_amplification && tear.amplification.is_some();
        if is_corrected { self.registers[tear.register.index()].terms[0] } else { 0.0 }
    }

    /// The derivatives of this order of all registers, with respect to problem time.
    fn derivatives(&self, order: usize) -> Vec<f64> {
        let factor = (1..=order).fold(1.0, |factor, term| factor * term as f64 / self.unit);
        self.registers.iter().map(|series| factor * series.terms[order]).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::circuit::Circuit;
    use crate::patch::{ElementBuilder, PatchBuilder};

    /// The derivatives of an element's output at the initial condition.
    fn derivatives(patch: PatchBuilder, element: &str, order: usize) -> Vec<f64> {
        let program = Program::new(&Circuit::new(&patch.build().unwrap()).unwrap()).unwrap();
        let (point, given) = (program.initial_point(), BTreeMap::new());
        let voltages = program.unlimited_voltages_at(&point, &given).unwrap();
        let register = program.element_outputs()[program.element(element).unwrap()].register;
        let found = program.derivatives_at(&point, &given, &voltages, order);
        found.iter().map(|of_order| of_order[register.index()]).collect()
    }

    fn assert_near(found: &[f64], expected: &[f64]) {
        assert_eq!(found.len(), expected.len());
        for (found, expected) in found.iter().zip(expected) {
            assert!(
                (found - expected).abs() <= 1e-12 * expected.abs().max(1e-3),
                "{found} is not {expected}"
            );
        }
    }

    #[test]
    fn an_oscillator_has_the_derivatives_of_a_cosine() {
        // A2 = 50 V x cos(1000 t), and A1 is its rate / -1000.
        let first = ElementBuilder::new("integrator").cords("x1000", ["B1"]);
        let second = ElementBuilder::new("integrator").cords("x1000", ["A1"]).set("initial", 50);
        let inverter = ElementBuilder::new("inverter").cord("in", "A2");
        let patch = PatchBuilder::new("oscillator").element("A1", first).element("A2", second);
        let found = derivatives(patch.element("B1", inverter), "A2", 6);
        assert_near(&found, &[50.0, 0.0, -50e6, 0.0, 50e12, 0.0, -50e18]);
    }

    #[test]
    fn a_loop_is_differentiated_implicitly() {
        // S1 = -(A1 + S1 / 2) = -A1 / 1.5, and A1 = 60 V x exp(-t).
        let decay = ElementBuilder::new("integrator").cords("x1", ["A1"]).set("initial", 60);
        let feedback = ElementBuilder::new("pot").cord("in", "S1").set("setting", 0.5);
        let summer = ElementBuilder::new("summer").cords("x1", ["A1", "P1"]);
        let patch = PatchBuilder::new("loop").element("A1", decay).element("P1", feedback);
        let found = derivatives(patch.element("S1", summer), "S1", 4);
        assert_near(&found, &[-40.0, 40.0, -40.0, 40.0, -40.0]);
    }

    #[test]
    fn higher_derivatives_than_the_highest_are_left_out() {
        let decay = ElementBuilder::new("integrator").cords("x1", ["A1"]).set("initial", 60);
        let found = derivatives(PatchBuilder::new("decay").element("A1", decay), "A1", 40);
        assert_eq!(found.len(), MAX_DERIVATIVE + 1);
        assert_near(&found[MAX_DERIVATIVE..], &[60.0]);
    }
}
