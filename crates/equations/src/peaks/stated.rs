//! What a problem states about the nodes of its plan before the run.

use patchcord_core::circuit::Circuit;
use patchcord_core::patch::{Problem, ProblemQuantity};

use crate::compare::intended::fraction;
use crate::graph::{ConstantValues, Operation, Plan, PlannedQuantity};
use crate::symbolic::Fraction;

/// What is stated about each node, in SI units.
#[derive(Debug, Clone)]
pub(super) struct Stated {
    /// The magnitude that is expected; 0 if it is not stated.
    pub sizes: Vec<f64>,
    /// The value near which the solution of a loop is sought at the start. `None` if it is not stated.
    pub starts: Vec<Option<f64>>,
}

impl Stated {
    /// The maxima of the quantities of a problem, and the initial values of those that are no states.
    pub(super) fn of(plan: &Plan, problem: &Problem, circuit: &Circuit) -> Self {
        let maximum = |quantity: &ProblemQuantity| {
            quantity.maximum.as_ref().map(|maximum| quantity.unit.to_si(maximum.value))
        };
        Stated::with_sizes(plan, problem, circuit, &maximum)
    }

    /// The same with one unit of each quantity as its size, for values before the run.
    pub(super) fn in_units(plan: &Plan, problem: &Problem, circuit: &Circuit) -> Self {
        Stated::with_sizes(plan, problem, circuit, &|quantity| Some(quantity.unit.factor()))
    }

    /// What a problem states, with the size of each quantity from a function.
    fn with_sizes(
        plan: &Plan,
        problem: &Problem,
        circuit: &Circuit,
        size: &dyn Fn(&ProblemQuantity) -> Option<f64>,
    ) -> Self {
        let count = plan.nodes.len();
        let mut stated = Stated { sizes: vec![0.0; count], starts: vec![None; count] };
        for PlannedQuantity { name, node } in &plan.quantities {
            let quantity = problem.quantities.get(name);
            let index = node.0 as usize;
            if let Some(size) = quantity.and_then(size) {
                stated.sizes[index] = size;
            }
            if !matches!(plan.node(*node).operation, Operation::Integral { .. }) {
                // A fault of an initial value has been reported with the circuit.
                let declared =
                    quantity.and_then(|quantity| quantity.initial_in_si(circuit.quantities()).ok().flatten());
                let start = declared.or_else(|| initial_of_equation(plan, circuit, name));
                stated.starts[index] = stated.starts[index].or(start);
            }
        }
        stated
    }
}

/// The initial value that an equation such as `y(0) = y0` states, in SI units. `None` if there is no such equation.
fn initial_of_equation(plan: &Plan, circuit: &Circuit, quantity: &str) -> Option<f64> {
    let mut equations = circuit.equations().iter().map(|placed| &placed.value);
    let equation = equations.find(|equation| equation.initial_quantity() == Some(quantity))?;
    let symbol = |name: &str| plan.symbols.find(name, 0).map(Fraction::symbol).unwrap_or_default();
    let value = fraction(equation.right(), &mut |name| Ok(symbol(name))).ok()?;
    Some(ConstantValues::new(&plan.symbols, circuit).value(&value)).filter(|value| value.is_finite())
}
