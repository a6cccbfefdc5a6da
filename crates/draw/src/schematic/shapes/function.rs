//! Boxes for functions of their inputs: multipliers, curves and delays.

use super::art::{Art, HALF_LETTER, NAME, PRINT, SMALL, jack_heights, wave};
use super::{Align, Ink, Symbol};
use crate::schematic::number_text::format_volts;

/// Returns a square with its jacks at the left.
pub(super) fn square(symbol: &Symbol, half: f64) -> Art {
    let mut art = Art { outputs: vec![(half, 0.0)], ..Art::default() };
    art.rectangle((-half, -half), (half, half));
    art.inputs = jack_heights(symbol.jacks.len()).map(|y| (-half, y)).collect();
    art
}

/// Draws a multiplier: a box with the sign and, below it, the law of its mode, in volts.
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

/// Half the side of a box with a curve.
const BOX: f64 = 22.0;
/// Half the side of the square of the curve.
const CURVE: f64 = 16.0;

/// Returns a box with axes and a curve.
fn curve_box(symbol: &Symbol, paint: impl FnOnce(&mut Art)) -> Art {
    let mut art = square(symbol, BOX);
    art.rule(&[(-CURVE, 0.0), (CURVE, 0.0)]);
    art.rule(&[(0.0, -CURVE), (0.0, CURVE)]);
    paint(&mut art);
    art.above(&symbol.name, NAME, Ink::Line);
    art
}

/// Scales points from -1 to 1 to the square of the curve.
fn lines(points: &[(f64, f64)]) -> Vec<(f64, f64)> {
    points.iter().map(|(x, y)| (CURVE * x, -CURVE * y)).collect()
}

/// Returns a box with a curve and a word below.
fn named_curve(symbol: &Symbol, word: &str, curve: fn(f64) -> f64) -> Art {
    let mut art = curve_box(symbol, |art| art.curve((0.0, 0.0), CURVE, curve));
    art.below(word, PRINT, Ink::Line);
    art
}

/// Draws the absolute value.
pub(super) fn absolute(symbol: &Symbol) -> Art {
    let mut art = curve_box(symbol, |art| art.bold(&lines(&[(-0.9, 0.9), (0.0, 0.0), (0.9, 0.9)])));
    art.below("|in|", PRINT, Ink::Line);
    art
}

/// Draws a dead zone with its two limits below.
pub(super) fn dead_zone(symbol: &Symbol) -> Art {
    let mut art =
        curve_box(symbol, |art| art.bold(&lines(&[(-1.0, -0.8), (-0.4, 0.0), (0.4, 0.0), (1.0, 0.8)])));
    if let (Some(lower), Some(upper)) = (symbol.number("lower"), symbol.number("upper")) {
        art.below(&format!("{} … {}", format_volts(lower), format_volts(upper)), PRINT, Ink::Line);
    }
    art
}

/// Draws backlash, a hysteresis loop, with its width below.
pub(super) fn backlash(symbol: &Symbol) -> Art {
    let mut art = curve_box(symbol, |art| {
        let play = [(-0.9, -0.8), (0.3, -0.8), (0.9, 0.8), (-0.3, 0.8), (-0.9, -0.8)];
        art.bold(&lines(&play));
    });
    if let Some(width) = symbol.number("width") {
        art.below(&format!("play {}", format_volts(width)), PRINT, Ink::Line);
    }
    art
}

/// Draws the curve of a function generator with its points and symmetry.
pub(super) fn generator(symbol: &Symbol) -> Art {
    let given = symbol.points("points");
    let mirrored =
        given.iter().rev().map(|[x, y]| [-x, if symbol.word("symmetry") == "odd" { -y } else { *y }]);
    let points: Vec<[f64; 2]> = match symbol.word("symmetry") {
        "odd" | "even" => mirrored.chain(given.iter().copied()).collect(),
        _ => given.to_vec(),
    };
    let normalised: Vec<_> =
        super::art::normalised(&points).into_iter().map(|(x, y)| (x, 0.85 * y)).collect();
    let mut art = curve_box(symbol, |art| art.bold(&lines(&normalised)));
    art.below(&format!("{} points", given.len()), SMALL, Ink::Soft);
    art
}

/// Draws one period of a sine.
pub(super) fn sin(symbol: &Symbol) -> Art {
    named_curve(symbol, "sin", |x| 0.8 * wave(x))
}

/// Draws one period of a cosine.
pub(super) fn cos(symbol: &Symbol) -> Art {
    named_curve(symbol, "cos", |x| 0.8 * wave(x + 0.5))
}

/// Draws a logarithm.
pub(super) fn log(symbol: &Symbol) -> Art {
    named_curve(symbol, "log", |x| if x <= 0.0 { -1.0 } else { 1.0 + x.log10().max(-2.0) })
}

/// Draws an exponential function.
pub(super) fn exp(symbol: &Symbol) -> Art {
    named_curve(symbol, "exp", |x| 0.9 * 10.0_f64.powf(1.3 * (x - 1.0)))
}

/// Draws a delay: a box with round ends.
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
