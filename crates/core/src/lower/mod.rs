//! From the circuit to the program: every element's law, emitted once.

mod check;
mod dry_run;
mod laws;
mod prologue;

use std::collections::HashMap;
use std::sync::Arc;

use crate::circuit::{Circuit, Stage};
use crate::document::Report;
use crate::elements::{Family, Output};
use crate::ir::{
    Builder, Declared, Draft, Lamp, Loop, Op, Order, Outlet, ParameterSlot, Probe, Program, Register,
    Relation, ScaleSlot, Switch,
};
use crate::machines::REFERENCE;
use patchcord_expr::Dimension;

impl Program {
    /// Flattens a checked circuit, and solves its loops once in initial condition.
    ///
    /// # Errors
    /// When a coefficient is not a finite number in its range, or a loop without an integrator has no
    /// solution or several.
    pub fn new(circuit: &Circuit) -> Result<Program, Box<Report>> {
        let mut lowering = Lowering::new(circuit);
        lowering.outputs();
        lowering.memories();
        lowering.signals();
        lowering.scales();
        lowering.switches();
        lowering.orders();
        let program = lowering.arranged();
        let findings = check::findings(circuit, &program);
        if findings.is_empty() {
            return Ok(program);
        }
        // The parts of an edited patch have no positions: its text has.
        match circuit.reread() {
            Some(read) => Program::new(&read?),
            None => Err(Box::new(circuit.report_with(findings))),
        }
    }
}

/// A circuit on its way to a program.
struct Lowering<'c> {
    circuit: &'c Circuit,
    draft: Draft,
    /// Coefficients of settings that laws have read, by element and setting.
    settings: HashMap<(usize, usize), u32>,
    /// Registers of the prologue that hold named values.
    names: HashMap<String, Register>,
}

impl<'c> Lowering<'c> {
    fn new(circuit: &'c Circuit) -> Self {
        let elements = circuit.elements();
        let parameters = circuit.parameters().map(|(name, parameter, value)| {
            let declared = Declared {
                name: name.to_owned(),
                per_unit: parameter.unit.factor(),
                range: parameter.range,
                unit: parameter.unit.text().to_owned(),
                dimension: parameter.unit.dimension(),
            };
            ParameterSlot { value: value * declared.per_unit, declared: Arc::new(declared) }
        });
        let mut program = Program { parameters: parameters.collect(), ..Program::default() };
        program.readers = circuit.all_readers();
        program.time_scale = circuit.time_scale();
        let draft = Draft::new(program, elements.len());
        Lowering { circuit, draft, settings: HashMap::new(), names: HashMap::new() }
    }

    /// The interface that laws emit into.
    fn builder(&mut self) -> &mut dyn Builder {
        self
    }

    fn outputs(&mut self) {
        let circuit = self.circuit;
        circuit.stages().iter().for_each(|stage| self.stage(stage));
        self.draft.program.elements = (self.circuit.elements().iter().zip(&self.draft.outputs))
            .map(|(element, register)| Outlet {
                name: element.name.clone(),
                register: register.expect("every element stands in one stage"),
            })
            .collect();
    }

    fn stage(&mut self, stage: &Stage) {
        match stage {
            Stage::Element(element) => self.output(*element),
            Stage::Loop { opened, inside } => self.close_loop(stage, *opened, inside),
        }
    }

    fn output(&mut self, element: usize) {
        self.draft.current = element;
        let kind = self.circuit.element(element).kind;
        let mut register = (kind.output_law)(self.builder());
        if matches!(kind.output, Output::Amplifier | Output::OpenAmplifier) {
            let output = self.clip(register);
            self.draft.program.lamps.push(Lamp { element, demand: register, output });
            register = output;
        }
        if kind.family == Family::Drive {
            self.draft.program.drives.push(register);
        }
        self.draft.outputs[element] = Some(register);
        self.draft.program.order.push(element);
    }

