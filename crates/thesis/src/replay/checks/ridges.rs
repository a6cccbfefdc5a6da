//! Claims on ridges and on ranges of ridges (7.2).
//!
//! Sums over the contacts of a range of ridges replace the printed power laws where a claim says "from geometry and
//! metal alone". Loads are in kgf, lengths in um and pressures in kgf/mm2 or kgf/cm2, as in the text.

use super::super::check_arguments::{ArgumentError, CheckArguments};
use super::super::finding::Finding;
use super::stability::part_of;
use super::{Check, CheckError};
use crate::slideway::SlidewayError;
use crate::slideway::asperities::{AsperityRange, ContactLaws, Levels, RangeContact};
use crate::slideway::crossing::Crossing;
use crate::slideway::material::Material;
use crate::slideway::power_law::PowerLaw;
use crate::slideway::ridge::Ridge;
use crate::slideway::units::{CM2, KGF, KGF_PER_CM2, KGF_PER_MM2, MM, MM2, UM, UM2};

/// The checks of this file, by the name that the ledger uses.
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
];

/// Radius of the arc that approximates a ridge, in mm.
///
/// R = (4 Z^2 + B^2) / (8 Z) (eq 9-7). Claim 7-004: 0.12625 mm for 50 um by 2.5 um.
fn ridge_radius(given: &CheckArguments) -> Result<Finding, CheckError> {
    Ok(Finding::Number(ridge(given)?.radius()? / MM))
}

/// The thesis's ridge. B and Z in m replace its width and height. Defaults are 50 um and 2.5 um.
fn ridge(given: &CheckArguments) -> Result<Ridge, ArgumentError> {
    let Ridge { width, height } = Ridge::GROUND;
    Ok(Ridge { width: given.number_or("B", width)?, height: given.number_or("Z", height)? })
}

/// A size of the thesis's ridge in units of `by` um, or the tangent of the slope that friction climbs. The mean
/// distance of a triangle from its mean line is a quarter of its height, which is the roughness.
///
/// Argument `of`: `width`, `height`, `roughness` or `tangent` Z / B. With `by=1000` lengths are in mm. Claims 5-017,
/// 5-021.a, 5-021.b and 6-017.a compare the ridge of chapter 7 with what other chapters state about the same surface.
fn ridge_size(given: &CheckArguments) -> Result<Finding, CheckError> {
    let Ridge { width, height } = Ridge::GROUND;
    let sizes = [
        ("width", width / UM),
        ("height", height / UM),
        ("roughness", height / 4.0 / UM),
        ("tangent", height / width),
    ];
    Ok(Finding::Number(given.choice("of", &sizes)? / given.number_or("by", 1.0)?))
}

/// Brinell hardness of the thesis's cast iron, in kgf/mm2.
///
/// 220 kgf/mm2. Claim 4-030 compares it with the 200 of chapter 4.
fn iron_hardness(_: &CheckArguments) -> Result<Finding, CheckError> {
    Ok(Finding::Number(Material::GRADE_17_IRON.hardness / KGF_PER_MM2))
}

/// Area in um2 that two wedges with an overlap of h um share, independent of eq 5-7. It counts the small squares of
/// the plane on which the wedges intersect.
///
/// Arguments: `h` in um, `beta` in degrees (90). The wedges share the points at which the sum of their distances below
/// both crests is less than the overlap. The plane is divided into 2000 x 2000 squares, accurate to 0.2 %. Claim
/// 7-002: 282.8 um2 at 45 degrees.
fn wedge_overlap(given: &CheckArguments) -> Result<Finding, CheckError> {
    let (overlap, angle) = (given.number("h")?, given.number_or("beta", 90.0)?.to_radians());
    let flank = 2.0 * Ridge::GROUND.height / Ridge::GROUND.width;
    let (half, steps) = (overlap / flank / angle.sin() * 1.5, 2000);
    let side = 2.0 * half / f64::from(steps);
    let position = |index: i32| -half + (f64::from(index) + 0.5) * side;
    let is_inside = |x: f64, y: f64| {
        let across = (y * angle.cos() - x * angle.sin()).abs();
        flank * (y.abs() + across) < overlap
    };
    let column = |i: i32| (0..steps).filter(|j| is_inside(position(i), position(*j))).count();
    let count: usize = (0..steps).map(column).sum();
    Ok(Finding::Number(count as f64 * side.powi(2)))
}

/// Mean pressure under a table of W kgf on A cm2, in kgf/cm2.
///
/// Pw = W / A. Claims 7-064, 9-019 and 9-020: both pressures of chapter 9 belong to other weights than stated.
fn table_pressure(given: &CheckArguments) -> Result<Finding, CheckError> {
    let (weight, area) = (given.number("W")? * KGF, given.number("A")? * CM2);
    Ok(Finding::Number(weight / area / KGF_PER_CM2))
}

