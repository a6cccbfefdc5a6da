//! Backlash: the play of gears and spindles.

use super::{Input, Kind, Measure, Setting, Takes};
use crate::ir::{Builder, Register};
use crate::machines::{Part, REFERENCE};

pub(super) static KIND: Kind = Kind {
    name: "backlash",
    summary: "play operator: stays where it is until its input has crossed the play, then is pushed along",
    law: "out stays while |in - out| < width / 2, and is pushed along at that distance otherwise; where in turns \
          within a step of length h, out stays up to h^2 / 8 x |d2 in / dt2| short of where it was pushed to; exact \
          where it turns at the end of one",
    modes: "in initial condition it is initial, pushed as far as its input asks for; in hold its output moves only \
            where a hand moves its input",
    source: "backlash circuits of the handbooks: an integrator of high gain behind a dead zone",
    symbol: "backlash",
    inputs: &[Input::jack("in", "what pushes")],
    settings: &[
        Setting::required("width", Measure::Volts, "the whole play").within(0.0, REFERENCE),
        Setting::preset("initial", Measure::Volts, 0.0, "output in initial condition, unless it is pushed"),
    ],
    parts: &[
        Takes::always(Part::Summer, 1),
        Takes::always(Part::Integrator, 1),
        Takes::always(Part::DiodePair, 1),
        Takes::always(Part::FreePot, 2),
    ],
    output_law,
    memory_law: Some(memory_law),
    ..Kind::AMPLIFIER
};

// Where it is just pushed, the push counts: its derivative there is that of its input.
fn output_law(builder: &mut dyn Builder) -> Register {
    let (was, signal, width) = (builder.new_memory("initial"), builder.input("in"), builder.get("width"));
    let half = builder.constant(0.5);
    let play = builder.multiply(half, width);
    let (least, most) = (builder.subtract(signal, play), builder.add(signal, play));
    let pushed = builder.maximum(least, was);
    builder.minimum(most, pushed)
}

fn memory_law(builder: &mut dyn Builder) {
    let output = builder.own_output();
    builder.remember(output);
}
