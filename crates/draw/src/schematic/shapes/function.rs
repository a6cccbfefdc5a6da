//! Boxes that make a function of what goes in: multipliers, curves, delay lines.

use super::art::{Art, HALF_LETTER, NAME, PRINT, SMALL, jack_heights, wave};
use super::{Align, Ink, Symbol};
use crate::schematic::symbol::volts;

/// A square with jacks at its left.
pub(super) fn square(symbol: &Symbol, half: f64) -> Art {
    let mut art = Art { outputs: vec![(half, 0.0)], ..Art::default() };
    art.rectangle((-half, -half), (half, half));
    art.inputs = jack_heights(symbol.jacks.len()).map(|y| (-half, y)).collect();
    art
}

pub(super) fn multiplier(symbol: &Symbol) -> Art {
    let mut art = square(symbol, 25.0);
    for (jack, at) in symbol.jacks.iter().zip(art.inputs.clone()) {
        art.text(&jack.input, (at.0 + 4.0, at.1 + HALF_LETTER * SMALL), SMALL, Align::Start, Ink::Soft);
    }
    let (sign, law) = match symbol.word("mode") {
        "sum-of-squares" => ("Σ²", "(a² + b²)/100"),
        _ => ("×", "a b/100"),
    };
    art.text(sign, (7.0, 6.0), 16.0, Align::Middle, Ink::Line);
    art.above(&symbol.name, NAME, Ink::Line);
    art.below(law, SMALL, Ink::Soft);
    art
}

/// Half the side of a box with a curve, and of the room of the curve.
const BOX: f64 = 22.0;
const CURVE: f64 = 16.0;

/// A box with axes and a curve.
fn curve_box(symbol: &Symbol, paint: impl FnOnce(&mut Art)) -> Art {
    let mut art = square(symbol, BOX);
    art.rule(&[(-CURVE, 0.0), (CURVE, 0.0)]);
    art.rule(&[(0.0, -CURVE), (0.0, CURVE)]);
    paint(&mut art);
    art.above(&symbol.name, NAME, Ink::Line);
    art
}

fn lines(points: &[(f64, f64)]) -> Vec<(f64, f64)> {
    points.iter().map(|(x, y)| (CURVE * x, -CURVE * y)).collect()
}

/// A curve with a word under it.
fn named_curve(symbol: &Symbol, word: &str, curve: fn(f64) -> f64) -> Art {
    let mut art = curve_box(symbol, |art| art.curve((0.0, 0.0), CURVE, curve));
    art.below(word, PRINT, Ink::Line);
    art
}

pub(super) fn absolute(symbol: &Symbol) -> Art {
    let mut art = curve_box(symbol, |art| art.bold(&lines(&[(-0.9, 0.9), (0.0, 0.0), (0.9, 0.9)])));
    art.below("|in|", PRINT, Ink::Line);
    art
}

pub(super) fn dead_zone(symbol: &Symbol) -> Art {
    let mut art =
        curve_box(symbol, |art| art.bold(&lines(&[(-1.0, -0.8), (-0.4, 0.0), (0.4, 0.0), (1.0, 0.8)])));
    if let (Some(lower), Some(upper)) = (symbol.number("lower"), symbol.number("upper")) {
        art.below(&format!("{} … {}", volts(lower), volts(upper)), PRINT, Ink::Line);
    }
    art
}

pub(super) fn backlash(symbol: &Symbol) -> Art {
    let mut art = curve_box(symbol, |art| {
        let play = [(-0.9, -0.8), (0.3, -0.8), (0.9, 0.8), (-0.3, 0.8), (-0.9, -0.8)];
        art.bold(&lines(&play));
    });
    if let Some(width) = symbol.number("width") {
        art.below(&format!("play {}", volts(width)), PRINT, Ink::Line);
    }
    art
}

/// The curve as it is set.
pub(super) fn generator(symbol: &Symbol) -> Art {
    let given = symbol.points("points");
    let mirrored =
        given.iter().rev().map(|[x, y]| [-x, if symbol.word("symmetry") == "odd" { -y } else { *y }]);
    let points: Vec<[f64; 2]> = match symbol.word("symmetry") {
        "odd" | "even" => mirrored.chain(given.iter().copied()).collect(),
        _ => given.to_vec(),
    };
    let fitted: Vec<_> = super::art::fitted(&points).into_iter().map(|(x, y)| (x, 0.85 * y)).collect();
    let mut art = curve_box(symbol, |art| art.bold(&lines(&fitted)));
    art.below(&format!("{} points", given.len()), SMALL, Ink::Soft);
    art
}

pub(super) fn sin(symbol: &Symbol) -> Art {
    named_curve(symbol, "sin", |x| 0.8 * wave(x))
}

pub(super) fn cos(symbol: &Symbol) -> Art {
    named_curve(symbol, "cos", |x| 0.8 * wave(x + 0.5))
}

pub(super) fn log(symbol: &Symbol) -> Art {
    named_curve(symbol, "log", |x| if x <= 0.0 { -1.0 } else { 1.0 + x.log10().max(-2.0) })
}

pub(super) fn exp(symbol: &Symbol) -> Art {
    named_curve(symbol, "exp", |x| 0.9 * 10.0_f64.powf(1.3 * (x - 1.0)))
}

/// A box with round ends.
pub(super) fn delay(symbol: &Symbol) -> Art {
    let mut art = Art { inputs: vec![(-30.0, 0.0)], outputs: vec![(30.0, 0.0)], ..Art::default() };
    let arc = |sign: f64| {
        (0..=12).map(move |step| {
            let angle = std::f64::consts::PI * (f64::from(step) / 12.0 - 0.5);
            (sign * (16.0 + 14.0 * angle.cos()), sign * 14.0 * angle.sin())
        })
    };
    let corners: Vec<_> = arc(1.0).chain(arc(-1.0)).collect();
    art.body(&corners);
    art.rule(&[(-16.0, -14.0), (-16.0, 14.0)]);
    art.rule(&[(16.0, -14.0), (16.0, 14.0)]);
    art.name(&symbol.name, (0.0, 0.0), 28.0);
    if let Some(setting) = symbol.setting("delay") {
        art.below(&format!("delay {}", setting.shown), PRINT, Ink::Line);
    }
    art
}
