//! First-order lag: an integrating amplifier with a resistor across its capacitor.

use super::{Input, Kind, Measure, Output, Setting, Takes};
use crate::ir::{Builder, Register};
use crate::machines::Part;

pub(super) static KIND: Kind = Kind {
    name: "lag",
    summary: "first-order lag: an integrating amplifier with a resistor across its capacitor; follows late, and inverts",
    law: "time x d out / dt = -(sum of gain x input) - out: a constant sum is followed to 63 % after time; a sine of \
          1 / (2 pi time) comes out as 0.7071 of it, 45 degrees late",
    overload: "stops at ±100 V and leaves at once when its input turns; the lamp lights when more is asked for",
    modes: "stands at initial in initial condition; keeps its output in hold",
    source: "thesis 8.3, Fig 8.15",
    symbol: "lag",
    inputs: &[Input::gains("x", "summing inputs, the gain for slow signals in the name").remembered()],
    settings: &[
        Setting::required("time", Measure::MachineSeconds, "time constant; at least one step of the run")
            .within(1e-9, 1e6),
        Setting::preset("initial", Measure::Volts, 0.0, "output in initial condition"),
    ],
    parts: &[Takes::always(Part::Integrator, 1)],
    output: Output::Integrator,
    output_law,
    memory_law: Some(memory_law),
    ..Kind::NETWORK
};

fn output_law(builder: &mut dyn Builder) -> Register {
    builder.new_state("initial")
}

fn memory_law(builder: &mut dyn Builder) {
    let (sum, out) = (builder.sum("x"), builder.own_output());
    let asked = builder.negate(sum);
    let missing = builder.subtract(asked, out);
    let time = builder.time_constant("time");
    let rate = builder.divide(missing, time);
    builder.set_rate(rate);
}
