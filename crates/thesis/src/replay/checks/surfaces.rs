//! Ridges, ranges of them, and the joint at rest (7.2).

use std::f64::consts::PI;

use super::super::finding::Finding;
use super::super::given::{Given, GivenError};
use super::stability::part_of;
use super::{Check, CheckError};
use crate::slideway::SlidewayError;
use crate::slideway::asperities::{AsperityRange, ContactLaws, Levels, Pressed};
use crate::slideway::boundary_film::{BoundaryFilm, film_shear_strength};
use crate::slideway::crossing::Crossing;
use crate::slideway::joint::Joint;
use crate::slideway::material::Material;
use crate::slideway::power_law::PowerLaw;
use crate::slideway::ridge::Ridge;
use crate::slideway::units::{CM2, KGF, KGF_PER_CM2, KGF_PER_MM2, MM, MM2, UM, UM2};

pub(super) const CHECKS: &[Check] = &[
    Check { name: "ridge-radius", run: ridge_radius },
    Check { name: "ridge-size", run: ridge_size },
    Check { name: "iron-hardness", run: iron_hardness },
    Check { name: "wedge-overlap", run: wedge_overlap },
    Check { name: "table-pressure", run: table_pressure },
    Check { name: "crossed-ridges", run: crossed_ridges },
    Check { name: "range-of-ridges", run: range_of_ridges },
    Check { name: "range-law", run: range_law },
    Check { name: "slope-of-sums", run: slope_of_sums },
    Check { name: "reloaded-range", run: reloaded_range },
    Check { name: "reload-law", run: reload_law },
    Check { name: "reloading-widens", run: reloading_widens },
    Check { name: "joint-at-rest", run: joint_at_rest },
    Check { name: "pull-raises-friction", run: pull_raises_friction },
    Check { name: "friction-and-load", run: friction_and_load },
    Check { name: "slip-within-radii", run: slip_within_radii },
    Check { name: "static-friction-law", run: static_friction_law },
    Check { name: "boundary-film", run: boundary_film },
    Check { name: "film-for-friction", run: film_for_friction },
];

/// Loads over which friction is fitted, as many points evenly on logarithmic paper.
const POINTS: u32 = 21;

/// Radius of the arc that stands in for a ridge, in mm.
fn ridge_radius(given: &Given) -> Result<Finding, CheckError> {
    Ok(Finding::Number(ridge(given)?.radius()? / MM))
}

fn ridge(given: &Given) -> Result<Ridge, GivenError> {
    let Ridge { width, height } = Ridge::GROUND;
    Ok(Ridge { width: given.number_or("B", width)?, height: given.number_or("Z", height)? })
}

/// What the study's ridge measures, in `by` um, and the tangent of the slope that is climbed. A triangle lies a quarter of its height off its mean line, on average.
fn ridge_size(given: &Given) -> Result<Finding, CheckError> {
    let Ridge { width, height } = Ridge::GROUND;
    let sizes = [
        ("width", width / UM),
        ("height", height / UM),
        ("roughness", height / 4.0 / UM),
        ("tangent", height / width),
    ];
    Ok(Finding::Number(given.word("of", &sizes)? / given.number_or("by", 1.0)?))
}

/// Brinell hardness of the study's cast iron, in kgf/mm2.
fn iron_hardness(_: &Given) -> Result<Finding, CheckError> {
    Ok(Finding::Number(Material::GRADE_17_IRON.hardness / KGF_PER_MM2))
}

/// Area in um2 in which two wedges meet that overlap by h um: by counting small squares of the plane on which the lower wedge, and
/// so the upper one, is higher than the overlap leaves room for. It knows nothing of eq 5-7.
fn wedge_overlap(given: &Given) -> Result<Finding, CheckError> {
    let (overlap, angle) = (given.number("h")?, given.number_or("beta", 90.0)?.to_radians());
    let flank = 2.0 * Ridge::GROUND.height / Ridge::GROUND.width;
    let (half, steps) = (overlap / flank / angle.sin() * 1.5, 2000);
    let side = 2.0 * half / f64::from(steps);
    let place = |index: i32| -half + (f64::from(index) + 0.5) * side;
    let is_inside = |x: f64, y: f64| {
        let across = (y * angle.cos() - x * angle.sin()).abs();
        flank * (y.abs() + across) < overlap
    };
    let column = |i: i32| (0..steps).filter(|j| is_inside(place(i), place(*j))).count();
    let count: usize = (0..steps).map(column).sum();
    Ok(Finding::Number(count as f64 * side.powi(2)))
}

