//! Checks settings over the ranges of their parameters.
//!
//! A setting without an error at the present values can still be wrong elsewhere in the ranges, which the user would
//! notice only in a sweep. The lower bounds, middles and upper bounds of the ranges are tried. They find every fault of
//! a formula that is monotonic in each of its parameters, if these are at most six.
//!
//! [`Circuit::range_checks`] gives all checks as data, so that a program can narrow ranges. Only pot settings cause
//! warnings.

mod warning;

use std::collections::BTreeSet;
use std::f64::consts::TAU;

use super::is_of_signal;
use crate::circuit::{Circuit, Quantities};
use crate::elements::{Setting, SettingQuantity};
use crate::machines::REFERENCE;
use crate::patch::{Amount, ElementEntry, Patch};
use patchcord_expr::Formula;

/// Number of parameters of one check that are varied at most. Three values of each give 3^6 = 729 combinations.
const MAX_VARIED_PARAMETERS: usize = 6;

/// Rounding of the voltage of a drive, as a share of it.
const ROUNDING: f64 = 1e-12;

/// A rule for the settings of one element or drive, which some values of parameters within their ranges can break.
///
/// There are three rules. A setting has a value that its element permits, such as 0 to 1 for a pot and -100 to 100 V
/// for an initial voltage. A setting is below another one, such as the lower limit of an amplifier. The magnitudes of
/// the levels of a drive add up to at most 100 V, or to at most the present sum if that is larger; a rate counts with
/// the length of the run.
///
/// Values and ranges of parameters are in their declared units. Parameters are given by their indices in the patch.
pub struct RangeCheck<'c> {
    /// The element or the drive.
    element: &'c str,
    /// The setting; the lower one of two, and the first level of a drive.
    setting: &'static str,
    /// The rule with its formulas.
    rule: Rule<'c>,
    /// The parameters with a range on which the settings depend, at most [`MAX_VARIED_PARAMETERS`].
    parameters: Vec<usize>,
    /// The present values of all quantities.
    quantities: &'c Quantities,
    /// The patch, for the names of the parameters.
    patch: &'c Patch,
}

/// A rule for settings.
enum Rule<'c> {
    /// A setting has a value that its element permits.
    Permitted {
        /// The setting with its range.
        row: &'c Setting,
        /// Its value in its unit.
        value: Term<'c>,
    },
    /// A setting is below another one.
    Order {
        /// The lower setting.
        lower: Term<'c>,
        /// The upper setting.
        upper: Term<'c>,
        /// Whether the two may be equal.
        may_be_equal: bool,
    },
    /// The magnitudes of the levels of a drive have a largest sum.
    Level {
        /// The value of one volt in SI units.
        per_volt: Term<'c>,
        /// The levels in SI units.
        levels: Vec<Term<'c>>,
        /// The largest sum in volts.
        limit: f64,
    },
}

/// A formula in a rule.
struct Term<'c> {
    /// The formula.
    formula: &'c Formula,
    /// Indices of the derived quantities on which it depends, in order of evaluation.
    derived: Vec<usize>,
    /// Indices of the parameters on which it depends.
    parameters: Vec<usize>,
    /// The factor from the value of the formula to the unit of the rule.
    factor: f64,
}

/// A rule for settings that is broken by some values of parameters within their ranges.
#[derive(Debug, Clone, PartialEq)]
pub struct RangeFault {
    /// The element or the drive.
    pub element: String,
    /// The setting; the lower one of two, and the first level of a drive.
    pub setting: &'static str,
    /// The value of the setting in its unit, the upper setting minus the lower one, or the volts of the drive. `None` if
    /// it cannot be computed.
    pub value: Option<f64>,
    /// The parameters with the values that break the rule, in their declared units. The others have their present values.
    pub parameters: Vec<(String, f64)>,
}

