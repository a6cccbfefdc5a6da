//! From the operations of a program to exact equations.
//!
//! The body is evaluated once with expressions in place of numbers. The outputs that have a name become symbols, and
//! the expression that computes an output becomes its definition. The limits of the amplifiers at ±100 V are left out:
//! the equations hold while no amplifier is overloaded.

use std::collections::{HashMap, HashSet};

use patchcord_core::circuit::Circuit;
use patchcord_core::elements::Family;
use patchcord_core::ir::{Level, Loop, Op, Program, PulseTrain, Register, SignalInfo};
use patchcord_expr::{Dimension, Function};

use super::loops::{Unknown, solve};
use super::system::{Law, LawKind, ModeLaw, Source, System, TableLaw, TableUnit, TransitionLaw};
use crate::symbolic::{
    Fraction, Operation, Symbol, SymbolEntry, SymbolKind, Symbols, absolute, call, opaque, step,
};

/// What the derivation keeps and what it eliminates.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Options {
    /// Whether the output of every element keeps its own equation. Otherwise only signals, drives and states do.
    pub keeps_elements: bool,
    /// Whether open amplifiers are ideal: the sum of their inputs is exactly 0.
    pub has_ideal_amplifiers: bool,
    /// Whether the inputs of squaring networks and logarithms count as within their range: above 0, or above the least
    /// value of a logarithm.
    pub stays_in_range: bool,
}

/// The equations of a program, and how they refer to it.
pub(crate) struct Wiring {
    /// The equations.
    pub system: System,
    /// The symbols of the states, in the order of the program.
    pub states: Vec<Symbol>,
    /// The quantity and the value per volt of every register with a name.
    pub names: HashMap<Register, Output>,
    /// The symbols of the delay lines, in the order of the program.
    pub delayed: Vec<Symbol>,
    /// The symbols of the sampled values, in the order of the program.
    pub sampled: Vec<Symbol>,
    /// The symbols of the levels, in the order of the program.
    pub levels: Vec<Symbol>,
    /// The parameters, in the order of the program.
    pub parameters: Vec<Symbol>,
    /// Problem time.
    pub time: Symbol,
}

/// The quantity at an output.
#[derive(Debug, Clone)]
pub(crate) struct Output {
    /// The quantity.
    pub symbol: Symbol,
    /// Its value at 1 V, in SI.
    pub per_volt: Fraction,
}

impl Output {
    /// The voltage as an expression of the quantity.
    pub(crate) fn volts(&self) -> Fraction {
        Fraction::symbol(self.symbol).over(&self.per_volt)
    }
}

/// Derives the equations of a program.
pub(crate) fn derive(circuit: &Circuit, program: &Program, options: Options) -> Wiring {
    let mut derivation = Derivation::new(circuit, program, options);
    derivation.name_outputs();
    derivation.body();
    derivation.finish()
}

/// A derivation in progress.
struct Derivation<'a> {
    program: &'a Program,
    circuit: &'a Circuit,
    options: Options,
    wiring: Wiring,
    pi: Symbol,
    /// The coefficients as expressions of the parameters.
    coefficients: Vec<Fraction>,
    /// For outputs of amplifiers, the register before the limit.
    unlimited: HashMap<Register, Register>,
    /// The inputs of squaring networks and logarithms after the limit of their range.
    ranged: HashSet<Register>,
    /// The value of each register that was computed.
    values: Vec<Option<Fraction>>,
    /// Number of intermediate quantities that were named because they are long.
    intermediates: usize,
}

/// Longest expression that is kept without a name, in terms.
const LONGEST: usize = 200;

