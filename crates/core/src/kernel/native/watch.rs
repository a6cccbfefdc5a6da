//! The code that watches.

use std::mem::offset_of;

use cranelift_codegen::ir::condcodes::FloatCC;
use cranelift_codegen::ir::{InstBuilder, Value, types};

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
}
