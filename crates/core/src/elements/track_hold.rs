//! Track-and-hold amplifier.
//!
//! The element remembers its output at the end of the last step. While it holds, this value is the output; the mode
//! says whether it holds.

use super::{Input, Kind, PartUse, Setting, SettingQuantity};
use crate::ir::{Builder, Guard, ModeHandle, ModeNames, Register, Transition};
use crate::machines::Part;

/// The row of the track-and-hold amplifier. Its control acts through the memory only.
pub(super) static KIND: Kind = Kind {
    name: "track-hold",
    summary: "track-and-hold amplifier: follows its input inverted, or keeps its output",
    law: "out = -in while track >= threshold; otherwise out keeps its value from the instant at which track fell \
          below it; if the input jumps at that instant, the value before the jump",
    modes: "in initial condition it tracks if its control says so, otherwise its output is initial; in hold its \
            output changes only if its input or its control is changed by hand",
    source: "track-store amplifiers of the hybrid machines",
    symbol: "track-hold",
    inputs: &[
        Input::jack("in", "voltage that it follows"),
        Input::jack("track", "control: it tracks while this is at or above the threshold").remembered(),
    ],
    settings: &[
        Setting::preset("threshold", SettingQuantity::Volts, 0.0, "control voltage from which it tracks"),
        Setting::preset(
            "initial",
            SettingQuantity::Volts,
            0.0,
            "output in initial condition if it does not track",
        ),
    ],
    parts: &[PartUse::always(Part::TrackHold, 1)],
    output_law,
    memory_law: Some(memory_law),
    ..Kind::AMPLIFIER
};

/// Mode while the output is kept.
const HOLDING: f64 = 0.0;
/// Mode while the output follows the input.
const TRACKING: f64 = 1.0;

/// The mode of the amplifier.
const POSITION: ModeNames =
    ModeNames { mode: "position", values: &[(HOLDING, "holding"), (TRACKING, "tracking")] };

/// out = -in while tracking, and otherwise the sampled output, in volts.
fn output_law(builder: &mut dyn Builder) -> Register {
    let (held, position) = (builder.new_sampled_value("initial"), builder.new_mode(POSITION, HOLDING));
    let signal = builder.input("in");
    let (followed, half) = (builder.negate(signal), builder.constant(0.5));
    builder.select(position.value, half, followed, held)
}

/// Samples the output at the end of every step, and switches the mode by the control.
fn memory_law(builder: &mut dyn Builder) {
    let output = builder.own_output();
    builder.set_next_sample(output);
    let position = builder.own_mode();
    switches(builder, position);
}

/// Tracks if track >= threshold, and holds if it is below, in volts.
///
/// The guards are complementary: one includes the threshold and the other does not.
fn switches(builder: &mut dyn Builder, position: ModeHandle) {
    let (control, threshold) = (builder.input("track"), builder.get("threshold"));
    let above = builder.subtract(control, threshold);
    let below = builder.subtract(threshold, control);
    builder.transition(position, Transition::new(HOLDING, TRACKING, Guard::reached(above)));
    builder.transition(position, Transition::new(TRACKING, HOLDING, Guard::passed(below)));
}
