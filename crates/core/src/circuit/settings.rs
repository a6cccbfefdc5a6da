//! Settings: their units, their values now, and over the ranges of their parameters.

use petgraph::Direction;
use petgraph::graph::NodeIndex;

use super::macros;
use super::resolve::Graph;
use super::scope::{Quantities, too_large};
use crate::document::{Code, Diagnostic, Placed, Span, told};
use crate::elements::{Default, Measure, REFERENCES, Setting, Transfer};
use crate::machines::REFERENCE;
use crate::patch::{Amount, Entry, Patch};
use patchcord_expr::{Dimension, Formula, Unit};

/// Whether every cord is where the patch wants it.
#[derive(Clone, Copy, PartialEq)]
pub(super) enum Cords {
    Known,
    /// Some were reported: an output that nothing reads may be meant for any input.
    Doubtful,
}

/// Checks every setting of every element and drive.
pub(super) fn check(
    patch: &Patch,
    quantities: &Quantities,
    graph: &Graph,
    cords: Cords,
    findings: &mut Vec<Diagnostic>,
) {
    let before_integrators = before_integrators(graph, cords);
    // The graph holds the references first, then drives and elements in the order of the document.
    let outlets = graph.node_indices().skip(REFERENCES.len());
    for (index, (name, entry)) in outlets.zip(patch.drives.iter().chain(&patch.elements)) {
        let before_integrator = before_integrators[index.index()];
        let scale = entry.scale.as_ref().and_then(|scale| patch.scales.get_index_of(&scale.value));
        let checker = Checker { name, entry, patch, quantities, before_integrator, scale };
        let told = findings.len();
        checker.all(findings);
        macros::name(patch, name, &mut findings[told..]);
    }
}

/// For every element, whether it is a pot whose voltage goes into an integrator, directly or through other pots.
fn before_integrators(graph: &Graph, cords: Cords) -> Vec<bool> {
    let is = |index: NodeIndex, transfer| graph[index].kind.transfer == transfer;
    let may_feed_one = |index: &NodeIndex| {
        cords == Cords::Doubtful && is(*index, Transfer::Share) && graph.neighbors(*index).next().is_none()
    };
    let mut before = vec![false; graph.node_count()];
    let mut open: Vec<_> = graph.node_indices().filter(may_feed_one).collect();
    open.iter().for_each(|index| before[index.index()] = true);
    open.extend(graph.node_indices().filter(|index| is(*index, Transfer::Integrating)));
    while let Some(index) = open.pop() {
        let drivers = graph.neighbors_directed(index, Direction::Incoming);
        for driver in drivers.filter(|driver| is(*driver, Transfer::Share)) {
            if !std::mem::replace(&mut before[driver.index()], true) {
                open.push(driver);
            }
        }
    }
    before
}

struct Checker<'a> {
    name: &'a str,
    entry: &'a Entry,
    patch: &'a Patch,
    quantities: &'a Quantities,
    before_integrator: bool,
    /// Index of a drive's scale.
    scale: Option<usize>,
}

