//! The soft limiter that an amplifier may carry: a biased diode across it.

use super::{Measure, Setting, Takes};
use crate::ir::{Builder, Register};
use crate::machines::Part;

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
pub(super) fn knees(builder: &mut dyn Builder) -> [Option<Register>; 2] {
    let (lower, upper) = (builder.optional("limit.lower"), builder.optional("limit.upper"));
    if lower.is_none() && upper.is_none() {
        return [None, None];
    }
    let drop = builder.get("limit.drop");
    [lower.map(|level| builder.subtract(level, drop)), upper.map(|level| builder.add(level, drop))]
}

/// The output after the limiter, or the output itself where none is set.
pub(super) fn apply(builder: &mut dyn Builder, out: Register) -> Register {
    let [lower, upper] = knees(builder);
    if upper.is_none() && lower.is_none() {
        return out;
    }
    let slope = builder.get("limit.slope");
    let mut limited = out;
    if let Some(knee) = upper {
        let inside = builder.minimum(out, knee);
        limited = beyond(builder, limited, out, inside, slope);
    }
    if let Some(knee) = lower {
        let inside = builder.maximum(out, knee);
        limited = beyond(builder, limited, out, inside, slope);
    }
    limited
}

/// Takes off the part of `out` that is not `inside`, but for the slope that is left of it.
fn beyond(
    builder: &mut dyn Builder,
    limited: Register,
    out: Register,
    inside: Register,
    slope: Register,
) -> Register {
    let excess = builder.subtract(out, inside);
    let kept = builder.multiply(slope, excess);
    let change = builder.subtract(kept, excess);
    builder.add(limited, change)
}
