//! Triangles: summing and integrating amplifiers.

use super::art::{Art, HALF_LETTER, NAME, PRINT, SMALL, jack_heights};
use super::{Align, Ink, Symbol};
use crate::plot::text_width;
use crate::schematic::symbol::{Jack, volts};

/// Length of a triangle.
const LENGTH: f64 = 58.0;

/// Width of the bar before an integrator's triangle.
const BAR: f64 = 27.0;

/// Height of a triangle with so many jacks at its base.
fn height(jacks: usize) -> f64 {
    (16.0 * jacks as f64 + 22.0).max(48.0)
}

/// The triangle of an amplifier, its base at `left`.
fn triangle(left: f64, jacks: usize) -> Art {
    let half = height(jacks) / 2.0;
    let mut art = Art { outputs: vec![(left + LENGTH, 0.0)], ..Art::default() };
    art.body(&[(left, -half), (left + LENGTH, 0.0), (left, half)]);
    art.inputs = jack_heights(jacks).map(|y| (left, y)).collect();
    art
}

fn gain_text(jack: &Jack) -> String {
    jack.gain.map(|gain| format!("{gain}")).unwrap_or_default()
}

pub(super) fn summer(symbol: &Symbol) -> Art {
    let left = -LENGTH / 2.0;
    let mut art = triangle(left, symbol.jacks.len());
    let mut widest = 0.0_f64;
    for (jack, at) in symbol.jacks.iter().zip(art.inputs.clone()) {
        let text = gain_text(jack);
        widest = widest.max(text_width(&text, SMALL));
        art.text(&text, (left + 4.0, at.1 + HALF_LETTER * SMALL), SMALL, Align::Start, Ink::Line);
    }
    name_in_triangle(&mut art, symbol, left + 4.0 + widest + 3.0);
    limits(&mut art, symbol);
    super::diodes::parts_below(&mut art, symbol);
    art
}

/// An amplifier without feedback of its own: its base is bent.
pub(super) fn open(symbol: &Symbol) -> Art {
    let mut art = summer(symbol);
    let (left, half) = (-LENGTH / 2.0, height(symbol.jacks.len()) / 2.0);
    let bent = |step: i32| {
        let y = half * f64::from(step) / 8.0;
        (left - BEND * (1.0 - (y / half).powi(2)), y)
    };
    let bow: Vec<_> = (-8..=8).map(bent).collect();
    let mut under = Art::default();
    under.body(&bow);
    under.marks.append(&mut art.marks);
    art.marks = under.marks;
    art.inputs.iter_mut().for_each(|at| at.0 = left - BEND * (1.0 - (at.1 / half).powi(2)));
    art
}

/// How far the base of an open amplifier is bent.
const BEND: f64 = 10.0;

/// A summing amplifier with a capacitor: its time constant stands in the bar.
pub(super) fn lag(symbol: &Symbol) -> Art {
    let mut art = integrator(symbol);
    if let Some(setting) = symbol.setting("time") {
        art.below(&format!("lag {}", setting.shown), PRINT, Ink::Line);
    }
    art
}

/// The name after the gains, where the triangle is still high enough for it.
fn name_in_triangle(art: &mut Art, symbol: &Symbol, left: f64) {
    let width = text_width(&symbol.name, NAME);
    let half = height(symbol.jacks.len()) / 2.0;
    let last = art.outputs[0].0 - 0.42 * NAME * LENGTH / half;
    if left + width <= last {
        art.text(&symbol.name, (left, HALF_LETTER * NAME), NAME, Align::Start, Ink::Line);
    } else {
        art.above(&symbol.name, NAME, Ink::Line);
    }
}

/// The diodes that hold an output within limits, with the levels.
fn limits(art: &mut Art, symbol: &Symbol) {
    for (name, sign) in [("limit.upper", "≤"), ("limit.lower", "≥")] {
        if let Some(level) = symbol.number(name) {
            let top = art.area().top - 9.0;
            let text = format!("{sign} {}", volts(level));
            let left = -(text_width(&text, PRINT) + 18.0) / 2.0;
            art.rule(&[(left, top), (left + 4.0, top)]);
            art.diode((left + 8.0, top), (if sign == "≤" { 1.0 } else { -1.0 }, 0.0));
            art.rule(&[(left + 12.0, top), (left + 15.0, top)]);
            art.text(&text, (left + 18.0, top + HALF_LETTER * PRINT), PRINT, Align::Start, Ink::Line);
        }
    }
}

pub(super) fn integrator(symbol: &Symbol) -> Art {
    let left = -(LENGTH + BAR) / 2.0;
    let count = symbol.jacks.len();
    let mut art = triangle(left + BAR, count);
    let half = height(count) / 2.0;
    art.rectangle((left, -half), (left + BAR, half));
    art.inputs.iter_mut().for_each(|at| at.0 = left);
    for (jack, at) in symbol.jacks.iter().zip(art.inputs.clone()) {
        let text = gain_text(jack);
        art.text(&text, (left + BAR / 2.0, at.1 + HALF_LETTER * SMALL), SMALL, Align::Middle, Ink::Line);
        let what = jack.input.trim_end_matches("_x");
        if what != "x" {
            art.text(what, (left - 4.0, at.1 - 3.0), SMALL, Align::End, Ink::Soft);
        }
    }
    initial(&mut art, symbol, left + BAR / 2.0, -half);
    name_in_triangle(&mut art, symbol, left + BAR + 6.0);
    limits(&mut art, symbol);
    art
}

/// The initial condition, which goes into the bar from above.
fn initial(art: &mut Art, symbol: &Symbol, x: f64, top: f64) {
    let Some(initial) = symbol.number("initial") else { return };
    art.line(&[(x, top - 7.0), (x, top)]);
    art.text(&format!("IC {}", volts(initial)), (x - BAR / 2.0, top - 11.0), PRINT, Align::Start, Ink::Line);
}
