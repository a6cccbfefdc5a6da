//! Networks without an amplifier: potentiometers; and the box for what has no symbol.

use super::art::{Art, HALF_LETTER, NAME, PRINT, SMALL, jack_heights};
use super::{Align, Ink, Symbol};
use crate::plot::text_width;

const RADIUS: f64 = 17.0;

/// A formula wider than this stands in the list below the drawing only.
const SHORT: f64 = 100.0;

pub(super) fn potentiometer(symbol: &Symbol) -> Art {
    let mut art = circle(symbol);
    setting_below(&mut art, symbol, "setting");
    art
}

fn circle(symbol: &Symbol) -> Art {
    let mut art = Art { inputs: vec![(-RADIUS, 0.0)], outputs: vec![(RADIUS, 0.0)], ..Art::default() };
    art.circle((0.0, 0.0), RADIUS);
    art.name(&symbol.name, (0.0, 0.0), 2.0 * RADIUS - 5.0);
    art
}

/// A circle whose other end is a jack of its own, below.
pub(super) fn free_potentiometer(symbol: &Symbol) -> Art {
    let mut art = circle(symbol);
    let below = RADIUS + 6.0;
    art.inputs.push((-RADIUS, below));
    art.line(&[(-RADIUS, below), (0.0, below), (0.0, RADIUS)]);
    setting_below(&mut art, symbol, "setting");
    art
}

/// A setting under the symbol, and how it comes about if that is short.
pub(super) fn setting_below(art: &mut Art, symbol: &Symbol, name: &str) {
    let Some(setting) = symbol.setting(name) else { return };
    art.below(&setting.shown, PRINT, Ink::Line);
    if let Some(formula) = setting.formula.as_ref().filter(|formula| text_width(formula, SMALL) <= SHORT) {
        art.below(formula, SMALL, Ink::Soft);
    }
}

/// A box with the names of its jacks, and its name.
pub(super) fn plain_box(symbol: &Symbol) -> Art {
    let (half_width, half_height) = (38.0, (8.0 * symbol.jacks.len() as f64 + 6.0).max(22.0));
    let mut art = Art { outputs: vec![(half_width, 0.0)], ..Art::default() };
    art.rectangle((-half_width, -half_height), (half_width, half_height));
    art.inputs = jack_heights(symbol.jacks.len()).map(|y| (-half_width, y)).collect();
    for (jack, at) in symbol.jacks.iter().zip(art.inputs.clone()) {
        let place = (at.0 + 4.0, at.1 + HALF_LETTER * SMALL);
        art.text(&jack.input, place, SMALL, Align::Start, Ink::Soft);
    }
    art.above(&symbol.name, NAME, Ink::Line);
    art.below(&symbol.kind, SMALL, Ink::Soft);
    art
}
