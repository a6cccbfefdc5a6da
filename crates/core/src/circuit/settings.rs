//! Checks the settings of elements and drives: their units, their present values, and pot settings over the ranges of
//! their parameters.
//!
//! A setting is a formula, so its value can be wrong for some values of the parameters only. For pot settings this
//! gives a warning: the lower and upper bounds and the middles of the ranges are tried.
//!
//! The order of the checks is: unit, value, range, whole number, variation of the parameters. The first fault of a
//! setting ends its check. Relations between settings, such as an upper limit above the lower one, are checked last.

mod ranges;
mod rates;
mod scale_units;

use super::macros;
use super::resolve::Graph;
use super::scope::{Quantities, too_large};
use crate::document::{
    Code, Diagnostic, Placed, Span, format_distinct, format_number, format_outside, range_violation,
    unit_suffix,
};
use crate::elements::{REFERENCES, Setting, SettingDefault, SettingQuantity, Transfer};
use crate::machines::REFERENCE;
use crate::patch::{Amount, ElementEntry, Patch, is_time};
use patchcord_expr::{Dimension, Formula, FormulaDimension, Unit};

pub use ranges::{RangeCheck, RangeFault};
use rates::before_integrators;

/// Whether all cords of the patch are in the graph.
#[derive(Clone, Copy, PartialEq)]
pub(super) enum Cords {
    /// All cords are in the graph.
    Complete,
    /// Cords with faults are missing. An output without a cord may belong to any input.
    Incomplete,
}

/// Checks every setting of every element and drive. Scales must be resolved and quantities evaluated.
pub(super) fn check(
    patch: &Patch,
    quantities: &Quantities,
    graph: &Graph,
    cords: Cords,
    findings: &mut Vec<Diagnostic>,
) {
    let before_integrators = before_integrators(patch, graph, cords);
    let first = findings.len();
    // The graph has the references first, then drives and elements in the order of the document.
    let nodes = graph.node_indices().skip(REFERENCES.len());
    for (index, (name, entry)) in nodes.zip(patch.drives.iter().chain(&patch.elements)) {
        let before_integrator = before_integrators[index.index()];
        let scale = entry.scale.as_ref().and_then(|scale| patch.scales.get_index_of(&scale.value));
        let checker = SettingChecker { name, entry, patch, quantities, before_integrator, scale };
        let reported = findings.len();
        checker.check_all(findings);
        macros::add_name(patch, name, &mut findings[reported..]);
    }
    scale_units::explain(patch, quantities, &mut findings[first..]);
}

/// Checks the settings of one element or drive.
struct SettingChecker<'a> {
    /// Name of the element.
    name: &'a str,
    /// The element in the patch, with its kind and settings.
    entry: &'a ElementEntry,
    /// The patch, for its scales and for the ranges of its parameters.
    patch: &'a Patch,
    /// The values and units of the names in formulas.
    quantities: &'a Quantities,
    /// Whether the element is a pot that drives an integrator.
    before_integrator: bool,
    /// Index of the scale of a drive. `None` for elements, and for a drive whose scale does not exist.
    scale: Option<usize>,
}

