//! Delay line.

use super::{Input, Kind, Measure, Setting, Takes};
use crate::ir::{Builder, Register};
use crate::machines::Part;

pub(super) static KIND: Kind = Kind {
    name: "delay",
    summary: "delay line: gives back what went in some time ago",
    law: "out(t) = in(t - delay); before that, initial",
    modes: "gives initial in initial condition, empty at the start of operate; stays in hold",
    source: "tape and bucket-brigade delays of the general-purpose machines",
    symbol: "delay",
    inputs: &[Input::jack("in", "what is delayed").remembered()],
    settings: &[
        Setting::required(
            "delay",
            Measure::MachineSeconds,
            "time between in and out; at least one step of the run, four for its full accuracy",
        )
        .within(1e-9, 1e6),
        Setting::preset("initial", Measure::Volts, 0.0, "what comes out until the first input arrives"),
    ],
    parts: &[Takes::always(Part::DelayLine, 1)],
    output_law,
    memory_law: Some(memory_law),
    ..Kind::NETWORK
};

fn output_law(builder: &mut dyn Builder) -> Register {
    builder.new_delay("delay", "initial")
}

fn memory_law(builder: &mut dyn Builder) {
    let signal = builder.input("in");
    builder.set_delay_input(signal);
}
