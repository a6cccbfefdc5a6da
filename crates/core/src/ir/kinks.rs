//! Kinks: where the body compares voltages that move within a step, so that a rate turns a corner.

use super::Program;
use super::op::{Op, Register};

/// A place in the body where the curve of a voltage has a corner.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Kink {
    /// Whose law it stands in.
    pub element: usize,
    surface: Surface,
}

/// What has a corner where it passes 0.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Surface {
    /// A voltage.
    Of(Register),
    /// The difference of two voltages.
    Between(Register, Register),
    /// The distance of a voltage from each point of a table.
    Points { table: u32, at: Register },
}

/// A kink that lies between two instants.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Crossing {
    surface: Surface,
    /// Of a table: the abscissa of the first corner on the way; else 0.
    place: f64,
    rises: bool,
}

/// Voltages nearer to a kink than this, in volts, stand on it.
pub(crate) const ON_THE_KINK: f64 = 1e-11;

impl Kink {
    /// What has its corner where it passes 0, or a point of a table.
    pub fn value(&self, registers: &[f64]) -> f64 {
        self.surface.value(registers)
    }

    /// The corner that is passed on the way from one value to another, neither of which stands on it.
    pub fn crossed(&self, tables: &[Vec<[f64; 2]>], from: f64, to: f64) -> Option<Crossing> {
        let rises = to > from;
        let place = match self.surface {
            Surface::Points { table, .. } => next_corner(&tables[table as usize], from, rises)?,
            _ => 0.0,
        };
        let crossing = Crossing { surface: self.surface, place, rises };
        (crossing.past(from) < -ON_THE_KINK && crossing.past(to) > ON_THE_KINK).then_some(crossing)
    }
}

impl Crossing {
    /// How far past the corner voltages are; negative before it.
    pub fn excess(&self, registers: &[f64]) -> f64 {
        self.past(self.surface.value(registers))
    }

    fn past(&self, value: f64) -> f64 {
        if self.rises { value - self.place } else { self.place - value }
    }
}

impl Surface {
    fn of(op: Op) -> Option<Surface> {
        match op {
            Op::Absolute(a) => Some(Surface::Of(a)),
            Op::Minimum(a, b) | Op::Maximum(a, b) => Some(Surface::Between(a, b)),
            Op::Select { left, right, .. } => Some(Surface::Between(left, right)),
            Op::Table(table, at) => Some(Surface::Points { table, at }),
            _ => None,
        }
    }

    fn value(self, registers: &[f64]) -> f64 {
        match self {
            Surface::Of(a) | Surface::Points { at: a, .. } => registers[a.index()],
            Surface::Between(a, b) => registers[a.index()] - registers[b.index()],
        }
    }

    fn moves(self, moving: &[bool]) -> bool {
        match self {
            Surface::Of(a) | Surface::Points { at: a, .. } => moving[a.index()],
            Surface::Between(a, b) => moving[a.index()] || moving[b.index()],
        }
    }
}

/// The abscissa of the next point above or below a place.
fn next_corner(points: &[[f64; 2]], from: f64, rises: bool) -> Option<f64> {
    let point = if rises {
        points.get(points.partition_point(|point| point[0] <= from + ON_THE_KINK))
    } else {
        points[..points.partition_point(|point| point[0] < from - ON_THE_KINK)].last()
    };
    point.map(|point| point[0])
}

impl Program {
    /// The kinks that the rates, and what is kept or delayed, have, and those that guards alone have; `owners` tells whose
    /// law each operation is.
    pub(crate) fn find_kinks(&self, owners: &[usize]) -> [Vec<Kink>; 2] {
        let moving = self.moving(|op| matches!(op, Op::State(_) | Op::Time | Op::Delayed(_) | Op::Tear(_)));
        let rates = self.states.iter().map(|state| state.rate);
        let inputs = self.delays.iter().map(|delay| delay.input);
        let run = self.needed_for(rates.chain(inputs).chain(self.kept.iter().map(|kept| kept.next)));
        let transitions = self.modes.iter().flat_map(|mode| &mode.transitions);
        let switch = self.needed_for(transitions.map(|transition| transition.guard.register));
        let those = |wanted: &dyn Fn(usize) -> bool| {
            let kinks = self.body.iter().enumerate().filter_map(|(at, op)| {
                let surface = Surface::of(*op).filter(|surface| wanted(at) && surface.moves(&moving))?;
                Some(Kink { element: owners[at], surface })
            });
            kinks.collect()
        };
        [those(&|at| run[at]), those(&|at| switch[at] && !run[at])]
    }
}
