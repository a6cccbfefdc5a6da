//! States of a machine at which both sides of an equation have values: no amplifier overloads and all loops are solved.

use std::cell::Cell;
use std::collections::BTreeMap;

use patchcord_core::circuit::Circuit;
use patchcord_core::ir::{Program, ProgramPoint, Register};
use patchcord_core::solve::Machine;

use crate::compare::expansions::TimeLaws;
use crate::operating_point::{
    Numbers, OVERLOAD, has_switches, initial_point, is_in_range, largest_demand, settled_point, state_limits,
};

/// States that are tried near a motion from the initial condition, and as many in the whole range.
const PLACES: usize = 24;
/// States near the motion that are enough.
pub(super) const MIN_PLACES: usize = 8;
/// Instants of the motion, with the initial condition.
const INSTANTS: usize = 6;
/// Steps of the machine between two instants at most.
const STEPS: f64 = 20.0;
/// Distances from an instant of the motion in volts. The first one is taken at which nothing overloads.
const DISTANCES: [f64; 4] = [20.0, 4.0, 0.8, 0.1];
/// Distances from 0 V in the whole range.
const WIDE_DISTANCES: [f64; 5] = [80.0, 25.0, 8.0, 2.0, 0.5];

/// Searches without a result after which only the last distance is tried: a loop without a solution takes long.
const MAX_FAILURES: usize = 3;

/// A state of the machine with all voltages.
#[derive(Debug, Clone)]
pub(super) struct Place {
    /// The values of everything that lasts.
    pub point: ProgramPoint,
    /// The voltages of all registers.
    pub voltages: Vec<f64>,
    /// The instant of the motion from which it differs. `None` if it is anywhere in the range.
    pub instant: Option<usize>,
}

/// The points of a motion of the machine from its initial condition. Empty if it cannot be set to this condition.
///
/// The motion lasts until the fastest state would have changed by the size of the largest one, but it has 100 steps at
/// most.
pub(super) fn motion(circuit: &Circuit, program: &Program) -> Vec<ProgramPoint> {
    let Ok(start) = initial_point(program) else { return Vec::new() };
    let mut points = vec![start];
    let duration = time_of_change(program, &points[0]);
    let stated = circuit.run_plan().step.as_ref().map(|step| step.value);
    let instants = (INSTANTS - 1) as f64;
    let step = stated.unwrap_or(duration / (STEPS * instants));
    let Ok(mut machine) = Machine::new(program, step) else { return points };
    let interval = (duration / instants).min(STEPS * step);
    while points.len() < INSTANTS && machine.operate(interval).is_ok() {
        points.push(machine.point());
    }
    points
}

/// The time in seconds in which the fastest state changes by the size of the largest one. Infinite if nothing moves.
fn time_of_change(program: &Program, point: &ProgramPoint) -> f64 {
    let voltages = program.voltages_at(point).unwrap_or_default();
    let rates = program.state_laws().iter().filter_map(|state| voltages.get(state.demand.index()).copied());
    largest(point.states.iter().copied()).max(1.0) / largest(rates)
}

/// The largest size among numbers; 0 if there are none.
fn largest(numbers: impl Iterator<Item = f64>) -> f64 {
    numbers.fold(0.0, |largest: f64, number| largest.max(number.abs()))
}

/// States at which nothing overloads: the instants of a motion, others near them, and others in the whole range if there
/// are few of these. `ramps` is whether each state is a ramp. Drives and ramps have any voltages unless they follow their
/// laws of time.
pub(super) fn places(
    program: &Program,
    motion: &[ProgramPoint],
    ramps: &[bool],
    time_laws: TimeLaws,
) -> Vec<Place> {
    let Some(start) = motion.first() else { return Vec::new() };
    let has_switches = has_switches(program);
    let has_free_drives = !time_laws.drives && !has_switches;
    let is_timed = ramps.iter().map(|is_ramp| *is_ramp && time_laws.ramps).collect();
    let limits = motion.iter().map(|point| state_limits(program, point)).collect();
    let failures = Cell::new(0);
    let search = Search { program, motion, start, limits, has_switches, has_free_drives, is_timed, failures };
    let mut places: Vec<Place> = (0..PLACES).filter_map(|index| search.near_motion(index)).collect();
    if places.len() < MIN_PLACES {
        places.extend((0..PLACES).filter_map(|index| search.anywhere(index)));
    }
    places
}

/// A search for states.
struct Search<'a> {
    program: &'a Program,
    /// The points of the motion.
    motion: &'a [ProgramPoint],
    /// The first of them.
    start: &'a ProgramPoint,
    /// The limits of the states at each point of the motion.
    limits: Vec<Vec<[f64; 2]>>,
    /// Whether the machine has elements that switch.
    has_switches: bool,
    /// Whether the voltages of drives are free.
    has_free_drives: bool,
    /// Whether each state follows a law of time.
    is_timed: Vec<bool>,
    /// The number of searches without a result so far.
    failures: Cell<usize>,
}

