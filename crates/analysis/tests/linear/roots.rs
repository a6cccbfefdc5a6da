//! Characteristic roots in closed form.

use std::f64::consts::{PI, TAU};

use proptest::prelude::*;

use crate::common::{built, element, patch, program, random_cases, volts};
use crate::linear::{near, roots_of, shipped};
use patchcord_analysis::linear::{LinearError, Root, Stability};
use patchcord_core::patch::PatchBuilder;

/// Relative rounding error of a simple root.
const ROOT_TOLERANCE: f64 = 1e-12;

#[test]
fn a_mass_on_a_spring_has_the_frequency_sqrt_k_over_m() {
    for (m, k) in [(1.0, 40.0), (2.5, 7.0), (10.0, 100.0)] {
        let found = roots_of(&shipped("lessons/mass-and-spring", &[("m", m), ("k", k)]));
        let [root] = found[..] else { panic!("{found:?}") };
        assert!(near(root.natural_frequency(), (k / m).sqrt(), ROOT_TOLERANCE), "{root:?}");
        assert!(near(root.hertz(), (k / m).sqrt() / TAU, ROOT_TOLERANCE), "{root:?}");
        assert_eq!((root.damping(), root.time_constant()), (Some(0.0), None));
        assert_eq!((root.stability(), root.multiplicity), (Stability::Neutral, 1));
    }
}

proptest! {
    #![proptest_config(random_cases(48))]

    #[test]
    fn a_damped_oscillator_has_its_textbook_roots(m in 1.0..5.0f64, k in 10.0..100.0f64, d in 0.01..10.0f64) {
        let found = roots_of(&shipped("lessons/driven-oscillator", &[("m", m), ("k", k), ("d", d)]));
        let (omega, zeta) = ((k / m).sqrt(), d / (2.0 * (k * m).sqrt()));
        // Near zeta = 1 the error of a root is the square root of the rounding error.
        prop_assume!((zeta - 1.0).abs() > 1e-3);
        if zeta < 1.0 {
            prop_assert_eq!(found.len(), 1);
            prop_assert!(near(found[0].natural_frequency(), omega, 1e-11), "{:?}", found);
            prop_assert!(near(found[0].damping().unwrap(), zeta, 1e-10), "{:?}", found);
        } else {
            let spread = (zeta * zeta - 1.0).sqrt();
            let expected = [zeta - spread, zeta + spread].map(|factor| 1.0 / (omega * factor));
            let constants: Vec<_> = found.iter().map(|root| root.time_constant().unwrap()).collect();
            let agree = constants.iter().zip(&expected).all(|(constant, expected)| near(*constant, *expected, 1e-9));
            prop_assert!(agree, "{:?}", found);
            prop_assert!(found.iter().all(|root| root.damping().is_none()));
        }
    }
}

#[test]
fn at_critical_damping_there_is_a_double_root() {
    for (m, k) in [(1.0, 25.0), (2.0, 12.5), (1.0, 16.0)] {
        let d = 2.0 * f64::sqrt(k * m);
        let found = roots_of(&shipped("lessons/driven-oscillator", &[("m", m), ("k", k), ("d", d)]));
        let [root] = found[..] else { panic!("{found:?}") };
        assert_eq!((root.multiplicity, root.imaginary), (2, 0.0));
        assert!(near(root.real, -(k / m).sqrt(), ROOT_TOLERANCE), "{root:?}");
    }
}

#[test]
fn fig_8_4_has_198_34_rad_s_and_a_damping_of_0_09917() {
    let found = roots_of(&shipped("thesis/fig-8-04", &[]));
    let [root] = found[..] else { panic!("{found:?}") };
    let (m, k, f) = (454.0, 17.86e6, 17.86e3);
    assert!(near(root.natural_frequency(), f64::sqrt(k / m), ROOT_TOLERANCE), "{root:?}");
    assert!(near(root.damping().unwrap(), f / (2.0 * f64::sqrt(k * m)), ROOT_TOLERANCE), "{root:?}");
    assert!((root.natural_frequency() - 198.34).abs() < 0.005, "{root:?}");
    assert!((root.damping().unwrap() - 0.09917).abs() < 5e-6, "{root:?}");
}

#[test]
fn the_origin_of_van_der_pol_is_unstable() {
    for mu in [0.0, 0.5, 1.0, 1.5] {
        let found = roots_of(&shipped("lessons/van-der-pol", &[("mu", mu), ("x0", 0.0)]));
        let [root] = found[..] else { panic!("{found:?}") };
        assert!(near(root.natural_frequency(), 1.0, ROOT_TOLERANCE), "{root:?}");
        assert!((root.damping().unwrap() + 0.5 * mu).abs() < ROOT_TOLERANCE, "{root:?}");
        let stability = if mu > 0.0 { Stability::Unstable } else { Stability::Neutral };
        assert_eq!(root.stability(), stability);
    }
}