/// Mean pressure of a table of W kgf on A cm2, in kgf/cm2.
fn table_pressure(given: &Given) -> Result<Finding, CheckError> {
    let (weight, area) = (given.number("W")? * KGF, given.number("A")? * CM2);
    Ok(Finding::Number(weight / area / KGF_PER_CM2))
}

/// The study's ridges, crossed at beta degrees.
fn crossing(given: &Given) -> Result<Crossing, CheckError> {
    let angle = given.number_or("beta", 90.0)?.to_radians();
    let iron = Material::GRADE_17_IRON;
    let material = Material {
        poisson: given.number_or("nu", iron.poisson)?,
        hardness: given.number_or("HB", iron.hardness / KGF_PER_MM2)? * KGF_PER_MM2,
        ..iron
    };
    Ok(Crossing::new(&Ridge::GROUND, &material, angle)?)
}

/// Two crossed ridges under 1 kgf, or where they yield, in the units of Fig 7.4.
fn crossed_ridges(given: &Given) -> Result<Finding, CheckError> {
    type Reading = fn(&Crossing) -> Result<f64, SlidewayError>;
    let known: [(&str, Reading); 7] = [
        ("major", |pair| Ok(pair.semi_axes(KGF)?.0 / MM)),
        ("minor", |pair| Ok(pair.semi_axes(KGF)?.1 / MM)),
        ("area", |pair| Ok(pair.area(KGF)? / MM2)),
        ("overlap", |pair| Ok(pair.overlap(KGF)? / MM)),
        ("peak", |pair| Ok(pair.peak_pressure(KGF)? / KGF_PER_MM2)),
        ("mean", |pair| Ok(pair.mean_pressure(KGF)? / KGF_PER_MM2)),
        ("yield", |pair| Ok(pair.yield_overlap() / UM)),
    ];
    let reading = given.word("of", &known)?;
    Ok(Finding::Number(reading(&crossing(given)?)?))
}

/// The study's range; `step` between levels in um, `beta` in degrees.
fn range(given: &Given) -> Result<AsperityRange, CheckError> {
    Ok(AsperityRange { crossing: crossing(given)?, step: given.number_or("step", 0.06)? * UM })
}

/// What is pressed may be read off: overlap in um, area in um2, load in kgf, contacts.
type Reading = fn(&Pressed) -> f64;

const PRESSED: [(&str, Reading); 4] = [
    ("overlap", |pressed| pressed.overlap / UM),
    ("area", |pressed| pressed.area / UM2),
    ("load", |pressed| pressed.load / KGF),
    ("contacts", |pressed| pressed.contacts),
];

/// A range at N levels, at an overlap of hd um, or under a load of W kgf.
fn range_of_ridges(given: &Given) -> Result<Finding, CheckError> {
    let (range, reading) = (range(given)?, given.word("of", &PRESSED)?);
    let pressed = if given.text("W").is_some() {
        range.under(given.number("W")? * KGF)?
    } else if given.text("hd").is_some() {
        range.pressed(given.number("hd")? * UM)?
    } else {
        range.at_level(given.number("N")? as u32)?
    };
    Ok(Finding::Number(reading(&pressed)))
}

/// Factor or exponent of a law of Table T7.1, fitted to the sums over levels from ... to.
fn range_law(given: &Given) -> Result<Finding, CheckError> {
    let law = laws(given)?;
    part_of(given, &fitted(given, law)?)
}

type Law = fn(&ContactLaws) -> PowerLaw;

fn laws(given: &Given) -> Result<Law, GivenError> {
    given.word::<Law>(
        "law",
        &[
            ("overlap", |laws| laws.overlap),
            ("area", |laws| laws.area),
            ("overlap-of-area", |laws| laws.overlap_of_area),
            ("contacts", |laws| laws.contacts),
        ],
    )
}

fn fitted(given: &Given, law: Law) -> Result<PowerLaw, CheckError> {
    let levels: Levels = (given.number("from")? as u32, given.number("to")? as u32);
    Ok(law(&ContactLaws::fitted(&range(given)?, [levels; 4])?))
}

