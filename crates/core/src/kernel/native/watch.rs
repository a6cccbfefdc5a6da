//! Emits the code of the watches.
//!
//! Only look-aheads and evaluations have watches. Steps write voltages into rows, which are tested afterwards.

use std::mem::offset_of;

use cranelift_codegen::ir::condcodes::FloatCC;
use cranelift_codegen::ir::{InstBuilder, Value, types};

use super::super::WatchCondition;
use super::Memory;
use super::emit::Emitter;

impl Emitter<'_, '_> {
    /// Computes the margins of the first watches, slope x voltage + offset, and stores them into a list, given by the
    /// offset of its pointer in the memory. The result says whether any is below 0 or not a number.
    pub(super) fn watch(&mut self, watches: usize, list: usize) -> Value {
        let pointer = self.pointer;
        let [slopes, offsets, margins] = [offset_of!(Memory, slopes), offset_of!(Memory, offsets), list]
            .map(|offset| self.of_memory(pointer, offset));
        let zero = self.number(0.0);
        let mut is_any_hit = self.build.ins().iconst(types::I8, 0);
        for (index, watch) in self.kernel.watches[..watches].iter().enumerate() {
            let mut value = self.get(watch.slot);
            if matches!(watch.condition, WatchCondition::Size(_)) {
                value = self.build.ins().fabs(value);
            }
            let [slope, offset] = [slopes, offsets].map(|base| self.load(base, index));
            let margin = self.build.ins().fma(value, slope, offset);
            self.store(margin, margins, index);
            let is_short = self.build.ins().fcmp(FloatCC::UnorderedOrLessThan, margin, zero);
            is_any_hit = self.build.ins().bor(is_any_hit, is_short);
        }
        is_any_hit
    }

    /// Stores what is tested within a step, at one of the first two stages of a look-ahead.
    pub(super) fn store_inner(&mut self, stage: usize) {
        let kernel = self.kernel;
        let list = offset_of!(Memory, inner) + stage * size_of::<*mut f64>();
        self.watch(kernel.thorough.within, list);
        let base = self.of_memory(self.pointer, list);
        for (index, followed) in kernel.turning().iter().enumerate() {
            let value = self.get(followed.slot);
            self.store(value, base, kernel.thorough.within + index);
        }
    }
}
