//! Random test values at which no amplifier is overloaded.

use std::collections::BTreeMap;

use patchcord_core::circuit::Circuit;
use patchcord_core::ir::{Program, ProgramPoint, Register};

use super::handles::timed_states;
use super::test_point::{TestError, fixed_reason, initial};
use super::wired::Wired;
use crate::operating_point::{
    Numbers, OVERLOAD, has_switches, is_in_range, largest_demand, settled_point, state_limits,
};

/// Largest voltage of random test values, and of the amplifiers at them, if possible.
const LARGEST: f64 = 80.0;
/// Largest voltage of the smallest random numbers: sets are not scaled down further.
const SMALLEST: f64 = 0.1;
/// Sets of random values that are tried.
const ATTEMPTS: usize = 40;
/// Smallest factor by which a set is scaled down at once.
const SMALLEST_FACTOR: f64 = 0.3;

/// The machine at random values. The first set is taken at which nothing overloads and all squaring networks and
/// logarithms are within their range, otherwise the first one at which nothing overloads. If there is none, the states
/// and drives differ from the initial condition by the smallest numbers.
///
/// # Errors
/// If no set has voltages.
pub(super) fn random<'a>(
    circuit: &'a Circuit,
    program: &'a Program,
    seed: u64,
) -> Result<Wired<'a>, TestError> {
    let start = initial(circuit, program)?;
    let search = Search::new(&start);
    let mut numbers = Numbers::new(seed);
    let sets: Vec<Shares> = (0..ATTEMPTS).map(|_| search.shares(&mut numbers)).collect();
    let mut first = None;
    for shares in &sets {
        for wired in
            [Centre::Zero, Centre::Initial].into_iter().filter_map(|from| search.scaled(shares, from))
        {
            if is_in_range(program, &wired.voltages) {
                return Ok(wired);
            }
            first.get_or_insert(wired);
        }
    }
    let overloaded = || sets.iter().find_map(|shares| search.at(shares, Centre::Initial, SMALLEST));
    let none = || TestError::NoVoltages(format!("none of {ATTEMPTS} random sets has any"));
    first.or_else(overloaded).ok_or_else(none)
}

/// What random numbers are added to.
#[derive(Debug, Clone, Copy)]
enum Centre {
    /// 0 V.
    Zero,
    /// The voltages of the initial condition.
    Initial,
}

/// Random numbers from -1 to 1 for every state and drive.
struct Shares {
    /// `None` for a state that follows the time, which is 0.
    states: Vec<Option<f64>>,
    drives: Vec<f64>,
}

/// A search for random values.
struct Search<'s, 'a> {
    /// The machine in initial condition.
    start: &'s Wired<'a>,
    /// The lower and the upper limit of every state in volts.
    limits: Vec<[f64; 2]>,
    /// The drives that get random values.
    drives: &'s [Register],
    /// For every state, whether it follows the time.
    is_timed: Vec<bool>,
    /// Whether modes must settle.
    has_switches: bool,
}

impl<'s, 'a> Search<'s, 'a> {
    /// A search that begins at the initial condition.
    fn new(start: &'s Wired<'a>) -> Self {
        let program = start.program;
        let drives = if fixed_reason(start).is_none() { program.drive_registers() } else { &[] };
        let limits = state_limits(program, &start.point);
        let is_timed = timed_states(start.circuit, program);
        Search { start, limits, drives, is_timed, has_switches: has_switches(program) }
    }

    /// The next random numbers.
    fn shares(&self, numbers: &mut Numbers) -> Shares {
        let states = self.is_timed.iter().map(|is_timed| (!is_timed).then(|| numbers.share())).collect();
        Shares { states, drives: self.drives.iter().map(|_| numbers.share()).collect() }
    }

    /// The machine at voltages of these shares, scaled down until no amplifier exceeds the largest voltage. If this does
    /// not succeed, the largest ones at which no amplifier is overloaded. `None` if there are none.
    fn scaled(&self, shares: &Shares, centre: Centre) -> Option<Wired<'a>> {
        let (mut size, mut second) = (LARGEST, None);
        while size >= SMALLEST {
            let wired = self.at(shares, centre, size);
            let demand = |wired: &Wired<'_>| largest_demand(wired.program, &wired.voltages);
            let largest = wired.as_ref().map_or(f64::INFINITY, demand);
            if largest <= LARGEST * (1.0 + 1e-9) {
                return wired;
            }
            if largest <= OVERLOAD && second.is_none() {
                second = wired;
            }
            size *= (0.95 * LARGEST / largest).max(SMALLEST_FACTOR);
        }
        second
    }

    /// The machine at voltages that differ from a centre by these shares of a size, within the limits of the states.
    fn at(&self, shares: &Shares, centre: Centre, size: f64) -> Option<Wired<'a>> {
        let start = self.start;
        let volts = |of_centre: f64, share: f64| match centre {
            Centre::Zero => share * size,
            Centre::Initial => of_centre + share * size,
        };
        let states = start.point.states.iter().zip(&shares.states).zip(&self.limits);
        let states = states
            .map(|((first, share), [low, high])| {
                share.map_or(*first, |share| volts(*first, share)).max(*low).min(*high)
            })
            .collect::<Vec<f64>>();
        let drives = self.drives.iter().zip(&shares.drives);
        let given: BTreeMap<Register, f64> =
            drives.map(|(drive, share)| (*drive, volts(start.volts(*drive), *share))).collect();
        let point = if self.has_switches {
            settled_point(start.program, &states).ok()?
        } else {
            ProgramPoint { states, ..start.point.clone() }
        };
        start.at(point, given)
    }
}
