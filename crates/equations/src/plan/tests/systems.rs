//! The plans of all problems satisfy the equations.

use std::collections::BTreeMap;
use std::path::Path;

use patchcord_core::circuit::Circuit;
use patchcord_core::ir::Program;
use patchcord_core::patch::Problem;
use patchcord_core::solve::Machine;
use serde_json::Value;

use super::evaluation::{Evaluator, Names, difference};
use super::{circuit, count};
use crate::graph::{NodeId, Operation, Plan};
use crate::plan::constants::Constants;
use crate::plan::plan;
use crate::testing::problem_files::{problem_files, reference};

/// Largest difference of the sides of an equation, as a share of their size.
const TOLERANCE: f64 = 1e-12;
/// Largest difference of an algebraic quantity from its reference, as a share of its peak.
const REFERENCE_TOLERANCE: f64 = 1e-9;
/// Inputs of switches that are smaller than this may be on the other side.
const SWITCH_TOLERANCE: f64 = 1e-9;

/// A problem with its plan and the values of its quantities at some times, in SI units.
struct System {
    name: String,
    problem: Problem,
    circuit: Circuit,
    plan: Plan,
    rows: Vec<BTreeMap<String, f64>>,
    /// The times of the rows in seconds.
    times: Vec<f64>,
    peaks: BTreeMap<String, f64>,
    /// The values of the drives at the start.
    drives: BTreeMap<String, f64>,
}

impl System {
    /// Reads a problem and its reference.
    fn read(path: &Path) -> System {
        let name = path.display().to_string();
        let problem = Problem::read(path).unwrap_or_else(|error| panic!("{error}"));
        let circuit = circuit(&problem);
        let plan = plan(&problem, &circuit).unwrap_or_else(|findings| panic!("{name}: {findings:#?}"));
        let reference = reference(path);
        let in_si =
            |quantity: &str, value: &Value| problem.quantities[quantity].unit.to_si(value.as_f64().unwrap());
        let quantities = reference["quantities"].as_object().unwrap();
        let row = |index: usize| -> BTreeMap<String, f64> {
            let value =
                |(name, entry): (&String, &Value)| (name.clone(), in_si(name, &entry["values"][index]));
            quantities.iter().map(value).collect()
        };
        let times: Vec<f64> =
            reference["times"].as_array().unwrap().iter().map(|time| time.as_f64().unwrap()).collect();
        let rows: Vec<_> = (0..times.len()).map(row).collect();
        let peaks = quantities.iter().map(|(name, entry)| (name.clone(), in_si(name, &entry["peak"])));
        let peaks = peaks.collect();
        let drives = drive_values(&circuit);
        System { name, problem, circuit, plan, rows, times, peaks, drives }
    }

    /// A state between two rows.
    fn state(&self, [first, second]: [usize; 2], share: f64) -> BTreeMap<String, f64> {
        let [first, second] = [first, second].map(|index| &self.rows[index % self.rows.len()]);
        first.iter().map(|(name, value)| (name.clone(), value + share * (second[name] - value))).collect()
    }

    /// The values of all nodes at a state. Each drive differs from its value at the start by a share of its unit. The time
    /// is this share too.
    fn values(&self, state: &BTreeMap<String, f64>, share: f64) -> (Evaluator<'_>, Vec<f64>) {
        let quantity_of = |node: NodeId| self.plan.quantities.iter().find(|planned| planned.node == node);
        let given = self.plan.ids().filter_map(|node| match &self.plan.node(node).operation {
            Operation::Integral { .. } => {
                Some((node, quantity_of(node).map_or(share, |planned| state[&planned.name])))
            }
            Operation::Drive(name) => {
                let unit = &self.problem.patch.scales[name].unit;
                Some((node, self.drives[name] + unit.to_si(0.3 * share)))
            }
            _ => None,
        });
        let (plan, problem) = (&self.plan, &self.problem);
        let given = given.collect();
        let evaluator = Evaluator { plan, problem, constants: Constants::new(&self.circuit), given };
        let values = evaluator.values();
        (evaluator, values)
    }

