//! The code of steps and of looks ahead.

use std::collections::HashMap;
use std::mem::offset_of;

use cranelift_codegen::ir::condcodes::IntCC;
use cranelift_codegen::ir::{Block, FuncRef, InstBuilder, MemFlagsData, Value, types};
use cranelift_frontend::FunctionBuilder;

use super::super::code::Slot;
use super::super::rows::Columns;
use super::super::step::SIXTH;
use super::super::{Checks, Kernel};
use super::Memory;

/// States of so many integrators are carried from step to step in registers.
const MOST_CARRIED: usize = 4;

/// What writes the code of a kernel.
pub(super) struct Emitter<'a, 'f> {
    pub build: &'a mut FunctionBuilder<'f>,
    pub kernel: &'a Kernel,
    pub pointer: types::Type,
    pub call: FuncRef,
    pub look_up: FuncRef,
    pub memory: Value,
    /// The slots, by stage.
    pub slots: [Value; 5],
    /// Where they are read now.
    pub stage: usize,
    /// The states and their rates.
    pub states: Value,
    pub rates: Value,
    pub columns: &'a Columns,
    /// Of a step, the row in which it begins.
    pub row: Option<Value>,
    /// Where stands what tables of time give in the middle of a step, and at its end.
    ahead: Value,
    /// The states that the first stage of a step tries, where they are few: worked out in the step before, from what is
    /// still at hand.
    tried: Vec<Value>,
    /// The values of the slots that were worked out or loaded in this stage.
    pub values: Vec<Option<Value>>,
    /// The beginnings of sums that were worked out in this stage.
    pub sums: HashMap<Vec<Slot>, Value>,
}

impl<'a, 'f> Emitter<'a, 'f> {
    pub fn new(
        build: &'a mut FunctionBuilder<'f>,
        kernel: &'a Kernel,
        columns: &'a Columns,
        pointer: types::Type,
        [call, look_up]: [FuncRef; 2],
    ) -> Self {
        let entry = build.create_block();
        build.append_block_params_for_function_params(entry);
        build.switch_to_block(entry);
        let memory = build.block_params(entry)[0];
        let mut slots = |index| {
            let offset = offset_of!(Memory, slots) + index * size_of::<*mut f64>();
            build.ins().load(pointer, constant(), memory, offset as i32)
        };
        let slots = std::array::from_fn(&mut slots);
        let [states, rates, ahead] =
            [offset_of!(Memory, states), offset_of!(Memory, rates), offset_of!(Memory, ahead)]
                .map(|offset| build.ins().load(pointer, constant(), memory, offset as i32));
        let values = vec![None; kernel.layout.all];
        Emitter {
            build,
            kernel,
            pointer,
            call,
            look_up,
            memory,
            slots,
            stage: 0,
            states,
            rates,
            columns,
            row: None,
            ahead,
            tried: Vec::new(),
            values,
            sums: HashMap::new(),
        }
    }

    pub fn of_memory(&mut self, of: types::Type, offset: usize) -> Value {
        self.build.ins().load(of, constant(), self.memory, offset as i32)
    }

    pub fn number(&mut self, value: f64) -> Value {
        self.build.ins().f64const(value)
    }

    pub fn load(&mut self, base: Value, index: usize) -> Value {
        self.build.ins().load(types::F64, MemFlagsData::trusted(), base, 8 * index as i32)
    }

    pub fn store(&mut self, value: Value, base: Value, index: usize) {
        self.build.ins().store(MemFlagsData::trusted(), value, base, 8 * index as i32);
    }

    /// The loop over the steps. When a step ends is worked out in the step before it, as that takes long; so is what its first
    /// stage tries.
    pub fn steps(mut self) {
        let kernel = self.kernel;
        let [first, all] = [offset_of!(Memory, first), offset_of!(Memory, count)]
            .map(|offset| self.of_memory(types::I64, offset));
        let row = self.of_memory(self.pointer, offset_of!(Memory, rows));
        let time = self.of_memory(types::F64, offset_of!(Memory, time));
        let zero = self.build.ins().iconst(types::I64, 0);
        let end = self.end_of(zero, first);
        self.row = Some(row);
        let carried = if kernel.rates.len() > MOST_CARRIED { 0 } else { kernel.rates.len() };
        let states: Vec<Value> = (0..carried).map(|index| self.state(index)).collect();
        let rates: Vec<Value> = (0..carried).map(|index| self.rate(index)).collect();
        let tried = self.tried_first([time, end], &states, &rates);
        let start = [&[zero, row, time, end], &tried[..]].concat();
        let head = self.build.create_block();
        for value in &start {
            let of = self.build.func.dfg.value_type(*value);
            self.build.append_block_param(head, of);
        }
        self.jump(head, &start);

        self.build.switch_to_block(head);
        let here: Vec<Value> = self.build.block_params(head).to_vec();
        let [gone, row, time, end] = [here[0], here[1], here[2], here[3]];
        (self.row, self.tried) = (Some(row), here[4..].to_vec());
        let is_done = self.build.ins().icmp(IntCC::UnsignedGreaterThanOrEqual, gone, all);
        let [done, on] = [(); 2].map(|()| self.build.create_block());
        self.build.ins().brif(is_done, done, &[], on, &[]);
        self.build.switch_to_block(on);
        let next = self.build.ins().iadd_imm_s(gone, 1);
        let end_of_next = self.end_of(next, first);
        let next_row = self.build.ins().iadd_imm_s(row, 8 * self.columns.width as i64);
        let [states, rates] = self.step([time, end], next_row);
        let tried = self.tried_first([end, end_of_next], &states, &rates);
        self.jump(head, &[&[next, next_row, end, end_of_next], &tried[..]].concat());
        self.build.switch_to_block(done);
        self.leave();
    }

