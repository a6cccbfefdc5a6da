//! What others had derived before the study (chapter 2).

use super::super::finding::Finding;
use super::super::given::Given;
use super::{Check, CheckError};
use crate::slideway::history::{GrowthAtRest, KatoLubricant, NakashimaFriction, Slip};
use crate::slideway::material::{Material, YIELD_TO_HARDNESS};
use crate::slideway::stability::DrivenTable;
use crate::slideway::units::{CM, GRAVITY, KGF_PER_MM2, MM_PER_S};
use crate::slideway::{SlidewayError, adhesion};

pub(super) const CHECKS: &[Check] = &[
    Check { name: "tomlinson", run: tomlinson },
    Check { name: "bowden-tabor", run: bowden_tabor },
    Check { name: "mean-shear", run: mean_shear },
    Check { name: "ernst-merchant", run: ernst_merchant },
    Check { name: "rabinowicz-rule", run: rabinowicz_rule },
    Check { name: "stick-slip-falls", run: stick_slip_falls },
    Check { name: "wear-particle", run: wear_particle },
    Check { name: "kraghelskii", run: kraghelskii },
    Check { name: "junctions-grow", run: junctions_grow },
    Check { name: "cone-on-plane", run: cone_on_plane },
    Check { name: "gupta-cook", run: gupta_cook },
    Check { name: "gupta-cook-area", run: gupta_cook_area },
    Check { name: "slip-drop-ratio", run: drop_ratio },
    Check { name: "slip-equation", run: slip_equation },
    Check { name: "slip-half-period", run: slip_half_period },
    Check { name: "slip-falls-with-drive", run: slip_falls_with_drive },
    Check { name: "slip-critical", run: slip_critical },
    Check { name: "slip-critical-tends", run: slip_critical_tends },
    Check { name: "slip-critical-ends-stick", run: slip_ends },
    Check { name: "slip-critical-falls", run: slip_critical_falls },
    Check { name: "growth-at-rest", run: growth_at_rest },
    Check { name: "growth-falls-with-beta", run: growth_by_beta },
    Check { name: "kato-falls", run: kato_falls },
    Check { name: "nakashima", run: nakashima },
];

/// Chapter 7's cast iron: shear strength and flow pressure of eq 61-7, in Pa.
const SHEAR: f64 = Material::GRADE_17_IRON.shear_strength;
const FLOW: f64 = YIELD_TO_HARDNESS * Material::GRADE_17_IRON.hardness;

/// Tomlinson's coefficient of cast iron, E in kgf/mm2, with Poisson's ratio nu and a sign in eq 2.2.
fn tomlinson(given: &Given) -> Result<Finding, CheckError> {
    let young = given.number("E")? * KGF_PER_MM2;
    let shear = young / (2.0 * (1.0 + given.number("nu")?));
    let constant = adhesion::tomlinson_constant(young, shear, given.number("sign")?)?;
    Ok(Finding::Number(adhesion::tomlinson(constant, constant)?))
}

/// That A Ss + a p without ploughing makes a coefficient Ss / Pm that no load changes.
fn bowden_tabor(given: &Given) -> Result<Finding, CheckError> {
    let told = adhesion::shear_by_flow(SHEAR, FLOW)?;
    let coefficient = |load: f64| Ok(adhesion::sheared_and_ploughed(load / FLOW, SHEAR, 0.0, FLOW)? / load);
    let coefficients =
        given.numbers("W")?.into_iter().map(coefficient).collect::<Result<Vec<f64>, SlidewayError>>()?;
    let holds = coefficients.iter().all(|coefficient| (coefficient / told - 1.0).abs() < 1e-12);
    Ok(Finding::truth(holds, format!("{told:.4} for chapter 7's cast iron, at every load")))
}

