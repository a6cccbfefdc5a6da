//! Loops without an integrator: a single solution is used; several solutions are refused and reported.

use proptest::prelude::*;

use crate::common::{
    built, check_derivatives, circuit, element, patch, root, run_for, source, voltage, volts,
};
use patchcord_core::circuit::Circuit;
use patchcord_core::ir::Program;
use patchcord_core::patch::{ElementBuilder, Patch, PatchBuilder};

/// A summer with feedback through a pot: out = -(gain_in u + gain_back setting out).
fn fed_back(u: f64, gain_in: u32, gain_back: u32, setting: f64) -> PatchBuilder {
    let (input, back) = (format!("x{gain_in}"), format!("x{gain_back}"));
    source(volts("fed back"), "u", u)
        .element("P1", element("pot").cord("in", "S1").set("setting", setting))
        .element("S1", element("summer").cords(&input, ["u"]).cords(&back, ["P1"]))
}

/// The voltage of an element in initial condition.
fn solved(builder: PatchBuilder, element: &str) -> f64 {
    voltage(&run_for(&built(builder), 1e-3, 0.0), element)
}

#[test]
fn a_summer_with_half_of_its_output_fed_back_gives_two_thirds() {
    let program = crate::common::program(&patch("summer-loop"), &[]);
    let machine = run_for(&program, 1e-3, 0.01);
    assert!((voltage(&machine, "S1") + 2.0 / 3.0).abs() < 1e-14);
    assert_eq!(program.loops().len(), 1);
}

proptest! {
    #![proptest_config(crate::common::random_cases(64))]

    #[test]
    fn any_negative_feedback_agrees_with_the_formula(
        u in -100.0..100.0f64, gain_in in 1..20u32, gain_back in 1..20u32, setting in 0.0..1.0f64,
    ) {
        let demand = -f64::from(gain_in) * u / (1.0 + f64::from(gain_back) * setting);
        let found = solved(fed_back(u, gain_in, gain_back, setting), "S1");
        // At 100 V the amplifier is at its limit, and its feedback has no effect.
        prop_assert!((found - demand.clamp(-100.0, 100.0)).abs() < 1e-11, "{found} {demand}");
    }

    #[test]
    fn positive_feedback_below_one_agrees_with_the_formula(u in -50.0..50.0f64, setting in 0.0..0.98f64) {
        // With one more inversion the loop gain is + setting: out = -u + setting out.
        let builder = source(volts("positive"), "u", u)
            .element("P1", element("pot").cord("in", "S2").set("setting", setting))
            .element("S2", element("summer").cords("x1", ["S1"]))
            .element("S1", element("summer").cords("x1", ["u", "P1"]));
        let demand = (-u / (1.0 - setting)).clamp(-100.0, 100.0);
        let found = solved(builder, "S1");
        prop_assert!((found - demand).abs() < 1e-10, "{found} {demand}");
    }

    #[test]
    fn a_loop_through_diodes_and_limits_agrees_with_bisection(
        u in -40.0..40.0f64, setting in 0.05..0.9f64, level in 1.0..60.0f64, slope in 0.0..1.0f64,
    ) {
        // The loop function is decreasing in its output, so there is one solution.
        let result = |out: f64| {
            let limited = -(u + 2.0 * setting * out);
            let soft_limited = limited.min(level) + slope * (limited - limited.min(level));
            let soft_limited = soft_limited.clamp(-100.0, 100.0);
            let upper = soft_limited.max(0.3 * soft_limited);
            (upper - 0.5 * out).clamp(-100.0, 100.0) - out
        };
        let found = solved(diodes_and_limits(u, setting, level, slope), "S3");
        let expected = root(result, -100.0 - 1e-9, 100.0 + 1e-9);
        prop_assert!((found - expected).abs() < 1e-8, "{found} {expected}");
    }
}

