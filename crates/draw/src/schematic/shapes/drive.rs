//! Drives: circles with a small waveform.

use super::art::{self, Art, NAME, wave};
use super::{Ink, Symbol};

/// The radius of the circle.
const RADIUS: f64 = 18.0;

/// Half the side of the square in which the waveform is drawn.
const HALF_SIDE: f64 = 11.0;

/// Draws the circle of a drive, what `paint` adds to it, and the name above.
fn source(symbol: &Symbol, paint: impl FnOnce(&mut Art)) -> Art {
    let mut art = Art { outputs: vec![(RADIUS, 0.0)], ..Art::default() };
    art.circle((0.0, 0.0), RADIUS);
    paint(&mut art);
    art.above(&symbol.name, NAME, Ink::Line);
    art
}

/// Draws a drive with a waveform of straight lines; the points range from -1 to 1.
fn corners(symbol: &Symbol, points: &[(f64, f64)]) -> Art {
    let points: Vec<_> = points.iter().map(|(x, y)| (HALF_SIDE * x, -HALF_SIDE * y)).collect();
    source(symbol, |art| art.bold(&points))
}

/// Draws a step upward.
pub(super) fn step(symbol: &Symbol) -> Art {
    corners(symbol, &[(-1.0, -0.6), (-0.2, -0.6), (-0.2, 0.7), (1.0, 0.7)])
}

/// Draws a rising straight line.
pub(super) fn ramp(symbol: &Symbol) -> Art {
    corners(symbol, &[(-1.0, -0.7), (0.9, 0.8)])
}

/// Draws a rectangular pulse.
pub(super) fn pulse(symbol: &Symbol) -> Art {
    corners(symbol, &[(-1.0, -0.6), (-0.4, -0.6), (-0.4, 0.7), (0.3, 0.7), (0.3, -0.6), (1.0, -0.6)])
}

/// Draws one and a half periods of a square wave.
pub(super) fn square(symbol: &Symbol) -> Art {
    corners(symbol, &[(-1.0, 0.6), (-0.33, 0.6), (-0.33, -0.6), (0.33, -0.6), (0.33, 0.6), (1.0, 0.6)])
}

/// Draws one period of a triangular wave.
pub(super) fn triangle(symbol: &Symbol) -> Art {
    corners(symbol, &[(-1.0, 0.0), (-0.5, 0.7), (0.5, -0.7), (1.0, 0.0)])
}

/// Draws one period of a sine.
pub(super) fn sine(symbol: &Symbol) -> Art {
    source(symbol, |art| art.curve((0.0, 0.0), HALF_SIDE, |x| 0.7 * wave(x)))
}

/// Draws a sine whose frequency rises.
pub(super) fn chirp(symbol: &Symbol) -> Art {
    source(symbol, |art| art.curve((0.0, 0.0), HALF_SIDE, |x| 0.7 * wave(0.75 * (x + 1.0).powi(2) + 0.5 * x)))
}

/// The samples of the noise symbol, from -1 to 1.
const NOISE_SAMPLES: [f64; 12] = [0.1, -0.5, 0.3, 0.7, -0.2, 0.4, -0.7, -0.1, 0.6, -0.4, 0.2, -0.3];

/// Draws an irregular line.
pub(super) fn noise(symbol: &Symbol) -> Art {
    let point = |(index, y): (usize, &f64)| (index as f64 / 5.5 - 1.0, *y);
    let points: Vec<_> = NOISE_SAMPLES.iter().enumerate().map(point).collect();
    corners(symbol, &points)
}

/// Draws the table of the drive itself.
pub(super) fn table(symbol: &Symbol) -> Art {
    let points = symbol.points("points");
    let points: Vec<_> = art::normalised(points).into_iter().map(|(x, y)| (x, 0.7 * y)).collect();
    corners(symbol, &points)
}
