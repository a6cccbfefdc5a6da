//! One number, or several side by side that go through the same operations.

/// Numbers that operations work on together. Each is rounded as if it stood alone.
pub(crate) trait Lane: Copy {
    /// How many there are.
    const COUNT: usize;
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

impl<const N: usize> Lane for [f64; N] {
    const COUNT: usize = N;

    #[inline(always)]
    fn splat(value: f64) -> Self {
        [value; N]
    }
    #[inline(always)]
    fn get(&self, lane: usize) -> f64 {
        self[lane]
    }
    #[inline(always)]
    fn set(&mut self, lane: usize, value: f64) {
        self[lane] = value;
    }
    #[inline(always)]
    fn map(self, other: Self, of: impl Fn(f64, f64) -> f64) -> Self {
        std::array::from_fn(|lane| of(self[lane], other[lane]))
    }
    #[inline(always)]
    fn map3(self, b: Self, c: Self, of: impl Fn(f64, f64, f64) -> f64) -> Self {
        std::array::from_fn(|lane| of(self[lane], b[lane], c[lane]))
    }
    #[inline(always)]
    fn all(self, other: Self, holds: impl Fn(f64, f64) -> bool) -> bool {
        (0..N).fold(true, |all, lane| all & holds(self[lane], other[lane]))
    }
}
