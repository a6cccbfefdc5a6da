//! The decision of a rescaling: the factor of every output, the gains, and machine seconds per old machine second.

use std::collections::{BTreeMap, BTreeSet};

use patchcord_core::circuit::Cord;

use super::laws::{Size, size};
use super::values::Values;
use super::wiring::Wiring;

/// What a rescaling changes.
#[derive(Debug, Clone)]
pub(super) struct Decision {
    /// The factor by which the voltage of each output is multiplied.
    pub factors: Vec<f64>,
    /// The value of one volt of each scale before, as a multiple of the new one, by the index of the scale.
    pub scale_factors: BTreeMap<usize, f64>,
    /// The gain of each cord, by element. Cords without a gain have 1.
    pub gains: Vec<Vec<f64>>,
    /// The diode networks whose setting follows their input. Their outputs have the factors of [`factor`].
    pub adapting: BTreeSet<usize>,
    /// The pots that are put into cords: the element and the index of its cord, with the setting.
    pub added: BTreeMap<(usize, usize), f64>,
    /// Machine seconds per old machine second.
    pub time: f64,
}

impl Decision {
    /// The decision to change nothing.
    pub(super) fn none(wiring: &Wiring<'_>) -> Self {
        let gains = |own: &Vec<(usize, Cord)>| own.iter().map(|(_, cord)| cord.gain).collect();
        Decision {
            factors: vec![1.0; wiring.len()],
            scale_factors: BTreeMap::new(),
            gains: wiring.cords.iter().map(gains).collect(),
            adapting: BTreeSet::new(),
            added: BTreeMap::new(),
            time: 1.0,
        }
    }

    /// This decision and another one for the patch that it makes. The wirings are those before and between. `None` if they
    /// do not have the same elements and cords.
    pub(super) fn followed_by(&self, next: &Decision, wirings: [&Wiring<'_>; 2]) -> Option<Decision> {
        let [before, between] = wirings;
        let are_equal = |element: usize| before.name(element) == between.name(element);
        if before.len() != between.len() || !(0..before.len()).all(are_equal) {
            return None;
        }
        let of_scale = |(scale, factor): (&usize, &f64)| {
            (*scale, factor * next.scale_factors.get(scale).copied().unwrap_or(1.0))
        };
        let gains = (0..before.len()).map(|element| self.next_gains(next, wirings, element));
        Some(Decision {
            factors: self.factors.iter().zip(&next.factors).map(|(one, other)| one * other).collect(),
            scale_factors: self.scale_factors.iter().map(of_scale).collect(),
            gains: gains.collect::<Option<Vec<Vec<f64>>>>()?,
            adapting: &self.adapting | &next.adapting,
            added: BTreeMap::new(),
            time: self.time * next.time,
        })
    }

    /// The gains of an element after another decision, in the order of the cords before. Cords at other jacks can have
    /// another order between. `None` if the cords are not the same.
    fn next_gains(&self, next: &Decision, wirings: [&Wiring<'_>; 2], element: usize) -> Option<Vec<f64>> {
        let [before, between] = wirings.map(|wiring| &wiring.cords[element]);
        let mut used = BTreeSet::new();
        let gains = before.iter().zip(&self.gains[element]).map(|((from, cord), gain)| {
            let is_same = |index: &usize| {
                let (other_from, other) = &between[*index];
                let are_equal = other_from == from && other.input == cord.input && other.gain == *gain;
                are_equal && !used.contains(index)
            };
            let found = (0..between.len()).find(is_same)?;
            used.insert(found);
            Some(next.gains[element][found])
        });
        gains.collect()
    }
}

/// A decision with the wiring and the old values of all formulas.
#[derive(Clone, Copy)]
pub(super) struct Decided<'d> {
    pub wiring: &'d Wiring<'d>,
    pub old: &'d Values<'d>,
    pub decision: &'d Decision,
}

impl Decided<'_> {
    /// The factor of an output at a point. That of an adapting diode network depends on its setting.
    pub(super) fn factor(&self, output: usize, point: usize) -> Option<f64> {
        if !self.decision.adapting.contains(&output) {
            return Some(self.decision.factors[output]);
        }
        let (share, relative) = self.network(output, point)?;
        let input = self.wiring.source(output, "in").map_or(1.0, |from| self.decision.factors[from]);
        Some(input * (1.0 + share) / (1.0 + relative * share))
    }

