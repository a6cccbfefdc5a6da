//! Nakashima's circuit behaves as the thesis says: it sticks and slips, and slides steadily while friction still falls.

use crate::known_problems::runs::difference;
use crate::others::steady_run::{BRAKE, FRICTION, NAKASHIMA, SteadyRun, record, shipped};
use crate::velocity_readings::min;

/// Set velocities of the page's table, in m/s.
pub(super) const SET: [f64; 9] = [0.5e-3, 1e-3, 2e-3, 4e-3, 6e-3, 7e-3, 8e-3, 9e-3, 10e-3];

/// The output velocity of both circuits for 2 s at a set velocity.
fn both(changes: [&[(&str, f64)]; 2], command: f64) -> [Vec<f64>; 2] {
    let set = [changes[0], &[("v_set", command)]].concat();
    let commanded = [changes[1], &[("v_start", command), ("v_rate", 0.0)]].concat();
    [(NAKASHIMA, set), (BRAKE, commanded)]
        .map(|(stem, changes)| record(&shipped(stem), &changes, 2.0, &["v_o"]).values("v_o").unwrap())
}

/// Holds as long as the spring does not pull the table back, because the relays would hold it.
#[test]
fn relays_hold_and_release_like_a_brake() {
    let mut unreversed = 0;
    for command in SET {
        let [relays, brake] = both([&[], &FRICTION], command);
        let back = brake.iter().position(|velocity| *velocity < 0.0).unwrap_or(brake.len());
        let error = difference(&relays[..back], &brake[..back]);
        assert!(back > 100 && error < 1e-8, "{error:e} up to row {back} at {command} m/s");
        unreversed += usize::from(back == brake.len());
    }
    assert_eq!(unreversed, 4, "commands up to 4 mm/s must not reverse the table");
}

#[test]
fn low_set_velocities_give_stick_slip() {
    for command in SET.into_iter().filter(|command| *command < 7.2e-3) {
        let run = SteadyRun::set(&shipped(NAKASHIMA), &[], command);
        assert!(run.rest_share() > 0.02 && run.min() == 0.0 && run.max() > 2.0 * command, "{command}");
    }
}

/// Whether friction in steady sliding falls with velocity: its slope 2 Fs (VcL - v) / VcL^2 exceeds f.
fn falls(command: f64) -> bool {
    let [(_, solid), (_, vcl)] = FRICTION;
    2.0 * solid * (vcl - command) / (vcl * vcl) > 10.7e3
}

#[test]
fn sliding_is_steady_while_friction_still_falls() {
    for command in [8e-3, 9e-3, 10e-3] {
        assert!(falls(command));
        let run = SteadyRun::set(&shipped(NAKASHIMA), &[], command);
        assert!(run.rest_share() == 0.0 && run.decays(0.6), "{command}");
    }
    assert!(!falls(12e-3));
}

/// If the lagging friction has decayed, the spring can throw the table back. The relays hold it nevertheless.
#[test]
fn relays_hold_the_table_against_the_spring() {
    let [relays, brake] = both([&[("VcL", 2.54e-3)], &[FRICTION[0], ("VcL", 2.54e-3)]], 1e-3);
    assert_eq!(min(&relays), 0.0);
    assert!(min(&brake) < -1e-3, "{}", min(&brake));
}
