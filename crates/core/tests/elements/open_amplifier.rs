//! Open amplifier, alone and with patched feedback. crates/core/tests/loops.rs tests square roots.

use proptest::prelude::*;

use crate::common::{
    built, check_derivatives, circuit, element, random_cases, run_for, source, voltage, volts,
};
use crate::elements::bench::{ANY, clip, computes_in_every_mode, near, output, stops_at_100_volts};
use patchcord_core::ir::Program;
use patchcord_core::patch::{ElementBuilder, PatchBuilder};

fn open() -> ElementBuilder {
    element("open-amplifier")
}

/// -100 V x n / d: the product of the output and d is fed back.
fn quotient(n: f64, d: f64, amplification: f64) -> PatchBuilder {
    source(source(volts("quotient"), "n", n), "d", d)
        .element("E", open().cords("x1", ["n", "M1"]).set("amplification", amplification))
        .element("M1", element("multiplier").set("mode", "product").cord("a", "E").cord("b", "d"))
}

proptest! {
    #![proptest_config(random_cases(48))]

    #[test]
    fn law(a in ANY, b in ANY, gain in 1e2..1e4f64) {
        let amplifier = open().cords("x1", ["a"]).cords("x10", ["b"]).set("amplification", gain);
        prop_assert!(near(output(amplifier, &[a, b]), clip(-gain * (a + 10.0 * b))));
    }

    #[test]
    fn a_product_fed_back_divides(n in ANY, d in 0.01..100.0f64, decades in 2.0..9.0f64) {
        let gain = 10f64.powf(decades).round();
        let program = built(quotient(n, d, gain));
        let found = voltage(&run_for(&program, 1e-3, 0.0), "E");
        let expected = clip(-n / (d / 100.0 + 1.0 / gain));
        prop_assert!((found - expected).abs() <= 1e-11 * (1.0 + 100.0 / d), "{found} {expected}");
    }

    #[test]
    fn a_curve_fed_back_is_inverted(u in -90.0..90.0f64) {
        // The feedback is out + 2 max(0, out - 20 V), so the output is u up to 20 V and has a slope of 1/3 above.
        let summer = |inputs: &[(&str, &[&str])]| {
            let jacks: serde_json::Map<_, _> =
                inputs.iter().map(|(jack, from)| ((*jack).to_owned(), serde_json::json!(from))).collect();
            element("summer").set("in", jacks)
        };
        let builder = source(volts("inverse"), "u", -u)
            .element("PB", element("pot").cord("in", "-100").set("setting", 0.2))
            .element("N1", summer(&[("x1", &["E", "PB"])]))
            .element("N2", summer(&[("x1", &["N1"])]))
            .element("U1", element("diode-upper-of").set("in", serde_json::json!(["N2", "ground"])))
            .element("E", open().cords("x1", ["u", "E"]).cords("x2", ["U1"]).set("amplification", 1e9));
        let program = built(builder);
        let found = voltage(&run_for(&program, 1e-3, 0.0), "E");
        let expected = if u > 20.0 { 20.0 + (u - 20.0) / 3.0 } else { u };
        // An amplification of 1e9 leaves an error of out / 1e9 in the sum.
        prop_assert!((found - expected).abs() < 2e-7, "{found} {expected}");
    }
}

#[test]
fn overload() {
    stops_at_100_volts(open().cords("x1", ["a"]), &[0.001], -1000.0);
}

#[test]
fn a_division_by_0_overloads() {
    for (n, stop) in [(20.0, -100.0), (-20.0, 100.0)] {
        let program = built(quotient(n, 0.0, 1e6));
        let machine = run_for(&program, 1e-3, 0.0);
        assert_eq!(voltage(&machine, "E"), stop);
        assert_eq!(machine.overloads()[0].element, "E");
    }
}

#[test]
fn a_division_by_a_negative_voltage_is_refused() {
    let patch = quotient(20.0, -50.0, 1e6).build().unwrap();
    let report = Program::new(&circuit(&patch, &[])).unwrap_err().to_string();
    assert!(report.contains("3 solutions") && report.contains("divide by a positive voltage"), "{report}");
}

#[test]
fn modes() {
    let amplifier = open().cords("x1", ["a"]).cords("x10", ["b"]).set("amplification", 100);
    computes_in_every_mode(amplifier, [(&[0.3, 0.02], -50.0), (&[0.2, 0.0], -20.0), (&[-1.0, 0.05], 50.0)]);
}

#[test]
fn derivatives() {
    // x' = 100 V x 20 V / (x + 60 V).
    let builder = source(volts("decay"), "n", 20.0)
        .element("A1", element("integrator").cords("x1", ["E"]).set("initial", 10))
        .element("PD", element("pot").cord("in", "-100").set("setting", 0.6))
        .element("N1", element("summer").cords("x1", ["PD", "N2"]))
        .element("N2", element("summer").cords("x1", ["A1"]))
        .element("E", open().cords("x1", ["n", "M1"]))
        .element("M1", element("multiplier").set("mode", "product").cord("a", "E").cord("b", "N1"));
    check_derivatives(&built(builder), 1e-3, &[0.0, 0.3]);
}
