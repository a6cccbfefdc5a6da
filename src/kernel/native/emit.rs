//! The code of steps and of looks ahead.

use std::collections::HashMap;
use std::mem::offset_of;

use cranelift_codegen::ir::condcodes::IntCC;
use cranelift_codegen::ir::{Block, FuncRef, InstBuilder, MemFlagsData, Value, types};
use cranelift_frontend::FunctionBuilder;

use super::super::code::Slot;
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
    /// Of a step, a few of both that are at hand.
    carried: Vec<[Value; 2]>,
    /// The values of the slots that were worked out or loaded in this stage.
    pub values: Vec<Option<Value>>,
    /// The beginnings of sums that were worked out in this stage.
    pub sums: HashMap<Vec<Slot>, Value>,
    /// Where the code goes when something is met.
    pub met: Block,
}

impl<'a, 'f> Emitter<'a, 'f> {
    pub fn new(
        build: &'a mut FunctionBuilder<'f>,
        kernel: &'a Kernel,
        pointer: types::Type,
        [call, look_up]: [FuncRef; 2],
    ) -> Self {
        let entry = build.create_block();
        build.append_block_params_for_function_params(entry);
        build.switch_to_block(entry);
        let memory = build.block_params(entry)[0];
        let met = build.create_block();
        let mut slots = |index| {
            let offset = offset_of!(Memory, slots) + index * size_of::<*mut f64>();
            build.ins().load(pointer, constant(), memory, offset as i32)
        };
        let slots = std::array::from_fn(&mut slots);
        let [states, rates] = [offset_of!(Memory, states), offset_of!(Memory, rates)]
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
            carried: Vec::new(),
            values,
            sums: HashMap::new(),
            met,
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

    /// The loop over the steps. When a step ends is worked out in the step before it, as that takes long. A few states and
    /// rates are carried in registers; more stand in memory.
    pub fn steps(mut self) {
        let [first, all] = [offset_of!(Memory, first), offset_of!(Memory, count)]
            .map(|offset| self.of_memory(types::I64, offset));
        let states = if self.kernel.rates.len() > MOST_CARRIED { 0 } else { self.kernel.rates.len() };
        let zero = self.build.ins().iconst(types::I64, 0);
        // Written when the code is left.
        let time = self.load(self.memory, offset_of!(Memory, time) / 8);
        let mut start = vec![zero, time];
        for index in 0..states {
            start.extend([self.states, self.rates].map(|base| self.load(base, index)));
        }
        let head = self.build.create_block();
        for block in [self.met, head] {
            for value in &start {
                let of = self.build.func.dfg.value_type(*value);
                self.build.append_block_param(block, of);
            }
        }
        self.build.append_block_param(head, types::F64);
        let end = self.end_of(zero, first);
        self.jump(head, &[&start[..], &[end]].concat());

        self.build.switch_to_block(head);
        let mut here: Vec<Value> = self.build.block_params(head).to_vec();
        let end = here.pop().expect("the end of the step comes last");
        let next = self.build.ins().iadd_imm_s(here[0], 1);
        let is_done = self.build.ins().icmp(IntCC::UnsignedGreaterThanOrEqual, here[0], all);
        self.leave_if(is_done, &here);
        let after_next = self.end_of(next, first);
        let carried = self.step(&here, end);
        self.jump(head, &[&[next, end], &carried[..], &[after_next]].concat());

        self.build.switch_to_block(self.met);
        let left: Vec<Value> = self.build.block_params(self.met).to_vec();
        let offset = offset_of!(Memory, time) as i32;
        self.build.ins().store(MemFlagsData::trusted(), left[1], self.memory, offset);
        for (index, carried) in left[2..].chunks(2).enumerate() {
            self.store(carried[0], self.states, index);
            self.store(carried[1], self.rates, index);
        }
        self.build.ins().return_(&[left[0]]);
    }

    fn jump(&mut self, block: Block, values: &[Value]) {
        let values: Vec<_> = values.iter().copied().map(Into::into).collect();
        self.build.ins().jump(block, &values);
    }

    /// Leaves the code with what stands at the beginning of the step, if something holds.
    pub fn leave_if(&mut self, holds: Value, here: &[Value]) {
        let next = self.build.create_block();
        let here: Vec<_> = here.iter().copied().map(Into::into).collect();
        self.build.ins().brif(holds, self.met, &here, next, &[]);
        self.build.switch_to_block(next);
    }

    /// One step, from its number, its time and what is carried, to what is carried on from its end.
    fn step(&mut self, here: &[Value], end: Value) -> Vec<Value> {
        let kernel = self.kernel;
        let time = here[1];
        self.carried = here[2..].chunks(2).map(|pair| [pair[0], pair[1]]).collect();
        let length = self.build.ins().fsub(end, time);
        let (after, rates, ()) = self.stages([time, length, end], &kernel.quick, |emitter| {
            emitter.leave_beyond_fences(kernel.quick.in_middle, here);
        });
        self.leave_beyond_fences(kernel.quick.all, here);
        self.see(end);
        self.keep();
        if self.carried.is_empty() {
            for index in 0..after.len() {
                self.store(after[index], self.states, index);
                self.store(rates[index], self.rates, index);
            }
            return Vec::new();
        }
        after.into_iter().zip(rates).flat_map(|(state, rate)| [state, rate]).collect()
    }

    /// A state at the beginning of the step.
    fn state(&mut self, index: usize) -> Value {
        match self.carried.get(index) {
            Some([state, _]) => *state,
            None => self.load(self.states, index),
        }
    }

    /// Its rate there.
    fn rate(&mut self, index: usize) -> Value {
        match self.carried.get(index) {
            Some([_, rate]) => *rate,
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
        self.leave_with(0);
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
        self.jump(self.met, &[]);
        self.leave_with(0);
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

    /// The block in which the code is left with a number.
    fn leave_with(&mut self, number: i64) {
        self.build.switch_to_block(self.met);
        let number = self.build.ins().iconst(types::I64, number);
        self.build.ins().return_(&[number]);
    }

    /// The stages of a step to states and rates at its end, with what is checked; the middle is looked at in between.
    fn stages<T>(
        &mut self,
        [time, length, end]: [Value; 3],
        checks: &Checks,
        in_the_middle: impl FnOnce(&mut Self) -> T,
    ) -> (Vec<Value>, Vec<Value>, T) {
        let kernel = self.kernel;
        let a_half = self.of_memory(types::F64, offset_of!(Memory, half));
        let half = self.build.ins().fmul(a_half, length);
        let middle = self.build.ins().fadd(time, half);
        let rates: Vec<Value> = (0..kernel.rates.len()).map(|index| self.rate(index)).collect();
        let second = self.stage(0, &rates, half, middle);
        let third = self.stage(1, &second, half, middle);
        let two = self.of_memory(types::F64, offset_of!(Memory, two));
        // All but the last rate, on which everything waits.
        let sums: Vec<Value> = (0..rates.len())
            .map(|index| {
                let inner = self.build.ins().fadd(second[index], third[index]);
                let rate = self.rate(index);
                self.build.ins().fma(inner, two, rate)
            })
            .collect();
        self.run(&checks.middle);
        let seen = in_the_middle(self);
        let fourth = self.stage(2, &third, length, end);
        let six = self.number(6.0);
        let sixth = self.build.ins().fdiv(length, six);
        let after: Vec<Value> = (0..sums.len())
            .map(|index| {
                let rate = self.build.ins().fadd(sums[index], fourth[index]);
                let state = self.state(index);
                // Rounded before it is added: straight lines stay exact.
                let way = self.build.ins().fmul(rate, sixth);
                self.build.ins().fadd(state, way)
            })
            .collect();
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
