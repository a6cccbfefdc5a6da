//! Unit tests of `narrowing`.

use patchcord_core::circuit::Circuit;
use patchcord_core::patch::{ElementBuilder, PatchBuilder, Problem};

use super::super::{ScaleOptions, scale_problem};
use super::{NarrowedRange, rounded_inwards, snapped, valid_ranges, with_narrowed_ranges};

/// The ranges in which all settings are valid.
fn ranges(builder: PatchBuilder) -> Vec<[f64; 2]> {
    let circuit = Circuit::new(&builder.build().unwrap()).unwrap_or_else(|report| panic!("{report}"));
    valid_ranges(&circuit).into_iter().map(|range| range.unwrap().into()).collect()
}

/// A pot with this setting between the reference and an integrator.
fn pot(builder: PatchBuilder, setting: &str) -> PatchBuilder {
    let pot = ElementBuilder::new("pot").cord("in", "+100").set("setting", setting);
    let integrator = ElementBuilder::new("integrator").cords("x1", ["P1"]);
    builder.element("P1", pot).element("A1", integrator).record(["A1"])
}

/// A patch with a parameter k.
fn with_k(value: f64, range: [f64; 2]) -> PatchBuilder {
    PatchBuilder::new("pot").parameter("k", value, "1", range)
}

#[test]
fn a_range_ends_where_the_setting_is_1() {
    assert_eq!(ranges(pot(with_k(1.0, [0.5, 5.0]), "k / 3")), [[0.5, 3.0]]);
    // The setting is 1 at k = 0.123456.
    assert_eq!(ranges(pot(with_k(0.2, [0.01, 9.0]), "0.123456 / k")), [[0.124, 9.0]]);
    assert_eq!(ranges(pot(with_k(1.0, [0.5, 5.0]), "k / 2.3456")), [[0.5, 2.3]]);
    // With 2 digits, 1.23456 would become 1.2.
    assert_eq!(ranges(pot(with_k(1.0, [0.5, 5.0]), "k / 1.23456")), [[0.5, 1.23]]);
    assert_eq!(ranges(pot(with_k(1.0, [0.5, 2.0]), "k / 3")), [[0.5, 2.0]]);
}

#[test]
fn a_range_is_never_narrowed_past_the_present_value() {
    assert_eq!(ranges(pot(with_k(2.0, [0.5, 5.0]), "k / 2")), [[0.5, 2.0]]);
    // The setting is 1 at k = 1.98765432; with 3 digits the end would be below the present value.
    assert_eq!(ranges(pot(with_k(1.987_654, [0.5, 5.0]), "k / 1.98765432")), [[0.5, 1.987_654]]);
}

#[test]
fn a_parameter_of_a_pot_has_one_sign() {
    assert_eq!(ranges(pot(with_k(-2.0, [-10.0, 10.0]), "-k / 4")), [[-4.0, 0.0]]);
    assert_eq!(ranges(pot(with_k(0.0, [-1.0, 1.0]), "k / 2")), [[0.0, 1.0]]);
}

#[test]
fn both_parameters_of_a_product_are_narrowed_by_equal_shares() {
    let builder = with_k(1.0, [0.5, 4.0]).parameter("m", 1.0, "1", [0.25, 2.0]);
    // k / m is 16 at the ends and 2 at a quarter of both logarithmic ranges: k = 4^(1/4) and m = 1 / 4^(1/4).
    assert_eq!(ranges(pot(builder, "k / m / 2")), [[0.5, 1.4], [0.71, 2.0]]);
}

#[test]
fn a_difference_keeps_its_sign() {
    let builder = with_k(8.0, [0.0, 20.0]).parameter("f", 5.0, "1", [0.0, 6.0]);
    // k is at least the present f. Then 8 (5/8)^s and 5 (6/5)^s are equal at s = 0.72, and both are 5.70.
    assert_eq!(ranges(pot(builder, "(k - f) / 20")), [[5.8, 20.0], [0.0, 5.7]]);
}

#[test]
fn settings_with_few_parameters_come_first() {
    let builder = with_k(1.0, [0.5, 4.0]).parameter("m", 1.0, "1", [0.25, 2.0]);
    let second = ElementBuilder::new("pot").cord("in", "-100").set("setting", "k / 2");
    let builder = pot(builder, "k / m / 8").element("P2", second);
    let builder = builder.element("A2", ElementBuilder::new("integrator").cords("x1", ["P2"]));
    // With k up to 2, k / m is up to 8.
    assert_eq!(ranges(builder.record(["A1", "A2"])), [[0.5, 2.0], [0.25, 2.0]]);
}

