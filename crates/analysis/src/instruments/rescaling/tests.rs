//! The sentences for changes of scales and gains.

use super::*;
use patchcord_core::patch::{ElementBuilder, PatchBuilder};

/// A circuit with a velocity at A1, whose inverter B1 has the only signal, and amplifiers without a signal.
fn circuit() -> Circuit {
    let pot = |from, setting| ElementBuilder::new("pot").cord("in", from).set("setting", setting);
    let patch = PatchBuilder::new("circuit")
        .parameter("f0", 8.0, "N", [1.0, 10.0])
        .scale("velocity", 2, "mm/s")
        .scale("force", "f0 / 40", "N")
        .drive("push", "force", ElementBuilder::new("step").set("height", "f0"))
        .element("P1", pot("push", 0.2))
        .element("P2", pot("A1", 0.5))
        .element("A1", ElementBuilder::new("integrator").cords("x10", ["P1"]).cords("x1", ["A1"]))
        .element("B1", ElementBuilder::new("inverter").cord("in", "A1"))
        .element("S1", ElementBuilder::new("summer").cords("x1", ["P2", "B1"]).cords("x10", ["A1"]))
        .element("A2", ElementBuilder::new("integrator").cords("x10", ["P2"]).set("initial", 4))
        .element(
            "M1",
            ElementBuilder::new("multiplier").set("mode", "product").cord("a", "A1").cord("b", "S1"),
        )
        .element("Q1", ElementBuilder::new("open-amplifier").cords("x1", ["A1", "Q1"]))
        .signal("v", "B1", "velocity", 1.0)
        .build()
        .unwrap();
    Circuit::new(&patch).unwrap_or_else(|report| panic!("{report}"))
}

fn index(circuit: &Circuit, name: &str) -> usize {
    element_index(circuit, name).unwrap()
}

/// The change of the scale of the signal at an element.
fn change(circuit: &Circuit, name: &str, rescaling: Rescaling) -> String {
    let element = index(circuit, name);
    scale_change(circuit, element, scaled_signal(circuit, element).unwrap(), rescaling)
}

#[test]
fn a_scale_changes_by_its_number_or_by_its_formula() {
    let circuit = circuit();
    let larger = "let 1 V of v at B1 represent 4 times as much (\"per_volt\": 8 in place of 2 in the scale \"velocity\")";
    assert_eq!(change(&circuit, "B1", Rescaling::Enlarge(4.0)), larger);
    let smaller =
        "let 1 V of push represent 1/20 as much (\"per_volt\": \"(f0 / 40) / 20\" in the scale \"force\")";
    assert_eq!(change(&circuit, "push", Rescaling::Reduce(20.0)), smaller);
    let formula = "let 1 V of push represent 1.5 times as much (\"per_volt\": \"1.5 * (f0 / 40)\" in the scale \"force\")";
    assert_eq!(change(&circuit, "push", Rescaling::Enlarge(1.5)), formula);
}

#[test]
fn an_amplifier_has_the_signal_of_its_inverter() {
    let circuit = circuit();
    let inverted = "let 1 V of v at B1, which inverts A1, represent 2 times as much (\"per_volt\": 4 in place of 2 in the \
                    scale \"velocity\")";
    assert_eq!(change(&circuit, "A1", Rescaling::Enlarge(2.0)), inverted);
    // A summer with other gains is no inverter.
    assert!(scaled_signal(&circuit, index(&circuit, "A2")).is_none());
}

#[test]
fn gains_and_pots_change_by_numbers() {
    let circuit = circuit();
    // P2 also drives A2, so it is not set. The feedback of A1 to itself stays.
    assert_eq!(
        smaller_output(&circuit, index(&circuit, "S1"), 4.0),
        "make S1 4 times smaller: put a pot of 0.25 between P2 and S1, put a pot of 0.25 between B1 and S1, put a pot of \
         0.25 between A1 and S1; then multiply by 4 where other amplifiers use it"
    );
    assert_eq!(
        larger_output(&circuit, index(&circuit, "A1"), 4.0),
        "make A1 4 times larger: set P1 to 0.8 in place of 0.2; then divide by 4 where other amplifiers use it"
    );
    assert_eq!(
        larger_output(&circuit, index(&circuit, "A2"), 10.0),
        "make A2 10 times larger: give P2 a gain of 100 in place of 10, multiply its initial value by 10; then divide by \
         10 where other amplifiers use it"
    );
}

#[test]
fn elements_without_gains_change_with_their_drivers() {
    let circuit = circuit();
    assert_eq!(
        larger_output(&circuit, index(&circuit, "M1"), 20.0),
        "enlarge A1 and S1 by smaller scales, so that M1 gets 20 times larger"
    );
    assert_eq!(
        smaller_output(&circuit, index(&circuit, "Q1"), 2.0),
        "reduce A1 by larger scales, so that Q1 gets 2 times smaller"
    );
}

#[test]
fn gains_are_those_of_the_machine() {
    let pot = ElementBuilder::new("pot").cord("in", "A1").set("setting", 0.5);
    let patch = PatchBuilder::new("gains of 1 and 10")
        .machine("solartron-1451")
        .element("A1", ElementBuilder::new("integrator").cords("x1", ["A1"]).set("initial", 1))
        .element("P1", pot)
        .element("S1", ElementBuilder::new("summer").cords("x1", ["A1"]))
        .element("A2", ElementBuilder::new("integrator").cords("x1", ["P1"]))
        .build()
        .unwrap();
    let circuit = Circuit::new(&patch).unwrap_or_else(|report| panic!("{report}"));
    let larger = |name: &str, factor: f64| larger_output(&circuit, index(&circuit, name), factor);
    let of_10 = "make S1 10 times larger: give A1 a gain of 10 in place of 1; then divide by 10 where other amplifiers \
                 use it";
    assert_eq!(larger("S1", 10.0), of_10);
    // 4 = 10 x 0.4.
    let of_4 = "make S1 4 times larger: give A1 a gain of 10 in place of 1 and put a pot of 0.4 between A1 and S1; then \
                divide by 4 where other amplifiers use it";
    assert_eq!(larger("S1", 4.0), of_4);
    // 0.5 x 4 = 10 x 0.2.
    let with_pot = "make A2 4 times larger: give P1 a gain of 10 in place of 1 and set P1 to 0.2 in place of 0.5; then \
                    divide by 4 where other amplifiers use it";
    assert_eq!(larger("A2", 4.0), with_pot);
    // A summer has no gain of 20.
    let no_gain = "enlarge A1 by smaller scales, so that S1 gets 20 times larger";
    assert_eq!(larger("S1", 20.0), no_gain);
}