    /// The values of all names of the equations.
    fn names(&self, evaluator: &Evaluator<'_>, nodes: &[f64]) -> Names<'_> {
        let mut values = BTreeMap::new();
        for planned in &self.plan.quantities {
            values.insert(planned.name.clone(), nodes[planned.node.0 as usize]);
            if let Operation::Integral { rate, .. } = &self.plan.node(planned.node).operation {
                values.insert(format!("{}'", planned.name), evaluator.sum(rate, nodes));
            }
        }
        for (node, value) in self.plan.nodes.iter().zip(nodes) {
            if let Operation::Drive(name) = &node.operation {
                values.insert(name.clone(), *value);
            }
            if node.name == "t" {
                values.insert("t".to_owned(), *value);
            }
        }
        Names { circuit: &self.circuit, problem: &self.problem, values }
    }
}

/// The values of all drives of a circuit in initial condition, in SI units.
fn drive_values(circuit: &Circuit) -> BTreeMap<String, f64> {
    let program = Program::new(circuit).unwrap();
    let machine = Machine::new(&program, 1e-3).unwrap();
    let value = |name: &String| {
        let point = circuit.signals().iter().find(|point| point.name == *name)?;
        let scale = point.scale?;
        let per_volt = circuit.derived_unit(scale).to_si(circuit.per_volt(scale)?);
        Some((name.clone(), per_volt * machine.voltage(name).ok()?))
    };
    circuit.patch().drives.keys().filter_map(value).collect()
}

#[test]
fn the_nodes_satisfy_the_equations_at_many_states() {
    let mut compared = 0;
    for path in problem_files() {
        let system = System::read(&path);
        for index in 0..system.rows.len() {
            let share = (index as f64 * 0.618).fract();
            let state = system.state([index, 3 * index + 1], share);
            let (evaluator, values) = system.values(&state, share);
            let names = system.names(&evaluator, &values);
            for placed in system.circuit.equations() {
                let Some(found) = difference(&placed.value, &names) else {
                    assert!(placed.value.text().contains("delay("), "{}: {}", system.name, placed.value);
                    continue;
                };
                let at = format!("{}: {} differs by {found:e} at row {index}", system.name, placed.value);
                assert!(found <= TOLERANCE, "{at}");
                compared += 1;
            }
        }
    }
    assert!(compared > 1500, "{compared}");
}

#[test]
fn algebraic_quantities_have_the_values_of_scipy() {
    let mut compared = 0;
    for path in problem_files() {
        let system = System::read(&path);
        let has_input =
            |operation: &Operation| matches!(operation, Operation::Drive(_) | Operation::Delay { .. });
        if count(&system.plan, has_input) > 0 {
            continue;
        }
        for (index, row) in system.rows.iter().enumerate() {
            let (_, values) = system.values(row, system.times[index]);
            let is_at_switch = system.plan.nodes.iter().any(|node| match &node.operation {
                Operation::Switch { input, .. } => values[input.0 as usize].abs() < SWITCH_TOLERANCE,
                _ => false,
            });
            if is_at_switch {
                continue;
            }
            for planned in &system.plan.quantities {
                let Some(expected) = row.get(&planned.name) else { continue };
                let found = values[planned.node.0 as usize];
                let at =
                    format!("{}: {} is {found}, not {expected}, at row {index}", system.name, planned.name);
                assert!(
                    (found - expected).abs() <= REFERENCE_TOLERANCE * system.peaks[&planned.name],
                    "{at}"
                );
                compared += usize::from(!matches!(
                    system.plan.node(planned.node).operation,
                    Operation::Integral { .. }
                ));
            }
        }
    }
    assert!(compared > 200, "{compared}");
}

#[test]
fn delays_begin_with_the_value_at_the_start() {
    for (name, quantity, initial) in [("dead-time-process", "measured", 0.0), ("mackey-glass", "past", 0.5)] {
        let plan = super::planned_system(name);
        let node = plan.node(super::node_of(&plan, quantity));
        let Operation::Delay { initial: found, .. } = &node.operation else {
            panic!("{quantity} is a delay")
        };
        assert_eq!(*found, crate::symbolic::Fraction::number(initial), "{name}");
    }
}
