//! Backlash: the play of gears and spindles.
//!
//! The element remembers its output at the end of the last step. Within a step the output is a function of the input
//! and of this value, so the solver needs no state and no mode.

use super::{Input, Kind, PartUse, Setting, SettingQuantity};
use crate::ir::{Builder, Register};
use crate::machines::{Part, REFERENCE};

/// The parts are those of a play circuit: a dead zone of two free pots and a diode pair, then an integrator with a
/// summer in its feedback.
pub(super) static KIND: Kind = Kind {
    name: "backlash",
    summary: "play operator: keeps its output until the input has crossed the play, then follows at half the width",
    law: "out is constant while |in - out| < width / 2, and otherwise follows in at that distance; the instants at \
          which in reverses are located, and a step ends there",
    modes: "has the value initial in initial condition, moved into the play of its input; in hold its output changes \
            only if its input is changed by hand",
    source: "backlash circuits of the handbooks: an integrator of high gain behind a dead zone",
    symbol: "backlash",
    inputs: &[Input::jack("in", "input that moves the output")],
    settings: &[
        Setting::required("width", SettingQuantity::Volts, "total width of the play").within(0.0, REFERENCE),
        Setting::preset(
            "initial",
            SettingQuantity::Volts,
            0.0,
            "output in initial condition, if it is within the play",
        ),
    ],
    parts: &[
        PartUse::always(Part::Summer, 1),
        PartUse::always(Part::Integrator, 1),
        PartUse::always(Part::DiodePair, 1),
        PartUse::always(Part::FreePot, 2),
    ],
    output_law,
    memory_law: Some(memory_law),
    ..Kind::AMPLIFIER
};

/// out = min(in + width / 2, max(in - width / 2, was)), in volts, with `was` the output at the end of the last step.
///
/// At the edge of the play the output follows the input, so its derivative there is that of the input. Steps end where
/// the input turns, so that the output reaches its own turning points within 1e-10 V.
fn output_law(builder: &mut dyn Builder) -> Register {
    let (was, signal, width) =
        (builder.new_sampled_value("initial"), builder.input("in"), builder.get("width"));
    builder.sample_turning_points_of(signal);
    let half = builder.constant(0.5);
    let play = builder.multiply(half, width);
    let (least, most) = (builder.subtract(signal, play), builder.add(signal, play));
    let pushed = builder.maximum(least, was);
    builder.minimum(most, pushed)
}

/// Samples the output at the end of every step. In the next step it is the value that the input must push or pull.
fn memory_law(builder: &mut dyn Builder) {
    let output = builder.own_output();
    builder.set_next_sample(output);
}
