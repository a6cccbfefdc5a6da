//! Evaluates the body of a program with expressions, and solves its loops.

use patchcord_core::ir::{Loop, Op, Register, Tear};
use patchcord_expr::Dimension;

use super::super::loops::{Unknown, solve};
use super::super::system::{Law, LawKind};
use super::{Derivation, Output};
use crate::symbolic::Fraction;

/// Longest expression that is kept without a name, in terms.
const LONGEST: usize = 200;

impl Derivation<'_> {
    /// Evaluates the body, and adds the definitions of outputs with names.
    pub(super) fn body(&mut self) {
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

    /// The expression, or a new symbol for it if it is long.
    fn shortened(&mut self, value: Fraction) -> Fraction {
        if value.nested_size(LONGEST) < LONGEST {
            return value;
        }
        let name = self.intermediate_name();
        let symbol = self.wiring.system.symbols.variable(&name, 0, Dimension::VOLTAGE);
        self.wiring.system.laws.push(Law { of: symbol, kind: LawKind::Definition(value) });
        Fraction::symbol(symbol)
    }

    /// A name for a long expression that no output has.
    fn intermediate_name(&mut self) -> String {
        let signals = self.program.signals();
        loop {
            self.intermediates += 1;
            let name = format!("sum.{}", self.intermediates);
            if signals.iter().all(|signal| signal.name != name) {
                return name;
            }
        }
    }

    /// Solves a loop and computes its registers.
    ///
    /// First the demanded outputs are computed as expressions of the tears, with no other symbols for outputs of the
    /// loop. A tear that can be solved for is replaced by its solution. The others become quantities with an implicit
    /// law.
    fn close_loop(&mut self, entry: &Loop, needed: &[bool]) {
        let unknowns: Vec<(Output, bool)> = entry.tears.iter().map(|tear| self.unknown(tear)).collect();
        let range = entry.operations.clone();
        range.clone().filter(|at| needed[*at]).for_each(|at| self.register(at, false));
        let system = entry.tears.iter().zip(&unknowns).map(|(tear, (output, _))| Unknown {
            of: output.symbol,
            residual: self.residual(tear, output),
            is_open: tear.amplification.is_some(),
        });
        let solutions = solve(system.collect());
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

    /// The quantity at the output at which a loop is opened, and whether the output has a name.
    fn unknown(&mut self, tear: &Tear) -> (Output, bool) {
        let named = self.wiring.names.get(&tear.register).cloned();
        let is_named = named.is_some();
        let output = named.unwrap_or_else(|| {
            // The name is used only if the loop cannot be solved.
            let symbol = self.wiring.system.symbols.variable(&tear.name, 0, Dimension::VOLTAGE);
            Output { symbol, per_volt: Fraction::whole(1) }
        });
        self.values[tear.register.index()] = Some(output.volts());
        (output, is_named)
    }

    /// The expression that is 0 at the voltage of a tear: the difference between the output and the demanded one. For an
    /// open amplifier it is the sum of its inputs and of its output over the amplification.
    fn residual(&self, tear: &Tear, output: &Output) -> Fraction {
        let demand = self.value(tear.result);
        let Some(index) = tear.amplification else { return output.volts().minus(&demand) };
        let amplification = &self.coefficients[index as usize];
        let sum = demand.over(amplification).negated();
        if self.options.has_ideal_amplifiers {
            return sum;
        }
        sum.plus(&output.volts().over(amplification))
    }
}
