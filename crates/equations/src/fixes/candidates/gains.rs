//! Cords in jacks with another gain.

use patchcord_core::elements::Jacks;

use super::super::change::Change;
use super::super::formula::Product;
use super::super::panel::{Cord, Panel, WiredCord};
use super::{Candidates, cost, decades};

impl Candidates<'_, '_> {
    /// Each cord of a summing input in the jacks with other gains.
    pub(super) fn gains(&mut self) {
        let panel = self.panel;
        for (index, cord) in panel.cords.iter().enumerate() {
            let Some(WiredCord { element, link, .. }) = cord.wired.filter(|_| !panel.is_repeated(index))
            else {
                continue;
            };
            if panel.kind(element).inputs[link.input].jacks != Jacks::Gains {
                continue;
            }
            for (jack, gain) in panel.jacks(element, link.input) {
                if gain != link.factor {
                    let cost = gain_cost(panel, cord, link.factor, gain);
                    self.push(cost, Change::Regain { cord: index, jack, gain });
                }
            }
        }
    }
}

/// The cost of a change of a gain.
fn gain_cost(panel: &Panel<'_>, cord: &Cord, present: f64, gain: f64) -> u32 {
    let power = (gain / present).log10();
    if (power - power.round()).abs() > 1e-9 {
        return cost::UNUSUAL_GAIN;
    }
    let fits = |gain: f64| fits_pot(panel, &cord.place.source, gain);
    if fits(gain) && !fits(present) {
        cost::GAIN - cost::FITTING
    } else {
        cost::GAIN + decades(gain / present)
    }
}

/// Whether the power of ten in the setting of a pot is that of the gain behind it: "k / 10" fits x10, "k" fits x1. False
/// if the source is no pot with a formula.
pub(super) fn fits_pot(panel: &Panel<'_>, source: &str, gain: f64) -> bool {
    let setting = &panel.circuit.patch().value()["elements"][source]["setting"];
    let product = setting.as_str().and_then(|_| Product::new(setting));
    product.is_some_and(|product| 10f64.powi(product.divided_decades()) == gain)
}
