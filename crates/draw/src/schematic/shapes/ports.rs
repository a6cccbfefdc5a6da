//! Macro instances as boxes, and the ports of an opened instance.

use super::art::{Art, HALF_LETTER, NAME, PRINT, SMALL, centred_heights, jack_heights};
use super::{Align, Ink, Symbol};
use crate::plot::{text_width, truncate_text};

/// The distance of output ports, which leaves space for the names and the voltage at each.
const OUTPUT_PITCH: f64 = 28.0;

/// The minimum width of a box.
const MIN_WIDTH: f64 = 76.0;
/// The gap between the name of a port and the edge.
const NAME_GAP: f64 = 4.0;
/// The minimum gap between the names of inputs and outputs.
const MIDDLE_GAP: f64 = 14.0;

/// The maximum width of the texts of a box; longer texts are truncated.
const MAX_TEXT_WIDTH: f64 = 150.0;

/// Draws an instance: a box with the names of its ports, and below it the macro and the settings.
pub(super) fn instance(symbol: &Symbol) -> Art {
    let inputs: Vec<String> = symbol.jacks.iter().map(|jack| truncated(&jack.input)).collect();
    let outputs: Vec<String> = symbol.outputs.iter().map(|output| truncated(&output.port)).collect();
    let widest = |names: &[String]| names.iter().map(|name| text_width(name, SMALL)).fold(0.0, f64::max);
    let min_width = widest(&inputs) + widest(&outputs) + 2.0 * NAME_GAP + MIDDLE_GAP;
    let half = (min_width.max(MIN_WIDTH) / 2.0).ceil();
    let mut art = Art {
        inputs: jack_heights(inputs.len()).map(|y| (-half, y)).collect(),
        outputs: centred_heights(outputs.len(), OUTPUT_PITCH).map(|y| (half, y)).collect(),
        ..Art::default()
    };
    let lowest = art.inputs.iter().chain(&art.outputs).map(|at| at.1).fold(0.0, f64::max);
    art.rectangle((-half, -lowest - 15.0), (half, lowest + 15.0));
    let sides = [(inputs, art.inputs.clone(), Align::Start), (outputs, art.outputs.clone(), Align::End)];
    for (names, positions, align) in sides {
        let inward = if align == Align::Start { NAME_GAP } else { -NAME_GAP };
        for (name, at) in names.iter().zip(positions) {
            art.text(name, (at.0 + inward, at.1 + HALF_LETTER * SMALL), SMALL, align, Ink::Soft);
        }
    }
    art.above(&truncated(&symbol.name), NAME, Ink::Line);
    art.below(&truncated(&symbol.kind), PRINT, Ink::Soft);
    for setting in &symbol.settings {
        art.below(&truncated(&format!("{} {}", setting.name, setting.shown)), PRINT, Ink::Line);
    }
    if !symbol.inside.is_empty() {
        art.below(&truncated(&format!("inside: {}", symbol.inside.join(", "))), PRINT, Ink::Signal);
    }
    art
}

/// Truncates a text of a box to [`MAX_TEXT_WIDTH`].
fn truncated(text: &str) -> String {
    truncate_text(text, PRINT, MAX_TEXT_WIDTH)
}

/// The radius of the circle of a port.
const RADIUS: f64 = 4.5;

/// Draws an input port with its name at the left.
pub(super) fn input(symbol: &Symbol) -> Art {
    terminal(symbol, -1.0, Align::End)
}

/// Draws an output port with its name at the right.
pub(super) fn output(symbol: &Symbol) -> Art {
    let mut art = terminal(symbol, 1.0, Align::Start);
    art.inputs.push((-RADIUS, 0.0));
    art
}

/// Draws a small circle with a name; `side` is -1 for a name at the left and 1 for a name at the right.
fn terminal(symbol: &Symbol, side: f64, align: Align) -> Art {
    let mut art = Art { outputs: vec![(RADIUS, 0.0)], ..Art::default() };
    art.circle((0.0, 0.0), RADIUS);
    let at = (side * (RADIUS + NAME_GAP), HALF_LETTER * NAME);
    art.text(&truncated(&symbol.name), at, NAME, align, Ink::Line);
    art
}