impl<'a> Derivation<'a> {
    /// Adds the symbols of everything that has no voltage, and evaluates the prologue.
    fn new(circuit: &'a Circuit, program: &'a Program, options: Options) -> Self {
        let mut symbols = Symbols::default();
        let entry =
            |name: &str, kind, dimension| SymbolEntry { name: name.to_owned(), primes: 0, kind, dimension };
        let pi = symbols.add(entry("pi", SymbolKind::Pi, Dimension::NONE), true);
        let parameters = program.parameters().iter().enumerate().map(|(index, parameter)| {
            let is_nonnegative = match parameter.declared.range {
                Some((low, _)) => low >= 0.0,
                None => parameter.value > 0.0,
            };
            let kind = SymbolKind::Parameter(index);
            symbols.add(entry(&parameter.declared.name, kind, parameter.declared.dimension), is_nonnegative)
        });
        let parameters: Vec<Symbol> = parameters.collect();
        let time = symbols.add(entry("t", SymbolKind::Time, Dimension::TIME), true);
        let tables = tables(program);
        let system = System { symbols, laws: Vec::new(), modes: Vec::new(), tables, margins: Vec::new() };
        let wiring = Wiring {
            system,
            states: Vec::new(),
            names: HashMap::new(),
            delayed: Vec::new(),
            sampled: Vec::new(),
            levels: Vec::new(),
            parameters,
            time,
        };
        let unlimited = program.lamps().iter().map(|lamp| (lamp.output, lamp.demand)).collect();
        let values = vec![None; program.body().len()];
        let coefficients = Vec::new();
        let mut derivation = Derivation {
            program,
            circuit,
            options,
            wiring,
            pi,
            coefficients,
            unlimited,
            ranged: ranged(program.body()),
            values,
            intermediates: 0,
        };
        derivation.coefficients = derivation.prologue();
        derivation
    }

    /// The coefficients as expressions of the parameters.
    fn prologue(&mut self) -> Vec<Fraction> {
        let mut registers: Vec<Fraction> = Vec::with_capacity(self.program.prologue().len());
        for op in self.program.prologue() {
            let value = self.operation(*op, false, &|register: Register| registers[register.index()].clone());
            registers.push(value);
        }
        let coefficients = self.program.coefficients().iter();
        coefficients.map(|coefficient| registers[coefficient.register.index()].clone()).collect()
    }

    /// Gives names to outputs: drives first, then signals in the order of the patch, then states and stored values.
    fn name_outputs(&mut self) {
        let program = self.program;
        let drives: Vec<_> =
            program.element_outputs().iter().filter(|output| self.is_drive(output.register)).collect();
        for output in drives {
            if let Some(signal) = program.signals().iter().find(|signal| signal.name == output.name) {
                self.name_signal(signal);
            }
        }
        for signal in program.signals().iter().filter(|signal| signal.is_named) {
            self.name_signal(signal);
        }
        if self.options.keeps_elements {
            for output in self.element_outputs() {
                self.name_element(&output.0, output.1);
            }
        }
        for state in program.state_laws() {
            let (name, register) = self.output(state.element);
            self.name_element(&name, register);
            self.wiring.states.push(self.wiring.names[&register].symbol);
        }
    }

    /// Name and register of every output that an element of the patch computes.
    fn element_outputs(&self) -> Vec<(String, Register)> {
        let elements = self.circuit.elements();
        let outputs = self.program.element_outputs().iter().zip(elements);
        let computed = outputs.filter(|(_, element)| element.kind.family == Family::Computing);
        computed.map(|(output, _)| (output.name.clone(), output.register)).collect()
    }

    /// Name and register of an element's output.
    fn output(&self, element: usize) -> (String, Register) {
        let output = &self.program.element_outputs()[element];
        (output.name.clone(), output.register)
    }

    /// Whether a register is the output of a drive.
    fn is_drive(&self, register: Register) -> bool {
        self.program.drive_registers().contains(&register)
    }

    /// Gives a signal's name to its output, unless the output has one. A constant has no name.
    fn name_signal(&mut self, signal: &SignalInfo) {
        let per_volt = self.per_volt(signal);
        let is_constant = matches!(self.program.body()[signal.register.index()], Op::Constant(_));
        if per_volt.is_zero() || is_constant || self.wiring.names.contains_key(&signal.register) {
            return;
        }
        let symbol = self.wiring.system.symbols.variable(&signal.name, 0, signal.dimension);
        self.wiring.names.insert(signal.register, Output { symbol, per_volt });
    }

