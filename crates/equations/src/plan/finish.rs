//! The last steps: signs get their comparators, equal nodes are joined, implicit equations get their sign, and delays
//! their initial values.

use std::collections::BTreeMap;

use patchcord_core::circuit::Circuit;
use patchcord_core::document::{Code, Diagnostic, formula_diagnostic};
use patchcord_core::patch::Problem;
use patchcord_expr::FormulaError;

use super::builder::Entry;
use super::constants::Constants;
use super::signs::split_signs;
use super::simplify::{Simplified, simplified};
use super::start_expressions::StartExpressions;
use crate::graph::{Node, NodeId, Operation, Plan, PlannedQuantity, Sum};
use crate::peaks::{StartError, StartValues, start_values};
use crate::positions::quantity_span;
use crate::symbolic::Fraction;

/// The nodes of a plan before equal ones are joined.
pub(super) struct Draft<'a> {
    /// The problem.
    pub problem: &'a Problem,
    /// The circuit of the problem.
    pub circuit: &'a Circuit,
    /// The constants of the problem.
    pub constants: &'a Constants,
    /// The quantities of the plan with their nodes.
    pub quantities: Vec<(String, NodeId)>,
    /// The index of the equation that determines a node.
    pub equations: BTreeMap<NodeId, usize>,
    /// The nodes.
    pub entries: Vec<Entry>,
    /// The nodes of angles, each by the two sums of which it is `atan2`.
    pub angles: BTreeMap<[Sum; 2], NodeId>,
}

impl Draft<'_> {
    /// The finished plan.
    ///
    /// # Errors
    /// If quantities are only set equal to each other, or an implicit equation has no solution at the start.
    pub(super) fn finished(mut self) -> Result<Plan, Vec<Diagnostic>> {
        let roots: Vec<NodeId> = self.quantities.iter().map(|(_, node)| *node).collect();
        let mut entries = std::mem::take(&mut self.entries);
        split_signs(&mut entries, self.problem, self.constants);
        let joined = simplified(entries, &roots).map_err(|node| vec![self.circular(node)])?;
        let angles = self.placed_angles(&joined);
        let equations = self.equations.iter();
        let equations: BTreeMap<NodeId, usize> =
            equations.filter_map(|(node, equation)| Some((joined.place(*node)?, *equation))).collect();
        let quantities = self.quantities.iter().filter_map(|(name, node)| {
            Some(PlannedQuantity { name: name.clone(), node: joined.place(*node)? })
        });
        let (symbols, quantities) = (self.constants.system.symbols.clone(), quantities.collect());
        let mut plan = Plan { symbols, nodes: joined.nodes, quantities };
        let remaining = self.set_stated_delays(&mut plan.nodes);
        if !remaining.is_empty() || has_implicit(&plan.nodes, &angles) {
            let start = start_values(&plan, self.problem, self.circuit, &angles);
            let start = start.map_err(|error| vec![self.without_start(&plan.nodes, &equations, error)])?;
            orient(&mut plan.nodes, &start)
                .map_err(|node| vec![self.unsolved(&plan.nodes, &equations, node)])?;
            set_delays(&mut plan.nodes, &remaining, &start)
                .map_err(|name| vec![infinite(self.problem, &name)])?;
        }
        Ok(plan)
    }

    /// Sets the initial values of delays that are expressions of parameters. Returns the indices of the other delays.
    fn set_stated_delays(&self, nodes: &mut [Node]) -> Vec<usize> {
        let mut expressions = StartExpressions::new(nodes, self.constants, self.circuit);
        let value = |(index, node): (usize, &Node)| match node.operation {
            Operation::Delay { input, .. } => Some((index, expressions.of(input))),
            _ => None,
        };
        let values: Vec<(usize, Option<Fraction>)> = nodes.iter().enumerate().filter_map(value).collect();
        let mut remaining = Vec::new();
        for (index, value) in values {
            match (&mut nodes[index].operation, value) {
                (Operation::Delay { initial, .. }, Some(value)) => *initial = value,
                _ => remaining.push(index),
            }
        }
        remaining
    }

    /// The angles among the joined nodes.
    fn placed_angles(&self, joined: &Simplified) -> BTreeMap<NodeId, [Sum; 2]> {
        let place = |node: NodeId| joined.place(node).unwrap_or(node);
        let angles = self.angles.iter().filter_map(|(sums, node)| {
            Some((joined.place(*node)?, sums.each_ref().map(|sum| sum.with_nodes(&place))))
        });
        angles.collect()
    }

    /// The fault of a quantity that its equations only set equal to itself.
    fn circular(&self, node: NodeId) -> Diagnostic {
        let name = self.quantities.iter().find(|(_, own)| *own == node).map_or("", |(name, _)| name);
        let message = format!("no equation determines {name}: they only set quantities equal to each other");
        let hint = format!("write an equation of {name} and other quantities");
        self.at_equation(self.equations.get(&node), name, message, hint)
    }

    /// The fault of a plan without values at the start.
    fn without_start(
        &self,
        nodes: &[Node],
        equations: &BTreeMap<NodeId, usize>,
        error: StartError,
    ) -> Diagnostic {
        match error {
            StartError::Unsolved(node) => self.unsolved(nodes, equations, node),
            StartError::Other(diagnostic) => *diagnostic,
        }
    }

    /// The fault of a node without a solution at the start.
    fn unsolved(&self, nodes: &[Node], equations: &BTreeMap<NodeId, usize>, node: NodeId) -> Diagnostic {
        let name = &nodes[node.0 as usize].name;
        let message = format!("no value of {name} at the start is found that satisfies this equation");
        let hint = format!("give {name} an \"initial\" near its value at the start");
        self.at_equation(equations.get(&node), name, message, hint)
    }

    /// A fault at a name in an equation.
    fn at_equation(&self, equation: Option<&usize>, name: &str, message: String, hint: String) -> Diagnostic {
        match equation.and_then(|index| self.circuit.equations().get(*index)) {
            Some(placed) => {
                let range = placed.value.range_of(name).unwrap_or(0..placed.value.text().len());
                formula_diagnostic(
                    Code::BAD_FORMULA,
                    placed,
                    FormulaError { range, message, hint: Some(hint) },
                )
            }
            None => {
                let span = quantity_span(self.problem, name);
                Diagnostic { code: Code::BAD_FORMULA, span, message, hint: Some(hint) }
            }
        }
    }
}

