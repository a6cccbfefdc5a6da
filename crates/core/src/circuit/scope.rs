//! The quantities that formulas can name: parameters, scales, settings of macros' instances and the time scale.
//!
//! Scales and settings of instances are *derived*: formulas of other quantities give them. They are evaluated in such
//! an order that each comes after the quantities in its formula. A derived quantity that depends on itself is reported.

mod cycles;
mod derived;

use std::collections::{BTreeSet, HashMap, HashSet};

use indexmap::IndexMap;

use super::parameters::parameters;
use crate::document::{
    ADVICE_WITHOUT_SCALES, Code, Diagnostic, Placed, Span, TIME_SCALE, check_cycles, formula_diagnostic,
    unit_mismatch,
};
use crate::patch::{Patch, UnreadNames};
use derived::{Derivation, derivations};
use patchcord_expr::{Dimension, Formula, FormulaDimension, Scope, Unit};

/// Values and units of everything that formulas can name.
///
/// # Examples
///
/// ```
/// use patchcord_core::circuit::Circuit;
/// use patchcord_core::patch::{ElementBuilder, PatchBuilder};
/// use patchcord_expr::{Formula, Scope};
///
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// let summer = ElementBuilder::new("summer").cords("x1", ["+100"]);
/// let builder = PatchBuilder::new("spring").parameter("k", 2.0, "N/mm", [0.0, 10.0]);
/// let circuit = Circuit::new(&builder.element("A1", summer).build()?)?;
/// // Formulas compute in SI units.
/// assert_eq!(Formula::parse("3 * k")?.evaluate(circuit.quantities())?, 6000.0);
/// assert_eq!(circuit.quantities().declared_unit("k"), Some("N/mm"));
/// assert!(circuit.is_literal(&Formula::parse("3 * 2")?));
/// # Ok(())
/// # }
/// ```
#[derive(Debug, Clone)]
pub struct Quantities {
    /// The parameters, in the order of the patch.
    parameters: IndexMap<String, Quantity>,
    /// The derived quantities: the scales, then the settings of macros' instances ("L1.T").
    derived: IndexMap<String, Quantity>,
    /// The formulas of the derived quantities.
    formulas: Vec<Formula>,
    /// Number of scales among the derived quantities.
    scale_count: usize,
    /// For each derived quantity, its rank in the order of evaluation. `None` if it depends on itself.
    ranks: Vec<Option<usize>>,
    /// Machine seconds per problem second.
    time_scale: f64,
    /// Names that the document may define in parts that could not be read.
    unread: UnreadNames,
    /// Whether the document can have scales. A problem cannot.
    has_scales: bool,
}

/// A quantity that formulas can name.
#[derive(Debug, Clone)]
pub(super) struct Quantity {
    /// The declared unit.
    pub unit: Unit,
    /// The value in SI units. `None` if it could not be computed; this was reported.
    pub value: Option<f64>,
}