    /// Value of a signal at 1 V.
    fn per_volt(&self, signal: &SignalInfo) -> Fraction {
        signal.per_volt.map_or_else(|| Fraction::whole(1), |index| self.coefficients[index as usize].clone())
    }

    /// Gives an element's name to its output, in volts, unless the output has a name.
    fn name_element(&mut self, name: &str, register: Register) {
        let is_constant = matches!(self.program.body()[register.index()], Op::Constant(_));
        if !is_constant && !self.wiring.names.contains_key(&register) {
            let symbol = self.wiring.system.symbols.variable(name, 0, Dimension::VOLTAGE);
            self.wiring.names.insert(register, Output { symbol, per_volt: Fraction::whole(1) });
        }
    }

    /// Adds a quantity that is constant within a step.
    fn held(&mut self, name: String, dimension: Dimension) -> Symbol {
        let entry = SymbolEntry { name, primes: 0, kind: SymbolKind::Held, dimension };
        self.wiring.system.symbols.add(entry, false)
    }

    /// Evaluates the body, and adds the definitions of outputs with names.
    fn body(&mut self) {
        self.name_sources();
        let needed = self.needed();
        let mut at = 0;
        while at < self.program.body().len() {
            if !needed[at] {
                at += 1;
            } else if let Op::Tear { index, .. } = self.program.body()[at] {
                let program = self.program;
                let entry = &program.loops()[index as usize];
                self.close_loop(entry, &needed);
                at = entry.operations.end;
            } else {
                self.register(at, true);
                at += 1;
            }
        }
    }

    /// Adds the symbols of delay lines, sampled values, levels and modes.
    fn name_sources(&mut self) {
        let program = self.program;
        for delay in program.delays() {
            let (name, register) = self.output(delay.element);
            self.name_element(&name, register);
            let symbol = self.wiring.names[&register].symbol;
            self.wiring.delayed.push(symbol);
        }
        for sampled in program.sampled_values() {
            let name = format!("{}.before", self.output(sampled.element).0);
            let entry =
                SymbolEntry { name, primes: 0, kind: SymbolKind::Held, dimension: Dimension::VOLTAGE };
            let symbol = self.wiring.system.symbols.add(entry, false);
            self.wiring.sampled.push(symbol);
        }
        for level in program.levels() {
            let (element, noun) = self.level_name(level);
            let dimension = match level {
                Level::Points { table } => {
                    self.wiring.system.tables[*table].unit.as_ref().map(|unit| unit.dimension)
                }
                Level::Noise(_) | Level::Pulses(_) => None,
            };
            let symbol = self.held(format!("{element}.{noun}"), dimension.unwrap_or(Dimension::NONE));
            self.wiring.levels.push(symbol);
        }
        for mode in program.modes() {
            let element = self.output(mode.element).0;
            let symbol = self.held(format!("{element}.{}", mode.names.mode), Dimension::NONE);
            self.wiring.system.modes.push(ModeLaw {
                symbol,
                element,
                noun: mode.names.mode,
                values: mode.names.values,
                initial: mode.initial,
                transitions: Vec::new(),
            });
        }
    }

    /// Name of a level's element, and a noun.
    fn level_name(&self, level: &Level) -> (String, &'static str) {
        let (element, noun) = match level {
            Level::Noise(noise) => (noise.element, "noise"),
            Level::Pulses(pulses) => (pulses.element, "pulses"),
            Level::Points { table } => {
                let drive = (0..self.program.element_outputs().len())
                    .find(|element| self.program.drive_table(*element) == Some(*table));
                (drive.unwrap_or_default(), "steps")
            }
        };
        (self.output(element).0, noun)
    }

