//! The unknowns of a rescaling: the logarithms of the factors of outputs and scales, with the relations between them.
//!
//! Two outputs are related by the law of an element, by a shared scale, or by a cord without a pot. A cord with a gain
//! permits the ratios of the gains that the machine has. A pot in front of a gain permits every ratio.

use std::collections::{BTreeMap, BTreeSet};

use patchcord_core::circuit::Circuit;
use patchcord_core::document::Phase;
use patchcord_core::elements::OutputStage;

use super::gains::LEAST_SETTING;
use super::laws::ties;
use super::relations::{Affine, Relations};
use super::values::Values;
use super::wiring::Wiring;
use crate::synthesis::GOOD_VOLTS;

/// The voltage at which the peak of an output is aimed: the middle of 50 and 95 V in the sense of ratios.
const TARGET_VOLTS: f64 = 69.0;
/// The setting at which a pot is aimed.
const TARGET_SETTING: f64 = 0.3;
/// Decades by which a gain can change on a machine with all gains.
const DECADES: i32 = 3;
/// Two ratios are equal if their logarithms differ by at most this.
const ROUNDING: f64 = 1e-9;

/// What is known about a patch.
#[derive(Clone, Copy)]
pub(super) struct Evidence<'e> {
    pub wiring: &'e Wiring<'e>,
    pub old: &'e Values<'e>,
    /// The peak of each output in volts under the old scales.
    pub peaks: &'e [f64],
}

/// Freedoms that a rescaling uses.
#[derive(Debug, Clone, Copy)]
pub(super) struct Approach {
    /// Whether the settings of diode networks with biases follow their inputs.
    pub adapts: bool,
    /// How gains change.
    pub gains: Gains,
}

/// How the gains of cords without pots change.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Gains {
    /// They stay.
    Kept,
    /// They change by powers of ten, to gains that the machine has.
    Decades,
    /// They can be any numbers with few digits, if the machine has all gains.
    Free,
}

/// The unknowns of a patch with their relations.
pub(super) struct Model<'e> {
    pub evidence: Evidence<'e>,
    approach: Approach,
    pub relations: Relations,
    /// The unknown of each open amplifier that is the factor of the sum of its inputs.
    balances: BTreeMap<usize, usize>,
    /// The diode networks whose setting follows their input.
    pub adapting: BTreeSet<usize>,
}

impl<'e> Model<'e> {
    /// The model of a patch.
    pub(super) fn new(evidence: Evidence<'e>, approach: Approach) -> Self {
        let keeps_gains = approach.gains == Gains::Kept;
        let mut frozen: BTreeSet<usize> = (0..evidence.wiring.len()).filter(|_| keeps_gains).collect();
        loop {
            let mut model = Model::unlinked(evidence, approach);
            match model.link(&frozen) {
                Ok(()) => return model,
                // Fewer gains change. If none does, the relations hold for the patch as it is.
                Err(element) => model.freeze(element, &mut frozen),
            }
        }
    }

    /// The unknown of a scale.
    pub(super) fn scale(&self, scale: usize) -> usize {
        self.evidence.wiring.len() + scale
    }

    /// The number of unknowns.
    pub(super) fn unknowns(&self) -> usize {
        self.scale(self.evidence.wiring.circuit.patch().scales.len()) + self.balances.len()
    }

    /// The unknown of what the inputs with gains of an element are proportional to: its output, or the sum of the inputs
    /// of an open amplifier.
    pub(super) fn target(&self, element: usize) -> usize {
        self.balances.get(&element).copied().unwrap_or(element)
    }

    /// The unknown that stands for an output in an estimate. That of an adapting diode network is its input.
    pub(super) fn estimate(&self, output: usize) -> usize {
        match self.adapting.contains(&output) {
            true => self.evidence.wiring.source(output, "in").unwrap_or(output),
            false => output,
        }
    }

    /// The present setting of a pot.
    pub(super) fn setting(&self, pot: usize) -> Option<f64> {
        self.evidence.old.value(self.evidence.wiring.formula(pot, "setting")?, 0)
    }

