//! The interface that element laws are written against: what a law can read, and the operations that it can emit.

use std::collections::HashMap;
use std::sync::Arc;

use super::{
    Calm, Delay, Distribution, Guard, Kept, Level, Mode, ModeHandle, Noise, Op, Program, Register, State,
    TimeConstant, Timetable, Transition,
};
use crate::machines::REFERENCE;
use patchcord_expr::Function;

/// Mode of an integrator between its limits; at a limit the mode is the limit's sign.
const FREE: f64 = 0.0;

/// A program under construction, and the element whose law is emitting.
pub struct Draft {
    pub(crate) program: Program,
    /// Index of the element whose law is emitting.
    pub(crate) current: usize,
    /// For every operation of the body, the element whose law emitted it.
    pub(crate) owners: Vec<usize>,
    /// The output of every element that has been emitted.
    pub(crate) outputs: Vec<Option<Register>>,
    pub(crate) own_state: HashMap<usize, u32>,
    pub(crate) own_mode: HashMap<usize, ModeHandle>,
    own_delay: HashMap<usize, u32>,
    own_memory: HashMap<usize, u32>,
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

/// What an element's law reads of its element. The operations it emits are methods of `dyn Builder`.
pub trait Builder {
    /// The program under construction.
    fn draft(&self) -> &Draft;

    /// The program under construction.
    fn draft_mut(&mut self) -> &mut Draft;

    /// Gain and voltage of every cord into an input of the element, in the order of the document.
    fn driven(&self, input: &str) -> Vec<(f64, Register)>;

    /// The coefficient of a setting; `None` if the patch omits it and it has no default.
    fn coefficient(&mut self, setting: &str) -> Option<u32>;

    /// A setting made of points; empty if the patch omits it.
    fn points(&self, setting: &str) -> Vec<[f64; 2]>;

    /// A setting that is true or false.
    fn flag(&self, setting: &str) -> bool;

    /// The word that a setting chooses, the first of its words by default.
    fn choice(&self, setting: &str) -> &'static str;

    /// Volts per unit of a drive's scale, for values that are not formulas.
    fn volts_per_signal(&mut self) -> Register;

    /// Whether the element is a drive.
    fn is_drive(&self) -> bool;
}

/// What a law reads.
impl dyn Builder + '_ {
    /// The voltages at an input, without gains, in the order of the document.
    pub fn inputs(&mut self, name: &str) -> Vec<Register> {
        self.driven(name).into_iter().map(|(_, register)| register).collect()
    }

    /// The voltage at an input of one jack; ground if it is left open.
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

    /// The sum of an input's voltages, each times its gain.
    pub fn sum(&mut self, name: &str) -> Register {
        let mut total = None;
        for (gain, register) in self.driven(name) {
            let term = self.scaled(register, gain);
            total = Some(total.map_or(term, |total| self.add(total, term)));
        }
        total.unwrap_or_else(|| self.constant(0.0))
    }

    fn scaled(&mut self, register: Register, gain: f64) -> Register {
        if gain == 1.0 {
            return register;
        }
        let gain = self.constant(gain);
        self.multiply(gain, register)
    }

    /// A setting as a voltage or number of the body, its default if the patch omits it.
    pub fn get(&mut self, name: &str) -> Register {
        self.optional(name).expect("a setting that is required or has a default is there")
    }

    /// A setting that may be absent.
    pub fn optional(&mut self, name: &str) -> Option<Register> {
        let index = self.coefficient(name)?;
        Some(self.emit(Op::Coefficient(index)))
    }

    /// The coefficient of a setting that is required or has a default.
    fn required(&mut self, name: &str) -> u32 {
        self.coefficient(name).expect("a setting that is required or has a default is there")
    }

    /// Appends an operation of the current element to the body.
    pub(crate) fn emit(&mut self, op: Op) -> Register {
        let draft = self.draft_mut();
        draft.program.body.push(op);
        draft.owners.push(draft.current);
        Register(draft.program.body.len() as u32 - 1)
    }
}

