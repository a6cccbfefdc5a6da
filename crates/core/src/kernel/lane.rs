//! Numbers on which operations work: one `f64`, or several in vector registers.
//!
//! The interpreter is written once for all lanes. [`Lane`] has the operations that it needs. `f64` is one run, and
//! [`Lanes`] is one run per element of an array, which the compiler keeps in vector registers.

use pulp::{Arch, NullaryFnOnce};

use crate::multiply_add::multiply_add;

/// Carries out operations, compiled for the widest registers of the processor. `pulp` selects them when the program
/// runs. WebAssembly cannot ask for the processor, and its code is loaded with the page, so there they are compiled once.
#[inline(always)]
pub(super) fn dispatch<O: NullaryFnOnce>(operations: O) -> O::Output {
    if cfg!(target_family = "wasm") { operations.call() } else { Arch::new().dispatch(operations) }
}

/// One or several numbers to which the same operations apply. Each is rounded as if it were alone.
pub(crate) trait Lane: Copy {
    /// How many numbers there are.
    const COUNT: usize;
    /// A truth value for each number.
    type Truth: Copy;
    /// True for all numbers.
    const TRUE: Self::Truth;
    /// One bit for each number for which the value is false.
    fn failing(truth: Self::Truth) -> u64;
    /// Whether each number is between two others. A number for which `already` is false stays false.
    fn is_within(self, low: Self, high: Self, already: Self::Truth) -> Self::Truth;
    /// The same number in all lanes.
    fn splat(value: f64) -> Self;
    /// The number of one lane.
    fn get(&self, lane: usize) -> f64;
    /// Replaces the number of one lane.
    fn set(&mut self, lane: usize, value: f64);
    /// A result from each number and its counterpart.
    fn map(self, other: Self, of: impl Fn(f64, f64) -> f64) -> Self;
    /// A result from each number and its two counterparts.
    fn map3(self, b: Self, c: Self, of: impl Fn(f64, f64, f64) -> f64) -> Self;
    /// Whether a condition holds for every number and its counterpart.
    fn all(self, other: Self, holds: impl Fn(f64, f64) -> bool) -> bool;

    /// self + other.
    #[inline(always)]
    fn add(self, other: Self) -> Self {
        self.map(other, |a, b| a + b)
    }
    /// self - other.
    #[inline(always)]
    fn subtract(self, other: Self) -> Self {
        self.map(other, |a, b| a - b)
    }
    /// self x other.
    #[inline(always)]
    fn multiply(self, other: Self) -> Self {
        self.map(other, |a, b| a * b)
    }
    /// self x factor + sum, rounded once.
    #[inline(always)]
    fn multiply_add(self, factor: Self, sum: Self) -> Self {
        self.map3(factor, sum, multiply_add)
    }
    /// The smaller of two numbers. A NaN on the left is returned, as in the reference.
    #[inline(always)]
    fn lower_of(self, other: Self) -> Self {
        self.map(other, |a, b| if b < a { b } else { a })
    }
    /// The larger of two numbers. A NaN on the left is returned, as in the reference.
    #[inline(always)]
    fn upper_of(self, other: Self) -> Self {
        self.map(other, |a, b| if b > a { b } else { a })
    }
    /// The absolute value of each number.
    #[inline(always)]
    fn absolute(self) -> Self {
        self.map(self, |a, _| a.abs())
    }
    /// `then` if a < b, otherwise `otherwise`, for each number.
    #[inline(always)]
    fn select_below(a: Self, b: Self, then: Self, otherwise: Self) -> Self {
        let is_below = a.map(b, |a, b| if a < b { 1.0 } else { 0.0 });
        is_below.map3(then, otherwise, |below, then, otherwise| if below == 1.0 { then } else { otherwise })
    }
    /// Whether every number is at least its counterpart.
    #[inline(always)]
    fn all_at_least(self, other: Self) -> bool {
        self.all(other, |value, other| value >= other)
    }
}

