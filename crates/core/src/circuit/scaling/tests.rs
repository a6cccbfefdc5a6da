//! Unit tests of `scaling`.

use super::*;
use crate::patch::{ElementBuilder, Patch, PatchBuilder};

/// Position and velocity of a mass, with a pot between them that represents k / m.
fn spring(setting: &str) -> PatchBuilder {
    PatchBuilder::new("spring")
        .time_scale(10.0)
        .parameter("k", 40.0, "N/m", [1.0, 100.0])
        .parameter("m", 2.0, "kg", [1.0, 10.0])
        .scale("position", 1.0, "mm")
        .scale("velocity", 20.0, "mm/s")
        .element("A1", ElementBuilder::new("integrator").cords("x10", ["P1"]))
        .element("A2", ElementBuilder::new("integrator").cords("x1", ["P2"]))
        .element(
            "P2",
            ElementBuilder::new("pot")
                .cord("in", "A1")
                .set("setting", "velocity / position / 10 / time_scale"),
        )
        .element("P1", ElementBuilder::new("pot").cord("in", "A2").set("setting", setting))
        .signal("v", "A1", "velocity", 1.0)
        .signal("x", "A2", "position", -1.0)
}

fn patch(setting: &str) -> Patch {
    spring(setting).build().unwrap()
}

fn row(setting: &str, output: &str) -> ScalingRow {
    let circuit = Circuit::new(&patch(setting)).unwrap_or_else(|report| panic!("{report}"));
    circuit.scaling().into_iter().find(|row| row.output == output).unwrap()
}

#[test]
fn a_pot_for_k_over_m_has_the_block_gain_k_over_m() {
    let right = row("k / m * position / velocity / 10 / time_scale", "v");
    assert_eq!(right.block.as_deref(), Some("k / m"));
    // Only an equation says whether k / m is right.
    assert_eq!(right.expected_gain, None);
    assert!((right.block_gain - 20.0).abs() < 1e-9, "{right:?}");
}

#[test]
fn the_reciprocal_of_a_parameter_of_zero_is_no_block_gain() {
    let patch =
        spring("3 * k / m * position / velocity / 10 / time_scale").parameter("T2", 0.0, "s2", [0.0, 1.0]);
    let circuit = Circuit::new(&patch.build().unwrap()).unwrap_or_else(|report| panic!("{report}"));
    let row = circuit.scaling().into_iter().find(|row| row.output == "v").unwrap();
    assert_eq!((row.block, row.expected_gain), (None, None));
}

#[test]
fn pairs_are_considered_up_to_100_parameters() {
    let block = |more: usize| {
        let spring = spring("k / m * position / velocity / 10 / time_scale");
        let with_times = (0..more)
            .fold(spring, |builder, index| builder.parameter(&format!("T{index}"), 3.0, "s", [1.0, 10.0]));
        let circuit = Circuit::new(&with_times.build().unwrap()).unwrap_or_else(|report| panic!("{report}"));
        circuit.scaling().into_iter().find(|row| row.output == "v").unwrap().block
    };
    assert_eq!(block(98).as_deref(), Some("k / m"));
    assert_eq!(block(99), None);
}

#[test]
fn integrating_velocity_into_position_has_a_block_gain_of_1() {
    // The pot in front of A2 lacks a factor of 10 on purpose: the gain is a tenth of the expected one.
    let row = row("k / m * position / velocity / 10 / time_scale", "x");
    assert_eq!(row.block.as_deref(), Some("1"));
    assert!((row.relative_error().unwrap() + 0.9).abs() < 1e-9, "{row:?}");
}

/// The block of a pot with a number as its setting, next to two parameters of the same unit.
fn block_of(setting: f64) -> Option<String> {
    let builder = PatchBuilder::new("two springs")
        .parameter("k1", 2.0, "N/m", [1.0, 100.0])
        .parameter("k2", 3.0, "N/m", [1.0, 100.0])
        .scale("position", 1.0, "m")
        .scale("force", 10.0, "N")
        .drive("D", "position", ElementBuilder::new("step").set("height", 1))
        .element("P", ElementBuilder::new("pot").cord("in", "D").set("setting", setting))
        .signal("x", "D", "position", 1.0)
        .signal("F", "P", "force", 1.0);
    let circuit = Circuit::new(&builder.build().unwrap()).unwrap_or_else(|report| panic!("{report}"));
    circuit.scaling().into_iter().next().unwrap().block
}

#[test]
fn a_block_is_named_only_if_its_value_is_a_reason() {
    assert_eq!(block_of(0.3).as_deref(), Some("k2"));
    // A tenth of the gain of k1 is no reason to name it.
    assert_eq!(block_of(0.02), None);
    assert_eq!(block_of(0.25), None);
}

#[test]
fn an_inverter_is_linear_and_a_curve_is_not() {
    for (kind, gains) in [("inverter", vec![-1.0]), ("absolute", vec![]), ("sin", vec![])] {
        let step = ElementBuilder::new("step").set("height", 1);
        let builder = PatchBuilder::new("curve").scale("volt", 1.0, "V").drive("D", "volt", step);
        let builder = builder.element("E", ElementBuilder::new(kind).cord("in", "D"));
        assert_eq!(gains_at(builder.signal("in", "D", "volt", 1.0), "E"), gains, "{kind}");
    }
}

fn summer(from: &[String]) -> ElementBuilder {
    ElementBuilder::new("summer").cords("x1", from)
}

fn gains_at(builder: PatchBuilder, last: &str) -> Vec<f64> {
    let builder = builder.signal("out", last, "volt", 1.0);
    let circuit = Circuit::new(&builder.build().unwrap()).unwrap_or_else(|report| panic!("{report}"));
    circuit.scaling().iter().map(|row| row.computer_gain).collect()
}

/// A drive followed by pairs of summers. Both summers of a pair are driven by both summers of the preceding pair.
fn ladder(pairs: usize) -> PatchBuilder {
    let step = ElementBuilder::new("step").set("height", 1);
    let builder = PatchBuilder::new("ladder").scale("volt", 1.0, "V").drive("D", "volt", step);
    (0..pairs).fold(builder, |builder, at| {
        let from = match at {
            0 => vec!["D".to_owned()],
            _ => vec![format!("A{}", at - 1), format!("B{}", at - 1)],
        };
        builder.element(&format!("A{at}"), summer(&from)).element(&format!("B{at}"), summer(&from))
    })
}

#[test]
fn the_gains_of_all_parallel_paths_are_added() {
    assert_eq!(gains_at(ladder(24), "A23"), [2f64.powi(23)]);
}

#[test]
fn a_chain_of_20000_summers_is_followed_to_its_end() {
    let step = ElementBuilder::new("step").set("height", 1);
    let builder = PatchBuilder::new("chain").scale("volt", 1.0, "V").drive("S0", "volt", step);
    let chain = (1..=20_000)
        .fold(builder, |builder, at| builder.element(&format!("S{at}"), summer(&[format!("S{}", at - 1)])));
    assert_eq!(gains_at(chain, "S20000"), [1.0]);
}
