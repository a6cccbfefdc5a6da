//! Random circuits of elements with kinks, switches, limits and memory.

use super::random::SplitMix64;
use super::{element, volts};
use patchcord_core::patch::{ElementBuilder, Patch, PatchBuilder};

/// The parameters of every random circuit.
pub(crate) const PARAMETERS: [&str; 5] = ["p0", "p1", "p2", "p3", "late"];

/// A nonlinear element between two integrators, of one of ten kinds. Its number `k` selects its parameters.
fn link(random: &mut SplitMix64, kind: usize, k: usize, from: &str) -> ElementBuilder {
    let (first_parameter, second_parameter) = (format!("p{}", k % 4), format!("p{}", (k + 1) % 4));
    let level = random.uniform(3.0, 12.0);
    let threshold = format!("{level} * {first_parameter}");
    match kind {
        0 => element("dead-zone").cord("in", from).set("lower", -level).set("upper", threshold),
        1 => element("absolute").cord("in", from),
        2 => element("relay")
            .cord("in", from)
            .cord("on", "B")
            .cord("off", "C")
            .set("pull_in", threshold)
            .set("drop_out", -level),
        3 => element("delay").cord("in", from).set("delay", format!("late * {}", random.uniform(0.5, 1.5))),
        4 => element("lag").cords("x1", [from]).set("time", format!("late * {second_parameter}")),
        5 => element("summer")
            .cords("x4", [from])
            .set("limit", serde_json::json!({"upper": threshold, "lower": -level})),
        6 => {
            let points = serde_json::json!([[-20, -5], [-level, 4], [level, -8], [20, 10]]);
            element("function-generator").cord("in", from).set("points", points)
        }
        7 => element("diode-lower-of").set("in", serde_json::json!([from, "u"])),
        8 => element("track-hold").cord("in", from).cord("track", "w").set("threshold", threshold),
        _ => element("multiplier").set("mode", "product").cord("a", from).cord("b", "B"),
    }
}

/// Three damped integrators with random links, one with limits and one with a brake. Two drives and two constant
/// voltages feed them.
pub(crate) fn random_circuit(random: &mut SplitMix64) -> Patch {
    let setting_for = |parameter: &str, volts: f64| format!("{} * {parameter}", 1e-2 * volts);
    let mut builder = volts("random");
    for name in &PARAMETERS[..4] {
        builder = builder.parameter(name, random.uniform(0.5, 0.9), "1", [0.1, 1.0]);
    }
    let step = element("step")
        .set("height", random.uniform(10.0, 30.0))
        .set("at", format!("late * {}", random.uniform(1.0, 4.0)));
    let wave = element("triangle")
        .set("amplitude", random.uniform(15.0, 25.0))
        .set("frequency", format!("0.4 / late * {}", random.uniform(0.5, 1.5)));
    builder = builder
        .parameter("late", random.uniform(0.3, 0.5), "s", [0.1, 1.0])
        .drive("u", "volt", step)
        .drive("w", "volt", wave)
        .element(
            "B",
            element("pot").cord("in", "+100").set("setting", setting_for("p1", random.uniform(10.0, 30.0))),
        )
        .element(
            "C",
            element("pot").cord("in", "-100").set("setting", setting_for("p2", random.uniform(10.0, 30.0))),
        );
    for k in 0..5 {
        let from = format!("A{}", (random.uniform(0.0, 3.0)) as usize);
        let kind = random.uniform(0.0, 10.0) as usize;
        let gain = element("pot").cord("in", &format!("N{k}")).set("setting", random.uniform(0.3, 1.0));
        builder =
            builder.element(&format!("N{k}"), link(random, kind, k, &from)).element(&format!("G{k}"), gain);
    }
    integrators(builder, random).build().unwrap_or_else(|report| panic!("{report}"))
}

/// Adds the integrators A0, A1 and A2.
fn integrators(builder: PatchBuilder, random: &mut SplitMix64) -> PatchBuilder {
    let limit = serde_json::json!({"upper": "15 * p3", "lower": -12});
    let integrator = || element("integrator");
    let start = random.uniform(-10.0, 10.0);
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
