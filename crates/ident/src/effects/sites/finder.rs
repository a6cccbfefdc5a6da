//! Finds the sites of a circuit: the sum of every integrator, and the signals and drives that an effect may use.

use std::collections::HashSet;

use super::{InputSum, Junction, ScaledSignal, TotalCord};
use patchcord_core::circuit::{Circuit, SignalPoint};
use patchcord_core::elements::Family;
use patchcord_core::patch::Amount;
use patchcord_expr::Dimension;

/// Finds the sites of a circuit. Elements are indices of the circuit's list.
pub(super) struct SiteFinder<'c> {
    /// The circuit.
    circuit: &'c Circuit,
    /// The signals that the patch declares.
    signals: Vec<&'c SignalPoint>,
}

/// A point on the path back from an integrator's jack through elements that only multiply.
#[derive(Clone)]
struct UpstreamPoint {
    /// The element at this point.
    element: usize,
    /// The element that this point drives on the path.
    driven: usize,
    /// The settings of the potentiometers between this point and the integrator, as formulas.
    settings: Vec<String>,
}

impl<'c> SiteFinder<'c> {
    /// Lists the signals that the patch declares; the circuit's list also has drives and elements.
    pub(super) fn of(circuit: &'c Circuit) -> Self {
        let patch = circuit.patch();
        let declared = circuit.signals().iter().filter(|point| patch.signals.contains_key(&point.name));
        SiteFinder { circuit, signals: declared.collect() }
    }

    /// The elements of a kind, in the order of the circuit.
    pub(super) fn of_kind(&self, kind: &str) -> impl Iterator<Item = usize> {
        let elements = self.circuit.elements();
        let matching = elements.into_iter().enumerate().filter(|(_, element)| element.kind.name == kind);
        matching.map(|(index, _)| index).collect::<Vec<_>>().into_iter()
    }

    /// The index of the element with this name.
    pub(super) fn named(&self, name: &str) -> Option<usize> {
        self.circuit.elements().iter().position(|element| element.name == name)
    }

