//! The interface that element laws are written against.
//!
//! A law reads inputs and settings of its element and emits operations. [`Builder`] has the methods that the lowering
//! implements because they need the circuit. The operations themselves are methods of `dyn Builder`, so laws are
//! ordinary functions without type parameters. `storage` has the methods for everything that lasts from step to step.

mod storage;

use std::collections::HashMap;
use std::sync::Arc;

use super::{Level, ModeHandle, Op, Program, Register, Timetable};
use patchcord_expr::Function;

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
    own_sampled_value: HashMap<usize, u32>,
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
            own_sampled_value: HashMap::new(),
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
}