/// What a law emits.
impl dyn Builder + '_ {
    /// A fixed number.
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

    /// The lower of two.
    pub fn minimum(&mut self, a: Register, b: Register) -> Register {
        self.emit(Op::Minimum(a, b))
    }

    /// The upper of two.
    pub fn maximum(&mut self, a: Register, b: Register) -> Register {
        self.emit(Op::Maximum(a, b))
    }

    /// Size without sign.
    pub fn absolute(&mut self, a: Register) -> Register {
        self.emit(Op::Absolute(a))
    }

    /// `then` where left >= right, else `otherwise`.
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

    /// The whole number at or below.
    pub fn floor(&mut self, a: Register) -> Register {
        self.call(Function::Floor, a)
    }

    /// Points looked up: straight between them, level outside.
    pub fn look_up(&mut self, points: Vec<[f64; 2]>, at: Register) -> Register {
        let table = self.new_table(points);
        let element = self.draft().current;
        self.draft_mut().program.curves.push((element, table));
        self.emit(Op::Table(table as u32, at))
    }

    fn new_table(&mut self, points: Vec<[f64; 2]>) -> usize {
        let tables = Arc::make_mut(&mut self.draft_mut().program.tables);
        tables.push(points);
        tables.len() - 1
    }

    /// A setting made of points in time, straight from one to the next, level outside: no step goes across its corners.
    pub fn straight_in_time(&mut self, name: &str) -> Register {
        let table = self.new_timetable(name, true);
        let time = self.time();
        self.emit(Op::Table(table as u32, time))
    }

    /// A setting made of points in time, each value held until the next, the first before it too.
    pub fn held_in_time(&mut self, name: &str) -> Register {
        let table = self.new_timetable(name, false);
        self.level(Level::Points { table })
    }

    fn new_timetable(&mut self, name: &str, is_straight: bool) -> usize {
        let table = self.new_table(self.points(name));
        let draft = self.draft_mut();
        let element = draft.current;
        draft.program.timetables.push(Timetable { element, table, is_straight });
        table
    }

    fn level(&mut self, level: Level) -> Register {
        let levels = &mut self.draft_mut().program.levels;
        levels.push(level);
        let index = levels.len() as u32 - 1;
        self.emit(Op::Level(index))
    }

    /// A new state of the current element, starting at a setting.
    pub fn new_state(&mut self, initial: &str) -> Register {
        let initial = self.required(initial);
        let draft = self.draft_mut();
        let (element, index, unset) = (draft.current, draft.program.states.len() as u32, Register(0));
        let state = State { element, rate: unset, demand: unset, limits: [unset; 2], initial, lag: None };
        draft.program.states.push(state);
        draft.own_state.insert(element, index);
        self.emit(Op::State(index))
    }

    /// The index of the current element's state.
    pub(super) fn own_state(&self) -> u32 {
        *self.draft().own_state.get(&self.draft().current).expect("the element's output law makes its state")
    }

    /// The output of the current element, for its memory law.
    pub fn own_output(&self) -> Register {
        self.draft().outputs[self.draft().current].expect("the output law comes before the memory law")
    }

    /// A setting that is the time constant of the current element's state: no step is longer.
    pub fn time_constant(&mut self, name: &str) -> Register {
        let (time, problem_seconds) = (self.required(name), 1.0 / self.draft().program.time_scale);
        let index = self.own_state() as usize;
        self.draft_mut().program.states[index].lag = Some(TimeConstant { time, problem_seconds });
        self.emit(Op::Coefficient(time))
    }

    /// Sets d/dt of the current element's state, in volts per machine second. At ±100 V the state is held
    /// while its rate points outward: a mode of the element, so that coming there and leaving are located.
    pub fn set_rate(&mut self, rate: Register) {
        self.set_rate_within(rate, [None, None]);
    }

    /// The same, held at limits of its own, lower and upper, where they lie inside of ±100 V.
    pub fn set_rate_within(&mut self, rate: Register, [lower, upper]: [Option<Register>; 2]) {
        let demand = self.scaled(rate, self.draft().program.time_scale);
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
        let state = &mut self.draft_mut().program.states[index];
        (state.rate, state.demand, state.limits) = (rate, demand, [lower, upper]);
    }

    /// The limit of this sign: met from inside, left when driven inward or set inside by something else.
    fn limit(&mut self, held: ModeHandle, sign: f64, limit: Register, demand: Register) {
        let out = self.own_output();
        let (past, short) = (self.subtract(out, limit), self.subtract(limit, out));
        let (over, inside) = if sign > 0.0 { (past, short) } else { (short, past) };
        let inward = if sign > 0.0 { self.negate(demand) } else { demand };
        // A limit that is turned inward takes the state along that it holds.
        for from in [FREE, sign] {
            let meets = Transition::new(from, sign, Guard::passed(over)).reset(self, limit);
            self.transition(held, meets);
        }
        self.transition(held, Transition::new(sign, FREE, Guard::passed(inward)));
        self.transition(held, Transition::new(sign, FREE, Guard::passed(inside)));
    }

    /// A new mode of the current element.
    pub fn new_mode(&mut self, initial: f64) -> ModeHandle {
        let of_drive = self.is_drive();
        let draft = self.draft_mut();
        let (element, index) = (draft.current, draft.program.modes.len() as u32);
        let (transitions, calmed_by) = (Vec::new(), Calm::Drive);
        draft.program.modes.push(Mode { element, of_drive, initial, transitions, calmed_by });
        let mode = ModeHandle { index, value: self.emit(Op::Mode(index)) };
        self.draft_mut().own_mode.entry(element).or_insert(mode);
        mode
    }

    /// What keeps a mode from chattering, where the element has something for that.
    pub fn calmed_by(&mut self, mode: ModeHandle, calm: Calm) {
        self.draft_mut().program.modes[mode.index as usize].calmed_by = calm;
    }

    /// The mode that the current element made first.
    pub fn own_mode(&self) -> ModeHandle {
        *self.draft().own_mode.get(&self.draft().current).expect("the element's output law makes its mode")
    }

    /// A change of a mode.
    pub fn transition(&mut self, mode: ModeHandle, transition: Transition) {
        self.draft_mut().program.modes[mode.index as usize].transitions.push(transition);
    }

    /// A delay line of the current element, its time and initial output being settings.
    pub fn new_delay(&mut self, time: &str, initial: &str) -> Register {
        let (time, initial) = (self.required(time), self.required(initial));
        let draft = self.draft_mut();
        let (element, index, input) = (draft.current, draft.program.delays.len() as u32, Register(0));
        let problem_seconds = 1.0 / draft.program.time_scale;
        draft.program.delays.push(Delay {
            element,
            input,
            hears: Vec::new(),
            time,
            initial,
            problem_seconds,
        });
        draft.own_delay.insert(element, index);
        self.emit(Op::Delayed(index))
    }

    /// Numbers drawn by chance, of mean 0 and variance 1, each held for a time; the seed, the time and the
    /// distribution are settings.
    pub fn noise(&mut self, seed: &str, every: &str, distribution: &str) -> Register {
        let (seed, every) = (self.required(seed), self.required(every));
        let distribution = match self.choice(distribution) {
            "uniform" => Distribution::Uniform,
            _ => Distribution::Normal,
        };
        let element = self.draft().current;
        self.level(Level::Noise(Noise { element, seed, every, distribution }))
    }

    /// A value of the current element that stays the same within a step, a setting in initial condition.
    pub fn new_memory(&mut self, initial: &str) -> Register {
        let initial = self.required(initial);
        let draft = self.draft_mut();
        let index = draft.program.kept.len() as u32;
        draft.program.kept.push(Kept { initial, next: Register(0) });
        draft.own_memory.insert(draft.current, index);
        self.emit(Op::Kept(index))
    }

    /// What the current element's kept value becomes at the end of every stretch of time, and again once what
    /// switches there has switched. It must come to the same again once it is kept: voltages are not worked out
    /// anew.
    pub fn remember(&mut self, next: Register) {
        let index = *self
            .draft()
            .own_memory
            .get(&self.draft().current)
            .expect("the element's output law makes its memory");
        self.draft_mut().program.kept[index as usize].next = next;
    }

    /// What goes into the current element's delay line.
    pub fn set_delay_input(&mut self, input: Register) {
        let index = *self
            .draft()
            .own_delay
            .get(&self.draft().current)
            .expect("the element's output law makes its delay line");
        self.draft_mut().program.delays[index as usize].input = input;
    }
}
