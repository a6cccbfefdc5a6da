//! Comparators, relays and switches.

use super::art::{Art, HALF_LETTER, NAME, PRINT, SMALL};
use super::function::square;
use super::{Align, Ink, Symbol};

/// Draws a relay: a coil with its switching levels, and a changeover contact.
pub(super) fn relay(symbol: &Symbol) -> Art {
    let is_compared = symbol.jacks.len() > 3;
    let bottom = if is_compared { 46.0 } else { 34.0 };
    let mut art = Art { outputs: vec![(34.0, -12.0)], ..Art::default() };
    art.rectangle((-34.0, -34.0), (34.0, bottom));
    // The jacks in the order of the kind: in, on, off, against.
    art.inputs =
        [20.0, -22.0, -2.0, 38.0][..3 + usize::from(is_compared)].iter().map(|y| (-34.0, *y)).collect();
    let pulled_in = symbol.position.map_or(symbol.flag("closed"), |position| position == PULLED_IN);
    contact(&mut art, pulled_in);
    art.line(&[(-34.0, 20.0), (-6.0, 20.0)]);
    art.rectangle((-6.0, 13.0), (14.0, 27.0));
    art.line(&[(-6.0, 27.0), (14.0, 13.0)]);
    art.rule(&[(4.0, 13.0), (4.0, -5.0)]);
    let mut names = vec![("on", -22.0), ("off", -2.0), ("in", 20.0)];
    if is_compared {
        art.line(&[(-34.0, 38.0), (10.0, 38.0), (10.0, 27.0)]);
        names.push(("against", 38.0));
    }
    for (name, y) in names {
        art.text(name, (-31.0, y - 3.0), SMALL, Align::Start, Ink::Soft);
    }
    art.above(&symbol.name, NAME, Ink::Line);
    for (name, sign) in [("pull_in", "on ≥"), ("drop_out", "off ≤")] {
        if let Some(setting) = symbol.setting(name) {
            art.below(&format!("{sign} {}", setting.shown), PRINT, Ink::Line);
        }
    }
    art
}

/// Draws a comparator: a box with a step and, below it, its threshold.
pub(super) fn comparator(symbol: &Symbol) -> Art {
    let mut art = square(symbol, 24.0);
    for (jack, at) in symbol.jacks.iter().zip(art.inputs.clone()) {
        let sign = if jack.input == "against" { "−" } else { "+" };
        art.text(sign, (at.0 + 4.0, at.1 + HALF_LETTER * SMALL), SMALL, Align::Start, Ink::Soft);
    }
    art.bold(&[(-10.0, 10.0), (4.0, 10.0), (4.0, -12.0), (18.0, -12.0)]);
    art.above(&symbol.name, NAME, Ink::Line);
    if let Some(threshold) = symbol.setting("threshold") {
        art.below(&format!("high ≥ {}", threshold.shown), PRINT, Ink::Line);
    }
    art
}

/// The switching position in which a relay connects its upper contact.
const PULLED_IN: &str = "pulled-in";

/// Draws the contact of a relay.
fn contact(art: &mut Art, pulled_in: bool) {
    let (on, off, pivot) = ((-8.0, -22.0), (-8.0, -2.0), (20.0, -12.0));
    art.line(&[(-34.0, -22.0), on]);
    art.line(&[(-34.0, -2.0), off]);
    art.line(&[pivot, art.outputs[0]]);
    art.bold(&[pivot, if pulled_in { on } else { off }]);
    [on, off, pivot].into_iter().for_each(|at| art.disc(at, 2.2));
}

/// Draws a track-hold amplifier: an amplifier with a controlled switch at its input.
pub(super) fn track_hold(symbol: &Symbol) -> Art {
    let mut art =
        Art { inputs: vec![(-52.0, 0.0), (-52.0, 22.0)], outputs: vec![(44.0, 0.0)], ..Art::default() };
    art.rectangle((-52.0, -30.0), (-6.0, 30.0));
    art.body(&[(-6.0, -30.0), (44.0, 0.0), (-6.0, 30.0)]);
    art.line(&[(-52.0, 0.0), (-38.0, 0.0)]);
    art.bold(&[(-38.0, 0.0), (-20.0, -9.0)]);
    art.line(&[(-19.0, 0.0), (-6.0, 0.0)]);
    art.disc((-38.0, 0.0), 2.2);
    art.disc((-19.0, 0.0), 2.2);
    art.rule(&[(-29.0, -3.0), (-29.0, 22.0), (-52.0, 22.0)]);
    art.text("T", (-48.0, 18.0), SMALL, Align::Start, Ink::Soft);
    art.name(&symbol.name, (13.0, 0.0), 26.0);
    if let Some(initial) = symbol.setting("initial") {
        art.above(&format!("IC {}", initial.shown), PRINT, Ink::Line);
    }
    if let Some(threshold) = symbol.setting("threshold") {
        art.below(&format!("tracks at T ≥ {}", threshold.shown), PRINT, Ink::Line);
    }
    art
}

/// Draws a key switch, open or closed.
pub(super) fn key(symbol: &Symbol) -> Art {
    let mut art = Art { inputs: vec![(-24.0, 0.0)], outputs: vec![(24.0, 0.0)], ..Art::default() };
    let tip = if symbol.flag("closed") { (12.0, -1.0) } else { (10.0, -11.0) };
    art.line(&[(-24.0, 0.0), (-12.0, 0.0)]);
    art.line(&[(12.0, 0.0), (24.0, 0.0)]);
    art.bold(&[(-12.0, 0.0), tip]);
    art.disc((-12.0, 0.0), 2.6);
    art.disc((12.0, 0.0), 2.6);
    art.text(&symbol.name, (0.0, -15.0), NAME, Align::Middle, Ink::Line);
    art.text(
        if symbol.flag("closed") { "closed" } else { "open" },
        (0.0, 14.0),
        SMALL,
        Align::Middle,
        Ink::Soft,
    );
    art
}