proptest! {
    #![proptest_config(crate::common::random_cases(48))]

    #[test]
    fn a_product_with_a_factor_from_outside_the_loop_is_linear(u in -100.0..100.0f64, g in -90.0..100.0f64) {
        // S1 = -(u + g S1 / 100), so that the summer divides by 1 + g / 100, up to its limit.
        let product = element("multiplier").set("mode", "product").cord("a", "S1").cord("b", "g");
        let divider = source(source(volts("divider"), "u", u), "g", g)
            .element("M1", product)
            .element("S1", element("summer").cords("x1", ["u", "M1"]));
        let expected = (-u / (1.0 + g / 100.0)).clamp(-100.0, 100.0);
        prop_assert!((solved(divider, "S1") - expected).abs() < 1e-9);
    }
}

/// A loop of a summer with a soft limit, a diode pair and two more summers.
fn diodes_and_limits(u: f64, setting: f64, level: f64, slope: f64) -> PatchBuilder {
    let limit = serde_json::json!({"upper": level, "slope": slope});
    source(volts("diodes"), "u", u)
        .element("P1", element("pot").cord("in", "S3").set("setting", setting))
        .element("S1", element("summer").cords("x1", ["u"]).cords("x2", ["P1"]).set("limit", limit))
        .element("P2", element("pot").cord("in", "S1").set("setting", 0.3))
        .element("U1", element("diode-upper-of").set("in", serde_json::json!(["S1", "P2"])))
        .element("S2", element("summer").cords("x1", ["U1"]))
        .element("S3", element("summer").cords("x1", ["S2"]).cords("x0.5", ["S3"]))
}

/// The square root of x: an open amplifier with the square of its positive output fed back.
fn root_of(x: f64, amplification: f64) -> PatchBuilder {
    source(volts("root"), "u", -x)
        .element("OA", element("open-amplifier").cords("x1", ["u", "M1"]).set("amplification", amplification))
        .element("M1", squares("OA"))
}

/// A multiplier that squares the positive voltage of an element.
fn squares(of: &str) -> ElementBuilder {
    element("multiplier").set("mode", "sum-of-squares").cord("a", of).cord("b", "ground")
}

proptest! {
    #![proptest_config(crate::common::random_cases(64))]

    #[test]
    fn a_square_fed_back_gives_the_root(x in 1e-3..100.0f64, decades in 2.0..9.0f64) {
        let gain = 10f64.powf(decades).round();
        // The positive root of out = -A (out^2 / 100 - x), in a form without cancellation.
        let expected = 2.0 * gain * x / (1.0 + (1.0 + 4.0 * gain * gain * x / 100.0).sqrt());
        let found = solved(root_of(x, gain), "OA");
        prop_assert!((found - expected.min(100.0)).abs() < 1e-12 * (1.0 + 1.0 / x), "{found} {expected}");
    }

    #[test]
    fn a_loop_through_a_square_agrees_with_its_quadratic(u in -99.0..99.0f64) {
        // out = -(u + max(out, 0)^2 / 100).
        let builder = source(volts("square"), "u", u)
            .element("S1", element("summer").cords("x1", ["u", "M1"]))
            .element("M1", squares("S1"));
        let expected = if u >= 0.0 { -u } else { -2.0 * u / (1.0 + (1.0 - 4.0 * u / 100.0).sqrt()) };
        prop_assert!((solved(builder, "S1") - expected).abs() < 1e-12);
    }
}

proptest! {
    #![proptest_config(crate::common::random_cases(12))]

    #[test]
    fn a_curved_loop_inside_another_is_solved(u in 40.0..90.0f64, v in 30.0..70.0f64) {
        // r^2 / 100 = u - s / 4 and s^2 / 100 = v + r / 4.
        let (gain, s) = (1e9, |r: f64| 10.0 * (v + r / 4.0).sqrt());
        let open = || element("open-amplifier").set("amplification", gain);
        let builder = source(source(volts("two roots"), "u", -u), "v", -v)
            .element("R", open().cords("x1", ["u", "M1"]).cords("x0.25", ["S"]))
            .element("S", open().cords("x1", ["v", "M2"]).cords("x0.25", ["N1"]))
            .element("N1", element("summer").cords("x1", ["R"]))
            .element("M1", squares("R"))
            .element("M2", squares("S"));
        let expected = root(|r| u - s(r) / 4.0 - r * r / 100.0, 0.0, 100.0);
        let machine = built(builder);
        let machine = run_for(&machine, 1e-3, 0.0);
        let found = (voltage(&machine, "R"), voltage(&machine, "S"));
        // Both squares have an error of out / 1e9.
        prop_assert!((found.0 - expected).abs() < 1e-6, "{found:?} {expected}");
        prop_assert!((found.1 - s(expected)).abs() < 1e-6, "{found:?} {expected}");
    }
}

