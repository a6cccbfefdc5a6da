//! Where a circuit leaves room for an effect: its junctions, the drives that data feed, the friction levels.

use std::collections::HashSet;

use crate::data::experiment::Feed;
use patchcord_core::circuit::{Circuit, SignalPoint};
use patchcord_core::document::Report;
use patchcord_core::elements::Family;
use patchcord_core::patch::{Amount, Patch};
use patchcord_expr::{Dimension, Unit};

/// A quantity as it can be read off a circuit.
#[derive(Debug, Clone, PartialEq)]
pub struct Reading {
    /// The signal that names it.
    pub signal: String,
    /// The element or drive at which it is read.
    pub at: String,
    /// Whether the voltage there has the quantity's sign.
    pub is_upright: bool,
    /// What a volt stands for, without sign, as a formula of scales.
    pub scale: String,
    /// The same as a number of the unit.
    pub per_volt: f64,
    /// Its unit.
    pub unit: Unit,
}

/// An integrator and what drives it: a place at which something may act that the patch does not have.
#[derive(Debug, Clone)]
pub struct Junction {
    /// Name of the integrator.
    pub integrator: String,
    /// What it gives, read where the quantity is upright if it is anywhere.
    pub own: Reading,
    /// Whether the integrator's own voltage has the sign of what it gives.
    pub is_upright: bool,
    /// What drives it.
    pub sum: Sum,
    /// Whether it gives a velocity.
    pub is_motion: bool,
    /// Signals of the time integral of what it gives.
    pub positions: Vec<Reading>,
    /// Drives, and signals that can change in a run, in the unit of the sum,
    pub loads: Vec<Reading>,
    /// and those of them that are no drives.
    pub forces: Vec<Reading>,
}

/// What drives an integrator, and the way from there into it.
#[derive(Debug, Clone)]
pub struct Sum {
    /// The signal or drive in whose unit it is; `None` where none is named: the unit then is that of the rate.
    pub of: Option<Reading>,
    /// What a volt stands for, as a formula of scales or a number of the unit.
    pub scale: String,
    /// The same as a number of the unit.
    pub per_volt: f64,
    /// Its unit.
    pub unit: Unit,
    /// The potentiometers on the way, as one setting.
    pub setting: Option<String>,
    /// The gain of the jack at the end of the way.
    pub gain: f64,
    /// Where it comes from and goes to, if nothing else drives the integrator, and it drives nothing else on its way there.
    pub total: Option<Total>,
}

/// A cord through which comes what drives an integrator.
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
pub struct Total {
    /// From where.
    pub from: String,
    /// To which element.
    pub to: String,
}

/// Every place of a circuit at which an effect may attach.
#[derive(Debug, Clone, Default)]
pub struct Sites {
    /// Its junctions.
    pub junctions: Vec<Junction>,
    /// The drives that data feed.
    pub drives: Vec<Reading>,
    /// Named signals on the way to a brake or to the bias of a dead zone.
    pub levels: Vec<Reading>,
    /// Integrators of the patch itself that give no signal with a scale, so that nothing is known to act there.
    pub nameless: Vec<String>,
}

impl Sites {
    /// The places of a patch of which data feed these drives.
    ///
    /// # Errors
    /// When the patch cannot be wired.
    pub fn fed(patch: &Patch, drives: &[Feed]) -> Result<Sites, Box<Report>> {
        let fed: Vec<&str> = drives.iter().map(|feed| feed.drive.as_str()).collect();
        Ok(Sites::of(&Circuit::new(patch, &[])?, &fed))
    }

    /// The places of a circuit of which these drives are fed.
    pub fn of(circuit: &Circuit, fed: &[&str]) -> Sites {
        let wiring = Wiring::of(circuit);
        let integrators: Vec<usize> = wiring.of_kind("integrator").collect();
        let is_nameless = |element: &&usize| wiring.own(**element).is_none();
        let nameless = integrators.iter().filter(is_nameless).map(|element| wiring.name(*element).to_owned());
        let drives = fed.iter().filter_map(|name| wiring.drive(wiring.named(name)?));
        Sites {
            junctions: integrators.iter().filter_map(|element| wiring.junction(*element)).collect(),
            nameless: nameless.filter(|name| !name.contains('.')).collect(),
            drives: drives.collect(),
            levels: wiring.levels(),
        }
    }
}

