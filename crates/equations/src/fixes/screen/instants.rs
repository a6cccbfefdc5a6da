//! The points of a screen, and the instants near them.

use std::cell::{OnceCell, RefCell};
use std::collections::HashMap;

use patchcord_core::ir::ProgramPoint;

use crate::compare::GOLDEN;
use crate::fixes::netlist::{Conditions, Netlist, Order, Rewiring, Voltages};

/// The times of the points are multiples of this time in seconds.
const TIME: f64 = 0.737;
/// Share of the size by which states move in a difference. Second differences of slow quantities have three digits at
/// this share, even if a state is 1000 times faster.
const SHARE: f64 = 5e-4;

/// A wiring that is evaluated, and the conditions.
#[derive(Clone, Copy)]
pub(super) struct Setup<'s> {
    pub netlist: &'s Netlist,
    pub rewiring: &'s Rewiring,
    pub order: &'s Order,
    pub conditions: &'s Conditions,
    /// Whether drives have free values. Otherwise they follow from time.
    pub has_free_drives: bool,
}

/// A point with a value for everything that varies.
pub(super) struct Centre {
    /// The values at the point.
    point: ProgramPoint,
    /// The size of the voltages.
    size: f64,
    /// The outputs of free drives near the point, by element.
    drives: Vec<Parabola>,
    /// The outputs of the delay lines near the point.
    delayed: Vec<Parabola>,
}

/// A voltage as a function of time: value, rate and rate of the rate at time 0.
#[derive(Debug, Clone, Copy)]
struct Parabola([f64; 3]);

impl Parabola {
    /// A constant voltage.
    fn steady(voltage: f64) -> Self {
        Parabola([voltage, 0.0, 0.0])
    }

    /// The voltage at a time.
    fn at(self, time: f64) -> f64 {
        let Parabola([value, rate, curvature]) = self;
        value + time * (rate + time * curvature / 2.0)
    }
}

impl Centre {
    /// The point with this index: irregular voltages of this size. Drives change about as fast as the states of the
    /// given wiring.
    pub(super) fn new(setup: Setup<'_>, index: usize, size: f64) -> Self {
        let turn = (index + 1) as f64;
        let voltage = |place: usize| {
            let share = (turn * GOLDEN + place as f64 * GOLDEN * GOLDEN).fract();
            let sign = if (turn * GOLDEN * (place + 2) as f64).fract() < 0.5 { -1.0 } else { 1.0 };
            sign * size * (1.0 + share) / 2.0
        };
        let laws = &setup.conditions.laws;
        let mut point = laws.initial_point(&setup.conditions.coefficients);
        point.time = TIME * turn;
        point.states.iter_mut().enumerate().for_each(|(place, state)| *state = voltage(place));
        point.sampled.iter_mut().enumerate().for_each(|(place, sampled)| *sampled = voltage(place + 101));
        for (mode, value) in laws.modes().iter().zip(&mut point.modes) {
            // Both positions of a relay are possible, whatever its input is.
            if mode.names.mode == "position" {
                *value = ((index + mode.element) % 2) as f64;
            }
        }
        let drives = (0..setup.netlist.len()).map(|place| Parabola::steady(voltage(place + 201))).collect();
        let delayed = (0..point.delayed.len()).map(|place| Parabola::steady(voltage(place + 301))).collect();
        let mut centre = Centre { point, size, drives, delayed };
        let fastest = Instant::new(&centre, setup).map_or(size, |instant| instant.fastest());
        let pace = (fastest / size).sqrt();
        for Parabola([value, rate, curvature]) in centre.drives.iter_mut().chain(&mut centre.delayed) {
            *rate = -*value * pace;
            *curvature = -*rate * pace;
        }
        centre
    }

    /// The point at the start of a run.
    pub(super) fn at_start(conditions: &Conditions) -> Self {
        let point = conditions.laws.initial_point(&conditions.coefficients);
        let delayed = point.delayed.iter().map(|voltage| Parabola::steady(*voltage)).collect();
        Centre { point, size: 1.0, drives: Vec::new(), delayed }
    }

    /// Whether sources are constant between known instants, as noise and pulses.
    pub(super) fn has_levels(&self) -> bool {
        !self.point.levels.is_empty()
    }