impl Checker<'_> {
    fn all(&self, findings: &mut Vec<Diagnostic>) {
        if self.is_driven_in_nothing() {
            findings.push(self.driven_in_nothing());
            return;
        }
        let mut values = vec![None; self.entry.settings.len()];
        for (index, row) in self.entry.kind.settings.iter().enumerate() {
            let Some(placed) = &self.entry.settings[index] else { continue };
            if let Amount::Formula(formula) = &placed.value {
                let placed = Placed { value: formula.clone(), span: placed.span };
                values[index] = self.one(row, &placed, findings);
            }
        }
        self.order(&values, findings);
        self.bounds(&values, findings);
    }

    /// A quantity of which one volt is nothing can be read, as 0, but not driven.
    fn is_driven_in_nothing(&self) -> bool {
        self.scale.and_then(|scale| self.quantities.per_volt(scale)) == Some(0.0)
    }

    fn driven_in_nothing(&self) -> Diagnostic {
        let (name, span) =
            self.entry.scale.as_ref().map_or(("", self.entry.span), |scale| (&scale.value, scale.span));
        let message = format!("{} is driven in the scale {name}, which comes to 0 per volt", self.name);
        Diagnostic::at(Code::BadNumber, span, message).hint("give the drive a scale of its own")
    }

    /// A setting's value, once unit and range are found fit.
    fn one(&self, row: &Setting, placed: &Placed<Formula>, findings: &mut Vec<Diagnostic>) -> Option<f64> {
        if is_of_signal(row.measure) && self.scale.is_none() {
            return None;
        }
        let wanted = self.wanted(row.measure);
        let value =
            self.quantities.checked(placed, |found| self.fits(row.measure, found), &wanted, findings)?;
        if is_of_signal(row.measure) && !self.volts(placed, value).is_finite() {
            findings.push(too_large(&placed.value, placed.span));
            return None;
        }
        if !row.allows(value) {
            findings.push(self.outside(row, placed, value));
            return None;
        }
        if row.measure == Measure::Whole && value.fract() != 0.0 {
            let message = format!(
                "\"{}\" of {} comes to {}, and must be a whole number",
                row.name,
                self.name,
                told(value)
            );
            findings.push(Diagnostic::at(Code::BadNumber, placed.span, message));
            return None;
        }
        if row.measure == Measure::Fraction {
            self.over_ranges(row, placed, findings);
        }
        Some(value)
    }

    /// Unit of a drive's scale.
    fn unit(&self) -> Option<&Unit> {
        Some(&self.patch.scales[self.scale?].unit)
    }

    /// What a drive's value is on the machine; 0 where its scale could not be worked out.
    fn volts(&self, placed: &Placed<Formula>, value: f64) -> f64 {
        let (Some(unit), Some(volt)) =
            (self.unit(), self.scale.and_then(|scale| self.quantities.per_volt(scale)))
        else {
            return 0.0;
        };
        self.quantities.in_si(&placed.value, value, unit) / volt
    }

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

    fn wanted(&self, measure: Measure) -> String {
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

    fn outside(&self, row: &Setting, placed: &Placed<Formula>, value: f64) -> Diagnostic {
        let (low, high) = row.range;
        let code = if row.measure == Measure::Fraction { Code::SettingOutside } else { Code::BadNumber };
        let unit = self.told_unit(row, &placed.value);
        let [value_told, low_told, high_told] = [value, low, high].map(told);
        let allowed = match high {
            f64::MAX => format!("below {low_told}{unit}"),
            _ => format!("outside {low_told} ... {high_told}{unit}"),
        };
        let message = format!("\"{}\" of {} comes to {value_told}{unit}, {allowed}", row.name, self.name);
        let hint = match code {
            Code::SettingOutside if value < low => "a pot cannot invert: a summer in front of it can",
            Code::SettingOutside => "divide it by 10 and use an input with 10 times the gain, or rescale",
            _ if row.measure == Measure::Volts && value.abs() > REFERENCE => {
                "rescale: the machine works between -100 and 100 V"
            }
            _ => row.description,
        };
        Diagnostic::at(code, placed.span, message).hint(hint)
    }

    /// The unit behind the value that a setting came to: plain formulas stand in that of their place.
    fn told_unit(&self, row: &Setting, formula: &Formula) -> String {
        let of_scale = |unit: &Unit| match self.quantities.is_plain(formula) {
            true => unit.text().to_owned(),
            false => unit.dimension().to_string(),
        };
        match (row.measure, self.unit()) {
            (Measure::Fraction | Measure::Ratio | Measure::Whole, _) => String::new(),
            (Measure::Signal, Some(unit)) => format!(" {}", of_scale(unit)),
            (Measure::SignalRate, Some(unit)) => format!(" {} per s", of_scale(unit)),
            _ => format!(" {}", row.unit()),
        }
    }

    /// Warns when a setting leaves its range somewhere in the ranges of the parameters that it names.
    fn over_ranges(&self, row: &Setting, placed: &Placed<Formula>, findings: &mut Vec<Diagnostic>) {
        let named = self.quantities.named_in(&placed.value);
        let outside = self.corners(&named.parameters).into_iter().find_map(|corner| {
            let comes_to = match placed.value.evaluate(&self.quantities.varied(&corner, &named.derived)) {
                Ok(value) if row.allows(value) => return None,
                Ok(value) => format!("would come to {}", told(value)),
                Err(_) => "would have no value".to_owned(),
            };
            Some((comes_to, self.told_corner(&corner)))
        });
        if let Some((comes_to, at)) = outside {
            let message = format!("\"{}\" of {} {comes_to} at {at}", row.name, self.name);
            let hint = "narrow the range of the parameter, or rescale";
            findings.push(Diagnostic::at(Code::SettingRange, placed.span, message).hint(hint));
        }
    }

    /// Least, middle and largest value of each of these parameters that has a range, in every combination.
    fn corners(&self, named: &[usize]) -> Vec<Vec<(usize, f64)>> {
        let ranged = named.iter().filter_map(|index| Some((*index, self.patch.parameters[*index].range?)));
        let mut corners = vec![Vec::new()];
        for (index, (low, high)) in ranged.take(MOST_VARIED) {
            let values = [low, (low + high) / 2.0, high];
            corners = corners
                .iter()
                .flat_map(|corner| values.map(|value| [corner.as_slice(), &[(index, value)]].concat()))
                .collect();
        }
        corners
    }

    fn told_corner(&self, corner: &[(usize, f64)]) -> String {
        let told = corner.iter().filter_map(|(index, value)| {
            let (name, _) = self.patch.parameters.get_index(*index)?;
            Some(format!("{name} = {}", told(*value)))
        });
        told.collect::<Vec<_>>().join(", ")
    }

    /// Some settings must lie below others.
    fn order(&self, values: &[Option<f64>], findings: &mut Vec<Diagnostic>) {
        for (lower, upper) in self.entry.kind.ordered {
            let value = |name: &str| self.entry.kind.setting(name).and_then(|index| values[index]);
            if let (Some(low), Some(high)) = (value(lower), value(upper))
                && low >= high
            {
                let [low, high] = [low, high].map(told);
                let message =
                    format!("{lower} of {} is {low}, which is not below {upper}, {high}", self.name);
                let hint = "exchange the two, or move one of them";
                findings.push(Diagnostic::at(Code::BadNumber, self.place(lower), message).hint(hint));
            }
        }
    }

    /// Some settings must lie between others, as far as these are set.
    fn bounds(&self, values: &[Option<f64>], findings: &mut Vec<Diagnostic>) {
        let value = |name: &str| self.value(values, name);
        for (lower, between, upper) in self.entry.kind.bounded {
            let Some(inner) = value(between) else { continue };
            let below = value(lower).filter(|low| inner < *low).map(|low| (lower, "below", low));
            let above = value(upper).filter(|high| inner > *high).map(|high| (upper, "above", high));
            for (bound, side, limit) in below.into_iter().chain(above) {
                let [inner, limit] = [inner, limit].map(told);
                let message = format!("{between} of {} is {inner}, {side} {bound}, {limit}", self.name);
                let span = if self.is_set(between) { self.place(between) } else { self.place(bound) };
                let hint = format!("set \"{between}\" inside the limits, or move the limit");
                findings.push(Diagnostic::at(Code::BadNumber, span, message).hint(hint));
            }
        }
    }

    /// A setting's value, its default where the patch is silent.
    fn value(&self, values: &[Option<f64>], name: &str) -> Option<f64> {
        let index = self.entry.kind.setting(name)?;
        match (&self.entry.settings[index], self.entry.kind.settings[index].default) {
            (None, Default::Number(number)) => Some(number),
            _ => values[index],
        }
    }

    fn is_set(&self, name: &str) -> bool {
        self.entry.kind.setting(name).is_some_and(|index| self.entry.settings[index].is_some())
    }

    /// Where a setting stands, or else its element.
    fn place(&self, name: &str) -> Span {
        let placed = self.entry.kind.setting(name).and_then(|index| self.entry.settings[index].as_ref());
        placed.map_or(self.entry.span, |placed| placed.span)
    }
}

