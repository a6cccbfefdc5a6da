//! The quantities that formulas may name: parameters, scales, the time scale.

use crate::patch::{
    Code, Diagnostic, Dimension, Formula, FormulaError, FormulaMeasure, Lost, Parameter, Patch, Placed,
    Scope, Span, Unit, suggestion, told,
};

/// Name under which formulas reach the machine seconds per problem second.
pub(crate) const TIME_SCALE: &str = "time_scale";

/// Values and units of everything that formulas may name.
#[derive(Debug, Clone)]
pub struct Quantities {
    parameters: Vec<Named>,
    scales: Vec<Named>,
    formulas: Vec<Formula>,
    time_scale: f64,
    lost: Lost,
}

#[derive(Debug, Clone)]
struct Named {
    name: String,
    unit: Unit,
    /// In SI; `None` where it could not be worked out, which has been reported.
    value: Option<f64>,
}

impl Quantities {
    /// Parameters at their values (changed by `changes`) and scales worked out of them.
    pub(super) fn new(patch: &Patch, changes: &[(String, f64)], findings: &mut Vec<Diagnostic>) -> Self {
        let mut quantities = Quantities {
            parameters: parameters(patch, changes, findings),
            scales: Vec::new(),
            formulas: Vec::new(),
            time_scale: patch.time_scale,
            lost: patch.lost().clone(),
        };
        quantities.work_out_scales(patch, findings);
        quantities
    }

    /// The same quantities with one parameter at another value (in its declared unit).
    pub(super) fn with(&self, parameter: usize, value: f64) -> Self {
        let mut changed = self.clone();
        let named = &mut changed.parameters[parameter];
        named.value = Some(named.unit.to_si(value));
        for index in 0..changed.scales.len() {
            changed.scales[index].value = changed.scale_value(index);
        }
        changed
    }

    /// The values of the parameters, in their declared units.
    pub(super) fn parameter_values(&self) -> impl Iterator<Item = f64> {
        self.parameters.iter().map(|named| named.unit.out_of_si(named.value.unwrap_or(f64::NAN)))
    }

    /// Name and formula of a scale.
    pub(super) fn scale(&self, index: usize) -> (&str, &Formula) {
        (&self.scales[index].name, &self.formulas[index])
    }

    /// One volt of a scale in SI, where it could be worked out.
    pub(super) fn per_volt(&self, scale: usize) -> Option<f64> {
        self.scales.get(scale)?.value
    }

    /// Whether a formula is made of bare numbers, and so takes the unit of its place.
    pub fn is_plain(&self, formula: &Formula) -> bool {
        formula.dimension(self) == Ok(FormulaMeasure::Free)
    }

    /// Scales may name other scales: each is worked out once those that it names are.
    fn work_out_scales(&mut self, patch: &Patch, findings: &mut Vec<Diagnostic>) {
        for (name, scale) in &patch.scales {
            self.scales.push(Named { name: name.clone(), unit: scale.unit.clone(), value: None });
            let formula = scale.per_volt.as_ref().map(|placed| placed.value.clone());
            self.formulas.push(formula.unwrap_or_else(|| Formula::constant(f64::NAN)));
        }
        let mut left: Vec<usize> = (0..self.scales.len()).collect();
        while let Some(ready) = left.iter().position(|index| self.is_ready(*index, &left)) {
            let index = left.remove(ready);
            if let Some(per_volt) = &patch.scales[index].per_volt {
                self.scales[index].value = self.checked_scale(index, per_volt, findings);
            }
        }
        self.report_rings(patch, &left, findings);
    }

    /// Reports scales that depend on themselves, each ring of them once.
    fn report_rings(&self, patch: &Patch, left: &[usize], findings: &mut Vec<Diagnostic>) {
        let mut reported = Vec::new();
        for index in left.iter().copied().filter(|index| self.leads_to(*index).contains(index)) {
            if reported.contains(&index) {
                continue;
            }
            let ring =
                self.leads_to(index).into_iter().filter(|other| self.leads_to(*other).contains(&index));
            let ring: Vec<_> = ring.collect();
            findings.push(self.ring(patch, index, &ring));
            reported.extend(ring);
        }
    }

    /// The scales that a scale names, and those that these name.
    fn leads_to(&self, index: usize) -> Vec<usize> {
        let mut reached = Vec::new();
        let mut next = vec![index];
        while let Some(index) = next.pop() {
            let names = self.formulas[index].names();
            let named =
                (0..self.scales.len()).filter(|other| names.contains(&self.scales[*other].name.as_str()));
            let new: Vec<_> = named.filter(|other| !reached.contains(other)).collect();
            reached.extend(&new);
            next.extend(new);
        }
        reached
    }

