//! Random test values at which no amplifier is overloaded.

use std::collections::BTreeMap;

use patchcord_core::circuit::Circuit;
use patchcord_core::ir::{Op, Program, Register};

use super::test_point::{TestError, fixed_reason, initial, limits, settled, wired_at};
use super::wired::Wired;
use crate::derive::ranged;

/// Largest voltage of random test values, and of the amplifiers at them, if possible.
const LARGEST: f64 = 80.0;
/// Smallest share of a random voltage in the largest one, so that no term is lost.
const SMALLEST_SHARE: f64 = 0.2;
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
    let mut numbers = Numbers(seed);
    let mut first = None;
    for _ in 0..ATTEMPTS {
        let shares = Shares {
            states: program.state_laws().iter().map(|_| numbers.share()).collect(),
            drives: drives.iter().map(|register| (*register, numbers.share())).collect(),
        };
        if let Some(wired) = scaled(&start, &shares) {
            if is_in_range(&wired) {
                return Ok(wired);
            }
            first.get_or_insert(wired);
        }
    }
    first.ok_or_else(|| TestError::NoVoltages(format!("none of {ATTEMPTS} random sets has any")))
}

/// Random numbers from -1 to 1 for every state and drive.
struct Shares {
    states: Vec<f64>,
    drives: Vec<(Register, f64)>,
}

/// The machine at voltages of these shares, scaled down until no amplifier exceeds the largest voltage. Outputs that are
/// larger even if all shares are 0 stay so. `None` if there are no voltages.
fn scaled<'a>(start: &Wired<'a>, shares: &Shares) -> Option<Wired<'a>> {
    let least = at_size(start, shares, 0.0).map_or(LARGEST, |wired| largest_voltage(&wired).max(LARGEST));
    let permitted = least * (1.0 + 1e-9);
    let mut size = LARGEST;
    for _ in 0..SCALINGS {
        let wired = at_size(start, shares, size);
        let largest = wired.as_ref().map_or(f64::INFINITY, largest_voltage);
        if largest <= permitted {
            return wired;
        }
        size *= (0.95 * permitted / largest).max(SMALLEST_FACTOR);
    }
    at_size(start, shares, size)
}

/// The machine at voltages of these shares of a size, within the limits of the states.
fn at_size<'a>(start: &Wired<'a>, shares: &Shares, size: f64) -> Option<Wired<'a>> {
    let limits = limits(start.program, &start.point);
    let states = shares.states.iter().zip(limits);
    let states: Vec<f64> = states.map(|(share, [low, high])| (share * size).max(low).min(high)).collect();
    let given: BTreeMap<Register, f64> =
        shares.drives.iter().map(|(register, share)| (*register, share * size)).collect();
    let point = settled(start.program, &states).ok()?;
    wired_at(start.circuit, start.program, point, given).ok()
}

/// The largest voltage that an amplifier demands. Infinite if one is not a number.
fn largest_voltage(wired: &Wired<'_>) -> f64 {
    let demands = wired.program.lamps().iter().map(|lamp| wired.volts(lamp.demand).abs());
    let is_larger =
        |largest: f64, volts: f64| if volts > largest || volts.is_nan() { volts } else { largest };
    let largest = demands.fold(0.0, is_larger);
    if largest.is_nan() { f64::INFINITY } else { largest }
}

/// Whether the inputs of all squaring networks and logarithms are within their range.
fn is_in_range(wired: &Wired<'_>) -> bool {
    ranged(wired.program.body()).into_iter().all(|register| match wired.program.body()[register.index()] {
        Op::Maximum(input, least) => wired.volts(input) >= wired.volts(least) - 1e-9,
        _ => true,
    })
}

/// Random numbers: splitmix64 of Steele, Lea and Flood, "Fast splittable pseudorandom number generators", 2014.
struct Numbers(u64);

impl Numbers {
    /// The next number from -1 to 1, with at least the smallest share.
    fn share(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut mixed = self.0;
        mixed = (mixed ^ (mixed >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        mixed = (mixed ^ (mixed >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        mixed ^= mixed >> 31;
        let size = (mixed >> 12) as f64 / (1u64 << 52) as f64;
        let share = SMALLEST_SHARE + (1.0 - SMALLEST_SHARE) * size;
        if mixed & 1 == 0 { share } else { -share }
    }
}
