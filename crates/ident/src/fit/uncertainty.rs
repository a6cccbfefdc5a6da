//! The uncertainty of a fitted value.

/// The standard error and the confidence interval of a fitted value.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Uncertainty {
    /// The standard error, in the declared unit. Infinite if the data do not determine the value.
    pub error: f64,
    /// The 95 % confidence interval, in the declared unit: its lower and its upper end.
    pub interval: [f64; 2],
}

impl Uncertainty {
    /// The uncertainty of a value that the data do not determine.
    pub const UNDETERMINED: Uncertainty =
        Uncertainty { error: f64::INFINITY, interval: [f64::NEG_INFINITY, f64::INFINITY] };
}
