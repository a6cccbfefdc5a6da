//! A quick numerical test of equations at one point, before the exact comparison.
//!
//! Derivatives are central differences along the flow, so the test has a tolerance. It passes every change that mends an
//! equation and refuses nearly all others, at a small part of the cost of an exact comparison.

use std::collections::HashMap;

use patchcord_core::circuit::Circuit;
use patchcord_core::ir::{Program, ProgramPoint, Register};
use patchcord_expr::{Dimension, Equation, Expression, Scope, split_primes};

/// Deviation of the two sides of an equation, as a share of the larger one, up to which it passes.
const TOLERANCE: f64 = 1e-3;
/// Equations with higher derivatives are not tested.
const MAX_ORDER: usize = 2;
/// Voltages of the states at the point: at most this size. The first one without an overload is taken.
const SIZES: [f64; 5] = [60.0, 15.0, 4.0, 1.0, 0.1];
/// Share of the size by which states move in a difference.
const SHARE: f64 = 1e-4;

/// The equations of a circuit at one point.
pub(super) struct Screen<'a> {
    circuit: &'a Circuit,
    program: &'a Program,
    /// Register and value per volt of every signal and drive.
    signals: HashMap<&'a str, (Register, f64)>,
    /// The equations that define auxiliary quantities.
    auxiliaries: HashMap<&'a str, &'a Equation>,
    point: ProgramPoint,
    /// Size of the voltages at the point.
    size: f64,
}

impl<'a> Screen<'a> {
    /// A screen for a circuit. `None` if every point has an overload, or if modes other than limits act.
    pub(super) fn new(circuit: &'a Circuit, program: &'a Program) -> Option<Self> {
        if program.modes().iter().any(|mode| mode.names.mode != "limit") {
            return None;
        }
        let coefficients = program.coefficient_values();
        let signals = program.signals().iter().map(|signal| {
            let per_volt = signal.per_volt.map_or(1.0, |index| coefficients[index as usize]);
            (signal.name.as_str(), (signal.register, per_volt))
        });
        let names: Vec<&str> = circuit.auxiliary_quantities().collect();
        let auxiliaries =
            circuit.equations().iter().filter_map(|placed| match &placed.value.left().expression {
                Expression::Name(name) if names.contains(&name.as_str()) => {
                    Some((name.as_str(), &placed.value))
                }
                _ => None,
            });
        let (point, size) = SIZES.iter().find_map(|size| {
            let point = point(program, *size);
            let voltages = program.voltages_at(&point)?;
            let is_linear = program.lamps().iter().all(|lamp| voltages[lamp.demand.index()].abs() <= 100.0);
            is_linear.then_some((point, *size))
        })?;
        let (signals, auxiliaries) = (signals.collect(), auxiliaries.collect());
        Some(Screen { circuit, program, signals, auxiliaries, point, size })
    }

    /// Whether both sides of an equation are equal at the point, or cannot be evaluated.
    pub(super) fn passes(&self, equation: &Equation) -> bool {
        let at_start = self.program.initial_point();
        let point = if equation.initial_quantity().is_some() { &at_start } else { &self.point };
        let order = equation.names().iter().map(|name| split_primes(name).1).max();
        let has_zero =
            [equation.left(), equation.right()].iter().any(|side| side.expression == Expression::Number(0.0));
        // A side that is 0 has no size, and differences of a high order have no digits.
        if equation.initial_quantity().is_none() && (has_zero || order > Some(MAX_ORDER)) {
            return true;
        }
        match equation.evaluate(&At { screen: self, point }) {
            Ok([left, right]) => (left - right).abs() <= TOLERANCE * left.abs().max(right.abs()),
            Err(_) => true,
        }
    }

    /// A quantity with this number of derivatives at a point.
    fn quantity(&self, name: &str, order: usize, point: &ProgramPoint) -> Option<f64> {
        if order > 0 {
            let (after, before, length) = self.neighbours(point)?;
            let [after, before] = [after, before].map(|point| self.quantity(name, order - 1, &point));
            return Some((after? - before?) / (2.0 * length));
        }
        if let Some(equation) = self.auxiliaries.get(name) {
            let [_, right] = equation.evaluate(&At { screen: self, point }).ok()?;
            return Some(right);
        }
        let (register, per_volt) = self.signals.get(name)?;
        Some(per_volt * self.program.voltages_at(point)?[register.index()])
    }

    /// The points a short time after and before a point, and this time.
    fn neighbours(&self, point: &ProgramPoint) -> Option<(ProgramPoint, ProgramPoint, f64)> {
        let voltages = self.program.voltages_at(point)?;
        let rates: Vec<f64> =
            self.program.state_laws().iter().map(|state| voltages[state.demand.index()]).collect();
        let fastest = rates.iter().fold(self.size, |fastest, rate| fastest.max(rate.abs()));
        let length = SHARE * self.size / fastest;
        let moved = |time: f64| {
            let mut moved = point.clone();
            moved.time += time;
            moved.states.iter_mut().zip(&rates).for_each(|(state, rate)| *state += time * rate);
            moved
        };
        Some((moved(length), moved(-length), length))
    }
}

/// A point with fixed irregular voltages.
fn point(program: &Program, size: f64) -> ProgramPoint {
    let mut point = program.initial_point();
    let voltage = |index: usize| {
        size * (1.0 + (index as f64 * GOLDEN).fract()) / 2.0 * if index % 3 == 1 { -1.0 } else { 1.0 }
    };
    point.states.iter_mut().enumerate().for_each(|(index, state)| *state = voltage(index));
    point.delayed.iter_mut().enumerate().for_each(|(index, delayed)| *delayed = voltage(index + 7));
    point.sampled.iter_mut().enumerate().for_each(|(index, sampled)| *sampled = voltage(index + 11));
    point.time = 1.0;
    point
}

/// The golden ratio, whose multiples have irregular fractions.
const GOLDEN: f64 = 1.618_033_988_749_895;

/// The quantities of a screen at a point.
struct At<'a> {
    screen: &'a Screen<'a>,
    point: &'a ProgramPoint,
}

impl Scope for At<'_> {
    fn value(&self, name: &str) -> Option<f64> {
        if name == "t" {
            return Some(self.point.time);
        }
        if let Some(index) = self.screen.program.parameter(name) {
            return Some(self.screen.program.parameters()[index].value);
        }
        let (base, order) = split_primes(name);
        self.screen.quantity(base, order, self.point)
    }

    fn dimension(&self, name: &str) -> Option<Dimension> {
        self.screen.circuit.equation_dimension(name)
    }

    fn names(&self) -> Vec<&str> {
        Vec::new()
    }
}