impl Circuit {
    /// The checks of all settings that depend on parameters with ranges.
    ///
    /// # Examples
    ///
    /// ```
    /// use patchcord_core::circuit::Circuit;
    /// use patchcord_core::patch::{ElementBuilder, PatchBuilder};
    ///
    /// # fn main() -> Result<(), Box<dyn std::error::Error>> {
    /// let pot = ElementBuilder::new("pot").cord("in", "+100").set("setting", "k / 2");
    /// let patch = PatchBuilder::new("pot").parameter("k", 1.0, "1", [0.0, 3.0]).element("P1", pot).build()?;
    /// let circuit = Circuit::new(&patch)?;
    /// let checks = circuit.range_checks();
    /// assert_eq!((checks.len(), checks[0].parameters()), (1, &[0][..]));
    /// // The setting is 1.5 at k = 3.
    /// assert_eq!(checks[0].excess(&[(0, 3.0)]), 0.5);
    /// assert!(checks[0].fault(&[Some((0.0, 2.0))]).is_none());
    /// # Ok(())
    /// # }
    /// ```
    pub fn range_checks(&self) -> Vec<RangeCheck<'_>> {
        let entries = self.patch.drives.iter().chain(&self.patch.elements);
        let checks = entries.flat_map(|(name, entry)| {
            let subject = Subject { element: name, quantities: &self.quantities, patch: &self.patch };
            subject.checks(entry)
        });
        checks.filter(|check| !check.parameters.is_empty()).collect()
    }

    /// The settings that are wrong for some values of parameters within their ranges, each with a combination of values
    /// for which this happens.
    ///
    /// # Examples
    ///
    /// ```
    /// use patchcord_core::circuit::Circuit;
    /// use patchcord_core::patch::{ElementBuilder, PatchBuilder};
    ///
    /// # fn main() -> Result<(), Box<dyn std::error::Error>> {
    /// let integrator = ElementBuilder::new("integrator").cords("x1", ["A1"]).set("initial", "50 * k");
    /// let patch = PatchBuilder::new("decay").parameter("k", 1.0, "1", [0.0, 3.0]);
    /// let circuit = Circuit::new(&patch.element("A1", integrator).build()?)?;
    /// let faults = circuit.range_faults();
    /// assert_eq!((faults[0].element.as_str(), faults[0].setting), ("A1", "initial"));
    /// assert_eq!((faults[0].value, faults[0].parameters[0].clone()), (Some(150.0), ("k".to_owned(), 3.0)));
    /// # Ok(())
    /// # }
    /// ```
    pub fn range_faults(&self) -> Vec<RangeFault> {
        let ranges = ranges(&self.patch);
        self.range_checks().iter().filter_map(|check| check.fault(&ranges)).collect()
    }
}

/// The range of each parameter of a patch in its declared unit.
fn ranges(patch: &Patch) -> Vec<Option<(f64, f64)>> {
    patch.parameters.values().map(|parameter| parameter.range).collect()
}

/// An element or a drive whose settings are checked.
struct Subject<'c> {
    /// Its name.
    element: &'c str,
    /// The values and units of the names in formulas.
    quantities: &'c Quantities,
    /// The patch.
    patch: &'c Patch,
}

impl<'c> Subject<'c> {
    /// The checks of all its settings.
    fn checks(&self, entry: &'c ElementEntry) -> Vec<RangeCheck<'c>> {
        let single = formulas(entry).filter(|(row, _)| !is_of_signal(row.quantity));
        let mut checks: Vec<_> = single.map(|(row, formula)| self.permitted(row, formula)).collect();
        checks.extend(self.orders(entry));
        checks.extend(self.level(entry));
        checks
    }

    /// The check of one setting.
    fn permitted(&self, row: &'c Setting, formula: &'c Formula) -> RangeCheck<'c> {
        let is_angular = row.quantity == SettingQuantity::Hertz && self.quantities.is_angular(formula);
        let value = self.term(formula, if is_angular { 1.0 / TAU } else { 1.0 });
        self.check(row.name, Rule::Permitted { row, value })
    }

