//! The primitive operations of which every element's law consists.
//!
//! The list is short so that each backend can implement all of it: the interpreter, derivatives, intervals and the
//! kernels. An operation names its operands by register and stores its result in the register with its index.

use super::number::Number;
use patchcord_expr::Function;

/// A register: the index of an operation in its list, and of the result of that operation.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Register(pub u32);

impl Register {
    /// The register as an index into a slice.
    pub fn index(self) -> usize {
        self.0 as usize
    }
}

/// One operation on f64 values in volts. Its operands are registers with smaller indices.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Op {
    /// A fixed number.
    Constant(f64),
    /// A parameter of the patch in SI. Only the prologue reads parameters.
    Parameter(u32),
    /// A coefficient that the prologue computes.
    Coefficient(u32),
    /// A state: the output of an integrator or a lag.
    State(u32),
    /// The present value of a mode.
    Mode(u32),
    /// Problem time in seconds.
    Time,
    /// a + b.
    Add(Register, Register),
    /// a - b.
    Subtract(Register, Register),
    /// a times b.
    Multiply(Register, Register),
    /// a divided by b.
    Divide(Register, Register),
    /// The smaller of two values.
    Minimum(Register, Register),
    /// The larger of two values.
    Maximum(Register, Register),
    /// The absolute value.
    Absolute(Register),
    /// `then` if left >= right, otherwise `otherwise`.
    Select {
        /// The left side of the comparison.
        left: Register,
        /// The right side of the comparison.
        right: Register,
        /// The value if left >= right.
        then: Register,
        /// The value if left < right.
        otherwise: Register,
    },
    /// A function of one or two arguments. Functions of one argument get it twice.
    Call(Function, Register, Register),
    /// A table at an abscissa: straight lines between the points, constant outside.
    Table(u32, Register),
    /// The output of a delay line.
    Delayed(u32),
    /// The present value of a source that is constant between known instants: noise or a stepped table.
    Level(u32),
    /// A value sampled at the end of the last step.
    Sampled(u32),
    /// A tear of a loop without an integrator: one of the voltages that solve the loop.
    Tear {
        /// Index of the loop.
        index: u32,
        /// Index of the tear among those of the loop.
        position: u32,
    },
}

/// What operations read in addition to registers. The index in an operation is the index in the slice.
pub(crate) struct Sources<'a, N> {
    /// Parameters in SI; the prologue reads them.
    pub parameters: &'a [N],
    /// Coefficients that the prologue has computed.
    pub coefficients: &'a [N],
    /// Voltages of the states.
    pub states: &'a [N],
    /// Values of the modes.
    pub modes: &'a [f64],
    /// Problem time in seconds.
    pub time: N,
    /// Points of the tables.
    pub tables: &'a [Vec<[f64; 2]>],
    /// Outputs of the delay lines, in volts.
    pub delayed: &'a [N],
    /// Values sampled at the end of the last step.
    pub sampled: &'a [N],
    /// Present values of the levels.
    pub levels: &'a [N],
}

impl<N: Number> Sources<'_, N> {
    /// Empty sources, for operations that read registers only.
    pub(crate) fn none() -> Self {
        Sources {
            parameters: &[],
            coefficients: &[],
            states: &[],
            modes: &[],
            time: N::constant(0.0),
            tables: &[],
            delayed: &[],
            sampled: &[],
            levels: &[],
        }
    }
}

impl Op {
    /// The registers that the operation reads.
    pub fn operands(self) -> impl Iterator<Item = Register> {
        let operands = match self {
            Op::Absolute(a) | Op::Table(_, a) => [Some(a), None, None, None],
            Op::Add(a, b)
            | Op::Subtract(a, b)
            | Op::Multiply(a, b)
            | Op::Divide(a, b)
            | Op::Minimum(a, b)
            | Op::Maximum(a, b)
            | Op::Call(_, a, b) => [Some(a), Some(b), None, None],
            Op::Select { left, right, then, otherwise } => [left, right, then, otherwise].map(Some),
            _ => [None; 4],
        };
        operands.into_iter().flatten()
    }

    /// The same operation with its registers mapped by `to`.
    pub(crate) fn with_operands(self, to: impl Fn(Register) -> Register) -> Op {
        match self {
            Op::Absolute(a) => Op::Absolute(to(a)),
            Op::Table(table, at) => Op::Table(table, to(at)),
            Op::Add(a, b) => Op::Add(to(a), to(b)),
            Op::Subtract(a, b) => Op::Subtract(to(a), to(b)),
            Op::Multiply(a, b) => Op::Multiply(to(a), to(b)),
            Op::Divide(a, b) => Op::Divide(to(a), to(b)),
            Op::Minimum(a, b) => Op::Minimum(to(a), to(b)),
            Op::Maximum(a, b) => Op::Maximum(to(a), to(b)),
            Op::Call(function, a, b) => Op::Call(function, to(a), to(b)),
            Op::Select { left, right, then, otherwise } => {
                Op::Select { left: to(left), right: to(right), then: to(then), otherwise: to(otherwise) }
            }
            source => source,
        }
    }

    /// The value of the operation. A tear gives NaN: the caller solves it instead.
    #[inline(always)]
    pub(crate) fn apply<N: Number>(self, from: &Sources<'_, N>, get: impl Fn(Register) -> N) -> N {
        match self {
            Op::Constant(value) => N::constant(value),
            Op::Parameter(index) => from.parameters[index as usize],
            Op::Coefficient(index) => from.coefficients[index as usize],
            Op::State(index) => from.states[index as usize],
            Op::Mode(index) => N::constant(from.modes[index as usize]),
            Op::Time => from.time,
            Op::Add(a, b) => get(a).add(get(b)),
            Op::Subtract(a, b) => get(a).subtract(get(b)),
            Op::Multiply(a, b) => get(a).multiply(get(b)),
            Op::Divide(a, b) => get(a).divide(get(b)),
            Op::Minimum(a, b) => get(a).lower_of(get(b)),
            Op::Maximum(a, b) => get(a).upper_of(get(b)),
            Op::Absolute(a) => get(a).absolute(),
            Op::Select { left, right, then, otherwise } => {
                N::select(get(left), get(right), get(then), get(otherwise))
            }
            Op::Call(function, a, b) => N::call(function, get(a), get(b)),
            Op::Table(index, at) => get(at).table(&from.tables[index as usize]),
            Op::Delayed(index) => from.delayed[index as usize],
            Op::Sampled(index) => from.sampled[index as usize],
            Op::Level(index) => from.levels[index as usize],
            Op::Tear { .. } => N::constant(f64::NAN),
        }
    }
}
