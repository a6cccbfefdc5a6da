//! Instances of macros as boxes, and the ports of an opened one.

use super::art::{Art, HALF_LETTER, NAME, PRINT, SMALL, jack_heights};
use super::{Align, Ink, Symbol};
use crate::plot::{text_width, text_within};

/// Distance of output ports: room for what is read at each.
const OUTLETS: f64 = 28.0;

/// The least width of a box, and the room between the names of ports and its edge and each other.
const NARROW: f64 = 76.0;
const BESIDE: f64 = 4.0;
const BETWEEN: f64 = 14.0;

/// Texts of a box are cut to this width.
const WIDEST: f64 = 150.0;

/// A box with the names of its ports; its settings below the name of its macro.
pub(super) fn instance(symbol: &Symbol) -> Art {
    let inlets: Vec<String> = symbol.jacks.iter().map(|jack| cut(&jack.input)).collect();
    let outlets: Vec<String> = symbol.outlets.iter().map(|outlet| cut(&outlet.port)).collect();
    let widest = |names: &[String]| names.iter().map(|name| text_width(name, SMALL)).fold(0.0, f64::max);
    let room = widest(&inlets) + widest(&outlets) + 2.0 * BESIDE + BETWEEN;
    let half = (room.max(NARROW) / 2.0).ceil();
    let mut art = Art {
        inputs: jack_heights(inlets.len()).map(|y| (-half, y)).collect(),
        outputs: outlet_heights(outlets.len()).map(|y| (half, y)).collect(),
        ..Art::default()
    };
    let lowest = art.inputs.iter().chain(&art.outputs).map(|at| at.1).fold(0.0, f64::max);
    art.rectangle((-half, -lowest - 15.0), (half, lowest + 15.0));
    let sides = [(inlets, art.inputs.clone(), Align::Start), (outlets, art.outputs.clone(), Align::End)];
    for (names, places, align) in sides {
        let inward = if align == Align::Start { BESIDE } else { -BESIDE };
        for (name, at) in names.iter().zip(places) {
            art.text(name, (at.0 + inward, at.1 + HALF_LETTER * SMALL), SMALL, align, Ink::Soft);
        }
    }
    art.above(&cut(&symbol.name), NAME, Ink::Line);
    art.below(&cut(&symbol.kind), PRINT, Ink::Soft);
    for setting in &symbol.settings {
        art.below(&cut(&format!("{} {}", setting.name, setting.shown)), PRINT, Ink::Line);
    }
    if !symbol.inside.is_empty() {
        art.below(&cut(&format!("inside: {}", symbol.inside.join(", "))), PRINT, Ink::Signal);
    }
    art
}

fn cut(text: &str) -> String {
    text_within(text, PRINT, WIDEST)
}

fn outlet_heights(count: usize) -> impl Iterator<Item = f64> {
    let first = -OUTLETS * (count.max(1) - 1) as f64 / 2.0;
    (0..count).map(move |outlet| first + OUTLETS * outlet as f64)
}

const RADIUS: f64 = 4.5;

/// A port that signals come in by: its name at its left.
pub(super) fn inlet(symbol: &Symbol) -> Art {
    terminal(symbol, -1.0, Align::End)
}

/// A port that signals go out by: its name at its right.
pub(super) fn outlet(symbol: &Symbol) -> Art {
    let mut art = terminal(symbol, 1.0, Align::Start);
    art.inputs.push((-RADIUS, 0.0));
    art
}

fn terminal(symbol: &Symbol, side: f64, align: Align) -> Art {
    let mut art = Art { outputs: vec![(RADIUS, 0.0)], ..Art::default() };
    art.circle((0.0, 0.0), RADIUS);
    let place = (side * (RADIUS + BESIDE), HALF_LETTER * NAME);
    art.text(&cut(&symbol.name), place, NAME, align, Ink::Line);
    art
}