    /// For every register, whether an equation depends on it. The limits of amplifiers are left out.
    fn needed(&self) -> Vec<bool> {
        let program = self.program;
        let mut needed = vec![false; program.body().len()];
        let mut open: Vec<Register> = self.wiring.names.keys().copied().collect();
        open.extend(program.signals().iter().filter(|signal| signal.is_named).map(|signal| signal.register));
        for state in program.state_laws() {
            open.extend([state.demand, state.limits[0], state.limits[1]]);
        }
        open.extend(program.delays().iter().map(|delay| delay.input));
        open.extend(program.sampled_values().iter().map(|sampled| sampled.next));
        for transition in program.modes().iter().flat_map(|mode| &mode.transitions) {
            open.push(transition.guard.register);
            open.extend(transition.reset.map(|reset| reset.to));
        }
        while let Some(register) = open.pop() {
            if std::mem::replace(&mut needed[register.index()], true) {
                continue;
            }
            if let Some(demand) = self.unlimited.get(&register) {
                open.push(*demand);
                continue;
            }
            match program.body()[register.index()] {
                Op::Tear { index, .. } => {
                    let tears = &program.loops()[index as usize].tears;
                    open.extend(tears.iter().flat_map(|tear| [tear.register, tear.result]));
                }
                op => open.extend(op.operands()),
            }
        }
        needed
    }

    /// Computes a register, and replaces it by its symbol if it has a name. `defines` is whether the name gets its
    /// definition now.
    fn register(&mut self, at: usize, defines: bool) {
        let register = Register(at as u32);
        let op = self.program.body()[at];
        let value = match self.unlimited.get(&register) {
            Some(demand) => self.value(*demand),
            None => self
                .operation(op, self.ranged.contains(&register), &|register: Register| self.value(register)),
        };
        let Some(output) = self.wiring.names.get(&register).cloned() else {
            let value = if defines { self.shortened(value) } else { value };
            self.values[at] = Some(value);
            return;
        };
        self.values[at] = Some(if defines { output.volts() } else { value.clone() });
        if defines && !matches!(op, Op::State(_) | Op::Delayed(_)) {
            let value = value.times(&output.per_volt);
            let kind =
                if self.is_drive(register) { LawKind::Drive(value) } else { LawKind::Definition(value) };
            self.wiring.system.laws.push(Law { of: output.symbol, kind });
        }
    }

    /// The value of a register that was computed before.
    fn value(&self, register: Register) -> Fraction {
        self.values[register.index()].clone().unwrap_or_default()
    }

    /// The expression, or a new symbol for it if it is long.
    fn shortened(&mut self, value: Fraction) -> Fraction {
        if value.nested_size(LONGEST) < LONGEST {
            return value;
        }
        self.intermediates += 1;
        let name = format!("sum.{}", self.intermediates);
        let symbol = self.wiring.system.symbols.variable(&name, 0, Dimension::VOLTAGE);
        self.wiring.system.laws.push(Law { of: symbol, kind: LawKind::Definition(value) });
        Fraction::symbol(symbol)
    }

