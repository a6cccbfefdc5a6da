//! Integrating amplifier, with or without diode limits, a brake, rebound stops and a reset.
//!
//! The output is the state of the element. The memory law gives its rate in this order: sum of the inputs, brake,
//! rebound, reset, limits. Brake, contact with a stop, reset and limits are modes, so the solver locates the instants
//! at which they change.

use super::{Input, Jacks, Kind, OutputStage, PartUse, Setting, SettingQuantity, Transfer, soft_limit};
use crate::ir::{Builder, ChatterRemedy, Guard, ModeHandle, ModeNames, Register, Transition};
use crate::machines::{Part, REFERENCE};

/// The row of the integrator. Every input acts through the rate only, so an integrator in a loop leaves no loop to
/// solve.
pub(super) static KIND: Kind = Kind {
    name: "integrator",
    summary: "integrating amplifier: integrates its inputs over machine time, each times its gain, and inverts",
    law: "d out / dt = -(sum of gain x input); with a brake: d out / dt = 0 while out = 0 and |sum| <= brake, \
          otherwise brake x sign(out) is subtracted from d out / dt; with a gap: when the lowest gap falls to 0, out \
          becomes -restitution x out; with a limit: out stays at the limit plus the drop while d out / dt points \
          outward; with a reset: out = initial while reset >= threshold, and it integrates from initial when reset \
          falls below the threshold",
    overload: "limited to ±100 V and leaves the limit as soon as its input reverses; the lamp lights if the demanded \
               output exceeds this, and stays dark at a diode limit",
    modes: "has the value initial in initial condition; keeps its output in hold, unless it is reset by hand",
    source: "thesis 8.1; limits: diodes across the amplifier, as in 8.2, Fig 8.9; brake: Coulomb friction that \
             balances the net force at rest; reset: electronic mode control of the hybrid machines",
    symbol: "integrator",
    inputs: &[
        Input::gains("x", "summing inputs, the gain per machine second in the name").remembered(),
        Input::gains("brake_x", "brake level (>= 0), the gain per machine second in the name; levels add")
            .remembered()
            .open(),
        Input::jack("gap", "distance to a stop; when it falls to 0, the output rebounds")
            .jacks(Jacks::Any)
            .remembered()
            .open(),
        Input::jack("reset", "control: it is reset while this is at or above threshold; never if open")
            .remembered()
            .open(),
    ],
    settings: &[
        Setting::preset("initial", SettingQuantity::Volts, 0.0, "output in initial condition"),
        Setting::preset(
            "restitution",
            SettingQuantity::Ratio,
            1.0,
            "share of the output that is kept at a rebound, with the opposite sign",
        )
        .within(0.0, 1.0),
        Setting::preset(
            "rest",
            SettingQuantity::Volts,
            1e-3,
            "output after a rebound below which it stays at rest against the stop",
        )
        .within(0.0, REFERENCE),
        Setting::preset(
            "threshold",
            SettingQuantity::Volts,
            1.0,
            "voltage of the reset input from which the output is initial",
        ),
        soft_limit::UPPER,
        soft_limit::LOWER,
        soft_limit::DROP,
    ],
    ordered: &[("limit.lower", "limit.upper")],
    bounded: &[("limit.lower", "initial", "limit.upper")],
    parts: &[
        PartUse::always(Part::Integrator, 1),
        PartUse::with("brake_x", Part::Brake, 1),
        PartUse::with("gap", Part::Rebound, 1),
        PartUse::with("reset", Part::ModeRelay, 1),
        soft_limit::LIMIT_PARTS[0],
        soft_limit::LIMIT_PARTS[1],
        soft_limit::LIMIT_PARTS[2],
    ],
    output: OutputStage::Integrator,
    transfer: Transfer::Integrating,
    output_law,
    memory_law: Some(memory_law),
    ..Kind::NETWORK
};

/// out is the state, in volts. It begins at `initial`.
fn output_law(builder: &mut dyn Builder) -> Register {
    builder.new_state("initial")
}

/// The modes of the optional parts; `None` if no cord is at their input.
#[derive(Clone, Copy)]
struct Modes {
    /// The mode of the brake.
    direction: Option<ModeHandle>,
    /// The mode of the contact with a stop.
    contact: Option<ModeHandle>,
    /// The mode of the reset. It is the last one: if several modes change at once, the reset sets the others.
    reset: Option<ModeHandle>,
}

