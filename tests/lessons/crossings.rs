//! Helper of the lesson tests: runs a machine until a voltage rises through 0.

use crate::common::root;
use patchcord::solve::Machine;

/// Runs the machine until a reading rises through 0, leaves it at that time, and returns the time.
pub(super) fn next_rise<'p>(machine: &mut Machine<'p>, reading: impl Fn(&Machine<'p>) -> f64) -> f64 {
    let step = machine.step();
    for _ in 0..1_000_000 {
        let before = machine.clone();
        machine.operate(step).unwrap_or_else(|error| panic!("{error}"));
        if reading(&before) < 0.0 && reading(machine) >= 0.0 {
            let after = |length: f64| {
                let mut machine = before.clone();
                machine.operate(length).unwrap_or_else(|error| panic!("{error}"));
                machine
            };
            *machine = after(root(|length| reading(&after(length)), 0.0, step));
            return machine.time();
        }
    }
    panic!("the reading never rises through 0")
}
