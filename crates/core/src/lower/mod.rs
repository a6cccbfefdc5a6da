//! Lowers a circuit to a program: emits every element's law once.
//!
//! Outputs come first, in the order in which elements depend on each other. Memory laws come second, because they can
//! read any output. Then follow signals, scales, switches and orders of settings. Finally the body is sorted and the
//! finished program is checked.

mod check;
mod dry_run;
mod element_laws;
mod laws;
mod prologue;

use std::collections::HashMap;
use std::sync::Arc;

use crate::circuit::{Circuit, EvaluationStep};
use crate::document::Report;
use crate::elements::{AMPLIFICATION, Family, OutputStage};
use crate::ir::{
    Builder, Draft, ElementOutput, Lamp, Loop, Op, ParameterDeclaration, ParameterValue, Program, Register,
    Relation, ScaleFactor, SettingOrder, SignalInfo, Switch, Tear,
};
use crate::machines::REFERENCE;
use patchcord_expr::Dimension;

impl Program {
    /// Lowers a checked circuit to a program, and solves its loops once in initial condition.
    ///
    /// # Errors
    /// If a coefficient is not a finite number in its range, or if a loop without an integrator does not have exactly
    /// one solution.
    ///
    /// # Examples
    ///
    /// ```
    /// use patchcord_core::circuit::Circuit;
    /// use patchcord_core::ir::Program;
    /// use patchcord_core::patch::{ElementBuilder, PatchBuilder};
    ///
    /// // dx/dt = -x, from 50 V
    /// let decay = ElementBuilder::new("integrator").cords("x1", ["A1"]).set("initial", 50);
    /// let patch = PatchBuilder::new("decay").element("A1", decay).build()?;
    /// let program = Program::new(&Circuit::new(&patch)?)?;
    /// assert_eq!(program.states(), ["A1"]);
    /// assert!(program.loops().is_empty());
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn new(circuit: &Circuit) -> Result<Program, Box<Report>> {
        let mut lowering = Lowering::new(circuit);
        lowering.outputs();
        lowering.memories();
        lowering.signals();
        lowering.scales();
        lowering.switches();
        lowering.orders();
        let program = lowering.finish();
        let findings = check::findings(circuit, &program);
        if findings.is_empty() {
            return Ok(program);
        }
        // The parts of an edited patch have no positions, but its text has.
        match circuit.reread() {
            Some(read) => Program::new(&read?),
            None => Err(Box::new(circuit.report_with(findings))),
        }
    }
}

/// Lowers a circuit, like [`Program::new`].
///
/// # Examples
///
/// ```
/// use patchcord_core::circuit::Circuit;
/// use patchcord_core::ir::Program;
/// use patchcord_core::patch::{ElementBuilder, PatchBuilder};
///
/// let ramp = ElementBuilder::new("integrator").cords("x1", ["+100"]);
/// let patch = PatchBuilder::new("ramp").element("A1", ramp).build()?;
/// let circuit = Circuit::new(&patch)?;
/// let program: Program = (&circuit).try_into()?;
/// assert_eq!(program.states(), ["A1"]);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
impl TryFrom<&Circuit> for Program {
    type Error = Box<Report>;

    /// As [`Program::new`], with the same errors.
    fn try_from(circuit: &Circuit) -> Result<Self, Self::Error> {
        Program::new(circuit)
    }
}

/// A circuit during lowering.
struct Lowering<'c> {
    /// The checked circuit. Lowering reads it and never changes it.
    circuit: &'c Circuit,
    /// The program so far, with the register of every output that was emitted.
    draft: Draft,
    /// Indices of the coefficients of settings that laws have read, by element and setting.
    settings: HashMap<(usize, usize), u32>,
    /// Registers of the prologue that contain named values.
    names: HashMap<String, Register>,
}

impl<'c> Lowering<'c> {
    /// Begins the lowering: the program has the parameters in SI units, the time scale and the readers of every
    /// element, and no operation yet.
    fn new(circuit: &'c Circuit) -> Self {
        let elements = circuit.elements();
        let parameters = circuit.parameters().map(|(name, parameter, value)| {
            let declared = ParameterDeclaration {
                name: name.to_owned(),
                per_unit: parameter.unit.factor(),
                range: parameter.range,
                unit: parameter.unit.text().to_owned(),
                dimension: parameter.unit.dimension(),
            };
            ParameterValue { value: value * declared.per_unit, declared: Arc::new(declared) }
        });
        let mut program = Program { parameters: parameters.collect(), ..Program::default() };
        program.lowered_mut().readers = circuit.all_readers();
        program.lowered_mut().time_scale = circuit.time_scale();
        let draft = Draft::new(program, elements.len());
        Lowering { circuit, draft, settings: HashMap::new(), names: HashMap::new() }
    }

