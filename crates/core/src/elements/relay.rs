//! Comparator with a relay: two contacts, hysteresis between them.
//!
//! The position is a mode. The output law selects a contact by it, and the memory law switches it when the difference
//! of the compared inputs reaches a threshold. The distance of the thresholds prevents chatter. A comparator has one
//! threshold and no contacts.

use super::{Input, Kind, PartUse, Setting, SettingQuantity};
use crate::ir::{Builder, ChatterRemedy, Guard, ModeNames, Register, Transition};
use crate::machines::Part;

/// Mode while the relay is released: the contact `off` is connected. It is position 0.
const RELEASED: f64 = 0.0;
/// Mode while the relay is pulled in: the contact `on` is connected. It is position 1.
const PULLED_IN: f64 = 1.0;

/// The row of the relay. Only the compared inputs act through the memory; the contacts act in the same instant.
pub(super) static KIND: Kind = Kind {
    name: "relay",
    summary: "comparator with a relay: compares two voltages and connects one of two others, with hysteresis",
    law: "pulls in if in - against >= pull_in, releases if in - against <= drop_out; out = on while pulled in, out = \
          off while released",
    modes: "in initial condition its position follows from its inputs, its thresholds and \"closed\"; in hold it \
            switches only if its inputs are changed by hand",
    source: "comparator relay of the general-purpose machines",
    symbol: "relay",
    inputs: &[
        Input::jack("in", "voltage that is compared").remembered(),
        Input::jack("on", "output while pulled in"),
        Input::jack("off", "output while released"),
        Input::jack("against", "voltage with which it is compared; 0 V if open").remembered().open(),
    ],
    settings: &[
        Setting::required("pull_in", SettingQuantity::Volts, "in - against at which it pulls in"),
        Setting::required(
            "drop_out",
            SettingQuantity::Volts,
            "in - against at which it releases; below pull_in",
        ),
        Setting::preset(
            "closed",
            SettingQuantity::Flag,
            0.0,
            "whether it is pulled in initially if in - against is between the thresholds",
        ),
    ],
    ordered: &[("drop_out", "pull_in")],
    positions: &["released", "pulled-in"],
    parts: &[PartUse::always(Part::Relay, 1)],
    output_law,
    memory_law: Some(memory_law),
    ..Kind::NETWORK
};

/// The mode of the contacts.
const POSITION: ModeNames =
    ModeNames { mode: "position", values: &[(RELEASED, "released"), (PULLED_IN, "pulled in")] };

/// out = on while pulled in, off while released, in volts. The mode begins at the setting `closed`.
fn output_law(builder: &mut dyn Builder) -> Register {
    let start = if builder.flag("closed") { PULLED_IN } else { RELEASED };
    let position = builder.new_mode(POSITION, start);
    builder.chatter_remedy(position, ChatterRemedy::Hysteresis);
    let half = builder.constant(0.5);
    let (on, off) = (builder.input("on"), builder.input("off"));
    builder.select(position.value, half, on, off)
}

/// Pulls in if in - against >= pull_in, and releases if in - against <= drop_out. All voltages are in volts.
///
/// Both guards include the threshold itself. They cannot hold at once, because `drop_out` is below `pull_in`.
fn memory_law(builder: &mut dyn Builder) {
    let (position, signal) = (builder.own_mode(), difference(builder));
    let (pull_in, drop_out) = (builder.get("pull_in"), builder.get("drop_out"));
    let above = builder.subtract(signal, pull_in);
    let below = builder.subtract(drop_out, signal);
    builder.transition(position, Transition::new(RELEASED, PULLED_IN, Guard::reached(above)));
    builder.transition(position, Transition::new(PULLED_IN, RELEASED, Guard::reached(below)));
}

/// The difference of the two compared inputs, in volts; the first one alone if `against` is open.
pub(super) fn difference(builder: &mut dyn Builder) -> Register {
    let signal = builder.input("in");
    if !builder.is_driven("against") {
        return signal;
    }
    let other = builder.input("against");
    builder.subtract(signal, other)
}