/// The thesis's ridges at a cross angle of beta degrees. nu and HB in kgf/mm2 replace the properties of the iron.
///
/// The thesis does not print nu. Every value from 0.257 to 0.279 gives its semi-axis (claim 7-013).
fn crossing(given: &CheckArguments) -> Result<Crossing, CheckError> {
    let angle = given.number_or("beta", 90.0)?.to_radians();
    let iron = Material::GRADE_17_IRON;
    let material = Material {
        poisson: given.number_or("nu", iron.poisson)?,
        hardness: given.number_or("HB", iron.hardness / KGF_PER_MM2)? * KGF_PER_MM2,
        ..iron
    };
    Ok(Crossing::new(&Ridge::GROUND, &material, angle)?)
}

/// A quantity of two crossed ridges under 1 kgf, or their yield overlap, in the units of Fig 7.4.
///
/// Argument `of`: semi-axes `major` and `minor` in mm (eq 24-7), `area` in mm2 (eq 25-7), `overlap` in mm (eq 26-7),
/// `peak` and `mean` pressure in kgf/mm2 (eq 30-7, 31-7), `yield` overlap in um (eq 42-7). The contact is elastic under
/// 1 kgf, also where the peak pressure exceeds the yield pressure of 132 kgf/mm2, as in the text. Claims 7-015 ...
/// 7-030.
fn crossed_ridges(given: &CheckArguments) -> Result<Finding, CheckError> {
    type CrossingQuantity = fn(&Crossing) -> Result<f64, SlidewayError>;
    let known: [(&str, CrossingQuantity); 7] = [
        ("major", |pair| Ok(pair.semi_axes(KGF)?.0 / MM)),
        ("minor", |pair| Ok(pair.semi_axes(KGF)?.1 / MM)),
        ("area", |pair| Ok(pair.area(KGF)? / MM2)),
        ("overlap", |pair| Ok(pair.overlap(KGF)? / MM)),
        ("peak", |pair| Ok(pair.peak_pressure(KGF)? / KGF_PER_MM2)),
        ("mean", |pair| Ok(pair.mean_pressure(KGF)? / KGF_PER_MM2)),
        ("yield", |pair| Ok(pair.yield_overlap() / UM)),
    ];
    let quantity = given.choice("of", &known)?;
    Ok(Finding::Number(quantity(&crossing(given)?)?))
}

/// The thesis's range, with the `step` between levels in um and the cross angle `beta` in degrees.
///
/// The default step is 0.06 um, twice the fall hT from ridge to ridge. The geometry of the text would give hT itself,
/// 0.03 um (claim 7-032.a); its sums need 0.06 um (claim 7-032.b).
pub(super) fn range(given: &CheckArguments) -> Result<AsperityRange, CheckError> {
    Ok(AsperityRange { crossing: crossing(given)?, step: given.number_or("step", 0.06)? * UM })
}

/// Reads a quantity of two ranges in contact.
type ContactQuantity = fn(&RangeContact) -> f64;

/// The quantities of two ranges in contact: overlap in um, area in um2, load in kgf, number of contacts.
const CONTACT_QUANTITIES: [(&str, ContactQuantity); 4] = [
    ("overlap", |pressed| pressed.overlap / UM),
    ("area", |pressed| pressed.area / UM2),
    ("load", |pressed| pressed.load / KGF),
    ("contacts", |pressed| pressed.contacts),
];

/// A quantity of a range at N levels, at an overlap of hd um, or under a load of W kgf.
///
/// One of `W`, `hd` and `N` specifies the state; the first that is given counts. An overlap of N levels is N steps. It
/// has 1 + 2 N (N - 1) contacts: 5, 13 and 421 for N = 2, 3 and 15 (claims 7-031). Claims 7-033 ... 7-036, 7-043 ...
/// 7-045 and 7-051.b compare areas, loads and numbers.
fn range_of_ridges(given: &CheckArguments) -> Result<Finding, CheckError> {
    let (range, quantity) = (range(given)?, given.choice("of", &CONTACT_QUANTITIES)?);
    let pressed = if given.text("W").is_some() {
        range.under(given.number("W")? * KGF)?
    } else if given.text("hd").is_some() {
        range.pressed(given.number("hd")? * UM)?
    } else {
        range.at_level(given.number("N")? as u32)?
    };
    Ok(Finding::Number(quantity(&pressed)))
}

/// Factor or exponent of a law of Table T7.1, fitted to the sums over the levels `from` ... `to`.
///
/// Arguments: `law`, `from`, `to`, `part`. A level is one point of the fit. The printed laws need different levels: 2
/// ... 25 for the overlap, 2 ... 8 for the area, 1 ... 10 for the number of contacts. Claims 7-038 ... 7-042 and 7-050.
fn range_law(given: &CheckArguments) -> Result<Finding, CheckError> {
    let law = selected_law(given)?;
    part_of(given, &fitted(given, law)?)
}