    /// The name of an element.
    pub(super) fn name(&self, element: usize) -> &'c str {
        &self.circuit.element(element).name
    }

    /// The cords into an input with this name: the driving element and the gain of the jack.
    fn cords(&self, element: usize, input: &str) -> Vec<(usize, f64)> {
        let inputs = self.circuit.element(element).kind.inputs;
        let cords = self.circuit.cords(element).into_iter();
        let matching = cords.filter(|(_, cord)| inputs[cord.input].name == input);
        matching.map(|(from, cord)| (from, cord.gain)).collect()
    }

    /// The driving element if this element only inverts: an inverter, or a summer with a single cord of gain 1.
    fn inverted(&self, element: usize) -> Option<usize> {
        let amplifier = self.circuit.element(element);
        let has_no_settings = amplifier.settings.iter().all(Option::is_none);
        let input = amplifier.kind.inputs.first().filter(|_| has_no_settings)?;
        match (amplifier.kind.name, self.cords(element, input.name).as_slice()) {
            ("inverter", [(from, _)]) => Some(*from),
            ("summer", [(from, gain)]) if *gain == 1.0 => Some(*from),
            _ => None,
        }
    }

    /// The element at the start of a chain of inverters, and whether its voltage equals that of `element`. Otherwise it
    /// is the opposite.
    fn root(&self, mut element: usize) -> (usize, bool) {
        let mut is_noninverted = true;
        // A ring of inverters has no root, so the number of steps is limited.
        for _ in self.circuit.elements() {
            let Some(from) = self.inverted(element) else { break };
            (element, is_noninverted) = (from, !is_noninverted);
        }
        (element, is_noninverted)
    }

    /// The quantity of a signal. `None` if it has no scale.
    fn scaled_signal(&self, point: &SignalPoint) -> Option<ScaledSignal> {
        let (name, _) = self.circuit.derived(point.scale?);
        let factor = point.factor.abs();
        let scale = if factor == 1.0 { name.to_owned() } else { format!("({factor} * {name})") };
        Some(ScaledSignal {
            signal: point.name.clone(),
            element: self.name(point.element).to_owned(),
            is_noninverted: point.factor > 0.0,
            scale,
            per_volt: factor * self.circuit.per_volt(point.scale?)?,
            unit: self.circuit.derived_unit(point.scale?).clone(),
        })
    }

    /// The quantity of a drive. `None` if the element is not a drive or has no scale.
    pub(super) fn drive(&self, element: usize) -> Option<ScaledSignal> {
        let drive = self.circuit.element(element);
        let point = SignalPoint { name: drive.name.clone(), element, scale: drive.scale, factor: 1.0 };
        let is_drive = drive.kind.family == Family::Drive;
        is_drive.then(|| self.scaled_signal(&point)).flatten()
    }

    /// The quantities of all declared signals, each with the element of its output.
    fn scaled_signals(&self) -> impl Iterator<Item = (usize, ScaledSignal)> + '_ {
        self.signals.iter().filter_map(|point| Some((point.element, self.scaled_signal(point)?)))
    }

    /// The quantity that an integrator computes, and whether its own voltage is noninverted. A noninverted output is
    /// preferred. `None` if no signal at the integrator or behind inverters has a scale.
    ///
    /// The rate of this quantity gives the unit of the sum if no signal names the sum.
    pub(super) fn output(&self, integrator: usize) -> Option<(ScaledSignal, bool)> {
        let candidates = self.scaled_signals().filter_map(|(element, signal)| {
            let (root, equals_root) = self.root(element);
            (root == integrator).then_some((signal.is_noninverted == equals_root, signal))
        });
        let mut candidates: Vec<_> = candidates.collect();
        candidates.sort_by_key(|(_, signal)| !signal.is_noninverted);
        let (is_noninverted, mut output) = candidates.into_iter().next()?;
        if is_noninverted && !output.is_noninverted {
            output.element = self.name(integrator).to_owned();
            output.is_noninverted = true;
        }
        Some((output, is_noninverted))
    }

    /// The junction of an integrator. `None` if no effect can act there: it is within a macro, its output has no scale,
    /// or it only integrates a velocity.
    pub(super) fn junction(&self, element: usize) -> Option<Junction> {
        let name = self.name(element);
        let (output, is_noninverted) = self.output(element)?;
        let dimension = output.unit.dimension();
        let is_in_macro = name.contains('.');
        if is_in_macro || self.is_kinematic(element, dimension) {
            return None;
        }
        let sum = self.sum(element, &output)?;
        let integral = dimension.times(Dimension::TIME);
        let sum_element = sum.signal.as_ref().map(|signal| signal.element.clone());
        let has_dimension = |signal: &ScaledSignal, dimension| signal.unit.dimension() == dimension;
        let signals = self.scaled_signals().map(|(_, signal)| signal);
        let drives = (0..self.circuit.elements().len()).filter_map(|drive| self.drive(drive));
        let is_load = |signal: &ScaledSignal| {
            has_dimension(signal, sum.unit.dimension()) && Some(&signal.element) != sum_element.as_ref()
        };
        let is_force = |carrier: usize| self.root(carrier).0 != element && self.is_variable(carrier);
        let forces = self.scaled_signals().filter(|(carrier, _)| is_force(*carrier));
        let forces: Vec<ScaledSignal> = forces.map(|(_, signal)| signal).filter(is_load).collect();
        Some(Junction {
            integrator: name.to_owned(),
            is_motion: integral == Dimension::LENGTH || integral == Dimension::NONE,
            positions: signals.filter(|signal| has_dimension(signal, integral)).collect(),
            loads: forces.iter().cloned().chain(drives.filter(is_load)).collect(),
            forces,
            output,
            is_noninverted,
            sum,
        })
    }

    /// Whether a voltage can change in a run: a drive or an element with memory is upstream. A level that only depends
    /// on parameters cannot.
    ///
    /// A voltage that never changes cannot be the load on which an effect depends.
    fn is_variable(&self, element: usize) -> bool {
        let (mut open, mut seen) = (vec![element], HashSet::new());
        while let Some(element) = open.pop() {
            let kind = self.circuit.element(element).kind;
            if kind.family == Family::Drive || kind.memory_law.is_some() {
                return true;
            }
            let upstream = self.circuit.cords(element).into_iter().map(|(from, _)| from);
            open.extend(upstream.filter(|from| seen.insert(*from)));
        }
        false
    }

    /// Whether the integrator only integrates the output of another integrator, as a position does a velocity.
    /// `dimension` is that of its own output.
    ///
    /// No force acts on a position: it follows from the velocity alone, so no effect is tried there.
    fn is_kinematic(&self, element: usize, dimension: Dimension) -> bool {
        let rate = dimension.over(Dimension::TIME);
        let is_integrated = |from: usize| {
            let path = self.upstream_path(from, element);
            let root = path.last().map_or(from, |point| self.root(point.element).0);
            self.circuit.element(root).kind.name == "integrator"
                && self.output(root).is_some_and(|(output, _)| output.unit.dimension() == rate)
        };
        self.cords(element, "x").iter().any(|(from, _)| is_integrated(*from))
    }

    /// The path back from `from`, which drives `to`, through elements that only multiply. The first point is `from`.
    fn upstream_path(&self, from: usize, to: usize) -> Vec<UpstreamPoint> {
        let mut point = UpstreamPoint { element: from, driven: to, settings: Vec::new() };
        let mut path = vec![point.clone()];
        while let Some((next, setting)) = self.multiplied(point.element) {
            if path.iter().any(|point| point.element == next) {
                break;
            }
            point.settings.extend(setting);
            point = UpstreamPoint { element: next, driven: point.element, settings: point.settings };
            path.push(point.clone());
        }
        path
    }

    /// The driving element if this element only multiplies, and the setting if it is a potentiometer. Elements of
    /// macros do not count, because a formula of the patch cannot contain their settings.
    fn multiplied(&self, element: usize) -> Option<(usize, Option<String>)> {
        let multiplier = self.circuit.element(element);
        if multiplier.name.contains('.') {
            return None;
        }
        if let Some(from) = self.inverted(element) {
            return Some((from, None));
        }
        let cords = self.circuit.cords(element);
        match (multiplier.kind.name, multiplier.settings.first(), cords.as_slice()) {
            ("pot", Some(Some(setting)), [(from, _)]) => match &setting.value {
                Amount::Formula(formula) => Some((*from, Some(format!("({})", formula.text())))),
                _ => None,
            },
            _ => None,
        }
    }

    /// The sum that drives an integrator: the farthest named signal upstream of one of its jacks. If there is none, a
    /// drive; if there is no drive either, the rate of its output.
    fn sum(&self, element: usize, output: &ScaledSignal) -> Option<InputSum> {
        let cords = self.cords(element, "x");
        let is_braked = !self.cords(element, "brake_x").is_empty();
        let mut candidates: Vec<(bool, ScaledSignal, UpstreamPoint, f64)> = Vec::new();
        for (from, gain) in &cords {
            let named = self.upstream_path(*from, element).into_iter().filter_map(|point| {
                let is_feedback = self.root(point.element).0 == element;
                let signal = self.signal_at(point.element).filter(|_| !is_feedback)?;
                let is_state = self.circuit.element(self.root(point.element).0).kind.name == "integrator";
                (!is_state).then(|| (self.drive(point.element).is_some(), signal, point, *gain))
            });
            candidates.extend(named.collect::<Vec<_>>().into_iter().rev());
        }
        // Signals before drives. The sort is stable, so the farthest point of a path remains first.
        candidates.sort_by_key(|(is_drive, ..)| *is_drive);
        let Some((_, signal, point, gain)) = candidates.into_iter().next() else {
            return self.rate(output);
        };
        let is_total = cords.len() == 1 && !is_braked && self.drives_only(point.driven, element);
        let total_cord =
            TotalCord { from: self.name(point.element).to_owned(), to: self.name(point.driven).to_owned() };
        Some(InputSum {
            scale: signal.scale.clone(),
            per_volt: signal.per_volt,
            unit: signal.unit.clone(),
            signal: Some(signal),
            setting: (!point.settings.is_empty()).then(|| point.settings.join(" * ")),
            gain,
            total_cord: is_total.then_some(total_cord),
        })
    }

    /// Whether an element, and each element that it drives in turn, drives a single input, up to `target`.
    fn drives_only(&self, mut element: usize, target: usize) -> bool {
        while element != target {
            let driven = (0..self.circuit.elements().len()).flat_map(|to| {
                self.circuit.cords(to).into_iter().filter(move |(from, _)| *from == element).map(move |_| to)
            });
            match driven.collect::<Vec<_>>().as_slice() {
                [only] => element = *only,
                _ => return false,
            }
        }
        true
    }

    /// The quantity at an element: that of a signal, or of the element if it is a drive.
    fn signal_at(&self, element: usize) -> Option<ScaledSignal> {
        let declared = self.signals.iter().find(|point| point.element == element && point.scale.is_some());
        declared.and_then(|point| self.scaled_signal(point)).or_else(|| self.drive(element))
    }

    /// A sum in the unit of the output's rate, at a jack of gain 10. One volt changes the output by ten of its volts
    /// per second of machine time.
    fn rate(&self, output: &ScaledSignal) -> Option<InputSum> {
        let per_volt = output.per_volt * 10.0 * self.circuit.time_scale();
        Some(InputSum {
            signal: None,
            scale: format!("{per_volt}"),
            per_volt,
            unit: output.unit.per_second(),
            setting: None,
            gain: 10.0,
            total_cord: None,
        })
    }

    /// The friction levels: named signals on the paths to brakes and to the biases of dead zones. The paths end at
    /// integrators, so velocities are not among them.
    pub(super) fn levels(&self) -> Vec<ScaledSignal> {
        let mut on_path: Vec<usize> = Vec::new();
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
            let is_end = root.kind.name == "integrator" || root.kind.family != Family::Computing;
            if is_end || seen.contains(&element) {
                continue;
            }
            seen.push(element);
            on_path.push(element);
            open.extend(self.circuit.cords(element).into_iter().map(|(from, _)| from));
        }
        on_path.sort_unstable();
        let outside_macros = on_path.into_iter().filter(|element| !self.name(*element).contains('.'));
        outside_macros.filter_map(|element| self.signal_at(element)).collect()
    }
}
