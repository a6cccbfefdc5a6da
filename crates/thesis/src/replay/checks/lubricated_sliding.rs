//! Claims on the lubricated sliding joint, and on the wedge of oil between its ridges (7.3.ii).
//!
//! Common arguments: `oil`, which is 1 or 2, and optionally `Pw` in kgf/cm2 (0.65), `joint` (`printed`, `table` or
//! `sums`), `shear=tabor` and the film (`film` or `Ko`). The optional ones are read in
//! [`joint_at_rest`](super::joint_at_rest). Velocities `V` are in cm/s, as in the text.

use super::super::check_arguments::{ArgumentError, CheckArguments};
use super::super::finding::Finding;
use super::dry_sliding::POINTS;
use super::joint_at_rest::{film, joint, pressure};
use super::stability::part_of;
use super::{Check, CheckError};
use crate::slideway::SlidewayError;
use crate::slideway::boundary_film::BoundaryFilm;
use crate::slideway::design::limit_velocity;
use crate::slideway::lubricated::{LubricatedJoint, LubricatedSliding};
use crate::slideway::oil::{Correction, Oil, thickening, thinning};
use crate::slideway::power_law::PowerLaw;
use crate::slideway::units::{CM_PER_S, KGF, MM_PER_S, N_S_PER_MM, UM, UM2};
use crate::slideway::wedge::{RangeProfile, Wedge};

/// The checks of this file, by the name that the ledger uses.
pub(super) const CHECKS: &[Check] = &[
    Check { name: "range-profile", run: range_profile },
    Check { name: "wedge-fit", run: wedge_fit },
    Check { name: "wedge-speed-fit", run: wedge_speed_fit },
    Check { name: "parting-velocity", run: parting_velocity },
    Check { name: "lubricated-sliding", run: lubricated_sliding },
    Check { name: "general-limit-agrees", run: general_limit_agrees },
    Check { name: "lift-stays-small", run: lift_stays_small },
    Check { name: "parting-trend", run: parting_trend },
    Check { name: "load-shares", run: load_shares },
    Check { name: "rises-slowly", run: rises_slowly },
    Check { name: "fall-exponent", run: fall_exponent },
    Check { name: "printed-total-excess", run: printed_total_excess },
    Check { name: "oil-drag-offset", run: oil_drag_offset },
    Check { name: "oil-damping", run: oil_damping },
    Check { name: "polar-lowers", run: polar_lowers },
    Check { name: "viscosity", run: viscosity },
];

/// A quantity of the thesis's range profile, in um and um2, or of the wedge over a gap of H um.
///
/// Argument `of`: `ridges` (200), `depth` (3 um), `free-area` (27440 um2, eq 137-7) and `touching-gap` (5.48 um, eq
/// 139-7) need no gap. `slope` m = depth / H (eq 141-7), `pressure-factor` Kp (eq 142-7) and `drag-factor` Kf (eq
/// 175-7) need `H`. Claims 7-061, 7-062.a, 7-147, 7-148.b, 7-150, 7-151 and 7-189.
fn range_profile(given: &CheckArguments) -> Result<Finding, CheckError> {
    type ProfileQuantity = fn(&RangeProfile, &CheckArguments) -> Result<f64, CheckError>;
    fn wedge(profile: &RangeProfile, given: &CheckArguments) -> Result<Wedge, CheckError> {
        Ok(profile.wedge(given.number("H")? * UM)?)
    }
    let known: [(&str, ProfileQuantity); 7] = [
        ("ridges", |profile, _| Ok(profile.ridges()?)),
        ("depth", |profile, _| Ok(profile.depth()? / UM)),
        ("free-area", |profile, _| Ok(profile.free_area()? / UM2)),
        ("touching-gap", |profile, _| Ok(profile.touching_gap()? / UM)),
        ("slope", |profile, given| Ok(wedge(profile, given)?.slope())),
        ("pressure-factor", |profile, given| Ok(wedge(profile, given)?.pressure_factor())),
        ("drag-factor", |profile, given| Ok(wedge(profile, given)?.drag_factor())),
    ];
    given.choice("of", &known)?(&RangeProfile::OF_THESIS, given).map(Finding::Number)
}

