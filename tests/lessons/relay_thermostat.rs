//! Thermostat: how long the heater is on and off.

use crate::common::{ran, voltage};
use crate::known::lessons::thermostat;
use crate::known::runs::{program, step_of};
use crate::lessons::bench::next_rise;
use patchcord::solve::Machine;

const STEM: &str = "lessons/relay-thermostat";

/// When the heater is first switched off, and how long it is off and on after that.
fn cycle(changes: &[(&str, f64)]) -> [f64; 3] {
    let program = program(STEM, changes);
    let mut machine = ran(&program, step_of(STEM), 0.0);
    let is_on = |machine: &Machine<'_>| voltage(machine, "K1") - 50.0;
    let off = next_rise(&mut machine, |machine| -is_on(machine));
    let on = next_rise(&mut machine, is_on);
    let off_again = next_rise(&mut machine, |machine| -is_on(machine));
    [off, on - off, off_again - on]
}

#[test]
fn it_switches_when_the_exponentials_say() {
    for (h, power, set, width) in [(2.0, 100.0, 17.0, 4.0), (1.0, 250.0, 10.0, 1.0), (4.0, 100.0, 20.0, 0.1)]
    {
        let found = cycle(&[("h", h), ("P", power), ("T_set", set), ("width", width)]);
        let expected = thermostat(h, power, set - width / 2.0, set + width / 2.0);
        for (found, expected) in found.iter().zip(expected) {
            // Steps of 1/1000 of the time constant are good to 1e-14 of it; switching is located as well.
            assert!((found - expected).abs() < 1e-8, "{found} s, not {expected} s");
        }
    }
}

#[test]
fn a_narrow_band_heats_for_the_share_of_time_that_the_losses_ask_for() {
    let [_, off, on] = cycle(&[("width", 0.1)]);
    let share = on / (on + off);
    // h T / P = 0.34; the rest goes with the square of the band's width.
    assert!((share - 0.34).abs() < 1e-5, "{share}");
}
