//! Integrating amplifier, with or without diode limits, a brake and rebound stops.

use crate::machines::{Part, REFERENCE};
use crate::program::{Calm, Guard, Lowering, ModeHandle, Register, Transition};

use super::{Input, Jacks, Kind, Measure, Output, Setting, Takes, Transfer, soft_limit};

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

fn output_law(lowering: &mut Lowering<'_>) -> Register {
    lowering.new_state("initial")
}

fn memory_law(lowering: &mut Lowering<'_>) {
    let sum = lowering.sum("x");
    let mut rate = lowering.negate(sum);
    let brake_mode = lowering.is_driven("brake_x").then(|| lowering.new_mode(STUCK));
    if let Some(direction) = brake_mode {
        rate = brake(lowering, direction, rate);
    }
    if lowering.is_driven("gap") {
        rate = rebound(lowering, brake_mode, rate);
    }
    let knees = soft_limit::knees(lowering);
    lowering.set_rate_within(rate, knees);
}

/// The brake holds; its other modes are the sign of the output while it slips.
const STUCK: f64 = 0.0;

fn brake(lowering: &mut Lowering<'_>, direction: ModeHandle, net: Register) -> Register {
    let level = lowering.sum("brake_x");
    let (zero, out) = (lowering.constant(0.0), lowering.own_output());
    let level = lowering.maximum(level, zero);
    let sides = [1.0, -1.0].map(|sign| {
        let along = lowering.constant(sign);
        (sign, along, lowering.multiply(along, out))
    });
    // What moves slips the way it moves, whatever drives it: these come before those of what stands still.
    for (sign, _, speed) in sides {
        lowering.transition(direction, Transition::new(STUCK, sign, Guard::passed(speed)));
    }
    for (sign, along, speed) in sides {
        let pull = lowering.multiply(along, net);
        let excess = lowering.subtract(pull, level);
        let (short, back) = (lowering.negate(excess), lowering.negate(speed));
        let stops = lowering.minimum(back, short);
        lowering.transition(direction, Transition::new(STUCK, sign, Guard::passed(excess)));
        let stop = Transition::new(sign, STUCK, Guard::reached(stops)).reset(lowering, zero);
        lowering.transition(direction, stop);
    }
    let friction = lowering.multiply(level, direction.value);
    let slipping = lowering.subtract(net, friction);
    let size = lowering.absolute(direction.value);
    let half = lowering.constant(0.5);
    lowering.select(size, half, slipping, zero)
}

/// Clear of the stops; the other modes carry the sign of the output that closed the gap.
const CLEAR: f64 = 0.0;
/// Thrown back, and not yet clear of the stop.
const THROWN: f64 = 1.0;
/// At rest against the stop.
const RESTING: f64 = 2.0;

fn rebound(lowering: &mut Lowering<'_>, brake: Option<ModeHandle>, rate: Register) -> Register {
    let contact = lowering.new_mode(CLEAR);
    lowering.calmed_by(contact, Calm::Rest);
    let gaps = lowering.inputs("gap");
    let gap = gaps.iter().copied().reduce(|a, b| lowering.minimum(a, b));
    let gap = gap.unwrap_or_else(|| lowering.constant(0.0));
    let (zero, out) = (lowering.constant(0.0), lowering.own_output());
    let thrown = thrown_back(lowering, out);
    let (overlap, slow) = (lowering.negate(gap), slowness(lowering, thrown));
    for sign in [1.0, -1.0] {
        let along = lowering.constant(sign);
        let (closing, pull) = (lowering.multiply(along, out), lowering.multiply(along, rate));
        let hits = lowering.minimum(overlap, closing);
        let settles = lowering.minimum(hits, slow);
        let leaves = lowering.negate(pull);
        for from in [CLEAR, sign * THROWN] {
            let rests = Transition::new(from, sign * RESTING, Guard::passed(settles)).reset(lowering, zero);
            lowering.transition(contact, begins_anew(rests, brake));
            let bounces = Transition::new(from, sign * THROWN, Guard::passed(hits)).reset(lowering, thrown);
            lowering.transition(contact, begins_anew(bounces, brake));
        }
        lowering.transition(contact, Transition::new(sign * THROWN, CLEAR, Guard::passed(gap)));
        lowering.transition(contact, Transition::new(sign * RESTING, CLEAR, Guard::passed(gap)));
        lowering.transition(contact, Transition::new(sign * RESTING, sign * THROWN, Guard::passed(leaves)));
    }
    let size = lowering.absolute(contact.value);
    let resting = lowering.constant((THROWN + RESTING) / 2.0);
    lowering.select(size, resting, zero, rate)
}

/// After a blow the brake finds the direction of slip anew.
fn begins_anew(blow: Transition, brake: Option<ModeHandle>) -> Transition {
    match brake {
        Some(direction) => blow.and_sets(direction, STUCK),
        None => blow,
    }
}

fn thrown_back(lowering: &mut Lowering<'_>, out: Register) -> Register {
    let restitution = lowering.get("restitution");
    let kept = lowering.multiply(restitution, out);
    lowering.negate(kept)
}

/// How far the output thrown back lies under the level of rest.
fn slowness(lowering: &mut Lowering<'_>, thrown: Register) -> Register {
    let (rest, speed) = (lowering.get("rest"), lowering.absolute(thrown));
    lowering.subtract(rest, speed)
}
