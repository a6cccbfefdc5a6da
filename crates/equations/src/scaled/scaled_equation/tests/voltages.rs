//! The values of written equations between voltages.

use std::collections::BTreeMap;

use patchcord_core::patch::Problem;
use patchcord_expr::Unit;

use crate::graph::{Operation, Plan};
use crate::notation::{Comparison, Condition, Notation, Relation};
use crate::peaks::points_in_si;

/// The voltages of all nodes by their names.
pub(super) struct Voltages<'a> {
    /// The problem, for its tables.
    problem: &'a Problem,
    /// Machine seconds per problem second.
    time_scale: f64,
    /// The voltages. A name is in brackets.
    by_name: BTreeMap<String, f64>,
}

impl<'a> Voltages<'a> {
    /// The voltages of nodes with these values in SI units.
    pub(super) fn new(
        plan: &Plan,
        problem: &'a Problem,
        per_volt: &[f64],
        time_scale: f64,
        values: &[f64],
    ) -> Self {
        let entry = |(index, value): (usize, &f64)| {
            let node = &plan.nodes[index];
            let name = if let Operation::Drive(name) = &node.operation { name } else { &node.name };
            (format!("[{name}]"), value / per_volt[index])
        };
        Voltages { problem, time_scale, by_name: values.iter().enumerate().map(entry).collect() }
    }

    /// The value of an expression. Numbers with units are in SI units.
    pub(super) fn value(&self, notation: &Notation) -> f64 {
        match notation {
            Notation::Number { value, unit: None } => *value,
            Notation::Number { value, unit: Some(unit) } => Unit::parse(unit).unwrap().to_si(*value),
            Notation::Name { name, primes } => {
                assert_eq!(*primes, 0, "{name}");
                self.by_name[name]
            }
            Notation::Negative(operand) => -self.value(operand),
            Notation::Sum(terms) => terms.iter().map(|term| self.value(term)).sum(),
            Notation::Product(factors) => factors.iter().map(|factor| self.value(factor)).product(),
            Notation::Quotient(top, bottom) => self.value(top) / self.value(bottom),
            Notation::Power(base, exponent) => self.value(base).powf(self.value(exponent)),
            Notation::Call(name, arguments) => {
                let arguments: Vec<f64> = arguments.iter().map(|argument| self.value(argument)).collect();
                self.function(name, &arguments)
            }
            Notation::Cases(cases) => {
                let holds = |condition: &Option<Condition>| {
                    condition.as_ref().is_none_or(|condition| self.holds(condition))
                };
                let case = cases.iter().find(|(_, condition)| holds(condition));
                case.map_or(f64::NAN, |(value, _)| self.value(value))
            }
        }
    }

    /// Whether a condition holds.
    fn holds(&self, condition: &Condition) -> bool {
        condition.0.iter().all(|comparison| match comparison {
            Comparison::Compare { left, relation: Relation::AtLeast, right } => {
                self.value(left) >= self.value(right)
            }
            other => panic!("{other:?} is not expected"),
        })
    }

    /// The value of a function or a table.
    fn function(&self, name: &str, arguments: &[f64]) -> f64 {
        match (name, arguments) {
            ("abs", [a]) => a.abs(),
            ("sqrt", [a]) => a.sqrt(),
            ("sin", [a]) => a.sin(),
            ("cos", [a]) => a.cos(),
            ("exp", [a]) => a.exp(),
            ("ln", [a]) => a.ln(),
            ("min", [a, b]) => a.min(*b),
            ("max", [a, b]) => a.max(*b),
            ("limit", [a, low, high]) => a.max(*low).min(*high),
            ("dead_zone", [a, width]) => (a - width).max(0.0) + (a + width).min(0.0),
            // In these tests, the past of a value is the value times 1 + the delay in problem seconds.
            ("delay", [a, seconds]) => a * (1.0 + seconds / self.time_scale),
            (table, [a]) => curve(&points_in_si(&self.problem.tables[table]), *a),
            _ => panic!("{name} is no function"),
        }
    }
}

/// The value of straight lines through points, of which the outermost continue.
pub(super) fn curve(points: &[[f64; 2]], at: f64) -> f64 {
    let segment = points.windows(2).find(|pair| at <= pair[1][0]).unwrap_or(&points[points.len() - 2..]);
    let [[x, y], [next, ordinate]] = [segment[0], segment[1]];
    y + (ordinate - y) * (at - x) / (next - x)
}
