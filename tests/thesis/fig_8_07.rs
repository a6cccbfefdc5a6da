//! Fig 8.7: constant friction as a dead zone in the spring force.

use patchcord::patch::{ElementBuilder, Patch, PatchBuilder};

use crate::bench;
use crate::problems::runs::record;
use crate::problems::slideway::{Law, Slideway};
use crate::slideway;

fn step() -> Slideway {
    Slideway::step_response(Law::Constant)
}

#[test]
fn follows_the_equations() {
    assert!(slideway::agrees_at("thesis/fig-8-07", &step()));
    slideway::agrees_at_random_settings("thesis/fig-8-07", Law::Constant, slideway::agrees_at);
}

#[test]
fn equals_the_equations_at_its_own_step() {
    assert!(slideway::equals_at_own_step("thesis/fig-8-07", &step(), 2.0));
    slideway::equals_at_random_settings("thesis/fig-8-07", Law::Constant);
}

#[test]
fn the_step_stops_off_the_input_by_less_than_fs_over_k() {
    let trace = record("thesis/fig-8-07", &step().changes(), 2.0, 1e-3, &["x_error", "v_o"]);
    let last = |name: &str| *trace.values(name).unwrap().last().unwrap();
    assert!((last("x_error") + 0.0389e-3).abs() < 0.000_05e-3, "{}", last("x_error"));
    assert!(last("x_error").abs() < 771.0 / 17.86e6);
    assert!(last("v_o").abs() < 1e-9);
}

/// The diode network alone, driven by a ramp from -50 V to +50 V in 1 s.
fn network(bias: f64) -> Patch {
    let drive = ElementBuilder::new("ramp").set("start", -50).set("rate", 100);
    let inverter = ElementBuilder::new("summer").cords("x1", ["PC1"]);
    let dead_zone = ElementBuilder::new("diode-dead-zone")
        .cord("in", "signal")
        .cord("bias_plus", "X1")
        .cord("bias_minus", "X2")
        .set("setting", "17 / 67");
    PatchBuilder::new("Fig 8.6")
        .machine("solartron-1451")
        .scale("volts", 1, "V")
        .drive("signal", "volts", drive)
        .element("PC1", ElementBuilder::new("pot").cord("in", "-100").set("setting", bias / 100.0))
        .element("X1", inverter)
        .element("X2", ElementBuilder::new("summer").cords("x1", ["X1"]))
        .element("DZ", dead_zone)
        .signal("out", "DZ", "volts", 1.0)
        .run(1.0, 1e-3)
        .record(["signal", "out"])
        .build()
        .unwrap()
}

/// Break and slope on one side of the dead zone, from the line through the outermost samples.
fn break_and_slope(input: &[f64], output: &[f64], at: usize, beside: usize) -> (f64, f64) {
    let slope = (output[at] - output[beside]) / (input[at] - input[beside]);
    (input[at] - output[at] / slope, slope)
}

#[test]
fn the_diode_network_breaks_at_0_34_vb_with_slope_0_746() {
    for bias in [25.0, 50.0, 75.0] {
        let trace = bench::run_patch(&network(bias));
        let (input, output) = (trace.values("signal").unwrap(), trace.values("out").unwrap());
        let last = input.len() - 1;
        for (side, at, beside) in [(1.0, last, last - 50), (-1.0, 0, 50)] {
            let (breaks, slope) = break_and_slope(&input, &output, at, beside);
            assert!((slope - 0.746).abs() < 0.000_5, "{slope}");
            assert!((side * breaks / bias - 0.34).abs() < 0.005, "{breaks} at {bias} V");
        }
        let dead = input.iter().zip(&output).filter(|(input, _)| input.abs() < 0.339 * bias);
        assert!(dead.into_iter().all(|(_, output)| *output == 0.0));
    }
}

#[test]
fn the_thesis_s_dead_zone_is_17_volts() {
    let trace = bench::run_patch(&network(50.0));
    let (input, output) = (trace.values("signal").unwrap(), trace.values("out").unwrap());
    let last = input.len() - 1;
    let (breaks, _) = break_and_slope(&input, &output, last, last - 50);
    assert!((breaks - 17.0).abs() < 0.05, "{breaks}");
    // 20 V in give 2.24 V out: the text's 2.22 V comes from 0.254 for 17/67.
    let at_20 = input.iter().position(|volts| (volts - 20.0).abs() < 1e-9).unwrap();
    assert!((output[at_20] - 2.22).abs() < 0.025, "{}", output[at_20]);
}
