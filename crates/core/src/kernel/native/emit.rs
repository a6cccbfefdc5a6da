//! Emits the code of steps and of look-aheads.
//!
//! The code has three functions: the loop over steps, the look-ahead, and the evaluation at the slots. All of them get
//! the address of a `Memory` and emit the same stages. A stage computes the rates from given states and a time;
//! `values` has what is known in it.
//!
//! The processor has to wait for the last rate of a step. So everything that does not depend on it is emitted before.

use std::collections::HashMap;
use std::mem::offset_of;

use cranelift_codegen::ir::condcodes::IntCC;
use cranelift_codegen::ir::{Block, FuncRef, InstBuilder, MemFlagsData, Value, types};
use cranelift_frontend::FunctionBuilder;

use super::super::code::Slot;
use super::super::rows::RowLayout;
use super::super::step::SIXTH;
use super::super::{Checks, Kernel};
use super::Memory;
use crate::parabola::LEAST_SLOPES;

/// Maximum number of states that are kept in registers from step to step.
const MAX_CARRIED: usize = 4;

/// Emits the code of a kernel.
pub(super) struct Emitter<'a, 'f> {
    /// The builder of the function.
    pub build: &'a mut FunctionBuilder<'f>,
    /// The kernel whose operations are emitted.
    pub kernel: &'a Kernel,
    /// The type of an address.
    pub pointer: types::Type,
    /// The helper for functions.
    pub call: FuncRef,
    /// The helper for tables.
    pub look_up: FuncRef,
    /// The argument of the function: the address of its memory.
    pub memory: Value,
    /// The base address of the slots, once per stage and once for the end.
    pub slots: [Value; 5],
    /// Index of the stage whose base address is used.
    pub stage: usize,
    /// The base address of the states at the beginning of a look-ahead.
    pub states: Value,
    /// The base address of the rates of these states.
    pub rates: Value,
    /// The layout of the rows.
    pub columns: &'a RowLayout,
    /// The row in which the present step begins; `None` outside of steps.
    pub row: Option<Value>,
    /// The base address of the values of tables of time, in the middle and at the end of the step.
    scheduled: Value,
    /// The states of the first stage, computed in the step before from values that are still in registers. Empty if
    /// there are many states.
    first_trial: Vec<Value>,
    /// The values of the slots that were computed or loaded in this stage.
    pub values: Vec<Option<Value>>,
    /// The beginnings of sums that were computed in this stage.
    pub sums: HashMap<Vec<Slot>, Value>,
}

