//! Claims on the joint at rest, and on its film of oil (7.2, 7.2.i).
//!
//! Common arguments, all optional: `Pw` in kgf/cm2 (0.65), `joint` (`printed`, `table` or `sums`), `shear=tabor`, and
//! the film (`film` or `Ko`). Checks of the sliding joint read the same arguments with the functions of this file.

use std::f64::consts::PI;

use super::super::check_arguments::{ArgumentError, CheckArguments};
use super::super::finding::Finding;
use super::ridges::range;
use super::stability::part_of;
use super::{Check, CheckError};
use crate::slideway::SlidewayError;
use crate::slideway::asperities::ContactLaws;
use crate::slideway::boundary_film::{BoundaryFilm, film_shear_strength};
use crate::slideway::joint::Joint;
use crate::slideway::material::Material;
use crate::slideway::power_law::PowerLaw;
use crate::slideway::ridge::Ridge;
use crate::slideway::units::{CM2, KGF, KGF_PER_CM2, KGF_PER_MM2, UM, UM2};

/// The checks of this file, by the name that the ledger uses.
pub(super) const CHECKS: &[Check] = &[
    Check { name: "joint-at-rest", run: joint_at_rest },
    Check { name: "pull-raises-friction", run: pull_raises_friction },
    Check { name: "friction-and-load", run: friction_and_load },
    Check { name: "slip-within-radii", run: slip_within_radii },
    Check { name: "static-friction-law", run: static_friction_law },
    Check { name: "boundary-film", run: boundary_film },
    Check { name: "film-for-friction", run: film_for_friction },
];

/// Number of loads for a fit of friction, evenly spaced on a logarithmic scale.
const POINTS: u32 = 21;

/// The origin of the constants of a joint.
#[derive(Debug, Clone, Copy)]
enum JointSource {
    /// The printed constants, including 9707.
    Printed,
    /// The printed Table T7.1, and the arithmetic of the text from there on.
    Table,
    /// Geometry and metal alone.
    Sums,
}

/// The joint. The default is grade 17 iron with the printed constants; `shear=tabor` selects the shear strength of eq
/// 70-7. The argument `joint` selects the source of the constants.
pub(super) fn joint(given: &CheckArguments) -> Result<Joint, CheckError> {
    let known =
        [("printed", JointSource::Printed), ("table", JointSource::Table), ("sums", JointSource::Sums)];
    let source = given.text("joint").map_or(Ok(JointSource::Printed), |_| given.choice("joint", &known))?;
    let iron = Material::GRADE_17_IRON;
    let joint = match source {
        JointSource::Printed => Joint::PRINTED,
        JointSource::Table => Joint::new(Ridge::GROUND, iron, &ContactLaws::PRINTED),
        JointSource::Sums => Joint::of_surfaces(Ridge::GROUND, iron, 0.06 * UM)?,
    };
    let material = given
        .text("shear")
        .map_or(Ok(iron), |_| given.choice("shear", &[("tabor", iron.with_tabor_shear())]))?;
    Ok(Joint { material, ..joint })
}

/// The film: none, that of one of the thesis's oils, or one with Ko in kgf/mm2.
///
/// The argument `film` is `dry`, `plain` (Ko = 70) or `polar` (Ko = 120); `Ko` takes precedence. Without an argument
/// the joint is dry. Films other than `dry` have the shear strength 2.9 kgf/mm2.
pub(super) fn film(given: &CheckArguments) -> Result<BoundaryFilm, ArgumentError> {
    if given.text("Ko").is_some() {
        return Ok(BoundaryFilm::of_thesis(given.number("Ko")?));
    }
    let known =
        [("dry", BoundaryFilm::DRY), ("plain", BoundaryFilm::NON_POLAR), ("polar", BoundaryFilm::POLAR)];
    given.text("film").map_or(Ok(BoundaryFilm::DRY), |_| given.choice("film", &known))
}

/// Mean pressure in Pa from Pw in kgf/cm2. The default is that of the thesis's table.
pub(super) fn pressure(given: &CheckArguments) -> Result<f64, ArgumentError> {
    Ok(given.number_or("Pw", 0.65)? * KGF_PER_CM2)
}