/// E is nearly (20 V - F / 10) / 2, and F divides by E - 50 V. The division has one solution only if E is below 50 V.
/// The element `first` is declared before the other.
fn divider_in_a_loop(first: &str) -> PatchBuilder {
    let entries = [
        ("E", element("open-amplifier").cords("x1", ["E", "PU"]).cords("x0.1", ["F"])),
        ("F", element("open-amplifier").cords("x1", ["PM", "M2"])),
    ];
    let order = if first == "E" { [0, 1] } else { [1, 0] };
    let builder = volts("divider")
        .element("PU", element("pot").cord("in", "-100").set("setting", 0.2))
        .element("P50", element("pot").cord("in", "+100").set("setting", 0.5))
        .element("PM", element("pot").cord("in", "+100").set("setting", 0.1))
        .element("S1", element("summer").cords("x1", ["E", "P50"]))
        .element("S2", element("inverter").cord("in", "S1"))
        .element("M2", element("multiplier").set("mode", "product").cord("a", "F").cord("b", "S2"));
    order.iter().fold(builder, |builder, index| {
        let (name, entry) = entries[*index].clone();
        builder.element(name, entry)
    })
}

#[test]
fn an_inner_loop_with_one_solution_at_the_operating_point_is_solved() {
    // E + F / 10 = 20 V, F (E + 50 V) = -1000 V2: E^2 + 30 E - 1100 = 0 in V.
    let expected = -15.0 + (225.0f64 + 1100.0).sqrt();
    for first in ["E", "F"] {
        let found = solved(divider_in_a_loop(first), "E");
        assert!((found - expected).abs() < 1e-3, "{first}: {found} {expected}");
    }
}

proptest! {
    #![proptest_config(crate::common::random_cases(32))]

    #[test]
    fn an_exponential_fed_back_with_any_gain_gives_the_logarithm(
        x in 1e-4..90.0f64, decades in 3.0..9.0f64, gain in 1..100u32,
    ) {
        // 10^(out / 12 V) uV = x.
        let jack = format!("x{gain}");
        let exponential = element("exp").cord("in", "OA").set("reference", 1e-6).set("per_decade", 12);
        let amplifier = element("open-amplifier").cords(&jack, ["u", "X"]);
        let amplification = 10f64.powf(decades).round();
        let builder = source(volts("logarithm"), "u", -x)
            .element("X", exponential)
            .element("OA", amplifier.set("amplification", amplification));
        let expected = 12.0 * (x * 1e6).log10();
        let found = solved(builder, "OA");
        // The error of the finite amplification divided by the slope of the exponential.
        let gain_error = 100.0 / (amplification * f64::from(gain)) * 12.0 / (x * 10f64.ln());
        prop_assert!((found - expected).abs() < 1e-9 + 1.1 * gain_error, "{found} {expected} {gain_error}");
    }
}

#[test]
fn a_curved_loop_with_a_range_of_solutions_is_reported() {
    let builder = volts("follower")
        .element("L", element("log").cord("in", "S"))
        .element("X", element("exp").cord("in", "L"))
        .element("N", element("inverter").cord("in", "X"))
        .element("S", element("inverter").cord("in", "N"));
    let report = Program::new(&circuit(&builder.build().unwrap(), &[])).unwrap_err().to_string();
    assert!(report.contains("a continuous range of solutions"), "{report}");
}

#[test]
fn the_root_of_a_negative_number_overloads() {
    let program = built(root_of(-20.0, 1e6));
    let machine = run_for(&program, 1e-3, 0.0);
    assert_eq!(voltage(&machine, "OA"), -100.0);
    assert_eq!(machine.overloads()[0].element, "OA");
}

