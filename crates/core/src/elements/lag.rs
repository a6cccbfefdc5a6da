//! First-order lag: an integrating amplifier with a resistor across its capacitor.
//!
//! The output is the state of the element. With equal steps, the machine refuses a time constant that is shorter than
//! the step: the method would be inaccurate and, from 2.8 time constants on, unstable.

use super::{Input, Kind, OutputStage, PartUse, Setting, SettingQuantity};
use crate::ir::{Builder, Register};
use crate::machines::Part;

/// The row of the lag. The scaling audit does not follow it, because its gain depends on the frequency.
pub(super) static KIND: Kind = Kind {
    name: "lag",
    summary: "first-order lag: an integrating amplifier with a resistor across its capacitor; inverts",
    law: "time x d out / dt = -(sum of gain x input) - out; a step reaches 63 % after time; a sine of frequency 1 / \
          (2 pi time) has 0.7071 of its amplitude and lags by 45 degrees",
    overload: "limited to ±100 V and leaves the limit as soon as its input reverses; the lamp lights if the demanded \
               output exceeds this",
    modes: "has the value initial in initial condition; keeps its output in hold",
    source: "thesis 8.3, Fig 8.15",
    symbol: "lag",
    inputs: &[Input::gains("x", "summing inputs, the gain for slow signals in the name").remembered()],
    settings: &[
        Setting::required(
            "time",
            SettingQuantity::MachineSeconds,
            "time constant; at least one step of the run",
        )
        .within(1e-9, 1e6),
        Setting::preset("initial", SettingQuantity::Volts, 0.0, "output in initial condition"),
    ],
    parts: &[PartUse::always(Part::Integrator, 1)],
    output: OutputStage::Integrator,
    output_law,
    memory_law: Some(memory_law),
    ..Kind::NETWORK
};

/// out is the state, in volts. It begins at `initial`.
fn output_law(builder: &mut dyn Builder) -> Register {
    builder.new_state("initial")
}

/// d out / dt = (-(sum of gain x input) - out) / time, in volts per machine second.
///
/// The transfer function is -gain / (1 + time x s), with `time` in machine seconds.
fn memory_law(builder: &mut dyn Builder) {
    let (sum, out) = (builder.sum("x"), builder.own_output());
    let target = builder.negate(sum);
    let difference = builder.subtract(target, out);
    let time = builder.time_constant("time");
    let rate = builder.divide(difference, time);
    builder.set_rate(rate);
}
