//! A kernel's steps as native code.
//!
//! The code runs the operations of [`Kernel::steps`] for one lane and gives the same bits. It takes its steps without
//! tests; the rows that it writes are tested afterwards.
//!
//! Only this module contains `unsafe` code. The generated code reads and writes memory through the pointers of
//! [`Memory`]: the values of one frame and its rows. Their lengths are compared with those for which the code was
//! made.
//!
//! Compilation takes time, so it is worth it for long runs only (`store`). A block of steps runs without any test; then
//! its rows are tested, and the steps up to the first hit are accepted.

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

use super::code::Instruction;
use super::frame::Frame;
use super::rows::RowLayout;
use super::{Kernel, Steps};
use crate::ir::Number;
use emit::Emitter;
use patchcord_expr::Function;

/// The native code of one kernel.
pub(crate) struct Native {
    /// The loop over steps, which writes rows.
    run: Entry,
    /// The look-ahead.
    look: Entry,
    /// The evaluation at the states and the time in the slots.
    at_slots: Entry,
    /// The owner of the generated code.
    module: Option<JITModule>,
    /// The lengths of the frames for which the code was made.
    lengths: Lengths,
    /// Number of tables that the code reads; the first ones of all.
    tables: usize,
    /// The layout of the rows that the code writes.
    columns: RowLayout,
}

/// Generated code. It accesses the memory that its argument points to, at the places that frames and tables of its
/// kernel have.
type Entry = unsafe extern "C" fn(*mut Memory) -> u64;

/// The number of values behind each pointer to a frame.
type Lengths = [usize; 10];

/// Everything that the generated code accesses.
#[repr(C)]
struct Memory {
    /// The slots, once per stage and once for the watches. A pointer that is loaded for one stage need not stay in a
    /// register longer.
    slots: [*mut f64; 5],
    /// The states at the beginning of a look-ahead, in volts.
    states: *mut f64,
    /// The rates of these states.
    rates: *mut f64,
    /// The slopes of the watches.
    slopes: *const f64,
    /// The offsets of the watches.
    offsets: *const f64,
    /// The rates that a look-ahead or an evaluation computes.
    end_rates: *mut f64,
    /// The margins of the watches that a look-ahead or an evaluation computes.
    margins: *mut f64,
    /// What a look-ahead tests at each of the first two stages.
    inner: [*mut f64; 2],
    /// Length of a look-ahead, in problem seconds.
    length: f64,
    /// Time at which a look-ahead ends, in problem seconds.
    end: f64,
    /// The values of tables of time in the middle of the look-ahead, then at its end.
    scheduled: *const f64,
    /// The tables of the program, for the helper that looks up a curve.
    tables: *const Vec<[f64; 2]>,
    /// The row in which the steps begin. As many rows follow as there are steps.
    rows: *mut f64,
    /// Time at which the steps or a look-ahead begin, in problem seconds.
    time: f64,
    /// Time at which the grid of the steps begins, in problem seconds.
    begin: f64,
    /// The factor of the index: the time of instant k is begin + k x step / per_second.
    step: f64,
    /// Steps per second; 1 if that is not a whole number.
    per_second: f64,
    /// Index of the instant at which the first step ends.
    first: u64,
    /// Number of steps.
    count: u64,
    /// Constants that are faster to read than to build.
    half: f64,
    /// The number 2.
    two: f64,
}

/// Maximum number of operations in native code. Larger kernels are interpreted: compiling this many takes a second,
/// and the time grows faster than in proportion.
const MAX_OPERATIONS: usize = 16_000;

impl Native {
    /// The native code of a kernel. `None` if the processor is not supported, if the kernel is too large, or if it has
    /// delay lines, which cut steps into pieces.
    pub(crate) fn new(kernel: &Kernel) -> Option<Native> {
        (!kernel.has_delay_lines() && kernel.operations() <= MAX_OPERATIONS)
            .then(|| compile(kernel).ok().flatten())
            .flatten()
    }

    /// Takes steps of a grid until a watch is hit. Returns how many were taken.
    pub(crate) fn steps(&self, frame: &mut Frame<f64>, tables: &[Vec<[f64; 2]>], steps: &Steps) -> u64 {
        let mut taken = 0;
        frame.rows.allocate(&self.columns);
        while taken < steps.count {
            frame.write_start_row(&self.columns);
            let remaining = steps.after(taken);
            let count = frame.rows.next_block(&self.columns, remaining.count);
            let block = Steps { count, ..remaining };
            let accepted = self.block(frame, tables, &block);
            taken += accepted;
            if accepted < block.count {
                break;
            }
        }
        taken
    }

    /// Takes at most as many steps as there are rows. The first row must be written.
    fn block(&self, frame: &mut Frame<f64>, tables: &[Vec<[f64; 2]>], steps: &Steps) -> u64 {
        let (step, per_second) = steps.grid.factors();
        frame.write_scheduled_rows(&self.columns, tables, steps);
        self.enter(self.run, frame, tables, |memory| {
            let (begin, first, count) = (steps.begin, steps.first, steps.count);
            Memory { begin, step, per_second, first, count, ..memory }
        });
        frame.accept_rows(&self.columns, steps)
    }

    /// Evaluates a step of this length, without taking it, and tests every watch. Returns whether one is hit at the end.
    pub(crate) fn look(&self, frame: &mut Frame<f64>, tables: &[Vec<[f64; 2]>], length: f64) -> bool {
        let end = frame.time + length;
        frame.compute_scheduled_values(tables, [frame.time + 0.5 * length, end]);
        self.enter(self.look, frame, tables, |memory| Memory { length, end, ..memory }) != 0
    }

