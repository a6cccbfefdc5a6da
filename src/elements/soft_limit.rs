//! The soft limiter that an amplifier may carry: a biased diode across it.

use crate::machines::REFERENCE;
use crate::program::{Lowering, Register};

use super::{Default, Measure, Setting};

const fn level(name: &'static str, description: &'static str) -> Setting {
    Setting {
        name,
        measure: Measure::Volts,
        default: Default::Absent,
        range: (-REFERENCE, REFERENCE),
        description,
    }
}

/// The settings of a soft limiter.
pub(super) const LIMIT_SETTINGS: &[Setting] = &[
    level("limit.upper", "output above which the upper diode conducts"),
    level("limit.lower", "output below which the lower diode conducts"),
    Setting {
        name: "limit.slope",
        measure: Measure::Ratio,
        default: Default::Number(0.0),
        range: (0.0, 1.0),
        description: "slope that is left beyond a limit (0: flat)",
    },
    Setting {
        name: "limit.drop",
        measure: Measure::Volts,
        default: Default::Number(0.0),
        range: (0.0, 10.0),
        description: "forward drop of the diodes: moves both limits outward",
    },
];

/// The output after the limiter, or the output itself where none is set.
pub(super) fn apply(lowering: &mut Lowering<'_>, out: Register) -> Register {
    let (upper, lower) = (lowering.set("limit.upper"), lowering.set("limit.lower"));
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
