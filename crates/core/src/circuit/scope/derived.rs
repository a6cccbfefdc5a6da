//! Evaluates the derived quantities: scales, and settings of macros' instances.

use std::collections::HashSet;

use indexmap::IndexMap;
use petgraph::algo::kosaraju_scc;
use petgraph::graph::{DiGraph, NodeIndex};

use super::Quantities;
use crate::circuit::macros;
use crate::document::{Code, Diagnostic, Placed, Span};
use crate::patch::{InstanceSetting, Patch, Scale};
use patchcord_expr::{Formula, Unit};

/// The definition of a derived quantity.
pub(super) struct Derivation<'p> {
    /// The formula. `None` if it could not be read.
    pub formula: Option<&'p Placed<Formula>>,
    /// The unit in which a literal formula is written.
    pub unit: &'p Unit,
    /// Position of the definition, for reports about a definition without a readable formula.
    pub span: Span,
}

/// The definitions of the derived quantities by name, in their order.
pub(super) type Derivations<'p> = IndexMap<String, Derivation<'p>>;

/// The definitions of the scales and of the settings of macros' instances. A setting has the name "instance.setting".
pub(super) fn derivations(patch: &Patch) -> Derivations<'_> {
    let mut derivations = Derivations::new();
    for (name, Scale { per_volt, unit, span }) in &patch.scales {
        let derivation = Derivation { formula: per_volt.as_ref(), unit, span: *span };
        derivations.insert(name.clone(), derivation);
    }
    for (instance_name, instance) in &patch.instances {
        for (name, InstanceSetting { value, unit }) in &instance.settings {
            let derivation = Derivation { formula: Some(value), unit, span: value.span };
            // A scale with the same name has an invalid name, which was reported.
            derivations.entry(format!("{instance_name}.{name}")).or_insert(derivation);
        }
    }
    derivations
}

impl Quantities {
    /// Evaluates the derived quantities, each after those in its formula. Reports circular definitions.
    ///
    /// Each rank is a strongly connected component of the graph of dependencies. A component with several members, or
    /// with an edge to itself, is a circular definition. Its members have no rank and no value, and quantities that
    /// depend on them have no value either.
    pub(super) fn evaluate_derived(
        &mut self,
        patch: &Patch,
        derivations: &Derivations<'_>,
        findings: &mut Vec<Diagnostic>,
    ) {
        let graph = self.dependency_graph();
        // A component comes after the components on which it depends.
        for (rank, mut members) in kosaraju_scc(&graph).into_iter().enumerate() {
            members.sort_unstable();
            let first = members[0];
            if members.len() > 1 || graph.contains_edge(first, first) {
                findings.push(self.circular_definition(&derivations[first.index()], &members));
                continue;
            }
            self.ranks[first.index()] = Some(rank);
            if let Some(formula) = derivations[first.index()].formula {
                let reported = findings.len();
                let value = self.checked_derived(first.index(), formula, findings);
                macros::add_name(patch, self.derived(first.index()).0, &mut findings[reported..]);
                self.derived[first.index()].value = value;
            }
        }
    }

    /// Checks the defaults of macros' settings that no instance uses. The others are checked with their instance.
    pub(super) fn check_unused_defaults(&self, patch: &Patch, findings: &mut Vec<Diagnostic>) {
        let instance_settings = patch.instances.values().flat_map(|instance| instance.settings.values());
        let used: HashSet<Span> = instance_settings.map(|setting| setting.value.span).collect();
        for setting in patch.macros.values().flat_map(|definition| definition.settings.values()) {
            let default = setting.default.as_ref().filter(|default| !used.contains(&default.span));
            if let (Some(default), Some(unit)) = (default, &setting.unit) {
                self.value_in_si(default, unit, findings);
            }
        }
    }

    /// The graph of derived quantities, with an edge to every derived quantity in the formula of another one.
    ///
    /// Parameters are not in the graph, because they do not depend on other quantities.
    fn dependency_graph(&self) -> DiGraph<(), ()> {
        let mut graph = DiGraph::new();
        for _ in &self.formulas {
            graph.add_node(());
        }
        for (index, formula) in self.formulas.iter().enumerate() {
            for dependency in formula.names().into_iter().filter_map(|name| self.derived_index(name)) {
                graph.add_edge(NodeIndex::new(index), NodeIndex::new(dependency), ());
            }
        }
        graph
    }

    /// The diagnostic for scales that depend on themselves or on each other.
    ///
    /// Settings of instances cannot: their formulas name quantities outside the instance.
    fn circular_definition(&self, first: &Derivation<'_>, members: &[NodeIndex]) -> Diagnostic {
        let names: Vec<_> = members.iter().map(|index| self.derived(index.index()).0).collect();
        let message = match names.as_slice() {
            [only] => format!("the scale {only} depends on itself"),
            names => format!("the scales {} depend on each other", names.join(", ")),
        };
        let span = first.formula.map_or(first.span, |placed| placed.span);
        Diagnostic::at(Code::BAD_FORMULA, span, message)
            .hint("define one of them by a number or by parameters only")
    }

    /// The value of a derived quantity in SI units. Reports a wrong unit, an error of evaluation, and a scale of 0.
    fn checked_derived(
        &self,
        index: usize,
        placed: &Placed<Formula>,
        findings: &mut Vec<Diagnostic>,
    ) -> Option<f64> {
        let value = self.value_in_si(placed, self.unit(index), findings)?;
        if value == 0.0 && self.is_literal(&placed.value) && index < self.scale_count {
            let message = "per_volt of a scale must not be 0";
            let hint = "per_volt is the value that one volt represents";
            findings.push(Diagnostic::at(Code::BAD_NUMBER, placed.span, message).hint(hint));
            return None;
        }
        Some(value)
    }
}
