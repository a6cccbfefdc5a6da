//! The code that watches, and that sees what is recorded.

use std::mem::offset_of;

use cranelift_codegen::ir::condcodes::FloatCC;
use cranelift_codegen::ir::{InstBuilder, MemFlagsData, Value, types};

use super::super::Watched;
use super::Memory;
use super::emit::Emitter;

impl Emitter<'_, '_> {
    /// Works slope x voltage + room of the first watches out and writes them down: whether any is not 0 or more.
    pub fn watch(&mut self, watches: usize) -> Value {
        let pointer = self.pointer;
        let [slopes, rooms, rests] =
            [offset_of!(Memory, slopes), offset_of!(Memory, rooms), offset_of!(Memory, rests)]
                .map(|offset| self.of_memory(pointer, offset));
        let zero = self.number(0.0);
        let mut any = self.build.ins().iconst(types::I8, 0);
        for (index, watch) in self.kernel.watches[..watches].iter().enumerate() {
            let mut value = self.get(watch.slot);
            if matches!(watch.what, Watched::Size(_)) {
                value = self.build.ins().fabs(value);
            }
            let [slope, room] = [slopes, rooms].map(|base| self.load(base, index));
            let rest = self.build.ins().fma(value, slope, room);
            self.store(rest, rests, index);
            let is_short = self.build.ins().fcmp(FloatCC::UnorderedOrLessThan, rest, zero);
            any = self.build.ins().bor(any, is_short);
        }
        any
    }

    /// Leaves the code where one of the first fences' voltages is not between its numbers: two are looked at at a time.
    pub fn leave_beyond_fences(&mut self, fences: usize, here: &[Value]) {
        let kernel = self.kernel;
        let values: Vec<Value> = kernel.fences[..fences].iter().map(|fence| self.get(fence.slot)).collect();
        let bases = [
            (FloatCC::GreaterThanOrEqual, offset_of!(Memory, lows)),
            (FloatCC::LessThanOrEqual, offset_of!(Memory, highs)),
        ];
        let pointer = self.pointer;
        let bases = bases.map(|(is, offset)| (is, self.of_memory(pointer, offset)));
        let compared = self.compared_in_pairs(&values, bases);
        let Some(all) = compared.into_iter().reduce(|all, is| self.build.ins().band(all, is)) else { return };
        let holds = self.build.ins().vall_true(all);
        self.leave_unless(holds, here);
    }

    /// Sees the voltages that are recorded: two at a time, whether any is the least or the largest so far. Those of the last
    /// step are left behind.
    pub fn see(&mut self, time: Value, is_last: Value) {
        let kernel = self.kernel;
        let [leave, go_on] = [(); 2].map(|()| self.build.create_block());
        let seen: Vec<Value> = kernel.seen.iter().map(|slot| self.get(*slot)).collect();
        self.build.ins().brif(is_last, leave, &[], go_on, &[]);
        self.build.switch_to_block(leave);
        for (slot, value) in kernel.seen.iter().zip(&seen) {
            self.store(*value, self.slots[4], *slot as usize);
        }
        self.build.ins().jump(go_on, &[]);
        self.build.switch_to_block(go_on);
        let values: Vec<Value> = kernel.turning.iter().map(|index| seen[*index]).collect();
        let pointer = self.pointer;
        let sides = [
            (FloatCC::LessThan, offset_of!(Memory, least), offset_of!(Memory, least_at)),
            (FloatCC::GreaterThan, offset_of!(Memory, most), offset_of!(Memory, most_at)),
        ];
        let sides = sides
            .map(|(is, extremes, at)| (is, self.of_memory(pointer, extremes), self.of_memory(pointer, at)));
        let bases = sides.map(|(is, extremes, _)| (is, extremes));
        let next = self.build.create_block();
        let compared = self.compared_in_pairs(&values, bases);
        if let Some(any) = compared.into_iter().reduce(|any, is| self.build.ins().bor(any, is)) {
            let any = self.build.ins().vany_true(any);
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

    /// Compares voltages, two at a time, with numbers that stand in memory; of an odd number the last stands twice.
    fn compared_in_pairs(&mut self, values: &[Value], bases: [(FloatCC, Value); 2]) -> Vec<Value> {
        let mut compared = Vec::new();
        for first in (0..values.len()).step_by(2) {
            let pair = [first, (first + 1).min(values.len() - 1)];
            let both = self.pair(pair.map(|index| values[index]));
            for (is, base) in bases {
                let known = if pair[0] == pair[1] {
                    let known =
                        self.build.ins().load(types::F64, MemFlagsData::trusted(), base, 8 * first as i32);
                    self.build.ins().splat(types::F64X2, known)
                } else {
                    // Aligned as one number is, not as two.
                    self.build.ins().load(
                        types::F64X2,
                        MemFlagsData::new().with_notrap(),
                        base,
                        8 * first as i32,
                    )
                };
                compared.push(self.build.ins().fcmp(is, both, known));
            }
        }
        compared
    }

    fn pair(&mut self, [one, other]: [Value; 2]) -> Value {
        let pair = self.build.ins().splat(types::F64X2, other);
        self.build.ins().insertlane(pair, one, 0)
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
