//! The quantities that formulas may name: parameters, scales, settings of macros, the time scale.

use std::collections::{BTreeSet, HashMap, HashSet};

use indexmap::IndexMap;
use petgraph::algo::kosaraju_scc;
use petgraph::graph::{DiGraph, NodeIndex};

use super::macros;
use super::parameters::parameters;
use crate::document::{Code, Diagnostic, Placed, Span, TIME_SCALE, in_formula, misfit};
use crate::patch::{InstanceSetting, Lost, Patch, Scale};
use patchcord_expr::{Dimension, Formula, FormulaMeasure, Scope, Unit};

/// Values and units of everything that formulas may name.
#[derive(Debug, Clone)]
pub struct Quantities {
    parameters: IndexMap<String, Named>,
    /// What is worked out of formulas: the scales, then the settings of macros' instances ("L1.T").
    derived: IndexMap<String, Named>,
    formulas: Vec<Formula>,
    /// How many of them are scales.
    scales: usize,
    /// Their places in an order in which each comes after those that it names; `None` where it cannot be worked out.
    ranks: Vec<Option<usize>>,
    time_scale: f64,
    lost: Lost,
}

/// What formulas may name.
#[derive(Debug, Clone)]
pub(super) struct Named {
    pub unit: Unit,
    /// In SI; `None` where it could not be worked out, which has been reported.
    pub value: Option<f64>,
}

