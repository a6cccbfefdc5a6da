use patchcord_core::ir::Program;
use patchcord_core::patch::{ElementBuilder, Patch, PatchBuilder};

use super::*;

/// The present parameters of a circuit as conditions.
fn conditions(circuit: &Circuit) -> Conditions {
    let laws = ElementLaws::new(circuit);
    let parameters = laws.parameters().iter().map(|parameter| parameter.value).collect();
    Conditions::new(laws, parameters)
}

/// The index of an element with this name.
fn index(circuit: &Circuit, name: &str) -> usize {
    circuit.elements().iter().position(|element| element.name == name).unwrap()
}

/// The voltages of a rewired circuit whose states have these values.
fn voltages(circuit: &Circuit, rewiring: &Rewiring, states: &[f64]) -> Option<Voltages> {
    let conditions = conditions(circuit);
    let netlist = Netlist::new(circuit, &conditions.laws);
    let mut point = conditions.laws.initial_point(&conditions.coefficients);
    point.states.copy_from_slice(states);
    let order = Order::new(&netlist, rewiring);
    netlist.voltages(&conditions, (rewiring, &order), &point, None)
}

/// A mass on a spring with v at A1 and -x at A2. `spring` is the output that drives the pot of the spring.
fn spring(spring: &str) -> Patch {
    let pot = |from, setting| ElementBuilder::new("pot").cord("in", from).set("setting", setting);
    let patch = PatchBuilder::new("spring")
        .element("A1", ElementBuilder::new("integrator").cords("x10", ["PK"]).cords("x1", ["PC"]))
        .element("A2", ElementBuilder::new("integrator").cords("x1", ["A1"]))
        .element("B1", ElementBuilder::new("inverter").cord("in", "A2"))
        .element("PK", pot(spring, 0.4))
        .element("PC", pot("A1", 0.5));
    patch.build().unwrap()
}

#[test]
fn a_rewired_circuit_has_the_voltages_of_the_patch_with_these_cords() {
    let circuit = Circuit::new(&spring("B1")).unwrap();
    let mut rewiring = Rewiring::default();
    let link = Link { input: 0, from: index(&circuit, "A2"), factor: 1.0 };
    rewiring.set(index(&circuit, "PK"), vec![link]);
    let found = voltages(&circuit, &rewiring, &[20.0, -30.0]).unwrap();

    let program = Program::new(&Circuit::new(&spring("A2")).unwrap()).unwrap();
    let mut point = program.initial_point();
    let state = |name: &str| if name == "A1" { 20.0 } else { -30.0 };
    point.states = program.states().into_iter().map(state).collect();
    let expected = program.voltages_at(&point).unwrap();
    for (element, output) in program.element_outputs().iter().enumerate() {
        assert_eq!(found.outputs[element], expected[output.register.index()], "{}", output.name);
    }
    for law in program.state_laws() {
        let state = if program.element_outputs()[law.element].name == "A1" { 0 } else { 1 };
        assert_eq!(found.rates[state], expected[law.rate.index()]);
    }
    // v' = 4 x - 0.5 v with x = 30 and v = 20, and x' = v
    assert_eq!(found.rates, [110.0, -20.0]);
}

#[test]
fn an_inverter_changes_the_sign_of_a_voltage() {
    let circuit = Circuit::new(&spring("B1")).unwrap();
    let mut rewiring = Rewiring::default();
    let link = Link { input: 0, from: index(&circuit, "B1"), factor: -1.0 };
    rewiring.set(index(&circuit, "PK"), vec![link]);
    assert_eq!(voltages(&circuit, &rewiring, &[20.0, -30.0]).unwrap().rates, [110.0, -20.0]);
}

#[test]
fn an_open_amplifier_takes_the_voltage_at_which_its_inputs_balance() {
    // -64 V + out^2 / 100 V = 0
    let patch = PatchBuilder::new("root")
        .element("P", ElementBuilder::new("pot").cord("in", "-100").set("setting", 0.64))
        .element("A", ElementBuilder::new("open-amplifier").cords("x1", ["P", "M"]))
        .element(
            "M",
            ElementBuilder::new("multiplier")
                .set("mode", "sum-of-squares")
                .cord("a", "A")
                .cord("b", "ground"),
        );
    let circuit = Circuit::new(&patch.build().unwrap()).unwrap();
    let found = voltages(&circuit, &Rewiring::default(), &[]).unwrap();
    assert!((found.outputs[index(&circuit, "A")] - 80.0).abs() < 1e-3);
    let netlist = Netlist::new(&circuit, &ElementLaws::new(&circuit));
    let order = Order::new(&netlist, &Rewiring::default());
    assert_eq!(order.tears, [index(&circuit, "A")]);
    assert_eq!(order.closed_loops(&netlist), 0);
}

#[test]
fn a_summer_that_drives_itself_is_a_loop() {
    // out = -(out / 2 + 60 V)
    let patch = PatchBuilder::new("loop")
        .element("P", ElementBuilder::new("pot").cord("in", "S").set("setting", 0.5))
        .element("S", ElementBuilder::new("summer").cords("x1", ["P", "Q"]))
        .element("Q", ElementBuilder::new("pot").cord("in", "+100").set("setting", 0.6));
    let circuit = Circuit::new(&patch.build().unwrap()).unwrap();
    let found = voltages(&circuit, &Rewiring::default(), &[]).unwrap();
    assert!((found.outputs[index(&circuit, "S")] + 40.0).abs() < 1e-6);
    let netlist = Netlist::new(&circuit, &ElementLaws::new(&circuit));
    assert_eq!(Order::new(&netlist, &Rewiring::default()).closed_loops(&netlist), 1);
    let mut open = Rewiring::default();
    open.set(index(&circuit, "P"), vec![Link { input: 0, from: index(&circuit, "+100"), factor: 1.0 }]);
    assert_eq!(Order::new(&netlist, &open).closed_loops(&netlist), 0);
}

#[test]
fn brakes_slip_and_comparators_follow_their_inputs() {
    let pot = |from, setting| ElementBuilder::new("pot").cord("in", from).set("setting", setting);
    let patch = PatchBuilder::new("friction")
        .element("A", ElementBuilder::new("integrator").cords("x1", ["A"]).cords("brake_x10", ["P"]))
        .element("P", pot("+100", 0.05))
        .element("K", ElementBuilder::new("comparator").cord("in", "A").set("high", 7).set("low", -3));
    let circuit = Circuit::new(&patch.build().unwrap()).unwrap();
    // out' = -out - 10 x 5 V x sign(out)
    for (state, rate, comparator) in [(2.0, -52.0, 7.0), (-4.0, 54.0, -3.0)] {
        let found = voltages(&circuit, &Rewiring::default(), &[state]).unwrap();
        assert_eq!(found.rates, [rate]);
        assert_eq!(found.outputs[index(&circuit, "K")], comparator);
    }
}