    /// The cords with gains that no pot adjusts: the element and the index of the cord.
    pub(super) fn direct_cords(&self) -> Vec<(usize, usize)> {
        let wiring = self.evidence.wiring;
        let cords_of = |element: usize| (0..wiring.cords[element].len()).map(move |cord| (element, cord));
        let is_direct = |(element, cord): &(usize, usize)| {
            let (from, _) = wiring.cords[*element][*cord];
            wiring.has_gain(*element, *cord)
                && !wiring.is_ground(from)
                && wiring.gain_behind(from) != Some((*element, *cord))
        };
        (0..wiring.len()).flat_map(cords_of).filter(is_direct).collect()
    }

    /// Whether the gains of an element can be any numbers.
    pub(super) fn is_free(&self, element: usize) -> bool {
        self.approach.gains == Gains::Free && self.evidence.wiring.gains(element).is_empty()
    }

    /// The unknowns with all relations except those of gains.
    fn unlinked(evidence: Evidence<'e>, approach: Approach) -> Self {
        let wiring = evidence.wiring;
        let scales = wiring.circuit.patch().scales.len();
        let is_open = |element: &usize| wiring.kind(*element).output == OutputStage::OpenAmplifier;
        let open = (0..wiring.len()).filter(is_open);
        let balances: BTreeMap<usize, usize> =
            open.enumerate().map(|(index, element)| (element, wiring.len() + scales + index)).collect();
        let mut ranks: Vec<u32> = (0..wiring.len()).map(|element| rank(wiring, element)).collect();
        ranks.extend((0..scales).map(|_| SCALE_RANK));
        ranks.extend(balances.iter().map(|_| 0));
        let adapting = if approach.adapts { adapting(evidence) } else { BTreeSet::new() };
        let mut model = Model { evidence, approach, relations: Relations::new(ranks), balances, adapting };
        for equation in model.equations() {
            // The sum of none of them has a constant, so all agree.
            let _agrees = model.relations.require(&equation);
        }
        model
    }

    /// The equations that hold whatever the gains are.
    fn equations(&self) -> Vec<Affine> {
        let wiring = self.evidence.wiring;
        let mut equations: Vec<Affine> = self.fixed().into_iter().map(Affine::unknown).collect();
        for element in 0..wiring.len() {
            let adapts = self.adapting.contains(&element);
            equations.extend(ties(wiring, element, adapts).iter().map(|tie| Affine::sum(tie)));
            let scales = wiring.scales.get(&element).into_iter().flatten();
            equations.extend(scales.map(|scale| Affine::sum(&[(element, 1.0), (self.scale(*scale), -1.0)])));
            if let Some(from) = wiring.source(element, "in").filter(|_| is_first_pot(wiring, element)) {
                // The pot behind this one is turned instead.
                equations.push(Affine::sum(&[(element, 1.0), (self.estimate(from), -1.0)]));
            }
        }
        equations.extend(twin_ties(wiring));
        equations
    }

    /// The unknowns that are 0: references, scales that must stay, and outputs of elements whose settings must stay.
    fn fixed(&self) -> Vec<usize> {
        let wiring = self.evidence.wiring;
        let mut fixed: Vec<usize> =
            (0..wiring.len()).filter(|element| wiring.is_reference(*element)).collect();
        let scales = 0..wiring.circuit.patch().scales.len();
        let named = names_in_phases(wiring.circuit);
        let stays = |scale: &usize| {
            let (name, _) = wiring.circuit.derived(*scale);
            let per_volt = wiring.circuit.per_volt(*scale);
            named.contains(name) || !per_volt.is_some_and(|value| value.is_finite() && value != 0.0)
        };
        fixed.extend(scales.filter(stays).map(|scale| self.scale(scale)));
        for element in (0..wiring.len()).filter(|element| !self.is_adjustable(*element)) {
            fixed.push(element);
            fixed.extend(wiring.cords[element].iter().map(|(from, _)| *from));
        }
        fixed
    }

    /// Whether the settings of an element can change: they are in the document, its diodes have no forward drop, and the
    /// points of its curve are not in a file.
    fn is_adjustable(&self, element: usize) -> bool {
        let wiring = self.evidence.wiring;
        let has_drop = |setting: &str| {
            let formula = wiring.formula(element, setting);
            formula.is_some_and(|formula| self.evidence.old.value(formula, 0) != Some(0.0))
        };
        let has_file = wiring.kind(element).name == "function-generator"
            && !wiring.written(element, "points").is_some_and(serde_json::Value::is_array);
        wiring.is_reference(element)
            || (wiring.places[element].is_some() && !has_drop("drop") && !has_drop("limit.drop") && !has_file)
    }

