//! Emits the prologue: formulas of parameters and scales become the coefficients that the body reads.
//!
//! All values of the prologue are in SI units. Each scale and each parameter is computed once and then found by name. A
//! formula without names has no unit, so it is taken in the unit that its place expects.

use std::f64::consts::TAU;

use super::Lowering;
use crate::elements::{Setting, SettingDefault, SettingQuantity};
use crate::ir::{Coefficient, Op, Register};
use crate::patch::Amount;
use patchcord_expr::{Callee, Expression, Formula, Function, Node, Operator};

impl Lowering<'_> {
    /// The coefficient with a signal's value per volt, in SI: value of the scale per volt x factor. Without a scale,
    /// the value is in volts.
    pub(super) fn signal_coefficient(&mut self, name: &str, scale: Option<usize>, factor: f64) -> u32 {
        let volt = match scale {
            Some(scale) => self.derived(scale),
            None => self.emit_prologue(Op::Constant(1.0)),
        };
        let factor = self.emit_prologue(Op::Constant(factor));
        let register = self.emit_prologue(Op::Multiply(volt, factor));
        let index = self.push_coefficient(register, format!("signal {name} per volt"), (f64::MIN, f64::MAX));
        let signal = self.circuit.patch().signals.get(name);
        self.draft.program.lowered_mut().coefficients[index as usize].span = signal.map(|signal| signal.span);
        index
    }

    /// The coefficient with the value of a scale per volt, in SI. Formulas of a run read it, and messages point to the
    /// scale.
    pub(super) fn scale_coefficient(&mut self, scale: usize) -> u32 {
        let register = self.derived(scale);
        let label = format!("scale {} per volt", self.circuit.derived(scale).0);
        let index = self.push_coefficient(register, label, (f64::MIN, f64::MAX));
        self.draft.program.lowered_mut().coefficients[index as usize].span =
            Some(self.circuit.patch().scales[scale].span);
        index
    }

    /// Appends an operation to the prologue. The register is the index of the operation.
    pub(super) fn emit_prologue(&mut self, op: Op) -> Register {
        self.draft.program.lowered_mut().prologue.push(op);
        Register(self.draft.program.lowered.prologue.len() as u32 - 1)
    }

    /// Adds a coefficient of the current element and returns its index. `label` and the element's position are for
    /// messages, and `range` has the least and the largest permitted value.
    pub(super) fn push_coefficient(&mut self, register: Register, label: String, range: (f64, f64)) -> u32 {
        let span = self.circuit.element(self.draft.current).span;
        self.draft.program.lowered_mut().coefficients.push(Coefficient {
            register,
            label,
            range,
            is_whole: false,
            span,
        });
        self.draft.program.lowered.coefficients.len() as u32 - 1
    }

    /// The coefficient of a setting of the current element. It is emitted when the setting is first read.
    ///
    /// `None` if the patch omits the setting and it has no default, or if the patch gives something other than a
    /// formula: a flag, a choice or points.
    pub(super) fn setting_coefficient(&mut self, name: &str) -> Option<u32> {
        let element = self.circuit.element(self.draft.current);
        let index = self.setting(name);
        if let Some(made) = self.settings.get(&(self.draft.current, index)) {
            return Some(*made);
        }
        let row = &element.kind.settings[index];
        let register = match (self.amount(name), row.default) {
            (Some(Amount::Formula(formula)), _) => self.setting_formula(formula, row),
            (None, SettingDefault::Number(number)) => self.emit_prologue(Op::Constant(number)),
            _ => return None,
        };
        let made = self.push_coefficient(register, self.label(row), row.coefficient_range());
        self.draft.program.lowered_mut().coefficients[made as usize].is_whole =
            row.quantity == SettingQuantity::Whole;
        self.settings.insert((self.draft.current, index), made);
        Some(made)
    }

    /// Element and setting, for messages: "PC5 setting".
    fn label(&self, row: &Setting) -> String {
        format!("{} {}", self.circuit.element(self.draft.current).name, row.name)
    }

    /// The value of a setting's formula in volts, seconds, Hz or plain numbers.
    ///
    /// An angular frequency is divided by 2 pi. A setting of a drive that is a signal or the rate of a signal is
    /// converted: volts = value in SI / value of one volt in SI. A formula without names is in the unit of the drive's
    /// scale.
    fn setting_formula(&mut self, formula: &Formula, row: &Setting) -> Register {
        let value = self.expression(formula.root());
        if row.quantity == SettingQuantity::Hertz && self.circuit.quantities().is_angular(formula) {
            let cycle = self.emit_prologue(Op::Constant(TAU));
            return self.emit_prologue(Op::Divide(value, cycle));
        }
        if !matches!(row.quantity, SettingQuantity::Signal | SettingQuantity::SignalRate) {
            return value;
        }
        if row.range != row.coefficient_range() {
            // The range applies to the value before the conversion to volts, which may change its sign.
            self.push_coefficient(value, self.label(row), row.range);
        }
        let Some(scale) = self.circuit.element(self.draft.current).scale else { return value };
        let volt = self.derived(scale);
        let value = self.in_si(value, formula, self.circuit.derived_unit(scale).factor());
        self.emit_prologue(Op::Divide(value, volt))
    }

    /// A value in SI. A formula without names is in the given unit: it is multiplied by the size of the unit in SI. Any
    /// other formula already has a value in SI.
    fn in_si(&mut self, value: Register, formula: &Formula, unit: f64) -> Register {
        if !self.circuit.is_literal(formula) || unit == 1.0 {
            return value;
        }
        let unit = self.emit_prologue(Op::Constant(unit));
        self.emit_prologue(Op::Multiply(value, unit))
    }

    /// The value of a scale per volt, or of a macro's setting, in SI. It is emitted at the first use, and its register
    /// is kept under its name.
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

    /// Emits an expression, operands first. -x becomes 0 - x, because there is no operation for a sign.
    fn expression(&mut self, node: &Node) -> Register {
        match &node.expression {
            Expression::Number(value) => self.emit_prologue(Op::Constant(*value)),
            Expression::Name(name) => self.name(name),
            Expression::Negate(operand) => {
                let operand = self.expression(operand);
                let zero = self.emit_prologue(Op::Constant(0.0));
                self.emit_prologue(Op::Subtract(zero, operand))
            }
            Expression::Binary(operator, left, right) => {
                let (left, right) = (self.expression(left), self.expression(right));
                self.emit_prologue(binary(*operator, left, right))
            }
            Expression::Call(callee, arguments) => {
                let arguments: Vec<_> = arguments.iter().map(|argument| self.expression(argument)).collect();
                self.emit_prologue(call(*callee, &arguments))
            }
            Expression::Apply(..) => unreachable!("only equations apply functions of equations and tables"),
        }
    }

    /// The register with the value of a name. It is computed at most once.
    ///
    /// Derived quantities come first, then parameters. The circuit has checked all names, so any other name is the time
    /// scale.
    fn name(&mut self, name: &str) -> Register {
        if let Some(register) = self.names.get(name) {
            return *register;
        }
        if let Some(index) = self.circuit.derived_index(name) {
            return self.derived(index);
        }
        let register = match self.draft.program.parameter(name) {
            Some(index) => self.emit_prologue(Op::Parameter(index as u32)),
            None => self.emit_prologue(Op::Constant(self.circuit.time_scale())),
        };
        self.names.insert(name.to_owned(), register);
        register
    }
}

/// The operation for an operator. A power is a call of a function with two arguments.
fn binary(operator: Operator, left: Register, right: Register) -> Op {
    match operator {
        Operator::Add => Op::Add(left, right),
        Operator::Subtract => Op::Subtract(left, right),
        Operator::Multiply => Op::Multiply(left, right),
        Operator::Divide => Op::Divide(left, right),
        Operator::Power => Op::Call(Function::Power, left, right),
    }
}

/// The operation for a function call. The parser has checked the number of arguments, so a missing one is never read.
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
