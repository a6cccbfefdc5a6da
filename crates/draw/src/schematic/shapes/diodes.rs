//! Diode networks, drawn as circuits.

use super::art::{Art, NAME, PRINT, SMALL, jack_heights};
use super::{Align, Ink, Symbol};

/// Half the width and height of the box.
const HALF: (f64, f64) = (50.0, 39.0);
/// The distance of the potentiometer tracks from the middle.
const TRACK: f64 = 17.0;
/// The distance of the bias jacks from the middle.
const BIAS: f64 = 30.0;

/// Draws the diode dead zone, Fig 8.5 (c) of the thesis.
///
/// Two potentiometer tracks run between the signal and the biases, with a diode from each wiper to the
/// output.
pub(super) fn dead_zone(symbol: &Symbol) -> Art {
    let mut art = Art { outputs: vec![(HALF.0, 0.0)], ..Art::default() };
    art.rectangle((-HALF.0, -HALF.1), HALF);
    // The jacks in the order of the kind: in, bias_plus, bias_minus.
    art.inputs = [0.0, BIAS, -BIAS].map(|y| (-HALF.0, y)).to_vec();
    art.line(&[(-HALF.0, 0.0), (-36.0, 0.0)]);
    for side in [-1.0, 1.0] {
        half_dead_zone(&mut art, side);
    }
    art.line(&[(38.0, 0.0), art.outputs[0]]);
    art.text("+VB", (-46.0, BIAS - 3.0), SMALL, Align::Start, Ink::Soft);
    art.text("−VB", (-46.0, -BIAS + 10.0), SMALL, Align::Start, Ink::Soft);
    art.above(&symbol.name, NAME, Ink::Line);
    super::network::setting_below(&mut art, symbol, "setting");
    parts_below(&mut art, symbol);
    art
}

/// Draws the half for negative signals (below, `side` 1) or for positive ones (above, `side` -1).
fn half_dead_zone(art: &mut Art, side: f64) {
    let (track, bias, wiper) = (TRACK * side, BIAS * side, 7.0 * side);
    art.line(&[(-36.0, 0.0), (-36.0, track), (-20.0, track)]);
    art.line(&[(6.0, track), (14.0, track), (14.0, bias), (-HALF.0, bias)]);
    art.resistor(-20.0, 6.0, track);
    art.line(&[(-7.0, track - 5.0 * side), (-7.0, wiper), (38.0, wiper), (38.0, 0.0)]);
    art.head((-7.0, track - 3.0 * side), (0.0, side));
    art.diode((20.0, wiper), (-side, 0.0));
}

/// Draws two diodes, of which the one at the lower voltage conducts.
pub(super) fn lower_of(symbol: &Symbol) -> Art {
    pair(symbol, "lower of", (-1.0, 0.0))
}

/// Draws two diodes, of which the one at the higher voltage conducts.
pub(super) fn upper_of(symbol: &Symbol) -> Art {
    pair(symbol, "upper of", (1.0, 0.0))
}

/// Draws a box with a diode from each input to the common output; `direction` is that of the forward current.
fn pair(symbol: &Symbol, label: &str, direction: (f64, f64)) -> Art {
    let mut art = Art { outputs: vec![(26.0, 0.0)], ..Art::default() };
    art.rectangle((-26.0, -20.0), (26.0, 20.0));
    art.inputs = jack_heights(symbol.jacks.len()).map(|y| (-26.0, y)).collect();
    for at in art.inputs.clone() {
        art.line(&[at, (10.0, at.1), (10.0, 0.0), art.outputs[0]]);
        art.diode((-6.0, at.1), direction);
    }
    art.disc((10.0, 0.0), 2.0);
    art.above(&symbol.name, NAME, Ink::Line);
    art.below(label, SMALL, Ink::Soft);
    parts_below(&mut art, symbol);
    art
}

/// Writes the names of the machine parts of a network below it.
pub(super) fn parts_below(art: &mut Art, symbol: &Symbol) {
    if !symbol.parts.is_empty() {
        art.below(&symbol.parts.join(" "), PRINT, Ink::Soft);
    }
}
