//! A kernel's steps as native code.
//!
//! The code does the operations of [`Kernel::steps`] over one lane, and gives the same bits; but it goes its steps blindly, and the
//! rows that it writes are judged afterwards. Here alone memory is reached without the compiler's guard: through the pointers of
//! [`Memory`], to the numbers of one frame, whose lengths are those for which the code was made, and to its rows.

#![allow(unsafe_code, reason = "calls code that is made while the program runs")]

mod emit;
mod operations;
mod watch;

use std::fmt;

use cranelift_codegen::ir::{AbiParam, types};
use cranelift_codegen::settings::{self, Configurable};
use cranelift_frontend::{FunctionBuilder, FunctionBuilderContext};
use cranelift_jit::{JITBuilder, JITModule};
use cranelift_module::{FuncId, Linkage, Module, ModuleError, default_libcall_names};

use super::Kernel;
use super::code::Instruction;
use super::frame::Frame;
use super::rows::Columns;
use super::step::{Look, Steps};
use crate::ir::Number;
use emit::Emitter;
use patchcord_expr::Function;

/// The native code of one kernel.
pub(crate) struct Native {
    run: Entry,
    look: Entry,
    at_slots: Entry,
    /// Owns the code.
    module: Option<JITModule>,
    /// The lengths of the frames for which it was made.
    lengths: Lengths,
    /// So many tables are looked up, the first.
    tables: usize,
    columns: Columns,
}

/// Code that reaches what its memory points to, at the places that frames and tables of its kernel have.
type Entry = unsafe extern "C" fn(*mut Memory) -> u64;

/// How many numbers stand behind each pointer to a frame.
type Lengths = [usize; 8];

/// What the code reaches.
#[repr(C)]
struct Memory {
    /// The same once for each stage and once for what is watched: what is loaded through one is used there, and
    /// takes no register for longer.
    slots: [*mut f64; 5],
    states: *mut f64,
    rates: *mut f64,
    slopes: *const f64,
    rooms: *const f64,
    /// Of a look, and of what is worked out at the slots: rates and what is left of the watches at its end.
    rates_ahead: *mut f64,
    rests: *mut f64,
    /// Of a look: its length, and when it ends.
    length: f64,
    end: f64,
    /// What tables of time give in its middle, then at its end.
    ahead: *const f64,
    tables: *const Vec<[f64; 2]>,
    /// Of steps: the row in which they begin, before as many others as there are steps.
    rows: *mut f64,
    time: f64,
    begin: f64,
    /// What the number of a step is multiplied by, then divided by.
    step: f64,
    per_second: f64,
    first: u64,
    count: u64,
    /// Numbers that are quicker read than made.
    half: f64,
    two: f64,
}

/// Kernels whose code would have more operations than this are interpreted: making it takes a second, and from there on
/// longer than in proportion.
const MOST_OPERATIONS: usize = 16_000;

impl Native {
    /// The native code of a kernel; nothing where this processor, or the kernel, is none for it: steps that delay lines cut into
    /// pieces are not gone blindly.
    pub fn new(kernel: &Kernel) -> Option<Native> {
        (!kernel.has_lines() && kernel.operations() <= MOST_OPERATIONS)
            .then(|| made(kernel).ok().flatten())
            .flatten()
    }

    /// Goes so many steps of a grid from one of its instants, as long as nothing is met: how many were gone.
    pub fn steps(&self, frame: &mut Frame<f64>, tables: &[Vec<[f64; 2]>], steps: &Steps) -> u64 {
        let mut gone = 0;
        frame.rows.make_room(&self.columns);
        while gone < steps.count {
            frame.begin_rows(&self.columns);
            let left = steps.after(gone);
            let block = Steps { count: frame.rows.next_of(&self.columns, left.count), ..left };
            let quiet = self.block(frame, tables, &block);
            gone += quiet;
            if quiet < block.count {
                break;
            }
        }
        gone
    }

