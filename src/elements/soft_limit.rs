//! The soft limiter that an amplifier may carry: a biased diode across it.

use crate::program::{Lowering, Register};

use super::{Measure, Setting};

/// The settings of a soft limiter.
pub(super) const LIMIT_SETTINGS: &[Setting] = &[
    Setting::optional("limit.upper", Measure::Volts, "output above which the upper diode conducts"),
    Setting::optional("limit.lower", Measure::Volts, "output below which the lower diode conducts"),
    Setting::preset("limit.slope", Measure::Ratio, 0.0, "slope that is left beyond a limit (0: flat)")
        .within(0.0, 1.0),
    Setting { name: "limit.drop", ..Setting::DIODE_DROP },
];

/// The output after the limiter, or the output itself where none is set.
pub(super) fn apply(lowering: &mut Lowering<'_>, out: Register) -> Register {
    let (upper, lower) = (lowering.optional("limit.upper"), lowering.optional("limit.lower"));
    if upper.is_none() && lower.is_none() {
        return out;
    }
    let slope = lowering.get("limit.slope");
    let drop = lowering.get("limit.drop");
    let mut limited = out;
    if let Some(level) = upper {
        let knee = lowering.add(level, drop);
        let inside = lowering.minimum(out, knee);
        limited = beyond(lowering, limited, out, inside, slope);
    }
    if let Some(level) = lower {
        let knee = lowering.subtract(level, drop);
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