/// A quantity of the joint at rest under Pw kgf/cm2, in the units of the thesis.
///
/// Argument `of`, for one square centimetre:
///
/// * `penetration` hd and `displacement` xm at slip, in um (eq 94-7, 66-7)
/// * `area` Ac and `leading-area` AcL, in um2 (eq 46-7, 56-7); `leading-pressure` Pw / AcL in kgf/mm2 (eq 74-7)
/// * `stiffness` Ka in kgf/um (eq 49-7), `shear-force` AcL KLP in kgf (eq 58-7)
/// * `friction` mu_s with the film (eq 59-7, 85-7), `initial-friction` mu_so of the first pull (eq 67-7)
///
/// Claims 7-065 ... 7-103, 6-017.b, 9-022.a and b.
fn joint_at_rest(given: &CheckArguments) -> Result<Finding, CheckError> {
    type JointQuantity = fn(&Joint, f64, &BoundaryFilm) -> Result<f64, SlidewayError>;
    let known: [(&str, JointQuantity); 9] = [
        ("penetration", |joint, pressure, _| Ok(joint.penetration(pressure)? / UM)),
        ("area", |joint, pressure, _| Ok(joint.area_share(pressure)? * CM2 / UM2)),
        ("leading-area", |joint, pressure, _| Ok(joint.leading_share(pressure)? * CM2 / UM2)),
        ("leading-pressure", |joint, pressure, _| Ok(joint.leading_pressure(pressure)? / KGF_PER_MM2)),
        ("stiffness", |joint, pressure, _| Ok(joint.tangent_stiffness(pressure)? * CM2 * UM / KGF)),
        ("displacement", |joint, pressure, _| Ok(joint.slip_displacement(pressure)? / UM)),
        ("friction", |joint, pressure, film| joint.static_friction(pressure, film)),
        ("initial-friction", |joint, pressure, _| joint.initial_friction(pressure)),
        ("shear-force", |joint, pressure, film| {
            let strength = film.joint_strength(&joint.material)?;
            Ok(joint.leading_share(pressure)? * strength * CM2 / KGF)
        }),
    ];
    let quantity = given.choice("of", &known)?;
    Ok(Finding::Number(quantity(&joint(given)?, pressure(given)?, &film(given)?)?))
}

/// Checks whether friction at slip exceeds that of the first pull.
///
/// Fig 7.12, claim 7-090.a: the leading area grows until the joint slips, so friction grows too.
fn pull_raises_friction(given: &CheckArguments) -> Result<Finding, CheckError> {
    let (joint, pressure) = (joint(given)?, pressure(given)?);
    let first = joint.initial_friction(pressure)?;
    let slip = joint.static_friction(pressure, &BoundaryFilm::DRY)?;
    Ok(Finding::shape(first < slip, format!("{first:.3} and {slip:.3}")))
}

/// Checks whether the static friction coefficient falls from 0.1 to 1 kgf/cm2, or stays the same. `power` replaces
/// the exponent of area against load.
///
/// Arguments: `way`, `power`, and those of the joint and the film. With `way=stays` the coefficients must agree to
/// 1e-9. That is the case for `power=1`, an area proportional to the load (eq 69-7, claim 7-091). Claims 7-090.b and
/// 7-108 use `way=falls`.
fn friction_and_load(given: &CheckArguments) -> Result<Finding, CheckError> {
    let (mut joint, film) = (joint(given)?, film(given)?);
    joint.leading_area.exponent = given.number_or("power", joint.leading_area.exponent)?;
    let at = |load: f64| joint.static_friction(load * KGF_PER_CM2, &film);
    let (light, heavy) = (at(0.1)?, at(1.0)?);
    let is_same = (heavy / light - 1.0).abs() < 1e-9;
    let found = format!("{light:.3} and {heavy:.3}");
    Ok(match given.choice("way", &[("stays", true), ("falls", false)])? {
        true => Finding::truth(is_same, found),
        false => Finding::shape(heavy < light && !is_same, found),
    })
}