    fn jump(&mut self, block: Block, values: &[Value]) {
        let values: Vec<_> = values.iter().copied().map(Into::into).collect();
        self.build.ins().jump(block, &values);
    }

    /// What the first stage of a step between two times tries; nothing of many states, which no registers hold.
    fn tried_first(&mut self, [time, end]: [Value; 2], states: &[Value], rates: &[Value]) -> Vec<Value> {
        if states.len() > MOST_CARRIED {
            return Vec::new();
        }
        let length = self.build.ins().fsub(end, time);
        let half = self.half_of(length);
        let pairs = states.iter().zip(rates);
        pairs.map(|(state, rate)| self.build.ins().fma(*rate, half, *state)).collect()
    }

    fn half_of(&mut self, length: Value) -> Value {
        let a_half = self.of_memory(types::F64, offset_of!(Memory, half));
        self.build.ins().fmul(a_half, length)
    }

    /// One step between two times, written down in a row: states and rates at its end.
    fn step(&mut self, [time, end]: [Value; 2], next: Value) -> [Vec<Value>; 2] {
        let (kernel, columns) = (self.kernel, self.columns);
        self.ahead = self.build.ins().iadd_imm_s(next, 8 * columns.scheduled as i64);
        let length = self.build.ins().fsub(end, time);
        let (after, rates, ()) = self.stages([time, length, end], &kernel.quick, |emitter| {
            for (index, slot) in columns.middles.iter().enumerate() {
                emitter.write_down(*slot, next, columns.ends.len() + index);
            }
        });
        for (column, slot) in columns.ends.iter().enumerate() {
            self.write_down(*slot, next, column);
        }
        for (index, rate) in rates.iter().enumerate() {
            self.store(*rate, next, columns.rates + index);
        }
        for (index, slot) in kernel.kept.iter().enumerate() {
            self.write_down(*slot, next, columns.kept + index);
        }
        [after, rates]
    }

    fn write_down(&mut self, slot: Slot, row: Value, column: usize) {
        let value = self.get(slot);
        self.store(value, row, column);
    }

    /// A state where it begins.
    fn state(&mut self, index: usize) -> Value {
        match self.row {
            Some(row) => self.load(row, self.columns.states[index]),
            None => self.load(self.states, index),
        }
    }

    /// Its rate there.
    fn rate(&mut self, index: usize) -> Value {
        match self.row {
            Some(row) => self.load(row, self.columns.rates + index),
            None => self.load(self.rates, index),
        }
    }

    /// A look ahead: 0 where nothing is met, 1 where something comes and goes, else 2.
    pub fn one_look(mut self) {
        let kernel = self.kernel;
        let [time, length, end] =
            [offset_of!(Memory, time), offset_of!(Memory, length), offset_of!(Memory, end)]
                .map(|offset| self.of_memory(types::F64, offset));
        let (after, rates, within) = self.stages([time, length, end], &kernel.thorough, |emitter| {
            emitter.watch(kernel.thorough.in_middle)
        });
        let ahead = self.watch(kernel.thorough.all);
        for (index, state) in after.into_iter().enumerate() {
            self.store(state, self.slots[4], kernel.layout.states + index);
        }
        self.store_end(&rates);
        let two = self.build.ins().iconst(types::I64, 2);
        let otherwise = self.build.ins().uextend(types::I64, within);
        let told = self.build.ins().select(ahead, two, otherwise);
        self.build.ins().return_(&[told]);
    }

    /// Everything at the states and the time in the slots.
    pub fn at_slots(mut self) {
        let kernel = self.kernel;
        self.stage = 4;
        self.run(&kernel.moving);
        self.run(&kernel.thorough.middle);
        self.run(&kernel.thorough.ending);
        self.watch(kernel.thorough.all);
        let rates: Vec<Value> = kernel.rates.iter().map(|slot| self.get(*slot)).collect();
        self.store_end(&rates);
        self.leave();
    }

