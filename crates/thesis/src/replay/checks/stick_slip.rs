//! Claims on earlier theories of stick-slip, and of friction that grows at rest (2.3 ... 2.5).
//!
//! Examples use the thesis's table, because most of the cited papers give no numbers. The equations of chapter 2 are
//! numbered with a point: eq 18.2.

use super::super::check_arguments::CheckArguments;
use super::super::finding::Finding;
use super::super::series::is_falling;
use super::{Check, CheckError};
use crate::slideway::SlidewayError;
use crate::slideway::history::{GrowthAtRest, KatoLubricant, NakashimaFriction, Slip};
use crate::slideway::stability::DrivenTable;
use crate::slideway::units::{GRAVITY, MM_PER_S};

/// The checks of this file, by the name that the ledger uses.
pub(super) const CHECKS: &[Check] = &[
    Check { name: "rabinowicz-rule", run: rabinowicz_rule },
    Check { name: "stick-slip-falls", run: stick_slip_falls },
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

/// An example of friction that grows at rest: mu_k = 0.2, gamma = 0.05, beta = 0.3 unless given. mu_s = mu_k + gamma
/// t^beta (eq 20.2).
fn growth(given: &CheckArguments) -> Result<GrowthAtRest, CheckError> {
    let (factor, exponent) = (given.number_or("gamma", 0.05)?, given.number_or("beta", 0.3)?);
    Ok(GrowthAtRest { kinetic: 0.2, factor, exponent })
}

/// Checks that by the rule of the critical distance kinetic friction falls with velocity. The distance is in m.
///
/// mu_k at a velocity is mu_s after the time distance / velocity. Claim 2-009.
fn rabinowicz_rule(given: &CheckArguments) -> Result<Finding, CheckError> {
    let (growth, distance) = (growth(given)?, given.number("distance")?);
    let at = |velocity: f64| growth.coefficient_at(velocity * MM_PER_S, distance);
    let coefficients = [at(0.01)?, at(0.1)?, at(1.0)?];
    let falls = is_falling(&coefficients);
    Ok(Finding::shape(falls, format!("{coefficients:.3?} at 0.01, 0.1 and 1 mm/s")))
}

/// Checks that each slip is shorter at a higher velocity or with a stiffer drive, or that stick-slip ends at a lower
/// velocity with a stiffer drive. The weight is 10 N and the critical distance 10 um.
///
/// Argument `with`: `velocity`, `stiffness` or `end`. A slip is (2 W gamma / (K V^beta))^(1 / (1 - beta)). Claims
/// 2-009.b ... d (Fig 2.2).
fn stick_slip_falls(given: &CheckArguments) -> Result<Finding, CheckError> {
    type SlipValues = fn(&GrowthAtRest) -> Result<[f64; 3], SlidewayError>;
    let row = given.choice::<SlipValues>(
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
    let falls = is_falling(&found);
    let unit = if given.text("with") == Some("end") { "mm/s" } else { "mm" };
    Ok(Finding::shape(falls, format!("{:.3?} {unit}", found.map(|number| number * 1e3))))
}

/// A slip on the thesis's table: dF in N (100 N by default), M in kg, K in N/m, damping ratio zeta.
fn slip(given: &CheckArguments) -> Result<Slip, CheckError> {
    let thesis = DrivenTable::simulated(0.0);
    Ok(Slip {
        drop: given.number_or("dF", 100.0)?,
        mass: given.number_or("M", thesis.mass)?,
        stiffness: given.number_or("K", thesis.stiffness)?,
        damping: given.number_or("zeta", 0.0)?,
    })
}

/// Checks that phi is dimensionless: it does not change if forces, masses and stiffness are ten times as large.
///
/// phi = dF / (V sqrt(K M)) (eq 17.2). Argument `V` in m/s. Claim 2-014.
fn drop_ratio(given: &CheckArguments) -> Result<Finding, CheckError> {
    let (slip, drive) = (slip(given)?, given.number("V")?);
    let larger =
        Slip { drop: 10.0 * slip.drop, mass: 10.0 * slip.mass, stiffness: 10.0 * slip.stiffness, ..slip };
    let (one, other) = (slip.drop_ratio(drive)?, larger.drop_ratio(drive)?);
    Ok(Finding::truth((one / other - 1.0).abs() < 1e-12, format!("phi = {one:.4} in both cases")))
}

/// Checks that eq 18.2 solves eq 15.2, within a ten-thousandth of K V over half a period, with v = 0 and v' = dF/M at
/// the start.
///
/// Arguments: `V` in m/s and `zeta`. 29 times are checked, 0.1 to 2.9 times sqrt(M / K). Claim 2-015.
fn slip_equation(given: &CheckArguments) -> Result<Finding, CheckError> {
    let (slip, drive) = (slip(given)?, given.number("V")?);
    let radian = (slip.mass / slip.stiffness).sqrt();
    let mut solves = true;
    for step in 1..30 {
        solves &= residual(&slip, drive, 0.1 * f64::from(step) * radian)?.abs() < 1e-4;
    }
    let soon = 1e-7 * radian;
    let start = slip.velocity(drive, soon)? / soon / (slip.drop / slip.mass);
    let holds = solves && slip.velocity(drive, 0.0)? == 0.0 && (start - 1.0).abs() < 1e-5;
    let equation = if solves { "solved" } else { "not solved" };
    Ok(Finding::truth(holds, format!("{equation}; v' at the start is {start:.4} dF/M")))
}

/// The residual of the derivative of eq 15.2 for the velocity of eq 18.2, M v'' + (f - n) v' + K (v - V), in units of
/// K V. The derivatives are central differences.
///
/// `drive` is V in m/s, `time` the time since the start of the slip in s.
fn residual(slip: &Slip, drive: f64, time: f64) -> Result<f64, SlidewayError> {
    let radian = (slip.mass / slip.stiffness).sqrt();
    let step = 1e-3 * radian;
    let (before, now) = (slip.velocity(drive, time - step)?, slip.velocity(drive, time)?);
    let after = slip.velocity(drive, time + step)?;
    let (first_derivative, second_derivative) =
        ((after - before) / (2.0 * step), (after - 2.0 * now + before) / step.powi(2));
    Ok((radian.powi(2) * second_derivative + 2.0 * slip.damping * radian * first_derivative + now - drive)
        / drive)
}

/// Checks that an undamped slip lasts pi / wn to the machine's accuracy of 2 %, for a drive velocity V in m/s.
///
/// Bowden and Tabor; it holds for a slow drive only. Claim 2-007.
fn slip_half_period(given: &CheckArguments) -> Result<Finding, CheckError> {
    let slip = slip(given)?;
    let share =
        slip.duration(given.number("V")?)? * (slip.stiffness / slip.mass).sqrt() / std::f64::consts::PI;
    Ok(Finding::truth((share - 1.0).abs() < 0.02, format!("{share:.4} of pi / wn")))
}

/// Checks that the peak velocity of slip relative to the drive velocity falls as the drive gets faster.
///
/// Argument `V`: drive velocities in m/s, ascending. Claim 2-007.b.
fn slip_falls_with_drive(given: &CheckArguments) -> Result<Finding, CheckError> {
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
    let falls = is_falling(&peaks);
    Ok(Finding::shape(falls, format!("peaks of {peaks:.2?} times the drive velocity")))
}

/// Checks that eq 19.2 agrees with the tangency of eq 18.2 to the machine's accuracy of 2 %.
///
/// dF / sqrt(4 pi zeta M K). Claim 2-016.a, at zeta = 0.001.
fn slip_critical(given: &CheckArguments) -> Result<Finding, CheckError> {
    let slip = slip(given)?;
    let ratio = slip.approximate_critical_velocity()? / slip.critical_velocity()?;
    let found = format!("{:+.1} % from tangency", 100.0 * (ratio - 1.0));
    Ok(Finding::truth((ratio - 1.0).abs() < 0.02, found))
}

/// Checks that eq 19.2 approaches the tangency of eq 18.2 as the damping ratio falls.
///
/// Argument `over`: damping ratios, descending. Claim 2-016.b.
fn slip_critical_tends(given: &CheckArguments) -> Result<Finding, CheckError> {
    let slip = slip(given)?;
    let error = |damping: f64| -> Result<f64, SlidewayError> {
        let slip = Slip { damping, ..slip };
        Ok(100.0 * (slip.approximate_critical_velocity()? / slip.critical_velocity()? - 1.0))
    };
    let ratios = given.numbers("over")?;
    let errors = ratios.iter().map(|damping| error(*damping)).collect::<Result<Vec<f64>, SlidewayError>>()?;
    let holds = errors.windows(2).all(|pair| pair[1].abs() < pair[0].abs());
    Ok(Finding::shape(holds, format!("{errors:.1?} % at {ratios:?}")))
}

/// Checks that a slip ends just below the critical velocity, and does not end just above it.
///
/// At 0.999 and 1.001 times the critical velocity. Claim 2-016.c.
fn slip_ends(given: &CheckArguments) -> Result<Finding, CheckError> {
    let slip = slip(given)?;
    let critical = slip.critical_velocity()?;
    let ends = |share: f64| slip.duration(share * critical).is_ok();
    let found = format!("critical at {:.3} mm/s", critical / MM_PER_S);
    Ok(Finding::truth(ends(0.999) && !ends(1.001), found))
}

/// Checks that the critical velocity falls as the damping ratio, or stiffness, rises, or as the drop falls.
///
/// Argument `with`: `zeta`, `K` or `drop`, changed by factors of 1.5 and 2. Claims 2-017 and 2-019.
fn slip_critical_falls(given: &CheckArguments) -> Result<Finding, CheckError> {
    type Change = fn(&Slip, f64) -> Slip;
    let changes: [(&str, Change); 3] = [
        ("zeta", |slip, factor| Slip { damping: slip.damping * factor, ..*slip }),
        // The viscous coefficient stays the same, so zeta is proportional to 1 / sqrt(K).
        ("K", |slip, factor| Slip {
            stiffness: slip.stiffness * factor,
            damping: slip.damping / factor.sqrt(),
            ..*slip
        }),
        ("drop", |slip, factor| Slip { drop: slip.drop / factor, ..*slip }),
    ];
    let (slip, change) = (slip(given)?, given.choice("with", &changes)?);
    let velocity =
        |factor: f64| Ok::<_, SlidewayError>(change(&slip, factor).critical_velocity()? / MM_PER_S);
    let velocities = [velocity(1.0)?, velocity(1.5)?, velocity(2.0)?];
    let falls = is_falling(&velocities);
    Ok(Finding::shape(falls, format!("{velocities:.2?} mm/s at 1, 1.5 and 2 times the change")))
}

/// Checks that mu_s equals mu_k for no time at rest, and that their difference is a straight line on logarithmic paper.
///
/// The slope on logarithmic paper must be beta between 0.01 and 0.1 s, and between 1 and 10 s. Eq 20.2, claim 2-018.
fn growth_at_rest(given: &CheckArguments) -> Result<Finding, CheckError> {
    let growth = growth(given)?;
    let grown = |time: f64| Ok::<_, SlidewayError>(growth.static_coefficient(time)? - growth.kinetic);
    let rises = [(grown(0.1)? / grown(0.01)?).log10(), (grown(10.0)? / grown(1.0)?).log10()];
    let holds = grown(0.0)? == 0.0 && rises.iter().all(|rise| (rise - growth.exponent).abs() < 1e-9);
    Ok(Finding::truth(holds, format!("0 for no time at rest, logarithmic slopes {rises:.3?}")))
}

/// Checks that static friction after `t` s at rest is smaller with a smaller beta.
///
/// Claims 2-019.d and e: this holds above 1 s, the unit of gamma, and not below it.
fn growth_by_beta(given: &CheckArguments) -> Result<Finding, CheckError> {
    let (growth, time) = (growth(given)?, given.number("t")?);
    let with = |exponent: f64| GrowthAtRest { exponent, ..growth }.static_coefficient(time);
    let (small, large) = (with(0.5 * growth.exponent)?, with(growth.exponent)?);
    Ok(Finding::shape(small < large, format!("{small:.4} with half of beta, {large:.4} with beta")))
}

/// Checks that Kato's critical velocity falls as the natural frequency rises.
///
/// Argument `M` in kg. The constants of the lubricant are examples. Eq 36.2, claim 2-031.
fn kato_falls(given: &CheckArguments) -> Result<Finding, CheckError> {
    let oil = KatoLubricant { drop: 0.1, a: 20.0, m: 0.8, b: 20.0, n: 0.8 };
    let mass = given.number("M")?;
    let at = |stiffness: f64| oil.critical_velocity(mass * GRAVITY, mass, stiffness);
    let velocities = [at(11e6)? / MM_PER_S, at(27.6e6)? / MM_PER_S, at(45e6)? / MM_PER_S];
    let falls = is_falling(&velocities);
    Ok(Finding::shape(falls, format!("{velocities:.3?} mm/s at 11, 27.6 and 45 MN/m")))
}

/// Checks that a table with Nakashima's friction can oscillate only if a is negative. The friction is that of eq 26-9
/// with Cn = -W a, Tc = 1 / b0, f = T0.
///
/// Argument `Tc` in s. The check tests a positive slope, and slopes 1 % below and above the boundary of Routh-Hurwitz.
/// Claim 2-033 (eq 38.2).
fn nakashima(given: &CheckArguments) -> Result<Finding, CheckError> {
    let thesis = DrivenTable::simulated(given.number("Tc")?);
    let friction = |slope: f64| NakashimaFriction {
        weight: thesis.mass * GRAVITY,
        slope,
        rate: 1.0 / thesis.memory,
        linear: thesis.damping,
    };
    let is_stable = |slope: f64| -> Result<bool, SlidewayError> {
        let friction = friction(slope);
        let table = DrivenTable { damping: friction.linear, memory: friction.memory()?, ..thesis };
        table.is_stable(friction.falling())
    };
    let edge = -thesis.critical_slope()? / friction(0.0).weight;
    let holds = is_stable(10.0)? && is_stable(0.99 * edge)? && !is_stable(1.01 * edge)?;
    Ok(Finding::truth(holds, format!("unstable below a = {edge:.2} s/m, stable above 0")))
}