#[test]
fn all_solutions_of_a_square_loop_are_reported() {
    // Both signs are squared, so out^2 / 100 = 25 has two roots. A third solution is the limit of -100 V.
    let builder = source(volts("roots"), "u", -25.0)
        .element("N1", element("summer").cords("x1", ["OA"]))
        .element("M1", squares("OA").cord("b", "N1"))
        .element("OA", element("open-amplifier").cords("x1", ["u", "M1"]));
    let report = Program::new(&circuit(&builder.build().unwrap(), &[])).unwrap_err().to_string();
    assert!(report.contains("3 solutions: OA at -100 V, -50.0001 V, 49.9999 V"), "{report}");
}

#[test]
fn derivatives_agree_through_curved_loops() {
    // x' = -10 (root(x + 30) - 40 V): the slope of the root changes with x.
    let builder = volts("leak")
        .element("A1", element("integrator").cords("x10", ["OA", "P2"]).set("initial", 20))
        .element("P2", element("pot").cord("in", "-100").set("setting", 0.4))
        .element("P1", element("pot").cord("in", "-100").set("setting", 0.3))
        .element("N2", element("summer").cords("x1", ["A1"]))
        .element("OA", element("open-amplifier").cords("x1", ["N2", "P1", "M1"]))
        .element("M1", squares("OA"));
    check_derivatives(&built(builder), 1e-3, &[0.0, 0.05]);
}

/// A loop with a gain of +2. It has a solution at each limit and one at 0 V.
fn latch() -> Patch {
    let builder = volts("latch")
        .element("S2", element("summer").cords("x2", ["S1"]))
        .element("S1", element("summer").cords("x1", ["S2"]));
    builder.build().unwrap()
}

#[test]
fn positive_gain_above_one_is_refused_with_its_three_solutions() {
    let report = Program::new(&circuit(&latch(), &[])).unwrap_err().to_string();
    assert!(report.contains("loop-with-solutions"), "{report}");
    assert!(report.contains("S1") && report.contains("S2"), "{report}");
    assert!(report.contains("3 solutions"), "{report}");
    for solution in ["-100 V", " 0 V", " 100 V"] {
        assert!(report.contains(solution), "{solution} in {report}");
    }
}

#[test]
fn an_integrator_after_a_loop_agrees_with_the_solved_equation() {
    // x' = -S1 and S1 = -(x + S1 / 2) give x' = 2/3 x. An inverter changes the sign.
    let machine_of = crate::common::program(&patch("loop-lag"), &[]);
    let machine = run_for(&machine_of, 1e-3, 1.0);
    let expected = 80.0 * (-2.0f64 / 3.0).exp();
    // RK4: (lambda h)^4 t / 120 of the value, under 1e-13; the rest is rounding.
    assert!((voltage(&machine, "A1") - expected).abs() < 1e-11, "{}", voltage(&machine, "A1") - expected);
}

#[test]
fn derivatives_agree_through_loops() {
    check_derivatives(&crate::common::program(&patch("loop-lag"), &[]), 1e-3, &[0.3, 0.9]);
    check_derivatives(&crate::common::program(&patch("loop-lag"), &[("back", 0.123)]), 1e-3, &[0.5]);
}

#[test]
fn a_loop_with_too_many_linear_pieces_is_refused_quickly() {
    // Every stage doubles the number of linear pieces: 22 stages have four million.
    let stages = 22;
    let builder = (0..stages).fold(volts("folded"), |builder, index| {
        let from = if index == 0 { format!("S{stages}") } else { format!("F{index}") };
        let (inverted, folded) = (format!("I{index}"), format!("U{index}"));
        let builder = builder.element(&inverted, element("summer").cords("x1", [from.as_str()]));
        let pair = serde_json::json!([from, inverted]);
        let builder = builder.element(&folded, element("diode-lower-of").set("in", pair));
        builder.element(
            &format!("F{}", index + 1),
            element("summer").set("in", serde_json::json!({ "x2": [folded], "x1": ["+100"] })),
        )
    });
    let last = format!("F{stages}");
    let builder = builder.element(&format!("S{stages}"), element("summer").cords("x1", [last.as_str()]));
    let patch = builder.build().unwrap();
    let report = Program::new(&Circuit::new(&patch).unwrap()).unwrap_err();
    assert_eq!(report.findings[0].code.as_str(), "loop-too-tangled", "{report}");
}