    /// The same of no more steps than there is room for in the rows, the first of which is written.
    fn block(&self, frame: &mut Frame<f64>, tables: &[Vec<[f64; 2]>], steps: &Steps) -> u64 {
        let (step, per_second) = steps.grid.numbers();
        frame.put_scheduled_rows(&self.columns, tables, steps);
        self.enter(self.run, frame, tables, |memory| {
            let (begin, first, count) = (steps.begin, steps.first, steps.count);
            Memory { begin, step, per_second, first, count, ..memory }
        });
        frame.judge_rows(&self.columns, steps)
    }

    /// Looks ahead by a step of this length.
    pub fn look(&self, frame: &mut Frame<f64>, tables: &[Vec<[f64; 2]>], length: f64) -> Look {
        let end = frame.time + length;
        frame.put_ahead(tables, [frame.time + 0.5 * length, end]);
        match self.enter(self.look, frame, tables, |memory| Memory { length, end, ..memory }) {
            0 => Look::Quiet,
            1 => Look::Within,
            _ => Look::Ahead,
        }
    }

    /// Works everything out at the states and the time in the slots.
    pub fn work_out(&self, frame: &mut Frame<f64>, tables: &[Vec<[f64; 2]>]) {
        self.enter(self.at_slots, frame, tables, |memory| memory);
    }

    /// Runs code of this kernel on a frame and tables, told what to do in its memory: what it gives.
    fn enter(
        &self,
        code: Entry,
        frame: &mut Frame<f64>,
        tables: &[Vec<[f64; 2]>],
        told: impl FnOnce(Memory) -> Memory,
    ) -> u64 {
        // One by one: arrays would be written down before they are compared.
        let fits =
            lengths(frame).into_iter().zip(self.lengths).fold(true, |all, (own, made)| all & (own == made));
        assert!(fits && tables.len() >= self.tables, "a frame of another kernel");
        let mut memory = told(memory(frame, tables));
        assert!(memory.count == 0 || frame.rows.hold(&self.columns, memory.count), "more steps than rows");
        // SAFETY: the code reaches places below the lengths for which it was made, which were compared, and the rows of so many
        // steps, for which there is room; frame and tables are borrowed until it is done.
        unsafe { code(&raw mut memory) }
    }
}

/// How many numbers of a frame the code may reach.
fn lengths(frame: &Frame<f64>) -> Lengths {
    let Frame { slots, states, rates, slopes, rooms, rests, ahead, stages: [.., rates_ahead], .. } = frame;
    [slots, states, rates, slopes, rooms, rests, ahead, rates_ahead].map(Vec::len)
}

/// How many tables of a program, the first, hold all that a kernel looks up.
fn tables(kernel: &Kernel) -> usize {
    let checks =
        [&kernel.quick, &kernel.thorough].into_iter().flat_map(|checks| [&checks.middle, &checks.ending]);
    let instructions = checks.chain([&kernel.moving]).flat_map(|code| &code.instructions);
    let above = instructions.map(|instruction| match instruction {
        Instruction::Table { table, .. } => *table as usize + 1,
        _ => 0,
    });
    above.max().unwrap_or(0)
}

/// The numbers of a frame; nothing is told yet of steps or of a look.
fn memory(frame: &mut Frame<f64>, tables: &[Vec<[f64; 2]>]) -> Memory {
    Memory {
        slots: [frame.slots.as_mut_ptr(); 5],
        states: frame.states.as_mut_ptr(),
        rates: frame.rates.as_mut_ptr(),
        slopes: frame.slopes.as_ptr(),
        rooms: frame.rooms.as_ptr(),
        rates_ahead: frame.stages[3].as_mut_ptr(),
        rests: frame.rests.as_mut_ptr(),
        length: 0.0,
        end: 0.0,
        ahead: frame.ahead.as_ptr(),
        tables: tables.as_ptr(),
        rows: frame.rows.pointer(),
        time: frame.time,
        begin: 0.0,
        step: 0.0,
        per_second: 1.0,
        first: 0,
        count: 0,
        half: 0.5,
        two: 2.0,
    }
}

impl Drop for Native {
    fn drop(&mut self) {
        if let Some(module) = self.module.take() {
            // SAFETY: the code is called through `self` alone.
            unsafe { module.free_memory() };
        }
    }
}