/// Factor or exponent of Kp or Kf against the gap in um, fitted evenly over `from` ... `to`.
///
/// Arguments: `of`, `from` and `to` in um, `part`. The text has Kp = 0.05 / H^0.478 (eq 151-7) and Kf = 0.51 H^0.23 (eq
/// 176-7) over 4.64 ... 9.2 um, the gaps from rest to 10 cm/s. Claims 7-157 and 7-190.
fn wedge_fit(given: &CheckArguments) -> Result<Finding, CheckError> {
    let factor = given.choice::<fn(&Wedge) -> f64>(
        "of",
        &[("pressure-factor", Wedge::pressure_factor), ("drag-factor", Wedge::drag_factor)],
    )?;
    fit_evenly(given, |gap| Ok(factor(&RangeProfile::OF_THESIS.wedge(gap * UM)?)))
}

/// Factor or exponent of V / Cv against V in cm/s, fitted over `from` ... `to`.
///
/// V / Cv is the velocity that enters Reynolds' equation; Cv = 1.6 + 0.14 V for oil 1 and 7.4 + 0.64 V for oil 2 (eq
/// 147-7, 148-7). The text has 0.79 V^0.624 and 0.145 V^0.7 (eq 149-7, 150-7), fitted above VcL. Claims 7-155 and
/// 7-156.
fn wedge_speed_fit(given: &CheckArguments) -> Result<Finding, CheckError> {
    let correction = given.choice("oil", &[("1", Correction::ONE), ("2", Correction::TWO)])?;
    fit_evenly(given, |velocity| Ok(correction.wedge_speed(velocity)))
}

/// Factor or exponent of a power law fitted to a function at even steps over `from` ... `to`.
///
/// The 41 points are evenly spaced in x, not in its logarithm, so the upper part of the range has more weight. The fit
/// minimises the squared differences of logarithms. `part` selects factor or exponent.
fn fit_evenly(
    given: &CheckArguments,
    y: impl Fn(f64) -> Result<f64, SlidewayError>,
) -> Result<Finding, CheckError> {
    let (from, to) = (given.number("from")?, given.number("to")?);
    let point = |step: u32| {
        let x = from + (to - from) * f64::from(step) / f64::from(POINTS);
        y(x).map(|y| (x, y))
    };
    part_of(given, &PowerLaw::fit(&(0..=POINTS).map(point).collect::<Result<Vec<_>, _>>()?)?)
}

/// Oil 1 or oil 2. The argument `oil` is required. Oil 1 has 0.74 P, oil 2 has 5.88 P (7.3.ii).
fn oil(given: &CheckArguments) -> Result<Oil, ArgumentError> {
    given.choice("oil", &[("1", Oil::ONE), ("2", Oil::TWO)])
}

/// The lubricated joint of a claim: oil, film, pressure and joint. The gap at which the ridges part is that of the
/// thesis, 5.48 um.
fn lubricated(given: &CheckArguments) -> Result<LubricatedJoint, CheckError> {
    let thesis = LubricatedJoint::of_thesis(oil(given)?, film(given)?, pressure(given)?)?;
    Ok(LubricatedJoint { joint: joint(given)?, ..thesis })
}

/// VcL of an oil in mm/s.
///
/// The velocity at which the film carries the whole load over the gap Ho + hd (eq 166-7, 167-7). Claims 7-171 and
/// 7-172: 43.1 and 21.5 mm/s at 0.65 kgf/cm2. The text prints no numbers.
fn parting_velocity(given: &CheckArguments) -> Result<Finding, CheckError> {
    Ok(Finding::Number(lubricated(given)?.limit_velocity()? / MM_PER_S))
}

