//! Quarter-squares multiplier. crates/core/tests/loops.rs tests it in a loop.

use proptest::prelude::*;

use crate::common::{element, random_cases};
use crate::elements::bench::{
    ANY, assert_out, at, bench, clip, computes_in_every_mode, has_exact_derivatives, near, output,
    stops_at_100_volts,
};
use patchcord_core::patch::ElementBuilder;

fn multiplier(mode: &str) -> ElementBuilder {
    element("multiplier").set("mode", mode).cord("a", "a").cord("b", "b")
}

proptest! {
    #![proptest_config(random_cases(48))]

    #[test]
    fn law(a in ANY, b in ANY) {
        let squares = clip((a.max(0.0).powi(2) + b.max(0.0).powi(2)) / 100.0);
        prop_assert!(near(output(multiplier("sum-of-squares"), &[a, b]), squares));
        let quarter_squares = ((a + b).powi(2) - (a - b).powi(2)) / 400.0;
        prop_assert!(near(output(multiplier("product"), &[a, b]), quarter_squares));
    }
}

#[test]
fn overload() {
    stops_at_100_volts(multiplier("sum-of-squares"), &[90.0, 80.0], 145.0);
    let beyond = element("multiplier").set("mode", "product").cord("a", "high").cord("b", "high");
    stops_at_100_volts(beyond, &[100.0], 121.0);
}

#[test]
fn a_product_of_full_voltages_is_no_overload() {
    for (a, b) in [(100.0, 100.0), (-100.0, 100.0)] {
        let program = bench(multiplier("product"));
        let machine = at(&program, &[a, b]);
        assert_out(&machine, a * b / 100.0, "at the ends");
        assert!(!machine.is_overloaded());
    }
}

#[test]
fn modes() {
    let squares = multiplier("sum-of-squares");
    computes_in_every_mode(squares, [(&[60.0, 40.0], 52.0), (&[-60.0, 40.0], 16.0), (&[-1.0, -2.0], 0.0)]);
    let product = multiplier("product");
    computes_in_every_mode(product, [(&[60.0, 40.0], 24.0), (&[-60.0, 40.0], -24.0), (&[-10.0, -20.0], 2.0)]);
}

#[test]
fn derivatives() {
    for mode in ["sum-of-squares", "product"] {
        has_exact_derivatives(multiplier(mode), 60.0, &[]);
    }
}
