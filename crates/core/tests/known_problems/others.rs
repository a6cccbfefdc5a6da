//! Circuits of other authors that the thesis describes.

use super::slideway::{FrictionLaw, Slideway};
use super::thesis::{SLIDEWAY, fine_velocity};
use super::{Problem, Solution};

/// The problems in the order of docs/problems.md.
pub(crate) static PROBLEMS: [Problem; 2] = [
    Problem {
        name: "Nakashima",
        patch: "others/nakashima",
        solution: Solution::Integrated(|duration, every| {
            fine_velocity(&nakashima_slideway(1e-3), duration, every)
        }),
        max_error: 1e-10,
        ..SLIDEWAY
    },
    Problem {
        name: "Singh",
        patch: "others/singh",
        solution: Solution::ClosedForm(|time| slip(5e3, 300.0, 1e-3, time)),
        max_error: 5e-11,
        ..SLIDEWAY
    },
];

/// The slideway of Nakashima's patch at a constant drive velocity in m/s. Friction follows the velocity with a lag, and
/// at standstill it holds against every backward force.
pub(crate) fn nakashima_slideway(velocity: f64) -> Slideway {
    Slideway {
        brake: true,
        one_way: true,
        solid: 0.1815 * 433.0 * 9.80665,
        vcl: 12.7e-3,
        v_start: velocity,
        v_rate: 0.0,
        ..Slideway::thesis(FrictionLaw::LagBeforeSquare)
    }
}

/// Velocity of a slip in m/s (eq 18.2) on the slideway of Singh's patch. `falling` is the slope of friction in N s/m,
/// `drop` its drop at the start of the slip in N, and `drive` the drive velocity in m/s.
pub(crate) fn slip(falling: f64, drop: f64, drive: f64, time: f64) -> f64 {
    let (mass, stiffness, viscous) = (433.0f64, 45e6f64, 10.7e3);
    let impedance = (mass * stiffness).sqrt();
    let (damping, ratio) = ((viscous - falling) / (2.0 * impedance), drop / (drive * impedance));
    let root = (1.0 - damping * damping).sqrt();
    let angle = (stiffness / mass).sqrt() * root * time;
    let transient = angle.cos() + (damping - ratio) / root * angle.sin();
    drive * (1.0 - (-damping / root * angle).exp() * transient)
}
