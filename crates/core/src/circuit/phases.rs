//! Checks the phases of a run: the relays that end phases, and the parameters that phases set.
//!
//! Names and units are checked here. Whether a new value is inside the range of its parameter is known only in the run,
//! because formulas of a run can use signals.

use super::names::found_or_report;
use super::scope::Quantities;
use crate::document::{
    Code, Diagnostic, ParameterChange, Phase, Placed, SwitchCondition, check_cycles, suggestion,
};
use crate::patch::{Parameter, Patch};
use patchcord_expr::{Dimension, Formula, Scope};

/// Checks the names and units in all phases.
pub(super) fn check(patch: &Patch, quantities: &Quantities, findings: &mut Vec<Diagnostic>) {
    let checker = PhaseChecker { patch, quantities };
    let mut each = |phase: &Phase| match phase {
        Phase::Operate { until: Some(condition), .. } => checker.condition(condition, findings),
        Phase::Set { changes } => changes.iter().for_each(|change| checker.change(change, findings)),
        _ => {}
    };
    patch.run.phases.iter().for_each(|phase| phase.for_each(&mut each));
}

/// Names of the relays that end phases. Names may be repeated.
pub(super) fn relays<'p>(patch: &'p Patch) -> Vec<&'p str> {
    let mut relays = Vec::new();
    let mut each = |phase: &'p Phase| {
        if let Phase::Operate { until: Some(condition), .. } = phase {
            relays.push(condition.relay.value.as_str());
        }
    };
    patch.run.phases.iter().for_each(|phase| phase.for_each(&mut each));
    relays
}

/// Checks phases against the patch.
struct PhaseChecker<'a> {
    /// The patch, for its elements, parameters and signals.
    patch: &'a Patch,
    /// The evaluated parameters and derived quantities of the patch.
    quantities: &'a Quantities,
}

