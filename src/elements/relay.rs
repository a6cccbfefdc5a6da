//! Comparator with a relay: two contacts, hysteresis between them.

use crate::machines::Part;
use crate::program::{Calm, Guard, Lowering, Register, Transition};

use super::{Input, Kind, Measure, Setting, Takes};

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

fn output_law(lowering: &mut Lowering<'_>) -> Register {
    let start = if lowering.flag("closed") { PULLED_IN } else { RELEASED };
    let position = lowering.new_mode(start);
    lowering.calmed_by(position, Calm::Hysteresis);
    let half = lowering.constant(0.5);
    let (on, off) = (lowering.input("on"), lowering.input("off"));
    lowering.select(position.value, half, on, off)
}

fn memory_law(lowering: &mut Lowering<'_>) {
    let (position, signal) = (lowering.own_mode(), compared(lowering));
    let (pull_in, drop_out) = (lowering.get("pull_in"), lowering.get("drop_out"));
    let above = lowering.subtract(signal, pull_in);
    let below = lowering.subtract(drop_out, signal);
    lowering.transition(position, Transition::new(RELEASED, PULLED_IN, Guard::reached(above)));
    lowering.transition(position, Transition::new(PULLED_IN, RELEASED, Guard::reached(below)));
}

/// The difference between the two inputs.
fn compared(lowering: &mut Lowering<'_>) -> Register {
    let signal = lowering.input("in");
    if !lowering.is_driven("against") {
        return signal;
    }
    let other = lowering.input("against");
    lowering.subtract(signal, other)
}
