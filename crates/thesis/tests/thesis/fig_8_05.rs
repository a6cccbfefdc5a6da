//! Fig 8.5 and 8.6: the diode dead zone alone.

use crate::known_problems::runs::run;
use crate::thesis::circuit_readings;

/// Input and output while the input rises from -40 to 40 V; samples are 0.1 V apart.
fn sweep(changes: &[(&str, f64)]) -> [Vec<f64>; 2] {
    let trace = run("thesis/fig-8-05", changes, 8.0);
    assert!(circuit_readings::overloaded_elements(&trace).is_empty());
    ["V_1", "V_o"].map(|name| trace.values(name).unwrap())
}

/// End of the dead zone and slope on one side, from the line through two outer samples.
fn break_and_slope(input: &[f64], output: &[f64], [first, second]: [usize; 2]) -> (f64, f64) {
    let slope = (output[first] - output[second]) / (input[first] - input[second]);
    (input[first] - output[first] / slope, slope)
}

/// End of the dead zone and slope on the positive side.
fn positive_break_and_slope([input, output]: &[Vec<f64>; 2]) -> (f64, f64) {
    break_and_slope(input, output, [800, 750])
}

/// The output at 20 V, the input at which the operator sets the network.
fn at_20_volts([input, output]: &[Vec<f64>; 2]) -> f64 {
    assert!((input[600] - 20.0).abs() < 1e-9);
    output[600]
}

#[test]
fn dead_zone_ends_at_0_34_vb_with_slope_0_746() {
    for bias in [25.0, 50.0, 75.0] {
        let [input, output] = sweep(&[("VB", bias)]);
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
fn three_biases_give_the_single_curves() {
    let trace = run("thesis/fig-8-06", &[], 8.0);
    for (bias, signal) in [(25.0, "VB.25"), (50.0, "VB.50"), (75.0, "VB.75")] {
        let [_, alone] = sweep(&[("VB", bias)]);
        assert_eq!(trace.values(signal).unwrap(), alone, "{signal}");
    }
}

#[test]
fn dead_zone_of_the_thesis_is_17_volts() {
    let swept = sweep(&[]);
    assert!(
        (positive_break_and_slope(&swept).0 - 17.0).abs() < 0.05,
        "{:?}",
        positive_break_and_slope(&swept)
    );
    assert!((at_20_volts(&swept) - 2.22).abs() < 1e-9, "{}", at_20_volts(&swept));
}

/// Set to 3 V at 20 V (eq. 17-8), the dead zone ends too early, because the network attenuates.
#[test]
fn setting_of_eq_17_8_gives_a_dead_zone_one_volt_too_small() {
    let first = sweep(&[("r", 17.0 / 70.0)]);
    assert!((at_20_volts(&first) - 3.0).abs() < 1e-9);
    assert!(
        (positive_break_and_slope(&first).0 - 16.04).abs() < 0.005,
        "{:?}",
        positive_break_and_slope(&first)
    );
    let printed = sweep(&[("r", 0.24)]);
    assert!(
        (positive_break_and_slope(&printed).0 / 50.0 - 0.32).abs() < 0.005,
        "{:?}",
        positive_break_and_slope(&printed)
    );
}

/// A diode needs 0.26 V. At the setting 0.254 the dead zone is 0.35 V wider on either side, and without bias it is
/// 0.26 V.
#[test]
fn diode_drop_widens_the_dead_zone() {
    let drop = 0.26;
    let breaks = |changes: &[(&str, f64)]| positive_break_and_slope(&sweep(changes)).0;
    let wider = breaks(&[("drop", drop)]) - breaks(&[]);
    assert!((wider - drop / 0.746).abs() < 1e-9, "{wider}");
    let without_bias = breaks(&[("drop", drop), ("VB", 0.0), ("r", 0.0)]);
    assert!((without_bias - drop).abs() < 1e-9, "{without_bias}");
}
