//! Drives: circles with their little waveform.

use super::art::{self, Art, NAME, wave};
use super::{Ink, Symbol};

const RADIUS: f64 = 18.0;

/// Half the side of the square in which the waveform is drawn.
const ROOM: f64 = 11.0;

fn source(symbol: &Symbol, paint: impl FnOnce(&mut Art)) -> Art {
    let mut art = Art { outputs: vec![(RADIUS, 0.0)], ..Art::default() };
    art.circle((0.0, 0.0), RADIUS);
    paint(&mut art);
    art.above(&symbol.name, NAME, Ink::Line);
    art
}

fn corners(symbol: &Symbol, points: &[(f64, f64)]) -> Art {
    let points: Vec<_> = points.iter().map(|(x, y)| (ROOM * x, -ROOM * y)).collect();
    source(symbol, |art| art.bold(&points))
}

pub(super) fn step(symbol: &Symbol) -> Art {
    corners(symbol, &[(-1.0, -0.6), (-0.2, -0.6), (-0.2, 0.7), (1.0, 0.7)])
}

pub(super) fn ramp(symbol: &Symbol) -> Art {
    corners(symbol, &[(-1.0, -0.7), (0.9, 0.8)])
}

pub(super) fn triangle(symbol: &Symbol) -> Art {
    corners(symbol, &[(-1.0, 0.0), (-0.5, 0.7), (0.5, -0.7), (1.0, 0.0)])
}

pub(super) fn sine(symbol: &Symbol) -> Art {
    source(symbol, |art| art.curve((0.0, 0.0), ROOM, |x| 0.7 * wave(x)))
}

/// Heights of a random walk, the same every time.
const JUMPS: [f64; 12] = [0.1, -0.5, 0.3, 0.7, -0.2, 0.4, -0.7, -0.1, 0.6, -0.4, 0.2, -0.3];

pub(super) fn noise(symbol: &Symbol) -> Art {
    let place = |(index, y): (usize, &f64)| (index as f64 / 5.5 - 1.0, *y);
    let points: Vec<_> = JUMPS.iter().enumerate().map(place).collect();
    corners(symbol, &points)
}

/// The curve itself.
pub(super) fn table(symbol: &Symbol) -> Art {
    let points = symbol.points("points");
    let points: Vec<_> = art::fitted(points).into_iter().map(|(x, y)| (x, 0.7 * y)).collect();
    corners(symbol, &points)
}
