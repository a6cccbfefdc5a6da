//! From the circuit to the program: every element's law, emitted once.

use std::collections::HashMap;

use super::{
    Coefficient, Delay, Lamp, Loop, Mode, Op, Outlet, ParameterSlot, Probe, Program, Register, State,
    Transition,
};
use crate::circuit::{Circuit, Stage};
use crate::elements::{Default as SettingDefault, Measure, Output};
use crate::machines::REFERENCE;
use crate::patch::{Amount, Callee, Expression, Formula, Function, Node, Operator, Report};

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
        super::check::check(circuit, &lowering.program)?;
        Ok(lowering.program)
    }
}

/// What an element's law emits its operations into.
pub struct Lowering<'c> {
    circuit: &'c Circuit,
    program: Program,
    /// The element whose law is being emitted.
    current: usize,
    outputs: Vec<Option<Register>>,
    own_state: HashMap<usize, u32>,
    own_mode: HashMap<usize, u32>,
    own_delay: HashMap<usize, u32>,
    constants: HashMap<u64, Register>,
    settings: HashMap<(usize, usize), u32>,
    names: HashMap<String, Register>,
}

impl<'c> Lowering<'c> {
    fn new(circuit: &'c Circuit) -> Self {
        let elements = circuit.elements();
        let parameters = circuit.parameters().map(|(name, parameter, value)| ParameterSlot {
            name: name.to_owned(),
            value: value * parameter.unit.factor(),
            per_unit: parameter.unit.factor(),
            range: parameter.range,
        });
        let program = Program {
            parameters: parameters.collect(),
            readers: circuit.all_readers(),
            ..Program::default()
        };
        Lowering {
            circuit,
            program,
            current: 0,
            outputs: vec![None; elements.len()],
            own_state: HashMap::new(),
            own_mode: HashMap::new(),
            own_delay: HashMap::new(),
            constants: HashMap::new(),
            settings: HashMap::new(),
            names: HashMap::new(),
        }
    }

    fn outputs(&mut self) {
        let circuit = self.circuit;
        circuit.stages().iter().for_each(|stage| self.stage(stage));
        self.program.elements = (self.circuit.elements().iter().zip(&self.outputs))
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
        self.current = element;
        let kind = self.circuit.element(element).kind;
        let mut register = (kind.output_law)(self);
        if kind.output == Output::Amplifier {
            self.program.lamps.push(Lamp { element, demand: register });
            register = self.clip(register);
        }
        self.outputs[element] = Some(register);
        self.program.order.push(element);
    }

    fn clip(&mut self, demand: Register) -> Register {
        let (upper, lower) = (self.constant(REFERENCE), self.constant(-REFERENCE));
        let below = self.minimum(demand, upper);
        self.maximum(below, lower)
    }

    /// Emits a loop: its tear, what is inside, and the element that opens it.
    fn close_loop(&mut self, stage: &Stage, opened: usize, inside: &[Stage]) {
        let index = self.program.loops.len();
        let tear = self.emit(Op::Tear(index as u32));
        let names = stage.members().into_iter().map(|member| self.circuit.element(member).name.clone());
        self.program.loops.push(Loop { tear, result: tear, members: names.collect() });
        self.outputs[opened] = Some(tear);
        inside.iter().for_each(|stage| self.stage(stage));
        self.output(opened);
        self.program.loops[index].result = self.outputs[opened].unwrap_or(tear);
    }

    fn memories(&mut self) {
        for (element, entry) in self.circuit.elements().iter().enumerate() {
            self.current = element;
            if let Some(memory_law) = entry.kind.memory_law {
                memory_law(self);
            }
        }
    }

    fn signals(&mut self) {
        for signal in self.circuit.signals() {
            let per_volt =
                signal.scale.map(|scale| self.signal_coefficient(&signal.name, scale, signal.factor));
            let (unit, per_unit) = self.circuit.signal_unit(signal);
            let register = self.outputs[signal.element].expect("outputs come before signals");
            self.program.signals.push(Probe {
                name: signal.name.clone(),
                register,
                per_volt,
                unit,
                per_unit,
            });
        }
    }

    fn signal_coefficient(&mut self, name: &str, scale: usize, factor: f64) -> u32 {
        let volt = self.scale(scale);
        let factor = self.early(Op::Constant(factor));
        let register = self.early(Op::Multiply(volt, factor));
        let index = self.push_coefficient(register, format!("signal {name} per volt"), (f64::MIN, f64::MAX));
        let signal = self.circuit.patch().signals.get(name);
        self.program.coefficients[index as usize].span = signal.map(|signal| signal.span);
        index
    }

