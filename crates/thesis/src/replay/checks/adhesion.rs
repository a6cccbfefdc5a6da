//! Claims on earlier theories of the coefficient of friction (2.2, 2.3).
//!
//! Examples use the thesis's cast iron, because most of the cited papers give no numbers. The equations of chapter 2
//! are numbered with a point: eq 18.2.

use super::super::check_arguments::CheckArguments;
use super::super::finding::Finding;
use super::{Check, CheckError};
use crate::slideway::material::{Material, YIELD_TO_HARDNESS};
use crate::slideway::units::{CM, KGF_PER_MM2};
use crate::slideway::{SlidewayError, adhesion};

/// The checks of this file, by the name that the ledger uses.
pub(super) const CHECKS: &[Check] = &[
    Check { name: "tomlinson", run: tomlinson },
    Check { name: "bowden-tabor", run: bowden_tabor },
    Check { name: "mean-shear", run: mean_shear },
    Check { name: "ernst-merchant", run: ernst_merchant },
    Check { name: "wear-particle", run: wear_particle },
    Check { name: "kraghelskii", run: kraghelskii },
    Check { name: "junctions-grow", run: junctions_grow },
    Check { name: "cone-on-plane", run: cone_on_plane },
    Check { name: "gupta-cook", run: gupta_cook },
    Check { name: "gupta-cook-area", run: gupta_cook_area },
];

/// Shear strength of chapter 7's cast iron, in Pa (eq 61-7).
const SHEAR: f64 = Material::GRADE_17_IRON.shear_strength;

/// Flow pressure of chapter 7's cast iron, in Pa (eq 61-7).
const FLOW: f64 = YIELD_TO_HARDNESS * Material::GRADE_17_IRON.hardness;

/// Tomlinson's coefficient of cast iron, E in kgf/mm2, with Poisson's ratio nu and a sign in eq 2.2.
///
/// G = E / (2 (1 + nu)), A = (3 E + sign 4 G) / (G (3 E + G)), and the coefficient is 1.07e4 (2 A)^(2/3) with A in
/// in2/lbf (eq 1.2). Claims 2-001 and 2-002.
fn tomlinson(given: &CheckArguments) -> Result<Finding, CheckError> {
    let young = given.number("E")? * KGF_PER_MM2;
    let shear = young / (2.0 * (1.0 + given.number("nu")?));
    let constant = adhesion::tomlinson_constant(young, shear, given.number("sign")?)?;
    Ok(Finding::Number(adhesion::tomlinson(constant, constant)?))
}

/// Checks that A Ss + a p without ploughing gives a coefficient Ss / Pm that does not depend on the load.
///
/// Argument `W`: loads in N. The area is W / Pm. Eq 4.2 ... 7.2, claim 2-005.
fn bowden_tabor(given: &CheckArguments) -> Result<Finding, CheckError> {
    let predicted = adhesion::shear_by_flow(SHEAR, FLOW)?;
    let coefficient = |load: f64| Ok(adhesion::sheared_and_ploughed(load / FLOW, SHEAR, 0.0, FLOW)? / load);
    let coefficients =
        given.numbers("W")?.into_iter().map(coefficient).collect::<Result<Vec<f64>, SlidewayError>>()?;
    let holds = coefficients.iter().all(|coefficient| (coefficient / predicted - 1.0).abs() < 1e-12);
    Ok(Finding::truth(holds, format!("{predicted:.4} for chapter 7's cast iron, at every load")))
}

/// Checks that the mean shear strength rises from that of the film to that of the metal with the metallic share.
///
/// Ss = alpha Ss1 + (1 - alpha) Ss2. The film has a tenth of the strength of the metal. Eq 8.2, claim 2-006.
fn mean_shear(_: &CheckArguments) -> Result<Finding, CheckError> {
    let [film, half, metal] = [0.0, 0.5, 1.0]
        .map(|share| Ok::<_, SlidewayError>(adhesion::mean_shear(share, SHEAR, 0.1 * SHEAR)? / SHEAR));
    let (film, half, metal) = (film?, half?, metal?);
    let found = format!(
        "{film:.2}, {half:.2}, {metal:.2} times that of the metal at a metallic share of 0, 1/2 and 1"
    );
    Ok(Finding::truth(
        (film - 0.1).abs() < 1e-12 && film < half && half < metal && (metal - 1.0).abs() < 1e-12,
        found,
    ))
}

/// Ss / Pm + tan(theta) for chapter 7's cast iron.
///
/// Argument `tan`. Eq 11.2, claim 2-008.
fn ernst_merchant(given: &CheckArguments) -> Result<Finding, CheckError> {
    Ok(Finding::Number(adhesion::ernst_merchant(SHEAR, FLOW, given.number("tan")?.atan())?))
}

/// Rabinowicz's least diameter in cm, for J/m2 and kgf/mm2.
///
/// 60 000 W / p, with `W` in J/m2 and `p` in kgf/mm2. Claim 2-010.
fn wear_particle(given: &CheckArguments) -> Result<Finding, CheckError> {
    let hardness = given.number("p")? * KGF_PER_MM2;
    Ok(Finding::Number(adhesion::wear_particle(given.number("W")?, hardness)? / CM))
}

/// Checks that eq 14.2 follows from eq 12.2 and 13.2 if the numerator of eq 13.2 is the load.
///
/// alpha / (nu sigma_s) + beta, at loads `W` in N with example constants. Claim 2-011.
fn kraghelskii(given: &CheckArguments) -> Result<Finding, CheckError> {
    let (alpha, beta, nu, stress) = (0.2 * FLOW, 0.05, 3.0, FLOW / 3.0);
    let predicted = adhesion::kraghelskii(alpha, nu, stress, beta)?;
    let by_parts = |load: f64| (alpha * load / (nu * stress) + beta * load) / load;
    let holds = given.numbers("W")?.into_iter().all(|load| (by_parts(load) / predicted - 1.0).abs() < 1e-12);
    Ok(Finding::truth(holds, format!("{predicted:.3} at every load, with W / (nu sigma_s)")))
}

/// Tsukizoe and Hisakado's coefficient of shearing.
///
/// (Ss/Pm) / sqrt(1 - alpha (Ss/Pm)^2). The scan lost the root. Eq 21.2, claim 2-022.
fn junctions_grow(given: &CheckArguments) -> Result<Finding, CheckError> {
    Ok(Finding::Number(adhesion::tsukizoe_hisakado(SHEAR, FLOW, given.number("alpha")?)?))
}

/// Tsukizoe and Hisakado's coefficient of a cone.
///
/// Arguments: `mu` and `tan`. Eq 22.2, claim 2-023.
fn cone_on_plane(given: &CheckArguments) -> Result<Finding, CheckError> {
    let slope = given.number("tan")?.atan();
    Ok(Finding::Number(adhesion::cone_on_plane(given.number("mu")?, slope)?))
}

/// Gupta and Cook's coefficient for S = Y.
///
/// 0.93 S / Y (eq 26.2). Claim 2-025.a.
fn gupta_cook(_: &CheckArguments) -> Result<Finding, CheckError> {
    Ok(Finding::Number(adhesion::gupta_cook(FLOW, FLOW)?))
}

/// The factor of W (2 / Y) in Gupta and Cook's contact area.
///
/// Y is 2 Pa and the load 1 N, so that the factor remains. Eq 25.2, claim 2-025.b.
fn gupta_cook_area(_: &CheckArguments) -> Result<Finding, CheckError> {
    Ok(Finding::Number(adhesion::gupta_cook_area(1.0, 2.0)?))
}
