//! Track-and-hold amplifier.

use crate::machines::Part;
use crate::program::{Guard, Lowering, ModeHandle, Register, Transition};

use super::{Input, Kind, Measure, Setting, Takes};

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

fn output_law(lowering: &mut Lowering<'_>) -> Register {
    let (held, position) = (lowering.new_memory("initial"), lowering.new_mode(HOLDING));
    let signal = lowering.input("in");
    let (followed, half) = (lowering.negate(signal), lowering.constant(0.5));
    lowering.select(position.value, half, followed, held)
}

fn memory_law(lowering: &mut Lowering<'_>) {
    let output = lowering.own_output();
    lowering.remember(output);
    let position = lowering.own_mode();
    switches(lowering, position);
}

fn switches(lowering: &mut Lowering<'_>, position: ModeHandle) {
    let (control, threshold) = (lowering.input("track"), lowering.get("threshold"));
    let above = lowering.subtract(control, threshold);
    let below = lowering.subtract(threshold, control);
    lowering.transition(position, Transition::new(HOLDING, TRACKING, Guard::reached(above)));
    lowering.transition(position, Transition::new(TRACKING, HOLDING, Guard::passed(below)));
}