    fn emit(&mut self, op: Op) -> Register {
        self.program.body.push(op);
        Register(self.program.body.len() as u32 - 1)
    }

    fn early(&mut self, op: Op) -> Register {
        self.program.prologue.push(op);
        Register(self.program.prologue.len() as u32 - 1)
    }

    fn push_coefficient(&mut self, register: Register, label: String, range: (f64, f64)) -> u32 {
        let span = self.circuit.element(self.current).span;
        self.program.coefficients.push(Coefficient { register, label, range, span });
        self.program.coefficients.len() as u32 - 1
    }

    // What laws read.

    /// The voltages at an input, without gains, in the order of the document.
    pub fn inputs(&mut self, name: &str) -> Vec<Register> {
        self.driven(name).into_iter().map(|(_, register)| register).collect()
    }

    /// The voltage at an input of one jack.
    pub fn input(&mut self, name: &str) -> Register {
        match self.inputs(name).first() {
            Some(register) => *register,
            None => self.constant(0.0),
        }
    }

    /// Whether anything is plugged into an input.
    pub fn is_driven(&self, name: &str) -> bool {
        !self.driven(name).is_empty()
    }

    /// The sum of an input's voltages, each times its gain.
    pub fn sum(&mut self, name: &str) -> Register {
        let mut total = None;
        for (gain, register) in self.driven(name) {
            let term = self.scaled(register, gain);
            total = Some(total.map_or(term, |total| self.add(total, term)));
        }
        total.unwrap_or_else(|| self.constant(0.0))
    }

    fn scaled(&mut self, register: Register, gain: f64) -> Register {
        if gain == 1.0 {
            return register;
        }
        let gain = self.constant(gain);
        self.multiply(gain, register)
    }

    fn driven(&self, name: &str) -> Vec<(f64, Register)> {
        let inputs = self.circuit.element(self.current).kind.inputs;
        let Some(input) = inputs.iter().position(|input| input.name == name) else { return Vec::new() };
        let cords = self.circuit.cords(self.current).into_iter().filter(|(_, cord)| cord.input == input);
        cords
            .map(|(from, cord)| {
                (cord.gain, self.outputs[from].expect("stages put drivers before what they drive"))
            })
            .collect()
    }

    /// A setting as a voltage or number of the body, its default where the patch is silent.
    pub fn get(&mut self, name: &str) -> Register {
        match self.set(name) {
            Some(register) => register,
            None => self.constant(0.0),
        }
    }

    /// A setting that may be absent.
    pub fn set(&mut self, name: &str) -> Option<Register> {
        let index = self.coefficient(name)?;
        Some(self.emit(Op::Coefficient(index)))
    }

    /// A setting that is true or false.
    pub fn flag(&self, name: &str) -> bool {
        match self.amount(name) {
            Some(Amount::Flag(flag)) => *flag,
            _ => matches!(self.default(name), SettingDefault::Number(number) if number != 0.0),
        }
    }

