//! The code that watches, and that sees what is recorded.

use std::mem::offset_of;

use cranelift_codegen::ir::condcodes::FloatCC;
use cranelift_codegen::ir::{Endianness, InstBuilder, MemFlagsData, Value, types};

use super::super::Watched;
use super::super::code::Slot;
use super::Memory;
use super::emit::Emitter;

/// Two voltages.
struct Pair {
    both: Value,
    /// Where the first stands among numbers like it.
    offset: i32,
    /// Whether they are two; else one stands twice.
    is_whole: bool,
}

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

    /// Leaves the code where one of the first fences' voltages is not between its numbers.
    pub fn leave_beyond_fences(&mut self, fences: usize, here: &[Value]) {
        let kernel = self.kernel;
        let voltages: Vec<Slot> = kernel.fences[..fences].iter().map(|fence| fence.slot).collect();
        let pointer = self.pointer;
        let bounds = [
            (FloatCC::UnorderedOrLessThan, offset_of!(Memory, lows)),
            (FloatCC::UnorderedOrGreaterThan, offset_of!(Memory, highs)),
        ];
        let bounds = bounds.map(|(is, offset)| (is, self.of_memory(pointer, offset)));
        let mut beyond = None;
        for pair in self.pairs(&voltages) {
            for (is, base) in bounds {
                let bound = self.load_pair(types::F64X2, base, &pair);
                let is_beyond = self.build.ins().fcmp(is, pair.both, bound);
                beyond = Some(self.or(beyond, is_beyond));
            }
        }
        if let Some(beyond) = beyond {
            let any = self.build.ins().vany_true(beyond);
            self.leave_if(any, here);
        }
    }

    /// Sees which of the voltages that are followed are the least or the largest so far, at a time.
    pub fn see(&mut self, time: Value) {
        let kernel = self.kernel;
        let pointer = self.pointer;
        let pairs = self.pairs(&kernel.followed);
        let sides = [
            (FloatCC::LessThan, [offset_of!(Memory, least), offset_of!(Memory, least_at)]),
            (FloatCC::GreaterThan, [offset_of!(Memory, most), offset_of!(Memory, most_at)]),
        ];
        let sides = sides.map(|(is, places)| (is, places.map(|offset| self.of_memory(pointer, offset))));
        let (mut any, mut compared) = (None, Vec::new());
        for pair in &pairs {
            for (is, [extreme, at]) in sides {
                let known = self.load_pair(types::F64X2, extreme, pair);
                let is_new = self.build.ins().fcmp(is, pair.both, known);
                any = Some(self.or(any, is_new));
                compared.push((pair, is_new, [extreme, at]));
            }
        }
        let Some(any) = any else { return };
        let any = self.build.ins().vany_true(any);
        let [new, next] = [(); 2].map(|()| self.build.create_block());
        self.build.ins().brif(any, new, &[], next, &[]);
        self.build.switch_to_block(new);
        let now = self.build.ins().splat(types::F64X2, time);
        // Written two at a time, as they are read: what is read is then at hand.
        for (pair, is_new, places) in compared {
            for (value, place) in [pair.both, now].into_iter().zip(places) {
                let known = self.load_pair(types::F64X2, place, pair);
                let is_new = self.build.ins().bitcast(types::F64X2, little(), is_new);
                let value = self.build.ins().bitselect(is_new, value, known);
                self.store_pair(value, place, pair);
            }
        }
        self.build.ins().jump(next, &[]);
        self.build.switch_to_block(next);
    }

    /// Voltages two at a time; of an odd number the last stands twice.
    fn pairs(&mut self, voltages: &[Slot]) -> Vec<Pair> {
        let in_pair = |(index, slots): (usize, &[Slot])| {
            let [one, other] = [slots[0], slots[slots.len() - 1]].map(|slot| self.get(slot));
            let both = self.build.ins().splat(types::F64X2, other);
            let both = self.build.ins().insertlane(both, one, 0);
            Pair { both, offset: 16 * index as i32, is_whole: slots.len() == 2 }
        };
        voltages.chunks(2).enumerate().map(in_pair).collect()
    }

    /// The numbers of a pair that stand side by side in memory.
    fn load_pair(&mut self, of: types::Type, base: Value, pair: &Pair) -> Value {
        if pair.is_whole {
            return self.build.ins().load(of, unaligned(), base, pair.offset);
        }
        let one = self.build.ins().load(of.lane_type(), MemFlagsData::trusted(), base, pair.offset);
        self.build.ins().splat(of, one)
    }

    fn store_pair(&mut self, both: Value, base: Value, pair: &Pair) {
        if pair.is_whole {
            self.build.ins().store(unaligned(), both, base, pair.offset);
        } else {
            let one = self.build.ins().extractlane(both, 0);
            self.build.ins().store(MemFlagsData::trusted(), one, base, pair.offset);
        }
    }

    fn or(&mut self, any: Option<Value>, one: Value) -> Value {
        any.map_or(one, |any| self.build.ins().bor(any, one))
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

/// Of memory that is aligned as one number is, not as two.
fn unaligned() -> MemFlagsData {
    MemFlagsData::new().with_notrap()
}

/// Lanes in the order in which they stand in memory.
fn little() -> MemFlagsData {
    MemFlagsData::new().with_endianness(Endianness::Little)
}