/// Reads one of the laws of a range.
type Law = fn(&ContactLaws) -> PowerLaw;

/// The law that `law` selects.
///
/// `overlap`, `area` and `contacts` are laws of the load in kgf; `overlap-of-area` is that of the area in um2 (Table
/// T7.1).
fn selected_law(given: &CheckArguments) -> Result<Law, ArgumentError> {
    given.choice::<Law>(
        "law",
        &[
            ("overlap", |laws| laws.overlap),
            ("area", |laws| laws.area),
            ("overlap-of-area", |laws| laws.overlap_of_area),
            ("contacts", |laws| laws.contacts),
        ],
    )
}

/// Fits a law to the sums over the levels `from` ... `to`. All four laws are fitted over these levels, and `law`
/// selects one of them.
fn fitted(given: &CheckArguments, law: Law) -> Result<PowerLaw, CheckError> {
    let levels: Levels = (given.number("from")? as u32, given.number("to")? as u32);
    Ok(law(&ContactLaws::fitted(&range(given)?, [levels; 4])?))
}

/// Exponent with which a quantity grows with load between two overlaps in um.
///
/// The exponent is ln(q2 / q1) / ln(W2 / W1). Claims 7-046 ... 7-048 compare it with Archard's 0.88 for the area and
/// 0.66 for the number of contacts (eq 37-7 ... 40-7).
fn slope_of_sums(given: &CheckArguments) -> Result<Finding, CheckError> {
    let (range, quantity) = (range(given)?, given.choice("of", &CONTACT_QUANTITIES)?);
    let (low, high) = (given.number("from")? * UM, given.number("to")? * UM);
    let (low, high) = (range.pressed(low)?, range.pressed(high)?);
    Ok(Finding::Number((quantity(&high) / quantity(&low)).ln() / (high.load / low.load).ln()))
}

/// A quantity of a range that is loaded again by N levels after the levels below `first` were flattened.
///
/// Arguments: `of`, `first`, `N`, `step`. A load of 1 kgf flattens the seven levels below 0.46 um, so `first` is 7 in
/// the claims. The 28 contacts of this level then touch at the same time. Claims 7-053 ... 7-056.
fn reloaded_range(given: &CheckArguments) -> Result<Finding, CheckError> {
    let pressed = reloaded(given, given.number("N")? as u32)?;
    Ok(Finding::Number(given.choice("of", &CONTACT_QUANTITIES)?(&pressed)))
}

/// The state of the range that is loaded again by `level` steps, after the levels below `first` were flattened.
fn reloaded(given: &CheckArguments, level: u32) -> Result<RangeContact, CheckError> {
    let range = range(given)?;
    Ok(range.reloaded(given.number("first")? as u32, f64::from(level) * range.step)?)
}

/// Factor or exponent of a quantity against load when the range is loaded again, fitted over the levels `from` ...
/// `to`.
///
/// The text has hd = 0.53 W^0.22 (eq 43-7), a line drawn parallel to the first loading, and Ac = 10500 W^0.74 (eq
/// 44-7). Claims 7-057 and 7-058.
fn reload_law(given: &CheckArguments) -> Result<Finding, CheckError> {
    let (from, to) = (given.number("from")? as u32, given.number("to")? as u32);
    let quantity = given.choice("of", &CONTACT_QUANTITIES)?;
    let point = |level| reloaded(given, level).map(|pressed| (pressed.load / KGF, quantity(&pressed)));
    let points = (from..=to).map(point).collect::<Result<Vec<_>, _>>()?;
    part_of(given, &PowerLaw::fit(&points)?)
}

/// Checks whether a range that was overloaded has a larger area at the same load, for its first levels.
///
/// For each level 1 ... `to` of the second loading, the area is compared with that of the first loading under the same
/// load. The finding lists the ratios. Claim 7-059.
fn reloading_widens(given: &CheckArguments) -> Result<Finding, CheckError> {
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

#[cfg(test)]
mod tests {
    use std::f64::consts::FRAC_PI_2;

    use super::*;

    #[test]
    fn counted_squares_agree_with_eq_5_7() {
        for degrees in [90.0f64, 45.0] {
            let counted = wedge_overlap(&CheckArguments::parse(&format!("h=1 beta={degrees}")).unwrap());
            let Ok(Finding::Number(counted)) = counted else { panic!() };
            let area = Ridge::GROUND.overlap_area(UM, degrees.to_radians().min(FRAC_PI_2)).unwrap() / UM2;
            assert!((counted / area - 1.0).abs() < 2e-3, "counted {counted}, expected {area}");
        }
    }
}