impl PhaseChecker<'_> {
    /// Reports a condition whose element does not exist, does not switch, or does not have the position.
    ///
    /// If the element does not switch, the hint names a similar relay, or the kinds of element that are needed.
    fn condition(&self, condition: &SwitchCondition, findings: &mut Vec<Diagnostic>) {
        let relay = &condition.relay;
        let message = || format!("there is no relay {} to wait for", relay.value);
        let known = || self.relays();
        let found = self.patch.elements.get(&relay.value);
        let Some(entry) = found_or_report(self.patch, relay, found, message, known, findings) else { return };
        let positions = entry.kind.positions;
        if positions.is_empty() {
            let message = format!("{} (kind {}) does not switch", relay.value, entry.kind.name);
            let hint = suggestion(&relay.value, &self.relays()).unwrap_or_else(|| {
                "add a \"comparator\" or a \"relay\" that compares its voltage, and name it".to_owned()
            });
            findings.push(Diagnostic::at(Code::NOT_A_RELAY, relay.span, message).hint(hint));
        } else if let Some(becomes) = &condition.becomes
            && !positions.contains(&becomes.value.as_str())
        {
            let message = format!("{} has no position \"{}\"", relay.value, becomes.value);
            let hint = suggestion(&becomes.value, positions);
            findings.push(Diagnostic::at(Code::UNKNOWN_NAME, becomes.span, message).maybe_hint(hint));
        }
    }

    /// Names of all elements that switch. A phase can wait for them.
    fn relays(&self) -> Vec<&str> {
        let entries = self.patch.elements.iter().filter(|(_, entry)| !entry.kind.positions.is_empty());
        entries.map(|(name, _)| name.as_str()).collect()
    }

    /// Checks that a changed parameter exists, that no scale depends on it, and that its new value has the right unit.
    fn change(&self, change: &ParameterChange, findings: &mut Vec<Diagnostic>) {
        let name = &change.parameter;
        let message = || format!("there is no parameter {} to set", name.value);
        let known = || self.patch.parameters.keys().map(String::as_str).collect();
        let found = self.patch.parameters.get_full(&name.value);
        let found = found_or_report(self.patch, name, found, message, known, findings);
        let Some((index, _, parameter)) = found else { return };
        self.check_scales(index, name, findings);
        self.formula(parameter, &change.to, findings);
    }

    /// Reports a scale that depends on a changed parameter. A scale must not change within a record.
    ///
    /// The first such scale is named. It may depend on the parameter through other scales.
    fn check_scales(&self, parameter: usize, name: &Placed<String>, findings: &mut Vec<Diagnostic>) {
        let depends =
            |formula: &Formula| self.quantities.dependencies(formula).parameters.contains(&parameter);
        let scale = (0..self.patch.scales.len())
            .map(|index| self.quantities.derived(index))
            .find(|(_, formula)| depends(formula));
        if let Some((scale, _)) = scale {
            let message = format!("setting {} would change the scale {scale} within the record", name.value);
            findings.push(Diagnostic::at(Code::SCALE_IN_RUN, name.span, message));
        }
    }

    /// Checks names and unit of the formula for a parameter's new value.
    ///
    /// A name that is both a signal and a quantity is reported here, because only formulas of a run can use both.
    fn formula(&self, parameter: &Parameter, to: &Placed<Formula>, findings: &mut Vec<Diagnostic>) {
        let scope = RunNames { patch: self.patch, quantities: self.quantities };
        let names = to.value.names();
        if let Some(name) = names.iter().find(|name| scope.is_ambiguous(name)) {
            let message = format!("{name} is both a signal and a parameter or scale");
            let hint = "rename the signal: the formula could mean either";
            findings.push(Diagnostic::at(Code::DUPLICATE_NAME, to.span, message).hint(hint));
            return;
        }
        if names.iter().any(|name| scope.has_unknown_scale(name)) {
            return;
        }
        let expected = parameter.unit.dimension();
        let checked = self.quantities.check_unit(
            to,
            &scope,
            |found| found == expected,
            &expected.to_string(),
            findings,
        );
        if checked.is_some() {
            check_cycles(to, &scope, &parameter.unit, findings);
        }
    }
}

/// The names that formulas of a run can use: the quantities of the patch and the signals.
struct RunNames<'a> {
    /// The patch, for its signals and their scales.
    patch: &'a Patch,
    /// The parameters, scales and settings of instances.
    quantities: &'a Quantities,
}

impl RunNames<'_> {
    /// Whether the name is both a signal and a quantity.
    fn is_ambiguous(&self, name: &str) -> bool {
        self.patch.signals.contains_key(name) && self.quantities.dimension(name).is_some()
    }

    /// Whether the name is a signal whose scale does not exist. That fault is reported at the signal.
    fn has_unknown_scale(&self, name: &str) -> bool {
        self.patch.signals.contains_key(name) && self.dimension(name).is_none()
    }
}

impl Scope for RunNames<'_> {
    /// Signals have no value before the run.
    fn value(&self, name: &str) -> Option<f64> {
        self.quantities.value(name)
    }

    /// A signal without a scale is in volts.
    fn dimension(&self, name: &str) -> Option<Dimension> {
        self.quantities.dimension(name).or_else(|| {
            let scale = &self.patch.signals.get(name)?.scale;
            match scale {
                Some(scale) => Some(self.patch.scales.get(&scale.value)?.unit.dimension()),
                None => Some(Dimension::VOLTAGE),
            }
        })
    }

    /// Only quantities have a declared unit; errors describe a signal by its dimension.
    fn declared_unit(&self, name: &str) -> Option<&str> {
        self.quantities.declared_unit(name)
    }

    /// The quantities, then the signals. A hint for an unknown name chooses among them.
    fn names(&self) -> Vec<&str> {
        self.quantities.names().into_iter().chain(self.patch.signals.keys().map(String::as_str)).collect()
    }
}
