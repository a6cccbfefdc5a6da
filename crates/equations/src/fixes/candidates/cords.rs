//! Cords from other outputs, further cords, and cords that are removed.

use patchcord_core::elements::Jacks;

use super::super::change::Change;
use super::super::panel::{Cord, Panel};
use super::gains::fits_pot;
use super::{Candidates, cost};

/// Products of the numbers of cords and outputs up to which every cord is tried from every output.
const MAX_MOVES: usize = 20_000;
/// Numbers of cords up to which every pair is exchanged.
const MAX_EXCHANGED: usize = 200;

impl Candidates<'_, '_> {
    /// The changes of cords.
    pub(super) fn cords(&mut self) {
        let panel = self.panel;
        let is_large = panel.cords.len().saturating_mul(panel.outputs.len()) > MAX_MOVES;
        for (index, cord) in panel.cords.iter().enumerate() {
            if panel.is_repeated(index) {
                continue;
            }
            self.moves(index, cord, is_large);
            self.push(cost::INVERTER, Change::Invert { cord: index });
            if is_summing(panel, cord) {
                self.push(cost::REMOVED_CORD, Change::Unplug { cord: index });
            }
        }
        self.additions(is_large);
        if panel.cords.len() <= MAX_EXCHANGED {
            self.exchanges();
        }
    }

    /// A cord from other outputs.
    fn moves(&mut self, index: usize, cord: &Cord, is_large: bool) {
        let panel = self.panel;
        for (output, to) in panel.outputs.iter().enumerate() {
            if to.name == cord.place.source
                || !can_drive(panel, cord.wired.map(|wired| wired.element), to.element)
            {
                continue;
            }
            let is_inverse = cord.wired.zip(to.element).is_some_and(|(wired, to)| {
                panel.inverts(to, wired.link.from) || panel.inverts(wired.link.from, to)
            });
            let cost = match (is_inverse, to.is_read) {
                (true, _) => cost::SIGN,
                (_, false) => cost::UNUSED_CORD,
                _ if is_large => continue,
                _ => cost::MOVED_CORD,
            };
            self.push(cost, Change::Replug { cord: index, output });
        }
    }

    /// Further cords into summing inputs.
    fn additions(&mut self, is_large: bool) {
        let panel = self.panel;
        for (_, element) in panel.elements() {
            let inputs = panel.kind(element).inputs.iter().enumerate();
            let summing = inputs.filter(|(_, input)| input.jacks == Jacks::Gains);
            for (input, _) in summing {
                let wired = panel.cords_into(element).filter(|wired| wired.link.input == input);
                let present: Vec<usize> = wired.map(|wired| wired.link.from).collect();
                // Laws have an input only if it has a cord.
                if !present.is_empty() {
                    self.additions_to(element, input, &present, is_large);
                }
            }
        }
    }

    /// Further cords into a summing input. `present` are the elements behind its cords.
    fn additions_to(&mut self, element: usize, input: usize, present: &[usize], is_large: bool) {
        let panel = self.panel;
        let jacks = panel.jacks(element, input);
        for (output, from) in panel.outputs.iter().enumerate() {
            let is_plugged = from.element.is_some_and(|from| present.contains(&from));
            if is_plugged || (from.is_read && is_large) || !can_drive(panel, Some(element), from.element) {
                continue;
            }
            let cost = if from.is_read { cost::ADDED_CORD } else { cost::UNUSED_CORD };
            for (jack, gain) in &jacks {
                let unfitting = if fits_pot(panel, &from.name, *gain) { 0 } else { cost::FITTING };
                let (jack, gain) = (jack.clone(), *gain);
                self.push(cost + unfitting, Change::Plug { element, input, jack, gain, output });
            }
        }
    }

    /// Pairs of cords that exchange their outputs.
    fn exchanges(&mut self) {
        let panel = self.panel;
        for (index, one) in panel.cords.iter().enumerate() {
            for (other_index, other) in panel.cords.iter().enumerate().skip(index + 1) {
                let [to_one, to_other] = [one, other].map(|cord| cord.wired.map(|wired| wired.element));
                let [from_one, from_other] = [one, other].map(|cord| cord.wired.map(|wired| wired.link.from));
                if one.place.source != other.place.source
                    && can_drive(panel, to_one, from_other)
                    && can_drive(panel, to_other, from_one)
                {
                    self.push(cost::EXCHANGED_CORDS, Change::Exchange { cords: [index, other_index] });
                }
            }
        }
    }
}

/// Whether a cord leads to a summing input.
fn is_summing(panel: &Panel<'_>, cord: &Cord) -> bool {
    cord.wired.is_some_and(|wired| panel.kind(wired.element).inputs[wired.link.input].jacks == Jacks::Gains)
}

/// Whether an output can drive an element. Only elements with a memory drive themselves: another one would be a loop
/// without an integrator.
fn can_drive(panel: &Panel<'_>, element: Option<usize>, output: Option<usize>) -> bool {
    let Some(element) = element.filter(|element| output == Some(*element)) else { return true };
    panel.kind(element).inputs.first().is_some_and(|main| !main.direct)
}
