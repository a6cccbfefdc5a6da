//! The interface that element laws are written against.
//!
//! A law reads inputs and settings of its element and emits operations. [`Builder`] has the methods that the lowering
//! implements because they need the circuit. The operations themselves are methods of `dyn Builder`, so laws are
//! ordinary functions without type parameters.

use std::collections::HashMap;
use std::sync::Arc;

use super::{
    ChatterRemedy, Delay, Distribution, Guard, Level, Mode, ModeHandle, Noise, Op, Program, Register,
    SampledValue, State, TimeConstant, Timetable, Transition,
};
use crate::machines::REFERENCE;
use patchcord_expr::Function;

/// Mode of an integrator between its limits. At a limit, the mode is the sign of the limit.
const FREE: f64 = 0.0;

/// A program under construction, with the element whose law is being emitted.
pub struct Draft {
    /// The program so far. The sections of its body are not sorted yet.
    pub(crate) program: Program,
    /// Index of the element whose law is being emitted.
    pub(crate) current: usize,
    /// For every operation of the body, the index of the element whose law emitted it.
    pub(crate) owners: Vec<usize>,
    /// The output register of every element; `None` before its output law has run.
    pub(crate) outputs: Vec<Option<Register>>,
    /// Index of the state of each element that has one.
    pub(crate) own_state: HashMap<usize, u32>,
    /// The first mode of each element that has one.
    pub(crate) own_mode: HashMap<usize, ModeHandle>,
    /// Index of the delay line of each element that has one.
    own_delay: HashMap<usize, u32>,
    /// Index of the sampled value of each element that has one.
    own_memory: HashMap<usize, u32>,
    /// The register of each number, by its bits, so that equal numbers are emitted once.
    constants: HashMap<u64, Register>,
}

impl Draft {
    /// A draft of the program for this many elements.
    pub(crate) fn new(program: Program, elements: usize) -> Self {
        Draft {
            program,
            current: 0,
            owners: Vec::new(),
            outputs: vec![None; elements],
            own_state: HashMap::new(),
            own_mode: HashMap::new(),
            own_delay: HashMap::new(),
            own_memory: HashMap::new(),
            constants: HashMap::new(),
        }
    }
}

/// What a law can read of its element. The operations that a law can emit are methods of `dyn Builder`.
pub trait Builder {
    /// The program under construction.
    fn draft(&self) -> &Draft;

    /// The program under construction.
    fn draft_mut(&mut self) -> &mut Draft;

    /// Gain and voltage of every cord into an input of the element, in the order of the document.
    fn driven(&self, input: &str) -> Vec<(f64, Register)>;

    /// Index of the coefficient of a setting. `None` if the patch omits the setting and it has no default.
    fn coefficient(&mut self, setting: &str) -> Option<u32>;

    /// A setting that is a list of points; empty if the patch omits it.
    fn points(&self, setting: &str) -> Vec<[f64; 2]>;

    /// A setting that is true or false.
    fn flag(&self, setting: &str) -> bool;

    /// The word chosen by a setting; by default the first one.
    fn choice(&self, setting: &str) -> &'static str;

    /// Register with the volts per unit of a drive's scale, for values that are not formulas.
    fn volts_per_signal(&mut self) -> Register;

    /// Whether the element is a drive.
    fn is_drive(&self) -> bool;
}

