//! The joint as it slides, dry and lubricated (7.3).

use super::super::finding::Finding;
use super::super::given::{Given, GivenError};
use super::stability::part_of;
use super::surfaces::{film, joint, pressure};
use super::{Check, CheckError};
use crate::slideway::SlidewayError;
use crate::slideway::boundary_film::BoundaryFilm;
use crate::slideway::design::limit_velocity;
use crate::slideway::dry_friction::{DryFriction, DrySliding, printed_penetration};
use crate::slideway::lubricated::{LubricatedJoint, LubricatedSliding};
use crate::slideway::measured::TABLE_9_2;
use crate::slideway::oil::{Correction, Oil, thickening, thinning};
use crate::slideway::power_law::PowerLaw;
use crate::slideway::units::{
    CM, CM_PER_S, CM2, KGF, KGF_PER_CM2, KGF_PER_MM2, MM_PER_S, N_S_PER_MM, UM, UM2,
};
use crate::slideway::wedge::{RangeProfile, Wedge};

pub(super) const CHECKS: &[Check] = &[
    Check { name: "dry-sliding", run: dry_sliding },
    Check { name: "dry-memory", run: dry_memory },
    Check { name: "dry-frequency-of-most", run: dry_frequency_of_most },
    Check { name: "dry-friction-exponent", run: dry_friction_exponent },
    Check { name: "stiffness-and-alpha", run: stiffness_and_alpha },
    Check { name: "damping-and-alpha", run: damping_and_alpha },
    Check { name: "penetration-of-area", run: penetration_of_area },
    Check { name: "stiffening-at", run: stiffening_at },
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

/// Points that a curve is fitted by.
const POINTS: u32 = 40;

fn dry(given: &Given) -> Result<DryFriction, CheckError> {
    let study = DryFriction::of_study(joint(given)?, pressure(given)?);
    Ok(DryFriction { stiffening: given.number_or("alpha", study.stiffening)?, ..study })
}

/// The dry joint at V mm/s or at w rad/s, in the units of the study; its time constant in s and limit velocity in mm/s.
fn dry_sliding(given: &Given) -> Result<Finding, CheckError> {
    let dry = dry(given)?;
    match given.need("of")? {
        "time-constant" => return Ok(Finding::Number(dry.time_constant()?)),
        "limit-velocity" => return Ok(Finding::Number(dry.limit_velocity()? / MM_PER_S)),
        "lift" => {
            let sliding = dry.at_velocity(given.number("V")? * MM_PER_S)?.penetration;
            return Ok(Finding::Number((dry.at_frequency(0.0)?.penetration - sliding) / UM));
        }
        _ => {}
    }
    let reading = given.word::<fn(&DrySliding) -> f64>(
        "of",
        &[
            ("velocity", |at| at.velocity / MM_PER_S),
            ("stiffening", |at| at.stiffening),
            ("friction", |at| at.friction),
            ("penetration", |at| at.penetration / UM),
            ("stiffness", |at| at.stiffness * CM2 * CM / KGF),
            ("damping", |at| damping(at)),
            ("viscosity", |at| at.asperity_viscosity().unwrap_or(0.0) / KGF_PER_CM2),
            ("time", |at| damping(at) / (at.stiffness * CM2 * CM / KGF)),
        ],
    )?;
    let at = match given.text("w") {
        Some(_) => dry.at_frequency(given.number("w")?)?,
        None => dry.at_velocity(given.number("V")? * MM_PER_S)?,
    };
    Ok(Finding::Number(reading(&at)))
}

/// CE in kgf s/cm of a square centimetre; none at rest.
fn damping(at: &DrySliding) -> f64 {
    at.damping.unwrap_or(0.0) * CM2 * CM / KGF
}

/// Whether a dry joint's own time constant, or CE / KE at some w, is above 0 and below the least of Table T9-2.
fn dry_memory(given: &Given) -> Result<Finding, CheckError> {
    let dry = dry(given)?;
    let memories = match given.text("w") {
        Some(_) => {
            let at = |w: f64| dry.at_frequency(w).map(|at| damping(&at) / (at.stiffness * CM2 * CM / KGF));
            given.numbers("w")?.into_iter().map(at).collect::<Result<Vec<_>, _>>()?
        }
        None => vec![dry.time_constant()?],
    };
    let oiled = TABLE_9_2.iter().map(|cell| cell.memory).fold(f64::INFINITY, f64::min);
    let told: Vec<_> = memories.iter().map(|memory| format!("{:.2}", memory * 1e3)).collect();
    let found = format!("{} ms dry, {:.1} ms with oil at least", told.join(", "), oiled * 1e3);
    Ok(Finding::shape(memories.iter().all(|memory| *memory > 0.0 && *memory < oiled), found))
}

/// The frequency in rad/s at which CE, or the imaginary part of alpha, is largest, to a thousandth.
fn dry_frequency_of_most(given: &Given) -> Result<Finding, CheckError> {
    let dry = dry(given)?;
    let is_damping = given.word("of", &[("damping", true), ("imaginary", false)])?;
    let height = |frequency: f64| match is_damping {
        true => dry.at_frequency(frequency).map(|at| damping(&at)),
        false => dry.response(frequency).map(|(_, imaginary)| imaginary),
    };
    let frequencies = (0..7000).map(|step| (f64::from(step) / 1000.0).exp());
    let mut most = (0.0, 0.0);
    for frequency in frequencies {
        let height = height(frequency)?;
        most = if height > most.1 { (frequency, height) } else { most };
    }
    Ok(Finding::Number(most.0))
}

/// The power n of mu_k = mu_s alpha^-n over alpha 1 ... its most, through mu_s at rest.
fn dry_friction_exponent(given: &Given) -> Result<Finding, CheckError> {
    let dry = dry(given)?;
    let at_rest = dry.at_frequency(0.0)?.friction;
    let (mut joint, mut square) = (0.0, 0.0);
    for step in 1..=POINTS {
        // Even on the axis of alpha: by the frequency that gives it.
        let alpha = 1.0 + (dry.stiffening - 1.0) * f64::from(step) / f64::from(POINTS + 1);
        let turn = ((alpha.powi(2) - 1.0) / (dry.stiffening.powi(2) - alpha.powi(2))).sqrt();
        let at = dry.at_frequency(turn / dry.time_constant()?)?;
        joint += at.stiffening.ln() * (at.friction / at_rest).ln();
        square += at.stiffening.ln().powi(2);
    }
    Ok(Finding::Number(-joint / square))
}

/// Whether the normal stiffness and the inverse of the real part of alpha both fall with frequency all the way.
fn stiffness_and_alpha(given: &Given) -> Result<Finding, CheckError> {
    let dry = dry(given)?;
    let at = |frequency: f64| -> Result<[f64; 2], CheckError> {
        Ok([dry.at_frequency(frequency)?.stiffness, 1.0 / dry.response(frequency)?.0])
    };
    let at_rest = at(0.0)?;
    let (mut holds, mut before) = (true, at_rest);
    for step in 1..=POINTS {
        let now = at(10f64.powf(4.0 * f64::from(step) / f64::from(POINTS) - 1.0))?;
        holds &= now[0] < before[0] && now[1] < before[1];
        before = now;
    }
    let [stiffness, inverse] = [0, 1].map(|index| before[index] / at_rest[index]);
    Ok(Finding::shape(holds, format!("to {stiffness:.3} and {inverse:.3} of what they are at rest")))
}

/// Whether the normal damping and the imaginary part of alpha both rise to one crest and fall from there on.
fn damping_and_alpha(given: &Given) -> Result<Finding, CheckError> {
    let dry = dry(given)?;
    let (mut heights, mut crests) = ([Vec::new(), Vec::new()], Vec::new());
    let frequencies: Vec<f64> =
        (0..=POINTS).map(|step| 10f64.powf(4.0 * f64::from(step) / f64::from(POINTS) - 1.0)).collect();
    for frequency in &frequencies {
        heights[0].push(damping(&dry.at_frequency(*frequency)?));
        heights[1].push(dry.response(*frequency)?.1);
    }
    let mut holds = true;
    for row in &heights {
        let crest = row.windows(2).take_while(|pair| pair[1] > pair[0]).count();
        holds &= crest > 0 && crest < row.len() - 1 && row[crest..].windows(2).all(|pair| pair[1] < pair[0]);
        crests.push(frequencies[crest]);
    }
    Ok(Finding::shape(holds, format!("one crest each, near {:.0} and {:.0} rad/s", crests[0], crests[1])))
}

/// hd in um of a leading area of A um2, by eq 96-7.
fn penetration_of_area(given: &Given) -> Result<Finding, CheckError> {
    Ok(Finding::Number(printed_penetration(given.number("A")? * UM2)? / UM))
}

/// Alpha at which the leading area bears its load with Px kgf/mm2, by the printed area law itself.
fn stiffening_at(given: &Given) -> Result<Finding, CheckError> {
    let borne = given.number("Px")? * KGF_PER_MM2;
    Ok(Finding::Number(DryFriction::stiffening_at(&joint(given)?, pressure(given)?, borne)?))
}

/// The study's range profile, in um and um2, and the wedge over a gap of H um.
fn range_profile(given: &Given) -> Result<Finding, CheckError> {
    type Reading = fn(&RangeProfile, &Given) -> Result<f64, CheckError>;
    fn wedge(profile: &RangeProfile, given: &Given) -> Result<Wedge, CheckError> {
        Ok(profile.wedge(given.number("H")? * UM)?)
    }
    let known: [(&str, Reading); 7] = [
        ("ridges", |profile, _| Ok(profile.ridges()?)),
        ("depth", |profile, _| Ok(profile.depth()? / UM)),
        ("free-area", |profile, _| Ok(profile.free_area()? / UM2)),
        ("touching-gap", |profile, _| Ok(profile.touching_gap()? / UM)),
        ("slope", |profile, given| Ok(wedge(profile, given)?.slope())),
        ("pressure-factor", |profile, given| Ok(wedge(profile, given)?.pressure_factor())),
        ("drag-factor", |profile, given| Ok(wedge(profile, given)?.drag_factor())),
    ];
    given.word("of", &known)?(&RangeProfile::OF_STUDY, given).map(Finding::Number)
}

/// Factor or exponent of Kp or Kf by the gap in um, fitted evenly from ... to.
fn wedge_fit(given: &Given) -> Result<Finding, CheckError> {
    let factor = given.word::<fn(&Wedge) -> f64>(
        "of",
        &[("pressure-factor", Wedge::pressure_factor), ("drag-factor", Wedge::drag_factor)],
    )?;
    fit_evenly(given, |gap| Ok(factor(&RangeProfile::OF_STUDY.wedge(gap * UM)?)))
}

/// Factor or exponent of V / Cv by V in cm/s, fitted from ... to.
fn wedge_speed_fit(given: &Given) -> Result<Finding, CheckError> {
    let correction = given.word("oil", &[("1", Correction::ONE), ("2", Correction::TWO)])?;
    fit_evenly(given, |velocity| Ok(correction.wedge_speed(velocity)))
}

/// Factor or exponent of a power law through a function at even steps from ... to.
fn fit_evenly(given: &Given, y: impl Fn(f64) -> Result<f64, SlidewayError>) -> Result<Finding, CheckError> {
    let (from, to) = (given.number("from")?, given.number("to")?);
    let point = |step: u32| {
        let x = from + (to - from) * f64::from(step) / f64::from(POINTS);
        y(x).map(|y| (x, y))
    };
    part_of(given, &PowerLaw::fit(&(0..=POINTS).map(point).collect::<Result<Vec<_>, _>>()?)?)
}

pub(super) fn oil(given: &Given) -> Result<Oil, GivenError> {
    given.word("oil", &[("1", Oil::ONE), ("2", Oil::TWO)])
}

fn lubricated(given: &Given) -> Result<LubricatedJoint, CheckError> {
    let study = LubricatedJoint::of_study(oil(given)?, film(given)?, pressure(given)?)?;
    Ok(LubricatedJoint { joint: joint(given)?, ..study })
}

/// VcL in mm/s of an oil.
fn parting_velocity(given: &Given) -> Result<Finding, CheckError> {
    Ok(Finding::Number(lubricated(given)?.limit_velocity()? / MM_PER_S))
}

/// The lubricated joint at V cm/s: lift in um, shares and coefficients.
fn lubricated_sliding(given: &Given) -> Result<Finding, CheckError> {
    let reading = given.word::<fn(&LubricatedSliding) -> f64>(
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
    Ok(Finding::Number(reading(&at)))
}

/// Whether eq 11-9, for any oil, gives the VcL of eq 166-7 or 167-7, to 2 %.
fn general_limit_agrees(given: &Given) -> Result<Finding, CheckError> {
    let joint = lubricated(given)?;
    let own = joint.limit_velocity()?;
    let general = limit_velocity(joint.pressure, joint.touching_gap, joint.oil.viscosity)?;
    let found = format!("{:.1} mm/s, and {:.1} mm/s of its own", general / MM_PER_S, own / MM_PER_S);
    Ok(Finding::truth((general / own - 1.0).abs() < 0.02, found))
}

/// Whether at V cm/s the table rises by less than the gap at which its ridges part.
fn lift_stays_small(given: &Given) -> Result<Finding, CheckError> {
    let joint = lubricated(given)?;
    let lift = joint.at_velocity(given.number("V")? * CM_PER_S)?.lift;
    let found =
        format!("{:.2} um above rest; ridges part at a gap of {:.2} um", lift / UM, joint.touching_gap / UM);
    Ok(Finding::shape(lift < joint.touching_gap, found))
}

/// Whether VcL falls when the viscosity doubles, or when the surface is smoother by a tenth of the gap.
fn parting_trend(given: &Given) -> Result<Finding, CheckError> {
    let joint = lubricated(given)?;
    let thicker = Oil { viscosity: 2.0 * joint.oil.viscosity, ..joint.oil };
    let other = given.word(
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

/// Whether the load that the lift leaves on the ridges and the load that the film does not carry are the same at V cm/s.
fn load_shares(given: &Given) -> Result<Finding, CheckError> {
    let (joint, velocity) = (lubricated(given)?, given.number("V")? * CM_PER_S);
    let at = joint.at_velocity(velocity)?;
    let penetration = joint.joint.penetration(joint.pressure)?;
    let by_lift = (1.0 - at.lift / penetration).powf(1.0 / joint.joint.penetration.exponent);
    let film = joint.oil.film_pressure(velocity, joint.touching_gap - penetration + at.lift)?;
    let by_film = 1.0 - film / joint.pressure;
    Ok(Finding::truth((by_lift - by_film).abs() < 1e-9, format!("{by_lift:.5} and {by_film:.5}")))
}

/// Whether friction rises less steeply from VcL to 10 cm/s than it falls up to VcL.
fn rises_slowly(given: &Given) -> Result<Finding, CheckError> {
    let joint = lubricated(given)?;
    let (limit, fast) = (joint.limit_velocity()?, 10.0 * CM_PER_S);
    let at = |velocity: f64| joint.at_velocity(velocity).map(|at| at.total);
    let fall = (at(0.0)? - at(limit)?) / limit * CM_PER_S;
    let rise = (at(fast)? - at(limit)?) / (fast - limit) * CM_PER_S;
    let found = format!("falls by {fall:.4}, rises by {rise:.4} with every cm/s");
    Ok(Finding::shape(rise > 0.0 && rise < fall, found))
}

/// The power of mu_k by VcL - V, fitted evenly from rest to a share of VcL; with `through=rest` the law has to begin at mu_s.
fn fall_exponent(given: &Given) -> Result<Finding, CheckError> {
    let (joint, share) = (lubricated(given)?, given.number("to")?);
    let limit = joint.limit_velocity()?;
    let point = |step: u32| {
        let velocity = share * limit * f64::from(step) / f64::from(POINTS);
        joint.at_velocity(velocity).map(|at| ((limit - velocity) / CM_PER_S, at.solid))
    };
    let points = (0..=POINTS).map(point).collect::<Result<Vec<_>, _>>()?;
    Ok(Finding::Number(match given.text("through") {
        Some(_) => given.word("through", &[("rest", exponent_through_first(&points))])?,
        None => PowerLaw::fit(&points)?.exponent,
    }))
}

/// The exponent of the power law through the first point that is nearest to the others.
fn exponent_through_first(points: &[(f64, f64)]) -> f64 {
    let (x0, y0) = points[0];
    let logarithms = || points[1..].iter().map(|(x, y)| ((x / x0).ln(), (y / y0).ln()));
    logarithms().map(|(x, y)| x * y).sum::<f64>() / logarithms().map(|(x, _)| x * x).sum::<f64>()
}

/// The most by which mu_k + mu_0 is above friction by weight, from rest to VcL.
fn printed_total_excess(given: &Given) -> Result<Finding, CheckError> {
    let joint = lubricated(given)?;
    let limit = joint.limit_velocity()?;
    let mut most = 0.0f64;
    for step in 0..=1000 {
        let at = joint.at_velocity(limit * f64::from(step) / 1000.0)?;
        most = most.max(at.printed_total() - at.total);
    }
    Ok(Finding::truth(most < 5e-4, format!("up to {most:.4} too much")))
}

/// Whether mu_0 rises ever less steeply near rest, and a straight line through it from VcL to 10 cm/s meets rest above 0.
fn oil_drag_offset(given: &Given) -> Result<Finding, CheckError> {
    let joint = lubricated(given)?;
    let (offset, slope) = oil_friction_line(&joint)?;
    let slow = 0.05 * CM_PER_S;
    let steep = joint.at_velocity(slow)?.oil / slow / slope;
    let found = format!("{offset:.4} at rest; near rest {steep:.0} times as steep");
    Ok(Finding::shape(offset > 0.0 && steep > 1.0, found))
}

/// What the line has at rest, and its slope in s/m.
fn oil_friction_line(joint: &LubricatedJoint) -> Result<(f64, f64), SlidewayError> {
    let (slow, fast) = (joint.limit_velocity()?, 10.0 * CM_PER_S);
    let near = joint.at_velocity(slow)?.oil;
    let slope = (joint.at_velocity(fast)?.oil - near) / (fast - slow);
    Ok((near - slope * slow, slope))
}

/// By how many N s/mm the oil friction of a table of W kgf rises along that line.
fn oil_damping(given: &Given) -> Result<Finding, CheckError> {
    let (_, slope) = oil_friction_line(&lubricated(given)?)?;
    Ok(Finding::Number(slope * given.number("W")? * KGF / N_S_PER_MM))
}

/// Whether a polar film lowers friction at every velocity below VcL, and leaves VcL as it is.
fn polar_lowers(given: &Given) -> Result<Finding, CheckError> {
    let plain = LubricatedJoint::of_study(oil(given)?, BoundaryFilm::NON_POLAR, pressure(given)?)?;
    let polar = LubricatedJoint { film: BoundaryFilm::POLAR, ..plain };
    let limits = [plain, polar].map(|joint| joint.limit_velocity());
    let (limit, other) = (limits[0].clone()?, limits[1].clone()?);
    let mut holds = limit == other;
    for step in 0..100 {
        let velocity = limit * f64::from(step) / 100.0;
        holds &= polar.at_velocity(velocity)?.total < plain.at_velocity(velocity)?.total;
    }
    Ok(Finding::truth(holds, format!("VcL {:.1} mm/s with both", limit / MM_PER_S)))
}

/// By how much viscosity grows under p MN/m2, or changes with a rise of K.
fn viscosity(given: &Given) -> Result<Finding, CheckError> {
    let (pressure, rise) = (given.number_or("p", 0.0)? * 1e6, given.number_or("rise", 0.0)?);
    Ok(Finding::Number(thickening(pressure)? * thinning(rise)?))
}
