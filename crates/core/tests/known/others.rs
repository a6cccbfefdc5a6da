//! The circuits of others that the thesis tells of.

use super::slideway::{Law, Slideway};
use super::thesis::{SLIDEWAY, finely};
use super::{Known, Problem};

pub static PROBLEMS: [Problem; 2] = [
    Problem {
        name: "Nakashima",
        patch: "others/nakashima",
        known: Known::Stepped(|duration, every| finely(&relayed(1e-3), duration, every)),
        within: 1e-10,
        ..SLIDEWAY
    },
    Problem {
        name: "Singh",
        patch: "others/singh",
        known: Known::Closed(|time| slip(5e3, 300.0, 1e-3, time)),
        within: 5e-11,
        ..SLIDEWAY
    },
];

/// The slideway of Nakashima's patch at a set velocity: friction that follows with a lag, and holds whatever pulls back.
pub fn relayed(velocity: f64) -> Slideway {
    Slideway {
        brake: true,
        one_way: true,
        solid: 0.1815 * 433.0 * 9.80665,
        vcl: 12.7e-3,
        v_start: velocity,
        v_rate: 0.0,
        ..Slideway::thesis(Law::Remembered)
    }
}

/// Velocity of a slip (eq 18.2) on the slideway of Singh's patch, by what friction falls with velocity, what it drops by, and the drive.
pub fn slip(falling: f64, drop: f64, drive: f64, time: f64) -> f64 {
    let (mass, stiffness, viscous) = (433.0f64, 45e6f64, 10.7e3);
    let impedance = (mass * stiffness).sqrt();
    let (damping, ratio) = ((viscous - falling) / (2.0 * impedance), drop / (drive * impedance));
    let root = (1.0 - damping * damping).sqrt();
    let angle = (stiffness / mass).sqrt() * root * time;
    let missing = angle.cos() + (damping - ratio) / root * angle.sin();
    drive * (1.0 - (-damping / root * angle).exp() * missing)
}