/// A quantity of the lubricated joint at V cm/s: lift in um, or a friction coefficient.
///
/// Arguments: `of`, `oil`, `V` up to 10 cm/s, and the film. `lift` is hs of eq 160-7, `solid` mu_k of eq 163-7, `oil`
/// mu_0 of eq 172-7, `total` friction divided by weight, `printed-total` mu_k + mu_0 of eq 179-7. The figures 7.29 ...
/// 7.33 are lost, so claims 7-177 ... 7-184 record our values without a comparison.
fn lubricated_sliding(given: &CheckArguments) -> Result<Finding, CheckError> {
    let quantity = given.choice::<fn(&LubricatedSliding) -> f64>(
        "of",
        &[
            ("lift", |at| at.lift / UM),
            ("solid", |at| at.solid),
            ("oil", |at| at.oil),
            ("total", |at| at.total),
            ("printed-total", LubricatedSliding::printed_total),
        ],
    )?;
    let at = lubricated(given)?.at_velocity(given.number("V")? * CM_PER_S)?;
    Ok(Finding::Number(quantity(&at)))
}

/// Checks whether the general eq 11-9 agrees with the VcL of eq 166-7 or 167-7 to 2 %.
///
/// Eq 11-9 uses one exponent, 1.515, for all oils. It is the mean of 1/0.624 and 1/0.7, the exponents of both oils.
/// Claims 7-174.a and b: 8 % less for oil 1, 5 % more for oil 2.
fn general_limit_agrees(given: &CheckArguments) -> Result<Finding, CheckError> {
    let joint = lubricated(given)?;
    let own = joint.limit_velocity()?;
    let general = limit_velocity(joint.pressure, joint.touching_gap, joint.oil.viscosity)?;
    let found =
        format!("{:.1} mm/s, and {:.1} mm/s by the law of the oil", general / MM_PER_S, own / MM_PER_S);
    Ok(Finding::truth((general / own - 1.0).abs() < 0.02, found))
}

/// Checks whether the lift of the table at V cm/s is less than the gap at which its ridges part.
///
/// Claims 7-199.a and b, at 10 cm/s. The text states no size, so the gap of 5.48 um serves as the measure.
fn lift_stays_small(given: &CheckArguments) -> Result<Finding, CheckError> {
    let joint = lubricated(given)?;
    let lift = joint.at_velocity(given.number("V")? * CM_PER_S)?.lift;
    let found =
        format!("lift {:.2} um; the ridges part at a gap of {:.2} um", lift / UM, joint.touching_gap / UM);
    Ok(Finding::shape(lift < joint.touching_gap, found))
}

/// Checks whether VcL falls if the viscosity doubles, or if a smoother surface reduces the gap by a tenth.
///
/// Argument `by`: `viscosity` or `smoothness`. Claims 7-196.a and b. Claim 5-027 uses the second: with age a surface
/// gets smoother, and the velocity of least friction falls.
fn parting_trend(given: &CheckArguments) -> Result<Finding, CheckError> {
    let joint = lubricated(given)?;
    let thicker = Oil { viscosity: 2.0 * joint.oil.viscosity, ..joint.oil };
    let other = given.choice(
        "by",
        &[
            ("viscosity", LubricatedJoint { oil: thicker, ..joint }),
            ("smoothness", LubricatedJoint { touching_gap: 0.9 * joint.touching_gap, ..joint }),
        ],
    )?;
    let [before, after] = [joint, other].map(|joint| joint.limit_velocity());
    let (before, after) = (before? / MM_PER_S, after? / MM_PER_S);
    Ok(Finding::shape(after < before, format!("from {before:.1} to {after:.1} mm/s")))
}

