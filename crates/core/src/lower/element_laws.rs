//! Lowers the elements of a circuit one by one: the laws read registers of inputs in place of the outputs behind the
//! cords.

use super::Lowering;
use crate::circuit::Circuit;
use crate::elements::Jacks;
use crate::ir::{Builder, Draft, ElementLaw, ElementLaws, Op, Register};

impl ElementLaws {
    /// The laws of the elements of a circuit.
    pub fn new(circuit: &Circuit) -> ElementLaws {
        let mut lowering = SeparateLowering { lowering: Lowering::new(circuit), laws: Vec::new() };
        let count = circuit.elements().len();
        (0..count).for_each(|element| lowering.inputs(element));
        (0..count).for_each(|element| lowering.output(element));
        (0..count).for_each(|element| lowering.memory(element));
        let SeparateLowering { mut lowering, laws } = lowering;
        lowering.signals();
        ElementLaws { parts: lowering.draft.program, elements: laws }
    }
}

/// A lowering in which the inputs of each element have registers of their own.
struct SeparateLowering<'c> {
    /// Reads everything except the inputs.
    lowering: Lowering<'c>,
    /// The laws so far, in the order of the circuit.
    laws: Vec<ElementLaw>,
}

impl SeparateLowering<'_> {
    /// The interface through which laws emit operations.
    fn builder(&mut self) -> &mut dyn Builder {
        self
    }

    /// The number of operations so far.
    fn length(&self) -> usize {
        self.lowering.draft.program.lowered.body.len()
    }

    /// Adds the registers of an element's inputs.
    fn inputs(&mut self, element: usize) {
        self.lowering.draft.current = element;
        let circuit = self.lowering.circuit;
        let cords = circuit.cords(element);
        let mut inputs = Vec::new();
        for (index, input) in circuit.element(element).kind.inputs.iter().enumerate() {
            let count = cords.iter().filter(|(_, cord)| cord.input == index).count();
            let count = if input.jacks == Jacks::Gains { count.min(1) } else { count };
            inputs.push((0..count).map(|_| self.input_register()).collect());
        }
        let law =
            ElementLaw { inputs, output: Register(0), output_operations: 0..0, memory_operations: 0..0 };
        self.laws.push(law);
    }

    /// A register that the caller of the laws writes.
    fn input_register(&mut self) -> Register {
        let position = self.length() as u32;
        self.builder().emit(Op::Tear { index: 0, position })
    }

    /// Emits the output of an element, without the limit of an amplifier.
    fn output(&mut self, element: usize) {
        self.lowering.draft.current = element;
        let output_law = self.lowering.circuit.element(element).kind.output_law;
        let begin = self.length();
        let output = output_law(self.builder());
        self.lowering.draft.outputs[element] = Some(output);
        self.laws[element].output = output;
        self.laws[element].output_operations = begin..self.length();
    }

    /// Emits the memory law of an element, if it has one.
    fn memory(&mut self, element: usize) {
        self.lowering.draft.current = element;
        let Some(memory_law) = self.lowering.circuit.element(element).kind.memory_law else { return };
        let begin = self.length();
        memory_law(self.builder());
        self.laws[element].memory_operations = begin..self.length();
    }
}