    /// Adds the relations of cords with gains. The gains of frozen elements stay.
    ///
    /// # Errors
    /// The element of a cord for which the machine has no gain.
    fn link(&mut self, frozen: &BTreeSet<usize>) -> Result<(), usize> {
        for (element, cord) in self.direct_cords() {
            if self.is_free(element) {
                continue;
            }
            let (from, cord) = self.evidence.wiring.cords[element][cord];
            let ratio = Affine::sum(&[(self.target(element), 1.0), (from, -1.0)]);
            let reduced = self.relations.reduced(&ratio);
            let is_frozen = frozen.contains(&element) || frozen.contains(&from);
            let possible = match is_frozen {
                true => vec![0.0],
                false => self.possible_ratios(element, from, cord.gain),
            };
            let is_known = reduced.terms.is_empty();
            let wanted = if is_known { reduced.constant } else { self.wanted_ratio(element, from) };
            let distance = |ratio: &f64| (ratio - wanted).abs();
            let nearest = possible.into_iter().min_by(|one, other| distance(one).total_cmp(&distance(other)));
            let Some(chosen) = nearest.filter(|chosen| !is_known || distance(chosen) < ROUNDING) else {
                return Err(element);
            };
            if !self.relations.require(&ratio.plus_constant(-chosen)) {
                return Err(element);
            }
        }
        Ok(())
    }

    /// The logarithms of the ratios of the possible gains to the gain of a cord. If one of its ends is fixed, only those
    /// with which the other end does not peak above 95 V, if there are any.
    fn possible_ratios(&self, element: usize, from: usize, gain: f64) -> Vec<f64> {
        let gains = self.evidence.wiring.gains(element);
        let all: Vec<f64> = match gains.is_empty() {
            true => (-DECADES..=DECADES).map(f64::from).collect(),
            false => gains.iter().map(|other| (other / gain).log10()).collect(),
        };
        let fixed = |unknown: usize| {
            let reduced = self.relations.reduced(&Affine::unknown(unknown));
            reduced.terms.is_empty().then_some(reduced.constant)
        };
        let is_low = |ratio: &f64| match (fixed(self.target(element)), fixed(from)) {
            (Some(to), None) => to - ratio <= self.highest(from) + ROUNDING,
            (None, Some(from)) => from + ratio <= self.highest(element) + ROUNDING,
            _ => true,
        };
        let low: Vec<f64> = all.iter().copied().filter(is_low).collect();
        if low.is_empty() { all } else { low }
    }

    /// The logarithm of the factor with which an output peaks at 95 V. Infinite for a pot, and for an output that is 0 V
    /// in the whole run.
    fn highest(&self, output: usize) -> f64 {
        let peak = self.evidence.peaks[output];
        let is_limited = peak > 0.0 && !self.evidence.wiring.is_pot(output);
        if is_limited { (GOOD_VOLTS[1] / peak).log10() } else { f64::INFINITY }
    }

    /// Freezes the gains of an element, and those of all that are connected by cords without pots to frozen elements.
    fn freeze(&self, element: usize, frozen: &mut BTreeSet<usize>) {
        let wiring = self.evidence.wiring;
        frozen.insert(element);
        let reached: Vec<usize> = self
            .direct_cords()
            .into_iter()
            .map(|(element, cord)| [element, wiring.cords[element][cord].0])
            .filter(|ends| ends.iter().any(|end| frozen.contains(end)))
            .flatten()
            .filter(|end| !wiring.is_reference(*end))
            .collect();
        let before = frozen.len();
        frozen.extend(reached);
        if frozen.len() == before {
            // The contradiction comes from elsewhere.
            frozen.extend(0..wiring.len());
        }
    }

    /// The logarithm of the ratio of the factors of an element and of an output that drives it, if both were at their
    /// targets. 0 if that is not known.
    fn wanted_ratio(&self, element: usize, from: usize) -> f64 {
        let own = match self.balances.contains_key(&element) {
            true => self.evidence.wiring.cords[element].iter().find_map(|(from, _)| self.aim(*from)),
            false => self.aim(element),
        };
        own.zip(self.aim(from)).map_or(0.0, |(to, from)| to - from)
    }

