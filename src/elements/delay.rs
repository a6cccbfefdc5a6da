//! Delay line.

use crate::machines::{Part, REFERENCE};
use crate::program::{Lowering, Register};

use super::{Default, Family, Input, Jacks, Kind, Measure, Output, Setting, Takes};

pub(super) static KIND: Kind = Kind {
    name: "delay",
    family: Family::Computing,
    summary: "delay line: gives back what went in some time ago",
    law: "out(t) = in(t - delay); before that, initial",
    overload: "has no amplifier: cannot overload",
    modes: "gives initial in initial condition, empty at the start of operate; stays in hold",
    source: "tape and bucket-brigade delays of the general-purpose machines",
    symbol: "delay",
    inputs: &[Input {
        name: "in",
        jacks: Jacks::One,
        required: true,
        direct: false,
        description: "what is delayed",
    }],
    settings: &[
        Setting {
            name: "delay",
            measure: Measure::MachineSeconds,
            default: Default::Required,
            range: (1e-9, 1e6),
            description: "time between in and out; at least one step of the run, four for its full accuracy",
        },
        Setting {
            name: "initial",
            measure: Measure::Volts,
            default: Default::Number(0.0),
            range: (-REFERENCE, REFERENCE),
            description: "what comes out until the first input arrives",
        },
    ],
    ordered: &[],
    parts: &[Takes::always(Part::DelayLine, 1)],
    output: Output::Passive,
    output_law,
    memory_law: Some(memory_law),
};

fn output_law(lowering: &mut Lowering<'_>) -> Register {
    lowering.new_delay("delay", "initial")
}

fn memory_law(lowering: &mut Lowering<'_>) {
    let signal = lowering.input("in");
    lowering.set_delay_input(signal);
}
