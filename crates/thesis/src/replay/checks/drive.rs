//! Claims on the drive and on the tilt of the table (4.4).

use super::super::check_arguments::CheckArguments;
use super::super::finding::Finding;
use super::super::series::min_max;
use super::joint_at_rest::{joint, pressure};
use super::{Check, CheckError};
use crate::slideway::design::Interface;
use crate::slideway::hydraulics::cylinder_stiffness;
use crate::slideway::measured::TABLE_9_2;
use crate::slideway::stability::DrivenTable;
use crate::slideway::tilt::{self, Tilt};
use crate::slideway::units::{KGF, MM, UM};

/// The checks of this file, by the name that the ledger uses.
pub(super) const CHECKS: &[Check] = &[
    Check { name: "cylinder-stiffness", run: cylinder },
    Check { name: "drives-within", run: drives_within },
    Check { name: "sinking", run: sinking },
    Check { name: "interface-stiffness", run: interface_stiffness },
    Check { name: "pitch", run: pitch },
    Check { name: "pitch-agrees", run: pitch_agrees },
    Check { name: "tilt-factor", run: tilt_factor },
    Check { name: "straight-push", run: straight_push },
    Check { name: "yaw-angle", run: yaw_angle },
];

/// Checks that 2 B A^2 / V is the force divided by the displacement, which compresses one side and relaxes the other.
///
/// B is the bulk modulus in Pa, A the area of the piston in m2, V the volume of one side in m3. The displacement is 1
/// nm. Eq 1-4, claim 4-001.
fn cylinder(_: &CheckArguments) -> Result<Finding, CheckError> {
    let (bulk, area, volume, small) = (1.7e9, 20e-4, 0.3e-3, 1e-9);
    let pressure = bulk * area * small / volume;
    let force = 2.0 * pressure * area;
    let stiffness = cylinder_stiffness(bulk, area, volume)?;
    let found = format!("{:.2} MN/m for 1.7 GPa, 20 cm2, 0.3 l", stiffness / 1e6);
    Ok(Finding::truth((force / small / stiffness - 1.0).abs() < 1e-9, found))
}

/// Checks whether the drives that the thesis simulates and measures have stiffnesses of `low` ... `high` N/m.
///
/// The stiffnesses are those of Table T9-2 and of the final circuit, 11 ... 45 kN/mm. Claim 4-003.
fn drives_within(given: &CheckArguments) -> Result<Finding, CheckError> {
    let measured = TABLE_9_2.iter().map(|cell| cell.stiffness);
    let stiffnesses = measured.chain([DrivenTable::simulated(0.0).stiffness]);
    let (min, max) = min_max(stiffnesses);
    let holds = given.number("low")? <= min && max <= given.number("high")?;
    Ok(Finding::shape(holds, format!("{:.1} ... {:.1} MN/m", min / 1e6, max / 1e6)))
}

/// Z0 = W / Ks in um, for W in kgf and the stiffness of the example.
///
/// Ks is 1e5 kgf/mm. Fig 4.5, claim 4-012.b.
fn sinking(given: &CheckArguments) -> Result<Finding, CheckError> {
    Ok(Finding::Number(tilt::sinking(given.number("W")? * KGF, Tilt::EXAMPLE.stiffness)? / UM))
}

/// Stiffness of chapter 7's joint under the model table, in kgf/mm.
///
/// The tangent stiffness Ka (eq 49-7) of a square centimetre under `Pw`, times the 697 cm2 of the table. Claim 4-012.a:
/// 25 times the stiffness of the example.
fn interface_stiffness(given: &CheckArguments) -> Result<Finding, CheckError> {
    let share = joint(given)?.tangent_stiffness(pressure(given)?)?;
    Ok(Finding::Number(share * Interface::MODEL.area / (KGF / MM)))
}

/// The example of the text. La replaces its offset, in mm.
///
/// 150 mm off the middle of a table of 450 mm, with 50 kgf and Ks = 1e5 kgf/mm.
fn tilt(given: &CheckArguments) -> Result<Tilt, CheckError> {
    let offset = given.number_or("La", Tilt::EXAMPLE.offset / MM)? * MM;
    Ok(Tilt { offset, ..Tilt::EXAMPLE })
}

/// dZ of eq 3-4 in um.
///
/// dZ = 9 La FA / (2 Ks LT). Claim 4-007: 0.75 um.
fn pitch(given: &CheckArguments) -> Result<Finding, CheckError> {
    Ok(Finding::Number(tilt(given)?.pitch()? / UM))
}

/// Checks that the angle of eq 2-4 is the one whose tangent is 2 dZ / LT.
///
/// Claim 4-005, to 1e-9.
fn pitch_agrees(given: &CheckArguments) -> Result<Finding, CheckError> {
    let tilt = tilt(given)?;
    let (direct, drawn) = (tilt.pitch_angle()?, 2.0 * tilt.pitch()? / tilt.length);
    let found = format!("{direct:.4e} rad both ways");
    Ok(Finding::truth((direct.tan() / drawn - 1.0).abs() < 1e-9, found))
}

/// The factor in place of 9 for an interface of uniform stiffness. The moment of its pressure, summed over `slices`
/// slices, balances the offset force.
///
/// The tilt is La FA / (sum of y^2 Ks / slices), with y from -LT/2 to LT/2. The factor tends to 12. Claim 4-008: the 9
/// of the text assumes that the deflection under the resultant of the pressure is on a straight line through the
/// middle.
fn tilt_factor(given: &CheckArguments) -> Result<Finding, CheckError> {
    let slices = given.number("slices")? as usize;
    let position = |slice: usize| (slice as f64 + 0.5) / slices as f64 - 0.5;
    // Moment per angle, in units of Ks LT^2.
    let moment: f64 = (0..slices).map(|slice| position(slice).powi(2) / slices as f64).sum();
    Ok(Finding::Number(1.0 / moment))
}

/// Checks that a push through the middle causes neither pitch nor yaw, for a clearance Yc of the gib strip in mm.
///
/// `La` is 0 in the claim. Without an offset no force takes up the clearance. Claim 4-010.a.
fn straight_push(given: &CheckArguments) -> Result<Finding, CheckError> {
    let tilt = tilt(given)?;
    let (pitch, yaw) = (tilt.pitch()? / UM, tilt.yaw(given.number("Yc")? * MM)? / UM);
    Ok(Finding::truth(pitch == 0.0 && yaw == 0.0, format!("pitch {pitch} um, yaw {yaw} um")))
}

/// Checks that an angle of yaw by `dY / (2 LT)` (eq 5-4), or by `2 dY / LT` (Fig 4.5), displaces the edge at LT/2 by
/// dY.
///
/// Arguments: `Yc` in mm and `by`. Claims 4-011.a and b: only the second form turns the table about its middle.
fn yaw_angle(given: &CheckArguments) -> Result<Finding, CheckError> {
    let tilt = tilt(given)?;
    let edge = tilt.yaw(given.number("Yc")? * MM)?;
    let shares = [("dY/(2LT)", edge / (2.0 * tilt.length)), ("2dY/LT", 2.0 * edge / tilt.length)];
    let angle = given.choice("by", &shares)?.atan();
    let displacement = angle.tan() * tilt.length / 2.0;
    let found = format!("the edge moves by {:.3} dY", displacement / edge);
    Ok(Finding::truth((displacement / edge - 1.0).abs() < 1e-9, found))
}