    /// The interface through which laws emit operations. The current element is `draft.current`.
    fn builder(&mut self) -> &mut dyn Builder {
        self
    }

    /// Emits the outputs in the order of evaluation, and lists their registers in the order of the circuit.
    fn outputs(&mut self) {
        let circuit = self.circuit;
        circuit.evaluation_order().iter().for_each(|step| self.step(step));
        let elements: Vec<_> = (circuit.elements().iter().zip(&self.draft.outputs))
            .map(|(element, register)| ElementOutput {
                name: element.name.clone(),
                register: register.expect("every element is in one step"),
            })
            .collect();
        let named = elements.iter().enumerate();
        let lowered = self.draft.program.lowered_mut();
        lowered.element_indices = named.map(|(index, output)| (output.name.clone(), index)).collect();
        lowered.elements = elements;
    }

    /// Emits an element, or a loop with its elements. All voltages that it reads are emitted by now, except the
    /// unknowns of a loop that contains it.
    fn step(&mut self, step: &EvaluationStep) {
        match step {
            EvaluationStep::Element(element) => self.output(*element),
            EvaluationStep::Loop { openers, members } => self.close_loop(openers, members),
        }
    }

    /// Emits the output of an element. The output of an amplifier is limited and gets a lamp.
    ///
    /// An integrator needs no limit here: its state is limited where it is integrated. A network is limited by its
    /// inputs only.
    fn output(&mut self, element: usize) {
        self.draft.current = element;
        let kind = self.circuit.element(element).kind;
        let mut register = (kind.output_law)(self.builder());
        if matches!(kind.output, OutputStage::Amplifier | OutputStage::OpenAmplifier) {
            let output = self.clip(register);
            self.draft.program.lowered_mut().lamps.push(Lamp { element, demand: register, output });
            register = output;
        }
        if kind.family == Family::Drive {
            self.draft.program.lowered_mut().drives.push(register);
        }
        self.draft.outputs[element] = Some(register);
        self.draft.program.lowered_mut().order.push(element);
    }

    /// The demanded output, limited to ±100 V: max(min(demand, 100 V), -100 V).
    fn clip(&mut self, demand: Register) -> Register {
        let builder = self.builder();
        let (upper, lower) = (builder.constant(REFERENCE), builder.constant(-REFERENCE));
        let below = builder.minimum(demand, upper);
        builder.maximum(below, lower)
    }

    /// Emits a loop: its tears, and then the outputs of its members.
    ///
    /// A tear is the unknown output of an element that opens the loop. It takes the place of the output. The operations
    /// that follow compute the output again, as a function of all tears. The solver finds the fixed point of this
    /// function.
    fn close_loop(&mut self, openers: &[usize], members: &[usize]) {
        let index = self.draft.program.lowered.loops.len() as u32;
        for (position, opener) in openers.iter().enumerate() {
            let tear = self.builder().emit(Op::Tear { index, position: position as u32 });
            self.draft.outputs[*opener] = Some(tear);
        }
        let begin = self.draft.program.lowered.body.len();
        let first_lamp = self.draft.program.lowered.lamps.len();
        let mut tears: Vec<(usize, Tear)> = Vec::new();
        for member in members {
            // Before its law runs, only an opener has a register.
            let tear = self.draft.outputs[*member];
            self.output(*member);
            if let (Some(register), Some(result)) = (tear, self.draft.outputs[*member]) {
                tears.push((register.index(), self.tear(*member, register, result)));
                // Readers use the tear. The recomputed output has a rounding error that is the tear's times the gain
                // of the loop.
                self.draft.outputs[*member] = Some(register);
            }
        }
        tears.sort_by_key(|(register, _)| *register);
        let names = members.iter().map(|member| self.circuit.element(*member).name.clone());
        let entry = Loop {
            tears: tears.into_iter().map(|(_, tear)| tear).collect(),
            operations: begin..self.draft.program.lowered.body.len(),
            lamps: first_lamp..self.draft.program.lowered.lamps.len(),
            inputs: Vec::new(),
            is_straight: true,
            members: names.collect(),
        };
        self.draft.program.lowered_mut().loops.push(entry);
    }