/// d out / dt = -(sum of gain x input), in volts per machine second, as changed by brake, stops, reset and limits.
///
/// Without cords at `brake_x`, `gap` and `reset` their modes do not exist, so a plain integrator costs nothing more.
fn memory_law(builder: &mut dyn Builder) {
    let sum = builder.sum("x");
    let mut rate = builder.negate(sum);
    let modes = Modes {
        direction: builder.is_driven("brake_x").then(|| builder.new_mode(BRAKE, STUCK)),
        contact: builder.is_driven("gap").then(|| builder.new_mode(CONTACT, CLEAR)),
        reset: builder.is_driven("reset").then(|| builder.new_mode(RESET_CONTROL, OPERATING)),
    };
    if let Some(direction) = modes.direction {
        rate = brake(builder, direction, rate);
    }
    if let Some(contact) = modes.contact {
        rate = rebound(builder, contact, modes, rate);
    }
    if let Some(position) = modes.reset {
        rate = reset(builder, position, modes, rate);
    }
    let knees = soft_limit::knees(builder);
    builder.set_limited_rate(rate, knees);
}

/// Mode of a brake that holds. While it slips, the mode is the sign of the output.
const STUCK: f64 = 0.0;
/// The mode of the brake.
const BRAKE: ModeNames =
    ModeNames { mode: "brake", values: &[(STUCK, "stuck"), (1.0, "slipping up"), (-1.0, "slipping down")] };