    /// Of an adapting diode network: r / (1 - r) for its old setting r, and the factor of its input relative to that of
    /// its biases.
    fn network(&self, element: usize, point: usize) -> Option<(f64, f64)> {
        let setting = self.old.value(self.wiring.formula(element, "setting")?, point)?;
        let source = |input: &str| self.wiring.source(element, input);
        let factor = |from: Option<usize>| from.map_or(1.0, |from| self.decision.factors[from]);
        let bias = source("bias_plus").or_else(|| source("bias_minus"));
        Some((setting / (1.0 - setting), factor(source("in")) / factor(bias)))
    }

    /// The factor of the biases of an adapting diode network, for the network and for a pot behind it. `None` for other
    /// elements.
    pub(super) fn bias_factor(&self, element: usize) -> Option<f64> {
        let is_adapting = |element: &usize| self.decision.adapting.contains(element);
        let source = |element: usize, input: &str| self.wiring.source(element, input);
        let network =
            Some(element).filter(is_adapting).or_else(|| source(element, "in").filter(is_adapting))?;
        let bias = source(network, "bias_plus").or_else(|| source(network, "bias_minus"))?;
        Some(self.decision.factors[bias])
    }

    /// The wanted value of a setting at a point. `None` if its formula has no value there.
    pub(super) fn wanted(&self, element: usize, setting: &str, point: usize) -> Option<f64> {
        let kind = self.wiring.kind(element).name;
        let old = self.old.value(self.wiring.formula(element, setting)?, point)?;
        if setting == "setting" && self.wiring.has_reference_ends(element) {
            return self.between_references(element, old);
        }
        if setting == "setting" && self.decision.adapting.contains(&element) {
            let (share, relative) = self.network(element, point)?;
            return Some(relative * share / (1.0 + relative * share));
        }
        Some(old * self.setting_factor(element, kind, setting, point)?)
    }

    /// Whether a setting is 0 in every scale and for all values of the parameters.
    pub(super) fn is_always_zero(&self, element: usize, setting: &str) -> bool {
        let formula = self.wiring.formula(element, setting);
        let is_zero = |formula| self.old.all(formula).into_iter().flatten().all(|value| value == 0.0);
        formula.is_some_and(is_zero) && !self.wiring.has_reference_ends(element)
    }

    /// The factor of a setting at a point.
    pub(super) fn setting_factor(
        &self,
        element: usize,
        kind: &str,
        setting: &str,
        point: usize,
    ) -> Option<f64> {
        let output = || self.factor(element, point);
        let input = |name: &str| match self.wiring.source(element, name) {
            Some(from) => self.factor(from, point),
            None => Some(1.0),
        };
        if setting == "setting" && self.wiring.is_pot(element) {
            return Some(output()? / input("in")?);
        }
        match size(kind, setting) {
            Size::Fixed => Some(1.0),
            Size::Output => output(),
            Size::Input(name) => input(name),
            Size::PerInput(name) => Some(1.0 / input(name)?),
            Size::OutputPerInput(name) => Some(output()? / input(name)?),
            Size::Time => Some(self.decision.time),
        }
    }

    /// The setting of a free pot between two references, whose voltage is multiplied by the factor of its output.
    fn between_references(&self, element: usize, old: f64) -> Option<f64> {
        let [top, end] = self.wiring.reference_ends(element)?;
        if top == end {
            return Some(old);
        }
        let wanted = self.decision.factors[element] * (end + old * (top - end));
        Some((wanted - end) / (top - end))
    }
}
