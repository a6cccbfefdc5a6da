//! The operating point of a linearisation: equilibria, kinks, holds and overloads.

use crate::common::{built, element, patch, program, run_for, slideway, source, volts};
use crate::linear::{model, near, roots_of, shipped};
use patchcord_analysis::linear::{Root, fastest_state, roots};
use patchcord_core::ir::StateHold;
use patchcord_core::solve::Machine;

#[test]
fn the_fastest_state_is_reported_unless_there_is_an_equilibrium() {
    assert!(fastest_state(&model(&shipped("lessons/van-der-pol", &[("x0", 0.0)]))).is_none());
    let moving = model(&shipped("lessons/van-der-pol", &[("x0", 0.2)]));
    let found = fastest_state(&moving).unwrap();
    // x'' = -x = -0.2 per s2, in volts of 0.05 per s.
    assert_eq!(found.name, "A1");
    assert!((found.rate + 4.0).abs() < 1e-12, "{found:?}");
}

#[test]
fn slow_states_are_no_equilibrium() {
    // 5e-10 V/s towards -50 V, with a time constant of 3000 years, and 5e-10 V/s without an end.
    let slow = |inputs: [&str; 2]| {
        let pot = element("pot").cord("in", "+100").set("setting", 0.5);
        let integrator = element("integrator").cords("x0.01", inputs);
        model(&built(volts("slow").time_scale(1e-9).element("P", pot).element("A", integrator)))
    };
    assert_eq!(fastest_state(&slow(["P", "A"])).unwrap().rate, -5e-10);
    assert_eq!(fastest_state(&slow(["P", "ground"])).unwrap().rate, -5e-10);
    assert!(fastest_state(&slow(["A", "ground"])).is_none());
}

#[test]
fn a_settled_run_is_at_an_equilibrium() {
    let program = built(volts("settles").element("L", element("lag").cords("x1", ["+100"]).set("time", 0.1)));
    let state_space_at = |seconds| run_for(&program, 1e-3, seconds).state_space();
    assert_eq!(fastest_state(&state_space_at(0.1)).unwrap().name, "L");
    assert!(fastest_state(&state_space_at(5.0)).is_none());
    assert!((state_space_at(5.0).states[0].volts + 100.0).abs() < 1e-9);
}

#[test]
fn time_dependent_drives_are_reported() {
    assert_eq!(model(&program(&slideway(), &[])).moving, ["v_i"]);
    assert_eq!(model(&program(&slideway(), &[("v_rate", 0.0)])).moving, Vec::<String>::new());
}

#[test]
fn signals_are_read_in_their_units() {
    let model = model(&program(&slideway(), &[]));
    let level = model.outputs.iter().find(|port| port.name == "friction_level").unwrap();
    assert!((level.volts * level.per_volt - 771.0).abs() < 1e-9 && level.unit == "N", "{level:?}");
}

#[test]
fn the_slideway_at_rest_is_at_a_kink_of_its_velocity() {
    // The absolute velocity has a corner at 0; the dead zone has none inside.
    let at_rest = model(&program(&slideway(), &[]));
    assert_eq!(at_rest.kinks, ["A3"]);
    let memory = at_rest.states.iter().position(|state| state.name == "A1").unwrap();
    let velocity = at_rest.states.iter().position(|state| state.name == "A3").unwrap();
    // 100 V x u' = -100 V x |v| / (VcL Tc), of 0.254 mm/s: it falls on both sides.
    let expected = -100.0 * 0.254e-3 / (2.54e-3 * 6.5e-3);
    let slope = at_rest.matrix[memory][velocity];
    assert!(near(slope, expected, 1e-12), "{slope} {expected}");
    let sliding = run_for(&program(&slideway(), &[]), 2e-5, 0.3).state_space();
    assert_eq!(sliding.kinks, Vec::<String>::new());
}