/// Equal masses between walls, joined by equal springs. V`n` is a velocity, A`n` the inverted position, I`n` the
/// position.
fn chain(masses: usize) -> PatchBuilder {
    let mut builder = volts("chain");
    for n in 1..=masses {
        // V' = -(10 x - 5 x_left - 5 x_right): every spring has a stiffness of 5 per mass.
        let mut force = element("integrator").cords("x10", [format!("I{n}").as_str()]);
        for neighbour in [n - 1, n + 1].into_iter().filter(|other| (1..=masses).contains(other)) {
            force = force.cords("x5", [format!("A{neighbour}").as_str()]);
        }
        builder = builder
            .element(&format!("V{n}"), force)
            .element(&format!("A{n}"), element("integrator").cords("x1", [format!("V{n}").as_str()]))
            .element(&format!("I{n}"), element("inverter").cord("in", &format!("A{n}")));
    }
    builder
}

#[test]
fn a_chain_of_three_masses_has_its_three_frequencies() {
    for masses in [3, 12] {
        let found = roots_of(&built(chain(masses)));
        assert_eq!(found.len(), masses, "{found:?}");
        for (mode, root) in found.iter().enumerate() {
            let angle = (mode + 1) as f64 * PI / (2.0 * (masses + 1) as f64);
            let expected = 2.0 * 5f64.sqrt() * angle.sin();
            assert!(near(root.natural_frequency(), expected, 1e-11), "{root:?} {expected}");
            assert_eq!((root.stability(), root.damping()), (Stability::Neutral, Some(0.0)));
        }
    }
}

#[test]
fn integrators_in_series_have_a_multiple_root_at_0() {
    let builder = volts("series")
        .element("A1", element("integrator").cords("x1", ["+100"]))
        .element("A2", element("integrator").cords("x10", ["A1"]))
        .element("A3", element("integrator").cords("x100", ["A2"]));
    let found = roots_of(&built(builder));
    assert_eq!(found, [Root { real: 0.0, imaginary: 0.0, multiplicity: 3 }]);
    assert_eq!((found[0].stability(), found[0].time_constant()), (Stability::Neutral, None));
}

#[test]
fn equal_lags_in_series_have_one_multiple_root() {
    let mut builder = volts("lags").time_scale(10.0);
    for n in 0..6 {
        let from = if n == 0 { "+100".to_owned() } else { format!("L{}", n - 1) };
        builder =
            builder.element(&format!("L{n}"), element("lag").cords("x1", [from.as_str()]).set("time", 2));
    }
    // A time constant of 2 machine seconds is 0.2 problem seconds.
    assert_eq!(roots_of(&built(builder)), [Root { real: -5.0, imaginary: 0.0, multiplicity: 6 }]);
}

/// Integrators in series with feedback from each: s^n + c_1 s^(n-1) + ... + c_n.
fn companion(coefficients: &[f64]) -> PatchBuilder {
    let mut builder = volts("companion");
    let mut first = element("integrator");
    let mut from = "A0".to_owned();
    for (n, coefficient) in coefficients.iter().enumerate() {
        if n > 0 {
            let (inverted, integral) = (format!("A{n}"), format!("I{n}"));
            builder = builder
                .element(&inverted, element("integrator").cords("x1", [from.as_str()]))
                .element(&integral, element("inverter").cord("in", &inverted));
            from = integral;
        }
        first = first.cords(&format!("x{coefficient}"), [from.as_str()]);
    }
    builder.element("A0", first)
}

#[test]
fn a_root_that_rounding_splits_is_merged() {
    // (s + 1)^n: the iteration alone gives roots that are 1e-16^(1/n) apart.
    for powers in [&[2.0, 1.0][..], &[3.0, 3.0, 1.0], &[4.0, 6.0, 4.0, 1.0]] {
        let found = roots_of(&built(companion(powers)));
        let [root] = found[..] else { panic!("{found:?}") };
        assert_eq!((root.multiplicity, root.imaginary), (powers.len(), 0.0));
        assert!(near(root.real, -1.0, 1e-12), "{root:?}");
    }
    // (s^2 + s + 4)^2: a double pair.
    let found = roots_of(&built(companion(&[2.0, 9.0, 8.0, 16.0])));
    let [root] = found[..] else { panic!("{found:?}") };
    assert_eq!(root.multiplicity, 2);
    assert!(
        near(root.natural_frequency(), 2.0, 1e-12) && near(root.damping().unwrap(), 0.25, 1e-12),
        "{root:?}"
    );
}

