//! The code that watches, and that sees what is recorded.

use std::mem::offset_of;

use cranelift_codegen::ir::condcodes::{FloatCC, IntCC};
use cranelift_codegen::ir::{InstBuilder, MemFlagsData, Value, types};

use super::super::Watched;
use super::Memory;
use super::emit::{Emitter, constant};

impl Emitter<'_, '_> {
    /// Leaves the code where a state is no number.
    pub fn watch_states(&mut self, states: &[Value], here: [Value; 2]) {
        let sum = states.iter().copied().reduce(|sum, state| self.build.ins().fadd(sum, state));
        if let Some(sum) = sum {
            let is_number = self.build.ins().fcmp(FloatCC::Equal, sum, sum);
            self.leave_unless(is_number, here);
        }
    }

    /// Works slope x voltage + room of the first watches out: a number whose sign is that of any of them below 0. Where
    /// some may be none, the code is left at each that is not 0 or more. Without a way to leave it writes them down,
    /// and what is none counts as below 0.
    pub fn watch(&mut self, watches: usize, here: Option<[Value; 2]>) -> Option<Value> {
        let pointer = self.pointer;
        let [slopes, rooms, rests] =
            [offset_of!(Memory, slopes), offset_of!(Memory, rooms), offset_of!(Memory, rests)]
                .map(|offset| self.of_memory(pointer, offset));
        let (zero, below) = (self.number(0.0), self.number(-1.0));
        let mut signs: Option<Value> = None;
        for (index, watch) in self.kernel.watches[..watches].iter().enumerate() {
            let mut value = self.get(watch.slot);
            if matches!(watch.what, Watched::Size(_)) {
                value = self.build.ins().fabs(value);
            }
            let offset = 8 * index as i32;
            let of =
                |emitter: &mut Self, base| emitter.build.ins().load(types::F64, constant(), base, offset);
            let mut rest = match watch.what {
                Watched::Corner | Watched::Points { .. } => {
                    let [slope, room] = [slopes, rooms].map(|base| of(self, base));
                    self.build.ins().fma(value, slope, room)
                }
                Watched::Above(_) => {
                    let room = of(self, rooms);
                    self.build.ins().fadd(value, room)
                }
                Watched::Below(_) | Watched::Size(_) => {
                    let room = of(self, rooms);
                    self.build.ins().fsub(room, value)
                }
            };
            if here.is_none() {
                self.store(rest, rests, index);
            }
            if self.is_doubtful || here.is_none() {
                let holds = self.build.ins().fcmp(FloatCC::GreaterThanOrEqual, rest, zero);
                match here {
                    Some(here) => {
                        self.leave_unless(holds, here);
                        continue;
                    }
                    None => rest = self.build.ins().select(holds, zero, below),
                }
            }
            signs = Some(signs.map_or(rest, |signs| self.build.ins().bor(signs, rest)));
        }
        signs
    }

    /// Whether the sign of a number is set.
    pub fn is_negative(&mut self, signs: Option<Value>) -> Value {
        let signs = signs.unwrap_or_else(|| self.number(0.0));
        let bits = self.build.ins().bitcast(types::I64, MemFlagsData::new(), signs);
        self.build.ins().icmp_imm_s(IntCC::SignedLessThan, bits, 0)
    }

    pub fn leave_where_negative(&mut self, signs: Option<Value>, here: [Value; 2]) {
        if signs.is_some() {
            let is_negative = self.is_negative(signs);
            let next = self.build.create_block();
            self.build.ins().brif(is_negative, self.met, &here.map(Into::into), next, &[]);
            self.build.switch_to_block(next);
        }
    }

    fn leave_unless(&mut self, holds: Value, here: [Value; 2]) {
        let next = self.build.create_block();
        self.build.ins().brif(holds, next, &[], self.met, &here.map(Into::into));
        self.build.switch_to_block(next);
    }

    /// Sees the voltages that are recorded: two at a time, whether any is the least or the largest so far.
    pub fn see(&mut self, time: Value) {
        let kernel = self.kernel;
        for slot in &kernel.seen {
            let value = self.get(*slot);
            self.store(value, self.slots[4], *slot as usize);
        }
        let values: Vec<Value> = kernel.turning.iter().map(|index| self.get(kernel.seen[*index])).collect();
        let pointer = self.pointer;
        let sides = [
            (FloatCC::LessThan, offset_of!(Memory, least), offset_of!(Memory, least_at)),
            (FloatCC::GreaterThan, offset_of!(Memory, most), offset_of!(Memory, most_at)),
        ];
        let sides = sides
            .map(|(is, extremes, at)| (is, self.of_memory(pointer, extremes), self.of_memory(pointer, at)));
        let bases = sides.map(|(is, extremes, _)| (is, extremes));
        let next = self.build.create_block();
        if let Some(any) = self.any_new(&values, bases) {
            let new = self.build.create_block();
            self.build.ins().brif(any, new, &[], next, &[]);
            self.build.switch_to_block(new);
        }
        for (index, value) in values.into_iter().enumerate() {
            for (is, extremes, at) in sides {
                self.see_one(value, time, is, index, [extremes, at]);
            }
        }
        self.build.ins().jump(next, &[]);
        self.build.switch_to_block(next);
    }

    /// Whether any of two or more voltages is beyond what was seen of it.
    fn any_new(&mut self, values: &[Value], bases: [(FloatCC, Value); 2]) -> Option<Value> {
        let mut any: Option<Value> = None;
        let last = values.len().checked_sub(2)?;
        // The last two overlap those before them where the number is odd.
        for first in (0..values.len()).step_by(2).map(|first| first.min(last)) {
            let one = self.build.ins().scalar_to_vector(types::F64X2, values[first]);
            let both = self.build.ins().insertlane(one, values[first + 1], 1);
            for (is, base) in bases {
                let flags = MemFlagsData::trusted();
                let known = self.build.ins().load(types::F64X2, flags, base, 8 * first as i32);
                let is_new = self.build.ins().fcmp(is, both, known);
                any = Some(any.map_or(is_new, |any| self.build.ins().bor(any, is_new)));
            }
        }
        any.map(|any| self.build.ins().vany_true(any))
    }

    fn see_one(&mut self, value: Value, time: Value, is: FloatCC, index: usize, [extremes, at]: [Value; 2]) {
        let known = self.build.ins().load(types::F64, MemFlagsData::trusted(), extremes, 8 * index as i32);
        let is_new = self.build.ins().fcmp(is, value, known);
        let [new, next] = [(); 2].map(|()| self.build.create_block());
        self.build.ins().brif(is_new, new, &[], next, &[]);
        self.build.switch_to_block(new);
        self.store(value, extremes, index);
        self.store(time, at, index);
        self.build.ins().jump(next, &[]);
        self.build.switch_to_block(next);
    }

    /// Keeps the values of now.
    pub fn keep(&mut self) {
        let kernel = self.kernel;
        for (index, slot) in kernel.kept.iter().enumerate() {
            let value = self.get(*slot);
            self.store(value, self.slots[4], kernel.layout.kept + index);
        }
    }
}
