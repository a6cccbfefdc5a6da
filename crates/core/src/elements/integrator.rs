//! Integrating amplifier, with or without diode limits, a brake and rebound stops.

use super::{Input, Jacks, Kind, Measure, Output, Setting, Takes, Transfer, soft_limit};
use crate::ir::{Builder, Calm, Guard, ModeHandle, Register, Transition};
use crate::machines::{Part, REFERENCE};

pub(super) static KIND: Kind = Kind {
    name: "integrator",
    summary: "integrating amplifier: integrates its inputs over machine time, each times its gain, and inverts",
    law: "d out / dt = -(sum of gain x input); with a brake: at out = 0 and |sum| <= brake it stands still, \
          otherwise brake x sign(out) is subtracted from d out / dt; with a gap: when the lowest gap closes \
          (falls to 0), out becomes -restitution x out; with a limit: out stands there (the drop beyond it) while \
          d out / dt points outward",
    overload: "stops at ±100 V and leaves at once when its input turns; the lamp lights when more is asked for, and \
               stays dark at a diode limit",
    modes: "stands at initial in initial condition; keeps its output in hold",
    source: "thesis 8.1; limits: diodes across the amplifier, as in 8.2, Fig 8.9; brake: Coulomb friction as a force that knows the net force",
    symbol: "integrator",
    inputs: &[
        Input::gains("x", "summing inputs, the gain per machine second in the name").remembered(),
        Input::gains("brake_x", "brake level (>= 0), the gain per machine second in the name; levels add")
            .remembered()
            .open(),
        Input::jack("gap", "distance to a stop that throws the output back when it falls to 0")
            .jacks(Jacks::Any)
            .remembered()
            .open(),
    ],
    settings: &[
        Setting::preset("initial", Measure::Volts, 0.0, "output in initial condition"),
        Setting::preset("restitution", Measure::Ratio, 1.0, "share of the output that a stop throws back")
            .within(0.0, 1.0),
        Setting::preset(
            "rest",
            Measure::Volts,
            1e-3,
            "output thrown back below which it comes to rest against the stop",
        )
        .within(0.0, REFERENCE),
        soft_limit::UPPER,
        soft_limit::LOWER,
        soft_limit::DROP,
    ],
    ordered: &[("limit.lower", "limit.upper")],
    bounded: &[("limit.lower", "initial", "limit.upper")],
    parts: &[
        Takes::always(Part::Integrator, 1),
        Takes::with("brake_x", Part::Brake, 1),
        Takes::with("gap", Part::Rebound, 1),
        soft_limit::LIMIT_PARTS[0],
        soft_limit::LIMIT_PARTS[1],
        soft_limit::LIMIT_PARTS[2],
    ],
    output: Output::Integrator,
    transfer: Transfer::Integrating,
    output_law,
    memory_law: Some(memory_law),
    ..Kind::NETWORK
};

fn output_law(builder: &mut dyn Builder) -> Register {
    builder.new_state("initial")
}

fn memory_law(builder: &mut dyn Builder) {
    let sum = builder.sum("x");
    let mut rate = builder.negate(sum);
    let brake_mode = builder.is_driven("brake_x").then(|| builder.new_mode(STUCK));
    if let Some(direction) = brake_mode {
        rate = brake(builder, direction, rate);
    }
    if builder.is_driven("gap") {
        rate = rebound(builder, brake_mode, rate);
    }
    let knees = soft_limit::knees(builder);
    builder.set_rate_within(rate, knees);
}

/// The brake holds; its other modes are the sign of the output while it slips.
const STUCK: f64 = 0.0;

fn brake(builder: &mut dyn Builder, direction: ModeHandle, net: Register) -> Register {
    let level = builder.sum("brake_x");
    let (zero, out) = (builder.constant(0.0), builder.own_output());
    let level = builder.maximum(level, zero);
    let sides = [1.0, -1.0].map(|sign| {
        let along = builder.constant(sign);
        (sign, along, builder.multiply(along, out))
    });
    // What moves slips the way it moves, whatever drives it: these come before those of what stands still.
    for (sign, _, speed) in sides {
        builder.transition(direction, Transition::new(STUCK, sign, Guard::passed(speed)));
    }
    for (sign, along, speed) in sides {
        let pull = builder.multiply(along, net);
        let excess = builder.subtract(pull, level);
        let (short, back) = (builder.negate(excess), builder.negate(speed));
        let stops = builder.minimum(back, short);
        builder.transition(direction, Transition::new(STUCK, sign, Guard::passed(excess)));
        let stop = Transition::new(sign, STUCK, Guard::reached(stops)).reset(builder, zero);
        builder.transition(direction, stop);
    }
    let friction = builder.multiply(level, direction.value);
    let slipping = builder.subtract(net, friction);
    let size = builder.absolute(direction.value);
    let half = builder.constant(0.5);
    builder.select(size, half, slipping, zero)
}

/// Clear of the stops; the other modes carry the sign of the output that closed the gap.
const CLEAR: f64 = 0.0;
/// Thrown back, and not yet clear of the stop.
const THROWN: f64 = 1.0;
/// At rest against the stop.
const RESTING: f64 = 2.0;

fn rebound(builder: &mut dyn Builder, brake: Option<ModeHandle>, rate: Register) -> Register {
    let contact = builder.new_mode(CLEAR);
    builder.calmed_by(contact, Calm::Rest);
    let gaps = builder.inputs("gap");
    let gap = gaps.iter().copied().reduce(|a, b| builder.minimum(a, b));
    let gap = gap.unwrap_or_else(|| builder.constant(0.0));
    let (zero, out) = (builder.constant(0.0), builder.own_output());
    let thrown = thrown_back(builder, out);
    let (overlap, slow) = (builder.negate(gap), slowness(builder, thrown));
    for sign in [1.0, -1.0] {
        let along = builder.constant(sign);
        let (closing, pull) = (builder.multiply(along, out), builder.multiply(along, rate));
        let hits = builder.minimum(overlap, closing);
        let settles = builder.minimum(hits, slow);
        let leaves = builder.negate(pull);
        for from in [CLEAR, sign * THROWN] {
            let rests = Transition::new(from, sign * RESTING, Guard::passed(settles)).reset(builder, zero);
            builder.transition(contact, begins_anew(rests, brake));
            let bounces = Transition::new(from, sign * THROWN, Guard::passed(hits)).reset(builder, thrown);
            builder.transition(contact, begins_anew(bounces, brake));
        }
        builder.transition(contact, Transition::new(sign * THROWN, CLEAR, Guard::passed(gap)));
        builder.transition(contact, Transition::new(sign * RESTING, CLEAR, Guard::passed(gap)));
        builder.transition(contact, Transition::new(sign * RESTING, sign * THROWN, Guard::passed(leaves)));
    }
    let size = builder.absolute(contact.value);
    let resting = builder.constant((THROWN + RESTING) / 2.0);
    builder.select(size, resting, zero, rate)
}

/// After a blow the brake finds the direction of slip anew.
fn begins_anew(blow: Transition, brake: Option<ModeHandle>) -> Transition {
    match brake {
        Some(direction) => blow.and_sets(direction, STUCK),
        None => blow,
    }
}

fn thrown_back(builder: &mut dyn Builder, out: Register) -> Register {
    let restitution = builder.get("restitution");
    let kept = builder.multiply(restitution, out);
    builder.negate(kept)
}

/// How far the output thrown back lies under the level of rest.
fn slowness(builder: &mut dyn Builder, thrown: Register) -> Register {
    let (rest, speed) = (builder.get("rest"), builder.absolute(thrown));
    builder.subtract(rest, speed)
}