    /// Solves a loop and computes its registers.
    ///
    /// First the demanded outputs are computed as expressions of the tears, with no other symbols for outputs of the
    /// loop. A tear that can be solved for is replaced by its solution. The others become quantities with an implicit
    /// law.
    fn close_loop(&mut self, entry: &Loop, needed: &[bool]) {
        let mut unknowns = Vec::new();
        for tear in &entry.tears {
            if !self.wiring.names.contains_key(&tear.register) {
                // The name is used only if the loop cannot be solved.
                let symbol = self.wiring.system.symbols.variable(&tear.name, 0, Dimension::VOLTAGE);
                unknowns.push((Output { symbol, per_volt: Fraction::whole(1) }, false));
            } else {
                unknowns.push((self.wiring.names[&tear.register].clone(), true));
            }
            self.values[tear.register.index()] = unknowns.last().map(|(output, _)| output.volts());
        }
        let range = entry.operations.clone();
        range.clone().filter(|at| needed[*at]).for_each(|at| self.register(at, false));
        let residuals = entry.tears.iter().zip(&unknowns).map(|(tear, (output, _))| {
            let demand = self.value(tear.result);
            match tear.amplification {
                None => output.volts().minus(&demand),
                Some(index) => {
                    let amplification = &self.coefficients[index as usize];
                    let sum = demand.over(amplification).negated();
                    if self.options.has_ideal_amplifiers {
                        sum
                    } else {
                        sum.plus(&output.volts().over(amplification))
                    }
                }
            }
        });
        let is_open = entry.tears.iter().map(|tear| tear.amplification.is_some());
        let system: Vec<Unknown> = (unknowns.iter().zip(residuals).zip(is_open))
            .map(|(((output, _), residual), is_open)| Unknown { of: output.symbol, residual, is_open })
            .collect();
        let solutions = solve(system);
        for ((tear, (output, is_named)), solution) in entry.tears.iter().zip(&unknowns).zip(solutions) {
            let (value, kind) = match solution {
                Ok(value) if *is_named => (output.volts(), Some(LawKind::Definition(value))),
                Ok(value) => (value.over(&output.per_volt), None),
                Err(residual) => (output.volts(), Some(LawKind::Implicit(residual))),
            };
            self.values[tear.register.index()] = Some(value);
            self.wiring.system.laws.extend(kind.map(|kind| Law { of: output.symbol, kind }));
            self.wiring.names.entry(tear.register).or_insert_with(|| output.clone());
        }
        range.filter(|at| needed[*at]).for_each(|at| self.register(at, true));
    }

    /// The expression of an operation, with the expressions of its operands.
    ///
    /// `is_ranged` is whether it limits the input of a squaring network or a logarithm to its range.
    fn operation(&self, op: Op, is_ranged: bool, get: &dyn Fn(Register) -> Fraction) -> Fraction {
        match op {
            Op::Constant(value) => self.constant(value),
            Op::Parameter(index) => Fraction::symbol(self.wiring.parameters[index as usize]),
            Op::Coefficient(index) => self.coefficients[index as usize].clone(),
            Op::State(index) => {
                let register = self.output(self.program.state_laws()[index as usize].element).1;
                self.wiring.names[&register].volts()
            }
            Op::Mode(index) => Fraction::symbol(self.wiring.system.modes[index as usize].symbol),
            Op::Time => Fraction::symbol(self.wiring.time),
            Op::Add(a, b) => get(a).plus(&get(b)),
            Op::Subtract(a, b) => get(a).minus(&get(b)),
            Op::Multiply(a, b) => get(a).times(&get(b)),
            Op::Divide(a, b) => get(a).over(&get(b)),
            Op::Minimum(a, b) => get(a).minimum(&get(b)),
            Op::Maximum(a, _) if is_ranged && self.options.stays_in_range => get(a),
            Op::Maximum(a, b) => get(a).maximum(&get(b)),
            Op::Absolute(a) => absolute(&get(a)),
            Op::Select { left, right, then, otherwise } => {
                Fraction::select(&get(left), &get(right), &get(then), &get(otherwise))
            }
            Op::Call(function, a, b) => call(function, &get(a), &get(b)),
            Op::Table(table, at) => self.in_unit(table, opaque(Operation::Table(table), vec![get(at)])),
            Op::Delayed(index) => Fraction::symbol(self.wiring.delayed[index as usize]),
            Op::Sampled(index) => Fraction::symbol(self.wiring.sampled[index as usize]),
            Op::Level(index) => self.level(index as usize),
            // A loop computes its tears before their readers.
            Op::Tear { .. } => Fraction::zero(),
        }
    }

    /// The value of a table in SI as a number in its unit.
    fn in_unit(&self, table: u32, value: Fraction) -> Fraction {
        match &self.wiring.system.tables[table as usize].unit {
            Some(unit) => value.over(&Fraction::number(unit.factor)),
            None => value,
        }
    }

