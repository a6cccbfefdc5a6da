//! Nakashima's arrangement does what the thesis says: it sticks and slips, and slides steadily where friction still falls.

use crate::known::runs::difference;
use crate::others::bench::{BRAKE, Even, FRICTION, NAKASHIMA, record, shipped};

/// Set velocities of the page's table, in m/s.
pub const SET: [f64; 9] = [0.5e-3, 1e-3, 2e-3, 4e-3, 6e-3, 7e-3, 8e-3, 9e-3, 10e-3];

/// The output velocity of both circuits for 2 s at a set velocity.
fn both(changes: [&[(&str, f64)]; 2], command: f64) -> [Vec<f64>; 2] {
    let set = [changes[0], &[("v_set", command)]].concat();
    let commanded = [changes[1], &[("v_start", command), ("v_rate", 0.0)]].concat();
    [(NAKASHIMA, set), (BRAKE, commanded)]
        .map(|(stem, changes)| record(&shipped(stem), &changes, 2.0, &["v_o"]).values("v_o").unwrap())
}

/// As long as nothing pulls the table back: the relays would hold it.
#[test]
fn relays_hold_and_release_as_a_brake_does() {
    let mut whole = 0;
    for command in SET {
        let [relays, brake] = both([&[], &FRICTION], command);
        let back = brake.iter().position(|velocity| *velocity < 0.0).unwrap_or(brake.len());
        let off = difference(&relays[..back], &brake[..back]);
        assert!(back > 100 && off < 1e-8, "{off:e} up to row {back} at {command} m/s");
        whole += usize::from(back == brake.len());
    }
    assert_eq!(whole, 4, "commands up to 4 mm/s pull nothing back");
}

#[test]
fn it_sticks_and_slips_at_a_low_set_velocity() {
    for command in SET.into_iter().filter(|command| *command < 7.2e-3) {
        let even = Even::set(&shipped(NAKASHIMA), &[], command);
        assert!(even.stands() > 0.02 && even.least() == 0.0 && even.most() > 2.0 * command, "{command}");
    }
}

/// Friction on steady sliding falls with velocity as long as its slope -2 Fs (VcL - v) / VcL^2 outweighs f.
fn falls(command: f64) -> bool {
    let [(_, solid), (_, vcl)] = FRICTION;
    2.0 * solid * (vcl - command) / (vcl * vcl) > 10.7e3
}

#[test]
fn it_slides_steadily_where_friction_still_falls() {
    for command in [8e-3, 9e-3, 10e-3] {
        assert!(falls(command));
        let even = Even::set(&shipped(NAKASHIMA), &[], command);
        assert!(even.stands() == 0.0 && even.dies_away(0.6), "{command}");
    }
    assert!(!falls(12e-3));
}

/// Where friction has been forgotten, the spring throws the table back: the relays hold it all the same.
#[test]
fn what_stands_is_held_whatever_pulls_it_back() {
    let [relays, brake] = both([&[("VcL", 2.54e-3)], &[FRICTION[0], ("VcL", 2.54e-3)]], 1e-3);
    let least = |velocity: &[f64]| velocity.iter().copied().fold(f64::MAX, f64::min);
    assert_eq!(least(&relays), 0.0);
    assert!(least(&brake) < -1e-3, "{}", least(&brake));
}
