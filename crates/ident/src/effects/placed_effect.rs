//! An effect at its site, by name.

/// An effect at its site, by name. Logs and results identify effects by it; reports print it, as in "leak at I2".
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
pub struct PlacedEffect {
    /// The name of the effect.
    pub effect: String,
    /// The name of the element on which it acts.
    pub site: String,
}