/// One number. Every operation is that of the reference.
impl Lane for f64 {
    const COUNT: usize = 1;
    type Truth = bool;
    const TRUE: bool = true;

    #[inline(always)]
    fn failing(truth: bool) -> u64 {
        u64::from(!truth)
    }
    #[inline(always)]
    fn is_within(self, low: Self, high: Self, already: bool) -> bool {
        already & (self >= low) & (high >= self)
    }

    #[inline(always)]
    fn splat(value: f64) -> Self {
        value
    }
    #[inline(always)]
    fn get(&self, _: usize) -> f64 {
        *self
    }
    #[inline(always)]
    fn set(&mut self, _: usize, value: f64) {
        *self = value;
    }
    #[inline(always)]
    fn map(self, other: Self, of: impl Fn(f64, f64) -> f64) -> Self {
        of(self, other)
    }
    #[inline(always)]
    fn map3(self, b: Self, c: Self, of: impl Fn(f64, f64, f64) -> f64) -> Self {
        of(self, b, c)
    }
    #[inline(always)]
    fn all(self, other: Self, holds: impl Fn(f64, f64) -> bool) -> bool {
        holds(self, other)
    }
}

/// Several numbers in an array whose alignment fits the widest registers: 64 bytes, or eight numbers.
#[derive(Debug, Clone, Copy)]
#[repr(align(64))]
pub(crate) struct Lanes<const N: usize>([f64; N]);

impl<const N: usize> Lanes<N> {
    /// A result from each number and its lane.
    ///
    /// It is a plain loop. Code that is not inlined into a function for wide registers is compiled for narrow ones,
    /// which is ten times slower. Library functions are not always inlined.
    #[inline(always)]
    fn each(mut self, of: impl Fn(usize, f64) -> f64) -> Self {
        for lane in 0..N {
            self.0[lane] = of(lane, self.0[lane]);
        }
        self
    }

    /// One bit for each number below 1. It is not inlined, so that the caller consists of whole vectors.
    #[inline(never)]
    fn less_than_one(&self) -> u64 {
        (0..N).filter(|lane| self.0[*lane] < 1.0).fold(0, |bits, lane| bits | 1 << lane)
    }
}

/// Each number has the same operations as a single `f64`, so a lane gives the same bits as a run alone.
impl<const N: usize> Lane for Lanes<N> {
    const COUNT: usize = N;
    /// 1 if true, otherwise 0. So truth values stay in the same registers as the numbers.
    type Truth = Self;
    const TRUE: Self = Lanes([1.0; N]);

    #[inline(always)]
    fn failing(truth: Self) -> u64 {
        if truth.all_at_least(Self::TRUE) { 0 } else { truth.less_than_one() }
    }
    #[inline(always)]
    fn is_within(self, low: Self, high: Self, already: Self) -> Self {
        self.each(|lane, value| {
            let is_inside = (value >= low.0[lane]) & (high.0[lane] >= value);
            if is_inside { already.0[lane] } else { 0.0 }
        })
    }
    #[inline(always)]
    fn splat(value: f64) -> Self {
        Lanes([value; N])
    }
    #[inline(always)]
    fn get(&self, lane: usize) -> f64 {
        self.0[lane]
    }
    #[inline(always)]
    fn set(&mut self, lane: usize, value: f64) {
        self.0[lane] = value;
    }
    #[inline(always)]
    fn map(self, other: Self, of: impl Fn(f64, f64) -> f64) -> Self {
        self.each(|lane, value| of(value, other.0[lane]))
    }
    #[inline(always)]
    fn map3(self, b: Self, c: Self, of: impl Fn(f64, f64, f64) -> f64) -> Self {
        self.each(|lane, value| of(value, b.0[lane], c.0[lane]))
    }
    #[inline(always)]
    fn all(self, other: Self, holds: impl Fn(f64, f64) -> bool) -> bool {
        let mut all = true;
        for lane in 0..N {
            all &= holds(self.0[lane], other.0[lane]);
        }
        all
    }
}
