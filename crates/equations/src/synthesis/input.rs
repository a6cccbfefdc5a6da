//! What the synthesis reads: the plan, the problem, the ranges and the options, with units and stated scales by node.

use std::collections::BTreeMap;

use patchcord_core::circuit::Circuit;
use patchcord_core::document::Diagnostic;
use patchcord_core::machines::REFERENCE;
use patchcord_core::patch::{Problem, ProblemQuantity};
use patchcord_expr::{Dimension, Unit, split_primes};

use super::ScaleOptions;
use super::centred::centre_angles;
use super::exponents::offset_exponents;
use super::expressions::Expressions;
use super::rescaled::{Rescaled, is_forced, rescaled, unsettled_scales};
use crate::findings::codes;
use crate::graph::{NodeId, Operation, Plan};
use crate::peaks::Ranges;
use crate::positions::node_span;

/// Gains of summers on a machine without a list of gains.
const SUMMER_GAINS: [f64; 2] = [1.0, 10.0];
/// Gains of integrators on a machine without a list of gains, per machine second.
const INTEGRATOR_GAINS: [f64; 4] = [1.0, 10.0, 100.0, 1000.0];

/// What the synthesis reads.
#[derive(Debug)]
pub(super) struct Input<'a> {
    /// The plan, with the nodes that `centred`, `exponents` and `rescaled` add.
    pub plan: Plan,
    /// The nodes whose scales follow from others, each after those from which it follows.
    pub forced_order: Vec<NodeId>,
    /// The problem.
    pub problem: &'a Problem,
    /// The circuit of the problem, with the values of the parameters.
    pub circuit: &'a Circuit,
    /// The smallest and the largest value of each node in SI units.
    pub ranges: Vec<[f64; 2]>,
    /// The largest rate of each integral in SI units.
    pub rates: Vec<f64>,
    /// The options.
    pub options: &'a ScaleOptions,
    /// The parameters, for the values of coefficients.
    pub expressions: Expressions<'a>,
    /// The offsets of exponents by exponential.
    offsets: BTreeMap<NodeId, i32>,
    /// The names of the quantities of each node. Names without primes come first.
    labels: Vec<Vec<String>>,
    /// Whether times count as pure numbers in the problem.
    is_time_dimensionless: bool,
}

impl<'a> Input<'a> {
    /// Prepares a plan for the synthesis.
    pub(super) fn new(
        plan: &Plan,
        problem: &'a Problem,
        circuit: &'a Circuit,
        ranges: &Ranges,
        options: &'a ScaleOptions,
    ) -> Self {
        let (mut centred, mut nodes) = (plan.clone(), ranges.nodes.clone());
        centre_angles(&mut centred, &mut nodes);
        let expressions = Expressions::new(&centred.symbols, circuit);
        let offsets = offset_exponents(&mut centred, &mut nodes, &|constant| expressions.value(constant));
        let mut labels = labels(&centred);
        let unsettled = unsettled_scales(&centred, &|constant| expressions.has_parameters(constant));
        let fixes_scale =
            |name: &String| problem.quantities.get(name).is_some_and(|it| has_scale(it, options));
        let needs_own_scale =
            |id: NodeId| unsettled.contains(&id) || labels[id.0 as usize].iter().any(fixes_scale);
        let Rescaled { plan, origins, order } = rescaled(&centred, &needs_own_scale);
        for origin in origins {
            nodes.push(nodes[origin.0 as usize]);
            labels.push(Vec::new());
        }
        let mut rates = ranges.rates.clone();
        rates.resize(nodes.len(), 0.0);
        let (ranges, forced_order) = (nodes, order);
        let is_time_dimensionless = circuit.is_time_dimensionless();
        Input {
            plan,
            forced_order,
            problem,
            circuit,
            ranges,
            rates,
            options,
            expressions,
            offsets,
            labels,
            is_time_dimensionless,
        }
    }

    /// The operation of a node.
    pub(super) fn operation(&self, id: NodeId) -> &Operation {
        &self.plan.node(id).operation
    }

    /// The value of the exponent of an exponential at which its input is 0.
    pub(super) fn exponent_offset(&self, id: NodeId) -> i32 {
        self.offsets.get(&id).copied().unwrap_or(0)
    }

    /// The names of the quantities that a node is.
    pub(super) fn labels(&self, id: NodeId) -> &[String] {
        &self.labels[id.0 as usize]
    }

    /// The largest magnitude of a node in SI units.
    pub(super) fn peak(&self, id: NodeId) -> f64 {
        let [low, high] = self.ranges[id.0 as usize];
        low.abs().max(high.abs())
    }

    /// The description of a node for a reader: that of its quantity, or its name.
    pub(super) fn description(&self, id: NodeId) -> &str {
        let described = self.labels(id).iter().filter_map(|label| self.problem.quantities.get(label));
        let description =
            described.map(|quantity| quantity.description.as_str()).find(|text| !text.is_empty());
        description.unwrap_or(&self.plan.node(id).name)
    }

