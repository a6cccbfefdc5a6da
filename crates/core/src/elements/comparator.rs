//! Comparator: a high or a low voltage by the sign of a difference, without hysteresis.
//!
//! The output is a mode, so the solver locates the instants at which it changes. If the difference stays at the
//! threshold because the output acts on it, the comparator chatters; a relay has two thresholds.

use super::relay::difference;
use super::{Input, Kind, PartUse, Setting, SettingQuantity};
use crate::ir::{Builder, ChatterRemedy, Guard, ModeNames, Register, Transition};
use crate::machines::{Part, REFERENCE};

/// The row of the comparator. Both inputs act through the memory, so a comparator in a loop leaves no loop to solve.
pub(super) static KIND: Kind = Kind {
    name: "comparator",
    summary: "comparator without hysteresis: its output is a high or a low voltage",
    law: "out = high if in - against >= threshold, low if it is below",
    modes: "in initial condition its output follows from its inputs; in hold it switches only if its inputs are \
            changed by hand",
    source: "electronic comparator of the hybrid machines",
    symbol: "comparator",
    inputs: &[
        Input::jack("in", "voltage that is compared").remembered(),
        Input::jack("against", "voltage with which it is compared; 0 V if open").remembered().open(),
    ],
    settings: &[
        Setting::preset("threshold", SettingQuantity::Volts, 0.0, "in - against from which it is high"),
        Setting::preset("high", SettingQuantity::Volts, REFERENCE, "output at or above the threshold"),
        Setting::preset("low", SettingQuantity::Volts, -REFERENCE, "output below the threshold"),
    ],
    positions: &["low", "high"],
    parts: &[PartUse::always(Part::Relay, 1)],
    output_law,
    memory_law: Some(memory_law),
    ..Kind::NETWORK
};

/// Mode while the output is low. It is position 0.
const LOW: f64 = 0.0;
/// Mode while the output is high. It is position 1.
const HIGH: f64 = 1.0;

/// The mode of the output.
const POSITION: ModeNames = ModeNames { mode: "output", values: &[(LOW, "low"), (HIGH, "high")] };

/// out = high or low, in volts.
fn output_law(builder: &mut dyn Builder) -> Register {
    let position = builder.new_mode(POSITION, LOW);
    builder.chatter_remedy(position, ChatterRemedy::TwoThresholds);
    let (half, high, low) = (builder.constant(0.5), builder.get("high"), builder.get("low"));
    builder.select(position.value, half, high, low)
}

/// High if in - against >= threshold, and low if it is below, in volts.
///
/// The guards are complementary: one includes the threshold and the other does not.
fn memory_law(builder: &mut dyn Builder) {
    let (position, signal) = (builder.own_mode(), difference(builder));
    let threshold = builder.get("threshold");
    let above = builder.subtract(signal, threshold);
    let below = builder.subtract(threshold, signal);
    builder.transition(position, Transition::new(LOW, HIGH, Guard::reached(above)));
    builder.transition(position, Transition::new(HIGH, LOW, Guard::passed(below)));
}