/// That the mean shear strength goes from that of the film to that of the metal.
fn mean_shear(_: &Given) -> Result<Finding, CheckError> {
    let [film, half, metal] = [0.0, 0.5, 1.0]
        .map(|share| Ok::<_, SlidewayError>(adhesion::mean_shear(share, SHEAR, 0.1 * SHEAR)? / SHEAR));
    let (film, half, metal) = (film?, half?, metal?);
    let found = format!("{film:.2}, {half:.2}, {metal:.2} of the metal's at none, half and all metallic");
    Ok(Finding::truth(
        (film - 0.1).abs() < 1e-12 && film < half && half < metal && (metal - 1.0).abs() < 1e-12,
        found,
    ))
}

/// Ss / Pm + tan(theta) for chapter 7's cast iron.
fn ernst_merchant(given: &Given) -> Result<Finding, CheckError> {
    Ok(Finding::Number(adhesion::ernst_merchant(SHEAR, FLOW, given.number("tan")?.atan())?))
}

/// Friction that grows at rest, as an example.
fn growth(given: &Given) -> Result<GrowthAtRest, CheckError> {
    let (factor, exponent) = (given.number_or("gamma", 0.05)?, given.number_or("beta", 0.3)?);
    Ok(GrowthAtRest { kinetic: 0.2, factor, exponent })
}

/// That the rule of the critical distance makes kinetic friction fall with velocity.
fn rabinowicz_rule(given: &Given) -> Result<Finding, CheckError> {
    let (growth, distance) = (growth(given)?, given.number("distance")?);
    let at = |velocity: f64| growth.coefficient_at(velocity * MM_PER_S, distance);
    let coefficients = [at(0.01)?, at(0.1)?, at(1.0)?];
    let falls = coefficients.windows(2).all(|pair| pair[1] < pair[0]);
    Ok(Finding::shape(falls, format!("{coefficients:.3?} at 0.01, 0.1 and 1 mm/s")))
}

/// That each slip gets shorter with velocity, or with a stiffer drive, or that stick-slip ends sooner on a stiffer drive, under 10 N and
/// with a critical distance of 10 um.
fn stick_slip_falls(given: &Given) -> Result<Finding, CheckError> {
    type Row = fn(&GrowthAtRest) -> Result<[f64; 3], SlidewayError>;
    let row = given.word::<Row>(
        "with",
        &[
            ("velocity", |growth| {
                Ok([
                    growth.slip(10.0, 2e4, 1e-5)?,
                    growth.slip(10.0, 2e4, 1e-4)?,
                    growth.slip(10.0, 2e4, 1e-3)?,
                ])
            }),
            ("stiffness", |growth| {
                Ok([
                    growth.slip(10.0, 1e4, 1e-4)?,
                    growth.slip(10.0, 2e4, 1e-4)?,
                    growth.slip(10.0, 5e4, 1e-4)?,
                ])
            }),
            ("end", |growth| {
                let end = |stiffness: f64| growth.end_of_stick_slip(10.0, stiffness, 10e-6);
                Ok([end(1e4)?, end(2e4)?, end(5e4)?])
            }),
        ],
    )?;
    let found = row(&growth(given)?)?;
    let falls = found.windows(2).all(|pair| pair[1] < pair[0]);
    let unit = if given.text("with") == Some("end") { "mm/s" } else { "mm" };
    Ok(Finding::shape(falls, format!("{:.3?} {unit}", found.map(|number| number * 1e3))))
}

/// Rabinowicz's least diameter in cm, for J/m2 and kgf/mm2.
fn wear_particle(given: &Given) -> Result<Finding, CheckError> {
    let hardness = given.number("p")? * KGF_PER_MM2;
    Ok(Finding::Number(adhesion::wear_particle(given.number("W")?, hardness)? / CM))
}

