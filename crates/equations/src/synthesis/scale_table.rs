//! The scales of all nodes as values and as expressions of the scales that are named in the patch.

use patchcord_core::machines::REFERENCE;

use super::expressions::Expressions;
use super::input::Input;
use super::rescaled::is_forced;
use crate::graph::{NodeId, Operation, Term};
use crate::symbolic::Fraction;

/// The scale of a node.
#[derive(Debug, Clone)]
pub(super) struct ScaleEntry {
    /// The value of one volt in SI units.
    pub value: f64,
    /// The value of one volt as an expression of named scales and parameters.
    pub expression: Fraction,
    /// The name in the patch. `None` if formulas contain the expression instead.
    pub name: Option<String>,
    /// The expression of other scales that defines a named scale. `None` if its value is chosen.
    pub definition: Option<Fraction>,
    /// Whether the value depends on parameters.
    pub is_parametric: bool,
}

/// The scales of all nodes.
#[derive(Debug)]
pub(super) struct ScaleTable<'a> {
    /// The parameters and scales.
    pub expressions: Expressions<'a>,
    /// The scales by node.
    entries: Vec<ScaleEntry>,
}

impl<'a> ScaleTable<'a> {
    /// The table with these values of the chosen scales. `name` gives the names of scales; every chosen scale has one.
    pub(super) fn new(
        input: &Input<'a>,
        per_volt: &[f64],
        name: &dyn Fn(NodeId) -> Option<String>,
    ) -> ScaleTable<'a> {
        let expressions = Expressions::new(&input.plan.symbols, input.circuit);
        // The reference voltage is the number 1.
        let (value, expression) = (1.0 / REFERENCE, Fraction::number(1.0 / REFERENCE));
        let one = ScaleEntry { value, expression, name: None, definition: None, is_parametric: false };
        let mut table = ScaleTable { expressions, entries: vec![one; input.plan.nodes.len()] };
        for id in input.plan.ids() {
            let operation = input.operation(id);
            if *operation != Operation::One && !is_forced(operation) {
                let value = per_volt.get(id.0 as usize).copied().unwrap_or(f64::NAN);
                table.set(input, id, value, name(id), None);
            }
        }
        for id in &input.forced_order {
            let definition = table.forced_scale(input.operation(*id));
            let value = table.expressions.value(&definition);
            table.set(input, *id, value, name(*id), Some(definition));
        }
        table
    }

    /// Sets the scale of a node: a chosen value, or one that follows from a definition.
    fn set(
        &mut self,
        input: &Input<'_>,
        id: NodeId,
        value: f64,
        name: Option<String>,
        definition: Option<Fraction>,
    ) {
        let is_parametric =
            definition.as_ref().is_some_and(|definition| self.depends_on_parameters(input, id, definition));
        let expression = match (&name, &definition) {
            (Some(name), _) => self.expressions.add_scale(name, input.dimension(id), value),
            (None, Some(definition)) => definition.clone(),
            (None, None) => Fraction::number(value),
        };
        self.entries[id.0 as usize] = ScaleEntry { value, expression, name, definition, is_parametric };
    }

    /// Whether the scale of a node depends on parameters, directly or through the scales of its inputs.
    fn depends_on_parameters(&self, input: &Input<'_>, id: NodeId, definition: &Fraction) -> bool {
        let is_parametric = |node: &NodeId| self.entry(*node).is_parametric;
        let has_parametric_input = match input.operation(id) {
            Operation::Product(factors) => factors.iter().any(is_parametric),
            Operation::Absolute(source) | Operation::Delay { input: source, .. } => is_parametric(source),
            Operation::Lower(terms) | Operation::Higher(terms) => {
                terms.iter().any(|term| is_parametric(&term.node))
            }
            Operation::DeadZone { input: source, width } => {
                is_parametric(source) || is_parametric(&width.node)
            }
            _ => false,
        };
        has_parametric_input || self.expressions.has_parameters(definition)
    }

    /// The scale of a node.
    pub(super) fn entry(&self, id: NodeId) -> &ScaleEntry {
        &self.entries[id.0 as usize]
    }

    /// The value of one volt of a node in SI units.
    pub(super) fn value(&self, id: NodeId) -> f64 {
        self.entry(id).value
    }

    /// The values of all nodes.
    pub(super) fn values(&self) -> Vec<f64> {
        self.entries.iter().map(|entry| entry.value).collect()
    }

    /// The value of one volt of a node as an expression.
    pub(super) fn expression(&self, id: NodeId) -> &Fraction {
        &self.entry(id).expression
    }

    /// The value of one volt of a node times the coefficient of a term, as an expression.
    pub(super) fn weighted(&self, term: &Term) -> Fraction {
        term.coefficient.times(self.expression(term.node))
    }

    /// The same without the sign of the coefficient.
    pub(super) fn size_of(&self, term: &Term) -> Fraction {
        self.expressions.positive(&term.coefficient).times(self.expression(term.node))
    }

    /// The value of one volt of a node times the coefficient of a term, in SI units.
    pub(super) fn weight(&self, term: &Term) -> f64 {
        self.expressions.value(&term.coefficient).abs() * self.value(term.node)
    }

    /// The index of the term with the larger weight, which needs no pot in front of a diode pair.
    pub(super) fn heavier(&self, [first, second]: &[Term; 2]) -> usize {
        usize::from(self.weight(second) > self.weight(first))
    }

    /// The scale that follows from those of the inputs.
    fn forced_scale(&self, operation: &Operation) -> Fraction {
        match operation {
            Operation::Product([first, second]) => {
                let product = self.expression(*first).times(self.expression(*second));
                product.times(&Fraction::number(REFERENCE))
            }
            Operation::Absolute(input) | Operation::Delay { input, .. } => self.expression(*input).clone(),
            Operation::Lower(terms) | Operation::Higher(terms) => self.weighted(&terms[self.heavier(terms)]),
            // The slope of the network is S / (S + W) with the scales of its input and of its width.
            Operation::DeadZone { input, width } => self.expression(*input).plus(&self.weighted(width)),
            _ => Fraction::whole(1),
        }
    }
}
