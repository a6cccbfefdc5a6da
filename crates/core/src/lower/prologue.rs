//! The prologue: formulas of parameters and scales, turned into the coefficients that the body reads.

use super::Lowering;
use crate::elements::{Default as SettingDefault, Measure, Setting};
use crate::ir::{Coefficient, Op, Register};
use crate::patch::Amount;
use patchcord_expr::{Callee, Expression, Formula, Function, Node, Operator};

impl Lowering<'_> {
    /// What one volt of a signal stands for, in SI; volts without a scale.
    pub(super) fn signal_coefficient(&mut self, name: &str, scale: Option<usize>, factor: f64) -> u32 {
        let volt = match scale {
            Some(scale) => self.derived(scale),
            None => self.early(Op::Constant(1.0)),
        };
        let factor = self.early(Op::Constant(factor));
        let register = self.early(Op::Multiply(volt, factor));
        let index = self.push_coefficient(register, format!("signal {name} per volt"), (f64::MIN, f64::MAX));
        let signal = self.circuit.patch().signals.get(name);
        self.draft.program.coefficients[index as usize].span = signal.map(|signal| signal.span);
        index
    }

    pub(super) fn scale_coefficient(&mut self, scale: usize) -> u32 {
        let register = self.derived(scale);
        let label = format!("scale {} per volt", self.circuit.derived(scale).0);
        let index = self.push_coefficient(register, label, (f64::MIN, f64::MAX));
        self.draft.program.coefficients[index as usize].span = Some(self.circuit.patch().scales[scale].span);
        index
    }

    pub(super) fn early(&mut self, op: Op) -> Register {
        self.draft.program.prologue.push(op);
        Register(self.draft.program.prologue.len() as u32 - 1)
    }

    pub(super) fn push_coefficient(&mut self, register: Register, label: String, range: (f64, f64)) -> u32 {
        let span = self.circuit.element(self.draft.current).span;
        self.draft.program.coefficients.push(Coefficient { register, label, range, whole: false, span });
        self.draft.program.coefficients.len() as u32 - 1
    }

    /// The coefficient of a setting of the current element, made when it is first read.
    pub(super) fn setting_coefficient(&mut self, name: &str) -> Option<u32> {
        let element = self.circuit.element(self.draft.current);
        let index = self.setting(name);
        if let Some(made) = self.settings.get(&(self.draft.current, index)) {
            return Some(*made);
        }
        let row = &element.kind.settings[index];
        let register = match (self.amount(name), row.default) {
            (Some(Amount::Formula(formula)), _) => self.placed_formula(formula, row),
            (None, SettingDefault::Number(number)) => self.early(Op::Constant(number)),
            _ => return None,
        };
        let made = self.push_coefficient(register, self.label(row), row.coefficient_range());
        self.draft.program.coefficients[made as usize].whole = row.measure == Measure::Whole;
        self.settings.insert((self.draft.current, index), made);
        Some(made)
    }

    fn label(&self, row: &Setting) -> String {
        format!("{} {}", self.circuit.element(self.draft.current).name, row.name)
    }

    /// A formula's value in volts, seconds or plain numbers: plain formulas of a drive stand in its unit.
    fn placed_formula(&mut self, formula: &Formula, row: &Setting) -> Register {
        let value = self.expression(formula.root());
        if !matches!(row.measure, Measure::Signal | Measure::SignalRate) {
            return value;
        }
        if row.range != row.coefficient_range() {
            // In volts it may have either sign: what its range allows is looked at before.
            self.push_coefficient(value, self.label(row), row.range);
        }
        let Some(scale) = self.circuit.element(self.draft.current).scale else { return value };
        let volt = self.derived(scale);
        let value = self.in_si(value, formula, self.circuit.derived_unit(scale).factor());
        self.early(Op::Divide(value, volt))
    }

    fn in_si(&mut self, value: Register, formula: &Formula, unit: f64) -> Register {
        if !self.circuit.is_plain(formula) || unit == 1.0 {
            return value;
        }
        let unit = self.early(Op::Constant(unit));
        self.early(Op::Multiply(value, unit))
    }

    /// A scale's value of one volt, or a macro's setting, in SI.
    pub(super) fn derived(&mut self, index: usize) -> Register {
        let (name, formula) = self.circuit.derived(index);
        if let Some(register) = self.names.get(name) {
            return *register;
        }
        let value = self.expression(formula.root());
        let register = self.in_si(value, formula, self.circuit.derived_unit(index).factor());
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
        if let Some(index) = self.circuit.derived_index(name) {
            return self.derived(index);
        }
        let parameter = self.draft.program.parameters.iter().position(|slot| slot.name == name);
        let register = match parameter {
            Some(index) => self.early(Op::Parameter(index as u32)),
            None => self.early(Op::Constant(self.circuit.time_scale())),
        };
        self.names.insert(name.to_owned(), register);
        register
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
