//! Triangles: summers, integrators, lags and open amplifiers.

use super::art::{Art, HALF_LETTER, NAME, PRINT, SMALL, jack_heights};
use super::{Align, Ink, Symbol};
use crate::plot::text_width;
use crate::schematic::number_text::format_volts;
use crate::schematic::symbol::Jack;

/// The length of a triangle.
const LENGTH: f64 = 58.0;

/// The width of the bar at the base of an integrator.
const BAR: f64 = 27.0;

/// Returns the height of a triangle with this number of jacks at its base.
fn height(jacks: usize) -> f64 {
    (16.0 * jacks as f64 + 22.0).max(48.0)
}

/// Returns the triangle of an amplifier with its base at `left`.
fn triangle(left: f64, jacks: usize) -> Art {
    let half = height(jacks) / 2.0;
    let mut art = Art { outputs: vec![(left + LENGTH, 0.0)], ..Art::default() };
    art.body(&[(left, -half), (left + LENGTH, 0.0), (left, half)]);
    art.inputs = jack_heights(jacks).map(|y| (left, y)).collect();
    art
}

/// Returns the gain of a jack as it is written at the jack; empty without a gain.
fn gain_text(jack: &Jack) -> String {
    jack.gain.map(|gain| format!("{gain}")).unwrap_or_default()
}

/// Draws a summer: a triangle that points to the output, with the gains inside at its base.
///
/// Inverters and other amplifiers with fixed feedback have the same shape.
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

/// Draws an amplifier without built-in feedback: a triangle with a curved base.
pub(super) fn open(symbol: &Symbol) -> Art {
    let mut art = summer(symbol);
    let (left, half) = (-LENGTH / 2.0, height(symbol.jacks.len()) / 2.0);
    let curved = |step: i32| {
        let y = half * f64::from(step) / 8.0;
        (left - BEND * (1.0 - (y / half).powi(2)), y)
    };
    let bow: Vec<_> = (-8..=8).map(curved).collect();
    let mut background = Art::default();
    background.body(&bow);
    background.primitives.append(&mut art.primitives);
    art.primitives = background.primitives;
    art.inputs.iter_mut().for_each(|at| at.0 = left - BEND * (1.0 - (at.1 / half).powi(2)));
    art
}

/// The depth of the curved base of an open amplifier.
const BEND: f64 = 10.0;

/// Draws a first-order lag: an integrator with its time constant below.
pub(super) fn lag(symbol: &Symbol) -> Art {
    let mut art = integrator(symbol);
    if let Some(setting) = symbol.setting("time") {
        art.below(&format!("lag {}", setting.shown), PRINT, Ink::Line);
    }
    art
}

/// Writes the name inside the triangle if it fits to the right of `left`, else above the triangle.
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

/// Draws the limiting diodes above the triangle, with their levels.
fn limits(art: &mut Art, symbol: &Symbol) {
    for (name, sign) in [("limit.upper", "≤"), ("limit.lower", "≥")] {
        if let Some(level) = symbol.number(name) {
            let top = art.area().top - 9.0;
            let text = format!("{sign} {}", format_volts(level));
            let left = -(text_width(&text, PRINT) + 18.0) / 2.0;
            art.rule(&[(left, top), (left + 4.0, top)]);
            art.diode((left + 8.0, top), (if sign == "≤" { 1.0 } else { -1.0 }, 0.0));
            art.rule(&[(left + 12.0, top), (left + 15.0, top)]);
            art.text(&text, (left + 18.0, top + HALF_LETTER * PRINT), PRINT, Align::Start, Ink::Line);
        }
    }
}

/// Draws an integrator: a triangle with a bar at its base.
///
/// The gains are in the bar, and the initial condition is above it. Inputs other than `x`, such as the brake, are named
/// to the left of their jacks.
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
        let input = jack.input.trim_end_matches("_x");
        if input != "x" {
            art.text(input, (left - 4.0, at.1 - 3.0), SMALL, Align::End, Ink::Soft);
        }
    }
    initial(&mut art, symbol, left + BAR / 2.0, -half);
    name_in_triangle(&mut art, symbol, left + BAR + 6.0);
    limits(&mut art, symbol);
    art
}

/// Draws the initial condition, which enters the bar from above.
fn initial(art: &mut Art, symbol: &Symbol, x: f64, top: f64) {
    let Some(initial) = symbol.number("initial") else { return };
    art.line(&[(x, top - 7.0), (x, top)]);
    art.text(
        &format!("IC {}", format_volts(initial)),
        (x - BAR / 2.0, top - 11.0),
        PRINT,
        Align::Start,
        Ink::Line,
    );
}
