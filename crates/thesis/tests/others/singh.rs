//! Singh's arrangement keeps up no oscillation at any setting, and is right on critical velocities nevertheless.

use crate::known::others::slip;
use crate::others::bench::{SINGH, record, shipped};
use patchcord_thesis::slideway::history::Slip;

const VISCOUS: f64 = 10.7e3;

/// Settings of the grid: what friction falls with velocity as a share of f, what it drops by in N, drive velocities in m/s.
pub const FALLING: [f64; 6] = [0.0, 0.3, 0.6, 0.9, 1.2, 2.0];
const DROPS: [f64; 4] = [50.0, 150.0, 300.0, 600.0];
const DRIVES: [f64; 4] = [0.5e-3, 1e-3, 2e-3, 4e-3];

/// A velocity in m/s that is nothing beside that of any drive.
const NOTHING: f64 = 1e-12;

/// How a run goes on: the largest departures from the drive velocity in every tenth of 4 s, and when an amplifier is
/// overloaded.
pub struct Swing {
    pub tenths: Vec<f64>,
    pub overloaded: Option<f64>,
}

pub fn swing(falling: f64, drop: f64, drive: f64) -> Swing {
    let changes = [("n", falling * VISCOUS), ("Fk", 100.0), ("drop", drop), ("v_set", drive)];
    let trace = record(&shipped(SINGH), &changes, 4.0, &["v_o"]);
    let velocity = trace.values("v_o").unwrap();
    let largest = |part: &[f64]| part.iter().fold(0.0, |swing: f64, v| swing.max((v - drive).abs()));
    Swing {
        tenths: velocity[1..].chunks(4000).map(largest).collect(),
        overloaded: trace.overloads().map(|overload| overload.time).reduce(f64::min),
    }
}

impl Swing {
    pub fn dies_away(&self) -> bool {
        let ceases = |pair: &[f64]| pair[1] < 0.75 * pair[0] || pair[0] < NOTHING;
        self.overloaded.is_none() && self.tenths.windows(2).all(ceases)
    }

    pub fn grows_into_overload(&self) -> bool {
        let before = self.overloaded.map_or(0, |time| (time / 0.4) as usize);
        self.overloaded.is_some() && self.tenths[..before].windows(2).all(|pair| pair[1] > pair[0])
    }
}

/// All settings of the grid with so much fall of friction.
pub fn grid(falling: f64) -> Vec<Swing> {
    DROPS.into_iter().flat_map(|drop| DRIVES.map(|drive| swing(falling, drop, drive))).collect()
}

#[test]
#[ignore = "takes several seconds"]
fn no_oscillation_lasts_at_any_setting() {
    for falling in FALLING {
        for swing in grid(falling) {
            let goes = if falling < 1.0 { swing.dies_away() } else { swing.grows_into_overload() };
            assert!(goes, "n = {falling} f: {:?}, overloaded {:?}", swing.tenths, swing.overloaded);
        }
    }
}

/// The reason: it is linear, so that no size of swing is its own.
#[test]
fn twice_the_drop_at_twice_the_drive_is_twice_the_motion() {
    let [once, twice] = [1.0, 2.0].map(|times| {
        let changes = [("drop", 150.0 * times), ("v_set", 1e-3 * times)];
        record(&shipped(SINGH), &changes, 0.5, &["v_o"]).values("v_o").unwrap()
    });
    let off = once.iter().zip(&twice).map(|(once, twice)| (2.0 * once - twice).abs());
    assert!(off.fold(0.0, f64::max) < 1e-14);
}

/// Nothing holds the table: after the slip it goes backward at low drives, where it would stick.
#[test]
fn it_goes_through_standstill() {
    let velocity = record(&shipped(SINGH), &[], 0.03, &["v_o"]).values("v_o").unwrap();
    assert!(velocity.into_iter().fold(0.0, f64::min) < -1e-3);
}

/// The drive at which the first slip of the circuit just ends at standstill, in m/s, by what friction falls with.
pub fn critical(falling: f64) -> f64 {
    let dips_below = |drive: f64| {
        let changes = [("n", falling), ("v_set", drive)];
        let velocity = record(&shipped(SINGH), &changes, 0.03, &["v_o"]).values("v_o").unwrap();
        velocity.into_iter().fold(f64::MAX, f64::min) < -1e-12
    };
    let (mut low, mut high) = (1e-3, 10e-3);
    for _ in 0..20 {
        let middle = 0.5 * (low + high);
        if dips_below(middle) { low = middle } else { high = middle }
    }
    high
}

/// The same by Derjaguin, Push and Tolstoi.
pub fn by_theory(falling: f64) -> Slip {
    let (mass, stiffness) = (433.0, 45e6);
    let damping = (VISCOUS - falling) / (2.0 * f64::sqrt(mass * stiffness));
    Slip { drop: 300.0, mass, stiffness, damping }
}

#[test]
fn its_critical_velocities_are_those_of_the_theory() {
    for falling in [0.0, 2.5e3, 5e3, 8e3] {
        let (found, expected) = (critical(falling), by_theory(falling).critical_velocity().unwrap());
        assert!((found / expected - 1.0).abs() < 1e-3, "{found} against {expected}");
        // Two ways to write eq 18.2 are one.
        let slipped = |time: f64| slip(falling, 300.0, found, time);
        assert!((slipped(0.01) - by_theory(falling).velocity(found, 0.01).unwrap()).abs() < 1e-15);
    }
}