/// The rate with Coulomb friction of a level b >= 0: 0 while stuck, net - b x direction while the output slips.
///
/// The brake holds while |net| <= b and the output is 0. It slips in the direction of the net rate as soon as |net|
/// exceeds b. It holds again when the output reaches 0 and the net rate does not exceed b in the direction of slip. If
/// the net rate exceeds b in the other direction, the output slips back at once. Levels below 0 count as 0. All rates
/// are in volts per machine second.
fn brake(builder: &mut dyn Builder, direction: ModeHandle, net: Register) -> Register {
    let level = builder.sum("brake_x");
    let (zero, out) = (builder.constant(0.0), builder.own_output());
    let level = builder.maximum(level, zero);
    let sides = [1.0, -1.0].map(|sign| {
        let along = builder.constant(sign);
        (sign, along, builder.multiply(along, out))
    });
    // A moving output slips in its direction of motion, whatever drives it. So these transitions come before those of
    // an output at rest.
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

/// Mode of an output that is clear of the stops. The other modes have the sign of the output that closed the gap.
const CLEAR: f64 = 0.0;
/// Mode after a rebound, until the output is clear of the stop.
const REBOUNDING: f64 = 1.0;
/// Mode at rest against the stop.
const RESTING: f64 = 2.0;
/// The mode of the stops.
const CONTACT: ModeNames = ModeNames {
    mode: "contact",
    values: &[
        (CLEAR, "clear"),
        (REBOUNDING, "rebounding down"),
        (-REBOUNDING, "rebounding up"),
        (RESTING, "pressed up"),
        (-RESTING, "pressed down"),
    ],
};

/// The rate with stops: 0 while the output rests against a stop, otherwise the given rate.
///
/// The smallest of the gaps decides. If it falls below 0 while the output closes it, the output jumps to -restitution x
/// out. If the size of that value is below `rest`, the output becomes 0 and stays there while the rate points into the
/// stop. The modes are CLEAR, ±REBOUNDING and ±RESTING; the sign is that of the output that closed the gap.
fn rebound(builder: &mut dyn Builder, contact: ModeHandle, modes: Modes, rate: Register) -> Register {
    builder.chatter_remedy(contact, ChatterRemedy::Rest);
    let gaps = builder.inputs("gap");
    let gap = gaps.iter().copied().reduce(|a, b| builder.minimum(a, b));
    let gap = gap.unwrap_or_else(|| builder.constant(0.0));
    let (zero, out) = (builder.constant(0.0), moving_output(builder, modes.reset));
    let after = rebound_output(builder, out);
    let (overlap, slow) = (builder.negate(gap), slowness(builder, after));
    for sign in [1.0, -1.0] {
        let along = builder.constant(sign);
        let (closing, pull) = (builder.multiply(along, out), builder.multiply(along, rate));
        let hits = builder.minimum(overlap, closing);
        let settles = builder.minimum(hits, slow);
        let leaves = builder.negate(pull);
        for from in [CLEAR, sign * REBOUNDING] {
            let rests = Transition::new(from, sign * RESTING, Guard::passed(settles)).reset(builder, zero);
            builder.transition(contact, with_mode(rests, modes.direction, STUCK));
            let bounces = Transition::new(from, sign * REBOUNDING, Guard::passed(hits)).reset(builder, after);
            builder.transition(contact, with_mode(bounces, modes.direction, STUCK));
        }
        builder.transition(contact, Transition::new(sign * REBOUNDING, CLEAR, Guard::passed(gap)));
        builder.transition(contact, Transition::new(sign * RESTING, CLEAR, Guard::passed(gap)));
        builder
            .transition(contact, Transition::new(sign * RESTING, sign * REBOUNDING, Guard::passed(leaves)));
    }
    let size = builder.absolute(contact.value);
    let resting = builder.constant((REBOUNDING + RESTING) / 2.0);
    builder.select(size, resting, zero, rate)
}

/// The same transition, which also sets another mode, if that mode exists. After the output has jumped, the brake
/// determines the direction of slip again.
fn with_mode(transition: Transition, mode: Option<ModeHandle>, value: f64) -> Transition {
    match mode {
        Some(mode) => transition.with_mode(mode, value),
        None => transition,
    }
}

/// The output as the stops see it: 0 while the integrator is reset, so that it closes no gap.
fn moving_output(builder: &mut dyn Builder, reset: Option<ModeHandle>) -> Register {
    let out = builder.own_output();
    let Some(position) = reset else { return out };
    let (half, zero) = (builder.constant(0.5), builder.constant(0.0));
    builder.select(position.value, half, zero, out)
}

/// The output after an impact: -restitution x out, in volts. The restitution is a pure number from 0 to 1.
fn rebound_output(builder: &mut dyn Builder, out: Register) -> Register {
    let restitution = builder.get("restitution");
    let rebound = builder.multiply(restitution, out);
    builder.negate(rebound)
}

/// The amount by which the output after a rebound is below the level of rest: rest - |after|, in volts. It is a guard:
/// above 0 the output stays at the stop.
fn slowness(builder: &mut dyn Builder, after: Register) -> Register {
    let (rest, speed) = (builder.get("rest"), builder.absolute(after));
    builder.subtract(rest, speed)
}

/// Mode while the reset voltage is below the threshold.
const OPERATING: f64 = 0.0;
/// Mode while the integrator is in initial condition by its reset input.
const RESET: f64 = 1.0;
/// The mode of the reset.
const RESET_CONTROL: ModeNames =
    ModeNames { mode: "reset", values: &[(OPERATING, "operating"), (RESET, "reset")] };

/// The rate with a reset: 0 while reset, otherwise the given rate.
///
/// The output becomes `initial` when the reset voltage reaches the threshold. The guards of the two modes are
/// complementary: one includes the threshold and the other does not. While reset, the output returns to `initial`
/// whenever it differs: if `initial` is changed by hand, or if a stop or a limit has set the output at the same
/// instant.
fn reset(builder: &mut dyn Builder, position: ModeHandle, modes: Modes, rate: Register) -> Register {
    let (control, threshold) = (builder.input("reset"), builder.get("threshold"));
    let (initial, out) = (builder.get("initial"), builder.own_output());
    let above = builder.subtract(control, threshold);
    let below = builder.subtract(threshold, control);
    let (over, under) = (builder.subtract(out, initial), builder.subtract(initial, out));
    let sets =
        [(OPERATING, Guard::reached(above)), (RESET, Guard::passed(over)), (RESET, Guard::passed(under))];
    for (from, guard) in sets {
        let set = Transition::new(from, RESET, guard).reset(builder, initial);
        let set = with_mode(with_mode(set, modes.direction, STUCK), modes.contact, CLEAR);
        builder.transition(position, set);
    }
    builder.transition(position, Transition::new(RESET, OPERATING, Guard::passed(below)));
    let (half, zero) = (builder.constant(0.5), builder.constant(0.0));
    builder.select(position.value, half, zero, rate)
}
