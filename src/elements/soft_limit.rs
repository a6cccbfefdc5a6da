//! The soft limiter that an amplifier may carry: a biased diode across it.

use crate::machines::Part;
use crate::program::{Lowering, Register};

use super::{Measure, Setting, Takes};

/// The upper limit of any amplifier.
pub(super) const UPPER: Setting =
    Setting::optional("limit.upper", Measure::Volts, "output above which the upper diode conducts");
/// The lower limit of any amplifier.
pub(super) const LOWER: Setting =
    Setting::optional("limit.lower", Measure::Volts, "output below which the lower diode conducts");
/// The drop of its diodes.
pub(super) const DROP: Setting = Setting { name: "limit.drop", ..Setting::DIODE_DROP };

/// The settings of a soft limiter.
pub(super) const LIMIT_SETTINGS: &[Setting] = &[
    UPPER,
    LOWER,
    Setting::preset("limit.slope", Measure::Ratio, 0.0, "slope that is left beyond a limit (0: flat)")
        .within(0.0, 1.0),
    DROP,
];

/// What it takes of a machine.
pub(super) const LIMIT_PARTS: [Takes; 3] = [
    Takes::with("limit", Part::DiodePair, 1),
    Takes::with("limit.upper", Part::FreePot, 1),
    Takes::with("limit.lower", Part::FreePot, 1),
];

/// The outputs, lower and upper, at which the diodes conduct, their drop included; `None` where there is none.
pub(super) fn knees(lowering: &mut Lowering<'_>) -> [Option<Register>; 2] {
    let (lower, upper) = (lowering.optional("limit.lower"), lowering.optional("limit.upper"));
    if lower.is_none() && upper.is_none() {
        return [None, None];
    }
    let drop = lowering.get("limit.drop");
    [lower.map(|level| lowering.subtract(level, drop)), upper.map(|level| lowering.add(level, drop))]
}

/// The output after the limiter, or the output itself where none is set.
pub(super) fn apply(lowering: &mut Lowering<'_>, out: Register) -> Register {
    let [lower, upper] = knees(lowering);
    if upper.is_none() && lower.is_none() {
        return out;
    }
    let slope = lowering.get("limit.slope");
    let mut limited = out;
    if let Some(knee) = upper {
        let inside = lowering.minimum(out, knee);
        limited = beyond(lowering, limited, out, inside, slope);
    }
    if let Some(knee) = lower {
        let inside = lowering.maximum(out, knee);
        limited = beyond(lowering, limited, out, inside, slope);
    }
    limited
}

/// Takes off the part of `out` that is not `inside`, but for the slope that is left of it.
fn beyond(
    lowering: &mut Lowering<'_>,
    limited: Register,
    out: Register,
    inside: Register,
    slope: Register,
) -> Register {
    let excess = lowering.subtract(out, inside);
    let kept = lowering.multiply(slope, excess);
    let change = lowering.subtract(kept, excess);
    lowering.add(limited, change)
}
