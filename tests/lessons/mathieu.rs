//! Mathieu: the boundaries of stability.

use std::f64::consts::PI;

use crate::common::{run_for, voltage};
use crate::known_problems::runs::{peak, program, run, step_of, values};

const STEM: &str = "lessons/mathieu";

/// Trace of the monodromy matrix over one period of the pump. The solution is stable if its absolute value is below 2.
fn trace_over_a_period(a: f64, q: f64) -> f64 {
    let after = |y0: f64, v0: f64| {
        let program = program(STEM, &[("a", a), ("q", q), ("y0", y0), ("v0", v0)]);
        let machine = run_for(&program, step_of(STEM), PI);
        (voltage(&machine, "B1") * 0.01, voltage(&machine, "A1") * 0.02)
    };
    // The start is 0.1, because an unstable deflection exceeds 1 within the period.
    10.0 * (after(0.1, 0.0).0 + after(0.0, 0.1).1)
}

/// Characteristic values a0, b1, a1, b2, a2 of q (scipy 1.17, scipy.special.mathieu_a and mathieu_b).
const BOUNDARIES: [(f64, [f64; 5]); 2] = [
    (
        0.2,
        [
            -0.019_913_296_358_4,
            0.795_123_868_083_9,
            1.194_874_059_204_5,
            3.996_667_245_138_2,
            4.016_579_152_969_5,
        ],
    ),
    (
        1.0,
        [
            -0.455_138_604_107_4,
            -0.110_248_816_992_1,
            1.859_108_072_514_4,
            3.917_024_772_998_5,
            4.371_300_982_735_1,
        ],
    ),
];

#[test]
fn the_boundaries_are_the_characteristic_values() {
    for (q, boundaries) in BOUNDARIES {
        for (a, trace) in boundaries.iter().zip([2.0, -2.0, -2.0, 2.0, 2.0]) {
            let found = trace_over_a_period(*a, q);
            assert!((found - trace).abs() < 1e-8, "a {a}, q {q}: {found}");
        }
    }
}

#[test]
fn stable_and_unstable_regions_alternate() {
    for (q, [a0, b1, a1, b2, a2]) in BOUNDARIES {
        for stable in [0.5 * (a0 + b1), 0.5 * (a1 + b2), a2 + 0.5] {
            assert!(trace_over_a_period(stable, q).abs() < 2.0, "a {stable}, q {q}");
        }
        for unstable in [a0 - 0.05, 0.5 * (b1 + a1), 0.5 * (b2 + a2)] {
            assert!(trace_over_a_period(unstable, q).abs() > 2.0, "a {unstable}, q {q}");
        }
    }
}

#[test]
fn the_lesson_shows_a_stable_and_an_unstable_case() {
    let stable = run(STEM, &[], 600.0);
    let largest = peak(&values(&stable, "y"));
    assert!(largest < 0.51 && stable.overloads().count() == 0, "{largest}");
    let unstable = run(STEM, &[("a", 1.0)], 60.0);
    assert!(unstable.overloads().count() > 0);
    // The inverted pendulum is stable with shaking and unstable without.
    assert_eq!(run(STEM, &[("a", -0.1), ("q", 0.6), ("y0", 0.1)], 600.0).overloads().count(), 0);
    assert!(run(STEM, &[("a", -0.1), ("q", 0.0), ("y0", 0.1)], 60.0).overloads().count() > 0);
}
