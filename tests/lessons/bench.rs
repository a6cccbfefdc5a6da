//! What the tests of lessons share: waiting for a voltage to pass 0.

use crate::common::root;
use patchcord::solve::Machine;

/// Runs on until a reading rises through 0, leaves the machine there, and tells the time.
pub fn next_rise<'p>(machine: &mut Machine<'p>, reading: impl Fn(&Machine<'p>) -> f64) -> f64 {
    let stretch = machine.step();
    for _ in 0..1_000_000 {
        let before = machine.clone();
        machine.operate(stretch).unwrap_or_else(|error| panic!("{error}"));
        if reading(&before) < 0.0 && reading(machine) >= 0.0 {
            let after = |length: f64| {
                let mut there = before.clone();
                there.operate(length).unwrap_or_else(|error| panic!("{error}"));
                there
            };
            *machine = after(root(|length| reading(&after(length)), 0.0, stretch));
            return machine.time();
        }
    }
    panic!("it never rises through 0")
}