#[test]
fn the_edge_of_a_dead_zone_is_a_kink_and_its_inside_is_not() {
    let zone = |start: f64| {
        let zone = element("dead-zone").cord("in", "A").set("lower", -2).set("upper", 3);
        let integrator = element("integrator").cords("x1", ["Z"]).set("initial", start);
        model(&built(volts("zone").element("A", integrator).element("Z", zone)))
    };
    // Derivatives are towards higher voltages: slope -1 at the upper edge, 0 at the lower edge.
    for (start, slope, is_kink) in
        [(3.0, -1.0, true), (-2.0, 0.0, true), (0.0, 0.0, false), (5.0, -1.0, false)]
    {
        let found = zone(start);
        assert_eq!((found.matrix[0][0], found.kinks.len()), (slope, usize::from(is_kink)), "{start}");
    }
}

#[test]
fn rounding_errors_of_loops_are_no_kinks() {
    for stem in ["lessons/projectile", "lessons/square-root-and-division"] {
        assert_eq!(model(&shipped(stem, &[])).kinks, Vec::<String>::new(), "{stem}");
    }
}

#[test]
fn at_a_limit_derivatives_point_away_from_it() {
    // The next inverter clips at the same voltage, so changes beyond 100 V would not pass.
    let builder = volts("full")
        .element("A", element("integrator").cords("x1", ["I"]).set("initial", 100))
        .element("I", element("inverter").cord("in", "B"))
        .element("B", element("inverter").cord("in", "A"));
    let found = model(&built(builder));
    assert_eq!((found.matrix[0][0], found.kinks.len()), (-1.0, 0));
}

#[test]
fn a_held_state_is_omitted_from_the_roots() {
    // The brake holds A against its input; the lag continues.
    let stuck = source(volts("stuck"), "u", 5.0)
        .element("level", element("pot").cord("in", "+100").set("setting", 0.2))
        .element("A", element("integrator").cords("x1", ["u"]).cords("brake_x1", ["level"]))
        .element("L", element("lag").cords("x1", ["A"]).set("time", 0.5));
    let program = built(stuck.machine("unlimited"));
    let found = model(&program);
    assert_eq!(
        found.states.iter().map(|state| state.hold).collect::<Vec<_>>(),
        [Some(StateHold::Brake), None]
    );
    assert_eq!(roots_of(&program), [Root { real: -2.0, imaginary: 0.0, multiplicity: 1 }]);
}

#[test]
fn an_integrator_at_its_limit_is_held() {
    let program = program(&patch("integrator-limit"), &[]);
    let held = run_for(&program, 1e-2, 15.0).state_space();
    assert_eq!(held.states[0].hold, Some(StateHold::Limit));
    assert_eq!(roots(&held).unwrap(), []);
    assert_eq!(run_for(&program, 1e-2, 5.0).state_space().states[0].hold, None);
}

#[test]
fn overloaded_amplifiers_are_reported_and_pass_no_changes() {
    let builder = source(volts("too much"), "u", 80.0)
        .element("S", element("summer").cords("x1", ["u", "A"]))
        .element("A", element("integrator").cords("x1", ["S"]).set("initial", 60));
    let program = built(builder);
    let found = model(&program);
    assert_eq!((found.overloaded.clone(), found.matrix[0][0]), (vec!["S".to_owned()], 0.0));
}

#[test]
fn drives_affect_states_and_signals_directly() {
    // A' = -10 u, S = -(A + 2 u).
    let builder = source(volts("direct"), "u", 1.0)
        .element("A", element("integrator").cords("x10", ["u"]))
        .element("S", element("summer").cords("x1", ["A"]).cords("x2", ["u"]));
    let program = built(builder);
    let machine = Machine::new(&program, 1e-3).unwrap();
    let found = machine.state_space();
    let input = found.inputs.iter().position(|port| port.name == "u").unwrap();
    let output = found.outputs.iter().position(|port| port.name == "S").unwrap();
    let column = found.states.len() + found.delays.len() + input;
    let row = found.states.len() + found.delays.len() + output;
    assert_eq!(
        (found.matrix[0][column], found.matrix[row][column], found.matrix[row][0]),
        (-10.0, -2.0, -1.0)
    );
}
