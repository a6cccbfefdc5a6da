//! Track-and-hold amplifier.

use super::{Input, Kind, Measure, Setting, Takes};
use crate::ir::{Builder, Guard, ModeHandle, Register, Transition};
use crate::machines::Part;

pub(super) static KIND: Kind = Kind {
    name: "track-hold",
    summary: "track-and-hold amplifier: follows its input and inverts, or keeps the output that it had",
    law: "out = -in while track >= threshold; otherwise out stays as it was when track fell below it: of an input \
          that jumps at that instant, as before the jump",
    modes: "in initial condition it tracks as its control says, or holds initial; in hold its output moves only \
            where a hand moves its input or its control",
    source: "track-store amplifiers of the hybrid machines",
    symbol: "track-hold",
    inputs: &[
        Input::jack("in", "what is followed"),
        Input::jack("track", "control: it tracks while this is at the threshold or above").remembered(),
    ],
    settings: &[
        Setting::preset("threshold", Measure::Volts, 0.0, "voltage of the control from which on it tracks"),
        Setting::preset("initial", Measure::Volts, 0.0, "output that it holds when it starts in hold"),
    ],
    parts: &[Takes::always(Part::TrackHold, 1)],
    output_law,
    memory_law: Some(memory_law),
    ..Kind::AMPLIFIER
};

const HOLDING: f64 = 0.0;
const TRACKING: f64 = 1.0;

fn output_law(builder: &mut dyn Builder) -> Register {
    let (held, position) = (builder.new_memory("initial"), builder.new_mode(HOLDING));
    let signal = builder.input("in");
    let (followed, half) = (builder.negate(signal), builder.constant(0.5));
    builder.select(position.value, half, followed, held)
}

fn memory_law(builder: &mut dyn Builder) {
    let output = builder.own_output();
    builder.remember(output);
    let position = builder.own_mode();
    switches(builder, position);
}

fn switches(builder: &mut dyn Builder, position: ModeHandle) {
    let (control, threshold) = (builder.input("track"), builder.get("threshold"));
    let above = builder.subtract(control, threshold);
    let below = builder.subtract(threshold, control);
    builder.transition(position, Transition::new(HOLDING, TRACKING, Guard::reached(above)));
    builder.transition(position, Transition::new(TRACKING, HOLDING, Guard::passed(below)));
}
