//! Unit tests of `batch`.

use super::*;
use crate::circuit::Circuit;
use crate::ir::Program;
use crate::patch::{ElementBuilder, PatchBuilder};
use crate::solve::RunSettings;
use crate::solve::run::prepare;

/// An integrator that a relay reverses at ±20 V, from many initial voltages.
fn programs() -> (Vec<Program>, RunSettings) {
    let element = ElementBuilder::new;
    let relay = element("relay").cord("in", "A1").cord("on", "+100").cord("off", "-100");
    let patch = PatchBuilder::new("reversed")
        .scale("volt", 1, "V")
        .parameter("start", 0.0, "1", [-50.0, 50.0])
        .element("K1", relay.set("pull_in", 20).set("drop_out", -20))
        .element("A1", element("integrator").cords("x1", ["K1"]).set("initial", "start"))
        .run(2.0, 1e-3)
        .build()
        .unwrap();
    let circuit = Circuit::new(&patch).unwrap();
    let program = Program::new(&circuit).unwrap();
    let with_start = |run: u32| {
        let mut program = program.clone();
        program.set_parameters([("start", f64::from(run) - 8.0)]).unwrap();
        program
    };
    let settings = RunSettings::of(&circuit).unwrap().with_signals(["A1"]).with_sample_interval(0.01);
    ((0..16).map(with_start).collect(), settings)
}

/// Modes change at another instant in every run.
#[test]
fn members_stay_at_the_same_step_and_take_most_steps_in_groups() {
    let (programs, settings) = programs();
    let mut progress = vec![|_: f64| (); programs.len()];
    let pairs = programs.iter().zip(&mut progress);
    let players = pairs.map(|(program, progress)| prepare(program, &settings, progress).unwrap());
    let mut batch = Batch::new(players.collect(), Backend::Lanes);
    batch.play(&Phase::InitialCondition);
    for member in &mut batch.members {
        assert!(member.begin_operating(2.0, None).is_some());
    }
    let (mut next, mut grouped_steps) = (1, 0);
    while batch.members.iter().any(Member::is_operating) {
        let grouped_lanes = u64::from(batch.grouped_lanes().count_ones());
        let first = next;
        next = batch.run_block(first);
        grouped_steps += grouped_lanes * (next - first);
        let steps = batch.members.iter().map(|member| member.operation.unwrap().steps);
        assert!(steps.clone().all(|steps| steps.first == next || steps.count == 0));
    }
    assert_eq!(next, 2001);
    assert!(grouped_steps > 16 * 1600, "{grouped_steps}");
}

#[test]
fn lanes_are_listed_from_the_lowest_bit() {
    assert!(lanes(0).next().is_none());
    assert!(lanes(1 << 63 | 0b1010).eq([1, 3, 63]));
    assert!(has_lane(0b1010, 3) && !has_lane(0b1010, 2));
}