impl Search<'_> {
    /// The place with this index: an instant of the motion, or a state near one. `None` if something overloads.
    fn near_motion(&self, index: usize) -> Option<Place> {
        let instant = index % self.motion.len();
        let from = &self.motion[instant];
        let (point, voltages) = if index < self.motion.len() {
            evaluated(self.program, from.clone(), BTreeMap::new())?
        } else {
            self.first_at(from, instant, index, &DISTANCES)?
        };
        Some(Place { point, voltages, instant: Some(instant) })
    }

    /// The place with this index in the whole range.
    fn anywhere(&self, index: usize) -> Option<Place> {
        let states = self.start.states.iter().zip(&self.is_timed);
        let states = states.map(|(volts, is_timed)| if *is_timed { *volts } else { 0.0 }).collect();
        let from = ProgramPoint { states, ..self.start.clone() };
        let (point, voltages) = self.first_at(&from, 0, PLACES + index, &WIDE_DISTANCES)?;
        Some(Place { point, voltages, instant: None })
    }

    /// The first point at one of these distances from another one at which nothing overloads, with all voltages. The
    /// direction depends on the seed. The limits of the states are those at an instant of the motion.
    fn first_at(
        &self,
        from: &ProgramPoint,
        instant: usize,
        seed: usize,
        distances: &[f64],
    ) -> Option<(ProgramPoint, Vec<f64>)> {
        let first = if self.failures.get() < MAX_FAILURES { 0 } else { distances.len() - 1 };
        let at = |distance: &f64| self.at(from, instant, &mut Numbers::new(seed as u64), *distance);
        let found = distances[first..].iter().find_map(at);
        self.failures.set(self.failures.get() + usize::from(found.is_none()));
        found
    }

    /// The point at a distance from another one in random directions, with all voltages. `None` if something overloads.
    fn at(
        &self,
        from: &ProgramPoint,
        instant: usize,
        numbers: &mut Numbers,
        distance: f64,
    ) -> Option<(ProgramPoint, Vec<f64>)> {
        let states = self.states_at(from, instant, numbers, distance);
        let mut point = if self.has_switches {
            settled_point(self.program, &states).ok()?
        } else {
            ProgramPoint { states, ..from.clone() }
        };
        point.delayed.iter_mut().for_each(|volts| *volts += distance * numbers.share());
        let drives = if self.has_free_drives { self.program.drive_registers() } else { &[] };
        let before = if drives.is_empty() { None } else { self.program.voltages_at(from) };
        let given = drives.iter().map(|drive| {
            let volts = before.as_ref().map_or(0.0, |voltages| voltages[drive.index()]);
            (*drive, volts + distance * numbers.share())
        });
        let given = given.collect();
        evaluated(self.program, point, given)
    }

    /// The voltages of the states at a distance from a point in random directions, within their limits. Those that follow a
    /// law of time are as at the point. If elements switch, the machine settles at t = 0, so they are as at the start.
    fn states_at(
        &self,
        from: &ProgramPoint,
        instant: usize,
        numbers: &mut Numbers,
        distance: f64,
    ) -> Vec<f64> {
        let timed = if self.has_switches { self.start } else { from };
        let states = from.states.iter().zip(&self.limits[instant]).enumerate();
        let moved = states.map(|(index, (volts, [low, high]))| {
            let volts_moved = (volts + distance * numbers.share()).max(*low).min(*high);
            if self.is_timed[index] { timed.states[index] } else { volts_moved }
        });
        moved.collect()
    }
}

/// A place that differs from another one in the voltage of one state. `None` if nothing can be compared there.
pub(super) fn with_state(program: &Program, place: &Place, state: usize, volts: f64) -> Option<Place> {
    let mut states = place.point.states.clone();
    states[state] = volts;
    let drives = program.drive_registers().iter().map(|drive| (*drive, place.voltages[drive.index()]));
    let (point, given) = if has_switches(program) {
        (settled_point(program, &states).ok()?, BTreeMap::new())
    } else {
        (ProgramPoint { states, ..place.point.clone() }, drives.collect())
    };
    let (point, voltages) = evaluated(program, point, given)?;
    Some(Place { point, voltages, instant: place.instant })
}

/// A point with all voltages. `None` if something overloads, a loop is not solved, or the input of a squaring network
/// or of a logarithm is outside its range.
fn evaluated(
    program: &Program,
    point: ProgramPoint,
    given: BTreeMap<Register, f64>,
) -> Option<(ProgramPoint, Vec<f64>)> {
    let voltages = program.unlimited_voltages_at(&point, &given)?;
    let is_usable = largest_demand(program, &voltages) <= OVERLOAD && is_in_range(program, &voltages);
    is_usable.then_some((point, voltages))
}