/// That eq 14.2 follows from 12.2 and 13.2, whose numerator is then the load.
fn kraghelskii(given: &Given) -> Result<Finding, CheckError> {
    let (alpha, beta, nu, stress) = (0.2 * FLOW, 0.05, 3.0, FLOW / 3.0);
    let told = adhesion::kraghelskii(alpha, nu, stress, beta)?;
    let by_parts = |load: f64| (alpha * load / (nu * stress) + beta * load) / load;
    let holds = given.numbers("W")?.into_iter().all(|load| (by_parts(load) / told - 1.0).abs() < 1e-12);
    Ok(Finding::truth(holds, format!("{told:.3} at every load, with W over nu sigma_s")))
}

/// Tsukizoe and Hisakado's coefficient of shearing.
fn junctions_grow(given: &Given) -> Result<Finding, CheckError> {
    Ok(Finding::Number(adhesion::tsukizoe_hisakado(SHEAR, FLOW, given.number("alpha")?)?))
}

/// Their coefficient of a cone.
fn cone_on_plane(given: &Given) -> Result<Finding, CheckError> {
    let slope = given.number("tan")?.atan();
    Ok(Finding::Number(adhesion::cone_on_plane(given.number("mu")?, slope)?))
}

/// Gupta and Cook's coefficient where S = Y.
fn gupta_cook(_: &Given) -> Result<Finding, CheckError> {
    Ok(Finding::Number(adhesion::gupta_cook(FLOW, FLOW)?))
}

/// Their factor of W (2 / Y) in the contact area.
fn gupta_cook_area(_: &Given) -> Result<Finding, CheckError> {
    Ok(Finding::Number(adhesion::gupta_cook_area(1.0, 2.0)?))
}

/// A slip on the study's table with a damping ratio: dF in N, M in kg, K in N/m.
fn slip(given: &Given) -> Result<Slip, CheckError> {
    let study = DrivenTable::simulated(0.0);
    Ok(Slip {
        drop: given.number_or("dF", 100.0)?,
        mass: given.number_or("M", study.mass)?,
        stiffness: given.number_or("K", study.stiffness)?,
        damping: given.number_or("zeta", 0.0)?,
    })
}

/// That phi is a number without unit: it stays where forces are ten times and masses, stiffness with them.
fn drop_ratio(given: &Given) -> Result<Finding, CheckError> {
    let (slip, drive) = (slip(given)?, given.number("V")?);
    let larger =
        Slip { drop: 10.0 * slip.drop, mass: 10.0 * slip.mass, stiffness: 10.0 * slip.stiffness, ..slip };
    let (one, other) = (slip.drop_ratio(drive)?, larger.drop_ratio(drive)?);
    Ok(Finding::truth((one / other - 1.0).abs() < 1e-12, format!("phi = {one:.4} both times")))
}

/// That eq 18.2 solves eq 15.2, within a ten-thousandth of K V over half a period, with v = 0 and v' = dF/M at the start.
fn slip_equation(given: &Given) -> Result<Finding, CheckError> {
    let (slip, drive) = (slip(given)?, given.number("V")?);
    let radian = (slip.mass / slip.stiffness).sqrt();
    let mut solves = true;
    for step in 1..30 {
        solves &= missed(&slip, drive, 0.1 * f64::from(step) * radian)?.abs() < 1e-4;
    }
    let soon = 1e-7 * radian;
    let start = slip.velocity(drive, soon)? / soon / (slip.drop / slip.mass);
    let holds = solves && slip.velocity(drive, 0.0)? == 0.0 && (start - 1.0).abs() < 1e-5;
    let found = if solves { "solved" } else { "not solved" };
    Ok(Finding::truth(holds, format!("{found}; v' at the start is {start:.4} dF/M")))
}

