//! Logarithm of a voltage.

use proptest::prelude::*;

use crate::common::{built, element, random_cases, run_for, source, voltage, volts};
use crate::elements::bench::{
    ANY, assert_out, at, bench, clip, computes_in_every_mode, has_exact_derivatives, near, output,
    stops_at_100_volts,
};

proptest! {
    #![proptest_config(random_cases(96))]

    #[test]
    fn law(decades in -6.0..2.0f64, reference in 0.01..100.0f64, per_decade in 1.0..100.0f64, least in 1e-6..1.0f64) {
        let a = 10f64.powf(decades);
        let preset = output(element("log").cord("in", "a"), &[a]);
        prop_assert!((preset - clip(50.0 * decades.max(-3.0))).abs() < 1e-11, "{preset}");
        let set = element("log").cord("in", "a").set("reference", reference).set("per_decade", per_decade);
        let expected = clip(per_decade * (a.max(least).ln() - reference.ln()) / 10f64.ln());
        prop_assert!((output(set.set("least", least), &[a]) - expected).abs() < 1e-11);
    }

    #[test]
    fn inputs_below_the_least_input_count_as_the_least_input(a in ANY, least in 1e-6..1.0f64) {
        let log = element("log").cord("in", "a").set("least", least).set("per_decade", 10);
        prop_assert!(near(output(log, &[-a.abs()]), 10.0 * least.log10()));
    }

    #[test]
    fn the_exponential_is_the_inverse(decades in -2.0..2.0f64) {
        let a = 10f64.powf(decades);
        let builder = source(volts("logarithm and exponential"), "u", a);
        let builder = builder.element("L", element("log").cord("in", "u"));
        let program = built(builder.element("E", element("exp").cord("in", "L")));
        let restored = voltage(&run_for(&program, 1e-3, 0.0), "E");
        prop_assert!((restored / a - 1.0).abs() < 1e-12, "{restored} {a}");
    }
}

#[test]
fn overload() {
    stops_at_100_volts(
        element("log").cord("in", "a").set("reference", 0.01).set("least", 0.01),
        &[100.0],
        200.0,
    );
}

#[test]
fn a_large_least_input_prevents_an_overload_at_0_volts() {
    let program = bench(element("log").cord("in", "a").set("least", 0.01));
    let machine = at(&program, &[0.0]);
    assert_out(&machine, -100.0, "two decades below the reference");
    assert!(!machine.is_overloaded());
}

#[test]
fn modes() {
    computes_in_every_mode(
        element("log").cord("in", "a"),
        [(&[10.0], 50.0), (&[1.0], 0.0), (&[100.0], 100.0)],
    );
}

#[test]
fn derivatives() {
    let log =
        || element("log").cord("in", "a").set("reference", "r").set("per_decade", "d").set("least", "l");
    let settings = |least| {
        [("r", 2.0, "1", [0.1, 10.0]), ("d", 20.0, "1", [1.0, 50.0]), ("l", least, "1", [1e-3, 50.0])]
    };
    has_exact_derivatives(log(), 40.0, &settings(0.01));
    has_exact_derivatives(log(), 5.0, &settings(30.0));
}
