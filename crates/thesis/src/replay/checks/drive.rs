//! The drive and how it pushes the table (4.4).

use super::super::finding::Finding;
use super::super::given::Given;
use super::surfaces::{joint, pressure};
use super::{Check, CheckError};
use crate::slideway::design::Interface;
use crate::slideway::hydraulics::cylinder_stiffness;
use crate::slideway::measured::TABLE_9_2;
use crate::slideway::stability::DrivenTable;
use crate::slideway::tilt::{self, Tilt};
use crate::slideway::units::{KGF, MM, UM};

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

/// That 2 B A^2 / V is the force by the move that compresses one side and relaxes the other.
fn cylinder(_: &Given) -> Result<Finding, CheckError> {
    let (bulk, area, volume, small) = (1.7e9, 20e-4, 0.3e-3, 1e-9);
    let pressure = bulk * area * small / volume;
    let force = 2.0 * pressure * area;
    let stiffness = cylinder_stiffness(bulk, area, volume)?;
    let found = format!("{:.2} MN/m for 1.7 GPa, 20 cm2, 0.3 l", stiffness / 1e6);
    Ok(Finding::truth((force / small / stiffness - 1.0).abs() < 1e-9, found))
}

/// Whether the drives that the study simulates and measures have stiffnesses from `low` to `high` N/m.
fn drives_within(given: &Given) -> Result<Finding, CheckError> {
    let measured = TABLE_9_2.iter().map(|cell| cell.stiffness);
    let stiffnesses = measured.chain([DrivenTable::simulated(0.0).stiffness]);
    let (least, most) = stiffnesses
        .fold((f64::INFINITY, 0.0), |(least, most): (f64, f64), one| (least.min(one), most.max(one)));
    let holds = given.number("low")? <= least && most <= given.number("high")?;
    Ok(Finding::shape(holds, format!("{:.1} ... {:.1} MN/m", least / 1e6, most / 1e6)))
}

/// Z0 = W / Ks in um, for kgf, with the stiffness of the example.
fn sinking(given: &Given) -> Result<Finding, CheckError> {
    Ok(Finding::Number(tilt::sinking(given.number("W")? * KGF, Tilt::EXAMPLE.stiffness)? / UM))
}

/// Stiffness of chapter 7's joint under the model table, in kgf/mm.
fn interface_stiffness(given: &Given) -> Result<Finding, CheckError> {
    let share = joint(given)?.tangent_stiffness(pressure(given)?)?;
    Ok(Finding::Number(share * Interface::MODEL.area / (KGF / MM)))
}

/// The example of the text, with another offset where it is given, in mm.
fn tilt(given: &Given) -> Result<Tilt, CheckError> {
    let offset = given.number_or("La", Tilt::EXAMPLE.offset / MM)? * MM;
    Ok(Tilt { offset, ..Tilt::EXAMPLE })
}

/// dZ of eq 3-4 in um.
fn pitch(given: &Given) -> Result<Finding, CheckError> {
    Ok(Finding::Number(tilt(given)?.pitch()? / UM))
}

/// That the angle of eq 2-4 is the one whose tangent is 2 dZ / LT.
fn pitch_agrees(given: &Given) -> Result<Finding, CheckError> {
    let tilt = tilt(given)?;
    let (direct, drawn) = (tilt.pitch_angle()?, 2.0 * tilt.pitch()? / tilt.length);
    let found = format!("{direct:.4e} rad both ways");
    Ok(Finding::truth((direct.tan() / drawn - 1.0).abs() < 1e-9, found))
}

/// The factor in place of 9 for an interface of even stiffness: the moment of its pressure holds the offset force. By slices.
fn tilt_factor(given: &Given) -> Result<Finding, CheckError> {
    let slices = given.number("slices")? as usize;
    let place = |slice: usize| (slice as f64 + 0.5) / slices as f64 - 0.5;
    // Moment by angle, in units of Ks LT^2.
    let moment: f64 = (0..slices).map(|slice| place(slice).powi(2) / slices as f64).sum();
    Ok(Finding::Number(1.0 / moment))
}

/// That a push through the middle neither pitches nor yaws, with clearance of the gib strip in mm.
fn straight_push(given: &Given) -> Result<Finding, CheckError> {
    let tilt = tilt(given)?;
    let (pitch, yaw) = (tilt.pitch()? / UM, tilt.yaw(given.number("Yc")? * MM)? / UM);
    Ok(Finding::truth(pitch == 0.0 && yaw == 0.0, format!("pitch {pitch} um, yaw {yaw} um")))
}

/// That an angle of yaw by `dY / (2 LT)` (eq 5-4), or by `2 dY / LT` (Fig 4.5), moves the edge, LT/2 away, by dY.
fn yaw_angle(given: &Given) -> Result<Finding, CheckError> {
    let tilt = tilt(given)?;
    let edge = tilt.yaw(given.number("Yc")? * MM)?;
    let shares = [("dY/(2LT)", edge / (2.0 * tilt.length)), ("2dY/LT", 2.0 * edge / tilt.length)];
    let angle = given.word("by", &shares)?.atan();
    let moved = angle.tan() * tilt.length / 2.0;
    let found = format!("the edge moves by {:.3} of dY", moved / edge);
    Ok(Finding::truth((moved / edge - 1.0).abs() < 1e-9, found))
}