/// The cords of a circuit, and its named signals.
struct Wiring<'c> {
    circuit: &'c Circuit,
    signals: Vec<&'c SignalPoint>,
}

/// The way back from a jack through amplifiers and potentiometers that do nothing but multiply.
#[derive(Clone)]
struct Way {
    /// Where it has come to.
    at: usize,
    /// The element before that.
    last: usize,
    /// The potentiometers passed.
    settings: Vec<String>,
}

impl<'c> Wiring<'c> {
    fn of(circuit: &'c Circuit) -> Self {
        let patch = circuit.patch();
        let named = circuit.signals().iter().filter(|point| patch.signals.contains_key(&point.name));
        Wiring { circuit, signals: named.collect() }
    }

    fn of_kind(&self, kind: &str) -> impl Iterator<Item = usize> {
        let elements = self.circuit.elements();
        let found = elements.into_iter().enumerate().filter(|(_, element)| element.kind.name == kind);
        found.map(|(index, _)| index).collect::<Vec<_>>().into_iter()
    }

    fn named(&self, name: &str) -> Option<usize> {
        self.circuit.elements().iter().position(|element| element.name == name)
    }

    fn name(&self, element: usize) -> &'c str {
        &self.circuit.element(element).name
    }

    /// The jacks of an input by its name, with the elements that drive them and their gains.
    fn cords(&self, element: usize, input: &str) -> Vec<(usize, f64)> {
        let inputs = self.circuit.element(element).kind.inputs;
        let cords = self.circuit.cords(element).into_iter();
        let those = cords.filter(|(_, cord)| inputs[cord.input].name == input);
        those.map(|(from, cord)| (from, cord.gain)).collect()
    }

    /// What an amplifier inverts that does nothing else.
    fn inverted(&self, element: usize) -> Option<usize> {
        let own = self.circuit.element(element);
        let is_plain = own.settings.iter().all(Option::is_none);
        let input = own.kind.inputs.first().filter(|_| is_plain)?;
        match (own.kind.name, self.cords(element, input.name).as_slice()) {
            ("inverter", [(from, _)]) => Some(*from),
            ("summer", [(from, gain)]) if *gain == 1.0 => Some(*from),
            _ => None,
        }
    }

    /// The element whose voltage, or the opposite of it, stands at an element.
    fn root(&self, mut element: usize) -> (usize, bool) {
        let mut is_upright = true;
        // A ring of inverters has no root: it is gone around once.
        for _ in self.circuit.elements() {
            let Some(from) = self.inverted(element) else { break };
            (element, is_upright) = (from, !is_upright);
        }
        (element, is_upright)
    }

    fn reading(&self, point: &SignalPoint) -> Option<Reading> {
        let (name, _) = self.circuit.derived(point.scale?);
        let size = point.factor.abs();
        let scale = if size == 1.0 { name.to_owned() } else { format!("({size} * {name})") };
        Some(Reading {
            signal: point.name.clone(),
            at: self.name(point.element).to_owned(),
            is_upright: point.factor > 0.0,
            scale,
            per_volt: size * self.circuit.per_volt(point.scale?)?,
            unit: self.circuit.derived_unit(point.scale?).clone(),
        })
    }

    fn drive(&self, element: usize) -> Option<Reading> {
        let own = self.circuit.element(element);
        let point = SignalPoint { name: own.name.clone(), element, scale: own.scale, factor: 1.0 };
        let is_drive = own.kind.family == Family::Drive;
        is_drive.then(|| self.reading(&point)).flatten()
    }

    fn readings(&self) -> impl Iterator<Item = (usize, Reading)> + '_ {
        self.signals.iter().filter_map(|point| Some((point.element, self.reading(point)?)))
    }

    /// What the integrator gives, and whether its own voltage is upright.
    fn own(&self, integrator: usize) -> Option<(Reading, bool)> {
        let rooted = self.readings().filter_map(|(element, reading)| {
            let (root, as_root) = self.root(element);
            (root == integrator).then_some((reading.is_upright == as_root, reading))
        });
        let mut rooted: Vec<_> = rooted.collect();
        rooted.sort_by_key(|(_, reading)| !reading.is_upright);
        let (is_upright, mut own) = rooted.into_iter().next()?;
        if is_upright && !own.is_upright {
            own.at = self.name(integrator).to_owned();
            own.is_upright = true;
        }
        Some((own, is_upright))
    }

    fn junction(&self, element: usize) -> Option<Junction> {
        let name = self.name(element);
        let (own, is_upright) = self.own(element)?;
        let dimension = own.unit.dimension();
        let is_inside = name.contains('.');
        if is_inside || self.is_kinematic(element, dimension) {
            return None;
        }
        let sum = self.sum(element, &own)?;
        let integral = dimension.times(Dimension::TIME);
        let at_sum = sum.of.as_ref().map(|of| of.at.clone());
        let measures = |reading: &Reading, dimension| reading.unit.dimension() == dimension;
        let positions = self.readings().map(|(_, reading)| reading);
        let drives = (0..self.circuit.elements().len()).filter_map(|drive| self.drive(drive));
        let is_load = |reading: &Reading| {
            measures(reading, sum.unit.dimension()) && Some(&reading.at) != at_sum.as_ref()
        };
        let is_force = |at: usize| self.root(at).0 != element && self.varies(at);
        let forces = self.readings().filter(|(at, _)| is_force(*at)).map(|(_, reading)| reading);
        let forces: Vec<Reading> = forces.filter(is_load).collect();
        Some(Junction {
            integrator: name.to_owned(),
            is_motion: integral == Dimension::LENGTH || integral == Dimension::NONE,
            positions: positions.filter(|reading| measures(reading, integral)).collect(),
            loads: forces.iter().cloned().chain(drives.filter(is_load)).collect(),
            forces,
            own,
            is_upright,
            sum,
        })
    }

    /// Whether its voltage can change in a run: a setting or level that parameters alone make cannot.
    fn varies(&self, element: usize) -> bool {
        let (mut open, mut seen) = (vec![element], HashSet::new());
        while let Some(element) = open.pop() {
            let kind = self.circuit.element(element).kind;
            if kind.family == Family::Drive || kind.memory_law.is_some() {
                return true;
            }
            let behind = self.circuit.cords(element).into_iter().map(|(from, _)| from);
            open.extend(behind.filter(|from| seen.insert(*from)));
        }
        false
    }

    /// Whether the integrator only integrates what another gives, as position does velocity.
    fn is_kinematic(&self, element: usize, own: Dimension) -> bool {
        let rate = own.over(Dimension::TIME);
        let integrates = |from: usize| {
            let root = self.ways(from, element).last().map_or(from, |way| self.root(way.at).0);
            self.circuit.element(root).kind.name == "integrator"
                && self.own(root).is_some_and(|(own, _)| own.unit.dimension() == rate)
        };
        self.cords(element, "x").iter().any(|(from, _)| integrates(*from))
    }

    /// The way back from an element that drives another: every place on it.
    fn ways(&self, from: usize, to: usize) -> Vec<Way> {
        let mut way = Way { at: from, last: to, settings: Vec::new() };
        let mut ways = vec![way.clone()];
        while let Some((next, setting)) = self.back(way.at) {
            if ways.iter().any(|way| way.at == next) {
                break;
            }
            way.settings.extend(setting);
            way = Way { at: next, last: way.at, settings: way.settings };
            ways.push(way.clone());
        }
        ways
    }

    /// What is behind an element that only multiplies.
    fn back(&self, element: usize) -> Option<(usize, Option<String>)> {
        let own = self.circuit.element(element);
        if own.name.contains('.') {
            return None;
        }
        if let Some(from) = self.inverted(element) {
            return Some((from, None));
        }
        let cords = self.circuit.cords(element);
        match (own.kind.name, own.settings.first(), cords.as_slice()) {
            ("pot", Some(Some(setting)), [(from, _)]) => match &setting.value {
                Amount::Formula(formula) => Some((*from, Some(format!("({})", formula.text())))),
                _ => None,
            },
            _ => None,
        }
    }

    /// What drives an integrator: the farthest named signal behind one of its jacks, or else a drive, or else its rate.
    fn sum(&self, element: usize, own: &Reading) -> Option<Sum> {
        let cords = self.cords(element, "x");
        let is_braked = !self.cords(element, "brake_x").is_empty();
        let mut found: Vec<(bool, Reading, Way, f64)> = Vec::new();
        for (from, gain) in &cords {
            let named = self.ways(*from, element).into_iter().filter_map(|way| {
                let is_own = self.root(way.at).0 == element;
                let reading = self.reading_at(way.at).filter(|_| !is_own)?;
                let is_state = self.circuit.element(self.root(way.at).0).kind.name == "integrator";
                (!is_state).then(|| (self.drive(way.at).is_some(), reading, way, *gain))
            });
            found.extend(named.collect::<Vec<_>>().into_iter().rev());
        }
        // The farthest back, but signals before drives: the sort keeps the order.
        found.sort_by_key(|(is_drive, ..)| *is_drive);
        let Some((_, reading, way, gain)) = found.into_iter().next() else {
            return self.rate(own);
        };
        let is_all = cords.len() == 1 && !is_braked && self.ends_at(way.last, element);
        let total = Total { from: self.name(way.at).to_owned(), to: self.name(way.last).to_owned() };
        Some(Sum {
            scale: reading.scale.clone(),
            per_volt: reading.per_volt,
            unit: reading.unit.clone(),
            of: Some(reading),
            setting: (!way.settings.is_empty()).then(|| way.settings.join(" * ")),
            gain,
            total: is_all.then_some(total),
        })
    }

    /// Whether all that an element gives comes to another.
    fn ends_at(&self, mut element: usize, other: usize) -> bool {
        while element != other {
            let all = (0..self.circuit.elements().len()).flat_map(|to| {
                self.circuit.cords(to).into_iter().filter(move |(from, _)| *from == element).map(move |_| to)
            });
            match all.collect::<Vec<_>>().as_slice() {
                [only] => element = *only,
                _ => return false,
            }
        }
        true
    }

    fn reading_at(&self, element: usize) -> Option<Reading> {
        let named = self.signals.iter().find(|point| point.element == element && point.scale.is_some());
        named.and_then(|point| self.reading(point)).or_else(|| self.drive(element))
    }

    /// The rate of what it gives, 10 V for as much as fills the scale in a second.
    fn rate(&self, own: &Reading) -> Option<Sum> {
        let per_volt = own.per_volt * 10.0 * self.circuit.time_scale();
        Some(Sum {
            of: None,
            scale: format!("{per_volt}"),
            per_volt,
            unit: own.unit.per_second(),
            setting: None,
            gain: 10.0,
            total: None,
        })
    }

    /// Named signals on the ways to brakes and to the biases of dead zones, velocities left out.
    fn levels(&self) -> Vec<Reading> {
        let mut found: Vec<usize> = Vec::new();
        let mut open: Vec<usize> = Vec::new();
        for element in self.of_kind("integrator") {
            open.extend(self.cords(element, "brake_x").iter().map(|(from, _)| *from));
        }
        for element in self.of_kind("diode-dead-zone") {
            open.extend(self.cords(element, "bias_plus").iter().map(|(from, _)| *from));
        }
        let mut seen: Vec<usize> = Vec::new();
        while let Some(element) = open.pop() {
            let root = self.circuit.element(self.root(element).0);
            let ends = root.kind.name == "integrator" || root.kind.family != Family::Computing;
            if ends || seen.contains(&element) {
                continue;
            }
            seen.push(element);
            found.push(element);
            open.extend(self.circuit.cords(element).into_iter().map(|(from, _)| from));
        }
        found.sort_unstable();
        let named = found.into_iter().filter(|element| !self.name(*element).contains('.'));
        named.filter_map(|element| self.reading_at(element)).collect()
    }
}