    fn clip(&mut self, demand: Register) -> Register {
        let builder = self.builder();
        let (upper, lower) = (builder.constant(REFERENCE), builder.constant(-REFERENCE));
        let below = builder.minimum(demand, upper);
        builder.maximum(below, lower)
    }

    /// Emits a loop: its tear, what is inside, and the element that opens it.
    fn close_loop(&mut self, stage: &Stage, opened: usize, inside: &[Stage]) {
        let index = self.draft.program.loops.len();
        let tear = self.builder().emit(Op::Tear(index as u32));
        let names = stage.members().into_iter().map(|member| self.circuit.element(member).name.clone());
        let is_open = self.circuit.element(opened).kind.output == Output::OpenAmplifier;
        self.draft.program.loops.push(Loop { tear, result: tear, members: names.collect(), is_open });
        self.draft.outputs[opened] = Some(tear);
        inside.iter().for_each(|stage| self.stage(stage));
        self.output(opened);
        self.draft.program.loops[index].result = self.draft.outputs[opened].unwrap_or(tear);
        // What is worked out from the tear carries its rounding times the gain of the loop; the tear does not.
        self.draft.outputs[opened] = Some(tear);
    }

    fn memories(&mut self) {
        for (element, entry) in self.circuit.elements().iter().enumerate() {
            self.draft.current = element;
            if let Some(memory_law) = entry.kind.memory_law {
                memory_law(self.builder());
            }
        }
    }

    fn signals(&mut self) {
        for signal in self.circuit.signals() {
            let is_volts = signal.scale.is_none() && signal.factor == 1.0;
            let per_volt =
                (!is_volts).then(|| self.signal_coefficient(&signal.name, signal.scale, signal.factor));
            let (unit, per_unit) = self.circuit.signal_unit(signal);
            let dimension = signal.scale.map(|scale| self.circuit.derived_unit(scale).dimension());
            let register = self.draft.outputs[signal.element].expect("outputs come before signals");
            self.draft.program.signals.push(Probe {
                name: signal.name.clone(),
                register,
                per_volt,
                unit,
                per_unit,
                dimension: dimension.unwrap_or(Dimension::VOLTAGE),
                is_named: self.circuit.patch().signals.contains_key(&signal.name),
            });
        }
    }

    /// The scales, as the formulas of a run read them.
    fn scales(&mut self) {
        for (index, (name, scale)) in self.circuit.patch().scales.iter().enumerate() {
            let per_volt = self.scale_coefficient(index);
            let slot = ScaleSlot { name: name.clone(), per_volt, dimension: scale.unit.dimension() };
            self.draft.program.scales.push(slot);
        }
    }

    fn switches(&mut self) {
        for (element, entry) in self.circuit.elements().iter().enumerate() {
            let positions = entry.kind.positions;
            if let Some(mode) = self.draft.own_mode.get(&element).filter(|_| !positions.is_empty()) {
                self.draft.program.switches.push(Switch { element, mode: mode.index as usize, positions });
            }
        }
    }

    /// The settings that must stand in an order, also once a run has set parameters.
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

    fn order(&mut self, setting: &str, relation: Relation, other: &str) {
        if let (Some(of), Some(to)) = (self.setting_coefficient(setting), self.setting_coefficient(other)) {
            self.draft.program.orders.push(Order { of, relation, to });
        }
    }

    /// The program, its body in the order in which it is worked out.
    fn arranged(mut self) -> Program {
        let order = self.draft.program.arrange();
        self.draft.program.find_corners();
        self.draft.program.find_echoes();
        let owners: Vec<usize> = order.into_iter().map(|at| self.draft.owners[at]).collect();
        [self.draft.program.kinks, self.draft.program.guard_kinks] = self.draft.program.find_kinks(&owners);
        self.draft.program.angles = self.draft.program.find_angles(&owners);
        self.draft.program
    }
}
