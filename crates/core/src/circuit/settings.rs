//! Checks the settings of elements and drives: their units, their present values, and pot settings over the ranges of
//! their parameters.
//!
//! A setting is a formula, so its value can be wrong for some values of the parameters only. For pot settings this
//! gives a warning: the lower and upper bounds and the middles of the ranges are tried.
//!
//! The order of the checks is: unit, value, range, whole number, variation of the parameters. The first fault of a
//! setting ends its check. Relations between settings, such as an upper limit above the lower one, are checked last.

use petgraph::Direction;
use petgraph::graph::NodeIndex;

use super::macros;
use super::resolve::Graph;
use super::scope::{Quantities, too_large};
use crate::document::{Code, Diagnostic, Placed, Span, format_number};
use crate::elements::{Default, Measure, REFERENCES, Setting, Transfer};
use crate::machines::REFERENCE;
use crate::patch::{Amount, ElementEntry, Patch};
use patchcord_expr::{Dimension, Formula, Unit};

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
    let before_integrators = before_integrators(graph, cords);
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
}

/// For every element, whether it is a pot that drives an integrator, directly or through other pots.
///
/// The setting of such a pot may be a rate in 1/s. If cords are missing, every pot without a cord counts as well.
fn before_integrators(graph: &Graph, cords: Cords) -> Vec<bool> {
    let has_transfer = |index: NodeIndex, transfer| graph[index].kind.transfer == transfer;
    let may_lack_cord = |index: &NodeIndex| {
        cords == Cords::Incomplete
            && has_transfer(*index, Transfer::Share)
            && graph.neighbors(*index).next().is_none()
    };
    let mut drives_integrator = vec![false; graph.node_count()];
    let mut unvisited: Vec<_> = graph.node_indices().filter(may_lack_cord).collect();
    unvisited.iter().for_each(|index| drives_integrator[index.index()] = true);
    unvisited.extend(graph.node_indices().filter(|index| has_transfer(*index, Transfer::Integrating)));
    while let Some(index) = unvisited.pop() {
        let drivers = graph.neighbors_directed(index, Direction::Incoming);
        for driver in drivers.filter(|driver| has_transfer(*driver, Transfer::Share)) {
            if !std::mem::replace(&mut drives_integrator[driver.index()], true) {
                unvisited.push(driver);
            }
        }
    }
    drives_integrator
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
            if let Amount::Formula(formula) = &placed.value {
                let placed = Placed { value: formula.clone(), span: placed.span };
                values[index] = self.checked_value(row, &placed, findings);
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
        if is_of_signal(row.measure) && self.scale.is_none() {
            return None;
        }
        let expected = self.expected_unit(row.measure);
        let value =
            self.quantities.checked(placed, |found| self.fits(row.measure, found), &expected, findings)?;
        if is_of_signal(row.measure) && !self.volts(placed, value).is_finite() {
            findings.push(too_large(&placed.value, placed.span));
            return None;
        }
        if !row.allows(value) {
            findings.push(self.out_of_range(row, placed, value));
            return None;
        }
        if row.measure == Measure::Whole && value.fract() != 0.0 {
            let message = format!(
                "\"{}\" of {} must be a whole number, but is {}",
                row.name,
                self.name,
                format_number(value)
            );
            findings.push(Diagnostic::at(Code::BAD_NUMBER, placed.span, message));
            return None;
        }
        if row.measure == Measure::Fraction {
            self.check_over_ranges(row, placed, findings);
        }
        Some(value)
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

    /// Whether a dimension is right for a setting of this measure.
    ///
    /// A pot in front of an integrator may have the unit 1/s: the pot and the gain of the integrator then are a rate.
    fn fits(&self, measure: Measure, found: Dimension) -> bool {
        let unit = self.unit().map_or(Dimension::NONE, Unit::dimension);
        match measure {
            Measure::Fraction => found.is_none() || (self.before_integrator && found == Dimension::FREQUENCY),
            Measure::Volts => found.is_none() || found == Dimension::VOLTAGE,
            Measure::MachineSeconds | Measure::Seconds => found == Dimension::TIME,
            Measure::Hertz => found == Dimension::FREQUENCY,
            Measure::RadiansPerVolt => found.is_none() || found == Dimension::NONE.over(Dimension::VOLTAGE),
            Measure::Signal => found == unit,
            Measure::SignalRate => found == unit.over(Dimension::TIME),
            _ => found.is_none(),
        }
    }

    /// The right unit of a setting of this measure, for messages.
    fn expected_unit(&self, measure: Measure) -> String {
        let unit = self.unit().map_or(Dimension::NONE, Unit::dimension);
        match measure {
            Measure::Fraction if self.before_integrator => {
                "a pure number (or 1/s, before an integrator)".to_owned()
            }
            Measure::Volts => "a number of volts".to_owned(),
            Measure::MachineSeconds | Measure::Seconds => "a time in s".to_owned(),
            Measure::Hertz => "a frequency in 1/s".to_owned(),
            Measure::RadiansPerVolt => "a number of rad/V".to_owned(),
            Measure::Signal => unit.to_string(),
            Measure::SignalRate => unit.over(Dimension::TIME).to_string(),
            _ => "a pure number".to_owned(),
        }
    }

    /// The diagnostic for a value outside the range of the setting.
    ///
    /// The message shows the value in the unit of the setting. The hint depends on the fault: a negative pot setting
    /// needs an inverter, a pot setting above 1 needs a larger gain, and a voltage above 100 V needs other scales.
    fn out_of_range(&self, row: &Setting, placed: &Placed<Formula>, value: f64) -> Diagnostic {
        let (low, high) = row.range;
        let code = if row.measure == Measure::Fraction { Code::SETTING_OUTSIDE } else { Code::BAD_NUMBER };
        let unit = self.value_unit(row, &placed.value);
        let [value_text, low_text, high_text] = [value, low, high].map(format_number);
        let violation = match high {
            f64::MAX => format!("below {low_text}{unit}"),
            _ => format!("outside {low_text} ... {high_text}{unit}"),
        };
        let message = format!("\"{}\" of {} is {value_text}{unit}, {violation}", row.name, self.name);
        let hint = match code {
            Code::SETTING_OUTSIDE if value < low => "a pot cannot invert: put a summer in front of it",
            Code::SETTING_OUTSIDE => "divide it by 10 and use an input with 10 times the gain, or rescale",
            _ if row.measure == Measure::Volts && value.abs() > REFERENCE => {
                "rescale: the machine works between -100 and 100 V"
            }
            _ => row.description,
        };
        Diagnostic::at(code, placed.span, message).hint(hint)
    }

    /// The unit of a setting's value for messages, with a space in front. Empty for a pure number.
    ///
    /// The value of a literal formula is in the scale's unit, that of another formula in SI units.
    fn value_unit(&self, row: &Setting, formula: &Formula) -> String {
        let scale_unit = |unit: &Unit| match self.quantities.is_literal(formula) {
            true => unit.text().to_owned(),
            false => unit.dimension().to_string(),
        };
        match (row.measure, self.unit()) {
            (Measure::Fraction | Measure::Ratio | Measure::Whole, _) => String::new(),
            (Measure::Signal, Some(unit)) => format!(" {}", scale_unit(unit)),
            (Measure::SignalRate, Some(unit)) => format!(" {} per s", scale_unit(unit)),
            _ => format!(" {}", row.unit()),
        }
    }

    /// Warns of a pot setting that leaves its range for some values of its parameters within their ranges.
    ///
    /// The warning names the first combination of values for which this happens.
    ///
    /// A setting without an error at the present values can still be wrong elsewhere in the ranges, which the user
    /// would notice only in a sweep. Bounds and middles find every fault of a formula that is monotonic in each of its
    /// parameters, if these are at most six.
    fn check_over_ranges(&self, row: &Setting, placed: &Placed<Formula>, findings: &mut Vec<Diagnostic>) {
        let dependencies = self.quantities.dependencies(&placed.value);
        let violation = self.combinations(&dependencies.parameters).into_iter().find_map(|combination| {
            let quantities = self.quantities.varied(&combination, &dependencies.derived);
            let predicate = match placed.value.evaluate(&quantities) {
                Ok(value) if row.allows(value) => return None,
                Ok(value) => format!("would be {}", format_number(value)),
                Err(_) => "would have no value".to_owned(),
            };
            Some((predicate, self.describe_combination(&combination)))
        });
        if let Some((predicate, values)) = violation {
            let message = format!("\"{}\" of {} {predicate} at {values}", row.name, self.name);
            let hint = "narrow the range of the parameter, or rescale";
            findings.push(Diagnostic::at(Code::SETTING_RANGE, placed.span, message).hint(hint));
        }
    }

    /// All combinations of the lower bounds, middles and upper bounds of these parameters' ranges.
    ///
    /// Each combination has indices of parameters with values in their declared units. Parameters without a range keep
    /// their value, and so do those after the first [`MAX_VARIED_PARAMETERS`].
    fn combinations(&self, parameters: &[usize]) -> Vec<Vec<(usize, f64)>> {
        let ranged =
            parameters.iter().filter_map(|index| Some((*index, self.patch.parameters[*index].range?)));
        let mut combinations = vec![Vec::new()];
        for (index, (low, high)) in ranged.take(MAX_VARIED_PARAMETERS) {
            let values = [low, (low + high) / 2.0, high];
            combinations = combinations
                .iter()
                .flat_map(|shorter| values.map(|value| [shorter.as_slice(), &[(index, value)]].concat()))
                .collect();
        }
        combinations
    }

    /// The names and values of a combination for messages: "k = 3, m = 2".
    ///
    /// Values are in the declared units, without the unit.
    fn describe_combination(&self, combination: &[(usize, f64)]) -> String {
        let values = combination.iter().filter_map(|(index, value)| {
            let (name, _) = self.patch.parameters.get_index(*index)?;
            Some(format!("{name} = {}", format_number(*value)))
        });
        values.collect::<Vec<_>>().join(", ")
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
                let [low, high] = [low, high].map(format_number);
                let message =
                    format!("{lower} of {} is {low}, which is not below {upper} = {high}", self.name);
                let hint = "exchange the two, or change one of them";
                findings.push(Diagnostic::at(Code::BAD_NUMBER, self.position(lower), message).hint(hint));
            }
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
                let [inner, limit] = [inner, limit].map(format_number);
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
            (None, Default::Number(number)) => Some(number),
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
fn is_of_signal(measure: Measure) -> bool {
    matches!(measure, Measure::Signal | Measure::SignalRate)
}

/// Number of parameters of one formula that are varied at most. Three values of each give 3^6 = 729 combinations.
const MAX_VARIED_PARAMETERS: usize = 6;

#[cfg(test)]
mod tests {
    use crate::circuit::Circuit;
    use crate::document::{Code, Report};
    use crate::ir::Program;
    use crate::patch::{ElementBuilder, PatchBuilder};
    use crate::solve::Machine;

    /// The circuit of a pot with this setting between a reference and a summer, or the report on it.
    fn pot_at(builder: PatchBuilder, setting: &str) -> Result<Circuit, Box<Report>> {
        let pot = ElementBuilder::new("pot").cord("in", "+100").set("setting", setting);
        let summer = ElementBuilder::new("summer").cords("x1", ["P"]);
        let patch = builder.element("P", pot).element("S", summer).scale("volt", 1.0, "V");
        Circuit::new(&patch.signal("s", "S", "volt", 1.0).build().unwrap())
    }

    #[test]
    fn a_setting_that_exceeds_1_by_rounding_is_accepted() {
        let circuit = pot_at(PatchBuilder::new("full"), "0.1 * 3 / 0.3").unwrap();
        let program = Program::new(&circuit).unwrap();
        assert_eq!(Machine::new(&program, 1e-3).unwrap().voltage("P").unwrap(), 100.0 * (0.1 * 3.0 / 0.3));
    }

    #[test]
    fn the_range_check_of_a_setting_follows_scales_that_depend_on_scales() {
        let builder = PatchBuilder::new("scales")
            .parameter("k", 1.0, "1", [0.5, 3.0])
            .scale("a", "b", "1")
            .scale("b", "k * c", "1")
            .scale("c", 0.5, "1");
        let warnings = pot_at(builder, "a").unwrap().warnings();
        assert_eq!(warnings.findings.len(), 1, "{warnings}");
        assert_eq!(warnings.findings[0].message, "\"setting\" of P would be 1.5 at k = 3");
    }

    #[test]
    fn only_a_pot_in_front_of_an_integrator_may_be_set_to_a_rate() {
        let codes = |last: ElementBuilder, kind: &str, setting: &str| {
            let builder = PatchBuilder::new("rates").parameter("w", 0.5, "1/s", [0.1, 1.0]);
            let pot = ElementBuilder::new(kind).cord("in", "+100").set("setting", setting);
            let pot = if kind == "pot" { pot } else { pot.cord("end", "ground") };
            let patch = builder.element("P", pot).element("A", last.cords("x1", ["P"]));
            let report = Circuit::new(&patch.record(["A"]).build().unwrap()).err();
            report.map_or(vec![], |report| report.findings.iter().map(|finding| finding.code).collect())
        };
        let lag = || ElementBuilder::new("lag").set("time", 1);
        assert_eq!(codes(lag(), "pot", "0.5"), []);
        assert!(codes(lag(), "pot", "w").contains(&Code::UNIT_MISMATCH));
        let integrator = || ElementBuilder::new("integrator");
        assert_eq!(codes(integrator(), "pot", "w"), []);
        assert!(codes(integrator(), "free-pot", "w").contains(&Code::UNIT_MISMATCH));
    }

    /// The circuit of a chain of pots, each set to a rate, that drives an amplifier of this kind.
    fn chain(length: usize, kind: &str) -> Result<Circuit, Box<Report>> {
        let pot = |at: usize| {
            let driver = if at == 0 { "+100".to_owned() } else { format!("P{}", at - 1) };
            ElementBuilder::new("pot").cord("in", &driver).set("setting", "w")
        };
        let builder =
            PatchBuilder::new("chain").parameter("w", 0.5, "1/s", [0.1, 1.0]).scale("volt", 1.0, "V");
        let builder = (0..length).fold(builder, |builder, at| builder.element(&format!("P{at}"), pot(at)));
        let last = format!("P{}", length - 1);
        let builder = builder.element("A", ElementBuilder::new(kind).cords("x1", [last.as_str()]));
        Circuit::new(&builder.signal("a", "A", "volt", 1.0).build().unwrap())
    }

    #[test]
    fn every_pot_of_a_chain_that_drives_an_integrator_may_be_set_to_a_rate() {
        chain(3000, "integrator").unwrap_or_else(|report| panic!("{report}"));
        assert_eq!(chain(3, "summer").unwrap_err().findings.len(), 3);
    }
}