/// Checks whether the load on the ridges by their lift equals the load that the film does not carry, at V cm/s.
///
/// The load on the ridges is Pw (1 - hs / hd)^4.55 (eq 161-7), the load on the film is PL (eq 162-7). The check
/// recomputes both shares from the lift and compares them to 1e-9. Claims 7-164.a and b.
fn load_shares(given: &CheckArguments) -> Result<Finding, CheckError> {
    let (joint, velocity) = (lubricated(given)?, given.number("V")? * CM_PER_S);
    let at = joint.at_velocity(velocity)?;
    let penetration = joint.joint.penetration(joint.pressure)?;
    let by_lift = (1.0 - at.lift / penetration).powf(1.0 / joint.joint.penetration.exponent);
    let film = joint.oil.film_pressure(velocity, joint.touching_gap - penetration + at.lift)?;
    let by_film = 1.0 - film / joint.pressure;
    Ok(Finding::truth((by_lift - by_film).abs() < 1e-9, format!("{by_lift:.5} and {by_film:.5}")))
}

/// Checks whether friction rises less steeply from VcL to 10 cm/s than it falls up to VcL.
///
/// Claims 7-195.c and d (4.5). Both slopes are means: from rest to VcL, and from VcL to 10 cm/s.
fn rises_slowly(given: &CheckArguments) -> Result<Finding, CheckError> {
    let joint = lubricated(given)?;
    let (limit, fast) = (joint.limit_velocity()?, 10.0 * CM_PER_S);
    let at = |velocity: f64| joint.at_velocity(velocity).map(|at| at.total);
    let fall = (at(0.0)? - at(limit)?) / limit * CM_PER_S;
    let rise = (at(fast)? - at(limit)?) / (fast - limit) * CM_PER_S;
    let found = format!("falls by {fall:.4} per cm/s, rises by {rise:.4} per cm/s");
    Ok(Finding::shape(rise > 0.0 && rise < fall, found))
}

/// Exponent of mu_k against VcL - V, fitted evenly from rest to the share `to` of VcL. With `through=rest` the law
/// passes through mu_s at rest.
///
/// The text has mu_k proportional to (VcL - V)^2.18 (eq 168-7), and later mu_s (1 - V / VcL)^2.18, which begins at
/// static friction (eq 169-7, 170-7). Points are evenly spaced in velocity. Near VcL the curves fall more steeply, so
/// `to` is 0.7 or 0.8 in most claims (7-185, 7-186).
fn fall_exponent(given: &CheckArguments) -> Result<Finding, CheckError> {
    let (joint, share) = (lubricated(given)?, given.number("to")?);
    let limit = joint.limit_velocity()?;
    let point = |step: u32| {
        let velocity = share * limit * f64::from(step) / f64::from(POINTS);
        joint.at_velocity(velocity).map(|at| ((limit - velocity) / CM_PER_S, at.solid))
    };
    let points = (0..=POINTS).map(point).collect::<Result<Vec<_>, _>>()?;
    Ok(Finding::Number(match given.text("through") {
        Some(_) => given.choice("through", &[("rest", exponent_through_first(&points))])?,
        None => PowerLaw::fit(&points)?.exponent,
    }))
}

/// The exponent of the power law through the first point with the least squared logarithmic deviation from the others.
///
/// The sum over the other points is exponent = sum(X Y) / sum(X^2), with X = ln(x / x0) and Y = ln(y / y0).
fn exponent_through_first(points: &[(f64, f64)]) -> f64 {
    let (x0, y0) = points[0];
    let logarithms = || points[1..].iter().map(|(x, y)| ((x / x0).ln(), (y / y0).ln()));
    logarithms().map(|(x, y)| x * y).sum::<f64>() / logarithms().map(|(x, _)| x * x).sum::<f64>()
}

/// Checks whether mu_k + mu_0 exceeds friction / weight by less than 5e-4, from rest to VcL.
///
/// The text adds mu_k, which is relative to the weight, and mu_0, which is relative to the load that the oil carries
/// (eq 179-7). The sum is too large below VcL. The bound 5e-4 is half a unit of the third digit of a coefficient. Claim
/// 7-193.
fn printed_total_excess(given: &CheckArguments) -> Result<Finding, CheckError> {
    let joint = lubricated(given)?;
    let limit = joint.limit_velocity()?;
    let mut most = 0.0f64;
    for step in 0..=1000 {
        let at = joint.at_velocity(limit * f64::from(step) / 1000.0)?;
        most = most.max(at.printed_total() - at.total);
    }
    Ok(Finding::truth(most < 5e-4, format!("up to {most:.4} too large")))
}

