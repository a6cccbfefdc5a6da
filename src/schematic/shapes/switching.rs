//! Relays and switches.

use super::art::{Art, NAME, PRINT, SMALL};
use super::{Align, Ink, Symbol};

/// A coil that is compared with two levels, and a contact that it throws.
pub(super) fn relay(symbol: &Symbol) -> Art {
    let mut art = Art { output: (32.0, -12.0), ..Art::default() };
    art.rectangle((-32.0, -34.0), (32.0, 34.0));
    // The jacks in the order of the kind: in, on, off.
    art.inputs = vec![(-32.0, 20.0), (-32.0, -22.0), (-32.0, -2.0)];
    let (on, off, pivot) = ((-8.0, -22.0), (-8.0, -2.0), (18.0, -12.0));
    art.line(&[(-32.0, -22.0), on]);
    art.line(&[(-32.0, -2.0), off]);
    art.line(&[pivot, art.output]);
    let thrown = if symbol.flag("closed") { on } else { off };
    art.bold(&[pivot, thrown]);
    [on, off, pivot].into_iter().for_each(|at| art.disc(at, 2.2));
    art.line(&[(-32.0, 20.0), (-10.0, 20.0)]);
    art.rectangle((-10.0, 13.0), (10.0, 27.0));
    art.line(&[(-10.0, 27.0), (10.0, 13.0)]);
    art.rule(&[(2.0, 13.0), (2.0, -5.0)]);
    art.text("on", (-29.0, -25.0), SMALL, Align::Start, Ink::Soft);
    art.text("off", (-29.0, -5.0), SMALL, Align::Start, Ink::Soft);
    art.text("in", (-29.0, 17.0), SMALL, Align::Start, Ink::Soft);
    art.above(&symbol.name, NAME, Ink::Line);
    for (name, sign) in [("pull_in", "on ≥"), ("drop_out", "off ≤")] {
        if let Some(setting) = symbol.setting(name) {
            art.below(&format!("{sign} {}", setting.shown), PRINT, Ink::Line);
        }
    }
    art
}

/// An amplifier behind a switch that its control opens and closes.
pub(super) fn track_hold(symbol: &Symbol) -> Art {
    let mut art = Art { inputs: vec![(-52.0, 0.0), (-52.0, 22.0)], output: (44.0, 0.0), ..Art::default() };
    art.rectangle((-52.0, -28.0), (-6.0, 30.0));
    art.body(&[(-6.0, -28.0), (44.0, 1.0), (-6.0, 30.0)]);
    art.output = (44.0, 0.0);
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

/// A hand switch, open or closed.
pub(super) fn key(symbol: &Symbol) -> Art {
    let mut art = Art { inputs: vec![(-24.0, 0.0)], output: (24.0, 0.0), ..Art::default() };
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