    /// The checks of settings that must be in order. A setting that the patch does not give is not checked.
    fn orders(&self, entry: &'c ElementEntry) -> Vec<RangeCheck<'c>> {
        let ordered = entry.kind.ordered.iter().map(|(lower, upper)| (*lower, *upper, false));
        let bounded = entry.kind.bounded.iter();
        let bounded =
            bounded.flat_map(|(lower, between, upper)| [(*lower, *between, true), (*between, *upper, true)]);
        let checks = ordered.chain(bounded).filter_map(|(lower, upper, may_be_equal)| {
            let [below, above] = [formula(entry, lower)?, formula(entry, upper)?];
            let rule =
                Rule::Order { lower: self.term(below, 1.0), upper: self.term(above, 1.0), may_be_equal };
            Some(self.check(lower, rule))
        });
        checks.collect()
    }

    /// The check of the levels of a drive. `None` if it has no levels, and for elements.
    fn level(&self, entry: &'c ElementEntry) -> Option<RangeCheck<'c>> {
        let scale = self.patch.scales.get_index_of(&entry.scale.as_ref()?.value)?;
        let duration = self.patch.run.duration.as_ref().map_or(0.0, |duration| duration.value);
        // A literal is in the unit of the scale.
        let unit = self.quantities.unit(scale).factor();
        let in_si = |formula: &Formula| if self.quantities.is_literal(formula) { unit } else { 1.0 };
        let rows = formulas(entry).filter(|(row, _)| is_of_signal(row.quantity));
        let (mut setting, mut levels) = (None, Vec::new());
        for (row, formula) in rows {
            let weight = if row.quantity == SettingQuantity::SignalRate { duration } else { 1.0 };
            levels.push(self.term(formula, weight * in_si(formula)));
            setting = setting.or(Some(row.name));
        }
        let (_, of_scale) = self.quantities.derived(scale);
        let per_volt = self.term(of_scale, in_si(of_scale));
        let mut check = self.check(setting?, Rule::Level { per_volt, levels, limit: REFERENCE });
        let present = check.value(&[]).unwrap_or_default();
        if let Rule::Level { limit, .. } = &mut check.rule {
            *limit = limit.max(present);
        }
        Some(check)
    }

    /// A formula with a factor.
    fn term(&self, formula: &'c Formula, factor: f64) -> Term<'c> {
        let dependencies = self.quantities.dependencies(formula);
        Term { formula, derived: dependencies.derived, parameters: dependencies.parameters, factor }
    }

    /// The check of a rule.
    fn check(&self, setting: &'static str, rule: Rule<'c>) -> RangeCheck<'c> {
        let parameters: BTreeSet<usize> =
            rule.terms().into_iter().flat_map(|term| term.parameters.iter().copied()).collect();
        let has_range = |index: &usize| self.patch.parameters[*index].range.is_some();
        let parameters = parameters.into_iter().filter(has_range).take(MAX_VARIED_PARAMETERS).collect();
        let Subject { element, quantities, patch } = *self;
        RangeCheck { element, setting, rule, parameters, quantities, patch }
    }
}

/// The settings of an element or drive that are formulas.
pub(super) fn formulas(entry: &ElementEntry) -> impl Iterator<Item = (&'static Setting, &Formula)> {
    let amounts = entry.settings.iter().map(|placed| placed.as_ref().map(|placed| &placed.value));
    entry.kind.settings.iter().zip(amounts).filter_map(|(row, amount)| match amount? {
        Amount::Formula(formula) => Some((row, formula)),
        Amount::Flag(_) | Amount::Choice(_) | Amount::Points(_) => None,
    })
}

/// The formula of the setting with this name. `None` if the patch does not give it.
fn formula<'c>(entry: &'c ElementEntry, name: &str) -> Option<&'c Formula> {
    formulas(entry).find(|(row, _)| row.name == name).map(|(_, formula)| formula)
}

