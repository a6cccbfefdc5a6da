//! Potentiometers, and the plain box for kinds without a symbol.

use super::art::{Art, HALF_LETTER, NAME, PRINT, SMALL, jack_heights};
use super::{Align, Ink, Symbol};
use crate::plot::text_width;

/// The radius of a potentiometer.
const RADIUS: f64 = 17.0;

/// The maximum width of a formula at a symbol; a wider one is only in the list below the drawing.
const MAX_FORMULA_WIDTH: f64 = 100.0;

/// Draws a potentiometer: a circle with its name inside and its setting below.
pub(super) fn potentiometer(symbol: &Symbol) -> Art {
    let mut art = circle(symbol);
    setting_below(&mut art, symbol, "setting");
    art
}

/// Returns the circle of a potentiometer with one input and one output.
fn circle(symbol: &Symbol) -> Art {
    let mut art = Art { inputs: vec![(-RADIUS, 0.0)], outputs: vec![(RADIUS, 0.0)], ..Art::default() };
    art.circle((0.0, 0.0), RADIUS);
    art.name(&symbol.name, (0.0, 0.0), 2.0 * RADIUS - 5.0);
    art
}

/// Draws a potentiometer whose other end has a separate jack, below.
pub(super) fn free_potentiometer(symbol: &Symbol) -> Art {
    let mut art = circle(symbol);
    let below = RADIUS + 6.0;
    art.inputs.push((-RADIUS, below));
    art.line(&[(-RADIUS, below), (0.0, below), (0.0, RADIUS)]);
    setting_below(&mut art, symbol, "setting");
    art
}

/// Writes a setting below the symbol, and its formula if that is short.
pub(super) fn setting_below(art: &mut Art, symbol: &Symbol, name: &str) {
    let Some(setting) = symbol.setting(name) else { return };
    art.below(&setting.shown, PRINT, Ink::Line);
    if let Some(formula) =
        setting.formula.as_ref().filter(|formula| text_width(formula, SMALL) <= MAX_FORMULA_WIDTH)
    {
        art.below(formula, SMALL, Ink::Soft);
    }
}

/// Draws a box with its name and the names of its jacks.
pub(super) fn plain_box(symbol: &Symbol) -> Art {
    let (half_width, half_height) = (38.0, (8.0 * symbol.jacks.len() as f64 + 6.0).max(22.0));
    let mut art = Art { outputs: vec![(half_width, 0.0)], ..Art::default() };
    art.rectangle((-half_width, -half_height), (half_width, half_height));
    art.inputs = jack_heights(symbol.jacks.len()).map(|y| (-half_width, y)).collect();
    for (jack, at) in symbol.jacks.iter().zip(art.inputs.clone()) {
        let at = (at.0 + 4.0, at.1 + HALF_LETTER * SMALL);
        art.text(&jack.input, at, SMALL, Align::Start, Ink::Soft);
    }
    art.above(&symbol.name, NAME, Ink::Line);
    art.below(&symbol.kind, SMALL, Ink::Soft);
    art
}