    /// The value of a level.
    fn level(&self, index: usize) -> Fraction {
        let value = Fraction::symbol(self.wiring.levels[index]);
        match self.program.levels()[index] {
            Level::Points { table } => self.in_unit(table as u32, value),
            Level::Noise(_) | Level::Pulses(_) => value,
        }
    }

    /// A number; multiples of pi keep their name.
    fn constant(&self, value: f64) -> Fraction {
        let turns = value / std::f64::consts::PI;
        let is_multiple = [1.0, 2.0, 0.5].contains(&turns);
        if is_multiple {
            Fraction::symbol(self.pi).times(&Fraction::number(turns))
        } else {
            Fraction::number(value)
        }
    }

    /// Adds the laws of everything that lasts: states, delays, stored values, levels, modes and tables; and the
    /// signals that read an output under another name.
    fn finish(mut self) -> Wiring {
        self.other_signals();
        self.states();
        self.delays();
        self.margins();
        self.levels();
        self.transitions();
        self.wiring
    }

    /// Defines the signals whose output has another name.
    fn other_signals(&mut self) {
        for signal in self.program.signals().iter().filter(|signal| signal.is_named) {
            let own = self.wiring.names.get(&signal.register);
            if own.is_some_and(|output| self.wiring.system.symbols.entry(output.symbol).name == signal.name) {
                continue;
            }
            let value = self.value(signal.register).times(&self.per_volt(signal));
            let of = self.wiring.system.symbols.variable(&signal.name, 0, signal.dimension);
            self.wiring.system.laws.push(Law { of, kind: LawKind::Definition(value) });
        }
    }

    /// Adds the laws of the states.
    fn states(&mut self) {
        for state in self.program.state_laws() {
            let output = self.wiring.names[&self.output(state.element).1].clone();
            let in_unit = |volts: Fraction| volts.times(&output.per_volt);
            let [lower, upper] = state.limits.map(|limit| self.value(limit));
            let is_amplifier = |limit: &Fraction, sign: i64| *limit == Fraction::whole(sign * 100);
            let lower = (!is_amplifier(&lower, -1)).then(|| in_unit(lower));
            let upper = (!is_amplifier(&upper, 1)).then(|| in_unit(upper));
            let rate = in_unit(self.value(state.demand));
            let initial = in_unit(self.coefficients[state.initial as usize].clone());
            let kind = LawKind::State { rate, initial, limits: [lower, upper] };
            self.wiring.system.laws.push(Law { of: output.symbol, kind });
        }
    }

    /// Adds the laws of delay lines and stored values.
    fn delays(&mut self) {
        for delay in self.program.delays() {
            let output = self.wiring.names[&self.output(delay.element).1].clone();
            let seconds = Fraction::number(delay.problem_seconds);
            let kind = LawKind::Delay {
                input: self.value(delay.input).times(&output.per_volt),
                time: self.coefficients[delay.time as usize].times(&seconds),
                initial: self.coefficients[delay.initial as usize].times(&output.per_volt),
            };
            self.wiring.system.laws.push(Law { of: output.symbol, kind });
        }
        for (index, sampled) in self.program.sampled_values().iter().enumerate() {
            let next = self.value(sampled.next);
            let initial = self.coefficients[sampled.initial as usize].clone();
            let kind = LawKind::Stored { next, initial };
            self.wiring.system.laws.push(Law { of: self.wiring.sampled[index], kind });
        }
    }

    /// Lists by how much the inputs of squaring networks and logarithms are within their range.
    fn margins(&mut self) {
        let mut registers: Vec<Register> = self.ranged.iter().copied().collect();
        registers.sort_unstable();
        for register in registers {
            if let Op::Maximum(input, least) = self.program.body()[register.index()] {
                let margin = self.value(input).minus(&self.value(least));
                self.wiring.system.margins.push(margin);
            }
        }
    }

