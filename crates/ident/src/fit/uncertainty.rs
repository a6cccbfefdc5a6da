//! How well a value that is fitted is known.

/// How well a value is known.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Known {
    /// Its standard error, in declared units; infinite where the data do not tell.
    pub error: f64,
    /// Between which values it lies in 95 of 100 cases.
    pub interval: [f64; 2],
}

impl Known {
    /// What the data do not tell.
    pub const NOT: Known = Known { error: f64::INFINITY, interval: [f64::NEG_INFINITY, f64::INFINITY] };
}
