//! The rows of a static check as data.

/// A row of a static check: the output of an element, or the derivative of an integrator or a lag.
#[derive(Debug, Clone, PartialEq)]
pub struct StaticRow {
    /// Name of the element.
    pub element: String,
    /// Its kind, such as "summer".
    pub kind: &'static str,
    /// Its note in the patch; empty if it has none.
    pub note: String,
    /// Number of derivatives: 0 for an output in volts, 1 for a derivative in volts per machine second.
    pub order: usize,
    /// The quantity that the row represents. `None` if there is no signal for it.
    pub quantity: Option<RowQuantity>,
    /// The expected value in volts, or in volts per machine second. `None` if the patch states no equations, or if a
    /// brake, a stop or a reset holds the output.
    pub expected: Option<f64>,
    /// The value in the wiring, without the limit of the amplifier.
    pub wired: f64,
    /// Where the expected value comes from.
    pub source: RowSource,
    /// Whether the two values differ. `false` if they are not compared.
    pub differs: bool,
    /// Why the two values are not compared, as a clause: "A3 is overloaded". `None` if they are compared, or if there is
    /// no expected value.
    pub not_compared: Option<String>,
    /// Indices of the stated equations that give the expected value, and then of those that give the quantities in them.
    /// Empty if no equation gives it.
    pub equations: Vec<usize>,
    /// Whether the output demands more than 100 V.
    pub is_overloaded: bool,
    /// Place in the order of signal flow. Derivatives come after all outputs.
    pub place: usize,
}

/// The quantity of a row.
#[derive(Debug, Clone, PartialEq)]
pub struct RowQuantity {
    /// Its name, such as x or x'.
    pub name: String,
    /// Its unit, such as mm/s. Derivatives are by problem time.
    pub unit: String,
    /// The expected value in this unit. `None` if there is no expected voltage.
    pub expected: Option<f64>,
    /// The value in the wiring in this unit.
    pub wired: f64,
}

/// Where an expected value comes from.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum RowSource {
    /// It is a test value or an initial value.
    TestValue,
    /// The stated equations give it.
    Equations,
    /// The law of the element gives it from the expected values at its inputs.
    Inputs,
    /// There is none, because a brake, a stop or a reset holds the output.
    Held,
    /// There is none, because the patch states no equations.
    NoEquations,
}
