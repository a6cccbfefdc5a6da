//! Kinks: the operations of the body at which a voltage has a corner as a function of the states or of time.
//!
//! An integration method loses its order if a step reaches across a kink of a rate. So the solver ends steps there. A
//! kink of a guard changes only the search for the time of an event.

use super::Program;
use super::op::{Op, Register};

/// An operation whose result has a corner.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Kink {
    /// Index of the element whose law contains it.
    pub element: usize,
    surface: Surface,
}

/// The quantity whose zero is the corner.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Surface {
    /// A voltage.
    Of(Register),
    /// The difference of two voltages.
    Between(Register, Register),
    /// The distance of a voltage from each point of a table.
    Points { table: u32, at: Register },
}

/// A kink that a voltage has crossed within a step, in one direction.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct KinkCrossing {
    surface: Surface,
    /// Abscissa of the first corner that was crossed in a table; otherwise 0.
    corner: f64,
    /// Whether the voltage rises through the corner.
    pub is_rising: bool,
}

/// A voltage within this distance of a kink, in volts, counts as on it. It is about the rounding of a voltage near 100
/// V after some hundred operations.
pub(crate) const KINK_TOLERANCE: f64 = 1e-11;

impl Kink {
    /// The quantity that has a corner at 0 or, for a table, at each of its abscissas.
    pub(crate) fn value(&self, registers: &[f64]) -> f64 {
        self.surface.value(registers)
    }

    /// Whether a value is on a corner, apart from rounding.
    pub(crate) fn is_on_corner(&self, tables: &[Vec<[f64; 2]>], value: f64) -> bool {
        match self.surface {
            Surface::Points { table, .. } => {
                let next = next_corner(&tables[table as usize], value - 3.0 * KINK_TOLERANCE, true);
                next.is_some_and(|corner| (corner - value).abs() <= KINK_TOLERANCE)
            }
            _ => value.abs() <= KINK_TOLERANCE,
        }
    }

    /// The first corner between two values. `None` if there is none or if one of the values is on it.
    pub(crate) fn crossed(&self, tables: &[Vec<[f64; 2]>], from: f64, to: f64) -> Option<KinkCrossing> {
        let is_rising = to > from;
        let corner = match self.surface {
            Surface::Points { table, .. } => next_corner(&tables[table as usize], from, is_rising)?,
            _ => 0.0,
        };
        let crossing = KinkCrossing { surface: self.surface, corner, is_rising };
        (crossing.past(from) < -KINK_TOLERANCE && crossing.past(to) > KINK_TOLERANCE).then_some(crossing)
    }
}

impl KinkCrossing {
    /// The distance past the corner, in the direction of crossing; negative before it.
    pub(crate) fn value(&self, registers: &[f64]) -> f64 {
        self.past(self.surface.value(registers))
    }

    /// The distance of a value past the corner, in the direction of crossing.
    fn past(&self, value: f64) -> f64 {
        if self.is_rising { value - self.corner } else { self.corner - value }
    }
}

impl Surface {
    /// The surface of an operation; `None` if the operation has no corner.
    fn of(op: Op) -> Option<Surface> {
        match op {
            Op::Absolute(a) => Some(Surface::Of(a)),
            Op::Minimum(a, b) | Op::Maximum(a, b) => Some(Surface::Between(a, b)),
            Op::Select { left, right, .. } => Some(Surface::Between(left, right)),
            Op::Table(table, at) => Some(Surface::Points { table, at }),
            _ => None,
        }
    }

    /// The quantity at these voltages.
    fn value(self, registers: &[f64]) -> f64 {
        match self {
            Surface::Of(a) | Surface::Points { at: a, .. } => registers[a.index()],
            Surface::Between(a, b) => registers[a.index()] - registers[b.index()],
        }
    }

    /// Whether the quantity varies within a step.
    fn is_varying(self, varying: &[bool]) -> bool {
        match self {
            Surface::Of(a) | Surface::Points { at: a, .. } => varying[a.index()],
            Surface::Between(a, b) => varying[a.index()] || varying[b.index()],
        }
    }
}

/// The next abscissa of a table above or below a value.
fn next_corner(points: &[[f64; 2]], from: f64, is_rising: bool) -> Option<f64> {
    let point = if is_rising {
        points.get(points.partition_point(|point| point[0] <= from + KINK_TOLERANCE))
    } else {
        points[..points.partition_point(|point| point[0] < from - KINK_TOLERANCE)].last()
    };
    point.map(|point| point[0])
}

impl Program {
    /// The registers of all guards.
    pub(super) fn guards(&self) -> impl Iterator<Item = Register> + '_ {
        let transitions = self.lowered.modes.iter().flat_map(|mode| &mode.transitions);
        transitions.map(|transition| transition.guard.register)
    }

    /// The registers that are stored at the ends of steps: inputs of delay lines, and what is sampled or followed by
    /// sampled values.
    pub(super) fn sampled_inputs(&self) -> impl Iterator<Item = Register> + '_ {
        let delayed = self.lowered.delays.iter().map(|delay| delay.input);
        let sampled = self.lowered.sampled.iter();
        delayed.chain(sampled.flat_map(|sampled| [sampled.next].into_iter().chain(sampled.follows)))
    }

    /// Finds two lists of kinks: those that affect a rate, a sampled value or a delay line's input, and those that
    /// affect guards only. `owners` has the element of every operation.
    pub(crate) fn find_kinks(&self, owners: &[usize]) -> [Vec<Kink>; 2] {
        let varying = self.varying();
        let rates = self.lowered.states.iter().map(|state| state.rate);
        let affects_run = self.needed_for(rates.chain(self.sampled_inputs()));
        let affects_guard = self.needed_for(self.guards());
        let kinks_at = |is_wanted: &dyn Fn(usize) -> bool| {
            let kinks = self.lowered.body.iter().enumerate().filter_map(|(at, op)| {
                let surface =
                    Surface::of(*op).filter(|surface| is_wanted(at) && surface.is_varying(&varying))?;
                Some(Kink { element: owners[at], surface })
            });
            kinks.collect()
        };
        [kinks_at(&|at| affects_run[at]), kinks_at(&|at| affects_guard[at] && !affects_run[at])]
    }
}