    /// The logarithm of the factor with which an output is at its target. `None` if it is 0 V in the whole run.
    fn aim(&self, output: usize) -> Option<f64> {
        let wiring = self.evidence.wiring;
        if wiring.is_ground(output) {
            return None;
        }
        if wiring.is_reference(output) {
            return Some(0.0);
        }
        if wiring.has_reference_ends(output) {
            // Its voltage can be small now, and large for other values of the parameters.
            return None;
        }
        if wiring.is_pot(output) {
            let setting = self.setting(output).filter(|setting| *setting > 0.0)?;
            let from = wiring.source(output, "in").filter(|from| !wiring.is_pot(*from))?;
            // An accurate setting can stay.
            let is_accurate = (LEAST_SETTING..=1.0).contains(&setting);
            let change = if is_accurate { 0.0 } else { (TARGET_SETTING / setting).log10() };
            return Some(self.aim(from)? + change);
        }
        let peak = self.evidence.peaks[output];
        (peak > 0.0).then(|| (TARGET_VOLTS / peak).log10())
    }
}

/// The rank of scales among the unknowns. They stay free, because they must be round numbers.
const SCALE_RANK: u32 = 3;

/// The rank of the factor of an output: an amplifier stays free rather than a network.
fn rank(wiring: &Wiring<'_>, element: usize) -> u32 {
    match wiring.kind(element).output {
        _ if wiring.is_pot(element) => 0,
        OutputStage::Passive => 1,
        _ => 2,
    }
}

/// Whether an element is a pot in front of other pots only, and no signal is read there.
fn is_first_pot(wiring: &Wiring<'_>, element: usize) -> bool {
    let readers = &wiring.readers[element];
    wiring.is_pot(element)
        && !wiring.has_signal[element]
        && !readers.is_empty()
        && readers.iter().all(|(reader, _)| wiring.is_pot(*reader))
}

/// The diode networks whose settings can follow their inputs: all their outputs lead to pots in front of gains, their
/// diodes have no forward drop, and no signal is read there.
fn adapting(evidence: Evidence<'_>) -> BTreeSet<usize> {
    let Evidence { wiring, old, .. } = evidence;
    let is_adapting = |element: &usize| {
        let value = |setting: &str| wiring.formula(*element, setting).map(|formula| old.value(formula, 0));
        let readers = &wiring.readers[*element];
        wiring.kind(*element).name == "diode-dead-zone"
            && !wiring.has_signal[*element]
            && value("setting").flatten().is_some_and(|setting| setting < 1.0)
            && value("drop").is_none_or(|drop| drop == Some(0.0))
            && !wiring.sources(*element, "in").is_empty()
            && readers.iter().all(|(reader, _)| wiring.gain_behind(*reader).is_some())
    };
    (0..wiring.len()).filter(is_adapting).collect()
}

/// Equal elements in the instances of a macro have equal factors, and so have their inputs: the macro has one setting and
/// one gain for all of them.
fn twin_ties(wiring: &Wiring<'_>) -> Vec<Affine> {
    let mut firsts: Vec<usize> = Vec::new();
    let mut found = Vec::new();
    for element in 0..wiring.len() {
        let Some(first) = firsts.iter().find(|first| wiring.are_twins(**first, element)).copied() else {
            firsts.extend(
                wiring.places[element].as_ref().filter(|place| place.instance.is_some()).map(|_| element),
            );
            continue;
        };
        let sources = wiring.cords[first].iter().zip(&wiring.cords[element]);
        let pairs = sources.map(|((one, _), (other, _))| (*one, *other)).chain([(first, element)]);
        let pairs = pairs.filter(|(one, other)| !wiring.is_ground(*one) && !wiring.is_ground(*other));
        found.extend(pairs.map(|(one, other)| Affine::sum(&[(one, 1.0), (other, -1.0)])));
    }
    found
}

/// The names in the formulas of the phases. A scale among them must stay.
fn names_in_phases(circuit: &Circuit) -> BTreeSet<String> {
    let mut names = BTreeSet::new();
    let mut open: Vec<&Phase> = circuit.patch().run.phases.iter().collect();
    while let Some(phase) = open.pop() {
        match phase {
            Phase::Repeat { phases, .. } => open.extend(phases),
            Phase::Set { changes } => {
                names.extend(changes.iter().flat_map(|change| change.to.value.names()).map(str::to_owned));
            }
            _ => (),
        }
    }
    names
}
