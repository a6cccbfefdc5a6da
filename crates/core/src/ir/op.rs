//! The primitive operations that every element comes down to.

use super::number::Number;
use patchcord_expr::Function;

/// Where an operation leaves its result: the index of the operation in its list.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Register(pub u32);

impl Register {
    /// The register as an index.
    pub fn index(self) -> usize {
        self.0 as usize
    }
}

/// One operation on f64 volts. Operands are registers written before it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Op {
    /// A fixed number.
    Constant(f64),
    /// A parameter of the patch, in SI (prologue only).
    Parameter(u32),
    /// A coefficient worked out by the prologue.
    Coefficient(u32),
    /// A state: the output of an integrator.
    State(u32),
    /// The present value of a mode.
    Mode(u32),
    /// Problem time in seconds.
    Time,
    /// Sum.
    Add(Register, Register),
    /// Difference.
    Subtract(Register, Register),
    /// Product.
    Multiply(Register, Register),
    /// Quotient.
    Divide(Register, Register),
    /// Lower of two.
    Minimum(Register, Register),
    /// Upper of two.
    Maximum(Register, Register),
    /// Size without sign.
    Absolute(Register),
    /// `then` where left >= right, else `otherwise`.
    Select {
        /// What is compared.
        left: Register,
        /// What it is compared with.
        right: Register,
        /// The value where left is not below right.
        then: Register,
        /// The value where it is.
        otherwise: Register,
    },
    /// A function of one or two numbers.
    Call(Function, Register, Register),
    /// A table of points at this abscissa: straight lines between them, level outside.
    Table(u32, Register),
    /// What a delay line gives back.
    Delayed(u32),
    /// The number that holds now of those that a source gives at known instants: noise, points that are held.
    Level(u32),
    /// A kept value: as it stood at the end of the last stretch.
    Kept(u32),
    /// Start of a loop without an integrator: the output that opens it, solved here.
    Tear(u32),
}

/// What operations read besides registers.
pub(crate) struct Sources<'a, N> {
    pub parameters: &'a [N],
    pub coefficients: &'a [N],
    pub states: &'a [N],
    pub modes: &'a [f64],
    pub time: N,
    pub tables: &'a [Vec<[f64; 2]>],
    pub delayed: &'a [N],
    pub kept: &'a [N],
    pub levels: &'a [N],
}

impl<N: Number> Sources<'_, N> {
    /// For operations that read registers alone.
    pub fn none() -> Self {
        Sources {
            parameters: &[],
            coefficients: &[],
            states: &[],
            modes: &[],
            time: N::constant(0.0),
            tables: &[],
            delayed: &[],
            kept: &[],
            levels: &[],
        }
    }
}

impl Op {
    /// The registers that it reads.
    pub(crate) fn operands(self) -> impl Iterator<Item = Register> {
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

    /// The same operation on other registers.
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

    /// The operation's value; a tear has none of its own and must be solved by the caller.
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
            Op::Kept(index) => from.kept[index as usize],
            Op::Level(index) => from.levels[index as usize],
            Op::Tear(_) => N::constant(f64::NAN),
        }
    }
}