    /// Adds the laws of noise, pulses and stepped tables.
    fn levels(&mut self) {
        for (index, level) in self.program.levels().iter().enumerate() {
            let source = match level {
                Level::Noise(_) => Source::Noise,
                Level::Points { table } => Source::Steps(*table),
                Level::Pulses(pulses) => Source::Pulses(self.pulses(pulses.train)),
            };
            let law = Law { of: self.wiring.levels[index], kind: LawKind::Source(source) };
            self.wiring.system.laws.push(law);
        }
    }

    /// Pulses as a law of time: 1 within a pulse, 0 outside.
    fn pulses(&self, train: PulseTrain<u32>) -> Fraction {
        let setting = |index: u32| self.coefficients[index as usize].clone();
        let time = Fraction::symbol(self.wiring.time);
        let fraction = |turns: &Fraction| turns.minus(&call(Function::Floor, turns, turns));
        let one = Fraction::whole(1);
        match train {
            PulseTrain::Wave { frequency, duty, phase } => {
                let turn = Fraction::symbol(self.pi).times(&Fraction::whole(2));
                let turns = setting(frequency).times(&time).plus(&setting(phase).over(&turn));
                one.minus(&step(&fraction(&turns).minus(&setting(duty))))
            }
            PulseTrain::Train { begin, width, period: None } => {
                let since = time.minus(&setting(begin));
                step(&since).minus(&step(&since.minus(&setting(width))))
            }
            PulseTrain::Train { begin, width, period: Some(period) } => {
                let (since, period) = (time.minus(&setting(begin)), setting(period));
                let share = fraction(&since.over(&period)).minus(&setting(width).over(&period));
                step(&since).times(&one.minus(&step(&share)))
            }
        }
    }

    /// Adds the transitions of the modes.
    fn transitions(&mut self) {
        for (index, mode) in self.program.modes().iter().enumerate() {
            let transitions = mode.transitions.iter().map(|transition| TransitionLaw {
                from: transition.from,
                to: transition.to,
                guard: self.value(transition.guard.register),
                is_strict: transition.guard.is_strict,
                reset: transition.reset.map(|reset| {
                    let state = &self.program.state_laws()[reset.state as usize];
                    let output = &self.wiring.names[&self.output(state.element).1];
                    (output.symbol, self.value(reset.to).times(&output.per_volt))
                }),
            });
            let transitions = transitions.collect();
            self.wiring.system.modes[index].transitions = transitions;
        }
    }
}

/// The registers that limit the inputs of squaring networks and logarithms to their range.
pub(crate) fn ranged(operations: &[Op]) -> HashSet<Register> {
    let inputs = operations.iter().filter_map(|op| match op {
        Op::Multiply(a, b) if a == b => Some(*a),
        Op::Call(Function::Ln | Function::Log10, a, _) => match operations[a.index()] {
            // The limited voltage is divided by that of the argument 1.
            Op::Divide(limited, _) => Some(limited),
            _ => Some(*a),
        },
        _ => None,
    });
    inputs.filter(|register| matches!(operations[register.index()], Op::Maximum(..))).collect()
}

/// The tables, in the order of the program.
fn tables(program: &Program) -> Vec<TableLaw> {
    let empty = TableLaw { element: String::new(), points: Vec::new(), unit: None };
    let mut tables = vec![empty; program.table_points().len()];
    for (element, output) in program.element_outputs().iter().enumerate() {
        let signal = program.signals().iter().find(|signal| signal.name == output.name);
        let unit = signal.map(|signal| TableUnit {
            text: signal.unit.clone(),
            factor: signal.per_unit,
            dimension: signal.dimension,
        });
        for (table, unit) in [(program.drive_table(element), unit), (program.element_curve(element), None)] {
            let Some(table) = table else { continue };
            let points = program.table_points()[table].clone();
            tables[table] = TableLaw { element: output.name.clone(), points, unit };
        }
    }
    tables
}
