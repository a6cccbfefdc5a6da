//! Parameters that a fit can change, and the coordinates of their values within their ranges.

use patchcord_core::patch::Patch;

/// A positive range whose ends differ by more than this factor has a logarithmic coordinate.
const LOGARITHMIC_RATIO: f64 = 20.0;

/// A value that a fit can change: a parameter of the patch with a range.
#[derive(Debug, Clone, PartialEq)]
pub struct FitParameter {
    /// Name of the parameter in the patch.
    pub name: String,
    /// Its value in the patch, in its declared unit. Initial voltages are in V.
    pub value: f64,
    /// The least and the largest value, in the same unit.
    pub range: [f64; 2],
}

impl FitParameter {
    /// The parameter `name` of a patch. `None` if the patch has no such parameter or the parameter has no range.
    pub(super) fn of(patch: &Patch, name: &str) -> Option<FitParameter> {
        let parameter = patch.parameters.get(name)?;
        let (low, high) = parameter.range?;
        Some(FitParameter { name: name.to_owned(), value: parameter.value, range: [low, high] })
    }

    /// The position of a value in the range: 0 at the least value, 1 at the largest. See [`range_fraction`].
    pub(crate) fn fraction(&self, value: f64) -> f64 {
        range_fraction(self.range, value)
    }

    /// The value at a position in the range; the inverse of [`fraction`](Self::fraction), within the range.
    pub(crate) fn value_at(&self, fraction: f64) -> f64 {
        let [low, high] = self.range;
        let value = if is_logarithmic(self.range) {
            low * libm::pow(high / low, fraction)
        } else {
            low + fraction * (high - low)
        };
        value.clamp(low, high)
    }

    /// The derivative of the value with respect to its position in the range.
    pub(crate) fn slope(&self, value: f64) -> f64 {
        let [low, high] = self.range;
        if is_logarithmic(self.range) { value * libm::log(high / low) } else { high - low }
    }
}

/// The position of a value in a range, 0 to 1: ln(value / low) / ln(high / low) if the range is logarithmic, otherwise
/// (value - low) / (high - low). Values outside the range give numbers below 0 or above 1.
pub(crate) fn range_fraction(range: [f64; 2], value: f64) -> f64 {
    let [low, high] = range;
    if is_logarithmic(range) {
        libm::log(value / low) / libm::log(high / low)
    } else {
        (value - low) / (high - low)
    }
}

/// Whether a range is positive and wider than [`LOGARITHMIC_RATIO`].
fn is_logarithmic([low, high]: [f64; 2]) -> bool {
    low > 0.0 && high > LOGARITHMIC_RATIO * low
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_wide_positive_range_has_a_logarithmic_coordinate() {
        assert!((range_fraction([1.0, 1e8], 50.0) - 50f64.ln() / 1e8f64.ln()).abs() < 1e-12);
        assert!((range_fraction([1e-3, 1e4], 1e-4) + 1.0 / 7.0).abs() < 1e-12);
        assert!((range_fraction([0.0, 1e4], 5e3) - 0.5).abs() < 1e-12);
    }
}