    fn amount(&self, name: &str) -> Option<&'c Amount> {
        let element = self.circuit.element(self.current);
        let index = element.kind.setting(name)?;
        element.settings.get(index)?.as_ref().map(|placed| &placed.value)
    }

    fn default(&self, name: &str) -> SettingDefault {
        let kind = self.circuit.element(self.current).kind;
        kind.setting(name).map_or(SettingDefault::Absent, |index| kind.settings[index].default)
    }

    /// The coefficient of a setting, made when it is first asked for.
    fn coefficient(&mut self, name: &str) -> Option<u32> {
        let element = self.circuit.element(self.current);
        let index = element.kind.setting(name)?;
        if let Some(made) = self.settings.get(&(self.current, index)) {
            return Some(*made);
        }
        let default = element.kind.settings[index].default;
        let register = match (self.amount(name), default) {
            (Some(Amount::Formula(formula)), _) => {
                self.placed_formula(formula, element.kind.settings[index].measure)
            }
            (None, SettingDefault::Number(number)) => self.early(Op::Constant(number)),
            _ => return None,
        };
        let label = format!("{} {name}", element.name);
        let made = self.push_coefficient(register, label, element.kind.settings[index].range);
        self.settings.insert((self.current, index), made);
        Some(made)
    }

    /// A formula's value in volts, seconds or plain numbers: plain formulas of a drive stand in its unit.
    fn placed_formula(&mut self, formula: &Formula, measure: Measure) -> Register {
        let value = self.expression(formula.root());
        if !matches!(measure, Measure::Signal | Measure::SignalRate) {
            return value;
        }
        let Some(scale) = self.circuit.element(self.current).scale else { return value };
        let volt = self.scale(scale);
        let value = self.in_si(value, formula, self.circuit.scale_unit(scale).factor());
        self.early(Op::Divide(value, volt))
    }

    fn in_si(&mut self, value: Register, formula: &Formula, unit: f64) -> Register {
        if !self.circuit.is_plain(formula) || unit == 1.0 {
            return value;
        }
        let unit = self.early(Op::Constant(unit));
        self.early(Op::Multiply(value, unit))
    }

    /// A scale's value of one volt, in SI.
    fn scale(&mut self, index: usize) -> Register {
        let (name, formula) = self.circuit.scale(index);
        if let Some(register) = self.names.get(name) {
            return *register;
        }
        let value = self.expression(formula.root());
        let register = self.in_si(value, formula, self.circuit.scale_unit(index).factor());
        self.names.insert(name.to_owned(), register);
        register
    }

    fn expression(&mut self, node: &Node) -> Register {
        match &node.expression {
            Expression::Number(value) => self.early(Op::Constant(*value)),
            Expression::Name(name) => self.name(name),
            Expression::Negate(operand) => {
                let operand = self.expression(operand);
                let zero = self.early(Op::Constant(0.0));
                self.early(Op::Subtract(zero, operand))
            }
            Expression::Binary(operator, left, right) => {
                let (left, right) = (self.expression(left), self.expression(right));
                self.early(binary(*operator, left, right))
            }
            Expression::Call(callee, arguments) => {
                let arguments: Vec<_> = arguments.iter().map(|argument| self.expression(argument)).collect();
                self.early(call(*callee, &arguments))
            }
        }
    }

    fn name(&mut self, name: &str) -> Register {
        if let Some(register) = self.names.get(name) {
            return *register;
        }
        if let Some(index) = self.circuit.scale_index(name) {
            return self.scale(index);
        }
        let parameter = self.program.parameters.iter().position(|slot| slot.name == name);
        let register = match parameter {
            Some(index) => self.early(Op::Parameter(index as u32)),
            None => self.early(Op::Constant(self.circuit.time_scale())),
        };
        self.names.insert(name.to_owned(), register);
        register
    }

    // What laws emit.

    /// A fixed number.
    pub fn constant(&mut self, value: f64) -> Register {
        if let Some(register) = self.constants.get(&value.to_bits()) {
            return *register;
        }
        let register = self.emit(Op::Constant(value));
        self.constants.insert(value.to_bits(), register);
        register
    }

    /// Problem time in seconds.
    pub fn time(&mut self) -> Register {
        self.emit(Op::Time)
    }

    /// a + b.
    pub fn add(&mut self, a: Register, b: Register) -> Register {
        self.emit(Op::Add(a, b))
    }

    /// a - b.
    pub fn subtract(&mut self, a: Register, b: Register) -> Register {
        self.emit(Op::Subtract(a, b))
    }

    /// -a.
    pub fn negate(&mut self, a: Register) -> Register {
        let zero = self.constant(0.0);
        self.emit(Op::Subtract(zero, a))
    }

    /// a times b.
    pub fn multiply(&mut self, a: Register, b: Register) -> Register {
        self.emit(Op::Multiply(a, b))
    }

    /// The lower of two.
    pub fn minimum(&mut self, a: Register, b: Register) -> Register {
        self.emit(Op::Minimum(a, b))
    }

    /// The upper of two.
    pub fn maximum(&mut self, a: Register, b: Register) -> Register {
        self.emit(Op::Maximum(a, b))
    }

    /// Size without sign.
    pub fn absolute(&mut self, a: Register) -> Register {
        self.emit(Op::Absolute(a))
    }

    /// `then` where left >= right, else `otherwise`.
    pub fn select(
        &mut self,
        left: Register,
        right: Register,
        then: Register,
        otherwise: Register,
    ) -> Register {
        self.emit(Op::Select { left, right, then, otherwise })
    }

    /// A function of one number.
    pub fn call(&mut self, function: Function, a: Register) -> Register {
        self.emit(Op::Call(function, a, a))
    }

    /// The whole number at or below.
    pub fn floor(&mut self, a: Register) -> Register {
        self.call(Function::Floor, a)
    }

    /// A setting made of points, looked up.
    pub fn table(&mut self, name: &str, at: Register) -> Register {
        let points = match self.amount(name) {
            Some(Amount::Points(points)) => points.clone(),
            _ => Vec::new(),
        };
        self.program.tables.push(points);
        self.emit(Op::Table(self.program.tables.len() as u32 - 1, at))
    }

    /// Volts per unit of a drive's scale, for values that are not formulas.
    pub fn volts_per_signal(&mut self) -> Register {
        let element = self.circuit.element(self.current);
        let Some(scale) = element.scale else { return self.constant(1.0) };
        let volt = self.scale(scale);
        let unit = self.early(Op::Constant(self.circuit.scale_unit(scale).factor()));
        let register = self.early(Op::Divide(unit, volt));
        let index =
            self.push_coefficient(register, format!("{} volts per unit", element.name), (f64::MIN, f64::MAX));
        self.emit(Op::Coefficient(index))
    }

    /// A new state of the current element, starting at a setting.
    pub fn new_state(&mut self, initial: &str) -> Register {
        let initial = self.coefficient_or_zero(initial);
        let index = self.program.states.len() as u32;
        let unset = Register(0);
        self.program.states.push(State { element: self.current, rate: unset, demand: unset, initial });
        self.own_state.insert(self.current, index);
        self.emit(Op::State(index))
    }

    fn coefficient_or_zero(&mut self, name: &str) -> u32 {
        if let Some(index) = self.coefficient(name) {
            return index;
        }
        let zero = self.early(Op::Constant(0.0));
        self.push_coefficient(zero, name.to_owned(), (0.0, 0.0))
    }

    /// The index of the current element's state.
    pub(super) fn own_state(&self) -> Option<u32> {
        self.own_state.get(&self.current).copied()
    }

    /// The output of the current element, once it is there.
    pub fn state(&mut self) -> Register {
        match self.outputs[self.current] {
            Some(register) => register,
            None => self.constant(0.0),
        }
    }

    /// Sets d/dt of the current element's state, in volts per machine second. At ±100 V it is 0 while it
    /// points outward.
    pub fn set_rate(&mut self, rate: Register) {
        let demand = self.scaled(rate, self.circuit.time_scale());
        let out = self.state();
        let [zero, upper, lower] = [0.0, REFERENCE, -REFERENCE].map(|value| self.constant(value));
        let inward = self.minimum(demand, zero);
        let below_top = self.select(out, upper, inward, demand);
        let outward = self.maximum(below_top, zero);
        let rate = self.select(lower, out, outward, below_top);
        if let Some(index) = self.own_state() {
            let state = &mut self.program.states[index as usize];
            (state.rate, state.demand) = (rate, demand);
        }
    }

    /// A new mode of the current element.
    pub fn new_mode(&mut self, initial: f64) -> Register {
        let index = self.program.modes.len() as u32;
        self.program.modes.push(Mode { element: self.current, initial, transitions: Vec::new() });
        self.own_mode.insert(self.current, index);
        self.emit(Op::Mode(index))
    }

    /// A change of the mode that the current element made last.
    pub fn transition(&mut self, transition: Transition) {
        if let Some(index) = self.own_mode.get(&self.current) {
            self.program.modes[*index as usize].transitions.push(transition);
        }
    }

    /// A delay line of the current element, its time and initial output being settings.
    pub fn new_delay(&mut self, time: &str, initial: &str) -> Register {
        let (time, initial) = (self.coefficient_or_zero(time), self.coefficient_or_zero(initial));
        let index = self.program.delays.len() as u32;
        let problem_seconds = 1.0 / self.circuit.time_scale();
        let (element, input) = (self.current, Register(0));
        self.program.delays.push(Delay { element, input, time, initial, problem_seconds });
        self.own_delay.insert(self.current, index);
        self.emit(Op::Delayed(index))
    }

    /// What goes into the current element's delay line.
    pub fn set_delay_input(&mut self, input: Register) {
        if let Some(index) = self.own_delay.get(&self.current) {
            self.program.delays[*index as usize].input = input;
        }
    }
}

fn binary(operator: Operator, left: Register, right: Register) -> Op {
    match operator {
        Operator::Add => Op::Add(left, right),
        Operator::Subtract => Op::Subtract(left, right),
        Operator::Multiply => Op::Multiply(left, right),
        Operator::Divide => Op::Divide(left, right),
        Operator::Power => Op::Call(Function::Power, left, right),
    }
}

/// The parser has counted the arguments: a missing one can only stand for itself.
fn call(callee: Callee, arguments: &[Register]) -> Op {
    let first = arguments.first().copied().unwrap_or(Register(0));
    let second = arguments.get(1).copied().unwrap_or(first);
    match callee {
        Callee::Minimum => Op::Minimum(first, second),
        Callee::Maximum => Op::Maximum(first, second),
        Callee::Absolute => Op::Absolute(first),
        Callee::Function(function) => Op::Call(function, first, second),
    }
}