    /// Writes down what is worked out at an end: rates, what is recorded and followed, what is kept.
    fn store_end(&mut self, rates: &[Value]) {
        let kernel = self.kernel;
        let pointer = self.pointer;
        let rates_ahead = self.of_memory(pointer, offset_of!(Memory, rates_ahead));
        for (index, rate) in rates.iter().enumerate() {
            self.store(*rate, rates_ahead, index);
        }
        let seen = kernel.seen.iter().map(|seen| seen.slot);
        for slot in seen.chain(kernel.followed.iter().chain(&kernel.kept).copied()) {
            let value = self.get(slot);
            self.store(value, self.slots[4], slot as usize);
        }
    }

    /// Leaves code that has nothing to tell.
    fn leave(&mut self) {
        let nothing = self.build.ins().iconst(types::I64, 0);
        self.build.ins().return_(&[nothing]);
    }

    /// The stages of a step to states and rates at its end, with what is checked; the middle is looked at in between.
    fn stages<T>(
        &mut self,
        [time, length, end]: [Value; 3],
        checks: &Checks,
        in_the_middle: impl FnOnce(&mut Self) -> T,
    ) -> (Vec<Value>, Vec<Value>, T) {
        let half = self.half_of(length);
        let middle = self.build.ins().fadd(time, half);
        let second = self.first_stage(half, middle);
        let third = self.stage(1, &second, half, middle);
        let two = self.of_memory(types::F64, offset_of!(Memory, two));
        let a_sixth = self.number(SIXTH);
        let sixth = self.build.ins().fmul(length, a_sixth);
        // All but the last rate, on which everything waits.
        let ways: Vec<Value> = (0..second.len())
            .map(|index| {
                let inner = self.build.ins().fadd(second[index], third[index]);
                let [state, rate] = [self.state(index), self.rate(index)];
                let rates = self.build.ins().fma(inner, two, rate);
                self.build.ins().fma(rates, sixth, state)
            })
            .collect();
        self.run(&checks.middle);
        let seen = in_the_middle(self);
        let fourth = self.stage(2, &third, length, end);
        let pairs = fourth.into_iter().zip(ways);
        let after: Vec<Value> = pairs.map(|(rate, way)| self.build.ins().fma(rate, sixth, way)).collect();
        let rates = self.evaluate(3, &after, end);
        self.run(&checks.middle);
        self.run(&checks.ending);
        (after, rates, seen)
    }

    /// When a step ends: as [`Steps::end_of`] tells it.
    fn end_of(&mut self, index: Value, first: Value) -> Value {
        let number = self.build.ins().iadd(first, index);
        let number = self.build.ins().fcvt_from_sint(types::F64, number);
        let [begin, step, per_second] =
            [offset_of!(Memory, begin), offset_of!(Memory, step), offset_of!(Memory, per_second)]
                .map(|offset| self.of_memory(types::F64, offset));
        let times = self.build.ins().fmul(number, step);
        let time = self.build.ins().fdiv(times, per_second);
        self.build.ins().fadd(begin, time)
    }

    /// The rates of the first stage.
    fn first_stage(&mut self, half: Value, middle: Value) -> Vec<Value> {
        if self.tried.is_empty() {
            let rates: Vec<Value> = (0..self.kernel.rates.len()).map(|index| self.rate(index)).collect();
            return self.stage(0, &rates, half, middle);
        }
        let tried = std::mem::take(&mut self.tried);
        self.evaluate(0, &tried, middle)
    }

    /// The rates of a stage that stands some length of the way along rates.
    fn stage(&mut self, stage: usize, rates: &[Value], length: Value, time: Value) -> Vec<Value> {
        let trial: Vec<Value> = (0..rates.len())
            .map(|index| {
                let state = self.state(index);
                self.build.ins().fma(rates[index], length, state)
            })
            .collect();
        self.evaluate(stage, &trial, time)
    }

    fn evaluate(&mut self, stage: usize, states: &[Value], time: Value) -> Vec<Value> {
        let kernel = self.kernel;
        self.stage = stage;
        self.values.fill(None);
        self.sums.clear();
        for (index, state) in states.iter().enumerate() {
            self.values[kernel.layout.states + index] = Some(*state);
        }
        self.values[kernel.layout.time] = Some(time);
        let scheduled = kernel.scheduled.len();
        for index in 0..scheduled {
            let place = if stage < 2 { index } else { scheduled + index };
            self.values[kernel.layout.scheduled + index] = Some(self.load(self.ahead, place));
        }
        self.run(&kernel.moving);
        let rates = kernel.rates.iter().map(|slot| self.get(*slot)).collect();
        self.stage = 4;
        rates
    }
}

/// Of memory that nothing changes while the code runs.
pub(super) fn constant() -> MemFlagsData {
    MemFlagsData::trusted().with_readonly()
}