impl Quantities {
    /// Parameters at their values (changed by `changes`) and scales worked out of them.
    pub(super) fn new(patch: &Patch, changes: &[(String, f64)], findings: &mut Vec<Diagnostic>) -> Self {
        let derivations = derivations(patch);
        let unknown = |(name, derivation): (&String, &Derivation<'_>)| {
            (name.clone(), Named { unit: derivation.unit.clone(), value: None })
        };
        let formula = |derivation: &Derivation<'_>| match derivation.formula {
            Some(placed) => placed.value.clone(),
            None => Formula::constant(f64::NAN),
        };
        let mut quantities = Quantities {
            parameters: parameters(patch, changes, findings),
            derived: derivations.iter().map(unknown).collect(),
            formulas: derivations.values().map(formula).collect(),
            scales: patch.scales.len(),
            ranks: vec![None; derivations.len()],
            time_scale: patch.time_scale,
            lost: patch.lost().clone(),
        };
        quantities.work_out(patch, &derivations, findings);
        quantities.judge_defaults(patch, findings);
        quantities
    }

    /// The parameters that a formula names, itself or through what is derived of them, and that in its order.
    pub(super) fn named_in(&self, formula: &Formula) -> Dependencies {
        let (mut parameters, mut derived) = (BTreeSet::new(), HashSet::new());
        let mut open = vec![formula];
        while let Some(formula) = open.pop() {
            for name in formula.names() {
                parameters.extend(self.parameters.get_index_of(name));
                let index = self.derived.get_index_of(name).filter(|index| derived.insert(*index));
                open.extend(index.map(|index| &self.formulas[index]));
            }
        }
        let mut derived: Vec<_> = derived.into_iter().filter(|index| self.ranks[*index].is_some()).collect();
        derived.sort_unstable_by_key(|index| self.ranks[*index]);
        Dependencies { parameters: parameters.into_iter().collect(), derived }
    }

    /// The same quantities with parameters at other values (in their declared units), and with them what is
    /// derived of them.
    pub(super) fn varied(&self, values: &[(usize, f64)], derived: &[usize]) -> Varied<'_> {
        let in_si = |(parameter, value): &(usize, f64)| {
            let (name, named) = self.parameters.get_index(*parameter)?;
            Some((name.as_str(), Some(named.unit.to_si(*value))))
        };
        let mut varied = Varied { quantities: self, changed: values.iter().filter_map(in_si).collect() };
        for index in derived {
            let (name, formula) = self.derived(*index);
            let value = formula.evaluate(&varied).ok();
            varied.changed.insert(name, value.map(|value| self.in_si(formula, value, self.unit(*index))));
        }
        varied
    }

    /// The values of the parameters, in their declared units.
    pub(super) fn parameter_values(&self) -> impl Iterator<Item = f64> {
        self.parameters.values().map(|named| named.unit.out_of_si(named.value.unwrap_or(f64::NAN)))
    }

    /// Name and formula of a scale or of a macro's setting.
    pub(super) fn derived(&self, index: usize) -> (&str, &Formula) {
        let name = self.derived.get_index(index).map_or("", |(name, _)| name);
        (name, &self.formulas[index])
    }

    /// Its index by name.
    pub(super) fn derived_index(&self, name: &str) -> Option<usize> {
        self.derived.get_index_of(name)
    }

    /// Its unit.
    pub(super) fn unit(&self, index: usize) -> &Unit {
        &self.derived[index].unit
    }

    /// One volt of a scale in SI, where it could be worked out.
    pub(super) fn per_volt(&self, scale: usize) -> Option<f64> {
        self.derived.get_index(scale)?.1.value
    }

    /// Whether a formula is made of bare numbers, and so takes the unit of its place.
    pub fn is_plain(&self, formula: &Formula) -> bool {
        formula.dimension(self) == Ok(FormulaMeasure::Free)
    }

    /// What a formula came to, in SI: a plain number stands in the unit of its place.
    pub(super) fn in_si(&self, formula: &Formula, value: f64, unit: &Unit) -> f64 {
        if self.is_plain(formula) { unit.to_si(value) } else { value }
    }

    /// Formulas may name what other formulas give: each is worked out once those that it names are.
    fn work_out(&mut self, patch: &Patch, derivations: &Derivations<'_>, findings: &mut Vec<Diagnostic>) {
        let naming = self.naming();
        // A component comes after those that it names.
        for (rank, mut members) in kosaraju_scc(&naming).into_iter().enumerate() {
            members.sort_unstable();
            let first = members[0];
            if members.len() > 1 || naming.contains_edge(first, first) {
                findings.push(self.ring(&derivations[first.index()], &members));
                continue;
            }
            self.ranks[first.index()] = Some(rank);
            if let Some(formula) = derivations[first.index()].formula {
                let told = findings.len();
                let value = self.checked_derived(first.index(), formula, findings);
                macros::name(patch, self.derived(first.index()).0, &mut findings[told..]);
                self.derived[first.index()].value = value;
            }
        }
    }

    /// Judges the defaults of macros that no instance takes; those taken are worked out with it.
    fn judge_defaults(&self, patch: &Patch, findings: &mut Vec<Diagnostic>) {
        let set = patch.instances.values().flat_map(|made| made.settings.values());
        let taken: HashSet<Span> = set.map(|setting| setting.value.span).collect();
        for setting in patch.macros.values().flat_map(|of| of.settings.values()) {
            let default = setting.default.as_ref().filter(|default| !taken.contains(&default.span));
            if let (Some(default), Some(unit)) = (default, &setting.unit) {
                self.quantity(default, unit, findings);
            }
        }
    }

    /// Which formulas name which.
    fn naming(&self) -> DiGraph<(), ()> {
        let mut naming = DiGraph::new();
        for _ in &self.formulas {
            naming.add_node(());
        }
        for (index, formula) in self.formulas.iter().enumerate() {
            for named in formula.names().into_iter().filter_map(|name| self.derived_index(name)) {
                naming.add_edge(NodeIndex::new(index), NodeIndex::new(named), ());
            }
        }
        naming
    }

    /// Scales that depend on themselves. Settings of macros cannot: they name what stands outside.
    fn ring(&self, first: &Derivation<'_>, ring: &[NodeIndex]) -> Diagnostic {
        let names: Vec<_> = ring.iter().map(|index| self.derived(index.index()).0).collect();
        let message = match names.as_slice() {
            [only] => format!("the scale {only} depends on itself"),
            names => format!("the scales {} depend on each other", names.join(", ")),
        };
        let span = first.formula.map_or(first.span, |placed| placed.span);
        Diagnostic::at(Code::BadFormula, span, message)
            .hint("give one of them as a number, or by parameters alone")
    }

    fn checked_derived(
        &self,
        index: usize,
        placed: &Placed<Formula>,
        findings: &mut Vec<Diagnostic>,
    ) -> Option<f64> {
        let value = self.quantity(placed, self.unit(index), findings)?;
        if value == 0.0 && self.is_plain(&placed.value) && index < self.scales {
            let message = "a scale of 0 per volt measures nothing";
            let hint = "per_volt is what one volt stands for";
            findings.push(Diagnostic::at(Code::BadNumber, placed.span, message).hint(hint));
            return None;
        }
        Some(value)
    }

    /// A formula's value in SI, once it is found fit for a unit.
    fn quantity(&self, placed: &Placed<Formula>, unit: &Unit, findings: &mut Vec<Diagnostic>) -> Option<f64> {
        let wanted = unit.dimension();
        let value = self.checked(placed, |found| found == wanted, &wanted.to_string(), findings)?;
        let value = self.in_si(&placed.value, value, unit);
        if !value.is_finite() {
            findings.push(too_large(&placed.value, placed.span));
            return None;
        }
        Some(value)
    }

    /// A formula's value, once its unit is found fit.
    pub(super) fn checked(
        &self,
        placed: &Placed<Formula>,
        fits: impl Fn(Dimension) -> bool,
        wanted: &str,
        findings: &mut Vec<Diagnostic>,
    ) -> Option<f64> {
        self.fitting(placed, self, fits, wanted, findings)?;
        let value = placed.value.evaluate(self);
        value.map_err(|error| findings.push(in_formula(Code::BadFormula, placed, error))).ok()
    }

    /// Whether a formula's unit is fit, with the names that `scope` knows.
    pub(super) fn fitting(
        &self,
        placed: &Placed<Formula>,
        scope: &dyn Scope,
        fits: impl Fn(Dimension) -> bool,
        wanted: &str,
        findings: &mut Vec<Diagnostic>,
    ) -> Option<()> {
        let formula = &placed.value;
        if self.names_unknown_value(formula) {
            return None;
        }
        let measured = formula.dimension(scope);
        let measure = measured.map_err(|error| findings.push(misfit(scope, placed, error))).ok()?;
        if let FormulaMeasure::Of(found) = measure
            && !fits(found)
        {
            let message = format!("{} {}, and {wanted} is wanted here", formula.text(), measured_in(found));
            let hint = fits(Dimension::NONE).then(|| self.divisor(formula, found));
            findings.push(Diagnostic::at(Code::UnitMismatch, placed.span, message).maybe_hint(hint));
            return None;
        }
        Some(())
    }

    /// What to divide by to be left with a pure number: a scale, or a parameter that the formula does not name.
    fn divisor(&self, formula: &Formula, found: Dimension) -> String {
        if let Some((name, _)) = self.scales().find(|(_, scale)| scale.unit.dimension() == found) {
            return format!("divide it by the scale {name}: that leaves volts");
        }
        let named = formula.names();
        let other = self
            .parameters
            .iter()
            .find(|(name, parameter)| parameter.unit.dimension() == found && !named.contains(&name.as_str()));
        match other {
            Some((name, _)) => format!("divide it by something in {found}, such as the parameter {name}"),
            None => format!("divide it by something in {found}, made of parameters and scales"),
        }
    }

    /// Whether a name stands for something that was itself reported as wrong.
    fn names_unknown_value(&self, formula: &Formula) -> bool {
        formula.names().iter().any(|name| match self.find(name) {
            Some(named) => named.value.is_none(),
            None => self.lost.may_hold(name) && *name != TIME_SCALE,
        })
    }

    fn find(&self, name: &str) -> Option<&Named> {
        self.parameters.get(name).or_else(|| self.derived.get(name))
    }

    fn scales(&self) -> impl Iterator<Item = (&String, &Named)> {
        self.derived.iter().take(self.scales)
    }
}

