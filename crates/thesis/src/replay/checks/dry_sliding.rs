//! Claims on the dry sliding joint (7.3.i).
//!
//! Common arguments, all optional: `Pw` in kgf/cm2 (0.65), `joint` (`printed`, `table` or `sums`), `shear=tabor` and
//! `alpha`. The first three are read in [`joint_at_rest`](super::joint_at_rest). Velocities `V` are in mm/s, as in the
//! text.

use super::super::check_arguments::CheckArguments;
use super::super::finding::Finding;
use super::super::series::{is_falling, is_rising};
use super::joint_at_rest::{joint, pressure};
use super::{Check, CheckError};
use crate::slideway::dry_friction::{DryFriction, DrySliding, printed_penetration};
use crate::slideway::measured::TABLE_9_2;
use crate::slideway::units::{CM, CM2, KGF, KGF_PER_CM2, KGF_PER_MM2, MM_PER_S, UM, UM2};

/// The checks of this file, by the name that the ledger uses.
pub(super) const CHECKS: &[Check] = &[
    Check { name: "dry-sliding", run: dry_sliding },
    Check { name: "dry-memory", run: dry_memory },
    Check { name: "dry-frequency-of-most", run: dry_frequency_of_most },
    Check { name: "dry-friction-exponent", run: dry_friction_exponent },
    Check { name: "stiffness-and-alpha", run: stiffness_and_alpha },
    Check { name: "damping-and-alpha", run: damping_and_alpha },
    Check { name: "penetration-of-area", run: penetration_of_area },
    Check { name: "stiffening-at", run: stiffening_at },
];

/// Number of intervals in the fit of a curve.
pub(super) const POINTS: u32 = 40;

/// The dry joint. `alpha` replaces the thesis's stiffening.
///
/// `alpha` is the ratio of the modulus at high frequency to that at rest. The thesis has 2.9 (eq 117-7). The viscosity
/// of the metal stays 8e10 P, so another alpha also changes the time constant T = Um / ((alpha - 1) E0) (eq 118-7).
fn dry(given: &CheckArguments) -> Result<DryFriction, CheckError> {
    let thesis = DryFriction::of_thesis(joint(given)?, pressure(given)?);
    Ok(DryFriction { stiffening: given.number_or("alpha", thesis.stiffening)?, ..thesis })
}