    /// The point some time later, with these states, and the outputs of free drives there.
    fn moved(&self, time: f64, states: Vec<f64>) -> (ProgramPoint, Vec<f64>) {
        let delayed = self.delayed.iter().map(|parabola| parabola.at(time)).collect();
        let point = ProgramPoint { states, delayed, time: self.point.time + time, ..self.point.clone() };
        (point, self.drives.iter().map(|parabola| parabola.at(time)).collect())
    }
}

/// All voltages at an instant near a point.
pub(super) struct Instant<'s> {
    centre: &'s Centre,
    /// The time from the point.
    offset: f64,
    /// The time for laws of time.
    pub time: f64,
    /// The voltages of the states.
    states: Vec<f64>,
    /// All voltages and rates.
    pub voltages: Voltages,
    /// The number of differences in time between the point and this instant.
    pub differences: usize,
    /// The values of the auxiliary quantities that were computed so far.
    auxiliaries: RefCell<HashMap<&'s str, f64>>,
    /// The instants a short time after and before this one, computed when they are first needed.
    neighbours: OnceCell<Option<Box<[Instant<'s>; 2]>>>,
}

impl<'s> Instant<'s> {
    /// The instant of a point. `None` if a loop without an integrator cannot be solved.
    pub(super) fn new(centre: &'s Centre, setup: Setup<'_>) -> Option<Self> {
        Self::moved(centre, setup, (0.0, 0), centre.point.states.clone())
    }

    /// The instant of a point at which some states follow the time: they begin at their initial values and have the rates
    /// of the point. `follows_time` is empty if none does.
    pub(super) fn at_time(centre: &'s Centre, setup: Setup<'_>, follows_time: &[bool]) -> Option<Self> {
        let free = Self::new(centre, setup)?;
        if !follows_time.contains(&true) {
            return Some(free);
        }
        let start = setup.conditions.laws.initial_point(&setup.conditions.coefficients).states;
        let mut states = free.states.clone();
        for (index, state) in states.iter_mut().enumerate() {
            if follows_time[index] {
                *state = start[index] + free.voltages.rates[index] * free.time;
            }
        }
        Self::moved(centre, setup, (0.0, 0), states)
    }

    /// The instant some time after a point, at the end of this number of differences, with these states.
    fn moved(
        centre: &'s Centre,
        setup: Setup<'_>,
        (offset, differences): (f64, usize),
        states: Vec<f64>,
    ) -> Option<Self> {
        let (point, drives) = centre.moved(offset, states.clone());
        let drives = setup.has_free_drives.then_some(drives.as_slice());
        let wiring = (setup.rewiring, setup.order);
        let voltages = setup.netlist.voltages(setup.conditions, wiring, &point, drives)?;
        Some(Instant {
            centre,
            offset,
            time: point.time,
            states,
            voltages,
            differences,
            auxiliaries: RefCell::default(),
            neighbours: OnceCell::new(),
        })
    }

    /// The value of an auxiliary quantity. It is computed once, because many others may contain it.
    pub(super) fn auxiliary(&self, name: &'s str, compute: impl FnOnce() -> f64) -> f64 {
        let known = self.auxiliaries.borrow().get(name).copied();
        known.unwrap_or_else(|| {
            let value = compute();
            self.auxiliaries.borrow_mut().insert(name, value);
            value
        })
    }

    /// The largest rate of a state, at least the size of the point per second.
    fn fastest(&self) -> f64 {
        self.voltages.rates.iter().fold(self.centre.size, |fastest, rate| fastest.max(rate.abs()))
    }

    /// The instants a short time after and before this one.
    pub(super) fn neighbours(&self, setup: Setup<'_>) -> Option<&[Instant<'s>; 2]> {
        let neighbours = self.neighbours.get_or_init(|| {
            let length = SHARE * self.centre.size / self.fastest();
            let neighbour = |length: f64| {
                let pairs = self.states.iter().zip(&self.voltages.rates);
                let states = pairs.map(|(state, rate)| state + length * rate).collect();
                Self::moved(self.centre, setup, (self.offset + length, self.differences + 1), states)
            };
            Some(Box::new([neighbour(length)?, neighbour(-length)?]))
        });
        neighbours.as_deref()
    }

    /// The time from another instant to this one.
    pub(super) fn since(&self, other: &Instant<'_>) -> f64 {
        self.offset - other.offset
    }
}