/// Checks whether the displacement at slip is 3 ... 5 times the mean radius of the contacts.
///
/// The mean radius is sqrt(Ac / (pi Nc)), from the sums of the range. Claim 7-088.b (2.3).
fn slip_within_radii(given: &CheckArguments) -> Result<Finding, CheckError> {
    let pressure = pressure(given)?;
    let pressed = range(given)?.under(pressure * CM2)?;
    let radius = (pressed.area / pressed.contacts / PI).sqrt();
    let ratio = joint(given)?.slip_displacement(pressure)? / radius;
    Ok(Finding::truth((3.0..=5.0).contains(&ratio), format!("{ratio:.2} times {:.2} um", radius / UM)))
}

/// Factor or exponent of a friction coefficient against load in kgf, fitted over `from` ... `to`.
///
/// Argument `of`: `initial` is mu_so of the first pull, `static` mu_s at slip. The text has 0.160 / W^0.181 (eq 64-7),
/// 0.35 / W^0.165 (eq 65-7), and 0.79 / W^0.165 with the shear strength Pm / sqrt(3) (eq 70-7). Claims 7-085, 7-086 and
/// 7-093.
fn static_friction_law(given: &CheckArguments) -> Result<Finding, CheckError> {
    let (joint, film) = (joint(given)?, film(given)?);
    let is_initial = given.choice("of", &[("initial", true), ("static", false)])?;
    let (from, to) = (given.number("from")?, given.number("to")?);
    let point = |index: u32| -> Result<(f64, f64), CheckError> {
        let load = from * (to / from).powf(f64::from(index) / f64::from(POINTS - 1));
        let pressure = load * KGF_PER_CM2;
        let friction = if is_initial {
            joint.initial_friction(pressure)
        } else {
            joint.static_friction(pressure, &film)
        };
        Ok((load, friction?))
    };
    let points = (0..POINTS).map(point).collect::<Result<Vec<_>, _>>()?;
    part_of(given, &PowerLaw::fit(&points)?)
}

/// A quantity of a film on grade 17 iron: strength KLP, yield pressure at ho um or shear strength under Pa kgf/mm2,
/// in kgf/mm2, or the covered share.
///
/// Argument `of`: `strength` KLP (eq 84-7), `covered` share ((Ko + 0.06) / Pm)^2 (eq 82-7), `yield` pressure Ko exp(-10
/// ho) + 0.06 (eq 71-7), `shear` strength exp(0.014 Pa) - 1 (eq 72-7). Claims 7-095, 7-098, 7-100, 7-167, 7-168 and
/// 9-259.
fn boundary_film(given: &CheckArguments) -> Result<Finding, CheckError> {
    type FilmQuantity = fn(&CheckArguments) -> Result<f64, CheckError>;
    let known: [(&str, FilmQuantity); 4] = [
        ("strength", |given| Ok(film(given)?.joint_strength(&Material::GRADE_17_IRON)? / KGF_PER_MM2)),
        ("covered", |given| Ok(film(given)?.covered_share(&Material::GRADE_17_IRON)?)),
        ("yield", |given| Ok(film(given)?.yield_pressure(given.number("ho")? * UM)? / KGF_PER_MM2)),
        ("shear", |given| Ok(film_shear_strength(given.number("Pa")? * KGF_PER_MM2)? / KGF_PER_MM2)),
    ];
    given.choice("of", &known)?(given).map(Finding::Number)
}

/// Ko in kgf/mm2 of the film that gives the static friction coefficient mu, to 0.01.
///
/// Ko rises from 0 in steps of 0.01 up to the yield pressure of the iron, 132 kgf/mm2. Friction falls with Ko, so the
/// first value that reaches mu is the result. Claims 7-104 and 7-105.
///
/// # Errors
/// If friction exceeds mu for every film.
fn film_for_friction(given: &CheckArguments) -> Result<Finding, CheckError> {
    let (joint, pressure, wanted) = (joint(given)?, pressure(given)?, given.number("mu")?);
    let hundredths = (0..13200).map(|index| f64::from(index) / 100.0);
    for rupture in hundredths {
        if joint.static_friction(pressure, &BoundaryFilm::of_thesis(rupture))? <= wanted {
            return Ok(Finding::Number(rupture));
        }
    }
    let reason = format!("no film reduces friction to {wanted}");
    Err(SlidewayError::NoSolution { sought: "film", reason }.into())
}