/// What eq 18.2 leaves of eq 15.2 once differentiated, M v'' + (f - n) v' + K (v - V), in units of K V, by differences.
fn missed(slip: &Slip, drive: f64, time: f64) -> Result<f64, SlidewayError> {
    let radian = (slip.mass / slip.stiffness).sqrt();
    let step = 1e-3 * radian;
    let (before, now) = (slip.velocity(drive, time - step)?, slip.velocity(drive, time)?);
    let after = slip.velocity(drive, time + step)?;
    let (rate, bend) = ((after - before) / (2.0 * step), (after - 2.0 * now + before) / step.powi(2));
    Ok((radian.powi(2) * bend + 2.0 * slip.damping * radian * rate + now - drive) / drive)
}

/// That an undamped slip lasts pi / wn, as nearly as a drive in m/s lets it: within the machine's 2 %.
fn slip_half_period(given: &Given) -> Result<Finding, CheckError> {
    let slip = slip(given)?;
    let share =
        slip.duration(given.number("V")?)? * (slip.stiffness / slip.mass).sqrt() / std::f64::consts::PI;
    Ok(Finding::truth((share - 1.0).abs() < 0.02, format!("{share:.4} of it")))
}

/// That the velocity of slip falls, by the drive's, as the drive gets faster.
fn slip_falls_with_drive(given: &Given) -> Result<Finding, CheckError> {
    let slip = slip(given)?;
    let most = |drive: f64| -> Result<f64, SlidewayError> {
        let (parts, end) = (200, slip.duration(drive)?);
        let mut most: f64 = 0.0;
        for part in 0..parts {
            most = most.max(slip.velocity(drive, end * f64::from(part) / f64::from(parts))? / drive);
        }
        Ok(most)
    };
    let peaks = given.numbers("V")?.into_iter().map(most).collect::<Result<Vec<f64>, SlidewayError>>()?;
    let falls = peaks.windows(2).all(|pair| pair[1] < pair[0]);
    Ok(Finding::shape(falls, format!("peaks of {peaks:.2?} times the drive's")))
}

/// That eq 19.2 is the tangency of eq 18.2 for small damping ratios: within the machine's 2 %.
fn slip_critical(given: &Given) -> Result<Finding, CheckError> {
    let slip = slip(given)?;
    let ratio = slip.approximate_critical_velocity()? / slip.critical_velocity()?;
    let found = format!("{:+.1} % from tangency", 100.0 * (ratio - 1.0));
    Ok(Finding::truth((ratio - 1.0).abs() < 0.02, found))
}

/// That eq 19.2 comes nearer to tangency as the damping ratio falls.
fn slip_critical_tends(given: &Given) -> Result<Finding, CheckError> {
    let slip = slip(given)?;
    let miss = |damping: f64| -> Result<f64, SlidewayError> {
        let slip = Slip { damping, ..slip };
        Ok(100.0 * (slip.approximate_critical_velocity()? / slip.critical_velocity()? - 1.0))
    };
    let ratios = given.numbers("over")?;
    let misses = ratios.iter().map(|damping| miss(*damping)).collect::<Result<Vec<f64>, SlidewayError>>()?;
    let holds = misses.windows(2).all(|pair| pair[1].abs() < pair[0].abs());
    Ok(Finding::shape(holds, format!("{misses:.1?} % at {ratios:?}")))
}

/// That slip ends just below the critical velocity, and not just above.
fn slip_ends(given: &Given) -> Result<Finding, CheckError> {
    let slip = slip(given)?;
    let critical = slip.critical_velocity()?;
    let ends = |share: f64| slip.duration(share * critical).is_ok();
    let found = format!("critical at {:.3} mm/s", critical / MM_PER_S);
    Ok(Finding::truth(ends(0.999) && !ends(1.001), found))
}