/// Whether a setting stands in the unit of the drive's scale.
fn is_of_signal(measure: Measure) -> bool {
    matches!(measure, Measure::Signal | Measure::SignalRate)
}

/// More parameters than this in one formula are not varied all at once.
const MOST_VARIED: usize = 6;

#[cfg(test)]
mod tests {
    use crate::circuit::Circuit;
    use crate::document::{Code, Report};
    use crate::ir::Program;
    use crate::patch::{ElementBuilder, PatchBuilder};
    use crate::solve::Machine;

    /// What is said of a pot at this setting, between a reference and a summer.
    fn pot_at(builder: PatchBuilder, setting: &str) -> Result<Circuit, Box<Report>> {
        let pot = ElementBuilder::new("pot").cord("in", "+100").set("setting", setting);
        let summer = ElementBuilder::new("summer").cords("x1", ["P"]);
        let patch = builder.element("P", pot).element("S", summer).scale("volt", 1.0, "V");
        Circuit::new(&patch.signal("s", "S", "volt", 1.0).build().unwrap(), &[])
    }

    #[test]
    fn a_setting_of_1_and_a_rounding_runs() {
        let circuit = pot_at(PatchBuilder::new("full"), "0.1 * 3 / 0.3").unwrap();
        let program = Program::new(&circuit).unwrap();
        assert_eq!(Machine::new(&program, 1e-3).unwrap().voltage("P").unwrap(), 100.0 * (0.1 * 3.0 / 0.3));
    }