/// Power with which area or contacts grow with load between two overlaps in um.
fn slope_of_sums(given: &Given) -> Result<Finding, CheckError> {
    let (range, reading) = (range(given)?, given.word("of", &PRESSED)?);
    let (low, high) = (given.number("from")? * UM, given.number("to")? * UM);
    let (low, high) = (range.pressed(low)?, range.pressed(high)?);
    Ok(Finding::Number((reading(&high) / reading(&low)).ln() / (high.load / low.load).ln()))
}

/// A range whose levels below `first` were flattened, loaded again by so many levels.
fn reloaded_range(given: &Given) -> Result<Finding, CheckError> {
    let pressed = reloaded(given, given.number("N")? as u32)?;
    Ok(Finding::Number(given.word("of", &PRESSED)?(&pressed)))
}

fn reloaded(given: &Given, level: u32) -> Result<Pressed, CheckError> {
    let range = range(given)?;
    Ok(range.reloaded(given.number("first")? as u32, f64::from(level) * range.step)?)
}

/// Factor or exponent of overlap or area by load when loaded again, fitted over levels from ... to.
fn reload_law(given: &Given) -> Result<Finding, CheckError> {
    let (from, to) = (given.number("from")? as u32, given.number("to")? as u32);
    let reading = given.word("of", &PRESSED)?;
    let point = |level| reloaded(given, level).map(|pressed| (pressed.load / KGF, reading(&pressed)));
    let points = (from..=to).map(point).collect::<Result<Vec<_>, _>>()?;
    part_of(given, &PowerLaw::fit(&points)?)
}

/// Whether a range that was overloaded touches over more area at the same load, over its first levels.
fn reloading_widens(given: &Given) -> Result<Finding, CheckError> {
    let range = range(given)?;
    let (mut holds, mut found) = (true, Vec::new());
    for level in 1..=given.number("to")? as u32 {
        let again = reloaded(given, level)?;
        let first = range.under(again.load)?;
        holds &= again.area > first.area;
        found.push(format!("{:.2}", again.area / first.area));
    }
    Ok(Finding::shape(holds, format!("{} times", found.join(", "))))
}

/// Where the constants of a joint come from.
#[derive(Debug, Clone, Copy)]
enum Source {
    /// The study, down to 9707.
    Printed,
    /// The printed Table T7.1, and its own arithmetic from there.
    Table,
    /// Geometry and metal alone.
    Sums,
}

/// The joint, by default with the constants as printed and grade 17 iron; `shear=tabor` gives it the shear strength of eq 70-7.
pub(super) fn joint(given: &Given) -> Result<Joint, CheckError> {
    let known = [("printed", Source::Printed), ("table", Source::Table), ("sums", Source::Sums)];
    let source = given.text("joint").map_or(Ok(Source::Printed), |_| given.word("joint", &known))?;
    let iron = Material::GRADE_17_IRON;
    let joint = match source {
        Source::Printed => Joint::PRINTED,
        Source::Table => Joint::new(Ridge::GROUND, iron, &ContactLaws::PRINTED),
        Source::Sums => Joint::of_surfaces(Ridge::GROUND, iron, 0.06 * UM)?,
    };
    let material = given
        .text("shear")
        .map_or(Ok(iron), |_| given.word("shear", &[("tabor", iron.with_tabor_shear())]))?;
    Ok(Joint { material, ..joint })
}

/// A film: none, one of the study's oils, or one with Ko in kgf/mm2.
pub(super) fn film(given: &Given) -> Result<BoundaryFilm, GivenError> {
    if given.text("Ko").is_some() {
        return Ok(BoundaryFilm::of_study(given.number("Ko")?));
    }
    let known =
        [("dry", BoundaryFilm::DRY), ("plain", BoundaryFilm::NON_POLAR), ("polar", BoundaryFilm::POLAR)];
    given.text("film").map_or(Ok(BoundaryFilm::DRY), |_| given.word("film", &known))
}

/// Mean pressure in Pa from Pw in kgf/cm2, that of the study's table where none is given.
pub(super) fn pressure(given: &Given) -> Result<f64, GivenError> {
    Ok(given.number_or("Pw", 0.65)? * KGF_PER_CM2)
}