impl<'a, 'f> Emitter<'a, 'f> {
    /// Begins a function: loads the addresses that every stage needs. No slot has a known value yet.
    pub(super) fn new(
        build: &'a mut FunctionBuilder<'f>,
        kernel: &'a Kernel,
        columns: &'a RowLayout,
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
        let [states, rates, scheduled] =
            [offset_of!(Memory, states), offset_of!(Memory, rates), offset_of!(Memory, scheduled)]
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
            scheduled,
            first_trial: Vec::new(),
            values,
            sums: HashMap::new(),
        }
    }

    /// Loads a field of the memory by its offset. The field does not change while the code runs.
    pub(super) fn of_memory(&mut self, of: types::Type, offset: usize) -> Value {
        self.build.ins().load(of, constant(), self.memory, offset as i32)
    }

    /// A number as a constant of the code.
    pub(super) fn number(&mut self, value: f64) -> Value {
        self.build.ins().f64const(value)
    }

    /// Loads a number from a list of doubles, by its index.
    pub(super) fn load(&mut self, base: Value, index: usize) -> Value {
        self.build.ins().load(types::F64, MemFlagsData::trusted(), base, 8 * index as i32)
    }

    /// Stores a number into a list of doubles, by its index.
    pub(super) fn store(&mut self, value: Value, base: Value, index: usize) {
        self.build.ins().store(MemFlagsData::trusted(), value, base, 8 * index as i32);
    }

    /// The loop over the steps. Its variables are the number of steps taken, the row, the time and the end of the step,
    /// and the states of its first stage. The end of a step and the states of its first stage are computed one step
    /// earlier, because they take long.
    pub(super) fn steps(mut self) {
        let kernel = self.kernel;
        let [first, all] = [offset_of!(Memory, first), offset_of!(Memory, count)]
            .map(|offset| self.of_memory(types::I64, offset));
        let row = self.of_memory(self.pointer, offset_of!(Memory, rows));
        let time = self.of_memory(types::F64, offset_of!(Memory, time));
        let zero = self.build.ins().iconst(types::I64, 0);
        let end = self.end_of(zero, first);
        self.row = Some(row);
        let carried = if kernel.rates.len() > MAX_CARRIED { 0 } else { kernel.rates.len() };
        let states: Vec<Value> = (0..carried).map(|index| self.state(index)).collect();
        let rates: Vec<Value> = (0..carried).map(|index| self.rate(index)).collect();
        let first_trial = self.first_trial_states([time, end], &states, &rates);
        let start = [&[zero, row, time, end], &first_trial[..]].concat();
        let head = self.build.create_block();
        for value in &start {
            let of = self.build.func.dfg.value_type(*value);
            self.build.append_block_param(head, of);
        }
        self.jump(head, &start);

        self.build.switch_to_block(head);
        let here: Vec<Value> = self.build.block_params(head).to_vec();
        let [taken, row, time, end] = [here[0], here[1], here[2], here[3]];
        (self.row, self.first_trial) = (Some(row), here[4..].to_vec());
        let is_done = self.build.ins().icmp(IntCC::UnsignedGreaterThanOrEqual, taken, all);
        let [done, on] = [(); 2].map(|()| self.build.create_block());
        self.build.ins().brif(is_done, done, &[], on, &[]);
        self.build.switch_to_block(on);
        let next = self.build.ins().iadd_imm_s(taken, 1);
        let end_of_next = self.end_of(next, first);
        let next_row = self.build.ins().iadd_imm_s(row, 8 * self.columns.width as i64);
        let [states, rates] = self.step([time, end], next_row);
        let first_trial = self.first_trial_states([end, end_of_next], &states, &rates);
        self.jump(head, &[&[next, next_row, end, end_of_next], &first_trial[..]].concat());
        self.build.switch_to_block(done);
        self.return_zero();
    }

    /// Jumps to a block with arguments: the values of its variables.
    fn jump(&mut self, block: Block, values: &[Value]) {
        let values: Vec<_> = values.iter().copied().map(Into::into).collect();
        self.build.ins().jump(block, &values);
    }

    /// The states of the first stage of a step; empty if there are too many states for registers.
    fn first_trial_states(
        &mut self,
        [time, end]: [Value; 2],
        states: &[Value],
        rates: &[Value],
    ) -> Vec<Value> {
        if states.len() > MAX_CARRIED {
            return Vec::new();
        }
        let length = self.build.ins().fsub(end, time);
        let half = self.half_of(length);
        let pairs = states.iter().zip(rates);
        pairs.map(|(state, rate)| self.build.ins().fma(*rate, half, *state)).collect()
    }

    /// Half of a length. The constant is read from memory, which is faster than to build it.
    fn half_of(&mut self, length: Value) -> Value {
        let a_half = self.of_memory(types::F64, offset_of!(Memory, half));
        self.build.ins().fmul(a_half, length)
    }

    /// One step, which is written to a row. Returns the states and rates at its end.
    fn step(&mut self, [time, end]: [Value; 2], next: Value) -> [Vec<Value>; 2] {
        let (kernel, columns) = (self.kernel, self.columns);
        self.scheduled = self.build.ins().iadd_imm_s(next, 8 * columns.scheduled as i64);
        let length = self.build.ins().fsub(end, time);
        let mut sums: Vec<Value> = Vec::new();
        let (after, rates) = self.stages([time, length, end], &kernel.quick, |emitter, stage| {
            let followed: Vec<Value> =
                kernel.followed.iter().map(|followed| emitter.get(followed.slot)).collect();
            if stage == 1 {
                let pairs = sums.iter().zip(followed);
                sums = pairs.map(|(first, second)| emitter.build.ins().fadd(*first, second)).collect();
                return;
            }
            sums = followed;
            for (index, slot) in columns.firsts.iter().enumerate() {
                emitter.write(*slot, next, columns.ends.len() + index);
            }
        });
        for (column, slot) in columns.ends.iter().enumerate() {
            self.write(*slot, next, column);
        }
        self.write_parabolas(&sums, next);
        for (index, rate) in rates.iter().enumerate() {
            self.store(*rate, next, columns.rates + index);
        }
        for (index, slot) in kernel.sampled.iter().enumerate() {
            self.write(*slot, next, columns.sampled + index);
        }
        [after, rates]
    }

    /// Writes the control point of every followed voltage that has an interval, and for the others the number that is
    /// negative if they may turn. `sums` are the sums of the voltages at the first two stages.
    fn write_parabolas(&mut self, sums: &[Value], row: Value) {
        let (kernel, columns) = (self.kernel, self.columns);
        for (index, (followed, sum)) in kernel.followed.iter().zip(sums).enumerate() {
            let [begin, end] = [followed.begin, followed.slot].map(|slot| self.get(slot));
            let both = self.build.ins().fadd(begin, end);
            let minus_half = self.number(-0.5);
            let mut tested = self.build.ins().fma(both, minus_half, *sum);
            if index >= kernel.curved_intervals {
                let before = self.build.ins().fsub(tested, begin);
                let after = self.build.ins().fsub(end, tested);
                let slopes = self.build.ins().fmul(before, after);
                let rise = self.build.ins().fsub(end, begin);
                let square = self.build.ins().fmul(rise, rise);
                let share = self.number(-LEAST_SLOPES);
                tested = self.build.ins().fma(square, share, slopes);
            }
            self.store(tested, row, columns.followed.start + index);
        }
    }

    /// Stores the value of a slot into a column of a row. It is that of the present stage.
    fn write(&mut self, slot: Slot, row: Value, column: usize) {
        let value = self.get(slot);
        self.store(value, row, column);
    }

    /// A state at the beginning of the step: from the row, or from the frame for a look-ahead.
    fn state(&mut self, index: usize) -> Value {
        match self.row {
            Some(row) => self.load(row, self.columns.states[index]),
            None => self.load(self.states, index),
        }
    }

    /// The rate of a state at the beginning of the step: from the row, or from the frame for a look-ahead.
    fn rate(&mut self, index: usize) -> Value {
        match self.row {
            Some(row) => self.load(row, self.columns.rates + index),
            None => self.load(self.rates, index),
        }
    }

    /// A look-ahead. It returns 1 if a watch is hit at its end, otherwise 0.
    pub(super) fn one_look(mut self) {
        let kernel = self.kernel;
        let [time, length, end] =
            [offset_of!(Memory, time), offset_of!(Memory, length), offset_of!(Memory, end)]
                .map(|offset| self.of_memory(types::F64, offset));
        let (after, rates) =
            self.stages([time, length, end], &kernel.thorough, |emitter, stage| emitter.store_inner(stage));
        let is_hit_at_end = self.watch(kernel.thorough.all, offset_of!(Memory, margins));
        for (index, state) in after.into_iter().enumerate() {
            self.store(state, self.slots[4], kernel.layout.states + index);
        }
        self.store_end(&rates);
        let result = self.build.ins().uextend(types::I64, is_hit_at_end);
        self.build.ins().return_(&[result]);
    }

    /// Evaluates everything at the states and the time in the slots.
    pub(super) fn at_slots(mut self) {
        let kernel = self.kernel;
        self.stage = 4;
        self.run(&kernel.moving);
        self.run(&kernel.thorough.first);
        self.run(&kernel.thorough.ending);
        self.watch(kernel.thorough.all, offset_of!(Memory, margins));
        let rates: Vec<Value> = kernel.rates.iter().map(|slot| self.get(*slot)).collect();
        self.store_end(&rates);
        self.return_zero();
    }

    /// Stores the results of an end into the frame: rates, recorded and tracked voltages, and sampled values. The other
    /// slots keep old values, which nothing reads.
    fn store_end(&mut self, rates: &[Value]) {
        let kernel = self.kernel;
        let pointer = self.pointer;
        let end_rates = self.of_memory(pointer, offset_of!(Memory, end_rates));
        for (index, rate) in rates.iter().enumerate() {
            self.store(*rate, end_rates, index);
        }
        let recorded = kernel.recorded.iter().map(|recorded| recorded.slot);
        for slot in recorded.chain(kernel.tracked.iter().chain(&kernel.sampled).copied()) {
            let value = self.get(slot);
            self.store(value, self.slots[4], slot as usize);
        }
    }

    /// Returns from code without a result.
    fn return_zero(&mut self) {
        let nothing = self.build.ins().iconst(types::I64, 0);
        self.build.ins().return_(&[nothing]);
    }

    /// The four stages of a step with its tests. Returns the states and rates at its end.
    ///
    /// The order is: stages 0 and 1, the part of the end that they determine, stage 2. The evaluation at the end (stage
    /// 3) follows with its tests. `within` is called for each of the stages 0 and 1, when what is tested there is known.
    fn stages(
        &mut self,
        [time, length, end]: [Value; 3],
        checks: &Checks,
        mut within: impl FnMut(&mut Self, usize),
    ) -> (Vec<Value>, Vec<Value>) {
        let half = self.half_of(length);
        let middle = self.build.ins().fadd(time, half);
        let second = self.first_stage(half, middle);
        self.run(&checks.first);
        within(self, 0);
        let third = self.stage(1, &second, half, middle);
        self.run(&checks.second);
        within(self, 1);
        let two = self.of_memory(types::F64, offset_of!(Memory, two));
        let a_sixth = self.number(SIXTH);
        let sixth = self.build.ins().fmul(length, a_sixth);
        // Everything except the last rate, which is ready last.
        let partials: Vec<Value> = (0..second.len())
            .map(|index| {
                let inner = self.build.ins().fadd(second[index], third[index]);
                let [state, rate] = [self.state(index), self.rate(index)];
                let rates = self.build.ins().fma(inner, two, rate);
                self.build.ins().fma(rates, sixth, state)
            })
            .collect();
        let fourth = self.stage(2, &third, length, end);
        let pairs = fourth.into_iter().zip(partials);
        let after: Vec<Value> =
            pairs.map(|(rate, partial)| self.build.ins().fma(rate, sixth, partial)).collect();
        let rates = self.evaluate(3, &after, end);
        self.run(&checks.first);
        self.run(&checks.ending);
        (after, rates)
    }

    /// The time at which a step ends, as in [`Steps::end_of`](super::super::Steps::end_of).
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

    /// The rates of the first stage. Its states may be known from the step before.
    fn first_stage(&mut self, half: Value, middle: Value) -> Vec<Value> {
        if self.first_trial.is_empty() {
            let rates: Vec<Value> = (0..self.kernel.rates.len()).map(|index| self.rate(index)).collect();
            return self.stage(0, &rates, half, middle);
        }
        let first_trial = std::mem::take(&mut self.first_trial);
        self.evaluate(0, &first_trial, middle)
    }

    /// The rates of a stage at a distance `length` along other rates: f(x + length x rates) at a time.
    fn stage(&mut self, stage: usize, rates: &[Value], length: Value, time: Value) -> Vec<Value> {
        let trial: Vec<Value> = (0..rates.len())
            .map(|index| {
                let state = self.state(index);
                self.build.ins().fma(rates[index], length, state)
            })
            .collect();
        self.evaluate(stage, &trial, time)
    }

    /// Evaluates the rates at these states and this time, as one stage of a step. Everything that the stage before has
    /// computed is discarded. Tables of time have their value in the middle for stages 0 and 1, and at the end
    /// otherwise.
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
            let position = if stage < 2 { index } else { scheduled + index };
            self.values[kernel.layout.scheduled + index] = Some(self.load(self.scheduled, position));
        }
        self.run(&kernel.moving);
        let rates = kernel.rates.iter().map(|slot| self.get(*slot)).collect();
        self.stage = 4;
        rates
    }
}

/// Flags for memory that does not change while the code runs.
pub(super) fn constant() -> MemFlagsData {
    MemFlagsData::trusted().with_readonly()
}
