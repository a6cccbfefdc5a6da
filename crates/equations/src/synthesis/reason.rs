//! The reasons for scales with which an output does not use the range of its amplifier.

use patchcord_core::machines::REFERENCE;

use crate::graph::Operation;

/// The factors of a product peak at the same time if its peak is at least this share of the product of their peaks.
const AT_THE_SAME_TIME: f64 = 0.95;

/// What determines a scale, if that is not the peak of the quantity alone.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum ScaleReason {
    /// The problem prescribes it.
    Prescribed,
    /// It follows from a stated maximum that is kept.
    KeptMaximum,
    /// The quantity is 0 in the whole run, except for rounding. So the scale is an estimate.
    Zero,
    /// A multiplier has no gain, and the product of the peaks of its factors is low.
    SmallFactors,
    /// A multiplier has no gain, and its factors do not peak at the same time.
    Factors,
    /// A diode network for an absolute value, or a delay line, has the scale of its input.
    Input,
    /// A diode pair has the scale of its inputs.
    DiodePair,
    /// The scale follows from the resistors of a diode network.
    DeadZone,
    /// A smaller scale would need a gain that no amplifier has.
    LargestGain,
    /// The settings of a function generator have limits.
    Generator,
    /// The bounds of a limiter or the values of a comparator are larger than the peak.
    Bounds,
}

impl ScaleReason {
    /// The reason as a clause about the output.
    pub(crate) fn text(self) -> &'static str {
        match self {
            ScaleReason::Prescribed => "the problem prescribes its scale",
            ScaleReason::KeptMaximum => "its stated maximum is kept",
            ScaleReason::Zero => "it is 0 in the whole run",
            ScaleReason::SmallFactors => "a multiplier gives the product of its factors divided by 100 V",
            ScaleReason::Factors => "its factors are not large at the same time",
            ScaleReason::Input => "it has the scale of its input",
            ScaleReason::DiodePair => "a diode pair has the scale of its inputs",
            ScaleReason::DeadZone => "its scale follows from the diode network",
            ScaleReason::LargestGain => "the largest gain of an amplifier limits it",
            ScaleReason::Generator => "the settings of the function generator limit its scale",
            ScaleReason::Bounds => "the other values that it can have must be within 100 V",
        }
    }

    /// The reason for the scale of an operation without gains, from its peak and those of its inputs in volts. `None` if
    /// the scale of the operation is chosen.
    pub(super) fn of_forced(operation: &Operation, peak: f64, inputs: &[f64]) -> Option<ScaleReason> {
        match operation {
            Operation::Product(_) => {
                let most = inputs.iter().fold(REFERENCE, |product, input| product * input / REFERENCE);
                let is_reached = peak >= AT_THE_SAME_TIME * most;
                Some(if is_reached { ScaleReason::SmallFactors } else { ScaleReason::Factors })
            }
            Operation::Absolute(_) | Operation::Delay { .. } => Some(ScaleReason::Input),
            Operation::Lower(_) | Operation::Higher(_) => Some(ScaleReason::DiodePair),
            Operation::DeadZone { .. } => Some(ScaleReason::DeadZone),
            _ => None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::graph::NodeId;

    #[test]
    fn a_low_product_is_that_of_small_factors_or_of_factors_at_different_times() {
        let product = Operation::Product([NodeId(1), NodeId(2)]);
        let reason = |peak: f64| ScaleReason::of_forced(&product, peak, &[60.0, 70.0]);
        assert_eq!(reason(42.0), Some(ScaleReason::SmallFactors));
        assert_eq!(reason(12.0), Some(ScaleReason::Factors));
        assert_eq!(ScaleReason::of_forced(&Operation::One, 100.0, &[]), None);
    }
}
