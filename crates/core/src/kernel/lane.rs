//! One number, or several side by side that go through the same operations.

/// Numbers that operations work on together. Each is rounded as if it stood alone.
pub(crate) trait Lane: Copy {
    /// How many numbers they are.
    const COUNT: usize;
    /// Of each number, whether something holds of it.
    type Truth: Copy;
    /// It holds of all.
    const TRUE: Self::Truth;
    /// A bit for each number of which it does not hold.
    fn failing(truth: Self::Truth) -> u64;
    /// Whether a number lies between two others, of those of which that much is true already.
    fn lies_between(self, low: Self, high: Self, already: Self::Truth) -> Self::Truth;
    fn splat(value: f64) -> Self;
    fn get(&self, lane: usize) -> f64;
    fn set(&mut self, lane: usize, value: f64);
    /// One result from every number and the number beside it.
    fn map(self, other: Self, of: impl Fn(f64, f64) -> f64) -> Self;
    /// The same of three.
    fn map3(self, b: Self, c: Self, of: impl Fn(f64, f64, f64) -> f64) -> Self;
    /// Whether something holds of every number and the one beside it.
    fn all(self, other: Self, holds: impl Fn(f64, f64) -> bool) -> bool;

    #[inline(always)]
    fn add(self, other: Self) -> Self {
        self.map(other, |a, b| a + b)
    }
    #[inline(always)]
    fn subtract(self, other: Self) -> Self {
        self.map(other, |a, b| a - b)
    }
    #[inline(always)]
    fn multiply(self, other: Self) -> Self {
        self.map(other, |a, b| a * b)
    }
    /// self x factor + sum, rounded once.
    #[inline(always)]
    fn multiply_add(self, factor: Self, sum: Self) -> Self {
        self.map3(factor, sum, f64::mul_add)
    }
    // A NaN on the left comes through, as in the reference.
    #[inline(always)]
    fn lower_of(self, other: Self) -> Self {
        self.map(other, |a, b| if b < a { b } else { a })
    }
    #[inline(always)]
    fn upper_of(self, other: Self) -> Self {
        self.map(other, |a, b| if b > a { b } else { a })
    }
    #[inline(always)]
    fn absolute(self) -> Self {
        self.map(self, |a, _| a.abs())
    }
    /// `then` where a < b, else `otherwise`.
    #[inline(always)]
    fn select_below(a: Self, b: Self, then: Self, otherwise: Self) -> Self {
        let is_below = a.map(b, |a, b| if a < b { 1.0 } else { 0.0 });
        is_below.map3(then, otherwise, |below, then, otherwise| if below == 1.0 { then } else { otherwise })
    }
    /// Whether every number is at least the one beside it.
    #[inline(always)]
    fn reaches(self, other: Self) -> bool {
        self.all(other, |value, other| value >= other)
    }
}

impl Lane for f64 {
    const COUNT: usize = 1;
    type Truth = bool;
    const TRUE: bool = true;

    #[inline(always)]
    fn failing(truth: bool) -> u64 {
        u64::from(!truth)
    }
    #[inline(always)]
    fn lies_between(self, low: Self, high: Self, already: bool) -> bool {
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

/// Numbers side by side, as the widest registers hold them.
#[derive(Debug, Clone, Copy)]
#[repr(align(64))]
pub(crate) struct Abreast<const N: usize>([f64; N]);

impl<const N: usize> Abreast<N> {
    // A plain loop, as whatever is not inlined into the code for wide registers is made for narrow ones, ten times as slow; what the
    // library offers instead need not be.
    #[inline(always)]
    fn each(mut self, of: impl Fn(usize, f64) -> f64) -> Self {
        for lane in 0..N {
            self.0[lane] = of(lane, self.0[lane]);
        }
        self
    }

    // Apart from those who ask, so that what they do stays whole vectors.
    #[inline(never)]
    fn less_than_one(&self) -> u64 {
        (0..N).filter(|lane| self.0[*lane] < 1.0).fold(0, |bits, lane| bits | 1 << lane)
    }
}

impl<const N: usize> Lane for Abreast<N> {
    const COUNT: usize = N;
    // 1 where it holds, else 0: it is kept where the numbers are.
    type Truth = Self;
    const TRUE: Self = Abreast([1.0; N]);

    #[inline(always)]
    fn failing(truth: Self) -> u64 {
        if truth.reaches(Self::TRUE) { 0 } else { truth.less_than_one() }
    }
    #[inline(always)]
    fn lies_between(self, low: Self, high: Self, already: Self) -> Self {
        self.each(|lane, value| {
            let lies = (value >= low.0[lane]) & (high.0[lane] >= value);
            if lies { already.0[lane] } else { 0.0 }
        })
    }
    #[inline(always)]
    fn splat(value: f64) -> Self {
        Abreast([value; N])
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
