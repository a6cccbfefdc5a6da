//! The scaled equations are true: with exact numbers, each gives the voltage that its operation has, whatever the scales
//! are.

mod physical;
mod voltages;

use std::path::Path;

use patchcord_core::circuit::Circuit;
use patchcord_core::low_discrepancy::golden_place;
use patchcord_core::patch::Problem;
use patchcord_expr::Equation;

use super::ScaledEquations;
use crate::graph::{ConstantValues, NodeId, Operation, Plan};
use crate::peaks::{Ranges, ranges};
use crate::plan::plan;
use crate::synthesis::{ScaleOptions, Scales, choose_scales};
use crate::testing::problem_files::{problem_file, problem_files};
use physical::{Computed, Physical};
use voltages::Voltages;

/// Largest error of an equation, as a share of the sum of its terms.
const TOLERANCE: f64 = 1e-12;
/// Number of points at which each equation is evaluated.
const POINTS: u64 = 10;
/// Number of sets of scales: the chosen ones, and others at random.
const SETS: u64 = 4;

/// A problem with its plan and the ranges of its nodes.
struct System {
    problem: Problem,
    circuit: Circuit,
    plan: Plan,
    ranges: Ranges,
}

impl System {
    fn read(path: &Path) -> Self {
        let problem = Problem::read(path).unwrap_or_else(|error| panic!("{error}"));
        let circuit = Circuit::new(&problem.patch).unwrap_or_else(|report| panic!("{report}"));
        let plan = plan(&problem, &circuit).unwrap_or_else(|faults| panic!("{faults:?}"));
        let ranges = ranges(&plan, &problem, &circuit).unwrap_or_else(|fault| panic!("{fault:?}"));
        System { problem, circuit, plan, ranges }
    }

    /// The scales that are chosen, and for other sets, these times random factors from 0.1 to 10. The scale of the
    /// reference voltage is fixed.
    fn scales(&self, set: u64) -> Scales {
        let options = ScaleOptions::default();
        let mut scales = choose_scales(&self.plan, &self.problem, &self.circuit, &self.ranges, &options);
        if set > 0 {
            let first = 1000 * set;
            let is_reference = |index: usize| {
                self.plan.nodes.get(index).is_some_and(|node| node.operation == Operation::One)
            };
            for (index, per_volt) in scales.per_volt.iter_mut().enumerate() {
                if !is_reference(index) {
                    *per_volt *= 10f64.powf(2.0 * golden_place(first + index as u64) - 1.0);
                }
            }
            scales.time_scale *= 0.3 * set as f64;
        }
        scales
    }

    /// Random values of all nodes in SI units, within their ranges. A node that is always 0 has up to 20 V.
    fn values(&self, scales: &Scales, point: u64) -> Vec<f64> {
        let first = 1 + point * self.plan.nodes.len() as u64;
        let value = |(index, [low, high]): (usize, &[f64; 2])| {
            let place = golden_place(first + index as u64);
            match (low == high, *low == 0.0) {
                (true, true) => 20.0 * (2.0 * place - 1.0) * scales.per_volt[index],
                (true, false) => low * (0.5 + place),
                (false, _) => low + place * (high - low),
            }
        };
        self.ranges.nodes.iter().enumerate().map(value).collect()
    }

    /// Compares the equations of all named nodes with their operations.
    fn assert_equations_are_true(&self, name: &str, scales: &Scales) {
        let constants = ConstantValues::new(&self.plan.symbols, &self.circuit);
        let System { problem, plan, .. } = self;
        let Scales { per_volt, time_scale, .. } = scales;
        let equations = ScaledEquations::new(plan, problem, per_volt, *time_scale, &constants);
        let named: Vec<NodeId> = plan.ids().filter(|id| equations.is_named[id.0 as usize]).collect();
        let mut compared = vec![0; plan.nodes.len()];
        for point in 0..POINTS {
            let values = self.values(scales, point);
            let voltages = Voltages::new(plan, problem, per_volt, *time_scale, &values);
            let is_named = &equations.is_named;
            let physical = Physical { plan, problem, constants: &constants, is_named, values: &values };
            for id in &named {
                let Computed { value, size } = expected(&equations, &physical, *id);
                if !(value.is_finite() && size.is_finite()) {
                    continue;
                }
                compared[id.0 as usize] += 1;
                let found = voltages.value(&equations.equation(*id).right);
                let text = equations.text(&plan.node(*id).name, *id);
                let is_true = (found - value).abs() <= TOLERANCE * size;
                assert!(is_true, "{name}: {text}: {found} instead of {value} at {values:?}");
            }
        }
        for id in named {
            assert!(compared[id.0 as usize] > 0, "{name}: {} has no value", plan.node(id).name);
        }
    }
}

