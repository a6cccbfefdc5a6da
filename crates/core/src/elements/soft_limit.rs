//! The soft limiter of an amplifier: biased diodes across it.
//!
//! Summers and integrators share these settings and parts. A summer has a slope beyond the limit. An integrator has a
//! flat limit.

use super::{PartUse, Setting, SettingQuantity};
use crate::ir::{Builder, Register};
use crate::machines::Part;

/// The upper limit of any amplifier.
pub(super) const UPPER: Setting =
    Setting::optional("limit.upper", SettingQuantity::Volts, "output above which the upper diode conducts");
/// The lower limit of any amplifier.
pub(super) const LOWER: Setting =
    Setting::optional("limit.lower", SettingQuantity::Volts, "output below which the lower diode conducts");
/// The forward drop of the limiter's diodes.
pub(super) const DROP: Setting = Setting { name: "limit.drop", ..Setting::DIODE_DROP };

/// The settings of a soft limiter.
pub(super) const LIMIT_SETTINGS: &[Setting] = &[
    UPPER,
    LOWER,
    Setting::preset("limit.slope", SettingQuantity::Ratio, 0.0, "remaining slope beyond a limit (0: flat)")
        .within(0.0, 1.0),
    DROP,
];

/// The parts of a machine that a limiter needs.
pub(super) const LIMIT_PARTS: [PartUse; 3] = [
    PartUse::with("limit", Part::DiodePair, 1),
    PartUse::with("limit.upper", Part::FreePot, 1),
    PartUse::with("limit.lower", Part::FreePot, 1),
];

/// The lower and the upper output at which the diodes conduct, in volts: lower - drop and upper + drop. `None` for a
/// limit that is not set.
pub(super) fn knees(builder: &mut dyn Builder) -> [Option<Register>; 2] {
    let (lower, upper) = (builder.optional("limit.lower"), builder.optional("limit.upper"));
    if lower.is_none() && upper.is_none() {
        return [None, None];
    }
    let drop = builder.get("limit.drop");
    [lower.map(|level| builder.subtract(level, drop)), upper.map(|level| builder.add(level, drop))]
}

/// The output after the limiter: K + slope x (out - K) beyond a knee K. The same output if no limit is set.
///
/// Both limits change the output independently, because at most one of them applies.
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

/// Subtracts the part of `out` beyond the limit, except for the remaining slope.
///
/// The result is limited + (slope - 1) x (out - inside), in volts; `inside` is `out` cut off at the knee.
fn beyond(
    builder: &mut dyn Builder,
    limited: Register,
    out: Register,
    inside: Register,
    slope: Register,
) -> Register {
    let excess = builder.subtract(out, inside);
    let remaining = builder.multiply(slope, excess);
    let change = builder.subtract(remaining, excess);
    builder.add(limited, change)
}
