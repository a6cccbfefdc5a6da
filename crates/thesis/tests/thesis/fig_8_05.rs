//! Fig 8.5 and 8.6: the diode dead zone alone.

use crate::known::runs::run;
use crate::thesis::bench;

/// Input and output while the input rises from -40 to 40 V; samples are 0.1 V apart.
fn swept(changes: &[(&str, f64)]) -> [Vec<f64>; 2] {
    let trace = run("thesis/fig-8-05", changes, 8.0);
    assert!(bench::lit(&trace).is_empty());
    ["V_1", "V_o"].map(|name| trace.values(name).unwrap())
}

/// Break and slope on one side of the dead zone, from the line through the outermost samples.
fn break_and_slope(input: &[f64], output: &[f64], [at, beside]: [usize; 2]) -> (f64, f64) {
    let slope = (output[at] - output[beside]) / (input[at] - input[beside]);
    (input[at] - output[at] / slope, slope)
}

/// The same on the positive side.
fn above([input, output]: &[Vec<f64>; 2]) -> (f64, f64) {
    break_and_slope(input, output, [800, 750])
}

/// The output at 20 V, where the operator sets the network up.
fn at_20_volts([input, output]: &[Vec<f64>; 2]) -> f64 {
    assert!((input[600] - 20.0).abs() < 1e-9);
    output[600]
}

#[test]
fn it_breaks_at_0_34_vb_with_slope_0_746() {
    for bias in [25.0, 50.0, 75.0] {
        let [input, output] = swept(&[("VB", bias)]);
        for (side, rows) in [(1.0, [800, 750]), (-1.0, [0, 50])] {
            let (breaks, slope) = break_and_slope(&input, &output, rows);
            assert!((slope - 0.746).abs() < 1e-9, "{slope}");
            assert!((side * breaks / bias - 0.34).abs() < 0.005, "{breaks} at {bias} V");
        }
        let dead = input.iter().zip(&output).filter(|(input, _)| input.abs() < 0.339 * bias);
        assert!(dead.into_iter().all(|(_, output)| *output == 0.0));
    }
}

#[test]
fn three_biases_give_the_curves_of_each() {
    let trace = run("thesis/fig-8-06", &[], 8.0);
    for (bias, signal) in [(25.0, "VB.25"), (50.0, "VB.50"), (75.0, "VB.75")] {
        let [_, alone] = swept(&[("VB", bias)]);
        assert_eq!(trace.values(signal).unwrap(), alone, "{signal}");
    }
}

#[test]
fn the_thesis_s_dead_zone_is_17_volts() {
    let swept = swept(&[]);
    assert!((above(&swept).0 - 17.0).abs() < 0.05, "{:?}", above(&swept));
    assert!((at_20_volts(&swept) - 2.22).abs() < 1e-9, "{}", at_20_volts(&swept));
}

/// Set up by 3 V for 20 V (eq. 17-8), it breaks too early: the network attenuates, which was not obvious.
#[test]
fn the_first_setting_is_one_volt_short() {
    let first = swept(&[("r", 17.0 / 70.0)]);
    assert!((at_20_volts(&first) - 3.0).abs() < 1e-9);
    assert!((above(&first).0 - 16.04).abs() < 0.005, "{:?}", above(&first));
    let printed = swept(&[("r", 0.24)]);
    assert!((above(&printed).0 / 50.0 - 0.32).abs() < 0.005, "{:?}", above(&printed));
}

/// A diode needs 0.26 V: at the setting 0.254 the dead zone is 0.35 V wider on either side, and at no bias it has that much.
#[test]
fn the_drop_of_the_diodes_widens_the_dead_zone() {
    let drop = 0.26;
    let breaks = |changes: &[(&str, f64)]| above(&swept(changes)).0;
    let wider = breaks(&[("drop", drop)]) - breaks(&[]);
    assert!((wider - drop / 0.746).abs() < 1e-9, "{wider}");
    let without_bias = breaks(&[("drop", drop), ("VB", 0.0), ("r", 0.0)]);
    assert!((without_bias - drop).abs() < 1e-9, "{without_bias}");
}
