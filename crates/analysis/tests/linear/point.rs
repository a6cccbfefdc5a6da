//! Where is linearised: what is told of the operating point.

use crate::common::{built, element, patch, program, ran, slideway, source, volts};
use crate::linear::{model, near, roots_of, shipped};
use patchcord_analysis::linear::{Root, fastest, roots};
use patchcord_core::ir::Hold;
use patchcord_core::solve::Machine;

#[test]
fn an_equilibrium_is_one_and_what_moves_is_named() {
    assert!(fastest(&model(&shipped("lessons/van-der-pol", &[("x0", 0.0)]))).is_none());
    let moving = model(&shipped("lessons/van-der-pol", &[("x0", 0.2)]));
    let found = fastest(&moving).unwrap();
    // x'' = -x = -0.2 per s2, in volts of 0.05 per s.
    assert_eq!(found.name, "A1");
    assert!((found.rate + 4.0).abs() < 1e-12, "{found:?}");
}

#[test]
fn what_moves_slowly_moves() {
    // 5e-10 V/s towards -50 V, with a time constant of 3000 years; and without any.
    let slow = |inputs: [&str; 2]| {
        let pot = element("pot").cord("in", "+100").set("setting", 0.5);
        let integrator = element("integrator").cords("x0.01", inputs);
        model(&built(volts("slow").time_scale(1e-9).element("P", pot).element("A", integrator)))
    };
    assert_eq!(fastest(&slow(["P", "A"])).unwrap().rate, -5e-10);
    assert_eq!(fastest(&slow(["P", "ground"])).unwrap().rate, -5e-10);
    assert!(fastest(&slow(["A", "ground"])).is_none());
}

#[test]
fn a_settled_run_comes_to_an_equilibrium() {
    let program = built(volts("settles").element("L", element("lag").cords("x1", ["+100"]).set("time", 0.1)));
    let at = |seconds| ran(&program, 1e-3, seconds).state_space();
    assert_eq!(fastest(&at(0.1)).unwrap().name, "L");
    assert!(fastest(&at(5.0)).is_none());
    assert!((at(5.0).states[0].volts + 100.0).abs() < 1e-9);
}

#[test]
fn drives_that_time_moves_are_named() {
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
fn the_slideway_at_rest_stands_on_the_kink_of_its_velocity() {
    // The size of the velocity has a corner at 0, the dead zone has none within its width.
    let at_rest = model(&program(&slideway(), &[]));
    assert_eq!(at_rest.kinks, ["A3"]);
    let memory = at_rest.states.iter().position(|state| state.name == "A1").unwrap();
    let velocity = at_rest.states.iter().position(|state| state.name == "A3").unwrap();
    // 100 V x u' = -100 V x |v| / (VcL Tc), of 0.254 mm/s: towards either side it falls.
    let wanted = -100.0 * 0.254e-3 / (2.54e-3 * 6.5e-3);
    let slope = at_rest.matrix[(memory, velocity)];
    assert!(near(slope, wanted, 1e-12), "{slope} {wanted}");
    let sliding = ran(&program(&slideway(), &[]), 2e-5, 0.3).state_space();
    assert_eq!(sliding.kinks, Vec::<String>::new());
}

#[test]
fn the_edge_of_a_dead_zone_is_a_kink_and_what_lies_within_is_not() {
    let zone = |start: f64| {
        let zone = element("dead-zone").cord("in", "A").set("lower", -2).set("upper", 3);
        let integrator = element("integrator").cords("x1", ["Z"]).set("initial", start);
        model(&built(volts("zone").element("A", integrator).element("Z", zone)))
    };
    // Towards higher voltages: the zone's own slope above it, none below it.
    for (start, slope, is_kink) in
        [(3.0, -1.0, true), (-2.0, 0.0, true), (0.0, 0.0, false), (5.0, -1.0, false)]
    {
        let found = zone(start);
        assert_eq!((found.matrix[(0, 0)], found.kinks.len()), (slope, usize::from(is_kink)), "{start}");
    }
}

#[test]
fn what_rounding_does_to_loops_is_no_kink() {
    for stem in ["lessons/projectile", "lessons/square-root-and-division"] {
        assert_eq!(model(&shipped(stem, &[])).kinks, Vec::<String>::new(), "{stem}");
    }
}

#[test]
fn a_state_at_its_limit_can_only_go_away_from_it() {
    // The inverter behind it clips just there: towards 100 V and beyond nothing would come through.
    let builder = volts("full")
        .element("A", element("integrator").cords("x1", ["I"]).set("initial", 100))
        .element("I", element("inverter").cord("in", "B"))
        .element("B", element("inverter").cord("in", "A"));
    let found = model(&built(builder));
    assert_eq!((found.matrix[(0, 0)], found.kinks.len()), (-1.0, 0));
}

#[test]
fn a_mode_that_holds_a_state_takes_it_out_of_the_roots() {
    // The brake holds A against its input; the lag beside it goes on.
    let stuck = source(volts("stuck"), "u", 5.0)
        .element("level", element("pot").cord("in", "+100").set("setting", 0.2))
        .element("A", element("integrator").cords("x1", ["u"]).cords("brake_x1", ["level"]))
        .element("L", element("lag").cords("x1", ["A"]).set("time", 0.5));
    let program = built(stuck.machine("unlimited"));
    let found = model(&program);
    assert_eq!(found.states.iter().map(|state| state.hold).collect::<Vec<_>>(), [Some(Hold::Brake), None]);
    assert_eq!(roots_of(&program), [Root { real: -2.0, imaginary: 0.0, times: 1 }]);
}

#[test]
fn an_integrator_at_its_limit_is_held() {
    let program = program(&patch("integrator-limit"), &[]);
    let held = ran(&program, 1e-2, 15.0).state_space();
    assert_eq!(held.states[0].hold, Some(Hold::Limit));
    assert_eq!(roots(&held).unwrap(), []);
    assert_eq!(ran(&program, 1e-2, 5.0).state_space().states[0].hold, None);
}

#[test]
fn amplifiers_beyond_100_volts_are_named_and_pass_nothing() {
    let builder = source(volts("too much"), "u", 80.0)
        .element("S", element("summer").cords("x1", ["u", "A"]))
        .element("A", element("integrator").cords("x1", ["S"]).set("initial", 60));
    let program = built(builder);
    let found = model(&program);
    assert_eq!((found.overloaded.clone(), found.matrix[(0, 0)]), (vec!["S".to_owned()], 0.0));
}

#[test]
fn states_follow_drives_at_once_and_signals_through_them() {
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
        (found.matrix[(0, column)], found.matrix[(row, column)], found.matrix[(row, 0)]),
        (-10.0, -2.0, -1.0)
    );
}