fn measured_in(dimension: Dimension) -> String {
    if dimension.is_none() { "is a pure number".to_owned() } else { format!("is in {dimension}") }
}

/// A number that overflows where it is brought to SI units or volts.
pub(super) fn too_large(formula: &Formula, span: Span) -> Diagnostic {
    let message = format!("{} is too large to reckon with here", formula.text());
    Diagnostic::at(Code::NotFinite, span, message).hint("look for a wrong power of ten, here or in a scale")
}

impl Scope for Quantities {
    fn value(&self, name: &str) -> Option<f64> {
        if name == TIME_SCALE {
            return Some(self.time_scale);
        }
        self.find(name)?.value
    }

    fn dimension(&self, name: &str) -> Option<Dimension> {
        if name == TIME_SCALE {
            return Some(Dimension::NONE);
        }
        self.find(name).map(|named| named.unit.dimension())
    }

    fn declared_unit(&self, name: &str) -> Option<&str> {
        self.find(name).map(|named| named.unit.text())
    }

    fn names(&self) -> Vec<&str> {
        let scales = self.scales().map(|(name, _)| name);
        self.parameters.keys().chain(scales).map(String::as_str).chain([TIME_SCALE]).collect()
    }
}

/// What the value of a formula depends on.
pub(super) struct Dependencies {
    pub parameters: Vec<usize>,
    pub derived: Vec<usize>,
}

/// How a scale or a setting of a macro's instance comes about.
struct Derivation<'p> {
    formula: Option<&'p Placed<Formula>>,
    unit: &'p Unit,
    span: Span,
}

type Derivations<'p> = IndexMap<String, Derivation<'p>>;

/// The scales of a patch, and the settings of the instances in it under the names that formulas have for them.
fn derivations(patch: &Patch) -> Derivations<'_> {
    let mut derivations = Derivations::new();
    for (name, Scale { per_volt, unit, span }) in &patch.scales {
        let derivation = Derivation { formula: per_volt.as_ref(), unit, span: *span };
        derivations.insert(name.clone(), derivation);
    }
    for (instance, made) in &patch.instances {
        for (name, InstanceSetting { value, unit }) in &made.settings {
            let derivation = Derivation { formula: Some(value), unit, span: value.span };
            // A scale of that name has been told that it cannot have it.
            derivations.entry(format!("{instance}.{name}")).or_insert(derivation);
        }
    }
    derivations
}

/// Quantities of which some have other values.
pub(super) struct Varied<'q> {
    quantities: &'q Quantities,
    changed: HashMap<&'q str, Option<f64>>,
}

impl Scope for Varied<'_> {
    fn value(&self, name: &str) -> Option<f64> {
        self.changed.get(name).copied().unwrap_or_else(|| self.quantities.value(name))
    }

    fn dimension(&self, name: &str) -> Option<Dimension> {
        self.quantities.dimension(name)
    }

    fn declared_unit(&self, name: &str) -> Option<&str> {
        self.quantities.declared_unit(name)
    }

    fn names(&self) -> Vec<&str> {
        self.quantities.names()
    }
}
