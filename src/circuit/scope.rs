//! The quantities that formulas may name: parameters, scales, the time scale.

use std::collections::{BTreeSet, HashMap, HashSet};

use indexmap::IndexMap;
use petgraph::algo::kosaraju_scc;
use petgraph::graph::{DiGraph, NodeIndex};

use crate::patch::{
    Code, Diagnostic, Dimension, Formula, FormulaError, FormulaMeasure, Lost, Parameter, Patch, Placed,
    Scale, Scope, Span, Unit, suggestion, told,
};

/// Name under which formulas reach the machine seconds per problem second.
pub(crate) const TIME_SCALE: &str = "time_scale";

/// Values and units of everything that formulas may name.
#[derive(Debug, Clone)]
pub struct Quantities {
    parameters: IndexMap<String, Named>,
    scales: IndexMap<String, Named>,
    formulas: Vec<Formula>,
    /// The scales that can be worked out, each after those that it names.
    order: Vec<usize>,
    time_scale: f64,
    lost: Lost,
}

#[derive(Debug, Clone)]
struct Named {
    unit: Unit,
    /// In SI; `None` where it could not be worked out, which has been reported.
    value: Option<f64>,
}

impl Quantities {
    /// Parameters at their values (changed by `changes`) and scales worked out of them.
    pub(super) fn new(patch: &Patch, changes: &[(String, f64)], findings: &mut Vec<Diagnostic>) -> Self {
        let unknown = |scale: &Scale| Named { unit: scale.unit.clone(), value: None };
        let formula = |scale: &Scale| match &scale.per_volt {
            Some(placed) => placed.value.clone(),
            None => Formula::constant(f64::NAN),
        };
        let mut quantities = Quantities {
            parameters: parameters(patch, changes, findings),
            scales: patch.scales.iter().map(|(name, scale)| (name.clone(), unknown(scale))).collect(),
            formulas: patch.scales.values().map(formula).collect(),
            order: Vec::new(),
            time_scale: patch.time_scale,
            lost: patch.lost().clone(),
        };
        quantities.work_out_scales(patch, findings);
        quantities
    }

    /// The parameters that a formula names, itself or through scales, and these scales in their order.
    pub(super) fn named_in(&self, formula: &Formula) -> Dependencies {
        let (mut parameters, mut scales) = (BTreeSet::new(), HashSet::new());
        let mut open = vec![formula];
        while let Some(formula) = open.pop() {
            for name in formula.names() {
                parameters.extend(self.parameters.get_index_of(name));
                let scale = self.scales.get_index_of(name).filter(|scale| scales.insert(*scale));
                open.extend(scale.map(|scale| &self.formulas[scale]));
            }
        }
        let scales = self.order.iter().copied().filter(|scale| scales.contains(scale)).collect();
        Dependencies { parameters: parameters.into_iter().collect(), scales }
    }

    /// The same quantities with parameters at other values (in their declared units), and these scales with them.
    pub(super) fn varied(&self, values: &[(usize, f64)], scales: &[usize]) -> Varied<'_> {
        let in_si = |(parameter, value): &(usize, f64)| {
            let (name, named) = self.parameters.get_index(*parameter)?;
            Some((name.as_str(), Some(named.unit.to_si(*value))))
        };
        let mut varied = Varied { quantities: self, changed: values.iter().filter_map(in_si).collect() };
        for scale in scales {
            let value = self.formulas[*scale].evaluate(&varied).ok();
            let value =
                value.map(|value| self.in_si(&self.formulas[*scale], value, &self.scales[*scale].unit));
            varied.changed.insert(self.scale(*scale).0, value);
        }
        varied
    }

    /// The values of the parameters, in their declared units.
    pub(super) fn parameter_values(&self) -> impl Iterator<Item = f64> {
        self.parameters.values().map(|named| named.unit.out_of_si(named.value.unwrap_or(f64::NAN)))
    }

    /// Name and formula of a scale.
    pub(super) fn scale(&self, index: usize) -> (&str, &Formula) {
        let name = self.scales.get_index(index).map_or("", |(name, _)| name);
        (name, &self.formulas[index])
    }

    /// One volt of a scale in SI, where it could be worked out.
    pub(super) fn per_volt(&self, scale: usize) -> Option<f64> {
        self.scales.get_index(scale)?.1.value
    }

    /// Whether a formula is made of bare numbers, and so takes the unit of its place.
    pub fn is_plain(&self, formula: &Formula) -> bool {
        formula.dimension(self) == Ok(FormulaMeasure::Free)
    }

    /// What a formula came to, in SI: a plain number stands in the unit of its place.
    pub(super) fn in_si(&self, formula: &Formula, value: f64, unit: &Unit) -> f64 {
        if self.is_plain(formula) { unit.to_si(value) } else { value }
    }

    /// Scales may name other scales: each is worked out once those that it names are.
    fn work_out_scales(&mut self, patch: &Patch, findings: &mut Vec<Diagnostic>) {
        let naming = self.naming();
        // A component comes after those that it names.
        for mut members in kosaraju_scc(&naming) {
            members.sort_unstable();
            let first = members[0];
            if members.len() > 1 || naming.contains_edge(first, first) {
                findings.push(self.ring(patch, &members));
                continue;
            }
            self.order.push(first.index());
            if let Some(per_volt) = &patch.scales[first.index()].per_volt {
                self.scales[first.index()].value = self.checked_scale(first.index(), per_volt, findings);
            }
        }
    }

    /// Which scales name which.
    fn naming(&self) -> DiGraph<(), ()> {
        let mut naming = DiGraph::new();
        for _ in &self.formulas {
            naming.add_node(());
        }
        for (index, formula) in self.formulas.iter().enumerate() {
            for named in formula.names().into_iter().filter_map(|name| self.scales.get_index_of(name)) {
                naming.add_edge(NodeIndex::new(index), NodeIndex::new(named), ());
            }
        }
        naming
    }

    /// Scales that depend on themselves.
    fn ring(&self, patch: &Patch, ring: &[NodeIndex]) -> Diagnostic {
        let names: Vec<_> = ring.iter().map(|index| self.scale(index.index()).0).collect();
        let message = match names.as_slice() {
            [only] => format!("the scale {only} depends on itself"),
            names => format!("the scales {} depend on each other", names.join(", ")),
        };
        let scale = &patch.scales[ring[0].index()];
        let span = scale.per_volt.as_ref().map_or(scale.span, |placed| placed.span);
        Diagnostic::at(Code::BadFormula, span, message)
            .hint("give one of them as a number, or by parameters alone")
    }

    fn checked_scale(
        &self,
        index: usize,
        placed: &Placed<Formula>,
        findings: &mut Vec<Diagnostic>,
    ) -> Option<f64> {
        let unit = &self.scales[index].unit;
        let wanted = unit.dimension();
        let value = self.checked(placed, |found| found == wanted, &wanted.to_string(), findings)?;
        let value = self.in_si(&placed.value, value, unit);
        if value == 0.0 && self.is_plain(&placed.value) {
            let message = "a scale of 0 per volt measures nothing";
            let hint = "per_volt is what one volt stands for";
            findings.push(Diagnostic::at(Code::BadNumber, placed.span, message).hint(hint));
            return None;
        }
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
        let measure = measured.map_err(|error| findings.push(misfit(placed, scope, error))).ok()?;
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
        if let Some((name, _)) = self.scales.iter().find(|(_, scale)| scale.unit.dimension() == found) {
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
        self.parameters.get(name).or_else(|| self.scales.get(name))
    }
}

