//! Thermostat: the on and off times of the heater.

use crate::common::{run_for, voltage};
use crate::known_problems::lessons::thermostat;
use crate::known_problems::runs::{program, step_of};
use crate::lessons::crossings::next_rise;
use patchcord::solve::Machine;

const STEM: &str = "lessons/relay-thermostat";

/// The time at which the heater first switches off, and the off and on times after that.
fn cycle(changes: &[(&str, f64)]) -> [f64; 3] {
    let program = program(STEM, changes);
    let mut machine = run_for(&program, step_of(STEM), 0.0);
    let is_on = |machine: &Machine<'_>| voltage(machine, "K1") - 50.0;
    let off = next_rise(&mut machine, |machine| -is_on(machine));
    let on = next_rise(&mut machine, is_on);
    let off_again = next_rise(&mut machine, |machine| -is_on(machine));
    [off, on - off, off_again - on]
}

#[test]
fn switching_times_match_the_exponentials() {
    for (h, power, set, width) in [(2.0, 100.0, 17.0, 4.0), (1.0, 250.0, 10.0, 1.0), (4.0, 100.0, 20.0, 0.1)]
    {
        let found = cycle(&[("h", h), ("P", power), ("T_set", set), ("width", width)]);
        let expected = thermostat(h, power, set - width / 2.0, set + width / 2.0);
        for (found, expected) in found.iter().zip(expected) {
            // Steps of 1/1000 of the time constant have an error of 1e-14 of it, like the location of switching.
            assert!((found - expected).abs() < 1e-8, "{found} s, not {expected} s");
        }
    }
}

#[test]
fn with_a_narrow_band_the_duty_cycle_matches_the_losses() {
    let [_, off, on] = cycle(&[("width", 0.1)]);
    let duty_cycle = on / (on + off);
    // h T / P = 0.34; the error is proportional to the square of the width of the band.
    assert!((duty_cycle - 0.34).abs() < 1e-5, "{duty_cycle}");
}