// SAFETY: the code and what it was made of are never changed once they are there.
unsafe impl Send for Native {}
// SAFETY: the same.
unsafe impl Sync for Native {}

impl fmt::Debug for Native {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str("Native")
    }
}

extern "C" fn call(function: u64, a: f64, b: f64) -> f64 {
    Function::at(function as usize).map_or(f64::NAN, |function| function.apply(a, b))
}

extern "C" fn look_up(tables: *const Vec<[f64; 2]>, table: u64, x: f64) -> f64 {
    // SAFETY: the code passes on the pointer of its memory, and the indices of the kernel's tables.
    let points = unsafe { &*tables.add(table as usize) };
    x.table(points)
}

fn made(kernel: &Kernel) -> Result<Option<Native>, Box<ModuleError>> {
    let mut flags = settings::builder();
    // The order of the operations is chosen for few registers: it is best left alone.
    for (name, value) in [("opt_level", "none"), ("is_pic", "false"), ("enable_verifier", "false")] {
        flags.set(name, value).expect("a flag of this version");
    }
    let Ok(builder) = cranelift_native::builder() else { return Ok(None) };
    let Ok(isa) = builder.finish(settings::Flags::new(flags)) else { return Ok(None) };
    let mut builder = JITBuilder::with_isa(isa, default_libcall_names());
    builder.symbol("patchcord_call", call as *const u8);
    builder.symbol("patchcord_look_up", look_up as *const u8);
    let mut module = JITModule::new(builder);
    let pointer = module.target_config().pointer_type();

    let call = import(&mut module, "patchcord_call", [types::I64, types::F64, types::F64])?;
    let look_up = import(&mut module, "patchcord_look_up", [pointer, types::I64, types::F64])?;
    let (helpers, columns) = ([call, look_up], Columns::of(kernel));
    let run = define(&mut module, "steps", (kernel, &columns), helpers, |emitter| emitter.steps())?;
    let look = define(&mut module, "look", (kernel, &columns), helpers, |emitter| emitter.one_look())?;
    let at_slots =
        define(&mut module, "at_slots", (kernel, &columns), helpers, |emitter| emitter.at_slots())?;
    module.finalize_definitions()?;
    let [run, look, at_slots] = [run, look, at_slots].map(|function| {
        let code = module.get_finalized_function(function);
        // SAFETY: all three functions were declared with this signature.
        unsafe { std::mem::transmute::<*const u8, Entry>(code) }
    });
    let (lengths, tables) = (lengths(&kernel.frame()), tables(kernel));
    Ok(Some(Native { run, look, at_slots, module: Some(module), lengths, tables, columns }))
}

/// A function that the code calls, and that gives a number.
fn import(module: &mut JITModule, name: &str, takes: [types::Type; 3]) -> Result<FuncId, Box<ModuleError>> {
    let mut signature = module.make_signature();
    signature.params.extend(takes.map(AbiParam::new));
    signature.returns.push(AbiParam::new(types::F64));
    Ok(module.declare_function(name, Linkage::Import, &signature)?)
}

/// Makes a function of a kernel.
fn define(
    module: &mut JITModule,
    name: &str,
    (kernel, columns): (&Kernel, &Columns),
    helpers: [FuncId; 2],
    emit: impl FnOnce(Emitter<'_, '_>),
) -> Result<FuncId, Box<ModuleError>> {
    let pointer = module.target_config().pointer_type();
    let mut context = module.make_context();
    context.func.signature.params.push(AbiParam::new(pointer));
    context.func.signature.returns.push(AbiParam::new(types::I64));
    context.func.signature.call_conv = module.target_config().default_call_conv;
    let function = module.declare_function(name, Linkage::Export, &context.func.signature)?;
    let helpers = helpers.map(|helper| module.declare_func_in_func(helper, &mut context.func));
    let mut room = FunctionBuilderContext::new();
    let mut builder = FunctionBuilder::new(&mut context.func, &mut room);
    emit(Emitter::new(&mut builder, kernel, columns, pointer, helpers));
    builder.seal_all_blocks();
    builder.finalize(module.target_config());
    module.define_function(function, &mut context)?;
    Ok(function)
}