/// That the critical velocity falls as the damping ratio, or stiffness, rises, or as the drop falls.
fn slip_critical_falls(given: &Given) -> Result<Finding, CheckError> {
    type Change = fn(&Slip, f64) -> Slip;
    let changes: [(&str, Change); 3] = [
        ("zeta", |slip, factor| Slip { damping: slip.damping * factor, ..*slip }),
        // The viscous coefficient stays, and zeta goes with 1 / sqrt(K).
        ("K", |slip, factor| Slip {
            stiffness: slip.stiffness * factor,
            damping: slip.damping / factor.sqrt(),
            ..*slip
        }),
        ("drop", |slip, factor| Slip { drop: slip.drop / factor, ..*slip }),
    ];
    let (slip, change) = (slip(given)?, given.word("with", &changes)?);
    let velocity =
        |factor: f64| Ok::<_, SlidewayError>(change(&slip, factor).critical_velocity()? / MM_PER_S);
    let velocities = [velocity(1.0)?, velocity(1.5)?, velocity(2.0)?];
    let falls = velocities.windows(2).all(|pair| pair[1] < pair[0]);
    Ok(Finding::shape(falls, format!("{velocities:.2?} mm/s at 1, 1.5 and 2 times the change")))
}

/// That mu_s is mu_k at no time of rest, and that the logarithms of the difference lie on a line over those of time.
fn growth_at_rest(given: &Given) -> Result<Finding, CheckError> {
    let growth = growth(given)?;
    let grown = |time: f64| Ok::<_, SlidewayError>(growth.static_coefficient(time)? - growth.kinetic);
    let rises = [(grown(0.1)? / grown(0.01)?).log10(), (grown(10.0)? / grown(1.0)?).log10()];
    let holds = grown(0.0)? == 0.0 && rises.iter().all(|rise| (rise - growth.exponent).abs() < 1e-9);
    Ok(Finding::truth(holds, format!("0 at rest, slopes {rises:.3?} in logarithms")))
}

/// That static friction after `t` s at rest is smaller with a smaller beta.
fn growth_by_beta(given: &Given) -> Result<Finding, CheckError> {
    let (growth, time) = (growth(given)?, given.number("t")?);
    let with = |exponent: f64| GrowthAtRest { exponent, ..growth }.static_coefficient(time);
    let (small, large) = (with(0.5 * growth.exponent)?, with(growth.exponent)?);
    Ok(Finding::shape(small < large, format!("{small:.4} with half the beta, {large:.4} with all of it")))
}

/// That Kato's critical velocity falls as the natural frequency rises.
fn kato_falls(given: &Given) -> Result<Finding, CheckError> {
    let oil = KatoLubricant { drop: 0.1, a: 20.0, m: 0.8, b: 20.0, n: 0.8 };
    let mass = given.number("M")?;
    let at = |stiffness: f64| oil.critical_velocity(mass * GRAVITY, mass, stiffness);
    let velocities = [at(11e6)? / MM_PER_S, at(27.6e6)? / MM_PER_S, at(45e6)? / MM_PER_S];
    let falls = velocities.windows(2).all(|pair| pair[1] < pair[0]);
    Ok(Finding::shape(falls, format!("{velocities:.3?} mm/s at 11, 27.6 and 45 MN/m")))
}

/// That Nakashima's friction lets a table oscillate with a below 0 only, and is eq 26-9 with Cn = -W a, Tc = 1 / b0, f = T0.
fn nakashima(given: &Given) -> Result<Finding, CheckError> {
    let study = DrivenTable::simulated(given.number("Tc")?);
    let friction = |slope: f64| NakashimaFriction {
        weight: study.mass * GRAVITY,
        slope,
        rate: 1.0 / study.memory,
        linear: study.damping,
    };
    let is_stable = |slope: f64| -> Result<bool, SlidewayError> {
        let friction = friction(slope);
        let table = DrivenTable { damping: friction.linear, memory: friction.memory()?, ..study };
        table.is_stable(friction.falling())
    };
    let edge = -study.critical_slope()? / friction(0.0).weight;
    let holds = is_stable(10.0)? && is_stable(0.99 * edge)? && !is_stable(1.01 * edge)?;
    Ok(Finding::truth(holds, format!("unstable below a = {edge:.2} s/m, stable above 0")))
}
