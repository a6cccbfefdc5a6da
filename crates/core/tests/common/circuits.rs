//! Circuits drawn by chance, made of everything that bends, switches, stops and remembers.

use super::dice::Dice;
use super::{element, volts};
use patchcord_core::patch::{ElementBuilder, Patch, PatchBuilder};

/// The parameters of each.
pub const PARAMETERS: [&str; 5] = ["p0", "p1", "p2", "p3", "late"];

/// Something between two integrators; `k` numbers it, and chooses its parameters.
fn link(dice: &mut Dice, kind: usize, k: usize, from: &str) -> ElementBuilder {
    let (own, other) = (format!("p{}", k % 4), format!("p{}", (k + 1) % 4));
    let level = dice.even(3.0, 12.0);
    let mark = format!("{level} * {own}");
    match kind {
        0 => element("dead-zone").cord("in", from).set("lower", -level).set("upper", mark),
        1 => element("absolute").cord("in", from),
        2 => element("relay")
            .cord("in", from)
            .cord("on", "B")
            .cord("off", "C")
            .set("pull_in", mark)
            .set("drop_out", -level),
        3 => element("delay").cord("in", from).set("delay", format!("late * {}", dice.even(0.5, 1.5))),
        4 => element("lag").cords("x1", [from]).set("time", format!("late * {other}")),
        5 => element("summer")
            .cords("x4", [from])
            .set("limit", serde_json::json!({"upper": mark, "lower": -level})),
        6 => {
            let points = serde_json::json!([[-20, -5], [-level, 4], [level, -8], [20, 10]]);
            element("function-generator").cord("in", from).set("points", points)
        }
        7 => element("diode-lower-of").set("in", serde_json::json!([from, "u"])),
        8 => element("track-hold").cord("in", from).cord("track", "w").set("threshold", mark),
        _ => element("multiplier").set("mode", "product").cord("a", from).cord("b", "B"),
    }
}

/// Three damped integrators, one with limits and one with a brake, linked at random; two drives and two levels.
pub fn circuit(dice: &mut Dice) -> Patch {
    let volts_of = |parameter: &str, share: f64| format!("{} * {parameter}", 1e-2 * share);
    let mut builder = volts("random");
    for name in &PARAMETERS[..4] {
        builder = builder.parameter(name, dice.even(0.5, 0.9), "1", [0.1, 1.0]);
    }
    let step = element("step")
        .set("height", dice.even(10.0, 30.0))
        .set("at", format!("late * {}", dice.even(1.0, 4.0)));
    let wave = element("triangle")
        .set("amplitude", dice.even(15.0, 25.0))
        .set("frequency", format!("0.4 / late * {}", dice.even(0.5, 1.5)));
    builder = builder
        .parameter("late", dice.even(0.3, 0.5), "s", [0.1, 1.0])
        .drive("u", "volt", step)
        .drive("w", "volt", wave)
        .element("B", element("pot").cord("in", "+100").set("setting", volts_of("p1", dice.even(10.0, 30.0))))
        .element(
            "C",
            element("pot").cord("in", "-100").set("setting", volts_of("p2", dice.even(10.0, 30.0))),
        );
    for k in 0..5 {
        let from = format!("A{}", (dice.even(0.0, 3.0)) as usize);
        let kind = dice.even(0.0, 10.0) as usize;
        let gain = element("pot").cord("in", &format!("N{k}")).set("setting", dice.even(0.3, 1.0));
        builder =
            builder.element(&format!("N{k}"), link(dice, kind, k, &from)).element(&format!("G{k}"), gain);
    }
    integrators(builder, dice).build().unwrap_or_else(|report| panic!("{report}"))
}

fn integrators(builder: PatchBuilder, dice: &mut Dice) -> PatchBuilder {
    let limit = serde_json::json!({"upper": "15 * p3", "lower": -12});
    let integrator = || element("integrator");
    let start = dice.even(-10.0, 10.0);
    builder
        .element(
            "A0",
            integrator()
                .cords("x2", ["G0", "w"])
                .cords("x1", ["A0", "G1"])
                .set("initial", format!("{start} * p0")),
        )
        .element("A1", integrator().cords("x2", ["A0", "u"]).cords("x1", ["A1", "G2"]).set("limit", limit))
        .element(
            "A2",
            integrator().cords("x2", ["A1", "G3"]).cords("x1", ["A2", "G4"]).cords("brake_x1", ["B"]),
        )
}