    /// Describes the tear of an element whose output was just emitted.
    fn tear(&mut self, element: usize, register: Register, result: Register) -> Tear {
        let is_open = self.circuit.element(element).kind.output == OutputStage::OpenAmplifier;
        let lamp = self.draft.program.lowered.lamps.last().filter(|lamp| lamp.element == element);
        Tear {
            name: self.circuit.element(element).name.clone(),
            register,
            result,
            demand: lamp.map(|lamp| lamp.demand),
            amplification: if is_open { self.setting_coefficient(AMPLIFICATION) } else { None },
        }
    }

    /// Emits the memory laws of all elements, in the order of the circuit. All outputs have registers by now.
    fn memories(&mut self) {
        for (element, entry) in self.circuit.elements().iter().enumerate() {
            self.draft.current = element;
            if let Some(memory_law) = entry.kind.memory_law {
                memory_law(self.builder());
            }
        }
    }

    /// Adds the recordable signals in the order of the circuit. A signal in volts with factor 1 needs no coefficient.
    fn signals(&mut self) {
        for signal in self.circuit.signals() {
            let is_volts = signal.scale.is_none() && signal.factor == 1.0;
            let per_volt =
                (!is_volts).then(|| self.signal_coefficient(&signal.name, signal.scale, signal.factor));
            let (unit, per_unit) = self.circuit.signal_unit(signal);
            let dimension = signal.scale.map(|scale| self.circuit.derived_unit(scale).dimension());
            let register = self.draft.outputs[signal.element].expect("outputs come before signals");
            self.draft.program.lowered_mut().signals.push(SignalInfo {
                name: signal.name.clone(),
                register,
                per_volt,
                unit,
                per_unit,
                dimension: dimension.unwrap_or(Dimension::VOLTAGE),
                is_named: self.circuit.patch().signals.contains_key(&signal.name),
            });
        }
        let lowered = self.draft.program.lowered_mut();
        let named = lowered.signals.iter().enumerate();
        lowered.signal_indices = named.map(|(index, signal)| (signal.name.clone(), index)).collect();
    }

    /// Makes the scales available to the formulas of a run, each as a coefficient with its value per volt in SI.
    fn scales(&mut self) {
        for (index, (name, scale)) in self.circuit.patch().scales.iter().enumerate() {
            let per_volt = self.scale_coefficient(index);
            let factor = ScaleFactor { name: name.clone(), per_volt, dimension: scale.unit.dimension() };
            self.draft.program.lowered_mut().scales.push(factor);
        }
    }

    /// Adds the elements whose positions a phase can wait for: those with names for the values of their first mode.
    fn switches(&mut self) {
        for (element, entry) in self.circuit.elements().iter().enumerate() {
            let positions = entry.kind.positions;
            if let Some(mode) = self.draft.own_mode.get(&element).filter(|_| !positions.is_empty()) {
                self.draft.program.lowered_mut().switches.push(Switch {
                    element,
                    mode: mode.index as usize,
                    positions,
                });
            }
        }
    }

    /// Collects the required orders of settings. They are checked again after every change of parameters.
    ///
    /// A pair in `ordered` gives one order. A triple in `bounded` gives two, and a bound that is not set gives none.
    fn orders(&mut self) {
        for (element, entry) in self.circuit.elements().iter().enumerate() {
            self.draft.current = element;
            for (lower, upper) in entry.kind.ordered {
                self.order(lower, Relation::Below, upper);
            }
            for (lower, between, upper) in entry.kind.bounded {
                self.order(between, Relation::AtLeast, lower);
                self.order(between, Relation::AtMost, upper);
            }
        }
    }

    /// Requires an order of two settings if both are set. Limits that are not set restrict nothing.
    fn order(&mut self, setting: &str, relation: Relation, other: &str) {
        if let (Some(of), Some(to)) = (self.setting_coefficient(setting), self.setting_coefficient(other)) {
            self.draft.program.lowered_mut().orders.push(SettingOrder { of, relation, to });
        }
    }

    /// Sorts the body, finds kinks and discontinuities, and returns the program.
    ///
    /// Sorting renumbers the registers, so kinks, upstream delay lines and angles are found afterwards. `owners` has
    /// the element of every operation in the new order.
    fn finish(mut self) -> Program {
        let order = self.draft.program.arrange();
        self.draft.program.describe_loops();
        self.draft.program.find_corners();
        self.draft.program.find_upstream();
        let owners: Vec<usize> = order.into_iter().map(|at| self.draft.owners[at]).collect();
        [self.draft.program.lowered_mut().kinks, self.draft.program.lowered_mut().guard_kinks] =
            self.draft.program.find_kinks(&owners);
        self.draft.program.lowered_mut().angles = self.draft.program.find_angles(&owners);
        self.draft.program
    }
}
