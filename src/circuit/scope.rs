//! The quantities that formulas may name: parameters, scales, the time scale.

use crate::patch::{
    Code, Diagnostic, Dimension, Formula, FormulaMeasure, Patch, Placed, Scope, Unit, suggestion,
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
        for index in left {
            let message = format!("the scale {} depends on itself", self.scales[index].name);
            findings.push(Diagnostic::at(Code::BadFormula, patch.scales[index].span, message));
        }
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
        if value == 0.0 {
            findings.push(Diagnostic::at(
                Code::BadNumber,
                placed.span,
                "a scale of 0 per volt measures nothing",
            ));
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
        let measured = formula.dimension(self).and_then(|measure| Ok((measure, formula.evaluate(self)?)));
        let (measure, value) =
            measured.map_err(|error| findings.push(formula_finding(placed, error))).ok()?;
        if let FormulaMeasure::Of(found) = measure
            && !fits(found)
        {
            let message = format!("{} is in {found}, and {wanted} is wanted here", formula.text());
            findings.push(Diagnostic::at(Code::UnitMismatch, placed.span, message));
            return None;
        }
        Some(value)
    }

    /// Whether a name stands for something that was itself reported as wrong.
    fn names_unknown_value(&self, formula: &Formula) -> bool {
        formula.names().iter().any(|name| self.find(name).is_some_and(|named| named.value.is_none()))
    }

    fn find(&self, name: &str) -> Option<&Named> {
        self.parameters.iter().chain(&self.scales).find(|named| named.name == name)
    }
}

fn in_unit(unit: &Unit) -> String {
    unit.dimension().to_string()
}

/// A formula's own error, at its place in the document.
pub(super) fn formula_finding(placed: &Placed<Formula>, error: crate::patch::FormulaError) -> Diagnostic {
    let inside = error.range.start + 1..error.range.end + 1;
    let span = if placed.value.names().is_empty() { placed.span } else { placed.span.part(&inside) };
    let unit_error = [" is in ", " is a pure number"].iter().any(|words| error.message.contains(words));
    let code = if unit_error { Code::UnitMismatch } else { Code::BadFormula };
    Diagnostic::at(code, span, error.message).maybe_hint(error.hint)
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
        let place = change.is_none().then_some(parameter.span);
        let fine = in_range(name, value, parameter.range, parameter.unit.text(), place, findings);
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
    range: Option<(f64, f64)>,
    unit: &str,
    span: Option<crate::patch::Span>,
    findings: &mut Vec<Diagnostic>,
) -> bool {
    if !value.is_finite() {
        let message = format!("{name} is set to {value}, which is not a number");
        findings.push(Diagnostic { code: Code::NotFinite, span, message, hint: None });
        return false;
    }
    let Some((low, high)) = range.filter(|(low, high)| value < *low || value > *high) else { return true };
    let message = format!("{name} = {value} {unit} is outside its range {low} ... {high} {unit}");
    let hint = "widen the range in the patch if the circuit can take it".to_owned();
    findings.push(Diagnostic { code: Code::OutsideRange, span, message, hint: Some(hint) });
    false
}