/// Methods that read inputs and settings.
impl dyn Builder + '_ {
    /// The voltages at an input without gains, in the order of the document.
    pub fn inputs(&mut self, name: &str) -> Vec<Register> {
        self.driven(name).into_iter().map(|(_, register)| register).collect()
    }

    /// The voltage at an input with one jack; 0 V if nothing is plugged in.
    pub fn input(&mut self, name: &str) -> Register {
        match self.inputs(name).first() {
            Some(register) => *register,
            None => self.constant(0.0),
        }
    }

    /// Whether anything is plugged into an input.
    pub fn is_driven(&self, name: &str) -> bool {
        !self.driven(name).is_empty()
    }

    /// The sum of the voltages at an input, each times its gain.
    pub fn sum(&mut self, name: &str) -> Register {
        let mut total = None;
        for (gain, register) in self.driven(name) {
            let term = self.scaled(register, gain);
            total = Some(total.map_or(term, |total| self.add(total, term)));
        }
        total.unwrap_or_else(|| self.constant(0.0))
    }

    /// gain x register; the register itself if the gain is 1.
    fn scaled(&mut self, register: Register, gain: f64) -> Register {
        if gain == 1.0 {
            return register;
        }
        let gain = self.constant(gain);
        self.multiply(gain, register)
    }

    /// The value of a setting, or its default if the patch omits it.
    pub fn get(&mut self, name: &str) -> Register {
        self.optional(name).expect("required settings and settings with a default have a value")
    }

    /// The value of a setting without a default; `None` if the patch omits it.
    pub fn optional(&mut self, name: &str) -> Option<Register> {
        let index = self.coefficient(name)?;
        Some(self.emit(Op::Coefficient(index)))
    }

    /// Index of the coefficient of a setting that is required or has a default.
    fn required(&mut self, name: &str) -> u32 {
        self.coefficient(name).expect("required settings and settings with a default have a value")
    }

    /// Appends an operation of the current element to the body.
    pub(crate) fn emit(&mut self, op: Op) -> Register {
        let draft = self.draft_mut();
        draft.program.lowered_mut().body.push(op);
        draft.owners.push(draft.current);
        Register(draft.program.lowered.body.len() as u32 - 1)
    }
}