/// Everything except the inputs is as in a lowering with cords.
impl Builder for SeparateLowering<'_> {
    fn draft(&self) -> &Draft {
        self.lowering.draft()
    }

    fn draft_mut(&mut self) -> &mut Draft {
        self.lowering.draft_mut()
    }

    /// The registers of an input. The gains are part of the voltages that the caller writes.
    fn driven(&self, name: &str) -> Vec<(f64, Register)> {
        let registers = &self.laws[self.lowering.draft.current].inputs[self.lowering.input(name)];
        registers.iter().map(|register| (1.0, *register)).collect()
    }

    fn coefficient(&mut self, setting: &str) -> Option<u32> {
        self.lowering.coefficient(setting)
    }

    fn points(&self, setting: &str) -> Vec<[f64; 2]> {
        self.lowering.points(setting)
    }

    fn flag(&self, setting: &str) -> bool {
        self.lowering.flag(setting)
    }

    fn choice(&self, setting: &str) -> &'static str {
        self.lowering.choice(setting)
    }

    fn volts_per_signal(&mut self) -> Register {
        self.lowering.volts_per_signal()
    }

    fn is_drive(&self) -> bool {
        self.lowering.is_drive()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ir::Program;
    use crate::patch::{ElementBuilder, PatchBuilder};

    /// A mass on a spring: v' = -4 x - 0.5 v at A1 and x' = v, with -x at A2.
    fn spring() -> Circuit {
        let pot = |from, setting| ElementBuilder::new("pot").cord("in", from).set("setting", setting);
        let patch = PatchBuilder::new("spring")
            .element("A1", ElementBuilder::new("integrator").cords("x10", ["PK"]).cords("x1", ["PC"]))
            .element("A2", ElementBuilder::new("integrator").cords("x1", ["A1"]).set("initial", 50))
            .element("B2", ElementBuilder::new("inverter").cord("in", "A2"))
            .element("PK", pot("B2", 0.4))
            .element("PC", pot("A1", 0.5));
        Circuit::new(&patch.build().unwrap()).unwrap()
    }

    /// The index of an element with this name.
    fn index(circuit: &Circuit, name: &str) -> usize {
        circuit.elements().iter().position(|element| element.name == name).unwrap()
    }

    #[test]
    fn a_law_depends_on_the_voltages_at_its_own_inputs_only() {
        let circuit = spring();
        let laws = ElementLaws::new(&circuit);
        let coefficients = laws.coefficients(&[]);
        let point = laws.initial_point(&coefficients);
        let mut registers = laws.registers();
        let pot = &laws.elements()[index(&circuit, "PK")];
        registers[pot.inputs[0][0].index()] = -30.0;
        laws.evaluate(pot.output_operations.clone(), &point, &coefficients, &mut registers);
        assert_eq!(registers[pot.output.index()], -12.0);
        // The sum of both cords, each times its gain, is at one register.
        let integrator = &laws.elements()[index(&circuit, "A1")];
        assert_eq!(integrator.inputs[0].len(), 1);
        assert!(integrator.inputs[1..].iter().all(Vec::is_empty));
        registers[integrator.inputs[0][0].index()] = 7.0;
        laws.evaluate(integrator.output_operations.clone(), &point, &coefficients, &mut registers);
        laws.evaluate(integrator.memory_operations.clone(), &point, &coefficients, &mut registers);
        assert_eq!(registers[laws.states()[0].demand.index()], -7.0);
        assert_eq!(registers[integrator.output.index()], 0.0);
    }

    #[test]
    fn the_laws_behind_their_cords_give_the_voltages_of_the_program() {
        let circuit = spring();
        let (laws, program) = (ElementLaws::new(&circuit), Program::new(&circuit).unwrap());
        let coefficients = laws.coefficients(&[]);
        let state = |name: &str| if name == "A1" { 20.0 } else { -30.0 };
        let mut point = laws.initial_point(&coefficients);
        point.states = laws.states().iter().map(|law| state(&circuit.element(law.element).name)).collect();
        let mut registers = laws.registers();
        let mut outputs = vec![f64::NAN; circuit.elements().len()];
        for name in ["A1", "A2", "B2", "PK", "PC"] {
            let element = index(&circuit, name);
            let law = &laws.elements()[element];
            if laws.states().iter().all(|state| state.element != element) {
                registers[law.inputs[0][0].index()] = outputs[circuit.cords(element)[0].0];
            }
            laws.evaluate(law.output_operations.clone(), &point, &coefficients, &mut registers);
            outputs[element] = registers[law.output.index()];
        }
        let mut point = program.initial_point();
        point.states = program.states().into_iter().map(state).collect();
        let voltages = program.voltages_at(&point).unwrap();
        for (element, output) in program.element_outputs().iter().enumerate().skip(3) {
            assert_eq!(outputs[element], voltages[output.register.index()], "{}", output.name);
        }
    }

    #[test]
    fn an_amplifier_has_no_limit() {
        let summer = ElementBuilder::new("summer").cords("x10", ["+100"]);
        let circuit = Circuit::new(&PatchBuilder::new("sum").element("A1", summer).build().unwrap()).unwrap();
        let laws = ElementLaws::new(&circuit);
        let law = &laws.elements()[3];
        let mut registers = laws.registers();
        registers[law.inputs[0][0].index()] = 1000.0;
        laws.evaluate(law.output_operations.clone(), &laws.initial_point(&[]), &[], &mut registers);
        assert_eq!(registers[law.output.index()], -1000.0);
    }
}