impl Quantities {
    /// The quantities of a patch that may have faults. A quantity that cannot be computed has no value.
    ///
    /// # Examples
    ///
    /// ```
    /// use patchcord_core::circuit::Quantities;
    /// use patchcord_core::patch::Patch;
    /// use patchcord_expr::Scope;
    ///
    /// // The summer has no cord, and the scale names a parameter that is not there.
    /// let text = r#"{"patchcord": 1, "parameters": {"k": {"value": 2, "unit": "N/mm"}},
    ///     "scales": {"force": {"per_volt": "F / 5", "unit": "N"}},
    ///     "elements": {"A1": {"kind": "summer", "in": {}}}}"#;
    /// let quantities = Quantities::of(&Patch::parse("faulty.json", text)?);
    /// assert_eq!((quantities.value("k"), quantities.value("force")), (Some(2000.0), None));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn of(patch: &Patch) -> Quantities {
        Quantities::new(patch, &[], &mut Vec::new())
    }

    /// The parameters with their values, changed by `changes`, and the derived quantities computed from them.
    pub(super) fn new(patch: &Patch, changes: &[(String, f64)], findings: &mut Vec<Diagnostic>) -> Self {
        let derivations = derivations(patch);
        let unknown = |(name, derivation): (&String, &Derivation<'_>)| {
            (name.clone(), Quantity { unit: derivation.unit.clone(), value: None })
        };
        let formula = |derivation: &Derivation<'_>| match derivation.formula {
            Some(placed) => placed.value.clone(),
            None => Formula::constant(f64::NAN),
        };
        let mut quantities = Quantities {
            parameters: parameters(patch, changes, findings),
            derived: derivations.iter().map(unknown).collect(),
            formulas: derivations.values().map(formula).collect(),
            scale_count: patch.scales.len(),
            ranks: vec![None; derivations.len()],
            time_scale: patch.time_scale,
            unread: patch.unread_names().clone(),
            has_scales: !patch.is_problem(),
        };
        quantities.evaluate_derived(patch, &derivations, findings);
        quantities.check_unused_defaults(patch, findings);
        quantities
    }

    /// The parameters and derived quantities on which a formula depends, directly or through derived quantities.
    pub(super) fn dependencies(&self, formula: &Formula) -> Dependencies {
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

    /// The same quantities with other values of some parameters.
    ///
    /// `values` has indices of parameters with values in their declared units. `derived` has the derived quantities
    /// that are computed again, in order of evaluation.
    pub(super) fn varied(&self, values: &[(usize, f64)], derived: &[usize]) -> VariedQuantities<'_> {
        let in_si = |(parameter, value): &(usize, f64)| {
            let (name, quantity) = self.parameters.get_index(*parameter)?;
            Some((name.as_str(), Some(quantity.unit.to_si(*value))))
        };
        let mut varied =
            VariedQuantities { quantities: self, changed: values.iter().filter_map(in_si).collect() };
        for index in derived {
            let (name, formula) = self.derived(*index);
            let value = formula.evaluate(&varied).ok();
            varied.changed.insert(name, value.map(|value| self.in_si(formula, value, self.unit(*index))));
        }
        varied
    }

    /// The same quantities with another value of one scale, in SI units per volt. Scales that depend on it keep theirs.
    pub(super) fn with_scale(&self, scale: usize, per_volt: f64) -> VariedQuantities<'_> {
        let (name, _) = self.derived(scale);
        VariedQuantities { quantities: self, changed: HashMap::from([(name, Some(per_volt))]) }
    }

    /// The values of the parameters in their declared units, in the order of the patch. NaN if a value is unknown.
    pub(super) fn parameter_values(&self) -> impl Iterator<Item = f64> {
        self.parameters.values().map(|quantity| quantity.unit.out_of_si(quantity.value.unwrap_or(f64::NAN)))
    }

    /// Name and formula of a derived quantity.
    pub(super) fn derived(&self, index: usize) -> (&str, &Formula) {
        let name = self.derived.get_index(index).map_or("", |(name, _)| name);
        (name, &self.formulas[index])
    }

    /// Index of the derived quantity with this name.
    pub(super) fn derived_index(&self, name: &str) -> Option<usize> {
        self.derived.get_index_of(name)
    }

    /// Unit of a derived quantity.
    pub(super) fn unit(&self, index: usize) -> &Unit {
        &self.derived[index].unit
    }

    /// The value of one volt in a scale, in SI units. `None` if it could not be computed.
    pub(super) fn per_volt(&self, scale: usize) -> Option<f64> {
        self.derived.get_index(scale)?.1.value
    }

    /// Whether a formula consists of bare numbers. Its value is then in the unit that its context expects.
    pub fn is_literal(&self, formula: &Formula) -> bool {
        formula.dimension(self) == Ok(FormulaDimension::Literal)
    }

    /// The value of a formula in SI units. The value of a literal formula is in the expected unit.
    pub(super) fn in_si(&self, formula: &Formula, value: f64, unit: &Unit) -> f64 {
        if self.is_literal(formula) { unit.to_si(value) } else { value }
    }

    /// The value of a formula in SI units. `None` if it is not of this unit or not finite, which is reported.
    fn value_in_si(
        &self,
        placed: &Placed<Formula>,
        unit: &Unit,
        findings: &mut Vec<Diagnostic>,
    ) -> Option<f64> {
        let expected = unit.dimension();
        let value = self.checked(placed, |found| found == expected, &expected.to_string(), findings)?;
        check_cycles(placed, self, unit, findings)?;
        let value = self.in_si(&placed.value, value, unit);
        if !value.is_finite() {
            findings.push(too_large(placed.value.text(), placed.span));
            return None;
        }
        Some(value)
    }

    /// The value of a formula. `None` if its dimension does not satisfy `fits` or it cannot be evaluated; both are
    /// reported. `expected` describes the right dimension.
    pub(super) fn checked(
        &self,
        placed: &Placed<Formula>,
        fits: impl Fn(Dimension) -> bool,
        expected: &str,
        findings: &mut Vec<Diagnostic>,
    ) -> Option<f64> {
        self.check_unit(placed, self, fits, expected, findings)?;
        let value = placed.value.evaluate(self);
        value.map_err(|error| findings.push(formula_diagnostic(Code::BAD_FORMULA, placed, error))).ok()
    }

    /// Checks the unit of a formula whose names are in `scope`. `None` if the unit is wrong, which is reported.
    ///
    /// A formula with a quantity whose value is unknown gives `None` without a report: that fault was reported.
    pub(super) fn check_unit(
        &self,
        placed: &Placed<Formula>,
        scope: &dyn Scope,
        fits: impl Fn(Dimension) -> bool,
        expected: &str,
        findings: &mut Vec<Diagnostic>,
    ) -> Option<()> {
        let formula = &placed.value;
        if self.depends_on_unknown_value(formula) {
            return None;
        }
        let dimension = formula.dimension(scope);
        let mismatch = |error| unit_mismatch(scope, placed, error, Some(expected));
        let dimension = dimension.map_err(|error| findings.push(mismatch(error))).ok()?;
        if let FormulaDimension::Of(found) = dimension
            && !fits(found)
        {
            let message = format!("{} {}, but {expected} is expected here", formula.text(), describe(found));
            let hint = match fits(Dimension::NONE) {
                true => Some(self.divisor(found, fits(Dimension::VOLTAGE))),
                false => (!self.has_scales).then(|| ADVICE_WITHOUT_SCALES.to_owned()),
            };
            findings.push(Diagnostic::at(Code::UNIT_MISMATCH, placed.span, message).maybe_hint(hint));
            return None;
        }
        Some(())
    }

    /// The hint that names a divisor to get a pure number.
    ///
    /// A formula that must be in volts most often lacks the division by a scale, so the scales with its unit are named.
    /// No parameter is named: a parameter with the right unit is rarely the right divisor.
    fn divisor(&self, found: Dimension, expects_volts: bool) -> String {
        let scales = self.scales().filter(|(_, scale)| expects_volts && scale.unit.dimension() == found);
        let scales: Vec<&str> = scales.map(|(name, _)| name.as_str()).collect();
        match scales.as_slice() {
            _ if !self.has_scales => format!("divide it by a quantity in {found}, made of parameters"),
            [] => format!("divide it by a quantity in {found}, made of parameters and scales"),
            [only] => format!("divide it by the scale {only} to get volts"),
            several => {
                format!("divide it by the scale of this voltage to get volts: {}", several.join(" or "))
            }
        }
    }

    /// Whether a formula names a quantity without a value. Such a quantity has a fault that was reported.
    fn depends_on_unknown_value(&self, formula: &Formula) -> bool {
        formula.names().iter().any(|name| match self.find(name) {
            Some(quantity) => quantity.value.is_none(),
            None => self.unread.can_include(name) && *name != TIME_SCALE,
        })
    }

    /// The parameter or derived quantity with this name.
    fn find(&self, name: &str) -> Option<&Quantity> {
        self.parameters.get(name).or_else(|| self.derived.get(name))
    }

    /// The scales with their names.
    fn scales(&self) -> impl Iterator<Item = (&String, &Quantity)> {
        self.derived.iter().take(self.scale_count)
    }
}