impl SettingChecker<'_> {
    /// Checks each setting, and then the relations between settings.
    fn check_all(&self, findings: &mut Vec<Diagnostic>) {
        if self.has_zero_scale() {
            findings.push(self.zero_scale());
            return;
        }
        let mut values = vec![None; self.entry.settings.len()];
        for (index, row) in self.entry.kind.settings.iter().enumerate() {
            let Some(placed) = &self.entry.settings[index] else { continue };
            match &placed.value {
                Amount::Formula(formula) => {
                    let placed = Placed { value: formula.clone(), span: placed.span };
                    values[index] = self.checked_value(row, &placed, findings);
                }
                Amount::Points(points) => findings.extend(self.point_violation(points, placed.span)),
                Amount::Flag(_) | Amount::Choice(_) => (),
            }
        }
        self.check_order(&values, findings);
        self.check_bounds(&values, findings);
    }

    /// Whether one volt of the drive's scale is 0. A signal in such a scale is 0, but a drive would need infinite
    /// volts.
    fn has_zero_scale(&self) -> bool {
        self.scale.and_then(|scale| self.quantities.per_volt(scale)) == Some(0.0)
    }

    /// The diagnostic for a drive whose scale is 0 per volt.
    fn zero_scale(&self) -> Diagnostic {
        let (name, span) =
            self.entry.scale.as_ref().map_or(("", self.entry.span), |scale| (&scale.value, scale.span));
        let message = format!("the scale {name} of the drive {} is 0 per volt", self.name);
        Diagnostic::at(Code::BAD_NUMBER, span, message).hint("give the drive another scale")
    }

    /// The value of a setting. `None` if its unit or its value is wrong, which is reported.
    fn checked_value(
        &self,
        row: &Setting,
        placed: &Placed<Formula>,
        findings: &mut Vec<Diagnostic>,
    ) -> Option<f64> {
        if is_of_signal(row.quantity) && self.scale.is_none() {
            return None;
        }
        let expected = self.expected_unit(row.quantity);
        let reported = findings.len();
        let value =
            self.quantities.checked(placed, |found| self.fits(row.quantity, found), &expected, findings);
        self.explain_rate(row, placed, &mut findings[reported..]);
        let value = value?;
        if row.quantity == SettingQuantity::Volts && self.quantities.is_angular(&placed.value) {
            findings.push(self.angle_as_volts(placed));
            return None;
        }
        let value = match row.quantity {
            SettingQuantity::Hertz => self.quantities.checked_hertz(placed, value, findings)?,
            _ => value,
        };
        if is_of_signal(row.quantity) && !self.volts(placed, value).is_finite() {
            findings.push(too_large(placed.value.text(), placed.span));
            return None;
        }
        if !row.is_allowed(value) {
            findings.push(self.out_of_range(row, placed, value));
            return None;
        }
        if row.quantity == SettingQuantity::Whole && value.fract() != 0.0 {
            let message = format!(
                "\"{}\" of {} must be a whole number, but is {}",
                row.name,
                self.name,
                format_distinct(value, value.round())
            );
            findings.push(Diagnostic::at(Code::BAD_NUMBER, placed.span, message));
            return None;
        }
        if row.quantity == SettingQuantity::Fraction {
            self.check_over_ranges(row, placed, findings);
        }
        Some(value)
    }

    /// Replaces the hint about a pot that is set to a rate and does not drive an integrator.
    fn explain_rate(&self, row: &Setting, placed: &Placed<Formula>, findings: &mut [Diagnostic]) {
        let is_pot = row.quantity == SettingQuantity::Fraction && self.entry.kind.transfer == Transfer::Share;
        let found = placed.value.dimension(self.quantities);
        let is_rate = found == Ok(FormulaDimension::Of(Dimension::FREQUENCY));
        if is_pot && is_rate && !self.before_integrator {
            let hint = "a pot that drives an integrator may be set to a rate: exchange it with the amplifier behind it";
            findings.iter_mut().for_each(|finding| finding.hint = Some(hint.to_owned()));
        }
    }

    /// The diagnostic for an angle in place of volts. Angles are pure numbers, so their dimension does not show it.
    fn angle_as_volts(&self, placed: &Placed<Formula>) -> Diagnostic {
        let is_angle =
            |name: &&String| Formula::parse(name).is_ok_and(|formula| self.quantities.is_angular(&formula));
        let scales: Vec<&str> = self.patch.scales.keys().filter(is_angle).map(String::as_str).collect();
        let divisor = match scales.as_slice() {
            [] => "a scale in rad or deg".to_owned(),
            several => format!("the scale {}", several.join(" or ")),
        };
        let message = format!("{} is an angle, but a number of volts is expected here", placed.value.text());
        let hint = format!("divide it by {divisor} to get volts");
        Diagnostic::at(Code::UNIT_MISMATCH, placed.span, message).hint(hint)
    }

    /// Unit of the drive's scale.
    fn unit(&self) -> Option<&Unit> {
        Some(&self.patch.scales[self.scale?].unit)
    }

    /// The voltage for a value of a drive. It is 0 if the scale has no value, which was reported.
    ///
    /// The value of a formula with names is in SI units: volts = value / (value of one volt). A literal is in the unit
    /// of the scale and is converted first.
    fn volts(&self, placed: &Placed<Formula>, value: f64) -> f64 {
        let (Some(unit), Some(volt)) =
            (self.unit(), self.scale.and_then(|scale| self.quantities.per_volt(scale)))
        else {
            return 0.0;
        };
        self.quantities.in_si(&placed.value, value, unit) / volt
    }

    /// The diagnostic for the first point of a drive whose voltage is not finite. `None` if there is none, and for the
    /// curve of an element, which is in volts.
    ///
    /// A factor that is not finite is reported when the patch is lowered.
    fn point_violation(&self, points: &[[f64; 2]], span: Span) -> Option<Diagnostic> {
        let unit = self.unit()?;
        let volts_per_unit = unit.factor() / self.quantities.per_volt(self.scale?)?;
        let is_violation = |[_, value]: &&[f64; 2]| !(volts_per_unit * value).is_finite();
        let [time, value] = points.iter().find(is_violation).filter(|_| volts_per_unit.is_finite())?;
        let (value, time) = (format_number(*value), format_number(*time));
        let source = format!("{value}{} at {time} s in the table of {}", unit_suffix(unit.text()), self.name);
        Some(too_large(&source, span))
    }

    /// Whether a dimension is right for a setting of this quantity.
    ///
    /// A pot in front of an integrator may have the unit 1/s: the pot and the gain of the integrator then are a rate.
    fn fits(&self, quantity: SettingQuantity, found: Dimension) -> bool {
        let unit = self.unit().map_or(Dimension::NONE, Unit::dimension);
        match quantity {
            SettingQuantity::Fraction => {
                found.is_dimensionless() || (self.before_integrator && found == Dimension::FREQUENCY)
            }
            SettingQuantity::Volts => found.is_dimensionless() || found == Dimension::VOLTAGE,
            SettingQuantity::MachineSeconds | SettingQuantity::Seconds => is_time(self.patch, found),
            SettingQuantity::Hertz => found == Dimension::FREQUENCY,
            SettingQuantity::RadiansPerVolt => {
                found.is_dimensionless() || found == Dimension::NONE.over(Dimension::VOLTAGE)
            }
            SettingQuantity::Signal => found == unit,
            SettingQuantity::SignalRate => found == unit.over(Dimension::TIME),
            _ => found.is_dimensionless(),
        }
    }

    /// The right unit of a setting of this quantity, for messages.
    fn expected_unit(&self, quantity: SettingQuantity) -> String {
        let unit = self.unit().map_or(Dimension::NONE, Unit::dimension);
        match quantity {
            SettingQuantity::Fraction if self.before_integrator => {
                "a pure number (or 1/s, before an integrator)".to_owned()
            }
            SettingQuantity::Volts => "a number of volts".to_owned(),
            SettingQuantity::MachineSeconds | SettingQuantity::Seconds => "a time in s".to_owned(),
            SettingQuantity::Hertz => "a frequency in Hz, 1/s, rad/s or rpm".to_owned(),
            SettingQuantity::RadiansPerVolt => "a number of rad/V".to_owned(),
            SettingQuantity::Signal => unit.to_string(),
            SettingQuantity::SignalRate => unit.over(Dimension::TIME).to_string(),
            _ => "a pure number".to_owned(),
        }
    }

    /// The diagnostic for a value outside the range of the setting.
    ///
    /// The message shows the value in the unit of the setting. The hint depends on the fault: a negative pot setting
    /// needs an inverter, a pot setting above 1 needs a larger gain, and a voltage above 100 V needs other scales.
    fn out_of_range(&self, row: &Setting, placed: &Placed<Formula>, value: f64) -> Diagnostic {
        let code =
            if row.quantity == SettingQuantity::Fraction { Code::SETTING_OUTSIDE } else { Code::BAD_NUMBER };
        let unit = self.value_unit(row, &placed.value);
        let violation = range_violation(value, row.range, &unit);
        let value_text = format!("{}{}", format_outside(value, row.range), unit_suffix(&unit));
        let message = format!("\"{}\" of {} is {value_text}, {violation}", row.name, self.name);
        let hint = match code {
            Code::SETTING_OUTSIDE if value < row.range.0 => {
                "a pot cannot invert: put a summer in front of it"
            }
            Code::SETTING_OUTSIDE => "divide it by 10 and use an input with 10 times the gain, or rescale",
            _ if row.quantity == SettingQuantity::Volts && value.abs() > REFERENCE => {
                "rescale: the machine works between -100 and 100 V"
            }
            _ => row.description,
        };
        Diagnostic::at(code, placed.span, message).hint(hint)
    }

    /// The unit of a setting's value for messages. Empty for a pure number.
    ///
    /// The value of a literal formula is in the scale's unit, that of another formula in SI units.
    fn value_unit(&self, row: &Setting, formula: &Formula) -> String {
        let scale_unit = |unit: &Unit| match self.quantities.is_literal(formula) {
            true => unit.text().to_owned(),
            false => unit.dimension().to_string(),
        };
        match (row.quantity, self.unit()) {
            (SettingQuantity::Fraction | SettingQuantity::Ratio | SettingQuantity::Whole, _) => String::new(),
            (SettingQuantity::Signal, Some(unit)) => scale_unit(unit),
            (SettingQuantity::SignalRate, Some(unit)) => format!("{} per s", scale_unit(unit)),
            _ => row.unit().to_owned(),
        }
    }

    /// Reports a setting that is not below the setting that must exceed it.
    ///
    /// The two names are a pair in the kind's `ordered`, such as "limit.lower" and "limit.upper".
    fn check_order(&self, values: &[Option<f64>], findings: &mut Vec<Diagnostic>) {
        for (lower, upper) in self.entry.kind.ordered {
            let value = |name: &str| self.entry.kind.setting(name).and_then(|index| values[index]);
            if let (Some(low), Some(high)) = (value(lower), value(upper))
                && low >= high
            {
                let hint = self.order_hint(lower, upper, low == high);
                let [low, high] = [format_distinct(low, high), format_distinct(high, low)];
                let message =
                    format!("{lower} of {} is {low}, which is not below {upper} = {high}", self.name);
                findings.push(Diagnostic::at(Code::BAD_NUMBER, self.position(lower), message).hint(hint));
            }
        }
    }

    /// The hint for two settings in the wrong order. A relay cannot have equal thresholds; a comparator has one.
    fn order_hint(&self, lower: &str, upper: &str, is_equal: bool) -> String {
        let is_relay = !self.entry.kind.positions.is_empty();
        match (is_equal, is_relay) {
            (true, true) => {
                format!(
                    "lower \"{lower}\" or raise \"{upper}\"; for a single threshold, use a \"comparator\", which \
                     has no hysteresis"
                )
            }
            (true, false) => format!("lower \"{lower}\" or raise \"{upper}\": the two must differ"),
            (false, _) => "exchange the two, or change one of them".to_owned(),
        }
    }

    /// Reports a setting that is not between the two settings that bound it. A missing bound does not count.
    ///
    /// The three names are a triple in the kind's `bounded`: the lower bound, the bounded setting and the upper bound.
    /// The position is that of the bounded setting, or of the bound if the patch omits the bounded setting.
    fn check_bounds(&self, values: &[Option<f64>], findings: &mut Vec<Diagnostic>) {
        let value = |name: &str| self.value(values, name);
        for (lower, between, upper) in self.entry.kind.bounded {
            let Some(inner) = value(between) else { continue };
            let below = value(lower).filter(|low| inner < *low).map(|low| (lower, "below", low));
            let above = value(upper).filter(|high| inner > *high).map(|high| (upper, "above", high));
            for (bound, side, limit) in below.into_iter().chain(above) {
                let [inner, limit] = [format_distinct(inner, limit), format_distinct(limit, inner)];
                let message = format!("{between} of {} is {inner}, {side} {bound} = {limit}", self.name);
                let span = if self.is_set(between) { self.position(between) } else { self.position(bound) };
                let hint = format!("set \"{between}\" inside the limits, or change the limit");
                findings.push(Diagnostic::at(Code::BAD_NUMBER, span, message).hint(hint));
            }
        }
    }

    /// The value of a setting, or its default if the patch does not give it. `None` if it has neither.
    fn value(&self, values: &[Option<f64>], name: &str) -> Option<f64> {
        let index = self.entry.kind.setting(name)?;
        match (&self.entry.settings[index], self.entry.kind.settings[index].default) {
            (None, SettingDefault::Number(number)) => Some(number),
            _ => values[index],
        }
    }

    /// Whether the patch gives a setting.
    fn is_set(&self, name: &str) -> bool {
        self.entry.kind.setting(name).is_some_and(|index| self.entry.settings[index].is_some())
    }

    /// Position of a setting, or of the element if the patch does not give the setting.
    fn position(&self, name: &str) -> Span {
        let placed = self.entry.kind.setting(name).and_then(|index| self.entry.settings[index].as_ref());
        placed.map_or(self.entry.span, |placed| placed.span)
    }
}

/// Whether a setting is in the unit of the drive's scale, or in this unit per second.
fn is_of_signal(quantity: SettingQuantity) -> bool {
    matches!(quantity, SettingQuantity::Signal | SettingQuantity::SignalRate)
}

#[cfg(test)]
mod tests;