/// What the right side of the equation of a node must be.
fn expected(equations: &ScaledEquations<'_>, physical: &Physical<'_>, id: NodeId) -> Computed {
    let scale = equations.per_volt[id.0 as usize];
    match &equations.plan.node(id).operation {
        Operation::Integral { rate, .. } => physical.sum(rate).over(scale * equations.time_scale),
        // The largest term has the factor 1.
        Operation::Zero(sum) => {
            let terms = sum.terms.iter();
            let weights = terms.map(|(node, coefficient)| {
                equations.constants.value(coefficient).abs() * equations.per_volt[node.0 as usize]
            });
            physical.sum(sum).over(weights.fold(0.0, f64::max))
        }
        operation => physical.operation(operation).over(scale),
    }
}

#[test]
fn every_scaled_equation_is_true_whatever_the_scales_are() {
    for path in problem_files() {
        let system = System::read(&path);
        for set in 0..SETS {
            system.assert_equations_are_true(&path.display().to_string(), &system.scales(set));
        }
    }
}

/// An equation with other names of its voltages, which the language of equations permits.
fn with_plain_names(text: &str) -> String {
    let mut parts = text.split('[');
    let mut plain = parts.next().unwrap_or_default().to_owned();
    for (index, part) in parts.enumerate() {
        let (_, rest) = part.split_once(']').unwrap_or_else(|| panic!("{text}"));
        plain += &format!("v{index}{rest}");
    }
    plain
}

#[test]
fn the_texts_are_equations() {
    for path in problem_files() {
        let System { problem, circuit, plan, ranges } = System::read(&path);
        let scales = choose_scales(&plan, &problem, &circuit, &ranges, &ScaleOptions::default());
        let constants = ConstantValues::new(&plan.symbols, &circuit);
        let equations =
            ScaledEquations::new(&plan, &problem, &scales.per_volt, scales.time_scale, &constants);
        let quantities = plan.quantities.iter().map(|quantity| (quantity.name.as_str(), quantity.node));
        for (name, id) in quantities {
            let text = equations.text(name, id);
            assert!(!text.contains("inf") && !text.contains("NaN"), "{text}");
            // The language of equations has no values by condition and no numbers with units.
            if !text.contains('{') && problem.tables.is_empty() {
                let plain = with_plain_names(&text);
                Equation::parse(&plain, &[]).unwrap_or_else(|error| panic!("{text}: {error}"));
            }
        }
    }
}

/// The scaled equation of a quantity of a problem of the tests.
fn equation(problem: &str, quantity: &str) -> String {
    let System { problem, circuit, plan, ranges } = System::read(&problem_file(problem));
    let scales = choose_scales(&plan, &problem, &circuit, &ranges, &ScaleOptions::default());
    let constants = ConstantValues::new(&plan.symbols, &circuit);
    let equations = ScaledEquations::new(&plan, &problem, &scales.per_volt, scales.time_scale, &constants);
    let planned = plan.quantities.iter().find(|planned| planned.name == quantity).unwrap();
    equations.text(quantity, planned.node)
}

#[test]
fn values_by_condition_are_in_braces() {
    let expected = "[torque] = 1.2 {66.67 if -2.327 + 1.164 [error] >= 0; 0 otherwise} \
                    - 1.2 {66.67 if -1.745 - 0.8727 [error] >= 0; 0 otherwise}";
    assert_eq!(equation("contactor-servo", "torque"), expected);
}

#[test]
fn a_delay_is_in_machine_seconds() {
    assert_eq!(equation("dead-time-process", "measured"), "[measured] = delay([y], 0.08 s)");
}
