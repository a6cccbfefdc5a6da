//! Delay line: the input of some time ago.
//!
//! The stored inputs are outside of the program, in a delay line of the machine. The law only names the setting of the
//! delay, the first output and the input.

use super::{Input, Kind, PartUse, Setting, SettingQuantity};
use crate::ir::{Builder, Register};
use crate::machines::Part;

/// The row of the delay line. Its input acts through the memory only, so a delay line in a loop leaves no loop to
/// solve.
pub(super) static KIND: Kind = Kind {
    name: "delay",
    summary: "delay line: its output is the input of some time ago",
    law: "out(t) = in(t - delay) for t >= delay, and initial before",
    modes: "has the value initial in initial condition and contains no input at the start of operate; keeps its \
            output in hold",
    source: "tape and bucket-brigade delays of the general-purpose machines",
    symbol: "delay",
    inputs: &[Input::jack("in", "input voltage").remembered()],
    settings: &[
        Setting::required(
            "delay",
            SettingQuantity::MachineSeconds,
            "time between input and output; at least one step of the run, four for full accuracy",
        )
        .within(1e-9, 1e6),
        Setting::preset("initial", SettingQuantity::Volts, 0.0, "output until the first input arrives"),
    ],
    parts: &[PartUse::always(Part::DelayLine, 1)],
    output_law,
    memory_law: Some(memory_law),
    ..Kind::NETWORK
};

/// out(t) = in(t - delay), in volts; `initial` while nothing has arrived. The delay is in machine seconds.
fn output_law(builder: &mut dyn Builder) -> Register {
    builder.new_delay("delay", "initial")
}

/// Passes the input to the delay line at the end of every step.
fn memory_law(builder: &mut dyn Builder) {
    let signal = builder.input("in");
    builder.set_delay_input(signal);
}
