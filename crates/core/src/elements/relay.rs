//! Comparator with a relay: two contacts, hysteresis between them.

use super::{Input, Kind, Measure, Setting, Takes};
use crate::ir::{Builder, Calm, Guard, Register, Transition};
use crate::machines::Part;

const RELEASED: f64 = 0.0;
const PULLED_IN: f64 = 1.0;

pub(super) static KIND: Kind = Kind {
    name: "relay",
    summary: "comparator with a relay: compares two voltages and connects one of two others, with hysteresis",
    law: "pulls in when in - against >= pull_in, releases when in - against <= drop_out; out = on while pulled in, off while released",
    modes: "in initial condition it is as its inputs, its thresholds and \"closed\" say; in hold it \
            switches only where a hand moves what it compares",
    source: "comparator relay of the general-purpose machines",
    symbol: "relay",
    inputs: &[
        Input::jack("in", "what is compared").remembered(),
        Input::jack("on", "passed on while pulled in"),
        Input::jack("off", "passed on while released"),
        Input::jack("against", "what it is compared with; ground where left open").remembered().open(),
    ],
    settings: &[
        Setting::required("pull_in", Measure::Volts, "in - against at which it pulls in"),
        Setting::required("drop_out", Measure::Volts, "in - against at which it releases; below pull_in"),
        Setting::preset(
            "closed",
            Measure::Flag,
            0.0,
            "whether it starts pulled in when in - against starts between the thresholds",
        ),
    ],
    ordered: &[("drop_out", "pull_in")],
    positions: &["released", "pulled-in"],
    parts: &[Takes::always(Part::Relay, 1)],
    output_law,
    memory_law: Some(memory_law),
    ..Kind::NETWORK
};

fn output_law(builder: &mut dyn Builder) -> Register {
    let start = if builder.flag("closed") { PULLED_IN } else { RELEASED };
    let position = builder.new_mode(start);
    builder.calmed_by(position, Calm::Hysteresis);
    let half = builder.constant(0.5);
    let (on, off) = (builder.input("on"), builder.input("off"));
    builder.select(position.value, half, on, off)
}

fn memory_law(builder: &mut dyn Builder) {
    let (position, signal) = (builder.own_mode(), compared(builder));
    let (pull_in, drop_out) = (builder.get("pull_in"), builder.get("drop_out"));
    let above = builder.subtract(signal, pull_in);
    let below = builder.subtract(drop_out, signal);
    builder.transition(position, Transition::new(RELEASED, PULLED_IN, Guard::reached(above)));
    builder.transition(position, Transition::new(PULLED_IN, RELEASED, Guard::reached(below)));
}

/// The difference between the two inputs.
fn compared(builder: &mut dyn Builder) -> Register {
    let signal = builder.input("in");
    if !builder.is_driven("against") {
        return signal;
    }
    let other = builder.input("against");
    builder.subtract(signal, other)
}