    /// The dimension of a node. If times count as pure numbers in the problem, it contains no time.
    pub(super) fn dimension(&self, id: NodeId) -> Dimension {
        let dimension = self.plan.node(id).dimension;
        if self.is_time_dimensionless { dimension.without_time() } else { dimension }
    }

    /// The unit of a node: that of its first quantity or of its drive, or the SI unit.
    pub(super) fn unit(&self, id: NodeId) -> Unit {
        if let Operation::Drive(name) = self.operation(id)
            && let Some(scale) = self.problem.patch.scales.get(name)
        {
            return scale.unit.clone();
        }
        match self.labels(id).first() {
            Some(label) => self.unit_of_quantity(label, id),
            None => si_unit(self.dimension(id)),
        }
    }

    /// The unit of a quantity at a node: the declared one, or that of the quantity of which it is a derivative, per
    /// second, or the SI unit.
    pub(super) fn unit_of_quantity(&self, name: &str, id: NodeId) -> Unit {
        let declared = |name: &str| Some(self.problem.quantities.get(name)?.unit.clone());
        let derived = || {
            let (base, order) = split_primes(name);
            let unit = declared(base)?;
            Some((0..order).fold(unit, |unit, _| unit.per_second()))
        };
        let unit = declared(name).or_else(derived).unwrap_or_else(|| si_unit(self.dimension(id)));
        if self.is_time_dimensionless && unit.dimension().contains_time() {
            return si_unit(unit.dimension().without_time());
        }
        unit
    }

    /// The value of one volt that the problem states, in SI units: `per_volt`, or a hundredth of the `maximum`. `None` if
    /// it states none, and if the scale follows from others.
    pub(super) fn stated_scale(&self, id: NodeId) -> Option<f64> {
        if is_forced(self.operation(id)) {
            return None;
        }
        let of_maximum = |quantity: &ProblemQuantity| {
            Some(quantity.unit.to_si(quantity.maximum.as_ref()?.value) / REFERENCE)
        };
        self.prescribed_scale(id).or_else(|| self.quantities(id).find_map(of_maximum))
    }

    /// The value of one volt that the problem prescribes by `per_volt`, in SI units. `None` if it prescribes none, and if
    /// the scale follows from others.
    pub(super) fn prescribed_scale(&self, id: NodeId) -> Option<f64> {
        let of_quantity =
            |quantity: &ProblemQuantity| Some(quantity.unit.to_si(quantity.per_volt.as_ref()?.value));
        if is_forced(self.operation(id)) { None } else { self.quantities(id).find_map(of_quantity) }
    }

    /// The declared quantities that a node is.
    fn quantities(&self, id: NodeId) -> impl Iterator<Item = &ProblemQuantity> {
        self.labels(id).iter().filter_map(|label| self.problem.quantities.get(label))
    }

    /// The gains of summers in ascending order.
    pub(super) fn summer_gains(&self) -> &'static [f64] {
        let gains = self.options.machine.summer_gains;
        if gains.is_empty() { &SUMMER_GAINS } else { gains }
    }

    /// The gains of integrators in ascending order, per machine second.
    pub(super) fn integrator_gains(&self) -> &'static [f64] {
        let gains = self.options.machine.integrator_gains;
        if gains.is_empty() { &INTEGRATOR_GAINS } else { gains }
    }

    /// A diagnostic about a node. It points to the quantity that the node is, or to one that depends on it.
    pub(super) fn fault(&self, id: NodeId, message: String, hint: &str) -> Diagnostic {
        let declared = self.quantities(id).next().map(|quantity| quantity.span);
        let span = declared.or_else(|| node_span(&self.plan, self.problem, id));
        Diagnostic { code: codes::NO_CIRCUIT, span, message, hint: Some(hint.to_owned()) }
    }
}

/// Whether the problem fixes the scale of a quantity: by `per_volt`, or by a maximum that is kept.
fn has_scale(quantity: &ProblemQuantity, options: &ScaleOptions) -> bool {
    quantity.per_volt.is_some() || (options.keeps_maxima && quantity.maximum.is_some())
}

/// The names of the quantities of each node. Names without primes come first.
fn labels(plan: &Plan) -> Vec<Vec<String>> {
    let mut labels = vec![Vec::new(); plan.nodes.len()];
    for quantity in &plan.quantities {
        labels[quantity.node.0 as usize].push(quantity.name.clone());
    }
    labels.iter_mut().for_each(|names| names.sort_by_key(|name| split_primes(name).1 > 0));
    labels
}

/// The SI unit of a dimension.
fn si_unit(dimension: Dimension) -> Unit {
    let pure = || Unit::of_product(std::iter::empty());
    if dimension.is_dimensionless() {
        return Unit::parse("1").unwrap_or_else(|_| pure());
    }
    Unit::parse(&dimension.to_string()).unwrap_or_else(|_| pure())
}