fn measured_in(dimension: Dimension) -> String {
    if dimension.is_none() { "is a pure number".to_owned() } else { format!("is in {dimension}") }
}

/// A formula whose unit cannot be told: it names something unknown, or its units do not agree.
fn misfit(placed: &Placed<Formula>, scope: &dyn Scope, error: FormulaError) -> Diagnostic {
    let guilty = placed.value.text().get(error.range.clone()).unwrap_or_default();
    let is_name = placed.value.names().contains(&guilty) && scope.dimension(guilty).is_none();
    if !is_name {
        return in_formula(Code::UnitMismatch, placed, error);
    }
    let hint = error.hint.clone().or_else(|| suggestion(guilty, &scope.names()));
    in_formula(Code::UnknownName, placed, error).maybe_hint(hint)
}

/// A formula's own error, at its place in the document. Only a formula in quotes can have one.
fn in_formula(code: Code, placed: &Placed<Formula>, error: FormulaError) -> Diagnostic {
    let inside = error.range.start + 1..error.range.end + 1;
    Diagnostic::at(code, placed.span.part(&inside), error.message).maybe_hint(error.hint)
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

    fn names(&self) -> Vec<&str> {
        let named = self.parameters.keys().chain(self.scales.keys()).map(String::as_str);
        named.chain([TIME_SCALE]).collect()
    }
}

/// What the value of a formula depends on.
pub(super) struct Dependencies {
    pub parameters: Vec<usize>,
    pub scales: Vec<usize>,
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

    fn names(&self) -> Vec<&str> {
        self.quantities.names()
    }
}

fn parameters(
    patch: &Patch,
    changes: &[(String, f64)],
    findings: &mut Vec<Diagnostic>,
) -> IndexMap<String, Named> {
    let known: Vec<&str> = patch.parameters.keys().map(String::as_str).collect();
    for (name, _) in changes.iter().filter(|(name, _)| !patch.parameters.contains_key(name)) {
        let message = format!("there is no parameter {name} to set");
        findings.push(Diagnostic::nowhere(Code::UnknownName, message).maybe_hint(suggestion(name, &known)));
    }
    let named = patch.parameters.iter().map(|(name, parameter)| {
        let change = changes.iter().rev().find(|(changed, _)| changed == name).map(|(_, value)| *value);
        let value = change.unwrap_or(parameter.value);
        let place = change.is_none().then_some(parameter.value_span);
        let fine = in_range(name, value, parameter, place, findings);
        let value = fine.then(|| parameter.unit.to_si(value));
        (name.clone(), Named { unit: parameter.unit.clone(), value })
    });
    named.collect()
}

fn in_range(
    name: &str,
    value: f64,
    parameter: &Parameter,
    span: Option<Span>,
    findings: &mut Vec<Diagnostic>,
) -> bool {
    let unit = parameter.unit.text();
    if !parameter.unit.to_si(value).is_finite() {
        let message = format!("{name} is set to {value} {unit}, which cannot be reckoned with");
        let hint = Some("every number of a patch must be finite".to_owned());
        findings.push(Diagnostic { code: Code::NotFinite, span, message, hint });
        return false;
    }
    let outside = parameter.range.filter(|(low, high)| value < *low || value > *high);
    let Some((low, high)) = outside else { return true };
    let [value, low, high] = [value, low, high].map(told);
    let message = format!("{name} = {value} {unit} is outside its range {low} ... {high} {unit}");
    let hint = "widen the range in the patch if the circuit can take it".to_owned();
    findings.push(Diagnostic { code: Code::OutsideRange, span, message, hint: Some(hint) });
    false
}