    /// Evaluates everything at the states and the time in the slots.
    pub(crate) fn evaluate(&self, frame: &mut Frame<f64>, tables: &[Vec<[f64; 2]>]) {
        self.enter(self.at_slots, frame, tables, |memory| memory);
    }

    /// Runs code of this kernel on a frame and tables, with the inputs that `setup` specifies. Returns its result.
    fn enter(
        &self,
        code: Entry,
        frame: &mut Frame<f64>,
        tables: &[Vec<[f64; 2]>],
        setup: impl FnOnce(Memory) -> Memory,
    ) -> u64 {
        // One by one, because arrays would be written to memory before they are compared.
        let is_own_frame = lengths(frame)
            .into_iter()
            .zip(self.lengths)
            .fold(true, |all, (length, expected)| all & (length == expected));
        assert!(is_own_frame && tables.len() >= self.tables, "a frame of another kernel");
        let mut memory = setup(memory(frame, tables));
        assert!(
            memory.count == 0 || frame.rows.has_capacity(&self.columns, memory.count),
            "more steps than rows"
        );
        // SAFETY: the code accesses places below the lengths for which it was made, which were compared, and rows for
        // `count` steps, which exist. Frame and tables are borrowed until it returns.
        unsafe { code(&raw mut memory) }
    }
}

/// The number of values of a frame that the code may access.
fn lengths(frame: &Frame<f64>) -> Lengths {
    let Frame {
        slots,
        states,
        rates,
        slopes,
        offsets,
        margins,
        scheduled_values,
        stages: [.., end_rates],
        inner: [first, second],
        ..
    } = frame;
    [slots, states, rates, slopes, offsets, margins, scheduled_values, end_rates, first, second].map(Vec::len)
}

/// The number of tables of a program that include all those the kernel reads; the first ones of all.
fn tables(kernel: &Kernel) -> usize {
    let checks = [&kernel.quick, &kernel.thorough]
        .into_iter()
        .flat_map(|checks| [&checks.first, &checks.second, &checks.ending]);
    let instructions = checks.chain([&kernel.moving]).flat_map(|code| &code.instructions);
    let counts = instructions.map(|instruction| match instruction {
        Instruction::Table { table, .. } => *table as usize + 1,
        _ => 0,
    });
    counts.max().unwrap_or(0)
}

/// The values of a frame, without steps or a look-ahead.
fn memory(frame: &mut Frame<f64>, tables: &[Vec<[f64; 2]>]) -> Memory {
    Memory {
        slots: [frame.slots.as_mut_ptr(); 5],
        states: frame.states.as_mut_ptr(),
        rates: frame.rates.as_mut_ptr(),
        slopes: frame.slopes.as_ptr(),
        offsets: frame.offsets.as_ptr(),
        end_rates: frame.stages[3].as_mut_ptr(),
        margins: frame.margins.as_mut_ptr(),
        inner: frame.inner.each_mut().map(|values| values.as_mut_ptr()),
        length: 0.0,
        end: 0.0,
        scheduled: frame.scheduled_values.as_ptr(),
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
            // SAFETY: the code is called through `self` only.
            unsafe { module.free_memory() };
        }
    }
}

// SAFETY: the code and its module are never changed after they are made.
unsafe impl Send for Native {}
// SAFETY: the same.
unsafe impl Sync for Native {}

impl fmt::Debug for Native {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str("Native")
    }
}

/// Helper of the code: a function of one or two numbers, by its index.
extern "C" fn call(function: u64, a: f64, b: f64) -> f64 {
    Function::from_index(function as usize).map_or(f64::NAN, |function| function.apply(a, b))
}

/// Helper of the code: the value of a table at an abscissa.
extern "C" fn look_up(tables: *const Vec<[f64; 2]>, table: u64, x: f64) -> f64 {
    // SAFETY: the code passes on the pointer from its memory, and indices of the kernel's tables.
    let points = unsafe { &*tables.add(table as usize) };
    x.table(points)
}

/// Compiles a kernel. `None` if the processor is not supported.
fn compile(kernel: &Kernel) -> Result<Option<Native>, Box<ModuleError>> {
    let mut flags = settings::builder();
    // The emitter orders operations so that few registers are needed. An optimiser would change that.
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
    let (helpers, columns) = ([call, look_up], RowLayout::of(kernel));
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

/// Declares a helper function that the code calls and that returns a number.
fn import(module: &mut JITModule, name: &str, takes: [types::Type; 3]) -> Result<FuncId, Box<ModuleError>> {
    let mut signature = module.make_signature();
    signature.params.extend(takes.map(AbiParam::new));
    signature.returns.push(AbiParam::new(types::F64));
    Ok(module.declare_function(name, Linkage::Import, &signature)?)
}

/// Compiles one function of a kernel.
fn define(
    module: &mut JITModule,
    name: &str,
    (kernel, columns): (&Kernel, &RowLayout),
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
    let mut builder_context = FunctionBuilderContext::new();
    let mut builder = FunctionBuilder::new(&mut context.func, &mut builder_context);
    emit(Emitter::new(&mut builder, kernel, columns, pointer, helpers));
    builder.seal_all_blocks();
    builder.finalize(module.target_config());
    module.define_function(function, &mut context)?;
    Ok(function)
}
