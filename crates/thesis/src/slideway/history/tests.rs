//! Unit tests of `history`.

use proptest::prelude::*;

use super::*;
use crate::slideway::assert_close;

fn unit(damping: f64) -> Slip {
    Slip { drop: 1.0, mass: 1.0, stiffness: 1.0, damping }
}

#[test]
fn slip_distance_agrees_with_the_growth_of_friction() {
    let growth = GrowthAtRest { kinetic: 0.2, factor: 0.05, exponent: 0.3 };
    let (weight, stiffness, velocity) = (10.0, 2e4, 1e-4);
    let slip = growth.slip(weight, stiffness, velocity).unwrap();
    let grown = growth.static_coefficient(slip / velocity).unwrap() - growth.kinetic;
    assert_close(2.0 * weight * grown / stiffness, slip, 1e-12);
    let end = growth.end_of_stick_slip(weight, stiffness, slip).unwrap();
    assert_close(end, velocity, 1e-12);
}

#[test]
fn critical_velocity_is_at_tangency() {
    for (damping, exact, approximate) in
        [(0.001, 8.893, 8.921), (0.01, 2.739, 2.821), (0.05, 1.098, 1.262), (0.1, 0.680, 0.892)]
    {
        assert!((unit(damping).critical_velocity().unwrap() - exact).abs() < 1e-3);
        assert!((unit(damping).approximate_critical_velocity().unwrap() - approximate).abs() < 1e-3);
    }
    assert!(unit(0.0).critical_velocity().is_err());
    assert!(unit(0.999).critical_velocity().unwrap() > 0.0);
}

#[test]
fn a_slip_without_damping_lasts_half_a_period() {
    let slip = Slip { drop: 100.0, mass: 454.0, stiffness: 17.86e6, damping: 0.0 };
    assert!((slip.duration(1e-9).unwrap() / 0.015_839 - 1.0).abs() < 1e-4);
    let ratio = slip.drop_ratio(1e-3).unwrap();
    let closed = 2.0 * (PI - ratio.atan()) / (slip.stiffness / slip.mass).sqrt();
    assert!((slip.duration(1e-3).unwrap() / closed - 1.0).abs() < 1e-6);
    assert!(unit(0.05).duration(2.0).unwrap_err().to_string().contains("faster than the critical velocity"));
}

proptest! {
    #[test]
    fn slip_obeys_its_equation(damping in 0.0..0.9f64, drive in 0.1..10.0f64, time in 0.1..4.0f64) {
        let slip = unit(damping);
        let v = |time: f64| slip.velocity(drive, time).unwrap();
        let small = 1e-3;
        let first_derivative = (v(time + small) - v(time - small)) / (2.0 * small);
        let second_derivative = (v(time + small) - 2.0 * v(time) + v(time - small)) / small.powi(2);
        // M v'' + (f - n) v' + K (v - V) = 0, the slip's equation once differentiated.
        let residual = second_derivative + 2.0 * damping * first_derivative + v(time) - drive;
        prop_assert!(residual.abs() < 1e-4 * (1.0 + drive));
        prop_assert!(v(0.0).abs() < 1e-12 && (v(1e-6) / 1e-6 - 1.0).abs() < 1e-4 * (1.0 + drive));
    }

    #[test]
    fn slip_ends_below_the_critical_velocity_only(damping in 0.01..0.5f64, share in 0.2..2.0f64) {
        prop_assume!((share - 1.0).abs() > 1e-6);
        let slip = unit(damping);
        let drive = share * slip.critical_velocity().unwrap();
        let end = slip.duration(drive);
        prop_assert_eq!(end.is_ok(), share < 1.0);
        if let Ok(end) = end {
            prop_assert!(slip.velocity(drive, end).unwrap().abs() < 1e-9 * drive);
        }
    }
}

#[test]
fn other_relations_agree_with_the_print() {
    let growth = GrowthAtRest { kinetic: 0.2, factor: 0.05, exponent: 0.5 };
    assert_eq!(growth.static_coefficient(0.0), Ok(0.2));
    assert!((growth.static_coefficient(4.0).unwrap() - 0.3).abs() < 1e-12);
    assert!((growth.coefficient_at(1e-6, 4e-6).unwrap() - 0.3).abs() < 1e-12);
    let immediate = KatoLubricant { drop: 0.1, a: 1e9, m: 1.0, b: 1e9, n: 1.0 };
    let velocity = immediate.critical_velocity(450.0 * 9.80665, 450.0, 45e6).unwrap();
    assert!((velocity * 1e3 - 1.974).abs() < 1e-3);
    assert_eq!(dynamic_slope((100.0, 1.0), (40.0, 4.0)), Ok(-20.0));
    assert!(dynamic_slope((100.0, 1.0), (40.0, 1.0)).is_err());
    let friction = NakashimaFriction { weight: 1000.0, slope: -0.02, rate: 100.0, linear: 5.0 };
    assert_eq!((friction.falling(), friction.memory()), (20.0, Ok(0.01)));
}