/// The predicate of a message: "is a pure number" or "is in m/s".
fn describe(dimension: Dimension) -> String {
    if dimension.is_dimensionless() { "is a pure number".to_owned() } else { format!("is in {dimension}") }
}

/// The diagnostic for a value that overflows when it is converted to SI units or volts. `source` is the text of its
/// formula, or describes where the value is.
pub(super) fn too_large(source: &str, span: Span) -> Diagnostic {
    let message = format!("the value of {source} is too large");
    Diagnostic::at(Code::NOT_FINITE, span, message).hint("look for a wrong power of ten, here or in a scale")
}

impl Scope for Quantities {
    /// The time scale comes first: no parameter or scale can have its name.
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
        self.find(name).map(|quantity| quantity.unit.dimension())
    }

    fn declared_unit(&self, name: &str) -> Option<&str> {
        self.find(name).map(|quantity| quantity.unit.text())
    }

    fn has_scales(&self) -> bool {
        self.has_scales
    }

    fn names(&self) -> Vec<&str> {
        let scales = self.scales().map(|(name, _)| name);
        self.parameters.keys().chain(scales).map(String::as_str).chain([TIME_SCALE]).collect()
    }
}

/// The quantities on which a formula depends.
pub(super) struct Dependencies {
    /// Indices of the parameters, in rising order.
    pub parameters: Vec<usize>,
    /// Indices of the derived quantities, in order of evaluation.
    pub derived: Vec<usize>,
}

/// Quantities of which some have other values.
pub(super) struct VariedQuantities<'q> {
    /// The quantities with their present values.
    quantities: &'q Quantities,
    /// The changed values in SI units. `None` if a derived quantity has no value then.
    changed: HashMap<&'q str, Option<f64>>,
}

impl Scope for VariedQuantities<'_> {
    fn value(&self, name: &str) -> Option<f64> {
        self.changed.get(name).copied().unwrap_or_else(|| self.quantities.value(name))
    }

    /// A change of values does not change dimensions.
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
