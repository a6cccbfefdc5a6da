//! Singh's circuit maintains no oscillation at any setting. Its critical velocities are nevertheless correct.

use crate::known_problems::others::slip;
use crate::others::steady_run::{SINGH, record, shipped};
use patchcord_thesis::slideway::history::Slip;

/// Viscous friction f of the patch in N s/m.
const VISCOUS: f64 = 10.7e3;

/// Slopes of falling friction of the grid, as shares of f.
pub(super) const FALLING: [f64; 6] = [0.0, 0.3, 0.6, 0.9, 1.2, 2.0];
/// Drops of friction of the grid, in N.
const DROPS: [f64; 4] = [50.0, 150.0, 300.0, 600.0];
/// Drive velocities of the grid, in m/s.
const DRIVES: [f64; 4] = [0.5e-3, 1e-3, 2e-3, 4e-3];

/// A velocity in m/s that is negligible compared with that of any drive.
const NEGLIGIBLE: f64 = 1e-12;

/// The course of a run: the largest deviation from the drive velocity in every tenth of 4 s, and the time at which an
/// amplifier is overloaded.
pub(super) struct Swing {
    /// Largest deviations in m/s.
    pub tenths: Vec<f64>,
    /// Time of the first overload, in s.
    pub overloaded: Option<f64>,
}

/// The course of a run for a slope as a share of f, a drop in N and a drive velocity in m/s.
pub(super) fn swing(falling: f64, drop: f64, drive: f64) -> Swing {
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
    /// Whether the deviation falls by a quarter in every tenth.
    pub(super) fn decays(&self) -> bool {
        let is_decay = |pair: &[f64]| pair[1] < 0.75 * pair[0] || pair[0] < NEGLIGIBLE;
        self.overloaded.is_none() && self.tenths.windows(2).all(is_decay)
    }

    /// Whether the deviation grows until an amplifier is overloaded.
    pub(super) fn grows_into_overload(&self) -> bool {
        let before = self.overloaded.map_or(0, |time| (time / 0.4) as usize);
        self.overloaded.is_some() && self.tenths[..before].windows(2).all(|pair| pair[1] > pair[0])
    }
}

/// The runs of all settings of the grid with this slope of friction.
pub(super) fn grid(falling: f64) -> Vec<Swing> {
    DROPS.into_iter().flat_map(|drop| DRIVES.map(|drive| swing(falling, drop, drive))).collect()
}

#[test]
#[ignore = "takes several seconds"]
fn no_oscillation_lasts_at_any_setting() {
    for falling in FALLING {
        for swing in grid(falling) {
            let is_expected = if falling < 1.0 { swing.decays() } else { swing.grows_into_overload() };
            assert!(is_expected, "n = {falling} f: {:?}, overloaded {:?}", swing.tenths, swing.overloaded);
        }
    }
}

/// The reason is that the circuit is linear, so no amplitude is preferred.
#[test]
fn motion_is_proportional_to_drop_and_drive() {
    let [single, double] = [1.0, 2.0].map(|factor| {
        let changes = [("drop", 150.0 * factor), ("v_set", 1e-3 * factor)];
        record(&shipped(SINGH), &changes, 0.5, &["v_o"]).values("v_o").unwrap()
    });
    let differences = single.iter().zip(&double).map(|(single, double)| (2.0 * single - double).abs());
    assert!(differences.fold(0.0, f64::max) < 1e-14);
}

/// No friction holds the table. At low drives it moves backward after the slip, where a real table would stick.
#[test]
fn table_moves_through_standstill() {
    let velocity = record(&shipped(SINGH), &[], 0.03, &["v_o"]).values("v_o").unwrap();
    assert!(velocity.into_iter().fold(0.0, f64::min) < -1e-3);
}

/// The drive velocity in m/s at which the first slip of the circuit just ends at standstill, for a slope of friction
/// in N s/m.
pub(super) fn critical(falling: f64) -> f64 {
    let reverses = |drive: f64| {
        let changes = [("n", falling), ("v_set", drive)];
        let velocity = record(&shipped(SINGH), &changes, 0.03, &["v_o"]).values("v_o").unwrap();
        velocity.into_iter().fold(f64::MAX, f64::min) < -1e-12
    };
    let (mut low, mut high) = (1e-3, 10e-3);
    for _ in 0..20 {
        let middle = 0.5 * (low + high);
        if reverses(middle) { low = middle } else { high = middle }
    }
    high
}

/// The slip by the theory of Derjaguin, Push and Tolstoi, for a slope of friction in N s/m.
pub(super) fn by_theory(falling: f64) -> Slip {
    let (mass, stiffness) = (433.0, 45e6);
    let damping = (VISCOUS - falling) / (2.0 * f64::sqrt(mass * stiffness));
    Slip { drop: 300.0, mass, stiffness, damping }
}

#[test]
fn critical_velocities_agree_with_theory() {
    for falling in [0.0, 2.5e3, 5e3, 8e3] {
        let (found, expected) = (critical(falling), by_theory(falling).critical_velocity().unwrap());
        assert!((found / expected - 1.0).abs() < 1e-3, "got {found}, expected {expected}");
        // The two forms of eq 18.2 agree.
        let slipped = |time: f64| slip(falling, 300.0, found, time);
        assert!((slipped(0.01) - by_theory(falling).velocity(found, 0.01).unwrap()).abs() < 1e-15);
    }
}