    fn ring(&self, patch: &Patch, index: usize, ring: &[usize]) -> Diagnostic {
        let names: Vec<_> = ring.iter().map(|index| self.scales[*index].name.as_str()).collect();
        let message = match names.as_slice() {
            [only] => format!("the scale {only} depends on itself"),
            names => format!("the scales {} depend on each other", names.join(", ")),
        };
        let scale = &patch.scales[index];
        let span = scale.per_volt.as_ref().map_or(scale.span, |placed| placed.span);
        Diagnostic::at(Code::BadFormula, span, message)
            .hint("give one of them as a number, or by parameters alone")
    }

    fn is_ready(&self, index: usize, left: &[usize]) -> bool {
        let names = self.formulas[index].names();
        left.iter().all(|other| !names.contains(&self.scales[*other].name.as_str()))
    }

    fn checked_scale(
        &self,
        index: usize,
        placed: &Placed<Formula>,
        findings: &mut Vec<Diagnostic>,
    ) -> Option<f64> {
        let wanted = self.scales[index].unit.dimension();
        let value =
            self.checked(placed, |found| found == wanted, &in_unit(&self.scales[index].unit), findings)?;
        let value = if self.is_plain(&placed.value) { self.scales[index].unit.to_si(value) } else { value };
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

    fn scale_value(&self, index: usize) -> Option<f64> {
        let value = self.formulas[index].evaluate(self).ok()?;
        Some(if self.is_plain(&self.formulas[index]) { self.scales[index].unit.to_si(value) } else { value })
    }

    /// A formula's value, once its unit is found fit.
    pub(super) fn checked(
        &self,
        placed: &Placed<Formula>,
        fits: impl Fn(Dimension) -> bool,
        wanted: &str,
        findings: &mut Vec<Diagnostic>,
    ) -> Option<f64> {
        let formula = &placed.value;
        if self.names_unknown_value(formula) {
            return None;
        }
        let measured = formula.dimension(self);
        let measure = measured.map_err(|error| findings.push(self.misfit(placed, error))).ok()?;
        if let FormulaMeasure::Of(found) = measure
            && !fits(found)
        {
            let message = format!("{} {}, and {wanted} is wanted here", formula.text(), measured_in(found));
            let hint = if fits(Dimension::NONE) { self.divisor(found) } else { None };
            findings.push(Diagnostic::at(Code::UnitMismatch, placed.span, message).maybe_hint(hint));
            return None;
        }
        let value = formula.evaluate(self);
        value.map_err(|error| findings.push(in_formula(Code::BadFormula, placed, error))).ok()
    }

    /// A formula whose unit cannot be told: it names something unknown, or its units do not agree.
    fn misfit(&self, placed: &Placed<Formula>, error: FormulaError) -> Diagnostic {
        let guilty = placed.value.text().get(error.range.clone()).unwrap_or_default();
        let is_name = placed.value.names().contains(&guilty) && self.dimension(guilty).is_none();
        if !is_name {
            return in_formula(Code::UnitMismatch, placed, error);
        }
        let hint = error.hint.clone().or_else(|| suggestion(guilty, &self.names()));
        in_formula(Code::UnknownName, placed, error).maybe_hint(hint)
    }

    /// What to divide by to be left with a pure number, where a scale does it.
    fn divisor(&self, found: Dimension) -> Option<String> {
        let scale = self.scales.iter().find(|scale| scale.unit.dimension() == found)?;
        Some(format!("divide it by the scale {}: that leaves volts", scale.name))
    }

    /// Whether a name stands for something that was itself reported as wrong.
    fn names_unknown_value(&self, formula: &Formula) -> bool {
        formula.names().iter().any(|name| match self.find(name) {
            Some(named) => named.value.is_none(),
            None => self.lost.may_hold(name) && *name != TIME_SCALE,
        })
    }

    fn find(&self, name: &str) -> Option<&Named> {
        self.parameters.iter().chain(&self.scales).find(|named| named.name == name)
    }
}

fn in_unit(unit: &Unit) -> String {
    unit.dimension().to_string()
}

fn measured_in(dimension: Dimension) -> String {
    if dimension.is_none() { "is a pure number".to_owned() } else { format!("is in {dimension}") }
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
        let named = self.parameters.iter().chain(&self.scales).map(|named| named.name.as_str());
        named.chain([TIME_SCALE]).collect()
    }
}

fn parameters(patch: &Patch, changes: &[(String, f64)], findings: &mut Vec<Diagnostic>) -> Vec<Named> {
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
        Named {
            name: name.clone(),
            unit: parameter.unit.clone(),
            value: fine.then(|| parameter.unit.to_si(value)),
        }
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