    #[test]
    fn ranges_are_followed_through_scales_of_scales() {
        let builder = PatchBuilder::new("scales")
            .parameter("k", 1.0, "1", [0.5, 3.0])
            .scale("a", "b", "1")
            .scale("b", "k * c", "1")
            .scale("c", 0.5, "1");
        let warnings = pot_at(builder, "a").unwrap().warnings();
        assert_eq!(warnings.findings.len(), 1, "{warnings}");
        assert_eq!(warnings.findings[0].message, "\"setting\" of P would come to 1.5 at k = 3");
    }

    #[test]
    fn a_lag_takes_no_rates_and_a_free_pot_is_none() {
        let told = |last: ElementBuilder, kind: &str, setting: &str| {
            let builder = PatchBuilder::new("rates").parameter("w", 0.5, "1/s", [0.1, 1.0]);
            let pot = ElementBuilder::new(kind).cord("in", "+100").set("setting", setting);
            let pot = if kind == "pot" { pot } else { pot.cord("end", "ground") };
            let patch = builder.element("P", pot).element("A", last.cords("x1", ["P"]));
            let codes = Circuit::new(&patch.record(["A"]).build().unwrap(), &[]).err();
            codes.map_or(vec![], |report| report.findings.iter().map(|finding| finding.code).collect())
        };
        let lag = || ElementBuilder::new("lag").set("time", 1);
        assert_eq!(told(lag(), "pot", "0.5"), []);
        assert!(told(lag(), "pot", "w").contains(&Code::UnitMismatch));
        let integrator = || ElementBuilder::new("integrator");
        assert_eq!(told(integrator(), "pot", "w"), []);
        assert!(told(integrator(), "free-pot", "w").contains(&Code::UnitMismatch));
    }

    /// A chain of pots, each at a rate, into an amplifier of a kind.
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
        Circuit::new(&builder.signal("a", "A", "volt", 1.0).build().unwrap(), &[])
    }

    #[test]
    fn every_pot_of_a_chain_into_an_integrator_may_be_a_rate() {
        chain(3000, "integrator").unwrap_or_else(|report| panic!("{report}"));
        assert_eq!(chain(3, "summer").unwrap_err().findings.len(), 3);
    }
}