/// Whether a node is implicit and no angle.
fn has_implicit(nodes: &[Node], angles: &BTreeMap<NodeId, [Sum; 2]>) -> bool {
    let mut all = (0..).map(NodeId).zip(nodes);
    all.any(|(node, own)| matches!(own.operation, Operation::Zero(_)) && !angles.contains_key(&node))
}

/// Sets the sign of implicit equations, so that each sum rises with its own node.
///
/// # Errors
/// A node whose sum does not change with it at the start.
fn orient(nodes: &mut [Node], start: &StartValues) -> Result<(), NodeId> {
    for (node, slope) in &start.slopes {
        match &mut nodes[node.0 as usize].operation {
            Operation::Zero(sum) if *slope < 0.0 => *sum = sum.negated(),
            Operation::Zero(_) if *slope > 0.0 => {}
            _ => return Err(*node),
        }
    }
    Ok(())
}

/// Sets the initial values of the delays with these indices, which are no expressions of parameters.
///
/// # Errors
/// The name of a delayed node whose value at the start is not finite.
fn set_delays(nodes: &mut [Node], delays: &[usize], start: &StartValues) -> Result<(), String> {
    for index in delays {
        let Operation::Delay { input, .. } = nodes[*index].operation else { continue };
        let value = start.values[input.0 as usize];
        if !value.is_finite() {
            return Err(nodes[input.0 as usize].name.clone());
        }
        if let Operation::Delay { initial, .. } = &mut nodes[*index].operation {
            *initial = Fraction::number(value);
        }
    }
    Ok(())
}

/// The fault of a delayed node without a value at the start.
fn infinite(problem: &Problem, name: &str) -> Diagnostic {
    let message = format!("the value of {name} at the start is not finite, and a delay needs it");
    let hint = format!("choose initial values for which {name} has a value");
    Diagnostic { code: Code::NOT_FINITE, span: quantity_span(problem, name), message, hint: Some(hint) }
}
