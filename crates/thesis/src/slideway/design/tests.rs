//! Unit tests of `design`.

use super::*;
use crate::slideway::assert_close;
use crate::slideway::falling::FallingFriction;

#[test]
fn figures_of_the_thesis_are_reproduced() {
    let pressure = 0.615 * KGF_PER_CM2;
    for (poise, limit) in [(0.13, 58.97), (0.34, 45.31), (0.455, 41.83), (0.595, 38.86)] {
        // eq 14-9 rounds the base to 2.23.
        assert_close(limit_velocity(pressure, 5.48 * UM, poise * POISE).unwrap() / MM_PER_S, limit, 3e-3);
    }
    assert_close(Interface::MODEL.static_friction(pressure).unwrap(), 1249.0, 1e-3);
    let derived = DesignEquation::derived();
    assert_close(derived.bracket, 19.8, 2e-3);
    assert_close(derived.bracket_viscosity, 0.0888, 1e-3);
}

#[test]
fn derived_equation_equals_its_chain_of_laws() {
    let design = Design::model(0.034, 27.6e6);
    let pressure = design.weight / design.interface.area;
    let limit = limit_velocity(pressure, design.lift, design.viscosity).unwrap();
    let equation = DesignEquation::derived();
    assert_close(equation.limit(&design).unwrap(), limit, 1e-9);
    // The text puts Pw^0.82 for Pw in the term of the flank.
    let [shear, climb] = design.interface.static_friction_factors().unwrap();
    let static_friction = (shear + climb) * (pressure / KGF_PER_CM2).powf(CONTACT_SHARE.exponent);
    let slope = OilLaw::AT_450_KGF.slope(design.viscosity, design.stiffness).unwrap();
    let velocity = FallingFriction { static_friction, limit }.velocity_at_slope(slope).unwrap();
    assert_close(equation.critical_velocity(&design).unwrap(), velocity, 1e-9);
}

#[test]
fn trends_are_logarithmic_derivatives() {
    let (equation, design) = (DesignEquation::derived(), Design::model(0.034, 27.6e6));
    let trends = equation.trends(&design).unwrap();
    let rise = |change: fn(&mut Design, f64)| {
        let at = |factor: f64| {
            let mut changed = design;
            change(&mut changed, factor);
            equation.critical_velocity(&changed).unwrap().ln()
        };
        (at(1.0 + 1e-5) - at(1.0 - 1e-5)) / 2e-5
    };
    let pairs = [
        (trends.viscosity, rise(|design, factor| design.viscosity *= factor)),
        (trends.weight, rise(|design, factor| design.weight *= factor)),
        (trends.stiffness, rise(|design, factor| design.stiffness *= factor)),
        (trends.polar, rise(|design, factor| design.interface.polar *= factor)),
        (trends.lift, rise(|design, factor| design.lift *= factor)),
        (trends.flank, rise(|design, factor| design.interface.flank *= factor)),
        (trends.area, rise(|design, factor| design.interface.area *= factor)),
    ];
    for (trend, measured) in pairs {
        assert!((trend - measured).abs() < 1e-6 * (1.0 + trend.abs()), "trend {trend}, measured {measured}");
    }
}

#[test]
fn polar_oil_has_no_critical_velocity() {
    let mut design = Design::model(0.034, 45e6);
    design.interface.polar = POLAR_ADDITIVE;
    let error = DesignEquation::PRINTED.critical_velocity(&design).unwrap_err();
    assert!(error.to_string().contains("it never oscillates"), "{error}");
    assert!(DesignEquation::PRINTED.limit(&Design { lift: 0.0, ..design }).is_err());
}
