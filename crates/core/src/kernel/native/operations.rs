//! Emits the code of a kernel's operations.
//!
//! The code has no loops over operations: each instruction of the kernel becomes one or a few instructions of the
//! processor. A value is loaded from its slot at the first use in a stage and not again. Functions and tables are calls
//! of helpers, so they give the same bits as the interpreter.

use std::mem::offset_of;

use cranelift_codegen::ir::condcodes::FloatCC;
use cranelift_codegen::ir::{InstBuilder, Value, types};

use super::super::code::{Code, Instruction, Slot};
use super::Memory;
use super::emit::{Emitter, constant};

impl Emitter<'_, '_> {
    /// The value in a slot.
    ///
    /// A value that this stage has computed or loaded is used again. Otherwise a factor of 0 becomes a constant, a
    /// sampled value is loaded from the row of the present step, and everything else from the slot.
    pub(super) fn get(&mut self, slot: Slot) -> Value {
        let index = slot as usize;
        if let Some(value) = self.values[index] {
            return value;
        }
        let sampled = self.kernel.layout.sampled..self.kernel.layout.levels;
        let value = match (self.kernel.number(slot), self.row) {
            (Some(value), _) if value.to_bits() == 0 => self.number(0.0),
            (_, Some(row)) if sampled.contains(&index) => {
                self.load(row, self.columns.sampled + index - sampled.start)
            }
            // Factors and levels never change while the code runs; nor do sampled values outside of steps.
            _ => self.build.ins().load(types::F64, constant(), self.slots[self.stage], 8 * slot as i32),
        };
        self.values[index] = Some(value);
        value
    }

    /// Emits a list of operations. Their results are known by slot until the next stage begins.
    pub(super) fn run(&mut self, code: &Code) {
        for instruction in &code.instructions {
            let (out, value) = self.instruction(code, *instruction);
            self.values[out as usize] = Some(value);
        }
    }

    /// Emits one instruction. Returns its slot and its value. Each has the rounding of the interpreter: fused
    /// multiply-adds for lines and sums, and comparisons that return a NaN on the left.
    fn instruction(&mut self, code: &Code, instruction: Instruction) -> (Slot, Value) {
        match instruction {
            Instruction::Line { out, constant, factor, a } => {
                let [factor, a, constant] = [factor, a, constant].map(|slot| self.get(slot));
                (out, self.build.ins().fma(factor, a, constant))
            }
            Instruction::Sum { out, constant, first, count } => {
                let terms = &code.terms[first as usize..(first + count) as usize];
                (out, self.sum(constant, terms))
            }
            Instruction::Multiply { out, a, b } => {
                let [a, b] = [a, b].map(|slot| self.get(slot));
                (out, self.build.ins().fmul(a, b))
            }
            Instruction::Minimum { out, a, b } => {
                let [a, b] = [a, b].map(|slot| self.get(slot));
                (out, self.choose(FloatCC::LessThan, b, a, b, a))
            }
            Instruction::Maximum { out, a, b } => {
                let [a, b] = [a, b].map(|slot| self.get(slot));
                (out, self.choose(FloatCC::GreaterThan, b, a, b, a))
            }
            Instruction::Absolute { out, a } => {
                let a = self.get(a);
                (out, self.build.ins().fabs(a))
            }
            Instruction::Call { out, function, a, b } => {
                let [a, b] = [a, b].map(|slot| self.get(slot));
                let index = self.build.ins().iconst(types::I64, function as i64);
                let call = self.build.ins().call(self.call, &[index, a, b]);
                (out, self.build.inst_results(call)[0])
            }
            Instruction::Table { out, table, a } => {
                let a = self.get(a);
                let pointer = self.pointer;
                let tables = self.of_memory(pointer, offset_of!(Memory, tables));
                let index = self.build.ins().iconst(types::I64, i64::from(table));
                let call = self.build.ins().call(self.look_up, &[tables, index, a]);
                (out, self.build.inst_results(call)[0])
            }
        }
    }

    /// Emits a sum. If another sum begins with the same terms, it continues from there.
    fn sum(&mut self, constant: Slot, terms: &[(Slot, Slot)]) -> Value {
        let mut prefix = vec![constant];
        let mut sum = None;
        for (factor, a) in terms {
            prefix.extend([*factor, *a]);
            sum = Some(match self.sums.get(&prefix) {
                Some(known) => *known,
                None => {
                    let [factor, a] = [*factor, *a].map(|slot| self.get(slot));
                    let before = sum.unwrap_or_else(|| self.get(constant));
                    let value = self.build.ins().fma(factor, a, before);
                    self.sums.insert(prefix.clone(), value);
                    value
                }
            });
        }
        sum.unwrap_or_else(|| self.get(constant))
    }

    /// `then` if a comparison holds, otherwise `otherwise`. A branch is used because compared values rarely change
    /// sides, and the processor predicts it.
    fn choose(&mut self, is: FloatCC, left: Value, right: Value, then: Value, otherwise: Value) -> Value {
        let is_chosen = self.build.ins().fcmp(is, left, right);
        let joined = self.build.create_block();
        self.build.append_block_param(joined, types::F64);
        self.build.ins().brif(is_chosen, joined, &[then.into()], joined, &[otherwise.into()]);
        self.build.switch_to_block(joined);
        self.build.block_params(joined)[0]
    }
}