/// A quantity of the dry joint at V mm/s or at w rad/s, in the units of the thesis; or its time constant in s or limit
/// velocity in mm/s.
///
/// Arguments: `of`, and either `V` or `w`. Quantities at a state of motion:
///
/// * `velocity` in mm/s (eq 122-7), `stiffening` alpha, `friction` mu_k (eq 115-7)
/// * `penetration` in um (eq 95-7), `lift` in um: penetration at rest minus that at `V` (eq 123-7)
/// * `stiffness` KE in kgf/cm and `damping` CE in kgf s/cm, both of a square centimetre (eq 98-7, 102-7)
/// * `viscosity` UA of the asperities in kgf s/cm2 (eq 101-7), `time` CE / KE in s
///
/// `time-constant` (eq 118-7) and `limit-velocity` (eq 132-7) need no state. Claims 7-113.a, 7-122.a, 7-125, 7-126,
/// 7-130 ... 7-133.b, 7-208 and 7-209.a ... e.
fn dry_sliding(given: &CheckArguments) -> Result<Finding, CheckError> {
    let dry = dry(given)?;
    match given.require("of")? {
        "time-constant" => return Ok(Finding::Number(dry.time_constant()?)),
        "limit-velocity" => return Ok(Finding::Number(dry.limit_velocity()? / MM_PER_S)),
        "lift" => {
            let sliding = dry.at_velocity(given.number("V")? * MM_PER_S)?.penetration;
            return Ok(Finding::Number((dry.at_frequency(0.0)?.penetration - sliding) / UM));
        }
        _ => {}
    }
    let quantity = given.choice::<fn(&DrySliding) -> f64>(
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
    Ok(Finding::Number(quantity(&at)))
}

/// Normal damping CE of a square centimetre, in kgf s/cm; 0 at rest. CE is not defined at rest, where the asperities do
/// not approach.
fn damping(at: &DrySliding) -> f64 {
    at.damping.unwrap_or(0.0) * CM2 * CM / KGF
}

/// Checks whether the time constant of a dry joint, or CE / KE at some w, is positive and below the smallest of Table
/// T9-2.
///
/// The argument `w` lists frequencies in rad/s. With it the check computes CE / KE at each of them (claim 10-008.a),
/// without it the time constant T of stiffening (claim 10-008.b). The two definitions in the text are inconsistent: T
/// is 31.9 ms, CE / KE at most 4.4 ms. The smallest Tc of Table T9-2 is 5.9 ms.
fn dry_memory(given: &CheckArguments) -> Result<Finding, CheckError> {
    let dry = dry(given)?;
    let memories = match given.text("w") {
        Some(_) => {
            let at = |w: f64| dry.at_frequency(w).map(|at| damping(&at) / (at.stiffness * CM2 * CM / KGF));
            given.numbers("w")?.into_iter().map(at).collect::<Result<Vec<_>, _>>()?
        }
        None => vec![dry.time_constant()?],
    };
    let oiled = TABLE_9_2.iter().map(|cell| cell.memory).fold(f64::INFINITY, f64::min);
    let texts: Vec<_> = memories.iter().map(|memory| format!("{:.2}", memory * 1e3)).collect();
    let found = format!("{} ms dry, at least {:.1} ms with oil", texts.join(", "), oiled * 1e3);
    Ok(Finding::shape(memories.iter().all(|memory| *memory > 0.0 && *memory < oiled), found))
}

/// The frequency in rad/s at which CE, or the imaginary part of alpha, is largest, to a thousandth.
///
/// Argument: `of`, `damping` or `imaginary`. Frequencies run from 1 to exp(7) = 1096 rad/s in steps of 0.1 %. The
/// imaginary part of alpha is (alpha - 1) T w / (1 + (T w)^2), whose maximum is at 1 / T = 31.4 rad/s (claim 7-134).
/// The maximum of CE is at a power of 1 / T that the scan lost (claim 7-135).
fn dry_frequency_of_most(given: &CheckArguments) -> Result<Finding, CheckError> {
    let dry = dry(given)?;
    let is_damping = given.choice("of", &[("damping", true), ("imaginary", false)])?;
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

/// The exponent n of mu_k = mu_s alpha^-n, fitted over alpha from 1 to its maximum, through mu_s at rest.
///
/// The fit minimises the squared differences of logarithms under the condition that the law is exact at rest: n = -
/// sum(ln alpha ln(mu_k / mu_s)) / sum((ln alpha)^2). The text has 0.67 (eq 125-7, claim 7-137).
fn dry_friction_exponent(given: &CheckArguments) -> Result<Finding, CheckError> {
    let dry = dry(given)?;
    let at_rest = dry.at_frequency(0.0)?.friction;
    let (mut joint, mut square) = (0.0, 0.0);
    for step in 1..=POINTS {
        // The points are evenly spaced in alpha; `turn` is T w for this alpha.
        let alpha = 1.0 + (dry.stiffening - 1.0) * f64::from(step) / f64::from(POINTS + 1);
        let turn = ((alpha.powi(2) - 1.0) / (dry.stiffening.powi(2) - alpha.powi(2))).sqrt();
        let at = dry.at_frequency(turn / dry.time_constant()?)?;
        joint += at.stiffening.ln() * (at.friction / at_rest).ln();
        square += at.stiffening.ln().powi(2);
    }
    Ok(Finding::Number(-joint / square))
}

/// Checks whether the normal stiffness and the inverse of the real part of alpha both fall monotonically with
/// frequency.
///
/// Fig 7.22, claim 7-136. Frequencies are 0 and 40 values from 0.13 to 1000 rad/s, evenly spaced on a logarithmic
/// scale. The finding states both final values relative to those at rest. They differ, as the text says.
fn stiffness_and_alpha(given: &CheckArguments) -> Result<Finding, CheckError> {
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
    Ok(Finding::shape(holds, format!("to {stiffness:.3} and {inverse:.3} of their values at rest")))
}

/// Checks whether the normal damping and the imaginary part of alpha both rise to one maximum and fall from there on.
///
/// Fig 7.23, claim 7-136.b. Frequencies are 41 values from 0.1 to 1000 rad/s. A crest at the first or last frequency
/// does not count as a maximum. The finding states both frequencies, which differ, as the text says.
fn damping_and_alpha(given: &CheckArguments) -> Result<Finding, CheckError> {
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
        let crest = row.windows(2).take_while(|pair| is_rising(pair)).count();
        holds &= crest > 0 && crest < row.len() - 1 && is_falling(&row[crest..]);
        crests.push(frequencies[crest]);
    }
    Ok(Finding::shape(holds, format!("one maximum each, near {:.0} and {:.0} rad/s", crests[0], crests[1])))
}

/// Penetration hd in um for a leading area of A um2, by eq 96-7.
///
/// The law is hd = 0.077 A^0.27 (eq 96-7). Claims 7-111.b and 7-121.
fn penetration_of_area(given: &CheckArguments) -> Result<Finding, CheckError> {
    Ok(Finding::Number(printed_penetration(given.number("A")? * UM2)? / UM))
}

/// Alpha at which the pressure on the leading area is Px kgf/mm2, by the printed law of the area.
///
/// alpha = (AcL Px / Pw)^(1 / 0.82), from eq 92-7 and 114-7, with AcL as a share of the apparent area. Claim 7-123.b:
/// the areas give 2.77 for 220 kgf/mm2, the penetrations 2.9.
fn stiffening_at(given: &CheckArguments) -> Result<Finding, CheckError> {
    let borne = given.number("Px")? * KGF_PER_MM2;
    Ok(Finding::Number(DryFriction::stiffening_at(&joint(given)?, pressure(given)?, borne)?))
}
