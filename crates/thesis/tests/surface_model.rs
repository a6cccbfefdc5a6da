//! Tests that the surface model returns finite numbers or an error for any arguments.

use proptest::prelude::*;

use patchcord_thesis::slideway::SlidewayError;
use patchcord_thesis::slideway::asperities::AsperityRange;
use patchcord_thesis::slideway::boundary_film::{BoundaryFilm, film_shear_strength};
use patchcord_thesis::slideway::crossing::Crossing;
use patchcord_thesis::slideway::dry_friction::{DryFriction, printed_penetration};
use patchcord_thesis::slideway::joint::Joint;
use patchcord_thesis::slideway::lubricated::{LubricatedJoint, falling_solid_friction};
use patchcord_thesis::slideway::material::Material;
use patchcord_thesis::slideway::oil::{Oil, thickening, thinning};
use patchcord_thesis::slideway::ridge::Ridge;
use patchcord_thesis::slideway::wedge::RangeProfile;

/// Any number, and positive numbers of all magnitudes that occur in the physics.
fn number() -> impl Strategy<Value = f64> {
    prop_oneof![any::<f64>(), (-16.0..12.0f64).prop_map(|power| 10f64.powf(power)), Just(0.0)]
}

/// Asserts that a result contains only finite numbers. Returns 1 for a result and 0 for an error.
fn numbers<const N: usize>(
    result: Result<[f64; N], SlidewayError>,
    of: &str,
) -> Result<usize, TestCaseError> {
    let Ok(result) = result else { return Ok(0) };
    prop_assert!(result.iter().all(|number| number.is_finite()), "{of}: {result:?}");
    Ok(1)
}

/// Results of a crossing of two ridges.
fn surfaces([a, b, c, d, e]: [f64; 5]) -> Result<[f64; 8], SlidewayError> {
    let ridge = Ridge { width: a, height: b };
    let material = Material { modulus: c, hardness: d, ..Material::GRADE_17_IRON };
    let crossing = Crossing::new(&ridge, &material, 1.0)?;
    let (major, minor) = crossing.semi_axes(e)?;
    let [area, overlap] = [crossing.area(e)?, crossing.overlap(e)?];
    let [peak, mean] = [crossing.peak_pressure(e)?, crossing.mean_pressure(e)?];
    Ok([major, minor, area, overlap, peak, mean, crossing.yield_overlap(), ridge.radius()?])
}

/// Results of a range of asperities at an overlap.
fn range([step, overlap, ..]: [f64; 5]) -> Result<[f64; 3], SlidewayError> {
    let range = AsperityRange { step, ..AsperityRange::of_thesis()? };
    let pressed = range.pressed(overlap)?;
    Ok([pressed.area, pressed.load, pressed.contacts])
}

/// Results of a range of asperities under a load.
fn loaded([load, ..]: [f64; 5]) -> Result<[f64; 2], SlidewayError> {
    let pressed = AsperityRange::of_thesis()?.under(load)?;
    Ok([pressed.overlap, pressed.area])
}

/// Results of a joint at rest.
fn at_rest([pressure, rupture, shear_strength, ..]: [f64; 5]) -> Result<[f64; 5], SlidewayError> {
    let (joint, film) = (Joint::PRINTED, BoundaryFilm { rupture, shear_strength });
    Ok([
        joint.penetration(pressure)?,
        joint.static_friction(pressure, &film)?,
        joint.slip_displacement(pressure)?,
        joint.tangent_stiffness(pressure)?,
        joint.leading_pressure(pressure)?,
    ])
}

/// Results of dry friction.
fn dry([pressure, stiffening, viscosity, velocity, _]: [f64; 5]) -> Result<[f64; 4], SlidewayError> {
    let dry = DryFriction { joint: Joint::PRINTED, pressure, stiffening, viscosity };
    let at = dry.at_velocity(velocity)?;
    Ok([at.friction, at.penetration, at.damping.unwrap_or(0.0), dry.limit_velocity()?])
}

/// Results of a lubricated joint.
fn lubricated([pressure, viscosity, touching_gap, velocity, _]: [f64; 5]) -> Result<[f64; 4], SlidewayError> {
    let oil = Oil { viscosity, ..Oil::ONE };
    let thesis = LubricatedJoint::of_thesis(oil, BoundaryFilm::POLAR, pressure)?;
    let at = LubricatedJoint { touching_gap, ..thesis }.at_velocity(velocity)?;
    Ok([at.lift, at.solid, at.oil, at.total])
}

/// Results of an oil film.
fn films_of_oil([viscosity, velocity, gap, pressure, _]: [f64; 5]) -> Result<[f64; 4], SlidewayError> {
    let oil = Oil { viscosity, ..Oil::TWO };
    let carried = oil.film_pressure(velocity, gap)?;
    Ok([carried, oil.drag(velocity, gap)?, oil.gap(velocity, pressure)?, oil.velocity(gap, pressure)?])
}

/// Results of a wedge between two ranges.
fn wedge([spacing, fall, gap, ..]: [f64; 5]) -> Result<[f64; 2], SlidewayError> {
    let wedge = RangeProfile { spacing, fall, ..RangeProfile::OF_THESIS }.wedge(gap)?;
    Ok([wedge.pressure_factor(), wedge.drag_factor()])
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(4096))]

    #[test]
    fn any_arguments_give_finite_numbers_or_an_error(given in prop::array::uniform5(number())) {
        numbers(surfaces(given), "surfaces")?;
        numbers(range(given), "range")?;
        numbers(loaded(given), "loaded")?;
        numbers(at_rest(given), "at rest")?;
        numbers(dry(given), "dry")?;
        numbers(lubricated(given), "lubricated")?;
        numbers(films_of_oil(given), "films of oil")?;
        numbers(wedge(given), "wedge")?;
        let [a, b, c, ..] = given;
        numbers(film_shear_strength(a).map(|strength| [strength]), "shear of film")?;
        numbers(printed_penetration(a).map(|penetration| [penetration]), "penetration")?;
        numbers(thickening(a).map(|factor| [factor]), "thickening")?;
        numbers(thinning(a).map(|factor| [factor]), "thinning")?;
        numbers(falling_solid_friction(a, b, c).map(|friction| [friction]), "falling friction")?;
    }

    #[test]
    fn arguments_within_the_ranges_give_numbers(
        pressure in 100.0..5e5f64, viscosity in 0.01..1.0f64, velocity in 1e-6..0.099f64, rupture in 0.0..1.2e9f64,
    ) {
        let successes = numbers(at_rest([pressure, rupture, 3e7, 0.0, 0.0]), "at rest")?
            + numbers(dry([pressure, 2.9, 8e9, velocity, 0.0]), "dry")?
            + numbers(lubricated([pressure, viscosity, 5.48e-6, velocity, 0.0]), "lubricated")?
            + numbers(films_of_oil([viscosity, velocity, 5e-6, pressure, 0.0]), "films of oil")?;
        prop_assert_eq!(successes, 4);
    }
}