/// The joint at rest under Pw kgf/cm2, in the units of the study.
fn joint_at_rest(given: &Given) -> Result<Finding, CheckError> {
    type Reading = fn(&Joint, f64, &BoundaryFilm) -> Result<f64, SlidewayError>;
    let known: [(&str, Reading); 9] = [
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
    let reading = given.word("of", &known)?;
    Ok(Finding::Number(reading(&joint(given)?, pressure(given)?, &film(given)?)?))
}

/// Whether friction at slip is above that of the first pull.
fn pull_raises_friction(given: &Given) -> Result<Finding, CheckError> {
    let (joint, pressure) = (joint(given)?, pressure(given)?);
    let first = joint.initial_friction(pressure)?;
    let slip = joint.static_friction(pressure, &BoundaryFilm::DRY)?;
    Ok(Finding::shape(first < slip, format!("{first:.3} and {slip:.3}")))
}

/// Whether the static friction coefficient falls from 0.1 to 1 kgf/cm2, or stays, for a power of the area by the load.
fn friction_and_load(given: &Given) -> Result<Finding, CheckError> {
    let (mut joint, film) = (joint(given)?, film(given)?);
    joint.leading_area.exponent = given.number_or("power", joint.leading_area.exponent)?;
    let at = |load: f64| joint.static_friction(load * KGF_PER_CM2, &film);
    let (light, heavy) = (at(0.1)?, at(1.0)?);
    let is_same = (heavy / light - 1.0).abs() < 1e-9;
    let found = format!("{light:.3} and {heavy:.3}");
    Ok(match given.word("way", &[("stays", true), ("falls", false)])? {
        true => Finding::truth(is_same, found),
        false => Finding::shape(heavy < light && !is_same, found),
    })
}

/// Whether the displacement at slip is 3 ... 5 times the mean radius of a contact.
fn slip_within_radii(given: &Given) -> Result<Finding, CheckError> {
    let pressure = pressure(given)?;
    let pressed = range(given)?.under(pressure * CM2)?;
    let radius = (pressed.area / pressed.contacts / PI).sqrt();
    let ratio = joint(given)?.slip_displacement(pressure)? / radius;
    Ok(Finding::truth((3.0..=5.0).contains(&ratio), format!("{ratio:.2} times {:.2} um", radius / UM)))
}

/// Factor or exponent of a friction coefficient by load in kgf, fitted from ... to.
fn static_friction_law(given: &Given) -> Result<Finding, CheckError> {
    let (joint, film) = (joint(given)?, film(given)?);
    let is_initial = given.word("of", &[("initial", true), ("static", false)])?;
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

/// A film on grade 17 iron, in kgf/mm2: its strength KLP, its yield pressure at ho um, its shear strength under Pa kgf/mm2.
fn boundary_film(given: &Given) -> Result<Finding, CheckError> {
    type Reading = fn(&Given) -> Result<f64, CheckError>;
    let known: [(&str, Reading); 4] = [
        ("strength", |given| Ok(film(given)?.joint_strength(&Material::GRADE_17_IRON)? / KGF_PER_MM2)),
        ("covered", |given| Ok(film(given)?.covered_share(&Material::GRADE_17_IRON)?)),
        ("yield", |given| Ok(film(given)?.yield_pressure(given.number("ho")? * UM)? / KGF_PER_MM2)),
        ("shear", |given| Ok(film_shear_strength(given.number("Pa")? * KGF_PER_MM2)? / KGF_PER_MM2)),
    ];
    given.word("of", &known)?(given).map(Finding::Number)
}

/// Ko in kgf/mm2 of the film that gives a static friction coefficient, to 0.01.
fn film_for_friction(given: &Given) -> Result<Finding, CheckError> {
    let (joint, pressure, wanted) = (joint(given)?, pressure(given)?, given.number("mu")?);
    let hundredths = (0..13200).map(|index| f64::from(index) / 100.0);
    for rupture in hundredths {
        if joint.static_friction(pressure, &BoundaryFilm::of_study(rupture))? <= wanted {
            return Ok(Finding::Number(rupture));
        }
    }
    let because = format!("no film brings friction down to {wanted}");
    Err(SlidewayError::NoSolution { sought: "film", because }.into())
}

#[cfg(test)]
mod tests {
    use std::f64::consts::FRAC_PI_2;

    use super::*;

    #[test]
    fn squares_counted_are_the_area_of_eq_5_7() {
        for degrees in [90.0f64, 45.0] {
            let counted = wedge_overlap(&Given::parse(&format!("h=1 beta={degrees}")).unwrap());
            let Ok(Finding::Number(counted)) = counted else { panic!() };
            let area = Ridge::GROUND.overlap_area(UM, degrees.to_radians().min(FRAC_PI_2)).unwrap() / UM2;
            assert!((counted / area - 1.0).abs() < 2e-3, "{counted} is not {area}");
        }
    }
}
