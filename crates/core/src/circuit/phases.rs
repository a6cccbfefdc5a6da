//! The phases of a run: the relays that end them, and the parameters that they set.

use super::names::found_or_told;
use super::scope::Quantities;
use crate::document::{Change, Code, Diagnostic, Phase, Placed, Until, suggestion};
use crate::patch::{Parameter, Patch};
use patchcord_expr::{Dimension, Formula, Scope};

/// Checks names and units of everything that the phases name.
pub(super) fn check(patch: &Patch, quantities: &Quantities, findings: &mut Vec<Diagnostic>) {
    let checker = Checker { patch, quantities };
    let mut each = |phase: &Phase| match phase {
        Phase::Operate { until: Some(until), .. } => checker.until(until, findings),
        Phase::Set { changes } => changes.iter().for_each(|change| checker.change(change, findings)),
        _ => {}
    };
    patch.run.phases.iter().for_each(|phase| phase.for_each(&mut each));
}

/// Names of the relays that end phases.
pub(super) fn relays<'p>(patch: &'p Patch) -> Vec<&'p str> {
    let mut relays = Vec::new();
    let mut each = |phase: &'p Phase| {
        if let Phase::Operate { until: Some(until), .. } = phase {
            relays.push(until.relay.value.as_str());
        }
    };
    patch.run.phases.iter().for_each(|phase| phase.for_each(&mut each));
    relays
}

struct Checker<'a> {
    patch: &'a Patch,
    quantities: &'a Quantities,
}

impl Checker<'_> {
    fn until(&self, until: &Until, findings: &mut Vec<Diagnostic>) {
        let relay = &until.relay;
        let message = || format!("there is no relay {} to wait for", relay.value);
        let known = || self.relays();
        let found = self.patch.elements.get(&relay.value);
        let Some(entry) = found_or_told(self.patch, relay, found, message, known, findings) else { return };
        let positions = entry.kind.positions;
        if positions.is_empty() {
            let message = format!("{} (kind {}) does not switch", relay.value, entry.kind.name);
            let hint = suggestion(&relay.value, &self.relays()).unwrap_or_else(|| {
                "compare its voltage in an element of kind \"relay\", and name that".to_owned()
            });
            findings.push(Diagnostic::at(Code::NotARelay, relay.span, message).hint(hint));
        } else if let Some(becomes) = &until.becomes
            && !positions.contains(&becomes.value.as_str())
        {
            let message = format!("{} does not become \"{}\"", relay.value, becomes.value);
            let hint = suggestion(&becomes.value, positions);
            findings.push(Diagnostic::at(Code::UnknownName, becomes.span, message).maybe_hint(hint));
        }
    }

    /// Names of the elements that a phase can wait for.
    fn relays(&self) -> Vec<&str> {
        let entries = self.patch.elements.iter().filter(|(_, entry)| !entry.kind.positions.is_empty());
        entries.map(|(name, _)| name.as_str()).collect()
    }

    fn change(&self, change: &Change, findings: &mut Vec<Diagnostic>) {
        let name = &change.parameter;
        let message = || format!("there is no parameter {} to set", name.value);
        let known = || self.patch.parameters.keys().map(String::as_str).collect();
        let found = self.patch.parameters.get_full(&name.value);
        let found = found_or_told(self.patch, name, found, message, known, findings);
        let Some((index, _, parameter)) = found else { return };
        self.scale_stays(index, name, findings);
        self.formula(parameter, &change.to, findings);
    }

    /// A record is read in one scale from beginning to end.
    fn scale_stays(&self, parameter: usize, name: &Placed<String>, findings: &mut Vec<Diagnostic>) {
        let depends = |formula: &Formula| self.quantities.named_in(formula).parameters.contains(&parameter);
        let scale = (0..self.patch.scales.len())
            .map(|index| self.quantities.derived(index))
            .find(|(_, formula)| depends(formula));
        if let Some((scale, _)) = scale {
            let message = format!("setting {} would change the scale {scale} within the record", name.value);
            findings.push(Diagnostic::at(Code::ScaleInRun, name.span, message));
        }
    }

    fn formula(&self, parameter: &Parameter, to: &Placed<Formula>, findings: &mut Vec<Diagnostic>) {
        let scope = Readable { patch: self.patch, quantities: self.quantities };
        let names = to.value.names();
        if let Some(name) = names.iter().find(|name| scope.is_two_things(name)) {
            let message = format!("{name} is a signal, and a parameter or scale as well");
            let hint = "rename the signal: here a formula may mean either";
            findings.push(Diagnostic::at(Code::DuplicateName, to.span, message).hint(hint));
            return;
        }
        if names.iter().any(|name| scope.is_unreadable(name)) {
            return;
        }
        let wanted = parameter.unit.dimension();
        self.quantities.fitting(to, &scope, |found| found == wanted, &wanted.to_string(), findings);
    }
}

/// What the formulas of a run may name: signals too.
struct Readable<'a> {
    patch: &'a Patch,
    quantities: &'a Quantities,
}

impl Readable<'_> {
    fn is_two_things(&self, name: &str) -> bool {
        self.patch.signals.contains_key(name) && self.quantities.dimension(name).is_some()
    }

    /// Whether it is a signal in a scale that is not there, which is reported at the signal.
    fn is_unreadable(&self, name: &str) -> bool {
        self.patch.signals.contains_key(name) && self.dimension(name).is_none()
    }
}

impl Scope for Readable<'_> {
    fn value(&self, name: &str) -> Option<f64> {
        self.quantities.value(name)
    }

    fn dimension(&self, name: &str) -> Option<Dimension> {
        self.quantities.dimension(name).or_else(|| {
            let scale = &self.patch.signals.get(name)?.scale;
            match scale {
                Some(scale) => Some(self.patch.scales.get(&scale.value)?.unit.dimension()),
                None => Some(Dimension::VOLTAGE),
            }
        })
    }

    fn declared_unit(&self, name: &str) -> Option<&str> {
        self.quantities.declared_unit(name)
    }

    fn names(&self) -> Vec<&str> {
        self.quantities.names().into_iter().chain(self.patch.signals.keys().map(String::as_str)).collect()
    }
}
