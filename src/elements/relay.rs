//! Comparator with a relay: hysteresis between two contacts.

use crate::machines::{Part, REFERENCE};
use crate::program::{Guard, Lowering, Register, Transition};

use super::{Default, Family, Input, Jacks, Kind, Measure, Output, Setting, Takes};

const RELEASED: f64 = 0.0;
const PULLED_IN: f64 = 1.0;

const fn contact(name: &'static str, description: &'static str) -> Input {
    Input { name, jacks: Jacks::One, required: true, direct: true, description }
}

const fn threshold(name: &'static str, description: &'static str) -> Setting {
    Setting {
        name,
        measure: Measure::Volts,
        default: Default::Required,
        range: (-REFERENCE, REFERENCE),
        description,
    }
}

pub(super) static KIND: Kind = Kind {
    name: "relay",
    family: Family::Computing,
    summary: "comparator with a relay: connects one of two voltages, with hysteresis",
    law: "pulls in when in >= pull_in, releases when in <= drop_out; out = on while pulled in, off while released",
    overload: "has no amplifier: cannot overload",
    modes: "in initial condition and at the start of operate it is as its thresholds and \"closed\" say; stays in hold",
    source: "comparator relay of the general-purpose machines; thesis 2 (eq. 37.2, 38.2) tells of friction made with relays",
    symbol: "relay",
    inputs: &[
        Input {
            name: "in",
            jacks: Jacks::One,
            required: true,
            direct: false,
            description: "what is compared",
        },
        contact("on", "passed on while pulled in"),
        contact("off", "passed on while released"),
    ],
    settings: &[
        threshold("pull_in", "input at which it pulls in"),
        threshold("drop_out", "input at which it releases; below pull_in"),
        Setting {
            name: "closed",
            measure: Measure::Flag,
            default: Default::Number(0.0),
            range: (0.0, 1.0),
            description: "whether it starts pulled in when its input starts between the thresholds",
        },
    ],
    ordered: &[("drop_out", "pull_in")],
    parts: &[Takes::always(Part::Relay, 1)],
    output: Output::Passive,
    output_law,
    memory_law: Some(memory_law),
};

fn output_law(lowering: &mut Lowering<'_>) -> Register {
    let start = if lowering.flag("closed") { PULLED_IN } else { RELEASED };
    let position = lowering.new_mode(start);
    let half = lowering.constant(0.5);
    let (on, off) = (lowering.input("on"), lowering.input("off"));
    lowering.select(position, half, on, off)
}

fn memory_law(lowering: &mut Lowering<'_>) {
    let signal = lowering.input("in");
    let (pull_in, drop_out) = (lowering.get("pull_in"), lowering.get("drop_out"));
    let above = lowering.subtract(signal, pull_in);
    let below = lowering.subtract(drop_out, signal);
    lowering.transition(Transition::new(RELEASED, PULLED_IN, Guard::reached(above)));
    lowering.transition(Transition::new(PULLED_IN, RELEASED, Guard::reached(below)));
}
