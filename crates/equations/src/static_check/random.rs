//! Random test values at which no amplifier is overloaded.

use std::collections::BTreeMap;

use patchcord_core::circuit::Circuit;
use patchcord_core::ir::{Program, Register};

use super::handles::timed_states;
use super::test_point::{TestError, fixed_reason, initial, wired_at};
use super::wired::Wired;
use crate::operating_point::{Numbers, is_in_range, largest_demand, settled_point, state_limits};

/// Largest voltage of random test values, and of the amplifiers at them, if possible.
const LARGEST: f64 = 80.0;
/// Sets of random values that are tried.
const ATTEMPTS: usize = 40;
/// Times that a set is scaled down.
const SCALINGS: usize = 20;
/// Smallest factor by which a set is scaled down at once.
const SMALLEST_FACTOR: f64 = 0.3;

/// The machine at random values. The first set is taken at which all squaring networks and logarithms are within their
/// range, otherwise the first one that has voltages.
///
/// # Errors
/// If no set has voltages.
pub(super) fn random<'a>(
    circuit: &'a Circuit,
    program: &'a Program,
    seed: u64,
) -> Result<Wired<'a>, TestError> {
    let start = initial(circuit, program)?;
    let drives = if fixed_reason(&start).is_none() { program.drive_registers() } else { &[] };
    let is_timed = timed_states(circuit, program);
    let mut numbers = Numbers::new(seed);
    let mut first = None;
    for _ in 0..ATTEMPTS {
        let shares = Shares {
            states: is_timed.iter().map(|is_timed| (!is_timed).then(|| numbers.share())).collect(),
            drives: drives.iter().map(|register| (*register, numbers.share())).collect(),
        };
        if let Some(wired) = scaled(&start, &shares) {
            if is_in_range(program, &wired.voltages) {
                return Ok(wired);
            }
            first.get_or_insert(wired);
        }
    }
    first.ok_or_else(|| TestError::NoVoltages(format!("none of {ATTEMPTS} random sets has any")))
}

/// Random numbers from -1 to 1 for every state and drive.
struct Shares {
    /// `None` for a state that follows the time, which is 0.
    states: Vec<Option<f64>>,
    drives: Vec<(Register, f64)>,
}

/// The machine at voltages of these shares, scaled down until no amplifier exceeds the largest voltage. Outputs that are
/// larger even if all shares are 0 stay so. `None` if there are no voltages.
fn scaled<'a>(start: &Wired<'a>, shares: &Shares) -> Option<Wired<'a>> {
    let demand = |wired: &Wired<'_>| largest_demand(wired.program, &wired.voltages);
    let least = at_size(start, shares, 0.0).map_or(LARGEST, |wired| demand(&wired).max(LARGEST));
    let permitted = least * (1.0 + 1e-9);
    let mut size = LARGEST;
    for _ in 0..SCALINGS {
        let wired = at_size(start, shares, size);
        let largest = wired.as_ref().map_or(f64::INFINITY, demand);
        if largest <= permitted {
            return wired;
        }
        size *= (0.95 * permitted / largest).max(SMALLEST_FACTOR);
    }
    at_size(start, shares, size)
}

/// The machine at voltages of these shares of a size, within the limits of the states.
fn at_size<'a>(start: &Wired<'a>, shares: &Shares, size: f64) -> Option<Wired<'a>> {
    let limits = state_limits(start.program, &start.point);
    let states = shares.states.iter().zip(&start.point.states).zip(limits);
    let states = states
        .map(|((share, first), [low, high])| share.map_or(*first, |share| share * size).max(low).min(high));
    let states: Vec<f64> = states.collect();
    let given: BTreeMap<Register, f64> =
        shares.drives.iter().map(|(register, share)| (*register, share * size)).collect();
    let point = settled_point(start.program, &states).ok()?;
    wired_at(start.circuit, start.program, point, given).ok()
}