#[test]
fn close_roots_are_not_merged() {
    // (s + 1) (s + 1.001)
    let found = roots_of(&built(companion(&[2.001, 1.001])));
    assert_eq!(found.len(), 2, "{found:?}");
    assert!(near(found[0].real, -1.0, 1e-11) && near(found[1].real, -1.001, 1e-11), "{found:?}");
}

#[test]
fn roots_are_not_merged_if_their_mean_is_another_root() {
    // A rod of cells: -2 + 2 cos(k pi / 102) in 1/s, the middle ones evenly spaced.
    let cells = 101;
    let mut builder = volts("rod");
    for n in 1..=cells {
        let mut cell = element("integrator").cords("x2", [format!("A{n}").as_str()]);
        for neighbour in [n - 1, n + 1].into_iter().filter(|other| (1..=cells).contains(other)) {
            cell = cell.cords("x1", [format!("A{neighbour}").as_str()]);
        }
        builder = builder.element(&format!("A{n}"), cell);
    }
    let found = roots_of(&built(builder));
    assert_eq!(found.len(), cells);
    for (mode, root) in found.iter().enumerate() {
        let expected = -4.0 * (0.5 * (mode + 1) as f64 * PI / (cells + 1) as f64).sin().powi(2);
        assert!((root.real - expected).abs() < 1e-12 && root.multiplicity == 1, "{root:?} {expected}");
    }
}

#[test]
fn a_ring_of_equal_integrators_has_roots_on_a_circle() {
    for count in 2..=9usize {
        let mut builder = volts("ring");
        for n in 0..count {
            let from = format!("A{}", (n + count - 1) % count);
            builder = builder.element(&format!("A{n}"), element("integrator").cords("x2", [from.as_str()]));
        }
        // s^n = (-2)^n.
        let found = roots_of(&built(builder));
        assert_eq!(found.iter().map(|root| if root.imaginary > 0.0 { 2 } else { 1 }).sum::<usize>(), count);
        for root in &found {
            assert!(near(root.natural_frequency(), 2.0, 1e-12), "{count} {root:?}");
            let turns = (-root.real).atan2(root.imaginary) + 1.5 * PI;
            let turns = turns * count as f64 / TAU;
            assert!((turns - turns.round()).abs() < 1e-11, "{count} {root:?}");
        }
    }
}

#[test]
fn rounding_errors_of_a_fast_root_do_not_affect_a_slow_one() {
    // The roots differ by a factor of 1e6, and the fast state drives the slow one.
    let builder = volts("far apart")
        .element("A1", element("integrator").cords("x1000", ["A1"]))
        .element("A2", element("integrator").cords("x1000", ["A1"]).cords("x0.001", ["A2"]));
    let found = roots_of(&built(builder));
    assert_eq!(found.iter().map(|root| root.real).collect::<Vec<_>>(), [-0.001, -1000.0]);
}

#[test]
fn a_loop_without_an_integrator_is_eliminated() {
    // S = -(A + S / 2): S = -2/3 A, and A' = -3 S: unstable. With the inverter in between it decays.
    let builder = |back: &str| {
        volts("loop")
            .element("P", element("pot").cord("in", "S").set("setting", 0.5))
            .element("S", element("summer").cords("x1", ["A", "P"]))
            .element("I", element("inverter").cord("in", "S"))
            .element("A", element("integrator").cords("x3", [back]).set("initial", 1))
    };
    for (back, real) in [("S", 2.0), ("I", -2.0)] {
        let found = roots_of(&built(builder(back)));
        assert!(near(found[0].real, real, ROOT_TOLERANCE), "{found:?}");
        let stability = if real > 0.0 { Stability::Unstable } else { Stability::Stable };
        assert_eq!((found[0].stability(), found.len()), (stability, 1));
        assert!(near(found[0].time_constant().unwrap(), 0.5, ROOT_TOLERANCE), "{found:?}");
    }
}

#[test]
fn a_circuit_without_memory_has_no_roots() {
    assert_eq!(roots_of(&program(&patch("summer-loop"), &[])), []);
}

#[test]
fn an_infinite_derivative_returns_an_error_with_its_element() {
    let mut model = crate::linear::model(&built(companion(&[2.0, 1.0])));
    model.matrix[1][0] = f64::INFINITY;
    let error = LinearError::NoDerivative { element: model.states[1].name.clone() };
    assert_eq!(patchcord_analysis::linear::roots(&model), Err(error));
}

#[test]
fn a_derivative_whose_square_overflows_returns_an_error_with_its_element() {
    let mut model = crate::linear::model(&built(companion(&[2.0, 1.0])));
    for huge in [1e101, -1e200] {
        model.matrix[1][0] = huge;
        let error = LinearError::DerivativeTooLarge { element: model.states[1].name.clone() };
        assert_eq!(patchcord_analysis::linear::roots(&model), Err(error));
    }
}
