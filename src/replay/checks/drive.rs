//! The drive and how it pushes the table (4.4).

use super::super::finding::Finding;
use super::super::given::Given;
use super::{Check, CheckError};
use crate::slideway::hydraulics::cylinder_stiffness;
use crate::slideway::tilt::{TILT_FACTOR, Tilt};
use crate::slideway::units::{KGF, MM, UM};

pub(super) const CHECKS: &[Check] = &[
    Check { name: "cylinder-stiffness", run: cylinder },
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

/// The example of the text, with another offset where it is given, in mm.
fn tilt(given: &Given) -> Result<Tilt, CheckError> {
    Ok(Tilt {
        offset: given.number_or("La", 150.0)? * MM,
        force: 50.0 * KGF,
        stiffness: 1e5 * KGF / MM,
        length: 450.0 * MM,
        factor: TILT_FACTOR,
    })
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
