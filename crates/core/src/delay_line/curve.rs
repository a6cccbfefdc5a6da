//! The polynomial through the samples around a delayed time.

/// A polynomial in Newton's form, with coefficients of 1, (t - t0), (t - t0)(t - t1) and so on.
#[derive(Debug, Clone, Copy)]
pub(super) struct Curve {
    /// The times of the nodes; only the first three are read.
    pub times: [f64; 4],
    /// The Newton coefficients in ascending order.
    pub coefficients: [f64; 4],
}

impl Curve {
    /// The polynomial at a time.
    pub(super) fn value(&self, time: f64) -> f64 {
        let [from_first, from_second, from_third, _] = self.times.map(|node| time - node);
        let [constant, first, second, third] = self.coefficients;
        constant + from_first * (first + from_second * (second + from_third * third))
    }

    /// The derivative of the polynomial at a time, in volts per second.
    pub(super) fn slope(&self, time: f64) -> f64 {
        let [a, b, c, _] = self.times.map(|node| time - node);
        let [_, first, second, third] = self.coefficients;
        first + (a + b) * second + (a * b + a * c + b * c) * third
    }
}

/// The curve between two adjacent samples, which no later sample changes.
#[derive(Debug, Clone, Copy)]
pub(super) struct CachedSegment {
    /// Input time from which the curve applies.
    pub from: f64,
    /// Input time up to which the curve applies.
    pub until: f64,
    pub curve: Curve,
}

/// The result of the search for a further sample of a curve.
pub(super) enum NextNode {
    /// The sample with this index.
    Found(usize),
    /// There is none: the smooth piece ends.
    PieceEnds,
    /// There is none yet: the horizon comes first.
    Pending,
}

/// Indices of up to four samples through which a curve is drawn.
#[derive(Debug, Clone, Copy)]
pub(super) struct CurveNodes {
    pub indices: [usize; 4],
    /// How many of the indices are used.
    pub count: usize,
    /// Whether no later sample can change the curve.
    pub is_final: bool,
}

impl CurveNodes {
    /// The two samples between which the curve is read; one if both are the same.
    pub(super) fn pair(first: usize, last: usize) -> Self {
        CurveNodes { indices: [first, last, 0, 0], count: if first == last { 1 } else { 2 }, is_final: true }
    }

    /// Adds a sample. There must be fewer than four.
    pub(super) fn add(&mut self, index: usize) {
        self.indices[self.count] = index;
        self.count += 1;
    }
}