impl RangeCheck<'_> {
    /// Indices of the parameters that are varied: at most six that have a range, in rising order.
    pub fn parameters(&self) -> &[usize] {
        &self.parameters
    }

    /// All combinations of the lower bounds, middles and upper bounds of the ranges of its parameters.
    ///
    /// The ranges are those of all parameters of the patch, in declared units. A combination has the index and the value
    /// of each varied parameter. Parameters without a range keep their value, and so do those after the first six.
    ///
    /// # Examples
    ///
    /// ```
    /// use patchcord_core::circuit::Circuit;
    /// use patchcord_core::patch::{ElementBuilder, PatchBuilder};
    ///
    /// # fn main() -> Result<(), Box<dyn std::error::Error>> {
    /// let pot = ElementBuilder::new("pot").cord("in", "+100").set("setting", "k / 2");
    /// let patch = PatchBuilder::new("pot").parameter("k", 1.0, "1", [0.0, 2.0]).element("P1", pot).build()?;
    /// let circuit = Circuit::new(&patch)?;
    /// let combinations = circuit.range_checks()[0].combinations(&[Some((0.5, 1.5))]);
    /// assert_eq!(combinations, [[(0, 0.5)], [(0, 1.0)], [(0, 1.5)]]);
    /// # Ok(())
    /// # }
    /// ```
    pub fn combinations(&self, ranges: &[Option<(f64, f64)>]) -> Vec<Vec<(usize, f64)>> {
        let range = |index: &usize| Some((*index, ranges.get(*index).copied().flatten()?));
        let mut combinations = vec![Vec::new()];
        for (index, (low, high)) in self.parameters.iter().filter_map(range) {
            let values = [low, (low + high) / 2.0, high];
            combinations = combinations
                .iter()
                .flat_map(|shorter| values.map(|value| [shorter.as_slice(), &[(index, value)]].concat()))
                .collect();
        }
        combinations
    }

    /// By how much the rule is broken at these values of parameters, each with its index: the distance of a setting from
    /// its range, of the upper setting from the lower one, or of a drive from its limit.
    ///
    /// It is negative if a value is too small, 0 if the rule holds, and infinity if a formula has no value.
    pub fn excess(&self, values: &[(usize, f64)]) -> f64 {
        match self.value(values) {
            Some(value) if value.is_finite() => self.rule.excess(value),
            _ => f64::INFINITY,
        }
    }

    /// A combination of values that breaks the rule, without the parameters whose present values break it too. It is the
    /// first one with ends of ranges only, if there is one. The ranges are those of all parameters of the patch, in
    /// declared units. `None` if the rule holds for all combinations.
    pub fn fault(&self, ranges: &[Option<(f64, f64)>]) -> Option<RangeFault> {
        let is_end = |(index, value): &(usize, f64)| {
            let range = ranges.get(*index).copied().flatten();
            range.is_some_and(|(low, high)| [low, high].contains(value))
        };
        let mut faulty = self.combinations(ranges);
        faulty.retain(|combination| self.excess(combination) != 0.0);
        let at_ends = faulty.iter().position(|combination| combination.iter().all(is_end));
        let combination = self.necessary(faulty.into_iter().nth(at_ends.unwrap_or(0))?);
        let named = |(index, value): &(usize, f64)| {
            let (name, _) = self.patch.parameters.get_index(*index)?;
            Some((name.clone(), *value))
        };
        Some(RangeFault {
            element: self.element.to_owned(),
            setting: self.setting,
            value: self.value(&combination),
            parameters: combination.iter().filter_map(named).collect(),
        })
    }

    /// The part of a combination that breaks the rule alone: the other parameters keep their present values.
    fn necessary(&self, mut combination: Vec<(usize, f64)>) -> Vec<(usize, f64)> {
        for parameter in &self.parameters {
            let others = combination.iter().copied().filter(|(index, _)| index != parameter);
            let others: Vec<(usize, f64)> = others.collect();
            if !others.is_empty() && self.excess(&others) != 0.0 {
                combination = others;
            }
        }
        combination
    }

    /// The value that the rule limits. `None` if a formula has no value.
    fn value(&self, values: &[(usize, f64)]) -> Option<f64> {
        let value_of = |term: &Term<'_>| {
            let quantities = self.quantities.varied(values, &term.derived);
            Some(term.factor * term.formula.evaluate(&quantities).ok()?)
        };
        match &self.rule {
            Rule::Permitted { value, .. } => value_of(value),
            Rule::Order { lower, upper, .. } => Some(value_of(upper)? - value_of(lower)?),
            Rule::Level { per_volt, levels, .. } => {
                let sizes = levels.iter().map(|level| Some(value_of(level)?.abs()));
                Some(sizes.sum::<Option<f64>>()? / value_of(per_volt)?.abs())
            }
        }
    }
}

impl<'c> Rule<'c> {
    /// The formulas of the rule.
    fn terms(&self) -> Vec<&Term<'c>> {
        match self {
            Rule::Permitted { value, .. } => vec![value],
            Rule::Order { lower, upper, .. } => vec![lower, upper],
            Rule::Level { per_volt, levels, .. } => [per_volt].into_iter().chain(levels).collect(),
        }
    }

    /// By how much a finite value breaks the rule: negative if it is too small. 0 if it does not.
    fn excess(&self, value: f64) -> f64 {
        match self {
            Rule::Permitted { row, .. } if row.is_allowed(value) => 0.0,
            Rule::Permitted { row, .. } if value < row.range.0 => value - row.range.0,
            Rule::Permitted { row, .. } => value - row.range.1,
            Rule::Order { may_be_equal, .. } if value > 0.0 || (*may_be_equal && value == 0.0) => 0.0,
            Rule::Order { .. } => value.min(-f64::MIN_POSITIVE),
            Rule::Level { limit, .. } if value <= limit * (1.0 + ROUNDING) => 0.0,
            Rule::Level { limit, .. } => value - limit,
        }
    }
}