/// Checks whether mu_0 rises more steeply near rest than at higher velocities, and whether the straight line through
/// its values at VcL and 10 cm/s is positive at rest.
///
/// Figs 7.32 and 7.33, claims 7-195.a and b. "Near rest" is the mean slope from rest to 0.05 cm/s. The offset at rest
/// is what makes the oil appear as constant friction in addition to viscous friction.
fn oil_drag_offset(given: &CheckArguments) -> Result<Finding, CheckError> {
    let joint = lubricated(given)?;
    let (offset, slope) = oil_friction_line(&joint)?;
    let slow = 0.05 * CM_PER_S;
    let steep = joint.at_velocity(slow)?.oil / slow / slope;
    let found = format!("{offset:.4} at rest; near rest {steep:.0} times as steep");
    Ok(Finding::shape(offset > 0.0 && steep > 1.0, found))
}

/// The value at rest of the straight line through mu_0 at VcL and 10 cm/s, and its slope in s/m. Above VcL oil friction
/// is nearly linear, so this line is the viscous friction of the lubricated table.
fn oil_friction_line(joint: &LubricatedJoint) -> Result<(f64, f64), SlidewayError> {
    let (slow, fast) = (joint.limit_velocity()?, 10.0 * CM_PER_S);
    let start = joint.at_velocity(slow)?.oil;
    let slope = (joint.at_velocity(fast)?.oil - start) / (fast - slow);
    Ok((start - slope * slow, slope))
}

/// The slope of the oil friction of a table of W kgf along this line, in N s/mm.
///
/// Claims 7-203.a and b compare it with the 10.7 N s/mm of the simulation (eq 183-7). The table of the claims has 450
/// kgf.
fn oil_damping(given: &CheckArguments) -> Result<Finding, CheckError> {
    let (_, slope) = oil_friction_line(&lubricated(given)?)?;
    Ok(Finding::Number(slope * given.number("W")? * KGF / N_S_PER_MM))
}

/// Checks whether a polar film lowers friction at every velocity below VcL, and does not change VcL.
///
/// The films are those of Ko = 70 and 120 kgf/mm2. Velocities are 100 values from rest to just below VcL. VcL depends
/// on the oil and the gap only (eq 166-7), so it must be exactly equal. Claims 7-197.a and b.
fn polar_lowers(given: &CheckArguments) -> Result<Finding, CheckError> {
    let plain = LubricatedJoint::of_thesis(oil(given)?, BoundaryFilm::NON_POLAR, pressure(given)?)?;
    let polar = LubricatedJoint { film: BoundaryFilm::POLAR, ..plain };
    let limits = [plain, polar].map(|joint| joint.limit_velocity());
    let (limit, other) = (limits[0].clone()?, limits[1].clone()?);
    let mut holds = limit == other;
    for step in 0..100 {
        let velocity = limit * f64::from(step) / 100.0;
        holds &= polar.at_velocity(velocity)?.total < plain.at_velocity(velocity)?.total;
    }
    Ok(Finding::truth(holds, format!("VcL {:.1} mm/s with both films", limit / MM_PER_S)))
}

/// The factor by which viscosity changes under a pressure of p MN/m2 and a temperature rise in K.
///
/// The factor is 2^(p / 35) 2^(-rise / 10) (6.5, 1e and 1f). Both arguments are 0 unless given. Claims 6-006 and 6-007.
fn viscosity(given: &CheckArguments) -> Result<Finding, CheckError> {
    let (pressure, rise) = (given.number_or("p", 0.0)? * 1e6, given.number_or("rise", 0.0)?);
    Ok(Finding::Number(thickening(pressure)? * thinning(rise)?))
}