#[test]
fn initial_values_and_drives_stay_within_100_volts() {
    let integrator = ElementBuilder::new("integrator").cords("x1", ["D"]).set("initial", "x0 / x");
    let builder = PatchBuilder::new("driven")
        .parameter("x0", 80.0, "mm", [-200.0, 200.0])
        .parameter("F", 20.0, "N", [10.0, 90.0])
        .scale("x", 2.0, "mm")
        .scale("force", 0.5, "N")
        .drive("D", "force", ElementBuilder::new("step").set("height", "F"))
        .element("A1", integrator)
        .signal("x", "A1", "x", 1.0);
    assert_eq!(ranges(builder), [[-200.0, 200.0], [10.0, 50.0]]);
}

#[test]
fn a_formula_without_a_value_at_the_end_is_left_out() {
    let [[low, high]] = ranges(pot(with_k(2.0, [0.0, 4.0]), "1 / k"))[..] else { panic!("one range") };
    assert_eq!((low, high), (1.0, 4.0));
}

#[test]
fn the_middle_of_a_range_is_valid_too() {
    // 1 - (k - 2)^2 is negative outside of 1 ... 3; at present it is 0.75.
    let found = ranges(pot(with_k(1.5, [0.0, 9.0]), "1 - (k - 2)^2"));
    assert_eq!(found, [[1.0, 3.0]]);
    // 4 k (1 - k) 1.5 is above 1 between 0.211 and 0.789, and k = 0.1 is below.
    let [[low, high]] = ranges(pot(with_k(0.1, [0.0, 0.9]), "6 * k * (1 - k)"))[..] else { panic!() };
    assert!(low == 0.0 && (0.1..0.212).contains(&high), "{low} ... {high}");
}

#[test]
fn ends_are_rounded_towards_the_present_value() {
    assert_eq!(rounded_inwards(-0.123, -1.0), -0.13);
    assert_eq!(rounded_inwards(0.996, 0.5), 0.99);
    assert_eq!(rounded_inwards(101.9, 200.0), 102.0);
    assert_eq!(rounded_inwards(101.9, 110.0), 102.0);
    assert_eq!(rounded_inwards(-5.678, 3.0), -5.6);
    assert_eq!(rounded_inwards(9.8143, 9.81), 9.81);
    assert_eq!(rounded_inwards(9.8143, 9.814), 9.814);
    assert_eq!(snapped(2.999_999_9, 1.0, 5.0), 3.0);
    assert_eq!(snapped(3.000_000_1, 5.0, 1.0), 3.0);
    assert_eq!(snapped(-1e-9, -2.0, 10.0), 0.0);
    // The present end is 1e-9, and 0 is beyond it.
    assert_eq!(snapped(1.5e-9, 1.0, 1e-9), 1.5e-9);
}

#[test]
fn the_other_ends_keep_their_text() {
    let patch = pot(with_k(1.0, [0.5, 5.0]), "k / 3").build().unwrap();
    let (narrowed, changes) = with_narrowed_ranges(&patch).unwrap();
    assert_eq!(narrowed.value()["parameters"]["k"]["range"].to_string(), "[0.5,3]");
    assert_eq!(narrowed.parameters["k"].range, Some((0.5, 3.0)));
    let texts: Vec<String> = changes.iter().map(NarrowedRange::text).collect();
    assert_eq!(texts, ["range of k: 0.5 ... 3, where all settings are valid (problem: 0.5 ... 5)"]);
}

#[test]
fn a_scaled_patch_has_no_warnings_and_reports_its_ranges() {
    let text = r#"{"patchcord": 1, "title": "An oscillator",
        "parameters": {"m": {"value": 1, "unit": "kg", "range": [0.1, 10]},
            "k": {"value": 36, "unit": "N/m", "range": [-500, 500]},
            "x0": {"value": 80, "unit": "mm", "range": [-300, 300]}},
        "quantities": {"x": {"unit": "mm", "initial": "x0", "maximum": 100},
            "x'": {"unit": "mm/s", "initial": 0, "maximum": 600}},
        "equations": ["m x'' = -k x"], "run": {"for": 2, "step": 1e-3}}"#;
    let problem = Problem::parse("problem.json", text).unwrap_or_else(|report| panic!("{report}"));
    let scaled = scale_problem(&problem, &ScaleOptions::default()).unwrap();
    let warnings = Circuit::new(&scaled.patch).unwrap().warnings();
    assert!(warnings.findings.is_empty(), "{warnings}");
    let range = |name: &str| {
        let change = scaled.narrowed_ranges.iter().find(|change| change.parameter == name).unwrap();
        assert_eq!(scaled.patch.parameters[name].range, Some(change.range.into()));
        change.range
    };
    // With 1 mm and 6 mm/s per volt, the pot is k / m / 60. From k / m = 36 to 5000 is a ratio of 138.9, and to 60 it
    // is 1.667 = 138.9^0.1035. So k is at most 36 x 13.89^0.1035 = 47.3, and m is at least 0.1^0.1035 = 0.788.
    assert_eq!(range("k"), [0.0, 47.0]);
    assert_eq!(range("m"), [0.79, 10.0]);
    assert_eq!(range("x0"), [-100.0, 100.0]);
}