/// Methods that emit operations.
impl dyn Builder + '_ {
    /// A fixed number. Equal numbers share a register.
    pub fn constant(&mut self, value: f64) -> Register {
        if let Some(register) = self.draft().constants.get(&value.to_bits()) {
            return *register;
        }
        let register = self.emit(Op::Constant(value));
        self.draft_mut().constants.insert(value.to_bits(), register);
        register
    }

    /// Problem time in seconds.
    pub fn time(&mut self) -> Register {
        self.emit(Op::Time)
    }

    /// a + b.
    pub fn add(&mut self, a: Register, b: Register) -> Register {
        self.emit(Op::Add(a, b))
    }

    /// a - b.
    pub fn subtract(&mut self, a: Register, b: Register) -> Register {
        self.emit(Op::Subtract(a, b))
    }

    /// -a.
    pub fn negate(&mut self, a: Register) -> Register {
        let zero = self.constant(0.0);
        self.emit(Op::Subtract(zero, a))
    }

    /// a times b.
    pub fn multiply(&mut self, a: Register, b: Register) -> Register {
        self.emit(Op::Multiply(a, b))
    }

    /// a divided by b.
    pub fn divide(&mut self, a: Register, b: Register) -> Register {
        self.emit(Op::Divide(a, b))
    }

    /// The smaller of two values.
    pub fn minimum(&mut self, a: Register, b: Register) -> Register {
        self.emit(Op::Minimum(a, b))
    }

    /// The larger of two values.
    pub fn maximum(&mut self, a: Register, b: Register) -> Register {
        self.emit(Op::Maximum(a, b))
    }

    /// The absolute value.
    pub fn absolute(&mut self, a: Register) -> Register {
        self.emit(Op::Absolute(a))
    }

    /// `then` if left >= right, otherwise `otherwise`.
    pub fn select(
        &mut self,
        left: Register,
        right: Register,
        then: Register,
        otherwise: Register,
    ) -> Register {
        self.emit(Op::Select { left, right, then, otherwise })
    }

    /// A function of one number.
    pub fn call(&mut self, function: Function, a: Register) -> Register {
        self.emit(Op::Call(function, a, a))
    }

    /// The largest whole number that is not above a.
    pub fn floor(&mut self, a: Register) -> Register {
        self.call(Function::Floor, a)
    }

    /// Looks up a table of points at a voltage: straight lines between the points, constant outside.
    pub fn look_up(&mut self, points: Vec<[f64; 2]>, at: Register) -> Register {
        let table = self.new_table(points);
        let element = self.draft().current;
        self.draft_mut().program.lowered_mut().curves.push((element, table));
        self.emit(Op::Table(table as u32, at))
    }

    /// Adds a table of points and returns its index.
    fn new_table(&mut self, points: Vec<[f64; 2]>) -> usize {
        let tables = Arc::make_mut(&mut self.draft_mut().program.tables);
        tables.push(points);
        tables.len() - 1
    }

    /// Looks up a setting of points at time: straight lines between the points, constant outside. No step reaches
    /// across a point.
    pub fn linear_time_table(&mut self, name: &str) -> Register {
        let table = self.new_timetable(name, true);
        let time = self.time();
        self.emit(Op::Table(table as u32, time))
    }

    /// Looks up a setting of points at time. Each value stays until the next point; before the first point, the first
    /// value applies.
    pub fn stepped_time_table(&mut self, name: &str) -> Register {
        let table = self.new_timetable(name, false);
        self.level(Level::Points { table })
    }

    /// Adds a table that is looked up at time, from a setting of points.
    fn new_timetable(&mut self, name: &str, is_straight: bool) -> usize {
        let table = self.new_table(self.points(name));
        let draft = self.draft_mut();
        let element = draft.current;
        draft.program.lowered_mut().timetables.push(Timetable { element, table, is_straight });
        table
    }

    /// Adds a level and emits the operation that reads it.
    fn level(&mut self, level: Level) -> Register {
        let levels = &mut self.draft_mut().program.lowered_mut().levels;
        levels.push(level);
        let index = levels.len() as u32 - 1;
        self.emit(Op::Level(index))
    }

    /// Adds a state to the current element. A setting is its initial voltage.
    pub fn new_state(&mut self, initial: &str) -> Register {
        let initial = self.required(initial);
        let draft = self.draft_mut();
        let (element, index, unset) = (draft.current, draft.program.lowered.states.len() as u32, Register(0));
        let state = State { element, rate: unset, demand: unset, limits: [unset; 2], initial, lag: None };
        draft.program.lowered_mut().states.push(state);
        draft.own_state.insert(element, index);
        self.emit(Op::State(index))
    }

    /// Index of the current element's state.
    pub(super) fn own_state(&self) -> u32 {
        *self.draft().own_state.get(&self.draft().current).expect("the element's output law makes its state")
    }

    /// The output of the current element, for its memory law.
    pub fn own_output(&self) -> Register {
        self.draft().outputs[self.draft().current].expect("the output law comes before the memory law")
    }

    /// A setting that is the time constant of the current element's state. No step may be longer.
    pub fn time_constant(&mut self, name: &str) -> Register {
        let (time, problem_seconds) = (self.required(name), 1.0 / self.draft().program.lowered.time_scale);
        let index = self.own_state() as usize;
        self.draft_mut().program.lowered_mut().states[index].lag =
            Some(TimeConstant { time, problem_seconds });
        self.emit(Op::Coefficient(time))
    }

    /// Sets the rate of the current element's state, in volts per machine second.
    ///
    /// At ±100 V the state is held while its rate points outward. This is a mode of the element, so the solver locates
    /// the instants at which it begins and ends.
    pub fn set_rate(&mut self, rate: Register) {
        self.set_limited_rate(rate, [None, None]);
    }

    /// The same with a lower and an upper limit, which apply if they are within ±100 V.
    pub fn set_limited_rate(&mut self, rate: Register, [lower, upper]: [Option<Register>; 2]) {
        let demand = self.scaled(rate, self.draft().program.lowered.time_scale);
        let (held, zero, half) = (self.new_mode(FREE), self.constant(0.0), self.constant(0.5));
        let (least, most) = (self.constant(-REFERENCE), self.constant(REFERENCE));
        let lower = lower.map_or(least, |lower| self.maximum(lower, least));
        let upper = upper.map_or(most, |upper| self.minimum(upper, most));
        for (sign, limit) in [(1.0, upper), (-1.0, lower)] {
            self.limit(held, sign, limit, demand);
        }
        let size = self.absolute(held.value);
        let rate = self.select(size, half, zero, demand);
        let index = self.own_state() as usize;
        let state = &mut self.draft_mut().program.lowered_mut().states[index];
        (state.rate, state.demand, state.limits) = (rate, demand, [lower, upper]);
    }

    /// One of the two limits, by its sign. It takes effect when the state passes it from inside. It ends when the rate
    /// points inward or when something else sets the state to a value inside.
    fn limit(&mut self, held: ModeHandle, sign: f64, limit: Register, demand: Register) {
        let out = self.own_output();
        let (past, short) = (self.subtract(out, limit), self.subtract(limit, out));
        let (over, inside) = if sign > 0.0 { (past, short) } else { (short, past) };
        let inward = if sign > 0.0 { self.negate(demand) } else { demand };
        // While a limit holds the state and moves inward, the state moves with it.
        for from in [FREE, sign] {
            let meets = Transition::new(from, sign, Guard::passed(over)).reset(self, limit);
            self.transition(held, meets);
        }
        self.transition(held, Transition::new(sign, FREE, Guard::passed(inward)));
        self.transition(held, Transition::new(sign, FREE, Guard::passed(inside)));
    }

    /// Adds a mode to the current element.
    pub fn new_mode(&mut self, initial: f64) -> ModeHandle {
        let is_drive = self.is_drive();
        let draft = self.draft_mut();
        let (element, index) = (draft.current, draft.program.lowered.modes.len() as u32);
        let (transitions, chatter_remedy) = (Vec::new(), ChatterRemedy::None);
        draft.program.lowered_mut().modes.push(Mode {
            element,
            is_drive,
            initial,
            transitions,
            chatter_remedy,
        });
        let mode = ModeHandle { index, value: self.emit(Op::Mode(index)) };
        self.draft_mut().own_mode.entry(element).or_insert(mode);
        mode
    }

    /// Specifies the element's means against chatter of a mode, if it has any.
    pub fn chatter_remedy(&mut self, mode: ModeHandle, remedy: ChatterRemedy) {
        self.draft_mut().program.lowered_mut().modes[mode.index as usize].chatter_remedy = remedy;
    }

    /// The first mode of the current element.
    pub fn own_mode(&self) -> ModeHandle {
        *self.draft().own_mode.get(&self.draft().current).expect("the element's output law makes its mode")
    }

    /// Adds a transition to a mode. Earlier transitions have priority.
    pub fn transition(&mut self, mode: ModeHandle, transition: Transition) {
        self.draft_mut().program.lowered_mut().modes[mode.index as usize].transitions.push(transition);
    }

    /// Adds a delay line to the current element. Settings are its delay and its initial output.
    pub fn new_delay(&mut self, time: &str, initial: &str) -> Register {
        let (time, initial) = (self.required(time), self.required(initial));
        let draft = self.draft_mut();
        let (element, index, input) = (draft.current, draft.program.lowered.delays.len() as u32, Register(0));
        let problem_seconds = 1.0 / draft.program.lowered.time_scale;
        draft.program.lowered_mut().delays.push(Delay {
            element,
            input,
            upstream: Vec::new(),
            time,
            initial,
            problem_seconds,
        });
        draft.own_delay.insert(element, index);
        self.emit(Op::Delayed(index))
    }

    /// Adds a noise source to the current element: random numbers with mean 0 and variance 1, each constant for a
    /// time. Seed, time and distribution are settings.
    pub fn noise(&mut self, seed: &str, every: &str, distribution: &str) -> Register {
        let (seed, every) = (self.required(seed), self.required(every));
        let distribution = match self.choice(distribution) {
            "uniform" => Distribution::Uniform,
            _ => Distribution::Normal,
        };
        let element = self.draft().current;
        self.level(Level::Noise(Noise { element, seed, every, distribution }))
    }

    /// Adds a sampled value to the current element: it is constant within a step. A setting is its value in initial
    /// condition.
    pub fn new_sampled_value(&mut self, initial: &str) -> Register {
        let initial = self.required(initial);
        let draft = self.draft_mut();
        let index = draft.program.lowered.kept.len() as u32;
        draft.program.lowered_mut().kept.push(SampledValue { initial, next: Register(0) });
        draft.own_memory.insert(draft.current, index);
        self.emit(Op::Sampled(index))
    }

    /// Specifies what the current element's sampled value becomes at the end of every step, and again after the
    /// changes of mode there.
    ///
    /// Sampling must not change this value: the body is not evaluated again afterwards.
    pub fn set_next_sample(&mut self, next: Register) {
        let index = *self
            .draft()
            .own_memory
            .get(&self.draft().current)
            .expect("the element's output law makes its memory");
        self.draft_mut().program.lowered_mut().kept[index as usize].next = next;
    }

    /// Specifies the input of the current element's delay line.
    pub fn set_delay_input(&mut self, input: Register) {
        let index = *self
            .draft()
            .own_delay
            .get(&self.draft().current)
            .expect("the element's output law makes its delay line");
        self.draft_mut().program.lowered_mut().delays[index as usize].input = input;
    }
}
